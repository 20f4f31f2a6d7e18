"""From numbers to a verdict: intervals over seeds, the band a claim asks for, and one rule for all claims."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeVar

import numpy as np
from scipy import stats

CONFIDENCE = 0.95
Item = TypeVar("Item")
_NAMED = 3  # sets of choices named in a condition, at most


class Word(StrEnum):
    """The verdicts there are."""

    REPRODUCED = "reproduced"
    ONLY_IF = "reproduced only if"
    NOT = "not reproduced"
    CONTRADICTS = "contradicts its own equations"
    UNDECIDED = "undecided (spread)"
    LOST = "not testable (figure lost)"


@dataclass(frozen=True)
class Interval:
    """A number and how far it may be off."""

    value: float
    low: float
    high: float
    unit: str
    n: int  # seeds, or whatever `how` says
    how: str

    def __str__(self) -> str:
        if not math.isfinite(self.value):
            return "no number"
        unit = "" if self.unit == "-" else f" {self.unit}"
        middle, low, high = short(self.value), short(self.low), short(self.high)
        return f"{middle}{unit}" if low == high else f"{middle}{unit} ({low} to {high})"


def short(value: float) -> str:
    """Give three digits, and no power of ten where plain digits do.

    >>> short(1042.0), short(0.01049), short(2.0e-6)
    ('1042', '0.0105', '2e-06')
    """
    return f"{value:.0f}" if 1e3 <= abs(value) < 1e6 else f"{value:.3g}"


def over_seeds(values: Sequence[float], unit: str, pooled: "Pooled | None" = None) -> Interval:
    """Mean over seeds with its 95 % interval by Student's t.

    Parameters
    ----------
    values : one number per seed.
    unit : of the numbers.
    pooled : spread of all settings of a sweep, and its degrees of freedom; counts where the own standard
        deviation is no larger. Few seeds alone give an interval far too wide (n = 3: 2.5 standard deviations)
        or, by luck, far too narrow. A setting that scatters more than the others keeps its own.

    Notes
    -----
    One seed has no interval: low, value and high are the same and the row is indicative. A value that is not
    finite makes all three nan.

    >>> str(over_seeds([1.0, 2.0, 3.0], "m"))
    '2 m (-0.484 to 4.48)'
    """
    numbers = np.asarray(values, dtype=np.float64)
    n = len(numbers)
    if n == 0 or not np.all(np.isfinite(numbers)):
        return Interval(math.nan, math.nan, math.nan, unit, n, f"mean of {n} seeds")
    mean = float(numbers.mean())
    if n == 1:
        return Interval(mean, mean, mean, unit, 1, "one seed, no interval")
    spread, freedom = float(numbers.std(ddof=1)), n - 1
    how = f"95 % of the mean of {n} seeds, Student's t"
    if pooled is not None and pooled.freedom > freedom and pooled.spread >= spread:
        spread, freedom = pooled.spread, pooled.freedom
        how += f", spread pooled over the sweep ({freedom} degrees of freedom)"
    half = float(stats.t.ppf(0.5 + CONFIDENCE / 2, freedom)) * spread / math.sqrt(n)
    return Interval(mean, mean - half, mean + half, unit, n, how)


def pseudo_values(value: Callable[[Sequence[Item]], float], items: Sequence[Item]) -> list[float]:
    """Jackknife: one number per item for a value that all items have together.

    Their mean is the value freed of its bias of order 1/n (Quenouille 1956, Biometrika 43, 353), their
    scatter gives its error (Tukey 1958, Ann. Math. Stat. 29, 614). For a plain mean they are the items.

    >>> pseudo_values(lambda x: sum(x) / len(x), [1.0, 2.0, 6.0])
    [1.0, 2.0, 6.0]
    """
    n, whole = len(items), value(items)
    if n < 2:
        return [whole]
    return [n * whole - (n - 1) * value([*items[:k], *items[k + 1 :]]) for k in range(n)]


@dataclass(frozen=True)
class Pooled:
    """Standard deviation within the settings of a sweep, and its degrees of freedom."""

    spread: float
    freedom: int


def pool(groups: Sequence[Sequence[float]]) -> Pooled | None:
    """Pool the spread between seeds over settings; None where no setting has two finite numbers.

    >>> pool([[1.0, 3.0], [5.0, 7.0]])
    Pooled(spread=1.4142135623730951, freedom=2)
    """
    kept = [np.asarray(one, dtype=np.float64) for one in groups]
    kept = [one for one in kept if len(one) > 1 and np.all(np.isfinite(one))]
    freedom = sum(len(one) - 1 for one in kept)
    if freedom == 0:
        return None
    return Pooled(math.sqrt(sum(float(((one - one.mean()) ** 2).sum()) for one in kept) / freedom), freedom)


def over_range(values: Sequence[float], unit: str, of_what: str) -> Interval:
    """Middle and range of numbers without chance in them; `of_what` such as "12 impact speeds".

    >>> str(over_range([1.0, 2.0, 4.0], "s", "3 speeds"))
    '2 s (1 to 4)'
    """
    numbers = np.asarray(values, dtype=np.float64)
    if len(numbers) == 0 or not np.all(np.isfinite(numbers)):
        return Interval(math.nan, math.nan, math.nan, unit, len(numbers), f"range over {of_what}")
    low, high = float(numbers.min()), float(numbers.max())
    return Interval(float(np.median(numbers)), low, high, unit, len(numbers), f"range over {of_what}")


@dataclass(frozen=True)
class Band:
    """What a claim asks of a number, as an inequality; either end may be infinite."""

    low: float
    high: float
    unit: str
    says: str  # how the paper's words became numbers

    def holds(self, found: Interval) -> bool | None:
        """True with the whole interval inside, False with all of it outside, None where it straddles."""
        if not (math.isfinite(found.low) and math.isfinite(found.high)):
            return None
        if self.low <= found.low and found.high <= self.high:
            return True
        if found.high < self.low or found.low > self.high:
            return False
        return None


@dataclass(frozen=True)
class Trial:
    """One part of a claim under one set of free choices.

    Attributes
    ----------
    part : what was measured, such as "slope of the heap at rest".
    choices : every free choice that is varied, by name; the same names in every trial of a claim.
    found, band : the number, and what the claim asks of it.
    decided : verdict where no number can carry it, such as a heap that stands as a wall; `note` says why.
    """

    part: str
    choices: Mapping[str, str]
    found: Interval
    band: Band
    decided: bool | None = None
    note: str = ""

    @property
    def holds(self) -> bool | None:
        """Whether this part holds; None where it cannot be told."""
        return self.decided if self.decided is not None else self.band.holds(self.found)


Key = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Finding:
    """What became of one claim.

    Attributes
    ----------
    claim : id of `paper.CLAIMS`.
    trials : every setting tried; those of the base, as the case file ships, come first.
    decided_by : one or two sentences on the physics that decides it.
    settings : what all trials share, in words.
    contradiction : set where the paper's own equations exclude the claim; says how, with the numbers found.
    also : numbers that belong to the story and decide nothing.
    beside : trials of something else than what the claim is about, such as other forms of a law.
    """

    claim: str
    trials: tuple[Trial, ...]
    decided_by: str
    settings: Mapping[str, str] = field(default_factory=dict[str, str])
    contradiction: str = ""
    also: tuple[str, ...] = ()
    beside: tuple[Trial, ...] = ()

    @property
    def by_choice(self) -> dict[Key, bool | None]:
        """Whether the claim holds under each set of choices: every part must."""
        parts: dict[Key, list[bool | None]] = {}
        for one in self.trials:
            parts.setdefault(tuple(one.choices.items()), []).append(one.holds)
        return {
            key: False if False in held else None if None in held else True for key, held in parts.items()
        }

    @property
    def word(self) -> Word:
        """The verdict: one rule for every claim.

        It holds under some sets of choices and fails under others: reproduced only if. It fails under none
        and holds as the case file ships: reproduced. It holds under none and fails as the case ships: not
        reproduced. Else the intervals straddle the line: undecided. A claim that the paper's own equations
        exclude contradicts them, whatever the runs say. `counts` says how many sets are behind it.
        """
        if self.contradiction:
            return Word.CONTRADICTS
        held = list(self.by_choice.values())
        if not held:
            return Word.UNDECIDED
        if True in held and False in held:
            return Word.ONLY_IF
        if held[0] is None:
            return Word.UNDECIDED
        return Word.REPRODUCED if held[0] else Word.NOT

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
        if self.word is not Word.ONLY_IF:
            return ""
        tried = {name: list(dict.fromkeys(dict(key)[name] for key in held)) for name in good[0]}
        fits = {
            name: [v for v in values if any(one[name] == v for one in good)] for name, values in tried.items()
        }
        inside = [one for key, one in held.items() if all(value in fits[name] for name, value in key)]
        if False not in inside:
            told = [
                f"{name} {_listed(fits[name], tried[name])}" for name in tried if fits[name] != tried[name]
            ]
        else:
            first = dict(next(iter(held)))
            sets = [", ".join(f"{k} {v}" for k, v in one.items() if v != first[k]) for one in good]
            told = [" or ".join(one or "as it ships" for one in sets[:_NAMED])]
            told += [f"or {len(sets) - _NAMED} more"] if len(sets) > _NAMED else []
        return f"{'; '.join(told)} ({len(good)} of {len(held)} settings)"

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
