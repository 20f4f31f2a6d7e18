"""What a study is: parts, each with its tasks, its measure and its judgement, and the words of its page."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

from ryusa.results import Results
from ryusa.study.judge import Finding, Outcome
from ryusa.study.plan import Level, Plan
from ryusa.study.task import CaseRun, Task

Found = Mapping[Any, Any]  # task -> what `measure` gave for it, or the arrays of a calculation

# Outcome -> class of its colour on the page, and a sign that can be told apart without colour.
LOOKS = {
    Outcome.HOLDS: ("yes", "●"),
    Outcome.ONLY_IF: ("partly", "◐"),
    Outcome.FAILS: ("no", "○"),
    Outcome.EXCLUDED: ("no", "✕"),
    Outcome.SHOWN: ("waits", "–"),
    Outcome.UNDECIDED: ("open", "?"),
}


class StudyPart(Protocol):
    """One part of a study: a module, or any object with these names.

    `measure` is not needed where all tasks are calculations. Three more functions are optional:

    - `rows(found, plan)` gives the lines of the part's CSV table;
    - `draw(found, plan)` gives pictures by name;
    - `failed(error)` gives what is measured where a run that breaks down is an answer (a law that creates
      energy), or None where this error is no answer. Without an answer the part is not judged.

    A part that judges claims names them in `CLAIMS`; `judge` then gives one finding for each.
    """

    TITLE: str

    def tasks(self, plan: Plan) -> Sequence[Task]:
        """Runs of case files (`case_run`) and calculations (`calculation`) that this part needs.

        No calculation takes longer than seconds, so that an interrupt costs little; longer ones are runs.
        """
        ...

    def measure(self, results: Results, task: CaseRun) -> Any:
        """Numbers of one run, small enough to be sent between processes."""
        ...

    def judge(self, found: Found, plan: Plan) -> Sequence[Finding]:
        """Compare what was measured with what is claimed or known."""
        ...


class Study(ABC):
    """A study as the framework sees it; those of the package and that of a user's folder derive from it.

    Attributes
    ----------
    name : of the study, in the ledger.
    title : heading of the page.
    command : what the user types to run it.
    stem : first part of the names of its ledger files.
    parts : names of the parts, in the order of the page.
    level : the level whose files carry no level in their name.
    words : verdict in words, by outcome.
    template : the page; it extends `page.html` of this room.
    """

    name = ""
    title = ""
    command = ""
    stem = "ledger"
    parts: tuple[str, ...] = ()
    level = Level.STANDARD
    words: Mapping[Outcome, str] = {one: str(one) for one in Outcome}
    template = Path(__file__).with_name("page.html")

    @abstractmethod
    def part(self, name: str) -> StudyPart:
        """Return the part of that name, in any process."""

    def claims(self, name: str) -> tuple[str, ...]:
        """Ids of the claims that a part judges; empty where its findings name themselves."""
        return tuple(getattr(self.part(name), "CLAIMS", ()))

    def entry_id(self, part: str, finding: Finding | None) -> str:
        """Name of an entry on the page; without a finding, that of a part that was not judged."""
        return part.replace("_", "-") if finding is None else finding.id

    def about(self, entry: str) -> dict[str, Any]:
        """Give what the ledger holds of an entry beside the finding itself."""
        del entry
        return {}

    def order(self, entries: Sequence[str]) -> Sequence[str]:
        """Order the ids of the entries."""
        return entries

    def head(self, findings: Sequence[Finding]) -> dict[str, Any]:
        """Give what the ledger holds for all findings together."""
        del findings
        return {}

    def facts(self, entry: Mapping[str, Any]) -> list[tuple[str, str]]:
        """Lines that the section of an entry begins with: a label and its text."""
        if not entry["source"]:
            return []
        return [("reference", f"{entry['source']} ({entry['known']})")]

    def asked(self, trial: Mapping[str, Any]) -> str:
        """Say what was asked of a number, in the words of this study."""
        return asked_in_words(trial)

    def context(self, ledger: Mapping[str, Any]) -> dict[str, Any]:
        """Give what the template of this study needs beside the common things."""
        del ledger
        return {}


def asked_in_words(trial: Mapping[str, Any]) -> str:
    """Say which limits a number has.

    >>> asked_in_words({"asked": {"low": 0.0, "high": 0.02, "unit": "-", "says": "half a cell"}})
    'at most 0.02: half a cell'
    >>> asked_in_words({"asked": None})
    'shown only'
    """
    if trial["asked"] is None:
        return "shown only"
    limits, says = limits_in_words(trial), trial["asked"]["says"]
    return f"{limits}: {says}" if says else limits


def limits_in_words(trial: Mapping[str, Any]) -> str:
    """Say the limits alone.

    >>> limits_in_words({"asked": {"low": 1.9, "high": 2.1, "unit": "-", "says": "central differences"}})
    '1.9 to 2.1'
    """
    if trial["asked"] is None:
        return "shown only"
    low, high = trial["asked"]["low"], trial["asked"]["high"]
    if high is None:
        return "any" if low is None else f"at least {low:g}"
    return f"at most {high:g}" if low in (0.0, None) else f"{low:g} to {high:g}"
