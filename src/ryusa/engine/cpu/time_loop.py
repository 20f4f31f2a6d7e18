"""The loop over steps that threads run together, block by block."""
# ruff: noqa: E741  (l is a lane)

from functools import cache
from typing import Any

import numpy as np

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu import prune_schedule as K
from ryusa.engine.cpu.arrays import (
    AccountArrays,
    CandidateArrays,
    GrainArrays,
    PairArrays,
    WallArrays,
    Workspace,
)
from ryusa.engine.cpu.attraction import attract, energy_of_attraction
from ryusa.engine.cpu.barrier import wait
from ryusa.engine.cpu.contact_rows import has_short_rows, springs_of_row
from ryusa.engine.cpu.exact_contact import compute_exactly, keep_states, spring_energy_of_maps
from ryusa.engine.cpu.hertz_contact import compute_hertz, spring_energy_hertz
from ryusa.engine.cpu.integration import integrate, post
from ryusa.engine.cpu.pair_batch import compute, filter_pairs, gather, overlap_of_lane, scatter
from ryusa.engine.cpu.pair_physics import immersed_dashpots, optional_physics
from ryusa.engine.cpu.prune import prune
from ryusa.engine.cpu.prune_schedule import COST_GRAIN, COST_TEST, ROUNDED_UP, plan_prune, steps_ahead
from ryusa.engine.cpu.rigid_bodies import move_bodies
from ryusa.engine.cpu.simd.borrow import borrow
from ryusa.engine.cpu.simd.prefetch import prefetch
from ryusa.engine.cpu.simd.vec4 import fill4
from ryusa.engine.cpu.wall_contacts import add_drift, book_walls, resolve_walls
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner, kernel
from ryusa.engine.shared.status import (
    FAULT_NONE,
    FAULT_OVERLAP,
    STOP_DONE,
    STOP_EVENTS,
    STOP_FAULT,
    STOP_LIST,
    STOP_ROOM,
    STOP_UNSAFE,
)
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.engine.shared.wall_pose import set_poses
from ryusa.model.tally import Term

Present = int | None  # 1, or None for what a variant goes without
# the terms of the account that a lane sums, in the order of batch_layout.py
TERMS = tuple(
    int(account)
    for account in (Term.DASH_N, Term.DASH_S, Term.SLIDE, Term.RELEASED_N, Term.RELEASED_S, Term.STEP)
)
WALL = int(Term.WALL)


