import importlib.util
import json
import re

import pytest
from typer.testing import CliRunner

import ryusa
from ryusa.cli import app
from ryusa.study import Band, Finding, Level, Plan, Trial, exact, ledger, page
from ryusa.study.entry import LedgerEntry
from ryusa.study.ledger import Ledger
from ryusa_studies.osada2004.study import NAMES, PAPER, load


def call(*words):
    return CliRunner().invoke(app, ["paper", *(str(word) for word in words)])


def test_the_list_names_every_experiment_with_its_claims_and_costs():
    result = call("--list")
    assert result.exit_code == 0, result.output
    for name in NAMES:
        assert name in result.output
        assert load(name).CLAIMS[0] in result.output
    assert "core minutes" in result.output


@pytest.mark.parametrize("word", ["fig20", "Fig. 20", "FIG20", "20", "figure 20", "fig20-shear"])
def test_figure_names_as_in_the_paper_are_accepted(word):
    result = call(word, "--list")
    assert result.exit_code == 0, result.output
    assert "fig20-shear" in result.output


@pytest.mark.parametrize(("word", "near"), [("fig200", "fig20"), ("fig20-sheer", "fig20-shear")])
def test_an_unknown_name_stops_everything_before_it_starts(word, near, tmp_path):
    result = call("fig20", word, "-o", tmp_path)
    assert result.exit_code == 2
    assert f"experiment = '{word}'" in result.output
    assert near in result.output
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("seeds", ["0", "-1", "1,1", "a", "", "1.5"])
def test_invalid_seeds_are_refused(seeds, tmp_path):
    result = call("fig20", "--seeds", seeds, "-o", tmp_path)
    assert result.exit_code == 2
    assert "--seeds" in result.output


def test_quick_and_full_exclude_each_other():
    assert call("--quick", "--full").exit_code == 2


@pytest.mark.full
def test_the_list_gives_time_and_disk_space(tmp_path):
    result = call("--full", "--list", "-j", 2, "-o", tmp_path)
    assert result.exit_code == 0, result.output
    last = result.stdout.strip().splitlines()[-1]
    assert re.match(r"full: \d+ runs to make: about .* 2 at a time \(\d+ core minutes .*B on the disk", last)
    assert not list(tmp_path.iterdir())


def broken(folder, **more):
    """A ledger in which one run failed."""
    held = Finding("fig16", (Trial("speed", {}, exact(1.0, "m/s"), Band(0.0, 2.0, "m/s", "slow")),))
    entries = (
        LedgerEntry("fig20", "fig20", None, problem="1 of 2 runs failed"),
        LedgerEntry("fig16", "fig16", held),
    )
    problems = {"fig20 [free]": "grain 7 lost"}
    return Ledger(PAPER, entries, Plan(Level.QUICK, (1,)), folder, problems, {}, {}, **more)


def test_a_failed_run_is_reported_at_the_end_and_by_the_exit_code(tmp_path, monkeypatch):
    monkeypatch.setattr(ledger, "make", lambda *_, **__: broken(tmp_path))
    monkeypatch.setattr(page, "write", lambda *_: (tmp_path / "ledger.html",))
    result = call("--quick", "-o", tmp_path)
    assert result.exit_code == 3
    assert "1 run could not be carried out or measured:\n  fig20 [free]: grain 7 lost" in result.stderr
    assert "not judged, see below" in result.stdout
    assert "1 reproduced as shipped; 1 undecided" in result.stdout
    assert all(len(line) <= 100 for line in result.stdout.splitlines() if "wrote" not in line)


def test_an_error_in_the_program_has_its_own_exit_code_and_no_traceback(tmp_path, monkeypatch):
    faults = {"fig20: judging": "error in the program: IndexError: no such (fig20.py, line 3)"}
    monkeypatch.setattr(ledger, "make", lambda *_, **__: broken(tmp_path, faults=faults))
    monkeypatch.setattr(page, "write", lambda *_: (tmp_path / "ledger.html",))
    assert call("--quick", "-o", tmp_path).exit_code == 3
    traces = {"fig20: judging": "Traceback (most recent call last):"}
    monkeypatch.setattr(ledger, "make", lambda *_, **__: broken(tmp_path, faults=faults, traces=traces))
    result = call("--quick", "-o", tmp_path)
    assert result.exit_code == 1
    assert "1 step after the runs failed:\n  fig20: judging: error in the program" in result.stderr
    assert f"{tmp_path / 'ledger-errors.log'} holds their tracebacks" in result.stderr
    assert "Traceback" not in result.output


@pytest.mark.slow
def test_a_figure_is_run_judged_and_written_and_a_second_time_opened(tmp_path):
    first = call("fig20", "--quick", "-o", tmp_path, "-q", "-j", 1)
    assert first.exit_code == 0, first.output
    ledger = json.loads((tmp_path / "ledger-quick-part.json").read_text())
    assert [one["id"] for one in ledger["findings"]] == ["fig20", "fig20-shear"]
    assert ledger["provenance"]["runs_made"] == 2
    assert (tmp_path / "ledger-quick-part.html").stat().st_size > 100_000
    assert not list(tmp_path.glob(".*.new"))
    again = call("fig20", "--quick", "-o", tmp_path, "-q", "-j", 1, "--json", tmp_path / "copy.json")
    assert again.exit_code == 0, again.output
    second = json.loads((tmp_path / "copy.json").read_text())
    assert second["provenance"]["runs_opened"] == 2
    assert second["findings"] == ledger["findings"]


@pytest.mark.parametrize("command", ["paper", "validate"])
def test_without_the_studies_one_line_says_how_to_get_them(command, tmp_path, monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(ryusa, "__file__", str(tmp_path / "site-packages" / "ryusa" / "__init__.py"))
    result = CliRunner().invoke(app, [command, "--list"])
    assert result.exit_code == 2
    assert "pip install ./studies in a checkout of ryusa" in " ".join(result.output.split())
