"""The law of contact on a batch of pairs: laid out lane by lane, reckoned by vector instructions, handed out.

Every formula is a law. Choices are made by picking one of two numbers, never by leaving the lane, and arrays are read at
places known beforehand: that lets the compiler turn the loop of `reckon` into vector instructions (engine/lanes.py).

Books are kept by velocity interval: at x(n) the velocity v(n-1/2) and the forces of steps n-1 and n give the
work u dt (f(n-1) + f(n))/2, exact for the scheme when kinetic energy is m v(n-1/2) v(n+1/2)/2. A spring met or left
within a step is booked for what the half interval takes beyond what it held (design/0005).
"""
# ruff: noqa: F403, F405  (the places of lanes.py and the columns of rows.py, all of them plain integers)

import math
from typing import Any

from ryusa.engine._kernel import FAST, kernel
from ryusa.engine.arrays import Grains, Walls
from ryusa.engine.lanes import *
from ryusa.engine.rows import *
from ryusa.laws.contact import (
    normal_force,
    normal_force_no_tension,
    shear_strength,
    slide_spring,
    slide_spring_drop,
    slide_total,
)
from ryusa.laws.geometry import arm, turn, wrap
from ryusa.laws.geometry import overlap as overlap_of
from ryusa.model.enums import Cap, Slip

SLIP_DROP, SLIP_TOTAL, CAP_TOTAL = int(Slip.SPRING_DROP), int(Slip.TOTAL), int(Cap.TOTAL)


@kernel(fastmath=FAST, forceinline=True)
def lay_out(m: int, n_solid: int, i_of: Any, j_of: Any, grains: Grains, walls: Walls, desk: Any) -> int:
    """Put m pairs on the desk; returns the lanes to reckon, whole vectors of eight, the rest far apart.

    A plane is met as a grain of the same size that touches it from behind.
    """
    x, v, w = grains.x, grains.v, grains.w
    for l in range(m):
        i, j = i_of[l], j_of[l]
        for k in range(4):
            desk[D_APART + 4 * l + k] = x[j, k] - x[i, k]
        for k in range(4):
            desk[D_SLIP + 4 * l + k] = v[i, k] - v[j, k]
        for k in range(4):
            desk[D_SPIN_I + 4 * l + k] = w[i, k]
        for k in range(4):
            desk[D_SPIN_J + 4 * l + k] = w[j, k]
        if j >= n_solid:
            a, r = j - n_solid, w[i, 3]
            gap = 0.0
            for k in range(3):
                gap += (x[i, k] - walls.points[a, k]) * walls.normals[a, k]
            for k in range(3):
                desk[D_APART + 4 * l + k] = -(gap + r) * walls.normals[a, k]
            desk[D_SPIN_J + 4 * l + 3] = r
    whole = (m + 7) // 8 * 8
    for l in range(m, whole):
        for k in range(4):
            desk[D_APART + 4 * l + k] = desk[D_SLIP + 4 * l + k] = 0.0
            desk[D_SPIN_I + 4 * l + k] = desk[D_SPIN_J + 4 * l + k] = 0.0
        desk[D_APART + 4 * l] = FAR
    return whole


