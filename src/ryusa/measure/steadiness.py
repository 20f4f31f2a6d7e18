"""Whether a record is steady, and from when on: parts of it compared, held against the noise within them.

A record is first averaged to at most `BLOCKS` blocks of equal length; all that follows looks only at
fluctuations that are slow compared with a block. design/0010 gives the reasons and the measured rates.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

BLOCKS = 128  # most blocks that a record is averaged to
PARTS = 4  # quarters of the record that are compared
WAVES = 4  # slowest cosines of a quarter, of which its noise is estimated
LIMIT = 2.64  # variation that 1.5 % of the records of white noise exceed; 6 % with 20 independent samples
ROUND_OFF = 1.0e-12  # share of the mean below which a record counts as constant
MSER_BLOCKS = 64
BEYOND = 1.5  # begin of the window over the truncation point of MSER
STEP = 1.0 / 16.0  # share by which more is left out where the rest is not steady
LATEST = 2.0 / 3.0  # share of the record that may be left out


def merged(series: Sequence[Floats]) -> Floats:
    """One record of several starts, each less its own mean, in the order of the place within a start.

    The k-th of n samples stands at (k + 1/2)/n of its start. What changes from begin to end in all starts
    changes in the merged record; what differs between starts is left out.

    >>> merged([np.array([1.0, 3.0]), np.array([12.0, 10.0])]).tolist()
    [-1.0, 1.0, 1.0, -1.0]
    """
    rest = [one - one.mean() for one in series]
    if len(rest) == 1:
        return rest[0]
    if len({len(one) for one in rest}) == 1:
        return np.stack(rest, axis=1).ravel()
    place = np.concatenate([(np.arange(len(one)) + 0.5) / len(one) for one in rest])
    return np.concatenate(rest)[np.argsort(place, kind="stable")]


def block_means(rows: Floats, most: int = BLOCKS) -> Floats:
    """Means of at most so many blocks of neighbouring rows, whose lengths differ by one row at most.

    Parameters
    ----------
    rows : in order of time, shape (n, ...).
    most : number of blocks where there are more rows.

    >>> block_means(np.array([1.0, 2.0, 3.0, 4.0, 5.0]), 2)
    array([1.5, 4. ])
    """
    n = len(rows)
    if n <= most:
        return rows
    edge = np.arange(most + 1) * n // most
    length = np.diff(edge).reshape(-1, *[1] * (rows.ndim - 1))
    return np.add.reduceat(rows, edge[:-1], axis=0) / length


def compare_quarters(record: ArrayLike, scale: float = 0.0) -> tuple[float, float]:
    """Variation between the four quarters of a record over the noise within them, and its drift.

    Parameters
    ----------
    record : samples in order of time, or of several starts as `merged` gives them; any unit.
    scale : a record whose standard deviation is round-off of this counts as constant [unit of the record].

    Returns
    -------
    variation : standard deviation of the means of the quarters over what noise explains [-]; 0 for a record
        that is constant, nan where a quarter has fewer than five samples.
    drift : mean of the second half less that of the first [unit of the record]; the same. It is not held
        against noise: where a record rests in three quarters, as that of an outlet that no grain has
        reached, there is none.

    Notes
    -----
    Analysis of variance: q times the variance of the means of quarters of q samples, over the noise at the
    lowest frequencies, the mean square of the first four cosine coefficients of each quarter (Mueller and
    Watson 2017), both of which are the spectrum at frequency zero where the record is steady. A transient or
    a step enlarges the noise of the quarter in which it happens, so the noisiest quarter is left out. A
    linear trend adds to the noise 1/80 of what it adds to the variance of the means.
    """
    samples = np.asarray(record, dtype=np.float64)
    if len(samples) < PARTS * (WAVES + 1):
        return math.nan, math.nan
    blocks = block_means(samples - samples[0])
    if float(samples.std()) <= ROUND_OFF * abs(scale):
        return 0.0, 0.0
    length = len(blocks) // PARTS
    # up to three blocks that are left over are taken from the middle
    odd = len(blocks) % PARTS
    places = np.delete(np.arange(len(blocks)), len(blocks) // 2 + np.arange(odd))
    quarters = blocks[places].reshape(PARTS, length)
    phase = math.pi * (np.arange(length) + 0.5) / length
    waves = math.sqrt(2.0 / length) * np.cos(np.outer(np.arange(1, WAVES + 1), phase))
    noise = float(np.sort(((quarters @ waves.T) ** 2).mean(axis=1))[: PARTS - 1].mean())
    means = quarters.mean(axis=1)
    half = 0.5 * float(means[2] + means[3] - means[0] - means[1])
    between = length * float(means.var(ddof=1))
    if noise <= ROUND_OFF**2 * between:
        return math.inf, half
    return math.sqrt(between / noise), half


def truncation(record: ArrayLike) -> float:
    """Share of a record that is to be left out at its begin; nan where no steady rest is found.

    Parameters
    ----------
    record : samples in order of time; any unit.

    Notes
    -----
    MSER (White 1997) leaves out what minimises the squared standard error of the mean of the rest, taken as
    if its samples were independent; here on 64 blocks. It stops where the transient is no larger than the
    noise of a block, which leaves a bias of about one standard error; half as much again is left out. Where
    the rest is not steady, sixteenths of the record are left out until it is (as Heidelberger and Welch 1983
    leave out tenths); nan where that needs more than two thirds.
    """
    samples = np.asarray(record, dtype=np.float64)
    if len(samples) < PARTS * (WAVES + 1):
        return math.nan
    blocks = block_means(samples - samples[0], MSER_BLOCKS)
    n = len(blocks)
    backwards, count = blocks[::-1], np.arange(1, n + 1)
    square = np.cumsum(backwards**2) - np.cumsum(backwards) ** 2 / count
    rule = (np.maximum(square, 0.0) / count**2)[::-1]
    share = BEYOND * int(np.argmin(rule[: n // 2 + 1])) / n
    while share <= LATEST:
        if compare_quarters(samples[math.ceil(share * len(samples)) :])[0] <= LIMIT:
            return share
        share += STEP
    return math.nan
