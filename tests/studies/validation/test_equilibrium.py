"""How debris flows are judged, from runs made up in closed form."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.build import scene
from ryusa.laws.debris import equilibrium_concentration
from ryusa.model import EVENT
from ryusa.study import Level, Outcome, Plan
from ryusa_studies.validation import equilibrium

D, RHO = 4.0e-3, 2650.0
COLUMNS, LAYERS = 4, 10
PLAN = Plan(Level.STANDARD, (1, 2, 3))


@pytest.fixture
def run():
    """A block of cubic layers of grains; speeds [m/s] of the layers, shape (n_frame, LAYERS)."""

    def build(speeds, gravity, water=None, interval=0.01):
        a, b, c = (g.ravel() for g in np.meshgrid(*map(np.arange, (COLUMNS, COLUMNS, LAYERS)), indexing="ij"))
        x = (np.column_stack([a, b, c]) + 0.5) * D
        fixed, _ = scene(
            x, D, density=RHO, period=(COLUMNS * D, COLUMNS * D), plane_case=False, stiffness=1000.0,
        )  # fmt: skip
        fixed = replace(fixed, gravity=np.array(gravity))
        speeds = np.asarray(speeds)
        v = np.zeros((len(speeds), len(x), 3))
        v[:, :, 0] = speeds[:, c]
        t = interval * np.arange(len(speeds))
        return SimpleNamespace(
            case={"record": {"settle": 0.0}},
            frames=SimpleNamespace(t=t, x=np.broadcast_to(x, v.shape), v=v, omega=0.0 * v),
            contacts=np.zeros(0, EVENT), scene=fixed, scene_at=lambda _: fixed, tally={}, water=water,
        )  # fmt: skip

    return build


def test_friction_is_what_stops_the_grains_that_move(run):
    down, into, friction, still = 3.0, 9.0, 0.5, 4
    t = 0.01 * np.arange(60)
    moving = np.maximum(1.0 - (friction * into - down) * t, 0.0)  # the upper layers as a block
    speeds = np.where(np.arange(LAYERS) < still, 0.0, moving[:, None])
    found = equilibrium.stopping(run(speeds, [down, 0.0, -into]))
    assert found["friction"] == pytest.approx(friction, rel=1e-6)


def test_the_concentration_of_a_flow_is_that_between_bed_and_surface(run):
    z = (np.arange(200) + 0.5) * 0.1 * D
    speed = np.maximum(np.arange(LAYERS) - 4.0, 0.0)  # the bed ends in the fifth layer
    surface, u_top = 12.0 * D, 10.0
    water = SimpleNamespace(
        t=0.01 * np.arange(20), z=z, faces=0.1 * D * np.arange(201), u=np.full((20, 200), u_top),
        tau=np.zeros((20, 201)), z_surface=np.full(20, surface),
    )  # fmt: skip
    gravity = [1.0, 0.0, -9.0]
    found = equilibrium.flowing(run(np.tile(speed, (20, 1)), gravity, water))
    bed = found["bed"] * D
    assert 4.5 * D < bed < 5.5 * D
    above = (math.pi / 6.0) * (10.0 * D - bed)  # nearly: cubic layers
    assert found["c"] == pytest.approx(above / (surface - bed), rel=0.1)
    solid = found["c"] * found["depth"]
    mu = (1000.0 * found["depth"] + 1650.0 * solid) / (9.0 * 1650.0 * solid)
    assert found["mu"] == pytest.approx(mu, rel=1e-9)
    assert found["error"] == pytest.approx(0.0, abs=1e-9)
    assert found["faster"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("factor", "word"), [(1.0, Outcome.HOLDS), (2.0, Outcome.FAILS)])
def test_concentrations_are_compared_with_the_friction_of_the_dry_flow(factor, word):
    friction = 0.55
    found: dict = {}
    for one in equilibrium.tasks(PLAN):
        if one.case == "friction_angle":
            found[one] = {"friction": friction, "time": 0.5}
            continue
        slope = math.radians(float(one.get("motion.slope_angle").split()[0]))
        c = factor * equilibrium_concentration(slope, math.atan(friction), RHO, 1000.0)
        found[one] = {
            "slope": slope, "c": c, "error": 0.01, "c_tenth": c, "faster": 0.0, "depth": 10.0, "speed": 1.0,
            "water": 0.01, "mu": friction, "densest": 0.6, "bed": 5.0,
            "z": np.arange(1.0, 10.0), "u": np.ones(9),
        }  # fmt: skip
    made, velocity = equilibrium.judge(found, PLAN)
    assert made.trials[0].found.value == pytest.approx(factor - 1.0, abs=1e-9)
    assert made.outcome is word
    assert velocity.outcome is Outcome.SHOWN


def judged(scatter, bias=0.0):
    """The finding for flows whose concentrations scatter, and whose dry flows scatter, about the formula."""
    rng = np.random.default_rng(7)
    found: dict = {}
    for one in equilibrium.tasks(PLAN):
        if one.case == "friction_angle":
            found[one] = {"friction": 0.55 + 0.1 * scatter * rng.normal(), "time": 0.5}
            continue
        slope = math.radians(float(one.get("motion.slope_angle").split()[0]))
        c = equilibrium_concentration(slope, math.atan(0.55), RHO, 1000.0)
        c *= 1.0 + bias + scatter * rng.normal()
        found[one] = {
            "slope": slope, "c": c, "error": 0.01, "c_tenth": c, "faster": 0.0, "depth": 10.0, "speed": 1.0,
            "water": 0.01, "mu": 0.55, "densest": 0.6, "bed": 5.0,
            "z": np.arange(1.0, 10.0 + rng.integers(2)), "u": np.ones(9),
        }  # fmt: skip
        found[one]["u"] = np.ones(len(found[one]["z"]))
    return equilibrium.judge(found, PLAN)[0]


@pytest.mark.parametrize(
    ("scatter", "bias", "word"),
    [(0.03, 0.1, Outcome.HOLDS), (0.03, 0.25, Outcome.UNDECIDED), (0.3, 0.1, Outcome.UNDECIDED)],
)
def test_a_limit_within_the_scatter_between_runs_decides_nothing(scatter, bias, word):
    assert judged(scatter, bias).outcome is word


def test_nothing_is_run_at_the_quick_level():
    assert not equilibrium.tasks(Plan(Level.QUICK, (1,)))
    assert not equilibrium.judge({}, Plan(Level.QUICK, (1,)))
