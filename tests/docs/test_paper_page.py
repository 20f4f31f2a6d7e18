"""The story page says of every claim what the kept ledger says."""

import json
import re
from pathlib import Path

from ryusa.studies.osada2004 import Word
from ryusa.studies.osada2004.paper import CLAIMS

DOCS = Path(__file__).parents[2] / "docs"


def page():
    """Claim -> verdict, as the table of the page has them."""
    lines = (DOCS / "paper.md").read_text(encoding="utf-8").splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
    return {row[0]: row[3] for row in cells if row[0] in CLAIMS}


def kept():
    """Claim -> verdict, as the kept ledger has them."""
    ledger = json.loads((DOCS / "paper-ledger.json").read_text(encoding="utf-8"))
    return {one["id"]: one["verdict"] for one in ledger["claims"]}


def test_every_claim_stands_on_the_page_with_its_verdict():
    assert page() == kept()
    assert set(kept().values()) <= set(Word)


def test_the_kept_ledger_is_whole_and_says_where_it_came_from():
    ledger = json.loads((DOCS / "paper-ledger.json").read_text(encoding="utf-8"))
    assert {one["id"] for one in ledger["claims"]} == set(CLAIMS)
    assert re.fullmatch(r"[0-9a-f]{40}", ledger["provenance"]["commit"])
    assert ledger["provenance"]["packages"]["numba"]
    assert not ledger["indicative"]
    assert not ledger["problems"]
