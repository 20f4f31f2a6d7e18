"""The law of contact of elastic spheres on a batch of pairs (laws/hertz_step.py, design/0018).

As `pair_batch.compute`, but every pair has a stiffness of its own, and keeps its overlap of the last step in
place of the force without its spring: from it follow spring and stiffness then.
"""
# ruff: noqa: E741  (l is a lane)

import math
from functools import cache
from typing import Any

from ryusa.compiled.lanes import known_lanes
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.contact_rows import SHORT
from ryusa.engine.cpu.lane_kinematics import kinematics_of_lane
from ryusa.engine.cpu.wall_shares import share_of
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.materials import material_of
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.contact_step import contact_force
from ryusa.laws.dispatch import cap_total, slip_drops, slip_total, unloading_rescales
from ryusa.laws.hertz import hertz_energy
from ryusa.laws.hertz_step import (
    dashpot_hertz,
    normal_step_hertz,
    normal_work_hertz,
    shear_spring_hertz,
    spring_hertz,
    tangential_step_hertz,
)


def _make_kinematics(plane: bool) -> Any:
    @inner(fastmath=FAST)
    def kinematics_hertz(m: int, most: float, c: Any, batch: Any) -> None:
        """Geometry and velocities of every contact, and its normal force before the limit."""
        dt, l_x, l_y = c[P.DT], c[P.PERIOD_X], c[P.PERIOD_Y]
        for l in range(known_lanes(m, B.LANES)):
            overlap, closing = kinematics_of_lane(l, plane, most, dt, l_x, l_y, batch)
            e_n, root = spring_hertz(overlap, batch[B.K_N + l])
            fourth = math.sqrt(root)
            eta = dashpot_hertz(fourth, batch[B.RELATIVE_VELOCITY + 4 * l + 3], batch[B.K_S + l], dt)
            batch[B.E_N + l], batch[B.ROOT + l], batch[B.FOURTH + l] = e_n, root, fourth
            batch[B.RAW + l] = e_n + eta * closing

    return kinematics_hertz


def _make_normal(mixed: bool) -> Any:
    @inner(fastmath=FAST)
    def normal_hertz(least: float, rescaled: bool, m: int, hdt: float, c: Any, batch: Any) -> None:
        """Normal force and the second half of its work, and the tangential stiffness.

        `least` is the least normal force that a contact can have [N].
        """
        mindlin = c[P.MINDLIN]
        for l in range(known_lanes(m, B.LANES)):
            f_n, held, touching, dashpot_n, released_n = normal_step_hertz(
                batch[B.OVERLAP + l], batch[B.CLOSING + l], batch[B.RAW + l], batch[B.E_N + l], least, hdt
            )
            batch[B.DASH_N + l] += dashpot_n
            batch[B.RELEASED_N + l] += released_n
            batch[B.F_N + l] = f_n
            batch[B.HELD + l], batch[B.TOUCHING + l] = held, touching
            stiff = batch[B.K_N + l]
            e_old, root_old = spring_hertz(batch[B.OVERLAP_OLD + l], stiff)
            k_s, soft_s, soft_old, scale = shear_spring_hertz(
                rescaled, batch[B.ROOT + l], root_old, (batch[B.MINDLIN + l] if mixed else mindlin) * stiff
            )
            batch[B.E_OLD + l], batch[B.STIFF_S + l], batch[B.SOFT_S + l] = e_old, k_s, soft_s
            batch[B.SOFT_OLD + l], batch[B.SCALE + l] = soft_old, scale

    return normal_hertz


