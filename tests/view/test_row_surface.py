"""The surface along a row of columns, as pages and films draw it."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, RowEnd
from ryusa.results.water import WaterFrames
from ryusa.view.box import box_of
from ryusa.view.flow import SurfaceLine, surface_line, surfaces
from ryusa.view.picture import DEEP_ALPHA, Painter

SLOPE = 0.1  # of the bottom
X = 2.0 + 0.5 * np.arange(4) + 0.25


def run_of(depths: Any, *, ends: bool) -> Any:
    """Results that have water of some depths [m], shape (n_frame, 4), over an inclined bottom."""
    end = RowEnd(EndKind.WALL) if ends else None
    bottom = SLOPE * (4.0 - X) if ends else np.zeros(4)
    row = ColumnRow(Column(-0.1, 0.01, 100, 0.5), 0.5, bottom, 9.81, end, end, x_low=2.0)
    t = np.arange(len(depths)) * 1.0
    found = {name: np.zeros((len(t), *shape)) for name, shape in row.frame_shapes().items()}
    shown = WaterFrames(row, t, **(found | {"surface": bottom + np.asarray(depths)}))
    return SimpleNamespace(row=shown, water=None, scene=SimpleNamespace(water=None))


def test_a_level_pond_over_an_inclined_bottom_is_a_level_line_from_end_to_end() -> None:
    depth = 0.5 - SLOPE * (4.0 - X)
    run = run_of([depth], ends=True)
    line = surface_line(run)
    assert line is not None and math.isinf(line.period)
    assert line.x == pytest.approx([2.0, *X, 4.0]) and line.z[0] == pytest.approx(0.5)
    assert surfaces(run) == pytest.approx([depth.mean() - 0.1])  # over the lowest cell, as the speeds


def test_a_dry_stretch_parts_the_line() -> None:
    line = surface_line(run_of([[0.1, 0.1, 0.0, 0.1]], ends=True))
    assert line is not None
    parts = line.within(line.at(0, 0.0), 0.0, 9.0)
    assert [x.tolist() for x, _, _ in parts] == [[2.0, 2.25, 2.75], [3.75, 4.0]]
    inner = line.within(line.at(0, 0.0), 2.1, 2.6)
    ((x, z, bottom),) = inner
    assert x == pytest.approx([2.1, 2.25, 2.6]) and bottom == pytest.approx(SLOPE * (4.0 - x))
    assert z[1:] == pytest.approx(0.1 + bottom[1:])


def test_between_two_frames_the_line_moves_evenly_and_a_segment_that_falls_dry_at_once() -> None:
    line = surface_line(run_of([[0.1, 0.1, 0.1, 0.1], [0.2, 0.2, 0.2, 0.0]], ends=False))
    assert line is not None
    assert line.at(0, 0.25)[1:4] == pytest.approx(0.125)
    assert line.at(0, 0.25)[4] == pytest.approx(0.1) and math.isnan(line.at(0, 0.75)[4])
    assert line.at(1, 0.0)[1] == pytest.approx(0.2)


def test_a_periodic_line_goes_on_around_a_grain_that_is_followed() -> None:
    x = np.array([0.0, 0.25, 0.75, 1.0])
    z = np.array([[2.0, 1.0, 3.0, 2.0]])
    line = SurfaceLine(x, z, z[0] - 1.0, 1.0)
    ((places, heights, bottom),) = line.within(line.at(0, 0.0), 5.5, 6.5)
    assert places == pytest.approx([5.5, 5.75, 6.0, 6.25, 6.5])
    assert heights == pytest.approx([2.0, 3.0, 2.0, 1.0, 2.0])
    assert bottom == pytest.approx(heights - 1.0)
    ((whole, _, _),) = line.within(line.at(0, 0.0), 0.0, 1.0)
    assert whole == pytest.approx(x)


@pytest.mark.parametrize("ends", [False, True])
def test_a_picture_from_the_side_has_water_between_the_surface_and_the_bottom(ends: bool) -> None:
    run = run_of([[0.1, 0.1, 0.1, 0.1]], ends=ends)
    painter: Any = object.__new__(Painter)
    faces: list[Any] = []
    painter._line = surface_line(run)
    painter.look = SimpleNamespace(view="side")
    low, high = np.array([2.0, 0.0, -5.0]), np.array([4.0, 1.0, 1.0])
    painter._add_row(0, 0.0, low, high, lambda *_: None, lambda *one: faces.append(one))
    deep = np.concatenate([corners for corners, _, alpha, _ in faces if alpha == DEEP_ALPHA])
    assert len(deep) == 5 * 4 and (deep[:, 1] == 1.0).all()
    bottom = SLOPE * (4.0 - deep[:, 0]) if ends else 0.0 * deep[:, 0]
    over = (deep[:, 2] - bottom).reshape(5, 4)
    assert over[:, 2:] == pytest.approx(0.0, abs=1e-12)
    assert over[1:-1, :2] == pytest.approx(0.1)


@pytest.mark.parametrize(("deep", "top"), [(0.9, 0.9), (1.1, 0.05)])
def test_the_box_of_a_row_holds_water_up_to_half_of_its_length_over_a_thin_bed(
    deep: float, top: float
) -> None:
    """Grains 5 cm high under deeper water at one end of a row of 2 m."""
    run = run_of([[deep, 0.1, 0.1, 0.1]], ends=False)
    run.scene = SimpleNamespace(
        d_fixed=np.zeros(0), x_fixed=np.zeros((0, 3)), period=(math.inf, math.inf), walls=None, water=None
    )
    centres = np.array([[2.025, 0.0, 0.025], [3.975, 0.0, 0.025]])
    low, high = box_of(run, np.full(2, 0.05), [centres])
    assert (low[2], high[2]) == pytest.approx((0.0, top))


def test_without_a_row_there_is_no_line() -> None:
    assert surface_line(SimpleNamespace(row=None)) is None
