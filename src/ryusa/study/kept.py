"""Reading and writing of ledger files, compressed if their name ends in .xz; older formats are read too."""

import json
import lzma
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ryusa.errors import ResultsError
from ryusa.running.disk import write_atomically
from ryusa.study.ledger import FORMAT

COMPRESSED = ".xz"
# Verdicts of format 1 and their outcomes.
_OUTCOMES = {
    "reproduced": "holds",
    "within": "holds",
    "reproduced only if": "holds only if",
    "not reproduced": "fails",
    "missed": "fails",
    "contradicts its own equations": "excluded by its own equations",
    "shown": "shown",
}


def write_ledger(path: Path, plain: Mapping[str, Any]) -> Path:
    """Write a ledger; the file appears complete or not at all.

    Raises
    ------
    OSError : it cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == COMPRESSED:
        short = json.dumps(plain, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
        data = lzma.compress(short.encode(), preset=9 | lzma.PRESET_EXTREME)
    else:
        data = (json.dumps(plain, indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()
    write_atomically(path, data)
    return path


def read_ledger(path: Path) -> dict[str, Any]:
    """Read a ledger of any study, as JSON or compressed, and return it in format 2.

    Raises
    ------
    ResultsError : the file is not a ledger, is damaged, or has a later format.
    """
    try:
        data = path.read_bytes()
        plain: Any = json.loads(lzma.decompress(data) if path.suffix == COMPRESSED else data)
    except (OSError, ValueError, lzma.LZMAError, EOFError) as error:
        raise ResultsError(f"{path}: cannot be read as a ledger ({error})") from None
    if not isinstance(plain, dict) or plain.get("format") not in range(1, FORMAT + 1):
        known = f"formats 1 to {FORMAT}"
        raise ResultsError(f"{path}: is no ledger of ryusa, or of a later version (this one reads {known})")
    if plain["format"] == 1:
        return _of_claims(plain) if "claims" in plain else _of_comparisons(plain)
    return plain


def _of_claims(old: Mapping[str, Any]) -> dict[str, Any]:
    """Convert format 1 of the ledger of the paper."""
    findings = [
        {
            **{key: value for key, value in one.items() if key not in {"sweep", "experiment", "spread"}},
            "part": one["experiment"],
            "title": "",
            "outcome": _OUTCOMES.get(one["verdict"], "undecided"),
            "source": "",
            "known": "",
            "trials": one["sweep"],
            "chart": None,
        }
        for one in old["claims"]
    ]
    kept = {key: value for key, value in old.items() if key != "claims"}
    return {**kept, "format": FORMAT, "study": "paper", "findings": findings}


def _of_comparisons(old: Mapping[str, Any]) -> dict[str, Any]:
    """Convert format 1 of the ledger of the validation."""
    findings = [
        {
            **{key: one[key] for key in ("id", "verdict", "title", "source", "known", "settings", "problem")},
            "part": one["check"],
            "outcome": _OUTCOMES.get(one["verdict"], "undecided"),
            "condition": "",
            "counts": {},
            "trials": [_trial_of_error(each) for each in one["errors"]],
            "beside": [],
            "decided_by": one["said"],
            "contradiction": "",
            "also": [],
            "chart": {key: one[key] for key in ("axes", "ours", "references", "beside")},
            "pictures": [one["picture"]] if one["picture"] else [],
        }
        for one in old["comparisons"]
    ]
    kept = {key: value for key, value in old.items() if key != "comparisons"}
    return {
        **kept, "format": FORMAT, "study": "validation", "indicative": old["level"] == "quick", "seeds": [],
        "findings": findings,
    }  # fmt: skip


def _trial_of_error(error: Mapping[str, Any]) -> dict[str, Any]:
    asked = {"low": error["low"], "high": error["high"], "unit": error["unit"], "says": error["why"]}
    return {
        "part": error["name"],
        "choices": {},
        **dict.fromkeys(("value", "low", "high"), error["value"]),
        "unit": error["unit"],
        "n": 1,
        "how": "one number, no interval",
        "asked": None if error["within"] is None else asked,
        "outcome": {True: "holds", False: "fails", None: "shown"}[error["within"]],
        "note": "",
    }
