"""The law of contact on a batch of pairs: laid out lane by lane, reckoned by vector instructions, handed out.

Every formula is a law. Choices are made by picking one of two numbers, never by leaving the lane, and arrays
are read at places known beforehand: that lets the compiler turn the loop of `reckon` into vector
instructions (engine/lanes.py).

Books are kept by velocity interval: at x(n) the velocity v(n-1/2) and the forces of steps n-1 and n give the
work u dt (f(n-1) + f(n))/2, exact for the scheme when kinetic energy is m v(n-1/2) v(n+1/2)/2. A spring met
or left within a step is booked for what the half interval takes beyond what it held (design/0005).
"""
# ruff: noqa: E741, F403, F405  (l is a lane; the places of lanes.py and the columns of rows.py, all of them plain integers)

import math
from typing import Any

from ryusa.engine.cpu.batch_layout import *
from ryusa.engine.cpu.cutoff import see_apart, tell_near
from ryusa.engine.cpu.simd.vec4 import add4, copy4, read4, take4, with_last, write4
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.pair import begin_row, place_of_eta
from ryusa.engine.shared.rows import *
from ryusa.laws.contact import normal_force, shear_strength, slide
from ryusa.laws.geometry import arm, turn, wrap
from ryusa.laws.geometry import overlap as overlap_of
from ryusa.model.enums import Cap, Slip

SLIP_DROP, SLIP_TOTAL, CAP_TOTAL = int(Slip.SPRING_DROP), int(Slip.TOTAL), int(Cap.TOTAL)


@inner(fastmath=FAST, forceinline=True)
def look(
    plane_case: int, reach_on: float, first: int, m: int, waiting: int, n_solid: int, c: Any, x: Any,
    i_of: Any, j_of: Any, live: Any, points: Any, normals: Any, glance: Any, hit: Any, which: Any,
) -> int:  # fmt: skip
    """Let those of m <= LANES near pairs wait that touch or did in the last step; returns how many wait.

    `which` gets their numbers; `glance` and `hit` are room to look at all.
    """
    for l in range(m):
        see_apart(l, i_of[first + l], j_of[first + l], n_solid, x, points, normals, glance)
    tell_near(plane_case, reach_on, m, c, glance, hit)
    for l in range(m):  # no branch: which pairs touch cannot be foretold
        which[waiting] = first + l
        waiting += int(hit[l] > 0.0) | int(live[first + l])
    return waiting


