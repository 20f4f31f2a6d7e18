"""From numbers to a verdict: permitted ranges, settings, and one rule for all studies."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from ryusa.figures.comparison import Axis, Curve
from ryusa.study.interval import Interval
from ryusa.study.verdict import Effect, Key, Robustness, effects, robustness

_NAMED = 3  # largest number of sets of choices named in a condition


class Outcome(StrEnum):
    """Outcome of a finding. Each study has its own words for these."""

    HOLDS = "holds"
    ONLY_IF = "holds only if"
    FAILS = "fails"
    EXCLUDED = "excluded by its own equations"
    SHOWN = "shown"
    UNDECIDED = "undecided"


class Known(StrEnum):
    """Origin of a reference."""

    CLOSED = "closed form"  # derived; can be checked against the equation of the source
    READ = "read in the source"
    QUOTED = "read where it is quoted"
    MEMORY = "from memory"  # shown, never judged


@dataclass(frozen=True)
class Source:
    """Source of a reference."""

    words: str  # author, year, equation or table
    known: Known = Known.CLOSED


@dataclass(frozen=True)
class ReferenceChart:
    """Our curves and reference curves; a reference is matched to our curve of the same name.

    Attributes
    ----------
    x, y : axes.
    ours, references : curves that are compared.
    beside : further curves, shown but not compared.
    """

    x: Axis
    y: Axis
    ours: Sequence[Curve]
    references: Sequence[Curve]
    beside: Sequence[Curve] = ()


@dataclass(frozen=True)
class Band:
    """Permitted range of a number; either end may be infinite."""

    low: float
    high: float
    unit: str
    says: str  # reason of the limits: how a statement was turned into numbers, or the accuracy of the method

    def holds(self, found: Interval) -> bool | None:
        """True if the interval is inside, False if it is outside, None if it includes a limit."""
        if not (math.isfinite(found.low) and math.isfinite(found.high)):
            return None
        if self.low <= found.low and found.high <= self.high:
            return True
        if found.high < self.low or found.low > self.high:
            return False
        return None


def at_most(high: float, says: str, unit: str = "-") -> Band:
    """Return the band of an error that cannot be negative.

    >>> at_most(0.02, "half a cell")
    Band(low=0.0, high=0.02, unit='-', says='half a cell')
    """
    return Band(0.0, high, unit, says)


@dataclass(frozen=True)
class Trial:
    """One number of a finding, for one set of free choices.

    Attributes
    ----------
    part : quantity, such as "slope of the heap at rest".
    choices : value of every free choice that is varied, by name; the same names in all trials of a finding.
    found : the number.
    band : its permitted range; None if the number is shown but not judged.
    decided : verdict if it cannot be based on a number, such as a heap that stands as a wall; `note` says
        why.
    """

    part: str
    choices: Mapping[str, str]
    found: Interval
    band: Band | None
    decided: bool | None = None
    note: str = ""

    @property
    def judged(self) -> bool:
        """Whether the number enters the verdict."""
        return self.band is not None or self.decided is not None

    @property
    def holds(self) -> bool | None:
        """Whether this part holds; None if it cannot be decided."""
        if self.decided is not None or self.band is None:
            return self.decided
        return self.band.holds(self.found)


@dataclass(frozen=True)
class Finding:
    """The result for one claim or one reference.

    Attributes
    ----------
    id : identifier of the claim; of a comparison, lower-case words with hyphens, unique within its part.
    trials : all numbers, for all settings; those of the case file as it ships come first.
    decided_by : one or two sentences on the physics that decides the verdict.
    settings : settings common to all trials, in words.
    contradiction : if the equations of the source exclude the claim, an explanation with the numbers found.
    also : further numbers, not judged.
    beside : trials of something other than the subject of the finding, such as other forms of a law.
    title : what is compared; empty if the title of the part is sufficient.
    source : source of the reference.
    chart : our curves and those of the reference.

    Raises
    ------
    ValueError : a reference known only from memory is judged; it may only be shown.
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
        """Refuse a judgement that is based on a reference known only from memory."""
        from_memory = self.source is not None and self.source.known is Known.MEMORY
        if from_memory and any(one.judged for one in self.trials):
            raise ValueError(f"{self.id}: a reference from memory may be shown, but must not decide")

    @property
    def by_choice(self) -> dict[Key, bool | None]:
        """Whether the finding holds for each set of choices, that is, all of its judged parts hold."""
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

        - excluded: the equations of its own source exclude the claim, whatever the runs show;
        - shown: no number has a permitted range;
        - holds only if: it holds for some sets of choices and fails for others;
        - holds: it fails for none, and holds for the case file as it ships;
        - fails: it holds for none, and fails for the case file as it ships;
        - undecided: otherwise; intervals include a limit.
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
    def base_outcome(self) -> Outcome:
        """The verdict for the case file as it ships, whatever other settings show."""
        held = list(self.by_choice.values())
        if self.contradiction:
            return Outcome.EXCLUDED
        if not held:
            return Outcome.SHOWN if self.trials else Outcome.UNDECIDED
        return {True: Outcome.HOLDS, False: Outcome.FAILS, None: Outcome.UNDECIDED}[held[0]]

    @property
    def robustness(self) -> Robustness:
        """Share of the settings in which it holds."""
        return robustness(list(self.by_choice.values()))

    @property
    def deciding(self) -> Effect | None:
        """The free choice that decides whether it holds; None if no effect is more than chance."""
        found = effects(self.by_choice)
        return found[0] if found and found[0].significant else None

    @property
    def counts(self) -> dict[str, int]:
        """Number of sets of choices for which it holds, fails, and is undecided."""
        held = list(self.by_choice.values())
        return {"holds": held.count(True), "fails": held.count(False), "undecided": held.count(None)}

    @property
    def condition(self) -> str:
        """Choices for which it holds, in words, if it fails for others.

        Choices are listed one by one if every combination of their values holds; else the sets for which it
        holds are listed, by their differences from the case as it ships.
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
    """Values in words; adjacent values of a numerical sweep are joined to a range.

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
