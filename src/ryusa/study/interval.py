"""Numbers with intervals: means over seeds, ranges, and the pooled spread of a sweep."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

CONFIDENCE = 0.95
Item = TypeVar("Item")


@dataclass(frozen=True)
class Interval:
    """A number with its interval of uncertainty."""

    value: float
    low: float
    high: float
    unit: str
    n: int  # number of seeds, or of the items named in `how`
    how: str

    def __str__(self) -> str:
        if not math.isfinite(self.value):
            return "no number"
        unit = "" if self.unit == "-" else f" {self.unit}"
        middle, low, high = short(self.value), short(self.low), short(self.high)
        return f"{middle}{unit}" if low == high else f"{middle}{unit} ({low} to {high})"


def short(value: float) -> str:
    """Return a number with three significant digits, without an exponent from 1000 to 1e6.

    >>> short(1042.0), short(0.01049), short(2.0e-6)
    ('1042', '0.0105', '2e-06')
    """
    return f"{value:.0f}" if 1e3 <= abs(value) < 1e6 else f"{value:.3g}"


def exact(value: float, unit: str) -> Interval:
    """Return a number without an interval, such as the largest difference between two curves.

    >>> str(exact(0.02, "m/s"))
    '0.02 m/s'
    """
    return Interval(value, value, value, unit, 1, "one number, no interval")


def over_seeds(
    values: Sequence[float],
    unit: str,
    pooled: "Pooled | None" = None,
    confidence: float = CONFIDENCE,
    *,
    alike: bool = False,
) -> Interval:
    """Mean over seeds with its interval by Student's t, of 95 % unless another confidence is given.

    Parameters
    ----------
    values : one number per seed.
    unit : unit of the numbers.
    pooled : spread of all settings of a sweep, with its degrees of freedom; used unless the standard
        deviation of `values` is larger. With few seeds alone the interval is far too wide (n = 3: 2.5
        standard deviations) or, by chance, far too narrow.
    confidence : probability that the interval covers the mean.
    alike : use the pooled spread even if that of `values` is larger.

    Notes
    -----
    One seed has no interval: low, value and high are equal, and the result is indicative. If a value is not
    finite, all three are nan.

    >>> str(over_seeds([1.0, 2.0, 3.0], "m"))
    '2 m (-0.484 to 4.48)'
    """
    from scipy import stats

    numbers = np.asarray(values, dtype=np.float64)
    n = len(numbers)
    if n == 0 or not np.all(np.isfinite(numbers)):
        return Interval(math.nan, math.nan, math.nan, unit, n, f"mean of {n} seeds")
    mean = float(numbers.mean())
    if n == 1:
        return Interval(mean, mean, mean, unit, 1, "one seed, no interval")
    spread, freedom = float(numbers.std(ddof=1)), n - 1
    how = f"{100 * confidence:.3g} % of the mean of {n} seeds, Student's t"
    if pooled is not None and pooled.freedom > freedom and (alike or pooled.spread >= spread):
        spread, freedom = pooled.spread, pooled.freedom
        how += f", spread pooled over the sweep ({freedom} degrees of freedom)"
    half = float(stats.t.ppf(0.5 + confidence / 2, freedom)) * spread / math.sqrt(n)
    return Interval(mean, mean - half, mean + half, unit, n, how)


def largest_mean(
    groups: Sequence[Sequence[float]], unit: str, pooled: "Pooled | None" = None, *, absolute: bool = False
) -> Interval:
    """Interval of the largest of several means, such as the errors at several slopes.

    Parameters
    ----------
    groups : numbers of every seed, by member.
    unit : unit of the numbers.
    pooled : spread of all members alike (`pool_alike`), which replaces that of each; None for their own. With
        few seeds the own spread of one of many members is, by chance, far too large or too small.
    absolute : take the magnitudes of the means, which are positive.

    Notes
    -----
    The intervals of all k members cover their means together with 95 % (Bonferroni: each has 1 - 0.05/k), and
    the largest mean then lies between the largest lower and the largest upper limit. The mean of the largest
    numbers of single seeds would be too large, because it picks the noise.

    >>> largest_mean([[1.0], [-3.0]], "-", absolute=True).value
    3.0
    """
    confidence = 1.0 - (1.0 - CONFIDENCE) / len(groups)
    each = [over_seeds(one, unit, pooled, confidence, alike=pooled is not None) for one in groups]
    if absolute:
        each = [magnitude(one) for one in each]
    value, low, high = (max((getattr(one, end) for one in each), key=_nan_last) for end in _ENDS)
    how = each[0].how if len(groups) == 1 else f"largest of {len(groups)}, each {each[0].how}"
    return Interval(value, low, high, unit, each[0].n, how)


_ENDS = ("value", "low", "high")


def _nan_last(value: float) -> float:
    return math.inf if math.isnan(value) else value


def magnitude(found: Interval) -> Interval:
    """Interval of the magnitude of a number.

    >>> magnitude(Interval(-0.1, -0.4, 0.2, "-", 3, ""))
    Interval(value=0.1, low=0.0, high=0.4, unit='-', n=3, how='')
    """
    low = max(0.0, found.low, -found.high) if math.isfinite(found.low) else found.low
    return Interval(
        abs(found.value), low, max(abs(found.low), abs(found.high)), found.unit, found.n, found.how
    )


def not_negative(found: Interval) -> Interval:
    """The part of an interval that a number which cannot be negative may have.

    >>> not_negative(Interval(0.1, -0.2, 0.4, "-", 3, "")).low
    0.0
    """
    if math.isnan(found.low):
        return found
    value, low, high = (max(0.0, end) for end in (found.value, found.low, found.high))
    return Interval(value, low, high, found.unit, found.n, found.how)


def transformed(found: Interval, by: Callable[[float], float], unit: str, how: str) -> Interval:
    """Interval of an increasing function of a number, such as a factor from its logarithm; `how` says which.

    >>> transformed(exact(0.0, "-"), math.exp, "-", "geometric").value
    1.0
    """
    value, low, high = (by(end) for end in (found.value, found.low, found.high))
    return Interval(value, low, high, unit, found.n, f"{how}, {found.how}")


def pseudo_values(value: Callable[[Sequence[Item]], float], items: Sequence[Item]) -> list[float]:
    """Jackknife pseudo-values: one number per item for a statistic of all items.

    Their mean is the statistic without its bias of order 1/n (Quenouille 1956, Biometrika 43, 353), and their
    scatter gives its error (Tukey 1958, Ann. Math. Stat. 29, 614). For a mean they are the items themselves.

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
    """Pool the spread between seeds over settings; None if no setting has two finite numbers.

    >>> pool([[1.0, 3.0], [5.0, 7.0]])
    Pooled(spread=1.4142135623730951, freedom=2)
    """
    kept = [np.asarray(one, dtype=np.float64) for one in groups]
    kept = [one for one in kept if len(one) > 1 and np.all(np.isfinite(one))]
    freedom = sum(len(one) - 1 for one in kept)
    if freedom == 0:
        return None
    return Pooled(math.sqrt(sum(float(((one - one.mean()) ** 2).sum()) for one in kept) / freedom), freedom)


