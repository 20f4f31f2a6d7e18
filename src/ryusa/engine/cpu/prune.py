"""Candidate pairs: the inner list, pruned from the Verlet list every few steps.

A step then sees little more than what touches. Pairs keep the order of the Verlet list, and those that do not
touch are skipped: when the list is pruned never shows in the bits of a run.
"""
# ruff: noqa: E741  (l is a lane)

import math
from functools import cache
from typing import Any

from ryusa.compiled.borrow import borrow
from ryusa.compiled.piece import call, lend, taken
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.arrays import CandidateArrays, PairArrays, StepArrays, TouchingPairs, Workspace
from ryusa.engine.cpu.contact_rows import copy_row
from ryusa.engine.cpu.cutoff import mark_approaching, set_relative_velocity, set_separation
from ryusa.engine.cpu.faces import distance_to
from ryusa.engine.cpu.simd.vec4 import copy4, fill4
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner, kernel


@kernel(nogil=True)
def prune_blocks(
    piece: Any, first: int, last: int, reach_on: float, ahead: float, plane_case: int, work: Workspace,
    held: StepArrays,
) -> bool:  # fmt: skip
    """Prune the lists of blocks first..last-1; returns whether all pairs in touch were found (`prune`)."""
    lent, lent_work = lend(held), lend(work)
    found = True
    for b in range(first, last):
        found = call(piece, (b, reach_on, ahead, plane_case, lent_work, lent)) >= 0 and found
    return found


@cache
def make_prune(walled: bool) -> Any:
    """Build the piece that prunes the list of a block: prune(b, reach_on, ahead, plane_case, work, held)."""

    @kernel()
    def prune(b: int, reach_on: float, ahead: float, plane_case: int, work: Any, held: Any) -> int:
        """List anew the pairs of block b that come nearer than `reach_on` [m] beyond touch.

        They do so within `ahead` seconds if each grain keeps its velocity, stored in `GrainArrays.v_pruned`;
        or did within the last two steps, and have an account to close: a contact that ends within a step is
        closed in the next. `spare` has room for the pairs in touch of any block. Returns how many are in
        touch, or -1 where one of them is beyond reach, which should not be.
        """
        held, work = taken(held), taken(work)
        c, grains, walls, pairs = held.c, held.grains, held.walls, held.pairs
        candidates, spare, n, n_solid = held.candidates, held.spare, held.n, held.n_solid
        lo, hi = held.block_start[b], held.block_start[b + 1]
        first, n_touching = candidates.first[b], _save_touching(b, candidates, spare)
        # numbers in the Verlet list stand where targets come later
        i_of, j_of, pair, touching = candidates.i, candidates.j, candidates.target, candidates.touching
        x, v, v_pruned, start, partners = grains.x, grains.v, grains.v_pruned, pairs.start, pairs.partners
        points, normals = walls.points, walls.normals
        separation, velocity, inside, owner = work.separation, work.velocity, work.inside, work.selected
        for g in range(lo, hi):
            copy4(v_pruned, 4 * g, v, 8 * g)
        new, i = 0, lo
        for begin in range(start[lo], start[hi], B.LANES):
            m = min(B.LANES, start[hi] - begin)
            for l in range(m):
                while begin + l >= start[i + 1]:
                    i += 1
                owner[l] = i
                if walled and partners[begin + l] >= n_solid + len(points):
                    seconds = max(ahead, 2.0 * c[P.DT])
                    f = partners[begin + l] - n_solid - len(points)
                    distance = distance_to(
                        f, x[i, 0], x[i, 1], x[i, 2], c[P.PERIOD_X], c[P.PERIOD_Y], walls.faces.poses,
                        walls.faces.rows, walls.faces.centre,
                    )  # fmt: skip
                    set_face(l, i, distance, seconds * walls.faces.speed, seconds, x, v, separation, velocity)
                    continue
                set_separation(l, i, partners[begin + l], n_solid, x, points, normals, separation)
                set_relative_velocity(l, i, partners[begin + l], n_solid, v, normals, velocity)
            mark_approaching(plane_case, reach_on, 2.0 * c[P.DT], ahead, m, c, separation, velocity, inside)
            for l in range(m):  # no branch: which pairs are near is not predictable
                i_of[first + new], pair[first + new] = owner[l], begin + l
                new += int(inside[l] > 0.0)
        candidates.count[b] = new
        _link_partners(b, lo, hi, n, pairs, candidates)
        if walled:
            list_faces(b, n_solid, candidates)
        for k in range(first, first + new):
            touching[k] = 0
        k = first
        for t in range(n_touching):
            while k < first + new and (i_of[k] != spare.i[t] or j_of[k] != spare.j[t]):
                k += 1
            if k == first + new:
                return -1
            touching[k] = spare.touching[t]
            copy_row(k, candidates.eta, candidates.rows, t, spare.eta, spare.rows)
        return n_touching

    return prune


@inner(forceinline=False)
def _link_partners(b: int, lo: int, hi: int, n: int, pairs: PairArrays, candidates: CandidateArrays) -> None:
    """Set the partners of the candidates of block b, and the rows where the forces on them go.

    In place of these stand the numbers of the pairs in the Verlet list.
    """
    first = pairs.cross_start[b]
    rows = n + len(candidates.count)
    crossing = pairs.crossing
    wanted = pairs.active
    last = pairs.cross_start[b + 1]
    for row in range(rows + first, rows + last):
        wanted[row] = 0
    q = first
    for k in range(candidates.first[b], candidates.first[b] + candidates.count[b]):
        p = candidates.target[k]
        j = pairs.partners[p]
        candidates.j[k] = j
        candidates.target[k] = j if j < n else n + b
        if j < n and (j < lo or j >= hi):
            while crossing[q] < p:
                q += 1
            candidates.target[k] = rows + q
            wanted[rows + q] = 1


