"""Grains in hollow edges and tips of walls, on surfaces that lie in one another, and through walls (0019)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import D, M, run
from tests.kernel_variants import full_but

from ryusa.build import WallMotion, cylinder, disc, rectangle, scene, triangles
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.errors import GrainThroughWall
from ryusa.laws.families import ContactTiming
from ryusa.model.contact_law import elastic_spheres
from ryusa.model.tally import Term

R, G, K = 0.5 * D, 9.80665, 1e4


def groove(fold, long=0.2):
    """Two faces whose normals differ by `fold` [rad], along y."""
    c, s, found = math.cos(fold / 2), math.sin(fold / 2), []
    for side in (1, -1):
        p = [
            (0, -long, 0),
            (0, long, 0),
            (side * long * c, long, long * s),
            (side * long * c, -long, long * s),
        ]
        found += [[p[0], p[1], p[2]], [p[0], p[2], p[3]]]
    return np.array(found, float)


def cone(n, half, high=0.02, hole=0.0):
    """A cone of n facets that stands on its tip, or round a hole of this radius."""
    wide = high * math.tan(half)
    turn = [(math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n)) for k in range(n)]
    top = [(wide * c, wide * s, high) for c, s in turn]
    if not hole:
        return np.array([[(0, 0, 0), top[k], top[(k + 1) % n]] for k in range(n)], float)
    low = [(hole * c, hole * s, hole / math.tan(half)) for c, s in turn]
    pairs = [(k, (k + 1) % n) for k in range(n)]
    return np.array([one for a, b in pairs for one in ((low[a], top[a], top[b]), (low[a], top[b], low[b]))])


def pipe(n, radius, long=0.01):
    """A pipe of n facets, upright, open at both ends: its mouth is at z = 0."""
    turn = [
        (radius * math.cos(2 * math.pi * k / n), radius * math.sin(2 * math.pi * k / n)) for k in range(n)
    ]
    found = []
    for (a, b), (c, d) in zip(turn, [*turn[1:], turn[0]], strict=True):
        found += [[(a, b, 0), (c, d, 0), (a, b, -long)], [(c, d, 0), (c, d, -long), (a, b, -long)]]
    return np.array(found, float)


def speeds(made, seconds):
    found = run(made, round(seconds / made[0].dt)).state()
    return float(np.abs(found.v).max()), float(np.abs(found.omega).max()), found.x[0]


SHAPES = {
    "cone of 8": (cone(8, math.radians(40)), 1.7e-3),
    "cone of 24": (cone(24, math.radians(40)), 1.63e-3),
    "cone of 96": (cone(96, math.radians(40)), 1.61e-3),
    "flat cone of 24": (cone(24, math.radians(70)), 1.1e-3),
    "steep cone of 16": (cone(16, math.radians(20)), 3.0e-3),
    "hopper of 24": (cone(24, math.radians(40), hole=0.6e-3), 1.64e-3),
    "outlet of 24": (cone(24, math.radians(40), hole=0.8e-3), 1.65e-3),
    "pipe of 12": (pipe(12, 0.8e-3), 0.72e-3),
    "pipe of 48": (pipe(48, 0.6e-3), 0.85e-3),
    "pipe of 5": (pipe(5, 0.9e-3), 0.72e-3),
}


@pytest.mark.parametrize("timing", full_but([ContactTiming.EXACT], list(ContactTiming)))
@pytest.mark.parametrize("shape", full_but(["cone of 8", "cone of 24", "pipe of 12"], SHAPES))
def test_a_grain_comes_to_rest_in_a_tip_and_on_a_mouth(shape, timing):
    mesh, z = SHAPES[shape]
    made = scene(
        [[1e-6, 2e-6, z]],
        D,
        walls=[triangles("cone", mesh)],
        stiffness=K,
        restitution=0.5,
        friction=0.5,
        timing=timing,
        steps_per_contact=20 if timing is ContactTiming.EXACT else 50,
        allow_overlap=True,
    )
    speed, spin, x = speeds(made, 0.3 if "flat" in shape else 0.15)
    assert speed < 1e-6 and spin < 1e-3
    assert abs(x[0]) < 1e-6 and abs(x[1]) < 1e-6


def energies(mesh, x, v, steps=12_000, **law):
    made = scene(
        [x],
        D,
        v=[v],
        walls=[triangles("m", mesh)],
        friction=0.0,
        restitution=1.0,
        timing=ContactTiming.AT_STEPS,
        steps_per_contact=50,
        stiffness=K,
        **law,
    )
    engine, found = CpuEngine(), []
    engine.load(*made)
    for _ in range(steps // 50):
        engine.advance(50).raise_if_any()
        tally = engine.tally()
        found.append(tally.kinetic + tally.spin + tally.potential + tally.spring_n + tally.spring_s)
    return (np.array(found) - found[0]) / (M * G * 1e-3 + 0.5 * M * float(np.dot(v, v)))


FOLDS = (2, 4, 7, 11, 16, 25, 40, 50, 90, 130)


@pytest.mark.full
@pytest.mark.parametrize("fold", FOLDS)
def test_a_hollow_edge_gives_no_energy_and_takes_none(fold):
    a = math.radians(fold)
    above = R / math.cos(a / 2)
    for x, v in (
        ((0.0, 0.0, above + 5e-4), (0.0, 0.0, -0.1)),
        ((2e-4, 0.0, above + 2e-4 * math.tan(a / 2) + 5e-4), (0.02, 0.01, -0.1)),
        ((-3e-3, 0.0, above + 3e-3 * math.tan(a / 2) + 3e-4), (0.3, 0.0, 0.0)),
    ):
        assert np.abs(energies(groove(a), x, v)).max() < 5e-3


@pytest.mark.full
@pytest.mark.parametrize("n", [8, 24, 96])
def test_a_tip_gives_no_energy_and_takes_none(n):
    for half in (20, 40, 70):
        mesh = cone(n, math.radians(half))
        high = R / math.sin(math.atan(math.tan(math.radians(half)) * math.cos(math.pi / n))) + 9e-4
        assert np.abs(energies(mesh, (1e-4, 2e-4, high), (0.0, 0.0, 0.0))).max() < 1e-2


@pytest.mark.parametrize("n", full_but([96], [24, 96, 200]))
@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_grain_that_meets_many_facets_at_once_is_not_stopped_many_times_over(n, friction):
    """With their whole force each, 96 facets gave what the account had as energy of the step."""
    half = math.radians(40)
    high = R / math.sin(math.atan(math.tan(half) * math.cos(math.pi / n))) + 5e-5
    made = scene([[1e-6, 2e-6, high]], D, walls=[triangles("m", cone(n, half))], stiffness=K, restitution=0.5,
                 friction=friction)  # fmt: skip
    engine = CpuEngine()
    engine.load(*made)
    for _ in range(40):
        engine.advance(20).raise_if_any()
        assert abs(engine.tally().terms[Term.STEP]) < 0.3 * M * G * 5e-5


@pytest.mark.full
def test_the_force_in_a_hollow_is_continuous_in_the_place_of_the_grain():
    """From one face of a fold to the other, so deep that both are touched over much of the way."""
    for fold in (3.0, 8.0, 20.0, 60.0):
        a, found = math.radians(fold), []
        deep = 0.02 * R
        for x in np.linspace(-0.12 * R, 0.12 * R, 481):
            z = (R - deep) / math.cos(a / 2) + abs(x) * math.tan(a / 2)
            made = scene(
                [[x, 0.0, z]],
                D,
                walls=[triangles("m", groove(a))],
                stiffness=K,
                restitution=1.0,
                gravity=0.0,
                friction=0.0,
                timing=ContactTiming.AT_STEPS,
                allow_overlap=True,
            )
            dt = made[0].dt
            engine = CpuEngine()
            engine.load(*made)
            engine.advance(1).raise_if_any()
            found.append(engine.state().v[0] * M / dt / (K * deep))
        jumps = np.linalg.norm(np.diff(found, axis=0), axis=1)
        assert jumps.max() < 0.06


FLAT = rectangle("sheet", (-0.05, -0.05, 0.0), (0.1, 0, 0), (0, 0.1, 0))
FLOOR = ("floor", (0, 0, 0), (0, 0, 1))


def box(low, high):
    """A closed plate as a mesh."""
    (x, y, z), (u, v, w) = low, high
    p = [(a, b, c) for a in (x, u) for b in (y, v) for c in (z, w)]
    sides = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    return np.array([[p[k] for k in one] for a, b, c, d in sides for one in ((a, b, c), (a, c, d))], float)


ONE_IN_ANOTHER = {
    "plane and sheet": {"planes": [FLOOR], "walls": [FLAT]},
    "sheet and plane a little above": {"planes": [("floor", (0, 0, 5e-8), (0, 0, 1))], "walls": [FLAT]},
    "plane and disc": {"planes": [FLOOR], "walls": [disc("lid", (0, 0, 0), (0, 0, 1), 0.05)]},
    "sheet and disc": {"walls": [FLAT, disc("lid", (0, 0, 0), (0, 0, 1), 0.05)]},
    "mesh twice": {"walls": [triangles("m", np.concatenate([groove(0.0)] * 2))]},
    "thin plate": {"walls": [triangles("m", box((-0.05, -0.05, -1e-4), (0.05, 0.05, 0.0)))]},
    "plate of a tenth": {"walls": [triangles("m", box((-0.05, -0.05, -2e-4), (0.05, 0.05, 0.0)))]},
    "sheets close together": {
        "walls": [FLAT, rectangle("other", (-0.05, -0.05, -2e-5), (0.1, 0, 0), (0, 0.1, 0))]
    },
    "plane behind a sheet": {"planes": [("floor", (0, 0, -2e-5), (0, 0, 1))], "walls": [FLAT]},
    "sheet behind a plane": {
        "planes": [FLOOR],
        "walls": [rectangle("low", (-0.05, -0.05, -2e-5), (0.1, 0, 0), (0, 0.1, 0))],
    },
}


@pytest.mark.parametrize("kind", ONE_IN_ANOTHER)
@pytest.mark.parametrize("law", full_but(["exact"], ["exact", "at steps", "Hertz"]))
def test_one_surface_counts_once(kind, law):
    more = {"restitution": 0.7, "friction": 0.3, "stiffness": K, "timing": ContactTiming.AT_STEPS}
    if law == "Hertz":
        more = {"contact": elastic_spheres(M, R, youngs_modulus=1e8, speed=0.3, restitution=0.7)}
    elif law == "exact":
        more["timing"] = ContactTiming.EXACT
    made = scene(
        [[1e-3, 2e-3, R + 1e-4]],
        D,
        v=[[0, 0, -0.3]],
        gravity=0.0,
        steps_per_contact=50,
        **more,
        **ONE_IN_ANOTHER[kind],
    )
    found = run(made, round(1.5e-3 / made[0].dt)).state()
    assert found.v[0, 2] == pytest.approx(0.21, rel=0.01)


def test_a_belt_on_a_floor_drags_the_grain_that_lies_on_it():
    belt = replace(
        rectangle("belt", (-0.5, -0.05, 0.0), (1.0, 0, 0), (0, 0.1, 0)), motion=WallMotion((0.1, 0, 0))
    )
    made = scene([[0, 0, R]], D, planes=[FLOOR], walls=[belt], friction=0.3, restitution=0.5)
    found = run(made, round(0.1 / made[0].dt)).state()
    # friction turns it backwards until the point of contact goes with the belt: v = 2/7 of its speed
    assert found.v[0, 0] == pytest.approx(0.1 * 2 / 7, rel=5e-3)
    assert found.v[0, 0] - R * found.omega[0, 1] == pytest.approx(0.1, rel=5e-3)
    lies = run(scene([[0, 0, R]], D, planes=[FLOOR], friction=0.3, restitution=0.5), 1000).state()
    assert lies.v[0, 0] == 0.0


SOFT, FAST = 10.0, 1.2  # r sqrt(k/m) is 0.95 m/s
WAYS = {
    "rectangle": ({"walls": [FLAT]}, (1e-3, 2e-3, 3e-3), (0, 0, -FAST)),
    "rectangle from below": ({"walls": [FLAT]}, (1e-3, 2e-3, -3e-3), (0.3, 0, FAST)),
    "disc": ({"walls": [disc("d", (0, 0, 0), (0, 0, 1), 0.02)]}, (1e-3, 2e-3, 3e-3), (0, 0, -FAST)),
    "shell from within": (
        {"walls": [cylinder("c", (0, 0, -0.05), (0, 0, 0.1), 0.01)]},
        (0, 0, 0),
        (FAST, 0, 0),
    ),
    "shell from outside": (
        {"walls": [cylinder("c", (0, 0, -0.05), (0, 0, 0.1), 0.01)]},
        (0.02, 0, 0),
        (-FAST, 0, 0),
    ),
    "mesh": ({"walls": [triangles("m", groove(0.5))]}, (3e-3, 0, 3e-3), (0, 0, -FAST)),
    "edge of a mesh": ({"walls": [triangles("m", groove(0.02))]}, (0, 0, 3e-3), (0, 0, -FAST)),
    "thin plate": (
        {"walls": [triangles("m", box((-0.05, -0.05, -1e-4), (0.05, 0.05, 0.0)))]},
        (1e-3, 2e-3, 3e-3),
        (0, 0, -FAST),
    ),
    "moving wall": (
        {
            "walls": [
                replace(
                    rectangle("sheet", (-0.05, -0.05, -2e-3), (0.1, 0, 0), (0, 0.1, 0)),
                    motion=WallMotion((0, 0, FAST)),
                )
            ]
        },
        (1e-3, 2e-3, 0.0),
        (0, 0, 0),
    ),
    "turning wall": (
        {
            "walls": [
                replace(
                    rectangle("sheet", (0, -0.05, -3e-3), (0.1, 0, 0), (0, 0.1, 0)),
                    motion=WallMotion(spin=(0, -FAST / 0.05, 0)),
                )
            ]
        },
        (0.05, 2e-3, 0.0),
        (0, 0, 0),
    ),
}


@pytest.mark.parametrize("timing", full_but([ContactTiming.EXACT], list(ContactTiming)))
@pytest.mark.parametrize("way", WAYS)
def test_a_grain_that_goes_through_a_wall_stops_the_run(way, timing):
    more, x, v = WAYS[way]
    made = scene(
        [x],
        D,
        v=[v],
        stiffness=SOFT,
        restitution=1.0,
        friction=0.3,
        gravity=0.0,
        steps_per_contact=30,
        timing=timing,
        **more,
    )
    with pytest.raises(GrainThroughWall) as caught:
        run(made, round(0.02 / made[0].dt))
    said = str(caught.value)
    assert f"wall '{more['walls'][0].name}'" in said and "grain 0" in said and "step" in said
    assert "use stiffer contacts (contact.stiffness)" in said


@pytest.mark.full
@pytest.mark.parametrize("way", ["rectangle", "disc", "shell from within", "mesh", "thin plate"])
def test_a_step_too_long_for_the_speed_is_named_as_the_remedy(way):
    more, x, v = WAYS[way]
    made = scene(
        [x],
        D,
        v=[[0.97 * one for one in v]],
        stiffness=SOFT,
        restitution=1.0,
        gravity=0.0,
        dt=4.2e-4,
        timing=ContactTiming.AT_STEPS,
        **more,
    )
    with pytest.raises(GrainThroughWall, match=r"time\.steps_per_contact"):
        run(made, 40)


@pytest.mark.full
@pytest.mark.parametrize("way", [way for way in WAYS if way not in {"moving wall", "turning wall"}])
def test_a_grain_that_is_slow_enough_comes_back(way):
    more, x, v = WAYS[way]
    made = scene(
        [x],
        D,
        v=[[0.5 * one for one in v]],
        stiffness=SOFT,
        restitution=1.0,
        friction=0.0,
        gravity=0.0,
        steps_per_contact=50,
        timing=ContactTiming.AT_STEPS,
        **more,
    )
    found = run(made, round(0.03 / made[0].dt)).state()
    assert float(np.linalg.norm(found.v[0])) == pytest.approx(0.5 * float(np.linalg.norm(v)), rel=5e-3)
    assert float(np.dot(found.v[0], v)) < 0.0


def test_a_grain_rolls_past_the_rim_of_a_plate_without_a_fault():
    made = scene(
        [[-2e-3, 0, R]],
        D,
        v=[[0.05, 0, 0]],
        walls=[rectangle("p", (-0.05, -0.05, 0), (0.05, 0, 0), (0, 0.1, 0))],
        friction=0.5,
        restitution=0.5,
    )
    found = run(made, round(0.08 / made[0].dt)).state()
    assert found.x[0, 0] > 0.0 and found.x[0, 2] < 0.0
