"""The discrete map of a contact against the damped oscillator in closed form."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from ryusa.laws import collision
from ryusa.laws.contact import damping
from ryusa.laws.contact_map import (
    begin_in_step,
    dashpot_of_map,
    decay_of_map,
    decay_rate,
    end_in_step,
    free_response,
    frequency_squared,
    passing,
    spring_of_map,
    time_of_release,
    velocity_of_map,
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
def test_the_map_goes_through_the_points_of_the_oscillator(zeta, phase, x, v):
    eta, a, q = oscillator(zeta)
    dt = phase / math.sqrt(K / M)
    v *= math.sqrt(K / M)
    k_d, eta_d = spring_of_map(K, eta, M, dt), dashpot_of_map(eta, M, dt)
    points = [flow(x, v, n * dt, a, q)[0] for n in range(6)]
    now, mean = points[1], (points[1] - points[0]) / dt
    for wanted in points[2:]:
        mean -= dt * (k_d * now + eta_d * mean) / M
        now += dt * mean
        assert now == pytest.approx(wanted, abs=1e-11)
    assert velocity_of_map(now, mean, dt, a, q) == pytest.approx(
        flow(x, v, 5 * dt, a, q)[1], abs=1e-9 * math.sqrt(K / M)
    )


@given(zeta=ZETA, phase=PHASE)
def test_the_oscillator_of_a_map_is_the_one_it_was_made_of(zeta, phase):
    eta, a, q = oscillator(zeta)
    dt = phase / math.sqrt(K / M)
    found = decay_of_map(dashpot_of_map(eta, M, dt), M, dt)
    assert found == pytest.approx(a, rel=1e-11, abs=1e-9)
    assert frequency_squared(K, 2.0 * found * M, M) == pytest.approx(q, abs=1e-9 * K / M)


@pytest.mark.parametrize("eta", [0.0, 5.0])
def test_small_steps_need_no_correction(eta):
    assert spring_of_map(K, eta, M, 1e-9) == pytest.approx(K, rel=1e-6)
    assert dashpot_of_map(eta, M, 1e-9) == pytest.approx(eta, rel=1e-6)


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


@given(zeta=ZETA, phase=PHASE, since=st.floats(0.01, 1.0), v=st.floats(0.1, 10.0))
def test_a_contact_that_began_within_a_step_is_then_the_oscillator_from_its_touch(zeta, phase, since, v):
    _, a, q = oscillator(zeta)
    dt = phase / math.sqrt(K / M)
    found, touch, y, rate, brake = begin_in_step(v * since * dt, v, 0.0, dt, a, q)
    assert touch == v
    assert found == pytest.approx(since * dt)
    assert (y, rate) == pytest.approx(flow(0.0, v, since * dt, a, q), rel=1e-12)
    after = v * since * dt + dt * (v - brake)
    assert after == pytest.approx(flow(0.0, v, (1.0 + since) * dt, a, q)[0], rel=1e-10)


@given(zeta=ZETA, phase=PHASE, until=st.floats(0.0, 1.0))
def test_after_its_release_a_contact_flies_on_with_its_last_velocity(zeta, phase, until):
    _, a, q = oscillator(zeta)
    dt = phase / math.sqrt(K / M)
    x, v = 1.0, -math.sqrt(K / M)
    mean, end = end_in_step(x, v, until * dt, dt, a, q)
    there, speed = flow(x, v, until * dt, a, q)
    assert end == pytest.approx(speed, rel=1e-10)
    assert x + dt * mean == pytest.approx(there + speed * (1.0 - until) * dt, abs=1e-10)


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


@given(v=st.floats(0.1, 10.0), along=st.floats(0.0, 10.0), since=st.floats(0.0, 0.01))
def test_free_grains_that_pass_each_other_touch_where_their_straight_ways_meet(v, along, since):
    reach = 1.0  # it touched `since` before, at this closing speed and speed along the surface
    x, z = along * since, reach - v * since
    distance = math.hypot(x, z)
    overlap, closing = reach - distance, (v * z - along * x) / distance
    assume(overlap > 1e-12 and closing > 0.05)
    curve = passing(v * v + along * along, closing, distance)
    found, touch, *_ = begin_in_step(overlap, closing, curve, 0.01, 0.0, 0.0)
    second_order = 2.0 * (v + along) ** 3 * since**2
    assert found == pytest.approx(since, abs=second_order * since / closing + 1e-8)
    assert touch == pytest.approx(v, abs=second_order + 1e-8)
