import json

import pytest
from typer.testing import CliRunner

from ryusa.cli import app
from ryusa.studies.validation import water_alone
from ryusa.studies.validation.study import NAMES, load


def call(*words):
    return CliRunner().invoke(app, ["validate", *(str(word) for word in words)])


@pytest.mark.parametrize("level", ["--quick", ""])
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
    assert {one["verdict"] for one in kept["findings"]} == {"within"}


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
