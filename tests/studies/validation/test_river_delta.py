"""Front and slope of a delta, on lines whose front and slope are known."""

import math

import numpy as np
import pytest

from ryusa_studies.validation import river_delta as delta

DX, HIGH, REPOSE = 0.015, 0.06, math.radians(30.0)
X = (np.arange(80) + 0.5) * DX


def bed(brink: float) -> np.ndarray:
    """A topset that falls by 0.05, a front at the angle of repose from `brink` on, the level floor [m]."""
    top = HIGH + 0.05 * (brink - X)
    return np.where(brink > X, top, np.maximum(HIGH - (X - brink) * math.tan(REPOSE), 0.0))


@pytest.mark.parametrize("brink", [0.703, 0.71, 0.8])
def test_front_and_slope_of_a_known_delta(brink: float) -> None:
    line = bed(brink)
    middle = brink + 0.5 * HIGH / math.tan(REPOSE)
    assert delta._front(X, line) == pytest.approx(middle, abs=0.4 * DX)  # the topset is higher upstream
    assert delta._front(X, bed(brink + 0.03)) - delta._front(X, line) == pytest.approx(0.03, abs=0.1 * DX)
    near = slice(
        int(np.searchsorted(X, middle - delta.LIP)), int(np.searchsorted(X, middle + 1.5 * delta.LIP))
    )
    assert delta._slope(line[near], DX) == pytest.approx(math.tan(REPOSE), rel=0.02)
    assert delta._foot(X, line) == pytest.approx(brink + HIGH / math.tan(REPOSE), abs=1.5 * DX)


def test_both_flanks_of_a_pile_have_its_slope() -> None:
    line = np.maximum(HIGH - np.abs(X - 0.6) * math.tan(REPOSE), 0.0)
    for way in (1, -1):
        assert delta._slope(line[::way], DX) == pytest.approx(math.tan(REPOSE), rel=1e-9)


def test_there_is_no_front_without_a_deposit() -> None:
    assert math.isnan(delta._front(X, np.zeros(80)))


def test_grains_that_rolled_ahead_are_not_the_front() -> None:
    line = bed(0.8)
    ahead = line.copy()
    ahead[70] = 0.012
    assert delta._front(X, ahead) == delta._front(X, line)
    assert delta._foot(X, ahead) == delta._foot(X, line)
