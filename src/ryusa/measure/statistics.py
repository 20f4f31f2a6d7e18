"""Averages of correlated records, with a standard error and a test whether the record is steady."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ryusa.measure.steadiness import LIMIT, PARTS, WAVES, block_means, compare_quarters, merged, truncation

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ENOUGH = 20.0  # independent samples below which a record is too short for its error and its steadiness
STAR = f"* worth fewer than {ENOUGH:g} independent samples: the error may be larger"
START = 8  # frequencies of the first estimate of the noise
FEWEST = 4  # frequencies at least
SHARE = 0.25  # frequencies for each independent sample
ROUNDS = 3  # estimates of the number of independent samples, each from the one before
ONE_SIGMA = 0.5 * (1.0 + math.erf(math.sqrt(0.5)))  # normal distribution at one standard deviation [-]
DRIFTS = 1.0  # drift that is named where a record changes, in standard errors of its mean
APART = 0.95  # starts differ where chance explains less than the rest


@dataclass(frozen=True, repr=False)
class Average:
    """A mean and how far to trust it.

    Attributes
    ----------
    name, unit : what it is, and its SI unit ("-" when it has none).
    value : mean over all samples of all series.
    error : standard error of the mean, see `standard_error`; nan with fewer than two samples.
    n : number of samples.
    n_series : number of independent series (starts) they come from; 0 of a number that is no mean, such as
        the largest.
    independent : number of independent samples they are worth, as far as blocks resolve it: at most 128 [-].
    window : begin and end of the record averaged over [s].
    variation : of the record, see `steadiness.compare_quarters` [-]; nan where it is too short.
    drift : mean of the second half of the record less that of the first, in its unit; the same.
    steady_from : begin of the part of the window that is steady, see `steadiness.truncation` [s]; nan where
        there is none, or no window. Samples count as evenly spread over the window.
    """

    name: str
    unit: str
    value: float
    error: float
    n: int
    n_series: int
    independent: float
    window: tuple[float, float]
    variation: float
    drift: float
    steady_from: float

    @property
    def short(self) -> bool:
        """True where the record is too short for its error, and for a verdict that it is steady."""
        return self.independent < ENOUGH

    @property
    def changes(self) -> bool:
        """True where four quarters of the record differ by more than chance explains."""
        return self.variation > LIMIT

    @property
    def steady(self) -> bool:
        """True where a record that is long enough shows no change."""
        return not self.short and self.variation <= LIMIT

    def __repr__(self) -> str:
        error = "" if math.isnan(self.error) else f" ± {self.error_text}"
        unit = "" if self.unit == "-" else f" {self.unit}"
        steady = "" if self.verdict in {"-", "yes"} else f", steady: {self.verdict}"
        return f"{self.name}: {self.value:.4g}{error}{unit} (n = {self.n}{steady})"

    @property
    def error_text(self) -> str:
        """The error by two digits, with a star where the record is too short for it; "–" where it is nan."""
        if math.isnan(self.error):
            return "–"
        return f"{self.error:.2g}" + "*" * (self.short and self.error > 0.0)

    @property
    def verdict(self) -> str:
        """What is said of steadiness: "yes", "no" with the drift, "too short", or "-" of what is no mean."""
        if self.n_series == 0:
            return "-"
        if self.changes:
            drifts = abs(self.drift) >= DRIFTS * self.error
            return f"no, drift {self.drift:+.3g}" if drifts else "no, it varies"
        return "too short" if self.short else "yes"

    def row(self) -> dict[str, object]:
        """One line of a CSV table."""
        return {
            "quantity": self.name,
            "unit": self.unit,
            "value": self.value,
            "standard_error": self.error,
            "n": self.n,
            "n_series": self.n_series,
            "independent": self.independent,
            "short": self.short,
            "window_begin_s": self.window[0],
            "window_end_s": self.window[1],
            "variation": self.variation,
            "drift": self.drift,
            "steady": self.steady,
            "steady_from_s": self.steady_from,
        }


@dataclass(frozen=True)
class StandardError:
    """Standard error of a mean.

    Attributes
    ----------
    error : half of the interval that holds the true mean with 68.3 %, in the unit of the samples.
    independent : number of independent samples, at most 128 [-].
    freedom : degrees of freedom of the estimate [-].
    """

    error: float
    independent: float
    freedom: int


def standard_error(series: Sequence[ArrayLike]) -> StandardError:
    """Standard error of the mean of one or several series that may be correlated in themselves.

    Parameters
    ----------
    series : one array per independent start, in order of time; any unit, lengths may differ.

    Notes
    -----
    The variance of the mean of n samples is S/n, where S is the spectrum at frequency zero. It is estimated
    by the mean square of the K lowest cosine coefficients of the record, which gives Student's t with K
    degrees of freedom (Mueller and Watson 2017; Lazarus et al. 2018); K is a quarter of the number of
    independent samples n var/S, at least 4. The error is widened by Student's t, so that it covers 68.3 %
    however small K is. Starts are merged (`steadiness.merged`). Where they differ by more than chance
    explains (F test, 5 %), or hold one sample each, the error is that of the means of the starts.

    >>> standard_error([[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]]).error
    0.0
    """
    from scipy.special import fdtri

    arrays = [np.asarray(one, dtype=np.float64) for one in series]
    arrays = [one for one in arrays if len(one)]
    n, n_series = sum(len(one) for one in arrays), len(arrays)
    if n < 2:
        return StandardError(math.nan, float(n), 0)
    between = _between(arrays)
    if n == n_series:
        return _widened(between / n, float(n), n - 1)
    blocks = block_means(merged(arrays))
    noise, independent, freedom = _noise(blocks[:, None])
    within, degrees = float(noise[0]) * n / len(blocks), int(freedom[0])
    if n_series > 1 and between > within * fdtri(n_series - 1, degrees, APART):
        return _widened(between / n, float(n_series), n_series - 1)
    return _widened(within / n, float(independent[0]), degrees)


def standard_errors(columns: ArrayLike) -> Floats:
    """Standard error of the mean of many quantities at once, each as `standard_error` gives it.

    Parameters
    ----------
    columns : one quantity per column, in order of time, shape (n, n_column).

    Returns
    -------
    Standard errors, shape (n_column,); nan where there are fewer than two rows.

    >>> standard_errors([[1.0, 0.0], [1.0, 1.0]]).round(3)
    array([0.   , 0.919])
    """
    from scipy.special import stdtrit

    rows = np.asarray(columns, dtype=np.float64)
    n, n_column = rows.shape
    if n < 2 or n_column == 0:
        return np.full(n_column, math.nan)
    blocks = block_means(rows - rows[0])
    noise, _, freedom = _noise(blocks)
    return np.sqrt(noise / len(blocks)) * stdtrit(freedom, ONE_SIGMA)


def average(
    name: str, unit: str, series: Sequence[ArrayLike], window: tuple[float, float] = (math.nan, math.nan)
) -> Average:
    """Mean of one or several series, with standard error and steadiness.

    Parameters
    ----------
    name, unit : what the numbers are.
    series : one array per independent start, in order of time; nan entries are left out.
    window : begin and end of the record they come from [s].
    """
    return _average(name, unit, series, window, 0.0)


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
    rest = [(p - value * q) / mean for p, q in zip(a, b, strict=True)]
    return replace(_average(name, unit, rest, window, value), value=value)


def begin_in_words(name: str, t: ArrayLike, record: ArrayLike, settle: float, begin: float | None) -> str:
    """When MSER would begin the window, beside when it begins; whether that is steady, its average says.

    Parameters
    ----------
    name : of the quantity.
    t, record : times [s] and samples from the begin of the run on, shape (n,).
    settle : `record.settle` of the case [s].
    begin : of the window where another was asked for [s], else None.

    >>> begin_in_words("q_star", [0.0, 1.0], [1.0, 1.0], 1.0, None)
    'too few samples to suggest a begin for q_star; the case settles until 1 s'
    """
    times, samples = np.asarray(t, dtype=np.float64), np.asarray(record, dtype=np.float64)
    share = truncation(samples)
    taken = f"the case settles until {settle:g} s"
    if begin is not None:
        taken += f", the window begins at {begin:g} s"
    if len(samples) < PARTS * (WAVES + 1):
        return f"too few samples to suggest a begin for {name}; {taken}"
    if math.isnan(share):
        return f"MSER suggests no begin of the window for {name}; {taken}"
    return (
        f"MSER suggests a window for {name} from t = {times[math.ceil(share * len(times))]:.3g} s on; {taken}"
    )


def _average(
    name: str, unit: str, series: Sequence[ArrayLike], window: tuple[float, float], scale: float
) -> Average:
    """Average of series whose samples are differences of numbers of size `scale`, if that is not 0."""
    arrays = [np.asarray(one, dtype=np.float64) for one in series]
    arrays = [one[np.isfinite(one)] for one in arrays]
    arrays = [one for one in arrays if len(one)]
    if not arrays:
        return Average(name, unit, math.nan, math.nan, 0, 0, 0.0, window, math.nan, math.nan, math.nan)
    value = float(np.concatenate(arrays).mean())
    error = standard_error(arrays)
    record = merged(arrays)
    variation, drift = compare_quarters(record, scale or value)
    return Average(
        name=name,
        unit=unit,
        value=value,
        error=error.error,
        n=sum(len(one) for one in arrays),
        n_series=len(arrays),
        independent=error.independent,
        window=window,
        variation=variation,
        drift=drift,
        steady_from=window[0] + truncation(record) * (window[1] - window[0]),
    )


def _noise(blocks: Floats) -> tuple[Floats, Floats, Ints]:
    """Spectrum at frequency zero, number of independent samples and degrees of freedom, per column.

    Parameters
    ----------
    blocks : samples or block means in order of time, shape (n, n_column), n >= 2.
    """
    from scipy.fft import dct

    n, n_column = blocks.shape
    waves: Floats = np.asarray(dct(blocks - blocks.mean(axis=0), axis=0, norm="ortho"))[1:]
    summed, column = np.cumsum(waves**2, axis=0), np.arange(n_column)
    spread = summed[-1] / (n - 1)
    k = np.full(n_column, min(START, n - 1))
    for _ in range(ROUNDS):
        independent = _count(n, spread, summed[k - 1, column] / k)
        k = np.clip((SHARE * independent).astype(np.int64), min(FEWEST, n - 1), n - 1)
    noise = summed[k - 1, column] / k
    return noise, _count(n, spread, noise), k


def _count(n: int, spread: Floats, noise: Floats) -> Floats:
    """Number of independent samples, from the variance of n blocks and their spectrum at frequency zero."""
    known = np.isfinite(noise) & (noise > 0.0)
    return np.minimum(np.divide(n * spread, noise, np.full(len(noise), float(n)), where=known), n)


def _between(arrays: list[Floats]) -> float:
    """Spectrum at frequency zero by the spread of the means of several starts; 0 for one start."""
    if len(arrays) == 1:
        return 0.0
    means, n = np.array([one.mean() for one in arrays]), np.array([len(one) for one in arrays])
    return float((n * (means - (n @ means) / n.sum()) ** 2).sum() / (len(arrays) - 1))


def _widened(square: float, independent: float, freedom: int) -> StandardError:
    """From the square of a standard error with so many degrees of freedom."""
    from scipy.special import stdtrit

    return StandardError(math.sqrt(square) * float(stdtrit(freedom, ONE_SIGMA)), independent, freedom)
