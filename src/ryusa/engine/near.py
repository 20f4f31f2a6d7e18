"""The near list: cut from the wide one every few steps, so that a step looks at hardly more than what touches.

Lanes keep the order of the wide list, and a lane that does not touch adds nothing: when the near list is cut never
shows in the bits of a run.
"""
# ruff: noqa: F403, F405  (the places of lanes.py and the columns of rows.py, all of them plain integers)

from typing import Any

from ryusa.engine._kernel import kernel
from ryusa.engine.arrays import Grains, Near, Pairs, Walls
from ryusa.engine.lanes import *
from ryusa.engine.pair import dashpots
from ryusa.engine.rows import *
from ryusa.laws.geometry import wrap


@kernel(forceinline=True)
def copy_lane(a: int, from_memory: Any, b: int, to_memory: Any) -> None:
    """Copy the memory of lane a of one array of batches to lane b of another."""
    p, q = a // LANES * MEMORY + a % LANES, b // LANES * MEMORY + b % LANES
    for k in range(N_MEMORY):
        to_memory[q + k * LANES] = from_memory[p + k * LANES]


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
    x, w = grains.x, grains.w
    start, partners = pairs.start, pairs.partners
    l_x, l_y = c[C_PERIOD_X], c[C_PERIOD_Y]
    first, had = near.first[b], near.count[b]
    room = near.first[b + 1] - first
    width = near.extra.shape[1] if len(near.extra) else 0
    old = new = live = 0
    q = pairs.cross_start[b]
    for i in range(lo, hi):
        x_i, y_i, z_i, r_i = x[i, 0], x[i, 1], x[i, 2], w[i, 3] + reach_on
        for p in range(start[i], start[i + 1]):
            j = partners[p]
            if j < n_solid:
                d_x, d_z = wrap(x[j, 0] - x_i, l_x), x[j, 2] - z_i
                square = d_x * d_x + d_z * d_z
                if not plane_case:
                    d_y = wrap(x[j, 1] - y_i, l_y)
                    square += d_y * d_y
                reach = r_i + w[j, 3]
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
            if known and not close:  # one that parted since the last step has an account to close
                close = near.memory[(first + old) // LANES * MEMORY + M_LIVE + (first + old) % LANES] > 0.0
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
            place = new // LANES * MEMORY + new % LANES
            if known:
                copy_lane(first + old, near.memory, new, spare.memory)
                for k in range(width):
                    spare.extra[new, k] = near.extra[first + old, k]
                if spare.memory[place + M_LIVE] > 0.0:
                    live += 1
            else:
                for k in range(N_MEMORY):
                    spare.memory[place + k * LANES] = 0.0
                eta = dashpots(i, j, rotation, c, grains.m, w, grains.inertia)
                spare.memory[place + M_ETA_N], spare.memory[place + M_ETA_S] = eta
                for k in range(width):
                    spare.extra[new, k] = 0.0
            new += 1
    near.count[b], near.live[b] = new, live
    near.i[first : first + new] = spare.i[:new]
    near.j[first : first + new] = spare.j[:new]
    near.to[first : first + new] = spare.to[:new]
    near.pair[first : first + new] = spare.pair[:new]
    batches = (new + LANES - 1) // LANES * MEMORY
    place = first // LANES * MEMORY
    near.memory[place : place + batches] = spare.memory[:batches]
    if width:
        near.extra[first : first + new] = spare.extra[:new]
    return True


@kernel()
def count_live(near: Near) -> int:
    """Pairs in touch."""
    total = 0
    for b in range(len(near.count)):
        for k in range(near.first[b], near.first[b] + near.count[b]):
            if near.memory[k // LANES * MEMORY + M_LIVE + k % LANES] > 0.0:
                total += 1
    return total


@kernel()
def take_rows(n: int, near: Near, ids: Any, out_i: Any, out_j: Any, rows: Any) -> None:
    """Copy ids and memory of all pairs in touch, in the order of the list; rows are those of rows.py."""
    t = 0
    for b in range(len(near.count)):
        for k in range(near.first[b], near.first[b] + near.count[b]):
            place = k // LANES * MEMORY + k % LANES
            if near.memory[place + M_LIVE] > 0.0:
                i, j = near.i[k], near.j[k]
                out_i[t] = ids[i]
                out_j[t] = ids[j] if j < n else j
                for a in range(BASE):
                    rows[t, a] = near.memory[place + a * LANES]
                for a in range(rows.shape[1] - BASE):
                    rows[t, BASE + a] = near.extra[k, a]
                t += 1


@kernel()
def put_rows(n: int, near: Near, block_of: Any, index: Any, i_ids: Any, j_ids: Any, rows: Any) -> int:
    """Lay memory into a new list; returns the first contact that has no place in it, or -1.

    `index` turns the id of a free grain into its place, `block_of` the place into its block.
    """
    for t in range(len(i_ids)):
        i = index[i_ids[t]]
        j = index[j_ids[t]] if j_ids[t] < n else j_ids[t]
        b = block_of[i]
        low, high = near.first[b], near.first[b] + near.count[b]
        end = high
        while low < high:  # the first lane of grain i
            middle = (low + high) // 2
            if near.i[middle] < i:
                low = middle + 1
            else:
                high = middle
        while low < end and near.i[low] == i and near.j[low] != j:
            low += 1
        if low == end or near.i[low] != i:
            return t
        place = low // LANES * MEMORY + low % LANES
        for a in range(BASE):
            near.memory[place + a * LANES] = rows[t, a]
        near.memory[place + M_LIVE] = 1.0
        near.live[b] += 1
        for a in range(rows.shape[1] - BASE):
            near.extra[low, a] = rows[t, BASE + a]
    return -1
