"""Elastic spheres and walls beside LAMMPS and LIGGGHTS: the same grains, processor time of one core.

    python benchmarks/peer_elastic.py [flow] [box] [--grains 20000] [--rounds 3]

`flow`: the bed of hertz.py, with linear springs and with those of Hertz and Mindlin in each code. `box`: the
bed of walls.py at rest, in five planes and in a mesh of 10,000 triangles; LAMMPS has no such meshes here, but
regions. A peer is run twice, for few steps and for more, and the difference of processor times is taken, so
that start-up falls out. LAMMPS is found as `lmp` beside this Python or on the path, LIGGGHTS on the path;
what is not there is left out. Where laws differ: LAMMPS `gran/*` and LIGGGHTS `hertz` damp otherwise than
ryusa (`granular` with `tsuji` and `mindlin_rescale/force` does the same), and no peer keeps an account.
"""

import argparse
import json
import math
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import hertz
import machine
import numpy as np
import peer_lammps
import walls
from workloads import Grains

from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.hertz import effective_modulus, effective_shear_modulus
from ryusa.model import Scene, State

FEW, MORE = 100, 500  # steps of a peer
WORK = Path("build/benchmarks")


def spent(command: list[str], folder: Path, extra: dict[str, str]) -> float:
    """Processor seconds of a program."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        command, cwd=folder, env={**os.environ, "OMP_NUM_THREADS": "1", **extra}, capture_output=True,
        text=True, check=False,
    )  # fmt: skip
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}:\n{done.stdout[-1500:]}{done.stderr[-500:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def peer(name: str, text: str, folder: Path, n: int) -> Callable[[], float]:
    """A run of a peer that returns ns a grain and step."""
    own = Path(sys.prefix) / "bin" / "lmp"
    program = (
        str(own)
        if name == "LAMMPS" and own.exists()
        else shutil.which({"LAMMPS": "lmp"}.get(name, "liggghts"))
    )
    extra = {"LD_LIBRARY_PATH": str(Path(sys.prefix) / "lib")} if program == str(own) else {}

    def run() -> float:
        times = []
        for steps in (FEW, MORE):
            (folder / "in.peer").write_text(f"{text}run {steps}\n")
            times.append(spent([str(program), "-in", "in.peer", "-log", "none"], folder, extra))
        return 1e9 * (times[1] - times[0]) / (MORE - FEW) / n

    return run


def ours(made: Scene, state: State, steps: int = 300) -> Callable[[], float]:
    """The same of ryusa, from the same state each time."""
    engine = CpuEngine(1)

    def run() -> float:
        engine.forget()
        engine.load(made, state)
        engine.advance(steps).raise_if_any()
        begun = time.process_time()
        engine.advance(steps).raise_if_any()
        return 1e9 * (time.process_time() - begun) / steps / made.n_grain

    return run


def data_of(made: Scene, state: State, folder: Path) -> None:
    """The grains as a data file."""
    grains = Grains(state.x, state.v, state.omega, made.d, made.x_fixed, made.d_fixed, made.period)
    peer_lammps.write_data(folder / "grains.data", grains, SimpleNamespace(key="a bed", plane=False), False)


def head(made: Scene, lammps: bool) -> str:
    """What both peers are told before the law."""
    end = "f" if lammps else "m"  # m grows with a mesh
    bounds = " ".join(["p" if math.isfinite(one) else end for one in made.period] + [end])
    speak = "comm_modify mode single vel yes" if lammps else "communicate single vel yes"
    style = "atom_style sphere" if lammps else "atom_style granular\natom_modify map array"
    bed = " exclude group bed bed" if len(made.x_fixed) else ""
    return f"""{style}
boundary {bounds}
newton off
{speak}
units si
read_data grains.data
group free type 1
group bed type 2
neighbor {0.1 * hertz.D:g} bin
neigh_modify delay 0 every 1 check yes{bed}
"""


def tail(made: Scene) -> str:
    """What both are told after it."""
    g = np.asarray(made.gravity)
    size = float(np.linalg.norm(g))
    return f"""timestep {made.dt:.17g}
