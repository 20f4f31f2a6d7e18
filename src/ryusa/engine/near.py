"""The near list: cut from the wide one every few steps, so that a step sees little more than what touches.

Pairs keep the order of the wide list, and those that do not touch are passed over: when the near list is cut
never shows in the bits of a run.
"""
# ruff: noqa: F403, F405  (the columns of rows.py, all of them plain integers)

from typing import Any

from ryusa.engine._kernel import kernel
from ryusa.engine.arrays import Grains, Near, Pairs, Walls
from ryusa.engine.pair import dashpots
from ryusa.engine.rows import *
from ryusa.laws.geometry import wrap


@kernel()
def cut(
    b: int,
    lo: int,
    hi: int,
    n: int,
    n_solid: int,
    reach_on: float,
    plane_case: int,
    rotation: int,
    c: Any,
    grains: Grains,
    walls: Walls,
    pairs: Pairs,
    near: Near,
    spare: Near,
) -> bool:
    """List anew the pairs of block b, grains lo..hi-1, that are nearer than `reach_on` [m] beyond touch.

    `spare` is room to work in, as large as the largest block. Returns whether there was room.
    """
    x = grains.x
    start, partners = pairs.start, pairs.partners
    l_x, l_y = c[C_PERIOD_X], c[C_PERIOD_Y]
    first, had = near.first[b], near.count[b]
    room, width = near.first[b + 1] - first, near.rows.shape[1]
    old = new = 0
    q = pairs.cross_start[b]
    for i in range(lo, hi):
        x_i, y_i, z_i, r_i = x[i, 0], x[i, 1], x[i, 2], x[i, 3] + reach_on
        for p in range(start[i], start[i + 1]):
            j = partners[p]
            if j < n_solid:
                d_x, d_z = wrap(x[j, 0] - x_i, l_x), x[j, 2] - z_i
                square = d_x * d_x + d_z * d_z
                if not plane_case:
                    d_y = wrap(x[j, 1] - y_i, l_y)
                    square += d_y * d_y
                reach = r_i + x[j, 3]
                close = square < reach * reach
            else:
                a = j - n_solid
                gap = 0.0
                for k in range(3):
                    gap += (x[i, k] - walls.points[a, k]) * walls.normals[a, k]
                close = gap < r_i
            while old < had and near.pair[first + old] < p:
                old += 1
            known = old < had and near.pair[first + old] == p
            if known and near.live[first + old]:
                close = True  # also one that parted since the last step: it has an account to close
            to = j
            if j >= n:
                to = n + b
            elif j < lo or j >= hi:
                pairs.near[q] = close
                to = n + len(near.count) + q
                q += 1
            if not close:
                continue
            if new == room:
                return False
            spare.i[new], spare.j[new], spare.to[new], spare.pair[new] = i, j, to, p
            if known:
                spare.live[new] = near.live[first + old]
                spare.eta[new, ETA_N], spare.eta[new, ETA_S] = (
                    near.eta[first + old, ETA_N],
                    near.eta[first + old, ETA_S],
                )
                for k in range(width):
                    spare.rows[new, k] = near.rows[first + old, k]
            else:
                spare.live[new] = 0
                for k in range(width):
                    spare.rows[new, k] = 0.0
                spare.eta[new, ETA_N], spare.eta[new, ETA_S] = dashpots(
                    i, j, rotation, c, grains.m, x, grains.inertia
                )
            new += 1
    near.count[b] = new
    near.i[first : first + new] = spare.i[:new]
    near.j[first : first + new] = spare.j[:new]
    near.to[first : first + new] = spare.to[:new]
    near.pair[first : first + new] = spare.pair[:new]
    near.live[first : first + new] = spare.live[:new]
    near.eta[first : first + new] = spare.eta[:new]
    near.rows[first : first + new] = spare.rows[:new]
    return True


@kernel()
def count_live(near: Near) -> int:
    """Pairs in touch."""
    total = 0
    for b in range(len(near.count)):
        for k in range(near.first[b], near.first[b] + near.count[b]):
            total += near.live[k]
    return total


@kernel()
def take_rows(n: int, near: Near, ids: Any, out_i: Any, out_j: Any, eta: Any, rows: Any) -> None:
    """Copy ids, dashpots and memory of all pairs in touch, in the order of the list."""
    t = 0
    for b in range(len(near.count)):
        for k in range(near.first[b], near.first[b] + near.count[b]):
            if near.live[k]:
                i, j = near.i[k], near.j[k]
                out_i[t] = ids[i]
                out_j[t] = ids[j] if j < n else j
                eta[t, :] = near.eta[k, :]
                rows[t, :] = near.rows[k, :]
                t += 1


@kernel()
def put_rows(
    n: int, near: Near, block_of: Any, index: Any, i_ids: Any, j_ids: Any, eta: Any, rows: Any
) -> int:
    """Lay dashpots and memory into a new list; returns the first contact that has no place in it, or -1.

    `index` turns the id of a free grain into its place, `block_of` the place into its block.
    """
    for t in range(len(i_ids)):
        i = index[i_ids[t]]
        j = index[j_ids[t]] if j_ids[t] < n else j_ids[t]
        b = block_of[i]
        low, high = near.first[b], near.first[b] + near.count[b]
        end = high
        while low < high:  # the first pair of grain i
            middle = (low + high) // 2
            if near.i[middle] < i:
                low = middle + 1
            else:
                high = middle
        while low < end and near.i[low] == i and near.j[low] != j:
            low += 1
        if low == end or near.i[low] != i:
            return t
        near.eta[low, :] = eta[t, :]
        near.rows[low, :] = rows[t, :]
        near.live[low] = 1
    return -1