def _make_tangential(plane: bool, mixed: bool) -> Any:
    @inner(fastmath=FAST)
    def tangential_hertz(
        total: bool, drop: bool, cap_total: bool, least: float, m: int, hdt: float, c: Any, batch: Any
    ) -> None:
        """Tangential force, its work, the first half of the normal work; force and torques on both grains."""
        dt, mu, cohesion = c[P.DT], c[P.MU], c[P.COHESION]
        for l in range(known_lanes(m, B.LANES)):
            n_x, n_y, n_z = batch[B.NORMAL + l], 0.0, batch[B.NORMAL + 2 * B.PITCH + l]
            f_n, touching = batch[B.F_N + l], batch[B.TOUCHING + l]
            p_x, p_y, p_z = batch[B.SPRING + 4 * l], batch[B.SPRING + 4 * l + 1], batch[B.SPRING + 4 * l + 2]
            q_x, q_y, q_z = batch[B.DASH + 4 * l], batch[B.DASH + 4 * l + 1], batch[B.DASH + 4 * l + 2]
            s_x, s_y, s_z, twist = batch[B.SLIP + l], 0.0, 0.0, 0.0
            overlap, e_n = batch[B.OVERLAP + l], batch[B.E_N + l]
            dashpot_n, released_n, step = normal_work_hertz(
                overlap, batch[B.CLOSING + l], e_n, batch[B.DASH + 4 * l + 3], batch[B.SPRING + 4 * l + 3],
                batch[B.E_OLD + l], least, hdt,
            )  # fmt: skip
            if not plane:
                n_y, twist = batch[B.NORMAL + B.PITCH + l], batch[B.TWIST + l]
                s_y, s_z = batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l]
            e_x, e_y, e_z, b_x, b_y, b_z, share, dashpot_s, sliding, released_s = tangential_step_hertz(
                plane, total, drop, cap_total, n_x, n_y, n_z, twist, f_n, e_n, batch[B.HELD + l], s_x, s_y,
                s_z, p_x, p_y, p_z, q_x, q_y, q_z, batch[B.STIFF_S + l], batch[B.SOFT_S + l],
                batch[B.SOFT_OLD + l], batch[B.SCALE + l], batch[B.ETA_S + l] * batch[B.FOURTH + l], cohesion,
                batch[B.MU + l] if mixed else mu, dt, hdt,
            )  # fmt: skip
            f_x, f_y, f_z, t_x, t_y, t_z = contact_force(
                plane, n_x, n_y, n_z, f_n, e_x + b_x, e_y + b_y, e_z + b_z
            )
            batch[B.DASH_N + l] += dashpot_n
            batch[B.RELEASED_N + l] += released_n
            batch[B.STEP + l] += step
            batch[B.DASH_S + l] += dashpot_s
            batch[B.SLIDE + l] += sliding
            batch[B.RELEASED_S + l] += released_s
            batch[B.SLIDES + l] = 1.0 if share < 1.0 else 0.0
            batch[B.SPRING + 4 * l], batch[B.SPRING + 4 * l + 1] = e_x, e_y
            batch[B.SPRING + 4 * l + 2], batch[B.SPRING + 4 * l + 3] = e_z, f_n
            batch[B.DASH + 4 * l], batch[B.DASH + 4 * l + 1] = b_x, b_y
            batch[B.DASH + 4 * l + 2], batch[B.DASH + 4 * l + 3] = b_z, max(overlap, 0.0)
            a_i, a_j = batch[B.ARM_I + l], batch[B.ARM_J + l]
            batch[B.FORCE + 4 * l], batch[B.FORCE + 4 * l + 1] = f_x, f_y
            batch[B.FORCE + 4 * l + 2], batch[B.FORCE + 4 * l + 3] = f_z, 0.0
            batch[B.TORQUE_I + 4 * l], batch[B.TORQUE_I + 4 * l + 1] = a_i * t_x, a_i * t_y
            batch[B.TORQUE_I + 4 * l + 2], batch[B.TORQUE_I + 4 * l + 3] = a_i * t_z, touching
            batch[B.TORQUE_J + 4 * l], batch[B.TORQUE_J + 4 * l + 1] = a_j * t_x, a_j * t_y
            batch[B.TORQUE_J + 4 * l + 2], batch[B.TORQUE_J + 4 * l + 3] = a_j * t_z, touching

    return tangential_hertz


@cache
def make_compute_hertz(plane: bool, mixed: bool) -> Any:
    """Build compute_hertz for a plane or for space, and for one material or several."""
    kinematics_hertz, normal_hertz = _make_kinematics(plane), _make_normal(mixed)
    tangential_hertz = _make_tangential(plane, mixed)

    @inner(fastmath=FAST)
    def compute_hertz(choice: LawChoice, m: int, hdt: float, most: float, c: Any, batch: Any) -> None:
        """Forces, torques and work of the first m lanes, as `pair_batch.compute`."""
        least = -math.inf if choice.tension else 0.0  # a contact that may pull has no least force
        total, drop, whole = slip_total(choice.slip), slip_drops(choice.slip), cap_total(choice.cap)
        kinematics_hertz(m, most, c, batch)
        normal_hertz(least, unloading_rescales(choice.unloading), m, hdt, c, batch)
        tangential_hertz(total, drop, whole, least, m, hdt, c, batch)

    return compute_hertz


@inner(fastmath=FAST)
def spring_energy_hertz(
    b: int, n_solid: int, c: Any, ids: Any, material: Any, table: Any, candidates: Any, met: Any
) -> tuple[float, float, int]:
    """Energy in normal and tangential springs of block b [J], and its contacts; `met` may be None."""
    eta, rows, mindlin = candidates.eta, candidates.rows, c[P.MINDLIN]
    short = rows.shape[1] == len(SHORT)
    normal = tangential = 0.0
    count = 0
    for k in range(candidates.first[b], candidates.first[b] + candidates.count[b]):
        if candidates.touching[k]:
            overlap = rows[k, 2] if short else rows[k, M.OVERLAP]  # SHORT.index(M.OVERLAP)
            stiff = eta[k, M.K_HERTZ]
            share = 1.0
            if met is not None:
                share = share_of(k, n_solid, candidates, met)
            normal += share * hertz_energy(overlap, stiff)
            if table is not None:
                i, j = candidates.i[k], candidates.j[k]
                mindlin = table[material_of(i, ids, material), material_of(j, ids, material), P.MINDLIN]
            k_s = mindlin * stiff * math.sqrt(overlap)
            if k_s > 0.0:
                square = rows[k, 0] ** 2
                if not short:
                    square += rows[k, M.SPRING_S + 1] ** 2 + rows[k, M.SPRING_S + 2] ** 2
                tangential += share * 0.5 * square / k_s
            count += 1
    return normal, tangential, count
