import json
from pathlib import Path

import pytest

from ryusa.errors import ResultsError
from ryusa.figures.style import new
from ryusa.study import Band, Finding, Level, Outcome, Plan, Trial, ledger, over_seeds
from ryusa.study.ledger import make as make_study
from ryusa.study.page import write
from ryusa_studies.osada2004._parts import paper_run
from ryusa_studies.osada2004.study import PaperStudy

SHORT = {"stop.time": "0.01 s", "record.settle": "0 s"}


class Fake:
    """An experiment of one short run that may fail."""

    FIGURE = TITLE = "fake"

    def __init__(self, claims, trouble=None):
        self.CLAIMS, self.trouble = claims, trouble

    def tasks(self, plan):
        return [paper_run("saltation", SHORT, seed) for seed in plan.seeds]

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


class Fakes(PaperStudy):
    """The paper's study with experiments of our own, which judge by bands that nobody registered."""

    registration = None

    def __init__(self, known):
        self.known = known

    @property
    def parts(self):
        return tuple(self.known)

    def part(self, name):
        return self.known[name]


@pytest.fixture
def fakes():
    return {"good": Fake(("fig20", "fig20-shear")), "bad": Fake(("fig4", "fig5"), ResultsError("no hop"))}


def make(known, names, plan, folder):
    return make_study(Fakes(known), names, plan, folder)


def test_a_failed_run_leaves_only_its_part_unjudged(fakes, tmp_path: Path):
    made = make(fakes, None, Plan(Level.QUICK, (1,)), tmp_path)
    by_id = {row.id: row for row in made.entries}
    assert set(by_id) == {"fig4", "fig5", "fig20", "fig20-shear"}
    assert by_id["fig20"].outcome is Outcome.HOLDS
    assert by_id["fig4"].outcome is Outcome.UNDECIDED
    assert "1 of 1 runs failed" in by_id["fig4"].problem
    assert by_id["fig5"].problem.endswith("saltation 0 s 1 0.01 s: no hop")
    assert list(made.problems.values()) == ["bad: no hop"]
    write(made)
    assert "no hop" in (tmp_path / "ledger-quick.html").read_text()


@pytest.mark.full
@pytest.mark.parametrize("step", ["judge", "rows", "draw", "measure"])
def test_an_error_in_the_program_is_reported_logged_and_affects_no_other_claim(fakes, tmp_path: Path, step):
    def wrong(*words):
        return words[7]

    fakes["bad"] = Fake(("fig4", "fig5"))
    setattr(fakes["bad"], step, wrong)
    made = make(fakes, None, Plan(Level.QUICK, (1,)), tmp_path)
    rows = {row.id: row for row in made.entries}
    assert rows["fig20"].outcome is Outcome.HOLDS
    assert not rows["fig20"].problem
    for claim in ("fig4", "fig5"):
        assert "IndexError: tuple index out of range (test_ledger.py, line" in rows[claim].problem
        judged = step in {"rows", "draw"}  # the verdict does not need them
        assert rows[claim].outcome is (Outcome.HOLDS if judged else Outcome.UNDECIDED)
        assert (rows[claim].finding is not None) == judged
    write(made)
    log = (tmp_path / "ledger-quick-errors.log").read_text()
    assert "Traceback" in log
    assert "in wrong" in log
    page = (tmp_path / "ledger-quick.html").read_text()
    assert "ledger-quick-errors.log" in page
    assert "Traceback" not in page
    assert str(Path(__file__).parent) not in page
    plain = json.loads((tmp_path / "ledger-quick.json").read_text())
    assert plain["log"] == "ledger-quick-errors.log"
    assert plain["errors_in"]
    fakes["bad"] = Fake(("fig4", "fig5"))
    write(make(fakes, None, Plan(Level.QUICK, (1,)), tmp_path))
    assert not (tmp_path / "ledger-quick-errors.log").exists()


def test_a_finding_without_words_or_of_another_claim_is_an_error(fakes, tmp_path: Path):
    fakes["bad"] = Fake(("fig4", "fig5"))
    fakes["bad"].judge = lambda *_: [Finding("fig4", (), "physics")]
    fakes["good"].judge = lambda *_: [
        Finding(one, (None,), "physics") for one in ("fig20", "fig20-shear")
    ]  # no trial at all
    made = make(fakes, None, Plan(Level.QUICK, (1,)), tmp_path)
    rows = {row.id: row for row in made.entries}
    assert "bad judged fig4, not fig4, fig5" in rows["fig5"].problem
    assert "AttributeError" in rows["fig20"].problem
    assert set(made.traces) == {"bad: judging", "good: judging"}


def test_a_full_disk_is_no_error_of_an_experiment(fakes, tmp_path: Path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    del fakes["bad"]
    monkeypatch.setattr(ledger, "write_csv", full)
    with pytest.raises(OSError, match="No space left"):
        make(fakes, None, Plan(Level.QUICK, (1,)), tmp_path)


def test_pictures_go_to_the_claim_they_are_named_after(fakes, tmp_path: Path):
    made = make(fakes, ["good"], Plan(Level.QUICK, (1,)), tmp_path)
    shown = {row.id: [one.stem for one in row.pictures] for row in made.entries}
    assert shown == {"fig20": ["fig20", "other"], "fig20-shear": ["fig20-shear-more"]}
    assert (tmp_path / "good" / "good.csv").is_file()
    assert set(shown) == {"fig20", "fig20-shear"}  # named experiments bring no rows that wait for water


def test_the_ledger_counts_its_runs_and_the_code_that_made_them(fakes, tmp_path: Path):
    first = make(fakes, ["good"], Plan(Level.STANDARD, (1, 2)), tmp_path).plain()["provenance"]
    second = make(fakes, ["good"], Plan(Level.STANDARD, (1, 2)), tmp_path).plain()["provenance"]
    assert (first["runs_made"], first["runs_opened"]) == (2, 0)
    assert (second["runs_made"], second["runs_opened"]) == (0, 2)
    assert first["commits_of_runs"] == second["commits_of_runs"]
