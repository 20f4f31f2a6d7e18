"""Debris flow: equilibrium concentration, stresses and the profile of one concentration."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import debris

SIGMA, RHO, G = 2650.0, 1000.0, 9.8
PHI = math.radians(38.0)
# slope [deg]: concentration at 38 deg; c: f_d, f_f; reference page, section (i)
EQUILIBRIUM = {10: 0.177, 12: 0.227, 14: 0.284, 15: 0.316, 16: 0.351, 18: 0.431, 20: 0.529}
FACTORS = {0.1: (0.028, 0.623), 0.3: (0.041, 0.197), 0.5: (0.048, 0.080)}
C, C_STAR, H, D = 0.3, 0.6, 0.05, 0.003
SLOPE, STATIC = math.radians(15.0), math.radians(35.0)
F = debris.collision_factor(C, 0.85, 0.0828, SIGMA, RHO) + debris.pore_factor(C, 0.16)


def velocity(z, c=C, slope=SLOPE):
    return debris.velocity_egashira(z, H, c, slope, STATIC, C_STAR, F, SIGMA, RHO, G, D)


@pytest.mark.parametrize("slope", EQUILIBRIUM)
def test_equilibrium_concentrations_return_the_reference_table(slope):
    c = debris.equilibrium_concentration(math.radians(slope), PHI, SIGMA, RHO)
    assert c == pytest.approx(EQUILIBRIUM[slope], abs=6e-4)


@given(slope=st.floats(0.01, 0.6))
def test_at_equilibrium_the_friction_of_the_grains_carries_the_weight_along_the_slope(slope):
    c = debris.equilibrium_concentration(slope, PHI, SIGMA, RHO)
    friction = (SIGMA - RHO) * c * math.cos(slope) * math.tan(PHI)
    assert friction == pytest.approx(((SIGMA - RHO) * c + RHO) * math.sin(slope), rel=1e-9)


def test_the_concentration_of_takahashi_is_at_most_nine_tenths_of_the_bed():
    for slope in (5, 10, 15):
        angle = math.radians(slope)
        assert debris.equilibrium_takahashi(angle, PHI, SIGMA, RHO, 0.6) == debris.equilibrium_concentration(
            angle, PHI, SIGMA, RHO
        )
    for slope in (22, 37, 38, 60):
        assert debris.equilibrium_takahashi(math.radians(slope), PHI, SIGMA, RHO, 0.6) == pytest.approx(0.54)
    assert debris.equilibrium_concentration(PHI, PHI, SIGMA, RHO) == math.inf


@pytest.mark.parametrize("c", FACTORS)
def test_factors_of_collisions_and_pores_return_the_reference_table(c):
    f_d, f_f = FACTORS[c]
    assert debris.collision_factor(c, 0.85, 0.0828, SIGMA, RHO) == pytest.approx(f_d, abs=5e-4)
    assert debris.pore_factor(c, 0.16) == pytest.approx(f_f, abs=5e-4)


def test_the_collision_factor_of_elastic_grains_and_the_pore_factor_without_pores_are_zero():
    assert debris.collision_factor(0.3, 1.0, 0.0828, SIGMA, RHO) == 0.0
    assert debris.pore_factor(1.0, 0.16) == 0.0


def test_enduring_contacts_carry_all_pressure_in_the_bed():
    assert debris.static_share(C_STAR, C_STAR) == 1.0
    assert debris.static_share(0.3, 0.6) == pytest.approx(0.8706, abs=1e-4)


@pytest.mark.parametrize("part", [0.01, 0.2, 0.5, 0.8, 0.99])
def test_the_profile_balances_the_stresses_at_every_height(part):
    z, dz = part * H, 1e-6 * H
    shear = (velocity(z + dz) - velocity(z - dz)) / (2.0 * dz)
    tau = ((SIGMA - RHO) * C + RHO) * G * (H - z) * math.sin(SLOPE)
    pressure = (SIGMA - RHO) * C * G * (H - z) * math.cos(SLOPE)
    rest = debris.static_share(C, C_STAR) * pressure * math.tan(STATIC)
    assert rest + RHO * F * D**2 * shear**2 == pytest.approx(tau, rel=1e-7)


def test_the_profile_is_at_rest_below_the_bed_and_keeps_its_speed_above_the_surface():
    assert velocity(0.0) == velocity(-1.0) == 0.0
    assert velocity(2.0 * H) == velocity(H)
    mean = sum(velocity((k + 0.5) / 2000 * H) for k in range(2000)) / 2000
    assert mean / velocity(H) == pytest.approx(0.6, rel=1e-5)  # three fifths of the surface's speed


def test_the_mean_speed_has_the_friction_factor_of_depth_averaged_models():
    mean = 0.6 * velocity(H)
    heavy = (SIGMA - RHO) * C
    rest = debris.static_share(C, C_STAR) * heavy * G * H * math.cos(SLOPE) * math.tan(STATIC)
    bed = (heavy + RHO) * G * H * math.sin(SLOPE)
    assert rest + RHO * 6.25 * F * (D / H) ** 2 * mean**2 == pytest.approx(bed, rel=1e-12)


def test_a_flow_that_friction_alone_can_carry_does_not_move():
    assert velocity(0.5 * H, c=0.55, slope=math.radians(12.0)) == 0.0
