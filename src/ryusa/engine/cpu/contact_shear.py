"""What the pairs of one block do between two kicks: shear, touch and release (design/0014).

After the kicks every pair in touch moves its grains along their normal by what its exact flow goes beyond the
flight of the grains, and half of its normal dashpot acts; pairs that touch or part within the step are
corrected. The impulses go where the forces of the kicks went, as forces over the step, and the shifts, times
the masses, to a row beside them.
"""
# ruff: noqa: E741  (l is a lane)

import math
from functools import cache
from typing import Any

from ryusa.compiled.function import compiled
from ryusa.compiled.lanes import known_lanes
from ryusa.compiled.piece import taken
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.contact_events import find_events, make_events, make_pack, make_put_back
from ryusa.engine.cpu.contact_rows import dashpot_row
from ryusa.engine.cpu.lane_kinematics import kinematics_of_lane
from ryusa.engine.cpu.pair_batch import make_filter_pairs, make_gather
from ryusa.engine.cpu.pair_physics import make_records_between
from ryusa.engine.cpu.simd.vec4 import add4, fill4, subtract4
from ryusa.engine.cpu.wall_contacts import resolve_walls
from ryusa.engine.cpu.wall_motion import add_drift, book_walls
from ryusa.engine.cpu.wall_shares import account_of_shares, leave_to_shares, take_shares
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_instants import (
    NOTHING,
    after_kick,
    bending,
    bounding,
    half_dashpot,
    is_held,
    kind_between,
    spent_in_touch,
)
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.variant import ForcesKind
from ryusa.laws.contact_step import contact_force
from ryusa.laws.dispatch import cap_total, slip_drops, slip_total
from ryusa.laws.geometry import wrap

_ROUND_OFF = 1e-12  # of a square of distances, by which pairs that just miss each other are kept


@inner(fastmath=FAST)
def _leave_out_apart(
    begin: int, end: int, n_solid: int, c: Any, x: Any, v: Any, i_of: Any, j_of: Any, touching: Any,
    selected: Any,
) -> int:  # fmt: skip
    """Take selected pairs of grains that stay apart until the next step out again; returns how many are left.

    In a dense flow more pairs are near to each other than touch, and most of them do not approach.
    """
    dt, l_x, l_y, kept = c[P.DT], c[P.PERIOD_X], c[P.PERIOD_Y], begin
    for l in range(begin, end):  # no branch: which pairs approach is not predictable
        k = selected[l]
        i, j = i_of[k], j_of[k]
        other = j if j < n_solid else i  # a wall stays in
        d_x, d_y = wrap(x[i, 0] - x[other, 0], l_x), wrap(x[i, 1] - x[other, 1], l_y)
        d_z = x[i, 2] - x[other, 2]
        square = d_x * d_x + d_y * d_y + d_z * d_z
        nearer = d_x * (v[i, 0] - v[other, 0]) + d_y * (v[i, 1] - v[other, 1]) + d_z * (v[i, 2] - v[other, 2])
        gap = square - (x[i, 3] + x[other, 3]) * math.sqrt(square)  # times the distance, as `nearer`
        selected[kept] = k
        kept += int(touching[k] != 0) | int(gap + nearer * dt <= _ROUND_OFF * square)
    return kept


@inner(fastmath=FAST)
def _gather_shears(m: int, lanes: int, selected: Any, j_of: Any, n_solid: int, eta: Any, batch: Any) -> None:
    """Copy the shears of the first m pairs to their lanes; the lanes after them get harmless ones."""
    for l in range(m):
        k = selected[l]
        e = dashpot_row(k, eta)
        batch[B.TURNS + l] = 1.0 if j_of[k] < n_solid else 0.0
        batch[B.WAY + l], batch[B.AFTER + l] = eta[e, M.WAY], eta[e, M.AFTER]
    for l in range(m, lanes):
        batch[B.TURNS + l] = batch[B.WAY + l] = batch[B.AFTER + l] = 0.0


