"""Forces of the pairs of one block, batch by batch of those that touch."""
# ruff: noqa: E741  (l is a lane)

from functools import cache
from typing import Any

from ryusa.compiled.function import compiled
from ryusa.compiled.piece import taken
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.arrays import CandidateArrays, GrainArrays
from ryusa.engine.cpu.attraction import attract, make_energy_of_attraction
from ryusa.engine.cpu.contact_rows import springs_of_row
from ryusa.engine.cpu.exact_contact import keep_states, make_compute_kicks, spring_energy_of_kicks
from ryusa.engine.cpu.hertz_contact import make_compute_hertz, spring_energy_hertz
from ryusa.engine.cpu.lane_kinematics import overlap_of_lane
from ryusa.engine.cpu.pair_batch import (
    make_compute,
    make_filter_pairs,
    make_gather,
    make_scatter,
)
from ryusa.engine.cpu.pair_physics import make_immersed_dashpots, make_optional_physics
from ryusa.engine.cpu.simd.prefetch import prefetch
from ryusa.engine.cpu.simd.vec4 import fill4
from ryusa.engine.cpu.wall_contacts import resolve_walls
from ryusa.engine.cpu.wall_motion import add_drift, book_walls
from ryusa.engine.cpu.wall_shares import account_of_shares, share_of, take_shares
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.status import FAULT_NONE, FAULT_OVERLAP
from ryusa.engine.shared.variant import ForcesKind
from ryusa.model.tally import Term

# the terms of the account that a lane sums, in the order of batch_layout.py
TERMS = tuple(
    int(account)
    for account in (Term.DASH_N, Term.DASH_S, Term.SLIDE, Term.RELEASED_N, Term.RELEASED_S, Term.STEP)
)
WALL, STEP = int(Term.WALL), int(Term.STEP)


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
def spring_energy(
    b: int, n_solid: int, c: Any, candidates: CandidateArrays, met: Any
) -> tuple[float, float, int]:
    """Energy in normal and tangential springs of block b [J], and its contacts; `met` may be None."""
    k_n, k_s, rows = c[P.K_N], c[P.K_S], candidates.rows
    normal = tangential = 0.0
    count = 0
    for k in range(candidates.first[b], candidates.first[b] + candidates.count[b]):
        if candidates.touching[k]:
            e_n, s_x, s_y, s_z = springs_of_row(k, rows)
            half = 0.5
            if met is not None:
                half *= share_of(k, n_solid, candidates, met)
            if k_n > 0.0:
                normal += half * e_n * e_n / k_n
            if k_s > 0.0:
                for force in (s_x, s_y, s_z):
                    tangential += half * force**2 / k_s
            count += 1
    return normal, tangential, count


