"""`ryusa sweep --emit slurm`: its scripts, run by a shell as Slurm would."""

import json
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ryusa.campaigns.sweep.slurm import submission
from ryusa.cases import case_path
from ryusa.cli import app

SHORT = {
    "build.length": "3 cm", "build.layers": "2", "stop.time": "0.4 s", "record.settle": "0.1 s",
    "record.frames": "5 ms",
}  # fmt: skip
BASH = shutil.which("bash")
needs_bash = pytest.mark.skipif(BASH is None, reason="runs a script of bash")


def call(*words):
    return CliRunner().invoke(app, ["sweep", *(str(word) for word in words)])


@pytest.fixture
def awkward(tmp_path, monkeypatch):
    """A folder and a case whose names would do harm in a shell that is not careful."""
    place = tmp_path / 'it\'s $(touch harm) `touch harm` "a" & b'
    place.mkdir()
    monkeypatch.chdir(place)
    shutil.copy(case_path("bedload_3d.toml"), "be'd $(touch harm).toml")
    return place


def asked(**changes):
    settings = [word for key, value in {**SHORT, **changes}.items() for word in ("--set", f"{key}={value}")]
    return ["be'd $(touch harm).toml", "--over", "motion.slope=0.02,0.04", "--seeds", 1, "-m", "transport",
            *settings, "-o", "o'ut $(touch harm)", "--no-pages"]  # fmt: skip


def environment(place, element):
    """Variables of one element, and a `scontrol` that notes what it was told."""
    tools = place / "tools"
    tools.mkdir(exist_ok=True)
    (tools / "scontrol").write_text(f'#!/bin/sh\necho "$@" >> "{tools.name}/told"\n')
    (tools / "scontrol").chmod(0o755)
    return {
        **os.environ, "PATH": f"{tools}:{os.environ['PATH']}", "SLURM_ARRAY_TASK_ID": str(element),
        "SLURM_ARRAY_JOB_ID": "77",
    }  # fmt: skip


@pytest.mark.full
@needs_bash
def test_the_scripts_make_the_same_sweep_whatever_names_hold(awkward):
    result = call(*asked(), "--emit", "slurm")
    assert result.exit_code == 0, result.output
    assert "2 runs to make. To submit:" in result.stdout
    out = awkward / "o'ut $(touch harm)"
    array = out / "slurm" / "array.sh"
    assert "#SBATCH --array=0-1\n" in array.read_text()
    assert not (out / "runs").exists()
    for element in (0, 1):  # the second as the first of another array
        beyond = environment(awkward, 0) | {"RYUSA_FIRST": str(element)}
        done = subprocess.run([BASH, array], cwd="/", env=beyond, check=False)
        assert done.returncode == 0, (out / "slurm" / f"{element}.log").read_text()
    collected = subprocess.run([BASH, out / "slurm" / "collect.sh"], cwd="/", check=False)
    log = (out / "slurm" / "collect.log").read_text()
    assert collected.returncode == 0, log
    assert "nothing to run; 2 finished runs will be opened" in log
    table = (out / "sweep.csv").read_bytes()
    shutil.move(out, awkward / "array")
    assert call(*asked(), "-j", 1).exit_code == 0
    assert (out / "sweep.csv").read_bytes() == table
    assert not list(awkward.rglob("harm"))
    assert not list(awkward.parent.glob("harm"))


@pytest.mark.full
@needs_bash
def test_a_run_at_its_time_limit_is_requeued_and_goes_on_from_its_checkpoint(awkward):
    words = asked(**{"stop.time": "20 s", "build.layers": "4"})
    assert call(*words, "--emit", "slurm").exit_code == 0
    out = awkward / "o'ut $(touch harm)"
    process = subprocess.Popen([BASH, out / "slurm" / "array.sh"], cwd="/", env=environment(awkward, 1))
    for _ in range(1200):
        summary = next(out.glob("runs/*/summary.json"), None)
        if process.poll() is not None or (summary and json.loads(summary.read_text())["t"] > 0.0):
            break
        time.sleep(0.05)
    process.send_signal(signal.SIGUSR1)
    assert process.wait(timeout=60) == 0
    assert (awkward / "tools" / "told").read_text() == "requeue 77_1\n"
    (place,) = out.glob("runs/*")
    assert (place / "checkpoint.h5").is_file()
    assert json.loads((place / "provenance.json").read_text())["status"] == "stopped"


def test_more_runs_than_slurm_takes_in_an_array_are_submitted_as_several() -> None:
    lines = submission([Path("out/array.sh"), Path("out/collect.sh")], 2200)
    assert lines[0] == "job=$(sbatch --parsable out/array.sh)"
    assert [line.split("RYUSA_FIRST=")[1].split(" out")[0] for line in lines[1:-1]] == [
        "1000 --array=0-999",
        "2000 --array=0-199",
    ]
    assert lines[-1] == 'sbatch --dependency=afterany:"$job" out/collect.sh'
    assert len(submission([Path("array.sh"), Path("collect.sh")], 1000)) == 2


@pytest.mark.full
def test_finished_runs_are_left_out_of_the_array(awkward):
    assert call(*asked(), "-j", 1).exit_code == 0
    shutil.rmtree(next(Path("o'ut $(touch harm)").glob("runs/slope-0.04*")))
    result = call(*asked(), "--emit", "slurm")
    assert "1 run to make" in result.stdout
    text = (Path("o'ut $(touch harm)") / "slurm" / "array.sh").read_text()
    assert "#SBATCH --array=0-0\n" in text
    assert "motion.slope=0.04" in text
    assert "motion.slope=0.02" not in text
    assert call(*asked(), "-j", 1).exit_code == 0
    again = call(*asked(), "--emit", "slurm")
    assert re.search(r"0 runs to make. To submit:\n +sbatch [^\n]*collect.sh", again.stdout)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--emit", "slrum"), r"--emit = 'slrum': must be one of slurm. Did you mean 'slurm'"),
        (("--emit", "slurm", "--again"), r"--again: cannot be combined with --emit"),
    ],
)
def test_what_cannot_be_emitted_is_refused(awkward, words, said):
    result = call(*asked(), *words)
    assert result.exit_code == 2
    assert re.search(said, " ".join(result.output.split())), result.output
    assert not (awkward / "o'ut $(touch harm)").exists()
