"""From numbers to a verdict: permitted ranges, settings, and one rule for all studies."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property

from ryusa.figures.comparison import Axis, Curve
from ryusa.study.interval import Interval, Pooled, exact, over_seeds
from ryusa.study.verdict import Effect, Key, Robustness, deciding, first_reading, robustness


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
    halves : whether it holds by the mean of each half of the seeds; None where no seed enters it.
    """

    part: str
    choices: Mapping[str, str]
    found: Interval
    band: Band | None
    decided: bool | None = None
    note: str = ""
    halves: tuple[bool | None, bool | None] | None = None

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


def seeds_trial(
    part: str,
    choices: Mapping[str, str],
    values: Sequence[float],
    band: Band,
    pooled: Pooled | None = None,
) -> Trial:
    """Return the trial of a mean over seeds.

    Parameters
    ----------
    part, choices, band : as in `Trial`.
    values : one number per seed, in the order of the seeds. Those at even and at odd places are the halves of
        the seeds on which a condition is predicted and confirmed.
    pooled : spread of all settings of a sweep, as in `over_seeds`.
    """
    one, other = (_by_mean(values[half::2], band) for half in (0, 1))
    return Trial(part, choices, over_seeds(values, band.unit, pooled), band, halves=(one, other))


def _by_mean(values: Sequence[float], band: Band) -> bool | None:
    return band.holds(exact(math.fsum(values) / len(values), band.unit)) if values else None


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
    readings : names of the choices that are readings of the same runs (a window of time, a definition); their
        values are no further settings.

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
    readings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a judgement that is based on a reference known only from memory."""
        from_memory = self.source is not None and self.source.known is Known.MEMORY
        if from_memory and any(one.judged for one in self.trials):
            raise ValueError(f"{self.id}: a reference from memory may be shown, but must not decide")

    @property
    def by_choice(self) -> dict[Key, bool | None]:
        """Whether the finding holds for each set of choices, that is, all of its judged parts hold."""
        return self._by_choice([(one, one.holds) for one in self.trials])

    @property
    def by_setting(self) -> dict[Key, bool | None]:
        """`by_choice` by the first reading of the runs."""
        return first_reading(self.by_choice, self.readings)

    @property
    def has_seeds(self) -> bool:
        """Whether seeds enter a judged number; else nothing in it is drawn at random."""
        return any(one.judged and one.halves is not None for one in self.trials)

    def by_half(self, half: int) -> dict[Key, bool | None]:
        """`by_choice` from one half of the data: the first (0) or the second (1).

        Halves of the seeds; where no seed enters, every other setting, with all readings of its runs.
        """
        if self.has_seeds:
            return self._by_choice(
                [(one, one.holds if one.halves is None else one.halves[half]) for one in self.trials]
            )
        held = self.by_choice
        settings = list(dict.fromkeys(self._setting(key) for key in held))
        return {key: one for key, one in held.items() if settings.index(self._setting(key)) % 2 == half}

    def _setting(self, key: Key) -> Key:
        return tuple(one for one in key if one[0] not in self.readings)

    def _by_choice(self, trials: Sequence[tuple[Trial, bool | None]]) -> dict[Key, bool | None]:
        parts: dict[Key, list[bool | None]] = {}
        for one, holds in trials:
            if one.judged:
                parts.setdefault(tuple(one.choices.items()), []).append(holds)
        return {
            key: False if False in held else None if None in held else True for key, held in parts.items()
        }

    @property
    def outcome(self) -> Outcome:
        """The verdict: one rule for every finding of every study.

        - excluded: the equations of its own source exclude the claim, whatever the runs show;
        - shown: no number has a permitted range;
        - holds only if: the case file as it ships is not undecided, and one choice decides (`deciding`): it
          holds in most settings with the levels named, and fails in all without;
        - holds, fails, undecided: otherwise, for the case file as it ships. `robustness` says in how many
          settings it holds.
        """
        return outcome_of(self.base_outcome, self.deciding)

    @property
    def base_outcome(self) -> Outcome:
        """The verdict for the case file as it ships, whatever other settings show."""
        if self.contradiction:
            return Outcome.EXCLUDED
        return base_outcome_of(self.by_choice, bool(self.trials))

    @property
    def robustness(self) -> Robustness:
        """Share of the settings in which it holds, by the first reading of their runs."""
        return robustness(list(self.by_setting.values()))

    @cached_property
    def deciding(self) -> Effect | None:
        """The free choice that decides whether it holds; None if there is none beyond chance."""
        return deciding(self.by_choice, self.by_half(0), self.by_half(1), self.readings)

    @property
    def counts(self) -> dict[str, int]:
        """Number of settings and readings for which it holds, fails, and is undecided."""
        held = list(self.by_choice.values())
        return {"holds": held.count(True), "fails": held.count(False), "undecided": held.count(None)}

    @property
    def condition(self) -> str:
        """Levels of the deciding choice at which it holds, in words, if it holds at no other."""
        one = self.deciding
        return "" if self.outcome is not Outcome.ONLY_IF or one is None else one.in_words(self.tried(one))

    def tried(self, effect: Effect) -> list[str]:
        """All values of a choice that were tried."""
        return list(dict.fromkeys(dict(key)[effect.choice] for key in self.by_choice))

    @property
    def base(self) -> tuple[Trial, ...]:
        """Trials of the case file as it ships."""
        first = self.trials[0].choices if self.trials else {}
        return tuple(one for one in self.trials if one.choices == first)


def base_outcome_of(held: Mapping[Key, bool | None], measured: bool) -> Outcome:
    """Outcome of the case file as it ships, the first of `held`; `measured`: there is a number at all."""
    if not held:
        return Outcome.SHOWN if measured else Outcome.UNDECIDED
    first = next(iter(held.values()))
    return {True: Outcome.HOLDS, False: Outcome.FAILS, None: Outcome.UNDECIDED}[first]


def outcome_of(base: Outcome, effect: Effect | None) -> Outcome:
    """Outcome of a finding from that of the case file as it ships and the choice that decides.

    Where the case as it ships is undecided, nothing is said to hold: no choice makes a verdict of that.
    """
    decided = base in (Outcome.HOLDS, Outcome.FAILS)
    return Outcome.ONLY_IF if decided and effect is not None and effect.decides else base
