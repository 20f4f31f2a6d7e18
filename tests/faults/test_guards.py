"""Every guard, provoked in a run: it names grain, step, time, cause and remedy, and loses nothing."""

import math
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib.resources import files
from itertools import count
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))

from campaign import differences, run
from kinds import KINDS

import ryusa
from ryusa.build import scene
from ryusa.casefile.read import read_text
from ryusa.cli import main
from ryusa.engine.cpu import engine as cpu
from ryusa.errors import (
    CaseError,
    ContactSlotsFull,
    EnergyCreated,
    GrainLost,
    ListUnsafe,
    NotANumber,
    OverlapTooLarge,
    RunError,
    WaterError,
)
from ryusa.laws.families import ContactTiming
from ryusa.results import Results, schema
from ryusa.running import checkpoint_scheduler, loop, recorder
from ryusa.running import folder as folder_module
from ryusa.running.checkpoint import read_checkpoint
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

D = 2e-3  # m
Run = Callable[[Path, bool], Results]


@pytest.fixture(autouse=True)
def often(monkeypatch: pytest.MonkeyPatch) -> None:
    """A checkpoint after every hundred steps, whatever it costs."""
    monkeypatch.setattr(loop.Loop, "_chunk", lambda self: 101)
    monkeypatch.setattr(checkpoint_scheduler, "_SHARE", math.inf)


def case(text: str, **settings: str) -> Run:
    made = read_text(text, {name.replace("__", "."): value for name, value in settings.items()})
    return lambda folder, resume: ryusa.run(made, folder, progress=False, checkpoint=1e-9, resume=resume)


def drop(**settings: str) -> Run:
    return case(files("ryusa").joinpath("cases", "drop.toml").read_text(encoding="utf-8"), **settings)


def by_hand(made: tuple, frames: float = 1e-3, time: float = 1.0) -> Run:
    return lambda folder, resume: run_scene(
        *made, folder, frames=frames, stop=Stop(time=time), progress=False, checkpoint=1e-9, resume=resume
    )


def stopped(go: Run, folder: Path, kind: type[RunError] | type[WaterError]) -> RunError | WaterError:
    """Run into a guard, and see that all is kept; going on ends at the same step, in the same words."""
    with pytest.raises(kind) as first:
        go(folder, False)
    fault = first.value
    results = Results.open(folder)
    assert results.status == schema.FAILED
    assert str(fault) == results.provenance["message"]
    assert f"step {fault.step}" in str(fault)
    assert f"t = {fault.t:.6g} s" in str(fault)
    assert len(fault.hint) > 40
    assert len(results.frames) > 2
    assert np.isfinite(results.frames.x[:]).all()
    if isinstance(fault, RunError):
        assert f"grain {fault.grain}" in str(fault)
        assert fault.step - results.summary["steps"] in {-1, 0}
    kept = read_checkpoint(folder / schema.CHECKPOINT, results.scene.n_grain)
    state = kept.block("state")
    assert 0 < state.values["step"] <= results.summary["steps"]
    assert np.isfinite(state.arrays["x"]).all()
    n_frame = len(results.frames)
    with pytest.raises(kind) as again:
        go(folder, True)
    assert str(again.value) == str(fault)
    assert len(Results.open(folder).frames) == n_frame
    return fault


def test_a_nan_stops_the_run(tmp_path: Path) -> None:
    fixed, first = scene([[0, 0, 5 * D], [0, 0, 9 * D]], D, v=[[0, 0, 0], [0, 0, -0.5]], gravity=0.0)
    stiff = replace(fixed, contact=replace(fixed.contact, k_n=math.inf), overlap_limit=math.inf)
    fault = stopped(by_hand((stiff, first)), tmp_path / "run", NotANumber)
    assert "springs" in fault.hint


