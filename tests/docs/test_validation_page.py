"""The page on validation says what the kept ledger says."""

import re
from html import unescape
from pathlib import Path

from ryusa.study import Level, Plan
from ryusa.study.ledger_file import as_registered, read_ledger
from ryusa.study.page import render
from ryusa_studies.validation.study import NAMES, VALIDATION, counted, load, table

DOCS = Path(__file__).parents[2] / "docs"


def kept():
    return as_registered(VALIDATION, read_ledger(DOCS / "ledgers" / "validation.json.xz"))


def test_the_table_of_the_page_is_that_of_the_kept_ledger():
    page = (DOCS / "validation.md").read_text(encoding="utf-8")
    assert table(kept()) in page
    assert counted(kept()) in page


def verdicts():
    """Row -> verdict on the page."""
    page = (DOCS / "validation.md").read_text(encoding="utf-8")
    lines = page.splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines if ": " in line[:60]]
    return {row[0].split(":")[0]: row[-1] for row in cells if len(row) == 5}


def test_hindered_settling_is_a_check_and_counted_among_no_verdicts():
    rows = verdicts()
    settling = [verdict for name, verdict in rows.items() if name.startswith("suspension/")]
    assert set(settling) == {"within (check)"}
    checks = [verdict for verdict in rows.values() if "(check)" in verdict]
    assert f"{len(checks)} checks, which all hold" in counted(kept())
    within = [one for one in rows.values() if one.startswith("within") and "(check)" not in one]
    assert f"{len(within)} *within*" in counted(kept())


def test_rows_whose_bands_were_changed_say_what_the_first_entry_gives():
    rows = verdicts()
    assert rows["transport/rate"] == "missed; within as first registered"
    for name in ("recoil", "spin", "recoil-inelastic", "tangential-restitution"):
        assert rows[f"hertz-oblique/{name}"] == "missed"  # by either


def test_the_page_of_a_run_has_both_verdicts_and_says_what_is_a_check(tmp_path):
    bare = {**kept(), "findings": [{**one, "pictures": []} for one in kept()["findings"]]}
    text = unescape(render(VALIDATION, bare, {}, tmp_path))
    assert "within</b> (check)" in text
    assert "missed</b>; within as first registered" in text
    assert "a check: the exponent follows from the hindrance" in text
    assert "until 2026-11-23 the same as first registered: from theta = 5" in text
    checks = [verdict for verdict in verdicts().values() if "(check)" in verdict]
    assert f"beside them {len(checks)} checks, which all hold" in text


def test_what_no_kept_run_can_judge_is_said_not_to_be_judged():
    page = (DOCS / "validation-bands.md").read_text(encoding="utf-8")
    (line,) = [one for one in page.splitlines() if "largest share held by 3 d_max after 2.5 s" in one]
    assert line.count("not judged") == 2


LATER = {"maurin"}  # parts that the next kept ledger has first


def test_the_kept_ledger_has_no_gap_and_says_where_it_came_from():
    ledger = kept()
    assert ledger["level"] in {"standard", "full"}
    assert not ledger["problems"] and not ledger["faults"]
    plan = Plan(Level(ledger["level"]), (1, 2, 3))
    parts = {one["part"] for one in ledger["findings"]}
    assert parts == {one for one in NAMES if load(one).tasks(plan)} - LATER, "parts with rows are not LATER"
    assert all(not one["verdict"].startswith("not judged") for one in ledger["findings"])
    assert re.fullmatch(r"[0-9a-f]{40}", ledger["provenance"]["commit"])


def test_what_is_missed_says_why():
    for one in kept()["findings"]:
        assert not one["verdict"].startswith("missed") or one["decided_by"], one["id"]
