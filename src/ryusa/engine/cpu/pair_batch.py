"""The law of contact on a batch of pairs: gathered to lanes, computed by vector instructions, scattered.

Every formula is a law. Choices are made by picking one of two numbers, never by leaving the lane, and arrays
are read at places known at compile time: that lets the compiler turn the loops of `compute` into vector
instructions (batch_layout.py).

The account is kept by velocity interval: at x(n) the velocity v(n-1/2) and the forces of steps n-1 and n
give the work u dt (f(n-1) + f(n))/2, exact for the scheme when kinetic energy is m v(n-1/2) v(n+1/2)/2. A
spring met or left within a step is booked for what the half interval takes beyond what it held (design/0005).
"""
# ruff: noqa: E741  (l is a lane)

import math
from functools import cache
from typing import Any

from ryusa.compiled.lanes import known_lanes
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.contact_rows import dashpot_row, make_begin_row, make_lane_to_row, make_row_to_lane
from ryusa.engine.cpu.cutoff import mark_within_cutoff, set_separation, set_separation_of_any
from ryusa.engine.cpu.lane_kinematics import kinematics_of_lane
from ryusa.engine.cpu.simd.vec4 import add4, copy4, read4, subtract4, with_fourth, write4
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.materials import material_of
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.contact import normal_force
from ryusa.laws.contact_step import (
    contact_force,
    normal_step,
    normal_work_of_last_force,
    tangential_step,
)
from ryusa.laws.dispatch import cap_total, slip_drops, slip_total


@cache
def make_filter_pairs(walled: bool) -> Any:
    """Build filter_pairs for scenes with faces or without."""

    @inner(fastmath=FAST)
    def filter_pairs(
        plane_case: int, reach_on: float, first: int, m: int, waiting: int, n_solid: int, c: Any, x: Any,
        i_of: Any, j_of: Any, touching: Any, points: Any, normals: Any, met: Any, slot: Any, separation: Any,
        inside: Any, selected: Any,
    ) -> int:  # fmt: skip
        """Select those of m <= LANES candidates that touch or did in the last step; returns how many.

        `selected` gets their numbers; `separation` and `inside` are workspace.
        """
        for l in range(m):
            k = first + l
            if not walled:
                set_separation(l, i_of[k], j_of[k], n_solid, x, points, normals, separation)
            else:
                set_separation_of_any(l, k, i_of[k], j_of[k], n_solid, x, met, slot, separation)
        mark_within_cutoff(plane_case, reach_on, m, c, separation, inside)
        for l in range(m):  # no branch: which pairs touch is not predictable
            selected[waiting] = first + l
            waiting += int(inside[l] > 0.0) | int(touching[first + l] != 0)
        return waiting

    return filter_pairs


