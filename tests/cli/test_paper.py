from importlib import import_module

import pytest
from typer.testing import CliRunner

from ryusa.cli import app
from ryusa.experiments import NAMES, Verdict, load

paper = import_module("ryusa.cli.paper")


def call(*words):
    return CliRunner().invoke(app, ["paper", *(str(word) for word in words)])


def test_without_names_every_experiment_is_listed_with_what_it_answers_and_needs():
    result = call()
    assert result.exit_code == 0, result.output
    lines = {line.split()[0]: line for line in result.output.splitlines() if line.strip()}
    for name in NAMES:
        runs = len(load(name).cases())
        assert load(name).FIGURE in lines[name]
        assert (f"{runs} run" in lines[name]) if runs else ("chart" in lines[name])


def test_charts_are_judged_and_the_paper_is_quoted(tmp_path):
    result = call("fig04", "fig12", "-o", tmp_path)
    assert result.exit_code == 0, result.output
    assert "agrees: d = 0.2 cm, k_n = 0.01 N/cm: about 0.01 s" in result.output
    assert "disagrees: d = 20 cm" in result.output
    assert "the paper, fig12: " in result.output
    for name in ("fig04", "fig12"):
        assert f"wrote {tmp_path / name / name}.png" in result.output
        assert (tmp_path / name / f"{name}.csv").is_file()


@pytest.mark.parametrize("word", ["fig4", "fig04", "Fig. 4", "FIG04", "4", "figure 4"])
def test_the_papers_own_way_of_writing_a_figure_is_understood(word, tmp_path):
    result = call(word, word, "-o", tmp_path)
    assert result.exit_code == 0, result.output
    assert result.output.count("fig04: ") == 1  # asked twice, done once


@pytest.mark.parametrize(
    ("word", "near"), [("fig60", "fig06"), ("free-choises", "free_choices"), ("saltation", "")]
)
def test_an_unknown_name_stops_everything_before_it_starts(word, near, tmp_path):
    result = call("fig04", word, "-o", tmp_path)
    assert result.exit_code == 2
    assert f"experiment = '{word}'" in result.output
    assert near in result.output
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_written_is_one_message(tmp_path):
    (tmp_path / "taken").write_text("")
    result = call("fig04", "-o", tmp_path / "taken")
    assert result.exit_code == 2
    assert "cannot be written" in result.output


def test_what_a_verdict_hangs_on_is_said():
    found = paper.settings(load("fig20"))
    assert found == {
        "phi": "30 deg",
        "k_s/k_n": "0.286",
        "slip rule": "spring",
        "rotation": "locked, free",
        "k_n": "100 N/cm",
    }
    assert paper.settings(load("fig04")) == {}
    assert "total" in paper.settings(load("free_choices"))["slip rule"]


def test_ctrl_c_ends_with_its_own_exit_code(monkeypatch, tmp_path):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("ryusa.experiments.run_experiment", interrupted)
    result = call("fig04", "-o", tmp_path)
    assert result.exit_code == 130


def test_an_undecided_verdict_is_called_so(capsys):
    paper._print_verdicts([Verdict("no-such-claim", "says", "found", None)])
    assert "undecided: says" in capsys.readouterr().out


@pytest.mark.slow
def test_fig06_runs_is_judged_and_opened_the_second_time(tmp_path):
    first = call("fig6", "-o", tmp_path)
    assert first.exit_code == 0, first.output
    assert "agrees: 30 saltations after settling" in first.output
    run = tmp_path / "fig06" / "runs" / "1-N-per-cm" / "provenance.json"
    written = run.stat().st_mtime_ns
    assert call("fig6", "-o", tmp_path).exit_code == 0
    assert run.stat().st_mtime_ns == written
    assert call("fig6", "-o", tmp_path, "--again").exit_code == 0
    assert run.stat().st_mtime_ns > written
