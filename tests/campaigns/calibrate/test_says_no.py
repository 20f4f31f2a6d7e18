"""A calibration that the model cannot reach says so in terminal, tables, page and what it returns.

The runs are made up: what they give follows from their parameters, and nothing is simulated.
"""

import csv
import json
import math
import shutil
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

import ryusa
from ryusa.campaigns.calibrate import read_calibration
from ryusa.campaigns.calibrate.runs import CaseRuns
from ryusa.campaigns.sweep.part import Measured
from ryusa.cases import case_path
from ryusa.cli import app
from ryusa.errors import CaseError
from ryusa.measure.statistics import Average

pytest.importorskip("sklearn")

STUDY = """
[calibrate]
points = 16
seeds = 2
rounds = 0
set = { "build.columns" = 3, "build.layers" = 3 }

[[parameters]]
key = "contact.friction_angle"
low = "10 deg"
high = "40 deg"

[[observations]]
case = "heap.toml"
measure = "surface"
quantity = "slope"
value = "34 deg"
error = "1 deg"
test = "gate in a plane"

[[predictions]]
case = "heap.toml"
measure = "surface"
quantity = "run_out"
"""
NO = "The model does not reach these observations."


def average(name, unit, value):
    return Average(name, unit, value, 0.1, 9, 1, 9.0, (0.0, 1.0), 0.0, 0.0, 0.0)


def made_up(self, u, seeds):
    """Runs whose slope is half the friction angle plus 5 deg, with a scatter of 0.3 deg between seeds."""
    made = []
    for plan in self.plans(u, seeds).values():
        for run in plan.runs:
            friction = float(dict(run.varied)["contact.friction_angle"].removesuffix("deg"))
            chance = np.random.default_rng([int(1e4 * friction), run.seed]).standard_normal()
            slope = math.radians(5.0 + 0.5 * friction + 0.3 * chance)
            quantities = average("slope", "rad", slope), average("run_out", "m", 0.2 - 0.1 * slope)
            self.found[run] = Measured({"surface": quantities})
            self.u[run] = np.zeros(1)
            made.append(run)
    self.widen(self.asked.priors)  # gives every run its place
    return made


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.setattr(CaseRuns, "make", made_up)
    shutil.copy(case_path("heap.toml"), tmp_path / "heap.toml")

    def written(*changes):
        text = STUDY
        for old, new in changes:
            assert old in text
            text = text.replace(old, new, 1)
        path = tmp_path / "mine.toml"
        path.write_text(text)
        return path

    return written


def call(*words):
    return CliRunner().invoke(app, ["calibrate", *(str(word) for word in words)])


def said(result):
    return " ".join(result.output.split())


def table(path):
    with path.open() as file:
        return list(csv.DictReader(file))


def test_an_observation_out_of_reach_is_refused_in_all_four_places(study, tmp_path):
    path, out = study(), tmp_path / "out"
    result = call(path, "-o", out, "-q")
    assert result.exit_code == 4, result.output
    assert said(result).startswith(NO)
    assert "observed 34 ± 1 deg; all runs give" in said(result)
    assert "contact.friction_angle would have to be about 5" in said(result)
    assert "contact.friction_angle lies at the high edge of its prior, 40 deg" in said(result)
    (row,) = table(out / "parameters.csv")
    assert row["determined"] == "False"
    assert row["verdict"] == "the model does not reach these observations"
    assert row["at_edge"] == "high"
    assert not any(row[name] for name in ("mean", "standard_deviation", "low_68", "high_95", "over_prior"))
    (row,) = table(out / "observations.csv")
    assert row["reached"] == "False"
    assert float(row["runs_most"]) < math.radians(26.0) < float(row["observed"])
    assert row["would_move"] == "contact.friction_angle"
    assert float(row["to"]) == pytest.approx(58.0, abs=3.0)
    page = (out / "calibration.html").read_text()
    assert page.index(NO) < page.index('id="parameters"')
    assert "No quantity is predicted" in page
    ledger = json.loads((out / "calibration.json").read_text())
    assert ledger["verdict"] == NO
    assert ledger["reached"] is False
    found = ryusa.calibrate(path, folder=out, progress=False)
    assert found.words[0] == NO
    assert not found.verdict.reached
    assert found.verdict.determined == (False,)
    assert found.rows[0]["mean"] is None
    assert math.isnan(found.predicted[1].mean)
    assert found._repr_html_().startswith(f"<p>{NO}</p>")


