"""The kicks of a batch of pairs whose contacts begin and end within steps (design/0014).

As `pair_batch.compute`, but every pair has the stiffness of its kick, half of its normal dashpot acts before
the kick and half after (contact_shear.py), and a pair that touched since the last kick has its spring by now.
Of the account, the springs and the tangential direction are booked here; the rest is in contact_shear.py.
"""
# ruff: noqa: E741  (l is a lane)

import math
from functools import cache
from typing import Any

from ryusa.compiled.lanes import known_lanes
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.contact_rows import springs_of_row
from ryusa.engine.cpu.wall_shares import share_of
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_instants import (
    APART,
    BACK,
    BEGAN,
    FREED,
    GONE,
    HELD,
    SLID,
    SLIDES,
    bounding,
    dashes,
    is_held,
    pushes,
)
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.contact import shear_strength
from ryusa.laws.contact_step import contact_force, contact_kinematics, tangential_step
from ryusa.laws.dispatch import cap_total, slip_drops, slip_total
from ryusa.laws.geometry import wrap


def _make_kinematics(plane: bool) -> Any:
    @inner(fastmath=FAST)
    def kinematics_of_kicks(m: int, most: float, c: Any, batch: Any) -> None:
        """Geometry and velocities of every contact, and its normal force."""
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
            state, touching = batch[B.WAS_TOUCHING + l], overlap > 0.0
            held = pushes(state, overlap)
            dash = batch[B.RELATIVE_VELOCITY + 4 * l + 3] * closing if dashes(state) else 0.0
            e_n = batch[B.K_N + l] * overlap if held else 0.0
            batch[B.KICK + l], batch[B.E_N + l] = e_n + dash, e_n
            batch[B.F_N + l] = e_n + 2.0 * dash if held else 0.0  # the other half acts after the kick
            batch[B.RAW + l] = batch[B.F_N + l]
            apart = FREED if touching else APART
            # released and still in touch, be it by others or by round-off: nothing damps it any more
            loose = (state == GONE) & (batch[B.RELATIVE_VELOCITY + 4 * l + 3] > 0.0)
            batch[B.STATE + l] = HELD if held and not loose else apart
            batch[B.TOUCHING + l] = 1.0 if touching else 0.0

    return kinematics_of_kicks


