"""One grain, one step."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import motion

numbers = st.floats(-1e3, 1e3)
masses = st.floats(1e-6, 1e3)


def test_a_thrown_grain_follows_the_parabola():
    dt = 0.001
    x, v = 0.0, 1.0 + 0.5 * dt * 9.8  # v half a step before x
    for _ in range(1000):
        x, v = motion.semi_implicit(x, v, -9.8, dt)
    assert x == pytest.approx(1.0 - 4.9, abs=1e-9)


@given(x=numbers, v=numbers, dt=st.floats(1e-3, 1.0))
def test_without_force_both_schemes_move_straight_on(x, v, dt):
    there = pytest.approx((x + v * dt, v), rel=1e-13, abs=1e-12)  # a compiler may fuse multiply and add
    assert motion.semi_implicit(x, v, 0.0, dt) == there
    assert motion.forward_euler(x, v, 0.0, dt) == there


@given(x=st.floats(-1.0, 1.0), v=st.floats(-1.0, 1.0), k=st.floats(0.01, 1.0), dt=st.floats(0.01, 1.0))
def test_on_a_spring_the_scheme_conserves_its_shadow_energy_and_forward_euler_gains(x, v, k, dt):
    def shadow(x, v):
        return k * x * x + v * v - k * dt * x * v

    new = motion.semi_implicit(x, v, -k * x, dt)
    # x and v enter as a step's end: the quadratic form that symplectic Euler keeps has -k dt x v
    assert shadow(*new) == pytest.approx(shadow(x, v), rel=1e-9, abs=1e-12)
    x_euler, v_euler = motion.forward_euler(x, v, -k * x, dt)
    gained = k * x_euler * x_euler + v_euler * v_euler
    assert gained == pytest.approx((k * x * x + v * v) * (1.0 + k * dt * dt), rel=1e-9, abs=1e-12)


@given(contact=numbers, drag=numbers, weight=numbers, m=masses)
def test_forces_add_up_and_added_mass_only_slows(contact, drag, weight, m):
    dry = motion.acceleration(contact, drag, weight, 1.0 / m)
    assert dry == pytest.approx((contact + drag + weight) / m)
    wet = motion.acceleration(contact, drag, weight, 1.0 / (m + 0.5 * m))
    assert wet == pytest.approx(dry / 1.5)


def test_a_quartz_grain_released_in_water_starts_with_the_acceleration_of_eq_11():
    m = 2.65
    a = motion.acceleration(0.0, 0.0, -1.65 * 9.8, 1.0 / (m + 0.5))
    assert a == pytest.approx(-9.8 * 1.65 / 3.15)


def test_a_sphere_has_two_fifths_of_m_r_squared():
    assert motion.inertia_sphere(3.0, 0.4) == pytest.approx(0.4 * 3.0 * 0.2**2)
    assert motion.acceleration_spin(1.0, 0.25) == 0.25


def test_an_undamped_contact_lasts_half_a_period_to_second_order():
    errors = []
    for n in (50, 100):
        dt = math.pi / n
        x, v, t = 0.0, 1.0, 0.0  # no force at x = 0: v half a step before is the same
        while True:
            old = x
            x, v = motion.semi_implicit(x, v, -x, dt)
            t += dt
            if x <= 0.0:
                break
        errors.append(abs(t - dt * -x / (old - x) - math.pi))
    assert errors[0] < 1e-3
    assert errors[1] < 0.3 * errors[0]
