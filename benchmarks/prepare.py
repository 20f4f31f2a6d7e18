"""Settles the first grains of a workload with ryusa, once, and keeps them in a file that every code reads.

    python benchmarks/prepare.py W1 20k [--poly] --work FOLDER [--threads 2]

A bed settles level for 0.3 s. No code can take over another's springs, and grains that must find theirs anew
tremble, so the bed forgets them and rests, five times over (W2). Then it tilts to 26 deg and flows for 0.02 s
(W1). A plane column settles in a box for 0.3 s, its gate goes, and it falls half as long as its top would
fall freely to the floor (W3). Large beds are copies of a smaller one side by side; copies of a flow differ by
noise in their velocities.
"""

import argparse
import os
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import workloads
from workloads import DT, Grains, Workload

from ryusa.build import build
from ryusa.casefile import read
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.model import State

SETTLE = 60_000  # steps
RESTS, REST = 5, 8000  # times that springs are forgotten, and steps after each
FLOW = 4000
NOISE = 1.0e-3  # m/s between copies of a flowing block


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("name", choices=("W1", "W2", "W3"))
    parser.add_argument("size")
    parser.add_argument("--poly", action="store_true")
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    options = parser.parse_args()
    print(
        grains(
            workloads.workload(options.name, options.size, poly=options.poly), options.work, options.threads
        )
    )


def grains(load: Workload, work: Path, threads: int) -> Path:
    """File with the first grains of a workload, made if it is not there."""
    grid, kind = load.grid, f"{load.name}-{load.spread:g}"
    path = work / f"{kind}-{grid.block}x{grid.tiles}.npz"
    if path.exists():
        return path
    work.mkdir(parents=True, exist_ok=True)
    if load.plane:
        _column(load, threads).save(str(path))
        return path
    block = work / f"{kind}-{grid.block}x1.npz"
    if not block.exists():
        settled, flowing = _bed(load, threads)
        settled.save(str(work / f"W2-{load.spread:g}-{grid.block}x1.npz"))
        flowing.save(str(work / f"W1-{load.spread:g}-{grid.block}x1.npz"))
    if grid.tiles > 1:
        Grains.load(str(block)).tiled(grid.tiles, NOISE if load.name == "W1" else 0.0).save(str(path))
    return path


def _case(name: str, load: Workload, build_keys: dict[str, str], slope: float) -> Any:
    """A packaged case with the law of the table."""
    keys = {
        "grains.diameter": f"{workloads.D} m",
        "grains.density": f"{workloads.DENSITY} kg/m3",
        "grains.spread": f"{load.spread}",
        "contact.stiffness": f"{workloads.K_N} N/m",
        "contact.shear_stiffness": f"{workloads.K_S} N/m",
        "contact.damping": f"{workloads.ETA_N} N s/m",
        "contact.shear_damping": f"{workloads.ETA_S} N s/m",
        "contact.friction": f"{workloads.MU}",
        "contact.slip": workloads.TOTAL,
        "motion.gravity": f"{workloads.GRAVITY} m/s2",
        "motion.slope_angle": f"{slope} rad",
        "motion.rotation": "free",
        "time.step": f"{DT} s",
        "timeline": "[]",
        "stop": "{ time = '1 s' }",
        "record": "{ events = 'none' }",
    }
    path = Path(str(files("ryusa").joinpath("cases", name)))
    return read(path, keys | {f"build.{key}": value for key, value in build_keys.items()})


def _bed(load: Workload, threads: int) -> tuple[Grains, Grains]:
    """A bed at rest, and the same flowing at 26 deg."""
    block = {"columns": f"{load.grid.block}", "rows": f"{load.grid.block}", "layers": "12"}
    level = build(_case("dense_3d.toml", load, block, 0.0))
    steep = build(_case("dense_3d.toml", load, block, float(workloads.SLOPE)))
    engine = CpuEngine(threads=threads)
    engine.load(level.scene, level.state)
    engine.advance(SETTLE).raise_if_any()
    settled = engine.state()
    for _ in range(RESTS):
        settled = State.at_rest(settled.x)
        engine = CpuEngine(threads=threads)
        engine.load(level.scene, settled)
        engine.advance(REST).raise_if_any()
        settled = engine.state()
    engine.load(steep.scene, settled)
    engine.advance(FLOW).raise_if_any()
    return _kept(level.scene, settled), _kept(level.scene, engine.state())


def _column(load: Workload, threads: int) -> Grains:
    """A plane column that falls out of its box, the gate gone."""
    n = load.grid.block
    height = n * workloads.D
    keys = {
        "columns": f"{n}", "layers": f"{n}", "floor": "grains", "walls": "grains",
        "run_out": f"{5.0 * height} m", "drop": f"{height} m",
    }  # fmt: skip
    built = build(_case("box.toml", load, keys, 0.0))
    engine = CpuEngine(threads=threads)
    engine.load(built.scene, built.state)
    engine.advance(SETTLE).raise_if_any()
    free = _kept(built.scene, engine.state(), without="gate")
    scene, state = free_scene(free, workloads.TOTAL, 0.0, plane=True)
    engine = CpuEngine(threads=threads)
    engine.load(scene, state)
    engine.advance(round(0.5 * np.sqrt(2.0 * height / workloads.GRAVITY) / DT)).raise_if_any()
    return _kept(scene, engine.state())


def _kept(scene: Any, state: State, without: str | None = None) -> Grains:
    there = scene.fixed_active.copy()
    if without is not None:
        first, end = scene.groups[without]
        there[first - scene.n_grain : end - scene.n_grain] = False
    x = np.array(state.x)
    for axis, period in enumerate(scene.period):
        if np.isfinite(period):
            x[:, axis] %= period
    return Grains(
        x,
        np.array(state.v),
        np.array(state.omega),
        scene.d,
        scene.x_fixed[there],
        scene.d_fixed[there],
        scene.period,
    )


def free_scene(
    grains: Grains,
    slip: str,
    slope: float,
    *,
    plane: bool,
    dt: float = DT,
    timing: str = "at steps",
    gravity: float = workloads.GRAVITY,
) -> tuple[Any, State]:
    """Scene and first state of given grains, by the front door for scripts."""
    from ryusa.build import scene
    from ryusa.laws.families import Cap, ContactTiming, Slip
    from ryusa.model import ContactLaw
    from ryusa.model.scene import Damping, EventRule

    law = ContactLaw(
        k_n=workloads.K_N, k_s=workloads.K_S, mu=workloads.MU, damping=Damping.CONSTANTS,
        eta_n=workloads.ETA_N, eta_s=workloads.ETA_S,
        slip={workloads.TOTAL: Slip.TOTAL, workloads.DROP: Slip.SPRING_DROP}[slip], cap=Cap.TOTAL,
        timing=ContactTiming.of(timing),
    )  # fmt: skip
    return scene(
        grains.x, grains.d, density=workloads.DENSITY, v=grains.v, omega=grains.omega,
        x_fixed=grains.x_fixed, d_fixed=grains.d_fixed, contact=law, gravity=gravity, slope=slope,
        plane_case=plane, period=grains.period, dt=dt, events=EventRule.NONE, allow_overlap=True,
    )  # fmt: skip


if __name__ == "__main__":
    main()
