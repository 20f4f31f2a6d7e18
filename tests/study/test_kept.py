"""Ledger files: whole, compressed, and of the format before."""

import json

import pytest

from ryusa.errors import ResultsError
from ryusa.study import Study
from ryusa.study.kept import as_registered, read_ledger, write_ledger
from ryusa.study.registration import Registration

PLAIN = {"format": 3, "study": "mine", "findings": [{"id": "one", "verdict": "holds"}]}


@pytest.mark.parametrize("name", ["ledger.json", "ledger.json.xz"])
def test_a_ledger_is_read_as_it_was_written(tmp_path, name):
    assert read_ledger(write_ledger(tmp_path / "deep" / name, PLAIN)) == PLAIN


def test_a_ledger_of_claims_of_format_1_is_read(tmp_path):
    trial = {"part": "length", "choices": {}, "value": 1.0, "outcome": "holds"}
    claim = {"id": "fig4", "verdict": "reproduced", "sweep": [trial], "experiment": "fig04", "spread": []}
    path = tmp_path / "old.json"
    path.write_text(json.dumps({"format": 1, "level": "full", "claims": [claim]}), encoding="utf-8")
    (one,) = read_ledger(path)["findings"]
    assert (one["part"], one["outcome"], one["trials"]) == ("fig04", "holds", [trial])
    assert (one["robustness"]["holds"], one["robustness"]["of"], one["readings"]) == (1, 1, [])


def of_format_2(held, **more):
    """A ledger of format 2 with one finding; its trials are of two readings."""
    trials = [
        {"part": "n", "choices": {"run": str(run), "pair": pair}, "value": 1.0, "outcome": outcome}
        for run, outcomes in enumerate(held)
        for pair, outcome in zip(("all", "free"), outcomes, strict=True)
    ]
    factor = {"choice": "pair", "holds_at": ["all"], "p": 0.01, "confirmed": 0.02, "halves_of": "seeds"}
    one = {
        "id": "one", "outcome": "holds only if", "verdict": "reproduced only if",
        "base_verdict": "reproduced", "condition": "pair all (9 of 9 settings, none of 4 others)",
        "trials": trials, "readings": ["pair"],
        "robustness": {"holds": 4, "of": 4, "undecided": 1, "low": 0.5, "high": 1.0},
        "deciding_factor": {**factor, "there": [9, 9], "elsewhere": [0, 4]}, "contradiction": "", **more,
    }  # fmt: skip
    return {"format": 2, "study": "mine", "findings": [one]}


def test_settings_of_a_ledger_of_format_2_are_counted_anew(tmp_path):
    held = [("undecided", "fails"), *[("holds", "fails")] * 4, ("fails", "undecided")]
    path = write_ledger(tmp_path / "old.json", of_format_2(held))
    before = path.read_bytes()
    (one,) = read_ledger(path)["findings"]
    assert (one["outcome"], one["base_outcome"], one["condition"]) == ("undecided", "undecided", "")
    share = one["robustness"]
    assert (share["holds"], share["of"], share["undecided"]) == (4, 6, 1)
    assert one["deciding_factor"]["words"] == (
        "pair all (4 of 6 settings, 1 undecided; none of 6 read otherwise, 1 undecided)"
    )
    assert path.read_bytes() == before


def test_a_condition_of_format_2_stays_where_its_settings_show_it(tmp_path):
    path = write_ledger(tmp_path / "old.json", of_format_2([("holds", "fails")] * 5))
    (one,) = read_ledger(path)["findings"]
    assert one["outcome"] == "holds only if"
    assert one["condition"] == "pair all (5 of 5 settings, none of 5 read otherwise)"
    shown = of_format_2([("holds", "fails")], outcome="excluded by its own equations", deciding_factor=None)
    (one,) = read_ledger(write_ledger(tmp_path / "new.json", shown))["findings"]
    assert one["outcome"] == one["base_outcome"] == "excluded by its own equations"


def test_a_ledger_of_comparisons_of_format_1_is_read(tmp_path):
    error = {"name": "rms", "value": 0.2, "unit": "m", "low": 0.0, "high": 0.1, "why": "a cell"}
    error["within"] = False
    row = {
        "id": "a/b", "check": "a", "verdict": "missed", "title": "A", "source": "s", "known": "closed form",
        "settings": {}, "problem": "", "errors": [error], "said": "why", "axes": ["x", "y"], "ours": [],
        "references": [], "beside": [], "picture": "pictures/a-b.png",
    }  # fmt: skip
    path = tmp_path / "old.json"
    path.write_text(json.dumps({"format": 1, "level": "full", "comparisons": [row]}), encoding="utf-8")
    (one,) = read_ledger(path)["findings"]
    assert (one["part"], one["outcome"], one["decided_by"]) == ("a", "fails", "why")
    assert one["trials"][0]["asked"] == {"low": 0.0, "high": 0.1, "unit": "m", "says": "a cell"}
    assert one["pictures"] == ["pictures/a-b.png"]


def test_a_kept_ledger_is_judged_by_a_band_that_is_newer_than_it(tmp_path):
    """The numbers stay; verdict, settings and words are those of the entry in force, the first is beside."""
    (tmp_path / "r.toml").write_text(
        """
[[claim]]
id = "one"
  [[claim.band]]
  part = "n"
  high = 2.0
  unit = "-"
  reason = "wide"
  date = 2026-01-02
  [[claim.band]]
  part = "n"
  high = 1.0
  unit = "-"
  reason = "narrow"
  date = 2026-01-03
  change = "the first cannot fail"
""",
        encoding="utf-8",
    )

    class Mine(Study):
        """A study with a registration."""

        registration = Registration.read(tmp_path / "r.toml")

        def part(self, name):
            raise NotImplementedError(name)

    asked = {"low": None, "high": 2.0, "unit": "-", "says": "wide"}
    number = {"part": "n", "choices": {}, "unit": "-", "asked": asked, "outcome": "holds", "note": ""}
    trials = [{**number, "value": 1.5, "low": 1.4, "high": 1.6}]
    entry = {**PLAIN["findings"][0], "outcome": "holds", "base_outcome": "holds", "trials": trials}
    old = {**PLAIN, "findings": [{**entry, "beside": [], "condition": "", "readings": []}]}
    (one,) = as_registered(Mine(), old)["findings"]
    assert (one["outcome"], one["verdict"]) == ("fails", "fails; holds as first registered")
    assert one["trials"][0]["asked"] == {"low": None, "high": 1.0, "unit": "-", "says": "narrow"}
    assert (one["robustness"]["holds"], one["robustness"]["of"]) == (0, 1)
    assert old["findings"][0]["trials"][0]["outcome"] == "holds"


@pytest.mark.parametrize("text", ["{", "[]", '{"format": 99}', '{"findings": []}'])
def test_a_file_that_is_not_a_ledger_is_refused(tmp_path, text):
    path = tmp_path / "ledger.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ResultsError, match="ledger"):
        read_ledger(path)


def test_a_damaged_compressed_ledger_is_refused(tmp_path):
    path = write_ledger(tmp_path / "ledger.json.xz", PLAIN)
    path.write_bytes(path.read_bytes()[:40])
    with pytest.raises(ResultsError, match="cannot be read as a ledger"):
        read_ledger(path)
