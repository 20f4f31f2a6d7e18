"""Shares, of runs or of grains in runs, with intervals between 0 and 1; what each half of the seeds says."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from scipy import stats

from ryusa.study import CONFIDENCE, Band, Interval, Trial, exact, not_negative, seeds_trial

Item = TypeVar("Item")  # of one seed


def share_interval(hits: Sequence[float], of: int) -> Interval:
    """Share of items over seeds, with its 95 % interval.

    Parameters
    ----------
    hits : items counted, one number per seed.
    of : items of one run; 1 where the run itself is counted.

    Notes
    -----
    Wilson's score interval (1927, J. Am. Stat. Assoc. 22, 209). Items of one run are no independent samples:
    where runs differ more than chance lets them, the number of items is divided by the ratio of the two
    variances (Korn & Graubard 1998, Surv. Methodol. 24, 193; Kish's design effect).

    >>> found = share_interval([1, 1, 1, 1], 1)
    >>> found.value, round(found.low, 2), round(found.high, 2)
    (1.0, 0.51, 1.0)
    >>> str(share_interval([0, 0, 42, 42], 42))  # as good as three grains
    '0.5 (0.125 to 0.875)'
    """
    n, share = len(hits) * of, sum(hits) / (len(hits) * of)
    effective = float(n)
    if of > 1 and len(hits) > 1 and 0.0 < share < 1.0:
        by_chance = share * (1.0 - share) / of
        effective = n / max(1.0, float(np.var(np.asarray(hits) / of, ddof=1)) / by_chance)
    z = float(stats.norm.ppf(0.5 + CONFIDENCE / 2))
    middle = (share + z * z / (2.0 * effective)) / (1.0 + z * z / effective)
    half = z * math.sqrt(share * (1.0 - share) / effective + (z / (2.0 * effective)) ** 2)
    half /= 1.0 + z * z / effective
    low, high = max(0.0, min(share, middle - half)), min(1.0, max(share, middle + half))
    what = f"{len(hits)} runs" if of == 1 else f"{n} grains in {len(hits)} runs, {effective:.0f} independent"
    return Interval(share, low, high, "-", len(hits), f"95 % of the share of {what}, Wilson")


def within_0_1(found: Interval) -> Interval:
    """The interval of a share, which cannot leave 0 to 1; one without a number as it is."""
    if math.isnan(found.value):
        return found
    return replace(found, low=max(0.0, found.low), high=min(1.0, found.high))


def positive(part: str, choices: Mapping[str, str], values: Sequence[float], band: Band) -> Trial:
    """Return the trial of the mean over seeds of a number that cannot be negative."""
    trial = seeds_trial(part, choices, values, band)
    return replace(trial, found=not_negative(trial.found))


def halves(
    items: Sequence[Item], value: Callable[[Sequence[Item]], float], limits: Band
) -> tuple[bool | None, bool | None]:
    """Whether the items at even and those at odd places hold by a number of theirs; None without any."""
    one, other = (
        limits.holds(exact(value(half), limits.unit)) if len(half) else None
        for half in (items[0::2], items[1::2])
    )
    return one, other


def share_trial(
    part: str, choices: Mapping[str, str], hits: Sequence[float], of: int, band: Band, note: str = ""
) -> Trial:
    """Return the trial of a share; the halves are the seeds at even and at odd places."""
    by_half = halves(hits, lambda half: sum(half) / (of * len(half)), band)
    return Trial(part, choices, share_interval(hits, of), band, note=note, halves=by_half)
