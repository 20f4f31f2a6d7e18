"""The codes that run a case of frameworks_cases.py: what each is told, and where its grains were over time.

Law: Hertz and Mindlin without slip in all. YADE ends a contact where its force would pull (damping of
Thornton et al. 2013), LIGGGHTS where the overlap ends (Tsuji et al. 1992); ryusa has both. Tangential spring:
YADE and ryusa keep a force to which k_s times the slip is added, LIGGGHTS a slip that it multiplies by the
present k_s; ryusa lets the force go as the contact area shrinks. Tangential dashpot: as the normal one in the
others; ryusa is given one restitution_shear for all pairs, that of two grains of M1 in the peer.
"""

import json
import math
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from frameworks_cases import DENSITY, FRICTION, MATERIALS, NU, RESTITUTION, YOUNG, Bulk, Floats, G
from peer import children_of, peak_of, threads_of_one
from peer_elastic import write_stl

HERE = Path(__file__).resolve().parent
OUT = -0.02  # grains below are taken out of the silo [m]
SHEAR = {"Tsuji": 0.29, "Thornton": 0.218}  # restitution_shear of ryusa: the tangential dashpot of each peer


@dataclass(frozen=True)
class Spent:
    """What a run took."""

    wall: float  # [s]
    processor: float  # of all its processes [s]
    memory: float  # of all its processes, the most [MB]


def carry_out(words: list[str], folder: Path, environment: dict[str, str]) -> Spent:
    """Run a program to its end."""
    log, begun = folder / "log", time.perf_counter()
    with log.open("w") as out:
        process = subprocess.Popen(
            words, cwd=folder, env=environment, stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL
        )
        peak, status, used = 0, 0, None
        while used is None:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            used = usage if pid else None
            peak = max(peak, sum(peak_of(one) for one in (process.pid, *children_of(process.pid))))
            time.sleep(0.05)
    process.returncode = os.waitstatus_to_exitcode(status)
    if status:
        raise SystemExit(f"{' '.join(words)[:300]}:\n{log.read_text(errors='replace')[-2000:]}")
    return Spent(time.perf_counter() - begun, used.ru_utime + used.ru_stime, peak / 2.0**20)


def steps_of(bulk: Bulk, dt: float) -> tuple[int, int]:
    """Steps between two frames, and frames, of a case."""
    return round(bulk.frame / dt), round(bulk.time / bulk.frame)


def run_yade(bulk: Bulk, kept: Path, folder: Path, dt: float, threads: int) -> tuple[Spent, Floats, Floats]:
    """Run a case in YADE; times [s] and places (n_frame, n, 3) [m], nan where a grain has left."""
    every, frames = steps_of(bulk, dt)
    np.save(folder / "mesh.npy", bulk.mesh())
    small = min(d for _, d, _ in bulk.kinds)
    job = {
        "grains": str(kept), "mesh": "mesh.npy", "materials": MATERIALS, "nu": NU, "density": DENSITY,
        "young": [one / bulk.soft for one in YOUNG], "restitution": RESTITUTION, "friction": FRICTION,
        "gravity": G, "spin": bulk.spin, "dt": dt, "every": every, "frames": frames, "skin": 0.1 * small,
        "out": OUT if bulk.name == "silo" else -1.0, "result": "frames.npz",
    }  # fmt: skip
    (folder / "job.json").write_text(json.dumps(job))
    script = str(HERE / "in_yade_frameworks.py")
    plain = {k: v for k, v in threads_of_one(threads).items() if not k.startswith("PYTHON")}
    spent = carry_out(["yade", "-n", "-x", f"-j{threads}", script, "job.json"], folder, plain)
    with np.load(folder / "frames.npz") as file:
        return spent, file["t"], file["x"].astype(np.float64)


def _liggghts(bulk: Bulk, dt: float, threads: int, every: int, steps: int, skin: float) -> str:
    def table(name: str, rows: tuple[tuple[float, ...], ...]) -> str:
        flat = " ".join(f"{one:g}" for row in rows for one in row)
        return f"fix {name} all property/global {name} peratomtypepair 3 {flat}\n"

    young = " ".join(f"{one / bulk.soft:g}" for one in YOUNG)
    model = "model hertz tangential history"
    turn = (
        "fix turn all move/mesh mesh wall rotate origin 0 0 0 axis 0 1 0 "
        f"period {2.0 * math.pi / bulk.spin:.17g}\n"
        if bulk.spin
        else ""
    )
    return f"""atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
units si
hard_particles yes
processors {threads} 1 1
read_data grains.data
neighbor {skin:g} bin
neigh_modify delay 0
fix youngsModulus all property/global youngsModulus peratomtype {young}
fix poissonsRatio all property/global poissonsRatio peratomtype {NU} {NU} {NU}
{table("coefficientRestitution", RESTITUTION)}{table("coefficientFriction", FRICTION)}
pair_style gran {model}
pair_coeff * *
timestep {dt:.17g}
fix weight all gravity {G} vector 0 0 -1
fix wall all mesh/surface file wall.stl type 3
fix walls all wall/gran {model} mesh n_meshes 1 meshes wall
fix move all nve/sphere
{turn}thermo {steps}
thermo_modify lost ignore norm no
dump frames all custom {every} frames.dump id x y z
dump_modify frames format "%d %.8g %.8g %.8g"
run {steps}
"""


