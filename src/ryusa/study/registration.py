"""Registration of claims: what stands for each and the band asked, written down before any run of it.

A study keeps it in TOML files that are committed before the runs; the page names the commits. A band is never
replaced: a later one is a further entry with its date and reason, and the page shows the verdict by both. A
text that changes keeps its earlier wording beside it.
"""

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

from ryusa.running.provenance import last_commit
from ryusa.study.interval import Interval
from ryusa.study.judge import Band, Finding, Outcome, Trial

CLOSE = 1e-9  # relative difference of limits that are the same
NOT_JUDGED = "not judged"  # by an entry whose number the ledger does not have
_BAND = {"part", "low", "high", "unit", "reason", "date", "change", "number", "check", "judged", "came_out"}
TEXTS = ("measured", "base", "factors", "missing", "sample", "test")  # that a change may be noted of
_CLAIM = {
    "id", "figure", "kind", "japanese", "translation", *TEXTS, "judged", "why_not", "band", "changed",
}  # fmt: skip
_CHANGED = {"text", "date", "was", "why", "effect"}
KINDS = ("claim", "conjecture", "proposal")


@dataclass(frozen=True)
class RegisteredBand:
    """One entry of the registration.

    Attributes
    ----------
    part : of the trials it judges; * stands for a number that varies between them.
    band : limits, and how the words of the claim became these; None in an entry by which the number is shown
        from then on and judges nothing.
    date : of the entry, as in the file.
    change : what changed against the entry before, and why; empty in a first entry.
    number : number that it judges, where that is another than the one that the part has now.
    check : why the number is a check, that is, holds by construction or tests the arithmetic alone; empty for
        a number that decides a verdict.
    came_out : what its number came out as, where no ledger has it.
    """

    part: str
    band: Band | None
    date: str
    change: str = ""
    number: str = ""
    check: str = ""
    came_out: str = ""


@dataclass(frozen=True)
class ChangedText:
    """An earlier wording of a text of a claim.

    Attributes
    ----------
    text : which: measured, base, factors, missing, sample or test.
    date : of the change.
    was : the wording before it.
    why : reason of the change.
    effect : what is known of the verdict by the wording before.
    """

    text: str
    date: str
    was: str | tuple[str, ...]
    why: str
    effect: str


@dataclass(frozen=True)
class RegisteredClaim:
    """One claim.

    Attributes
    ----------
    id : of the finding; * stands for what varies between findings that are asked the same.
    kind : "claim" if it is reported as a result, else "conjecture" or "proposal".
    original, translation : wording of the source, and what it says in English.
    measured, base, sample, test : number that stands for it, settings as shipped, runs per setting, test.
    factors, missing : free choices that are varied, and those that could touch the claim and are not.
    bands : entries in their order; of one part the last is in force.
    changed : earlier wordings of its texts.
    why_not : reason why it is not judged; empty for a claim that is.
    """

    id: str
    figure: str
    kind: str
    original: str
    translation: str
    measured: str
    base: str
    sample: str
    test: str
    factors: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    bands: tuple[RegisteredBand, ...] = field(default=())
    changed: tuple[ChangedText, ...] = ()
    why_not: str = ""

    def entries(self, part: str) -> list[RegisteredBand]:
        """Entries of one part, the one in force last."""
        return [one for one in self.bands if one.part == part or fnmatchcase(part, one.part)]

    def replaced(self) -> list[dict[str, Any]]:
        """Entries that were replaced, as plain data, without a number that they would judge."""
        parts = dict.fromkeys(one.part for one in self.bands)
        return [one for part in parts for one in _earlier(part, self.entries(part), {})]


