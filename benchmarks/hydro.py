"""Grains under a column of water, beside the one peer that has a column: YADE's HydroForceEngine.

    python benchmarks/hydro.py                 # about four minutes
    python benchmarks/hydro.py --save          # and keep the table in benchmarks/results/

The set-up is that of YADE's own validation of its coupling: 1165 beads of 6 mm, ten layers on a bed of fixed
beads of random height, ten by ten diameters, periodic, on a slope of 0.05 under 17.5 diameters of water; drag
times (1 - phi)**-3.1, a mixing length after Li and Sawamoto, no lift, no torque of the water, no
fluctuations. ryusa lets the beads settle once; both codes read the same positions and step them with the same
springs, dashpots and friction, at the same time step, one thread each, in turns. The drag coefficient is
0.44 + 24.4/Re in YADE and 0.4 + 24/Re in ryusa. YADE solves for the water every 10 ms, as in its validation;
ryusa, by its default, every 50 steps, ten times as often. ryusa runs by `ryusa.run_scene`: energy account,
guards and run folder with frames; YADE without output. Both are timed by the time of the processor.
"""

import argparse
import datetime
import json
import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

import machine
import numpy as np
from ours import Clocked
from peer import threads_of_one

from ryusa.build import build
from ryusa.casefile import read_text
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

HERE = Path(__file__).resolve().parent
CHILD = "--child"
D, DENSITY, G, SLOPE, MU = 0.006, 2500.0, 9.81, 0.05, 0.5  # [m], [kg/m3], [m/s2], [rad], [-]
ACROSS, LAYERS, DEPTH, PHI_MAX = 10, 10.0, 17.5, 0.61  # diameters but for the last, a concentration [-]
CELLS, EVERY, WITHIN = 300, 1.0e-2, 1.0e-5  # YADE's cells, time between its solutions, and step in them [s]
STIFFNESS = (DENSITY - 1000.0) * PHI_MAX * LAYERS * D * G * D * 1.0e4  # rigid grains, as in the validation
MASS = DENSITY * math.pi / 6.0 * D**3
RESTITUTION = 0.7
DASHPOT = (
    -2.0
    * math.log(RESTITUTION)
    / math.hypot(math.pi, math.log(RESTITUTION))
    * math.sqrt(STIFFNESS * MASS / 2.0)
)
DT = 2.0e-5  # ten steps in a contact [s]
SETTLE = 25_000  # steps
WARM, STEPS = 1000, 6000  # ryusa's; YADE does half of them
YADE_SHARE = 0.5
HEAD = "x [m],y [m],z [m],d [m],fixed"
CASE = """
[grains]
diameter = "{D} m"
density = "{DENSITY} kg/m3"
[contact]
stiffness = "{STIFFNESS} N/m"
shear_stiffness = "{shear} N/m"
damping = "{DASHPOT} N s/m"
shear_damping = "0 N s/m"
friction = {MU}
slip = "spring-drop"
cap = "total"
[motion]
rotation = "free"
plane = false
gravity = "{G} m/s2"
slope_angle = "{slope} rad"
[build]
kind = "table"
file = "{file}"
allow_overlap = true
[domain]
period_x = "{side} m"
period_y = "{side} m"
{water}
[time]
step = "{DT} s"
[stop]
time = "1000 s"
[record]
events = "none"
"""
WATER = """
[water]
profile = "column"
zero = "0 m"
depth = "{depth} m"
buoyancy = "pressure"
drag = "24/Re+0.4"
hindrance = "power"
hindrance_exponent = 3.1
torque = "none"
added_mass = 0.0
[water.column]
bed = "moving"
mixing_length = "Li-Sawamoto"
packed = 0.55
"""


def scene_of(folder: Path, file: str, *, wet: bool) -> Any:
    """Scene and first state of the beads in a table."""
    keys = {
        **globals(), "file": file, "shear": 0.5 * STIFFNESS, "side": ACROSS * D,
        "slope": SLOPE if wet else 0.0, "water": WATER.format(depth=(LAYERS + DEPTH) * D) if wet else "",
    }  # fmt: skip
    return build(read_text(CASE.format(**keys), path=folder / "case.toml"))


def table(path: Path, x: np.ndarray, x_fixed: np.ndarray) -> None:
    """Write beads as a table that a case reads."""
    rows = [
        np.column_stack([one, np.full(len(one), D), np.full(len(one), kind)])
        for kind, one in ((0, x), (1, x_fixed))
    ]
    np.savetxt(path, np.vstack(rows), ["%.17g"] * 4 + ["%d"], delimiter=",", header=HEAD, comments="")