def _make_shears(plane: bool, mixed: bool) -> Any:
    @inner(fastmath=FAST)
    def shears(m: int, tension: bool, rules: Any, c: Any, batch: Any) -> None:
        """Geometry and velocities of every pair, its shear and half its dashpot, and what happens to it."""
        dt, l_x, l_y, k_n = c[P.DT], c[P.PERIOD_X], c[P.PERIOD_Y], c[P.K_N]
        for l in range(known_lanes(m, B.LANES)):
            overlap, closing = kinematics_of_lane(l, plane, 0.0, dt, l_x, l_y, batch)
            state, eta_d = batch[B.WAS_TOUCHING + l], batch[B.RELATIVE_VELOCITY + 4 * l + 3]
            k_law = batch[B.K_LAW + l] if mixed else k_n
            way, after = batch[B.WAY + l], batch[B.AFTER + l]
            m_n = batch[B.MASS + l]
            left, before = 1.0 - eta_d * dt / m_n, batch[B.K_N + l] * dt / m_n - after
            u_x, u_y, u_z = batch[B.RELATIVE_VELOCITY + 4 * l], 0.0, batch[B.RELATIVE_VELOCITY + 4 * l + 2]
            if not plane:
                u_y = batch[B.RELATIVE_VELOCITY + 4 * l + 1]
            distance = batch[B.TURNS + l] * (batch[B.SEPARATION + 4 * l + 3] - overlap)
            bend = bending(u_x * u_x + u_y * u_y + u_z * u_z, closing, distance)
            kind = kind_between(
                state, overlap, closing, bend, k_law, 2.0 * eta_d / left, way, left, before, tension, dt
            )
            batch[B.BEND + l] = bend
            goes_on = is_held(state) and kind == NOTHING
            f_n = batch[B.SPRING + 4 * l + 3]
            f_n = bounding(f_n, f_n - batch[B.DASH + 4 * l + 3])
            dash, rub = after_kick(state, closing, f_n, eta_d, batch[B.ETA_S + l], rules, dt)
            dash, rub = dash if goes_on else 0.0, rub if goes_on else 0.0
            f_x, f_y = (
                batch[B.SPRING + 4 * l] + batch[B.DASH + 4 * l],
                batch[B.SPRING + 4 * l + 1] + batch[B.DASH + 4 * l + 1],
            )
            f_z = batch[B.SPRING + 4 * l + 2] + batch[B.DASH + 4 * l + 2]
            s_x = batch[B.SLIP + l]
            batch[B.PUSH + l], slip_2 = dash * s_x + rub * f_x, s_x * s_x
            if not plane:
                s_y, s_z = batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l]
                slip_2 += s_y * s_y + s_z * s_z
                batch[B.PUSH + B.PITCH + l] = dash * s_y + rub * f_y
                batch[B.PUSH + 2 * B.PITCH + l] = dash * s_z + rub * f_z
            spent = spent_in_touch(overlap, closing, way, after, before, left, m_n, k_law) if goes_on else 0.0
            batch[B.KIND + l], batch[B.WHEN + l], batch[B.SLIDES + l] = kind, math.inf, 0.0
            batch[B.CHANGE + l] = (left - 1.0) * closing if goes_on else 0.0
            batch[B.SHIFT + l] = (way - dt * left) * closing if goes_on else 0.0
            spent_s = half_dashpot(-dash / dt, batch[B.MASS_S + l], dt) * slip_2 if goes_on else 0.0
            batch[B.DASH_N + l] += spent
            batch[B.DASH_S + l] += spent_s
            batch[B.STEP + l] += spent + spent_s

    return shears