@inner(fastmath=FAST, forceinline=True)
def block_forces(
    variant: KernelVariant, flat: Present, water: Present, optional: Present, exact: Present, hertz: Present,
    short: Present, walled: Present, adhesive: Present, choice: LawChoice, b: int, b_0: int, hi: int, n: int,
    n_solid: int, step: int, t: float, hdt: float, last: bool, c: Any, material: Any, table: Any,
    grains: GrainArrays, walls: WallArrays, pairs: PairArrays, candidates: CandidateArrays, work: Workspace,
    accounts: AccountArrays, ended: Any, account: Any, stats: Any,
) -> None:  # fmt: skip
    """Forces of every pair that block b, grains up to hi-1, owns, batch by batch of those that touch.

    `b_0` is the first block of the thread, with whose place in the workspace of faces it begins.
    """
    # One function: what a variant goes without is taken out of it before it is compiled
    batch, separation, inside, selected = work.batch, work.separation, work.inside, work.selected
    reach_on = c[P.FILM_REACH] if variant.film else 0.0
    # arrays are passed one by one: references to a tuple of them would be counted for every batch
    x, v, w, f, ids = grains.x, grains.v, grains.w, pairs.f, grains.ids
    i_of, j_of, to, touching, eta, rows = (
        candidates.i,
        candidates.j,
        candidates.target,
        candidates.touching,
        candidates.eta,
        candidates.rows,
    )
    mass, inertia, points, normals = grains.m, grains.inertia, walls.points, walls.normals
    met, slot, face_lanes, impulse = candidates.met, candidates.slot, work.face_lanes, accounts.walls[b]
    spring_r = given = pending = 0.0
    fill4(f, 8 * (n + b), 0.0)  # forces on fixed grains and planes, not used
    fill4(f, 8 * (n + b) + 4, 0.0)
    for place in range(B.WORK, B.WORK + B.N_WORK * B.PITCH):
        batch[place] = 0.0
    if walled is not None:
        met = met[candidates.first[b_0] :]  # the same rows for all blocks of a thread stay in its cache
        given = stats[S.PENDING_WALL]
        resolve_walls(b, reach_on, c, grains, walls.faces, candidates, met)
    k = candidates.first[b]
    end = k + candidates.count[b]
    waiting = 0
    while True:
        while waiting < B.LANES and k < end:
            some = min(B.LANES, end - k)
            for g in range(i_of[k] + pairs.slab, min(i_of[k + some - 1] + pairs.slab + 1, n)):
                prefetch(x, 4 * g)
                prefetch(v, 8 * g)
                if g < hi:  # beyond, another thread may be writing
                    prefetch(f, 8 * g)
            waiting = filter_pairs(
                variant.plane_case, walled, reach_on, k, some, waiting, n_solid, c, x, i_of, j_of, touching,
                points, normals, met, slot, separation, inside, selected,
            )  # fmt: skip
            k += some
        m = min(waiting, B.LANES)
        if m == 0:
            break
        lanes = gather(
            variant.rotation, M.OF_MAPS * variant.exact + M.HERTZ * variant.hertz, short, walled, m, selected,
            n_solid, c, mass, inertia, x, v, w, points, normals, i_of, j_of, touching, eta, rows, met, slot,
            face_lanes, ids, material, table, batch,
        )  # fmt: skip
        if walled is not None:
            add_drift(face_lanes, selected, slot, walls.faces.motion, met, batch)
        if water is not None and choice.rebound:
            immersed_dashpots(
                exact, hertz, choice, m, selected, c, material, table, grains, candidates, batch
            )
        if hertz is not None:
            compute_hertz(flat, choice, lanes, hdt, stats[S.OVERLAP_MAX], table, c, batch)
        elif exact is None:
            compute(flat, choice, lanes, hdt, stats[S.OVERLAP_MAX], table, c, batch)
        else:
            compute_exactly(
                flat, variant.rotation, choice, m, lanes, hdt, stats[S.OVERLAP_MAX], selected, i_of, j_of,
                mass, inertia, w, ids, material, table, c, batch,
            )  # fmt: skip
        if adhesive is not None:
            attract(choice, m, hdt, selected, c, material, table, grains, candidates, batch)
        if optional is not None:
            spring_r += optional_physics(
                variant, choice, m, n, t, hdt, selected, c, material, table, grains, candidates, batch, ended,
                account, stats,
            )  # fmt: skip
        if walled is not None:
            given, pending = book_walls(
                given, pending, face_lanes, selected, hdt, c, i_of, x, slot, walls.faces.poses,
                walls.faces.motion, met, impulse, batch,
            )  # fmt: skip
        if exact is not None:
            keep_states(m, selected, touching, batch)
        if scatter(exact, short, m, selected, i_of, to, touching, rows, batch, f):
            track_overlap(m, selected, n, step, c, grains, candidates, batch, stats)
        waiting -= m
        for l in range(waiting):
            selected[l] = selected[B.LANES + l]
    if walled is not None:
        account[WALL] += given
        stats[S.PENDING_WALL] = pending
    for row in range(B.N_WORK):
        total = 0.0
        for l in range(B.LANES):
            total += batch[B.WORK + row * B.PITCH + l]
        account[TERMS[row]] += total
    if last:
        if hertz is not None:
            stats[S.SPRING_N], stats[S.SPRING_S], stats[S.N_CONTACT] = spring_energy_hertz(
                b, c, ids, material, table, candidates
            )
        elif exact is None:
            stats[S.SPRING_N], stats[S.SPRING_S], stats[S.N_CONTACT] = spring_energy(b, c, candidates)
        else:
            stats[S.SPRING_N], stats[S.SPRING_S], stats[S.N_CONTACT] = spring_energy_of_maps(b, candidates)
        if adhesive is not None:
            stats[S.SPRING_N] -= energy_of_attraction(
                b, choice, hertz, c, material, table, grains, candidates
            )
        stats[S.SPRING_R] = spring_r


