"""What walls cost: a step of a settled bed between planes, and of the same bed in a mesh, in turn.

    python benchmarks/walls.py [--grains 20000] [--faces 10000 100000] [--rounds 9] [--turning]

Grains settle in a box of five planes (a floor and four sides); then the same grains are stepped with those
planes, and with boxes of triangles in their place. The times are taken in turn; of the ratios of each box to
the planes the median and the range are printed, and the ratio of the least times, beside the share of grains
at the walls.
"""

import argparse
import math
import os
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from ryusa.build import scene
from ryusa.build.walls import WallMotion, triangles, with_walls
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import ContactTiming
from ryusa.model import Scene, State
from ryusa.model.scene import EventRule

D = 2.0e-3  # [m]
KEYS = {
    "density": 2650.0, "stiffness": 2.0e3, "shear_ratio": 0.3, "restitution": 0.5, "friction": 0.5,
    "timing": ContactTiming.AT_STEPS, "events": EventRule.NONE, "steps_per_contact": 20.0,
}  # fmt: skip


def block(n: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Centres and diameters of n grains on a lattice as wide as it is deep, and its width [m]."""
    rng = np.random.default_rng(1)
    pitch, side = 1.11 * D, round(n ** (1 / 3) * 1.1)
    high = math.ceil(n / side**2)
    cells = np.stack(np.meshgrid(np.arange(high), np.arange(side), np.arange(side), indexing="ij"), axis=-1)
    x = (cells.reshape(-1, 3)[:n, ::-1] + 0.5) * pitch + rng.uniform(-0.004, 0.004, (n, 3)) * D
    return x, D * rng.uniform(0.9, 1.1, n), side * pitch


def square(n: int, corner: np.ndarray, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Corners of 2 n**2 triangles over a parallelogram."""
    g = np.linspace(0.0, 1.0, n + 1)
    p = corner + g[:, None, None] * one + g[None, :, None] * other
    a, b, c, e = p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]
    return np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, e], axis=2)]).reshape(-1, 3, 3)


def triangles_of_box(width: float, high: float, faces: int) -> np.ndarray:
    """Corners of the triangles of a box without a lid, about `faces` of them."""
    n = max(round(math.sqrt(faces / 10.0)), 1)
    o, x, y, z = np.zeros(3), *(np.eye(3) * np.array([width, width, high]))
    return np.concatenate(
        [square(n, *one) for one in ((o, x, y), (o, x, z), (o, y, z), (x, y, z), (y, x, z))]
    )


def bed(n: int, settle: int, threads: int, work: Path) -> tuple[Scene, State]:
    """A bed of n grains at rest between five planes, without its springs; kept in a file of `work`."""
    x, d, width = block(n)
    sides = [("floor", (0, 0, 0), (0, 0, 1)), ("left", (0, 0, 0), (1, 0, 0)),
             ("right", (width, 0, 0), (-1, 0, 0)),
             ("front", (0, 0, 0), (0, 1, 0)), ("back", (0, width, 0), (0, -1, 0))]  # fmt: skip
    made, first = scene(x, d, planes=sides, **KEYS)
    kept = work / f"box-{n}-{settle}.npz"
    if not kept.exists():
        engine = loaded(made, first, threads)
        engine.advance(settle).raise_if_any()
        now = engine.state()
        work.mkdir(parents=True, exist_ok=True)
        np.savez(kept, x=now.x, v=now.v, omega=now.omega)
    with np.load(kept) as file:
        return made, State(**{name: file[name] for name in file.files}, step=0, t=0.0)


def in_a_box(planes: Scene, faces: int, turning: bool) -> tuple[Scene, float, float]:
    """The scene with a box of triangles in place of its planes, and the width and height of that [m].

    Turning, it does so about the vertical axis through its middle, by next to nothing.
    """
    x, d, width = block(planes.n_grain)
    high = 1.5 * (float(x[:, 2].max()) + D)
    bare, _ = scene(x, d, **KEYS)
    bare = replace(bare, world_low=planes.world_low, world_high=planes.world_high)
    motion = WallMotion(spin=(0.0, 0.0, 1e-6 if turning else 0.0), axis_point=(width / 2, width / 2, 0.0))
    made = with_walls(bare, [triangles("box", triangles_of_box(width, high, faces), motion)])
    return made, width, high


def timed(engine: CpuEngine, steps: int) -> float:
    """Processor seconds of so many steps, which other load changes less than those of the clock."""
    begin = time.process_time()
    engine.advance(steps).raise_if_any()
    return time.process_time() - begin


def loaded(made: Scene, state: State, threads: int) -> CpuEngine:
    """An engine with a scene and a state, its kernels compiled."""
    engine = CpuEngine(threads)
    engine.load(made, state)
    engine.advance(20).raise_if_any()
    return engine


def main() -> None:
    """Print the cost of walls."""
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name, value in (
        ("grains", 20_000),
        ("rounds", 9),
        ("steps", 200),
        ("settle", 40_000),
        ("threads", 1),
    ):
        asked.add_argument(f"--{name}", type=int, default=value)
    asked.add_argument("--faces", type=int, nargs="+", default=[10_000, 100_000], help="of each box")
    asked.add_argument("--turning", action="store_true")
    asked.add_argument("--work", type=Path, default=Path("build/benchmarks"), help="where the bed is kept")
    how = asked.parse_args()
    planes, rest = bed(how.grains, how.settle, how.threads, how.work)
    boxes = [in_a_box(planes, faces, how.turning) for faces in how.faces]
    at, d, width = rest.x, planes.d, boxes[0][1]
    near = np.minimum.reduce([at[:, 2], at[:, 0], at[:, 1], width - at[:, 0], width - at[:, 1]]) < 0.51 * d
    engines = [loaded(made, rest, how.threads) for made in (planes, *(box[0] for box in boxes))]
    for engine in engines:
        timed(engine, how.steps)
    times = np.array([[timed(engine, how.steps) for engine in engines] for _ in range(how.rounds)])
    ratios, least = times[:, 1:] / times[:, :1], times.min(axis=0)
    turning = ", turning" if how.turning else ""
    print(
        f"{how.grains} grains, {near.mean():.0%} at the walls{turning}; {how.rounds} rounds, load "
        f"{os.getloadavg()[0]:.1f}; planes: least {1e6 * least[0] / how.steps:.0f} us a step"
    )
    for k, (made, _, _) in enumerate(boxes):
        assert made.walls is not None
        print(
            f"{made.walls.n_face} triangles: {np.median(ratios[:, k]):.3f} of the time with planes "
            f"({ratios[:, k].min():.3f} to {ratios[:, k].max():.3f}), least over least "
            f"{least[k + 1] / least[0]:.3f}"
        )


if __name__ == "__main__":
    main()
