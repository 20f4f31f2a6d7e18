"""Numbers in the prose of docs/paper.md are those of the ledgers, and what is said of them is so."""

import importlib
import re
import tomllib
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from ryusa.study import Outcome
from ryusa.study.verdict_words import said

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "paper.md"
TYPED = tomllib.loads(Path(__file__).with_name("typed_numbers.toml").read_text(encoding="utf-8"))

# What looks like a number of ours and is a name, whatever the text around it.
NAMES = {
    "command or file": r"`[^`\n]+`",
    "target of a link": r"\]\([^)]*\)",
    "the paper in its own language": r"「[^」]*」",
    "figure": r"Figs?\. \d+(?:,? (?:and|to)\s\d+)?",
    "equation": r"Eqs?\. \(\d+\)",
    "design note": r"design note \d{4}",
    "number of a list": r"^\d+\. ",
    "year": r"(?<=[a-z.] )\(?(?:19|20)\d\d\)",
}
WORDS = (
    "two|three|four|five|six|seven|eight|nine|ten|eleven|twelve|twenty|thirty|forty|fifty|hundred|thousand|"
    "twice|half|halves|third|thirds|quarter|quarters|fifth|tenth|twentieth|hundredth|thousandth"
)
NUMERAL = re.compile(rf"(?<![\w.])\d[\w.,]*|\b(?:{WORDS})\b", re.IGNORECASE)


@pytest.fixture(scope="module")
def cited() -> ModuleType:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(DOCS)
        return importlib.import_module("cited")


def text() -> str:
    return PAGE.read_text(encoding="utf-8")


def typed(cited: ModuleType, page: str) -> list[str]:
    """Numbers that neither a ledger nor the list of exceptions accounts for, with what stands around them."""
    prose = cited.prose(page)
    for name in NAMES.values():
        prose = re.sub(name, "", prose, flags=re.MULTILINE)
    prose = " ".join(prose.split())
    for phrase in sorted(phrases(), key=len, reverse=True):
        prose = re.sub(rf"(?<![\w.]){re.escape(phrase)}(?!\w)", "", prose)
    return [prose[max(0, one.start() - 40) : one.end() + 30] for one in NUMERAL.finditer(prose)]


def phrases() -> list[str]:
    return [phrase for group in TYPED.values() for phrase in group]


def test_the_text_has_every_number_as_the_ledgers_have_it(cited: ModuleType) -> None:
    page = text()
    wrong = [
        f"{found['asked']}: {found['shown']!r} in the text, {cited.lookup(found['asked'])!s} in the ledger"
        for found in cited.CITED.finditer(page)
        if found["shown"] != str(cited.lookup(found["asked"]))
    ]
    assert not wrong, "run `make docs`"
    assert cited.filled(page) == page
    assert len(cited.CITED.findall(page)) > 100


def test_what_the_text_says_of_the_numbers_is_so(cited: ModuleType) -> None:
    assert not cited.untrue(text())
    assert len(cited.WHILE.findall(text())) > 30


def test_every_other_number_in_the_text_is_a_known_exception(cited: ModuleType) -> None:
    assert not typed(cited, text()), "take it from a ledger (docs/cited.py), or add it to typed_numbers.toml"


def test_every_exception_stands_in_the_text(cited: ModuleType) -> None:
    prose = " ".join(cited.prose(text()).split())
    assert not [phrase for phrase in phrases() if phrase not in prose]
    assert len(phrases()) == len(set(phrases()))


def trial(
    part: str, value: float | None, low: float, high: float, outcome: str, **more: Any
) -> dict[str, Any]:
    choices = {"friction angle": "30 deg", "reading": "first hits", **more.pop("choices", {})}
    plain = {"part": part, "value": value, "low": low, "high": high, "outcome": outcome, "choices": choices}
    return {**plain, "unit": "s", "n": 4, "note": "", **more}