@kernel(fastmath=FAST, forceinline=True)
def reckon(kind: Variant, choice: Choice, m: int, hdt: float, c: Any, desk: Any, memory: Any) -> None:
    """Forces, torques and work of the first m lanes; `memory` goes from the last step to this one."""
    plane_case, rotation = kind.plane_case, kind.rotation
    company = kind.rolling or kind.events or kind.film
    slip, cap_total, tension = choice.slip, choice.cap == CAP_TOTAL, choice.tension != 0
    total = slip == SLIP_TOTAL
    dt, k_n, k_s, mu, cohesion = c[C_DT], c[C_K_N], c[C_K_S], c[C_MU], c[C_COHESION]
    l_x, l_y = c[C_PERIOD_X], c[C_PERIOD_Y]
    for l in range(m):
        # geometry
        d_x, d_y, d_z = wrap(desk[D_APART + 4 * l], l_x), 0.0, desk[D_APART + 4 * l + 2]
        square = d_x * d_x + d_z * d_z
        if not plane_case:
            d_y = wrap(desk[D_APART + 4 * l + 1], l_y)
            square += d_y * d_y
        r_i, r_j = desk[D_SPIN_I + 4 * l + 3], desk[D_SPIN_J + 4 * l + 3]
        distance = math.sqrt(square)
        inverse = 1.0 / distance
        n_x, n_y, n_z = d_x * inverse, d_y * inverse, d_z * inverse
        overlap = overlap_of(r_i, r_j, distance)
        touching = overlap > 0.0
        a_i = arm(r_i, overlap)
        a_j = distance - a_i

        # velocities at the contact point; s is the slip of i against j, in a plane along the tangent (n_z, 0, -n_x)
        u_x, u_y, u_z = desk[D_SLIP + 4 * l], 0.0, desk[D_SLIP + 4 * l + 2]
        i_x, i_y, i_z = desk[D_SPIN_I + 4 * l], desk[D_SPIN_I + 4 * l + 1], desk[D_SPIN_I + 4 * l + 2]
        j_x, j_y, j_z = desk[D_SPIN_J + 4 * l], desk[D_SPIN_J + 4 * l + 1], desk[D_SPIN_J + 4 * l + 2]
        closing = u_x * n_x + u_z * n_z
        s_y = s_z = 0.0
        if plane_case:
            s_x = u_x * n_z - u_z * n_x
            if rotation:
                s_x += a_i * i_y + a_j * j_y
        else:
            u_y = desk[D_SLIP + 4 * l + 1]
            closing += u_y * n_y
            s_x, s_y, s_z = u_x - closing * n_x, u_y - closing * n_y, u_z - closing * n_z
            if rotation:
                g_x, g_y, g_z = a_i * i_x + a_j * j_x, a_i * i_y + a_j * j_y, a_i * i_z + a_j * j_z
                s_x += g_y * n_z - g_z * n_y
                s_y += g_z * n_x - g_x * n_z
                s_z += g_x * n_y - g_y * n_x

        # normal force
        was = memory[M_LIVE + l] > 0.0
        f_old, d_old = memory[M_F_N + l], memory[M_DASH_N + l]
        e_n = k_n * overlap if touching else 0.0
        if tension:
            f_n = normal_force(overlap, closing, k_n, memory[M_ETA_N + l])
        else:
            f_n = normal_force_no_tension(overlap, closing, k_n, memory[M_ETA_N + l])
        f_n = f_n if touching else 0.0
        held = touching and (tension or f_n > 0.0)
        d_n = f_n - e_n
        drawn = tension or f_old > 0.0
        first, second = hdt * closing * d_old, hdt * closing * d_n
        e_old = f_old - d_old
        met = touching and (not was) and hdt > 0.0
        left = was and not touching
        given = -0.5 * e_n * (2.0 * hdt * closing - overlap) if met else 0.0
        given_left = 0.5 * e_old * (-2.0 * hdt * closing - e_old / k_n) if k_n > 0.0 else 0.0
        given += given_left if left else 0.0

        # tangential force
        p_x, p_y, p_z = memory[M_SPRING_S + l], 0.0, 0.0
        q_x, q_y, q_z = memory[M_DASH_S + l], 0.0, 0.0
        if not plane_case:
            p_y, p_z = memory[M_SPRING_S + LANES + l], memory[M_SPRING_S + 2 * LANES + l]
            q_y, q_z = memory[M_DASH_S + LANES + l], memory[M_DASH_S + 2 * LANES + l]
            twist = 0.0
            if rotation:
                twist = 0.5 * dt * ((i_x + j_x) * n_x + (i_y + j_y) * n_y + (i_z + j_z) * n_z)
            p_x, p_y, p_z = turn(p_x, p_y, p_z, n_x, n_y, n_z, twist)
        eta_s = memory[M_ETA_S + l]
        tau_c = shear_strength(f_n if cap_total else e_n, cohesion, mu)
        e_x, e_y, e_z = p_x - k_s * s_x * dt, 0.0, 0.0
        b_x, b_y, b_z = -eta_s * s_x, 0.0, 0.0
        if not plane_case:
            e_y, e_z = p_y - k_s * s_y * dt, p_z - k_s * s_z * dt
            b_y, b_z = -eta_s * s_y, -eta_s * s_z
        g_x = e_x + b_x if total else e_x
        if plane_case:
            size = abs(g_x)
        else:
            g_y, g_z = e_y + b_y if total else e_y, e_z + b_z if total else e_z
            size = math.sqrt(g_x * g_x + g_y * g_y + g_z * g_z)
        if total:
            share, swap, keep = slide_total(size, tau_c)
        elif slip == SLIP_DROP:
            share, swap, keep = slide_spring_drop(size, tau_c)
        else:
            share, swap, keep = slide_spring(size, tau_c)
        share = share if held else 0.0
        swap = swap if held else 0.0
        keep = keep if held else 0.0
        e_x, b_x = share * e_x + swap * b_x, keep * b_x
        taken, lost = s_x * (p_x + e_x), s_x * (q_x + b_x)
        spent = p_x * p_x - e_x * e_x
        if not plane_case:
            e_y, b_y = share * e_y + swap * b_y, keep * b_y
            e_z, b_z = share * e_z + swap * b_z, keep * b_z
            taken += s_y * (p_y + e_y) + s_z * (p_z + e_z)
            lost += s_y * (q_y + b_y) + s_z * (q_z + b_z)
            spent += p_y * p_y - e_y * e_y + (p_z * p_z - e_z * e_z)
        taken = 0.5 * spent / k_s - hdt * taken if k_s > 0.0 else -hdt * taken
        taken = taken if share < 1.0 else 0.0

        # what is left for the books, for the next step, and for the two grains
        desk[D_DASH_N + l] = (first if drawn else 0.0) + (second if held else 0.0)
        desk[D_RELEASED_N + l] = (0.0 if drawn else first) + (0.0 if held else second)
        desk[D_DASH_S + l] = -hdt * lost
        desk[D_SLIDE + l] = taken if held else 0.0
        desk[D_RELEASED_S + l] = 0.0 if held else taken
        desk[D_STEP + l] = given
        desk[D_RATIO + l] = 0.5 * overlap / min(r_i, r_j) if touching else 0.0
        memory[M_SPRING_S + l], memory[M_DASH_S + l] = e_x, b_x
        if not plane_case:
            memory[M_SPRING_S + LANES + l], memory[M_SPRING_S + 2 * LANES + l] = e_y, e_z
            memory[M_DASH_S + LANES + l], memory[M_DASH_S + 2 * LANES + l] = b_y, b_z
        memory[M_DASH_N + l], memory[M_F_N + l] = d_n, f_n
        live = 1.0 if touching else 0.0
        memory[M_LIVE + l] = live
        if company:
            desk[D_WAS + l] = 1.0 if was else 0.0
            desk[D_CLOSING + l], desk[D_OVERLAP + l] = closing, overlap
            desk[D_NORMAL + l], desk[D_NORMAL + LANES + l], desk[D_NORMAL + 2 * LANES + l] = n_x, n_y, n_z
            desk[D_SLIDING_V + l] = s_x
            desk[D_SLIDING_V + LANES + l], desk[D_SLIDING_V + 2 * LANES + l] = s_y, s_z
            desk[D_SLIDES + l] = 1.0 if share < 1.0 else 0.0
        if plane_case:
            h = e_x + b_x
            h_x, h_y, h_z = h * n_z, 0.0, -h * n_x
            t_x, t_y, t_z = 0.0, h, 0.0
        else:
            h_x, h_y, h_z = e_x + b_x, e_y + b_y, e_z + b_z
            t_x, t_y, t_z = n_y * h_z - n_z * h_y, n_z * h_x - n_x * h_z, n_x * h_y - n_y * h_x
        desk[D_FORCE + 4 * l], desk[D_FORCE + 4 * l + 1] = h_x - f_n * n_x, h_y - f_n * n_y
        desk[D_FORCE + 4 * l + 2], desk[D_FORCE + 4 * l + 3] = h_z - f_n * n_z, 0.0
        desk[D_TORQUE_I + 4 * l], desk[D_TORQUE_I + 4 * l + 1] = a_i * t_x, a_i * t_y
        desk[D_TORQUE_I + 4 * l + 2], desk[D_TORQUE_I + 4 * l + 3] = a_i * t_z, live
        desk[D_TORQUE_J + 4 * l], desk[D_TORQUE_J + 4 * l + 1] = a_j * t_x, a_j * t_y
        desk[D_TORQUE_J + 4 * l + 2], desk[D_TORQUE_J + 4 * l + 3] = a_j * t_z, live