@pytest.mark.full
def test_an_observation_within_reach_is_determined(study, tmp_path):
    out = tmp_path / "out"
    result = call(study(("34 deg", "17 deg")), "-o", out, "-q")
    assert result.exit_code == 0, result.output
    assert said(result).startswith("Determined: contact.friction_angle.")
    (row,) = table(out / "parameters.csv")
    assert row["determined"] == "True"
    assert float(row["mean"]) == pytest.approx(24.0, abs=0.7)
    assert float(row["low_95"]) < 24.0 < float(row["high_95"])


@pytest.mark.full
def test_one_seed_gives_no_interval(study, tmp_path):
    out = tmp_path / "out"
    path = study(("34 deg", "17 deg"), ("seeds = 2", "seeds = 1"))
    result = call(path, "-o", out, "-q")
    assert result.exit_code == 0, result.output
    assert said(result).startswith("Not determined: contact.friction_angle (one seed")
    (row,) = table(out / "parameters.csv")
    assert row["determined"] == "False"
    assert float(row["mean"]) == pytest.approx(24.0, abs=1.0)
    assert not any(row[name] for name in ("standard_deviation", "low_68", "high_95"))
    found = ryusa.calibrate(path, folder=out, progress=False)
    assert all(math.isnan(one.sd) for one in found.predicted)


@pytest.mark.full
def test_a_prior_is_extended_when_asked_and_it_is_said(study, tmp_path):
    path = study(("34 deg", "27 deg"))
    assert call(path, "-o", tmp_path / "one", "-q").exit_code in {0, 4}
    out = tmp_path / "two"
    result = call(path, "-o", out, "-q", "--extend", 2)
    assert result.exit_code == 0, result.output
    assert "was extended at its high edge: uniform from 10 to 55 deg" in said(result)
    (row,) = table(out / "parameters.csv")
    assert row["determined"] == "True"
    assert row["prior"] == "uniform from 10 to 55 deg"
    assert float(row["mean"]) == pytest.approx(44.0, abs=1.0)
    assert "was extended at its high edge" in (out / "calibration.html").read_text()
    assert "--extend 2" in (out / "calibration.html").read_text()


@pytest.mark.full
def test_an_extension_ends_where_the_cases_end(study, tmp_path):
    """A slope of 80 deg would need a friction angle of 150 deg."""
    out = tmp_path / "out"
    result = call(study(("34 deg", "80 deg")), "-o", out, "-q", "--extend", 5)
    assert result.exit_code == 4, result.output
    assert "which the cases do not take" in said(result)
    (row,) = table(out / "parameters.csv")
    assert row["determined"] == "False"
    assert "the cases take nothing beyond" in said(result)


def test_the_test_of_the_observation_is_asked(study, tmp_path):
    result = call(study(('test = "gate in a plane"\n', "")), "-o", tmp_path / "out", "-q")
    assert result.exit_code == 2
    assert "observations.0.test: missing" in said(result)
    assert "ryusa new lifted_cylinder" in said(result)
    result = call(study(("gate in a plane", "lifted cylinder in space")), "-o", tmp_path / "out", "-q")
    assert result.exit_code == 2
    assert "heap.toml shows 'gate in a plane'" in said(result)
    asked = read_calibration(study())
    untold = replace(asked, observations=(replace(asked.observations[0], test=""),))
    with pytest.raises(CaseError, match="must name the test"):
        ryusa.calibrate(untold, folder=tmp_path / "out", progress=False)
    assert not (tmp_path / "out").exists()


@pytest.mark.full
def test_coverage_counts_wrong_verdicts(study, tmp_path):
    out = tmp_path / "out"
    result = call(study(("34 deg", "17 deg")), "-o", out, "-q", "--coverage", 6)
    assert result.exit_code == 0, result.output
    rows = table(out / "coverage-verdicts.csv")
    assert [row["observations"] for row in rows] == [
        "within reach, called out of reach", "out of reach, called within reach",
        "out of reach, a parameter called determined",
    ]  # fmt: skip
    assert [row["wrong"] for row in rows] == ["0", "0", "0"]
    assert "out of reach, called within reach" in said(result)