def pool_alike(groups: Sequence[Sequence[float]]) -> Pooled | None:
    """Pool the spread between seeds if the settings scatter alike; None if they do not.

    Bartlett's test at 5 % tells them apart (Bartlett 1937, Proc. R. Soc. A 160, 268).

    >>> pool_alike([[1.0, 3.0], [5.0, 7.0]])
    Pooled(spread=1.4142135623730951, freedom=2)
    >>> pool_alike([[0.0, 90.0, 50.0], [0.1, 0.2, 0.1]]) is None
    True
    """
    from scipy import stats

    if not np.isfinite(groups).all():
        return None
    spread = [float(np.std(one)) for one in groups]
    if min(spread) == 0.0:
        return pool(groups) if max(spread) == 0.0 else None
    if len(groups) > 1 and float(stats.bartlett(*groups).pvalue) < 1.0 - CONFIDENCE:
        return None
    return pool(groups)


def over_range(values: Sequence[float], unit: str, of_what: str) -> Interval:
    """Median and range of deterministic numbers; `of_what` names them, such as "12 impact speeds".

    >>> str(over_range([1.0, 2.0, 4.0], "s", "3 speeds"))
    '2 s (1 to 4)'
    """
    numbers = np.asarray(values, dtype=np.float64)
    if len(numbers) == 0 or not np.all(np.isfinite(numbers)):
        return Interval(math.nan, math.nan, math.nan, unit, len(numbers), f"range over {of_what}")
    low, high = float(numbers.min()), float(numbers.max())
    return Interval(float(np.median(numbers)), low, high, unit, len(numbers), f"range over {of_what}")
