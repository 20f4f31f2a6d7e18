"""The fault campaign: whatever ends a run, and whenever, nothing is lost and what goes on is the same run.

Short here (about a minute); `make faults` is the long form: every kind of run killed, each 40 times, 17 disks
that fill up over and over, a thousand damaged and foreign checkpoints, thousands of folders of strangers.
"""

import io
import os
import random
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

sys.path.insert(0, str(Path(__file__).parent))

from campaign import differences, run
from kinds import KINDS

from ryusa.cli import app
from ryusa.errors import CheckpointError
from ryusa.results import Results, schema
from ryusa.running import checkpoint_scheduler, disk, loop, recorder

HERE = Path(__file__).parent
# Open records, water, walls with passages, bodies: together they write all that a folder may hold.
SHOWN = ("rolling", "two-way", "servo-feeds", "clumps")


def kill(folder: Path, kind: str, kills: int, seed: int) -> None:
    words = [sys.executable, str(HERE / "campaign.py"), str(folder), str(kills), str(seed), kind]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"{kind}: {kills} kills" in done.stdout


@pytest.mark.skipif(
    not hasattr(os, "fork"), reason="kills a process that os.fork made, which this system has not"
)
@pytest.mark.parametrize(
    "kind",
    [
        "rolling",
        *(pytest.param(one, marks=pytest.mark.full) for one in SHOWN[1:]),
        *(pytest.param(one, marks=pytest.mark.slow) for one in KINDS if one not in SHOWN),
    ],
)
def test_runs_killed_at_random_moments_lose_nothing_and_end_with_the_same_results(
    tmp_path: Path, kind: str
) -> None:
    kill(tmp_path, kind, 2, seed=1)


@pytest.mark.slow
@pytest.mark.skipif(
    not hasattr(os, "fork"), reason="kills a process that os.fork made, which this system has not"
)
@pytest.mark.parametrize("kind", KINDS)
def test_two_hundred_kills_lose_nothing(tmp_path: Path, kind: str) -> None:
    kill(tmp_path, kind, 40, seed=int.from_bytes(os.urandom(4)))


