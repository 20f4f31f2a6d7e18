"""A verdict in three parts: the base case, how many settings it holds in, and the choice that decides it."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from ryusa.study.interval import CONFIDENCE

SIGNIFICANT = 1.0 - CONFIDENCE
RESAMPLES = 1999  # of a table with more than two rows

Key = tuple[tuple[str, str], ...]  # a setting: each free choice and its value
Held = TypeVar("Held")


@dataclass(frozen=True)
class Count:
    """Settings in which a finding holds, of all that were run.

    Attributes
    ----------
    holds : settings in which it holds.
    of : all settings that were run, each counted once, however often its runs are read.
    undecided : settings whose interval includes a limit; they are among `of`.
    """

    holds: int = 0
    of: int = 0
    undecided: int = 0

    @property
    def fails(self) -> int:
        """Settings in which it fails."""
        return self.of - self.holds - self.undecided

    def in_words(self, what: str = "settings", unsure: str = " ({} undecided)") -> str:
        """Share with its undecided settings, which are never left out.

        >>> Count(10, 17, 4).in_words(), Count(0, 4).in_words("others")
        ('10 of 17 settings (4 undecided)', 'none of 4 others')
        """
        named = what.removesuffix("s") if self.of == 1 else what
        return f"{self.holds or 'none'} of {self.of} {named}" + (
            unsure.format(self.undecided) if self.undecided else ""
        )


@dataclass(frozen=True)
class Robustness(Count):
    """Share of the settings in which a finding holds.

    Attributes
    ----------
    low, high : 95 % interval of the share by Wilson's score; 0 and 1 if none was run. An undecided setting
        may hold or fail: at the low end all of them fail, at the high end all of them hold.
    """

    low: float = 0.0
    high: float = 1.0


@dataclass(frozen=True)
class Effect:
    """Effect of a free choice on whether a finding holds.

    Attributes
    ----------
    choice : its name.
    p : probability of a table as uneven as this one if the choice had no effect, after correction.
    levels : values at which it holds more often than on average.
    inside, outside : settings with these levels and without; for a reading, settings read so and otherwise.
    confirmed : probability on the second half of the data, for the levels predicted from the first half.
    reading : whether the choice is another reading of the same runs.
    """

    choice: str
    p: float
    levels: tuple[str, ...]
    inside: Count
    outside: Count
    confirmed: float = math.nan
    reading: bool = False

    @property
    def significant(self) -> bool:
        """Whether the effect is more than chance, at 95 % for all choices together."""
        return self.p < SIGNIFICANT

    @property
    def decides(self) -> bool:
        """Whether the finding holds in most settings with these levels, and fails in all without.

        An undecided setting is neither: it does not count for "most", and it may hold, so that "only if" is
        not shown where one lacks these levels.
        """
        return 2 * self.inside.holds > self.inside.of and self.outside.fails == self.outside.of

    def in_words(self, tried: Sequence[str]) -> str:
        """The choice and its levels, with the share of the settings with them and without.

        Parameters
        ----------
        tried : all values of the choice.

        >>> Effect("slip", 0.01, ("total",), Count(5, 9, 4), Count(0, 8)).in_words(["spring", "total"])
        'slip total (5 of 9 settings, 4 undecided; none of 8 others)'
        """
        inside = self.inside.in_words(unsure=", {} undecided")
        outside = self.outside.in_words("read otherwise" if self.reading else "others", ", {} undecided")
        between = "; " if self.inside.undecided or self.outside.undecided else ", "
        return f"{self.choice} {_listed(self.levels, tried)} ({inside}{between}{outside})"


def robustness(held: Sequence[bool | None]) -> Robustness:
    """Count settings.

    Parameters
    ----------
    held : for each setting whether the finding holds; None if undecided.

    Notes
    -----
    Source: E. B. Wilson (1927), J. Am. Stat. Assoc. 22, 209.

    >>> found = robustness([True, True, False, None])
    >>> found.holds, found.of, found.undecided, round(found.low, 2), round(found.high, 2)
    (2, 4, 1, 0.15, 0.95)
    """
    from scipy import stats

    count = counted(held)
    if count.of == 0:
        return Robustness()
    least, most = (
        stats.binomtest(holds, count.of).proportion_ci(CONFIDENCE, method="wilson")
        for holds in (count.holds, count.of - count.fails)
    )
    return Robustness(count.holds, count.of, count.undecided, float(least.low), float(most.high))


def counted(held: Collection[bool | None]) -> Count:
    """Count what became of every setting; None is undecided."""
    every = list(held)
    return Count(every.count(True), len(every), every.count(None))


def held_of(trials: Sequence[Mapping[str, Any]]) -> dict[Key, bool | None]:
    """Whether a finding holds in each setting and reading, from its trials as the JSON file has them.

    Every part that is judged must hold.
    """
    parts: dict[Key, list[str]] = {}
    for one in trials:
        if one["outcome"] != "shown":
            parts.setdefault(tuple(one["choices"].items()), []).append(one["outcome"])
    return {
        key: False if "fails" in got else None if "undecided" in got else True for key, got in parts.items()
    }


def first_reading(held: Mapping[Key, Held], readings: Collection[str]) -> dict[Key, Held]:
    """Settings by the first reading of their runs: another reading of the same runs is no further sample.

    Parameters
    ----------
    held : by setting what became of a finding, the case as it ships first.
    readings : names of the choices that are readings of the same runs.
    """
    chosen = {name: value for name, value in next(iter(held), ()) if name in readings}
    return {key: one for key, one in held.items() if chosen.items() <= dict(key).items()}


def effects(held: Mapping[Key, bool | None], readings: Collection[str] = ()) -> list[Effect]:
    """Effect of each free choice on whether a finding holds, the strongest first.

    Parameters
    ----------
    held : by setting whether the finding holds; every setting names the same choices.
    readings : names of the choices that are readings of the same runs. The other choices are tested by the
        first reading alone, whose settings are independent; a reading, by all.

    Notes
    -----
    The test leaves undecided settings out; `inside` and `outside` count them. A choice that does not vary
    among the others has no effect to show. The table of its values against holds and fails is tested exactly,
    by permutation where it has more than two rows, which needs no number of settings to be large; the
    probabilities are corrected for the number of choices (Holm 1979, Scand. J. Stat. 6, 65).
    """
    found: list[Effect] = []
    for name, _ in next(iter(held), ()):
        decided = {key: one for key, one in _tested(held, name, readings).items() if one is not None}
        if not decided:
            continue
        values = list(dict.fromkeys(dict(key)[name] for key in decided))
        counts = _counted(decided, name, values)
        if len(values) < 2 or not counts.sum(axis=0).all():
            continue
        levels = _favourable(counts, values)
        shares = settings_within(held, name, levels, readings)
        found.append(Effect(name, _probability(counts), levels, *shares, reading=name in readings))
    return _corrected(found)


def _tested(
    held: Mapping[Key, bool | None], name: str, readings: Collection[str]
) -> Mapping[Key, bool | None]:
    """Settings on which a choice is tested."""
    return held if name in readings else first_reading(held, readings)


def deciding(
    held: Mapping[Key, bool | None],
    first: Mapping[Key, bool | None],
    second: Mapping[Key, bool | None],
    readings: Collection[str] = (),
) -> Effect | None:
    """Return the choice that decides whether a finding holds; None if there is none beyond chance.

    Parameters
    ----------
    held : by setting whether the finding holds, from all data.
    first, second : the same from each half of the data.
    readings : as in `effects`.

    Notes
    -----
    Its effect is significant from all data after correction for the number of choices; the levels at which
    the finding holds are predicted from the first half alone, and the second half confirms them: it holds
    there more often than elsewhere by Fisher's test, one-sided, at 5 %.
    """
    from scipy import stats

    for one in effects(held, readings):
        if not one.significant:
            return None
        here, there, whole = (_tested(each, one.choice, readings) for each in (first, second, held))
        values = list(dict.fromkeys(dict(key)[one.choice] for key in whole))
        levels = _favourable(_counted(here, one.choice, values), values)
        table = _within(there, one.choice, levels)
        confirmed: Any = stats.fisher_exact(table, alternative="greater")
        if float(confirmed.pvalue) < SIGNIFICANT:
            inside, outside = settings_within(held, one.choice, levels, readings)
            return replace(
                one, levels=levels, inside=inside, outside=outside, confirmed=float(confirmed.pvalue)
            )
    return None


def _counted(held: Mapping[Key, bool | None], name: str, values: Sequence[str]) -> np.ndarray:
    """Settings in which a finding holds and fails, by the value of a choice."""
    counts = np.zeros((len(values), 2), dtype=np.int64)
    for key, here in held.items():
        if here is not None:
            counts[values.index(dict(key)[name]), 0 if here else 1] += 1
    return counts


def _favourable(counts: np.ndarray, values: Sequence[str]) -> tuple[str, ...]:
    """Values at which a finding holds more often than on average."""
    holds, of = counts[:, 0], counts.sum(axis=1)
    return tuple(
        value for value, yes, n in zip(values, holds, of, strict=True) if yes * of.sum() > holds.sum() * n
    )


def _within(held: Mapping[Key, bool | None], name: str, levels: Sequence[str]) -> list[list[int]]:
    """Table for Fisher's test: holds and fails, with these levels of a choice and with others."""
    parts = [
        [one for key, one in held.items() if (dict(key)[name] in levels) is there] for there in (True, False)
    ]
    return [[one.count(True), one.count(False)] for one in parts]