DECIDED = "friction angle 10 deg (1 of 1 setting; none of 2 others, 1 undecided)"
SPIN = {
    "id": "spin",
    "base_outcome": "fails",
    "outcome": "fails",
    "condition": "",
    "robustness": {"holds": 1, "of": 3, "undecided": 1},
    "deciding_factor": {
        "choice": "friction angle",
        "words": DECIDED,
        "there": {"holds": 1, "of": 1, "undecided": 0},
        "elsewhere": {"holds": 0, "of": 2, "undecided": 1},
    },
    "readings": ["reading"],
    "registered": {"test": "the spread is pooled over the settings"},
    "trials": [
        trial("mean time", 0.01234, 0.012, 0.013, "fails"),
        trial("mean time", 0.05, 0.05, 0.05, "holds", choices={"friction angle": "10 deg"}),
        trial("mean time", 0.03, 0.02, 0.04, "undecided", choices={"friction angle": "20 deg"}),
        trial("mean time", 0.002, 0.001, 0.003, "fails", choices={"reading": "later hits"}),
        trial("most time", None, 0.0, 0.0, "shown", note="4 of 4 stand"),
    ],
    "beside": [
        {**trial("share that flows", 0.75, 0.3, 0.9, "shown"), "unit": "-", "choices": {"bed": "loose"}}
    ],
    "also": [
        "begun at rest: 443 rad/s (418 to 468), 1008 rad/s (977 to 1039) after 6 hits",
        "37 of 68 heaps",
    ],
    "decided_by": "Locked 1.2 to 1.3 m/s.",
    "contradiction": "",
}
SLOPE = {**SPIN, "id": "slope", "base_outcome": "holds", "outcome": "holds", "deciding_factor": None}
TIME = {
    **SPIN,
    "id": "time",
    "outcome": "holds only if",
    "condition": "time scheme (all) old (2 of 2 settings, none of 1 other)",
}
LEDGER = {
    "findings": [SPIN, *({**one, "registered": {"test": "no spread is pooled"}} for one in (SLOPE, TIME))],
    "seeds": [1, 2, 3, 4],
    "provenance": {
        "commit": "a",
        "commits_of_runs": {"a": 2685, "b": 8},
        "of_other_code": {"b": 8},
        "runs_made": 2693,
        "wall_s": 2099.3,
    },
}


