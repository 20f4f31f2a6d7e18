"""Loads on dams of a row: water at rest in closed form, grains about the toe, largest means over a time."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.measure.made_rows import DX, DZ, WIDTH, G, row_of, run_of
from tests.measure.test_walls import pushed

from ryusa.errors import ResultsError
from ryusa.figures.loads import loads as drawn
from ryusa.laws.families import Pressure, SurfaceRule
from ryusa.measure import structures
from ryusa.measure.loads import loads, running_mean
from ryusa.measure.structures import water_on_dam
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, RowDam, RowEnd
from ryusa.results.water import WaterFrames
from ryusa.water.row import advance_row, row_at_rest

T, CREST, RHO = np.arange(11) * 0.1, 8 * DZ, 1000.0
TOE = 0.1 + 5 * DX  # of a dam in segment 4 [m]


def ponded(before: Any, behind: float, over: float = 0.0, *, porous: bool = False, bottom: Any = None) -> Any:
    """A dam of 4 mm between two levels [m], that of the water on it; one for each frame or for all."""
    row, solid = row_of(bottom=bottom), np.zeros(8, np.int64)
    solid[4] = 0 if porous else 8
    row = replace(row, solid=solid, dams=(RowDam("weir", 4, 5, CREST, porous),))
    surface = np.zeros((11, 8))
    surface[:, :4] = np.broadcast_to(np.asarray(before), 11)[:, None]
    surface[:, 4], surface[:, 5:] = max(over, CREST), behind
    none = np.zeros((11, 1, 3))
    return run_of(row, T, none, none, surface=surface)


def names(found: Any) -> dict[str, float]:
    return {one.name.removeprefix("weir: "): one.value for one in found.averages.items}


def test_a_pond_below_the_crest_pushes_with_half_its_depth_squared() -> None:
    found, h = loads(ponded(0.003, 0.0)), 0.003
    force = 0.5 * RHO * G * h**2 * WIDTH
    assert found.water[:, 0] == pytest.approx(np.tile([force, 0.0, force * h / 3.0], (10, 1)), rel=1e-12)
    assert found.height == pytest.approx(np.full((10, 1), h / 3.0))
    said = names(found)
    assert said["force x, both, largest, by width"] == pytest.approx(force / WIDTH)
    assert said["impulse x, both"] == pytest.approx(force * 1.0)
    assert "no grain acts on weir: it is no wall for them" in found.averages.notes


def test_water_on_both_sides_pushes_from_both() -> None:
    found = loads(ponded(0.0035, 0.002))
    force, turn = (0.5 * (0.0035**2 - 0.002**2), (0.0035**3 - 0.002**3) / 6.0)
    assert found.water[:, 0, 0] == pytest.approx(np.full(10, RHO * G * WIDTH * force))
    assert found.water[:, 0, 2] == pytest.approx(np.full(10, RHO * G * WIDTH * turn))


def test_a_submerged_dam_feels_the_fall_of_the_level_and_carries_the_water_over_it() -> None:
    found = loads(ponded(0.010, 0.007, 0.008))
    force, over = RHO * G * WIDTH * CREST * (0.010 - 0.007), RHO * G * WIDTH * DX * (0.008 - CREST)
    turn = 0.5 * CREST * force - 0.5 * DX * over
    assert found.water[:, 0] == pytest.approx(np.tile([force, -over, turn], (10, 1)))
    assert found.height == pytest.approx(np.full((10, 1), 0.5 * CREST))


def test_a_dam_on_a_bottom_that_falls_turns_about_its_own_foot() -> None:
    """The pond stands on a bottom 1 mm over that of the dam and behind it."""
    bottom = np.where(np.arange(8) < 4, 0.001, 0.0)
    found, h = loads(ponded(0.0035, 0.0, bottom=bottom)), 0.0025
    force = 0.5 * RHO * G * h**2 * WIDTH
    assert found.water[:, 0, 2] == pytest.approx(np.full(10, force * (0.001 + h / 3.0)))


def test_the_largest_load_is_that_of_a_mean_over_the_time_asked_for() -> None:
    bore = np.where(T > 0.55, 0.004, 0.002)
    force = 0.5 * RHO * G * WIDTH * np.array([0.002, 0.004]) ** 2
    short, long = (names(loads(ponded(bore, 0.0), window=one)) for one in (None, 0.4))
    assert short["force x, both, largest"] == pytest.approx(force[1])
    assert long["force x, both, largest"] == pytest.approx(force[1])
    brief = np.where((T > 0.35) & (T < 0.55), 0.004, 0.002)  # two frames: means 0.5, 1, 0.5 between
    peak = names(loads(ponded(brief, 0.0), window=0.4))["force x, both, largest"]
    assert peak == pytest.approx(0.5 * (force[0] + force[1]))
    assert running_mean(np.array([1.0, 3.0]), np.array([1.0, 1.0]), 9.0).tolist() == [2.0]


def test_grains_turn_the_dam_about_its_toe(monkeypatch: pytest.MonkeyPatch) -> None:
    """A force at a place, with its torque about another point, as `measure.walls` gives it."""
    run, force, place = ponded(0.0, 0.0), np.array([2.0, 0.0, -3.0]), np.array([0.141, 0.0, 0.003])
    about = np.array([0.05, 0.0, -0.02])
    of = SimpleNamespace(
        names=("floor", "weir"), untouched=(), axis_point=np.array([[0.0] * 3, about]),
        force=np.broadcast_to([np.zeros(3), force], (10, 2, 3)),
        torque=np.broadcast_to([np.zeros(3), np.cross(place - about, force)], (10, 2, 3)),
    )  # fmt: skip
    run.scene = SimpleNamespace(walls=of, n_grain=0)
    monkeypatch.setattr(structures, "forces_of_frames", lambda *_: of)
    found = loads(run)
    turn = np.cross(place - np.array([TOE, 0.0, 0.0]), force)[1]
    assert found.grains[:, 0] == pytest.approx(np.tile([2.0, -3.0, turn], (10, 1)))
    assert found.total == pytest.approx(found.water + found.grains)
    assert not any("no wall" in one for one in found.averages.notes)
    drawn(found)


def test_frames_are_those_of_the_water_though_the_account_is_of_a_step_earlier() -> None:
    run, weir = ponded(0.003, 0.0), pushed({"weir": 0.5})
    run.scene, run.walls, run.wall_travel = weir.scene, weir.walls[:11], weir.wall_travel[:11]
    run.scene.n_grain = 0
    run.tally = {"t": np.maximum(T - 1e-4, 0.0)}
    found = loads(run, begin=0.1, end=0.8)
    assert found.t == pytest.approx(0.1 * np.arange(1, 8) + 0.05)
    assert found.grains.shape == found.water.shape == (7, 1, 3)
    assert found.grains[:, 0, 0] == pytest.approx(np.full(7, 0.25))  # 0.5 N over frames 0.05 s apart


def test_a_row_without_a_dam_that_stops_water_is_refused() -> None:
    with pytest.raises(ResultsError, match="it seeps through weir"):
        loads(ponded(0.003, 0.0, porous=True))
    run = ponded(0.003, 0.0)
    run.row = None
    with pytest.raises(ResultsError, match=r"no \[water.row\]"):
        loads(run)


def test_a_pressure_beyond_the_hydrostatic_one_pushes_face_and_top() -> None:
    run = ponded(0.010, 0.0, 0.008)
    row, beyond = replace(run.row.row, pressure=Pressure.FULL), 20.0
    frames = {name: getattr(run.row, name) for name in run.row.flow.fields()}
    pressure = np.zeros((11, 8, row.column.n))
    pressure[:, 3, : round(0.010 / DZ) - 1] = beyond  # the dam's face ends below them
    pressure[:, 4, 8] = 2.0 * beyond
    at_rest = loads(run)
    faces = np.zeros((11, 8, row.column.n + 1))
    run.row = WaterFrames(row, T, **frames, pressure=pressure, w_faces=faces)
    found = loads(run)
    force, above = beyond * CREST * WIDTH, 2.0 * beyond * DX * WIDTH
    more = [force, -above, 0.5 * CREST * force - 0.5 * DX * above]
    assert found.water[:, 0] - at_rest.water[:, 0] == pytest.approx(np.tile(more, (10, 1)))
    assert any("its own pressure" in note for note in found.averages.notes)


def load_over_momentum_lost(fine: int) -> float:
    """Load on a weir over the momentum that a steady stream without friction loses at it."""
    n, first, end, dz, q = 60 * fine, 30 * fine, 34 * fine, 0.005, 0.02
    c = Column(z_low=0.0, dz=dz, n=40, depth=0.1, nu=1e-15, surface=SurfaceRule.VOLUME)
    ends = RowEnd(EndKind.DISCHARGE, discharge=q), RowEnd(EndKind.FREE_FALL)
    solid = np.where((np.arange(n) >= first) & (np.arange(n) < end), 10, 0)
    row = ColumnRow(
        c, 0.02 / fine, np.zeros(n), G, *ends, solid, dams=(RowDam("weir", first, end, 0.05),),
        pressure=Pressure.FULL,
    )  # fmt: skip
    now = advance_row(row, row_at_rest(row, np.where(np.arange(n) < end, 0.1, 0.04)), 10.0)
    p = np.asarray(now.pressure)
    frames = WaterFrames(
        row, np.zeros(1), surface=now.surface[None, row.inner], pressure=RHO * p[None, row.inner]
    )

    def momentum(station: int) -> float:
        """Momentum that passes a station, and the force of the pressure there, per width [N/m]."""
        content, depth, beyond = (
            0.5 * (one[station] + one[station + 1]) for one in (now.content, now.surface, p)
        )
        return RHO * float((content * now.u[station] ** 2 + beyond * dz).sum() + 0.5 * G * depth**2)

    return float(water_on_dam(frames, row.dams[0])[0, 0]) / (momentum(10 * fine) - momentum(50 * fine))


def test_the_load_on_a_weir_tends_to_the_momentum_that_the_stream_loses() -> None:
    """0.880, 0.960 and 0.991 with segments of 2, 1 and 0.5 cm: what strikes within half a segment is lost."""
    coarse, fine = (abs(load_over_momentum_lost(one) - 1.0) for one in (1, 2))
    assert coarse < 0.13
    assert fine < 0.05
    assert fine < 0.5 * coarse
