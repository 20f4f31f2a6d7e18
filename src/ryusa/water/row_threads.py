"""Threads that share the loops over grains of an exchange with a row of columns.

Each thread sums for some of the segments, over all grains in their order, or tells some of the grains: the
bits are those of one thread. The solution of the stations is not shared: it takes a hundredth of a step
(design/0027).
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import TypeVar

import numpy as np

from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters
from ryusa.water.exchange_arrays import GrainNumbers, SliceArrays
from ryusa.water.row_grain_sums import (
    N_GIVEN,
    N_PRESENT,
    MetByGrains,
    add_given,
    add_present,
    amounts_given,
    as_rows,
    cut_in_row,
)
from ryusa.water.row_layout import RowShape
from ryusa.water.row_sums import GrainPlaces
from ryusa.water.slice_sums import BAD_GRAIN, RATE

A = TypeVar("A", SliceArrays, GrainPlaces, GrainNumbers, MetByGrains)
SHARED = 4000  # grains for each thread from which on sharing pays


class RowThreads:
    """Threads for a row.

    Parameters
    ----------
    n : number of threads, the caller among them.
    """

    def __init__(self, n: int = 1) -> None:
        self.n = n
        self._pool = ThreadPoolExecutor(n - 1, thread_name_prefix="ryusa-water") if n > 1 else None

    def number_for(self, n_grain: int) -> int:
        """Threads that share this number of grains."""
        return max(min(self.n, n_grain // SHARED), 1)

    def share(self, ends: list[int], work: Callable[[int, int], None]) -> None:
        """Do work(begin, end) for each pair of ends that follow each other, at the same time."""
        first, *others = pairwise(ends)
        assert self._pool is not None
        going = [self._pool.submit(work, *one) for one in others]
        work(*first)
        for one in going:
            one.result()


def equal_parts(n: int, parts: int) -> list[int]:
    """Ends of equal parts of 0 to n-1."""
    return [k * n // parts for k in range(parts + 1)]


def equal_work(places: GrainPlaces, n_segment: int, parts: int) -> list[int]:
    """Ends of groups of segments that hold about the same number of grains."""
    grains = np.cumsum(np.bincount(places.at[:, places.at.shape[1] // 2], minlength=n_segment))
    inner = np.searchsorted(grains, [k * grains[-1] / parts for k in range(1, parts)])
    return [0, *(int(one) for one in inner), n_segment]


def sum_grains_shared(
    threads: RowThreads, p: ColumnParameters, shape: RowShape, x_low: float, grains: GrainNumbers,
    cut: SliceArrays, places: GrainPlaces, x: Floats, v: Floats, impulse: Floats, sampled: Floats,
    met: MetByGrains, wet: Floats, per_dt: float, z: Floats, sums: Floats, through: Floats, largest: Floats,
) -> None:  # fmt: skip
    """As `sum_grains_in_row`, with the same bits, by threads."""
    given, present = np.zeros((*wet.shape, N_GIVEN)), np.zeros((*wet.shape, N_PRESENT))
    amounts, values = np.empty((len(z), N_GIVEN)), np.empty((len(z), N_PRESENT + 1))
    parts, order = threads.number_for(len(z)), grains.order
    rows, segments = equal_parts(len(z), parts), equal_work(places, len(wet), parts)

    def find_given(a: int, b: int) -> None:
        given_now = rows_of(a, b, met), rows_of(a, b, grains), rows_of(a, b, cut)
        amounts[a:b] = amounts_given(shape, impulse[a:b], sampled[a:b], *given_now, per_dt)

    def cut_some(a: int, b: int) -> None:
        some, here = (rows_of(a, b, grains), rows_of(a, b, cut), rows_of(a, b, places)), largest.copy()
        values[a:b] = cut_in_row(p, shape, x_low, *some, x[a:b], v[a:b], impulse[a:b], z[a:b], here)
        if here[BAD_GRAIN] >= 0.0:
            here[BAD_GRAIN] += a
        found.append(here)

    found: list[Floats] = []
    threads.share(rows, find_given)
    threads.share(segments, lambda a, b: add_given(a, b, cut, places, wet, order, met.per, amounts, given))
    threads.share(rows, cut_some)
    largest[RATE] = max(one[RATE] for one in found)
    largest[BAD_GRAIN] = min((one[BAD_GRAIN] for one in found if one[BAD_GRAIN] >= 0.0), default=-1.0)
    if largest[BAD_GRAIN] < 0.0:
        add = cut, places, wet, order, values, present, through
        threads.share(segments, lambda a, b: add_present(a, b, *add))
        as_rows(given, present, sums)


def rows_of(begin: int, end: int, arrays: A) -> A:
    """The rows of some of the grains in a tuple of arrays, not copied."""
    return arrays._make(one[begin:end] for one in arrays)