@dataclass(frozen=True)
class Registration:
    """All claims of a study, and the file that each is in, by id.

    Attributes
    ----------
    whole : whether every band is registered, so that any other is refused. Else the parts of the study state
        their bands, and registered are those that were changed and those that are checks.
    """

    claims: Mapping[str, RegisteredClaim]
    paths: Mapping[str, Path]
    whole: bool = True

    @classmethod
    def read(cls, path: Path, whole: bool = True) -> "Registration":
        """Read a registration.

        Parameters
        ----------
        path : a TOML file, or a folder of such files.
        whole : as of the class.

        Raises
        ------
        ValueError : a key, a kind or a limit that is not allowed, or an id that occurs twice.
        """
        found: dict[str, RegisteredClaim] = {}
        paths: dict[str, Path] = {}
        for file in sorted(path.glob("*.toml")) if path.is_dir() else [path]:
            for one in tomllib.loads(file.read_text(encoding="utf-8")).get("claim", []):
                claim = _claim(one, file.name)
                if claim.id in found:
                    raise ValueError(f"{file.name}: {claim.id} occurs twice, also in {paths[claim.id].name}")
                found[claim.id], paths[claim.id] = claim, file
        return cls(found, paths, whole)

    @cached_property
    def commits(self) -> Mapping[str, str | None]:
        """Commit that last changed the file of each claim, "+" if it differs; None outside a checkout."""
        files = {path: last_commit(path) for path in set(self.paths.values())}
        return {claim: files[path] for claim, path in self.paths.items()}

    def of(self, name: str) -> RegisteredClaim | None:
        """The claim of a finding, by its id or by a pattern."""
        patterns = (one for id, one in self.claims.items() if fnmatchcase(name, id))
        return self.claims.get(name) or next(patterns, None)

    def check(self, finding: Finding, name: str = "") -> None:
        """Refuse a finding that is judged by a band that is not in force.

        Parameters
        ----------
        finding : the finding.
        name : its id on the page, if that is not its own.

        Raises
        ------
        ValueError : the claim, a part of it, or the limits of a part are not registered.
        """
        name = name or finding.id
        claim = self.of(name)
        if claim is None:
            if self.whole:
                raise ValueError(f"{name} is not registered, so it is not judged")
            return
        for one in finding.trials:
            if one.band is not None and one.judged:
                self._check(claim, one, one.band)

    def _check(self, claim: RegisteredClaim, trial: Trial, band: Band) -> None:
        entries = claim.entries(trial.part)
        said = f'{claim.id}: "{trial.part}" is judged by {limits_of(band)}, '
        rule = f"a band is registered in {self.paths[claim.id].name}, and committed, before it judges a run"
        if not entries:
            if self.whole:
                raise ValueError(f"{said}which is not registered; {rule}")
            return
        if not any(_same(one.band, band) for one in _in_force(entries)):
            raise ValueError(f"{said}but registered is {limits_of(entries[-1].band)}; {rule}")

    def plain(
        self, name: str, trials: Sequence[Mapping[str, Any]], beside: Sequence[Mapping[str, Any]] = ()
    ) -> dict[str, Any] | None:
        """What is registered of a finding, with its verdicts by bands that were replaced, as plain data.

        Parameters
        ----------
        name : id of the finding.
        trials, beside : its trials as the JSON file has them, and what it shows beside them.

        Returns
        -------
        None if nothing is registered of it. `earlier` are entries that were replaced, with the verdict by
        each; `first` is the verdict by the first entry of every part, empty where these ask the same as now;
        `checks` says why a part is a check, and `check` whether all parts that are judged are.
        """
        claim = self.of(name)
        if claim is None:
            return None
        base = {one["part"]: one for one in trials if one["choices"] == trials[0]["choices"]}
        by_part = {part: entries for part in base if (entries := claim.entries(part))}
        judged = [part for part, one in base.items() if one["outcome"] != "shown"]
        numbers = {**{one["part"]: one for one in reversed(beside)}, **base}
        checks = {part: by_part[part][-1].check for part in judged if part in by_part}
        return {
            "commit": self.commits[claim.id], "kind": claim.kind, "original": claim.original,
            "translation": claim.translation, "measured": claim.measured, "base": claim.base,
            "factors": list(claim.factors), "missing": list(claim.missing), "sample": claim.sample,
            "test": claim.test,
            "earlier": [one for part, entries in by_part.items() for one in _earlier(part, entries, numbers)],
            "first": _first(by_part, judged, numbers),
            "checks": {part: why for part, why in checks.items() if why},
            "check": bool(judged) and all(checks.get(part) for part in judged),
            "changed": [
                {
                    "text": one.text, "date": one.date, "why": one.why, "effect": one.effect,
                    "was": one.was if isinstance(one.was, str) else "; ".join(one.was),
                }
                for one in claim.changed
            ],
        }  # fmt: skip


Numbers = Mapping[str, Mapping[str, Any]]  # trials of the case as it ships and beside it, by part


def _earlier(part: str, entries: Sequence[RegisteredBand], numbers: Numbers) -> list[dict[str, Any]]:
    """Entries of a part that were replaced, with the verdict by each."""
    return [
        {
            "part": part, "number": entry.number or part, "limits": limits_of(entry.band), "date": entry.date,
            "reason": "" if entry.band is None else entry.band.says,
            "outcome": outcome_by(entry, part, numbers), "came_out": entry.came_out,
            "now": limits_of(entries[-1].band), "last": entries[-1].date, "replaced": after.date,
            "why": after.change,
        }
        for entry, after in pairwise(entries)
    ]  # fmt: skip


def _first(by_part: Mapping[str, Sequence[RegisteredBand]], judged: Sequence[str], numbers: Numbers) -> str:
    """Outcome by the first entry of every part; empty where these ask the same of the same numbers as now."""
    first = {part: entries[0] for part, entries in by_part.items()}
    if all(_asks_the_same(first[part], entries[-1]) for part, entries in by_part.items()):
        return ""
    outcomes = [outcome_by(one, part, numbers) for part, one in first.items()]
    outcomes += [numbers[part]["outcome"] for part in judged if part not in first]
    asked = [one for one in outcomes if one != "shown"]
    for worst in ("fails", NOT_JUDGED, "undecided", "holds"):
        if worst in asked:
            return worst
    return "shown"


def _asks_the_same(one: RegisteredBand, other: RegisteredBand) -> bool:
    if one.band is None or other.band is None:
        return one.band is other.band
    return _same(one.band, other.band) and one.number == other.number


