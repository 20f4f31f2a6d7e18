"""The memory that `ryusa check` expects, beside what runs take."""

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

import ryusa
from ryusa.casefile import derive
from ryusa.casefile.estimate import (
    HELD_LONGEST,
    HELD_MOST,
    HELD_SHARE,
    HELD_SHORTEST,
    contacts_expected,
    held_back,
    memory_needed,
    memory_of_grains,
)
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.laws.families import ContactTiming
from ryusa.results import schema
from ryusa.running import recorder


# Sums of the arrays in the file: 130 B a grain, 150 more in a column of water; 96 B a contact, 8 more where
# contacts begin and end within steps.
@pytest.mark.full
@pytest.mark.parametrize(
    ("name", "keys", "of_grain"),
    [
        ("dense_3d", {"build.columns": "7", "build.rows": "7", "stop.time": "0.35 s"}, 130),
        ("bedload_3d", {"build.length": "4.8 cm", "stop.time": "0.2 s", "record.settle": "0 s"}, 280),
        ("heap", {"stop.time": "0.5 s"}, 130),
    ],
)
def test_a_checkpoint_has_the_size_that_its_grains_and_contacts_give(
    tmp_path: Path, name: str, keys: dict[str, str], of_grain: int
) -> None:
    case = read(case_path(f"{name}.toml"), keys)
    results = ryusa.run(case, tmp_path / "run", progress=False)
    scene = results.scene
    contacts = int(results.tally["n_contact"][-1])
    assert contacts > 0.1 * scene.n_grain
    expected = scene.n_grain * of_grain + contacts * 104
    size = (tmp_path / "run" / schema.CHECKPOINT).stat().st_size
    overhead = 20_000 + (0 if scene.column is None else 100 * scene.column.n)  # headers, names, the column
    assert expected == pytest.approx(size - overhead, rel=0.15)


def test_frames_wait_as_long_as_the_recorder_keeps_them() -> None:
    for age in (1.0, 1000.0, 1e5):  # seconds that a run has lasted, made up: no clock is read
        assert recorder.flush_after(age, 0) == min(max(HELD_SHORTEST, HELD_SHARE * age), HELD_LONGEST)
    assert recorder.buffer_limit(0) == HELD_MOST


def test_contacts_frames_and_water_take_memory() -> None:
    dense, plane = read(case_path("dense_3d.toml")), read(case_path("dense_plane.toml"))
    wet = read(case_path("bedload_3d.toml"))
    assert contacts_expected(dense, derive(dense)) > contacts_expected(plane, derive(plane))
    assert contacts_expected(wet, derive(wet)) > 1.0
    by_steps, exact = (
        memory_of_grains(1000, 0, 1.5, timed, column=False)
        for timed in (ContactTiming.AT_STEPS, ContactTiming.EXACT)
    )
    assert by_steps < exact < memory_of_grains(1000, 0, 1.5, ContactTiming.EXACT, column=True)
    many = read(case_path("dense_3d.toml"), {"record.frames": "1 ms"})
    assert held_back(many, derive(many)) > held_back(dense, derive(dense)) >= 80 * derive(dense).n_grain
    held = held_back(many, derive(many)) - held_back(dense, derive(dense))
    more = memory_needed(many, derive(many)) - memory_needed(dense, derive(dense))
    assert held <= more <= 3.1 * held + 1  # twice in memory while written


WATCH = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


@pytest.mark.full
@pytest.mark.skipif(find_spec("resource") is None, reason="the peak of a process is known on Unix alone")
def test_a_run_takes_as_much_memory_as_expected(tmp_path: Path) -> None:
    """20,000 grains for a few steps; the first run compiles, the second one counts. Band: 20 %."""
    short = {"stop.time": "0.4 ms", "record.frames": "0.1 ms", "record.settle": "0 s", "timeline": "[]"}
    path = case_path("dense_3d.toml")
    command = [
        sys.executable,
        "-m",
        "ryusa",
        "run",
        str(path),
        "-q",
        "--overwrite",
        "-o",
        str(tmp_path / "run"),
    ]
    for key, value in short.items():
        command += ["--set", f"{key}={value}"]
    peak = 0
    for _ in range(2):  # by a small process between: the peak of one that starts another is passed on
        between = [sys.executable, "-c", WATCH, *command]
        done = subprocess.run(between, stdout=subprocess.PIPE, text=True, check=True)
        peak = int(done.stdout.splitlines()[-1]) * (1 if sys.platform == "darwin" else 1024)
    case = read(path, short)
    summary = json.loads((tmp_path / "run" / schema.SUMMARY).read_text())
    assert summary["frames"] == 5
    assert memory_needed(case, derive(case)) == pytest.approx(peak, rel=0.2)
