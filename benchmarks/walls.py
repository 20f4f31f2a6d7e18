"""What walls cost: a step of a settled bed between planes, and of the same bed in a mesh, in turn.

    python benchmarks/walls.py [--grains 20000] [--faces 10000] [--rounds 5] [--turning]

Grains settle in a box of five planes (a floor and four sides); then the same grains are stepped with those
planes, and with a box of triangles in their place. The times of the two are taken in turn, and the median of
the ratios is printed, beside the share of grains at the walls.
"""

import argparse
import math
import statistics
import time
from dataclasses import replace

import numpy as np

from ryusa.build import scene
from ryusa.build.walls import SolidWall, WallMotion, triangles, with_walls
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


def box(width: float, high: float, faces: int, turning: bool) -> SolidWall:
    """A box of triangles; turning, about the vertical axis through its middle, by next to nothing."""
    n = max(round(math.sqrt(faces / 10.0)), 1)
    o, x, y, z = np.zeros(3), *(np.eye(3) * np.array([width, width, high]))
    corners = [square(n, *one) for one in ((o, x, y), (o, x, z), (o, y, z), (x, y, z), (y, x, z))]
    middle = (width / 2, width / 2, 0.0)
    motion = WallMotion(spin=(0.0, 0.0, 1e-6 if turning else 0.0), axis_point=middle)
    return triangles("box", np.concatenate(corners), motion)


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
        ("faces", 10_000),
        ("rounds", 5),
        ("steps", 200),
        ("settle", 40_000),
        ("threads", 1),
    ):
        asked.add_argument(f"--{name}", type=int, default=value)
    asked.add_argument("--turning", action="store_true")
    how = asked.parse_args()
    x, d, width = block(how.grains)
    high = float(x[:, 2].max()) + D
    sides = [("floor", (0, 0, 0), (0, 0, 1)), ("left", (0, 0, 0), (1, 0, 0)),
             ("right", (width, 0, 0), (-1, 0, 0)),
             ("front", (0, 0, 0), (0, 1, 0)), ("back", (0, width, 0), (0, -1, 0))]  # fmt: skip
    planes, first = scene(x, d, planes=sides, **KEYS)
    engine = loaded(planes, first, how.threads)
    engine.advance(how.settle).raise_if_any()
    rest = engine.state()
    at = rest.x
    near = np.minimum.reduce([at[:, 2], at[:, 0], at[:, 1], width - at[:, 0], width - at[:, 1]]) < 0.51 * d
    bare, _ = scene(x, d, **KEYS)
    bare = replace(bare, world_low=planes.world_low, world_high=planes.world_high)
    made = with_walls(bare, [box(width, 1.5 * high, how.faces, how.turning)])
    assert made.walls is not None
    plain = replace(rest, contacts=type(rest.contacts).none(), engine=None, tally=None, step=0)
    a, b = loaded(planes, plain, how.threads), loaded(made, plain, how.threads)
    timed(a, how.steps), timed(b, how.steps)
    ratios = []
    for _ in range(how.rounds):
        one, other = timed(a, how.steps), timed(b, how.steps)
        ratios.append(other / one)
        each = [f"{1e6 * t / how.steps:.0f} us a step" for t in (one, other)]
        print(f"planes {each[0]}, mesh {each[1]}: {ratios[-1]:.3f}")
    print(
        f"{how.grains} grains, {near.mean():.0%} at the walls, {made.walls.n_face} triangles"
        f"{', turning' if how.turning else ''}: {statistics.median(ratios):.3f} of the time with planes"
    )


if __name__ == "__main__":
    main()
