"""Say what is missing in a ledger that `ryusa paper` wrote: `python tests/report/check_ledger.py FILE`."""

import json
import sys
from pathlib import Path

from ryusa.studies.osada2004 import Word
from ryusa.studies.osada2004.paper import CLAIMS


def faults(ledger):
    """Sentences, none for a ledger that is whole."""
    rows = {one["id"]: one for one in ledger["claims"]}
    found = [f"{claim}: has no row" for claim in CLAIMS if claim not in rows]
    found += [f"{what}: error in the program, see {ledger['log']}" for what in ledger["errors_in"]]
    found += [f"{what}: {words}" for what, words in ledger["faults"].items()]
    for name, row in rows.items():
        if row["problem"]:
            found.append(f"{name}: {row['problem']}")
        else:
            found += [f"{name}: {fault}" for fault in _of_row(row)]
    return found


def _of_row(row):
    if row["verdict"] not in set(Word):
        yield f"verdict {row['verdict']!r} is none of ours"
    if not row["spread"]:
        yield "has no number"
    base = [one for one in row["sweep"] if one["choices"] == row["sweep"][0]["choices"]]
    for part, one in zip(base, row["spread"], strict=False):
        if one["value"] is None and not part["note"]:
            yield f"{part['part']}: no number, and no note that says why"
    if not row["decided_by"]:
        yield "does not say what decides it"


if __name__ == "__main__":
    said = faults(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
    print("\n".join(said) or f"{sys.argv[1]}: every claim has its row, and its numbers")
    sys.exit(1 if said else 0)
