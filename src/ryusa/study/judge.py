"""From numbers to a verdict: the band that is asked for, the settings tried, and one rule for all studies."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from ryusa.figures.comparison import Axis, Curve
from ryusa.study.interval import Interval

_NAMED = 3  # sets of choices named in a condition, at most


class Outcome(StrEnum):
    """What became of a finding. Each study has its own words for these."""

    HOLDS = "holds"
    ONLY_IF = "holds only if"
    FAILS = "fails"
    EXCLUDED = "excluded by its own equations"
    SHOWN = "shown"
    UNDECIDED = "undecided"


class Known(StrEnum):
    """How a reference is known."""

    CLOSED = "closed form"  # derived; the reader can check it against the equation of the source
    READ = "read in the source"
    QUOTED = "read where it is quoted"
    MEMORY = "from memory"  # shown, and never decides


@dataclass(frozen=True)
class Source:
    """Where a reference comes from."""

    words: str  # author, year, equation or table
    known: Known = Known.CLOSED


@dataclass(frozen=True)
class ReferenceChart:
    """Our curves on reference curves; a reference named as one of ours belongs to it.

    Attributes
    ----------
    x, y : the axes.
    ours, references : the curves compared.
    beside : further curves, shown and not compared.
    """

    x: Axis
    y: Axis
    ours: Sequence[Curve]
    references: Sequence[Curve]
    beside: Sequence[Curve] = ()


@dataclass(frozen=True)
class Band:
    """What is asked of a number, as an inequality; either end may be infinite."""

    low: float
    high: float
    unit: str
    says: str  # why these limits: how words became numbers, or how accurate the method can be

    def holds(self, found: Interval) -> bool | None:
        """True with the whole interval inside, False with all of it outside, None where it straddles."""
        if not (math.isfinite(found.low) and math.isfinite(found.high)):
            return None
        if self.low <= found.low and found.high <= self.high:
            return True
        if found.high < self.low or found.low > self.high:
            return False
        return None


def at_most(high: float, says: str, unit: str = "-") -> Band:
    """Give the band of an error that cannot be negative.

    >>> at_most(0.02, "half a cell")
    Band(low=0.0, high=0.02, unit='-', says='half a cell')
    """
    return Band(0.0, high, unit, says)


@dataclass(frozen=True)
class Trial:
    """One number of a finding, under one set of free choices.

    Attributes
    ----------
    part : what was measured, such as "slope of the heap at rest".
    choices : every free choice that is varied, by name; the same names in every trial of a finding.
    found : the number.
    band : what is asked of it; None where the number is shown and decides nothing.
    decided : verdict where no number can carry it, such as a heap that stands as a wall; `note` says why.
    """

    part: str
    choices: Mapping[str, str]
    found: Interval
    band: Band | None
    decided: bool | None = None
    note: str = ""

    @property
    def judged(self) -> bool:
        """Whether anything is asked of it."""
        return self.band is not None or self.decided is not None

    @property
    def holds(self) -> bool | None:
        """Whether this part holds; None where it cannot be decided."""
        if self.decided is not None or self.band is None:
            return self.decided
        return self.band.holds(self.found)


Key = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Finding:
    """What was found about one claim or one reference.

    Attributes
    ----------
    id : of the claim; of a comparison, short lower-case words with hyphens, unique within its part.
    trials : every number and setting tried; those of the case file as it ships come first.
    decided_by : one or two sentences on the physics that decides it.
    settings : what all trials share, in words.
    contradiction : set where the source's own equations exclude the claim; says how, with the numbers found.
    also : further numbers, which decide nothing.
    beside : trials of something else than what the finding is about, such as other forms of a law.
    title : what is compared; empty where the part's own title says it.
    source : of the reference.
    chart : our curves on those of the reference.

    Raises
    ------
    ValueError : a reference known from memory would decide; it may only be shown.
    """

    id: str
    trials: tuple[Trial, ...]
    decided_by: str = ""
    settings: Mapping[str, str] = field(default_factory=dict[str, str])
    contradiction: str = ""
    also: tuple[str, ...] = ()
    beside: tuple[Trial, ...] = ()
    title: str = ""
    source: Source | None = None
    chart: ReferenceChart | None = None

    def __post_init__(self) -> None:
        """Let nothing that is known from memory alone decide."""
        from_memory = self.source is not None and self.source.known is Known.MEMORY
        if from_memory and any(one.judged for one in self.trials):
            raise ValueError(f"{self.id}: a reference from memory may be shown, but must not decide")

    @property
    def by_choice(self) -> dict[Key, bool | None]:
        """Whether it holds under each set of choices: every part that is judged must."""
        parts: dict[Key, list[bool | None]] = {}
        for one in self.trials:
            if one.judged:
                parts.setdefault(tuple(one.choices.items()), []).append(one.holds)
        return {
            key: False if False in held else None if None in held else True for key, held in parts.items()
        }

    @property
    def outcome(self) -> Outcome:
        """The verdict: one rule for every finding of every study.

        It holds under some sets of choices and fails under others: holds only if. It fails under none and
        holds as the case file ships: holds. It holds under none and fails as the case ships: fails. Otherwise
        the intervals straddle a limit: undecided. A claim that the equations of its own source exclude is
        excluded, whatever the runs say. Numbers of which nothing is asked are shown.
        """
        if self.contradiction:
            return Outcome.EXCLUDED
        held = list(self.by_choice.values())
        if not held:
            return Outcome.SHOWN if self.trials else Outcome.UNDECIDED
        if True in held and False in held:
            return Outcome.ONLY_IF
        if held[0] is None:
            return Outcome.UNDECIDED
        return Outcome.HOLDS if held[0] else Outcome.FAILS

    @property
    def counts(self) -> dict[str, int]:
        """Sets of choices under which it holds, fails, and stays open."""
        held = list(self.by_choice.values())
        return {"holds": held.count(True), "fails": held.count(False), "undecided": held.count(None)}

    @property
    def condition(self) -> str:
        """Where it holds, in words, when it fails elsewhere.

        Choices are named one by one where every combination of their values that was tried holds; else the
        sets under which it holds are named, by what they change in the case as it ships.
        """
        held = self.by_choice
        good = [dict(key) for key, one in held.items() if one]
        if self.outcome is not Outcome.ONLY_IF:
            return ""
        tried = {name: list(dict.fromkeys(dict(key)[name] for key in held)) for name in good[0]}
        fits = {
            name: [v for v in values if any(one[name] == v for one in good)] for name, values in tried.items()
        }
        inside = [one for key, one in held.items() if all(value in fits[name] for name, value in key)]
        if False not in inside:
            said = [
                f"{name} {_listed(fits[name], tried[name])}" for name in tried if fits[name] != tried[name]
            ]
        else:
            first = dict(next(iter(held)))
            sets = [", ".join(f"{k} {v}" for k, v in one.items() if v != first[k]) for one in good]
            said = [" or ".join(one or "as it ships" for one in sets[:_NAMED])]
            said += [f"or {len(sets) - _NAMED} more"] if len(sets) > _NAMED else []
        return f"{'; '.join(said)} ({len(good)} of {len(held)} settings)"

    @property
    def base(self) -> tuple[Trial, ...]:
        """Trials of the case file as it ships."""
        first = self.trials[0].choices if self.trials else {}
        return tuple(one for one in self.trials if one.choices == first)


def _listed(fits: Sequence[str], tried: Sequence[str]) -> str:
    """Values in words; neighbours of a sweep of numbers become a range.

    >>> _listed(["20 deg", "30 deg", "40 deg"], ["10 deg", "20 deg", "30 deg", "40 deg"])
    '20 deg to 40 deg'
    """
    order = sorted(tried, key=_number)
    places = sorted(order.index(value) for value in fits)
    runs: list[list[str]] = []
    for place in places:
        if runs and order.index(runs[-1][-1]) == place - 1 and math.isfinite(_number(order[place])):
            runs[-1].append(order[place])
        else:
            runs.append([order[place]])
    return " or ".join(one[0] if len(one) == 1 else f"{one[0]} to {one[-1]}" for one in runs)


def _number(text: str) -> float:
    try:
        return float(text.split(maxsplit=1)[0])
    except (ValueError, IndexError):
        return math.inf
