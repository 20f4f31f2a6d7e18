"""Feeds and exits between walls, some of which move."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ryusa.build import scene as scene_of
from ryusa.build.walls import WallMotion, cylinder, rectangle, with_walls
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.pool import GrainPool
from ryusa.engine.shared.passages import removed
from ryusa.model import Exit, Feed, Scene, State, Term, Traffic
from ryusa.model.feeds import IN, OUT
from ryusa.results import Results
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

D, RADIUS = 0.002, 0.008


def _apart(n: int) -> np.ndarray:
    """Places for the first grains of a scene, which are not there yet."""
    return np.arange(n)[:, None] * np.array([1.5 * D, 0.0, 0.0])


def tube(n: int, **keys: Any) -> tuple[Scene, State]:
    """A tube that turns about its axis, x; grains enter at its one end and leave while they touch it."""
    scene, state = scene_of(x=_apart(n), d=D, dt=2.0e-5, stiffness=2000.0, slope=0.35, **keys)
    turning = WallMotion(spin=(15.0, 0.0, 0.0))
    shell = replace(cylinder("tube", (-0.005, 0.0, 0.0), (0.06, 0.0, 0.0), RADIUS), motion=turning)
    scene = with_walls(scene, [shell])
    feed = Feed(
        "hose", centre=(0.0, 0.0, -0.002), normal=(1.0, 0.0, 0.0), radius=0.0045, velocity=(0.2, 0.0, 0.0),
        rate=300.0, begin=0.0, first=0, count=n, seed=5,
    )  # fmt: skip
    traffic = Traffic((feed,), (Exit("end", point=(0.04, 0.0, 0.0), normal=(1.0, 0.0, 0.0)),), 50, 0)
    nowhere = np.full((n, 3), np.nan)
    scene = replace(scene, traffic=traffic, world_low=(-0.1, -0.1, -0.1), world_high=(0.1, 0.1, 0.1))
    return scene, replace(
        state, x=nowhere, v=nowhere.copy(), omega=nowhere.copy(), present=np.zeros(n, np.bool_)
    )


def conveyed(folder: Path, **how: Any) -> Results:
    scene, state = tube(60)
    return run_scene(scene, state, folder, frames=5.0e-3, stop=Stop(time=0.4), progress=False, **how)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return conveyed(tmp_path_factory.mktemp("tube") / "run")


def test_grains_pass_through_a_turning_tube_and_the_account_closes(whole: Results) -> None:
    rows = whole.passages
    entered, left = (int(np.sum(rows["way"] == way)) for way in (IN, OUT))
    assert entered == 60
    assert 30 < left <= 60
    n = np.isfinite(whole.frames.x[:][:, :, 0]).sum(axis=1)
    steps = np.asarray(whole.frames.step)
    came = [np.sum((rows["way"] == IN) & (rows["step"] <= one)) for one in steps]
    gone = [np.sum((rows["way"] == OUT) & (rows["step"] <= one)) for one in steps]
    assert n.tolist() == (np.array(came) - np.array(gone)).tolist()
    assert whole.tally["residual"].max() < 2e-3
    assert whole.tally["wall"][-1] > 0.0  # the tube carries grains up its side
    given = whole.walls.reshape(len(steps), -1)[-1, 6]
    pending = whole.tally["wall"][-1] - given
    assert abs(pending) < 1e-3 * given  # up to the half step to come, the work on the wall is the term


def test_any_number_of_threads_and_stops_give_the_same_bits(
    whole: Results, tmp_path: Path, stop_at: Any
) -> None:
    conveyed(tmp_path / "two", threads=2)
    assert differences(whole.folder, tmp_path / "two") == []
    for step in (49, 5_000, 13_337):
        stop_at(step)
        conveyed(tmp_path / "run", resume=True)
    assert conveyed(tmp_path / "run", resume=True).complete
    assert differences(whole.folder, tmp_path / "run") == []
    assert np.array_equal(np.asarray(whole.walls), np.asarray(Results.open(tmp_path / "run").walls))


def test_a_moving_wall_does_no_work_on_a_grain_that_has_left() -> None:
    """One grain rests on a rising plate and is taken away: the account stays as it was."""
    scene, state = scene_of(
        x=[[0.0, 0.0, 0.5 * D], [0.01, 0.0, 0.5 * D]], d=D, dt=2.0e-5, stiffness=2000.0, restitution=0.3
    )
    plate = rectangle("plate", (-0.05, -0.05, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0))
    scene = with_walls(scene, [replace(plate, motion=WallMotion(velocity=(0.0, 0.0, 0.05)))])
    scene = replace(scene, traffic=Traffic((), (), 50, 2), world_low=(-1.0,) * 3, world_high=(1.0,) * 3)
    state = replace(state, present=np.ones(2, np.bool_))
    pool = GrainPool(CpuEngine())
    pool.load(scene, state)
    pool.advance(3_000).raise_if_any()
    before = pool.state()
    assert before.tally is not None
    assert len(before.contacts) == 2
    gone, _ = removed(scene, before, np.array([0]))
    assert gone.tally is not None
    assert gone.tally.imbalance == pytest.approx(before.tally.imbalance, abs=1e-18)
    pool.load(scene, gone)
    pool.advance(1).raise_if_any()
    after = pool.tally()
    force = float(scene.m[0]) * 9.80665  # of the plate on the grain that left, at rest on it
    half = 0.5 * scene.dt * force * 0.05
    assert abs(after.imbalance - before.tally.imbalance) < 1e-3 * half
    work = after.terms[Term.WALL] - before.tally.terms[Term.WALL]
    assert work == pytest.approx(2.0 * half, rel=1e-6)  # a whole step on the one that is left


def test_no_grain_enters_across_a_wall(tmp_path: Path) -> None:
    scene, state = scene_of(x=_apart(200), d=D, dt=2.0e-5, stiffness=2000.0, gravity=0.0)
    wall = rectangle("wall", (0.0, -0.05, -0.05), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1))
    scene = with_walls(scene, [wall])
    feed = Feed(
        "box", low=(-0.008, -0.008, -0.008), high=(0.008, 0.008, 0.008), rate=1.0e5, count=200, seed=1
    )
    scene = replace(scene, traffic=Traffic((feed,), (), 50, 0), world_low=(-1.0,) * 3, world_high=(1.0,) * 3)
    nowhere = np.full((200, 3), np.nan)
    state = replace(state, x=nowhere, v=nowhere.copy(), omega=nowhere.copy(), present=np.zeros(200, np.bool_))
    results = run_scene(scene, state, tmp_path / "run", frames=1e-3, stop=Stop(time=5e-3), progress=False)
    rows = results.passages
    assert len(rows) > 50
    assert np.abs(rows["x"][:, 0]).min() >= 0.5 * D
    assert min(np.sum(rows["x"][:, 0] > 0.0), np.sum(rows["x"][:, 0] < 0.0)) > 20
    assert results.tally["overlap_max"].max() == 0.0
