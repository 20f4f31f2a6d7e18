"""Collisions under water."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.laws import immersed
from ryusa.laws.reduced import reduced

NU, RHO, SIGMA = 1e-6, 1000.0, 2500.0
D = 0.001
M = SIGMA * math.pi / 6.0 * D**3


def pair(wall):
    """Reduced mass and radius of a grain that meets a wall, or its like."""
    other = math.inf if wall else 1.0
    return reduced(M, M * other), reduced(0.5 * D, 0.5 * D * other)


def film(gap, closing, r, roughness):
    """The film without a cut: a reach so far that it takes nothing off."""
    return immersed.lubrication_force(gap, closing, r, roughness, 1.0e9, RHO, NU)


@pytest.mark.parametrize("wall", [True, False])
def test_the_stokes_number_is_that_of_the_field(wall):
    m, r = pair(wall)
    against_a_wall = SIGMA * D * 0.2 / (9.0 * RHO * NU)
    st_number = immersed.stokes_number(0.2, m, r, RHO, NU)
    assert st_number == pytest.approx(against_a_wall * (1.0 if wall else 2.0), rel=1e-12)
    yade = immersed.stokes_number_yade(0.2, D, SIGMA, RHO, NU)
    assert yade / st_number == pytest.approx(9.0 if wall else 4.5, rel=1e-12)


@pytest.mark.parametrize("wall", [True, False])
def test_the_film_slows_the_approach_as_in_davis_with_this_stokes_number(wall):
    m, r = pair(wall)
    speed, roughness, far = 0.5, 1e-5, 0.5 * D
    v, n = speed, 40_000
    edges = [(far + roughness) * (roughness / (far + roughness)) ** (k / n) - roughness for k in range(n + 1)]
    for k in range(n):  # m v dv = -F dgap
        a, b = edges[k], edges[k + 1]
        v -= film(0.5 * (a + b), v, r, roughness) / (m * v) * (a - b)
    st_number = immersed.stokes_number(speed, m, r, RHO, NU)
    assert v / speed == pytest.approx(1.0 - math.log((far + roughness) / roughness) / st_number, rel=1e-6)
    assert immersed.restitution_davis(1.0, st_number, roughness, D) == pytest.approx(v / speed, rel=1e-3)


def test_with_the_stokes_number_of_yade_davis_underestimates_the_loss():
    m, r = pair(wall=False)
    st_number = immersed.stokes_number(0.2, m, r, RHO, NU)
    yade = immersed.stokes_number_yade(0.2, D, SIGMA, RHO, NU)
    lost, lost_yade = (1.0 - immersed.restitution_davis(1.0, x, 1e-5, D) for x in (st_number, yade))
    assert lost / lost_yade == pytest.approx(4.5, rel=1e-9)


@given(st_number=st.floats(0.0, 1e6), more=st.floats(1.0, 10.0), e_dry=st.floats(0.0, 1.0))
def test_restitution_is_between_zero_and_dry_and_never_decreases_with_stokes_number(st_number, more, e_dry):
    for law in (
        lambda x: immersed.restitution_exponential(e_dry, x, 35.0),
        lambda x: immersed.restitution_davis(e_dry, x, 1e-5, D),
    ):
        assert 0.0 <= law(st_number) <= law(st_number * more) <= e_dry


def test_restitution_is_dry_at_large_stokes_numbers_and_zero_at_small_ones():
    assert immersed.restitution_exponential(0.9, 1e5, 35.0) == pytest.approx(0.9, rel=1e-3)
    assert immersed.restitution_exponential(0.9, 10.0, 35.0) < 0.03
    assert immersed.restitution_davis(0.9, 1e5, 1e-5, D) == pytest.approx(0.9, rel=1e-3)
    assert immersed.restitution_davis(0.9, 3.9, 1e-5, D) == 0.0  # ln(50) = 3.91
    assert immersed.restitution_davis(0.9, 4.0, 1e-5, D) > 0.0


def test_roughness_beyond_the_radius_gives_no_energy():
    assert immersed.restitution_davis(0.9, 1.0, D, D) == 0.9


@given(gap=st.floats(0.0, 1e-3), closing=st.floats(-1.0, 1.0))
def test_the_film_opposes_the_motion_within_its_reach_only(gap, closing):
    force = immersed.lubrication_force(gap, closing, 5e-4, 1e-6, 2e-4, RHO, NU)
    assert force * closing >= 0.0
    if gap >= 2e-4:
        assert force == 0.0


def test_the_film_begins_without_a_jump_and_ends_in_touch():
    def force(gap):
        return immersed.lubrication_force(gap, 0.1, 5e-4, 1e-6, 2e-4, RHO, NU)

    assert force(2e-4 * (1 - 1e-9)) < 1e-8 * force(0.0)
    assert force(0.0) == pytest.approx(6.0 * math.pi * RHO * NU * 25e-8 * 0.1 * (1e6 - 1 / 2.01e-4), rel=1e-9)
    assert force(-1e-9) == 0.0
