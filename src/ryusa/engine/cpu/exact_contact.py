"""The law of contact on a batch of pairs, with contacts that begin and end within steps (design/0014).

As `pair_batch.compute`, but every pair has the stiffness of its map, and contacts that begin, or may end, are
done between the two loops (contact_events.py). Energy that is not in a spring is dissipated: there is none
that a contact gains from beginning or ending between two steps.
"""
# ruff: noqa: E741  (l is a lane)

import math
from functools import cache
from typing import Any

from ryusa.compiled.lanes import known_lanes
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.contact_events import make_begin_and_end
from ryusa.engine.cpu.contact_rows import springs_of_row
from ryusa.engine.cpu.wall_shares import share_of
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_instants import (
    APART,
    BEGAN,
    CORRECTS,
    ENDED,
    ENDING,
    FREE,
    HELD,
    ON_MAP,
    PARTED,
    kind_of_step,
    may_end,
)
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.contact import normal_force
from ryusa.laws.contact_step import contact_force, contact_kinematics, tangential_step
from ryusa.laws.dispatch import cap_total, slip_drops, slip_total
from ryusa.laws.geometry import turn, wrap


def _make_kinematics(plane: bool) -> Any:
    @inner(fastmath=FAST)
    def kinematics_of_maps(m: int, most: float, tension: bool, c: Any, batch: Any) -> None:
        """Geometry and velocities of every contact, its normal force, and what the step does with it."""
        dt, l_x, l_y = c[P.DT], c[P.PERIOD_X], c[P.PERIOD_Y]
        for l in range(known_lanes(m, B.LANES)):
            d_x, d_y, d_z = wrap(batch[B.SEPARATION + 4 * l], l_x), 0.0, batch[B.SEPARATION + 4 * l + 2]
            u_x, u_y, u_z = batch[B.RELATIVE_VELOCITY + 4 * l], 0.0, batch[B.RELATIVE_VELOCITY + 4 * l + 2]
            i_x, i_y, i_z = batch[B.SPIN_I + 4 * l], batch[B.SPIN_I + 4 * l + 1], batch[B.SPIN_I + 4 * l + 2]
            j_x, j_y, j_z = batch[B.SPIN_J + 4 * l], batch[B.SPIN_J + 4 * l + 1], batch[B.SPIN_J + 4 * l + 2]
            if plane:  # spin has one component; the zeros beside it are read to read all four of a group
                i_y, j_y = i_x + i_y + i_z, j_x + j_y + j_z
            else:
                d_y, u_y = wrap(batch[B.SEPARATION + 4 * l + 1], l_y), batch[B.RELATIVE_VELOCITY + 4 * l + 1]
            r_i, r_j = batch[B.SPIN_I + 4 * l + 3], batch[B.SPIN_J + 4 * l + 3]
            n_x, n_y, n_z, overlap, a_i, a_j, closing, s_x, s_y, s_z, twist = contact_kinematics(
                plane, d_x, d_y, d_z, batch[B.SEPARATION + 4 * l + 3], r_i, u_x, u_y, u_z,
                i_x, i_y, i_z, j_x, j_y, j_z, dt,
            )  # fmt: skip
            if not plane:
                batch[B.TWIST + l] = twist
                batch[B.NORMAL + B.PITCH + l] = n_y
                batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l] = s_y, s_z
            batch[B.NORMAL + l], batch[B.NORMAL + 2 * B.PITCH + l] = n_x, n_z
            batch[B.SLIP + l] = s_x
            batch[B.OVERLAP + l], batch[B.CLOSING + l] = overlap, closing
            batch[B.ARM_I + l], batch[B.ARM_J + l] = a_i, a_j
            batch[B.EXCESS + l] = overlap - 2.0 * most * min(r_i, r_j)
            k_n, state = batch[B.K_N + l], batch[B.WAS_TOUCHING + l]
            f_n = normal_force(overlap, closing, k_n, batch[B.RELATIVE_VELOCITY + 4 * l + 3])
            fades = may_end(closing, f_n, k_n, c)
            kind = kind_of_step(state, overlap, closing, f_n, fades, tension, dt)
            touching, held = overlap > 0.0, kind == ON_MAP
            batch[B.F_N + l] = batch[B.RAW + l] = f_n if held else 0.0
            batch[B.E_N + l] = k_n * overlap if held else 0.0
            apart = PARTED if kind == CORRECTS else APART
            now = ENDED if touching else apart
            batch[B.STATE + l] = HELD if held else now
            until = -math.inf if state >= ENDED or kind == CORRECTS else 0.0
            batch[B.UNTIL + l] = math.inf if held else until
            batch[B.KIND + l] = kind
            batch[B.TOUCHING + l] = 1.0 if touching else 0.0
            batch[B.GIVEN + l] = batch[B.GIVEN_SLID + l] = batch[B.REST + l] = 0.0

    return kinematics_of_maps


