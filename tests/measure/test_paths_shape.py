"""Shapes of ways: sawteeth of known height and number, straight ways, noise, and who meets bed and movers."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.errors import ResultsError
from ryusa.measure import alternating, paths
from ryusa.measure.paths import _zigzag
from ryusa.model import EVENT
from ryusa.model.scene import EventRule

D = 0.002
T = np.arange(2001) * 1.0e-3


def sawtooth(count, height, t=T):
    """Rises and falls by `height`, `count` times up and down a second, from the lowest point on."""
    phase = (t * count) % 1.0
    return height * (1.0 - np.abs(2.0 * phase - 1.0))


def moved(make, *ways, speed=0.1, events=None):
    x = np.zeros((len(T), len(ways), 3))
    x[:, :, 0] = speed * T[:, None]
    x[:, :, 2] = np.array(ways).T
    return make.run_of(T, x, 0.0 * x, np.zeros(0, EVENT) if events is None else events)


def test_a_sawtooth_has_its_number_of_reversals_and_its_vertical_path(make):
    run = moved(make, 3 * D + sawtooth(5, 0.4 * D), 3 * D + sawtooth(20, 0.1 * D))
    found = paths(run, begin=0.0)
    assert found.begin == pytest.approx([0.0, 1.0])
    assert found.reversals[0] == pytest.approx([9.0, 39.0])  # between the ends of the window
    assert found.way_z[0] == pytest.approx([10 * 0.4 * D, 40 * 0.1 * D])
    assert found.range_z == pytest.approx(np.tile([0.4 * D, 0.1 * D], (2, 1)))
    assert found.advance == pytest.approx(0.1)
    assert found.jaggedness[0, 0] == pytest.approx(40 * D)
    assert found.averages["jaggedness"].value == pytest.approx(40 * D)


def test_a_straight_path_has_no_reversal_and_a_level_one_no_jaggedness(make):
    found = paths(moved(make, 3 * D + 0 * T, 3 * D + 0.5 * D * T, 3 * D - 0.5 * D * T), begin=0.0)
    assert not found.reversals.any()
    assert not found.way_z[:, 0].any()
    assert found.way_z[0, 1:] == pytest.approx(0.5 * D)


def test_motion_below_the_threshold_is_no_reversal(make):
    noise = np.random.default_rng(1).uniform(-0.5, 0.5, len(T)) * 0.019 * D
    run = moved(make, 3 * D + noise, 3 * D + sawtooth(4, D) + noise)
    found = paths(run, begin=0.0)
    assert found.reversals[0] == pytest.approx([0.0, 7.0])
    assert found.way_z[0, 0] == 0.0
    assert found.way_z[0, 1] == pytest.approx(8 * D, rel=0.02)
    assert paths(run, begin=0.0, threshold=0.001).reversals[0, 0] > 100


@given(z=st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=30), threshold=st.floats(0.01, 1.0))
def test_paths_between_reversals_are_longer_than_the_threshold_and_no_longer_than_the_whole(z, threshold):
    turns, way = np.zeros(1), np.zeros(1)
    _zigzag(np.array(z)[:, None], np.array([threshold]), turns, way)
    assert way[0] <= np.abs(np.diff(z)).sum() + 1e-12
    assert way[0] >= (turns[0] + (way[0] > 0)) * threshold - 1e-12
    again = np.zeros(1)
    _zigzag(-np.array(z)[:, None], np.array([threshold]), again, way)
    assert again[0] == turns[0]


def test_time_at_the_bed_follows_from_the_height_of_the_centre(make):
    low = np.where(T % 1.0 < 0.25, 1.4 * D, 3 * D)
    found = paths(moved(make, low), begin=0.0)
    assert found.near[0, 0] == pytest.approx(0.25, abs=0.002)
    assert found.above_crest[0, 0] == pytest.approx(0.25 * 0.4 * D + 0.75 * 2 * D, rel=0.01)
    assert found.rows()[0]["grain"] == 0


def test_a_window_that_the_run_does_not_hold_is_refused(make):
    run = moved(make, 3 * D + 0 * T)
    with pytest.raises(ResultsError, match="no whole window"):
        paths(run, begin=1.5)
    with pytest.raises(ResultsError, match="frames in a window"):
        paths(run, begin=0.0, window=0.005)


def test_alternations_between_bed_and_movers_are_counted_from_contacts(make):
    bed, other = 4, 1  # ids of a fixed grain and a free one; four grains are free
    order = [(0, bed), (0, other), (0, bed), (2, bed), (2, bed), (2, 3)]
    rows = [make.event(i, j, 0.1 * (k + 1), (0, 0), (0, 0), (0, 0)) for k, (i, j) in enumerate(order)]
    run = moved(make, *[3 * D + 0 * T] * 4, events=np.array(rows, EVENT))
    found = alternating(run, begin=0.0, turns=1)
    assert found.by == "contacts"
    assert dict(zip(found.grains.tolist(), found.turns.tolist(), strict=True)) == {0: 2, 2: 1}
    assert alternating(run, begin=0.0).grains.tolist() == [0]
    assert alternating(run, begin=0.25, turns=1).grains.tolist() == [2]


def test_without_contacts_alternations_follow_from_heights(make):
    goes = 1.3 * D + sawtooth(3, D)
    hovers = 1.6 * D + sawtooth(3, 0.3 * D)  # never clear of the bed
    run = moved(make, hovers, goes)
    run.scene = replace(run.scene, events=EventRule.NONE)
    found = alternating(run, begin=0.0, end=1.0)
    assert found.by == "heights"
    assert found.grains.tolist() == [1]
    assert found.turns.tolist() == [6]
