"""Crossings of the end of a period, by hand: times, places, and grains that go back and forth."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ryusa.casefile.row.reach_record import _crossings

LENGTH, LOW = 0.5, 0.25  # of the period, and where it begins [m]


def crossings(x: list[list[float]], **more: Any) -> tuple[dict[str, Any], Any, int]:
    """Those of grains whose centres along x are given by frame, one each second, with z = 0.1 t."""
    n = len(x[0])

    def frame(k: int) -> SimpleNamespace:
        place = np.zeros((n, 3))
        place[:, 0], place[:, 1], place[:, 2] = x[k], more.get("y", 0.0), 0.1 * k
        v = np.full((n, 3), [1.0 + k, 0.0, 0.0])
        return SimpleNamespace(t=float(k), x=place, v=v, omega=2.0 * v)

    class Frames:
        def __getitem__(self, k: int) -> SimpleNamespace:
            return frame(k)

    scene = SimpleNamespace(d=np.arange(1.0, n + 1.0), solid_volume=np.full(n, 2.0))
    run: Any = SimpleNamespace(frames=Frames(), scene=scene)
    return _crossings(run, np.arange(len(x)), LENGTH, LOW)


def test_a_crossing_lies_between_two_frames_in_proportion() -> None:
    found, moved, backwards = crossings([[0.3, 0.7], [0.65, 0.9], [0.85, 1.1]])
    assert found["t"].tolist() == pytest.approx([0.25, 1.5])  # the end of the period is at 0.75
    assert found["d"].tolist() == [2.0, 1.0]
    assert found["z"].tolist() == pytest.approx([0.025, 0.15])
    assert found["v"][:, 0].tolist() == pytest.approx([1.25, 2.5])
    assert found["omega"][:, 0].tolist() == pytest.approx([2.5, 5.0])
    assert moved.tolist() == pytest.approx([2.0 * 0.55, 2.0 * 0.4])
    assert backwards == 0


def test_a_grain_that_goes_more_than_a_period_between_two_frames_crosses_twice() -> None:
    found, _, _ = crossings([[0.5], [1.5]])
    assert found["t"].tolist() == pytest.approx([0.25, 0.75])


@pytest.mark.parametrize(
    ("x", "times", "left"),
    [
        ([0.7, 0.8, 0.7, 0.8], [2.5], 0),  # over, back, and over again
        ([0.7, 0.8, 0.7], [], 0),
        ([0.8, 0.7, 0.8], [], 0),  # it was over from the start
        ([0.8, 0.7, 0.8, 1.3], [2.9], 0),
        ([0.8, 0.7], [], 1),
    ],
)
def test_a_crossing_upstream_undoes_one_downstream(x: list[float], times: list[float], left: int) -> None:
    found, _, backwards = crossings([[one] for one in x])
    assert found["t"].tolist() == pytest.approx(times)
    assert backwards == left
