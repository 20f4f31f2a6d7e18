"""Crossing pairs: rows where one block leaves forces for grains of another, added there after the barrier."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.engine.shared.kernel import kernel

Whole = NDArray[np.int64]


def number_crossing_pairs(
    n: int, block_start: Whole, start: Whole, partners: np.ndarray
) -> tuple[Whole, np.ndarray, Whole, Whole]:
    """Number the rows of `Pairs.f` for pairs whose partner belongs to another block.

    Returns the first of them in each block (n_block + 1); their numbers in the Verlet list; and, for each
    grain, the rows of the pairs that others own and it is partner of:
    incoming[incoming_start[j]:incoming_start[j + 1]], in list order.
    """
    first, incoming_start = np.zeros(len(block_start), np.int64), np.zeros(n + 1, np.int64)
    _count(n, block_start, start, partners, first, incoming_start)
    np.cumsum(first, out=first)
    np.cumsum(incoming_start, out=incoming_start)
    incoming, crossing = np.empty(first[-1], np.int64), np.empty(first[-1], np.uint32)
    _number(n, block_start, start, partners, incoming_start[:-1].copy(), incoming, crossing)
    return first, crossing, incoming_start, incoming


@kernel()
def _count(n: int, block_start: Any, start: Any, partners: Any, first: Any, incoming_start: Any) -> None:
    for b in range(len(block_start) - 1):
        lo, hi = block_start[b], block_start[b + 1]
        for p in range(start[lo], start[hi]):
            j = partners[p]
            if j < n and (j < lo or j >= hi):
                first[b + 1] += 1
                incoming_start[j + 1] += 1


@kernel()
def _number(
    n: int, block_start: Any, start: Any, partners: Any, fill: Any, incoming: Any, crossing: Any
) -> None:
    q, row = 0, n + len(block_start) - 1
    for b in range(len(block_start) - 1):
        lo, hi = block_start[b], block_start[b + 1]
        for p in range(start[lo], start[hi]):
            j = partners[p]
            if j < n and (j < lo or j >= hi):
                incoming[fill[j]], crossing[q] = row + q, p
                fill[j] += 1
                q += 1
