"""Carry contact memory from an old list to a new one, and tell blocks what they owe each other."""

from typing import Any

import numpy as np

from ryusa.engine._kernel import kernel


@kernel()
def count_live(n_pair: int, live: Any) -> int:
    """Pairs in touch among the first n_pair of the list."""
    count = 0
    for p in range(n_pair):
        count += live[p]
    return count


@kernel()
def take_rows(
    n: int, start: Any, partners: Any, live: Any, mem: Any, ids: Any, out_i: Any, out_j: Any, rows: Any
) -> None:
    """Copy ids and rows of all pairs in touch, in list order."""
    k = 0
    for i in range(n):
        for p in range(start[i], start[i + 1]):
            if live[p]:
                out_i[k] = ids[i]
                j = partners[p]
                out_j[k] = ids[j] if j < n else j
                rows[k, :] = mem[p, :]
                k += 1


@kernel()
def put_rows(
    n: int, start: Any, partners: Any, live: Any, mem: Any, index: Any, i_ids: Any, j_ids: Any, rows: Any
) -> int:
    """Lay rows into a new list; returns the first contact that has no place in it, or -1.

    `index` turns the id of a free grain into its place in the engine's order.
    """
    for k in range(len(i_ids)):
        i = index[i_ids[k]]
        j = index[j_ids[k]] if j_ids[k] < n else j_ids[k]
        found = False
        for p in range(start[i], start[i + 1]):
            if partners[p] == j:
                live[p] = 1
                mem[p, :] = rows[k, :]
                found = True
                break
        if not found:
            return k
    return -1


@kernel()
def cross_lists(n: int, block_start: Any, start: Any, partners: Any) -> tuple[Any, Any, Any]:
    """Number the pairs whose partner belongs to another block.

    Returns the first number of each block (n_block + 1) and, for each grain, the numbers of the pairs
    that others own and it is partner of: incoming[incoming_start[j]:incoming_start[j + 1]], in list order.
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
    incoming = np.empty(first[n_block], np.int64)
    q = 0
    for b in range(n_block):
        lo, hi = block_start[b], block_start[b + 1]
        for p in range(start[lo], start[hi]):
            j = partners[p]
            if j < n and (j < lo or j >= hi):
                incoming[fill[j]] = q
                fill[j] += 1
                q += 1
    return first, incoming_start, incoming


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
