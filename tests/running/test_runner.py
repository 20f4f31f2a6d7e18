import json
import os
import signal
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.running.conftest import DROP

from ryusa.casefile import derive, estimate, read_text
from ryusa.compiled import waiting
from ryusa.errors import CaseError, DiskFull, ResultsError, RunError
from ryusa.laws.families import Rolling
from ryusa.model import RollingLaw
from ryusa.model.scene import EventRule
from ryusa.results import Results
from ryusa.running import folder as folder_module
from ryusa.running.record_buffer import bytes_per_frame
from ryusa.running.runner import run, run_scene
from ryusa.running.stops import Stop
from ryusa.running.timeline import Change


@pytest.fixture
def go(scene: Any, state: Any, engine: Any, tmp_path: Path) -> Any:
    def run(**changes: Any) -> Results:
        arguments: dict[str, Any] = {
            "scene": scene,
            "state": state,
            "folder": tmp_path / "run",
            "frames": 1e-3,
            "stop": Stop(time=0.01),
            "engine": engine,
            "progress": False,
        }
        return run_scene(**{**arguments, **changes})

    return run


def test_frame_k_falls_on_step_round_of_k_interval_over_dt(go: Any, scene: Any) -> None:
    results = go(frames=0.37e-3)
    k = np.arange(len(results.frames))
    assert results.frames.step.tolist() == [round(n * 0.37e-3 / scene.dt) for n in k]
    assert len(k) == 28
    assert results.frames.x[5, 1, 2] == results.frames.step[5] + 1 / 8


def test_a_frame_at_every_step_misses_none(go: Any, scene: Any) -> None:
    assert go(frames=scene.dt, stop=Stop(time=1e-3)).frames.step.tolist() == list(range(101))


def test_a_finished_run_says_complete_and_how_it_ended(go: Any) -> None:
    results = go()
    assert results.complete
    assert results.provenance["message"] == "reached 0.01 s"
    assert results.summary["steps"] == 1000
    assert results.provenance["end"] >= results.provenance["begin"]
    assert "complete: reached 0.01 s" in (results.folder / "log.txt").read_text()


def test_the_host_name_stays_out_of_the_run_folder(go: Any) -> None:
    import socket

    name = socket.gethostname()
    assert all(name not in path.read_text() for path in go().folder.glob("*.json")) or len(name) < 4


def test_a_run_stops_once_all_grains_rest_long_enough(go: Any, engine: Any) -> None:
    engine.speed = lambda step: 0.0 if step >= 300 else 1.0
    results = go(stop=Stop(time=1.0, rest_speed=1e-4, rest_for=1e-3))
    assert results.complete
    assert 400 <= results.summary["steps"] <= 425


def test_rest_before_the_last_change_of_the_timeline_does_not_stop_a_run(go: Any, engine: Any) -> None:
    engine.speed = lambda step: 0.0
    results = go(
        stop=Stop(time=1.0, rest_speed=1e-4, rest_for=1e-3), changes=[Change(0.005, lambda scene: scene)]
    )
    assert 600 <= results.summary["steps"] <= 625


def test_saltations_of_the_slowest_grain_stop_a_run(go: Any, engine: Any, event: Any) -> None:
    for k in range(20):
        for i in range(3):
            step = 100 * (k + 1) * (2 if i == 1 else 1) + i
            engine.events_at[step] = event(i, 3, 0.2 * k * (i + 1), 0.2 * k * (i + 1) + 1e-4)
    results = go(stop=Stop(time=1.0, saltations=5))
    assert results.provenance["message"] == "every tracked grain made 5 saltations"
    assert min(results.summary["saltations"]) == 5
    assert results.summary["steps"] == 1300


def test_a_change_of_the_timeline_lands_on_its_step(go: Any, engine: Any, scene: Any) -> None:
    from dataclasses import replace

    gone = np.array([False, True])
    results = go(changes=[Change(0.00333, lambda now: replace(now, fixed_active=gone), "remove gate")])
    assert [step for step, _ in engine.loaded] == [0, 333]
    assert [step for step, _, _ in results.scenes] == [0, 333]
    assert results.scene_at(0.0).fixed_active.all()
    assert not results.scene_at(0.005).fixed_active[0]
    assert "remove gate" in (results.folder / "log.txt").read_text()
    assert len(results.frames) == 11