def _make_tangential(plane: bool, mixed: bool) -> Any:
    @inner(fastmath=FAST)
    def tangential_of_maps(
        total: bool, drop: bool, cap_total: bool, m: int, hdt: float, c: Any, batch: Any
    ) -> None:
        """Tangential force, the work of all; force and torques on both grains."""
        dt, mu, cohesion = c[P.DT], c[P.MU], c[P.COHESION]
        for l in range(known_lanes(m, B.LANES)):
            n_x, n_y, n_z = batch[B.NORMAL + l], 0.0, batch[B.NORMAL + 2 * B.PITCH + l]
            f_n, e_n = batch[B.F_N + l], batch[B.E_N + l]
            touching = batch[B.TOUCHING + l]
            kind, was = batch[B.KIND + l], batch[B.WAS_TOUCHING + l]
            p_x, p_y, p_z = batch[B.SPRING + 4 * l], batch[B.SPRING + 4 * l + 1], batch[B.SPRING + 4 * l + 2]
            p_x = 0.0 if was == ENDING else p_x  # where the correction was
            f_old = batch[B.SPRING + 4 * l + 3]
            q_x, q_y, q_z = batch[B.DASH + 4 * l], batch[B.DASH + 4 * l + 1], batch[B.DASH + 4 * l + 2]
            e_old = f_old - batch[B.DASH + 4 * l + 3]
            s_x, s_y, s_z, twist = batch[B.SLIP + l], 0.0, 0.0, 0.0
            if not plane:
                n_y, twist = batch[B.NORMAL + B.PITCH + l], batch[B.TWIST + l]
                s_y, s_z = batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l]
            k_n, k_s = batch[B.K_N + l], batch[B.K_S + l]
            soft_s = 1.0 / k_s if k_s > 0.0 else 0.0
            without = kind == FREE or kind == CORRECTS  # noqa: PLR1714 (lanes)
            held = 0.0 if without else 1.0
            e_x, e_y, e_z, b_x, b_y, b_z, share, dashpot_s, sliding, _ = tangential_step(
                plane, total, drop, cap_total, n_x, n_y, n_z, twist, batch[B.RAW + l], e_n, held, s_x, s_y,
                s_z, p_x, p_y, p_z, q_x, q_y, q_z, k_s, soft_s, batch[B.ETA_S + l], cohesion,
                batch[B.MU + l] if mixed else mu, dt, hdt,
            )  # fmt: skip
            shaped, slid = batch[B.GIVEN + l] > 0.0, batch[B.GIVEN_SLID + l] > 0.0
            given = without or shaped
            g_x, h_x = batch[B.GIVEN_SPRING + l], batch[B.GIVEN_REST + l]
            e_x, b_x = g_x if shaped else e_x, h_x if shaped else b_x
            t_x, t_y, t_z = p_x, p_y, p_z
            if not plane:
                t_x, t_y, t_z = turn(p_x, p_y, p_z, n_x, n_y, n_z, twist)
                g_y, h_y = batch[B.GIVEN_SPRING + B.PITCH + l], batch[B.GIVEN_REST + B.PITCH + l]
                g_z, h_z = batch[B.GIVEN_SPRING + 2 * B.PITCH + l], batch[B.GIVEN_REST + 2 * B.PITCH + l]
                e_y, b_y = g_y if shaped else e_y, h_y if shaped else b_y
                e_z, b_z = g_z if shaped else e_z, h_z if shaped else b_z
            work, stored = s_x * (t_x + q_x + e_x + b_x), e_x * e_x - t_x * t_x
            if not plane:
                work += s_y * (t_y + q_y + e_y + b_y) + s_z * (t_z + q_z + e_z + b_z)
                stored += e_y * e_y - t_y * t_y + (e_z * e_z - t_z * t_z)
            # springs held in the first step belong to the start: no interval lies before it
            lost = -hdt * work - (0.5 * soft_s * stored if hdt > 0.0 else 0.0)
            dashpot_s = (0.0 if slid else lost) if given else dashpot_s
            sliding = (lost if slid else 0.0) if given else sliding
            share = (0.5 if slid else 1.0) if given else share
            f_x, f_y, f_z, t_x, t_y, t_z = contact_force(
                plane, n_x, n_y, n_z, f_n, e_x + b_x, e_y + b_y, e_z + b_z
            )
            # between two steps on the map the spring takes and gives what it holds; where a contact begins or
            # ends, what its force does beyond that is dissipated
            closing, now = batch[B.CLOSING + l], batch[B.STATE + l]
            on_map = was == HELD and (now == HELD or now == ENDING)  # noqa: PLR1714, SIM109 (lanes)
            beyond = hdt * closing * (e_old + e_n) - 0.5 * (e_n * e_n - e_old * e_old) / k_n
            batch[B.DASH_N + l] += hdt * closing * (f_old - e_old + f_n - e_n) + (
                0.0 if on_map or hdt == 0.0 else beyond
            )
            batch[B.DASH_S + l] += dashpot_s
            batch[B.SLIDE + l] += sliding
            batch[B.SLIDES + l] = 1.0 if share < 1.0 else 0.0
            batch[B.SPRING + 4 * l] = batch[B.REST + l] if now == ENDING else e_x
            batch[B.SPRING + 4 * l + 1] = e_y
            batch[B.SPRING + 4 * l + 2], batch[B.SPRING + 4 * l + 3] = e_z, f_n
            batch[B.DASH + 4 * l], batch[B.DASH + 4 * l + 1] = b_x, b_y
            batch[B.DASH + 4 * l + 2], batch[B.DASH + 4 * l + 3] = b_z, f_n - e_n
            a_i, a_j = batch[B.ARM_I + l], batch[B.ARM_J + l]
            batch[B.FORCE + 4 * l], batch[B.FORCE + 4 * l + 1] = f_x, f_y
            batch[B.FORCE + 4 * l + 2], batch[B.FORCE + 4 * l + 3] = f_z, 0.0
            batch[B.TORQUE_I + 4 * l], batch[B.TORQUE_I + 4 * l + 1] = a_i * t_x, a_i * t_y
            batch[B.TORQUE_I + 4 * l + 2], batch[B.TORQUE_I + 4 * l + 3] = a_i * t_z, touching
            batch[B.TORQUE_J + 4 * l], batch[B.TORQUE_J + 4 * l + 1] = a_j * t_x, a_j * t_y
            batch[B.TORQUE_J + 4 * l + 2], batch[B.TORQUE_J + 4 * l + 3] = a_j * t_z, touching

    return tangential_of_maps