fix move free nve/sphere
fix weight free gravity {size:.17g} vector {" ".join(f"{one / size:.17g}" for one in g)}
thermo 1000
"""


def constants(**values: float) -> str:
    """Properties of pairs of two types in LIGGGHTS."""
    return "".join(
        f"fix {name} all property/global {name} peratomtypepair 2 {' '.join([f'{one:.17g}'] * 4)}\n"
        for name, one in values.items()
    )


def hooke(made: Scene) -> tuple[str, str, str]:
    """Linear springs of a scene: constants of gran/hooke/history, properties and model of LIGGGHTS."""
    law = made.contact
    m = float(np.mean(made.m))
    rates = [
        2.0 * zeta * math.sqrt(k / m) * math.sqrt(2.0)
        for zeta, k in ((law.zeta_n, law.k_n), (law.zeta_s, law.k_s))
    ]
    said = f"{law.k_n:.17g} {law.k_s:.17g} {rates[0]:.17g} {rates[1]:.17g} {law.mu:.17g} 1"
    fixed = constants(
        kn=law.k_n, kt=law.k_s, gamman_abs=0.5 * m * rates[0], gammat_abs=0.5 * m * rates[1],
        coefficientFriction=law.mu,
    )  # fmt: skip
    return said, fixed, "hooke/stiffness tangential history absolute_damping on limitForce on"


def flow(n: int, folder: Path) -> dict[str, Callable[[], float]]:
    """Codes and laws on the flowing bed."""
    known = hertz.laws()
    made, now = hertz.flow(n, known["linear"], WORK)
    data_of(made, now, folder)
    spheres = known["Hertz-Mindlin"]
    young, nu = spheres.youngs_modulus, spheres.poisson_ratio
    stiff, shear = 4.0 / 3.0 * effective_modulus(young, nu), 8.0 * effective_shear_modulus(young, nu)
    springs, fixed, model = hooke(replace(made, contact=known["linear"]))
    linear_rate = float(springs.split()[2])
    # the same rate at the mean overlap of an impact at the speed of the comparison
    overlap = 0.5 * hertz.SPEED * math.sqrt(0.5 * hertz.M / hertz.K_N)
    rate = linear_rate / math.sqrt(0.25 * hertz.D * overlap)
    material = (
        f"hertz/material {young:.17g} {hertz.E} {nu} damping tsuji "
        f"tangential mindlin_rescale/force NULL 1.0 {hertz.MU}"
    )
    elastic = (
        f"fix youngsModulus all property/global youngsModulus peratomtype {young:.17g} {young:.17g}\n"
        f"fix poissonsRatio all property/global poissonsRatio peratomtype {nu} {nu}\n"
    ) + constants(coefficientRestitution=hertz.E, coefficientFriction=hertz.MU)
    found = {
        "ryusa, linear": ours(replace(made, contact=known["linear"]), now),
        "ryusa, Hertz-Mindlin": ours(replace(made, contact=spheres), now),
    }
    for name, law in (
        ("gran/hooke/history", f"pair_style gran/hooke/history {springs} limit_damping\npair_coeff * *\n"),
        ("gran/hertz/history", f"pair_style gran/hertz/history {stiff:.17g} {shear:.17g} {rate:.17g} "
         f"{0.5 * rate:.17g} {hertz.MU} 1 limit_damping\npair_coeff * *\n"),
        ("granular, hertz/material", f"pair_style granular\npair_coeff * * {material}\n"),
    ):  # fmt: skip
        found[f"LAMMPS, {name}"] = peer("LAMMPS", head(made, True) + law + tail(made), folder, made.n_grain)
    for name, law in (
        ("hooke/stiffness", f"{fixed}pair_style gran model {model}\npair_coeff * *\n"),
        ("hertz", f"{elastic}pair_style gran model hertz tangential history\npair_coeff * *\n"),
    ):
        found[f"LIGGGHTS, {name}"] = peer(
            "LIGGGHTS", head(made, False) + law + tail(made), folder, made.n_grain
        )
    return found


def write_stl(path: Path, corners: np.ndarray) -> None:
    """Triangles, (n, 3, 3), as a text STL."""
    with path.open("w") as file:
        file.write("solid box\n")
        for a, b, c in corners:
            n = np.cross(b - a, c - a)
            file.write("facet normal {:.9g} {:.9g} {:.9g}\n outer loop\n".format(*(n / np.linalg.norm(n))))
            for one in (a, b, c):
                file.write("  vertex {:.9g} {:.9g} {:.9g}\n".format(*one))
            file.write(" endloop\nendfacet\n")
        file.write("endsolid box\n")


def box(n: int, folder: Path) -> dict[str, Callable[[], float]]:
    """Codes and walls round the bed at rest."""
    planes, bed = walls.bed(n, 40_000, 1, WORK)
    made, width, high = walls.in_a_box(planes, 10_000, False)
    data_of(planes, bed, folder)
    write_stl(folder / "box.stl", walls.triangles_of_box(width, high, 10_000))
    springs, fixed, model = hooke(planes)
    kind, _, keys = model.partition(" absolute_damping")  # walls are named between the two
    keys = f"absolute_damping{keys}"
    found = {"ryusa, planes": ours(planes, bed), "ryusa, 10,000 triangles": ours(made, bed)}
    law = f"pair_style gran/hooke/history {springs} limit_damping\npair_coeff * *\n"
    region = f"region cup block 0 {width:.17g} 0 {width:.17g} 0 {high:.17g} open 6\n"
    for name, more in (
        ("wall/gran, planes", "".join(
            f"fix w{axis} free wall/gran hooke/history {springs} limit_damping {axis}plane 0.0 {end}\n"
            for axis, end in (("x", f"{width:.17g}"), ("y", f"{width:.17g}"), ("z", "NULL")))),
        ("wall/gran/region, block", f"{region}fix w free wall/gran/region hooke/history "
         f"{springs} limit_damping region cup\n"),
    ):  # fmt: skip
        found[f"LAMMPS, {name}"] = peer("LAMMPS", head(planes, True) + law + more + tail(planes), folder, n)
    law = f"{fixed}pair_style gran model {model}\npair_coeff * *\n"
    sides = (("x", 0.0), ("x", width), ("y", 0.0), ("y", width), ("z", 0.0))
    for name, more in (
        ("primitive planes", "".join(
            f"fix w{k} all wall/gran model {kind} primitive type 1 {axis}plane {at:.17g} {keys}\n"
            for k, (axis, at) in enumerate(sides))),
        ("mesh/surface, 10,000 triangles", "fix cup all mesh/surface file box.stl type 1\n"
         f"fix w all wall/gran model {kind} mesh n_meshes 1 meshes cup {keys}\n"),
    ):  # fmt: skip
        found[f"LIGGGHTS, {name}"] = peer(
            "LIGGGHTS", head(planes, False) + law + more + tail(planes), folder, n
        )
    return found


def main() -> None:
    """Time what was asked, and print ns a grain and step."""
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked.add_argument("what", nargs="*", choices=("flow", "box", []), default=["flow", "box"])
    asked.add_argument("--grains", type=int, default=20_000)
    asked.add_argument("--rounds", type=int, default=3)
    how = asked.parse_args()
    absent = [name for name, found in (
        ("LAMMPS", (Path(sys.prefix) / "bin" / "lmp").exists() or shutil.which("lmp")),
        ("LIGGGHTS", shutil.which("liggghts"))) if not found]  # fmt: skip
    for what in how.what:
        with tempfile.TemporaryDirectory() as name:
            runs = {"flow": flow, "box": box}[what](how.grains, Path(name))
            runs = {key: run for key, run in runs.items() if key.split(",")[0] not in absent}
            load = os.getloadavg()[0]
            times: dict[str, list[float]] = {key: [] for key in runs}
            for _ in range(how.rounds):
                for key, run in runs.items():
                    times[key].append(run())
        row: dict[str, Any] = {
            key: {"median": round(statistics.median(one), 1), "least": round(min(one), 1)}
            for key, one in times.items()
        }
        print(json.dumps({
            "what": what, "grains": how.grains, "ns a grain and step": row, "rounds": how.rounds,
            "load": [round(load, 1), round(os.getloadavg()[0], 1)], "machine": machine.describe(),
        }, indent=1))  # fmt: skip


if __name__ == "__main__":
    main()
