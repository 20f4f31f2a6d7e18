"""`--on`: every command that carries out runs hands them to the place that was named."""

import shutil
from concurrent.futures import Future
from typing import ClassVar

import pytest
import typer
from typer.testing import CliRunner

from ryusa.cases import case_path
from ryusa.cli import app
from ryusa.errors import CaseError
from ryusa.study.executors import EXECUTORS, RunExecutor

STUDY = '"""A title."""\nfrom ryusa.cases import case_path\nfrom ryusa.study import calculation, case_run\n'
CALCULATION = """
def twice(x):
    return {"y": 2.0 * x}

def tasks(plan):
    return [calculation(twice, x=1.0), calculation(twice, x=2.0)]

def measure(results, task):
    raise AssertionError("no run")

def rows(found, plan):
    return [{"x": dict(task.arguments)["x"], "y": float(one["y"])} for task, one in found.items()]

def judge(found, plan):
    return []
"""
RUN = """
def tasks(plan):
    return [case_run(case_path("heap.toml"), seed=seed) for seed in plan.seeds]

def measure(results, task):
    return {}
"""
CALIBRATION = """
[calibrate]
points = 4
[[parameters]]
key = "contact.friction_angle"
low = "10 deg"
high = "40 deg"
[[observations]]
case = "heap.toml"
measure = "surface"
quantity = "slope"
value = "21 deg"
error = "0.5 deg"
test = "gate in a plane"
"""
WORDS = {
    "sweep": ("heap.toml", "--seeds", "2", "-m", "surface"),
    "study": ("mine",),
    "soften": ("heap.toml", "-m", "surface", "--value", "slope", "--to", "1 deg"),
    "paper": ("fig19", "--quick"),
    "validate": ("gas",),
    "calibrate": ("study.toml",),
}


class Elsewhere(RunExecutor):
    """A place that notes what it is asked for, and is then not there."""

    asked: ClassVar[list[tuple[str, int | None]]] = []
    tasks: ClassVar[list[str]] = []

    def __init__(self, given, jobs):
        self.jobs = jobs or 7
        self.asked.append((given, jobs))

    def here(self, n, made):
        return False

    def open(self, folder, tasks):
        self.tasks.extend(one.label for one in tasks)
        raise CaseError("on", "elsewhere", "is gone")

    def stop(self, pool):
        raise AssertionError("was never opened")


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(EXECUTORS, "elsewhere", Elsewhere)
    monkeypatch.setattr(Elsewhere, "asked", [])
    monkeypatch.setattr(Elsewhere, "tasks", [])
    shutil.copy(case_path("heap.toml"), "heap.toml")
    (tmp_path / "study.toml").write_text(CALIBRATION)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "study.py").write_text(STUDY + RUN)
    return tmp_path


def call(command, *more):
    return CliRunner().invoke(app, [command, *WORDS[command], "-o", "out", *more])


def said(result):
    return " ".join(result.output.split())


@pytest.mark.parametrize("command", WORDS)
def test_runs_go_to_the_place_that_was_named(command, place):
    if command == "calibrate":
        pytest.importorskip("sklearn")
    result = call(command, "--on", "elsewhere:there", "-j", "3")
    assert result.exit_code == 2, result.output
    assert "on = 'elsewhere': is gone" in said(result)
    assert Elsewhere.asked == [("there", 3)]
    assert Elsewhere.tasks


@pytest.mark.parametrize("command", WORDS)
def test_a_place_that_is_not_known_is_named_before_anything_is_written(command, place):
    if command == "calibrate":
        pytest.importorskip("sklearn")
    result = call(command, "--on", "dsk:tcp://node1:8786")
    assert result.exit_code == 2, result.output
    assert "on = 'dsk:tcp://node1:8786': must be one of processes, dask:ADDRESS. " in said(result)
    assert "Did you mean 'dask'" in said(result)
    assert not (place / "out").exists()


@pytest.mark.parametrize("typed", ["slurm", "slurm:ib0"])
def test_jobs_of_slurm_are_asked_for_in_other_words(typed, place):
    result = call("sweep", "--on", typed, "-j", "4")
    assert result.exit_code == 2, result.output
    assert f"on = '{typed}': is not there" in said(result)
    assert "type --on dask:ADDRESS (docs/many-runs.md has the script)" in said(result)
    assert "or let ryusa sweep write a job array with --emit slurm" in said(result)
    assert not (place / "out").exists()


def test_the_number_of_runs_at_a_time_is_that_of_the_place(place):
    result = call("study", "--list", "--on", "elsewhere")
    assert result.exit_code == 0, result.output
    assert "7 at a time" in said(result)
    assert Elsewhere.asked == [("", None)]


def test_all_commands_say_the_same_of_it():
    every = typer.main.get_command(app).commands
    told = {
        (one.default, one.help)
        for name in WORDS
        for one in every[name].params
        if "--on" in one.opts
    }  # fmt: skip
    assert len(told) == 1
    assert all(any("--on" in one.opts for one in every[name].params) for name in WORDS)


class Noting(Elsewhere):
    """A place that carries out every call at once, in this process, and notes its task."""

    def open(self, folder, tasks):
        return self

    def submit(self, pool, call, *given):
        self.tasks.append(given[0].label)
        found = Future()
        found.set_result(call(*given))
        return found

    def shutdown(self, wait=True):
        assert wait


@pytest.mark.full
def test_a_study_is_the_same_at_another_place(place, monkeypatch):
    (place / "mine" / "study.py").write_text(STUDY + CALCULATION)
    assert call("study", "-q").exit_code == 0
    table = place / "out" / "mine" / "mine.csv"
    here = table.read_bytes()
    assert here.count(b"\n") == 3
    shutil.rmtree(place / "out")
    monkeypatch.setitem(EXECUTORS, "elsewhere", Noting)
    result = call("study", "-q", "--on", "elsewhere")
    assert result.exit_code == 0, result.output
    assert len(Elsewhere.tasks) == 2
    assert table.read_bytes() == here
