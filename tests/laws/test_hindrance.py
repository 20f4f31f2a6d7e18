"""Hindered drag: suspensions settle with the exponent that each law implies."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import drag, hindrance

R, G, NU, RHO = 1.65, 9.81, 1e-6, 1000.0
M_RZ, M_POWER = 3.3, 3.1
C_D = {
    "24/Re": lambda re: 24.0 / re,
    "0.44": lambda re: 0.44,
    "24/Re+0.4": drag.c_d_re_04,
    "24/Re+2": drag.c_d_re_2,
    "Schiller-Naumann": drag.c_d_schiller_naumann,
    "Ferguson-Church sphere": drag.c_d_ferguson_church_sphere,
    "Ferguson-Church sand": drag.c_d_ferguson_church_sand,
}
SIZES = [1e-5, 1e-4, 5e-4, 2e-3, 1.5e-2]  # Re 1e-3 to 1e4
CROWDS = [0.05, 0.2, 0.35, 0.5]  # phi
BUOYANCY = {"weight": False, "stress": True}
# What each law does to the slip, and its factor eps**-q under model A and B, where that is a power of eps.
FORM = {
    "none": (0.0, 0.0, 0.0),
    "richardson_zaki": (1.0 - M_RZ, -1.0, 0.0),
    "wen_yu": (1.0, 3.65, 4.65),
    "power": (0.0, M_POWER, M_POWER),
}


def hindered(name, slip, eps, d, stress):
    match name:
        case "none":
            return slip, 1.0
        case "richardson_zaki":
            return hindrance.richardson_zaki(slip, eps, M_RZ, stress)
        case "wen_yu":
            return hindrance.wen_yu(slip, eps, stress)
        case "gidaspow":
            return hindrance.gidaspow(slip, eps, d, NU, stress)
        case "di_felice":
            return hindrance.di_felice(slip, eps, d, NU, stress)
        case _:
            return hindrance.power(slip, eps, M_POWER)


def lone(w, d, c_d):
    """Drag of a lone grain [N]."""
    re = drag.reynolds(w, d, NU)
    return drag.drag_factor(w, c_d(re) if re else 0.0, RHO, math.pi / 4, d) * w


def halve(force, wanted):
    """Speed at which a rising force reaches what is wanted, by halving [m/s]."""
    low, high = 0.0, 1e4
    for _ in range(200):
        w = 0.5 * (low + high)
        low, high = (w, high) if force(w) < wanted else (low, w)
    return w


def settle(name, d, phi, c_d, stress):
    """Settling velocity in a closed column [m/s] from the balance of one grain, which slips at w/eps."""
    eps = 1.0 - phi
    weight = R * RHO * G * math.pi / 6.0 * d**3

    def drag_at(w_p):
        speed, factor = hindered(name, w_p / eps, eps, d, stress)
        return factor * lone(speed, d, c_d)

    return halve(drag_at, weight * eps if stress else weight)


def settle_alone(d, c_d):
    return halve(lambda w: lone(w, d, c_d), R * RHO * G * math.pi / 6.0 * d**3)


@pytest.mark.parametrize("buoyancy", BUOYANCY)
@pytest.mark.parametrize("drag_law", C_D)
def test_richardson_and_zaki_get_their_exponent_whatever_the_drag_law(drag_law, buoyancy):
    for d in SIZES:
        w_0 = settle_alone(d, C_D[drag_law])
        for phi in CROWDS:
            w_p = settle("richardson_zaki", d, phi, C_D[drag_law], BUOYANCY[buoyancy])
            assert math.log(w_p / w_0) / math.log(1.0 - phi) == pytest.approx(M_RZ, rel=1e-9)


@pytest.mark.parametrize("buoyancy", BUOYANCY)
@pytest.mark.parametrize("name", FORM)
@pytest.mark.parametrize(("drag_law", "a"), [("24/Re", 1.0), ("0.44", 2.0)])
def test_suspensions_settle_with_the_exponent_derived_for_stokes_and_newton(name, drag_law, a, buoyancy):
    stress = BUOYANCY[buoyancy]
    p, q_a, q_b = FORM[name]
    n = hindrance.exponent_settling(a, p, q_a if stress else q_b, stress)
    for d in SIZES:
        w_0 = settle_alone(d, C_D[drag_law])
        for phi in CROWDS:
            w_p = settle(name, d, phi, C_D[drag_law], stress)
            assert math.log(w_p / w_0) / math.log(1.0 - phi) == pytest.approx(n, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "stokes", "newton"),
    [
        ("none", (1.0, 2.0), (1.0, 1.5)),
        ("richardson_zaki", (M_RZ, M_RZ), (M_RZ, M_RZ)),
        ("wen_yu", (4.65, 4.65), (2.325, 2.325)),
        ("power", (4.1, 5.1), (2.55, 3.05)),
    ],
)
def test_the_exponents_are_those_of_the_table(name, stokes, newton):
    p, q_a, q_b = FORM[name]
    for a, (model_b, model_a) in ((1.0, stokes), (2.0, newton)):
        assert hindrance.exponent_settling(a, p, q_b, False) == pytest.approx(model_b)
        assert hindrance.exponent_settling(a, p, q_a, True) == pytest.approx(model_a)


@pytest.mark.parametrize("buoyancy", BUOYANCY)
@pytest.mark.parametrize("name", FORM)
@pytest.mark.parametrize("drag_law", sorted(set(C_D) - {"24/Re", "0.44", "Schiller-Naumann"}))
def test_in_between_the_exponent_follows_the_mean_slope_of_the_drag_law(drag_law, name, buoyancy):
    stress, c_d = BUOYANCY[buoyancy], C_D[drag_law]
    p, q_a, q_b = FORM[name]
    for d in SIZES:
        w_0 = settle_alone(d, c_d)
        for phi in CROWDS:
            eps = 1.0 - phi
            w_p = settle(name, d, phi, c_d, stress)
            taken = w_p / eps * eps**p
            if taken == pytest.approx(w_0, rel=1e-6):
                continue  # no slope between a speed and itself
            a = math.log(lone(taken, d, c_d) / lone(w_0, d, c_d)) / math.log(taken / w_0)
            assert 0.999 < a < 2.001
            n = hindrance.exponent_settling(a, p, q_a if stress else q_b, stress)
            assert math.log(w_p / w_0) / math.log(eps) == pytest.approx(n, rel=1e-6)


@pytest.mark.parametrize("name", ["richardson_zaki", "wen_yu", "gidaspow", "di_felice"])
def test_a_law_read_under_both_models_settles_the_same(name):
    for d in SIZES:
        for phi in CROWDS:
            weight, stress = (settle(name, d, phi, drag.c_d_schiller_naumann, s) for s in (False, True))
            assert stress == pytest.approx(weight, rel=1e-9)


@pytest.mark.parametrize(("drag_law", "n"), [("24/Re", 4.7), ("0.44", 2.35)])
@pytest.mark.parametrize("buoyancy", BUOYANCY)
def test_di_felice_settles_as_observed_at_both_ends(drag_law, n, buoyancy):
    d = 1e-6 if n > 4.0 else 3.0  # Re 1e-6 and 3e7
    w_0 = settle_alone(d, C_D[drag_law])
    for phi in CROWDS:
        w_p = settle("di_felice", d, phi, C_D[drag_law], BUOYANCY[buoyancy])
        assert math.log(w_p / w_0) / math.log(1.0 - phi) == pytest.approx(n, rel=1e-3)


@pytest.mark.parametrize(("name", "newton", "stokes"), [("wen_yu", 2.325, 4.65), ("di_felice", 2.025, 4.7)])
def test_exponents_of_published_laws_go_from_stokes_to_newton_with_grain_size(name, newton, stokes):
    for phi in CROWDS:
        exponents = []
        for d in SIZES:
            w_0 = settle_alone(d, drag.c_d_schiller_naumann)
            w_p = settle(name, d, phi, drag.c_d_schiller_naumann, True)
            exponents.append(math.log(w_p / w_0) / math.log(1.0 - phi))
        assert newton - 1e-9 < min(exponents)
        assert max(exponents) < stokes + 1e-9
        assert exponents == sorted(exponents, reverse=True)


@pytest.mark.parametrize("phi", [0.3, 0.45, 0.6])
def test_gidaspow_settles_by_ergun_where_grains_are_dense(phi):
    eps = 1.0 - phi
    d = 1e-6
    ratio = settle("gidaspow", d, phi, drag.c_d_schiller_naumann, True) / settle_alone(
        d, drag.c_d_schiller_naumann
    )
    assert ratio == pytest.approx(0.12 * eps**3 / phi, rel=1e-4)
    d = 3.0
    ratio = settle("gidaspow", d, phi, drag.c_d_schiller_naumann, True) / settle_alone(
        d, drag.c_d_schiller_naumann
    )
    assert ratio == pytest.approx(math.sqrt(0.33 / 1.75) * eps**1.5, rel=1e-3)


@pytest.mark.parametrize("eps", [0.35, 0.5, 0.79])
@pytest.mark.parametrize("flow", [1e-5, 1e-3, 0.1, 1.0])  # water per area of bed [m/s]
def test_gidaspow_under_model_b_is_the_pressure_that_ergun_measured(eps, flow):
    d, phi = 0.002, 1.0 - eps
    ergun = 150.0 * RHO * NU * phi**2 * flow / (eps**3 * d**2) + 1.75 * RHO * phi * flow**2 / (eps**3 * d)
    speed, factor = hindrance.gidaspow(flow / eps, eps, d, NU, False)
    per_volume = factor * lone(speed, d, drag.c_d_schiller_naumann) * phi / (math.pi / 6.0 * d**3)
    assert per_volume == pytest.approx(ergun, rel=1e-12)


@pytest.mark.parametrize("name", ["wen_yu", "gidaspow"])
@pytest.mark.parametrize("slip", [1e-5, 1e-2, 1.0])
def test_wen_and_yu_are_the_exchange_coefficient_of_gidaspow_per_grain(name, slip):
    d, eps = 0.002, 0.9
    c_d = drag.c_d_schiller_naumann(eps * slip * d / NU)
    beta = 0.75 * c_d * eps * (1.0 - eps) * RHO * slip / d * eps**-2.65
    speed, factor = hindered(name, slip, eps, d, True)
    force = factor * lone(speed, d, drag.c_d_schiller_naumann)
    assert force == pytest.approx(beta * slip / (1.0 - eps) * math.pi / 6.0 * d**3, rel=1e-12)


def test_gidaspow_is_discontinuous_at_eps_0_8_as_documented():
    def jump(slip):
        below, above = (
            factor * lone(speed, 0.002, drag.c_d_schiller_naumann)
            for speed, factor in (hindered("gidaspow", slip, eps, 0.002, True) for eps in (0.8 - 1e-12, 0.8))
        )
        return below / above

    assert jump(1e-7) == pytest.approx(1.15, abs=0.01)
    assert jump(10.0) == pytest.approx(3.67, abs=0.01)


@pytest.mark.parametrize("name", ["wen_yu", "di_felice"])
def test_slow_flow_through_a_packed_bed_has_about_the_drag_of_ergun(name):
    d, slip, eps = 1e-4, 1e-6, 0.4

    def force(law):
        speed, factor = hindered(law, slip, eps, d, True)
        return factor * lone(speed, d, drag.c_d_schiller_naumann)

    assert force(name) == pytest.approx(force("gidaspow"), rel=0.15)


@given(slip=st.floats(1e-9, 10.0), d=st.floats(1e-5, 0.1), stress=st.booleans())
def test_there_is_no_hindrance_in_clear_water(slip, d, stress):
    for name in ("none", *FORM, "gidaspow", "di_felice"):
        assert hindered(name, slip, 1.0, d, stress) == (slip, 1.0)


@given(slip=st.floats(1e-6, 10.0), phi=st.floats(0.0, 0.6), stress=st.booleans())
def test_drag_never_decreases_with_concentration(slip, phi, stress):
    d = 0.002
    for name in ("wen_yu", "gidaspow", "di_felice", "power"):
        few, many = (
            factor * lone(speed, d, drag.c_d_re_04)
            for speed, factor in (hindered(name, slip, 1.0 - c, d, stress) for c in (phi, phi + 0.01))
        )
        assert many >= few


@given(slip=st.floats(1e-6, 10.0), eps=st.floats(0.1, 1.0), stress=st.booleans())
def test_three_laws_are_linear_in_the_slip(slip, eps, stress):
    for name in ("richardson_zaki", "wen_yu", "power"):
        one, factor = hindered(name, 1.0, eps, 0.002, stress)
        assert hindered(name, slip, eps, 0.002, stress) == (pytest.approx(slip * one, rel=1e-14), factor)


def test_every_law_is_finite_and_zero_in_water_at_rest():
    for name in ("richardson_zaki", "wen_yu", "gidaspow", "di_felice", "power"):
        for eps in (0.4, 0.9):
            speed, factor = hindered(name, 0.0, eps, 0.002, True)
            assert speed == 0.0
            assert math.isfinite(factor)


def test_exponents_fall_from_stokes_to_newton():
    for law, stokes, newton in (
        (hindrance.exponent_rowe, 4.7, 0.41 / 0.175),
        (hindrance.exponent_garside, 5.1, 2.7),
    ):
        values = [law(10.0**k) for k in range(-6, 9)]
        assert values == sorted(values, reverse=True)
        assert values[0] == pytest.approx(stokes, rel=1e-3)
        assert values[-1] == pytest.approx(newton, rel=1e-3)


def test_the_multiple_of_stokes_is_schiller_and_naumann():
    for re in (1e-3, 1.0, 500.0, 1e4):
        assert hindrance.stokes_multiple(re) == pytest.approx(
            drag.c_d_schiller_naumann(re) * re / 24.0, rel=1e-14
        )
