"""The validation as a study: `ryusa validate`."""

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from ryusa.errors import CaseError
from ryusa.study import Finding, Level, Outcome, Study, StudyPart
from ryusa.study.page import checks_of, interval
from ryusa.study.registration import Registration
from ryusa.study.study import limits_in_words
from ryusa.study.verdict_words import checks, tally
from ryusa_studies.validation.sampling import CLOSED, sampling_lines

NAMES = (
    "water_alone", "river", "river_pressure", "river_pressure_grains", "river_debris",
    "terminal_velocity", "suspension", "balance", "impact", "hertz", "hertz_oblique", "hertz_pairs",
    "rebound", "rolling", "gas", "incline", "silo", "collapse", "channel_collapse", "gravel_heap", "drum",
    "plane_shear", "split_bottom", "transport", "equilibrium", "frey", "maurin",
)  # fmt: skip


class ValidationStudy(Study):
    """Every check of the package, with the words of its page."""

    name = "validation"
    title = "Comparison with references, and the error of each"
    command = "ryusa validate"
    stem = "validation"
    parts = NAMES
    words: Mapping[Outcome, str] = {
        Outcome.HOLDS: "within",
        Outcome.FAILS: "missed",
        Outcome.EXCLUDED: "missed",
        Outcome.SHOWN: "shown",
        Outcome.UNDECIDED: "undecided",
    }
    registration = Registration.read(Path(__file__).with_name("registration"), whole=False)
    template = Path(__file__).with_name("validation.html")

    def context(self, ledger: Mapping[str, Any]) -> dict[str, Any]:
        """Add the runs of each comparison."""
        return {"sampling": sampling_lines(Level(ledger["level"])), "closed": CLOSED}

    def part(self, name: str) -> StudyPart:
        """Return the check of that name (see NAMES)."""
        return load(name)

    def entry_id(self, part: str, finding: Finding | None) -> str:
        """Name on the page, such as "water-alone/log-rough"."""
        name = part.replace("_", "-")
        return name if finding is None else f"{name}/{finding.id}"


def load(name: str) -> StudyPart:
    """Return the check of that name (see NAMES)."""
    if name not in NAMES:
        raise CaseError("check", name, f"must be one of {', '.join(NAMES)}")
    module: Any = import_module(f"ryusa_studies.validation.{name}")
    return module


VALIDATION = ValidationStudy()


def table(plain: Mapping[str, Any]) -> str:
    """Give the lines of the table of docs/validation.md, from what the ledger holds.

    Of several errors it shows those that miss or are undecided, or the one that uses most of its tolerance.
    """
    lines = ["| comparison | reference | error | allowed | verdict |", "|---|---|---|---|---|"]
    for row in plain["findings"]:
        shown = telling(row["trials"])
        more = len(row["trials"]) - len(shown)
        errors = [f"{each['part']}: {interval(each)}" for each in shown]
        errors += [f"and {more} more"] if more else []
        asked = [limits_in_words(each) + _check(row, each) for each in shown]
        cells = [f"{row['id']}: {row['title']}", row["source"], "<br>".join(errors), "<br>".join(asked)]
        cells.append(str(VALIDATION.said(row)))
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


def _check(row: Mapping[str, Any], trial: Mapping[str, Any]) -> str:
    return " (check)" if trial["part"] in checks_of(row) else ""


def counted(plain: Mapping[str, Any]) -> str:
    """Give how many comparisons have each verdict, how many are checks, and what first entries change."""
    n = {headline: k for _, headline, k, _ in tally(plain["findings"], VALIDATION.said)}
    words = ", ".join(f"{k} *{headline}*" for headline, k in n.items())
    other = sum(bool(VALIDATION.said(one).first) for one in plain["findings"])
    words += f" ({other} of them other than as first registered)" if other else ""
    beside = checks(plain["findings"])
    return f"{len(plain['findings'])} rows: {words}" + (
        f"; beside these verdicts {beside}." if beside else "."
    )


def changes(plain: Mapping[str, Any]) -> list[str]:
    """Give the paragraphs about verdicts that changed since an earlier ledger; none if none was compared."""
    against = plain.get("against")
    if against is None:
        return []
    lines = [f"- {one['id']}: {one['old']}, now {one['new']}" for one in against["changed"]]
    seeds = ", ".join(str(one) for one in against["seeds"]) or "single runs"
    made = f"Against the table of {against['made'][:10]} (commit {against['commit'][:12]}, {seeds}):"
    return ["## Verdicts that changed", made, "\n".join(lines) or "none."]


def telling(errors: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Give the errors that miss or are undecided; else the one that uses most of its tolerance, or the first.

    >>> asked = {"low": 0.0, "high": 1.0, "unit": "-", "says": ""}
    >>> small = {"part": "a", "value": 0.1, "asked": asked, "outcome": "holds"}
    >>> [one["part"] for one in telling([small, {**small, "part": "b", "value": 0.2}])]
    ['b']
    """
    missed = [one for one in errors if one["outcome"] in ("fails", "undecided")]
    judged = [one for one in errors if one["outcome"] == "holds"]
    return missed or sorted(judged, key=_used)[-1:] or errors[:1]


def _used(one: Mapping[str, Any]) -> float:
    """Share of its tolerance that an error uses [-]; one without an upper end, or bound to 0, uses none.

    >>> _used({"value": 0.0, "asked": {"low": 0.0, "high": 0.0}})
    0.0
    """
    low, high = one["asked"]["low"] or 0.0, one["asked"]["high"]
    if high is None or low == high:
        return 0.0
    return abs(one["value"] - 0.5 * (low + high)) / (0.5 * (high - low)) if low else one["value"] / high
