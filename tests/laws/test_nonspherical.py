"""Drag on grains that are not spheres: limits, the exact friction of spheroids, formulae of the field."""

import math

import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from ryusa.laws import drag, nonspherical
from ryusa.laws.families import DragOfForm
from ryusa.model.clump import SHAPES, drag_form, shape

R, G, NU = 1.65, 9.81, 1.0e-6
CURVES = {nonspherical.c_d_ganser: 0.4305, nonspherical.c_d_bagheri_bonadonna: 0.46}


def perrin(p):
    """Stokes drag of a spheroid of axis ratio p, over orientations, over that on its sphere (Perrin 1936).

    Two over the integral of ds/sqrt((a^2 + s)(b^2 + s)^2), the capacity of the spheroid of semi-axes a and b.
    """
    a, b = p ** (2.0 / 3.0), p ** (-1.0 / 3.0)
    whole, _ = quad(lambda s: 1.0 / ((b * b + s) * math.sqrt(a * a + s)), 0.0, math.inf)
    return 2.0 / whole


@pytest.mark.parametrize("p", [0.25, 0.5, 0.8, 1.25, 2.0, 4.0])
def test_the_stokes_factor_of_axes_is_near_the_exact_one_of_spheroids(p):
    axes = sorted((p ** (2.0 / 3.0), p ** (-1.0 / 3.0), p ** (-1.0 / 3.0)), reverse=True)
    stokes, newton = nonspherical.shape_factors_bagheri_bonadonna(
        axes[1] / axes[0], axes[2] / axes[1], 1.0, 2.65
    )
    assert stokes == pytest.approx(perrin(p), rel=0.05)
    assert newton > 1.0


@pytest.mark.parametrize("c_d", CURVES)
@pytest.mark.parametrize(("stokes", "newton"), [(1.0, 1.0), (1.2, 3.5)])
def test_shape_factors_are_the_drag_at_both_ends(c_d, stokes, newton):
    assert c_d(1e-9, stokes, newton) * 1e-9 == pytest.approx(24.0 * stokes, rel=1e-3)
    assert c_d(1e12, stokes, newton) == pytest.approx(newton * CURVES[c_d], rel=0.01)


def test_a_sphere_has_factors_of_one_and_those_of_other_forms_are_above():
    assert nonspherical.shape_factors_ganser(1.0) == (1.0, 1.0)
    assert nonspherical.shape_factors_bagheri_bonadonna(1.0, 1.0, 1.0, 2.65) == (1.0, 1.0)
    before = 1.0, 1.0
    for sphericity in (0.95, 0.8, 0.6):
        now = nonspherical.shape_factors_ganser(sphericity)
        assert now[0] > before[0]
        assert now[1] > before[1]
        before = now


@pytest.mark.parametrize("re", [0.1, 1.0, 10.0, 1000.0, 10_000.0])
def test_haider_and_levenspiel_is_near_the_sphere_and_grows_as_sphericity_falls(re):
    sphere = drag.c_d_schiller_naumann(re)
    assert nonspherical.c_d_haider_levenspiel(re, 1.0) == pytest.approx(sphere, rel=0.13)
    last = 0.0
    for sphericity in (1.0, 0.9, 0.8, 0.67):
        now = nonspherical.c_d_haider_levenspiel(re, sphericity)
        assert now > last
        last = now


@pytest.mark.parametrize("re", [0.1, 10.0, 1000.0, 10_000.0])
@pytest.mark.parametrize("sphericity", [0.7, 0.8, 0.9])
def test_the_two_laws_of_sphericity_agree_as_their_authors_found(re, sphericity):
    """To a quarter: both were fitted to the same collections of measured grains."""
    ganser = nonspherical.c_d_ganser(re, *nonspherical.shape_factors_ganser(sphericity))
    assert ganser == pytest.approx(nonspherical.c_d_haider_levenspiel(re, sphericity), rel=0.25)


@pytest.mark.parametrize("d", [2e-4, 1e-3, 5e-3])
def test_dietrich_by_corey_is_dietrich_by_size_for_round_grains(d):
    by_size = drag.terminal_velocity_dietrich(R, G, d, NU)
    assert nonspherical.terminal_velocity_corey(R, G, d, NU, 1.0, 6.0) == pytest.approx(by_size, rel=0.02)
    assert nonspherical.terminal_velocity_corey(R, G, d, NU, 0.7, 3.5) < 0.95 * by_size


@pytest.mark.parametrize("name", [one for one in SHAPES if one not in {"sphere", "tetrahedron"}])
@pytest.mark.parametrize("d", [1e-3, 4e-3, 2e-2])
def test_clumps_settle_as_natural_grains_of_their_axes(name, d):
    """Bagheri & Bonadonna between Dietrich's perfectly round and natural grains, to 15 %."""
    clump = shape(name)
    stokes, newton, _ = drag_form(DragOfForm.BAGHERI_BONADONNA, clump, 1.0 + R)

    def excess(w):
        c_d = nonspherical.c_d_bagheri_bonadonna(w * d / NU, stokes, newton)
        return 0.75 * c_d * w * w - R * G * d

    speed = brentq(excess, 1e-6, 10.0)
    round_, natural = (
        nonspherical.terminal_velocity_corey(R, G, d, NU, clump.corey, one) for one in (6.0, 3.5)
    )
    assert 0.85 * natural < speed < 1.15 * round_
