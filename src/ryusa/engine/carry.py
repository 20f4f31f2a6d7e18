"""What blocks owe each other, and grains brought back into the period."""

from typing import Any

import numpy as np

from ryusa.engine._kernel import kernel


@kernel()
def cross_lists(n: int, block_start: Any, start: Any, partners: Any) -> tuple[Any, Any, Any, Any]:
    """Number the rows of `Pairs.f` for pairs whose partner belongs to another block.

    Returns the first of them in each block (n_block + 1); their numbers in the wide list; and, for each
    grain, the rows of the pairs that others own and it is partner of:
    incoming[incoming_start[j]:incoming_start[j + 1]], in list order.
    """
    n_block = len(block_start) - 1
    first = np.zeros(n_block + 1, np.int64)
    incoming_start = np.zeros(n + 1, np.int64)
    for b in range(n_block):
        lo, hi = block_start[b], block_start[b + 1]
        first[b + 1] = first[b]
        for p in range(start[lo], start[hi]):
            j = partners[p]
            if j < n and (j < lo or j >= hi):
                first[b + 1] += 1
                incoming_start[j + 1] += 1
    for j in range(n):
        incoming_start[j + 1] += incoming_start[j]
    fill = incoming_start[:-1].copy()
    incoming, crossing = np.empty(first[n_block], np.int64), np.empty(first[n_block], np.uint32)
    q = n + n_block
    for b in range(n_block):
        lo, hi = block_start[b], block_start[b + 1]
        for p in range(start[lo], start[hi]):
            j = partners[p]
            if j < n and (j < lo or j >= hi):
                incoming[fill[j]], crossing[q - n - n_block] = q, p
                fill[j] += 1
                q += 1
    return first, crossing, incoming_start, incoming


@kernel()
def wrap_grains(x: Any, image: Any, period: Any, low: Any, high: Any) -> int:
    """Bring grains back into the period, count it, and return the first one outside the world, or -1."""
    lost = -1
    for i in range(len(x)):
        for k in range(2):
            length = period[k]
            if length < np.inf:
                shift = np.floor(x[i, k] / length)
                if shift != 0.0:
                    x[i, k] -= shift * length
                    image[i, k] += int(shift)
        inside = True
        for k in range(3):
            inside = inside and low[k] <= x[i, k] <= high[k]
        if not inside and lost < 0:
            lost = i
    return lost
