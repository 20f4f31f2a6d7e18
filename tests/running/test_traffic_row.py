"""Feeds and exits in a row of columns: volume and momentum close at every frame, the same bits."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.running.test_traffic_column import RHO, STEPS, Books, G, along, fed, passed, weight_along

from ryusa.model import Scene, State
from ryusa.model.feeds import IN, OUT
from ryusa.model.fluid import EXTRA_X
from ryusa.model.row import ColumnRow
from ryusa.results import Results
from ryusa.running import loop as loop_module
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop
from ryusa.water import momentum_balance as m
from ryusa.water.row_coupling import RowCoupling

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

pytestmark = pytest.mark.full

SEGMENTS, EVERY = 4, 25


def in_row() -> tuple[Scene, State]:
    """The grains of `test_traffic_column`, in a period of four segments."""
    scene, state = fed()
    column = scene.column
    assert column is not None
    n = SEGMENTS
    row = ColumnRow(
        column, scene.period[0] / n, np.full(n, column.z_low), G, start=np.full(n, column.z_surface)
    )
    return replace(scene, flow=row), state


def carried_out(folder: Path, **how: Any) -> Results:
    made = in_row()
    dt = made[0].dt
    return run_scene(*made, folder, frames=EVERY * dt, stop=Stop(time=STEPS * dt), progress=False, **how)


@pytest.fixture(scope="module")
def books(tmp_path_factory: pytest.TempPathFactory) -> Books:
    kept = Books()
    record, exchange = loop_module.Loop._record, RowCoupling.exchange

    def exchanged(self: RowCoupling, *given: Any) -> Any:
        time, area = self.steps * self.scene.dt, self.row.column.area / self.row.n_segment
        found = exchange(self, *given)
        b = area * self.state.budgets.sum(axis=0)
        kept.given += float(b[m.B_GRAVITY] + b[m.B_BED] + b[m.B_SURFACE]) * time
        return found

    def recorded(self: Any) -> None:
        record(self)
        water, scene, state = self._water, self.scene, self.engine.state()
        area, content = water.row.column.area / water.row.n_segment, water.state.content
        elapsed = (self._step - (water.due - water.steps)) * scene.dt
        there = state.present
        owed = float(state.fluid.impulse[there, 0].sum())  # not given to the water yet
        archimedes = (scene.m_weight - scene.m)[there] * scene.gravity[0]
        owed += float((archimedes + state.fluid.sampled[there, EXTRA_X]).sum()) * elapsed
        of_water = RHO * area * float((0.5 * (content + np.roll(content, 1, axis=0)) * water.state.u).sum())
        kept.held.append(of_water + along(scene, state.v, state.bodies) - owed)
        kept.at_frames.append(kept.given)
        kept.water.append(float(water.state.volume.sum()) * area)
        kept.solid.append(float(water.phi.sum()) * water.row.column.dz * area)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(RowCoupling, "exchange", exchanged)
        patch.setattr(loop_module.Loop, "_record", recorded)
        kept.run = carried_out(tmp_path_factory.mktemp("fed") / "run")
    return kept


def test_water_and_grains_gain_what_bed_weight_and_passages_give_at_every_frame(books: Books) -> None:
    run, held = books.run, np.array(books.held)
    rows = run.passages
    assert (rows["way"] == IN).sum() > 40
    assert (rows["way"] == OUT).sum() > 10
    assert run.summary["water"]["momentum_residual"] < 1e-10
    crossed, scale = passed(run, rows["momentum"][:, 0]), np.abs(held).max()
    given = np.array(books.at_frames) + weight_along(run) + crossed
    assert np.abs(crossed).max() > 0.1 * scale
    np.testing.assert_allclose(held - held[0], given - given[0], rtol=0.0, atol=1e-12 * scale)


def test_grains_bring_their_volume_and_the_water_makes_room_for_it(books: Books) -> None:
    run, scene = books.run, books.run.scene
    row, found = scene.row, run.row
    assert row is not None and found is not None
    of_all = (scene.m - scene.m_weight) / RHO
    volume = np.isfinite(run.frames.x[:, :, 2]) @ of_all
    assert volume.max() > 1.5 * volume[0]
    np.testing.assert_allclose(books.solid, volume, rtol=1e-12)
    np.testing.assert_allclose(books.water, books.water[0], rtol=1e-13)
    area, faces = row.column.area / SEGMENTS, row.column.faces[:-1]
    wet = np.clip(
        found.surface[:, :, None] - row.bottom[:, None] + row.column.z_low - faces, 0.0, row.column.dz
    )
    below = (found.phi * wet).sum(axis=(1, 2)) * area  # volume of grains below the surface
    rise = (found.surface - found.surface[0]).sum(axis=1) * area
    # the surface follows with the next exchange, a step after a passage
    at_rest = ~np.isin(run.frames.step, run.passages["step"])
    assert at_rest.sum() > 10 and rise.max() > 1e-3 * books.water[0]
    np.testing.assert_allclose(rise[at_rest], (below - below[0])[at_rest], atol=1e-12 * books.water[0])


def test_the_energy_account_closes_where_nothing_touches(books: Books) -> None:
    tally = books.run.tally
    free = np.cumsum(tally["overlap_max"] > 0.0) == 0
    assert free.sum() > 20
    assert tally["residual"][free].max() < 1e-13


@pytest.mark.parametrize("stops", [(39, 41), (799, 800), (1201, 1507)])
def test_a_stopped_run_resumes_with_the_same_bits(
    books: Books, tmp_path: Path, stop_at: Any, stops: tuple[int, ...]
) -> None:
    for step in stops:
        stop_at(step)
        carried_out(tmp_path / "run", resume=True)
    assert carried_out(tmp_path / "run", resume=True, threads=2).complete
    assert differences(books.run.folder, tmp_path / "run") == []
