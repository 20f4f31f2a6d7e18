"""Slices of spheres and circles."""

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from ryusa.laws import slices

radius = st.floats(1.0e-4, 10.0)
height = st.floats(-1.5, 1.5)


def test_half_a_sphere_and_half_a_circle_are_known():
    assert slices.sphere_slice(2.0, 0.0, 9.0) == pytest.approx(2.0 / 3.0 * math.pi * 8.0, rel=1e-15)
    assert slices.circle_slice(2.0, -9.0, 0.0) == pytest.approx(2.0 * math.pi, rel=1e-15)


def test_planes_outside_the_grain_give_a_slice_of_zero():
    assert slices.sphere_slice(1.0, 1.0, 2.0) == 0.0
    assert slices.circle_slice(1.0, -3.0, -1.0) == 0.0


@given(r=radius, low=height, high=height)
def test_a_slice_is_the_integral_of_its_sections(r, low, high):
    a, b = (min(max(z, -1.0), 1.0) for z in (low, high))
    disc, _ = quad(lambda z: math.pi * (1.0 - z * z), a, b)
    chord, _ = quad(lambda z: 2.0 * math.sqrt(1.0 - z * z), a, b)
    assert slices.sphere_slice(r, low * r, high * r) == pytest.approx(
        disc * r**3, rel=1e-12, abs=1e-13 * r**3
    )
    assert slices.circle_slice(r, low * r, high * r) == pytest.approx(chord * r**2, rel=1e-6, abs=1e-8 * r**2)


@given(r=radius, cuts=st.lists(height, min_size=1, max_size=20))
def test_adjoining_slices_add_up_to_the_whole(r, cuts):
    edges = [-2.0 * r, *(z * r for z in sorted(cuts)), 2.0 * r]
    pairs = list(itertools.pairwise(edges))
    assert sum(slices.sphere_slice(r, *pair) for pair in pairs) == pytest.approx(
        math.pi * r**3 * 4 / 3, rel=1e-13
    )
    assert sum(slices.circle_slice(r, *pair) for pair in pairs) == pytest.approx(math.pi * r**2, rel=1e-13)


@given(r=radius, low=height, high=height)
def test_moments_of_a_slice_are_those_of_its_sections(r, low, high):
    a, b = (min(max(z, -1.0), 1.0) for z in (low, high))
    section = (
        lambda z: math.pi * z * (1.0 - z * z),
        lambda z: math.pi * z * z * (1.0 - z * z),
        lambda z: 0.25 * math.pi * (1.0 - z * z) ** 2,
    )
    found = slices.sphere_slice_moments(r, low * r, high * r)
    for k, (one, power) in enumerate(zip(found, (4, 5, 5), strict=True)):
        assert one == pytest.approx(quad(section[k], a, b)[0] * r**power, rel=1e-11, abs=1e-13 * r**power)
