"""Reading and writing of ledger files, compressed if their name ends in .xz; older formats are read too."""

import json
import lzma
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from ryusa.errors import ResultsError
from ryusa.running.disk import write_atomically
from ryusa.study.judge import Outcome, base_outcome_of, outcome_of
from ryusa.study.ledger import FORMAT
from ryusa.study.origin import json_number
from ryusa.study.registration import RegisteredBand, RegisteredClaim, outcome_by
from ryusa.study.said import plain_count, plain_effect
from ryusa.study.study import Study
from ryusa.study.verdict import Effect, first_reading, held_of, robustness, settings_within

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
    """Read a ledger of any study, as JSON or compressed, and return it in format 3.

    What an older one says of settings is counted anew from its trials; its file is not changed.

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
        plain = _of_claims(plain) if "claims" in plain else _of_comparisons(plain)
    if plain["format"] < FORMAT:
        return {**plain, "format": FORMAT, "findings": [_of_settings(one) for one in plain["findings"]]}
    return plain


def kept_at(path: Path, study: Study, level: str) -> dict[str, Any] | None:
    """The ledger that findings of some parts are to be put into; None if there is no such file yet.

    Raises
    ------
    ResultsError : the file is no ledger, or one of another study or level.
    """
    if not path.exists():
        return None
    kept = read_ledger(path)
    if (kept["study"], kept["level"]) != (study.name, level):
        raise ResultsError(
            f"{path} is the ledger of '{kept['study']}' at level {kept['level']}; parts of '{study.name}' at "
            f"level {level} have no place in it: name another file"
        )
    return kept


def joined(study: Study, kept: Mapping[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
    """A kept ledger with the parts of a new one in place of its own, and where each of these came from.

    What the kept ledger says of code, machine and runs stays true of its other parts; that of the new parts
    stands in `provenance["parts"]`, by name of the part.
    """
    parts = dict.fromkeys(one["part"] for one in new["findings"])
    by_id = {one["id"]: one for one in kept["findings"] if one["part"] not in parts}
    by_id |= {one["id"]: one for one in new["findings"]}
    own_seeds = {} if new["seeds"] == kept["seeds"] else dict.fromkeys(parts, new["seeds"])
    whole = {**new, "seeds": kept["seeds"], "indicative": kept["indicative"] or new["indicative"]}
    for key, added in (("more_seeds", {**own_seeds, **new["more_seeds"]}), ("too_long_minutes", {})):
        whole[key] = _of_others(kept.get(key, {}), parts) | {**added, **new[key]}
    whole["faults"] = _of_others(kept["faults"], parts) | new["faults"]
    whole["errors_in"] = [*_of_others(dict.fromkeys(kept["errors_in"]), parts), *new["errors_in"]]
    failed = any(one["problem"] for one in kept["findings"] if one["part"] not in parts)
    whole["problems"] = {**(kept["problems"] if failed else {}), **new["problems"]}
    origin = {key: value for key, value in new["provenance"].items() if key != "packages"}
    earlier = kept["provenance"].get("parts", {})
    whole["provenance"] = {**kept["provenance"], "parts": {**earlier, **dict.fromkeys(parts, origin)}}
    place = {name: at for at, name in enumerate(study.parts)}
    inside = sorted(by_id, key=lambda one: place.get(by_id[one]["part"], len(place)))
    return {**whole, "findings": [by_id[one] for one in study.order(inside)]}


def _of_others(said: Mapping[str, Any], parts: Iterable[str]) -> dict[str, Any]:
    """What is said by name of a part ("fig19", "fig19: its tasks"), of parts other than these."""
    return {name: value for name, value in said.items() if name.partition(":")[0] not in parts}


def as_registered(study: Study, plain: Mapping[str, Any]) -> dict[str, Any]:
    """A ledger with its numbers judged by the bands that are in force now, and by those that were replaced.

    The numbers stay as they are; a band that is newer than the ledger judges those that the ledger has.
    """
    return {**plain, "findings": [_judged_anew(study, one) for one in plain["findings"]]}


def _judged_anew(study: Study, entry: Mapping[str, Any]) -> dict[str, Any]:
    claim = None if study.registration is None else study.registration.of(entry["id"])
    if claim is None:
        return dict(entry)
    trials = [_by_band_in_force(claim, one) for one in entry["trials"]]
    if trials != entry["trials"]:
        entry = _of_settings({**entry, "trials": trials})
    now = {**entry, "registered": study.registered(entry)}
    return {**now, "verdict": str(study.said(now))}


def _by_band_in_force(claim: RegisteredClaim, trial: Mapping[str, Any]) -> dict[str, Any]:
    """A trial with the band in force; one that was shown stays so, for its seeds may not suffice."""
    entries = claim.entries(trial["part"])
    if trial["asked"] is None or not entries:
        return dict(trial)
    band = entries[-1].band
    if band is None:
        return {**trial, "asked": None, "outcome": str(Outcome.SHOWN)}
    ends = {"low": json_number(band.low), "high": json_number(band.high)}
    if all(ends[end] == trial["asked"][end] for end in ends):
        return dict(trial)
    outcome = outcome_by(RegisteredBand(trial["part"], band, ""), trial["part"], {trial["part"]: trial})
    return {**trial, "asked": {**ends, "unit": band.unit, "says": band.says}, "outcome": outcome}


def _of_settings(entry: Mapping[str, Any]) -> dict[str, Any]:
    """Convert an entry of format 2: its outcome and settings are counted anew from its trials.

    Format 2 left undecided settings out of the shares, counted readings of the same runs as settings in
    conditions, and said "only if" of cases that are undecided as they ship. The choice that decides is kept,
    because it follows from single seeds, which no ledger has.
    """
    held, readings = held_of(entry["trials"]), tuple(entry.get("readings", ()))
    excluded = entry["outcome"] == Outcome.EXCLUDED
    base = Outcome.EXCLUDED if excluded else base_outcome_of(held, bool(entry["trials"]))
    old, factor, effect = entry.get("deciding_factor"), None, None
    if old and "confirmed" in old:  # without it nothing had confirmed the levels
        levels = tuple(old["holds_at"])
        shares = settings_within(held, old["choice"], levels, readings)
        effect = Effect(old["choice"], old["p"], levels, *shares, old["confirmed"], old["choice"] in readings)
        tried = list(dict.fromkeys(dict(key)[old["choice"]] for key in held))
        factor = plain_effect(effect, tried, old["halves_of"])
    outcome = outcome_of(base, effect)
    every = robustness(list(first_reading(held, readings).values()))
    return {
        **{key: value for key, value in entry.items() if key != "base_verdict"},
        "outcome": str(outcome),
        "base_outcome": str(base),
        "condition": factor["words"] if factor and outcome is Outcome.ONLY_IF else "",
        "robustness": {**plain_count(every), "low": every.low, "high": every.high},
        "readings": list(readings),
        "deciding_factor": factor,
    }


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
    return {**kept, "format": 2, "study": "paper", "findings": findings}


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
        **kept, "format": 2, "study": "validation", "indicative": old["level"] == "quick", "seeds": [],
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
