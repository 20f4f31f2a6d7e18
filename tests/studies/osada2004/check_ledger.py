"""Name what is missing in a ledger of `ryusa paper`: `python check_ledger.py FILE`."""

import sys
from pathlib import Path

from ryusa.study.ledger_file import read_ledger
from ryusa_studies.osada2004.claims import CLAIMS
from ryusa_studies.osada2004.study import PAPER


def faults(ledger):
    """Sentences, none for a ledger that is whole."""
    rows = {one["id"]: one for one in ledger["findings"]}
    found = [f"{claim}: has no row" for claim in CLAIMS if claim not in rows]
    found += [f"{what}: error in the program, see {ledger['log']}" for what in ledger["errors_in"]]
    found += [f"{what}: {words}" for what, words in ledger["faults"].items()]
    for name, row in rows.items():
        if row["problem"]:
            found.append(f"{name}: {row['problem']}")
        else:
            found += [f"{name}: {fault}" for fault in _of_row(row)]
        count = row["robustness"]["of"]
        if ledger["level"] == "quick" and count > 1:
            found.append(f"{name}: counts readings of the case as it ships as {count} settings")
    return found


def _of_row(row):
    if row["verdict"] != str(PAPER.said(row)):
        yield f"verdict {row['verdict']!r} is not what its numbers say"
    if row["registered"] is None:
        yield "is judged without a registration"
    if not row["trials"]:
        yield "has no number"
    for one in row["trials"]:
        if one["choices"] == row["trials"][0]["choices"] and one["value"] is None and not one["note"]:
            yield f"{one['part']}: no number, and no note that says why"
    if not row["decided_by"]:
        yield "does not say what decides it"


if __name__ == "__main__":
    said = faults(read_ledger(Path(sys.argv[1])))
    print("\n".join(said) or f"{sys.argv[1]}: every claim has its row, and its numbers")
    sys.exit(1 if said else 0)
