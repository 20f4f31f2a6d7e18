"""Claims and their bands are written down before any run, and nothing else judges."""

import math
import subprocess
from pathlib import Path
from typing import Any

import pytest

from ryusa.study import Band, Finding, Trial, exact
from ryusa.study.entry import _trial
from ryusa.study.registration import Registration

TEXT = """
[[claim]]
id = "contact"
kind = "conjecture"
japanese = "接触時間は約7e-5秒"
translation = "the contact time is about 7e-5 s"
measured = "mean contact time"
  [[claim.band]]
  part = "mean contact time"
  low = 6e-5
  high = 8e-5
  unit = "s"
  reason = "about 7e-5 s"
  date = 2026-01-02
[[claim]]
id = "flow"
  [[claim.band]]
  part = "speed, slope * deg"
  low = 0.02
  unit = "-"
  reason = "flows"
  date = 2026-01-02
"""
LATER = """
  [[claim.band]]
  part = "mean contact time"
  low = 6.5e-5
  high = 7.5e-5
  unit = "s"
  reason = "about 7e-5 s: one digit"
  date = 2026-02-03
  change = "narrowed to one digit after a number was seen"
"""


def registered(tmp_path: Path, text: str = TEXT) -> Registration:
    (tmp_path / "registration.toml").write_text(text, encoding="utf-8")
    return Registration.read(tmp_path / "registration.toml")


def finding(claim: str, part: str, band: Band | None, value: float = 6.3e-5) -> Finding:
    return Finding(claim, (Trial(part, {"phi": "30 deg"}, exact(value, "s"), band),))


def plain_trials(found: Finding) -> list[dict[str, Any]]:
    """Trials as a ledger has them."""
    return [_trial(one) for one in found.trials]


def test_a_band_that_is_registered_may_judge_and_no_other(tmp_path: Path) -> None:
    both = registered(tmp_path)
    both.check(finding("contact", "mean contact time", Band(6e-5, 8e-5, "s", "other words")))
    both.check(finding("flow", "speed, slope 21 deg", Band(0.02, float("inf"), "-", "")))
    both.check(finding("flow", "something shown", None))
    with pytest.raises(
        ValueError, match=r"judged by 6.5e-05 to 7.5e-05 s, but registered is 6e-05 to 8e-05 s"
    ):
        both.check(finding("contact", "mean contact time", Band(6.5e-5, 7.5e-5, "s", "")))
    with pytest.raises(ValueError, match=r"but registered is at least 0.02"):
        both.check(finding("flow", "speed, slope 21 deg", Band(0.02, 1.0, "-", "")))
    with pytest.raises(ValueError, match=r'"largest contact time" is judged by .* which is not registered'):
        both.check(finding("contact", "largest contact time", Band(6e-5, 8e-5, "s", "")))
    with pytest.raises(ValueError, match=r"heap is not registered, so it is not judged"):
        both.check(finding("heap", "slope", Band(30.0, 36.0, "deg", "")))


def test_a_band_that_was_replaced_judges_no_more_but_its_verdict_is_shown(tmp_path: Path) -> None:
    first, rest = TEXT.split('[[claim]]\nid = "flow"')
    both = registered(tmp_path, first + LATER + '[[claim]]\nid = "flow"' + rest)
    late = finding("contact", "mean contact time", Band(6.5e-5, 7.5e-5, "s", ""))
    both.check(late)
    with pytest.raises(ValueError, match=r"but registered is 6\.5e-05"):
        both.check(finding("contact", "mean contact time", Band(6e-5, 8e-5, "s", "")))
    plain = both.plain("contact", plain_trials(late))
    assert plain is not None
    (earlier,) = plain["earlier"]
    assert (earlier["limits"], earlier["outcome"]) == ("6e-05 to 8e-05 s", "holds")
    assert (earlier["date"], earlier["replaced"]) == ("2026-01-02", "2026-02-03")
    assert "after a number was seen" in earlier["why"]
    assert plain["kind"] == "conjecture"
    assert plain["first"] == "holds"


SLIDES = """
[[claim]]
id = "impact/recoil"
  [[claim.band]]
  part = "sliding branch"
  number = "sliding branch, from 5"
  high = 0.02
  unit = "-"
  reason = "from 5"
  date = 2026-01-02
  [[claim.band]]
  part = "sliding branch"
  high = 0.1
  unit = "-"
  reason = "from 6"
  date = 2026-01-03
  change = "after the first run"
  [[claim.band]]
  part = "closes"
  high = 1e-9
  unit = "-"
  reason = "round-off"
  date = 2026-01-02
  check = "a sum of the same numbers"
  [[claim.changed]]
  text = "sample"
  date = 2026-01-04
  was = "three runs"
  why = "undecided"
[[claim]]
id = "settling/*"
  [[claim.band]]
  part = "*: error of n"
  high = 0.1
  unit = "-"
  reason = "round-off"
  date = 2026-01-02
  check = "the exponent is put in"
"""
LATE = Band(-math.inf, 0.1, "-", "from 6")


