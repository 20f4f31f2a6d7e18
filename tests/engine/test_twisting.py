"""Twisting friction against closed forms, its energy account, bits, and what it refuses."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import D, bits, elastic_law, pile, run

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import Arm, ContactTiming, Rolling
from ryusa.model import RollingLaw, Term
from ryusa.model.scene import EventRule

FLOOR = ("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
G = 9.80665


def lying(spin, twisting, model=Rolling.NONE, **keys):
    """A grain at rest on a floor under its weight, spinning about the vertical."""
    k_n, m = 1.0e4, 2650.0 * math.pi / 6.0 * D**3
    z = 0.5 * D - m * G / k_n if "contact" not in keys else 0.5 * D
    rolling = RollingLaw(model, Arm.REDUCED_RADIUS, coefficient=0.1 if model else 0.0, twisting=twisting)
    how = {"stiffness": k_n, "restitution": 0.5, "timing": ContactTiming.AT_STEPS, **keys}
    return scene(
        x=[[0, 0, z]], d=D, omega=[[0.0, 0.0, spin]], planes=[FLOOR], rolling=rolling, allow_overlap=True,
        events=EventRule.NONE, **how,
    )  # fmt: skip


@pytest.mark.full
@pytest.mark.parametrize("model", [Rolling.NONE, Rolling.CONSTANT, Rolling.EPSD])
@pytest.mark.parametrize("spin", [20.0, -20.0])
def test_a_grain_that_spins_on_a_floor_slows_down_evenly_and_stops(model, spin):
    """Torque c N R: the spin falls by c m g R/I in a second, whatever the rolling friction."""
    made = lying(spin, 0.01, model)
    m, inertia = made[0].m[0], made[0].inertia[0]
    rate = 0.01 * m * G * 0.5 * D / inertia
    stop = 20.0 / rate
    engine = run(made, round(0.5 * stop / made[0].dt))
    t = engine.state().t
    assert engine.state().omega[0, 2] == pytest.approx(math.copysign(20.0 - rate * t, spin), rel=1e-3)
    assert np.allclose(engine.state().omega[0, :2], 0.0, atol=1e-9)
    engine.advance(round(0.7 * stop / made[0].dt)).raise_if_any()
    assert abs(engine.state().omega[0, 2]) < 1e-9
    tally = engine.tally()
    assert tally.terms[Term.ROLL] == pytest.approx(0.5 * inertia * 20.0**2, rel=1e-3)
    assert tally.residual < 1e-6


@pytest.mark.full
def test_two_grains_that_meet_head_on_share_spin_by_the_impulse_between_them():
    """While they slip about the normal the torque is c R* f: it changes both spins by c R* J/I."""
    made = scene(
        x=[[0, 0, 0], [1.001 * D, 0, 0]], d=D, omega=[[300.0, 0, 0], [0, 0, 0]],
        v=[[0.5, 0, 0], [-0.5, 0, 0]], gravity=0.0, rolling=RollingLaw(twisting=0.02), restitution=1.0,
        timing=ContactTiming.AT_STEPS, events=EventRule.NONE,
    )  # fmt: skip
    engine = run(made, 200)
    assert engine.tally().n_contact == 0
    m, inertia = made[0].m[0], made[0].inertia[0]
    change = 0.02 * 0.25 * D * m * 1.0 / inertia  # J = 2 m_e u = m u with u = 1 m/s
    assert engine.state().omega[:, 0] == pytest.approx([300.0 - change, change], rel=2e-3)
    assert engine.state().omega[:, 0].sum() == pytest.approx(300.0, rel=1e-12)
    lost = 0.5 * inertia * (300.0**2 - (300.0 - change) ** 2 - change**2)
    assert engine.tally().terms[Term.ROLL] == pytest.approx(lost, rel=2e-3)


@pytest.mark.full
@pytest.mark.parametrize("model", [Rolling.NONE, Rolling.EPSD])
@pytest.mark.parametrize("law", [{}, {"contact": elastic_law(r=0.5 * D, friction=0.4, restitution=0.5)}])
def test_a_pile_with_twisting_keeps_its_account_and_bits(model, law):
    arm = Arm.REDUCED_RADIUS
    rolling = RollingLaw(model, arm, coefficient=0.1 if model else 0.0, twisting=0.05)
    made = pile(300)
    made = (replace(made[0], rolling=rolling, **law), made[1])
    one, two = run(made, 1500), run(made, 1500, threads=2)
    assert bits(one.state()) == bits(two.state())
    first = run(made, 700)
    again = CpuEngine()
    again.load(made[0], first.state())
    again.advance(800).raise_if_any()
    assert bits(again.state()) == bits(one.state())
    assert again.tally() == one.tally()
    assert one.tally().terms[Term.ROLL] > 0.0
    assert one.tally().residual < 2e-3


def test_what_twisting_cannot_do_is_refused_by_name():
    made = lying(1.0, 0.01)[0]
    alike = replace(made, rolling=RollingLaw(Rolling.PRINTED, coefficient=0.1, twisting=0.01))
    assert "relative spin" in CpuEngine().refuses(alike)[0]
    flat = scene(x=[[0, 0, D]], d=D, plane_case=True, rolling=RollingLaw(twisting=0.01))[0]
    assert "motion in space" in CpuEngine().refuses(flat)[0]