def settle(folder: Path) -> None:
    """Let the beads settle without water, and keep where they lie: beads.csv, and beads.npz for YADE."""
    rng = np.random.default_rng(0)
    n = int(LAYERS * PHI_MAX * ACROSS**2 * 6.0 / math.pi)
    row = ACROSS - 1  # loose enough to fall
    places = np.array([(k % row, k // row % row, k // row**2) for k in range(n)], dtype=float)
    x = (places * (ACROSS / row) + 0.5) * D + rng.uniform(-0.04, 0.04, (n, 3)) * D
    x[:, 2] += 1.2 * D
    base = np.array([(i, j, rng.uniform(-0.5, 0.5)) for i in range(ACROSS) for j in range(ACROSS)]) * D
    table(folder / "loose.csv", x, base)
    built = scene_of(folder, "loose.csv", wet=False)
    engine = CpuEngine(threads=1)
    engine.load(built.scene, built.state)
    engine.advance(SETTLE).raise_if_any()
    lying = np.array(engine.state().x)
    lying[:, :2] %= ACROSS * D
    table(folder / "beads.csv", lying, base)
    np.savez(folder / "beads.npz", x=lying, x_fixed=base)


def child(folder: Path) -> None:
    """One timed run of ryusa in a process of its own; prints its figures."""
    built = scene_of(folder, "beads.csv", wet=True)
    engine = Clocked(threads=1)
    engine.warm = WARM
    with tempfile.TemporaryDirectory() as work:
        results = run_scene(
            built.scene, built.state, Path(work) / "run", frames=EVERY, stop=Stop(time=(WARM + STEPS) * DT),
            progress=False, engine=engine,
        )  # fmt: skip
        loop = time.process_time() - engine.begun_cpu
        found = {"rate": 1e-6 * built.scene.n_grain * STEPS / loop, "grains": built.scene.n_grain}
        found |= {"contacts": engine.contacts[-1], "residual": results.summary["energy"]["residual"]}
        found |= {"exchanges": results.summary["water"]["exchanges"]}
    print(json.dumps(found))


def ours(folder: Path) -> dict[str, Any]:
    """Run ryusa once."""
    done = subprocess.run(
        [sys.executable, str(Path(__file__).resolve()), CHILD, str(folder)], capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    if done.returncode:
        raise SystemExit(done.stderr[-2000:])
    return json.loads(done.stdout.splitlines()[-1])


def yade(program: str, folder: Path) -> dict[str, Any]:
    """Run YADE once."""
    job = {
        "grains": str(folder / "beads.npz"), "d": D, "density": DENSITY, "g": G, "slope": SLOPE, "mu": MU,
        "k_n": STIFFNESS, "k_s": 0.5 * STIFFNESS, "eta_n": DASHPOT, "side": ACROSS * D, "dt": DT,
        "depth": (LAYERS + DEPTH) * D, "cells": CELLS, "every": EVERY, "within": WITHIN, "phi_max": PHI_MAX,
        "warm": round(YADE_SHARE * WARM), "steps": round(YADE_SHARE * STEPS),
    }  # fmt: skip
    (folder / "job.json").write_text(json.dumps(job))
    done = subprocess.run(
        [program, "-n", "-x", "-j1", str(HERE / "in_yade_hydro.py"), "job.json"], cwd=folder, check=False,
        env={k: v for k, v in threads_of_one(1).items() if not k.startswith("PYTHON")},
        capture_output=True, text=True, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    if "FOUND " not in done.stdout:
        raise SystemExit(f"YADE: {(done.stdout + done.stderr)[-2000:]}")
    found = json.loads(done.stdout.partition("FOUND ")[2].splitlines()[0])
    return found | {"rate": 1e-6 * found["grains"] * job["steps"] / found["loop"]}


def main() -> None:
    if CHILD in sys.argv:
        child(Path(sys.argv[-1]))
        return
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--save", action="store_true", help="keep the table in benchmarks/results/")
    options = parser.parse_args()
    program = shutil.which("yade")
    if program is None:
        raise SystemExit("YADE is not installed: apt-get install yade")
    rounds = []
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        settle(folder)
        ours(folder)  # compiles
        for _ in range(options.rounds):
            one = {"ryusa": ours(folder), "YADE": yade(program, folder)}
            rounds.append(one)
            print(
                f"ryusa {one['ryusa']['rate']:.2f}, YADE {one['YADE']['rate']:.3f} M particle-steps/s: "
                f"{one['ryusa']['rate'] / one['YADE']['rate']:.1f}; contacts {one['ryusa']['contacts']}, "
                f"{one['YADE']['contacts']}",
                flush=True,
            )
    ratios = sorted(one["ryusa"]["rate"] / one["YADE"]["rate"] for one in rounds)
    print(f"median {statistics.median(ratios):.1f}, least {ratios[0]:.1f}, in {len(ratios)} rounds")
    if options.save:
        kept = {
            "date": datetime.date.today().isoformat(), "machine": machine.describe(),
            "versions": {name: version(name) for name in ("ryusa", "numba", "numpy")},
            "load average": [round(a, 2) for a in os.getloadavg()], "ratio": statistics.median(ratios),
            "rounds": rounds,
        }  # fmt: skip
        file = HERE / "results" / f"hydro-{kept['date']}.json"
        file.write_text(json.dumps(kept, indent=1) + "\n")
        print(f"kept in {file.relative_to(HERE.parent)}")


if __name__ == "__main__":
    main()