def settings_within(
    held: Mapping[Key, bool | None], name: str, levels: Collection[str], readings: Collection[str]
) -> tuple[Count, Count]:
    """Settings in which a finding holds with these levels of a choice, and without them.

    Parameters
    ----------
    held, readings : as in `effects`.
    name : the choice. Of a reading, several levels belong to one setting: it holds with the levels if it
        holds by each of them, and it holds without them if it does by any other.
    levels : its levels.
    """
    here: dict[Key, list[bool | None]] = {}
    there: dict[Key, list[bool | None]] = {}
    for key, one in first_reading(held, set(readings) - {name}).items():
        setting = tuple(each for each in key if each[0] not in readings)
        (here if dict(key)[name] in levels else there).setdefault(setting, []).append(one)
    every = [False if False in got else None if None in got else True for got in here.values()]
    some = [True if True in got else None if None in got else False for got in there.values()]
    return counted(every), counted(some)


def _probability(counts: np.ndarray) -> float:
    """Probability of a table of values against holds and fails at least as uneven, both margins kept."""
    from scipy import stats

    chance = stats.PermutationMethod(n_resamples=RESAMPLES, rng=np.random.default_rng(1))
    tested: Any = stats.fisher_exact(counts, method=None if len(counts) == 2 else chance)
    return float(tested.pvalue)


def _corrected(found: list[Effect]) -> list[Effect]:
    """Correct the probabilities for the number of effects, after Holm."""
    ordered = sorted(found, key=lambda one: one.p)
    p, corrected = 0.0, []
    for rank, one in enumerate(ordered):
        p = max(p, min(1.0, one.p * (len(ordered) - rank)))
        corrected.append(replace(one, p=p))
    return corrected


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
