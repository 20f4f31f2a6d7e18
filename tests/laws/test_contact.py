"""Eqs. (1)-(4) and the named ways to slide."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import contact

forces = st.floats(-1e3, 1e3)
sizes = st.just(0.0) | st.floats(1e-9, 1e3)
positive = st.floats(1e-6, 1e6)


@given(overlap=st.floats(0.0, 1e-3), closing=st.floats(-10.0, 10.0), k_n=positive, eta_n=sizes)
def test_without_tension_the_normal_force_never_pulls_and_otherwise_is_the_same(overlap, closing, k_n, eta_n):
    free = contact.normal_force(overlap, closing, k_n, eta_n)
    cut = contact.normal_force_no_tension(overlap, closing, k_n, eta_n)
    assert cut >= 0.0
    assert cut == pytest.approx(max(free, 0.0), rel=1e-13, abs=1e-9)


@given(overlap=st.floats(0.0, 1e-3), closing=st.floats(-10.0, 10.0), k_n=positive, eta_n=sizes)
def test_the_normal_dashpot_only_takes_energy(overlap, closing, k_n, eta_n):
    spring = k_n * overlap
    for law in (contact.normal_force, contact.normal_force_no_tension):
        power = (law(overlap, closing, k_n, eta_n) - spring) * closing  # put into the dashpot
        assert power >= -1e-12 * (abs(spring * closing) + 1.0)


def test_at_rest_and_at_first_touch_there_is_no_normal_force():
    assert contact.normal_force(0.0, 0.0, 1e4, 0.1) == 0.0
    assert contact.normal_force_no_tension(0.0, 0.0, 1e4, 0.1) == 0.0


@given(push=forces, cohesion=sizes, mu=st.floats(0.0, 2.0))
def test_shear_strength_is_never_negative(push, cohesion, mu):
    strength = contact.shear_strength(push, cohesion, mu)
    assert strength >= 0.0
    assert strength == pytest.approx(max(cohesion + mu * push, 0.0), rel=1e-13, abs=1e-12)


@given(spring_s=forces, spring_n=forces, cohesion=sizes, mu=st.floats(0.0, 2.0))
def test_slip_never_exceeds_tau_c_and_keeps_its_sign(spring_s, spring_n, cohesion, mu):
    tau_c = contact.shear_strength(spring_n, cohesion, mu)
    capped = contact.slip_spring(spring_s, spring_n, cohesion, mu)
    assert abs(capped) <= tau_c
    assert capped * spring_s >= 0.0
    if abs(spring_s) < tau_c:
        assert capped == spring_s


@given(spring=forces, tau_c=sizes)
def test_the_cap_along_one_tangent_and_the_scale_in_3d_are_one_law(spring, tau_c):
    scale = contact.slip_scale(abs(spring), tau_c)
    assert 0.0 <= scale <= 1.0
    assert scale * spring == pytest.approx(contact.slip_spring(spring, tau_c, 0.0, 1.0), rel=1e-14)


@given(spring=forces, dash=forces, tau_c=sizes)
def test_each_slip_rule_caps_the_forces_in_its_name(spring, dash, tau_c):
    def after(size, drop=False, total=False):
        a, b, c = contact.slide(size, tau_c, drop, total)
        return a * spring + b * dash, c * dash

    near = 1.0 + 1e-12
    e, d = after(abs(spring))
    assert abs(e) <= tau_c * near
    assert d == dash
    e, d = after(abs(spring), drop=True)
    assert abs(e) <= tau_c * near
    assert d == (dash if abs(spring) <= tau_c else 0.0)
    e, d = after(abs(spring + dash), total=True)
    assert d == dash
    assert abs(e + d) <= tau_c * near + 1e-12 * (abs(spring) + abs(dash))


@given(size=sizes)
def test_below_the_cap_nothing_slides(size):
    for drop, total in ((False, False), (True, False), (False, True)):
        assert contact.slide(size, size + 1.0, drop, total) == (1.0, 0.0, 1.0)


def test_without_strength_or_spring_no_scale_is_infinite():
    assert contact.slip_scale(0.0, 0.0) == 1.0
    assert contact.slip_scale(1.0, 0.0) == 0.0


def test_critical_damping_of_one_kilogram_on_one_newton_per_metre_is_two():
    assert contact.damping(1.0, 1.0, 1.0) == 2.0
    assert math.isclose(contact.damping(0.5, 4.0, 9.0), 6.0)