@cache
def make_compute_exactly(plane: bool, mixed: bool) -> Any:
    """Build compute_exactly for a plane or for space, and for one material or several."""
    kinematics_of_maps, tangential_of_maps = _make_kinematics(plane), _make_tangential(plane, mixed)
    begin_and_end = make_begin_and_end(plane, mixed)

    @inner(fastmath=FAST)
    def compute_exactly(
        rotation: int, choice: LawChoice, m: int, lanes: int, hdt: float, most: float, selected: Any,
        i_of: Any, j_of: Any, mass: Any, inertia: Any, w: Any, ids: Any, material: Any, table: Any, c: Any,
        batch: Any,
    ) -> None:  # fmt: skip
        """Forces, torques and work of m lanes, as `pair_batch.compute`; `lanes` in whole vectors."""
        total, drop, whole = slip_total(choice.slip), slip_drops(choice.slip), cap_total(choice.cap)
        kinematics_of_maps(lanes, most, choice.tension != 0, c, batch)
        begin_and_end(
            rotation, choice, m, selected, i_of, j_of, mass, inertia, w, ids, material, table, c, batch
        )
        tangential_of_maps(total, drop, whole, lanes, hdt, c, batch)

    return compute_exactly


@inner(fastmath=FAST)
def keep_states(m: int, selected: Any, touching: Any, batch: Any) -> None:
    """Keep the states of the first m lanes."""
    for l in range(m):
        touching[selected[l]] = int(batch[B.STATE + l])


@inner(fastmath=FAST)
def spring_energy_of_maps(b: int, n_solid: int, candidates: Any, met: Any) -> tuple[float, float, int]:
    """Energy in normal and tangential springs of block b [J], and its contacts; `met` may be None."""
    eta, rows = candidates.eta, candidates.rows
    normal = tangential = 0.0
    count = 0
    for k in range(candidates.first[b], candidates.first[b] + candidates.count[b]):
        state = candidates.touching[k]
        if state == 0:
            continue
        e_n, s_x, s_y, s_z = springs_of_row(k, rows)
        half = 0.5
        if met is not None:
            half *= share_of(k, n_solid, candidates, met)
        normal += half * e_n * e_n / eta[k, M.K_N]
        if eta[k, M.K_S] > 0.0 and state in (HELD, BEGAN):
            for force in (s_x, s_y, s_z):
                tangential += half * force**2 / eta[k, M.K_S]
        count += int(state in (HELD, BEGAN))
    return normal, tangential, count
