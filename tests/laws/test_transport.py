"""Transport rates, thresholds and dimensionless numbers."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import debris, transport, water

# tau_star: Meyer-Peter and Mueller, Wong and Parker (both), Ashida and Michiue; reference page, section (f)
TABLE = {
    0.1: (0.098, 0.045, 0.045, 0.079),
    0.2: (0.479, 0.232, 0.245, 0.570),
    0.3: (1.018, 0.498, 0.547, 1.378),
    0.5: (2.439, 1.200, 1.389, 3.699),
    1.08: (8.40, 4.15, 5.19, 14.3),
}
FORMULAE = [
    transport.q_star_meyer_peter_mueller,
    transport.q_star_wong_parker,
    transport.q_star_wong_parker_steep,
    lambda tau_star: transport.q_star_ashida_michiue(tau_star, tau_star, 0.05),
]
SAND = {"friction_angle": math.radians(38.0), "c_s": 0.3, "alpha": 0.25}
F_S = debris.collision_factor(0.3, 0.85, 0.0828, 2650.0, 1000.0) + debris.pore_factor(0.3, 0.16)


def egashira(tau_star, slope, depth):
    return transport.q_star_egashira(
        tau_star, slope, SAND["friction_angle"], SAND["c_s"], SAND["alpha"], F_S, depth
    )


@pytest.mark.parametrize("tau_star", TABLE)
def test_the_formulae_return_the_reference_table(tau_star):
    for law, value in zip(FORMULAE, TABLE[tau_star], strict=True):
        assert law(tau_star) == pytest.approx(value, rel=5e-3, abs=5e-4)


@pytest.mark.parametrize("formula", FORMULAE)
def test_transport_is_zero_below_the_threshold_and_increases_with_shear(formula):
    assert formula(0.0469) == 0.0
    rates = [formula(0.05 + 0.05 * k) for k in range(40)]
    assert rates == sorted(rates)


def test_ashida_and_michiue_without_bed_forms_is_the_short_form():
    for tau_star in (0.06, 0.2, 1.0):
        short = 17.0 * (tau_star - 0.05) * (math.sqrt(tau_star) - math.sqrt(0.05))
        assert transport.q_star_ashida_michiue(tau_star, tau_star, 0.05) == pytest.approx(short, rel=1e-12)


def test_the_effective_stress_is_the_whole_stress_without_bed_forms():
    ratio, g, d, depth, tau_star = 1.65, 9.81, 0.002, 0.05, 0.1
    u_star = math.sqrt(tau_star * ratio * g * d)
    speed = u_star * (6.0 + 2.5 * math.log(depth / (d * 1.2)))
    assert transport.tau_star_effective(speed, depth, tau_star, ratio, g, d) == pytest.approx(tau_star)
    assert transport.tau_star_effective(0.8 * speed, depth, tau_star, ratio, g, d) < tau_star


def test_frey_s_two_flume_runs_have_the_rates_of_the_reference_page():
    g = 9.81 * math.cos(math.atan(0.1))
    assert transport.q_star_from_q(1.18e-4, 1.5, g, 0.006) == pytest.approx(0.066, abs=5e-4)
    assert transport.q_star_from_q(3.45e-4, 1.5, g, 0.006) == pytest.approx(0.194, abs=5e-4)


@given(q_star=st.floats(1e-4, 10.0), d=st.floats(1e-5, 1.0))
def test_q_and_q_star_are_inverse(q_star, d):
    q = transport.q_from_q_star(q_star, 1.65, 9.81, d)
    assert transport.q_star_from_q(q, 1.65, 9.81, d) == pytest.approx(q_star, rel=1e-13)


def test_stress_and_friction_velocity_give_the_same_tau_star():
    u_star = 0.09
    assert transport.tau_star_from_stress(1000.0 * u_star**2, 2650.0, 1000.0, 9.8, 0.002) == pytest.approx(
        water.tau_star_from_u_star(u_star, 2650.0, 1000.0, 9.8, 0.002), rel=1e-13
    )


@pytest.mark.parametrize(("d", "tau_star"), [(0.0002, 0.0477), (0.001, 0.0315), (0.01, 0.0556)])
def test_the_threshold_has_its_minimum_near_a_millimetre(d, tau_star):
    number = transport.d_star(1.65, 9.81, d, 1e-6)
    assert transport.tau_star_critical(number) == pytest.approx(tau_star, abs=1e-4)


def test_the_threshold_of_coarse_grains_is_0_055():
    assert transport.tau_star_critical(1e4) == pytest.approx(0.055, abs=1e-4)


def test_egashira_s_rate_is_his_closed_form():
    tau_star, slope, depth = 0.3, math.atan(0.05), 40.0
    k_1 = 1.0 / (math.cos(slope) * (math.tan(SAND["friction_angle"]) / 1.25 - 0.05))
    layer = k_1 * tau_star / 0.3
    k_2 = math.sqrt(1.0 - layer / depth) / 0.3
    assert transport.bedload_layer(tau_star, slope, *SAND.values()) == pytest.approx(layer, rel=1e-12)
    assert egashira(tau_star, slope, depth) == pytest.approx(
        4.0 / 15.0 * k_1**2 * k_2 * tau_star**2.5 / math.sqrt(F_S), rel=1e-12
    )


def test_the_rate_of_egashira_is_the_flux_of_a_layer_with_friction_decreasing_to_its_top():
    # yield falls from the whole stress at the bed to nothing at h_s, while the stress falls to nothing at h
    tau_star, slope, depth, n = 0.3, math.atan(0.05), 40.0, 20_000
    layer = transport.bedload_layer(tau_star, slope, *SAND.values())
    dz = layer / n
    u = flux = 0.0
    for k in range(n):
        z = (k + 0.5) * dz
        left = tau_star * ((1.0 - z / depth) - (1.0 - z / layer))  # per (sigma - rho) g d
        rise = math.sqrt(left / F_S) * dz  # per sqrt(R g d)
        flux += (u + 0.5 * rise) * 0.3 * dz
        u += rise
    assert egashira(tau_star, slope, depth) == pytest.approx(flux, rel=1e-4)


def test_a_layer_that_fills_the_depth_is_no_bed_load():
    assert math.isnan(egashira(3.0, math.atan(0.05), 5.0))
    assert transport.bedload_layer(0.3, math.radians(35.0), *SAND.values()) == math.inf


def test_a_grain_that_settles_faster_has_the_larger_rouse_number():
    assert transport.rouse_number(0.16, 0.1, 0.41) == pytest.approx(3.902, abs=1e-3)
    assert transport.rouse_number(0.008, 0.1, 0.41) == pytest.approx(0.195, abs=1e-3)
