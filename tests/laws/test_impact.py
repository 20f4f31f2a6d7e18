"""One grain hits a fixed one, stepped by hand: the damped oscillator, and why not forward Euler."""

import math

import numpy as np
import pytest

from ryusa.laws import collision, motion
from ryusa.laws.contact import damping_in_steps, normal_force, normal_force_no_tension

PHASES = (np.arange(24) + 0.5) / 24  # where in a step the first touch falls
ASKED = [0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.98]


def hit(zeta, tension, n_steps, phase, scheme=motion.semi_implicit, correct=True):
    """Impact at speed 1 with m = k_n = 1: restitution got, duration of the force over the closed form."""
    force = normal_force if tension else normal_force_no_tension
    expected = collision.contact_time(zeta, 1.0, tension)
    dt = expected / n_steps
    eta = damping_in_steps(2.0 * zeta, 1.0, dt) if correct else 2.0 * zeta
    x, v, t = -phase * dt, 1.0, 0.0  # x is the overlap
    ended = math.nan
    while True:
        f = force(x, v, 1.0, eta) if x > 0.0 else 0.0
        before = (x if tension else f, t)
        x, v = scheme(x, v, -f, dt)
        t += dt
        now = x if tension else x + eta * v  # what passes zero when the force ends
        if t > dt and math.isnan(ended) and now <= 0.0 < before[0]:
            ended = before[1] + dt * before[0] / (before[0] - now)
        if t > dt and x <= 0.0:
            return -v, (ended - phase * dt) / expected


def hits(e, tension, n_steps, correct=True):
    """Restitution got and duration over the closed form at all phases of first touch."""
    zeta = collision.zeta_for_restitution(e, tension)
    return np.array([hit(zeta, tension, n_steps, phase, correct=correct) for phase in PHASES]).T


@pytest.mark.parametrize("tension", [True, False])
@pytest.mark.parametrize("e", ASKED)
def test_fifty_steps_per_contact_give_the_restitution_and_the_contact_time(e, tension):
    got, duration = hits(e, tension, 50)
    assert abs(got.mean() - e) < 2e-3
    assert np.abs(got - e).max() < 1.5e-2
    if e >= 0.7:
        assert abs(duration.mean() - 1.0) < 5e-3


@pytest.mark.parametrize("tension", [True, False])
@pytest.mark.parametrize("e", [0.1, 0.3, 0.5])
def test_heavily_damped_contacts_are_shorter_by_the_stiffness_that_the_lag_adds(e, tension):
    _, duration = hits(e, tension, 50)
    zeta = collision.zeta_for_restitution(e, tension)
    assert duration.mean() == pytest.approx(
        1.0 - 0.5 * zeta * collision.contact_time(zeta, 1.0, tension) / 50, abs=8e-3
    )


@pytest.mark.parametrize("tension", [True, False])
@pytest.mark.parametrize("e", [0.3, 0.5])
def test_without_correction_heavy_damping_lowers_restitution_by_the_lag_of_half_a_step(e, tension):
    # The dashpot sees the velocity of half a step before: the pair acts as if lighter by eta dt/2, which
    # shortens the contact and strengthens the decay; in all ln(e) grows by a factor 1 + zeta omega_0 dt/2.
    zeta = collision.zeta_for_restitution(e, tension)
    got, duration = hits(e, tension, 50, correct=False)
    assert got.mean() == pytest.approx(
        e ** (1.0 + 0.5 * zeta * collision.contact_time(zeta, 1.0, tension) / 50), abs=2e-3
    )
    assert np.abs(got - e).max() < 1.5e-2
    assert abs(duration.mean() - 1.0) < 2e-2


@pytest.mark.parametrize("tension", [True, False])
def test_restitution_is_first_order_in_the_step_and_within_a_thousandth_at_500(tension):
    counts = [50, 100, 200, 500]
    worst = [np.abs(hits(0.7, tension, n)[0] - 0.7).max() for n in counts]
    order = -np.polyfit(np.log(counts), np.log(worst), 1)[0]
    assert order > 0.95
    assert np.abs(hits(0.7, tension, 500)[0].mean() - 0.7) < 1e-3


def test_ten_steps_per_contact_keep_restitution_within_a_few_hundredths():
    got, _ = hits(0.7, False, 10)
    assert abs(got.mean() - 0.7) < 0.03


def test_forward_euler_adds_energy_to_every_contact():
    zeta = collision.zeta_tension(0.7)
    euler = [hit(zeta, True, 10, phase, motion.forward_euler, correct=False)[0] for phase in PHASES]
    assert np.mean(euler) > 1.0
    elastic = [hit(0.0, True, 50, phase, motion.forward_euler, correct=False)[0] for phase in PHASES]
    assert np.mean(elastic) > 1.05
    kept = [hit(0.0, True, 50, phase)[0] for phase in PHASES]
    assert np.mean(kept) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("e", ASKED)
def test_the_largest_overlap_is_that_of_the_damped_oscillator(e):
    zeta = collision.zeta_no_tension(e)
    x, v, largest, dt = 0.0, 1.0, 0.0, 4.0e-4
    while v > 0.0:
        x, v = motion.semi_implicit(x, v, -normal_force_no_tension(x, v, 1.0, 2.0 * zeta), dt)
        largest = max(largest, x)
    assert largest == pytest.approx(collision.overlap_max(1.0, 1.0, 1.0, zeta), rel=2e-3)


@pytest.mark.parametrize("zeta", [0.0, 0.1, 0.5, 1.0])
def test_a_permanent_contact_becomes_unstable_at_the_step_limit(zeta):
    def grows(factor):
        dt = factor * collision.step_limit(zeta, 1.0)
        x, v = 1.0, 0.0
        for _ in range(4000):
            x, v = motion.semi_implicit(x, v, -normal_force(x, v, 1.0, 2.0 * zeta), dt)
            if abs(x) > 1.0e6:
                return True
        return False

    assert not grows(0.99)
    assert grows(1.01)