def test_a_run_whose_engine_gives_no_more_numbers_is_written_as_failed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its last words are its fault, though there is no summary of it."""
    tally, lost = cpu.CpuEngine.tally, OverlapTooLarge("too large", grain=0, step=1, t=0.0, hint="")

    def fails(self: cpu.CpuEngine) -> object:
        if self.grains().step > 0:
            raise lost
        return tally(self)

    monkeypatch.setattr(cpu.CpuEngine, "tally", fails)
    with pytest.raises(OverlapTooLarge):
        drop()(tmp_path / "run", False)
    found = Results.open(tmp_path / "run")
    assert found.status == schema.FAILED
    assert "too large" in found.provenance["message"]
    assert len(found.frames) >= 1


def test_an_overlap_beyond_the_limit_stops_the_run(tmp_path: Path) -> None:
    soft = drop(contact__stiffness="0.01 N/cm")
    fault = stopped(soft, tmp_path / "run", OverlapTooLarge)
    assert fault.partner == 1
    assert "contact.stiffness" in fault.hint


def test_a_grain_that_leaves_the_domain_stops_the_run(tmp_path: Path) -> None:
    box = {"domain__low": '["-1 m", "-1 m", "-1 m"]', "domain__high": '["2.3 cm", "1 m", "1 m"]'}
    fault = stopped(case(KINDS["dry-2d"], **box), tmp_path / "run", GrainLost)
    assert "domain.low" in fault.hint


def test_an_excessive_speed_stops_the_run(tmp_path: Path) -> None:
    fast = drop(motion__gravity="10000 m/s2", build__height="4 m", record__frames="0.1 ms")
    fault = stopped(fast, tmp_path / "run", ListUnsafe)
    assert "time.steps_per_contact" in fault.hint


@pytest.mark.full
def test_created_energy_stops_the_run(tmp_path: Path) -> None:
    """Grains that boil because the step is too long, and would do so for ever."""
    n, draw = 60, np.random.default_rng(1)
    a, c = np.meshgrid(np.arange(10), np.arange(6))
    x = np.column_stack(
        [1.05 * D * a.ravel() + draw.uniform(0, 0.04 * D, n), np.zeros(n), D + 1.1 * D * c.ravel()]
    )
    bed = np.column_stack([np.arange(-1, 12) * D, np.zeros((13, 2))])
    sides = [("left", (-D, 0, 0), (1, 0, 0)), ("right", (11.5 * D, 0, 0), (-1, 0, 0))]
    made = scene(
        x,
        D,
        x_fixed=bed,
        planes=sides,
        plane_case=True,
        steps_per_contact=2.1,
        restitution=0.9,
        timing=ContactTiming.AT_STEPS,
    )
    fault = stopped(by_hand(made), tmp_path / "run", EnergyCreated)
    assert "J that no force supplied" in fault.cause
    assert "time.steps_per_contact" in fault.hint


def test_more_contact_records_than_the_buffer_holds_stop_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cpu, "_RECORDS", 9)
    angles = np.radians([-20.0, -10.0, 10.0, 20.0])
    normals = np.column_stack([-np.cos(angles), np.sin(angles), np.zeros(4)])
    sides = [(f"side {k}", tuple(-(0.5 * D - 1e-8) * one), tuple(one)) for k, one in enumerate(normals)]
    x, v = [[-D, 0, 1.5 * D * k] for k in range(8)], [[0.01, 0, 0]] * 8
    made = scene(x, D, gravity=0.0, planes=sides, v=v, allow_overlap=True)
    fault = stopped(by_hand(made, time=2.0), tmp_path / "run", ContactSlotsFull)
    assert "record.events" in fault.hint


def test_a_small_grain_in_the_bed_limits_the_speed_of_a_large_one(tmp_path: Path) -> None:
    """So that neither passes through the other, or through the bed, within a step."""
    bed = np.column_stack([np.arange(-4, 5) * D, np.zeros((9, 2))])
    sizes = np.where(np.arange(9) == 4, 0.1 * D, D)
    made = scene(
        [[0, 0, 40 * D]],
        D,
        v=[[0, 0, -5.0]],
        x_fixed=bed,
        d_fixed=sizes,
        gravity=1e4,
        stiffness=1e4,
        steps_per_contact=50.0,
    )
    fault = stopped(by_hand(made, frames=1e-4), tmp_path / "run", ListUnsafe)
    assert fault.grain == 0
    assert "pass through" in fault.hint
    way = 0.25 * 0.1 * D
    assert 5.0 + 1e4 * fault.t == pytest.approx(way / made[0].dt, rel=1e-2)


@pytest.mark.full
def test_a_column_without_solution_stops_the_run(tmp_path: Path) -> None:
    """Soft grains under a huge weight are pressed so close that drag outruns the step."""
    settings = {
        "contact__stiffness": "1 N/cm",
        "motion__gravity": "1000 m/s2",
        "domain__overlap_limit": "1.0",
    }
    fault = stopped(case(KINDS["two-way"], **settings), tmp_path / "run", WaterError)
    assert "step" in fault.hint


def test_a_disk_nearly_full_pauses_a_run_that_then_continues_with_the_same_bits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run("rolling", tmp_path / "whole")
    asked = count()
    monkeypatch.setattr(recorder, "free_bytes", lambda place: 1 << 20 if next(asked) % 3 else 1 << 40)
    monkeypatch.setattr(recorder, "flush_after", lambda elapsed, n_part: 0.02)
    monkeypatch.setattr(loop.time, "sleep", lambda seconds: None)
    results = run("rolling", tmp_path / "hurt")
    log = (results.folder / schema.LOG).read_text(encoding="utf-8")
    assert "paused: " in log
    assert "the disk is almost full" in log
    assert "free space is available again" in log
    assert differences(tmp_path / "whole", tmp_path / "hurt") == []


@pytest.mark.parametrize("kind", ["dry-3d", "dry-2d"])
def test_more_grains_than_memory_holds_are_refused_in_a_moment(
    tmp_path: Path, kind: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "huge.toml"
    path.write_text(KINDS[kind], encoding="utf-8")
    monkeypatch.setattr(folder_module, "available_memory", lambda: 1e9)
    many = [word for key in ("columns", "layers") for word in ("--set", f"build.{key}=1000")]
    with pytest.raises(SystemExit) as left:
        main(["run", str(path), "-o", str(tmp_path / "run"), *many])
    assert left.value.code == CaseError.exit_code
    said = capsys.readouterr().err
    assert "GB of memory; 1 GB are available" in said
    assert "Take fewer grains" in said
    assert not (tmp_path / "run").exists()
