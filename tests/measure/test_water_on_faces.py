"""Still water on triangles against closed forms: displaced weight, and the centre of pressure on a plate."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.measure.made_rows import DX, DZ, WIDTH, G, row_of, run_of

from ryusa.measure.water_on_faces import in_pieces, water_line, water_on_triangles
from ryusa.model.row import RowDam

RHO = 1000.0
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def box(low: Any, high: Any) -> np.ndarray:
    """Triangles of a box, normals outwards; corners are numbered by x, y and z."""
    unit = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    corner = np.asarray(low) + unit * (np.asarray(high) - np.asarray(low))
    return corner[[(a, *two) for a, b, c, d in SIDES for two in ((b, c), (c, d))]]


def line_of(surface: Any, *, dam: bool = False) -> Any:
    """The water of a row that begins at x = 0.1 m, at one frame."""
    row = row_of(ends=True)
    if dam:
        row = replace(row, solid=np.where(np.arange(8) == 4, 8, 0), dams=(RowDam("weir", 4, 5, 8 * DZ),))
    none = np.zeros((1, 1, 3))
    return water_line(run_of(row, np.zeros(1), none, none, surface=np.broadcast_to(surface, (1, 8))).row)


def load(line: Any, corners: np.ndarray, toe: tuple[float, float] = (0.0, 0.0), **how: Any) -> np.ndarray:
    return water_on_triangles(line, 0, *in_pieces(line, corners, **how), toe)


def turned(corners: np.ndarray, a: float, b: float) -> np.ndarray:
    """Turned about its middle, first about y, then about z."""
    middle, (c, s), (d, t) = corners.mean((0, 1)), (math.cos(a), math.sin(a)), (math.cos(b), math.sin(b))
    about = np.array([[d, -t, 0], [t, d, 0], [0, 0, 1]]) @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return (corners - middle) @ about.T + middle


@given(a=st.floats(-3.0, 3.0), b=st.floats(-3.0, 3.0))
def test_a_submerged_body_is_lifted_by_the_water_that_it_displaces(a: float, b: float) -> None:
    low, high = np.array([0.13, 0.003, 0.018]), np.array([0.15, 0.007, 0.021])
    middle = 0.5 * (low + high)
    found = load(line_of(0.04), turned(box(low, high), a, b), (middle[0], middle[2]))
    lift = RHO * G * np.prod(high - low)
    assert found == pytest.approx([0.0, lift, 0.0, found[3]], abs=1e-10 * lift)


def test_a_box_half_in_the_water_is_lifted_by_half_of_that() -> None:
    low, high = (0.12, 0.002, 0.004), (0.15, 0.008, 0.010)  # borders and middles of segments
    found = load(line_of(0.007), box(low, high), (0.1, 0.0))
    lift = RHO * G * 0.03 * 0.006 * 0.003
    assert found == pytest.approx([0.0, lift, -lift * 0.035, found[3]], abs=1e-12)


def test_where_the_surface_falls_it_pushes_along_the_fall() -> None:
    x = 0.1 + (np.arange(8) + 0.5) * DX
    low, high = (0.127, 0.002, 0.004), (0.151, 0.008, 0.010)
    volume, fall = 0.024 * 0.006 * 0.006, 0.05
    found = load(line_of(0.03 - fall * x), box(low, high))
    assert found[:2] == pytest.approx([RHO * G * volume * fall, RHO * G * volume], rel=1e-9)


def test_no_water_lifts_what_stands_on_the_floor() -> None:
    found = load(line_of(0.010), box((0.12, 0.0, 0.0), (0.15, WIDTH, 0.004)))
    assert found[:2] == pytest.approx([0.0, -RHO * G * 0.03 * WIDTH * 0.006], abs=1e-12)


@pytest.mark.parametrize("angle", [30.0, 75.0, 90.0])
def test_an_inclined_plate_is_pushed_at_its_centre_of_pressure(angle: float) -> None:
    """It stands on the floor and out of the water: F = rho g h l/2 per width at l/3 along it."""
    theta, h, x = math.radians(angle), 0.006, 0.13
    long = h / math.sin(theta)
    top = (x + 2 * long * math.cos(theta), 2 * h)
    (a, b), (c, d) = (((x, y, 0.0), (top[0], y, top[1])) for y in (0.0, WIDTH))
    plate = np.array([[a, b, d], [a, d, c]])  # its normal points upstream
    found = load(line_of(h), plate, (x, 0.0))
    force = 0.5 * RHO * G * h * long * WIDTH
    assert found[:2] == pytest.approx([force * math.sin(theta), -force * math.cos(theta)], rel=1e-7)
    assert found[2] == pytest.approx(force * long / 3.0, rel=1e-7)
    assert found[3] == pytest.approx(force * math.sin(theta) * h / 3.0, rel=1e-7)


def test_a_face_at_a_dam_has_the_water_of_its_own_side_and_none_within_the_dam() -> None:
    line = line_of(np.where(np.arange(8) < 4, 0.010, np.where(np.arange(8) == 4, 0.009, 0.002)), dam=True)
    shell = box((0.1 + 4 * DX, 0.0, 0.0), (0.1 + 5 * DX, WIDTH, 8 * DZ))
    found = load(line, shell)
    assert found[0] == pytest.approx(0.5 * RHO * G * WIDTH * (0.010**2 - 0.006**2 - 0.002**2))
    within = box((0.1 + 4 * DX + 1e-4, 0.0, 0.0), (0.1 + 5 * DX - 1e-4, WIDTH, 7 * DZ))
    assert load(line, within).tolist() == [0.0] * 4


def test_water_ends_at_side_walls_and_at_the_ends_of_the_row() -> None:
    line, wide = line_of(0.02), box((0.12, -0.5, 0.005), (0.13, 0.5, 0.01))
    assert load(line, wide, sides=(0.0, WIDTH))[1] == pytest.approx(RHO * G * 0.01 * WIDTH * 0.005)
    assert load(line, box((0.3, 0.0, 0.0), (0.4, 0.01, 0.1))).tolist() == [0.0] * 4