@inner(fastmath=FAST)
def track_overlap(
    m: int,
    selected: Any,
    n: int,
    step: int,
    c: Any,
    grains: GrainArrays,
    candidates: CandidateArrays,
    batch: Any,
    stats: Any,
) -> None:
    """Keep the largest overlap among the first m lanes, and flag one beyond the limit."""
    ids = grains.ids
    for l in range(m):
        smaller = 2.0 * min(batch[B.SPIN_I + 4 * l + 3], batch[B.SPIN_J + 4 * l + 3])
        ratio = overlap_of_lane(l, c, batch) / smaller
        if ratio > stats[S.OVERLAP_MAX]:
            i, j = candidates.i[selected[l]], candidates.j[selected[l]]
            stats[S.OVERLAP_MAX], stats[S.OVERLAP_GRAIN], stats[S.OVERLAP_STEP] = ratio, ids[i], step
            if ratio > c[P.OVERLAP_LIMIT] and stats[S.FAULT] == FAULT_NONE:
                stats[S.FAULT], stats[S.FAULT_GRAIN] = FAULT_OVERLAP, ids[i]
                stats[S.FAULT_PARTNER] = ids[j] if j < n else j


@inner(fastmath=FAST)
def spring_energy(b: int, c: Any, candidates: CandidateArrays) -> tuple[float, float, int]:
    """Energy in the normal and tangential springs of block b [J], and its contacts."""
    k_n, k_s, rows = c[P.K_N], c[P.K_S], candidates.rows
    normal = tangential = 0.0
    count = 0
    for k in range(candidates.first[b], candidates.first[b] + candidates.count[b]):
        if candidates.touching[k]:
            e_n, s_x, s_y, s_z = springs_of_row(k, rows)
            if k_n > 0.0:
                normal += 0.5 * e_n * e_n / k_n
            if k_s > 0.0:
                for force in (s_x, s_y, s_z):
                    tangential += 0.5 * force**2 / k_s
            count += 1
    return normal, tangential, count


