"""The story page says of every claim what the kept ledger says."""

import re
from html import unescape
from pathlib import Path

import pytest

from ryusa.study.ledger_file import as_registered, read_ledger
from ryusa.study.page import render
from ryusa_studies.osada2004.claims import CLAIMS
from ryusa_studies.osada2004.study import PAPER

DOCS = Path(__file__).parents[2] / "docs"
SHARE = re.compile(r"(none|\d+) of (\d+) settings( \((\d+) undecided\))?")
LEDGERS = ("paper.json.xz", "paper-full.json.xz")
# Registered after the runs of the kept ledgers: the page has no row of them until the next ledgers are kept.
LATER = {"rolling-blind"}


def page():
    """Claim -> verdict, as the table of the page has them."""
    whole = (DOCS / "paper.md").read_text(encoding="utf-8")
    lines = whole.partition("## Twice as many settings")[0].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
    return {row[0]: row[3] for row in cells if row[0] in CLAIMS}


def kept(name=LEDGERS[0]):
    """Claim -> finding, as the kept ledger has them."""
    return {one["id"]: one for one in of_today(name)["findings"]}


def of_today(name):
    """The kept ledger, judged by the bands that are in force."""
    return as_registered(PAPER, read_ledger(DOCS / "ledgers" / name))


def settings_of(finding):
    """Settings that were run, by the choices that are no reading of the same runs."""
    return {
        tuple(item for item in one["choices"].items() if item[0] not in finding["readings"])
        for one in finding["trials"]
        if one["outcome"] != "shown"
    }


def test_every_claim_stands_on_the_page_with_its_verdict():
    assert set(page()) == set(kept()) == set(CLAIMS) - LATER, "claims that have a row are no longer LATER"
    assert set(CLAIMS) > LATER
    for claim, finding in kept().items():
        assert page()[claim] == str(PAPER.said(finding)), claim


@pytest.mark.parametrize("name", LEDGERS)
def test_every_verdict_names_all_settings_that_were_run_and_the_undecided_ones(name):
    for claim, finding in kept(name).items():
        n = len(settings_of(finding))
        said = PAPER.said(finding)
        if n < 2:
            assert said.share == (", the only setting" if n else ""), claim
            continue
        holds, of, _, undecided = SHARE.search(said.share).groups()
        assert int(of) == n, claim
        outcomes = [one["outcome"] for one in finding["trials"]]
        assert (undecided is not None) <= ("undecided" in outcomes), claim
        assert 0 <= int(holds.replace("none", "0")) <= n - int(undecided or 0), claim


@pytest.mark.parametrize("name", LEDGERS)
def test_no_share_of_a_claim_counts_more_settings_than_were_run(name):
    factors = [(one, one["deciding_factor"]) for one in kept(name).values() if one["deciding_factor"]]
    assert factors
    for finding, factor in factors:
        n = len(settings_of(finding))
        for share in (factor["there"], factor["elsewhere"]):
            assert share["holds"] + share["undecided"] <= share["of"] <= n, finding["id"]
        for of in re.findall(r"of (\d+)", factor["words"]):
            assert int(of) <= n, finding["id"]


@pytest.mark.parametrize("name", LEDGERS)
def test_only_if_is_said_of_no_claim_that_is_undecided_as_shipped(name):
    for claim, one in kept(name).items():
        if one["base_outcome"] == "undecided":
            assert "only if" not in str(PAPER.said(one)), claim
    assert kept(name)["film-debris"]["base_outcome"] == "undecided"


def test_both_levels_give_a_claim_one_verdict():
    """Of the free debris flow the levels said two things before undecided settings were counted."""
    few, many = (kept(name)["fig17-free"] for name in LEDGERS)
    assert few["outcome"] == many["outcome"] == "holds"


@pytest.mark.parametrize("name", LEDGERS)
def test_no_verdict_on_the_page_of_a_kept_ledger_lacks_its_share(name, tmp_path):
    plain = of_today(name)
    bare = {**plain, "findings": [{**one, "pictures": []} for one in plain["findings"]]}
    text = render(PAPER, bare, {}, tmp_path)
    verdicts = re.findall(r'<b class="word [^"]*">(.*?)</b>(.*?)(?:</td>|</span>|\. )', text, re.DOTALL)
    assert len(verdicts) >= 2 * len(plain["findings"])  # in the table, and in its section
    said = {str(PAPER.said(one)) for one in plain["findings"]}
    for headline, share in verdicts:
        words = unescape(headline).partition(" ")[2]  # without the sign
        assert words == "shown" or "the only setting" in share or SHARE.search(share), words
        assert any(one.startswith(words) and unescape(share) in one for one in said)


def test_the_kept_ledger_is_whole_and_says_where_it_came_from():
    ledger = read_ledger(DOCS / "ledgers" / "paper.json.xz")
    assert re.fullmatch(r"[0-9a-f]{40}", ledger["provenance"]["commit"])
    assert ledger["provenance"]["packages"]["numba"]
    assert not ledger["indicative"]
    assert not ledger["problems"]