def test_a_fault_is_named_and_everything_before_it_is_kept(go: Any, engine: Any, tmp_path: Path) -> None:
    engine.fault_at = 555
    with pytest.raises(RunError, match="made to fail: grain 1"):
        go()
    results = Results.open(tmp_path / "run")
    assert results.status == "failed"
    assert "made to fail" in results.provenance["message"]
    assert results.frames.step.tolist() == [0, 100, 200, 300, 400, 500]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_run_cleanly(go: Any, engine: Any, number: signal.Signals) -> None:
    engine.on_advance = lambda step: os.kill(os.getpid(), number) if step >= 400 else None
    before = signal.getsignal(number)
    results = go()
    assert results.status == "stopped"
    assert results.frames.step[-1] <= 400
    assert signal.getsignal(number) is before


def test_an_unforeseen_error_is_not_swallowed(go: Any, engine: Any, tmp_path: Path) -> None:
    def fail(step: int) -> None:
        raise ZeroDivisionError("a bug")

    engine.on_advance = fail
    with pytest.raises(ZeroDivisionError):
        go()
    assert Results.open(tmp_path / "run").status == "failed"


def test_an_earlier_run_is_refused_then_replaced_on_request(go: Any) -> None:
    first = go()
    (first.folder / "notes.md").write_text("mine")
    with pytest.raises(ResultsError, match="--overwrite"):
        go()
    second = go(overwrite=True, stop=Stop(time=0.002))
    assert len(second.frames) == 3
    assert (first.folder / "notes.md").read_text() == "mine"


@pytest.mark.parametrize("content", [{}, {"provenance.json": "{}"}, {"provenance.json": '{"format": 2}'}])
def test_a_folder_that_is_no_run_is_never_deleted(go: Any, tmp_path: Path, content: dict[str, str]) -> None:
    (tmp_path / "run" / "parts").mkdir(parents=True)
    (tmp_path / "run" / "thesis.tex").write_text("all of it")
    for name, text in content.items():
        (tmp_path / "run" / name).write_text(text)
    with pytest.raises(ResultsError, match="not a run folder of ryusa"):
        go(overwrite=True)
    assert (tmp_path / "run" / "thesis.tex").read_text() == "all of it"


def test_overwriting_follows_no_link_out_of_the_folder(go: Any, tmp_path: Path) -> None:
    results = go()
    outside = tmp_path / "outside"
    (results.folder / "parts").rename(outside)
    (results.folder / "parts").symlink_to(outside)
    before = {path: path.stat().st_mtime_ns for path in outside.iterdir()}
    with pytest.raises(ResultsError):
        go(overwrite=True)
    assert {path: path.stat().st_mtime_ns for path in outside.iterdir()} == before


def test_a_folder_that_cannot_be_made_is_one_clear_error(go: Any, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ResultsError, match="cannot be written"):
        go(folder=tmp_path / "file" / "run")


