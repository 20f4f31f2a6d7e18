"""The law of contact on a batch of pairs: laid out lane by lane, reckoned by vector instructions, handed out.

Every formula is a law. Choices are made by picking one of two numbers, never by leaving the lane, and arrays
are read at places known beforehand: that lets the compiler turn the loop of `reckon` into vector
instructions (engine/lanes.py).

Books are kept by velocity interval: at x(n) the velocity v(n-1/2) and the forces of steps n-1 and n give the
work u dt (f(n-1) + f(n))/2, exact for the scheme when kinetic energy is m v(n-1/2) v(n+1/2)/2. A spring met
or left within a step is booked for what the half interval takes beyond what it held (design/0005).
"""
# ruff: noqa: E741  (l is a lane)

import math
from typing import Any

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.contact_rows import begin_row, dashpot_row
from ryusa.engine.cpu.cutoff import mark_within_cutoff, set_separation
from ryusa.engine.cpu.simd.vec4 import add4, copy4, read4, subtract4, with_fourth, write4
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.contact import normal_force, shear_strength, slide
from ryusa.laws.geometry import arm, turn, wrap
from ryusa.laws.geometry import overlap as overlap_of
from ryusa.model.enums import Cap, Slip

SLIP_DROP, SLIP_TOTAL, CAP_TOTAL = int(Slip.SPRING_DROP), int(Slip.TOTAL), int(Cap.TOTAL)


@inner(fastmath=FAST, forceinline=True)
def filter_pairs(
    plane_case: int, reach_on: float, first: int, m: int, waiting: int, n_solid: int, c: Any, x: Any,
    i_of: Any, j_of: Any, touching: Any, points: Any, normals: Any, separation: Any, inside: Any,
    selected: Any,
) -> int:  # fmt: skip
    """Let those of m <= LANES near pairs wait that touch or did in the last step; returns how many wait.

    `which` gets their numbers; `glance` and `hit` are room to look at all.
    """
    for l in range(m):
        set_separation(l, i_of[first + l], j_of[first + l], n_solid, x, points, normals, separation)
    mark_within_cutoff(plane_case, reach_on, m, c, separation, inside)
    for l in range(m):  # no branch: which pairs touch cannot be foretold
        selected[waiting] = first + l
        waiting += int(inside[l] > 0.0) | int(touching[first + l])
    return waiting