def _make_impulses(plane: bool) -> Any:
    @inner(fastmath=FAST)
    def impulses(m: int, c: Any, batch: Any) -> None:
        """Impulses over the step as forces and torques, and shifts times masses, of the first m lanes."""
        per_dt, l_x, l_y = 1.0 / c[P.DT], c[P.PERIOD_X], c[P.PERIOD_Y]
        for l in range(known_lanes(m, B.LANES)):
            n_x, n_y, n_z = batch[B.NORMAL + l], 0.0, batch[B.NORMAL + 2 * B.PITCH + l]
            u_x, u_y, u_z = batch[B.RELATIVE_VELOCITY + 4 * l], 0.0, batch[B.RELATIVE_VELOCITY + 4 * l + 2]
            p_x, p_y, p_z = batch[B.PUSH + l], 0.0, 0.0
            d_x, d_y, d_z = wrap(batch[B.SEPARATION + 4 * l], l_x), 0.0, batch[B.SEPARATION + 4 * l + 2]
            closing, shift = batch[B.CLOSING + l], batch[B.SHIFT + l]
            if not plane:
                n_y, u_y = batch[B.NORMAL + B.PITCH + l], batch[B.RELATIVE_VELOCITY + 4 * l + 1]
                d_y = wrap(batch[B.SEPARATION + 4 * l + 1], l_y)
                p_y, p_z = batch[B.PUSH + B.PITCH + l], batch[B.PUSH + 2 * B.PITCH + l]
            m_n = batch[B.MASS + l]
            f_x, f_y, f_z, t_x, t_y, t_z = contact_force(
                plane, n_x, n_y, n_z, -m_n * batch[B.CHANGE + l] * per_dt, p_x * per_dt, p_y * per_dt,
                p_z * per_dt,
            )  # fmt: skip
            # a pair moved together keeps its angular momentum
            apart = d_x * n_x + d_y * n_y + d_z * n_z
            turned = batch[B.TURNS + l] * m_n * per_dt * shift / (apart - shift)
            f_x += turned * (u_x - closing * n_x)
            f_y += turned * (u_y - closing * n_y)
            f_z += turned * (u_z - closing * n_z)
            a_i, a_j = batch[B.ARM_I + l], batch[B.ARM_J + l]
            batch[B.FORCE + 4 * l], batch[B.FORCE + 4 * l + 1] = f_x, f_y
            batch[B.FORCE + 4 * l + 2], batch[B.FORCE + 4 * l + 3] = f_z, 0.0
            batch[B.TORQUE_I + 4 * l], batch[B.TORQUE_I + 4 * l + 1] = a_i * t_x, a_i * t_y
            batch[B.TORQUE_I + 4 * l + 2], batch[B.TORQUE_I + 4 * l + 3] = a_i * t_z, 0.0
            batch[B.TORQUE_J + 4 * l], batch[B.TORQUE_J + 4 * l + 1] = a_j * t_x, a_j * t_y
            batch[B.TORQUE_J + 4 * l + 2], batch[B.TORQUE_J + 4 * l + 3] = a_j * t_z, 0.0
            way = m_n * shift
            batch[B.SIDEWAYS + 4 * l], batch[B.SIDEWAYS + 4 * l + 1] = way * n_x, way * n_y
            batch[B.SIDEWAYS + 4 * l + 2], batch[B.SIDEWAYS + 4 * l + 3] = way * n_z, 0.0

    return impulses


@inner(fastmath=FAST)
def _scatter(
    m: int, selected: Any, i_of: Any, target: Any, batch: Any, f: Any, shifts: Any, stats: Any
) -> None:
    """Add the first m lanes to their grains and to the account, one by one in the order of the list.

    Pairs that only might have touched have no part in it: which of them there are depends on the list.
    """
    for l in range(m):
        if batch[B.KIND + l] == NOTHING and not is_held(batch[B.WAS_TOUCHING + l]):
            continue
        k = selected[l]
        i, j = i_of[k], target[k]
        add4(f, 8 * i, batch, B.FORCE + 4 * l)
        add4(f, 8 * i + 4, batch, B.TORQUE_I + 4 * l)
        subtract4(f, 8 * j, batch, B.FORCE + 4 * l)
        add4(f, 8 * j + 4, batch, B.TORQUE_J + 4 * l)
        add4(shifts, 4 * i, batch, B.SIDEWAYS + 4 * l)
        subtract4(shifts, 4 * j, batch, B.SIDEWAYS + 4 * l)
        stats[S.PENDING_DASH_N] += batch[B.DASH_N + l]
        stats[S.PENDING_DASH_S] += batch[B.DASH_S + l]
        stats[S.PENDING_SLIDE] += batch[B.SLIDE + l]
        stats[S.PENDING_STEP] += batch[B.STEP + l]


