import csv
from types import SimpleNamespace

import pytest

from ryusa.casefile.read import read
from ryusa.errors import CaseError
from ryusa.experiments import NAMES, case_path, load, run_experiment


@pytest.mark.parametrize("name", NAMES)
def test_every_experiment_has_its_parts_and_its_cases_can_be_read(name):
    experiment = load(name)
    assert experiment.FIGURE
    assert experiment.TITLE
    names = [one.name for one in experiment.cases()]
    assert len(names) == len(set(names))
    for one in experiment.cases():
        read(case_path(one.case), dict(one.overrides))


@pytest.mark.parametrize("name", ["fig04", "fig08", "fig11", "fig12"])
def test_a_chart_is_measured_judged_drawn_and_written(name, tmp_path):
    outcome = run_experiment(name, tmp_path)
    assert (tmp_path / f"{name}.png").stat().st_size > 10_000
    assert (tmp_path / f"{name}.svg").exists()
    with (tmp_path / f"{name}.csv").open() as file:
        assert len(list(csv.DictReader(file))) == len(outcome.table.rows())
    with (tmp_path / f"{name}-verdicts.csv").open() as file:
        assert {row["verdict"] for row in csv.DictReader(file)} <= {"agrees", "disagrees", "undecided"}


def test_the_quoted_numbers_of_fig4_and_fig11_come_out_and_fig12_contradicts_itself(tmp_path):
    verdicts = {
        name: run_experiment(name, tmp_path).verdicts[0].holds for name in ("fig04", "fig11", "fig12")
    }
    assert verdicts == {"fig04": True, "fig11": True, "fig12": False}


def test_an_unknown_experiment_is_named(tmp_path):
    with pytest.raises(CaseError, match="fig99"):
        run_experiment("fig99", tmp_path)


@pytest.mark.slow
def test_fig20_runs_from_case_to_picture_and_a_second_time_opens_what_is_there(tmp_path):
    outcome = run_experiment("fig20", tmp_path, progress=False)
    written = (tmp_path / "runs" / "free" / "provenance.json").stat().st_mtime_ns
    locked, free = outcome.table.hops["locked"], outcome.table.hops["free"]
    assert free["jump_height"].value > locked["jump_height"].value
    assert locked["spin_after"].value == 0.0
    run_experiment("fig20", tmp_path, progress=False)
    assert (tmp_path / "runs" / "free" / "provenance.json").stat().st_mtime_ns == written


def test_a_run_that_was_stopped_gives_no_verdict(tmp_path, monkeypatch):
    monkeypatch.setattr("ryusa.running.runner.run", lambda *_, **__: SimpleNamespace(complete=False))
    with pytest.raises(KeyboardInterrupt):
        run_experiment("fig06", tmp_path)


def test_a_run_that_cannot_be_read_is_run_anew(tmp_path, monkeypatch):
    asked = []

    def stopped(*_, **__):
        asked.append(1)
        return SimpleNamespace(complete=False)

    folder = tmp_path / "runs" / "1-N-per-cm"
    folder.mkdir(parents=True)
    (folder / "case.json").write_text("{}")
    monkeypatch.setattr("ryusa.running.runner.run", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_experiment("fig06", tmp_path)
    assert asked
