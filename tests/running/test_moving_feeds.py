"""Feeds and exits that move with a wall: places, velocities and spins in closed form, the same bits."""

import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ryusa
from ryusa.build import build
from ryusa.build import scene as scene_of
from ryusa.build.feeds import moving_with
from ryusa.build.walls import WallMotion, rectangle, with_walls
from ryusa.casefile import read_text
from ryusa.cases import case_path
from ryusa.errors import CaseError
from ryusa.model import Exit, Feed, Scene, State, Traffic
from ryusa.model.feeds import IN, OUT
from ryusa.model.walls import INTERVAL
from ryusa.results import Results
from ryusa.results.scene_file import scene_digest
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

D, G, N, RADIUS = 0.002, 9.80665, 30, 0.002
ARM, SPIN, AXIS, UP = 0.05, 7.0, np.array([0.01, 0.02, 0.1]), 0.3
CENTRE = np.array([0.01 + ARM, 0.02, 0.11])
SPEED = np.array([0.4, 0.0, -0.2])  # outwards along the arm, and down


def arm(motion: WallMotion, *, gravity: float = G, exits: tuple[Exit, ...] = ()) -> tuple[Scene, State]:
    """A small plate at the end of an arm, with a nozzle that moves with it."""
    x = np.arange(N)[:, None] * np.array([1.5 * D, 0.0, 0.0])
    scene, state = scene_of(x=x, d=D, dt=2.0e-5, stiffness=2000.0, gravity=gravity)
    plate = rectangle("plate", (0.01, 0.02, 0.15), (0.01, 0.0, 0.0), (0.0, 0.01, 0.0))
    scene = with_walls(scene, [replace(plate, motion=motion)])
    nozzle = Feed(
        "nozzle", centre=tuple(CENTRE.tolist()), normal=(1.0, 0.0, 0.0), radius=RADIUS,
        velocity=tuple(SPEED.tolist()), rate=100.0, count=N, seed=4, wall=0,
    )  # fmt: skip
    traffic = Traffic((nozzle,), exits, 100, 0)
    scene = replace(scene, traffic=traffic, world_low=(-9.0,) * 3, world_high=(9.0,) * 3)
    nowhere = np.full((N, 3), np.nan)
    away = np.zeros(N, np.bool_)
    return moving_with(scene), replace(state, x=nowhere, v=nowhere.copy(), omega=nowhere.copy(), present=away)


def done(folder: Path, motion: WallMotion, *, time: float = 0.31, **how: Any) -> Results:
    keys = {name: how.pop(name) for name in ("gravity", "exits") if name in how}
    return run_scene(*arm(motion, **keys), folder, frames=0.01, stop=Stop(time=time), progress=False, **how)


TURNING = WallMotion(spin=(0.0, 0.0, SPIN), axis_point=tuple(AXIS.tolist()), velocity=(0.0, 0.0, UP))


