"""Waves of the bed of a periodic row: made waves come back, and what is no row of that kind is refused."""

import numpy as np
import pytest
from tests.measure.made_rows import CELLS, DZ, PACKED, row_of, run_of

from ryusa.errors import ResultsError
from ryusa.measure.bed_waves import bed_waves, waves_of


def test_waves_that_go_upstream_under_their_surface_come_back():
    """Two waves at once: one of 0.3 m goes upstream with 5 mm/s, its surface 20 deg downstream of it."""
    n, dx, t = 60, 0.01, np.arange(0.0, 20.0, 0.1)
    x = (np.arange(n) + 0.5) * dx
    k, lag = 2.0 * np.pi / 0.3, np.radians(20.0)
    bed = 0.002 * np.cos(k * (x + 0.005 * t[:, None])) + 0.001 * np.cos(2.0 * k * (x - 0.02 * t[:, None]))
    surface = 0.01 + 0.0024 * np.cos(k * (x + 0.005 * t[:, None]) - lag)
    found = waves_of(t, dx, bed, surface)
    assert found.length[:4] == pytest.approx([0.6, 0.3, 0.2, 0.15])
    assert found.bed[[1, 3]] == pytest.approx([0.004, 0.002])
    assert found.surface[1] == pytest.approx(0.0048)
    assert found.gain[[1, 3]] == pytest.approx([1.2, 0.0], abs=1e-9)
    assert found.phase[1] == pytest.approx(20.0)
    assert found.celerity[[1, 3]] == pytest.approx([-0.005, 0.02])
    assert found.steady[[1, 3]] == pytest.approx(1.0)
    assert found.bed[[0, 2]] == pytest.approx(0.0, abs=1e-12)


def test_waves_that_come_and_go_are_not_steady():
    rng = np.random.default_rng(2)
    found = waves_of(np.arange(400.0), 0.01, rng.normal(0.0, 1e-3, (400, 60)), np.zeros((400, 60)))
    assert (found.steady < 0.2).all()


def test_the_waves_of_a_run_are_those_of_the_top_of_its_grains():
    row, t = row_of(12), np.arange(0.0, 2.0, 0.1)
    z, x = (np.arange(CELLS) + 0.5) * DZ, 0.06 * np.cos(2.0 * np.pi * (row.x - 0.01 * t[:, None]) / 0.12)
    top = 0.01 + 0.05 * x
    phi = PACKED * np.clip((top[:, :, None] - z + 0.5 * DZ) / DZ, 0.0, 1.0)
    at = np.zeros((len(t), 2, 3))
    run = run_of(row, t, at, at, phi=phi, surface=top + 0.01)
    found = bed_waves(run, begin=0.0)
    assert found.bed[0] == pytest.approx(0.006, rel=0.1)
    assert found.celerity[0] == pytest.approx(0.01, rel=0.05)
    assert (found.gain[0], found.phase[0]) == (pytest.approx(1.0, abs=0.1), pytest.approx(0.0, abs=5.0))
    with pytest.raises(ResultsError, match=r"2 frames from 0 to 0\.1 s: waves need three or more"):
        bed_waves(run, begin=0.0, end=0.1)


def test_a_row_with_ends_and_a_short_one_are_refused():
    at = np.zeros((3, 2, 3))
    with pytest.raises(ResultsError, match="needs grains in a periodic row"):
        bed_waves(run_of(row_of(ends=True), np.arange(3.0), at, at), begin=0.0)
    with pytest.raises(ResultsError, match="5 segments: a wave needs 6"):
        bed_waves(run_of(row_of(5), np.arange(3.0), at, at), begin=0.0)