@kernel(fastmath=FAST, forceinline=True)
def hand_out(m: int, i_of: Any, to: Any, desk: Any, f: Any, sums: Any) -> int:
    """Add the first m lanes to their grains and to the books; returns the lane of a larger overlap, or -1.

    Lanes are added one by one in the order of the list, so that a lane that does not touch (all zeros) changes
    no bit, and sums do not know which pairs were near without touching.

    Parameters
    ----------
    i_of, to : rows of `f` of the two grains of each lane; a partner of another block has a row of its own.
    f : force [N], nothing, torque [N m] and contacts of each row, shape (rows, 8).
    sums : the six books of `desk` [J], then the largest ratio of overlap [-].
    """
    dash_n, dash_s, slide = sums[0], sums[1], sums[2]
    released_n, released_s, step, most = sums[3], sums[4], sums[5], sums[6]
    where = -1
    for l in range(m):
        i, j = i_of[l], to[l]
        for k in range(4):
            f[i, k] += desk[D_FORCE + 4 * l + k]
        for k in range(4):
            f[i, 4 + k] += desk[D_TORQUE_I + 4 * l + k]
        for k in range(4):
            f[j, k] -= desk[D_FORCE + 4 * l + k]
        for k in range(4):
            f[j, 4 + k] += desk[D_TORQUE_J + 4 * l + k]
        dash_n += desk[D_DASH_N + l]
        dash_s += desk[D_DASH_S + l]
        slide += desk[D_SLIDE + l]
        released_n += desk[D_RELEASED_N + l]
        released_s += desk[D_RELEASED_S + l]
        step += desk[D_STEP + l]
        if desk[D_RATIO + l] > most:
            most, where = desk[D_RATIO + l], l
    sums[0], sums[1], sums[2] = dash_n, dash_s, slide
    sums[3], sums[4], sums[5], sums[6] = released_n, released_s, step, most
    return where