@cache
def make_block_forces(kind: ForcesKind) -> Any:
    """Build the piece for the forces of contacts, block_forces."""
    plane, rotation, film, rebound = kind.plane_case, kind.rotation, bool(kind.film), bool(kind.rebound)
    exact, hertz, walled, adhesive = (
        bool(one) for one in (kind.exact, kind.hertz, kind.walls, kind.adhesive)
    )
    short = bool(kind.plane_case) and not kind.rolling and not kind.events
    optional = bool(kind.rolling or kind.events or kind.film)
    filter_pairs, scatter = make_filter_pairs(walled), make_scatter(exact, short)
    compute = (make_compute_hertz if hertz else make_compute_kicks if exact else make_compute)(
        bool(kind.plane_case), bool(kind.mixed)
    )
    energy_of_attraction: Any = make_energy_of_attraction(hertz) if adhesive else None
    gather = make_gather(M.OF_KICKS * kind.exact + M.HERTZ * kind.hertz, short, walled)
    immersed_dashpots: Any = make_immersed_dashpots(hertz) if rebound and not exact else None
    optional_physics: Any = make_optional_physics(kind) if optional else None

    @compiled(fastmath=FAST)
    def block_forces(
        b: int, b_0: int, step: int, t: float, hdt: float, last: bool, reach: float, work: Any, held: Any
    ) -> None:
        """Forces of every pair that block b owns, batch by batch of those that touch.

        `b_0` is the first block of the thread, with whose place in the workspace of faces it begins; faces up
        to `reach` [m] from a grain are met.
        """
        # One function: what a kind goes without is taken out of it before it is compiled
        held, work = taken(held), taken(work)
        grains, walls, pairs, candidates = held.grains, held.walls, held.pairs, held.candidates
        c, material, table, choice = held.c, held.material, held.table, held.choice
        accounts, n, n_solid, hi = held.accounts, held.n, held.n_solid, held.block_start[b + 1]
        ended, account, stats = accounts.ended[b], accounts.terms[b], accounts.stats[b]
        batch, separation, inside, selected = work.batch, work.separation, work.inside, work.selected
        reach_on = c[P.FILM_REACH] if film else 0.0
        # arrays are passed one by one: references to a tuple of them would be counted for every batch
        x, v, w, f, ids = grains.x, grains.v, grains.w, pairs.f, grains.ids
        i_of = candidates.i
        j_of = candidates.j
        to = candidates.target
        touching = candidates.touching
        eta = candidates.eta
        rows = candidates.rows
        mass, inertia, points, normals = grains.m, grains.inertia, walls.points, walls.normals
        met, slot, face_lanes, impulse = candidates.met, candidates.slot, work.face_lanes, accounts.walls[b]
        spring_r = given = pending = 0.0
        fill4(f, 8 * (n + b), 0.0)  # forces on fixed grains and planes, not used
        fill4(f, 8 * (n + b) + 4, 0.0)
        for place in range(B.WORK, B.WORK + B.N_WORK * B.PITCH):
            batch[place] = 0.0
        if walled:
            met = met[candidates.first[b_0] :]  # the same rows for all blocks of a thread stay in its cache
            given = stats[S.PENDING_WALL]
            resolve_walls(b, max(reach_on, reach), n_solid, c, grains, walls, candidates, met, stats)
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
                    plane, reach_on, k, some, waiting, n_solid, c, x, i_of, j_of, touching,
                    points, normals, met, slot, separation, inside, selected,
                )  # fmt: skip
                k += some
            m = min(waiting, B.LANES)
            if m == 0:
                break
            lanes = gather(
                rotation, m, selected, n_solid, c, mass, inertia, x, v, w, points, normals, i_of, j_of,
                touching, eta, rows, met, slot, face_lanes, ids, material, table, batch,
            )  # fmt: skip
            if walled:
                add_drift(face_lanes, selected, slot, walls.faces.motion, met, batch)
                account_of_shares(face_lanes, selected, slot, met, batch)
            if rebound and not exact:
                immersed_dashpots(choice, m, selected, c, material, table, grains, candidates, batch)
            compute(choice, lanes, hdt, stats[S.OVERLAP_MAX], c, batch)
            if adhesive:
                attract(choice, m, hdt, selected, c, material, table, grains, candidates, batch)
            if walled:
                take_shares(face_lanes, batch)
            if optional:
                spring_r += optional_physics(
                    choice, m, n, t, hdt, selected, c, material, table, grains, candidates, batch, ended,
                    account, stats,
                )  # fmt: skip
            if walled:
                given, pending = book_walls(
                    given, pending, face_lanes, selected, hdt, c[P.DT], c, i_of, x, slot, walls.faces.poses,
                    walls.faces.motion, met, impulse, batch,
                )  # fmt: skip
            if exact:
                keep_states(m, selected, touching, batch)
            if scatter(m, selected, i_of, to, touching, rows, batch, f):
                track_overlap(m, selected, n, step, c, grains, candidates, batch, stats)
            waiting -= m
            for l in range(waiting):
                selected[l] = selected[B.LANES + l]
        if walled:
            account[WALL] += given
            stats[S.PENDING_WALL] = pending
        for row in range(B.N_WORK):
            total = 0.0
            for l in range(B.LANES):
                total += batch[B.WORK + row * B.PITCH + l]
            account[TERMS[row]] += total
            if exact and row != B.N_WORK - 1:
                account[STEP] += total
        if exact:
            account[STEP] -= given
        if last:
            if hertz:
                if walled:
                    found = spring_energy_hertz(b, n_solid, c, ids, material, table, candidates, met)
                else:
                    found = spring_energy_hertz(b, n_solid, c, ids, material, table, candidates, None)
            elif not exact:
                if walled:
                    found = spring_energy(b, n_solid, c, candidates, met)
                else:
                    found = spring_energy(b, n_solid, c, candidates, None)
            elif walled:
                found = spring_energy_of_kicks(b, n_solid, candidates, met)
            else:
                found = spring_energy_of_kicks(b, n_solid, candidates, None)
            stats[S.SPRING_N], stats[S.SPRING_S], stats[S.N_CONTACT] = found
            if adhesive:
                stats[S.SPRING_N] -= energy_of_attraction(b, choice, c, material, table, grains, candidates)
            stats[S.SPRING_R] = spring_r

    return block_forces
