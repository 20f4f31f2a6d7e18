"""Exact timing and timing at steps are one law as steps get short, whatever the rule of sliding."""

import math

import numpy as np
import pytest
from tests.engine.conftest import D, M, run

from ryusa.build import scene
from ryusa.laws import collision
from ryusa.laws.families import Cap, ContactTiming, Slip
from ryusa.model import ContactLaw
from ryusa.model.scene import Damping, EventRule

pytestmark = pytest.mark.full

K_N, K_S, ETA_N, ETA_S, MU, SPEED = 2.0e4, 1.5e3, 0.1, 0.01, 0.78, 0.3
LAST = 2000.0  # steps to the contact of the reference, at steps


def energy_left(slip, cap, timing, steps, tangent, phase):
    """Energy after two free grains met at an angle, over that before; the first step is at some phase."""
    zeta = collision.damping_ratio(ETA_N, K_N, 0.5 * M)
    dt = collision.contact_time_no_tension(zeta, collision.omega_natural(K_N, 0.5 * M)) / steps
    law = ContactLaw(
        k_n=K_N, k_s=K_S, mu=MU, damping=Damping.CONSTANTS, eta_n=ETA_N, eta_s=ETA_S, slip=slip, cap=cap,
        timing=timing,
    )  # fmt: skip
    flight = (2.0 + phase) * dt
    v = 0.5 * SPEED * np.array([[1.0, 0.0, tangent], [-1.0, 0.0, -tangent]])
    x = np.array([[0.0, 0.0, 0.0], [D, 0.0, 0.0]]) - flight * v
    made = scene(x, D, v=v, contact=law, gravity=0.0, dt=dt, events=EventRule.NONE, allow_overlap=True)
    end, fixed = run(made, math.ceil(4.0 + 1.6 * steps)).state(), made[0]
    left = np.sum(fixed.m[:, None] * end.v**2) + np.sum(fixed.inertia[:, None] * end.omega**2)
    return float(left / np.sum(fixed.m[:, None] * v**2))


@pytest.mark.parametrize("tangent", [0.5, 1.0, 4.0])
@pytest.mark.parametrize(
    ("slip", "cap", "off"),
    [
        *((slip, cap, 8e-4) for slip in (Slip.SPRING, Slip.SPRING_DROP) for cap in Cap),
        (Slip.TOTAL, Cap.TOTAL, 8e-4),
        (Slip.TOTAL, Cap.SPRING, 4e-3),  # of first order in the step
    ],
)
def test_both_timings_leave_the_same_energy(slip, cap, off, tangent):
    """At 50 exact steps; a limit taken from half of the dashpot left 0.9 % less, however short the step."""
    exact = [energy_left(slip, cap, ContactTiming.EXACT, 50.0, tangent, phase) for phase in (0.1, 0.5, 0.9)]
    assert np.mean(exact) == pytest.approx(
        energy_left(slip, cap, ContactTiming.AT_STEPS, LAST, tangent, 0.3), rel=off
    )
