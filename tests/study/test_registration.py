"""Claims and their bands are written down before any run, and nothing else judges."""

import subprocess
from pathlib import Path

import pytest

from ryusa.study import Band, Finding, Trial, exact
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
    (earlier,) = both.plain(late)["earlier"]
    assert (earlier["limits"], earlier["outcome"]) == ("6e-05 to 8e-05 s", "holds")
    assert (earlier["date"], earlier["replaced"]) == ("2026-01-02", "2026-02-03")
    assert "after a number was seen" in earlier["why"]
    assert both.plain(late)["kind"] == "conjecture"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('unit = "s"\n', ""), "a band needs unit"),
        (("low = 6e-5", "low = 9e-5"), "low = 9e-05 and high = 8e-05 are no band"),
        (("low = 6e-5", "lower = 6e-5"), "lower is no key; allowed are"),
        (('kind = "conjecture"', 'kind = "guess"'), "must be one of claim, conjecture, proposal"),
        (('id = "flow"', 'id = "contact"'), "contact occurs twice"),
        (('kind = "conjecture"', "judged = false"), "says in why_not why it is not"),
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
