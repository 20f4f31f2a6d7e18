"""The page on validation says what the kept ledger says."""

import re
from pathlib import Path

from ryusa.studies.validation.study import NAMES, load, table
from ryusa.study import Level, Plan
from ryusa.study.kept import read_ledger

DOCS = Path(__file__).parents[2] / "docs"


def kept():
    return read_ledger(DOCS / "ledgers" / "validation.json.xz")


def test_the_table_of_the_page_is_that_of_the_kept_ledger():
    assert table(kept()) in (DOCS / "validation.md").read_text(encoding="utf-8")


def test_the_kept_ledger_has_no_gap_and_says_where_it_came_from():
    ledger = kept()
    assert ledger["level"] in {"standard", "full"}
    assert not ledger["problems"] and not ledger["faults"]
    plan = Plan(Level(ledger["level"]), (1, 2, 3))
    assert {one["part"] for one in ledger["findings"]} == {one for one in NAMES if load(one).tasks(plan)}
    assert all(one["verdict"] != "not judged" for one in ledger["findings"])
    assert re.fullmatch(r"[0-9a-f]{40}", ledger["provenance"]["commit"])


def test_what_is_missed_says_why():
    for one in kept()["findings"]:
        assert one["verdict"] != "missed" or one["decided_by"], one["id"]