@pytest.fixture
def small(cited: ModuleType, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """With a small ledger and its words, so that the kept ones may change."""
    monkeypatch.setattr(cited, "kept", {"paper": LEDGER}.__getitem__)
    words = {Outcome.HOLDS: "reproduced", Outcome.FAILS: "not reproduced"}
    mine = SimpleNamespace(said=lambda entry: said(entry, words.__getitem__))
    monkeypatch.setattr(cited, "study_of", {"paper": mine}.__getitem__)
    return cited


def test_a_typed_number_and_a_number_word_are_found(cited: ModuleType) -> None:
    prose = "It lasts <!-- paper spin: mean time -->0.01<!--/--> of Eq. (8), not 0.87, and half by Fig. 7."
    found = typed(cited, prose)
    assert len(found) == 2 and all("not 0.87, and half by" in one for one in found)


def test_a_number_that_is_not_that_of_the_ledger_is_written_anew(small: ModuleType) -> None:
    comment = "<!-- paper spin: held -->"
    assert small.filled(f"in {comment}none<!--/-->.") == f"in {comment}1 of 3 settings (1 undecided)<!--/-->."


def test_words_that_a_number_no_longer_bears_are_named(small: ModuleType) -> None:
    prose = "They last long. <!-- while paper spin: mean time; is above 0.0125 -->"
    (wrong,) = small.untrue(prose)
    assert "They last long." in wrong and "0.0123" in wrong
    assert small.untrue(prose.replace("above", "below")), "neither: the limit lies in the interval"
    assert not small.untrue(prose.replace("0.0125", "0.011"))
    assert not small.untrue("So it is. <!-- while paper spin: as shipped; is not reproduced -->")
    assert small.untrue("So it is. <!-- while paper spin: only if; is friction angle 10 deg -->")


def test_an_undecided_setting_may_hold_or_fail(small: ModuleType) -> None:
    """1 of 3 settings holds and 1 is undecided: no more than two of three hold, and no less than one."""
    share = small.lookup("paper spin: held")
    assert share.is_so("above 0.3") and share.is_so("below 0.7")
    assert not share.is_so("below 0.5") and not share.is_so("above 0.5")
    assert small.lookup("paper spin: held; as value").is_so("below 0.5")


@pytest.mark.parametrize(
    ("asked", "shown"),
    [
        ("paper spin: mean time", "0.0123 s (0.012 to 0.013)"),
        ("paper spin: mean time; as value", "0.0123 s"),
        ("paper spin: mean time; as ms, 2 digits", "12 ms (12 to 13)"),
        ("paper spin: mean time; as ms, no unit", "12.3 (12 to 13)"),
        ("paper spin: mean time; reading = later hits", "0.002 s (0.001 to 0.003)"),
        ("paper spin: mean time; over settings", "0.0123 to 0.05 s"),
        ("paper spin: share; bed = loose; as count", "3 of 4"),
        ("paper spin: share; bed = loose; as %, 2 digits", "75 % (30 to 90)"),
        ("paper spin: held", "1 of 3 settings (1 undecided)"),
        ("paper spin: held; as count", "1 of 3 (1 undecided)"),
        ("paper spin: held; friction angle = 10 deg or 20 deg", "1 of 2 settings (1 undecided)"),
        ("paper spin: held; reading = later hits", "none of 1 setting"),
        ("paper spin: held; reading = first hits or later hits", "1 of 3 settings (1 undecided)"),
        ("paper spin: undecided", "1 of 3"),
        ("paper spin: settings", "3"),
        ("paper spin: there", "1 of 1 setting"),
        ("paper spin: elsewhere; as count", "none of 2 (1 undecided)"),
        (
            "paper spin: verdict",
            "not reproduced as shipped, though it holds in 1 of 3 settings (1 undecided)",
        ),
        ("paper spin: as shipped", "not reproduced"),
        ("paper spin: decided by", "friction angle 10 deg"),
        ("paper slope: decided by", "no choice"),
        ("paper spin: only if", "no condition"),
        ("paper time: only if", "time scheme (all) old"),
        ('paper spin: "begun at rest: #"', "443 rad/s (418 to 468)"),
        ('paper spin: "begun at rest: ..., # after 6 hits"', "1008 rad/s (977 to 1039)"),
        ('paper spin: "# heaps"', "37 of 68"),
        ('paper spin: "Locked #"', "1.2 to 1.3 m/s"),
        ("paper: runs", "2685"),
        ("paper: wall time; as minutes, 2 digits", "35 minutes"),
        ("paper: claims", "3"),
        ("paper: claims that a choice decides", "2"),
        ("paper: claims that hold only if", "1"),
        ('paper: "the spread is pooled over the settings"', "1"),
    ],
)
def test_forms_of_a_number(small: ModuleType, asked: str, shown: str) -> None:
    assert str(small.lookup(asked)) == shown


@pytest.mark.parametrize(
    ("asked", "fault"),
    [
        ("paper spinn: mean time", "no claim 'spinn'; nearest: 'spin'"),
        ("paper spin: meen time", "no number begins so of spin; nearest: 'mean time'"),
        ("paper spin: m", "more than one number begins so of spin"),
        (
            "paper spin: mean time; friction = 30 deg",
            "no choice 'friction' of spin; nearest: 'friction angle'",
        ),
        (
            "paper spin: mean time; reading = late hits",
            "no value 'late hits' of 'reading'; nearest: 'later hits'",
        ),
        ("paper spin: mean time; as hours", "no format 'hours' of a number in 's'"),
        ("paper spin: mean time; shortly", "write CHOICE = VALUE"),
        ("paper: rns", "no number 'rns' of a whole ledger; nearest: 'runs'"),
        ('paper spin: "begun at test: #"', "0 sentences of spin say so; nearest: 'begun at rest"),
        ("paper slope: there", "no choice decides slope"),
        ("paper spin: most time", "has no number there: 4 of 4 stand"),
    ],
)
def test_an_unknown_number_is_an_error_that_names_it_and_the_nearest(
    small: ModuleType, asked: str, fault: str
) -> None:
    with pytest.raises(small.UnknownNumber) as caught:
        small.lookup(asked)
    assert asked in str(caught.value) and fault in str(caught.value)


def test_an_unknown_ledger_is_an_error_that_names_the_nearest(cited: ModuleType) -> None:
    with pytest.raises(cited.UnknownNumber, match="no ledger 'papper'; nearest: 'paper'"):
        cited.lookup("papper spin: mean time")


def test_a_comment_at_the_beginning_of_a_line_is_refused(small: ModuleType) -> None:
    with pytest.raises(small.UnknownNumber, match="must not begin with a comment"):
        small.filled("They last\n<!-- paper spin: mean time --><!--/--> of it.")


def test_a_comment_without_its_end_and_an_end_alone_are_refused(small: ModuleType) -> None:
    with pytest.raises(small.UnknownNumber, match="but 0 comments"):
        small.filled("They last 0.996<!--/--> of it.")
    with pytest.raises(small.UnknownNumber, match="has no end"):
        small.filled("They last <!-- paper spin: mean time --> 0.996 of it.")