def _make_tangential(plane: bool, mixed: bool) -> Any:
    @inner(fastmath=FAST)
    def tangential_of_kicks(
        total: bool, drop: bool, cap_total: bool, m: int, hdt: float, c: Any, batch: Any
    ) -> None:
        """Tangential force, the energy of the springs; force and torques on both grains."""
        dt, mu, cohesion = c[P.DT], c[P.MU], c[P.COHESION]
        for l in range(known_lanes(m, B.LANES)):
            n_x, n_y, n_z = batch[B.NORMAL + l], 0.0, batch[B.NORMAL + 2 * B.PITCH + l]
            f_n, e_n, kick = batch[B.F_N + l], batch[B.E_N + l], batch[B.KICK + l]
            was, held = batch[B.WAS_TOUCHING + l], is_held(batch[B.STATE + l])
            began, bound = (was == BEGAN) | (was == BACK), bounding(f_n, e_n)
            p_x, p_y, p_z = batch[B.SPRING + 4 * l], batch[B.SPRING + 4 * l + 1], batch[B.SPRING + 4 * l + 2]
            e_old = batch[B.SPRING + 4 * l + 3] - batch[B.DASH + 4 * l + 3]
            q_x, q_y, q_z = batch[B.DASH + 4 * l], batch[B.DASH + 4 * l + 1], batch[B.DASH + 4 * l + 2]
            s_x, s_y, s_z, twist = batch[B.SLIP + l], 0.0, 0.0, 0.0
            if not plane:
                n_y, twist = batch[B.NORMAL + B.PITCH + l], batch[B.TWIST + l]
                s_y, s_z = batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l]
            k_n, k_s = batch[B.K_N + l], batch[B.K_S + l]
            soft_s = 1.0 / k_s if k_s > 0.0 else 0.0
            # of a contact that began the spring is that of this step, and the step before has no share in it
            way, share_of_work = 0.0 if began else dt, 0.0 if began else hdt
            e_x, e_y, e_z, b_x, b_y, b_z, share, dashpot_s, sliding, _ = tangential_step(
                plane, total, drop, cap_total, n_x, n_y, n_z, twist, bound, e_n, 1.0 if held else 0.0, s_x,
                s_y, s_z, p_x, p_y, p_z, q_x, q_y, q_z, k_s, soft_s, 2.0 * batch[B.ETA_S + l], cohesion,
                batch[B.MU + l] if mixed else mu, way, share_of_work,
            )  # fmt: skip
            slides = share < 1.0
            # half of the dashpot acts after the kick; of a force at its strength, what the strength is then
            size = e_x + b_x
            if not plane:
                size = math.sqrt((e_x + b_x) ** 2 + (e_y + b_y) ** 2 + (e_z + b_z) ** 2)
            strength = shear_strength(bound if cap_total else e_n, cohesion, batch[B.MU + l] if mixed else mu)
            whole = total and (math.fabs(size) >= SLIDES * strength)
            slides = whole or share < 1.0
            of_e = max(kick, 0.0) / bound if whole and cap_total and bound > 0.0 else 1.0
            later = 0.0 if whole else 0.5
            f_x, f_y, f_z, t_x, t_y, t_z = contact_force(
                plane, n_x, n_y, n_z, kick, of_e * (e_x + b_x) - later * b_x,
                of_e * (e_y + b_y) - later * b_y, of_e * (e_z + b_z) - later * b_z,
            )  # fmt: skip
            batch[B.STATE + l] = SLID if held and slides else batch[B.STATE + l]
            stored, taken = e_x * e_x, p_x * p_x
            if not plane:
                stored, taken = stored + (e_y * e_y + e_z * e_z), taken + (p_y * p_y + p_z * p_z)
            in_springs = batch[B.STORED + l] / (k_n * k_n) * (e_n * e_n - e_old * e_old)
            in_springs += soft_s * (stored - (0.0 if began else taken))
            # springs held in the first step belong to the start
            batch[B.STEP + l] += 0.5 * in_springs if hdt > 0.0 else 0.0
            batch[B.DASH_S + l] += dashpot_s
            batch[B.SLIDE + l] += sliding
            batch[B.SLIDES + l] = 1.0 if slides else 0.0
            batch[B.SPRING + 4 * l], batch[B.SPRING + 4 * l + 1] = e_x, e_y
            batch[B.SPRING + 4 * l + 2], batch[B.SPRING + 4 * l + 3] = e_z, f_n
            batch[B.DASH + 4 * l], batch[B.DASH + 4 * l + 1] = b_x, b_y
            batch[B.DASH + 4 * l + 2], batch[B.DASH + 4 * l + 3] = b_z, f_n - e_n
            a_i, a_j, touching = batch[B.ARM_I + l], batch[B.ARM_J + l], batch[B.TOUCHING + l]
            batch[B.FORCE + 4 * l], batch[B.FORCE + 4 * l + 1] = f_x, f_y
            batch[B.FORCE + 4 * l + 2], batch[B.FORCE + 4 * l + 3] = f_z, 0.0
            batch[B.TORQUE_I + 4 * l], batch[B.TORQUE_I + 4 * l + 1] = a_i * t_x, a_i * t_y
            batch[B.TORQUE_I + 4 * l + 2], batch[B.TORQUE_I + 4 * l + 3] = a_i * t_z, touching
            batch[B.TORQUE_J + 4 * l], batch[B.TORQUE_J + 4 * l + 1] = a_j * t_x, a_j * t_y
            batch[B.TORQUE_J + 4 * l + 2], batch[B.TORQUE_J + 4 * l + 3] = a_j * t_z, touching

    return tangential_of_kicks


@cache
def make_compute_kicks(plane: bool, mixed: bool) -> Any:
    """Build compute_kicks for a plane or for space, and for one material or several."""
    kinematics_of_kicks, tangential_of_kicks = _make_kinematics(plane), _make_tangential(plane, mixed)

    @inner(fastmath=FAST)
    def compute_kicks(choice: LawChoice, m: int, hdt: float, most: float, c: Any, batch: Any) -> None:
        """Forces, torques and springs of m lanes, as `pair_batch.compute`."""
        total, drop, whole = slip_total(choice.slip), slip_drops(choice.slip), cap_total(choice.cap)
        kinematics_of_kicks(m, most, c, batch)
        tangential_of_kicks(total, drop, whole, m, hdt, c, batch)

    return compute_kicks


@inner(fastmath=FAST)
def keep_states(m: int, selected: Any, touching: Any, batch: Any) -> None:
    """Keep the states of the first m lanes."""
    for l in range(m):
        touching[selected[l]] = int(batch[B.STATE + l])


@inner(fastmath=FAST)
def spring_energy_of_kicks(b: int, n_solid: int, candidates: Any, met: Any) -> tuple[float, float, int]:
    """Energy in normal and tangential springs of block b [J], and its contacts; `met` may be None."""
    eta, rows = candidates.eta, candidates.rows
    normal = tangential = 0.0
    count = 0
    for k in range(candidates.first[b], candidates.first[b] + candidates.count[b]):
        if not is_held(candidates.touching[k]):
            continue
        e_n, s_x, s_y, s_z = springs_of_row(k, rows)
        e = k if len(eta) > 1 else 0
        half = 0.5
        if met is not None:
            half *= share_of(k, n_solid, candidates, met)
        normal += half * e_n * e_n * eta[e, M.STORED] / eta[e, M.K_N] ** 2
        if eta[e, M.K_S] > 0.0:
            for force in (s_x, s_y, s_z):
                tangential += half * force**2 / eta[e, M.K_S]
        count += 1
    return normal, tangential, count
