"""Definition of a study: parts, each with tasks, measure and judgement, and the words of its page."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

from ryusa.results import Results
from ryusa.study.judge import Finding, Outcome
from ryusa.study.plan import Level, Plan
from ryusa.study.registration import Registration
from ryusa.study.task import CaseRun, Task
from ryusa.study.verdict_words import SaidVerdict, said

Found = Mapping[Any, Any]  # task -> result of `measure`, or the arrays of a calculation

# Outcome -> class of its colour on the page, and a sign that is distinct without colour.
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

    `measure` is not needed if all tasks are calculations. Three more functions are optional:

    - `rows(found, plan)` returns the lines of the CSV table of the part;
    - `draw(found, plan)` returns pictures by name;
    - `failed(error)` returns the measurement of a failed run if the failure is a result (a scheme that
      creates energy), else None. A part with a failed run and no such result is not judged.

    A part that judges claims lists them in `CLAIMS`; `judge` then returns one finding for each.
    """

    TITLE: str

    def tasks(self, plan: Plan) -> Sequence[Task]:
        """Return the runs of case files (`case_run`) and the calculations (`calculation`) of this part.

        Calculations should take seconds at most, because they cannot be resumed.
        """
        ...

    def measure(self, results: Results, task: CaseRun) -> Any:
        """Return the numbers of one run, small enough to be sent between processes."""
        ...

    def judge(self, found: Found, plan: Plan) -> Sequence[Finding]:
        """Compare the measurements with claims or references."""
        ...


class Study(ABC):
    """Base class of studies: those of the package, and that of a folder of the user.

    Attributes
    ----------
    name : name of the study in the ledger.
    title : heading of the page.
    command : command that runs it.
    stem : first part of the names of its ledger files.
    parts : names of the parts, in the order of the page.
    level : level whose files have no level in their names.
    words : words for what the case as it ships gives, by outcome. "Holds only if" has none, because a verdict
        says what holds as shipped, and then in which settings.
    alone : said where the case as it ships is the only setting, in a study that varies free choices.
    registration : claims with the bands that judge them; without it a part states its bands itself. One that
        is not `whole` has the bands that were changed, and says which numbers are checks.
    template : template of the page; it extends `page.html` of this package.
    """

    name = ""
    title = ""
    command = ""
    stem = "ledger"
    parts: tuple[str, ...] = ()
    level = Level.STANDARD
    words: Mapping[Outcome, str] = {one: str(one) for one in Outcome if one is not Outcome.ONLY_IF}
    alone = ""
    registration: Registration | None = None
    template = Path(__file__).with_name("page.html")

    @abstractmethod
    def part(self, name: str) -> StudyPart:
        """Return the part of that name, in any process."""

    def claims(self, name: str) -> tuple[str, ...]:
        """Ids of the claims that a part judges; empty for a part without declared claims."""
        return tuple(getattr(self.part(name), "CLAIMS", ()))

    def entry_id(self, part: str, finding: Finding | None) -> str:
        """Id of an entry on the page; without a finding, that of a part that was not judged."""
        return part.replace("_", "-") if finding is None else finding.id

    def about(self, entry: str) -> dict[str, Any]:
        """Additional content of an entry in the ledger."""
        del entry
        return {}

    def registered(self, entry: Mapping[str, Any]) -> dict[str, Any] | None:
        """What is registered of an entry, as the ledger has it; None if nothing is."""
        if self.registration is None:
            return None
        return self.registration.plain(entry["id"], entry["trials"], entry["beside"])

    def word(self, entry: str, outcome: Outcome) -> str:
        """Word for what the case as it ships gives, of the entry with this id."""
        del entry
        return self.words[outcome]

    def said(self, entry: Mapping[str, Any]) -> SaidVerdict:
        """The verdict on an entry in words, from the numbers that the ledger has of it."""
        return said(entry, lambda outcome: self.word(entry["id"], outcome), self.alone)

    def order(self, entries: Sequence[str]) -> Sequence[str]:
        """Order the ids of the entries."""
        return entries

    def head(self, findings: Sequence[Finding]) -> dict[str, Any]:
        """Additional content of the ledger, for all findings together."""
        del findings
        return {}

    def facts(self, entry: Mapping[str, Any]) -> list[tuple[str, str]]:
        """First lines in the section of an entry: labels and texts."""
        if not entry["source"]:
            return []
        return [("reference", f"{entry['source']} ({entry['known']})")]

    def asked(self, trial: Mapping[str, Any]) -> str:
        """Permitted range of a number, in the words of this study."""
        return asked_in_words(trial)

    def context(self, ledger: Mapping[str, Any]) -> dict[str, Any]:
        """Additional variables for the template of this study."""
        del ledger
        return {}


def asked_in_words(trial: Mapping[str, Any]) -> str:
    """Limits of a number with their reason, in words.

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
    """Limits of a number, in words.

    >>> limits_in_words({"asked": {"low": 1.9, "high": 2.1, "unit": "-", "says": "central differences"}})
    '1.9 to 2.1'
    """
    if trial["asked"] is None:
        return "shown only"
    low, high = trial["asked"]["low"], trial["asked"]["high"]
    if high is None:
        return "any" if low is None else f"at least {low:g}"
    return f"at most {high:g}" if low in (0.0, None) else f"{low:g} to {high:g}"
