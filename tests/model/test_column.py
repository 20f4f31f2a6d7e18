"""Columns that cannot be, and numbers that contradict each other."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ryusa.laws.families import BedKind, Drive, Mixing, SideWalls, SurfaceRule
from ryusa.model.column import Column, Top, WaterState, refuse

GOOD = Column(z_low=0.0, dz=5e-4, n=40, depth=0.02)


def test_a_good_column_is_not_refused():
    assert GOOD.refuses() == ()
    assert GOOD.z[[0, -1]] == pytest.approx([2.5e-4, 0.01975])
    assert (len(GOOD.faces), GOOD.faces[-1]) == (41, pytest.approx(GOOD.z_high))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"depth": -0.01}, "below the bed"),
        ({"dz": -1e-3}, "thickness"),
        ({"n": 1}, "at least 2"),
        ({"n": 20}, "below the surface at 0.02 m: 40 cells"),
        ({"z_low": 0.01, "z_bed": 0.0, "bed": BedKind.MOVING}, "above the bed"),
        ({"z_low": -0.1, "z_bed": 0.0, "bed": BedKind.MOVING}, "below the bed"),
        ({"z_low": -0.1, "z_bed": 0.0, "n": 300}, "bottom of the column"),
        ({"bed": BedKind.ROUGH}, "roughness"),
        ({"bed": BedKind.ROUGH, "k_rough": 0.02}, "k_rough/30"),
        ({"bed": BedKind.MOVING, "mixing": Mixing.VAN_DRIEST}, "needs a wall"),
        ({"top": Top.LID, "surface": SurfaceRule.VOLUME}, "lid"),
        ({"side": SideWalls.BLASIUS}, "width"),
        ({"drive": Drive.TAU}, "tau"),
        ({"drive": Drive.DISCHARGE}, "discharge"),
        ({"k_f": 0.16}, "k_f"),
        ({"nu": 0.0}, "nu"),
    ],
)
def test_a_bad_column_is_refused_with_the_reason(change, says):
    faults = replace(GOOD, **change).refuses()
    assert any(says in fault for fault in faults), faults


SLOPE = math.atan(1 / 20)


def test_the_papers_saltation_agrees_with_itself():
    assert refuse(depth=0.02, slope=SLOPE, tau_star=0.3, d=0.002) == ()


def test_contradicting_stress_slope_and_depth_are_refused_with_a_remedy():
    (fault,) = refuse(depth=0.05, slope=SLOPE, tau_star=0.3, d=0.002)
    assert "tau_star = 0.3 and slope = 0.05 and depth = 0.05 m contradict each other" in fault
    assert "a depth of 0.01982 m" in fault
    assert "tau_star = 0.7566" in fault


def test_two_stresses_that_differ_are_refused():
    (fault,) = refuse(depth=0.02, u_star=0.2, tau_star=0.3, d=0.002)
    assert "contradict" in fault
    assert refuse(depth=0.02, u_star=0.0985, tau_star=0.3, d=0.002) == ()


def test_water_on_a_flat_bed_may_have_any_stress():
    assert refuse(depth=0.5, slope=0.0, tau_star=0.3, d=0.002) == ()
    assert refuse(depth=0.5, tau_star=0.3, d=0.002) == ()


def test_a_bed_that_rises_downstream_is_refused():
    (fault,) = refuse(depth=0.02, slope=-SLOPE, u_star=0.1)
    assert "rises" in fault


@pytest.mark.parametrize("name", ["tau_star", "u_star"])
def test_a_stress_below_zero_is_refused(name):
    (fault,) = refuse(depth=0.02, d=0.002, **{name: -1.0})
    assert name in fault


def test_water_at_rest_fills_the_pores_up_to_the_surface():
    c = replace(GOOD, depth=0.01025)
    state = WaterState.at_rest(c, np.full(c.n, 0.4))
    assert state.content.sum() == pytest.approx(0.6 * 0.01025)
    assert state.content[20] == pytest.approx(0.6 * 0.00025)
    assert (state.content[21:] == 0.0).all()