@inner(fastmath=FAST, forceinline=True)
def gather(
    rotation: int, m: int, selected: Any, n_solid: int, c: Any, mass: Any, inertia: Any, x: Any, v: Any,
    w: Any, points: Any, normals: Any, i_of: Any, j_of: Any, touching: Any, eta: Any, rows: Any, batch: Any,
) -> int:  # fmt: skip
    """Lay the first m pairs that wait on as many lanes; returns the lanes to reckon.

    Those are whole vectors of eight: the lanes beyond m hold pairs far apart.
    """
    width = rows.shape[1]
    for l in range(m):
        k = selected[l]
        i, j = i_of[k], j_of[k]
        if not touching[k]:
            begin_row(k, i, j, rotation, c, mass, x, inertia, eta, rows)
        set_separation(B.SEPARATION // 4 + l, i, j, n_solid, x, points, normals, batch)
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
        copy4(batch, B.SPRING + 4 * l, rows, width * k)
        copy4(batch, B.DASH + 4 * l, rows, width * k + M.DASH_S)
        batch[B.ETA_S + l], batch[B.WAS_TOUCHING + l] = eta[e, M.ETA_S], touching[k]
    whole = (m + 7) // 8 * 8
    for l in range(m, whole):
        for a in range(4):
            batch[B.SEPARATION + 4 * l + a] = batch[B.RELATIVE_VELOCITY + 4 * l + a] = 0.0
            batch[B.SPIN_I + 4 * l + a] = batch[B.SPIN_J + 4 * l + a] = 0.0
            batch[B.SPRING + 4 * l + a] = batch[B.DASH + 4 * l + a] = 0.0
        batch[B.ETA_S + l] = batch[B.WAS_TOUCHING + l] = 0.0
        batch[B.SEPARATION + 4 * l] = B.FAR
    return whole


@inner(fastmath=FAST)
def overlap_of_lane(l: int, c: Any, batch: Any) -> float:
    """Overlap of the pair on lane l [m]."""
    d_x, d_z = wrap(batch[B.SEPARATION + 4 * l], c[P.PERIOD_X]), batch[B.SEPARATION + 4 * l + 2]
    d_y = wrap(batch[B.SEPARATION + 4 * l + 1], c[P.PERIOD_Y])
    distance = math.sqrt(d_x * d_x + d_y * d_y + d_z * d_z)
    return overlap_of(batch[B.SPIN_I + 4 * l + 3], batch[B.SPIN_J + 4 * l + 3], distance)


def _make_kinematics(plane_case: int) -> Any:
    @inner(fastmath=FAST)
    def kinematics(m: int, most: float, c: Any, batch: Any) -> None:
        """How each pair meets: normal, overlap, arms, closing speed and slip; and its spring and dashpot."""
        dt, k_n, l_x, l_y = c[P.DT], c[P.K_N], c[P.PERIOD_X], c[P.PERIOD_Y]
        for l in range(min(m, B.LANES)):  # never more: the compiler has to know
            d_x, d_y, d_z = wrap(batch[B.SEPARATION + 4 * l], l_x), 0.0, batch[B.SEPARATION + 4 * l + 2]
            square = d_x * d_x + d_z * d_z
            if not plane_case:
                d_y = wrap(batch[B.SEPARATION + 4 * l + 1], l_y)
                square += d_y * d_y
            r_i, r_j = batch[B.SPIN_I + 4 * l + 3], batch[B.SPIN_J + 4 * l + 3]
            distance = math.sqrt(square)
            inverse = 1.0 / distance
            n_x, n_y, n_z = d_x * inverse, d_y * inverse, d_z * inverse
            overlap = overlap_of(batch[B.SEPARATION + 4 * l + 3], 0.0, distance)
            a_i = arm(r_i, overlap)
            a_j = distance - a_i

            # velocities at the contact point; s is the slip of i against j, in a plane along (n_z, 0, -n_x)
            u_x, u_y, u_z = batch[B.RELATIVE_VELOCITY + 4 * l], 0.0, batch[B.RELATIVE_VELOCITY + 4 * l + 2]
            i_x, i_y, i_z = batch[B.SPIN_I + 4 * l], batch[B.SPIN_I + 4 * l + 1], batch[B.SPIN_I + 4 * l + 2]
            j_x, j_y, j_z = batch[B.SPIN_J + 4 * l], batch[B.SPIN_J + 4 * l + 1], batch[B.SPIN_J + 4 * l + 2]
            closing = u_x * n_x + u_z * n_z
            if plane_case:
                s_x = u_x * n_z - u_z * n_x
                # in a plane spin has one component; the zeros beside it are read to read all four of a group
                s_x += a_i * (i_x + i_y + i_z) + a_j * (j_x + j_y + j_z)
            else:
                u_y = batch[B.RELATIVE_VELOCITY + 4 * l + 1]
                closing += u_y * n_y
                s_x, s_y, s_z = u_x - closing * n_x, u_y - closing * n_y, u_z - closing * n_z
                g_x, g_y, g_z = a_i * i_x + a_j * j_x, a_i * i_y + a_j * j_y, a_i * i_z + a_j * j_z
                s_x += g_y * n_z - g_z * n_y
                s_y += g_z * n_x - g_x * n_z
                s_z += g_x * n_y - g_y * n_x
                twist = 0.5 * dt * ((i_x + j_x) * n_x + (i_y + j_y) * n_y + (i_z + j_z) * n_z)
                batch[B.TWIST + l] = twist
                batch[B.NORMAL + B.PITCH + l] = n_y
                batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l] = s_y, s_z
            batch[B.NORMAL + l], batch[B.NORMAL + 2 * B.PITCH + l] = n_x, n_z
            batch[B.SLIP + l] = s_x
            batch[B.OVERLAP + l], batch[B.CLOSING + l] = overlap, closing
            batch[B.ARM_I + l], batch[B.ARM_J + l] = a_i, a_j
            batch[B.EXCESS + l] = overlap - 2.0 * most * min(r_i, r_j)
            batch[B.RAW + l] = normal_force(overlap, closing, k_n, batch[B.RELATIVE_VELOCITY + 4 * l + 3])

    return kinematics


@inner(fastmath=FAST)
def _normal_force(least: float, m: int, hdt: float, c: Any, batch: Any) -> None:
    """Normal force, and the later half of its books; `least` is the least a contact can have [N]."""
    k_n = c[P.K_N]
    for l in range(min(m, B.LANES)):
        overlap, closing, was = batch[B.OVERLAP + l], batch[B.CLOSING + l], batch[B.WAS_TOUCHING + l] > 0.0
        touching = overlap > 0.0
        e_n = k_n * overlap if touching else 0.0
        f_n = max(batch[B.RAW + l], least) if touching else 0.0
        held = touching and f_n > least
        work = hdt * closing * (f_n - e_n)
        met = touching and (not was) and hdt > 0.0
        batch[B.DASH_N + l] += work if held else 0.0
        batch[B.RELEASED_N + l] += 0.0 if held else work
        batch[B.STEP + l] += -0.5 * e_n * (2.0 * hdt * closing - overlap) if met else 0.0
        batch[B.F_N + l], batch[B.E_N + l] = f_n, e_n
        batch[B.HELD + l], batch[B.TOUCHING + l] = 1.0 if held else 0.0, 1.0 if touching else 0.0


