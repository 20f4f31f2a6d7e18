"""Walls whose surface runs, as belts: what they do to grains in closed form, and their work."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import D, M, bits, run
from tests.kernel_variants import full_but

from ryusa.build import WallMotion, cylinder, disc, rectangle, scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import ContactTiming, Slip
from ryusa.model import Term
from ryusa.model.contact_law import elastic_spheres
from ryusa.model.tally import LOSSES
from ryusa.model.walls import WORK, surface_velocity

R, G, K, U = 0.5 * D, 9.80665, 1e4, 0.2
ABOVE = 1e-9  # [m] first distance from the belt, so that the contact begins within the run
LAWS = ("exact", "at steps", "Hertz")


def of_law(law, mu=0.5, e=0.6):
    """Arguments of `scene` for a contact law."""
    if law == "Hertz":
        return {"contact": elastic_spheres(M, R, youngs_modulus=1e8, speed=0.3, friction=mu, restitution=e)}
    timing = ContactTiming.EXACT if law == "exact" else ContactTiming.AT_STEPS
    return {"friction": mu, "restitution": e, "timing": timing, "stiffness": K, "slip": Slip.TOTAL}


def floor(tilt=0.0, **motion):
    """A square of 2 m, as x rises tilted by an angle about y [rad]."""
    c, s = math.cos(tilt), math.sin(tilt)
    made = rectangle("belt", (-c, -1, -s), (2 * c, 0, 2 * s), (0, 2, 0))
    return replace(made, motion=WallMotion(**motion))


def belt(speed=U, tilt=0.0, **motion):
    along = (speed * math.cos(tilt), 0.0, speed * math.sin(tilt))
    return floor(tilt, surface_velocity=along, **motion)


def put_on(wall, law, x=(0.0, 0.0, R + ABOVE), mu=0.5, **more):
    return scene([x], D, walls=[wall], **of_law(law, mu), allow_overlap=True, **more)


def lost(tally):
    """Energy that contacts have taken out of a run [J]."""
    return sum(tally.terms[term] for term in LOSSES)


def after(made, seconds):
    """Engine after a time, and the time that its whole steps are [s]."""
    steps = round(seconds / made[0].dt)
    return run(made, steps), steps * made[0].dt


@pytest.mark.full
@pytest.mark.parametrize("mu", [0.2, 0.6])
@pytest.mark.parametrize("law", LAWS)
def test_a_grain_that_cannot_turn_is_taken_along_with_mu_g_until_it_has_the_speed_of_the_belt(law, mu):
    made, until = put_on(belt(), law, mu=mu, rotation=False), U / (mu * G)
    engine, t = after(made, 0.6 * until)
    assert engine.state().v[0, 0] == pytest.approx(mu * G * t, rel=2e-3)
    engine, t = after(made, 2.0 * until)
    state, tally = engine.state(), engine.tally()
    assert state.v[0] == pytest.approx([U, 0.0, 0.0], rel=1e-3, abs=1e-5)
    assert state.x[0, 0] == pytest.approx(U * t - 0.5 * U * until, rel=2e-3)
    # half of the work of the belt is motion of the grain, half is lost
    assert tally.terms[Term.WALL] == pytest.approx(M * U**2, rel=2e-3)
    assert lost(tally) == pytest.approx(0.5 * M * U**2, rel=2e-3)
    assert tally.residual < 1e-3


@pytest.mark.parametrize("law", full_but(["exact"], LAWS))
def test_a_ball_put_on_a_belt_ends_at_two_sevenths_of_its_speed_and_rolls(law):
    """Its angular momentum about a point of the belt stays 0, and at last nothing slips."""
    made = put_on(belt(), law)
    engine, _ = after(made, 0.1)
    state, tally = engine.state(), engine.tally()
    v, spin = state.v[0, 0], state.omega[0, 1]
    assert v == pytest.approx(2.0 / 7.0 * U, rel=2e-3)
    assert v - spin * R == pytest.approx(U, rel=1e-3)
    assert tally.terms[Term.WALL] == pytest.approx(U * M * v, rel=1e-3)  # speed times impulse
    motion = 0.5 * M * v**2 + 0.2 * M * R**2 * spin**2
    assert tally.terms[Term.WALL] == pytest.approx(motion + lost(tally), rel=1e-3)
    assert tally.residual < 1e-3
    assert tally.walls[WORK] == pytest.approx(tally.terms[Term.WALL], rel=1e-12)


def grains_over(wall, law, seconds=0.04):
    """A handful of grains that spin and fall on a wall; they do not meet, which would enlarge round-off."""
    rng = np.random.default_rng(4)
    x = np.stack(np.meshgrid(np.arange(3), np.arange(3), indexing="ij"), axis=-1).reshape(-1, 2)
    x = np.column_stack([20 * D * x, rng.uniform(0.5, 0.7, len(x)) * D])
    v, omega = rng.normal(0, 0.05, x.shape), rng.normal(0, 20.0, x.shape)
    return after(scene(x, D, v=v, omega=omega, walls=[wall], **of_law(law)), seconds)[0]


@pytest.mark.parametrize("law", full_but(["exact"], LAWS))
def test_a_belt_does_what_a_wall_that_moves_with_its_speed_does(law):
    velocity = (0.3, -0.1, 0.0)
    one = grains_over(floor(surface_velocity=velocity), law)
    other = grains_over(floor(velocity=velocity), law)
    for name in ("x", "v", "omega"):
        a, b = getattr(one.state(), name), getattr(other.state(), name)
        assert np.allclose(a, b, rtol=1e-9, atol=1e-11), name
    assert one.tally().terms == pytest.approx(other.tally().terms, rel=1e-8, abs=1e-16)
    assert one.tally().terms[Term.WALL] > 0.0
    assert one.tally().residual < 1e-3


@pytest.mark.parametrize("law", full_but(["exact"], LAWS))
def test_a_belt_against_a_wall_that_moves_the_other_way_stands_still(law):
    one = grains_over(floor(velocity=(-0.3, 0.0, 0.0), surface_velocity=(0.3, 0.0, 0.0)), law)
    other = grains_over(floor(), law)
    assert np.allclose(one.state().v, other.state().v, rtol=1e-9, atol=1e-11)
    assert abs(one.tally().terms[Term.WALL]) < 1e-9 * one.tally().kinetic


@pytest.mark.full
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("mu", "up"), [(0.6, True), (0.3, False)])
def test_an_inclined_belt_carries_a_grain_up_if_friction_is_above_the_tangent(mu, up, law):
    tilt = math.radians(25.0)
    above = R + ABOVE
    made = put_on(belt(tilt=tilt), law, (-above * math.sin(tilt), 0.0, above * math.cos(tilt)), mu,
                  rotation=False)  # fmt: skip
    engine, t = after(made, 0.3 if up else 0.05)
    along = engine.state().v[0] @ [math.cos(tilt), 0.0, math.sin(tilt)]
    pull = G * (mu * math.cos(tilt) - math.sin(tilt))
    assert along == pytest.approx(U if up else pull * t, rel=3e-3)
    assert engine.tally().residual < 1e-3


@pytest.mark.parametrize("law", full_but(["exact"], LAWS))
def test_the_normal_contact_does_not_see_the_belt(law):
    """Flat to the last bits, on a slope to round-off; without friction nothing is moved along either."""
    for tilt in (0.0, 0.4):
        x = (-1.2 * R * math.sin(tilt), 0.0, 1.2 * R * math.cos(tilt))
        found = []
        for speed in (0.0, 3.0):
            engine, _ = after(put_on(belt(speed, tilt), law, x, mu=0.0, v=[[0.0, 0.0, -0.1]]), 0.02)
            found.append((engine.state(), engine.tally()))
        (still, _), (running, tally) = found
        assert running.v[0] == pytest.approx(still.v[0], rel=1e-10, abs=1e-12)
        assert running.x[0] == pytest.approx(still.x[0], rel=1e-10, abs=1e-13)
        assert np.abs(running.omega).max() == 0.0
        assert abs(tally.terms[Term.WALL]) < 1e-12 * tally.kinetic


def test_a_velocity_into_the_wall_counts_with_its_part_along_it():
    one = after(put_on(floor(surface_velocity=(U, 0.0, 5.0)), "exact"), 0.05)[0].state()
    other = after(put_on(belt(), "exact"), 0.05)[0].state()
    assert np.allclose(one.v, other.v, rtol=1e-9, atol=1e-12)


def test_the_surface_turns_with_its_wall():
    """So fast that a grain on the axis is always dragged along it: v_x = mu g sin(spin t)/spin."""
    spin = math.radians(90.0) / 0.02
    motion = WallMotion(spin=(0.0, 0.0, spin), surface_velocity=(50.0, 0.0, 0.0))
    made = put_on(replace(disc("table", (0, 0, 0), (0, 0, 1), 0.2), motion=motion), "exact")
    assert made[0].walls is not None
    assert surface_velocity(made[0].walls.motion[0], 0.02) == pytest.approx([0.0, 50.0, 0.0], abs=1e-12)
    engine, _ = after(made, 0.02)
    mean = 0.5 * G / spin
    assert engine.state().v[0, :2] == pytest.approx([mean, mean], rel=0.02)
    assert engine.tally().residual < 1e-3


def test_a_grain_in_a_pipe_is_taken_along_its_axis():
    pipe = cylinder("pipe", (-1, 0, 0), (2, 0, 0), 5 * D)
    pipe = replace(pipe, motion=WallMotion(surface_velocity=(U, 0.0, 0.0)))
    engine, _ = after(put_on(pipe, "exact", (0.0, 0.0, R + ABOVE - 5 * D)), 0.1)
    assert engine.state().v[0] == pytest.approx([2.0 / 7.0 * U, 0.0, 0.0], rel=2e-3, abs=1e-6)
    assert engine.tally().residual < 1e-3


def test_a_belt_keeps_its_bits_over_threads_and_a_resume():
    x = np.stack(np.meshgrid(np.arange(8), np.arange(8), [0.6, 1.7], indexing="ij"), axis=-1).reshape(-1, 3)
    made = scene(x * 1.05 * D, D, walls=[belt()], **of_law("exact"))
    one, two, first, again = run(made, 900), run(made, 900, threads=2), run(made, 411), CpuEngine()
    again.load(made[0], first.state())
    again.advance(489).raise_if_any()
    assert bits(one.state()) == bits(two.state()) == bits(again.state())
    assert one.tally() == two.tally() == again.tally()


@pytest.mark.parametrize("first", [True, False])
def test_of_a_belt_and_a_floor_in_one_plane_the_first_has_the_grain(first):
    walls = [belt(), replace(floor(), name="floor")]
    made = scene([(0.0, 0.0, R + ABOVE)], D, walls=walls if first else walls[::-1], **of_law("exact"))
    end = after(made, 0.1)[0].state().v[0, 0]
    assert end == pytest.approx(2.0 / 7.0 * U if first else 0.0, rel=2e-3, abs=1e-12)
