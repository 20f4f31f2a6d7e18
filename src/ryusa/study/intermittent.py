"""Flows that stop and start: share of the time in motion, mean rate, and how long a rate is correlated."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.model.scene import Floats
from ryusa.study.interval import CONFIDENCE, Interval, not_negative, over_seeds, pseudo_values


def share_over_runs(shares: Sequence[float], confidence: float = CONFIDENCE) -> Interval:
    """Mean share of the time over independent runs, with its Jeffreys interval.

    Parameters
    ----------
    shares : share of its time that each run was in one state [-].
    confidence : probability that the interval covers the mean.

    Notes
    -----
    Frames of one run are correlated, so they are no independent trials. The number of trials is the effective
    sample size of a clustered sample, n = p (1 - p)/var(p), reduced for the few degrees of freedom of the
    variance (Korn and Graubard 1998, Survey Methodology 24, 193); the variance is that between runs. If all
    runs have the same share, as when all were always in motion, every run counts as one trial. Jeffreys
    interval: quantiles of Beta(n p + 1/2, n (1 - p) + 1/2), always between 0 and 1; its end is 0 or 1 where
    the share is (Brown, Cai and DasGupta 2001). One run has no interval.

    >>> found = share_over_runs([1.0, 1.0, 1.0])
    >>> found.value, round(found.low, 2), found.high
    (1.0, 0.46, 1.0)
    """
    from scipy import stats

    p = np.asarray(shares, dtype=np.float64)
    n, mean = len(p), float(np.mean(p))
    if n == 1:
        return Interval(mean, mean, mean, "-", 1, "one seed, no interval")
    variance = float(p.var(ddof=1)) / n
    trials = float(n)
    if variance > 0.0:
        level = 0.5 + confidence / 2.0
        trials = mean * (1.0 - mean) / variance
        trials *= float(stats.norm.ppf(level) / stats.t.ppf(level, n - 1)) ** 2
    tail = 0.5 * (1.0 - confidence)
    a, b = trials * mean + 0.5, trials * (1.0 - mean) + 0.5
    low = 0.0 if mean <= 0.0 else float(stats.beta.ppf(tail, a, b))
    high = 1.0 if mean >= 1.0 else float(stats.beta.ppf(1.0 - tail, a, b))
    how = f"{100 * confidence:.3g} % of the mean of {n} runs, Jeffreys with {trials:.3g} effective trials"
    return Interval(mean, min(low, mean), max(high, mean), "-", n, how)


def rate_with_rests(rates: Sequence[float], moving: Sequence[float], unit: str) -> Interval:
    """Mean rate of a flow that may stop and start, over independent runs.

    Parameters
    ----------
    rates : mean rate of each run.
    moving : share of the time that the run was in motion [-].
    unit : unit of the rates.

    Notes
    -----
    The rates of a flow that stops and starts have two modes, zero and that of the flow in motion. With few
    runs Student's interval misses the mean too often (three runs that happen to be all in motion scatter
    little), a bootstrap more often still, and a logarithm of zero does not exist (design/0015). The mean is
    the share of the time in motion times the rate while in motion: the interval multiplies the ends of
    the two (97.5 % each, so 95 % together). The first is that of `share_over_runs`, the second Student's of
    the jackknife of sum(rates)/sum(moving). If no run ever rested, or none ever moved, it is Student's of
    the rates.

    >>> str(rate_with_rests([2.0, 2.0, 2.0], [1.0, 1.0, 1.0], "m2/s"))
    '2 m2/s'
    """
    q, m = np.asarray(rates, dtype=np.float64), np.asarray(moving, dtype=np.float64)
    if len(q) == 1 or m.min() >= 1.0 or m.max() <= 0.0:
        return not_negative(over_seeds(list(q), unit))
    each = 0.5 * (1.0 + CONFIDENCE)
    share = share_over_runs(list(m), each)
    pairs = list(zip(q, m, strict=True))
    while_moving = pseudo_values(_ratio, pairs)
    flow = not_negative(over_seeds(while_moving, unit, confidence=each))
    how = f"95 %: share of the time in motion times rate while in motion, {len(q)} runs; {share.how}"
    return Interval(float(q.mean()), share.low * flow.low, share.high * flow.high, unit, len(q), how)


def _ratio(pairs: Sequence[tuple[float, float]]) -> float:
    """Rate while in motion; without the one run that moved, the rate of those at rest."""
    moved = sum(m for _, m in pairs)
    return sum(q for q, _ in pairs) / moved if moved > 0.0 else 0.0


def correlation_time(series: Sequence[Floats], interval: float) -> float:
    """Integral correlation time of a rate [s], from the scatter of the means of independent runs.

    Parameters
    ----------
    series : rate of every run, at equal intervals, as long in every run.
    interval : time between two values [s].

    Notes
    -----
    The variance of a mean over a time T much longer than the correlation time tau is 2 tau variance/T. The
    estimate is as uncertain as a variance of as many numbers as there are runs; nan for one run or a constant
    rate. It cannot exceed T/2, which means that the runs are too short to tell.
    """
    rates = np.array(series, dtype=np.float64)
    variance = float(rates.var())
    if len(rates) < 2 or variance == 0.0:
        return math.nan
    length = rates.shape[1] * interval
    between = float(rates.mean(axis=1).var(ddof=1))
    return min(0.5 * between * length / variance, 0.5 * length)
