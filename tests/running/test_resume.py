"""Resume: the same bits, the same case and code only, and nothing repeated or lost."""

import json
import shutil
import signal
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.kernel_variants import full_but

import ryusa
from ryusa.build import scene as scene_of
from ryusa.casefile.read import read_text
from ryusa.errors import CheckpointError, ResultsError
from ryusa.model.feeds import IN
from ryusa.results import Results, schema
from ryusa.running import checkpoint_scheduler, loop, recorder
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences
from kinds import KINDS

CASE = KINDS["rolling"]
SHORT = {"stop.time": "0.13 s"}


def run(folder: Path, overrides: dict[str, str] | None = None, **how: Any) -> Results:
    return ryusa.run(read_text(CASE, SHORT | (overrides or {})), folder, progress=False, **how)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return run(tmp_path_factory.mktemp("whole") / "run")


@pytest.fixture
def stopped(tmp_path: Path, stop_at: Any) -> Path:
    """A run stopped somewhere between two frames, after the gate opened."""
    stop_at(19_000)
    results = run(tmp_path / "run")
    assert results.status == schema.STOPPED
    assert results.summary["steps"] % 37
    return tmp_path / "run"


def test_a_stopped_run_resumes_with_the_same_bits(stopped: Path, whole: Results) -> None:
    assert (stopped / schema.CHECKPOINT).is_file()
    results = run(stopped, resume=True)
    assert differences(whole.folder, stopped) == []
    assert not (stopped / schema.CHECKPOINT_BEFORE).exists()
    assert [one["step"] for one in results.provenance["resumed"]] == [
        results.provenance["resumed"][0]["step"]
    ]
    assert "resumed at step" in (stopped / schema.LOG).read_text()


@pytest.mark.parametrize("steps", [(1, 20, 400), (5_000, 5_001, 17_323), (17_324, 17_325, 22_000)])
def test_a_run_stopped_many_times_resumes_with_the_same_bits(
    tmp_path: Path, stop_at: Any, whole: Results, steps: tuple[int, ...]
) -> None:
    for step in steps:
        stop_at(step)
        run(tmp_path / "run", resume=True)
    run(tmp_path / "run", resume=True)
    assert differences(whole.folder, tmp_path / "run") == []


def test_contacts_of_an_incomplete_part_are_readable_and_not_counted_twice(
    stopped: Path, whole: Results
) -> None:
    before = Results.open(stopped)
    parts = sorted((stopped / "parts").glob("part-*"))
    assert before._parts[-1].tail
    assert before.contacts["t_part"].max() > before.frames.t[-1]
    run(stopped, resume=True)
    assert not any(part.tail for part in Results.open(stopped)._parts)
    assert len(parts) >= 1


def test_sigusr1_writes_a_checkpoint_and_the_run_continues(
    tmp_path: Path, stop_at: Any, whole: Results
) -> None:
    seen: list[bool] = []
    stop_at(9_000, signal.SIGUSR1)
    write = checkpoint_scheduler.CheckpointScheduler.write
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            checkpoint_scheduler.CheckpointScheduler,
            "write",
            lambda *arguments: (seen.append(True), write(*arguments))[1],
        )
        assert run(tmp_path / "run").complete
    assert seen == [True, True]  # on request, and at the end
    assert "on request" in (tmp_path / "run" / schema.LOG).read_text()
    assert differences(whole.folder, tmp_path / "run") == []


def test_parts_after_the_checkpoint_are_kept_and_not_written_twice(
    tmp_path: Path, stop_at: Any, whole: Results, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorder, "flush_after", lambda elapsed, n_part: 0.0)
    folder = tmp_path / "run"
    stop_at(9_000, signal.SIGUSR1)
    stop_at(19_000)
    run(folder)
    (folder / schema.CHECKPOINT).unlink()  # as if killed: only that of SIGUSR1 is left
    (folder / schema.CHECKPOINT_BEFORE).rename(folder / schema.CHECKPOINT)
    parts = [one for one in sorted((folder / "parts").glob("part-*"))[:-1]]
    stamps = [one.stat().st_mtime_ns for one in parts]
    run(folder, resume=True)
    assert [one.stat().st_mtime_ns for one in parts] == stamps
    assert differences(whole.folder, folder) == []


def test_a_run_killed_before_its_first_checkpoint_keeps_its_frames(stopped: Path, whole: Results) -> None:
    (stopped / schema.CHECKPOINT).unlink()
    first = sorted((stopped / "parts").glob("part-*"))[0]
    stamp = first.stat().st_mtime_ns
    run(stopped, resume=True)
    assert first.stat().st_mtime_ns == stamp
    assert differences(whole.folder, stopped) == []


