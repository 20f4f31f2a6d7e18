"""The story page says of every claim what the kept ledger says."""

import re
from pathlib import Path

from ryusa.studies.osada2004.claims import CLAIMS
from ryusa.studies.osada2004.study import PAPER
from ryusa.study.kept import read_ledger

DOCS = Path(__file__).parents[2] / "docs"


def page():
    """Claim -> verdict, as the table of the page has them."""
    lines = (DOCS / "paper.md").read_text(encoding="utf-8").splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
    return {row[0]: row[3] for row in cells if row[0] in CLAIMS}


def kept():
    """Claim -> verdict, as the kept ledger has them."""
    ledger = read_ledger(DOCS / "ledgers" / "paper.json.xz")
    return {one["id"]: one["verdict"] for one in ledger["findings"]}


def newer():
    """Claims that the page names as newer than the kept ledger."""
    text = (DOCS / "paper.md").read_text(encoding="utf-8")
    found = re.search(r"Newer than the kept ledger: ([a-z0-9, -]+)\.", text)
    return set(found[1].split(", ")) if found else set()


def test_every_claim_stands_on_the_page_with_its_verdict():
    assert page() == kept()
    assert set(kept().values()) <= set(PAPER.words.values())


def test_the_kept_ledger_is_whole_and_says_where_it_came_from():
    ledger = read_ledger(DOCS / "ledgers" / "paper.json.xz")
    there = {one["id"] for one in ledger["findings"]}
    assert there | newer() == set(CLAIMS)
    assert not there & newer()
    assert re.fullmatch(r"[0-9a-f]{40}", ledger["provenance"]["commit"])
    assert ledger["provenance"]["packages"]["numba"]
    assert not ledger["indicative"]
    assert not ledger["problems"]
