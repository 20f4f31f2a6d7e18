"""The loop over steps that threads run together, block by block."""
# ruff: noqa: F403, F405  (the columns of rows.py, all of them plain integers)

from functools import cache
from typing import Any

import numpy as np

from ryusa.engine._kernel import FAST, kernel
from ryusa.engine.arrays import Grains, Ledger, Near, Pairs, Walls
from ryusa.engine.batch import hand_out, lay_out, reckon
from ryusa.engine.company import keep_company, wet_dashpots
from ryusa.engine.lanes import D_SUMS, DESK, LANES, M_DASH_N, M_F_N, M_LIVE, M_SPRING_S, MEMORY
from ryusa.engine.motion import motion
from ryusa.engine.near import cut
from ryusa.engine.rows import *
from ryusa.engine.sync import meet
from ryusa.model.tally import Book

B_STEP, B_DASH_N, B_DASH_S = int(Book.STEP), int(Book.DASH_N), int(Book.DASH_S)
B_SLIDE, B_RELEASED_N, B_RELEASED_S = int(Book.SLIDE), int(Book.RELEASED_N), int(Book.RELEASED_S)


@kernel(fastmath=FAST, forceinline=True)
def forces(
    kind: Variant,
    choice: Choice,
    b: int,
    n: int,
    n_solid: int,
    step: int,
    t: float,
    hdt: float,
    last: bool,
    c: Any,
    grains: Grains,
    walls: Walls,
    pairs: Pairs,
    near: Near,
    desk: Any,
    ended: Any,
    book: Any,
    now: Any,
) -> None:
    """Forces of every pair that block b owns."""
    f, ids = pairs.f, grains.ids
    sums = desk[D_SUMS : D_SUMS + 7]
    sums[:] = 0.0
    sums[6] = now[N_OVERLAP_MAX]
    spring_r = 0.0
    first, end = near.first[b], near.first[b] + near.count[b]
    f[n + b, :] = 0.0  # what fixed grains and planes would get
    while first < end:
        m = min(LANES, end - first)
        i_of, j_of, to = near.i[first : first + m], near.j[first : first + m], near.to[first : first + m]
        memory = near.memory[first // LANES * MEMORY : (first // LANES + 1) * MEMORY]
        lanes = lay_out(m, n_solid, i_of, j_of, grains, walls, desk)
        if choice.rebound:
            wet_dashpots(choice, m, i_of, j_of, c, grains, desk, memory)
        reckon(kind, choice, lanes, hdt, c, desk, memory)
        if kind.rolling or kind.events or kind.film:
            spring_r += keep_company(
                kind, choice, m, n, t, hdt, i_of, j_of, to, c, grains, desk, memory,
                near.extra[first : first + m], ended, book, now,
            )  # fmt: skip
        most = hand_out(m, i_of, to, desk, f, sums)
        if most >= 0:
            i, j = i_of[most], j_of[most]
            now[N_OVERLAP_GRAIN], now[N_OVERLAP_STEP] = ids[i], step
            if sums[6] > c[C_OVERLAP_LIMIT] and now[N_FAULT] == FAULT_NONE:
                now[N_FAULT], now[N_FAULT_GRAIN] = FAULT_OVERLAP, ids[i]
                now[N_FAULT_PARTNER] = ids[j] if j < n else j
        first += LANES
    book[B_DASH_N] += sums[0]
    book[B_DASH_S] += sums[1]
    book[B_SLIDE] += sums[2]
    book[B_RELEASED_N] += sums[3]
    book[B_RELEASED_S] += sums[4]
    book[B_STEP] += sums[5]
    now[N_OVERLAP_MAX] = sums[6]
    if last:
        now[N_SPRING_N], now[N_SPRING_S], now[N_N_CONTACT] = springs(b, c, near)
        now[N_SPRING_R] = spring_r


@kernel(fastmath=FAST)
def springs(b: int, c: Any, near: Near) -> tuple[float, float, int]:
    """Energy in the normal and tangential springs of block b [J], and its contacts."""
    k_n, k_s, memory = c[C_K_N], c[C_K_S], near.memory
    normal = tangential = 0.0
    count = 0
    for k in range(near.first[b], near.first[b] + near.count[b]):
        place = k // LANES * MEMORY + k % LANES
        if memory[place + M_LIVE] > 0.0:
            e_n = memory[place + M_F_N] - memory[place + M_DASH_N]
            if k_n > 0.0:
                normal += 0.5 * e_n * e_n / k_n
            if k_s > 0.0:
                for a in range(3):
                    tangential += 0.5 * memory[place + M_SPRING_S + a * LANES] ** 2 / k_s
            count += 1
    return normal, tangential, count


@cache
def make_run(kind: Variant) -> Any:
    """Build the stepping function of one variant; compiled when first called, then kept on disk."""

    @kernel(nogil=True, fastmath=FAST)
    def run(
        thread: int,
        n_threads: int,
        n_steps: int,
        step: int,
        travel: float,
        count: Any,
        c: Any,
        block_start: Any,
        n: int,
        n_solid: int,
        grains: Grains,
        walls: Walls,
        pairs: Pairs,
        near: Near,
        spare: Near,
        ledger: Ledger,
        choice: Choice,
        clock: Any,
    ) -> tuple[int, float, int]:
        """March up to n_steps; all threads come back with the same (steps done, travel, stop)."""
        ended, books, now = ledger.ended, ledger.books, ledger.now
        n_block = len(block_start) - 1
        b_0, b_1 = thread * n_block // n_threads, (thread + 1) * n_block // n_threads
        dt, t_zero, skin, step_limit = c[C_DT], c[C_T_ZERO], c[C_SKIN], c[C_STEP_LIMIT]
        desk = np.zeros(DESK)
        near_skin, near_travel, since = clock[K_SKIN], clock[K_TRAVEL], clock[K_SINCE]
        cuts, waste = clock[K_CUTS], clock[K_WASTE]
        cost = COST_LOOK * pairs.start[n] + COST_GRAIN * n
        target = done = 0
        stop = STOP_DONE
        while done < n_steps:
            if 2.0 * travel > skin:
                stop = STOP_LIST
                break
            idle = COST_LANE * waste * since  # spent on pairs that do not touch
            if 2.0 * (travel - near_travel) > near_skin or idle > 4.0 * cost:
                near_skin *= 1.25 if idle < cost else 0.8
                near_skin = min(max(near_skin, clock[K_LEAST]), clock[K_MOST])
                reach_on = near_skin + (c[C_FILM_REACH] if kind.film else 0.0)
                for b in range(b_0, b_1):
                    room = cut(
                        b, block_start[b], block_start[b + 1], n, n_solid, reach_on, kind.plane_case,
                        kind.rotation, c, grains, walls, pairs, near, spare,
                    )  # fmt: skip
                    now[b, N_FULL] = 0.0 if room else 1.0
                target = meet(count, n_threads, target)
                near_travel, since, waste = travel, 0.0, 0.0
                cuts += 1.0
                for b in range(n_block):
                    waste += near.count[b] - near.live[b]
                    if now[b, N_FULL] > 0.0:
                        stop = STOP_ROOM
                if stop != STOP_DONE:
                    near_travel = -np.inf
                    break
            last = done == n_steps - 1
            t = t_zero + step * dt
            hdt = 0.0 if step == 0 else 0.5 * dt
            for b in range(b_0, b_1):
                forces(
                    kind, choice, b, n, n_solid, step, t, hdt, last, c, grains, walls, pairs, near, desk,
                    ended[b], books[b], now[b],
                )  # fmt: skip
            target = meet(count, n_threads, target)
            for b in range(b_0, b_1):
                motion(
                    kind, choice, block_start[b], block_start[b + 1], n + n_block, step == 0, last, c, grains,
                    pairs, books[b], now[b],
                )  # fmt: skip
            target = meet(count, n_threads, target)
            fastest = 0.0
            full = False
            for b in range(n_block):
                fastest = max(fastest, now[b, N_SPEED_MAX])
                full = full or now[b, N_ENDED_SHOWN] > 0.5 * ended.shape[1]
                if now[b, N_FAULT_SHOWN] != FAULT_NONE:
                    stop = STOP_FAULT
            travel += fastest * dt
            since += 1.0
            step += 1
            done += 1
            if fastest * dt > step_limit and stop == STOP_DONE:
                stop = STOP_UNSAFE
            if stop != STOP_DONE:
                break
            if full:
                stop = STOP_EVENTS
                break
        meet(count, n_threads, target)
        if thread == 0:
            clock[K_SKIN], clock[K_TRAVEL], clock[K_SINCE] = near_skin, near_travel, since
            clock[K_CUTS], clock[K_WASTE] = cuts, waste
        return done, travel, stop

    return run