@pytest.fixture(scope="module")
def turning(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return done(tmp_path_factory.mktemp("arm") / "run", TURNING)


def test_a_nozzle_on_a_turning_arm_that_rises_throws_grains_as_the_closed_form_says(turning: Results) -> None:
    rows = turning.passages
    assert len(rows) == N
    np.testing.assert_allclose(rows["t"], np.arange(N) / 100.0, atol=1e-12)
    for row in rows:
        t = float(row["t"])
        c, s = math.cos(SPIN * t), math.sin(SPIN * t)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        middle = turn @ (CENTRE - AXIS) + AXIS + np.array([0.0, 0.0, UP * t])
        from_middle = turn.T @ (row["x"] - middle)
        assert abs(from_middle[0]) < 1e-14  # it lies in the disc, which has turned
        assert np.linalg.norm(from_middle) <= RADIUS - 0.5 * D + 1e-12
        of_wall = SPIN * np.array([-(row["x"][1] - AXIS[1]), row["x"][0] - AXIS[0], 0.0])
        of_wall[2] += UP
        np.testing.assert_allclose(row["v"], turn @ SPEED + of_wall, atol=1e-12)
        np.testing.assert_array_equal(row["omega"], [0.0, 0.0, SPIN])


def test_its_grains_are_where_free_flight_from_their_own_instant_brings_them(turning: Results) -> None:
    t, x = float(turning.frames.t[-1]), np.asarray(turning.frames.x[-1])
    for row in turning.passages:
        since = t - float(row["t"])
        place = row["x"] + row["v"] * since - 0.5 * G * since**2 * np.array([0.0, 0.0, 1.0])
        np.testing.assert_allclose(x[row["grain"]], place, atol=1e-10)
    assert turning.tally["residual"][turning.tally["kinetic"] > 0.0].max() < 1e-9


def test_a_nozzle_that_swings_gives_its_velocity_to_the_grain(tmp_path: Path) -> None:
    swing, rate = 0.01, 2.0 * math.pi * 5.0
    run = done(tmp_path / "run", WallMotion(amplitude=(0.0, swing, 0.0), frequency=5.0))
    rows = run.passages
    assert len(rows) == N
    np.testing.assert_allclose(rows["v"][:, 1], swing * rate * np.cos(rate * rows["t"]), atol=1e-12)
    assert np.abs(rows["x"][:, 1] - 0.02 - swing * np.sin(rate * rows["t"])).max() <= RADIUS


def test_an_exit_that_moves_takes_a_grain_when_they_meet(tmp_path: Path) -> None:
    """Without gravity: nozzle and plane at its side move alike, so that all are as long on their way."""
    ahead = Exit("ahead", point=(0.1, 0.0, 0.0), normal=(1.0, 0.0, 0.0), wall=0)
    motion = WallMotion(velocity=(0.2, 0.1, 0.0))
    run = done(tmp_path / "run", motion, gravity=0.0, exits=(ahead,), time=0.5)
    come, gone = (run.passages[run.passages["way"] == way] for way in (IN, OUT))
    assert len(come) == len(gone) == N
    taken = gone["t"] - come["t"][np.argsort(come["grain"])][gone["grain"]]
    np.testing.assert_allclose(taken, (0.1 - CENTRE[0]) / SPEED[0], rtol=1e-10)
    np.testing.assert_allclose(gone["x"][:, 0], 0.1 + 0.2 * gone["t"], rtol=1e-10)


def test_any_number_of_threads_and_stops_give_the_same_bits(
    turning: Results, tmp_path: Path, stop_at: Any
) -> None:
    assert turning.scene.traffic is not None
    interval = turning.scene.traffic.interval
    assert interval == 91  # a grain and its nozzle go 2 mm in that time
    done(tmp_path / "two", TURNING, threads=2)
    assert differences(turning.folder, tmp_path / "two") == []
    for step in (interval - 1, 50 * interval, 70 * interval + 1):
        stop_at(step)
        done(tmp_path / "run", TURNING, resume=True)
    assert done(tmp_path / "run", TURNING, resume=True).complete
    assert differences(turning.folder, tmp_path / "run") == []


def test_a_feed_that_stays_keeps_the_digest_of_its_scene() -> None:
    """0021: scenes say nothing of walls where no feed moves with one."""
    scene, _ = scene_of(x=[[0.0, 0.0, 0.01]], d=D)
    scene = replace(scene, traffic=Traffic((Feed("a", rate=1.0, count=1),), (Exit("b"),), 10, 0))
    from ryusa.results.scene_file import _scalars

    data = _scalars(scene)["traffic"]
    assert "wall" not in data["feeds"][0] | data["exits"][0]
    moving = replace(scene, traffic=Traffic((Feed("a", rate=1.0, count=1, wall=0),), (Exit("b"),), 10, 0))
    assert scene_digest(moving) != scene_digest(scene)


HOSE = case_path("lifted_cylinder.toml").read_text()


def changed(*pairs: tuple[str, str]) -> str:
    text = HOSE
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


RISES = changed(
    ('at = "1 s"   ', 'at = "0.05 s"   '), ('"3 cm/s"]', '"30 cm/s"]'), ('time = "3.2 s"', 'time = "0.15 s"'),
    ('end = "0.8 s" ', 'moves_with = "cylinder" '), ('"20 ms"', '"10 ms"'),
    ('"1500 grains/s"', '"400 grains/s"'), ('settle = "1 s"', 'settle = "0 s"'),
)  # fmt: skip


@pytest.mark.full
def test_a_hose_rises_with_a_cylinder_from_the_moment_that_the_timeline_lifts_it(tmp_path: Path) -> None:
    run = ryusa.run(read_text(RISES), tmp_path / "run", progress=False)
    rows = run.passages[run.passages["way"] == IN]
    t = rows["t"]
    assert np.sum(t < 0.05) == 20
    assert len(t) > 50
    lifted = 0.3 * np.maximum(t - round(0.05 / run.scene.dt) * run.scene.dt, 0.0)
    np.testing.assert_allclose(rows["x"][:, 2], 0.045 + lifted, atol=1e-12)
    np.testing.assert_allclose(rows["v"][:, 2], np.where(lifted > 0.0, 0.0, -0.3), atol=1e-12)


def test_a_feed_that_moves_with_a_servo_has_its_corrections_as_instants() -> None:
    lid = (
        '[[walls]]\nname = "lid"\nshape = "disc"\nat = ["0 cm", "0 cm", "9 cm"]\nnormal = [0, 0, 1]\n'
        'radius = "2 cm"\nservo = { direction = [0, 0, -1], force = "1 N", max_speed = "5 cm/s" }\n'
    )
    text = changed(("[time]", lid + "[time]"), ('end = "0.8 s" ', 'moves_with = "lid"\nend = "0.8 s" '))
    scene = build(read_text(text)).scene
    assert scene.traffic is not None
    assert scene.walls is not None
    assert int(scene.walls.servo[0, INTERVAL]) % scene.traffic.interval == 0
    assert scene.traffic.feeds[0].wall == 1


@pytest.mark.parametrize(
    ("pairs", "words"),
    [
        ([('end = "0.8 s" ', 'moves_with = "cylindre" ')], "'cylindre'.*Did you mean 'cylinder'"),
        ([('move = { wall = "cylinder", velocity = ["0 cm/s", "0 cm/s", "3 cm/s"] }', 'remove = "cylinder"'),
          ('end = "0.8 s" ', 'moves_with = "cylinder" ')], "feeds.0.moves_with.*is removed by the timeline"),
    ],
)  # fmt: skip
def test_a_wall_that_is_not_there_to_the_end_is_named(pairs: Any, words: str) -> None:
    with pytest.raises(CaseError, match=words):
        read_text(changed(*pairs))
