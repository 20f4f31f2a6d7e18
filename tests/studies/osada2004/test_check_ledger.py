import runpy
from pathlib import Path

from ryusa.study import Outcome
from ryusa_studies.osada2004.claims import CLAIMS
from ryusa_studies.osada2004.study import PAPER

faults = runpy.run_path(str(Path(__file__).with_name("check_ledger.py")))["faults"]


ONE = {"holds": 0, "of": 1, "undecided": 0}


def whole():
    trial = {"part": "length", "value": 1.0, "note": "", "choices": {}}
    rows = [
        {
            "id": one, "outcome": "fails", "base_outcome": "fails", "condition": "",
            "verdict": f"{PAPER.word(one, Outcome.FAILS)} as shipped, the only setting",
            "registered": {"commit": "0" * 40}, "trials": [dict(trial)],
            "decided_by": "physics", "problem": "", "robustness": dict(ONE),
        }
        for one in CLAIMS
    ]  # fmt: skip
    return {"level": "quick", "findings": rows, "errors_in": [], "faults": {}, "log": ""}


def row(ledger, claim):
    return next(one for one in ledger["findings"] if one["id"] == claim)


def test_a_whole_ledger_has_no_fault():
    assert faults(whole()) == []


def test_what_is_missing_is_named():
    ledger = whole()
    ledger["findings"].remove(row(ledger, "fig5"))
    row(ledger, "fig4")["trials"] = []
    row(ledger, "fig7")["trials"][0]["value"] = None
    row(ledger, "fig8")["trials"] = []
    row(ledger, "fig11")["problem"] = "2 of 3 runs failed"
    row(ledger, "fig12")["decided_by"] = ""
    row(ledger, "fig14")["verdict"] = "fine"
    row(ledger, "fig16")["registered"] = None
    assert [one.split(":")[0] for one in faults(ledger)] == [
        "fig5", "fig4", "fig7", "fig8", "fig11", "fig12", "fig14", "fig16",
    ]  # fmt: skip


def test_a_second_reading_is_no_setting():
    ledger = whole()
    shear = row(ledger, "fig20-shear")
    shear["robustness"] = {"holds": 0, "of": 5, "undecided": 1}
    shear["verdict"] = "not reproduced as shipped, and in none of 5 settings (1 undecided)"
    assert faults(ledger) == ["fig20-shear: counts readings of the case as it ships as 5 settings"]
    assert faults(ledger | {"level": "standard"}) == []


def test_a_nan_needs_a_note():
    ledger = whole()
    row(ledger, "fig7")["trials"][0] |= {"value": None, "note": "stands as a wall"}
    assert faults(ledger) == []


def test_an_error_in_the_program_is_a_fault_even_with_complete_rows():
    ledger = whole() | {"errors_in": ["fig5: run drop 1"], "log": "ledger-errors.log"}
    assert faults(ledger) == ["fig5: run drop 1: error in the program, see ledger-errors.log"]
    assert faults(whole() | {"faults": {"fig5: its table": "KeyError"}}) == ["fig5: its table: KeyError"]
