"""What clumps cost: a step of settled clumps of three, and of as many settled spheres, in turn.

    python benchmarks/clumps.py [--spheres 20000] [--rounds 5] [--shape rod] [--threads 1]

Both fall and settle on a floor, periodic on all sides, with contacts that begin and end at steps and the same
steps per contact of their own. The times of the two are taken in turn, and the median of their ratio is
printed: spheres over clumps, so that 1 is as fast.
"""

import argparse
import math
import statistics
import time

import numpy as np

from ryusa.build import scene
from ryusa.build.clumps import random_orientations, with_clumps
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import ContactTiming
from ryusa.model import Scene, State
from ryusa.model.clump import SHAPES, shape
from ryusa.model.scene import EventRule

D, DEEP, FALL = 2.0e-3, 12, 0.25  # diameter [m], grains above each other at first, time to settle [s]


def block(n: int, form: str | None) -> tuple[Scene, State]:
    """About n grains in layers above a floor, each a clump where there is a form."""
    rng = np.random.default_rng(1)
    pitch = 1.02 * D * (shape(form).extent if form else 1.0)
    side = max(round(math.sqrt(n / DEEP)), 4)
    cells = np.stack(np.meshgrid(np.arange(side), np.arange(side), np.arange(DEEP), indexing="ij"), axis=-1)
    x = (cells.reshape(-1, 3) + np.array([0.0, 0.0, 0.6])) * pitch
    made = scene(
        x=x, d=D * rng.uniform(0.9, 1.0, len(x)), v=rng.normal(0.0, 0.1, x.shape), restitution=0.5,
        planes=[("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))], period=(side * pitch, side * pitch),
        timing=ContactTiming.AT_STEPS, events=EventRule.NONE, steps_per_contact=20.0,
    )  # fmt: skip
    if form is None:
        return made
    return with_clumps(*made, [shape(form)], orientation=random_orientations(len(x), rng))


def timed(engine: CpuEngine, steps: int) -> float:
    """Seconds of so many steps."""
    begin = time.perf_counter()
    engine.advance(steps).raise_if_any()
    return time.perf_counter() - begin


def main() -> None:
    """Print the cost of clumps."""
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name, value in (("spheres", 20_000), ("rounds", 5), ("steps", 500), ("threads", 1)):
        asked.add_argument(f"--{name}", type=int, default=value)
    asked.add_argument("--shape", choices=[one for one in SHAPES if one != "sphere"], default="rod")
    given = asked.parse_args()
    each = len(SHAPES[given.shape][1])
    engines: list[tuple[str, CpuEngine, int]] = []
    for name, n, form in (("spheres", given.spheres, None), ("clumps", given.spheres // each, given.shape)):
        fixed, state = block(n, form)
        engine = CpuEngine(given.threads)
        engine.load(fixed, state)
        engine.advance(round(FALL / fixed.dt)).raise_if_any()
        contacts = engine.tally().n_contact / fixed.n_grain
        print(f"{name}: {fixed.n_grain} spheres, {contacts:.2f} contacts each", flush=True)
        engines.append((name, engine, fixed.n_grain))
    ratios: list[float] = []
    for _ in range(given.rounds):
        cost = {name: timed(engine, given.steps) / given.steps / n for name, engine, n in engines}
        ratios.append(cost["spheres"] / cost["clumps"])
        shown = ", ".join(f"{name} {1e9 * one:.1f} ns" for name, one in cost.items())
        print(f"a sphere and step: {shown}; ratio {ratios[-1]:.3f}", flush=True)
    print(f"median of {given.rounds}: clumps do {statistics.median(ratios):.3f} of the steps of spheres")


if __name__ == "__main__":
    main()
