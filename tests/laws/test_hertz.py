"""Elastic spheres in closed form, against numbers known by hand and the fits of the literature."""

import math

import pytest

from ryusa.laws import collision, hertz


def gamma_thornton(e: float) -> float:
    """Damping ratio over the tangent stiffness, by the polynomial of Thornton, Cummins & Cleary 2013 [-]."""
    alpha = 0.0
    for h in (
        -1489.915, 6276.757, -11342.18, 11494.29, -7206.864, 2928.711, -796.4559, 146.8049, -16.41105,
        -6.918798,
    ):  # fmt: skip
        alpha = e * (h + alpha)
    return math.sqrt(1.0 / (1.0 - (1.0 + e) ** 2 * math.exp(alpha)) - 1.0)


@pytest.mark.parametrize("e", [0.1, 0.2, 0.4, 0.6, 0.8, 0.95])
def test_the_damping_without_tension_is_what_thornton_fits(e):
    # 2 gamma sqrt(m dF/dx) v, with dF/dx = 1.5 K sqrt(x), against sqrt(5) zeta sqrt(m K) x**0.25 v
    zeta = collision.zeta_no_tension(e)
    assert math.sqrt(5.0 / 6.0) * zeta == pytest.approx(gamma_thornton(e), rel=0.01, abs=1e-3)


@pytest.mark.parametrize(
    ("zeta", "tension", "factor"),
    [
        (0.0, True, 3.21807), (0.05, True, 3.27251), (0.3, True, 3.69582), (0.6, True, 4.92194),
        (0.05, False, 3.09351), (0.3, False, 2.77741), (0.6, False, 2.52967),
    ],
)  # fmt: skip
def test_contact_times_are_those_of_a_fine_integration(zeta, tension, factor):
    # the table of design/0014, from an integration at a relative tolerance of 1e-12
    assert hertz.time_factor_hertz(zeta, tension) == pytest.approx(factor, abs=6e-6)


def test_the_undamped_contact_time_is_that_of_the_gamma_function():
    whole = 1.25**-0.6 * math.gamma(0.4) * math.gamma(0.5) / math.gamma(0.9)
    assert hertz.time_factor_hertz(0.0, True) == pytest.approx(whole, rel=1e-9)
    assert hertz.contact_time_hertz(1.0, 1.0, 4.0 / 3.0, 0.0, True) == pytest.approx(2.8683, abs=1e-4)


def test_a_dashpot_that_may_pull_and_is_critical_never_lets_go():
    assert hertz.time_factor_hertz(1.0, True) == math.inf


def test_the_tangential_stiffness_is_that_of_mindlin():
    young, nu, r, x = 3.0e9, 0.3, 2.0e-3, 1.0e-6
    a = hertz.contact_radius(x, r)
    stiff = hertz.hertz_stiffness(hertz.effective_modulus(young, nu), r)
    k_s = hertz.mindlin_ratio(nu) * stiff * math.sqrt(x)
    assert k_s == pytest.approx(8.0 * hertz.effective_shear_modulus(young, nu) * a, rel=1e-12)
    k_n = hertz.normal_stiffness_hertz(x, stiff)
    assert k_n == pytest.approx(2.0 * hertz.effective_modulus(young, nu) * a, rel=1e-12)
    assert k_s / k_n == pytest.approx(2.0 * (1.0 - nu) / (2.0 - nu), rel=1e-12)


@pytest.mark.parametrize("zeta", [0.0, 0.2])
def test_the_inverses_give_back_what_went_in(zeta):
    x = hertz.overlap_max_hertz(0.3, 2.0e-5, 4.0e6, zeta)
    assert hertz.stiffness_hertz_for_overlap(x, 0.3, 2.0e-5, zeta) == pytest.approx(4.0e6, rel=1e-12)
    assert hertz.speed_for_overlap_hertz(x, 2.0e-5, 4.0e6, zeta) == pytest.approx(0.3, rel=1e-12)
    f = hertz.hertz_force(x, 4.0e6)
    assert hertz.hertz_overlap(f, 4.0e6) == pytest.approx(x, rel=1e-12)
    assert hertz.hertz_energy_of_force(f, 4.0e6) == pytest.approx(hertz.hertz_energy(x, 4.0e6), rel=1e-12)
