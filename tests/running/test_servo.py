"""Walls that a servo presses on the grains: force, way, account, resume, and walls that go too far."""

import math
import re
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ryusa
from ryusa.build import build
from ryusa.casefile import read_text
from ryusa.errors import WallLost
from ryusa.model.walls import N_IMPULSE, TOUCHED, pose
from ryusa.results import Results, schema
from ryusa.running.servo import ServoRule

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences
from kinds import KINDS

D, K, FORCE, MASS = 4.0e-3, 2000.0, 0.5, 2650.0 * math.pi / 6.0 * 4.0e-3**3
ONE = f"""
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
[contact]
stiffness = "{K:g} N/m"
restitution = 0.5
friction = 0.3
timing = "at steps"
[motion]
rotation = "free"
plane = false
[[planes]]
name = "floor"
point = ["0 cm", "0 cm", "0 cm"]
normal = [0, 0, 1]
[[walls]]
name = "lid"
shape = "disc"
at = ["0 cm", "0 cm", "5 mm"]
normal = [0, 0, 1]
radius = "1 cm"
servo = {{ direction = [0, 0, -2], force = "{FORCE:g} N", max_speed = "5 cm/s" }}
[build]
kind = "fill"
low = ["-2 mm", "-2 mm", "0 mm"]
high = ["2.2 mm", "2.2 mm", "4.2 mm"]
jitter = 0
[stop]
time = "0.3 s"
[record]
frames = "10 ms"
"""
SERVO = KINDS["servo"]
SINKING = re.sub(r"servo = .*\n", "", SERVO).replace('"5 cm/s", "0 cm/s", "0', '"5 cm/s", "0 cm/s", "-2.5')


def done(text: str, folder: Path, **how: Any) -> Results:
    return ryusa.run(read_text(text), folder, progress=False, **how)


