"""Torque of the water on a spinning grain; the reference page, section (k)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import motion, torque

D, NU, RHO = 0.002, 1e-6, 1000.0
spins = st.floats(1e-3, 1e5)


def at(re_r):
    """Spin of that rotational Reynolds number [rad/s]."""
    return re_r * NU / (D * D)


@given(spin=st.floats(0.0, 7.9))
def test_slow_spin_has_the_torque_of_stokes(spin):
    stokes = 8.0 * math.pi * RHO * NU * (D / 2) ** 3
    assert torque.torque_stokes(spin, D, NU, RHO) == pytest.approx(stokes)
    assert torque.torque_dennis(spin, D, NU, RHO) == pytest.approx(stokes)


def test_both_branches_meet_at_32():
    below, above = (torque.torque_dennis(at(re), D, NU, RHO) for re in (32.0, 32.0001))
    assert above / below == pytest.approx(6.293 / 6.283, abs=1e-3)


@given(re=st.floats(9.0, 1000.0))
def test_the_law_is_that_of_dennis_1980(re):
    r, spin = D / 2, at(4.0 * re)
    c_m = 6.45 / math.sqrt(re) + 32.1 / re  # T = (1/2) rho R**5 spin**2 C, Re = R**2 spin/nu
    assert torque.torque_dennis(spin, D, NU, RHO) * spin == pytest.approx(
        0.5 * RHO * r**5 * spin**2 * c_m, rel=1e-9
    )


@given(a=spins, b=spins)
def test_the_factor_is_even_and_grows_with_spin(a, b):
    low, high = sorted((a, b))
    assert torque.torque_dennis(-a, D, NU, RHO) == torque.torque_dennis(a, D, NU, RHO)
    assert torque.torque_dennis(low, D, NU, RHO) <= torque.torque_dennis(high, D, NU, RHO) * (1 + 1e-12)


def test_at_the_fastest_spin_of_the_paper_it_is_four_and_a_half_times_stokes():
    ratio = torque.torque_dennis(900.0, D, NU, RHO) / torque.torque_stokes(900.0, D, NU, RHO)
    assert ratio == pytest.approx(4.5, abs=0.05)
    assert torque.torque_in_range(900.0, D, NU)


def test_beyond_the_fitted_range_is_flagged():
    assert torque.torque_in_range(-999.9, D, NU)
    assert not torque.torque_in_range(-1000.1, D, NU)


def test_spin_decays_with_rho_s_r_squared_over_15_mu():
    m = 2650.0 * math.pi / 6 * D**3
    tau = motion.inertia_sphere(m, D) / torque.torque_stokes(0.0, D, NU, RHO)
    assert tau == pytest.approx(2650.0 * (D / 2) ** 2 / (15.0 * RHO * NU))
    assert tau == pytest.approx(0.18, abs=0.005)