def _make_tangential(plane_case: int) -> Any:
    @inner(fastmath=FAST)
    def tangential(
        total: bool, drop: bool, cap_total: bool, least: float, m: int, hdt: float, c: Any, batch: Any
    ) -> None:
        """Tangential force, its books and the earlier half of the normal ones, and what both grains get."""
        dt, k_n, k_s, mu, cohesion = c[P.DT], c[P.K_N], c[P.K_S], c[P.MU], c[P.COHESION]
        soft_n, soft_s = 1.0 / k_n if k_n > 0.0 else 0.0, 1.0 / k_s if k_s > 0.0 else 0.0
        for l in range(min(m, B.LANES)):
            n_x, n_y, n_z = batch[B.NORMAL + l], 0.0, batch[B.NORMAL + 2 * B.PITCH + l]
            f_n, e_n, held, touching = (
                batch[B.F_N + l],
                batch[B.E_N + l],
                batch[B.HELD + l],
                batch[B.TOUCHING + l],
            )
            p_x, p_y, p_z = batch[B.SPRING + 4 * l], batch[B.SPRING + 4 * l + 1], batch[B.SPRING + 4 * l + 2]
            q_x, q_y, q_z = batch[B.DASH + 4 * l], batch[B.DASH + 4 * l + 1], batch[B.DASH + 4 * l + 2]
            s_x, s_y, s_z = batch[B.SLIP + l], 0.0, 0.0
            eta_s, closing = batch[B.ETA_S + l], batch[B.CLOSING + l]
            f_old, d_old = batch[B.SPRING + 4 * l + 3], batch[B.DASH + 4 * l + 3]
            work, e_old, drawn = hdt * closing * d_old, f_old - d_old, f_old > least
            left = batch[B.WAS_TOUCHING + l] > touching
            batch[B.DASH_N + l] += work if drawn else 0.0
            batch[B.RELEASED_N + l] += 0.0 if drawn else work
            batch[B.STEP + l] += 0.5 * e_old * (-2.0 * hdt * closing - e_old * soft_n) if left else 0.0
            if not plane_case:
                n_y = batch[B.NORMAL + B.PITCH + l]
                s_y, s_z = batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l]
                twist = batch[B.TWIST + l]
                p_x, p_y, p_z = turn(p_x, p_y, p_z, n_x, n_y, n_z, twist)
            tau_c = shear_strength(f_n if cap_total else e_n, cohesion, mu)
            e_x, e_y, e_z = p_x - k_s * s_x * dt, p_y, p_z  # the last two zeros in a plane
            b_x, b_y, b_z = -eta_s * s_x, q_y, q_z
            if not plane_case:
                e_y, e_z = p_y - k_s * s_y * dt, p_z - k_s * s_z * dt
                b_y, b_z = -eta_s * s_y, -eta_s * s_z
            g_x = e_x + b_x if total else e_x
            if plane_case:
                size = math.fabs(g_x)
            else:
                g_y, g_z = e_y + b_y if total else e_y, e_z + b_z if total else e_z
                size = math.sqrt(g_x * g_x + g_y * g_y + g_z * g_z)
            share, swap, keep = slide(size, tau_c, drop, total)
            share, swap, keep = held * share, held * swap, held * keep
            e_x, b_x = share * e_x + swap * b_x, keep * b_x
            taken, lost = s_x * (p_x + e_x), s_x * (q_x + b_x)
            spent = p_x * p_x - e_x * e_x
            if not plane_case:
                e_y, b_y = share * e_y + swap * b_y, keep * b_y
                e_z, b_z = share * e_z + swap * b_z, keep * b_z
                taken += s_y * (p_y + e_y) + s_z * (p_z + e_z)
                lost += s_y * (q_y + b_y) + s_z * (q_z + b_z)
                spent += p_y * p_y - e_y * e_y + (p_z * p_z - e_z * e_z)
            taken = 0.5 * spent * soft_s - hdt * taken if share < 1.0 else 0.0
            batch[B.DASH_S + l] += -hdt * lost
            batch[B.SLIDE + l] += held * taken
            batch[B.RELEASED_S + l] += taken - held * taken
            batch[B.SLIDES + l] = 1.0 if share < 1.0 else 0.0
            batch[B.SPRING + 4 * l], batch[B.SPRING + 4 * l + 1] = e_x, e_y
            batch[B.SPRING + 4 * l + 2], batch[B.SPRING + 4 * l + 3] = e_z, f_n
            batch[B.DASH + 4 * l], batch[B.DASH + 4 * l + 1] = b_x, b_y
            batch[B.DASH + 4 * l + 2], batch[B.DASH + 4 * l + 3] = b_z, f_n - e_n
            if plane_case:
                h = e_x + b_x
                h_x, h_y, h_z = h * n_z, 0.0, -h * n_x
                t_x, t_y, t_z = 0.0, h, 0.0
            else:
                h_x, h_y, h_z = e_x + b_x, e_y + b_y, e_z + b_z
                t_x, t_y, t_z = n_y * h_z - n_z * h_y, n_z * h_x - n_x * h_z, n_x * h_y - n_y * h_x
            a_i, a_j = batch[B.ARM_I + l], batch[B.ARM_J + l]
            batch[B.FORCE + 4 * l], batch[B.FORCE + 4 * l + 1] = h_x - f_n * n_x, h_y - f_n * n_y
            batch[B.FORCE + 4 * l + 2], batch[B.FORCE + 4 * l + 3] = h_z - f_n * n_z, 0.0
            batch[B.TORQUE_I + 4 * l], batch[B.TORQUE_I + 4 * l + 1] = a_i * t_x, a_i * t_y
            batch[B.TORQUE_I + 4 * l + 2], batch[B.TORQUE_I + 4 * l + 3] = a_i * t_z, touching
            batch[B.TORQUE_J + 4 * l], batch[B.TORQUE_J + 4 * l + 1] = a_j * t_x, a_j * t_y
            batch[B.TORQUE_J + 4 * l + 2], batch[B.TORQUE_J + 4 * l + 3] = a_j * t_z, touching

    return tangential


