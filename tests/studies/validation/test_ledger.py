"""What `make` and `write` do with checks that are right, wrong, broken, or cut short."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from ryusa.cases import case_path
from ryusa.errors import ResultsError
from ryusa.figures.comparison import Axis, Curve
from ryusa.study import (
    Band,
    Known,
    Level,
    Outcome,
    Plan,
    Source,
    StudyProgress,
    at_most,
    calculation,
    case_run,
    comparison,
    misfit,
    over_seeds,
)
from ryusa.study import ledger as ledger_module
from ryusa.study.ledger import make as make_study
from ryusa.study.page import write
from ryusa_studies.validation.sampling import CLOSED, SAMPLING
from ryusa_studies.validation.study import ValidationStudy, changes, table

CALLS = []
SHORT = {"stop.time": "0.01 s", "record.settle": "0 s"}


def parabola(n):
    CALLS.append(n)
    x = np.linspace(0.0, 1.0, n)
    return {"x": x, "y": x**2}


class Fake:
    """A check of two calculations."""

    TITLE = "Fake <b>"

    def __init__(self, factor=1.0, trouble=None, works=None):
        self.factor, self.trouble, self.works = factor, trouble, works

    def tasks(self, plan):
        return self.works or [calculation(parabola, n=n) for n in (5, 9 if plan.level is Level.QUICK else 17)]

    def judge(self, found, plan):
        if self.trouble:
            raise self.trouble
        ours = list(found.values())[-1]
        error = float(np.abs(self.factor * ours["y"] - ours["x"] ** 2).max())
        return [
            comparison(
                "square", "Square & <i>", Source("y = x^2"), Axis("x"), Axis("y", "m"),
                [Curve("ours", ours["x"], self.factor * ours["y"])],
                [Curve("law", ours["x"], ours["x"] ** 2)],
                [misfit("largest difference", error, "m", at_most(0.1, "a tenth"))], said="it is a square",
            )
        ]  # fmt: skip


class Scattered(Fake):
    """A check whose number scatters about its limit, beside one that is within."""

    def judge(self, found, plan):
        (made,) = super().judge(found, plan)
        rate = misfit("rate", over_seeds([0.5, 0.5, 2.0], "-"), "-", at_most(1.5, "why"))
        small = misfit("small", over_seeds([0.1, 0.1, 0.1], "-"), "-", at_most(1.0, "why"))
        return [replace(made, trials=(small, rate))]


class Checks(ValidationStudy):
    """The validation with checks of our own."""

    def __init__(self):
        self.known = {}

    @property
    def parts(self):
        return tuple(self.known)

    def part(self, name):
        return self.known[name]

    def __setitem__(self, name, check):
        self.known[name] = check

    def __getitem__(self, name):
        return self.known[name]


@pytest.fixture
def checks():
    CALLS.clear()
    return Checks()


def make(checks, names, level, folder, **how):
    return make_study(checks, names, Plan(level, ()), folder, **how)


def test_a_second_call_opens_what_was_computed_and_gives_the_same(checks, tmp_path):
    checks["one"] = Fake()
    first = make(checks, None, Level.STANDARD, tmp_path)
    second = make(checks, None, Level.STANDARD, tmp_path)
    assert CALLS == [5, 17]
    assert second.counts["runs_opened"] == 2
    assert second.plain()["findings"] == first.plain()["findings"]
    make(checks, None, Level.STANDARD, tmp_path, again=True)
    assert CALLS == [5, 17, 5, 17]


def test_an_interrupted_validation_continues_where_it_stopped(checks, tmp_path, monkeypatch):
    checks["one"] = Fake()
    real = ledger_module.carry_out

    def stops(*words, progress=None, **how):
        class Stop(StudyProgress):
            def done(self, *_):
                raise KeyboardInterrupt

        return real(*words, progress=Stop(), **how)

    monkeypatch.setattr(ledger_module, "carry_out", stops)
    with pytest.raises(KeyboardInterrupt):
        make(checks, None, Level.STANDARD, tmp_path)
    assert CALLS == [5]
    monkeypatch.setattr(ledger_module, "carry_out", real)
    made = make(checks, None, Level.STANDARD, tmp_path)
    assert CALLS == [5, 17]
    assert made.entries[0].outcome is Outcome.HOLDS


def test_damaged_numbers_are_computed_anew(checks, tmp_path):
    checks["one"] = Fake()
    make(checks, None, Level.STANDARD, tmp_path)
    next(tmp_path.glob("runs/*/*5*/numbers.npz")).write_bytes(b"PK half")
    assert make(checks, None, Level.STANDARD, tmp_path).entries[0].outcome is Outcome.HOLDS
    assert len(CALLS) == 3


def test_a_curve_that_is_too_far_off_is_missed(checks, tmp_path):
    checks["one"] = Fake(factor=1.5)
    made = make(checks, None, Level.QUICK, tmp_path)
    (row,) = made.plain()["findings"]
    assert row["verdict"] == "missed"
    assert row["trials"][0]["value"] == pytest.approx(0.5)
    assert row["trials"][0]["outcome"] == "fails"
    assert not made.problems and not made.faults  # computed in order: the number is the answer


def test_an_error_in_one_comparison_affects_no_other(checks, tmp_path):
    checks["bad"], checks["good"] = Fake(trouble=IndexError("no such row")), Fake()
    checks["told"] = Fake(trouble=ResultsError("no steady state"))
    made = make(checks, None, Level.QUICK, tmp_path)
    assert [one.outcome for one in made.entries] == [Outcome.UNDECIDED, Outcome.HOLDS, Outcome.UNDECIDED]
    assert "IndexError: no such row" in made.entries[0].problem
    assert set(made.traces) == {"bad: judging"}
    files = write(made)
    assert "could not be judged" in files[0].read_text(encoding="utf-8")
    assert "IndexError" in (tmp_path / made.log).read_text(encoding="utf-8")


def broken():
    raise ValueError("no root")


def test_a_calculation_that_fails_leaves_its_check_unjudged_and_no_other(checks, tmp_path):
    checks["bad"], checks["good"] = Fake(works=[calculation(broken)]), Fake()
    made = make(checks, None, Level.QUICK, tmp_path)
    assert [one.outcome for one in made.entries] == [Outcome.UNDECIDED, Outcome.HOLDS]
    assert "ValueError: no root" in next(iter(made.problems.values()))
    assert made.traces


def test_the_page_holds_its_pictures_and_escapes_words(checks, tmp_path):
    checks["one"] = Fake()
    files = write(make(checks, None, Level.QUICK, tmp_path), tmp_path / "copy" / "validation.json")
    assert [one.name for one in files] == [
        "validation-quick.html",
        "validation-quick.json",
        "validation.json",
    ]
    text = files[0].read_text(encoding="utf-8")
    assert "data:image/png;base64," in text
    assert "Square &amp; &lt;i&gt;" in text
    assert "<link" not in text and 'src="pictures' not in text
    kept = json.loads(files[2].read_text(encoding="utf-8"))
    assert kept["findings"][0]["chart"]["ours"][0]["name"] == "ours"
    assert table(kept).splitlines()[2].startswith("| one/square: Square")


def test_axe_finds_no_fault_on_the_page(checks, tmp_path, faults_of):
    checks["one"] = Fake()
    assert faults_of(write(make(checks, None, Level.STANDARD, tmp_path))[0]) == []


def test_the_page_of_the_standard_level_says_how_often_each_comparison_was_run(checks, tmp_path):
    checks["one"] = Fake()
    (page, *_) = write(make(checks, None, Level.STANDARD, tmp_path))
    text = page.read_text(encoding="utf-8")
    assert all(f"<td>{name}</td>" in text for name, one in SAMPLING.items() if one.runs[0])
    assert all(f"{name} ({why})" in text for name, why in CLOSED.items())


def test_the_table_shows_what_is_undecided(checks, tmp_path):
    checks["one"] = Scattered()
    made = make(checks, None, Level.STANDARD, tmp_path)
    assert made.entries[0].outcome is Outcome.UNDECIDED
    (line,) = table(made.plain()).splitlines()[2:]
    assert "rate: 1 (-1.15 to 3.15)" in line
    assert "small" not in line
    assert line.endswith("| undecided |")


def test_changed_verdicts_are_paragraphs_of_the_documentation(checks, tmp_path):
    checks["one"] = Fake()
    first = make(checks, None, Level.STANDARD, tmp_path)
    assert changes(first.plain()) == []
    checks["one"] = Fake(factor=1.5)
    second = replace(make(checks, None, Level.STANDARD, tmp_path), earlier=first.plain())
    assert changes(second.plain())[-1] == "- one/square: within, now missed"
    write(second)


def test_a_part_never_replaces_the_whole(checks, tmp_path):
    checks["one"], checks["two"] = Fake(), Fake()
    assert make(checks, ["one"], Level.STANDARD, tmp_path).stem == "validation-part"
    assert make(checks, None, Level.STANDARD, tmp_path).stem == "validation"


def test_nan_is_missed():
    assert misfit("e", math.nan, "-", at_most(1.0, "why")).holds is False
    assert misfit("e", 3.0, "-", Band(1.0, math.inf, "-", "why")).holds is True


def test_a_reference_from_memory_is_shown_and_must_not_decide():
    line, axis = Curve("a", np.zeros(2), np.zeros(2)), Axis("x")
    shown = comparison(
        "m", "M", Source("someone", Known.MEMORY), axis, axis, [line], [line], [misfit("e", 1.0)]
    )
    assert shown.outcome is Outcome.SHOWN
    with pytest.raises(ValueError, match="from memory"):
        comparison(
            "m", "M", Source("someone", Known.MEMORY), axis, axis, [line], [line],
            [misfit("e", 1.0, "-", at_most(2.0, "why"))],
        )  # fmt: skip


class OfRuns:
    """A check of two runs of a case file."""

    TITLE = "Runs"
    CASES = tuple(
        case_run(
            case_path("paper/saltation.toml"), {"stop.time": "0.01 s", "record.settle": "0 s"}, seed=seed
        )
        for seed in (1, 2)
    )

    def tasks(self, plan):
        return self.CASES[: 1 if plan.level is Level.QUICK else 2]

    def measure(self, run, one):
        assert one in self.CASES
        return len(run.frames)

    def judge(self, found, plan):
        count = np.array([float(n) for n in found.values()])
        lines = [Curve("ours", count, count)]
        errors = [misfit("frames", count.min(), "-", Band(1.0, math.inf, "-", "more than none"))]
        return [comparison("frames", "Frames", Source("a count"), Axis("a"), Axis("b"), lines, lines, errors)]


def test_runs_of_case_files_are_kept_and_opened(checks, tmp_path):
    checks["runs"] = OfRuns()
    quick = make(checks, None, Level.QUICK, tmp_path)
    assert (quick.counts["runs_made"], quick.counts["runs_opened"]) == (1, 0)
    full = make(checks, None, Level.STANDARD, tmp_path)
    assert (full.counts["runs_made"], full.counts["runs_opened"]) == (1, 1)
    assert full.entries[0].outcome is Outcome.HOLDS
    assert len(list((tmp_path / "runs" / "saltation").glob("*/grains.vtkhdf"))) == 2


def test_a_check_without_work_at_a_level_has_no_row(checks, tmp_path):
    checks["one"], checks["later"] = Fake(), Fake()
    checks["later"].tasks = lambda _: []
    checks["later"].judge = lambda *_: []
    made = make(checks, None, Level.QUICK, tmp_path)
    assert [one.part for one in made.entries] == ["one"]
    write(made)
