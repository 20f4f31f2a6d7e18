"""The paper as a study: `ryusa paper`."""

from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from ryusa.errors import CaseError
from ryusa.study import Finding, Outcome, Study, StudyPart
from ryusa.study.page import as_shipped, interval
from ryusa.study.registration import Registration
from ryusa_studies.osada2004._parts import NAMES
from ryusa_studies.osada2004.by_level import tables
from ryusa_studies.osada2004.claims import CLAIMS
from ryusa_studies.osada2004.paper import CITATION, QUESTIONS

# Words for what is no claim: the paper supposes it, or proposes it.
OF_KIND: Mapping[str, Mapping[Outcome, str]] = {
    "conjecture": {
        Outcome.HOLDS: "conjecture holds",
        Outcome.FAILS: "conjecture does not hold",
    },
    "proposal": {
        Outcome.HOLDS: "proposal works",
        Outcome.FAILS: "proposal falls short",
    },
}

REGISTRATION = Registration.read(Path(__file__).with_name("registration"))


class PaperStudy(Study):
    """Every experiment that answers the paper, with the words of its page."""

    name = "paper"
    title = "Verdicts on the claims of the paper, and the choices that decide them"
    command = "ryusa paper"
    parts = NAMES
    words: Mapping[Outcome, str] = {
        Outcome.HOLDS: "reproduced",
        Outcome.FAILS: "not reproduced",
        Outcome.EXCLUDED: "contradicts its own equations",
        Outcome.UNDECIDED: "undecided",
        Outcome.SHOWN: "shown",
    }
    alone = "the only setting"
    registration = REGISTRATION
    template = Path(__file__).with_name("paper.html")

    def part(self, name: str) -> StudyPart:
        """Return the experiment of that name (see NAMES)."""
        return load(name)

    def figure(self, name: str) -> str:
        """What the paper calls the figure of an experiment, such as "fig19"."""
        part: Any = load(name)
        return str(part.FIGURE)

    def about(self, entry: str) -> dict[str, Any]:
        """What the paper says: figure, statement, set-up, what it leaves open, and a caution of ours."""
        claim = CLAIMS[entry]
        return {
            "figure": claim.figure,
            "statement": claim.says,
            "setup": claim.setup,
            "left_open": claim.free,
            "caution": claim.caution,
        }

    def word(self, entry: str, outcome: Outcome) -> str:
        """Word for what the case as it ships gives, another for what is no reported result of the paper."""
        own = CLAIMS[entry].words if entry in CLAIMS else None
        if own is not None and outcome in (Outcome.HOLDS, Outcome.FAILS):
            return own[outcome is Outcome.FAILS]
        kind = REGISTRATION.claims[entry].kind
        return OF_KIND.get(kind, {}).get(outcome, self.words[outcome])

    def order(self, entries: Sequence[str]) -> Sequence[str]:
        """The order of the claims in the paper."""
        return [one for one in CLAIMS if one in entries]

    def head(self, findings: Sequence[Finding]) -> dict[str, Any]:
        """The paper."""
        del findings
        return {"paper": CITATION}

    def facts(self, entry: Mapping[str, Any]) -> list[tuple[str, str]]:
        """Set-up, what is left open, and the statement."""
        return [
            (f"Fig. {entry['figure']}" if entry["figure"] else "In the text", entry["setup"]),
            ("left open", entry["left_open"] or "nothing"),
            ("the paper says", entry["statement"]),
        ]

    def asked(self, trial: Mapping[str, Any]) -> str:
        """The paper's words with the limits that were made of them."""
        return "shown only" if trial["asked"] is None else trial["asked"]["says"]

    def context(self, ledger: Mapping[str, Any]) -> dict[str, Any]:
        """Free choices level by level, and the open questions."""
        findings: list[dict[str, Any]] = [{**one, "ours": _ours(one)} for one in ledger["findings"]]
        here = {one["id"]: one for one in findings}
        return {
            "findings": findings,
            "n_claims": len(CLAIMS),
            "choices": tables(findings),
            "unjudged": [one for name, one in REGISTRATION.claims.items() if name not in CLAIMS],
            "questions": [
                (one["title"], one["anchor"], one["about"], answers)
                for one in QUESTIONS
                if (answers := [here[claim] for claim in one["claims"] if claim in here])
            ],
        }


def load(name: str) -> StudyPart:
    """Return the experiment of that name (see NAMES)."""
    if name not in NAMES:
        raise CaseError("experiment", name, f"must be one of {', '.join(NAMES)}")
    module: Any = import_module(f"ryusa_studies.osada2004.{name}")
    return module


def _ours(entry: Mapping[str, Any]) -> str:
    """Numbers of the case file as it ships."""
    return "; ".join(map(_number, entry["base"]))


def _number(trial: Mapping[str, Any]) -> str:
    return f"{trial['part']}: {trial['note'] or interval(trial)}"


def table(plain: Mapping[str, Any]) -> str:
    """Give the lines of the table of docs/paper.md, from what the ledger holds: judged numbers as shipped.

    Statements are those of today: they are our wording, and change without a run.
    """
    lines = ["| claim | the paper | ours, as shipped | verdict | decided by |", "|" + "---|" * 5]
    for row in plain["findings"]:
        judged = [one for one in as_shipped(row) if one["outcome"] != "shown"]
        why = row["deciding_factor"]
        cells = [
            row["id"],
            CLAIMS[row["id"]].says,
            "<br>".join(map(_number, judged)),
            str(PAPER.said(row)),
            "" if not why else why["choice"] if row["condition"] else why["words"],
        ]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


PAPER = PaperStudy()
