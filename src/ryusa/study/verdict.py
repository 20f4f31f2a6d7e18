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
class Robustness:
    """Share of the settings in which a finding holds.

    Attributes
    ----------
    holds, of : settings in which it holds, of those that are decided.
    undecided : settings whose interval includes a limit; they are in neither number.
    low, high : 95 % interval of the share by Wilson's score; 0 and 1 if none is decided.
    """

    holds: int
    of: int
    undecided: int
    low: float
    high: float


@dataclass(frozen=True)
class Effect:
    """Effect of a free choice on whether a finding holds.

    Attributes
    ----------
    choice : its name.
    p : probability of a table as uneven as this one if the choice had no effect, after correction.
    levels : values at which it holds more often than on average.
    inside, outside : settings in which it holds, and those that are decided, with these levels and without.
    confirmed : probability on the second half of the data, for the levels predicted from the first half.
    """

    choice: str
    p: float
    levels: tuple[str, ...]
    inside: tuple[int, int]
    outside: tuple[int, int]
    confirmed: float = math.nan

    @property
    def significant(self) -> bool:
        """Whether the effect is more than chance, at 95 % for all choices together."""
        return self.p < SIGNIFICANT

    @property
    def decides(self) -> bool:
        """Whether the finding holds in most settings with these levels, and in none without."""
        return 2 * self.inside[0] > self.inside[1] and self.outside[0] == 0


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
    (2, 3, 1, 0.21, 0.94)
    """
    from scipy import stats

    holds, of = held.count(True), len(held) - held.count(None)
    if of == 0:
        return Robustness(0, 0, len(held), 0.0, 1.0)
    share = stats.binomtest(holds, of).proportion_ci(CONFIDENCE, method="wilson")
    return Robustness(holds, of, held.count(None), float(share.low), float(share.high))


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
    Undecided settings are left out. A choice that does not vary among the others has no effect to show. The
    table of its values against holds and fails is tested exactly, by permutation where it has more than two
    rows, which needs no number of settings to be large; the probabilities are corrected for the number of
    choices (Holm 1979, Scand. J. Stat. 6, 65).
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
        found.append(Effect(name, _probability(counts), levels, *_within(decided, name, levels)))
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
        inside, outside = _within(there, one.choice, levels)
        table = [[inside[0], inside[1] - inside[0]], [outside[0], outside[1] - outside[0]]]
        confirmed: Any = stats.fisher_exact(table, alternative="greater")
        if float(confirmed.pvalue) < SIGNIFICANT:
            inside, outside = _within(whole, one.choice, levels)
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


def _within(
    held: Mapping[Key, bool | None], name: str, levels: Sequence[str]
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Settings in which it holds, of those decided, with these levels of a choice and with others."""
    parts = [
        [one for key, one in held.items() if (dict(key)[name] in levels) is there] for there in (True, False)
    ]
    there, elsewhere = ((one.count(True), len(one) - one.count(None)) for one in parts)
    return there, elsewhere


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
