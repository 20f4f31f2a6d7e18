"""Walls pressed by a servo beside feeds and exits: force, way, account, and the same bits after a stop."""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ryusa
from ryusa.casefile import read_text
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.cpu.prune_schedule import APPROACH
from ryusa.engine.protocol import Flags
from ryusa.model.walls import INTERVAL
from ryusa.results import Results

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences
from kinds import KINDS

# with other seeds one bed in eight gives way, and the lid follows it down without a force to measure
SERVO_FEEDS = KINDS["servo-feeds"].replace("[grains]", "seed = 2\n[grains]", 1)

D, K, FORCE, MASS, G = 4.0e-3, 2000.0, 0.5, 2650.0 * math.pi / 6.0 * 4.0e-3**3, 9.80665
EMPTY = f"""
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
at = ["0 cm", "0 cm", "9 mm"]
normal = [0, 0, 1]
radius = "1 cm"
servo = {{ direction = [0, 0, -2], force = "{FORCE:g} N", max_speed = "5 cm/s" }}
[build]
kind = "empty"
[[feeds]]
name = "tray"
low = ["-2 mm", "-2 mm", "0 mm"]
high = ["2.1 mm", "2.1 mm", "4.1 mm"]
rate = "10 grains/s"
begin = "0.02 s"
end = "0.1 s"
[stop]
time = "0.35 s"
[record]
frames = "10 ms"
"""


def done(text: str, folder: Path, **how: Any) -> Results:
    return ryusa.run(read_text(text), folder, progress=False, **how)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return done(SERVO_FEEDS, tmp_path_factory.mktemp("servo") / "run")


@pytest.mark.full
def test_a_lid_sinks_through_an_empty_box_and_presses_the_grain_that_is_fed(tmp_path: Path) -> None:
    run = done(EMPTY, tmp_path / "run")
    assert len(run.passages) == 1
    t = np.asarray(run.frames.t)
    free = t <= 0.02
    interval = int(run.scene.walls.servo[0, INTERVAL]) * run.scene.dt if run.scene.walls else math.nan
    np.testing.assert_allclose(
        run.wall_travel[free, 0], 0.05 * np.maximum(t[free] - interval, 0.0), atol=1e-12
    )
    found = run.measure("walls", begin=0.3)
    assert found.force[-1, 0] == pytest.approx([0.0, 0.0, FORCE], rel=1e-6, abs=1e-9)
    travel = 9.0e-3 - D + FORCE / K + (FORCE + MASS * G) / K
    assert run.wall_travel[-1, 0] == pytest.approx(travel, rel=1e-6)


def test_a_lid_follows_a_bed_that_is_drawn_off_and_fed(whole: Results) -> None:
    traffic = whole.summary["traffic"]
    assert traffic["feeds"][0]["entered"] > 25
    assert traffic["exits"][0]["left"] > 15
    found = whole.measure("walls", begin=0.2)
    # a lid lags on a bed that sinks from under it, by 2 N k T times its speed (design/0019): 0.42 N here
    assert float(np.mean(found.force[:, 0, 2])) == pytest.approx(0.5, rel=0.2)
    sunk = whole.wall_travel[:, 0]
    assert sunk[-1] > sunk[len(sunk) // 5] + 2.0e-3  # on grains, not only on the way to them
    assert whole.tally["residual"][-1] < 2e-3


def test_any_number_of_threads_gives_the_same_bits(whole: Results, tmp_path: Path) -> None:
    done(SERVO_FEEDS, tmp_path / "run", threads=2)
    assert differences(whole.folder, tmp_path / "run") == []


def test_lists_of_pairs_never_show_beside_feeds(
    whole: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The other run lists pairs anew in every step."""
    advance = CpuEngine.advance

    def one_by_one(engine: CpuEngine, n_steps: int) -> Flags:
        for _ in range(n_steps):
            engine._candidates.schedule[APPROACH] = np.inf
            if flags := advance(engine, 1):
                return flags
        return Flags()

    monkeypatch.setattr(CpuEngine, "advance", one_by_one)
    done(SERVO_FEEDS, tmp_path / "run")
    assert differences(whole.folder, tmp_path / "run") == []


@pytest.mark.parametrize(
    "stops", [(520, 521, 522), (3 * 521, 12_160), (33 * 500 - 1, 33 * 500, 33 * 500 + 1)]
)
def test_a_stopped_run_resumes_with_the_same_bits(
    whole: Results, tmp_path: Path, stop_at: Any, stops: tuple[int, ...]
) -> None:
    """At, before and after instants (every 521 steps) and corrections (every 33)."""
    assert whole.scene.traffic is not None
    assert whole.scene.walls is not None
    assert (whole.scene.traffic.interval, int(whole.scene.walls.servo[0, INTERVAL])) == (521, 33)
    for step in stops:
        stop_at(step)
        done(SERVO_FEEDS, tmp_path / "run", resume=True)
    assert done(SERVO_FEEDS, tmp_path / "run", resume=True).complete
    assert differences(whole.folder, tmp_path / "run") == []
