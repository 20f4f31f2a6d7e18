"""One entry of a ledger: the finding about one claim or reference, as written to the JSON file."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ryusa.figures.comparison import Curve
from ryusa.study.interval import Interval
from ryusa.study.judge import Finding, Outcome, Trial
from ryusa.study.origin import json_number
from ryusa.study.study import Study
from ryusa.study.verdict_words import plain_count, plain_effect

DIGITS = 6  # significant digits of curves in the JSON file
MOST = 200  # largest number of points of a curve in the JSON file


@dataclass(frozen=True)
class LedgerEntry:
    """A finding with its pictures and its problems."""

    id: str
    part: str
    finding: Finding | None  # None if it could not be run or judged
    pictures: tuple[Path, ...] = ()
    problem: str = ""  # why it could not be judged, or what is missing

    @property
    def outcome(self) -> Outcome:
        """The verdict."""
        return Outcome.UNDECIDED if self.finding is None else self.finding.outcome


def plain_entry(study: Study, entry: LedgerEntry, folder: Path) -> dict[str, Any]:
    """Return an entry as written to the JSON file; picture paths are relative to `folder`."""
    found = entry.finding if entry.finding is not None else Finding(entry.id, ())
    settings = {**found.settings, **(found.base[0].choices if found.base else {})}
    share = found.robustness
    plain = {
        "id": entry.id,
        "part": entry.part,
        "title": found.title or study.part(entry.part).TITLE,
        "outcome": str(entry.outcome),
        "verdict": "",
        "base_outcome": str(found.base_outcome),
        "condition": found.condition,
        "counts": found.counts,
        "robustness": {**plain_count(share), "low": share.low, "high": share.high},
        "readings": list(found.readings),
        "deciding_factor": _deciding(found),
        "registered": None,
        **study.about(entry.id),
        "source": "" if found.source is None else found.source.words,
        "known": "" if found.source is None else str(found.source.known),
        "settings": settings,
        "trials": [_trial(one) for one in found.trials],
        "beside": [_trial(one) for one in found.beside],
        "decided_by": found.decided_by,
        "contradiction": found.contradiction,
        "also": list(found.also),
        "chart": _chart(found),
        "problem": entry.problem,
        "pictures": [one.relative_to(folder).as_posix() for one in entry.pictures],
    }
    plain["registered"] = study.registered(plain)
    return {**plain, "verdict": str(study.said(plain))}


def ours_in_words(finding: Finding) -> str:
    """Numbers of the case file as it ships, in words."""
    return "; ".join(f"{one.part}: {one.note or one.found}" for one in finding.base)


def _deciding(found: Finding) -> dict[str, Any] | None:
    """The free choice that decides a finding, at which values it holds, and how sure that is."""
    one = found.deciding
    if one is None:
        return None
    return plain_effect(one, found.tried(one), "seeds" if found.has_seeds else "settings")


def _trial(one: Trial) -> dict[str, Any]:
    held = {True: "holds", False: "fails", None: "undecided"}[one.holds] if one.judged else "shown"
    band = one.band
    return {
        "part": one.part, "choices": dict(one.choices), **_interval(one.found),
        "asked": None if band is None else {
            "low": json_number(band.low), "high": json_number(band.high), "unit": band.unit, "says": band.says
        },
        "outcome": held, "note": one.note,
    }  # fmt: skip


def _interval(found: Interval) -> dict[str, Any]:
    return {
        **{name: json_number(getattr(found, name)) for name in ("value", "low", "high")},
        "unit": found.unit, "n": found.n, "how": found.how,
    }  # fmt: skip


def _chart(found: Finding) -> dict[str, Any] | None:
    if found.chart is None:
        return None
    return {
        "axes": [str(found.chart.x), str(found.chart.y)],
        "ours": [_curve(one) for one in found.chart.ours],
        "references": [_curve(one) for one in found.chart.references],
        "beside": [_curve(one) for one in found.chart.beside],
    }


def _curve(one: Curve) -> dict[str, Any]:
    """A curve with a limited number of points and digits."""
    step = max(1, -(-len(one.x) // MOST))
    return {
        "name": one.name,
        "x": [float(f"{value:.{DIGITS}g}") for value in one.x[::step]],
        "y": [float(f"{value:.{DIGITS}g}") for value in one.y[::step]],
    }
