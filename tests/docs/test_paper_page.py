"""The story page says of every claim what the kept ledger says."""

import re
from pathlib import Path

from ryusa.studies.osada2004.claims import CLAIMS
from ryusa.studies.osada2004.study import OF_KIND, PAPER
from ryusa.study.kept import read_ledger

DOCS = Path(__file__).parents[2] / "docs"


def page():
    """Claim -> verdict, as the table of the page has them."""
    whole = (DOCS / "paper.md").read_text(encoding="utf-8")
    lines = whole.partition("## Twice as many settings")[0].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
    return {row[0]: row[3] for row in cells if row[0] in CLAIMS}


def kept():
    """Claim -> verdict, as the kept ledger has them."""
    ledger = read_ledger(DOCS / "ledgers" / "paper.json.xz")
    return {one["id"]: one["verdict"] for one in ledger["findings"]}


def test_every_claim_stands_on_the_page_with_its_verdict():
    assert set(page()) == set(CLAIMS) == set(kept())
    for claim, verdict in kept().items():
        assert page()[claim].startswith(verdict), claim
    of_kind = {word for words in OF_KIND.values() for word in words.values()}
    assert set(kept().values()) <= {*PAPER.words.values(), *of_kind}


def test_the_kept_ledger_is_whole_and_says_where_it_came_from():
    ledger = read_ledger(DOCS / "ledgers" / "paper.json.xz")
    assert re.fullmatch(r"[0-9a-f]{40}", ledger["provenance"]["commit"])
    assert ledger["provenance"]["packages"]["numba"]
    assert not ledger["indicative"]
    assert not ledger["problems"]
