"""The near list: cut from the wide one every few steps, so that a step sees little more than what touches.

Pairs keep the order of the wide list, and those that do not touch are passed over: when the near list is cut
never shows in the bits of a run.
"""
# ruff: noqa: E741, F403, F405  (l is a lane; the columns of rows.py, all of them plain integers)

import math
from typing import Any

from ryusa.engine.cpu.arrays import Grains, Near, Pairs, Walls, Work
from ryusa.engine.cpu.batch_layout import LANES
from ryusa.engine.cpu.cutoff import see_apart, see_drift, tell_coming
from ryusa.engine.cpu.simd.vec4 import copy4
from ryusa.engine.shared.kernel import inner, kernel
from ryusa.engine.shared.pair import place_of_eta
from ryusa.engine.shared.rows import *

_SLACK = 2 * LANES  # pairs are listed by the batch, where a whole one would find room


@kernel(nogil=True)
def cut_blocks(
    first: int, last: int, block_start: Any, n: int, n_solid: int, reach_on: float, ahead: float,
    plane_case: int, c: Any, grains: Grains, walls: Walls, pairs: Pairs, near: Near, spare: Near, work: Work,
    wanted: Any,
) -> None:  # fmt: skip
    """Cut the lists of blocks first..last-1; `wanted` gets the room that each wants (see `cut`)."""
    for b in range(first, last):
        wanted[b] = cut(
            b, block_start[b], block_start[b + 1], n, n_solid, reach_on, ahead, plane_case, c, grains, walls,
            pairs, near, spare, work,
        )[0]  # fmt: skip


@inner()
def cut(
    b: int, lo: int, hi: int, n: int, n_solid: int, reach_on: float, ahead: float, plane_case: int, c: Any,
    grains: Grains, walls: Walls, pairs: Pairs, near: Near, spare: Near, work: Work,
) -> tuple[int, int]:  # fmt: skip
    """List anew the pairs of block b, grains lo..hi-1, that come nearer than `reach_on` [m] beyond touch.

    They do so within `ahead` seconds if each grain keeps its velocity, which is noted in `Grains.then`; or
    did within the last step, and have an account to close. `spare` has room for the pairs in touch of any
    block. Returns how much room is wanted where there was too little (the list then holds the pairs in touch
    alone), 0 where there was enough, -1 where a pair in touch is beyond reach, which should not be; and how
    many are in touch.
    """
    first, touching = near.first[b], _put_aside(b, near, spare)
    room = near.first[b + 1] - first
    i_of, pair, live = near.i, near.pair, near.live
    x, v, then, start, partners = grains.x, grains.v, grains.then, pairs.start, pairs.partners
    points, normals = walls.points, walls.normals
    glance, drift, hit, owner = work.glance, work.drift, work.hit, work.which
    for g in range(lo, hi):
        copy4(then, 4 * g, v, 8 * g)
    new, i, full = 0, lo, False
    for begin in range(start[lo], start[hi], LANES):
        m = min(LANES, start[hi] - begin)
        for l in range(m):
            while begin + l >= start[i + 1]:
                i += 1
            owner[l] = i
            see_apart(l, i, partners[begin + l], n_solid, x, points, normals, glance)
            see_drift(l, i, partners[begin + l], n_solid, v, normals, drift)
        tell_coming(plane_case, reach_on, c[C_DT], ahead, m, c, glance, drift, hit)
        full = full or new + m > room
        for l in range(m):  # no branch: who is near cannot be foretold
            if not full:
                i_of[first + new], pair[first + new] = owner[l], begin + l
            new += int(hit[l] > 0.0)
    if full:
        _take_back(b, touching, near, spare)
        return new + _SLACK, touching
    near.count[b] = new
    _address(b, lo, hi, n, pairs, near)
    for k in range(first, first + new):
        live[k] = 0
    k = first
    for t in range(touching):
        while k < first + new and pair[k] < spare.pair[t]:
            k += 1
        if k == first + new or pair[k] != spare.pair[t]:
            return -1, touching
        live[k] = 1
        _copy_row(k, near.eta, near.rows, t, spare.eta, spare.rows)
    return 0, touching


