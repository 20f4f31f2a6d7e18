"""Eq. (13) and the variants the field uses."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import motion, rolling
from ryusa.laws.reduced import reduced

radii = st.floats(1e-4, 10.0)
sizes = st.just(0.0) | st.floats(1e-9, 1e3)
signed = sizes | sizes.map(lambda size: -size)


@given(r=radii, part=st.floats(1e-6, 0.5))
def test_the_contact_width_of_equal_grains_is_eq_13(r, part):
    overlap = part * r
    printed = 2.0 * math.sqrt(r * r - (r - overlap / 2) ** 2)
    assert rolling.rolling_arm_width(r, r, overlap) == pytest.approx(printed, rel=1e-8)


@given(r_i=radii, r_j=radii, part=st.floats(1e-3, 0.5))
def test_the_contact_width_is_the_circle_both_spheres_share(r_i, r_j, part):
    overlap = part * min(r_i, r_j)
    half = 0.5 * rolling.rolling_arm_width(r_i, r_j, overlap)
    distance = r_i + r_j - overlap
    # legs to the circle from the two centres add up to the distance
    assert math.sqrt(r_i**2 - half**2) + math.sqrt(r_j**2 - half**2) == pytest.approx(distance, rel=1e-9)
    assert half == 0.5 * rolling.rolling_arm_width(r_j, r_i, overlap)


@given(r=radii, part=st.floats(1e-6, 0.5))
def test_a_plane_is_the_limit_of_a_large_partner(r, part):
    overlap = part * r
    plane = rolling.rolling_arm_width(r, math.inf, overlap)
    assert plane == pytest.approx(2.0 * math.sqrt(overlap * (2.0 * r - overlap)), rel=1e-12)
    assert rolling.rolling_arm_width(r, 1e12 * r, overlap) == pytest.approx(plane, rel=1e-9)
    assert rolling.rolling_arm_width(math.inf, r, overlap) == plane


@pytest.mark.parametrize("overlap", [0.0, -1e-6])
def test_the_contact_width_is_zero_without_overlap(overlap):
    assert rolling.rolling_arm_width(0.001, 0.001, overlap) == 0.0
    assert rolling.rolling_arm_width(0.001, math.inf, overlap) == 0.0


@given(a=radii, b=radii)
def test_reduced_values_are_symmetric_and_equal_the_finite_one_if_the_other_is_infinite(a, b):
    assert reduced(a, b) == reduced(b, a) == rolling.reduced_radius(a, b)
    assert reduced(a, b) == pytest.approx(a * b / (a + b), rel=1e-14)
    assert reduced(a, math.inf) == reduced(math.inf, a) == a


def test_eq_13_as_printed_needs_compression():
    assert rolling.rolling_printed(2.0, 1e-4) == 2e-4
    assert rolling.rolling_printed(-2.0, 1e-4) == 0.0


@given(cap=sizes, spin=signed, inertia=st.floats(1e-9, 1.0), dt=st.floats(1e-7, 1e-2))
def test_the_constant_torque_stops_a_spin_but_never_reverses_it(cap, spin, inertia, dt):
    size = rolling.rolling_constant(cap, spin, inertia, dt)
    assert 0.0 <= size <= cap
    after = abs(spin) - motion.acceleration_spin(size, 1.0 / inertia) * dt
    assert -1e-12 * abs(spin) <= after <= abs(spin)


@given(spring=signed, cap=sizes)
def test_the_slider_limits_the_rolling_spring_to_its_cap(spring, cap):
    scale = rolling.slider_scale(abs(spring), cap)
    assert 0.0 <= scale <= 1.0
    assert abs(scale * spring) <= cap * (1.0 + 1e-12)
    if abs(spring) <= cap:
        assert scale == 1.0


@given(spin=signed, eta_r=sizes)
def test_the_rolling_dashpot_only_takes_energy_and_is_off_while_sliding(spin, eta_r):
    assert rolling.epsd_torque(0.0, spin, eta_r, 1.0) * spin <= 0.0
    assert rolling.epsd_torque(-1.0, spin, eta_r, 0.99) == -1.0


def test_the_rolling_stiffness_is_that_of_ai_2011():
    k_n, mu_r, r = 1e4, 0.1, 0.0005
    assert rolling.epsd_stiffness(k_n, mu_r * r, 2.25) == pytest.approx(2.25 * k_n * mu_r**2 * r**2)


def test_the_rolling_spring_and_dashpot_damp_a_rocking_grain():
    inertia, k_r, cap, dt = 1.0, 1.0, 1e9, 0.01
    eta_r = rolling.epsd_damping(k_r, inertia, 0.3)
    spin, spring, swing = 1.0, 0.0, []
    for _ in range(round(2 * math.pi / math.sqrt(1 - 0.09) / dt)):  # one damped period
        spring = rolling.epsd_spring(spring, spin, k_r, dt)
        scale = rolling.slider_scale(abs(spring), cap)
        spring *= scale
        spin += rolling.epsd_torque(spring, spin, eta_r, scale) / inertia * dt
        swing.append(spin)
    assert swing[-1] == pytest.approx(math.exp(-0.3 * 2 * math.pi / math.sqrt(1 - 0.09)), abs=0.01)
    assert min(swing) < 0.0


def test_a_grain_about_its_contact_point_has_seven_fifths_of_m_r_squared():
    m, r = 3.0, 0.5
    inertia = motion.inertia_sphere(m, 2 * r)
    fixed = rolling.inertia_rolling(m, r, inertia, math.inf, math.inf, math.inf)
    assert fixed == pytest.approx(1.4 * m * r * r)
    assert rolling.inertia_rolling(m, r, inertia, m, r, inertia) == pytest.approx(fixed / 2)


def test_a_rolling_sphere_stops_after_the_distance_of_the_closed_form():
    # Constant torque f N on a rolling sphere (no slip) slows it by (5/7) mu_r g; stop distance v**2/(2 a).
    m, r, g, mu_r, dt = 1.0, 0.01, 9.8, 0.05, 1e-5
    about = rolling.inertia_rolling(m, r, motion.inertia_sphere(m, 2 * r), math.inf, math.inf, math.inf)
    cap = rolling.rolling_printed(m * g, mu_r * rolling.reduced_radius(r, math.inf))
    x, spin = 0.0, 0.5 / r
    while spin > 0.0:
        spin -= rolling.rolling_constant(cap, spin, about, dt) / about * dt
        x += spin * r * dt
    assert x == pytest.approx(0.25 / (2.0 * 5.0 / 7.0 * mu_r * g), rel=1e-3)
    assert spin == 0.0


def fastest(k_r, eta_r, inertia, partners, dt, steps=4000):
    """Amplitude that is left of the fastest motion of a packing, by the scheme itself."""
    spin, spring = 1.0, 0.0
    for _ in range(steps):
        spring = rolling.epsd_spring(spring, 2.0 * spin, k_r, dt)
        torque = partners * rolling.epsd_torque(spring, 2.0 * spin, eta_r, 1.0)
        spin += torque / inertia * dt
        if abs(spin) > 1e6:
            break
    return abs(spin)


@pytest.mark.parametrize("zeta", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("partners", [1, 4, 6])
def test_beyond_the_step_of_the_rolling_springs_a_packing_trembles_for_ever(zeta, partners):
    k_r, inertia = 3.0, 0.25
    eta_r = rolling.epsd_damping(k_r, 3.5 * inertia, zeta)
    limit = rolling.epsd_step(k_r, eta_r, inertia, partners)
    assert fastest(k_r, eta_r, inertia, partners, 0.99 * limit) < 1e-3
    assert fastest(k_r, eta_r, inertia, partners, 1.01 * limit) > 1e3
