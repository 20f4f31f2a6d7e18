"""What docs/interrupted-runs.md tells to type is there, and does what it says."""

import re
import shlex
from pathlib import Path

import pytest
import typer

import ryusa
from ryusa.casefile import read
from ryusa.cli import INTERRUPTED, app, main
from ryusa.cli.run import _STOPPED
from ryusa.errors import CaseError, DiskFull, RunError, WaterError
from ryusa.running import checkpoint_scheduler

PAGE = (Path(__file__).parents[2] / "docs" / "interrupted-runs.md").read_text(encoding="utf-8")
SHORT = {"stop.time": "0.02 s", "record.settle": "0 s", "build.columns": "8", "build.layers": "2"}


def test_its_commands_and_options_are_known() -> None:
    known = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    lines = [line for text in re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL) for line in text.splitlines()]
    spoken = [shlex.split(line, comments=True)[1:] for line in lines if line.startswith("ryusa ")]
    assert {words[0] for words in spoken} == {"new", "run", "resume", "inspect"}
    for words in spoken:
        options = {option for one in known[words[0]].params for option in one.opts}
        assert {word for word in words if word.startswith("-")} <= options
    every = {option for name in ("run", "resume") for one in known[name].params for option in one.opts}
    assert set(re.findall(r"`(--[a-z]+)", PAGE)) <= every


def test_its_exit_codes_are_those_of_the_code() -> None:
    found = [int(code) for code in re.findall(r"^\| (\d+) \|", PAGE, re.MULTILINE)]
    assert found == [0, CaseError.exit_code, RunError.exit_code, _STOPPED, INTERRUPTED]
    assert WaterError.exit_code == DiskFull.exit_code == RunError.exit_code
    assert f"every {checkpoint_scheduler.CHECKPOINT_INTERVAL / 60:.0f} minutes" in PAGE


def test_its_python_reads_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    main_quietly(["new", "movable_bed"])
    ryusa.run(read("movable_bed.toml", SHORT), progress=False)
    (block,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    names: dict[str, object] = {}
    exec(block, names)
    assert len(names["t"]) == 3  # type: ignore[arg-type]


def main_quietly(words: list[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main(words)
    assert left.value.code == 0