@inner()
def _address(b: int, lo: int, hi: int, n: int, pairs: Pairs, near: Near) -> None:
    """Tell the near pairs of block b their partners, and where the force on those goes."""
    first, rows, crossing, wanted = pairs.cross_start[b], n + len(near.count), pairs.crossing, pairs.near
    last = pairs.cross_start[b + 1]
    for row in range(rows + first, rows + last):
        wanted[row] = 0
    q = first
    for k in range(near.first[b], near.first[b] + near.count[b]):
        p = near.pair[k]
        j = pairs.partners[p]
        near.j[k] = j
        near.to[k] = j if j < n else n + b
        if j < n and (j < lo or j >= hi):
            while crossing[q] < p:
                q += 1
            near.to[k] = rows + q
            wanted[rows + q] = 1


@inner(forceinline=True)
def _copy_row(at: int, to_eta: Any, to_rows: Any, of: int, eta: Any, rows: Any) -> None:
    # four by four: slices would have their references counted
    width = rows.shape[1]
    a, e = place_of_eta(at, to_eta), place_of_eta(of, eta)
    to_eta[a, 0], to_eta[a, 1] = eta[e, 0], eta[e, 1]
    for k in range(0, width - 3, 4):
        copy4(to_rows, width * at + k, rows, width * of + k)
    for k in range(width // 4 * 4, width):
        to_rows[at, k] = rows[of, k]


@inner()
def _put_aside(b: int, near: Near, spare: Near) -> int:
    """Copy the pairs in touch of block b; returns how many there are."""
    t = 0
    for k in range(near.first[b], near.first[b] + near.count[b]):
        if near.live[k]:
            spare.i[t], spare.j[t] = near.i[k], near.j[k]
            spare.to[t], spare.pair[t] = near.to[k], near.pair[k]
            _copy_row(t, spare.eta, spare.rows, k, near.eta, near.rows)
            t += 1
    return t


@inner()
def _take_back(b: int, touching: int, near: Near, spare: Near) -> None:
    """Make the pairs put aside the whole list of block b."""
    first = near.first[b]
    near.count[b] = touching
    for t in range(touching):
        k = first + t
        near.i[k], near.j[k], near.to[k], near.pair[k] = spare.i[t], spare.j[t], spare.to[t], spare.pair[t]
        near.live[k] = 1
        _copy_row(k, near.eta, near.rows, t, spare.eta, spare.rows)


@kernel()
def best_skin(skin: float, closing: float, making: float, keeping: float) -> float:
    """Reach of a list beyond touch that costs least [m]; at most twice, at least half of what it is.

    Parameters
    ----------
    skin : its reach now [m].
    closing : how much nearer two grains may come in a step [m]: a list lasts skin/closing steps.
    making : cost of making the list.
    keeping : cost in each step of its pairs that do not touch; their number goes with the skin.

    Notes
    -----
    The cost of a step, making closing/s + keeping s/skin, is least at s = sqrt(making closing skin/keeping).
    """
    if keeping <= 0.0:
        return 2.0 * skin
    return min(max(math.sqrt(making * closing * skin / keeping), 0.5 * skin), 2.0 * skin)


@inner()
def plan_cut(clock: Any, look: float) -> None:
    """Choose reach and time ahead of the next near list from how the last one fared.

    Parameters
    ----------
    clock : places K_ of rows.py.
    look : cost of looking at all pairs of the wide list.
    """
    since = clock[K_SINCE]
    if since == 0.0:
        return
    rate = clock[K_STRAY] / since
    skin = best_skin(
        clock[K_SKIN], rate, look + COST_LAY * clock[K_LANES],
        COST_NEAR * (clock[K_LANES] - clock[K_TOUCHING]),
    )  # fmt: skip
    skin = min(max(skin, clock[K_LEAST]), clock[K_MOST])
    clock[K_SKIN] = skin
    clock[K_AHEAD] = min(LOOK_AHEAD * skin / rate, LONGEST_CUT) if rate > 0.0 else LONGEST_CUT


@kernel()
def steps_ahead(clock: Any, way: float) -> float:
    """Steps a near list may last, where the fastest grain goes `way` in one [m].

    In a period no more than leave the nearest image of a partner the one that matters.
    """
    if way > 0.0:
        return max(math.floor(min(clock[K_AHEAD], (clock[K_ROOM] - clock[K_SKIN]) / (2.0 * way))), 1.0)
    return clock[K_AHEAD]


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
                _copy_row(t, eta, rows, k, near.eta, near.rows)
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
        _copy_row(low, near.eta, near.rows, t, eta, rows)
        near.live[low] = 1
    return -1