@pytest.fixture(scope="module")
def one(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return done(ONE, tmp_path_factory.mktemp("servo") / "run")


@pytest.fixture(scope="module")
def bed(tmp_path_factory: pytest.TempPathFactory) -> dict[bool, Results]:
    folder = tmp_path_factory.mktemp("bed")
    return {
        servo: done(text, folder / str(servo), threads=2) for servo, text in ((True, SERVO), (False, SINKING))
    }


@pytest.mark.full
def test_a_grain_is_pressed_with_the_force_asked(one: Results) -> None:
    """Both springs of the grain are then as short as Hooke's law says, and the lid stands on it."""
    found = one.measure("walls", begin=0.2)
    assert found.force[-1, 0] == pytest.approx([0.0, 0.0, FORCE], rel=1e-6, abs=1e-9)
    assert found.travel is not None
    gap = 5.0e-3 - D
    assert found.travel[-1, 0] == pytest.approx(gap + FORCE / K + (FORCE + MASS * 9.80665) / K, rel=1e-6)
    assert found.contacts[-1, 0] == pytest.approx(1.0)
    assert one.frames.x[-1][0, 2] == pytest.approx(0.5 * D - (FORCE + MASS * 9.80665) / K, rel=1e-9)
    assert {"travel_m", "contacts"} <= set(found.rows()[0])


@pytest.mark.full
def test_the_wall_stands_in_results_where_it_was(one: Results) -> None:
    t = one.frames.t
    for k in (0, 3, len(t) - 1):
        walls = one.scene_at(float(t[k])).walls
        assert walls is not None
        _, shift = pose(walls.motion[0], float(t[k]))
        assert shift == pytest.approx([0.0, 0.0, -one.wall_travel[k, 0]], abs=1e-12)
    middle = 0.5 * float(t[1] + t[2])
    between = one.scene_at(middle).walls
    assert between is not None
    assert pose(between.motion[0], middle)[1][2] == pytest.approx(-one.wall_travel[1:3, 0].mean(), rel=1e-9)


def test_a_bed_sheared_under_a_lid_carries_its_force(tmp_path: Path) -> None:
    """While grains are rearranged the force stays somewhat below; the work of the lid is in the account."""
    slow = SERVO.replace('"5 cm/s", "0 cm/s"', '"1 cm/s", "0 cm/s"').replace('"0.3 s"', '"1 s"')
    run = done(slow, tmp_path / "run", threads=2)
    found = run.measure("walls", begin=0.6)
    assert float(np.mean(found.force[:, 0, 2])) == pytest.approx(0.1152, rel=0.25)
    assert float(np.mean(found.force[:, 0, 0])) < 0.0  # the grains hold the lid back
    assert run.tally["residual"][-1] < 2e-3
    assert run.tally["wall"][-1] > 0.0
    t = float(run.frames.t[-1])
    walls = run.scene_at(t).walls
    assert walls is not None
    assert pose(walls.motion[0], t)[1] == pytest.approx([0.01 * t, 0.0, -run.wall_travel[-1, 0]], abs=1e-12)


def test_the_mean_force_on_grains_that_flow_is_the_one_asked() -> None:
    """Contacts come and go from one correction to the next, and force with them; each yields to the way."""
    scene, rng = build(read_text(ONE)).scene, np.random.default_rng(1)
    rule, impulse = ServoRule.of(scene, 0.0), np.zeros(N_IMPULSE)
    assert rule is not None
    since = rule.interval(scene) * scene.dt
    engine: Any = SimpleNamespace(
        tally=lambda: SimpleNamespace(walls=tuple(impulse)), set_walls=lambda _motion: None
    )
    forces: list[float] = []
    for k in range(1, 20_001):
        contacts = float(rng.choice([1.0, 3.0, 8.0]))
        way = float(rule.travel_at(k * since)[0])
        forces.append(max(contacts * K / 20.0 * (way - 1.0e-3), 0.0))
        impulse[2] += forces[-1] * since  # the grains push the lid up
        impulse[TOUCHED] += contacts * since
        rule.correct(scene, engine, k, k * since)
    assert np.mean(forces[10_000:]) == pytest.approx(FORCE, rel=0.03)


@pytest.mark.full
def test_the_impulse_of_the_wall_is_the_change_of_momentum(one: Results) -> None:
    """Over a time in which the grain falls to the floor and is pressed: floor and lid carry its weight."""
    m, first = one.scene.m, 25
    before, after = ((m[:, None] * np.asarray(one.frames.v[k])).sum(axis=0) for k in (first, -1))
    assert after - before == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    on_lid = one.walls[-1, 0, 2] - one.walls[first, 0, 2]
    assert on_lid == pytest.approx(FORCE * float(one.frames.t[-1] - one.frames.t[first]), rel=1e-6)


@pytest.mark.parametrize("share", [0.3, 0.5, 0.71])
@pytest.mark.parametrize("servo", [True, False])
def test_a_run_resumes_with_the_same_bits(
    bed: dict[bool, Results], tmp_path: Path, stop_at: Any, share: float, servo: bool
) -> None:
    """Also one whose lid sinks at a given speed: pairs are listed with the lid where it stood then."""
    stop_at(round(share * bed[servo].summary["steps"]))
    text = SERVO if servo else SINKING
    assert done(text, tmp_path / "run").status == schema.STOPPED
    assert done(text, tmp_path / "run", resume=True).status == schema.COMPLETE
    assert differences(bed[servo].folder, tmp_path / "run") == []


@pytest.mark.full
def test_a_wall_with_nothing_in_its_way_ends_the_run(tmp_path: Path) -> None:
    """It comes down beside the grain, which the check before the run cannot tell from one below it."""
    beside = 'at = ["2 cm", "0 cm", "5 mm"]'
    away = ONE.replace('at = ["0 cm", "0 cm", "5 mm"]', beside)
    away = away.replace('"5 cm/s"', '"5 cm/s", max_travel = "4 mm"')
    with pytest.raises(
        WallLost, match=r"wall 'lid' has moved 0\.004.* m, and exerts -?0 N of the 0\.5 N"
    ) as said:
        done(away, tmp_path / "run")
    assert "raise servo.max_travel" in str(said.value)
    left = Results.open(tmp_path / "run")
    assert left.status == schema.FAILED
    assert 0.07 < left.frames.t[-1] < 0.1
    assert left.wall_travel[-1, 0] == pytest.approx(0.05 * left.frames.t[-1], rel=0.05)


@pytest.mark.full
def test_the_page_moves_the_wall_at_every_frame(one: Results, tmp_path: Path) -> None:
    one.view().save(tmp_path / "view.html")
    text = (tmp_path / "view.html").read_text()
    begin = text.index('"scenes"')
    assert text.count('"gravity"', begin) == len(one.frames)
    assert one.film(frames=2, size=(480, 270)) is not None
