"""The loop over steps that threads run together, block by block."""
# ruff: noqa: E741, F403, F405  (l is a lane; the columns of rows.py, all of them plain integers)

from functools import cache
from typing import Any

import numpy as np

from ryusa.engine.cpu.arrays import Grains, Ledger, Near, Pairs, Walls, Work
from ryusa.engine.cpu.barrier import meet
from ryusa.engine.cpu.batch_layout import D_BOOKS, D_SPIN_I, D_SPIN_J, LANES, N_LANE_BOOK, PITCH
from ryusa.engine.cpu.integration import motion
from ryusa.engine.cpu.pair_batch import hand_out, lay_out, look, overlap_on, reckon
from ryusa.engine.cpu.pair_physics import keep_company, wet_dashpots
from ryusa.engine.cpu.prune import cut, plan_cut, steps_ahead
from ryusa.engine.cpu.simd.borrow import lend
from ryusa.engine.cpu.simd.vec4 import ask, spread4
from ryusa.engine.shared.kernel import FAST, inner, kernel
from ryusa.engine.shared.rows import *
from ryusa.model.tally import Book

Maybe = int | None  # 1, or None for what a variant goes without
# the books a lane keeps, in the order of lanes.py
BOOKS = tuple(
    int(book) for book in (Book.DASH_N, Book.DASH_S, Book.SLIDE, Book.RELEASED_N, Book.RELEASED_S, Book.STEP)
)


@inner(fastmath=FAST, forceinline=True)
def forces(
    kind: Variant,
    flat: Maybe,
    water: Maybe,
    company: Maybe,
    choice: Choice,
    b: int,
    hi: int,
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
    work: Work,
    ended: Any,
    book: Any,
    now: Any,
) -> None:
    """Forces of every pair that block b, grains up to hi-1, owns, batch by batch of those that touch."""
    desk, glance, hit, which = work.desk, work.glance, work.hit, work.which
    reach_on = c[C_FILM_REACH] if kind.film else 0.0
    # arrays are handed over one by one: a tuple of them would have its references counted for every batch
    x, v, w, f = grains.x, grains.v, grains.w, pairs.f
    i_of, j_of, to, live, eta, rows = near.i, near.j, near.to, near.live, near.eta, near.rows
    mass, inertia, points, normals = grains.m, grains.inertia, walls.points, walls.normals
    spring_r = 0.0
    spread4(f, 8 * (n + b), 0.0)  # what fixed grains and planes would get
    spread4(f, 8 * (n + b) + 4, 0.0)
    for place in range(D_BOOKS, D_BOOKS + N_LANE_BOOK * PITCH):
        desk[place] = 0.0
    k = near.first[b]
    end = k + near.count[b]
    waiting = 0
    while True:
        while waiting < LANES and k < end:
            some = min(LANES, end - k)
            for g in range(i_of[k] + pairs.slab, min(i_of[k + some - 1] + pairs.slab + 1, n)):
                ask(x, 4 * g)
                ask(v, 8 * g)
                if g < hi:  # beyond, another thread may be writing
                    ask(f, 8 * g)
            waiting = look(
                kind.plane_case, reach_on, k, some, waiting, n_solid, c, x, i_of, j_of, live, points, normals,
                glance, hit, which,
            )  # fmt: skip
            k += some
        m = min(waiting, LANES)
        if m == 0:
            break
        lanes = lay_out(
            kind.rotation,
            m,
            which,
            n_solid,
            c,
            mass,
            inertia,
            x,
            v,
            w,
            points,
            normals,
            i_of,
            j_of,
            live,
            eta,
            rows,
            desk,
        )
        if water is not None and choice.rebound:
            wet_dashpots(choice, m, which, c, grains, near, desk)
        reckon(flat, choice, lanes, hdt, now[N_OVERLAP_MAX], c, desk)
        if company is not None:
            spring_r += keep_company(
                kind, choice, m, n, t, hdt, which, c, grains, near, desk, ended, book, now
            )
        if hand_out(m, which, i_of, to, live, rows, desk, f):
            guard(m, which, n, step, c, grains, near, desk, now)
        waiting -= m
        for l in range(waiting):
            which[l] = which[LANES + l]
    for row in range(N_LANE_BOOK):
        total = 0.0
        for l in range(LANES):
            total += desk[D_BOOKS + row * PITCH + l]
        book[BOOKS[row]] += total
    if last:
        now[N_SPRING_N], now[N_SPRING_S], now[N_N_CONTACT] = springs(b, c, near)
        now[N_SPRING_R] = spring_r


@inner()
def guard(
    m: int, which: Any, n: int, step: int, c: Any, grains: Grains, near: Near, desk: Any, now: Any
) -> None:
    """Note the largest overlap among the first m lanes, and flag one beyond the limit."""
    ids = grains.ids
    for l in range(m):
        smaller = 2.0 * min(desk[D_SPIN_I + 4 * l + 3], desk[D_SPIN_J + 4 * l + 3])
        ratio = overlap_on(l, c, desk) / smaller
        if ratio > now[N_OVERLAP_MAX]:
            i, j = near.i[which[l]], near.j[which[l]]
            now[N_OVERLAP_MAX], now[N_OVERLAP_GRAIN], now[N_OVERLAP_STEP] = ratio, ids[i], step
            if ratio > c[C_OVERLAP_LIMIT] and now[N_FAULT] == FAULT_NONE:
                now[N_FAULT], now[N_FAULT_GRAIN] = FAULT_OVERLAP, ids[i]
                now[N_FAULT_PARTNER] = ids[j] if j < n else j


