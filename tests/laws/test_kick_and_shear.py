"""A contact over a step, as kicks and a shear, against the damped oscillator in closed form."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import collision
from ryusa.laws.contact import damping
from ryusa.laws.kick_and_shear import (
    dashpot_of_kick,
    decay_of_kick,
    decay_rate,
    free_response,
    frequency_squared,
    kick_and_shear,
    part_in_step,
    springs_of_kicks,
    time_of_release,
    touch_in_step,
)
from ryusa.laws.slip_within_step import slip_within_step

M, K = 2.0, 3.0e4
ZETA = st.one_of(st.floats(0.0, 0.98), st.floats(1.02, 3.0), st.just(1.0))
PHASE = st.floats(0.01, 0.7)  # of the natural frequency in a step: 4.5 steps per contact and more


def oscillator(zeta):
    """Dashpot, decay rate and squared frequency."""
    eta = damping(zeta, K, M)
    return eta, decay_rate(eta, M), frequency_squared(K, eta, M)


def flow(x, v, t, a, q):
    """Displacement and velocity after time t."""
    g, h = free_response(t, a, q)
    return x * (h + 2.0 * a * g) + v * g, v * h - (a * a + q) * x * g


@given(zeta=ZETA, t=st.floats(0.0, 0.05))
def test_the_free_response_solves_the_equation_of_motion(zeta, t):
    eta, a, q = oscillator(zeta)
    step = 1.0e-6
    before, now, after = (free_response(t + s, a, q)[1] for s in (-step, 0.0, step))
    g = free_response(t, a, q)[0]
    assert (after - before) / (2.0 * step) == pytest.approx(
        -(K * g + eta * now) / M, abs=3e-3 * math.sqrt(K / M)
    )


@given(zeta=ZETA, phase=PHASE, x=st.floats(-1.0, 1.0), v=st.floats(-1.0, 1.0))
def test_kicks_and_shears_go_through_the_points_of_the_oscillator(zeta, phase, x, v):
    eta, a, q = oscillator(zeta)
    dt = phase / math.sqrt(K / M)
    v *= math.sqrt(K / M)
    eta_d = dashpot_of_kick(eta, M, dt)
    k_d, way, after, stored, k_step = springs_of_kicks(K, eta_d, M, dt)
    _, same, before, left = kick_and_shear(dt, a, q)
    assert (left, after) == pytest.approx((1.0 - eta_d * dt / M, same), rel=1e-9, abs=1e-9)
    assert (k_d, stored) == pytest.approx((M * (after + before) / dt, K + M * after * before), rel=1e-9)
    now, u, force = x, v - after * x, -k_d * x  # the spring kept as a place, and as a force
    for n in range(1, 6):
        now, u = now + way * u, left * u
        force -= k_step * dt * u
        wanted = flow(x, v, n * dt, a, q)
        assert (now, force) == pytest.approx((wanted[0], -k_d * wanted[0]), rel=1e-9, abs=1e-9 * K)
        assert left * u - before * now == pytest.approx(wanted[1], abs=1e-9 * math.sqrt(K / M))
        u -= dt * (k_d * now + eta_d * u) / M


@given(zeta=ZETA, phase=PHASE)
def test_the_oscillator_of_a_kick_is_the_one_it_was_made_of(zeta, phase):
    eta, a, q = oscillator(zeta)
    dt = phase / math.sqrt(K / M)
    found = decay_of_kick(dashpot_of_kick(eta, M, dt), M, dt)
    assert found == pytest.approx(a, rel=1e-11, abs=1e-9)
    assert frequency_squared(K, 2.0 * found * M, M) == pytest.approx(q, abs=1e-9 * K / M)


@pytest.mark.parametrize("eta", [0.0, 5.0])
def test_small_steps_need_no_correction(eta):
    eta_d = dashpot_of_kick(eta, M, 1e-6)
    assert 2.0 * eta_d == pytest.approx(eta, rel=1e-5)
    k_d, way, _, stored, k_step = springs_of_kicks(K, eta_d, M, 1e-6)
    assert (k_d, stored, k_step) == pytest.approx((K, K, K), rel=1e-5)
    assert way == pytest.approx(1e-6, rel=1e-5)


@pytest.mark.parametrize("tension", [False, True])
@pytest.mark.parametrize("e", [0.05, 0.2, 0.5, 0.9, 1.0])
def test_a_contact_lasts_and_returns_as_collision_says(e, tension):
    zeta = collision.zeta_for_restitution(e, tension)
    _, a, q = oscillator(zeta)
    until = time_of_release(0.0, 1.0, a, q, True) if tension else time_of_release(1e-12, 1.0, a, q, False)
    assert until == pytest.approx(collision.contact_time(zeta, math.sqrt(K / M), tension), rel=1e-8)
    assert -flow(0.0, 1.0, until, a, q)[1] == pytest.approx(e, rel=1e-8)


def test_a_force_that_has_ended_ends_at_once_and_one_that_never_ends_is_not_ended():
    _, a, q = oscillator(2.0)
    assert time_of_release(-1.0, 0.0, a, q, True) == 0.0
    assert time_of_release(1.0, -1e6, a, q, False) == 0.0
    assert time_of_release(1.0, 0.0, a, q, True) == math.inf


@given(zeta=ZETA, phase=PHASE, wait=st.floats(0.0, 1.0), v=st.floats(0.1, 10.0))
def test_a_contact_that_begins_within_a_step_is_then_the_oscillator_from_its_touch(zeta, phase, wait, v):
    _, a, q = oscillator(zeta)
    dt = phase / math.sqrt(K / M)
    since, y, rate = touch_in_step(-v * wait * dt, v, dt, a, q)
    assert since == pytest.approx((1.0 - wait) * dt, abs=1e-12 * dt)
    assert (y, rate) == pytest.approx(flow(0.0, v, since, a, q), rel=1e-12)


def test_a_force_that_comes_back_goes_on_from_the_overlap_that_there_is():
    _, a, q = oscillator(0.2)
    assert touch_in_step(0.1, 0.5, 1e-3, a, q) == pytest.approx(
        (1e-3, *flow(0.1, 0.5, 1e-3, a, q)), rel=1e-12
    )


@given(zeta=ZETA, phase=PHASE, until=st.floats(0.0, 1.0))
def test_after_its_release_a_contact_flies_on_with_its_last_velocity(zeta, phase, until):
    _, a, q = oscillator(zeta)
    dt = phase / math.sqrt(K / M)
    x, v = 1.0, -math.sqrt(K / M)
    y, end = part_in_step(x, v, until * dt, dt, a, q)
    there, speed = flow(x, v, until * dt, a, q)
    assert end == pytest.approx(speed, rel=1e-10)
    assert y == pytest.approx(there + speed * (1.0 - until) * dt, abs=1e-10)


SLIP = {"spring": (False, False, False), "dropped": (False, True, False), "together": (True, False, True)}


@pytest.mark.parametrize("rules", SLIP.values(), ids=SLIP)
@pytest.mark.parametrize("s_0", [0.05, 0.4, 2.0])
def test_slip_within_a_step_converges_on_many_short_steps(rules, s_0):
    """From touch through an eighth of a contact: sticking, or sliding that stops, or sliding throughout."""
    _, a, q = oscillator(0.12)
    span, m_t, k_s, eta_s, mu = 0.125 * math.pi / math.sqrt(K / M), 2.0 * M / 7.0, 2.0 * K / 7.0, 20.0, 0.4

    def integrate(parts):
        answer, y, rate, way = (0.0, 0.0, 0.0, s_0, 0.0, 0.0), 0.0, 1.0, 0.0
        for _ in range(parts):
            *answer, dx, _, _, _ = slip_within_step(
                span / parts, y, rate, a, q, M, *answer, k_s, eta_s, m_t, 0.0, mu, *rules
            )
            way += dx
            y, rate = flow(y, rate, span / parts, a, q)
        return np.array([answer[0], answer[3], way])

    fine = integrate(1000)
    assert integrate(1) == pytest.approx(fine, rel=1.5e-2)
    assert integrate(8) == pytest.approx(fine, rel=1.0e-3)


def test_slip_that_sticks_in_space_is_that_in_a_plane_turned():
    _, a, q = oscillator(0.12)
    rest = (2e3, 5.0, 0.5, 0.0, 0.3, False, False, False)
    flat = slip_within_step(1e-3, 1e-3, 0.0, a, q, M, 0.5, 0.0, 0.0, 0.2, 0.0, 0.0, *rest)
    turned = slip_within_step(1e-3, 1e-3, 0.0, a, q, M, 0.3, 0.0, 0.4, 0.12, 0.0, 0.16, *rest)
    assert turned[0:9:3] == pytest.approx([0.6 * x for x in flat[0:9:3]])
    assert turned[2:9:3] == pytest.approx([0.8 * x for x in flat[0:9:3]])
