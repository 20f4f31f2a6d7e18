"""Motion of one block of grains."""
# ruff: noqa: F403, F405  (the columns of rows.py, all of them plain integers)

import math
from typing import Any

from ryusa.engine._kernel import FAST, kernel
from ryusa.engine.arrays import Grains, Pairs
from ryusa.engine.rows import *
from ryusa.engine.wet import water_on, water_speed
from ryusa.laws.motion import acceleration, acceleration_spin, semi_implicit
from ryusa.laws.torque import torque_dennis, torque_stokes
from ryusa.model.enums import Above, WaterTorque
from ryusa.model.immersed import A_X, DRAG, EXTRA_X, EXTRA_Z, SHARE, SHEAR
from ryusa.model.resistance import drag_of
from ryusa.model.tally import Book

DRY = int(Above.DRY)
STOKES = int(WaterTorque.STOKES)
B_DRAG, B_TORQUE, B_LIFT, B_FLOW = int(Book.DRAG), int(Book.TORQUE), int(Book.LIFT), int(Book.FLOW)
B_FILM = int(Book.FILM)


@kernel(fastmath=FAST, forceinline=True)
def motion(
    kind: Variant,
    choice: Choice,
    lo: int,
    hi: int,
    crossing: int,
    first: bool,
    last: bool,
    c: Any,
    grains: Grains,
    pairs: Pairs,
    book: Any,
    now: Any,
) -> None:
    """Gather what other blocks stored, add water and weight, and move grains lo..hi-1 by one step."""
    plane_case, rotation = kind.plane_case, kind.rotation
    profile, above, drag, torque_law = choice.profile, choice.above, choice.drag, choice.torque
    film = kind.film
    column, seen, taken = kind.column, grains.seen, grains.taken
    x, v, w, m, inertia, ids = grains.x, grains.v, grains.w, grains.m, grains.inertia, grains.ids
    m_bare, m_weight, image = grains.m_bare, grains.m_weight, grains.image
    f, near, incoming, incoming_start = pairs.f, pairs.near, pairs.incoming, pairs.incoming_start
    dt, g_x, g_y, g_z = c[C_DT], c[C_G_X], c[C_G_Y], c[C_G_Z]
    half = 0.0 if first else 0.5 * dt
    speed_2 = spin_2 = kinetic = spin = potential = 0.0
    book[B_DRAG] += now[N_PEND_DRAG]
    book[B_TORQUE] += now[N_PEND_TORQUE]
    pend_drag = pend_torque = work_drag = work_torque = 0.0
    if column:
        book[B_LIFT] += now[N_PEND_LIFT]
        book[B_FLOW] += now[N_PEND_FLOW]
    if film:
        book[B_FILM] -= now[N_PEND_FILM]
    pend_lift = pend_flow = work_lift = work_flow = pend_film = work_film = 0.0
    for i in range(lo, hi):
        f_x, f_y, f_z = f[i, 0], f[i, 1], f[i, 2]
        t_x, t_y, t_z, hits = f[i, 4], f[i, 5], f[i, 6], f[i, 7]
        h_x = h_y = h_z = 0.0
        if film:
            h_x, h_y, h_z = grains.film[i, 0], grains.film[i, 1], grains.film[i, 2]
            grains.film[i, :] = 0.0
        for k in range(incoming_start[i], incoming_start[i + 1]):
            q = incoming[k]
            if near[q]:
                q += crossing
                f_x, f_y, f_z = f_x + f[q, 0], f_y + f[q, 1], f_z + f[q, 2]
                t_x, t_y, t_z, hits = t_x + f[q, 4], t_y + f[q, 5], t_z + f[q, 6], hits + f[q, 7]
                for a in range(8):
                    f[q, a] = 0.0
                if film:
                    h_x, h_y, h_z = (
                        h_x + grains.film[q, 0], h_y + grains.film[q, 1], h_z + grains.film[q, 2],
                    )  # fmt: skip
                    grains.film[q, :] = 0.0
        for a in range(8):
            f[i, a] = 0.0
        if kind.rolling or kind.events:
            grains.touched[i] = int(hits)

        v_x, v_y, v_z = v[i, 0], v[i, 1], v[i, 2]
        d_x = d_y = d_z = l_x = l_y = l_z = e_x = e_z = turn = 0.0
        wet = 1.0
        m_i, m_b, m_w = m[i], m_bare[i], m_weight[i]
        added = m_i - m_b
        if column:
            wet = seen[i, SHARE]
            dry = wet == 0.0
            added *= wet  # water moves along with what of a grain is in it
            e_x, e_z = seen[i, EXTRA_X] + added * seen[i, A_X], seen[i, EXTRA_Z]
            turn = 0.5 * seen[i, SHEAR]
            if not dry:
                k_d, d_x, d_y, d_z, l_x, l_y, l_z = water_on(choice, c, w[i, 3], seen[i], v[i], w[i])
                taken[i, DRAG] = k_d
        else:
            z = x[i, 2] - c[C_Z_ZERO]
            dry = profile == 0 or (above == DRY and z > c[C_DEPTH])
            if drag and not dry:
                u_x, u_y, u_z = water_speed(profile, above, z, c) - v_x, -v_y, -v_z
                slip = math.sqrt(u_x * u_x + u_y * u_y + u_z * u_z)
                k_d = drag_of(drag, slip, 2.0 * w[i, 3], c[C_NU], c[C_RHO_W], c[C_A_2], c[C_C_D])
                d_x, d_y, d_z = k_d * u_x, k_d * u_y, k_d * u_z
        if column:
            f_x, f_y, f_z = f_x + l_x + e_x, f_y + l_y, f_z + l_z + e_z
        if film:
            f_x, f_y, f_z = f_x + h_x, f_y + h_y, f_z + h_z
        y_x, y_z = x[i, 0], x[i, 2]
        x[i, 0], a_x = semi_implicit(x[i, 0], v_x, acceleration(f_x, d_x, m_w * g_x, m_b, added), dt)
        x[i, 2], a_z = semi_implicit(x[i, 2], v_z, acceleration(f_z, d_z, m_w * g_z, m_b, added), dt)
        a_y = v_y
        y_y = x[i, 1]
        if not plane_case:
            x[i, 1], a_y = semi_implicit(x[i, 1], v_y, acceleration(f_y, d_y, m_w * g_y, m_b, added), dt)
        v[i, 0], v[i, 1], v[i, 2] = a_x, a_y, a_z
        if column:
            if not dry:
                taken[i, 0] += dt * (d_x + l_x + added * seen[i, A_X]) - added * (a_x - v_x)
                taken[i, 1] += dt * (d_y + l_y) - added * (a_y - v_y)
                taken[i, 2] += dt * (d_z + l_z) - added * (a_z - v_z)
            work_lift += half * (l_x * v_x + l_y * v_y + l_z * v_z)
            pend_lift += 0.5 * dt * (l_x * a_x + l_y * a_y + l_z * a_z)
            work_flow += half * (e_x * v_x + e_z * v_z)
            pend_flow += 0.5 * dt * (e_x * a_x + e_z * a_z)
        if film:
            work_film += half * (h_x * v_x + h_y * v_y + h_z * v_z)
            pend_film += 0.5 * dt * (h_x * a_x + h_y * a_y + h_z * a_z)
        square = a_x * a_x + a_y * a_y + a_z * a_z
        if not square < math.inf and now[N_FAULT] == FAULT_NONE:
            now[N_FAULT], now[N_FAULT_GRAIN], now[N_FAULT_PARTNER] = FAULT_NOT_A_NUMBER, ids[i], -1
        speed_2 = max(speed_2, square)
        if drag:
            work_drag += half * (d_x * v_x + d_y * v_y + d_z * v_z)
            pend_drag += 0.5 * dt * (d_x * a_x + d_y * a_y + d_z * a_z)

        if rotation:
            o_x, o_y, o_z = w[i, 0], w[i, 1], w[i, 2]
            k_t = 0.0
            if torque_law and not dry:
                o_rel = o_y - turn
                size = math.sqrt(o_x * o_x + o_rel * o_rel + o_z * o_z)
                if torque_law == STOKES:
                    k_t = torque_stokes(size, 2.0 * w[i, 3], c[C_NU], c[C_RHO_W])
                else:
                    k_t = torque_dennis(size, 2.0 * w[i, 3], c[C_NU], c[C_RHO_W])
                k_t *= wet
            i_i = inertia[i]
            b_y = o_y + dt * acceleration_spin(t_y - k_t * (o_y - turn), i_i)
            b_x, b_z = o_x, o_z
            if not plane_case:
                b_x = o_x + dt * acceleration_spin(t_x - k_t * o_x, i_i)
                b_z = o_z + dt * acceleration_spin(t_z - k_t * o_z, i_i)
            w[i, 0], w[i, 1], w[i, 2] = b_x, b_y, b_z
            whirl = b_x * b_x + b_y * b_y + b_z * b_z
            if not whirl < math.inf and now[N_FAULT] == FAULT_NONE:
                now[N_FAULT], now[N_FAULT_GRAIN], now[N_FAULT_PARTNER] = FAULT_NOT_A_NUMBER, ids[i], -1
            spin_2 = max(spin_2, whirl)
            if torque_law:
                work_torque -= half * k_t * (o_x * o_x + (o_y - turn) * o_y + o_z * o_z)
                pend_torque -= 0.5 * dt * k_t * (o_x * b_x + (o_y - turn) * b_y + o_z * b_z)
            if last:
                spin += 0.5 * i_i * (o_x * b_x + o_y * b_y + o_z * b_z)
        if last:
            kinetic += 0.5 * (m_b + added if column else m_i) * (v_x * a_x + v_y * a_y + v_z * a_z)
            if image[i, 0] != 0:
                y_x += image[i, 0] * c[C_PERIOD_X]
            if image[i, 1] != 0:
                y_y += image[i, 1] * c[C_PERIOD_Y]
            potential -= m_w * (g_x * y_x + g_y * y_y + g_z * y_z)
    now[N_PEND_DRAG], now[N_PEND_TORQUE] = pend_drag, pend_torque
    book[B_DRAG] += work_drag
    book[B_TORQUE] += work_torque
    if column:
        now[N_PEND_LIFT], now[N_PEND_FLOW] = pend_lift, pend_flow
        book[B_LIFT] += work_lift
        book[B_FLOW] += work_flow
    if film:
        now[N_PEND_FILM] = pend_film
        book[B_FILM] -= work_film
    now[N_SPEED_MAX], now[N_SPIN_MAX] = math.sqrt(speed_2), math.sqrt(spin_2)
    now[N_FAULT_SHOWN], now[N_ENDED_SHOWN] = now[N_FAULT], now[N_N_ENDED]
    if last:
        now[N_KINETIC], now[N_SPIN], now[N_POTENTIAL] = kinetic, spin, potential
