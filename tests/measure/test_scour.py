"""Scour below a dam: a hole that is dug comes back, and what has none is refused."""

import numpy as np
import pytest
from tests.measure.made_rows import DX, DZ, D, layered, row_of, run_of

from ryusa.errors import ResultsError
from ryusa.measure.scour import schoklitsch, scour
from ryusa.model.row import RowDam

T = np.arange(0.0, 1.05, 0.1)
BED, DEEP = 0.012, 0.006


def dug(**more):
    """A bed of 14 segments behind a dam of one, and a hole that grows to 6 mm at the third of them."""
    row = row_of(20, ends=True)
    object.__setattr__(row, "dams", (RowDam("weir", 4, 5, 0.02), RowDam("end sill", 18, 20, 0.012)))
    phi = np.zeros((len(T), 20, row.column.n))
    surface, q = np.full((len(T), 20), 0.02), np.zeros((len(T), 21))
    surface[:, :5], q[:, 5] = 0.03, 0.002
    for m, t in enumerate(T):
        levels = np.full(20, BED)
        levels[5:9] -= DEEP * t * np.array([0.25, 0.5, 1.0, 0.25])
        levels[:5], levels[18:] = 0.0, 0.0
        phi[m] = layered(row, np.round(levels / DZ) * DZ, 0.0)
    still = np.zeros((len(T), 3, 3))
    return run_of(row, T, still, still, phi=phi, surface=surface, discharge=q, **more)


def test_a_hole_that_is_dug_has_its_depth_place_length_and_volume():
    found = scour(dug(), begin=0.0)
    assert found.depth[[0, -1]] == pytest.approx([0.0, DEEP], abs=0.4 * DZ)
    assert found.at[-1] == pytest.approx(2.5 * DX) and found.length[-1] == pytest.approx(4.0 * DX)
    assert found.volume[-1] == pytest.approx(DEEP * 2.0 * DX, rel=0.1)
    assert found.head == pytest.approx(0.01, abs=2e-3) and found.tail == pytest.approx(0.02 - BED, abs=DZ)
    assert found["depth"].value == pytest.approx(0.5 * DEEP, rel=0.1)
    assert found.expected == schoklitsch(float(found.head.mean()), 0.002, D) - float(found.tail.mean())
    end = 1e3 * (schoklitsch(float(found.head.mean()), 0.002, D) - float(found.tail.mean()))
    (note,) = found.averages.notes
    assert "behind dam 'weir'" in note and f"Schoklitsch 1932 expects {1e-3 * end:.3g} m" in note


def test_depth_counts_from_the_bed_of_the_first_frame_in_the_window():
    run = dug()
    assert scour(run, begin=0.5).depth[-1] == pytest.approx(0.5 * DEEP, abs=DZ)
    levels = BED - 0.1 * DX * np.arange(20)
    levels[:5] = levels[18:] = 0.0
    run.row._of["phi"][:] = layered(run.row.row, np.round(levels / DZ) * DZ, 0.0)
    still = scour(run, begin=0.0)
    assert not still.depth.any() and not still.length.any() and not still.volume.any()
    assert np.isnan(still.at).all()
    run.row._of["phi"][5:] = layered(run.row.row, np.round(levels / DZ) * DZ + 2.0 * DZ * (levels > 0.0), 0.0)
    grown = scour(run, begin=0.0)
    assert not grown.depth.any() and "0 m deep at the end, counted from t = 0 s" in grown.averages.notes[0]


def test_the_head_is_vertical_and_taken_at_the_face_of_the_dam():
    run = dug()
    run.row._of["surface"][:, :5] = [0.05, 0.045, 0.04, 0.035, 0.03]
    assert scour(run, begin=0.0).head == pytest.approx(0.035 - 0.02 + 0.01 * 13.0 * DX, rel=1e-3)
    run.row._of["phi"][:, 7] = 0.0
    note = scour(run, begin=0.0).averages.notes[0]
    assert "dug to the floor" not in note  # there was no bed from the start
    run.row._of["phi"][0] = run.row._of["phi"][0, 10]
    assert "dug to the floor" in scour(run, begin=0.0).averages.notes[0]


def test_without_water_over_the_dam_nothing_is_expected():
    run = dug()
    run.row._of["discharge"][:] = 0.0
    assert np.isnan(scour(run, begin=0.0).expected)


def test_rows_without_a_dam_a_bed_or_time_are_refused():
    run = dug()
    with pytest.raises(
        ResultsError, match=r"no dam 'wier': the row has weir, end sill\. Did you mean 'weir'"
    ):
        scour(run, begin=0.0, dam="wier")
    with pytest.raises(ResultsError, match="1 frames from 1 to inf s"):
        scour(run, begin=1.0)
    with pytest.raises(ResultsError, match="0 segments of bed behind dam 'end sill'"):
        scour(run, begin=0.0, dam="end sill")
    bare = row_of(8, ends=True)
    with pytest.raises(ResultsError, match="a row of columns with a dam"):
        scour(run_of(bare, T, np.zeros((len(T), 1, 3)), np.zeros((len(T), 1, 3))), begin=0.0)
