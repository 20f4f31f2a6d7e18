"""Threads that share an exchange with a row of columns: the bits are those of one thread."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.water.test_row_dams import N, dammed
from tests.water.test_row_grains import D, cloud

from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import Fluctuations, Hindrance, Pressure
from ryusa.model.fluid import N_IMPULSE
from ryusa.water import row_threads
from ryusa.water.row_grains import GrainsInRow
from ryusa.water.row_threads import RowThreads, equal_parts, equal_work

STATE = "u", "volume", "content", "wet", "surface", "passed", "profiles", "edges", "budgets"


@pytest.mark.parametrize("pressure", list(Pressure))
@pytest.mark.parametrize("fluctuations", [Fluctuations.NONE, Fluctuations.RANDOM_WALK])
def test_the_bits_do_not_depend_on_threads(monkeypatch, fluctuations, pressure):
    """Grains that move beside a dam, over an inclined bottom."""
    monkeypatch.setattr(row_threads, "SHARED", 1)
    row, at = dammed(0.05, False)
    row = replace(row, column=replace(row.column, fluctuations=fluctuations, seed=4), pressure=pressure)
    made, first = cloud(at=at, length=math.inf, tilt=0.05, hindrance=Hindrance.DI_FELICE)
    made = replace(made, world_low=(-math.inf,) * 3)
    state = GrainsInRow.begin(made, row, at).at_rest(np.full(N, 0.05))
    state = replace(state, u=0.2 + 0.0 * state.u)
    each = [(state, GrainsInRow.begin(made, row, at, state, RowThreads(n))) for n in (1, 2, 5)]
    engine = CpuEngine()
    engine.load(made, first)
    for _ in range(4):
        engine.set_fluid(each[0][1].sampled)
        engine.advance(20).raise_if_any()
        x, v, impulse = engine.kinematics()
        each = [(one.exchange(now, x, v, impulse, 20 * made.dt), one) for now, one in each]
        (alone, grains), *shared = each
        for now, one in shared:
            own = () if alone.w is None else ("w", "pressure")
            assert all(getattr(now, name).tobytes() == getattr(alone, name).tobytes() for name in STATE + own)
            assert one.sampled.tobytes() == grains.sampled.tobytes()
            assert (one.fastest, one.worst) == (grains.fastest, grains.worst)
    assert np.abs(x - at).max() > 0.01 * D


def test_the_first_grain_that_is_nowhere_is_named_by_any_number_of_threads(monkeypatch):
    monkeypatch.setattr(row_threads, "SHARED", 1)
    row, at = dammed(0.0, False)
    made, _ = cloud(at=at, length=math.inf, tilt=0.0)
    state = GrainsInRow.begin(made, row, at).at_rest(np.full(N, 0.05))
    lost = at.copy()
    lost[[7, len(at) - 2], 2] = np.nan
    for n in (1, 3):
        grains = GrainsInRow.begin(made, row, at, state, RowThreads(n))
        with pytest.raises(ValueError, match="the place of grain 7 is not finite"):
            grains.exchange(state, lost, 0.0 * at, np.zeros((len(at), N_IMPULSE)), 1e-4)


def test_parts_cover_all_grains_and_all_segments():
    row, at = dammed(0.0, False)
    made, _ = cloud(at=at, length=math.inf, tilt=0.0)
    places = GrainsInRow.begin(made, row, at)._places
    for parts in (1, 2, 3, 40):
        rows, segments = equal_parts(len(at), parts), equal_work(places, N + 2, parts)
        assert (rows[0], rows[-1], segments[0], segments[-1]) == (0, len(at), 0, N + 2)
        assert rows == sorted(rows)
        assert segments == sorted(segments)