@pytest.mark.parametrize(
    ("kind", "seed"),
    [("rolling", 5), pytest.param("two-way", 5, marks=pytest.mark.full)]
    + [pytest.param(kind, seed, marks=pytest.mark.slow) for kind in KINDS for seed in (11, 12, 13)],
)
def test_a_disk_that_fills_up_again_and_again_loses_nothing(
    tmp_path: Path, kind: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    run(kind, tmp_path / "whole")
    draw, full = random.Random(seed), [0]
    beside = disk.write_temporary

    def narrow(path: Path, content: disk.Content) -> Path:
        if path.parent != tmp_path / "hurt" and path.parent.parent != tmp_path / "hurt":
            return beside(path, content)
        if full[0] == 0 and draw.random() < 0.2 and path.suffix in {".h5", ".vtkhdf"}:
            full[0] = draw.randint(1, 4)
        if full[0]:
            whole = io.BytesIO(content) if isinstance(content, bytes) else io.BytesIO()
            if not isinstance(content, bytes):
                content(whole)
            kept = whole.getvalue()[: draw.randint(0, len(whole.getvalue()))]
            path.with_name(f".{path.name}.new").write_bytes(kept)
            raise OSError(28, "No space left on device")
        return beside(path, content)

    def sleep(seconds: float) -> None:
        full[0] = max(full[0] - 1, 0)

    monkeypatch.setattr(recorder, "flush_after", lambda elapsed, n_part: 0.02)
    monkeypatch.setattr(loop.time, "sleep", sleep)
    monkeypatch.setattr(checkpoint_scheduler, "_SHARE", 1.0)
    begin = recorder.Recorder.flush
    begun: list[bool] = []

    def flush(self: Any) -> bool:
        if not begun:  # from the first frame on
            monkeypatch.setattr(disk, "write_temporary", narrow)
            begun.append(True)
        return begin(self)

    monkeypatch.setattr(recorder.Recorder, "flush", flush)
    results = run(kind, tmp_path / "hurt", checkpoint=0.1)
    assert "paused: " in (results.folder / "log.txt").read_text()
    assert differences(tmp_path / "whole", tmp_path / "hurt") == []


def stopped_half_way(kind: str, folder: Path) -> bytes:
    """A checkpoint of one of the six, whose run was stopped in the middle."""
    advance = loop.Loop._advance

    def watched(self: Any, n_steps: int) -> None:
        advance(self, n_steps)
        self._signal.stop = "the test" if self._t > 0.03 else self._signal.stop

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(loop.Loop, "_advance", watched)
        patch.setattr(loop.Loop, "_chunk", lambda self: 101)
        assert run(kind, folder).status == schema.STOPPED
    return (folder / schema.CHECKPOINT).read_bytes()


@pytest.mark.full
@pytest.mark.parametrize("times", [30, pytest.param(1_000, marks=pytest.mark.slow)])
def test_truncated_flipped_and_foreign_checkpoints_are_refused_in_one_clear_line(
    tmp_path: Path, times: int
) -> None:
    folder, draw = tmp_path / "rolling", random.Random(times)
    good = stopped_half_way("rolling", folder)
    foreign = [stopped_half_way(kind, tmp_path / kind) for kind in ("dry-2d", "two-way")]
    (folder / schema.CHECKPOINT_BEFORE).unlink(missing_ok=True)
    for k in range(times):
        bad = bytearray(good)
        if k % 3 == 0:
            bad = bad[: draw.randrange(len(bad))]
        elif k % 3 == 1:
            bad[draw.randrange(len(bad))] ^= 1 << draw.randrange(8)
        else:
            bad = bytearray(draw.choice(foreign))
        if bytes(bad[512:]) == good[512:] and bytes(bad[:100]) == good[:100]:
            continue  # the flip lies in the padding of the head, which says nothing
        (folder / schema.CHECKPOINT).write_bytes(bad)
        with pytest.raises(CheckpointError) as refused:
            run("rolling", folder, resume=True)
        assert "\n" not in str(refused.value)
        assert "to discard it and start again, use --overwrite" in str(refused.value)
    (folder / schema.CHECKPOINT).write_bytes(good)
    assert run("rolling", folder, resume=True).complete
    run("rolling", tmp_path / "whole")
    assert differences(tmp_path / "whole", folder) == []


SMALL = """
import os, subprocess, sys, threading, time
from pathlib import Path
disk = Path(sys.argv[1])
sys.path.insert(0, sys.argv[2])
subprocess.run(["mount", "-t", "tmpfs", "-o", "size=30m", "none", disk], check=True)
from campaign import differences, run
from ryusa.running import disk as disk_errors
disk_errors._RETRY_EVERY = 0.05
filler = disk / "filler"
filler.write_bytes(bytes(14 << 20))
log = disk / "hurt" / "log.txt"
seen = []

def watch():
    while not (log.is_file() and "paused: " in log.read_text()):
        time.sleep(0.02)
    seen.append(True)
    filler.unlink()

threading.Thread(target=watch, daemon=True).start()
run("dry-3d", disk / "hurt")
assert seen
run("dry-3d", Path(sys.argv[3]))
assert differences(disk / "hurt", Path(sys.argv[3])) == []
print("nothing lost")
"""


@pytest.mark.slow
def test_a_small_disk_that_is_full_pauses_a_run_until_there_is_room(tmp_path: Path) -> None:
    space = ["unshare", "--user", "--map-root-user", "--mount"]
    if shutil.which("unshare") is None or subprocess.run([*space, "true"], check=False).returncode:
        pytest.skip("no user namespaces here")
    (tmp_path / "disk").mkdir()
    words = [sys.executable, "-c", SMALL, str(tmp_path / "disk"), str(HERE), str(tmp_path / "whole")]
    done = subprocess.run([*space, *words], capture_output=True, text=True, check=False)
    assert "nothing lost" in done.stdout, done.stdout + done.stderr


@pytest.mark.full
def test_a_folder_is_read_while_it_is_written(tmp_path: Path) -> None:
    code = f"import sys; sys.path.insert(0, {str(HERE)!r}); import campaign; from pathlib import Path; "
    code += "campaign.recorder.flush_after = lambda elapsed, n: 0.0; "
    code += "campaign.run('two-way', Path(sys.argv[1]), checkpoint=0.1)"
    writer = subprocess.Popen([sys.executable, "-c", code, str(tmp_path / "run")])
    seen: list[int] = []
    try:
        while writer.poll() is None:
            if (tmp_path / "run" / "grains.vtkhdf").exists():
                frames = Results.open(tmp_path / "run").frames
                assert frames.x[-1].shape == (48, 3)
                seen.append(len(frames))
    finally:
        writer.kill()
        writer.wait()
    assert sorted(seen) == seen
    assert len(set(seen)) > 3


LOOKED_AT = """
import sys, time
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from campaign import loop, recorder, run
folder, looked = Path(sys.argv[2]), Path(sys.argv[3])
chunk = loop.Loop._chunk

def wait(self):
    while (folder / "parts" / "part-000005.h5").exists() and not looked.exists():
        time.sleep(0.02)
    return min(chunk(self), 200)

recorder.flush_after = lambda elapsed, n: 0.0
loop.Loop._chunk = wait
run("two-way", folder)
"""


@pytest.mark.full
def test_a_run_is_viewed_filmed_drawn_and_measured_while_it_goes_on(tmp_path: Path) -> None:
    folder, looked = tmp_path / "run", tmp_path / "looked"
    writer = subprocess.Popen([sys.executable, "-c", LOOKED_AT, str(HERE), str(folder), str(looked)])
    try:
        while not (folder / "parts" / "part-000005.h5").exists():
            assert writer.poll() is None
            time.sleep(0.02)
        before, so_far = -1, 0  # a part may still be on its way to the disk beside the run, which waits
        while so_far > before:
            time.sleep(0.5)
            before, so_far = so_far, len(Results.open(folder).frames)
        said: dict[str, str] = {}
        for words in (
            ("view", "-q"), ("film", "-q", "--frames", "4", "--size", "480x270"), ("draw", "grains"),
            ("draw", "forces"), ("measure", "profile", "--begin", "0s"), ("inspect",),
        ):  # fmt: skip
            result = CliRunner().invoke(app, [words[0], str(folder), *words[1:]])
            assert result.exit_code == 0, result.output
            said[words[0]] = result.output
        assert writer.poll() is None, "the run ended before it was looked at"
        assert f"4 pictures of {so_far} recorded frames" in " ".join(said["film"].split())
        assert "running" in said["inspect"]
        looked.touch()
        assert writer.wait(timeout=120) == 0
    finally:
        writer.kill()
        writer.wait()
    assert {one.name for one in folder.iterdir()} >= {"view.html", "film.webp", "pictures"}
    assert len(Results.open(folder).frames) > so_far
    run("two-way", tmp_path / "alone")
    assert differences(folder, tmp_path / "alone") == []