def test_a_damaged_checkpoint_is_replaced_by_the_previous_one(
    tmp_path: Path, stop_at: Any, whole: Results
) -> None:
    folder = tmp_path / "run"
    stop_at(9_000, signal.SIGUSR1)
    stop_at(19_000)
    run(folder)
    with (folder / schema.CHECKPOINT).open("r+b") as file:
        file.seek(4000)
        file.write(b"rust")
    results = run(folder, resume=True)
    assert differences(whole.folder, folder) == []
    assert any("damaged" in one for one in results.provenance["resumed"][0]["said"])


def test_without_a_good_checkpoint_a_run_is_refused_in_one_line(stopped: Path) -> None:
    (stopped / schema.CHECKPOINT).write_bytes(b"junk")
    with pytest.raises(CheckpointError, match="not a checkpoint of ryusa") as caught:
        run(stopped, resume=True)
    assert "\n" not in str(caught.value)
    assert Results.open(stopped).status == "stopped"


def test_a_damaged_part_after_the_checkpoint_is_written_again(
    tmp_path: Path, stop_at: Any, whole: Results, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recorder, "flush_after", lambda elapsed, n_part: 0.0)
    folder = tmp_path / "run"
    stop_at(9_000, signal.SIGUSR1)
    stop_at(19_000)
    run(folder)
    (folder / schema.CHECKPOINT).unlink()
    (folder / schema.CHECKPOINT_BEFORE).rename(folder / schema.CHECKPOINT)
    parts = sorted((folder / "parts").glob("part-*"))
    parts[-4].write_bytes(parts[-4].read_bytes()[:1000])
    run(folder, resume=True)
    assert differences(whole.folder, folder) == []


def test_a_part_missing_before_the_checkpoint_is_reported(stopped: Path) -> None:
    sorted((stopped / "parts").glob("part-*"))[0].unlink()
    with pytest.raises(CheckpointError, match=r"part-000000\.h5 is missing.*before the checkpoint"):
        run(stopped, resume=True)


def test_a_checkpoint_of_another_run_is_refused(stopped: Path, tmp_path: Path, stop_at: Any) -> None:
    stop_at(15_000)
    run(tmp_path / "other", {"seed": "2"})
    shutil.copy(tmp_path / "other" / schema.CHECKPOINT, stopped / schema.CHECKPOINT)
    with pytest.raises(CheckpointError, match="belongs to another run"):
        run(stopped, resume=True)


def test_a_changed_case_is_refused_with_the_key(stopped: Path) -> None:
    for how in ({}, {"force": True}):
        with pytest.raises(
            CheckpointError, match=r"the case has changed since: contact.restitution 0.3 is now"
        ):
            run(stopped, {"contact.restitution": "0.4"}, resume=True, **how)


def test_a_stopped_run_goes_on_to_a_later_end(stopped: Path, tmp_path: Path) -> None:
    longer = {"stop.time": "0.14 s"}
    run(stopped, longer, resume=True)
    assert differences(run(tmp_path / "longer", longer).folder, stopped) == []


def test_a_new_rule_of_stopping_is_reported_and_resumed_with_force(stopped: Path) -> None:
    ruled = {"stop.rest": '{ speed = "1 mm/s", for = "5 ms" }'}
    with pytest.raises(CheckpointError, match=r"stop.rest.* is now .*With --force"):
        run(stopped, ruled, resume=True)
    assert run(stopped, ruled, resume=True, force=True).complete