@cache
def make_gather(springs: int, short: bool, walled: bool, begins: bool = True) -> Any:
    """Build gather for a kind of springs, the length of rows (contact_rows.py), and scenes with faces.

    It empties the rows of pairs that did not touch and gives them their springs, if it `begins` contacts.
    """
    hertz, kicks, row_to_lane = springs == M.HERTZ, springs == M.OF_KICKS, make_row_to_lane(short)
    begin_row = make_begin_row(springs)

    @inner(fastmath=FAST)
    def gather(
        rotation: int, m: int, selected: Any, n_solid: int, c: Any, mass: Any, inertia: Any, x: Any, v: Any,
        w: Any, points: Any, normals: Any, i_of: Any, j_of: Any, touching: Any, eta: Any, rows: Any, met: Any,
        slot: Any, face_lanes: Any, ids: Any, material: Any, table: Any, batch: Any,
    ) -> int:  # fmt: skip
        """Copy the first m selected pairs to as many lanes; returns the number of lanes to compute.

        Those are whole vectors of eight: the lanes beyond m hold pairs far apart. `table` has a row of
        parameters for each two materials, None where there is one material. `face_lanes` gets the lanes of
        faces, and in place LANES their number.
        """
        n_face = 0
        for l in range(m):
            k = selected[l]
            i, j = i_of[k], j_of[k]
            if table is not None:
                a, b = material_of(i, ids, material), material_of(j, ids, material)
                if begins and not touching[k]:
                    begin_row(k, i, j, rotation, table[a, b], mass, x, inertia, eta, rows)
                batch[B.MU + l] = table[a, b, P.MU]
                if hertz:
                    batch[B.MINDLIN + l] = table[a, b, P.MINDLIN]
                else:
                    batch[B.K_LAW + l] = table[a, b, P.K_N]
            elif begins and not touching[k]:
                begin_row(k, i, j, rotation, c, mass, x, inertia, eta, rows)
            if not walled:
                set_separation(B.SEPARATION // 4 + l, i, j, n_solid, x, points, normals, batch)
            else:
                set_separation_of_any(B.SEPARATION // 4 + l, k, i, j, n_solid, x, met, slot, batch)
            e = dashpot_row(k, eta)
            write4(
                batch,
                B.RELATIVE_VELOCITY + 4 * l,
                with_fourth(read4(v, 8 * i) - read4(v, 8 * j), eta[e, M.ETA_N]),
            )
            copy4(batch, B.SPIN_I + 4 * l, w, 8 * i)
            copy4(batch, B.SPIN_J + 4 * l, w, 8 * j)
            if j >= n_solid:
                batch[B.SPIN_J + 4 * l + 3] = w[i, 3]
                if walled:
                    face_lanes[n_face] = l
                    n_face += 1
            row_to_lane(l, k, rows, batch)
            batch[B.ETA_S + l], batch[B.WAS_TOUCHING + l] = eta[e, M.ETA_S], touching[k]
            if springs:
                batch[B.K_N + l], batch[B.K_S + l] = eta[e, M.K_N], eta[e, M.K_S]
            if kicks:
                batch[B.STORED + l], batch[B.MASS + l] = eta[e, M.STORED], eta[e, M.MASS]
                batch[B.MASS_S + l] = eta[e, M.MASS_S]
            if hertz:  # a row of its own, since a loop reads all four of a group or none
                batch[B.OVERLAP_OLD + l] = batch[B.DASH + 4 * l + 3]
        if walled:
            face_lanes[B.LANES] = n_face
        whole = (m + 7) // 8 * 8
        for l in range(m, whole):
            for a in range(4):
                batch[B.SEPARATION + 4 * l + a] = batch[B.RELATIVE_VELOCITY + 4 * l + a] = 0.0
                batch[B.SPIN_I + 4 * l + a] = batch[B.SPIN_J + 4 * l + a] = 0.0
                batch[B.SPRING + 4 * l + a] = batch[B.DASH + 4 * l + a] = 0.0
            batch[B.ETA_S + l] = batch[B.WAS_TOUCHING + l] = 0.0
            batch[B.K_N + l] = batch[B.K_S + l] = 1.0
            if hertz:
                batch[B.OVERLAP_OLD + l] = 0.0
            if kicks:
                batch[B.STORED + l] = batch[B.MASS + l] = batch[B.MASS_S + l] = 1.0
            if table is not None:
                batch[B.MU + l] = batch[B.MINDLIN + l] = 1.0
                if kicks:
                    batch[B.K_LAW + l] = 1.0
            batch[B.SEPARATION + 4 * l] = B.FAR
        return whole

    return gather


def _make_kinematics(plane: bool) -> Any:
    @inner(fastmath=FAST)
    def kinematics(m: int, most: float, c: Any, batch: Any) -> None:
        """Geometry and velocities of every contact, and its normal force before the limit."""
        dt, k_n, l_x, l_y = c[P.DT], c[P.K_N], c[P.PERIOD_X], c[P.PERIOD_Y]
        for l in range(known_lanes(m, B.LANES)):
            overlap, closing = kinematics_of_lane(l, plane, most, dt, l_x, l_y, batch)
            batch[B.RAW + l] = normal_force(overlap, closing, k_n, batch[B.RELATIVE_VELOCITY + 4 * l + 3])

    return kinematics


@inner(fastmath=FAST)
def _normal_force(least: float, m: int, hdt: float, c: Any, batch: Any) -> None:
    """Normal force and the second half of its work; `least` is the least a contact can have [N]."""
    k_n = c[P.K_N]
    for l in range(known_lanes(m, B.LANES)):
        f_n, e_n, held, touching, dashpot_n, released_n, step = normal_step(
            batch[B.OVERLAP + l], batch[B.CLOSING + l], batch[B.RAW + l], batch[B.WAS_TOUCHING + l] > 0.0,
            least, k_n, hdt,
        )  # fmt: skip
        batch[B.DASH_N + l] += dashpot_n
        batch[B.RELEASED_N + l] += released_n
        batch[B.STEP + l] += step
        batch[B.F_N + l], batch[B.E_N + l] = f_n, e_n
        batch[B.HELD + l], batch[B.TOUCHING + l] = held, touching


def _make_tangential(plane: bool, mixed: bool) -> Any:
    @inner(fastmath=FAST)
    def tangential(
        total: bool, drop: bool, cap_total: bool, least: float, m: int, hdt: float, c: Any, batch: Any
    ) -> None:
        """Tangential force, its work, the first half of the normal work; force and torques on both grains."""
        dt, k_n, k_s, mu, cohesion = c[P.DT], c[P.K_N], c[P.K_S], c[P.MU], c[P.COHESION]
        soft_n, soft_s = 1.0 / k_n if k_n > 0.0 else 0.0, 1.0 / k_s if k_s > 0.0 else 0.0
        for l in range(known_lanes(m, B.LANES)):
            n_x, n_y, n_z = batch[B.NORMAL + l], 0.0, batch[B.NORMAL + 2 * B.PITCH + l]
            f_n, e_n = batch[B.F_N + l], batch[B.E_N + l]
            held, touching = batch[B.HELD + l], batch[B.TOUCHING + l]
            p_x, p_y, p_z = batch[B.SPRING + 4 * l], batch[B.SPRING + 4 * l + 1], batch[B.SPRING + 4 * l + 2]
            q_x, q_y, q_z = batch[B.DASH + 4 * l], batch[B.DASH + 4 * l + 1], batch[B.DASH + 4 * l + 2]
            s_x, s_y, s_z, twist = batch[B.SLIP + l], 0.0, 0.0, 0.0
            if not plane:
                n_y, twist = batch[B.NORMAL + B.PITCH + l], batch[B.TWIST + l]
                s_y, s_z = batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l]
            dashpot_n, released_n, step = normal_work_of_last_force(
                batch[B.CLOSING + l], batch[B.SPRING + 4 * l + 3], batch[B.DASH + 4 * l + 3],
                batch[B.WAS_TOUCHING + l] > touching, least, soft_n, hdt,
            )  # fmt: skip
            e_x, e_y, e_z, b_x, b_y, b_z, share, dashpot_s, sliding, released_s = tangential_step(
                plane, total, drop, cap_total, n_x, n_y, n_z, twist, f_n, e_n, held, s_x, s_y, s_z,
                p_x, p_y, p_z, q_x, q_y, q_z, k_s, soft_s, batch[B.ETA_S + l], cohesion,
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
            batch[B.DASH + 4 * l + 2], batch[B.DASH + 4 * l + 3] = b_z, f_n - e_n
            a_i, a_j = batch[B.ARM_I + l], batch[B.ARM_J + l]
            batch[B.FORCE + 4 * l], batch[B.FORCE + 4 * l + 1] = f_x, f_y
            batch[B.FORCE + 4 * l + 2], batch[B.FORCE + 4 * l + 3] = f_z, 0.0
            batch[B.TORQUE_I + 4 * l], batch[B.TORQUE_I + 4 * l + 1] = a_i * t_x, a_i * t_y
            batch[B.TORQUE_I + 4 * l + 2], batch[B.TORQUE_I + 4 * l + 3] = a_i * t_z, touching
            batch[B.TORQUE_J + 4 * l], batch[B.TORQUE_J + 4 * l + 1] = a_j * t_x, a_j * t_y
            batch[B.TORQUE_J + 4 * l + 2], batch[B.TORQUE_J + 4 * l + 3] = a_j * t_z, touching

    return tangential


@cache
def make_compute(plane: bool, mixed: bool) -> Any:
    """Build compute for a plane or for space, and for one material or several."""
    kinematics, tangential = _make_kinematics(plane), _make_tangential(plane, mixed)

    @inner(fastmath=FAST)
    def compute(choice: LawChoice, m: int, hdt: float, most: float, c: Any, batch: Any) -> None:
        """Forces, torques and work of the first m lanes; their memory goes from the last step to this one.

        Three loops, not one: each reads what it needs from the batch. One long loop has more numbers alive
        than there are registers, and waits for its own divisions and roots. `most` is the largest overlap
        over diameter so far [-]. Spins of locked grains are zero.
        """
        least = -math.inf if choice.tension else 0.0  # a contact that may pull has no least force
        total, drop, whole = slip_total(choice.slip), slip_drops(choice.slip), cap_total(choice.cap)
        kinematics(m, most, c, batch)
        _normal_force(least, m, hdt, c, batch)
        tangential(total, drop, whole, least, m, hdt, c, batch)

    return compute


@cache
def make_scatter(exact: bool, short: bool) -> Any:
    """Build scatter for the timing of contacts and the length of rows (contact_rows.py)."""
    lane_to_row = make_lane_to_row(short)

    @inner(fastmath=FAST)
    def scatter(
        m: int, selected: Any, i_of: Any, target: Any, touching: Any, rows: Any, batch: Any, f: Any
    ) -> bool:
        """Add the first m lanes to their grains, one by one in the order of the list, and keep their memory.

        `selected` are the candidates on the lanes. Returns whether an overlap is larger than any before.
        """
        larger = False
        for l in range(m):
            k = selected[l]
            i, j = i_of[k], target[k]
            add4(f, 8 * i, batch, B.FORCE + 4 * l)
            add4(f, 8 * i + 4, batch, B.TORQUE_I + 4 * l)
            subtract4(f, 8 * j, batch, B.FORCE + 4 * l)
            add4(f, 8 * j + 4, batch, B.TORQUE_J + 4 * l)
            lane_to_row(l, k, rows, batch)
            if not exact:
                touching[k] = batch[B.TORQUE_I + 4 * l + 3] > 0.0
            larger = larger or batch[B.EXCESS + l] > 0.0
        return larger

    return scatter