@cache
def make_run(variant: KernelVariant) -> Any:
    """Build the stepping function of one variant; compiled when first called, then kept on disk.

    What a variant lacks is passed as None: the compiler then removes it before type inference.
    """
    flat: Present = 1 if variant.plane_case else None
    water: Present = 1 if variant.water else None
    column: Present = 1 if variant.column else None
    exact: Present = 1 if variant.exact else None
    hertz: Present = 1 if variant.hertz else None
    short: Present = 1 if has_short_rows(variant) else None
    optional: Present = 1 if variant.rolling or variant.events or variant.film else None
    walled: Present = 1 if variant.walls else None
    adhesive: Present = 1 if variant.adhesive else None

    @kernel(nogil=True, fastmath=FAST)
    def run(
        thread: int,
        n_threads: int,
        n_steps: int,
        step: int,
        travel: float,
        count: Any,
        c: Any,
        material: Any,
        table: Any,
        block_start: Any,
        n: int,
        n_solid: int,
        grains: GrainArrays,
        walls: WallArrays,
        pairs: PairArrays,
        candidates: CandidateArrays,
        spare: CandidateArrays,
        accounts_of_blocks: AccountArrays,
        work: Workspace,
        choice: LawChoice,
        schedule: Any,
        bodies: Any,
    ) -> tuple[int, float, int]:
        """Do up to n_steps steps; all threads return the same (steps done, travel, stop)."""
        # One function: split into four, W1 and W2 at 2,000 grains took 1 % longer (design/lab/0005)
        c, grains, walls, pairs, work = borrow(c), borrow(grains), borrow(walls), borrow(pairs), borrow(work)
        candidates, spare, accounts_of_blocks, block_start = (
            borrow(candidates),
            borrow(spare),
            borrow(accounts_of_blocks),
            borrow(block_start),
        )
        if table is not None:
            material, table = borrow(material), borrow(table)
        ended, terms, stats = accounts_of_blocks.ended, accounts_of_blocks.terms, accounts_of_blocks.stats
        n_block = len(block_start) - 1
        b_0, b_1 = thread * n_block // n_threads, (thread + 1) * n_block // n_threads
        dt, t_zero, skin, step_limit = c[P.DT], c[P.T_ZERO], c[P.SKIN], c[P.DISPLACEMENT_LIMIT]
        own, span = work.schedule, pairs.span
        for k in range(K.N_SCHEDULE):
            own[k] = schedule[k]
        listing_cost = COST_TEST * pairs.start[n] + COST_GRAIN * n
        target = done = 0
        stop = STOP_DONE
        while done < n_steps:
            if 2.0 * travel > skin:
                stop = STOP_LIST
                break
            if walled is not None:
                set_poses(t_zero + step * dt, dt, walls.faces.motion, walls.faces.poses)
            if own[K.APPROACH] > own[K.SKIN] or own[K.SINCE] >= own[K.LASTS]:
                plan_prune(own, listing_cost)
                fastest = 0.0
                for b in range(n_block):
                    fastest = max(fastest, stats[b, S.SPEED_MAX])
                own[K.LASTS] = steps_ahead(own, fastest * dt)
                reach_on = ROUNDED_UP * own[K.SKIN] + (c[P.FILM_REACH] if variant.film else 0.0)
                for b in range(b_0, b_1):
                    stats[b, S.ROOM_WANTED], stats[b, S.N_TOUCHING] = prune(
                        b, block_start[b], block_start[b + 1], n, n_solid, reach_on, own[K.LASTS] * dt,
                        variant.plane_case, walled, c, grains, walls, pairs, candidates, spare, work,
                    )  # fmt: skip
                target = wait(count, n_threads, target)
                own[K.APPROACH] = own[K.SINCE] = own[K.CANDIDATES] = own[K.TOUCHING] = 0.0
                for b in range(n_block):
                    own[K.CANDIDATES] += candidates.count[b]
                    own[K.TOUCHING] += stats[b, S.N_TOUCHING]
                    if stats[b, S.ROOM_WANTED] != 0.0:
                        stop = STOP_ROOM
                if stop != STOP_DONE:
                    own[K.APPROACH] = np.inf
                    break
            last = done == n_steps - 1
            t = t_zero + step * dt
            hdt = 0.0 if step == 0 else 0.5 * dt
            # A block moves as soon as the blocks within `span` have their forces, while its grains are still
            # in the cache. Those that share pairs with blocks of other threads move after the barrier.
            for after in range(2):
                for b in range(b_0, b_1):
                    if not after:
                        block_forces(
                            variant, flat, water, optional, exact, hertz, short, walled, adhesive, choice, b,
                            b_0, block_start[b + 1], n, n_solid, step, t, hdt, last, c, material, table,
                            grains, walls, pairs, candidates, work, accounts_of_blocks, ended[b], terms[b],
                            stats[b],
                        )  # fmt: skip
                    q = b if after else b - span
                    soon = b_0 + span <= q < b_1 - span
                    if soon != (after == 1):
                        integrate(
                            variant, water, column, choice, block_start[q], block_start[q + 1], step == 0,
                            last, c, grains, pairs, bodies, work.water, terms[q], stats[q],
                        )  # fmt: skip
                    if after and bodies is None:
                        post(stats[b])
                target = wait(count, n_threads, target)
            if bodies is not None:
                n_body = len(bodies.order)
                for b in range(b_0, b_1):
                    move_bodies(
                        variant, water, column, choice, b * n_body // n_block, (b + 1) * n_body // n_block,
                        step == 0, last, c, grains, pairs, bodies, work.bodies, work.water, terms[b],
                        stats[b],
                    )  # fmt: skip
                    post(stats[b])
                target = wait(count, n_threads, target)
            fastest = velocity_change = 0.0
            full = False
            for b in range(n_block):
                fastest, velocity_change = (
                    max(fastest, stats[b, S.SPEED_MAX]),
                    max(velocity_change, stats[b, S.VELOCITY_CHANGE_MAX]),
                )
                full = full or stats[b, S.N_ENDED_POSTED] > 0.5 * ended.shape[1]
                if stats[b, S.FAULT_POSTED] != FAULT_NONE:
                    stop = STOP_FAULT
            if walled is not None:
                travel += max(fastest, walls.faces.speed) * dt
            else:
                travel += fastest * dt
            own[K.APPROACH] += 2.0 * velocity_change * dt
            own[K.SINCE] += 1.0
            step += 1
            done += 1
            if fastest * dt > step_limit and stop == STOP_DONE:
                stop = STOP_UNSAFE
            if stop != STOP_DONE:
                break
            if full:
                stop = STOP_EVENTS
                break
        wait(count, n_threads, target)
        if thread == 0:
            for k in range(K.N_SCHEDULE):
                schedule[k] = own[k]
        return done, travel, stop

    return run
