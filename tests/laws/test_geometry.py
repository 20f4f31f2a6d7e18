"""Eq. (12), contact arms, the turning contact frame, the periodic wrap."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from ryusa.laws import geometry

part = st.floats(-1.0, 1.0)
vectors = st.tuples(part, part, part)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    size = math.sqrt(dot(a, a))
    assume(size > 0.1)
    return tuple(x / size for x in a)


def turned(a, axis, angle):
    """Rodrigues' rotation of a about a unit axis."""
    along, around = dot(a, axis), cross(axis, a)
    c, s = math.cos(angle), math.sin(angle)
    return tuple(c * x + s * y + (1.0 - c) * along * k for x, y, k in zip(a, around, axis, strict=True))


@given(r_i=st.floats(1e-3, 1.0), r_j=st.floats(1e-3, 1.0), gap=st.floats(1e-6, 1.0))
def test_separate_grains_do_not_overlap_and_arms_end_at_one_point(r_i, r_j, gap):
    assert geometry.overlap(r_i, r_j, r_i + r_j + gap) < 0.0
    distance = (r_i + r_j) * 0.98
    overlap = geometry.overlap(r_i, r_j, distance)
    assert overlap == geometry.overlap(r_j, r_i, distance)
    assert geometry.arm(r_i, overlap) + geometry.arm(r_j, overlap) == pytest.approx(distance, rel=1e-14)


@given(step=st.floats(-1.5, 1.5), period=st.floats(0.5, 3.0))
def test_the_wrap_is_the_shortest_image(step, period):
    assume(abs(step) <= 1.5 * period)
    short = geometry.wrap(step, period)
    assert abs(short) <= 0.5 * period * (1.0 + 1e-12)
    turns = (step - short) / period
    assert turns == pytest.approx(round(turns), abs=1e-12)
    assert geometry.wrap(-step, period) == -short


def test_an_open_direction_is_not_wrapped():
    assert geometry.wrap(1.0e6, math.inf) == 1.0e6


@given(s=vectors, n=vectors, twist=st.floats(-0.1, 0.1))
def test_a_turned_spring_lies_in_the_tangent_plane_and_keeps_its_length(s, n, twist):
    n = unit(n)
    side = unit(cross(n, s))  # old vector nearly tangential, as between two steps
    s = tuple(a + 0.01 * b for a, b in zip(side, n, strict=True))
    new = geometry.turn(*s, *n, twist)
    assert dot(new, n) == pytest.approx(0.0, abs=1e-14)
    assert dot(new, new) == pytest.approx(dot(s, s), rel=1e-13)


@given(s=vectors, n=vectors, twist=st.floats(-0.1, 0.1))
def test_the_spring_on_the_partner_is_opposite_with_the_same_bits(s, n, twist):
    n = unit(n)
    across = cross(n, s)
    assume(dot(s, s) > 1e-6 and dot(across, across) > 1e-12 * dot(s, s))  # a spring lies along the surface
    mine = geometry.turn(*s, *n, twist)
    # seen from the other grain: the spring and the normal point the other way, and so does the turn about it
    theirs = geometry.turn(*(-x for x in s), *(-x for x in n), -twist)
    assert theirs == tuple(-x for x in mine)


@given(s=vectors, n=vectors, axis=vectors, angle=st.floats(-0.01, 0.01))
def test_the_spring_rotates_with_a_pair_that_rotates_as_a_whole(s, n, axis, angle):
    n, axis = unit(n), unit(axis)
    s = unit(cross(n, s))
    rolled, spring = turned(n, axis, angle), turned(s, axis, angle)
    # the mean spin of a rigid pair is the turn itself; its part along the normal is the twist
    got = geometry.turn(*s, *rolled, angle * dot(axis, rolled))
    assert got == pytest.approx(spring, abs=2.0 * angle * angle + 1e-14)


def test_a_spring_that_is_zero_stays_zero():
    assert geometry.turn(0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.3) == (0.0, 0.0, 0.0)
    assert geometry.turn(0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("angle", [1e-2, 1e-3])
def test_turning_is_second_order_in_the_angle_of_a_step(angle):
    n, axis, s = (0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (1.0, 0.0, 0.0)
    whole = 0.5
    steps = round(whole / angle)
    spring = s
    for k in range(1, steps + 1):
        now = turned(n, axis, k * angle)
        spring = geometry.turn(*spring, *now, angle * dot(axis, now))
    assert math.dist(spring, turned(s, axis, whole)) < 0.5 * whole * angle
