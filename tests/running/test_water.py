"""A run whose water is solved: exchanged at fixed steps, recorded, read back, however it was cut."""

import math
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import BedKind, Drag, Fluctuations, Hindrance, Mixing, Profile, Rebound, Start
from ryusa.model import Column, Scene, State, Water
from ryusa.model.scene import EventRule
from ryusa.results import Results
from ryusa.running import loop as loop_module
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

D, G = 2.0e-3, 9.80665


def falling(interval=10):
    """Grains that fall into water flowing down a slope."""
    rng = np.random.default_rng(3)
    n = 30
    x = np.zeros((n, 3))
    x[:, 0], x[:, 2] = (np.arange(n) + 0.5) * 2.0 * D, rng.uniform(3.0 * D, 9.0 * D, n)
    water = Water(profile=Profile.COLUMN, drag=Drag.SCHILLER_NAUMANN, hindrance=Hindrance.DI_FELICE)
    fixed, first = scene(
        x, D, water=water, gravity=G, slope=0.05, period=(n * 2.0 * D, math.inf), plane_case=True,
        planes=[("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))], events=EventRule.NONE,
    )  # fmt: skip
    column = Column(
        z_low=0.0, dz=0.25 * D, n=48, depth=10.0 * D, area=n * 2.0 * D * D, bed=BedKind.ROUGH,
        k_rough=0.5 * D, mixing=Mixing.PARABOLIC, g_x=G * math.sin(0.05), interval=interval,
    )  # fmt: skip
    return replace(fixed, flow=column), first


def over_fixed_grains() -> tuple[Scene, State]:
    """The same over a row of fixed grains, whose drag is all that stops the water."""
    fixed, first = falling()
    n = 30
    row = np.column_stack([(np.arange(n) + 0.5) * 2.0 * D, np.zeros(n), np.full(n, 0.5 * D)])
    column = replace(fixed.column, bed=BedKind.MOVING, mixing=Mixing.PRANDTL, start=Start.STEADY)
    return replace(
        fixed, x_fixed=row, d_fixed=np.full(n, D), fixed_active=np.ones(n, dtype=np.bool_), flow=column
    ), first


def stepping(fixed, state) -> loop_module.Loop:
    """The loop without what it writes."""
    nothing: Any = None
    stop = Stop(time=1.0)
    loop = loop_module.Loop(
        CpuEngine(), fixed, 1.0, stop, [], nothing, nothing, nothing, {}, nothing, _step=state.step
    )
    loop.engine.load(fixed, state)
    loop._start_water(state)
    return loop


def bits(value: Any) -> Any:
    """All numbers of a snapshot."""
    if is_dataclass(value):
        return {one.name: bits(getattr(value, one.name)) for one in fields(value)}
    return value.tobytes() if isinstance(value, np.ndarray) else repr(value)


def carried_out(folder: Path) -> Results:
    made = falling()
    return run_scene(*made, folder, frames=50 * made[0].dt, stop=Stop(time=400 * made[0].dt), progress=False)


def test_the_water_of_every_frame_is_read_back(tmp_path: Path) -> None:
    results = carried_out(tmp_path / "run")
    water, column = results.water, results.scene.column
    assert water is not None
    assert column is not None and bits(column) == bits(falling()[0].column)
    assert water.u.shape == (len(results.frames), column.n)
    assert np.array_equal(water.t, results.frames.t)
    assert (np.diff(water.u[:, -10]) > 0.0).all()  # it gains speed down the slope
    assert water.phi.sum(axis=1) == pytest.approx(np.full(len(water.t), water.phi[0].sum()), rel=1e-9)
    assert results.summary["water"]["momentum_residual"] < 1e-9
    assert results.summary["energy"]["residual"] < 1e-3


def test_water_and_grains_do_not_depend_on_how_the_run_is_cut(tmp_path: Path, monkeypatch) -> None:
    whole = carried_out(tmp_path / "whole")
    monkeypatch.setattr(loop_module.Loop, "_chunk", lambda self: 7)
    cut = carried_out(tmp_path / "cut")
    assert np.array_equal(whole.water.u, cut.water.u)
    assert np.array_equal(whole.frames[-1].x, cut.frames[-1].x)


@pytest.mark.parametrize("k", [0, 1, 5, 95, 101, 104, 163])
def test_a_snapshot_at_any_step_resumes_with_the_same_bits(k: int) -> None:
    fixed, first = over_fixed_grains()
    whole = stepping(fixed, first)
    whole._steps(200)
    before = stepping(fixed, first)
    before._steps(k)
    again = stepping(fixed, before.state())
    assert bits(again.state()) == bits(before.state())
    again._steps(200 - k)
    assert whole._water is not None and whole._water.exchanges > 10
    assert bits(again.state()) == bits(whole.state())


@pytest.mark.parametrize("k", [1, 45, 501])
def test_a_snapshot_with_eddies_and_films_resumes_with_the_same_bits(k: int) -> None:
    fixed, first = over_fixed_grains()
    column = replace(
        fixed.column, fluctuations=Fluctuations.RANDOM_WALK, seed=112
    )  # some eddies are about to end
    water = replace(fixed.water, rebound=Rebound.EXPONENTIAL)
    fixed = replace(fixed, flow=column, water=water)
    whole = stepping(fixed, first)
    whole._steps(600)
    before = stepping(fixed, first)
    before._steps(k)
    again = stepping(fixed, before.state())
    again._steps(600 - k)
    assert whole._water is not None and whole._water.eddies.count.any()
    assert bits(again.state()) == bits(whole.state())


def test_a_snapshot_of_another_column_is_refused() -> None:
    fixed, first = falling()
    state = stepping(fixed, first).state()
    assert fixed.column is not None
    with pytest.raises(ValueError, match="48 cells and 30 grains, the run has 49 cells"):
        stepping(replace(fixed, flow=replace(fixed.column, n=49)), state)


def test_grains_removed_by_the_timeline_no_longer_fill_the_column() -> None:
    fixed, first = over_fixed_grains()
    loop = stepping(fixed, first)
    loop._steps(50)
    water, column = loop._water, fixed.column
    assert water is not None and column is not None
    full = water.phi.copy()
    gone = replace(fixed, fixed_active=np.zeros(fixed.n_fixed, dtype=np.bool_))
    water.change(gone)
    lost = (full - water.phi).sum() * column.dz * column.area
    assert lost == pytest.approx(fixed.n_fixed * math.pi / 6.0 * D**3)
    loop._steps(20)
    assert water.budget is not None and water.budget.fixed == 0.0


@pytest.mark.full
def test_a_run_without_a_column_has_no_water(tmp_path: Path) -> None:
    fixed, first = scene([[0.0, 0.0, 0.01]], D, events=EventRule.NONE)
    results = run_scene(
        fixed, first, tmp_path / "dry", frames=10 * fixed.dt, stop=Stop(time=20 * fixed.dt), progress=False
    )
    assert results.water is None


def test_a_run_that_records_no_contacts_does_not_say_that_there_were_none(tmp_path: Path) -> None:
    carried_out(tmp_path / "run")
    log = (tmp_path / "run" / "log.txt").read_text(encoding="utf-8")
    assert "contacts not recorded" in log
    assert "restitution" not in log
    assert "momentum imbalance" in log


def test_a_bed_that_never_packs_gives_a_warning(tmp_path: Path) -> None:
    fixed, first = over_fixed_grains()
    assert fixed.column is not None
    for phi_max, said in ((0.61, True), (0.05, False)):
        column = replace(fixed.column, mixing=Mixing.LI_SAWAMOTO, phi_max=phi_max, d=D)
        folder = tmp_path / str(phi_max)
        stop = Stop(time=20 * fixed.dt)
        made = run_scene(
            replace(fixed, flow=column), first, folder, frames=10 * fixed.dt, stop=stop, progress=False
        )
        assert any("packed concentration" in text for text in made.summary["warnings"]) is said
        assert 0.05 < made.summary["water"]["densest"] < 0.61
