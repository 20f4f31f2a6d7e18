"""A grain meets every face in time, whatever list of pairs it is found in."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.engine.conftest import bits, split_square

from ryusa.build import scene
from ryusa.build.servo import Servo
from ryusa.build.walls import SolidWall, WallMotion, cylinder, disc, rectangle, triangles, with_walls
from ryusa.engine.cpu import prune_schedule as K
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import ContactTiming
from ryusa.model import Scene, State
from ryusa.model.servo import motion_with
from ryusa.model.walls import N_IMPULSE, TOUCHED

pytestmark = pytest.mark.full

D = 2.0e-3
LAW = {"timing": ContactTiming.AT_STEPS, "steps_per_contact": 20.0, "stiffness": 2.0e3}


def moving(wall: SolidWall, **motion: Any) -> SolidWall:
    return replace(wall, motion=WallMotion(**motion))


def gas(
    number: tuple[int, int, int],
    pitch: float,
    speed: float,
    walls: list[SolidWall],
    z: float = 0.0,
    **more: Any,
) -> Any:
    """Grains on a lattice round a point of the z axis with random velocities, between walls."""
    x = np.stack(np.meshgrid(*(np.arange(n) - 0.5 * (n - 1) for n in number), indexing="ij"), axis=-1)
    x = x.reshape(-1, 3) * pitch + [0.0, 0.0, z]
    v = np.random.default_rng(2).normal(0.0, speed, x.shape)
    made, state = scene(x=x, d=D, v=v, **LAW, **more)
    return replace(with_walls(made, walls), world_low=(-1.0,) * 3, world_high=(1.0,) * 3), state


def follow(
    made: tuple[Scene, State], steps: int, change: Callable[[int, CpuEngine], None] | None = None
) -> None:
    """Hold the bits of a run to those of one that lists pairs anew in every step."""
    one, other = CpuEngine(), CpuEngine()
    for engine in (one, other):
        engine.load(*made)
    for step in range(steps):
        other._candidates.schedule[K.APPROACH] = np.inf
        for engine in (one, other):
            if change is not None:
                change(step, engine)
            engine.advance(1).raise_if_any()
        if step % 100 == 0:
            assert bits(one.state()) == bits(other.state()), step
    assert bits(one.state()) == bits(other.state())
    assert one.tally() == other.tally()
    assert (np.array(one.tally().walls).reshape(-1, N_IMPULSE)[:, TOUCHED] > 0.0).all()


def test_grains_that_fall_into_a_drum_on_meshes_that_turn() -> None:
    a = 4.0 * D
    walls = [
        moving(cylinder("round", (0, 0, -a), (0, 0, 8 * D), 3.5 * D), spin=(0, 0, 6.0)),
        triangles("fine", split_square(60, 12 * D, z=-a)),
        moving(triangles("tilted", split_square(40, 8 * D, 0.3, -a)), spin=(0, 0, 3.0)),
    ]
    follow(gas((4, 4, 5), 1.02 * D, 0.3, walls), 2500)


def test_fast_grains_that_hit_each_other_between_walls_that_move() -> None:
    """A paddle, a lid that swings and one that a servo drives at will, as fast as they may be."""
    a = 4.0 * D
    sides = split_square(8, 2 * a, z=-a)
    walls = [triangles(f"side {k}", np.roll(s * sides, k, axis=2)) for k in (1, 2) for s in (1.0, -1.0)]
    walls += [
        moving(triangles("floor", sides), amplitude=(0.0, 0.0, 0.4 * D), frequency=400.0),
        moving(rectangle("paddle", (0.5 * D, 0.0, -0.7 * a), (2.5 * D, 0, 0), (0, 0, 1.4 * a)),
               spin=(0.0, 0.0, 200.0)),
        replace(triangles("lid", -sides), servo=Servo((0, 0, -1), 1.0, 2.0 * a, force=1.0)),
    ]  # fmt: skip
    made = gas((4, 4, 4), 1.3 * D, 2.0, walls, restitution=1.0, friction=0.2, gravity=0.0)
    assert made[0].walls is not None
    none, driven = np.zeros(len(walls)), np.zeros(len(walls))
    way = {"t": 0.0, "travel": none.copy(), "speed": none.copy()}
    rng, dt = np.random.default_rng(5), made[0].dt

    def drive(step: int, engine: CpuEngine) -> None:
        if step % 37:
            return
        if way["t"] != step * dt:
            way["travel"] = way["travel"] + way["speed"] * (step * dt - way["t"])
            far = way["travel"][-1] > 0.5 * D
            driven[-1] = -1.0 if far else rng.uniform(-1.0, 1.0)
            way.update(t=step * dt, speed=driven.copy())
        engine.set_walls(motion_with(made[0].walls, way["travel"], way["speed"], way["t"]))

    follow(made, 4000, drive)


@pytest.mark.parametrize("speed", [-1.0, 0.0, 1.0])
def test_a_grain_between_two_images_of_a_face_meets_the_other_one(speed: float) -> None:
    """It leaves the rim of a disc that nearly fills the period, and soon comes to the rim on the other side.

    The disc takes no energy from it, in whose frame it is, nor gives it any, as where it is found late. Lists
    are made at other places of each path.
    """
    period, way, wind = 6.0 * D, np.array([1.0, 0.0, -0.5]), np.array([speed, 0.0, 0.0])
    plate = moving(disc("plate", (0, 0, 0), (0, 0, 1), 2.5 * D), velocity=(speed, 0.0, 0.0))
    law = {"restitution": 1.0, "friction": 0.0, "gravity": 0.0, "period": (period, math.inf)}
    for before in np.arange(1.0, 1.6, 0.05):
        x = np.array([3.0 * D, 0.0, 0.35 * D]) - before * D * way
        made, first = scene(x=[x], d=D, v=[way + wind], **LAW, **law)
        engine = CpuEngine()
        engine.load(replace(with_walls(made, [plate]), world_low=(-1.0,) * 3, world_high=(1.0,) * 3), first)
        engine.advance(round(2.5 * D / made.dt)).raise_if_any()
        v = engine.state().v[0] - wind
        # met where 1.25 s^2 - 1.35 s + 0.1225 = 0 for s diameters beyond the middle of the gap, s = 0.1: the
        # normal is (-0.8, 0.6), and turns a little while they touch
        assert v == pytest.approx([1.0 - 1.1 * 1.6, 0.0, -0.5 + 1.1 * 1.2], abs=0.06), before
        assert np.linalg.norm(v) == pytest.approx(math.sqrt(1.25), rel=2e-3)
