"""Velocity profiles and friction velocity."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import water

heights = st.floats(1e-9, 10.0)
speeds = st.floats(1e-3, 2.0)


@given(z=heights, u_star=speeds, k=st.floats(1e-4, 0.1))
def test_the_rough_law_is_eq_9_where_that_is_positive_and_zero_elsewhere(z, u_star, k):
    printed = u_star * (8.5 + 5.75 * math.log10(z / k))
    assert water.log_law_rough(z, u_star, k) == pytest.approx(max(printed, 0.0), rel=1e-12, abs=1e-15)


def test_the_rough_law_is_zero_below_a_thirtieth_of_the_roughness():
    zero = 10.0 ** (-8.5 / 5.75)
    assert 1.0 / zero == pytest.approx(30.07, abs=0.01)
    assert water.log_law_rough(0.999 * zero, 1.0, 1.0) == 0.0
    assert 0.0 < water.log_law_rough(1.001 * zero, 1.0, 1.0) < 0.01


@pytest.mark.parametrize("z", [0.0, -1e-9, -1.0, -math.inf])
def test_there_is_no_water_at_and_below_the_zero_of_a_profile(z):
    assert water.log_law_rough(z, 0.1, 0.002) == 0.0
    assert water.log_law_smooth(z, 0.1, 1e-6) == 0.0
    assert water.uniform(z, 0.5) == 0.0


@given(a=heights, b=heights, u_star=speeds)
def test_water_speed_never_decreases_with_height(a, b, u_star):
    low, high = sorted((a, b))
    assert water.log_law_rough(low, u_star, 0.002) <= water.log_law_rough(high, u_star, 0.002)
    assert water.log_law_smooth(low, u_star, 1e-6) <= water.log_law_smooth(high, u_star, 1e-6) * (1 + 1e-12)


def test_the_smooth_law_is_the_wall_law_and_both_layers_meet():
    nu, u_star = 1e-6, 0.05
    wall = nu / u_star
    assert water.log_law_smooth(5.0 * wall, u_star, nu) == pytest.approx(5.0 * u_star)
    assert water.log_law_smooth(1e3 * wall, u_star, nu) / u_star == pytest.approx(
        math.log(1e3) / 0.41 + 5.39, abs=0.01
    )
    below, above = (water.log_law_smooth(11.3 * wall * f, u_star, nu) for f in (1 - 1e-12, 1 + 1e-12))
    assert below == pytest.approx(above, rel=1e-10)


def test_the_saltation_of_the_paper_has_a_friction_velocity_of_0_0985_and_its_slope_agrees():
    u_star = water.u_star_from_tau_star(0.3, 2650.0, 1000.0, 9.8, 0.002)
    assert u_star == pytest.approx(0.0985, abs=5e-5)
    assert water.u_star_from_slope(0.02, math.atan(1 / 20), 9.8) == pytest.approx(u_star, rel=5e-3)


@given(tau_star=st.floats(1e-3, 10.0), d=st.floats(1e-4, 1.0))
def test_tau_star_and_u_star_are_inverse(tau_star, d):
    u_star = water.u_star_from_tau_star(tau_star, 2650.0, 1000.0, 9.81, d)
    assert water.tau_star_from_u_star(u_star, 2650.0, 1000.0, 9.81, d) == pytest.approx(tau_star, rel=1e-13)
