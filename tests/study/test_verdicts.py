"""Verdicts of two ledgers beside each other."""

import pytest

from ryusa.errors import ResultsError
from ryusa.study.verdicts import against, changed, contradictions

WORDS = {"holds": "within", "fails": "missed", "undecided": "undecided", "shown": "shown"}


def ledger(study="validation", seeds=(), **outcomes):
    rows = [
        {"id": name, "part": name.split("_")[0], "outcome": one, "verdict": WORDS[one]}
        for name, one in outcomes.items()
    ]
    made = {"made": "2026-11-21T15:53:26+00:00", "commit": "280cee4"}
    return {"study": study, "level": "full", "seeds": list(seeds), "findings": rows, "provenance": made}


def test_a_verdict_that_became_open_has_changed_but_contradicts_nothing():
    old, new = ledger(gas="holds", frey_6="fails"), ledger(gas="undecided", frey_6="fails")
    assert changed(old, new) == [{"id": "gas", "old": "within", "new": "undecided"}]
    assert contradictions(old, new) == []


def test_two_decided_verdicts_that_differ_contradict_each_other():
    one, other = ledger(gas="holds", frey_6="fails"), ledger(gas="fails", frey_6="shown")
    assert contradictions(one, other) == [{"id": "gas", "old": "within", "new": "missed"}]


def test_a_finding_of_one_ledger_alone_is_listed():
    old, new = ledger(gas="holds", gas_old="holds"), ledger(gas="holds", gas_new="shown")
    assert changed(old, new) == [
        {"id": "gas_new", "old": "none", "new": "shown"},
        {"id": "gas_old", "old": "within", "new": "none"},
    ]


def test_only_the_parts_that_were_run_are_compared():
    found = against(ledger(gas="holds", frey_6="fails", seeds=(1, 2)), ledger(gas="fails"))
    assert found["changed"] == [{"id": "gas", "old": "within", "new": "missed"}]
    assert found["contradictions"] == ["gas"]
    assert (found["seeds"], found["commit"], found["level"]) == ([1, 2], "280cee4", "full")


def test_ledgers_of_different_studies_are_not_compared():
    with pytest.raises(ResultsError, match="'paper', not of 'validation'"):
        against(ledger(study="paper", gas="holds"), ledger(gas="holds"))
