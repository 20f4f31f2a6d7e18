from pathlib import Path

import pytest

from ryusa.errors import ResultsError
from ryusa.experiments import Band, Finding, Level, Plan, Trial, Word, _campaign, over_seeds, variant
from ryusa.figures.style import new
from ryusa.report import ledger, make, write
from ryusa.report.ledger import WATER

SHORT = {"stop.time": "0.01 s", "record.settle": "0 s"}


class Fake:
    """An experiment of one short run that may fail."""

    FIGURE = TITLE = "fake"

    def __init__(self, claims, trouble=None):
        self.CLAIMS, self.trouble = claims, trouble

    def cases(self, plan):
        return [variant("saltation", SHORT, seed) for seed in plan.seeds]

    def measure(self, run, one):
        del one
        if self.trouble is not None:
            raise self.trouble
        return len(run.frames)

    def judge(self, found, plan):
        del plan
        assert found
        held = Trial("length", {}, over_seeds([1.5], "m"), Band(1.0, 2.0, "m", "1 to 2 m"))
        return [Finding(one, (held,), "physics") for one in self.CLAIMS]

    def rows(self, found, plan):
        del plan
        return [{"frames": one} for one in found.values()]

    def draw(self, found, plan):
        del found, plan
        return {"fig20-shear-more": new()[0], "fig20": new()[0], "other": new()[0]}


@pytest.fixture
def fakes(monkeypatch):
    known = {"good": Fake(("fig20", "fig20-shear")), "bad": Fake(("fig4", "fig5"), ResultsError("no hop"))}
    for place in (_campaign, ledger):
        monkeypatch.setattr(place, "load", known.__getitem__)
    monkeypatch.setattr("ryusa.report.page.load", known.__getitem__)
    monkeypatch.setattr(ledger, "NAMES", tuple(known))
    return known


def test_a_run_that_fails_costs_its_experiment_its_verdict_and_no_other(fakes, tmp_path: Path):
    made = make(None, Plan(Level.QUICK, (1,)), tmp_path)
    by_id = {row.claim.id: row for row in made.rows}
    assert set(by_id) == {"fig4", "fig5", "fig20", "fig20-shear", *WATER}
    assert by_id["fig20"].word is Word.REPRODUCED
    assert by_id["fig4"].word is Word.UNDECIDED
    assert "1 of 1 runs failed" in by_id["fig4"].problem
    assert "bad: no hop" in by_id["fig5"].problem
    assert list(made.problems.values()) == ["bad: no hop"]
    write(made)
    assert "no hop" in (tmp_path / "ledger-quick.html").read_text()


def test_pictures_go_to_the_claim_they_are_named_after(fakes, tmp_path: Path):
    made = make(["good"], Plan(Level.QUICK, (1,)), tmp_path)
    shown = {row.claim.id: [one.stem for one in row.pictures] for row in made.rows}
    assert shown == {"fig20": ["fig20", "other"], "fig20-shear": ["fig20-shear-more"]}
    assert (tmp_path / "good" / "good.csv").is_file()
    assert set(shown) == {"fig20", "fig20-shear"}  # named experiments bring no rows that wait for water


def test_the_ledger_counts_its_runs_and_the_code_that_made_them(fakes, tmp_path: Path):
    first = make(["good"], Plan(Level.STANDARD, (1, 2)), tmp_path).plain()["provenance"]
    second = make(["good"], Plan(Level.STANDARD, (1, 2)), tmp_path).plain()["provenance"]
    assert (first["runs_made"], first["runs_opened"]) == (2, 0)
    assert (second["runs_made"], second["runs_opened"]) == (0, 2)
    assert first["commits_of_runs"] == second["commits_of_runs"]
