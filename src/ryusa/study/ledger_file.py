"""Reading and writing of ledger files, compressed if their name ends in .xz."""

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
from ryusa.study.study import Study
from ryusa.study.verdict import Effect, first_reading, held_of, robustness, settings_within
from ryusa.study.verdict_words import plain_count, plain_effect

COMPRESSED = ".xz"


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
    """Read a ledger of any study, as JSON or compressed.

    Raises
    ------
    ResultsError : the file is not a ledger, is damaged, or has another format.
    """
    try:
        data = path.read_bytes()
        plain: Any = json.loads(lzma.decompress(data) if path.suffix == COMPRESSED else data)
    except (OSError, ValueError, lzma.LZMAError, EOFError) as error:
        raise ResultsError(f"{path}: cannot be read as a ledger ({error})") from None
    if not isinstance(plain, dict) or "format" not in plain:
        raise ResultsError(f"{path}: is no ledger of ryusa")
    if plain["format"] != FORMAT:
        raise ResultsError(
            f"{path}: a ledger in format {plain['format']!r}, of another version; this ryusa reads {FORMAT}"
        )
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
    """An entry whose outcome and settings are counted anew from its trials.

    The choice that decides is kept, because it follows from single seeds, which no ledger has.
    """
    held, readings = held_of(entry["trials"]), tuple(entry["readings"])
    excluded = entry["outcome"] == Outcome.EXCLUDED
    base = Outcome.EXCLUDED if excluded else base_outcome_of(held, bool(entry["trials"]))
    old, factor, effect = entry["deciding_factor"], None, None
    if old:
        levels = tuple(old["holds_at"])
        shares = settings_within(held, old["choice"], levels, readings)
        effect = Effect(old["choice"], old["p"], levels, *shares, old["confirmed"], old["choice"] in readings)
        tried = list(dict.fromkeys(dict(key)[old["choice"]] for key in held))
        factor = plain_effect(effect, tried, old["halves_of"])
    outcome = outcome_of(base, effect)
    every = robustness(list(first_reading(held, readings).values()))
    return {
        **entry,
        "outcome": str(outcome),
        "base_outcome": str(base),
        "condition": factor["words"] if factor and outcome is Outcome.ONLY_IF else "",
        "robustness": {**plain_count(every), "low": every.low, "high": every.high},
        "deciding_factor": factor,
    }