@pytest.mark.parametrize("name", ["commit", "processor", "numba"])
def test_another_version_or_machine_is_reported_and_resumed_only_with_force(
    stopped: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from ryusa.running import resume

    code = resume.code_versions
    monkeypatch.setattr(resume, "code_versions", lambda origin: {**code(origin), name: "another"})
    with pytest.raises(
        CheckpointError, match=f"on another processor or by another version: {name} .* is now another"
    ):
        run(stopped, resume=True)
    results = run(stopped, resume=True, force=True)
    assert results.complete
    assert any("another version" in one for one in results.provenance["resumed"][0]["said"])


def test_a_folder_without_a_key_of_today_is_refused_with_the_version(stopped: Path) -> None:
    path = stopped / schema.CASE_JSON
    data = json.loads(path.read_text())
    del data["contact"]["timing"]
    path.write_text(json.dumps(data))
    made = json.loads((stopped / schema.PROVENANCE).read_text())
    (stopped / schema.PROVENANCE).write_text(json.dumps({**made, "commit": "an earlier one"}))
    said = "contact.timing None is now .*by another version: commit an earlier one is now "
    with pytest.raises(CheckpointError, match=said):
        run(stopped, resume=True, force=True)


def test_without_a_checkpoint_a_run_starts_anew_and_says_so(tmp_path: Path) -> None:
    results = run(tmp_path / "run", resume=True)
    assert results.complete
    assert "no run to resume: starts from the beginning" in (tmp_path / "run" / schema.LOG).read_text()
    assert "resumed" not in results.provenance


def test_a_complete_run_is_opened_unchanged(tmp_path: Path) -> None:
    run(tmp_path / "run")
    stamps = {one: one.stat().st_mtime_ns for one in tmp_path.rglob("*") if one.is_file()}
    assert run(tmp_path / "run", resume=True).complete
    assert {one: one.stat().st_mtime_ns for one in tmp_path.rglob("*") if one.is_file()} == stamps
    with pytest.raises(CheckpointError, match=r"is complete, and the case has changed since: seed"):
        run(tmp_path / "run", {"seed": "2"}, resume=True)


def test_a_folder_that_is_not_a_run_is_not_touched(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("all of it")
    with pytest.raises(ResultsError, match="not a run folder of ryusa"):
        run(tmp_path, resume=True)
    assert [one.name for one in tmp_path.iterdir()] == ["thesis.tex"]


def test_frames_that_differ_on_resume_end_the_run_before_anything_is_written(
    stopped: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (stopped / schema.CHECKPOINT).unlink()
    state = loop.Loop.state
    advance = loop.Loop._steps

    def disturbed(self: Any, n_steps: int) -> Any:
        flags = advance(self, n_steps)
        self.engine._grains.x[0, 2] += 1e-15
        return flags

    monkeypatch.setattr(loop.Loop, "_steps", disturbed)
    before = Results.open(stopped)
    with pytest.raises(CheckpointError, match="it is not the same run"):
        run(stopped, resume=True)
    after = Results.open(stopped)
    assert after.status == "failed"
    assert np.array_equal(before.frames.x[:], after.frames.x[:])
    assert state is loop.Loop.state


def test_a_scene_built_grain_by_grain_is_resumed_too(
    scene: Any, state: Any, engine: Any, tmp_path: Path, stop_at: Any
) -> None:
    from ryusa.engine.cpu.engine import CpuEngine

    x = np.array([[0.005, 0.0, 0.02], [0.015, 0.0, 0.02], [0.025, 0.0, 0.02]])
    first = ryusa.State.at_rest(x)
    how: dict[str, Any] = {"frames": 1e-3, "stop": Stop(time=0.02), "progress": False, "resume": True}
    run_scene(scene, first, tmp_path / "whole", **how, engine=CpuEngine())
    stop_at(700)
    assert run_scene(scene, first, tmp_path / "hurt", **how).status == "stopped"
    run_scene(scene, first, tmp_path / "hurt", **how)
    assert differences(tmp_path / "whole", tmp_path / "hurt") == []
    with pytest.raises(CheckpointError, match="is complete, and the case has changed since"):
        run_scene(scene, first, tmp_path / "hurt", **{**how, "frames": 2e-3})


def test_provenance_of_a_resumed_run_is_that_of_its_start(stopped: Path) -> None:
    before = json.loads((stopped / schema.PROVENANCE).read_text())
    after = run(stopped, resume=True).provenance
    assert after["begin"] == before["begin"]
    assert after["end"] >= before["end"]
    assert after["status"] == "complete"


def test_a_case_with_a_table_is_resumed_from_its_run_folder_alone(tmp_path: Path, stop_at: Any) -> None:
    from ryusa.casefile.read import read

    rows = "".join(f"{0.3 * k},{1.0 + 0.1 * k},0.2\n" for k in range(3))
    (tmp_path / "three.csv").write_text("x [cm],z [cm],d [cm]\n" + rows)
    text = CASE[: CASE.index("[build]")] + '[build]\nkind = "table"\nfile = "three.csv"\n'
    text += '[[planes]]\nname = "floor"\npoint = ["0 m", "0 m", "0 m"]\nnormal = [0.0, 0.0, 1.0]\n'
    (tmp_path / "case.toml").write_text(text + '[stop]\ntime = "0.05 s"\n[record]\nframes = "2 ms"\n')
    case = read(tmp_path / "case.toml")
    ryusa.run(case, tmp_path / "whole", progress=False)
    stop_at(3_000)
    assert not ryusa.run(case, tmp_path / "hurt", progress=False).complete
    (tmp_path / "three.csv").unlink()
    case = read(tmp_path / "hurt" / "case.toml")
    ryusa.run(case, tmp_path / "hurt", progress=False, resume=True)
    assert differences(tmp_path / "whole", tmp_path / "hurt") == []


MEANS = ("travel_over_d", "restitution", "restitution_shear")


@pytest.mark.parametrize("kind", full_but(["dry-3d", "saltation"], ["dry-3d", "two-way", "saltation"]))
@pytest.mark.parametrize("first", ["0.05 s", "0.0717 s"])
def test_a_complete_run_is_lengthened_to_the_bits_of_a_longer_one(
    kind: str, first: str, tmp_path: Path
) -> None:
    def made(folder: Path, end: str, **how: Any) -> Results:
        case = read_text(KINDS[kind], {"stop.time": end, "record.settle": "0 s"})
        return ryusa.run(case, folder, progress=False, **how)

    longer = made(tmp_path / "long", "0.12 s")
    made(tmp_path / "run", first)
    lengthened = made(tmp_path / "run", "0.12 s", resume=True)
    assert lengthened.complete
    assert lengthened.case["stop"]["time"] == pytest.approx(0.12)
    summed = {f"summary.{name}" for name in MEANS}  # in two stretches instead of one
    assert set(differences(tmp_path / "long", tmp_path / "run")) <= summed
    for name in MEANS:
        found, other = (numbers_in(one.summary[name]) for one in (lengthened, longer))
        assert found == pytest.approx(other, rel=1e-12)


def numbers_in(one: Any) -> list[float]:
    """All numbers of nested plain data, in order."""
    if isinstance(one, dict):
        return [number for part in one.values() for number in numbers_in(part)]
    return [float(one)] if isinstance(one, int | float) else []


RAIN = """
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.5
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
[build]
kind = "empty"
[[feeds]]
name = "hose"
centre = ["0 m", "0 m", "0.1 m"]
radius = "1 cm"
rate = "100 grains/s"
velocity = ["0 m/s", "0 m/s", "-0.5 m/s"]
[[exits]]
name = "below"
point = ["0 m", "0 m", "0 m"]
normal = [0, 0, -1]
[stop]
time = "0.1 s"
[record]
frames = "10 ms"
"""


def test_a_longer_run_whose_feed_has_no_grains_left_is_refused(tmp_path: Path) -> None:
    def made(end: str, more: dict[str, str], **how: Any) -> Results:
        case = read_text(RAIN, {"stop.time": end} | more)
        return ryusa.run(case, tmp_path / "run", progress=False, **how)

    assert (made("0.1 s", {}).passages["way"] == IN).sum() == 10
    with pytest.raises(CheckpointError, match=r"feed 'hose' were drawn up to 0.1 s, .* not to 0.2 s"):
        made("0.2 s", {}, resume=True)
    forced = made("0.2 s", {}, resume=True, force=True)
    assert forced.complete
    assert (forced.passages["way"] == IN).sum() == 10
    with pytest.raises(CheckpointError, match=r"feed 'hose' were drawn up to 0.1 s, .* not to 0.2 s"):
        made("0.2 s", {}, resume=True)  # complete, but not the run of this case
    with pytest.raises(CheckpointError, match=r"feed 'hose' were drawn up to 0.1 s, .* not to 0.3 s"):
        made("0.3 s", {}, resume=True)
    made("0.1 s", {"feeds.0.end": "0.05 s"}, overwrite=True)  # ends before the run, however long that is
    assert (made("0.2 s", {"feeds.0.end": "0.05 s"}, resume=True).passages["way"] == IN).sum() == 5


def test_an_end_that_the_run_has_passed_is_refused(whole: Results, tmp_path: Path) -> None:
    shutil.copytree(whole.folder, tmp_path / "run")
    with pytest.raises(CheckpointError, match=r"stop.time 0.13 is now 0.12; the run has reached t = 0.1"):
        run(tmp_path / "run", {"stop.time": "0.12 s"}, resume=True)
    assert Results.open(tmp_path / "run").complete


def test_a_run_that_came_to_rest_goes_on_only_without_that_rule(tmp_path: Path) -> None:
    floor = [("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]
    ball, state = scene_of([[0.0, 0.0, 0.0012]], 0.002, planes=floor, restitution=0.3)
    ends = Stop(time=1.0, rest_speed=0.01, rest_for=0.02)

    def made(stop: Stop, **how: Any) -> Results:
        return run_scene(ball, state, tmp_path / "run", frames=0.01, stop=stop, progress=False, **how)

    first = made(ends)
    assert first.complete
    assert first.summary["t"] < 0.5
    again = made(Stop(time=2.0, rest_speed=0.01, rest_for=0.02), resume=True)
    assert again.summary["t"] == first.summary["t"]
    with pytest.raises(CheckpointError, match="the end has changed"):
        made(Stop(time=2.0, rest_speed=0.01, rest_for=0.001), resume=True)
    assert made(Stop(time=0.5), resume=True).summary["t"] == pytest.approx(0.5, abs=1e-3)


def test_a_complete_run_without_a_checkpoint_of_its_end_says_so(whole: Results, tmp_path: Path) -> None:
    shutil.copytree(whole.folder, tmp_path / "run")
    (tmp_path / "run" / schema.CHECKPOINT).unlink()
    with pytest.raises(CheckpointError, match="cannot be lengthened"):
        run(tmp_path / "run", {"stop.time": "0.2 s"}, resume=True)
