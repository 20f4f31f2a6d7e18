"""Registration of claims: what stands for each and the band asked, written down before any run of it.

A study keeps it in TOML files that are committed before the runs; the page names the commits. A band is never
replaced: a later one is a further entry with its date and reason, and the page shows the verdict by both.
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
from ryusa.study.judge import Band, Finding, Trial

CLOSE = 1e-9  # relative difference of limits that are the same
_BAND = {"part", "low", "high", "unit", "reason", "date", "change"}
_CLAIM = {
    "id", "figure", "kind", "japanese", "translation", "measured", "base", "factors", "missing", "sample",
    "test", "judged", "why_not", "band",
}  # fmt: skip
KINDS = ("claim", "conjecture", "proposal")


@dataclass(frozen=True)
class RegisteredBand:
    """One entry of the registration.

    Attributes
    ----------
    part : of the trials it judges; * stands for a number that varies between them.
    band : limits, and how the words of the claim became these.
    date : of the entry, as in the file.
    change : what changed against the entry before, and why; empty in a first entry.
    """

    part: str
    band: Band
    date: str
    change: str


@dataclass(frozen=True)
class RegisteredClaim:
    """One claim.

    Attributes
    ----------
    kind : "claim" if it is reported as a result, else "conjecture" or "proposal".
    original, translation : wording of the source, and what it says in English.
    measured, base, sample, test : number that stands for it, settings as shipped, runs per setting, test.
    factors, missing : free choices that are varied, and those that could touch the claim and are not.
    bands : entries in their order; of one part the last is in force.
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
    why_not: str = ""

    def entries(self, part: str) -> list[RegisteredBand]:
        """Entries of one part, the one in force last."""
        return [one for one in self.bands if one.part == part or fnmatchcase(part, one.part)]


@dataclass(frozen=True)
class Registration:
    """All claims of a study, and the file that each is in, by id."""

    claims: Mapping[str, RegisteredClaim]
    paths: Mapping[str, Path]

    @classmethod
    def read(cls, path: Path) -> "Registration":
        """Read a registration.

        Parameters
        ----------
        path : a TOML file, or a folder of such files.

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
        return cls(found, paths)

    @cached_property
    def commits(self) -> Mapping[str, str | None]:
        """Commit that last changed the file of each claim, "+" if it differs; None outside a checkout."""
        files = {path: last_commit(path) for path in set(self.paths.values())}
        return {claim: files[path] for claim, path in self.paths.items()}

    def check(self, finding: Finding) -> None:
        """Refuse a finding that is judged by a band that is not in force.

        Raises
        ------
        ValueError : the claim, a part of it, or the limits of a part are not registered.
        """
        claim = self.claims.get(finding.id)
        if claim is None:
            raise ValueError(f"{finding.id} is not registered, so it is not judged")
        for one in finding.trials:
            if one.band is not None and one.judged:
                self._check(claim, one, one.band)

    def _check(self, claim: RegisteredClaim, trial: Trial, band: Band) -> None:
        entries = claim.entries(trial.part)
        said = f'{claim.id}: "{trial.part}" is judged by {_limits(band)}, '
        rule = f"a band is registered in {self.paths[claim.id].name}, and committed, before it judges a run"
        if not entries:
            raise ValueError(f"{said}which is not registered; {rule}")
        if not any(_same(one.band, band) for one in _in_force(entries)):
            raise ValueError(f"{said}but registered is {_limits(entries[-1].band)}; {rule}")

    def plain(self, finding: Finding) -> dict[str, Any]:
        """What is registered of a finding, with its verdicts by bands that were replaced, as plain data."""
        claim = self.claims[finding.id]
        earlier: list[dict[str, Any]] = []
        for trial in finding.base:
            entries = claim.entries(trial.part)
            for entry, after in pairwise(entries):
                held = entry.band.holds(trial.found) if trial.decided is None else trial.decided
                earlier.append(
                    {
                        "part": trial.part, "limits": _limits(entry.band), "date": entry.date,
                        "outcome": {True: "holds", False: "fails", None: "undecided"}[held],
                        "replaced": after.date, "why": after.change,
                    }
                )  # fmt: skip
        return {
            "commit": self.commits[finding.id], "kind": claim.kind, "original": claim.original,
            "translation": claim.translation, "measured": claim.measured, "base": claim.base,
            "factors": list(claim.factors), "missing": list(claim.missing), "sample": claim.sample,
            "test": claim.test, "earlier": earlier,
        }  # fmt: skip


def _in_force(entries: Sequence[RegisteredBand]) -> list[RegisteredBand]:
    """Entries that are in force: the last one for each pattern of parts and unit."""
    return list({(one.part, one.band.unit): one for one in entries}.values())


def _same(one: Band, other: Band) -> bool:
    limits = ((one.low, other.low), (one.high, other.high))
    return one.unit == other.unit and all(a == b or math.isclose(a, b, rel_tol=CLOSE) for a, b in limits)


def _limits(band: Band) -> str:
    unit = "" if band.unit == "-" else f" {band.unit}"
    if not math.isfinite(band.high):
        return f"at least {band.low:g}{unit}"
    return (
        f"{band.low:g} to {band.high:g}{unit}" if math.isfinite(band.low) else f"at most {band.high:g}{unit}"
    )


def _claim(given: Mapping[str, Any], file: str) -> RegisteredClaim:
    name = str(given.get("id", "a claim without id"))
    _refuse_unknown(given, _CLAIM, f"{file}: {name}")
    kind = str(given.get("kind", KINDS[0]))
    if kind not in KINDS:
        raise ValueError(f"{file}: {name}: kind = {kind!r} must be one of {', '.join(KINDS)}")
    texts = {
        key: str(given.get(key, ""))
        for key in ("figure", "translation", "measured", "base", "sample", "test")
    }
    bands = tuple(_band(one, f"{file}: {name}") for one in given.get("band", []))
    why_not = str(given.get("why_not", ""))
    if bool(given.get("judged", True)) != (not why_not):
        raise ValueError(f"{file}: {name}: a claim is either judged, or says in why_not why it is not")
    return RegisteredClaim(
        id=name, kind=kind, original=str(given.get("japanese", "")), factors=tuple(given.get("factors", ())),
        missing=tuple(given.get("missing", ())), bands=bands, why_not=why_not, **texts,
    )  # fmt: skip


def _band(given: Mapping[str, Any], where: str) -> RegisteredBand:
    _refuse_unknown(given, _BAND, where)
    lacking = {"part", "unit", "reason", "date"} - set(given)
    if lacking:
        raise ValueError(f"{where}: a band needs {', '.join(sorted(lacking))}")
    low, high = float(given.get("low", -math.inf)), float(given.get("high", math.inf))
    if not low <= high or (math.isinf(low) and math.isinf(high)):
        raise ValueError(f"{where}: {given['part']}: low = {low:g} and high = {high:g} are no band")
    band = Band(low, high, str(given["unit"]), str(given["reason"]))
    return RegisteredBand(str(given["part"]), band, str(given["date"]), str(given.get("change", "")))


def _refuse_unknown(given: Mapping[str, Any], known: set[str], where: str) -> None:
    unknown = sorted(set(given) - known)
    if unknown:
        raise ValueError(f"{where}: {unknown[0]} is no key; allowed are {', '.join(sorted(known))}")