# Built once for a plane and once for space; not handed over as functions, which numba could not keep on disk.
_kinematics_plane, _kinematics_space = _make_kinematics(1), _make_kinematics(0)
_tangential_plane, _tangential_space = _make_tangential(1), _make_tangential(0)


@inner(fastmath=FAST, forceinline=True)
def compute(flat: int | None, choice: LawChoice, m: int, hdt: float, most: float, c: Any, batch: Any) -> None:
    """Forces, torques and work of the first m lanes; their memory goes from the last step to this one.

    Three loops, not one: each finds on the desk what it needs. One long loop has more numbers alive than
    there are registers, and waits for its own divisions and roots. `most` is the largest overlap over
    diameter so far [-]. Spins of locked grains are zero.
    """
    least = -math.inf if choice.tension else 0.0  # a contact that may pull has no least force
    total, drop, cap_total = choice.slip == SLIP_TOTAL, choice.slip == SLIP_DROP, choice.cap == CAP_TOTAL
    if flat is not None:
        _kinematics_plane(m, most, c, batch)
        _normal_force(least, m, hdt, c, batch)
        _tangential_plane(total, drop, cap_total, least, m, hdt, c, batch)
    else:
        _kinematics_space(m, most, c, batch)
        _normal_force(least, m, hdt, c, batch)
        _tangential_space(total, drop, cap_total, least, m, hdt, c, batch)


@inner(fastmath=FAST, forceinline=True)
def scatter(
    m: int, selected: Any, i_of: Any, target: Any, touching: Any, rows: Any, batch: Any, f: Any
) -> bool:
    """Add the first m lanes to their grains, one by one in the order of the list, and keep their memory.

    `which` are the near pairs on the lanes. Returns whether an overlap is larger than any before.
    """
    width, larger = rows.shape[1], False
    for l in range(m):
        k = selected[l]
        i, j = i_of[k], target[k]
        add4(f, 8 * i, batch, B.FORCE + 4 * l)
        add4(f, 8 * i + 4, batch, B.TORQUE_I + 4 * l)
        subtract4(f, 8 * j, batch, B.FORCE + 4 * l)
        add4(f, 8 * j + 4, batch, B.TORQUE_J + 4 * l)
        copy4(rows, width * k, batch, B.SPRING + 4 * l)
        copy4(rows, width * k + M.DASH_S, batch, B.DASH + 4 * l)
        touching[k] = batch[B.TORQUE_I + 4 * l + 3] > 0.0
        larger = larger or batch[B.EXCESS + l] > 0.0
    return larger