@inner(fastmath=FAST, forceinline=True)
def set_face(
    l: int,
    i: int,
    distance: float,
    moved: float,
    seconds: float,
    x: Any,
    v: Any,
    separation: Any,
    velocity: Any,
) -> None:
    """Write to lane l how near grain i can come to a face within `seconds`, if the face is `moved` [m]."""
    speed = math.sqrt(v[i, 0] * v[i, 0] + v[i, 1] * v[i, 1] + v[i, 2] * v[i, 2])
    fill4(separation, 4 * l, 0.0)
    fill4(velocity, 4 * l, 0.0)
    separation[4 * l + 2] = max(distance - speed * seconds - moved, 0.0)
    separation[4 * l + 3] = x[i, 3]


@inner(forceinline=False)
def list_faces(b: int, n_solid: int, candidates: CandidateArrays) -> None:
    """List the candidates of block b that are planes or faces."""
    first, count = candidates.first[b], 0
    for k in range(first, first + candidates.count[b]):
        if candidates.j[k] >= n_solid:
            s = first + count
            candidates.face[s], candidates.slot[k] = k, count
            candidates.face_grain[s], candidates.face_number[s] = (
                candidates.i[k],
                candidates.j[k] - n_solid,
            )
            count += 1
    candidates.face_count[b] = count


@inner(forceinline=False)
def _save_touching(b: int, candidates: CandidateArrays, spare: TouchingPairs) -> int:
    """Copy the pairs in touch of block b; returns how many there are."""
    t = 0
    for k in range(candidates.first[b], candidates.first[b] + candidates.count[b]):
        if candidates.touching[k]:
            spare.i[t], spare.j[t] = candidates.i[k], candidates.j[k]
            spare.touching[t] = candidates.touching[k]
            copy_row(t, spare.eta, spare.rows, k, candidates.eta, candidates.rows)
            t += 1
    return t


@kernel(nogil=True)
def count_touching(b_0: int, b_1: int, candidates: CandidateArrays, count: Any) -> None:
    """Set count[b + 1] to the pairs in touch of each block b in b_0..b_1-1."""
    for b in range(b_0, b_1):
        total = 0
        for k in range(candidates.first[b], candidates.first[b] + candidates.count[b]):
            total += int(candidates.touching[k] != 0)
        count[b + 1] = total


@kernel(nogil=True)
def copy_rows_out(
    b_0: int, b_1: int, k_0: int, k_1: int, n: int, candidates: CandidateArrays, ids: Any, out_i: Any,
    out_j: Any, states: Any, eta: Any, rows: Any,
) -> int:  # fmt: skip
    """Copy names, states, springs and memory of pairs in touch, in list order; returns how many there are.

    They are those of candidates k_0..k_1-1 that belong to blocks b_0..b_1-1. A grain's name is its id, or its
    place where `ids` is empty.
    """
    candidates, out_i, out_j, states = borrow(candidates), borrow(out_i), borrow(out_j), borrow(states)
    ids, eta, rows = borrow(ids), borrow(eta), borrow(rows)
    by_id, t = len(ids) > 0, 0
    for b in range(b_0, b_1):
        first = candidates.first[b]
        for k in range(max(first, k_0), min(first + candidates.count[b], k_1)):
            if candidates.touching[k]:
                i, j = candidates.i[k], candidates.j[k]
                out_i[t] = ids[i] if by_id else i
                out_j[t] = ids[j] if by_id and j < n else j
                states[t] = candidates.touching[k]
                copy_row(t, eta, rows, k, candidates.eta, candidates.rows)
                t += 1
    return t


@kernel(nogil=True)
def copy_rows_in(
    n: int, block_start: Any, candidates: CandidateArrays, place_of: Any, i_of: Any, j_of: Any, states: Any,
    eta: Any, rows: Any,
) -> int:  # fmt: skip
    """Copy contacts into a new list, until one is not in it; returns how many were copied.

    `place_of` turns the name of a free grain into its place.
    """
    candidates, place_of, i_of, j_of = borrow(candidates), borrow(place_of), borrow(i_of), borrow(j_of)
    states, eta, rows = borrow(states), borrow(eta), borrow(rows)
    b = 0
    for t in range(len(i_of)):
        i = place_of[i_of[t]]
        j = place_of[j_of[t]] if j_of[t] < n else j_of[t]
        while i < block_start[b]:
            b -= 1
        while i >= block_start[b + 1]:
            b += 1
        low, high = candidates.first[b], candidates.first[b] + candidates.count[b]
        end = high
        while low < high:  # the first pair of grain i
            middle = (low + high) // 2
            if candidates.i[middle] < i:
                low = middle + 1
            else:
                high = middle
        while low < end and candidates.i[low] == i and candidates.j[low] != j:
            low += 1
        if low == end or candidates.i[low] != i:
            return t
        copy_row(low, candidates.eta, candidates.rows, t, eta, rows)
        candidates.touching[low] = states[t]
    return len(i_of)