@cache
def make_contact_shear(kind: ForcesKind) -> Any:
    """Build the piece between two kicks: contact_shear(b, b_0, t, reach, work, held)."""
    plane, rotation, walled, mixed = bool(kind.plane_case), kind.rotation, bool(kind.walls), bool(kind.mixed)
    short = plane and not kind.rolling and not kind.events
    filter_pairs, gather = make_filter_pairs(walled), make_gather(M.OF_KICKS, short, walled, begins=False)
    shears, impulses, events = _make_shears(plane, mixed), _make_impulses(plane), make_events(plane, mixed)
    events_kept, records_between = bool(kind.events), make_records_between(plane)
    pack, put_back = make_pack(bool(kind.rebound)), make_put_back(short)

    @compiled(fastmath=FAST)
    def contact_shear(b: int, b_0: int, t: float, reach: float, work: Any, held: Any) -> None:
        """Impulses and shifts of every pair that block b owns; pairs up to `reach` apart may touch [m].

        `b_0` as in `block_forces`: the list may be another than at the kicks, and faces are met again.
        """
        # One function: what a kind goes without is taken out of it before it is compiled
        held, work = taken(held), taken(work)
        grains, walls, pairs, candidates = held.grains, held.walls, held.pairs, held.candidates
        c, material, table, choice = held.c, held.material, held.table, held.choice
        n, n_solid, stats = held.n, held.n_solid, held.accounts.stats[b]
        batch, separation, inside, selected = work.batch, work.separation, work.inside, work.selected
        x, v, w, f, ids, shifts = grains.x, grains.v, grains.w, pairs.f, grains.ids, grains.film
        i_of, j_of, to, touching, eta, rows = (
            candidates.i, candidates.j, candidates.target, candidates.touching, candidates.eta,
            candidates.rows,
        )  # fmt: skip
        mass, inertia, points, normals = grains.m, grains.inertia, walls.points, walls.normals
        met = candidates.met
        slot = candidates.slot
        face_lanes = work.face_lanes
        impulse = held.accounts.walls[b]
        rules = slip_total(choice.slip), slip_drops(choice.slip), cap_total(choice.cap)
        given = pending = 0.0
        fill4(f, 8 * (n + b), 0.0)  # those of fixed grains and planes, not used
        fill4(f, 8 * (n + b) + 4, 0.0)
        fill4(shifts, 4 * (n + b), 0.0)
        if walled:
            met = met[candidates.first[b_0] :]
            resolve_walls(b, reach, n_solid, c, grains, walls, candidates, met, stats)
        k = candidates.first[b]
        end = k + candidates.count[b]
        waiting = 0
        while True:
            while waiting < B.LANES and k < end:
                some = min(B.LANES, end - k)
                had = waiting
                waiting = filter_pairs(
                    held.plane_case, reach, k, some, waiting, n_solid, c, x, i_of, j_of, touching, points,
                    normals, met, slot, separation, inside, selected,
                )  # fmt: skip
                waiting = _leave_out_apart(had, waiting, n_solid, c, x, v, i_of, j_of, touching, selected)
                k += some
            m = min(waiting, B.LANES)
            if m == 0:
                break
            lanes = gather(
                rotation, m, selected, n_solid, c, mass, inertia, x, v, w, points, normals, i_of, j_of,
                touching, eta, rows, met, slot, face_lanes, ids, material, table, batch,
            )  # fmt: skip
            for place in range(B.WORK, B.WORK + B.N_WORK * B.PITCH):
                batch[place] = 0.0
            _gather_shears(m, lanes, selected, j_of, n_solid, eta, batch)
            if walled:
                add_drift(face_lanes, selected, slot, walls.faces.motion, met, batch)
                account_of_shares(face_lanes, selected, slot, met, batch)
            shears(lanes, choice.tension != 0, rules, c, batch)
            if walled:
                leave_to_shares(b, face_lanes, selected, candidates, met, batch)
            begin, part = find_events(m, batch)
            for of, first, count in ((True, B.TOUCHES, begin), (False, B.MAY_PART, part)):
                if count > 0:
                    wide = pack(
                        count, first, rotation, choice, selected, i_of, j_of, touching, mass, inertia, x, w,
                        eta, rows, ids, material, table, c, batch,
                    )  # fmt: skip
                    events(of, wide, choice, c, batch)
                    put_back(count, first, selected, touching, rows, batch)
            impulses(lanes, c, batch)
            if walled:
                take_shares(face_lanes, batch)
                given, pending = book_walls(
                    given, pending, face_lanes, selected, 0.5 * c[P.DT], 0.0, c, i_of, x, slot,
                    walls.faces.poses, walls.faces.motion, met, impulse, batch,
                )  # fmt: skip
            if events_kept:
                records_between(choice, m, n, t, selected, c, grains, candidates, batch)
            _scatter(m, selected, i_of, to, batch, f, shifts, stats)
            waiting -= m
            for l in range(waiting):
                selected[l] = selected[B.LANES + l]
        if walled:
            stats[S.PENDING_WALL] += given + pending

    return contact_shear
