import json

import pytest
from typer.testing import CliRunner

from ryusa.cli import app
from ryusa.experiments import NAMES, load


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
def test_the_papers_own_way_of_writing_a_figure_is_understood(word):
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
def test_seeds_that_are_none_are_refused(seeds, tmp_path):
    result = call("fig20", "--seeds", seeds, "-o", tmp_path)
    assert result.exit_code == 2
    assert "--seeds" in result.output


def test_quick_and_full_exclude_each_other():
    assert call("--quick", "--full").exit_code == 2


@pytest.mark.slow
def test_a_figure_is_run_judged_and_written_and_a_second_time_opened(tmp_path):
    first = call("fig20", "--quick", "-o", tmp_path, "-q", "-j", 1)
    assert first.exit_code == 0, first.output
    ledger = json.loads((tmp_path / "ledger.json").read_text())
    assert [one["id"] for one in ledger["claims"]] == ["fig20", "fig20-shear"]
    assert ledger["provenance"]["runs_made"] == 2
    again = call("fig20", "--quick", "-o", tmp_path, "-q", "-j", 1, "--json", tmp_path / "copy.json")
    assert again.exit_code == 0, again.output
    second = json.loads((tmp_path / "copy.json").read_text())
    assert second["provenance"]["runs_opened"] == 2
    assert second["claims"] == ledger["claims"]
