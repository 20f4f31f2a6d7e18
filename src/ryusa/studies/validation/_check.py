"""What a check is: what it computes, the references it sets that against, and how far off it may be."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from importlib import import_module
from typing import Any, Protocol

from ryusa.cases import FOLDERS
from ryusa.errors import CaseError
from ryusa.figures.comparison import Axis, Curve
from ryusa.results import Results
from ryusa.study import CaseRun, Level, Task

NAMES = (
    "water_alone",
    "terminal_velocity",
    "suspension",
    "balance",
    "impact",
    "rebound",
    "rolling",
    "gas",
    "incline",
    "transport",
    "equilibrium",
    "frey",
)


class Known(StrEnum):
    """How a reference is known."""

    CLOSED = "closed form"  # derived, and checked by whoever reads the source's equation
    READ = "read in the source"
    QUOTED = "read where it is quoted"
    MEMORY = "from memory"  # is shown, and never decides


@dataclass(frozen=True)
class Source:
    """Where a reference comes from."""

    words: str  # author, year, equation or table
    known: Known = Known.CLOSED


@dataclass(frozen=True)
class Tolerance:
    """How large an error may be, and why so large."""

    low: float
    high: float
    why: str


def at_most(high: float, why: str) -> Tolerance:
    """Give the tolerance of an error that is no smaller than 0."""
    return Tolerance(0.0, high, why)


@dataclass(frozen=True)
class Error:
    """One number that says how far ours is from a reference; without a tolerance it decides nothing.

    >>> Error("largest difference", 0.01, "m/s", at_most(0.02, "half a cell")).within
    True
    """

    name: str
    value: float
    unit: str = "-"
    tolerance: Tolerance | None = None

    @property
    def within(self) -> bool | None:
        """Whether it is as small as it may be; None without a tolerance."""
        if self.tolerance is None:
            return None
        return self.tolerance.low <= self.value <= self.tolerance.high  # False for what is no number


class Word(StrEnum):
    """What became of a comparison."""

    WITHIN = "within"
    MISSED = "missed"
    SHOWN = "shown"  # no tolerance: beside each other, to look at
    UNDECIDED = "not judged"  # a run or the program failed


@dataclass(frozen=True)
class Comparison:
    """Ours on one reference.

    Attributes
    ----------
    id : short, of lower-case words and hyphens; unique within its check.
    title : what is compared.
    source : of the reference.
    x, y : axes of the picture.
    ours, references : curves that the errors compare; a reference named as one of ours belongs to it.
    errors : numbers, the one that tells most first.
    settings : what ours was made with, in words.
    said : what decides it, one or two sentences; where it misses, why.
    beside : other curves of the field, shown and not compared.

    Raises
    ------
    ValueError : a reference from memory would decide; it may be shown only.
    """

    id: str
    title: str
    source: Source
    x: Axis
    y: Axis
    ours: Sequence[Curve]
    references: Sequence[Curve]
    errors: Sequence[Error]
    settings: Mapping[str, str] = field(default_factory=dict[str, str])
    said: str = ""
    beside: Sequence[Curve] = ()

    def __post_init__(self) -> None:
        """Let nothing from memory decide."""
        if self.source.known is Known.MEMORY and any(one.tolerance is not None for one in self.errors):
            raise ValueError(f"{self.id}: a reference from memory may be shown, but must not decide")

    @property
    def word(self) -> Word:
        """The verdict: within where every error is that has a tolerance."""
        held = [one.within for one in self.errors if one.within is not None]
        if not held:
            return Word.SHOWN
        return Word.WITHIN if all(held) else Word.MISSED


Found = Mapping[Any, Any]


class Check(Protocol):
    """A module that sets what the package computes against one reference, or a few of a kind."""

    TITLE: str

    def runs(self, level: Level) -> Sequence[Task]:
        """Runs of case files (`case_run`) and calculations (`calculation`); level is quick or full.

        No calculation takes longer than seconds, so that an interrupt costs little; longer ones are runs.
        """
        ...

    def measure(self, run: Results, one: CaseRun) -> Any:
        """Numbers of one run of a case file, small; not needed where all are calculations."""
        ...

    def compare(self, found: Found, level: Level) -> Sequence[Comparison]:
        """Set ours against the references.

        `found` gives for each of `runs(level)` what `measure` made of it, or the numbers of the calculation.
        """
        ...


def load(name: str) -> Check:
    """Return the check of that name (see NAMES)."""
    if name not in NAMES:
        raise CaseError("check", name, f"there are {', '.join(NAMES)}")
    module: Any = import_module(f"ryusa.studies.validation.{name}")
    return module


def case_run(case: str, overrides: Mapping[str, str] | None = None, folder: str = "validation") -> CaseRun:
    """Name one run of a case file.

    Parameters
    ----------
    case : "frey" is frey.toml in the folder cases/ beside this file.
    overrides : keys of the case and values as text with units, as `ryusa run --set` takes them.
    folder : which of the packaged folders, of `cases.FOLDERS`; "" holds the general cases.
    """
    return CaseRun(case, tuple(sorted((overrides or {}).items())), FOLDERS[folder])


def relative(ours: Any, reference: Any) -> float:
    """Largest difference over the largest reference [-]; nan where there is none.

    >>> relative([1.0, 2.2], [1.0, 2.0])
    0.1
    """
    import numpy as np

    a, b = np.asarray(ours, dtype=np.float64), np.asarray(reference, dtype=np.float64)
    return round(float(np.abs(a - b).max() / np.abs(b).max()), 15) if a.size and np.any(b) else math.nan
