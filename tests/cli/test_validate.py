import json

import pytest
from typer.testing import CliRunner

from ryusa.cli import app
from ryusa_studies.validation import water_alone
from ryusa_studies.validation.study import NAMES, load


def call(*words):
    return CliRunner().invoke(app, ["validate", *(str(word) for word in words)])


@pytest.mark.parametrize("level", ["--quick", "", "--full"])
def test_the_list_names_every_check_and_what_it_costs(level):
    result = call("--list", *([level] if level else []))
    assert result.exit_code == 0, result.output
    for name in NAMES:
        assert name in result.output
        assert load(name).TITLE.split()[0] in result.output
    assert "core minutes" in result.output


def test_an_unknown_check_is_refused_with_the_nearest(tmp_path):
    result = call("water_alon", "-o", tmp_path)
    assert result.exit_code == 2
    assert "Did you mean 'water_alone'" in result.output
    assert not list(tmp_path.iterdir())


def test_a_check_is_computed_written_and_a_second_time_opened(tmp_path):
    first = call("water-alone", "--quick", "-o", tmp_path, "-q", "-j", 1)
    assert first.exit_code == 0, first.output
    assert "water-alone/log-rough" in first.stdout
    again = call("water-alone", "--quick", "-o", tmp_path, "-q", "-j", 1, "--json", tmp_path / "copy.json")
    kept = json.loads((tmp_path / "copy.json").read_text(encoding="utf-8"))
    assert again.exit_code == 0
    assert kept["provenance"]["runs_made"] == 0
    assert {one["verdict"] for one in kept["findings"]} == {"within", "within (check)"}
    assert "2 within; 6 checks, which all hold" in " ".join(first.stdout.split())
    assert "(at most 1e-07, check)" in " ".join(first.stdout.split())


@pytest.mark.full
def test_a_missed_comparison_has_its_own_exit_code_and_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(water_alone, "U_STAR", 0.2)  # of the reference alone, once the columns are kept
    call("water_alone", "--quick", "-o", tmp_path, "-q", "-j", 1)
    monkeypatch.setattr(water_alone, "U_STAR", 0.1)
    result = call("water_alone", "--quick", "-o", tmp_path, "-q", "-j", 1)
    assert result.exit_code == 4
    assert "2 outside the tolerance: water-alone/log-rough, water-alone/log-discharge" in result.stderr


def test_an_error_in_the_program_leaves_with_1_and_a_repaired_one_needs_no_run(tmp_path, monkeypatch):
    monkeypatch.setattr(water_alone, "judge", lambda *_: 1 / 0)
    result = call("water_alone", "--quick", "-o", tmp_path, "-q", "-j", 1)
    assert result.exit_code == 1
    assert "holds their tracebacks" in result.stderr
    assert (tmp_path / "validation-quick-part-errors.log").is_file()
    monkeypatch.undo()
    assert call("water_alone", "--quick", "-o", tmp_path, "-q", "-j", 1).exit_code == 0
    assert not (tmp_path / "validation-quick-part-errors.log").exists()


def test_seeds_set_the_runs_and_need_not_be_those_of_the_table():
    runs = {}
    for seeds in ("1,2,3", "4,5,6", "1"):
        shown = call("--list", "gas", "--seeds", seeds).output
        runs[seeds] = next(line.split()[-2] for line in shown.splitlines() if line.strip().startswith("gas"))
    assert runs["1,2,3"] == runs["4,5,6"]
    assert int(runs["1,2,3"]) == 3 * int(runs["1"])
    assert call("--list", "gas", "--seeds", "4,4").exit_code == 2
    assert call("--list", "--quick", "--full").exit_code == 2


@pytest.mark.full
def test_changed_verdicts_are_listed_against_an_earlier_ledger(tmp_path, monkeypatch):
    kept = tmp_path / "kept.json"
    first = call("water_alone", "--quick", "-o", tmp_path, "-q", "-j", 1, "--json", kept)
    assert first.exit_code == 0
    same = call("water_alone", "--quick", "-o", tmp_path, "-q", "-j", 1, "--against", kept)
    assert "0 verdicts differ" in same.stdout
    monkeypatch.setattr(water_alone, "U_STAR", 0.1)  # of the reference alone, once the columns are kept
    more = ("--against", kept, "--json", kept)  # the earlier one is read before it is replaced
    result = call("water_alone", "--quick", "-o", tmp_path, "-q", "-j", 1, *more)
    assert result.exit_code == 4
    assert "water-alone/log-rough: within (check), now missed (check)" in result.stdout
    assert "contrary: water-alone/log-rough" in result.stderr
    page = (tmp_path / "validation-quick-part.html").read_text(encoding="utf-8")
    assert "<li>water-alone/log-rough: within (check), now missed (check)</li>" in page
    assert "6 checks, of which 2 fail" in page
    against = json.loads(kept.read_text(encoding="utf-8"))["against"]
    line = {"id": "water-alone/log-rough", "old": "within (check)", "new": "missed (check)"}
    assert line in against["changed"]


def test_a_ledger_of_another_study_is_refused(tmp_path):
    other = tmp_path / "paper.json"
    other.write_text('{"format": 3, "study": "paper", "findings": [], "provenance": {}}', encoding="utf-8")
    result = call("water_alone", "--quick", "-o", tmp_path / "out", "-q", "-j", 1, "--against", other)
    assert result.exit_code == 2
    assert "of 'paper', not of 'validation'" in result.output
    assert not (tmp_path / "out").exists()  # before any run
