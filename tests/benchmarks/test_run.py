import json
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def quick(tmp_path: Path):
    """Runs the benchmark of 108 grains, alone, on whatever machine; no figure is judged."""

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, str(BENCHMARKS / "run.py"), "--quick", "--anyway", "--peers", *words]
        return subprocess.run(
            [*command, "--pairs", "1", "--threads", "1", "--work", str(tmp_path)],
            capture_output=True, text=True, check=False,
        )  # fmt: skip

    return run


@pytest.mark.full
def test_the_benchmark_writes_figures_with_their_machine_and_does_nothing_twice(
    quick, tmp_path: Path
) -> None:
    done = quick("--parts", "speed", "--only", "W1-100")
    assert done.returncode == 0, done.stderr
    kept = json.loads((tmp_path / "quick.json").read_text())
    (row,) = kept["speed"].values()
    (one,) = row["rounds"]
    assert kept["machine"]["cpu"] and kept["versions"]["ryusa"]
    assert row["grains"] == 108
    assert one["codes"]["ryusa (total)"]["rate"] > 0.0
    assert "| W1-100 | 108 | 1 |" in (tmp_path / "quick.md").read_text()

    again = quick("--parts", "speed", "--only", "W1-100")
    assert again.returncode == 0, again.stderr
    assert json.loads((tmp_path / "quick.json").read_text())["speed"] == kept["speed"]


@pytest.mark.parametrize("word", ["W1-3k", "W9", "W3-100", "W1-2k-wet"])
def test_an_unknown_workload_is_named_before_anything_is_done(quick, tmp_path: Path, word: str) -> None:
    done = quick("--parts", "speed", "--only", word)
    assert done.returncode == 2
    assert f"'{word}' is no workload: one of W1, W2, W3" in done.stderr
    assert not list(tmp_path.iterdir())
