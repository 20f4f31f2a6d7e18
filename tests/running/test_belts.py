"""Runs with a belt: started and stopped by the timeline, with grains that leave it, resumed and measured."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ryusa
from ryusa.build import WallMotion, rectangle
from ryusa.build import scene as scene_of
from ryusa.casefile import read
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.pool import GrainPool
from ryusa.engine.shared.passages import removed
from ryusa.model import Traffic
from ryusa.model.walls import WORK
from ryusa.results import Results, schema

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences

CASE = """
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
[contact]
stiffness = "2000 N/m"
restitution = 0.5
friction = 0.5
[motion]
rotation = "free"
plane = false
[domain]
low = ["-10 cm", "-10 cm", "-10 cm"]
high = ["20 cm", "10 cm", "10 cm"]
[[walls]]
name = "belt"
shape = "rectangle"
at = ["-5 cm", "-5 cm", "0 cm"]
sides = [["20 cm", "0 cm", "0 cm"], ["0 cm", "10 cm", "0 cm"]]
[[timeline]]
at = "30 ms"
[timeline.move]
wall = "belt"
surface_velocity = ["0.8 m/s", "0 m/s", "0 m/s"]
[[timeline]]
at = "130 ms"
[timeline.move]
wall = "belt"
[[exits]]
name = "end"
point = ["2 cm", "0 cm", "0 cm"]
normal = [1, 0, 0]
[build]
kind = "fill"
low = ["-12 mm", "-9 mm", "0.1 mm"]
high = ["12 mm", "9 mm", "13 mm"]
[stop]
time = "0.15 s"
[record]
frames = "5 ms"
forces = true
events = "all"
"""


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Results:
    folder = tmp_path_factory.mktemp("belt")
    (folder / "case.toml").write_text(CASE)
    return ryusa.run(read(folder / "case.toml"), folder / "run", progress=False)


def test_a_belt_brings_grains_to_the_exit_while_it_runs_and_the_account_closes(whole: Results) -> None:
    t, work = np.asarray(whole.tally["t"]), np.asarray(whole.tally["wall"])
    assert np.all(work[t < 0.0299] == 0.0)
    assert np.all(work[t > 0.131] == work[-1])
    assert work[-1] > 0.0
    left = np.isnan(np.asarray(whole.frames.x[-1])[:, 0]).mean()
    assert 0.2 < left < 0.9
    # a move leaves half a step of each force of a touching grain times the change of speed unbooked
    assert whole.tally["residual"].max() < 3e-4


def test_the_measure_of_walls_gives_force_and_power_of_a_belt(whole: Results) -> None:
    found = whole.measure("walls", begin=0.0)
    runs = (found.t > 0.035) & (found.t < 0.125)
    along = found.force[runs, 0, 0]
    assert along.mean() < 0.0  # grains hold it back
    assert found.power[runs, 0] == pytest.approx(-0.8 * along, rel=1e-6, abs=0.03 * np.abs(along).max())
    assert np.all(found.power[found.t < 0.029, 0] == 0.0)


def test_a_run_with_a_belt_resumes_with_the_same_bits(whole: Results, tmp_path: Path, stop_at: Any) -> None:
    (tmp_path / "case.toml").write_text(CASE)
    case = read(tmp_path / "case.toml")
    stop_at(round(0.5 * whole.summary["steps"]))
    assert ryusa.run(case, tmp_path / "run", progress=False).status == schema.STOPPED
    assert ryusa.run(case, tmp_path / "run", progress=False, resume=True).status == schema.COMPLETE
    assert differences(whole.folder, tmp_path / "run") == []


def test_a_belt_does_no_work_on_a_grain_that_has_left() -> None:
    """One of two grains is taken away while a fast belt drags them: the account stays as it was."""
    d = 2.0e-3
    plate = rectangle("belt", (-0.05, -0.05, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0))
    plate = replace(plate, motion=WallMotion(surface_velocity=(20.0, 0.0, 0.0)))
    scene, state = scene_of(
        x=[[0.0, 0.0, 0.5 * d + 1e-9], [0.01, 0.0, 0.5 * d + 1e-9]], d=d, dt=2.0e-5, stiffness=2000.0,
        restitution=0.3, walls=[plate],
    )  # fmt: skip
    scene = replace(scene, traffic=Traffic((), (), 50, 2), world_low=(-1.0,) * 3, world_high=(1.0,) * 3)
    pool = GrainPool(CpuEngine())
    pool.load(scene, replace(state, present=np.ones(2, np.bool_)))
    pool.advance(500).raise_if_any()
    before = pool.state()
    assert before.tally is not None
    assert len(before.contacts) == 2
    gone, _ = removed(scene, before, np.array([0]))
    assert gone.tally is not None
    assert gone.tally.imbalance == pytest.approx(before.tally.imbalance, abs=1e-15)
    less = before.tally.walls[WORK] - gone.tally.walls[WORK]
    half_step = 0.5 * scene.dt * scene.contact.mu * float(scene.m[0]) * 9.80665 * 20.0
    assert less == pytest.approx(half_step, rel=1e-2)
