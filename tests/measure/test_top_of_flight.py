"""The highest point of a flight, between the frames that were recorded."""

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from ryusa.measure._hops import _top


def test_the_top_of_a_parabola_does_not_depend_on_the_frames():
    for t in (np.array([0.0, 0.3]), np.array([0.0, 0.11, 0.3]), np.array([0.0, 0.0, 0.2, 0.3])):
        z, w = 1.2 * t - 4.9 * t**2, 1.2 - 9.8 * t
        assert _top(t, z, w) == pytest.approx(1.2**2 / (4.0 * 4.9), rel=1e-14)


def test_the_top_is_that_of_the_cubics_on_both_sides_of_the_highest_frame():
    draw = np.random.default_rng(1)
    for _ in range(200):
        t = np.cumsum(draw.uniform(0.01, 1.0, 5))
        z, w = draw.normal(size=5), draw.normal(size=5)
        k = int(np.argmax(z))
        near = np.linspace(t[max(k - 1, 0)], t[min(k + 1, 4)], 20001)
        dense = float(CubicHermiteSpline(t, z, w)(near).max())
        assert dense - 1e-12 <= _top(t, z, w) <= dense + 1e-6


def test_heights_that_fall_all_the_way_are_highest_at_the_beginning():
    t = np.array([0.0, 1.0, 2.0])
    assert _top(t, -t, np.full(3, -1.0)) == 0.0
