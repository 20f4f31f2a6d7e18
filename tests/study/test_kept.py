"""Ledger files: whole, compressed, and of the format before."""

import json

import pytest

from ryusa.errors import ResultsError
from ryusa.study.kept import read_ledger, write_ledger

PLAIN = {"format": 2, "study": "mine", "findings": [{"id": "one", "verdict": "holds"}]}


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
