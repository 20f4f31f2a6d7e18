"""Feeds and exits: every grain is counted, times are exact, nothing overlaps, the same bits after a stop."""

import math
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from ryusa.build import scene as scene_of
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.pool import GrainPool
from ryusa.errors import CaseError, CheckpointError, ResultsError
from ryusa.model import PASSAGE, Exit, Feed, Scene, State, Traffic
from ryusa.model.feeds import IN, OUT
from ryusa.results import Results
from ryusa.results.scene_file import scene_digest
from ryusa.running.checkpoint import CheckpointBlock
from ryusa.running.feeds import TrafficRule
from ryusa.running.recorder import Recorder
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

G, D = 9.80665, 0.002
FLOOR = [("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]
DOWN = (0.0, 0.0, -1.0)


def disc(**keys: Any) -> Feed:
    plain: dict[str, Any] = {"centre": (0.0, 0.0, 0.1), "normal": DOWN, "radius": 0.008, "seed": 3}
    return Feed("hose", **plain | {"velocity": (0.0, 0.0, -0.5), "rate": 80.0} | keys)


def fed(
    n: int, n_first: int, feeds: tuple[Feed, ...], exits: tuple[Exit, ...] = (), **keys: Any
) -> tuple[Scene, State]:
    """A scene of n grains, of which the first are there: a column above the floor."""
    x = np.zeros((n, 3))
    x[:, 2] = np.arange(n) * 1.5 * D + 0.75 * D
    interval = keys.pop("interval", 70)
    scene, state = scene_of(x=x, **{"d": D, "dt": 2.0e-5, "stiffness": 2000.0} | keys)
    traffic = Traffic(feeds, exits, interval, n_first)
    scene = replace(scene, traffic=traffic, world_low=(-1.0, -1.0, -5.0), world_high=(1.0, 1.0, 5.0))
    there = np.arange(n) < n_first
    x, v, omega = (np.where(there[:, None], one, np.nan) for one in (state.x, state.v, state.omega))
    return scene, replace(state, x=x, v=v, omega=omega, present=there)


def poured(folder: Path, *, time: float = 0.8, **how: Any) -> Results:
    """Ten grains on a floor, fifty fed on top; those that roll off one side come in again."""
    exits = (
        Exit("right", point=(0.03, 0.0, 0.0), normal=(1.0, 0.0, 0.0), to=0),
        Exit("left", point=(-0.03, 0.0, 0.0), normal=(-1.0, 0.0, 0.0)),
    )
    scene, state = fed(60, 10, (disc(begin=0.05, first=10, count=50),), exits, planes=FLOOR)
    return run_scene(scene, state, folder, frames=0.02, stop=Stop(time=time), progress=False, **how)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return poured(tmp_path_factory.mktemp("poured") / "run")


@pytest.fixture(scope="module")
def falling(tmp_path_factory: pytest.TempPathFactory) -> Results:
    """Grains fall freely from a disc to an exit half a metre below."""
    feed = disc(centre=(0.0, 0.0, 0.5), rate=100.0, count=40)
    scene, state = fed(40, 0, (feed,), (Exit("floor", point=(0.0, 0.0, 0.0), normal=DOWN),))
    folder = tmp_path_factory.mktemp("falling") / "run"
    return run_scene(scene, state, folder, frames=0.01, stop=Stop(time=0.8), progress=False)


def test_a_grain_passes_from_feed_to_exit_in_the_time_of_free_fall(falling: Results) -> None:
    rows = falling.passages
    come, gone = rows[rows["way"] == IN], rows[rows["way"] == OUT]
    begin = dict(zip(come["grain"].tolist(), come["t"].tolist(), strict=True))
    taken = np.array([t - begin[i] for i, t in zip(gone["grain"].tolist(), gone["t"].tolist(), strict=True)])
    speed = math.sqrt(0.25 + 2.0 * G * 0.5)
    np.testing.assert_allclose(taken, (speed - 0.5) / G, rtol=1e-11)
    np.testing.assert_allclose(gone["v"][:, 2], -speed, rtol=1e-11)
    np.testing.assert_allclose(gone["x"][:, 2], 0.0, atol=1e-12)


def test_grains_enter_at_the_rate_asked_for(falling: Results) -> None:
    rows = falling.passages
    np.testing.assert_allclose(rows["t"][rows["way"] == IN], np.arange(40) / 100.0, atol=1e-12)


def test_grains_fed_by_mass_are_due_when_the_mass_before_them_has_entered(tmp_path: Path) -> None:
    d = D * (1.0 + 0.5 * np.sin(np.arange(30.0)))
    scene, state = fed(30, 0, (disc(rate=0.002, by_mass=True, begin=0.1, count=30),), d=d)
    results = run_scene(scene, state, tmp_path / "run", frames=0.01, stop=Stop(time=0.3), progress=False)
    rows = results.passages
    before = np.concatenate([[0.0], np.cumsum(rows["m"])[:-1]])
    assert len(rows) > 15
    np.testing.assert_allclose(rows["t"], 0.1 + before / 0.002, rtol=1e-12)
    np.testing.assert_array_equal(rows["m"], scene.m[rows["grain"]])


def test_every_frame_holds_what_entered_less_what_left(whole: Results, falling: Results) -> None:
    for run, first in ((whole, 10), (falling, 0)):
        assert run.scene.traffic is not None
        for frame in run.frames:
            passed = run.passages[run.passages["step"] <= frame.step]
            there = np.isfinite(frame.x[:, 0])
            assert there.sum() == first + passed["way"].sum()
            m = run.scene.m
            balance = m[:first].sum() + (passed["way"] * passed["m"]).sum()
            assert m[there].sum() == pytest.approx(balance, rel=1e-12, abs=1e-15)


def test_a_grain_that_comes_in_again_keeps_its_number_and_size(whole: Results) -> None:
    rows = whole.passages
    right = rows[(rows["way"] == OUT) & (rows["at"] == 0)]
    assert len(right) > 3
    for row in right:
        later = rows[(rows["grain"] == row["grain"]) & (rows["way"] == IN) & (rows["due"] == row["t"])]
        waits = whole.frames.t[-1] - row["t"] < 2 * 70 * whole.scene.dt
        assert len(later) == 1 or waits
        assert all(later["d"] == row["d"])
    left = rows[(rows["way"] == OUT) & (rows["at"] == 1)]
    assert not np.isin(
        left["grain"], rows[(rows["way"] == IN) & (rows["t"] > left["t"].max())]["grain"]
    ).any()


def test_no_grain_enters_on_top_of_another(tmp_path: Path) -> None:
    feed = Feed("box", low=(-0.005, -0.005, 0.02), high=(0.005, 0.005, 0.03), rate=2.0e4, count=200, seed=1)
    scene, state = fed(200, 0, (feed,), planes=FLOOR, interval=50)
    results = run_scene(scene, state, tmp_path / "run", frames=2.0e-3, stop=Stop(time=0.06), progress=False)
    rows = results.passages
    assert (rows["way"] == IN).all()
    for step in np.unique(rows["step"]):
        x = rows["x"][rows["step"] == step]
        apart = np.linalg.norm(x[:, None] - x[None], axis=2) + np.eye(len(x))
        assert apart.min() >= D
    assert results.tally["overlap_max"][0] == 0.0
    inside = (rows["x"] >= np.array(feed.low) + D / 2) & (rows["x"] <= np.array(feed.high) - D / 2)
    assert inside.all()


def test_grains_that_find_no_place_stay_due_and_are_named(tmp_path: Path) -> None:
    feed = Feed("hatch", low=(-0.003, -0.003, 0.0), high=(0.003, 0.003, 0.005), rate=1.0e4, count=300, seed=1)
    sides = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
    walls = [(f"{a}{b}", (-0.004 * a, -0.004 * b, 0.0), (a, b, 0.0)) for a, b in sides]
    scene, state = fed(300, 0, (feed,), planes=[*FLOOR, *walls])
    results = run_scene(scene, state, tmp_path / "run", frames=0.01, stop=Stop(time=0.1), progress=False)
    traffic = results.summary["traffic"]
    [feeds] = traffic["feeds"]
    assert feeds["due"] + feeds["entered"] == 300
    assert feeds["due"] > 100
    assert feeds["due_mass"] == pytest.approx(feeds["due"] * scene.m[0])
    assert traffic["present"] == feeds["entered"] == len(results.passages)
    [warning] = [one for one in results.summary["warnings"] if "hatch" in one]
    assert f"could not place {feeds['due']} grains" in warning
    assert (tmp_path / "run" / "log.txt").read_text().count("feed 'hatch' is full") == 1


def test_the_energy_account_closes_as_without_feeds(whole: Results, falling: Results) -> None:
    assert whole.tally["residual"].max() < 2e-3
    steady = falling.tally["kinetic"] > 0.0
    assert falling.tally["residual"][steady].max() < 1e-10
    held_at_start = falling.tally["start"][-1]  # by the grain that is due at once
    assert held_at_start > 1e-5
    assert falling.tally["switch"][-1] == pytest.approx(-held_at_start, rel=1e-9)


def test_any_number_of_threads_gives_the_same_bits(whole: Results, tmp_path: Path) -> None:
    poured(tmp_path / "run", threads=2)
    assert differences(whole.folder, tmp_path / "run") == []


@pytest.mark.parametrize("stops", [(1, 69, 71), (5_039, 5_040, 20_001), (30_000,)])
def test_a_stopped_run_resumes_with_the_same_bits(
    whole: Results, tmp_path: Path, stop_at: Any, stops: tuple[int, ...]
) -> None:
    for step in stops:
        stop_at(step)
        poured(tmp_path / "run", resume=True)
    last = poured(tmp_path / "run", resume=True)
    assert last.complete
    assert differences(whole.folder, tmp_path / "run") == []
    assert last.passages.tobytes() == whole.passages.tobytes()


def test_grains_that_passed_between_frames_are_in_a_checkpoint_and_in_a_part(tmp_path: Path) -> None:
    scene, _ = fed(3, 0, (disc(count=3),))
    (tmp_path / "provenance.json").write_text('{"format": 2, "status": "running"}')
    recorder, rows = Recorder(tmp_path, scene), np.zeros(2, PASSAGE)
    rows["grain"] = 0, 1
    assert recorder.to_block().arrays == {}
    recorder.passages(rows)
    assert recorder.buffered == rows.nbytes
    assert recorder.to_block().arrays["passages"].tobytes() == rows.tobytes()
    assert recorder.flush()
    assert Results.open(tmp_path).passages["grain"].tolist() == [0, 1]


def test_a_checkpoint_of_other_feeds_is_refused() -> None:
    scene, state = fed(60, 10, (disc(first=10, count=50),), planes=FLOOR)
    rule = TrafficRule.of(scene)
    assert rule is not None
    good = rule.to_block()
    rule.restore(good, state)
    for name, wrong in (("status", np.full(60, 7)), ("feed", np.full(60, 3)), ("due", np.zeros(3))):
        with pytest.raises(CheckpointError, match="not match"):
            rule.restore(CheckpointBlock({}, good.arrays | {name: wrong}), state)
    with pytest.raises(CheckpointError, match="incomplete"):
        rule.restore(CheckpointBlock({}, {}), state)


def test_an_engine_that_cannot_forget_refuses_by_name(tmp_path: Path) -> None:
    class Fixed(CpuEngine):
        forget = None  # type: ignore[assignment]

    scene, state = fed(60, 10, (disc(first=10, count=50),), planes=FLOOR)
    with pytest.raises(CaseError, match="steps a fixed number of grains"):
        run_scene(
            scene, state, tmp_path / "run", frames=0.02, stop=Stop(time=0.1), progress=False, engine=Fixed()
        )


def test_a_scene_without_feeds_needs_no_pool_and_keeps_its_digest() -> None:
    from ryusa.engine.pool import stepping

    scene, _ = scene_of(x=[[0.0, 0.0, 0.01]], d=D)
    engine = CpuEngine()
    assert stepping(engine, scene) is engine
    other = replace(scene, traffic=Traffic(n_first=1))
    assert isinstance(stepping(engine, other), GrainPool)
    assert scene_digest(other) != scene_digest(scene)


@pytest.mark.full
def test_a_grain_reaches_rest_only_after_the_last_has_entered(tmp_path: Path) -> None:
    scene, state = fed(4, 1, (disc(rate=5.0, begin=0.3, first=1, count=3),), planes=FLOOR, rotation=False)
    results = run_scene(
        scene, state, tmp_path / "run", frames=0.05, progress=False,
        stop=Stop(time=20.0, rest_speed=1.0e-3, rest_for=0.1),
    )  # fmt: skip
    assert len(results.passages) == 3
    assert 0.7 < results.frames.t[-1] < 20.0


def test_passages_of_a_version_without_their_momentum_are_refused(whole: Results, tmp_path: Path) -> None:
    earlier = np.dtype([(name, PASSAGE.fields[name][0]) for name in PASSAGE.names if name != "momentum"])
    shutil.copytree(whole.folder, tmp_path / "old")
    for path in (tmp_path / "old" / "parts").glob("part-*.h5"):
        with h5py.File(path, "r+") as file:
            n = len(file["passages"])
            del file["passages"]
            file["passages"] = np.zeros(n, earlier)
    with pytest.raises(ResultsError, match="'passages' has other columns: another version of ryusa wrote it"):
        _ = Results.open(tmp_path / "old").passages