def outcome_by(entry: RegisteredBand, part: str, numbers: Numbers) -> str:
    """Outcome of the number that an entry judges; a verdict that follows from no number stays as it is."""
    if entry.band is None:
        return "shown"
    trial = numbers.get(entry.number or part)
    if trial is None:
        return NOT_JUDGED
    found = interval_of(trial)
    asked = trial["asked"]
    if asked is not None and trial["outcome"] != _word(band_of(asked).holds(found)):
        return trial["outcome"]
    return _word(entry.band.holds(found))


def interval_of(trial: Mapping[str, Any]) -> Interval:
    """Number of a trial as the JSON file has it; what has no value there is no number."""
    value, low, high = (math.nan if trial[end] is None else trial[end] for end in ("value", "low", "high"))
    return Interval(value, low, high, trial["unit"], trial.get("n", 1), trial.get("how", ""))


def band_of(asked: Mapping[str, Any]) -> Band:
    """Band as the JSON file has it; a limit that is missing is infinite."""
    low, high = asked["low"], asked["high"]
    return Band(
        -math.inf if low is None else low, math.inf if high is None else high, asked["unit"], asked["says"]
    )


def _word(held: bool | None) -> str:
    return str({True: Outcome.HOLDS, False: Outcome.FAILS, None: Outcome.UNDECIDED}[held])


def _in_force(entries: Sequence[RegisteredBand]) -> list[RegisteredBand]:
    """Entries that are in force: the last one for each pattern of parts."""
    return list({one.part: one for one in entries}.values())


def _same(one: Band | None, other: Band | None) -> bool:
    if one is None or other is None:
        return False
    limits = ((one.low, other.low), (one.high, other.high))
    return one.unit == other.unit and all(a == b or math.isclose(a, b, rel_tol=CLOSE) for a, b in limits)


def limits_of(band: Band | None) -> str:
    """Limits of a band in words."""
    if band is None:
        return "shown only"
    unit = "" if band.unit == "-" else f" {band.unit}"
    if not math.isfinite(band.high):
        return f"at least {band.low:g}{unit}"
    return (
        f"{band.low:g} to {band.high:g}{unit}" if math.isfinite(band.low) else f"at most {band.high:g}{unit}"
    )


def _claim(given: Mapping[str, Any], file: str) -> RegisteredClaim:
    name = str(given.get("id", "a claim without id"))
    where = f"{file}: {name}"
    _refuse_unknown(given, _CLAIM, where)
    kind = str(given.get("kind", KINDS[0]))
    if kind not in KINDS:
        raise ValueError(f"{where}: kind = {kind!r} must be one of {', '.join(KINDS)}")
    texts = {
        key: str(given.get(key, ""))
        for key in ("figure", "translation", "measured", "base", "sample", "test")
    }
    bands = tuple(_band(one, where) for one in given.get("band", []))
    changed = tuple(_changed(one, where) for one in given.get("changed", []))
    why_not = str(given.get("why_not", ""))
    if bool(given.get("judged", True)) != (not why_not):
        raise ValueError(f"{where}: a claim is either judged, or says in why_not why it is not")
    return RegisteredClaim(
        id=name, kind=kind, original=str(given.get("japanese", "")), factors=tuple(given.get("factors", ())),
        missing=tuple(given.get("missing", ())), bands=bands, changed=changed, why_not=why_not, **texts,
    )  # fmt: skip


def _band(given: Mapping[str, Any], where: str) -> RegisteredBand:
    _refuse_unknown(given, _BAND, where)
    judged = bool(given.get("judged", True))
    needed = {"part", "unit", "reason", "date"} if judged else {"part", "change", "date"}
    if lacking := needed - set(given):
        raise ValueError(f"{where}: a band needs {', '.join(sorted(lacking))}")
    texts = {key: str(given.get(key, "")) for key in ("change", "number", "check", "came_out")}
    part, date = str(given["part"]), str(given["date"])
    if not judged:
        return RegisteredBand(part, None, date, **texts)
    low, high = float(given.get("low", -math.inf)), float(given.get("high", math.inf))
    if not low <= high or (math.isinf(low) and math.isinf(high)):
        raise ValueError(f"{where}: {part}: low = {low:g} and high = {high:g} are no band")
    return RegisteredBand(part, Band(low, high, str(given["unit"]), str(given["reason"])), date, **texts)


def _changed(given: Mapping[str, Any], where: str) -> ChangedText:
    _refuse_unknown(given, _CHANGED, where)
    if lacking := {"text", "date", "was", "why"} - set(given):
        raise ValueError(f"{where}: a changed text needs {', '.join(sorted(lacking))}")
    if given["text"] not in TEXTS:
        raise ValueError(f"{where}: text = {given['text']!r} must be one of {', '.join(TEXTS)}")
    was = given["was"]
    return ChangedText(
        str(given["text"]), str(given["date"]), was if isinstance(was, str) else tuple(was),
        str(given["why"]), str(given.get("effect", "")),
    )  # fmt: skip


def _refuse_unknown(given: Mapping[str, Any], known: set[str], where: str) -> None:
    unknown = sorted(set(given) - known)
    if unknown:
        raise ValueError(f"{where}: {unknown[0]} is no key; allowed are {', '.join(sorted(known))}")
