"""Ledger files: whole, compressed, of another format, and judged by newer bands."""

import json

import pytest

from ryusa.errors import ResultsError
from ryusa.study import Study
from ryusa.study.ledger_file import as_registered, read_ledger, write_ledger
from ryusa.study.registration import Registration

PLAIN = {"format": 3, "study": "mine", "findings": [{"id": "one", "verdict": "holds"}]}


@pytest.mark.parametrize("name", ["ledger.json", "ledger.json.xz"])
def test_a_ledger_is_read_as_it_was_written(tmp_path, name):
    assert read_ledger(write_ledger(tmp_path / "deep" / name, PLAIN)) == PLAIN


REGISTERED = """
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
"""
VALUES = {"holds": 0.5, "undecided": 1.0, "fails": 1.5}  # by what the narrow band says of them, +- 0.1
BY_WIDE = {"part": "n", "unit": "-", "asked": {"low": None, "high": 2.0, "unit": "-", "says": "wide"}}


def trial(outcome, **choices):
    """One number, with its outcome by the wide band, which holds all."""
    value = VALUES[outcome]
    ends = {"value": value, "low": value - 0.1, "high": value + 0.1}
    return {**BY_WIDE, **ends, "choices": choices, "outcome": "holds", "note": ""}


def judged_anew(folder, trials, **more):
    """A finding that the wide band judged, by the narrow one."""
    (folder / "r.toml").write_text(REGISTERED, encoding="utf-8")

    class Mine(Study):
        """A study with a registration."""

        registration = Registration.read(folder / "r.toml")

        def part(self, name):
            raise NotImplementedError(name)

    entry = {
        **PLAIN["findings"][0], "outcome": "holds", "base_outcome": "holds", "trials": trials, "beside": [],
        "condition": "", "readings": [], "deciding_factor": None, "contradiction": "", **more,
    }  # fmt: skip
    before = json.dumps(entry)
    (one,) = as_registered(Mine(), {**PLAIN, "findings": [entry]})["findings"]
    assert json.dumps(entry) == before
    return one


def of_two_readings(folder, held, **more):
    """A finding whose trials are of two readings, anew."""
    trials = [
        trial(outcome, run=str(run), pair=pair)
        for run, outcomes in enumerate(held)
        for pair, outcome in zip(("all", "free"), outcomes, strict=True)
    ]
    factor = {"choice": "pair", "holds_at": ["all"], "p": 0.01, "confirmed": 0.02, "halves_of": "seeds"}
    said = {
        "outcome": "holds only if", "condition": "pair all (9 of 9 settings, none of 4 others)",
        "readings": ["pair"], "robustness": {"holds": 4, "of": 4, "undecided": 1, "low": 0.5, "high": 1.0},
        "deciding_factor": {**factor, "there": [9, 9], "elsewhere": [0, 4]},
    }  # fmt: skip
    return judged_anew(folder, trials, **{**said, **more})


def test_settings_of_a_finding_are_counted_anew_with_its_band(tmp_path):
    held = [("undecided", "fails"), *[("holds", "fails")] * 4, ("fails", "undecided")]
    one = of_two_readings(tmp_path, held)
    assert (one["outcome"], one["base_outcome"], one["condition"]) == ("undecided", "undecided", "")
    share = one["robustness"]
    assert (share["holds"], share["of"], share["undecided"]) == (4, 6, 1)
    assert one["deciding_factor"]["words"] == (
        "pair all (4 of 6 settings, 1 undecided; none of 6 read otherwise, 1 undecided)"
    )


def test_a_condition_stays_where_the_settings_show_it_by_the_new_band(tmp_path):
    one = of_two_readings(tmp_path, [("holds", "fails")] * 5)
    assert one["outcome"] == "holds only if"
    assert one["condition"] == "pair all (5 of 5 settings, none of 5 read otherwise)"
    excluded = {"outcome": "excluded by its own equations", "deciding_factor": None}
    one = of_two_readings(tmp_path, [("holds", "fails")], **excluded)
    assert one["outcome"] == one["base_outcome"] == "excluded by its own equations"


def test_one_number_of_a_finding_is_counted_as_its_only_setting(tmp_path):
    one = judged_anew(tmp_path, [trial("holds")])
    assert (one["robustness"]["holds"], one["robustness"]["of"], one["readings"]) == (1, 1, [])


def test_a_kept_ledger_is_judged_by_a_band_that_is_newer_than_it(tmp_path):
    """The numbers stay; verdict, settings and words are those of the entry in force, the first is beside."""
    one = judged_anew(tmp_path, [trial("fails")])
    assert (one["outcome"], one["verdict"]) == ("fails", "fails; holds as first registered")
    assert one["trials"][0]["asked"] == {"low": None, "high": 1.0, "unit": "-", "says": "narrow"}
    assert (one["robustness"]["holds"], one["robustness"]["of"]) == (0, 1)


@pytest.mark.parametrize("form", [1, 2, 99])
def test_a_ledger_of_another_format_is_refused_with_both_formats(tmp_path, form):
    path = write_ledger(tmp_path / "ledger.json", {**PLAIN, "format": form})
    with pytest.raises(ResultsError, match=f"a ledger in format {form}, of another version; .* reads 3$"):
        read_ledger(path)


@pytest.mark.parametrize("text", ["{", "[]", '{"format": "1"}', '{"findings": []}'])
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
