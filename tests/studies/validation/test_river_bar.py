"""How far a run over a bar is off, by runs whose harmonics and shift are known."""

import numpy as np
import pytest

from ryusa.model.arrays import Floats
from ryusa_studies.validation import river_bar as over


def run(shift: float = 0.0, factor: float = 1.0) -> dict[str, Floats]:
    """What was measured, later and higher, at the times of a run that begins a period before."""
    measured = list(over.measured().values())
    t = np.arange(measured[0][0, 0] - over.PERIOD, over.END, over.EACH)
    phase = 2.0 * np.pi / over.PERIOD * np.arange(1, 9)
    surfaces: list[Floats] = []
    for one in measured:
        columns = [np.hstack([np.cos(np.outer(at, phase)), np.sin(np.outer(at, phase))])
                   for at in (one[:, 0], t - shift)]  # fmt: skip
        surfaces.append(factor * columns[1] @ np.linalg.lstsq(columns[0], one[:, 1], rcond=None)[0])
    return {"t": t, "surface": np.array(surfaces)}


@pytest.mark.parametrize("shift", [0.0, 0.7, 2.0])
def test_a_run_like_what_was_measured_is_near_whatever_its_clock(shift: float) -> None:
    harmonic, series, told = over.off(run(shift))
    assert harmonic < 0.02
    assert series < 0.07  # two periods are not quite alike in the flume
    assert list(told) == ["3.04 m", "9.44 m", "20.04 m", "26.04 m", "30.44 m", "37.04 m"]


def test_waves_that_are_too_high_are_off_by_their_excess() -> None:
    own, high = over.off(run()), over.off(run(factor=1.5))
    squares = [sum(float((one**2).sum()) for one, _ in list(told.values())[1:]) for _, _, told in (own, high)]
    first = float(next(iter(own[2].values()))[0][0])
    assert high[0] == pytest.approx(0.5 * np.sqrt(squares[0] / 20.0) / first, rel=0.05)
    assert high[1] == pytest.approx(0.5, rel=0.05)
