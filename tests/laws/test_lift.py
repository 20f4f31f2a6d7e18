"""Shear lift and the Magnus force."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import lift

NU, RHO, D = 1e-6, 1000.0, 0.002
speeds = st.floats(1e-4, 2.0)
spins = st.floats(1e-2, 2000.0)


@given(top=st.floats(-1.0, 1.0), bottom=st.floats(-1.0, 1.0))
def test_wiberg_and_smith_lift_towards_the_faster_water(top, bottom):
    force = lift.lift_wiberg_smith(top, bottom, 0.2, RHO, math.pi / 4, D)
    area = math.pi / 4 * D**2
    assert force == pytest.approx(0.5 * RHO * 0.2 * area * (top**2 - bottom**2), rel=1e-9, abs=1e-15)


def test_saffman_s_limit_is_his_own_formula():
    slip, shear = 1e-6, 1e-4  # Re = 2e-3, beta = 0.1
    k = lift.lift_saffman_mei(slip, shear, D, NU, RHO)
    part = (1.0 - 0.3314 * math.sqrt(0.1)) * math.exp(-2e-4) + 0.3314 * math.sqrt(0.1)
    assert part == pytest.approx(1.0, abs=2e-4)
    saffman = 6.46 * RHO * math.sqrt(NU * shear) * (D / 2) ** 2 * slip
    assert k * slip == pytest.approx(saffman * part, rel=1e-12)


def test_shear_lift_turns_with_the_shear_and_points_to_the_faster_water_for_a_grain_left_behind():
    up = lift.lift_saffman_mei(0.1, 50.0, D, NU, RHO)
    assert up > 0.0  # F_z = k w_x
    assert lift.lift_saffman_mei(0.1, -50.0, D, NU, RHO) == -up


@pytest.mark.parametrize(("beta", "step"), [(0.4, 0.07), (0.005, 0.76)])
def test_the_branches_of_mei_differ_at_40_as_documented(beta, step):
    below, above = lift.saffman_mei(40.0, beta), lift.saffman_mei(40.0 * (1 + 1e-12), beta)
    assert below / above - 1.0 == pytest.approx(step, abs=0.005)


def test_without_slip_shear_lift_has_saffman_s_factor_and_without_shear_none():
    none = lift.lift_saffman_mei(0.0, 50.0, D, NU, RHO)
    assert none == pytest.approx(1.615 * RHO * math.sqrt(NU * 50.0) * D**2, rel=1e-12)
    assert lift.lift_saffman_mei(1e-12, 50.0, D, NU, RHO) == pytest.approx(none, rel=1e-4)
    assert lift.lift_saffman_mei(0.1, 0.0, D, NU, RHO) == 0.0


def test_rubinow_and_keller_have_a_lift_coefficient_of_spin_d_over_slip():
    slip, spin = 0.3, 100.0
    force = lift.magnus_rubinow_keller(D, RHO) * spin * slip
    assert force == pytest.approx(0.5 * RHO * (spin * D / slip) * math.pi / 4 * D**2 * slip**2, rel=1e-14)


@pytest.mark.parametrize("magnus", [lift.magnus_loth, lift.magnus_oesterle_dinh])
def test_loth_is_rubinow_and_keller_in_slow_water(magnus):
    d = 1e-6
    assert magnus(1e-3, 2e4, d, NU, RHO) == pytest.approx(lift.magnus_rubinow_keller(d, RHO), rel=0.02)
    assert magnus(0.0, 10.0, D, NU, RHO) == lift.magnus_rubinow_keller(D, RHO)


@given(slip=speeds, spin=spins)
def test_loth_reduces_the_force_by_at_most_98_percent(slip, spin):
    part = lift.magnus_loth(slip, spin, D, NU, RHO) / lift.magnus_rubinow_keller(D, RHO)
    assert 0.02 < part <= 1.0


@given(re=st.floats(20.0, 140.0), ratio=st.floats(3.0, 10.0))
def test_the_two_corrections_agree_within_a_factor_of_two_where_both_were_fitted(re, ratio):
    slip = re * NU / D
    spin = ratio * slip / D
    loth, oesterle = (law(slip, spin, D, NU, RHO) for law in (lift.magnus_loth, lift.magnus_oesterle_dinh))
    assert 0.5 < loth / oesterle < 2.0


def test_oesterle_and_dinh_end_at_a_lift_coefficient_of_0_45():
    slip, spin = 1.0, 3000.0
    force = lift.magnus_oesterle_dinh(slip, spin, D, NU, RHO) * slip * spin
    assert force == pytest.approx(0.5 * RHO * 0.45 * math.pi / 4 * D**2 * slip**2, rel=1e-6)


def test_oesterle_and_dinh_s_force_vanishes_with_the_spin():
    forces = [lift.magnus_oesterle_dinh(0.05, spin, D, NU, RHO) * spin for spin in (1.0, 1e-4, 1e-8, 0.0)]
    assert forces == sorted(forces, reverse=True)
    assert forces[-1] == 0.0
    assert forces[-2] < 1e-3 * forces[0]
