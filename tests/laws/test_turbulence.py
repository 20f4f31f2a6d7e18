"""Mixing lengths, walls and friction factors."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import side_walls, turbulence, water

KAPPA = 0.41
heights = st.floats(1e-6, 0.1)


@given(z=heights)
def test_the_parabolic_length_gives_the_log_law_under_a_linear_stress(z):
    depth, u_star = 0.1, 0.05
    length = turbulence.length_parabolic(z, depth, KAPPA)
    shear = u_star / (KAPPA * z)
    assert length**2 * shear**2 == pytest.approx(u_star**2 * (1.0 - z / depth), rel=1e-9, abs=1e-18)


@pytest.mark.parametrize("z", [0.0, -0.01])
def test_the_mixing_length_is_zero_at_and_below_a_wall(z):
    assert turbulence.length_prandtl(z, KAPPA) == 0.0
    assert turbulence.length_parabolic(z, 0.1, KAPPA) == 0.0
    assert turbulence.length_van_driest(z, 0.05, 1e-6, KAPPA) == 0.0


def test_the_mixing_length_is_zero_above_the_surface():
    assert turbulence.length_parabolic(0.1, 0.1, KAPPA) == 0.0
    assert turbulence.length_parabolic(0.2, 0.1, KAPPA) == 0.0


@given(z=heights, u_star=st.floats(1e-3, 0.5))
def test_van_driest_is_below_prandtl_and_approaches_it_far_from_the_wall(z, u_star):
    damped = turbulence.length_van_driest(z, u_star, 1e-6, KAPPA)
    free = turbulence.length_prandtl(z, KAPPA)
    assert 0.0 <= damped <= free
    if z * u_star / 1e-6 > 1000.0:
        assert damped == pytest.approx(free, rel=1e-15)


def test_the_length_of_li_and_sawamoto_is_prandtls_in_clear_water_and_constant_in_a_bed():
    layers = [turbulence.length_growth_li_sawamoto(0.0, 0.6, 0.001, KAPPA) for _ in range(10)]
    assert sum(layers) == pytest.approx(turbulence.length_prandtl(0.01, KAPPA))
    assert turbulence.length_growth_li_sawamoto(0.6, 0.6, 0.001, KAPPA) == 0.0
    assert turbulence.length_growth_li_sawamoto(0.7, 0.6, 0.001, KAPPA) == 0.0


@pytest.mark.parametrize(("c", "f_f"), [(0.1, 0.623), (0.3, 0.197), (0.5, 0.080)])
def test_the_pore_length_gives_the_stress_of_egashira(c, f_f):
    assert turbulence.length_pore_egashira(c, 1.0, 0.16) ** 2 == pytest.approx(f_f, abs=6e-4)


@given(z=st.floats(1e-5, 0.1), u_star=st.floats(1e-3, 1.0))
def test_the_friction_velocity_of_a_smooth_wall_inverts_the_two_layer_law(z, u_star):
    speed = water.log_law_smooth(z, u_star, 1e-6)
    assert turbulence.u_star_smooth(speed, z, 1e-6) == pytest.approx(u_star, rel=1e-12)
    assert turbulence.u_star_smooth(-speed, z, 1e-6) == turbulence.u_star_smooth(speed, z, 1e-6)


@given(z=st.floats(1e-3, 0.1), u_star=st.floats(1e-3, 1.0))
def test_the_stress_of_a_rough_wall_inverts_eq_9(z, u_star):
    speed = water.log_law_rough(z, u_star, 0.002)
    assert turbulence.wall_rough(speed, z, 0.002)[0] == pytest.approx(u_star**2, rel=1e-12)


@given(u=st.floats(-2.0, 2.0).filter(lambda u: abs(u) > 1e-3), z=st.floats(1e-3, 1e-2))
def test_wall_stress_has_the_sign_of_the_speed_and_its_slope_is_the_derivative(u, z):
    for wall in (
        lambda v: turbulence.wall_smooth(v, z, 1e-6),
        lambda v: turbulence.wall_rough(v, z, 0.002),
    ):
        stress, slope = wall(u)
        assert math.copysign(1.0, stress) == math.copysign(1.0, u)
        step = 1e-5 * abs(u)
        numeric = (wall(u + step)[0] - wall(u - step)[0]) / (2.0 * step)
        z_plus = z * math.sqrt(abs(stress)) / 1e-6
        if abs(z_plus - 11.3) > 0.01:  # the joint of the two layers
            assert slope == pytest.approx(numeric, rel=1e-6)


def test_the_mean_of_eq_9_over_the_depth_is_its_integral():
    depth, u_star, k = 0.02, 0.0985, 0.002
    n = 200_000
    mean = sum(water.log_law_rough((i + 0.5) / n * depth, u_star, k) for i in range(n)) / n
    assert turbulence.speed_mean_rough(depth, u_star, k) == pytest.approx(mean, rel=1e-5)
    assert turbulence.speed_mean_rough(0.00005, u_star, k) == 0.0


@given(low=st.floats(1e-6, 1.0), ratio=st.floats(1.0, 10.0))
def test_the_gradient_of_the_log_law_equals_its_mean_between_two_heights(low, ratio):
    at = turbulence.height_between(low, low * ratio)
    assert low * (1.0 - 1e-12) <= at <= low * ratio * (1.0 + 1e-12)


@given(re=st.floats(3e3, 1e7))
def test_karman_prandtl_satisfies_its_equation_and_is_near_blasius(re):
    f = side_walls.friction_karman_prandtl(re)
    assert 1.0 / math.sqrt(f) == pytest.approx(2.0 * math.log10(re * math.sqrt(f)) - 0.8, rel=1e-12)
    if re < 1e5:
        assert side_walls.friction_blasius(re) == pytest.approx(f, rel=0.04)


def test_the_friction_factors_are_those_of_the_table():
    table = {4e3: 0.0399, 1e4: 0.0309, 1e5: 0.0180, 1e6: 0.0116, 1e7: 0.0081, 1e8: 0.0059}
    for re, f in table.items():
        assert side_walls.friction_karman_prandtl(re) == pytest.approx(f, abs=6e-5)


@given(u=st.floats(-2.0, 2.0))
def test_side_walls_slow_the_water_down(u):
    assert side_walls.side_wall_drag(u, 0.03, 0.0065) * u <= 0.0
