"""Averages with a standard error from block averages and a check that the record is steady."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

STEADY_LIMIT = 3.0  # |drift| up to which a record counts as steady, in units of its own standard error


@dataclass(frozen=True)
class Average:
    """A mean and how far to trust it.

    Attributes
    ----------
    name, unit : what it is, and its SI unit ("-" when it has none).
    value : mean over all samples of all series.
    error : standard error of the mean from block averages; nan when fewer than two blocks exist.
    n : number of samples.
    n_series : number of independent series (starts) they come from.
    block : block length chosen [samples].
    n_blocks : number of blocks of that length.
    plateau : False when the series is too short for the block error to have stopped growing.
    window : begin and end of the record averaged over [s].
    drift : (mean of second halves - mean of first halves) over its standard error [-].
    """

    name: str
    unit: str
    value: float
    error: float
    n: int
    n_series: int
    block: int
    n_blocks: int
    plateau: bool
    window: tuple[float, float]
    drift: float

    @property
    def steady(self) -> bool:
        """True where first and second half differ by no more than chance explains."""
        return math.isfinite(self.drift) and abs(self.drift) <= STEADY_LIMIT

    def row(self) -> dict[str, object]:
        """One line of a CSV table."""
        return {
            "quantity": self.name,
            "unit": self.unit,
            "value": self.value,
            "standard_error": self.error,
            "n": self.n,
            "n_series": self.n_series,
            "block": self.block,
            "n_blocks": self.n_blocks,
            "plateau": self.plateau,
            "window_begin_s": self.window[0],
            "window_end_s": self.window[1],
            "drift": self.drift,
            "steady": self.steady,
        }


@dataclass(frozen=True)
class BlockError:
    """Standard error of a mean at the block length where it stopped growing."""

    error: float
    block: int
    n_blocks: int
    plateau: bool


def block_error(series: Sequence[ArrayLike], least: int = 4) -> BlockError:
    """Standard error of the mean of one or several series that may be correlated in themselves.

    Parameters
    ----------
    series : one array per independent start, in order of time; any unit, lengths may differ.
    least : fewest blocks, over all series, from which an error is taken.

    Notes
    -----
    Blocks of 1, 2, 4, ... neighbouring samples are averaged; the variance of those means, pooled over the
    series about the one grand mean, gives an error per block length. Taken is the shortest block b with
    b**3 > 2 n (s_b/s_1)**4 (Lee et al. 2011, Phys. Rev. E 83, 066706), which for uncorrelated samples is
    close to n**(1/3) and for correlated ones lies beyond the correlation length. Where no length fulfils
    this, the largest error found is returned and `plateau` is False.

    >>> block_error([[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]]).error
    0.0
    """
    arrays = [np.asarray(one, dtype=np.float64) for one in series]
    n = sum(len(one) for one in arrays)
    if n < 2:
        return BlockError(math.nan, 1, n, plateau=False)
    found: list[BlockError] = []
    block = 1
    while True:
        means = np.concatenate([_block_means(one, block) for one in arrays])
        if len(means) < max(least, 2) and found:
            break
        error = float(means.std(ddof=1) / math.sqrt(len(means))) if len(means) > 1 else math.nan
        found.append(BlockError(error, block, len(means), plateau=True))
        if found[0].error == 0.0 or not math.isfinite(error):
            return found[0]
        if block**3 > 2 * n * (error / found[0].error) ** 4:
            return found[-1]
        block *= 2
    worst = max(found, key=lambda one: one.error)
    return BlockError(worst.error, worst.block, worst.n_blocks, plateau=False)


def block_errors(columns: ArrayLike, least: int = 4) -> Floats:
    """Standard error of the mean of many quantities at once, each by the rule of `block_error`.

    Parameters
    ----------
    columns : one quantity per column, in order of time, shape (n, n_column).
    least : fewest blocks from which an error is taken.

    Returns
    -------
    Standard errors, shape (n_column,); nan where there are fewer than two rows.

    >>> block_errors([[1.0, 0.0], [1.0, 1.0]]).round(3)
    array([0. , 0.5])
    """
    rows = np.asarray(columns, dtype=np.float64)
    n, n_column = rows.shape
    taken = np.full(n_column, math.nan)
    if n < 2 or n_column == 0:
        return taken
    open_still = np.ones(n_column, dtype=np.bool_)
    worst, first, block = np.zeros(n_column), np.zeros(n_column), 1
    while block == 1 or n // block >= max(least, 2):
        count = n // block
        means = rows[n - count * block :].reshape(count, block, n_column).mean(axis=1)
        error = means.std(axis=0, ddof=1) / math.sqrt(count)
        if block == 1:
            first = error
        worst = np.maximum(worst, error)
        with np.errstate(divide="ignore", invalid="ignore"):
            done = open_still & ((block**3 > 2 * n * (error / first) ** 4) | (first == 0.0))
        taken[done] = error[done]
        open_still &= ~done
        block *= 2
    taken[open_still] = worst[open_still]
    return taken


def average(
    name: str, unit: str, series: Sequence[ArrayLike], window: tuple[float, float] = (math.nan, math.nan)
) -> Average:
    """Mean of one or several series, with standard error and steadiness.

    Parameters
    ----------
    name, unit : what the numbers are.
    series : one array per independent start, in order of time; nan entries are left out.
    window : begin and end of the record they come from [s].

    Notes
    -----
    The halves are those of each series by count, so that every start puts as many samples into the first as
    into the second (an odd one in the middle is left out). Their difference is set against the block errors
    of both.
    """
    arrays = [np.asarray(one, dtype=np.float64) for one in series]
    arrays = [one[np.isfinite(one)] for one in arrays]
    arrays = [one for one in arrays if len(one)]
    if not arrays:
        return Average(name, unit, math.nan, math.nan, 0, 0, 1, 0, False, window, math.nan)
    error = block_error(arrays)
    return Average(
        name=name,
        unit=unit,
        value=float(np.concatenate(arrays).mean()),
        error=error.error,
        n=sum(len(one) for one in arrays),
        n_series=len(arrays),
        block=error.block,
        n_blocks=error.n_blocks,
        plateau=error.plateau,
        window=window,
        drift=drift(arrays),
    )


def ratio(
    name: str,
    unit: str,
    above: Sequence[ArrayLike],
    below: Sequence[ArrayLike],
    window: tuple[float, float] = (math.nan, math.nan),
) -> Average:
    """Sum over all samples of `above` over the sum of `below`, such as length over time.

    Parameters
    ----------
    name, unit : what the quotient is.
    above, below : one array per independent start each, of equal lengths; finite.
    window : begin and end of the record they come from [s].

    Notes
    -----
    To first order the error of R = sum a / sum b is that of the mean of (a - R b), over the mean of b.
    """
    a = [np.asarray(one, dtype=np.float64) for one in above]
    b = [np.asarray(one, dtype=np.float64) for one in below]
    total = sum(float(one.sum()) for one in b)
    if total == 0.0:
        return average(name, unit, [], window)
    value = sum(float(one.sum()) for one in a) / total
    mean = total / sum(len(one) for one in b)
    rest = average(name, unit, [(p - value * q) / mean for p, q in zip(a, b, strict=True)], window)
    return replace(rest, value=value)


def drift(series: Sequence[ArrayLike]) -> float:
    """Mean of the second halves less that of the first, over its standard error [-]; nan if too short."""
    arrays = [np.asarray(one, dtype=np.float64) for one in series]
    first = [one[: len(one) // 2] for one in arrays if len(one) > 1]
    second = [one[len(one) - len(one) // 2 :] for one in arrays if len(one) > 1]
    if sum(len(one) for one in first) < 2:
        return math.nan
    difference = float(np.concatenate(second).mean() - np.concatenate(first).mean())
    spread = math.hypot(block_error(first).error, block_error(second).error)
    if spread == 0.0:
        return 0.0 if difference == 0.0 else math.copysign(math.inf, difference)
    return difference / spread


def _block_means(series: Floats, block: int) -> Floats:
    """Means of whole blocks; what is left over at the beginning (nearest the transient) is dropped."""
    count = len(series) // block
    return series[len(series) - count * block :].reshape(count, block).mean(axis=1) if count else np.zeros(0)
