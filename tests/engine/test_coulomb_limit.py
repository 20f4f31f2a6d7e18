"""Coulomb's limit where no contact law is named: slopes, floors without friction, impacts."""

import math

import numpy as np
import pytest
from tests.engine.conftest import D, M, run
from tests.kernel_variants import full_but

from ryusa.build import rectangle, scene
from ryusa.laws.families import ContactTiming, Drag, Profile, Slip
from ryusa.model.contact_law import elastic_spheres
from ryusa.model.scene import Water
from ryusa.model.tally import Term

G = 9.80665
LAWS = ("exact", "at steps", "Hertz")
FLOOR = {"planes": [("floor", (0, 0, 0), (0, 0, 1))]}
SHEET = {"walls": [rectangle("sheet", (-0.5, -0.5, 0.0), (1.0, 0, 0), (0, 1.0, 0))]}


def of_law(law, mu, e=0.6):
    """Arguments of `scene` for a contact law, whose `slip` is left out."""
    if law == "Hertz":
        chosen = elastic_spheres(M, 0.5 * D, youngs_modulus=1e8, speed=0.3, friction=mu, restitution=e)
        return {"contact": chosen}
    timing = ContactTiming.EXACT if law == "exact" else ContactTiming.AT_STEPS
    return {"friction": mu, "restitution": e, "timing": timing, "stiffness": 1e4}


def at_rest(mu, law, on, **more):
    """One grain on a floor, as deep in it as its weight presses; state after 20 ms."""
    deep = 1e-9
    made = scene([[0.0, 0.0, 0.5 * D - deep]], D, **of_law(law, mu), **on, **more, allow_overlap=True)
    steps = round(0.02 / made[0].dt)
    return made[0], run(made, steps).state(), steps * made[0].dt


@pytest.mark.full
@pytest.mark.parametrize("on", [FLOOR, SHEET], ids=["plane", "wall"])
@pytest.mark.parametrize("law", full_but(["exact"], LAWS))
@pytest.mark.parametrize(("slope", "mu"), [(45, 0.3), (30, 0.1), (20, 0.0), (60, 0.9), (10, 0.3)])
def test_a_grain_that_cannot_turn_slides_as_coulomb_says(slope, mu, law, on):
    tilt = math.radians(slope)
    fixed, found, t = at_rest(mu, law, on, slope=tilt, rotation=False)
    expected = max(0.0, G * (math.sin(tilt) - mu * math.cos(tilt))) * t
    assert found.v[0, 0] == pytest.approx(expected, rel=5e-3, abs=2e-4)
    if expected and mu:  # what friction takes is booked as friction, but for what the spring holds
        spent, tally = fixed.m[0] * G * math.cos(tilt) * mu * found.x[0, 0], found.tally
        assert tally.terms[Term.SLIDE] + tally.spring_s == pytest.approx(spent, rel=2e-2)
        assert abs(tally.terms[Term.DASH_S]) < 2e-2 * spent


@pytest.mark.parametrize("law", full_but(["exact"], LAWS))
def test_a_grain_on_a_floor_without_friction_slides_and_is_not_turned(law):
    _, found, _ = at_rest(0.0, law, FLOOR, v=[[0.5, 0.0, 0.0]])
    assert found.v[0, 0] == pytest.approx(0.5, rel=1e-12)
    assert np.abs(found.omega[0]).max() == 0.0


@pytest.mark.full
@pytest.mark.parametrize("law", LAWS)
def test_a_grain_without_friction_slides_down_a_slope_under_still_water(law):
    still = Water(profile=Profile.STILL, drag=Drag.NONE)
    _, found, t = at_rest(0.0, law, FLOOR, slope=0.3, water=still)
    ratio = (2650.0 - 1000.0) / (2650.0 + 500.0)  # with half the mass of its water added
    assert found.v[0, 0] == pytest.approx(ratio * G * math.sin(0.3) * t, rel=5e-3)
    assert np.abs(found.omega[0]).max() == 0.0


@pytest.mark.parametrize("law", full_but(["exact"], LAWS))
@pytest.mark.parametrize("along", [0.5, 5.0, 30.0])
@pytest.mark.parametrize("mu", [0.0, 0.1, 0.5])
def test_the_tangential_impulse_of_an_impact_is_at_most_mu_times_the_normal_one(law, along, mu):
    made = scene(
        [[0.0, 0.0, 0.5 * D + 1e-6]], D, v=[[along, 0.0, -0.05]], gravity=0.0, steps_per_contact=50,
        **of_law(law, mu), **FLOOR,
    )  # fmt: skip
    found = run(made, 400).state()
    assert found.v[0, 2] > 0.0
    share = (along - found.v[0, 0]) / (found.v[0, 2] + 0.05)
    assert share <= mu * (1.0 + 1e-3) + 1e-12
    if mu and along >= 5.0:  # slides all the time
        assert share == pytest.approx(mu, rel=1e-3)


@pytest.mark.full
def test_the_paper_s_reading_is_still_there():
    made = scene([[0.0, 0.0, 0.5 * D - 1e-9]], D, rotation=False, slope=math.radians(45), friction=0.3,
                 restitution=0.6, slip=Slip.SPRING, allow_overlap=True, **FLOOR)  # fmt: skip
    found = run(made, round(0.02 / made[0].dt)).state()
    assert found.v[0, 0] < 0.05  # 0.097 m/s by Coulomb