def run_liggghts(
    bulk: Bulk, kept: Path, folder: Path, dt: float, threads: int, skin: float = 0.2
) -> tuple[Spent, Floats, Floats]:
    """The same in LIGGGHTS; `skin` in diameters of the smallest grain."""
    every, frames = steps_of(bulk, dt)
    write_stl(folder / "wall.stl", bulk.mesh())
    with np.load(kept) as file:
        x, v, d, of = (file[name] for name in ("x", "v", "d", "of"))
    low, high = bulk.mesh().min(axis=(0, 1)) - 0.005, bulk.mesh().max(axis=(0, 1)) + 0.005
    if bulk.name == "silo":
        low[2] = OUT
    ids = np.arange(1, len(x) + 1)[:, None]
    body = np.hstack([ids, of[:, None] + 1, d[:, None], np.array(DENSITY)[of][:, None], x])
    with (folder / "grains.data").open("w") as out:
        out.write(f"grains\n\n{len(x)} atoms\n3 atom types\n\n")
        for axis, a, b in zip("xyz", low, high, strict=True):
            out.write(f"{a:.17g} {b:.17g} {axis}lo {axis}hi\n")
        out.write("\nAtoms\n\n")
        np.savetxt(out, body, fmt=["%d", "%d", *["%.17g"] * 5])
        out.write("\nVelocities\n\n")
        np.savetxt(out, np.hstack([ids, v, np.zeros_like(v)]), fmt=["%d", *["%.17g"] * 6])
    small = skin * min(one for _, one, _ in bulk.kinds)
    text = _liggghts(bulk, dt, threads, every, every * frames, small)
    (folder / "in.liggghts").write_text(text)
    ranks = ["mpirun", "-n", str(threads)] if threads > 1 else []
    spent = carry_out([*ranks, "liggghts", "-in", "in.liggghts", "-log", "none"], folder, threads_of_one(1))
    places = np.full((frames + 1, len(x), 3), np.nan)
    for k, part in enumerate((folder / "frames.dump").read_text().split("ITEM: TIMESTEP")[1 : frames + 2]):
        rows = np.array(part.split("ITEM: ATOMS")[1].split()[4:], np.float64).reshape(-1, 4)
        places[k, rows[:, 0].astype(int) - 1] = rows[:, 1:]
    return spent, dt * every * np.arange(frames + 1), places


def run_ryusa(
    bulk: Bulk, kept: Path, folder: Path, dt: float, threads: int, damping: str = "Tsuji"
) -> tuple[Spent, Floats, Floats]:
    """The same in ryusa, from its case file."""
    from ryusa.results import Results

    every, frames = steps_of(bulk, dt)
    shutil.copy(HERE / "frameworks" / f"{bulk.name}.toml", folder / "case.toml")
    write_stl(folder / "wall.stl", bulk.mesh())
    with np.load(kept) as file:
        names = np.array(["", "M2", "ball"])[file["of"]]
        with (folder / "grains.csv").open("w") as out:
            out.write("x [m],y [m],z [m],d [m],vz [m/s],group\n")
            for x, v, d, name in zip(file["x"], file["v"], file["d"], names, strict=True):
                out.write(",".join(f"{one:.17g}" for one in (*x, d, v[2])) + f",{name}\n")
    keys = {
        "contact.youngs_modulus": f"{YOUNG[0] / bulk.soft:g} Pa",
        "materials.steel.youngs_modulus": f"{YOUNG[2] / bulk.soft:g} Pa",
        "contact.damping_law": damping,
        "contact.restitution_shear": str(SHEAR[damping]),
        "time.step": f"{dt:.17g} s",
        "stop.time": f"{dt * every * frames:.17g} s",
        "record.frames": f"{dt * every:.17g} s",
    }
    if bulk.name == "drum":
        keys["materials.M2.youngs_modulus"] = f"{YOUNG[1] / bulk.soft:g} Pa"
        keys["walls.0.angular_velocity"] = f'["0 rad/s", "{bulk.spin:.17g} rad/s", "0 rad/s"]'
    sets = [word for one in keys.items() for word in ("--set", "=".join(one))]
    words = [sys.executable, "-m", "ryusa", "run", "case.toml", "--out", "run", "--overwrite", "--quiet"]
    spent = carry_out([*words, "--threads", str(threads), *sets], folder, dict(os.environ))
    run = Results.open(folder / "run")
    places: Floats = np.stack([frame.x for frame in run.frames])
    return spent, run.frames.t, places


def codes() -> dict[str, Callable[..., tuple[Spent, Floats, Floats]]]:
    """Those that are there, by the name of their rows."""
    found: dict[str, Callable[..., tuple[Spent, Floats, Floats]]] = {"ryusa": run_ryusa}
    if shutil.which("liggghts"):
        found["LIGGGHTS"] = run_liggghts
    if shutil.which("yade"):
        found["YADE"] = run_yade
    return found | {"ryusa (Thornton)": partial(run_ryusa, damping="Thornton")}
