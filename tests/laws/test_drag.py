"""Drag laws against settling velocities; the table of the reference page, section (d)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import drag

C_D = {
    "24/Re+0.4": drag.c_d_re_04,
    "24/Re+2": drag.c_d_re_2,
    "Schiller-Naumann": drag.c_d_schiller_naumann,
    "Ferguson-Church sphere": drag.c_d_ferguson_church_sphere,
    "Ferguson-Church sand": drag.c_d_ferguson_church_sand,
}
R, G, NU, RHO = 1.65, 9.81, 1e-6, 1000.0
# d [mm]: settling velocities [m/s] at 2650 kg/m3, nu 1e-6
TABLE = {
    0.1: {"Schiller-Naumann": 0.0080, "Ferguson-Church sphere": 0.0080, "Ferguson-Church sand": 0.0075},
    0.5: {"Schiller-Naumann": 0.0784, "Ferguson-Church sphere": 0.0949, "Ferguson-Church sand": 0.0710},
    1.0: {"Schiller-Naumann": 0.1551, "Ferguson-Church sphere": 0.1846, "Ferguson-Church sand": 0.1263},
    2.0: {"Schiller-Naumann": 0.2835, "Ferguson-Church sphere": 0.3010, "Ferguson-Church sand": 0.1964},
    6.0: {"Schiller-Naumann": 0.5425, "Ferguson-Church sphere": 0.5591, "Ferguson-Church sand": 0.3559},
}
speeds = st.floats(1e-6, 10.0)


def settle(c_d, d):
    """Speed at which drag carries the submerged weight, by halving [m/s]."""
    weight = (
        drag.submerged_mass((1.0 + R) * RHO * drag.volume(d, math.pi / 6), RHO, drag.volume(d, math.pi / 6))
        * G
    )
    low, high = 0.0, 10.0
    for _ in range(80):
        w = 0.5 * (low + high)
        force = drag.drag_factor(w, c_d(drag.reynolds(w, d, NU)), RHO, math.pi / 4, d) * w
        low, high = (w, high) if force < weight else (low, w)
    return w


@pytest.mark.parametrize(("d", "name"), [(d, name) for d, row in TABLE.items() for name in row])
def test_grains_settle_as_fast_as_the_table_says(d, name):
    assert settle(C_D[name], d / 1000) == pytest.approx(TABLE[d][name], abs=6e-5)


@pytest.mark.parametrize("d", [1e-4, 5e-4, 1e-3, 2e-3, 6e-3])
def test_ferguson_and_church_as_a_drag_law_returns_their_settling_velocity(d):
    closed = [drag.terminal_velocity_ferguson_church(R, G, d, NU, 18.0, c_2) for c_2 in (0.4, 1.0)]
    assert settle(drag.c_d_ferguson_church_sphere, d) == pytest.approx(closed[0], rel=1e-12)
    assert settle(drag.c_d_ferguson_church_sand, d) == pytest.approx(closed[1], rel=1e-12)


@pytest.mark.parametrize(("name", "plus"), [("24/Re+0.4", 0.4), ("24/Re+2", 2.0)])
@pytest.mark.parametrize("d", [1e-4, 1e-3, 6e-3])
def test_the_two_term_laws_settle_as_their_quadratic_says(name, plus, d):
    # plus w**2 + 24 nu/d w = (4/3) R g d
    a = 12.0 * NU / d
    exact = (math.sqrt(a * a + plus * 4.0 / 3.0 * R * G * d) - a) / plus
    assert settle(C_D[name], d) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("name", C_D)
def test_every_law_has_the_stokes_limit(name):
    re = 1e-9
    assert C_D[name](re) * re == pytest.approx(24.0, rel=1e-4)
    w = settle(C_D[name], 1e-6)
    assert w == pytest.approx(drag.terminal_velocity_stokes(R, G, 1e-6, NU), rel=1e-3)


@pytest.mark.parametrize(("name", "limit"), list(zip(C_D, [0.4, 2.0, 0.44, 0.4, 1.0], strict=True)))
def test_every_law_has_its_limit_at_large_re(name, limit):
    assert C_D[name](1e12) == pytest.approx(limit, rel=1e-4)


def test_schiller_and_naumann_step_by_less_than_half_a_percent_at_1000():
    assert drag.c_d_schiller_naumann(1000.0) == pytest.approx(0.44, rel=5e-3)


@given(u=speeds, name=st.sampled_from(sorted(C_D)))
def test_drag_never_decreases_with_speed(u, name):
    def force(w):
        return drag.drag_factor(w, C_D[name](drag.reynolds(w, 0.002, NU)), RHO, math.pi / 4, 0.002) * w

    assert force(1.01 * u) >= force(u)


@pytest.mark.parametrize("c_d", [*C_D.values(), lambda re: 0.4])
def test_drag_is_zero_without_relative_velocity(c_d):
    assert drag.drag_factor(0.0, c_d(0.0), RHO, math.pi / 4, 0.002) == 0.0


def test_at_1_percent_of_a_micron_per_second_drag_is_still_that_of_stokes():
    w, d = 1e-8, 0.002
    factor = drag.drag_factor(w, drag.c_d_re_04(drag.reynolds(w, d, NU)), RHO, math.pi / 4, d)
    assert factor == pytest.approx(3.0 * math.pi * RHO * NU * d, rel=1e-3)


def test_weight_has_no_added_mass_and_inertia_is_that_of_eq_10():
    v = drag.volume(0.002, math.pi / 6)
    m = 2650.0 * v
    assert drag.submerged_mass(m, RHO, v) == pytest.approx(1650.0 * v)
    assert m + drag.added_mass(RHO, 0.5, v) == pytest.approx(RHO * (2.65 + 0.5) * v)


@pytest.mark.parametrize(
    ("d", "soulsby", "dietrich"),
    [(1e-4, 0.0079, 0.0075), (5e-4, 0.0737, 0.0740), (1e-3, 0.1204, 0.1551), (6e-3, 0.3175, 0.5763)],
)
def test_settling_formulae_of_the_field_give_their_known_values(d, soulsby, dietrich):
    assert drag.terminal_velocity_soulsby(R, G, d, NU) == pytest.approx(soulsby, abs=2e-4)
    assert drag.terminal_velocity_dietrich(R, G, d, NU) == pytest.approx(dietrich, abs=3e-4)
    assert drag.terminal_velocity_soulsby(R, G, 1e-6, NU) == pytest.approx(
        drag.terminal_velocity_stokes(R, G, 1e-6, NU),
        rel=0.14,  # 2 * 10.36/1.049 = 19.75, not 18
    )
