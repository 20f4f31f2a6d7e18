"""`ryusa calibrate` and `ryusa.calibrate`, on grains that bounce."""

import csv
import json
import math
import shutil

import numpy as np
import pytest
from typer.testing import CliRunner

import ryusa
from ryusa.campaigns.calibrate import read_calibration
from ryusa.campaigns.calibrate.runs import CaseRuns
from ryusa.campaigns.sweep.part import Measured, SweepRun
from ryusa.cases import case_path
from ryusa.cli import app
from ryusa.errors import CaseError, ResultsError
from ryusa.measure.statistics import Average
from ryusa.study.executors import Processes

pytest.importorskip("sklearn")

OBSERVED = 0.7
STUDY = """
[calibrate]
points = 16
seeds = 2
rounds = 1
more = 2
set = { "build.partner" = "plane", "stop.time" = "0.12 s" }

[[parameters]]
key = "contact.restitution"
low = 0.5
high = 0.95

[[parameters]]
key = "contact.friction_angle"
low = "10 deg"
high = "40 deg"

[[observations]]
case = "drop.toml"
measure = "collisions"
quantity = "restitution_alone"
value = 0.7
error = 0.02

[[predictions]]
case = "drop.toml"
measure = "collisions"
quantity = "duration_alone"
"""


def call(*words):
    return CliRunner().invoke(app, ["calibrate", *(str(word) for word in words)])


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    shutil.copy(case_path("drop.toml"), folder / "drop.toml")
    (folder / "bounce.toml").write_text(STUDY)
    return folder / "bounce.toml"


@pytest.fixture(scope="module")
def done(study, tmp_path_factory):
    out = tmp_path_factory.mktemp("calibration") / "out"
    return call(study, "-o", out, "-j", 1, "--coverage", 5), out


@pytest.mark.full
def test_restitution_is_found_and_friction_is_not_determined_by_a_central_impact(done):
    result, out = done
    assert result.exit_code == 0, result.output
    with (out / "parameters.csv").open() as file:
        first, second = csv.DictReader(file)
    assert first["parameter"] == "contact.restitution"
    assert first["determined"] == "True"
    assert float(first["mean"]) == pytest.approx(OBSERVED, abs=0.03)
    assert float(first["standard_deviation"]) == pytest.approx(0.02, abs=0.012)
    assert second["determined"] == "False"
    words = (
        "Determined: contact.restitution. Not determined: contact.friction_angle (these data say too little)."
    )
    assert words in " ".join(result.output.split())
    assert "intervals have no scatter between runs in them" in " ".join(result.output.split())
    assert words in (out / "calibration.html").read_text()


@pytest.mark.full
def test_axe_finds_no_fault_on_the_page(done, faults_of):
    assert faults_of(done[1] / "calibration.html") == []


@pytest.mark.full
def test_a_second_method_gives_the_same_posterior(done, study, tmp_path):
    """The likelihood of runs themselves on a grid of restitution, without an emulator."""
    grid = np.linspace(0.6, 0.8, 21)
    found = ryusa.sweep(
        study.parent / "drop.toml", {"contact.restitution": [f"{one:.4g}" for one in grid]}, "collisions",
        seeds=1, overrides={"build.partner": "plane", "stop.time": "0.12 s"}, folder=tmp_path / "grid",
        pages=False, progress=False,
    )  # fmt: skip
    values = np.array(
        [
            one["value"]
            for one in found.rows
            if one["quantity"] == "restitution_alone" and one["over"] == "run"
        ]
    )
    weights = np.exp(-0.5 * ((values - OBSERVED) / 0.02) ** 2)
    mean = np.sum(weights * grid) / np.sum(weights)
    sd = np.sqrt(np.sum(weights * (grid - mean) ** 2) / np.sum(weights))
    made = ryusa.calibrate(study, folder=done[1], coverage=5, progress=False)
    assert made.posterior.mean()[0] == pytest.approx(mean, abs=0.35 * sd)
    assert made.posterior.sd()[0] == pytest.approx(sd, rel=0.35)
    times = np.array(
        [one["value"] for one in found.rows if one["quantity"] == "duration_alone" and one["over"] == "run"]
    )
    (left_out,) = [one for one in made.predicted if one.observed is None]
    time = np.sum(weights * times) / np.sum(weights)
    assert left_out.low < time < left_out.high
    assert left_out.mean == pytest.approx(time, rel=0.01)