@inner(fastmath=FAST, forceinline=True)
def lay_out(
    rotation: int, m: int, which: Any, n_solid: int, c: Any, mass: Any, inertia: Any, x: Any, v: Any, w: Any,
    points: Any, normals: Any, i_of: Any, j_of: Any, live: Any, eta: Any, rows: Any, desk: Any,
) -> int:  # fmt: skip
    """Lay the first m pairs that wait on as many lanes; returns the lanes to reckon.

    Those are whole vectors of eight: the lanes beyond m hold pairs far apart.
    """
    width = rows.shape[1]
    for l in range(m):
        k = which[l]
        i, j = i_of[k], j_of[k]
        if not live[k]:
            begin_row(k, i, j, rotation, c, mass, x, inertia, eta, rows)
        see_apart(D_APART // 4 + l, i, j, n_solid, x, points, normals, desk)
        e = place_of_eta(k, eta)
        write4(desk, D_MOVING + 4 * l, with_last(read4(v, 8 * i) - read4(v, 8 * j), eta[e, ETA_N]))
        copy4(desk, D_SPIN_I + 4 * l, w, 8 * i)
        copy4(desk, D_SPIN_J + 4 * l, w, 8 * j)
        if j >= n_solid:
            desk[D_SPIN_J + 4 * l + 3] = w[i, 3]
        copy4(desk, D_SPRING + 4 * l, rows, width * k)
        copy4(desk, D_DASH + 4 * l, rows, width * k + R_DASH_S)
        desk[D_ETA_S + l], desk[D_WAS + l] = eta[e, ETA_S], live[k]
    whole = (m + 7) // 8 * 8
    for l in range(m, whole):
        for a in range(4):
            desk[D_APART + 4 * l + a] = desk[D_MOVING + 4 * l + a] = 0.0
            desk[D_SPIN_I + 4 * l + a] = desk[D_SPIN_J + 4 * l + a] = 0.0
            desk[D_SPRING + 4 * l + a] = desk[D_DASH + 4 * l + a] = 0.0
        desk[D_ETA_S + l] = desk[D_WAS + l] = 0.0
        desk[D_APART + 4 * l] = FAR
    return whole


@inner(fastmath=FAST)
def overlap_on(l: int, c: Any, desk: Any) -> float:
    """Overlap of the pair on lane l [m]."""
    d_x, d_z = wrap(desk[D_APART + 4 * l], c[C_PERIOD_X]), desk[D_APART + 4 * l + 2]
    d_y = wrap(desk[D_APART + 4 * l + 1], c[C_PERIOD_Y])
    distance = math.sqrt(d_x * d_x + d_y * d_y + d_z * d_z)
    return overlap_of(desk[D_SPIN_I + 4 * l + 3], desk[D_SPIN_J + 4 * l + 3], distance)


def _make_see(plane_case: int) -> Any:
    @inner(fastmath=FAST)
    def see(m: int, most: float, c: Any, desk: Any) -> None:
        """How each pair meets: normal, overlap, arms, closing speed and slip; and its spring and dashpot."""
        dt, k_n, l_x, l_y = c[C_DT], c[C_K_N], c[C_PERIOD_X], c[C_PERIOD_Y]
        for l in range(min(m, LANES)):  # never more: the compiler has to know
            d_x, d_y, d_z = wrap(desk[D_APART + 4 * l], l_x), 0.0, desk[D_APART + 4 * l + 2]
            square = d_x * d_x + d_z * d_z
            if not plane_case:
                d_y = wrap(desk[D_APART + 4 * l + 1], l_y)
                square += d_y * d_y
            r_i, r_j = desk[D_SPIN_I + 4 * l + 3], desk[D_SPIN_J + 4 * l + 3]
            distance = math.sqrt(square)
            inverse = 1.0 / distance
            n_x, n_y, n_z = d_x * inverse, d_y * inverse, d_z * inverse
            overlap = overlap_of(desk[D_APART + 4 * l + 3], 0.0, distance)
            a_i = arm(r_i, overlap)
            a_j = distance - a_i

            # velocities at the contact point; s is the slip of i against j, in a plane along (n_z, 0, -n_x)
            u_x, u_y, u_z = desk[D_MOVING + 4 * l], 0.0, desk[D_MOVING + 4 * l + 2]
            i_x, i_y, i_z = desk[D_SPIN_I + 4 * l], desk[D_SPIN_I + 4 * l + 1], desk[D_SPIN_I + 4 * l + 2]
            j_x, j_y, j_z = desk[D_SPIN_J + 4 * l], desk[D_SPIN_J + 4 * l + 1], desk[D_SPIN_J + 4 * l + 2]
            closing = u_x * n_x + u_z * n_z
            if plane_case:
                s_x = u_x * n_z - u_z * n_x
                # in a plane spin has one component; the zeros beside it are read to read all four of a group
                s_x += a_i * (i_x + i_y + i_z) + a_j * (j_x + j_y + j_z)
            else:
                u_y = desk[D_MOVING + 4 * l + 1]
                closing += u_y * n_y
                s_x, s_y, s_z = u_x - closing * n_x, u_y - closing * n_y, u_z - closing * n_z
                g_x, g_y, g_z = a_i * i_x + a_j * j_x, a_i * i_y + a_j * j_y, a_i * i_z + a_j * j_z
                s_x += g_y * n_z - g_z * n_y
                s_y += g_z * n_x - g_x * n_z
                s_z += g_x * n_y - g_y * n_x
                twist = 0.5 * dt * ((i_x + j_x) * n_x + (i_y + j_y) * n_y + (i_z + j_z) * n_z)
                desk[D_TWIST + l] = twist
                desk[D_NORMAL + PITCH + l] = n_y
                desk[D_SLIP + PITCH + l], desk[D_SLIP + 2 * PITCH + l] = s_y, s_z
            desk[D_NORMAL + l], desk[D_NORMAL + 2 * PITCH + l] = n_x, n_z
            desk[D_SLIP + l] = s_x
            desk[D_OVERLAP + l], desk[D_CLOSING + l] = overlap, closing
            desk[D_ARM_I + l], desk[D_ARM_J + l] = a_i, a_j
            desk[D_EXCESS + l] = overlap - 2.0 * most * min(r_i, r_j)
            desk[D_RAW + l] = normal_force(overlap, closing, k_n, desk[D_MOVING + 4 * l + 3])

    return see


@inner(fastmath=FAST)
def _push(least: float, m: int, hdt: float, c: Any, desk: Any) -> None:
    """Normal force, and the later half of its books; `least` is the least a contact can have [N]."""
    k_n = c[C_K_N]
    for l in range(min(m, LANES)):
        overlap, closing, was = desk[D_OVERLAP + l], desk[D_CLOSING + l], desk[D_WAS + l] > 0.0
        touching = overlap > 0.0
        e_n = k_n * overlap if touching else 0.0
        f_n = max(desk[D_RAW + l], least) if touching else 0.0
        held = touching and f_n > least
        work = hdt * closing * (f_n - e_n)
        met = touching and (not was) and hdt > 0.0
        desk[D_DASH_N + l] += work if held else 0.0
        desk[D_RELEASED_N + l] += 0.0 if held else work
        desk[D_STEP + l] += -0.5 * e_n * (2.0 * hdt * closing - overlap) if met else 0.0
        desk[D_F_N + l], desk[D_E_N + l] = f_n, e_n
        desk[D_HELD + l], desk[D_LIVE + l] = 1.0 if held else 0.0, 1.0 if touching else 0.0


def _make_shear(plane_case: int) -> Any:
    @inner(fastmath=FAST)
    def shear(
        total: bool, drop: bool, cap_total: bool, least: float, m: int, hdt: float, c: Any, desk: Any
    ) -> None:
        """Tangential force, its books and the earlier half of the normal ones, and what both grains get."""
        dt, k_n, k_s, mu, cohesion = c[C_DT], c[C_K_N], c[C_K_S], c[C_MU], c[C_COHESION]
        soft_n, soft_s = 1.0 / k_n if k_n > 0.0 else 0.0, 1.0 / k_s if k_s > 0.0 else 0.0
        for l in range(min(m, LANES)):
            n_x, n_y, n_z = desk[D_NORMAL + l], 0.0, desk[D_NORMAL + 2 * PITCH + l]
            f_n, e_n, held, live = desk[D_F_N + l], desk[D_E_N + l], desk[D_HELD + l], desk[D_LIVE + l]
            p_x, p_y, p_z = desk[D_SPRING + 4 * l], desk[D_SPRING + 4 * l + 1], desk[D_SPRING + 4 * l + 2]
            q_x, q_y, q_z = desk[D_DASH + 4 * l], desk[D_DASH + 4 * l + 1], desk[D_DASH + 4 * l + 2]
            s_x, s_y, s_z = desk[D_SLIP + l], 0.0, 0.0
            eta_s, closing = desk[D_ETA_S + l], desk[D_CLOSING + l]
            f_old, d_old = desk[D_SPRING + 4 * l + 3], desk[D_DASH + 4 * l + 3]
            work, e_old, drawn = hdt * closing * d_old, f_old - d_old, f_old > least
            left = desk[D_WAS + l] > live
            desk[D_DASH_N + l] += work if drawn else 0.0
            desk[D_RELEASED_N + l] += 0.0 if drawn else work
            desk[D_STEP + l] += 0.5 * e_old * (-2.0 * hdt * closing - e_old * soft_n) if left else 0.0
            if not plane_case:
                n_y = desk[D_NORMAL + PITCH + l]
                s_y, s_z = desk[D_SLIP + PITCH + l], desk[D_SLIP + 2 * PITCH + l]
                twist = desk[D_TWIST + l]
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
            desk[D_DASH_S + l] += -hdt * lost
            desk[D_SLIDE + l] += held * taken
            desk[D_RELEASED_S + l] += taken - held * taken
            desk[D_SLIDES + l] = 1.0 if share < 1.0 else 0.0
            desk[D_SPRING + 4 * l], desk[D_SPRING + 4 * l + 1] = e_x, e_y
            desk[D_SPRING + 4 * l + 2], desk[D_SPRING + 4 * l + 3] = e_z, f_n
            desk[D_DASH + 4 * l], desk[D_DASH + 4 * l + 1] = b_x, b_y
            desk[D_DASH + 4 * l + 2], desk[D_DASH + 4 * l + 3] = b_z, f_n - e_n
            if plane_case:
                h = e_x + b_x
                h_x, h_y, h_z = h * n_z, 0.0, -h * n_x
                t_x, t_y, t_z = 0.0, h, 0.0
            else:
                h_x, h_y, h_z = e_x + b_x, e_y + b_y, e_z + b_z
                t_x, t_y, t_z = n_y * h_z - n_z * h_y, n_z * h_x - n_x * h_z, n_x * h_y - n_y * h_x
            a_i, a_j = desk[D_ARM_I + l], desk[D_ARM_J + l]
            desk[D_FORCE + 4 * l], desk[D_FORCE + 4 * l + 1] = h_x - f_n * n_x, h_y - f_n * n_y
            desk[D_FORCE + 4 * l + 2], desk[D_FORCE + 4 * l + 3] = h_z - f_n * n_z, 0.0
            desk[D_TORQUE_I + 4 * l], desk[D_TORQUE_I + 4 * l + 1] = a_i * t_x, a_i * t_y
            desk[D_TORQUE_I + 4 * l + 2], desk[D_TORQUE_I + 4 * l + 3] = a_i * t_z, live
            desk[D_TORQUE_J + 4 * l], desk[D_TORQUE_J + 4 * l + 1] = a_j * t_x, a_j * t_y
            desk[D_TORQUE_J + 4 * l + 2], desk[D_TORQUE_J + 4 * l + 3] = a_j * t_z, live

    return shear


# Built once for a plane and once for space; not handed over as functions, which numba could not keep on disk.
_see_plane, _see_space = _make_see(1), _make_see(0)
_shear_plane, _shear_space = _make_shear(1), _make_shear(0)


@inner(fastmath=FAST, forceinline=True)
def reckon(flat: int | None, choice: Choice, m: int, hdt: float, most: float, c: Any, desk: Any) -> None:
    """Forces, torques and work of the first m lanes; their memory goes from the last step to this one.

    Three loops, not one: each finds on the desk what it needs. One long loop has more numbers alive than
    there are registers, and waits for its own divisions and roots. `most` is the largest overlap over
    diameter so far [-]. Spins of locked grains are zero.
    """
    least = -math.inf if choice.tension else 0.0  # a contact that may pull has no least force
    total, drop, cap_total = choice.slip == SLIP_TOTAL, choice.slip == SLIP_DROP, choice.cap == CAP_TOTAL
    if flat is not None:
        _see_plane(m, most, c, desk)
        _push(least, m, hdt, c, desk)
        _shear_plane(total, drop, cap_total, least, m, hdt, c, desk)
    else:
        _see_space(m, most, c, desk)
        _push(least, m, hdt, c, desk)
        _shear_space(total, drop, cap_total, least, m, hdt, c, desk)


@inner(fastmath=FAST, forceinline=True)
def hand_out(m: int, which: Any, i_of: Any, to: Any, live: Any, rows: Any, desk: Any, f: Any) -> bool:
    """Add the first m lanes to their grains, one by one in the order of the list, and keep their memory.

    `which` are the near pairs on the lanes. Returns whether an overlap is larger than any before.
    """
    width, larger = rows.shape[1], False
    for l in range(m):
        k = which[l]
        i, j = i_of[k], to[k]
        add4(f, 8 * i, desk, D_FORCE + 4 * l)
        add4(f, 8 * i + 4, desk, D_TORQUE_I + 4 * l)
        take4(f, 8 * j, desk, D_FORCE + 4 * l)
        add4(f, 8 * j + 4, desk, D_TORQUE_J + 4 * l)
        copy4(rows, width * k, desk, D_SPRING + 4 * l)
        copy4(rows, width * k + R_DASH_S, desk, D_DASH + 4 * l)
        live[k] = desk[D_TORQUE_I + 4 * l + 3] > 0.0
        larger = larger or desk[D_EXCESS + l] > 0.0
    return larger
