"""Crossing pairs: rows where one block leaves forces for grains of another, added there after the barrier."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.engine.shared.array_memory import zeros
from ryusa.engine.shared.kernel import kernel

Whole = NDArray[np.int64]


def number_crossing_pairs(
    n: int,
    block_start: Whole,
    start: np.ndarray,
    partners: np.ndarray,
    share: Callable[[Callable[[int, int], Any]], list[Any]],
) -> tuple[Whole, np.ndarray, np.ndarray, np.ndarray, int]:
    """Number the rows of `Pairs.f` for pairs whose partner belongs to another block.

    Returns the first of them in each block (n_block + 1); their numbers in the Verlet list; for each grain,
    the rows of the pairs that others own and it is partner of:
    incoming[incoming_start[j]:incoming_start[j + 1]], in list order; and how many blocks apart the two
    blocks of a pair are at most, the last block beside the first. `share` distributes blocks over threads.
    """
    first = np.zeros(len(block_start), np.int64)
    none = np.empty(0, np.uint32)
    spans = share(lambda a, b: _list_crossing(a, b, n, block_start, start, partners, first, none))
    np.cumsum(first, out=first)
    crossing = np.empty(first[-1], np.uint32)
    share(lambda a, b: _list_crossing(a, b, n, block_start, start, partners, first, crossing))
    incoming_start, incoming = zeros(np.int32, n + 1), zeros(np.int32, first[-1])
    _list_incoming(n, n + len(block_start) - 1, partners, crossing, incoming_start, incoming)
    return first, crossing, incoming_start, incoming, max(spans)


@kernel(nogil=True)
def _list_crossing(
    b_0: int, b_1: int, n: int, block_start: Any, start: Any, partners: Any, first: Any, crossing: Any
) -> int:
    """Write the crossing pairs of blocks b_0..b_1-1 from crossing[first[b]] on; count them if it is empty.

    Returns how many blocks apart the two blocks of a pair are at most.
    """
    counting, n_block, span = len(crossing) == 0, len(block_start) - 1, 0
    for b in range(b_0, b_1):
        lo, hi = block_start[b], block_start[b + 1]
        q = 0 if counting else first[b]
        for p in range(start[lo], start[hi]):
            j = partners[p]
            if j < n and (j < lo or j >= hi):
                if not counting:
                    crossing[q] = p
                q += 1
                apart = 1
                while not block_start[(b + apart) % n_block] <= j < block_start[(b + apart) % n_block + 1]:
                    apart = 1 - apart if apart <= 0 else -apart  # 1, -1, 2, -2, ...
                span = max(span, abs(apart))
        if counting:
            first[b + 1] = q
    return span


@kernel()
def _list_incoming(
    n: int, row: int, partners: Any, crossing: Any, incoming_start: Any, incoming: Any
) -> None:
    """List the rows for each grain; `row` is that of the first crossing pair."""
    for q in range(len(crossing)):
        incoming_start[partners[crossing[q]] + 1] += 1
    for j in range(n):
        incoming_start[j + 1] += incoming_start[j]
    for q in range(len(crossing)):
        j = partners[crossing[q]]
        incoming[incoming_start[j]] = row + q
        incoming_start[j] += 1
    for j in range(n - 1, 0, -1):
        incoming_start[j] = incoming_start[j - 1]
    if n > 0:
        incoming_start[0] = 0