@pytest.mark.full
def test_the_same_command_opens_what_is_there_and_gives_the_same_numbers(done, study):
    _, out = done
    before = (out / "parameters.csv").read_bytes()
    result = call(study, "-o", out, "-j", 1, "--coverage", 5)
    assert result.exit_code == 0, result.output
    assert (out / "parameters.csv").read_bytes() == before
    assert json.loads((out / "calibration.json").read_text())["provenance"]["runs_made"] == 0


@pytest.mark.full
def test_a_quantity_that_is_not_there_costs_one_run_and_is_named(study, tmp_path):
    other = study.parent / "other.toml"
    other.write_text(STUDY.replace("duration_alone", "duraton_alone"))
    result = call(other, "-o", tmp_path / "out", "-j", 1)
    assert result.exit_code == 2
    assert "Did you mean 'duration_alone'?" in " ".join(result.output.split())
    assert len(list((tmp_path / "out" / "runs").iterdir())) == 1


def test_a_key_that_the_case_does_not_have_is_refused_before_anything_is_written(study, tmp_path):
    other = study.parent / "other.toml"
    other.write_text(STUDY.replace("contact.restitution", "contact.restitutoin"))
    result = call(other, "-o", tmp_path / "out", "-j", 1)
    assert result.exit_code == 2
    assert "restitutoin" in result.output
    assert not (tmp_path / "out").exists()


@pytest.mark.full
def test_a_folder_of_another_calibration_is_not_touched(done, study):
    other, text = study.parent / "other.toml", STUDY
    for old, new in (
        ("contact.friction_angle", "grains.density"),
        ('"10 deg"', '"2000 kg/m3"'),
        ('"40 deg"', '"3000 kg/m3"'),
    ):
        text = text.replace(old, new)
    other.write_text(text)
    with pytest.raises(ResultsError, match="holds another calibration: parameters"):
        ryusa.calibrate(other, folder=done[1], progress=False)


def test_too_few_made_up_truths_are_refused(study):
    with pytest.raises(CaseError, match="5 or more"):
        ryusa.calibrate(study, coverage=2, progress=False)


def test_the_list_runs_nothing(study, tmp_path):
    result = call(study, "-o", tmp_path / "out", "--list")
    assert result.exit_code == 0, result.output
    assert "36 runs" in result.output
    assert not (tmp_path / "out").exists()
    assert read_calibration(study).points == 16


def test_a_target_that_few_runs_give_is_refused_with_points_and_reasons(study, tmp_path):
    asked = read_calibration(study)
    target = asked.targets[0]
    runs = CaseRuns(asked, tmp_path, Processes(1))
    made = [
        SweepRun("drop", varied=(("contact.restitution", f"0.{k}"), ("seed", "1")), cases=target.case.parent)
        for k in (5, 6, 7, 8)
    ]
    for run, value in zip(made, (math.nan, 0.6, 0.7, 0.8), strict=True):
        average = Average(target.name, "-", value, 0.1, 9, 1, 9.0, (0.0, 1.0), 0.0, 0.0, 0.0)
        runs.found[run] = Measured({"collisions": (average,)})
    runs.refuse_if_few(target, made)
    runs.found[made[3]] = Measured(problems={"run": "a grain was lost"})
    with pytest.raises(ResultsError, match=r"restitution_alone: only 2 of 4 runs gave it") as raised:
        runs.refuse_if_few(target, made)
    said = str(raised.value)
    assert "at restitution 0.5 seed 1: its restitution_alone is nan" in said
    assert "at restitution 0.8 seed 1: a grain was lost" in said
    assert "stop.time" in said and str(tmp_path / "runs") in said