@inner(fastmath=FAST)
def springs(b: int, c: Any, near: Near) -> tuple[float, float, int]:
    """Energy in the normal and tangential springs of block b [J], and its contacts."""
    k_n, k_s, rows = c[C_K_N], c[C_K_S], near.rows
    normal = tangential = 0.0
    count = 0
    for k in range(near.first[b], near.first[b] + near.count[b]):
        if near.live[k]:
            e_n = rows[k, R_F_N] - rows[k, R_DASH_N]
            if k_n > 0.0:
                normal += 0.5 * e_n * e_n / k_n
            if k_s > 0.0:
                for a in range(3):
                    tangential += 0.5 * rows[k, R_SPRING_S + a] ** 2 / k_s
            count += 1
    return normal, tangential, count


@cache
def make_run(kind: Variant) -> Any:
    """Build the stepping function of one variant; compiled when first called, then kept on disk.

    What a variant goes without is handed on as None: the compiler then leaves it out before it types it.
    """
    flat: Maybe = 1 if kind.plane_case else None
    water: Maybe = 1 if kind.water else None
    company: Maybe = 1 if kind.rolling or kind.events or kind.film else None

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
        work: Work,
        choice: Choice,
        clock: Any,
    ) -> tuple[int, float, int]:
        """March up to n_steps; all threads come back with the same (steps done, travel, stop)."""
        c, grains, walls, pairs, work = lend(c), lend(grains), lend(walls), lend(pairs), lend(work)
        near, spare, ledger, block_start = lend(near), lend(spare), lend(ledger), lend(block_start)
        ended, books, now = ledger.ended, ledger.books, ledger.now
        n_block = len(block_start) - 1
        b_0, b_1 = thread * n_block // n_threads, (thread + 1) * n_block // n_threads
        dt, t_zero, skin, step_limit = c[C_DT], c[C_T_ZERO], c[C_SKIN], c[C_STEP_LIMIT]
        own = work.clock
        for k in range(N_CLOCK):
            own[k] = clock[k]
        look = COST_LOOK * pairs.start[n] + COST_GRAIN * n
        target = done = 0
        stop = STOP_DONE
        while done < n_steps:
            if 2.0 * travel > skin:
                stop = STOP_LIST
                break
            if own[K_STRAY] > own[K_SKIN] or own[K_SINCE] >= own[K_LASTS]:
                plan_cut(own, look)
                fastest = 0.0
                for b in range(n_block):
                    fastest = max(fastest, now[b, N_SPEED_MAX])
                own[K_LASTS] = steps_ahead(own, fastest * dt)
                reach_on = ROUNDED_UP * own[K_SKIN] + (c[C_FILM_REACH] if kind.film else 0.0)
                for b in range(b_0, b_1):
                    now[b, N_FULL], now[b, N_TOUCHING] = cut(
                        b, block_start[b], block_start[b + 1], n, n_solid, reach_on, own[K_LASTS] * dt,
                        kind.plane_case, c, grains, walls, pairs, near, spare, work,
                    )  # fmt: skip
                target = meet(count, n_threads, target)
                own[K_STRAY] = own[K_SINCE] = own[K_LANES] = own[K_TOUCHING] = 0.0
                for b in range(n_block):
                    own[K_LANES] += near.count[b]
                    own[K_TOUCHING] += now[b, N_TOUCHING]
                    if now[b, N_FULL] != 0.0:
                        stop = STOP_ROOM
                if stop != STOP_DONE:
                    own[K_STRAY] = np.inf
                    break
            last = done == n_steps - 1
            t = t_zero + step * dt
            hdt = 0.0 if step == 0 else 0.5 * dt
            for b in range(b_0, b_1):
                forces(
                    kind, flat, water, company, choice, b, block_start[b + 1], n, n_solid, step, t, hdt, last,
                    c, grains, walls, pairs, near, work, ended[b], books[b], now[b],
                )  # fmt: skip
            target = meet(count, n_threads, target)
            for b in range(b_0, b_1):
                motion(
                    kind, water, choice, block_start[b], block_start[b + 1], step == 0, last, c, grains,
                    pairs, work.table, books[b], now[b],
                )  # fmt: skip
            target = meet(count, n_threads, target)
            fastest = stray = 0.0
            full = False
            for b in range(n_block):
                fastest, stray = max(fastest, now[b, N_SPEED_MAX]), max(stray, now[b, N_STRAY_MAX])
                full = full or now[b, N_ENDED_SHOWN] > 0.5 * ended.shape[1]
                if now[b, N_FAULT_SHOWN] != FAULT_NONE:
                    stop = STOP_FAULT
            travel += fastest * dt
            own[K_STRAY] += 2.0 * stray * dt
            own[K_SINCE] += 1.0
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
            for k in range(N_CLOCK):
                clock[k] = own[k]
        return done, travel, stop

    return run
