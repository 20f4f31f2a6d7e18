"""What `ryusa measure` writes and prints besides its table: CSV, series, layers, JSON, several runs."""

import csv
import json

import numpy as np
import pytest
from scipy.stats import norm
from scipy.stats import t as student
from typer.testing import CliRunner

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.cli import app
from ryusa.errors import ResultsError
from ryusa.measure.pooled import pooled
from ryusa.measure.statistics import average
from ryusa.measure.table import Averages
from ryusa.running.runner import run


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Three saltations that differ in their seed, one that also differs in its friction."""
    folder = tmp_path_factory.mktemp("runs")
    changes = {"build.starts": "3", "stop.time": "0.5 s", "record.settle": "0 s"}
    made = [
        run(read(case_path("saltation.toml"), changes | {"seed": str(k)}), folder / str(k), progress=False)
        for k in (1, 2, 3)
    ]
    other = changes | {"contact.friction_angle": "20 deg"}
    made.append(run(read(case_path("saltation.toml"), other), folder / "other", progress=False))
    return made


def call(*words):
    return CliRunner().invoke(app, ["measure", *(str(word) for word in words)])


def rows_in(path):
    with path.open() as file:
        return list(csv.DictReader(file))


def test_csv_is_always_the_averages_and_series_what_was_averaged(runs, tmp_path):
    for what, column, n in (
        ("transport", "q_star", len(runs[0].frames) - 1),
        ("saltation", "t_takeoff", len(runs[0].measure("saltation").hops)),
        ("spin", "omega_y_rad_per_s", len(runs[0].frames) * 3),
    ):
        result = call(runs[0].folder, what, "--csv", tmp_path / "a.csv", "--series", tmp_path / "s.csv")
        assert result.exit_code == 0, result.output
        averages = {row["quantity"]: row for row in rows_in(tmp_path / "a.csv")}
        found = runs[0].measure(what)
        assert {one.name for one in found.averages.items} == set(averages)
        series = rows_in(tmp_path / "s.csv")
        assert len(series) == n
        assert column in series[0]


def test_layers_are_written_where_there_are_some(runs, tmp_path):
    result = call(runs[0].folder, "profile", "--layers", tmp_path / "layers.csv")
    assert result.exit_code == 0, result.output
    assert float(rows_in(tmp_path / "layers.csv")[0]["z_m"]) == runs[0].measure("profile").z[0]
    result = call(runs[0].folder, "spin", "--layers", tmp_path / "none.csv")
    assert "has no layers" in result.stderr
    result = call(runs[0].folder, "energy", "--series", tmp_path / "none.csv")
    assert "keeps no series" in result.stderr


@pytest.mark.parametrize("what", ["transport", "energy", "saltation"])
def test_json_is_one_object_with_the_numbers(runs, what):
    result = call(runs[0].folder, what, "--json")
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))
    assert found["measure"] == what
    if what != "energy":
        value = next(row["value"] for row in found["rows"] if row["n"])
        assert value == next(one.value for one in runs[0].measure(what).averages.items if one.n)


def test_several_runs_are_pooled_with_the_error_between_them(runs, tmp_path):
    folders = [one.folder for one in runs[:3]]
    result = call(*folders, "saltation", "--csv", tmp_path / "pooled.csv")
    assert result.exit_code == 0, result.output
    assert "mean of 3 runs" in result.output
    assert "differ in more than their seed" not in result.output
    row = next(row for row in rows_in(tmp_path / "pooled.csv") if row["quantity"] == "jump_height")
    values = [one.measure("saltation")["jump_height"].value for one in runs[:3]]
    assert float(row["value"]) == pytest.approx(np.mean(values))
    widened = student.ppf(norm.cdf(1.0), 2)  # 68.3 % with two degrees of freedom
    assert float(row["standard_error"]) == pytest.approx(
        widened * np.std(values, ddof=1) / np.sqrt(3), rel=1e-6
    )
    assert int(row["n_series"]) == 3


def test_runs_that_differ_in_more_than_their_seed_are_pooled_with_a_warning(runs):
    result = call(runs[0].folder, runs[3].folder, "saltation")
    assert result.exit_code == 0, result.output
    assert "the cases differ in more than their seed: contact.friction" in result.output


def test_what_several_runs_cannot_give_is_refused(runs, tmp_path):
    both = [runs[0].folder, runs[1].folder]
    assert "has no averages that could be pooled" in call(*both, "energy").stderr
    assert "takes one run" in call(*both, "spin", "--series", tmp_path / "s.csv").stderr


def test_a_quantity_without_samples_in_one_run_is_left_out_and_named():
    def found(values):
        return Averages(
            "t",
            (
                average("a", "-", [np.array(values)], (0.0, 1.0)),
                average("b", "-", [np.arange(9.0)], (0.0, 1.0)),
            ),
        )

    both = pooled([found([1.0, 2.0]), found([])])
    assert [one.name for one in both.items] == ["b"]
    assert "left out, since a run has no samples: a" in both.notes
    with pytest.raises(ResultsError, match="two runs"):
        pooled([found([1.0])])
