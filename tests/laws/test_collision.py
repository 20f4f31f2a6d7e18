"""Closed forms of one contact, by hand and by property; tables of the reference page, section (c)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import collision
from ryusa.laws.contact import damping

QUARTZ = 2650.0 * math.pi / 6 * 0.002**3  # mass of a 0.2 cm quartz grain [kg]

# wanted e, zeta with tension, e got with that zeta without, zeta without tension, omega_0 T without tension
TABLE = [
    (0.1, 0.59116, 0.2527, 1.24319, 1.8522),
    (0.3, 0.35786, 0.3971, 0.49724, 2.4213),
    (0.5, 0.21545, 0.5503, 0.25528, 2.7153),
    (0.7, 0.11281, 0.7182, 0.12221, 2.9184),
    (0.9, 0.03352, 0.9020, 0.03427, 3.0749),
    (0.98, 0.00643, 0.9801, 0.00646, 3.1287),
]
restitutions = st.floats(1.0e-4, 1.0)
ratios = st.floats(0.0, 20.0)


@pytest.mark.parametrize(("k_n", "t"), [(1.0, 1.05e-2), (1.0e4, 1.05e-4)])
def test_eq_8_gives_the_times_the_paper_quotes(k_n, t):
    assert collision.collision_time(QUARTZ, k_n) == pytest.approx(t, rel=5e-3)


@pytest.mark.parametrize(("e", "zeta", "clamped", "zeta_cut", "phase_cut"), TABLE)
def test_damping_ratios_are_those_of_the_table(e, zeta, clamped, zeta_cut, phase_cut):
    assert collision.zeta_tension(e) == pytest.approx(zeta, abs=6e-6)
    assert collision.restitution_no_tension(collision.zeta_tension(e)) == pytest.approx(clamped, abs=6e-5)
    assert collision.zeta_no_tension(e) == pytest.approx(zeta_cut, abs=6e-6)
    assert collision.contact_time_no_tension(collision.zeta_no_tension(e), 1.0) == pytest.approx(
        phase_cut, abs=6e-5
    )


def test_the_constants_of_fig17_bracket_the_time_and_restitution_the_paper_quotes():
    m = 2650.0 * math.pi / 6 * 0.00218**3
    for m_eff, t, e in [(m, 8.46e-5, 0.745), (m / 2, 6.0e-5, 0.658)]:
        zeta = collision.damping_ratio(0.1, 2.0e4, m_eff)
        omega_0 = collision.omega_natural(2.0e4, m_eff)
        assert collision.contact_time_tension(zeta, omega_0) == pytest.approx(t, rel=3e-3)
        assert collision.restitution_tension(zeta) == pytest.approx(e, abs=1e-3)


@given(e=restitutions)
def test_the_damping_of_a_restitution_gives_that_restitution(e):
    assert collision.restitution_tension(collision.zeta_tension(e)) == pytest.approx(e, rel=1e-12)
    assert collision.restitution_no_tension(collision.zeta_no_tension(e)) == pytest.approx(e, rel=1e-12)


@given(zeta=st.floats(0.0, 0.999))
def test_the_three_branches_are_the_printed_ones(zeta):
    w = math.sqrt(1.0 - zeta * zeta)
    printed = math.atan2(2.0 * zeta * w, 2.0 * zeta * zeta - 1.0) / w
    assert collision.contact_time_no_tension(zeta, 1.0) == pytest.approx(printed, rel=1e-9)
    big = 1.0 / (zeta + 1.0e-3) + 0.01  # up to 1000, above 1
    s = math.sqrt(big * big - 1.0)
    assert collision.contact_time_no_tension(big, 1.0) == pytest.approx(2.0 * math.log(big + s) / s, rel=1e-9)


@given(gap=st.floats(1.0e-15, 1.0e-3))
def test_all_functions_are_continuous_at_critical_damping(gap):
    for law in (collision.phase_to_largest, collision.restitution_no_tension):
        assert law(1.0 - gap) == pytest.approx(law(1.0), rel=2.0 * gap + 1e-14)
        assert law(1.0 + gap) == pytest.approx(law(1.0), rel=2.0 * gap + 1e-14)


def test_restitution_of_heavy_damping_is_one_over_four_zeta_squared():
    assert collision.restitution_no_tension(100.0) == pytest.approx(1.0 / 4.0e4, rel=1e-2)


@given(a=ratios, b=ratios)
def test_restitution_decreases_with_damping(a, b):
    low, high = sorted((a, b))
    assert collision.restitution_no_tension(high) <= collision.restitution_no_tension(low)
    assert collision.restitution_tension(high) <= collision.restitution_tension(low)
    assert collision.restitution_tension(low) <= collision.restitution_no_tension(low) <= 1.0


@pytest.mark.parametrize("e", [0.0, -0.1, 1.1, math.nan])
def test_a_restitution_out_of_range_has_no_damping_ratio(e):
    assert math.isnan(collision.zeta_tension(e))
    assert math.isnan(collision.zeta_no_tension(e))


def test_with_tension_an_overdamped_pair_never_parts():
    assert collision.contact_time_tension(1.0, 1.0) == math.inf
    assert collision.restitution_tension(1.5) == 0.0


@given(speed=st.floats(1e-3, 10.0), k_n=st.floats(1.0, 1e6), zeta=ratios)
def test_the_stiffness_for_an_overlap_gives_that_overlap(speed, k_n, zeta):
    largest = collision.overlap_max(speed, QUARTZ, k_n, zeta)
    assert collision.stiffness_for_overlap(largest, speed, QUARTZ, zeta) == pytest.approx(k_n, rel=1e-12)
    assert largest <= speed * math.sqrt(QUARTZ / k_n)


@given(k_n=st.floats(1.0, 1e6), zeta=st.floats(0.0, 0.9))
def test_the_stiffness_for_a_time_gives_that_time(k_n, zeta):
    omega_0 = collision.omega_natural(k_n, QUARTZ)
    free = collision.contact_time_tension(zeta, omega_0)
    cut = collision.contact_time_no_tension(zeta, omega_0)
    assert cut <= free * (1.0 + 1e-12)
    assert collision.stiffness_for_time(free, QUARTZ, zeta, True) == pytest.approx(k_n, rel=1e-12)
    assert collision.stiffness_for_time(cut, QUARTZ, zeta, False) == pytest.approx(k_n, rel=1e-12)


def test_effective_masses_of_equal_spheres_and_of_a_fixed_partner():
    r, inertia, inf = 0.001, 0.4 * QUARTZ * 0.001**2, math.inf
    assert collision.effective_mass(QUARTZ, QUARTZ) == QUARTZ / 2
    assert collision.effective_mass(QUARTZ, inf) == collision.effective_mass(inf, QUARTZ) == QUARTZ
    free = collision.effective_mass_tangential(QUARTZ, r, inertia, QUARTZ, r, inertia, True)
    assert free == pytest.approx(QUARTZ / 7)
    assert collision.effective_mass_tangential(QUARTZ, r, inertia, inf, inf, inf, True) == pytest.approx(
        QUARTZ * 2 / 7
    )
    assert collision.effective_mass_tangential(QUARTZ, r, inertia, inf, r, inf, False) == pytest.approx(
        QUARTZ
    )


@given(a=st.floats(1e-9, 1e3), b=st.floats(1e-9, 1e3))
def test_the_effective_mass_is_symmetric(a, b):
    assert collision.effective_mass(a, b) == collision.effective_mass(b, a)
    assert collision.effective_mass(a, b) == pytest.approx(a * b / (a + b), rel=1e-14)


@given(zeta=st.floats(0.0, 5.0), k=st.floats(1.0, 1e6), m=st.floats(1e-9, 1.0))
def test_damping_ratio_and_dashpot_are_inverse(zeta, k, m):
    assert collision.damping_ratio(damping(zeta, k, m), k, m) == pytest.approx(zeta, rel=1e-12, abs=1e-300)


@given(zeta=ratios, k=st.floats(1.0, 1e6), tension=st.booleans())
def test_the_shortest_contact_is_the_smaller_of_damped_and_undamped(zeta, k, tension):
    omega_0 = collision.omega_natural(k, QUARTZ)
    damped = (collision.contact_time_tension if tension else collision.contact_time_no_tension)(zeta, omega_0)
    found = collision.shortest_contact(QUARTZ, k, zeta, tension)
    assert found == min(damped, collision.collision_time(QUARTZ, k))
    assert found == pytest.approx(collision.collision_time(QUARTZ, k) if tension else damped, rel=1e-12)