def impact(slides: float, first: float | None) -> Finding:
    trials = [Trial("sliding branch", {}, exact(slides, "-"), LATE)]
    trials += [Trial("sliding branch, from 5", {}, exact(first, "-"), None)] if first is not None else []
    return Finding("recoil", (*trials, Trial("closes", {}, exact(0.0, "-"), Band(-math.inf, 1e-9, "-", ""))))


@pytest.mark.parametrize(
    ("slides", "first", "outcome"),
    [(0.05, 0.5, "fails"), (0.05, 0.01, "holds"), (0.05, None, "not judged"), (0.5, 0.5, "fails")],
)
def test_a_first_entry_judges_the_number_that_it_was_written_for(
    slides: float, first: float | None, outcome: str, tmp_path: Path
) -> None:
    found = impact(slides, first)
    both = registered(tmp_path, SLIDES)
    both.check(found, "impact/recoil")
    plain = both.plain("impact/recoil", plain_trials(found))
    assert plain is not None
    (earlier,) = plain["earlier"]
    assert earlier["number"] == "sliding branch, from 5"
    assert (earlier["outcome"], plain["first"]) == (outcome, outcome)
    assert (plain["checks"], plain["check"]) == ({"closes": "a sum of the same numbers"}, False)
    (changed,) = plain["changed"]
    assert (changed["text"], changed["was"], changed["effect"]) == ("sample", "three runs", "")


def test_a_finding_all_of_whose_numbers_are_checks_is_one(tmp_path: Path) -> None:
    found = Finding("stokes", (Trial("power: error of n", {}, exact(0.0, "-"), LATE),))
    plain = registered(tmp_path, SLIDES).plain("settling/stokes", plain_trials(found))
    assert plain is not None
    assert plain["check"]
    assert not plain["first"]
    assert registered(tmp_path, SLIDES).plain("heap/slope", plain_trials(found)) is None


def test_a_registration_of_what_was_changed_alone_leaves_other_bands_to_the_code(tmp_path: Path) -> None:
    (tmp_path / "some.toml").write_text(SLIDES, encoding="utf-8")
    some = Registration.read(tmp_path / "some.toml", whole=False)
    some.check(impact(0.05, 0.5), "impact/recoil")
    other = Finding("recoil", (Trial("sticking branch", {}, exact(1.0, "-"), LATE),))
    some.check(other, "impact/recoil")
    some.check(other, "impact/spin")
    with pytest.raises(ValueError, match=r"judged by at most 0\.2, but registered is at most 0\.1"):
        wider = Trial("sliding branch", {}, exact(0.05, "-"), Band(-math.inf, 0.2, "-", ""))
        some.check(Finding("recoil", (wider,)), "impact/recoil")


def test_an_entry_may_take_a_number_out_of_the_verdict(tmp_path: Path) -> None:
    shown = """
  [[claim.band]]
  part = "mean contact time"
  judged = false
  date = 2026-02-03
  change = "from memory"
"""
    first, rest = TEXT.split('[[claim]]\nid = "flow"')
    both = registered(tmp_path, first + shown + '[[claim]]\nid = "flow"' + rest)
    part = "mean contact time"
    both.check(finding("contact", part, None))
    with pytest.raises(ValueError, match=r"but registered is shown only"):
        both.check(finding("contact", part, Band(6e-5, 8e-5, "s", "")))
    plain = both.plain("contact", plain_trials(finding("contact", part, None)))
    assert plain is not None
    assert (plain["earlier"][0]["outcome"], plain["first"]) == ("holds", "holds")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('unit = "s"\n', ""), "a band needs unit"),
        (("low = 6e-5", "low = 9e-5"), "low = 9e-05 and high = 8e-05 are no band"),
        (("low = 6e-5", "lower = 6e-5"), "lower is no key; allowed are"),
        (('kind = "conjecture"', 'kind = "guess"'), "must be one of claim, conjecture, proposal"),
        (('id = "flow"', 'id = "contact"'), "contact occurs twice"),
        (('kind = "conjecture"', "judged = false"), "says in why_not why it is not"),
        (("high = 8e-5", "high = 8e-5\njudged = false"), "a band needs change"),
        (
            ('[[claim]]\nid = "flow"', '[[claim]]\nid = "flow"\n[[claim.changed]]\ntext = "test"'),
            "needs date, was",
        ),
    ],
)
def test_a_registration_that_is_not_clear_is_refused(
    change: tuple[str, str], words: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=words):
        registered(tmp_path, TEXT.replace(*change))


def test_the_commit_is_named_and_says_when_the_file_is_not_committed(tmp_path: Path) -> None:
    def git(*words: str) -> str:
        who = ["-c", "user.name=a", "-c", "user.email=a@b.c"]
        return subprocess.run(
            ["git", "-C", str(tmp_path), *who, *words], check=True, capture_output=True, text=True
        ).stdout.strip()

    assert registered(tmp_path).commits["contact"] is None
    git("init", "-q")
    git("add", ".")
    git("commit", "-qm", "Register")
    first = git("rev-parse", "HEAD")
    assert registered(tmp_path).commits["contact"] == first
    (tmp_path / "other").write_text("1")
    git("add", ".")
    git("commit", "-qm", "Something else")
    assert registered(tmp_path).commits["contact"] == first
    assert registered(tmp_path, TEXT + "\n").commits["contact"] == first + "+"