def test_frames_that_do_not_fit_on_the_disk_are_refused_before_work(
    go: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(folder_module, "free_bytes", lambda place: 5000)
    with pytest.raises(CaseError, match=r"record\.frames.*only 5 kB are free"):
        go(frames=1e-5)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(("stop", "key"), [("0.1 s", "record.frames"), ("1000 s", "record.events")])
def test_check_and_run_agree_on_what_fits_events_counted(
    stop: str, key: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = read_text(DROP, {"stop.time": stop, "record.frames": stop})
    derived = derive(case)
    frames, events = estimate.disk_needed(case, derived), estimate.disk_for_events(case, derived)
    assert frames == estimate.frames_expected(case) * bytes_per_frame(1) + estimate.BYTES_PER_RUN
    monkeypatch.setattr(folder_module, "free_bytes", lambda place: frames + events - 1)
    with pytest.raises(CaseError, match="contact records about") as caught:
        run(case, tmp_path / "run", progress=False)
    assert caught.value.key == key
    assert not (tmp_path / "run").exists()


@pytest.fixture
def full(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A disk that has no room from a step on, and has again later."""
    from ryusa.running import disk, recorder

    sync, state = disk.sync, {"full": False}

    def refuses(path: Path) -> None:
        if state["full"]:
            raise OSError(28, "No space left on device")
        sync(path)

    monkeypatch.setattr(disk, "sync", refuses)
    monkeypatch.setattr(recorder, "flush_after", lambda elapsed, n_part: 0.0)
    monkeypatch.setattr(disk, "_RETRY_EVERY", 0.01)
    return state


def test_a_full_disk_pauses_a_run_which_goes_on_when_there_is_room(
    go: Any, engine: Any, full: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    from ryusa.running import disk

    looks: list[float] = []

    def sleep(seconds: float) -> None:
        looks.append(seconds)
        full["full"] = len(looks) < 5

    monkeypatch.setattr(disk.time, "sleep", sleep)
    engine.on_advance = lambda step: full.update(full=full["full"] or step == 500)
    results = go()
    assert results.complete
    assert len(looks) == 5
    assert results.frames.step.tolist() == list(range(0, 1001, 100))
    log = (results.folder / "log.txt").read_text()
    assert log.count("paused: ") == 1
    assert log.count("free space is available again") == 1


def test_a_disk_that_stays_full_ends_the_run_with_what_was_written_and_a_final_status(
    go: Any, engine: Any, full: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from ryusa.running import disk

    monkeypatch.setattr(disk, "_DISK_TIMEOUT", 0.05)

    def nothing_new(path: Path, content: bytes) -> Path:
        raise OSError(28, "No space left on device")

    engine.on_advance = lambda step: step >= 500 and monkeypatch.setattr(disk, "write_temporary", nothing_new)
    with pytest.raises(DiskFull, match="No space left"):
        go()
    results = Results.open(tmp_path / "run")
    assert len(results.frames) >= 4
    assert results.status == "failed"
    assert "No space left" in results.provenance["message"]


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"stop": Stop()}, "stop"),
        ({"frames": 1e-6}, "record.frames"),
        ({"frames": float("nan")}, "record.frames"),
        ({"stop": Stop(time=1e60)}, "stop.time"),
        ({"engine": None, "threads": 0}, "threads"),
    ],
)
def test_a_run_that_cannot_be_is_refused_by_key(go: Any, changes: dict[str, Any], key: str) -> None:
    with pytest.raises(CaseError) as caught:
        go(**changes)
    assert caught.value.key == key


def test_what_an_engine_refuses_is_said_before_work(go: Any, scene_with: Any, tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="no rolling friction here"):
        go(scene=scene_with(rolling=RollingLaw(model=Rolling.PRINTED)))
    assert not (tmp_path / "run").exists()


def test_saltations_cannot_be_counted_without_events(go: Any, scene_with: Any) -> None:
    with pytest.raises(CaseError, match=r"record\.events"):
        go(scene=scene_with(events=EventRule.NONE), stop=Stop(saltations=3))


def test_json_of_a_run_holds_no_nan(go: Any) -> None:
    def refuse(word: str) -> None:
        raise AssertionError(word)

    for path in go().folder.glob("*.json"):
        json.loads(path.read_text(), parse_constant=refuse)


def test_calls_to_the_engine_are_short_at_first_and_land_on_frames(go: Any, engine: Any) -> None:
    go()
    assert engine.calls[:2] == [1, 16]
    assert sum(engine.calls) == 1000


def test_a_case_is_run_with_its_text_and_resolved_form(tmp_path: Path, engine: Any, monkeypatch: Any) -> None:
    import ryusa

    text = (Path(ryusa.__file__).parent / "cases" / "drop.toml").read_text(encoding="utf-8")
    (tmp_path / "fall.toml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    case = ryusa.load("fall.toml", {"stop.time": "5 ms"})
    results = ryusa.run(case, engine=engine, progress=False)
    assert results.folder == Path("runs") / "fall"
    assert (results.folder / "case.toml").read_text(encoding="utf-8") == text
    assert results.case["stop"]["time"] == 0.005
    assert results.provenance["overrides"] == {"stop.time": "5 ms"}
    assert results.provenance["seed"] == case.seed


def test_an_entry_of_the_timeline_is_logged_as_the_case_says_it(tmp_path: Path, engine: Any) -> None:
    import ryusa

    text = (Path(ryusa.__file__).parent / "cases" / "drop.toml").read_text(encoding="utf-8")
    text += '\n[[timeline]]\nat = "1 ms"\nslope_angle = "10 deg"\n'
    text += '[[timeline]]\nat = "2 ms"\nslope = "1/10"\n'
    (tmp_path / "fall.toml").write_text(text, encoding="utf-8")
    case = ryusa.load(tmp_path / "fall.toml", {"stop.time": "3 ms", "timeline.1.slope": "1/20"})
    ryusa.run(case, tmp_path / "run", engine=engine, progress=False)
    log = (tmp_path / "run" / "log.txt").read_text()
    assert " s: slope_angle 10 deg\n" in log
    assert " s: slope 1/20\n" in log


@pytest.mark.parametrize("left", [[], [".provenance.json.new"]])
def test_a_folder_left_by_a_run_killed_as_it_began_is_used(go: Any, tmp_path: Path, left: list[str]) -> None:
    (tmp_path / "run" / "parts").mkdir(parents=True)
    for name in left:
        (tmp_path / "run" / name).write_text("{")
    assert go().complete
    assert go(overwrite=True).complete


def test_a_folder_left_by_a_run_that_was_killed_before_it_made_parts_is_used(go: Any, tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / ".lock").write_bytes(b"")
    assert go().complete


def test_an_empty_parts_folder_behind_a_link_is_not_used(go: Any, tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "parts").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(ResultsError, match="not a run folder of ryusa"):
        go()
    assert not any((tmp_path / "elsewhere").iterdir())


def test_a_folder_without_write_permission_is_not_reported_as_full(
    go: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(**_: Any) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(folder_module, "free_bytes", lambda place: 0)
    monkeypatch.setattr(folder_module.tempfile, "TemporaryFile", refused)
    with pytest.raises(ResultsError, match="cannot be written \\(Permission denied\\)"):
        go()
    assert not (tmp_path / "run").exists()


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no /proc")
def test_a_folder_under_proc_is_one_clear_error(go: Any) -> None:
    with pytest.raises(ResultsError, match="cannot be written"):
        go(folder="/proc/ryusa-run")


def test_an_interrupt_before_the_first_step_leaves_no_folder(
    go: Any, engine: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = signal.getsignal(signal.SIGINT)

    def refuses(scene: Any) -> tuple[str, ...]:
        os.kill(os.getpid(), signal.SIGINT)
        return ()

    monkeypatch.setattr(engine, "refuses", refuses)
    with pytest.raises(KeyboardInterrupt, match="Ctrl-C before the first step"):
        go()
    assert not (tmp_path / "run").exists()
    assert signal.getsignal(signal.SIGINT) is before


def test_an_interrupt_while_kernels_load_waits_and_ends_the_run(
    go: Any, engine: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    load = engine.load

    def interrupted(*arguments: Any) -> None:
        try:
            os.kill(os.getpid(), signal.SIGINT)
            load(*arguments)
        except KeyboardInterrupt:  # as a callback of the compiler does
            load(*arguments)

    monkeypatch.setattr(engine, "load", interrupted)
    results = go()
    assert results.status == "stopped"
    assert results.frames.step.tolist() == [0]


def test_a_grain_that_spins_in_place_is_not_at_rest(
    go: Any, engine: Any, scene_with: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    from dataclasses import replace

    engine.speed = lambda step: 0.0
    state = engine.state

    def spinning() -> Any:
        now, spin = state(), 0.2 if state().step < 500 else 0.05  # rad/s; d/2 = 1 mm
        return replace(now, omega=np.tile([0.0, spin, 0.0], (3, 1)))

    monkeypatch.setattr(engine, "state", spinning)
    stop = Stop(time=0.01, rest_speed=1e-4, rest_for=1e-3)
    assert 600 <= go(scene=scene_with(3, rotation=True), stop=stop).summary["steps"] <= 625
    assert go(scene=scene_with(3, rotation=False), stop=stop, overwrite=True).summary["steps"] <= 125


def test_a_run_separates_compiling_from_running(
    go: Any, engine: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    wall = [0.0]
    monkeypatch.setattr(waiting, "done", lambda: waiting.Done(1, wall[0]))
    results = go(progress=True, stop=Stop(time=1e-3))
    assert results.summary["compiled"] == 0.0 and "compil" not in capsys.readouterr().err

    def compile_at_first(step: int) -> None:
        if step == 1:
            time.sleep(0.1)
            wall[0] += 0.1

    engine.on_advance = compile_at_first
    summary = go(progress=True, stop=Stop(time=1e-3), overwrite=True).summary
    assert summary["compiled"] == pytest.approx(0.1) and summary["wall"] >= 0.1
    assert "compiled 0.1 s, stepped and recorded" in capsys.readouterr().err


def test_an_engine_is_chosen_by_name_or_refused_in_one_line(go: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from ryusa.engine.cuda import availability

    with pytest.raises(
        CaseError, match=r"engine = 'cuad': must be cpu .* or lammps .*\. Did you mean 'cuda'"
    ):
        go(engine="cuad")
    monkeypatch.setattr(availability, "unavailable", lambda: "the CUDA driver finds no card")
    with pytest.raises(CaseError, match="engine = 'cuda': the CUDA driver finds no card"):
        go(engine="cuda")
