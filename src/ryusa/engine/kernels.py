"""Contact forces of one block of grains: which pair, and in what order; every formula is a law.

Grains are cut into blocks by their number alone. A block adds both sides of its own pairs; where the partner
belongs to another block the other side is stored and added there after the barrier, in list order. So
sums and bits are the same for any number of threads.

Books are kept by velocity interval: at x(n) the velocity v(n-1/2) and the forces of steps n-1 and n give the
work u dt (f(n-1) + f(n))/2, exact for the scheme when kinetic energy is m v(n-1/2) v(n+1/2)/2.
"""
# ruff: noqa: F403, F405  (the columns of rows.py, all of them plain integers)

import math
from typing import Any

from ryusa.engine._kernel import FAST, kernel
from ryusa.engine.arrays import Grains, Pairs, Walls
from ryusa.engine.pair import (
    B_DASH_N,
    B_DASH_S,
    B_RELEASED_N,
    B_RELEASED_S,
    B_SLIDE,
    B_STEP,
    ROLL_PRINTED,
    begin_row,
    part,
    roll,
    wet_row,
)
from ryusa.engine.records import begin_record, end_record, keep_record
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
from ryusa.laws.immersed import lubrication_force
from ryusa.laws.rolling import reduced_radius
from ryusa.model.enums import Cap, Slip

SLIP_DROP, SLIP_TOTAL, CAP_TOTAL = int(Slip.SPRING_DROP), int(Slip.TOTAL), int(Cap.TOTAL)


@kernel(fastmath=FAST, forceinline=True)
def forces(
    kind: Variant,
    choice: Choice,
    lo: int,
    hi: int,
    n: int,
    n_solid: int,
    step: int,
    t: float,
    hdt: float,
    last: bool,
    c: Any,
    grains: Grains,
    walls: Walls,
    pairs: Pairs,
    q: int,
    ended: Any,
    book: Any,
    now: Any,
) -> None:
    """Forces of every pair owned by grains lo..hi-1; q is the first slot of the block in `pairs.react`."""
    plane_case, rotation, rolling, events, _, film = kind
    slip, cap, tension, width = choice.slip, choice.cap, choice.tension, pairs.mem.shape[1]
    x, v, w, r, m, inertia, ids = grains.x, grains.v, grains.w, grains.r, grains.m, grains.inertia, grains.ids
    f, torque, touches, touched = grains.f, grains.torque, grains.touches, grains.touched
    start, partners, live, mem = pairs.start, pairs.partners, pairs.live, pairs.mem
    react, react_touch = pairs.react, pairs.react_touch
    normals, points = walls.normals, walls.points
    dt, k_n, k_s, mu, cohesion = c[C_DT], c[C_K_N], c[C_K_S], c[C_MU], c[C_COHESION]
    l_x, l_y, limit = c[C_PERIOD_X], c[C_PERIOD_Y], c[C_OVERLAP_LIMIT]
    film_reach, near = c[C_FILM_REACH], False
    spring_n = spring_s = spring_r = 0.0
    step_given = dash_n_lost = dash_s_lost = slide_lost = released_n = released_s = 0.0
    most = now[N_OVERLAP_MAX]
    count = 0
    for i in range(lo, hi):
        x_i, y_i, z_i, r_i = x[i, 0], x[i, 1], x[i, 2], r[i]
        v_x, v_y, v_z = v[i, 0], v[i, 1], v[i, 2]
        o_x, o_y, o_z = w[i, 0], w[i, 1], w[i, 2]
        f_x = f_y = f_z = m_x = m_y = m_z = 0.0
        hits = 0
        for p in range(start[i], start[i + 1]):
            j = partners[p]
            cross = j < n and (j < lo or j >= hi)
            distance = overlap = 0.0
            if j >= n_solid:
                k = j - n_solid
                n_x, n_y, n_z = -normals[k, 0], -normals[k, 1], -normals[k, 2]
                distance = (
                    (points[k, 0] - x_i) * n_x + (points[k, 1] - y_i) * n_y + (points[k, 2] - z_i) * n_z
                )
                overlap = r_i - distance
                touching = overlap > 0.0
                if film:
                    near = overlap > -film_reach
            else:
                n_x, n_y, n_z = wrap(x[j, 0] - x_i, l_x), 0.0, x[j, 2] - z_i
                square = n_x * n_x + n_z * n_z
                if not plane_case:
                    n_y = wrap(x[j, 1] - y_i, l_y)
                    square += n_y * n_y
                reach = r_i + r[j]
                touching = square < reach * reach
                if film:
                    near = square < (reach + film_reach) * (reach + film_reach)
                if touching or live[p] or near:
                    distance = math.sqrt(square)
                    overlap = overlap_of(r_i, r[j], distance)
                    inverse = 1.0 / distance
                    n_x, n_y, n_z = n_x * inverse, n_y * inverse, n_z * inverse
            if not (touching or live[p] or near):
                if cross:
                    react_touch[q] = 0
                    q += 1
                continue

            # velocities at the contact point; u_x.. is the slip of i against j
            a_i = arm(r_i, overlap)
            a_j = distance - a_i
            if plane_case:
                u_x, u_z = v_x - v[j, 0], v_z - v[j, 2]
                closing = u_x * n_x + u_z * n_z
                s_x = u_x * n_z - u_z * n_x  # along the tangent (n_z, 0, -n_x)
                s_y = s_z = 0.0
                if rotation:
                    s_x += a_i * o_y + a_j * w[j, 1]
            else:
                u_x, u_y, u_z = v_x - v[j, 0], v_y - v[j, 1], v_z - v[j, 2]
                closing = u_x * n_x + u_y * n_y + u_z * n_z
                s_x, s_y, s_z = u_x - closing * n_x, u_y - closing * n_y, u_z - closing * n_z
                if rotation:
                    g_x, g_y, g_z = (
                        a_i * o_x + a_j * w[j, 0],
                        a_i * o_y + a_j * w[j, 1],
                        a_i * o_z + a_j * w[j, 2],
                    )
                    s_x += g_y * n_z - g_z * n_y
                    s_y += g_z * n_x - g_x * n_z
                    s_z += g_x * n_y - g_y * n_x
            row = mem[p]

            if live[p] and not touching:  # parted in this step
                part(
                    tension,
                    choice.rolling if rolling else 0,
                    row,
                    c,
                    hdt,
                    closing,
                    (s_x, s_y, s_z),
                    (o_x, o_y, o_z),
                    (w[j, 0], w[j, 1], w[j, 2]),
                    reduced_radius(r_i, r[j]),
                    book,
                )
                live[p] = 0
                if events and row[width - N_EVENT + E_J] >= 0.0:
                    end_record(
                        plane_case,
                        tension,
                        row[width - N_EVENT :],
                        row[R_F_N],
                        t,
                        overlap,
                        closing,
                        (s_x, s_y, s_z),
                        (n_x, n_y, n_z),
                        i,
                        v,
                        w,
                        ended,
                        now,
                    )
            if not touching:
                if film:
                    radius = reduced_radius(r_i, r[j])
                    f_n = lubrication_force(
                        -overlap, closing, radius, c[C_ASPERITY], film_reach, c[C_RHO_W], c[C_NU]
                    )
                    h_x, h_y, h_z = -f_n * n_x, -f_n * n_y, -f_n * n_z
                    grains.film[i, 0] += h_x
                    grains.film[i, 1] += h_y
                    grains.film[i, 2] += h_z
                    if cross:
                        react[q, 0], react[q, 1], react[q, 2] = h_x, h_y, h_z
                    elif j < n:
                        grains.film[j, 0] -= h_x
                        grains.film[j, 1] -= h_y
                        grains.film[j, 2] -= h_z
                if cross:
                    react_touch[q] = 2 * film
                    q += 1
                continue

            if not live[p]:
                live[p] = 1
                # the spring met within the step: what the half interval takes for it is not what it holds
                if hdt > 0.0:
                    step_given -= 0.5 * k_n * overlap * (2.0 * hdt * closing - overlap)
                begin_row(row, rotation, i, j, c, m, r, inertia)
                if choice.rebound:
                    wet_row(row, choice, closing, i, j, c, m, r)
                if events:
                    begin_record(
                        plane_case,
                        choice.events,
                        row[width - N_EVENT :],
                        t,
                        dt,
                        overlap,
                        closing,
                        (s_x, s_y, s_z),
                        (n_x, n_y, n_z),
                        i,
                        j,
                        n,
                        grains,
                        l_x,
                        l_y,
                    )

            # normal force
            e_n = k_n * overlap
            if tension:
                f_n = normal_force(overlap, closing, k_n, row[R_ETA_N])
            else:
                f_n = normal_force_no_tension(overlap, closing, k_n, row[R_ETA_N])
            held = tension or f_n > 0.0
            d_n = f_n - e_n
            if row[R_F_N] > 0.0 or tension:
                dash_n_lost += hdt * closing * row[R_DASH_N]
            else:
                released_n += hdt * closing * row[R_DASH_N]
            if held:
                dash_n_lost += hdt * closing * d_n
            else:
                released_n += hdt * closing * d_n

            # tangential force
            tau_c = shear_strength(f_n if cap == CAP_TOTAL else e_n, cohesion, mu)
            eta_s = row[R_ETA_S]
            p_x, p_y, p_z = row[R_SPRING_S], row[R_SPRING_S + 1], row[R_SPRING_S + 2]
            q_x, q_y, q_z = row[R_DASH_S], row[R_DASH_S + 1], row[R_DASH_S + 2]
            if not plane_case:
                twist = 0.0
                if rotation:
                    twist = 0.5 * dt * ((o_x + w[j, 0]) * n_x + (o_y + w[j, 1]) * n_y + (o_z + w[j, 2]) * n_z)
                p_x, p_y, p_z = turn(p_x, p_y, p_z, n_x, n_y, n_z, twist)
            e_x, d_x = p_x - k_s * s_x * dt, -eta_s * s_x
            e_y = e_z = d_y = d_z = 0.0
            if not plane_case:
                e_y, d_y = p_y - k_s * s_y * dt, -eta_s * s_y
                e_z, d_z = p_z - k_s * s_z * dt, -eta_s * s_z
            if slip == SLIP_TOTAL:
                g_x, g_y, g_z = e_x + d_x, e_y + d_y, e_z + d_z
            else:
                g_x, g_y, g_z = e_x, e_y, e_z
            size = abs(g_x) if plane_case else math.sqrt(g_x * g_x + g_y * g_y + g_z * g_z)
            if slip == SLIP_TOTAL:
                a, b, keep = slide_total(size, tau_c)
            elif slip == SLIP_DROP:
                a, b, keep = slide_spring_drop(size, tau_c)
            else:
                a, b, keep = slide_spring(size, tau_c)
            if not held:
                a = b = keep = 0.0
            e_x, d_x = a * e_x + b * d_x, keep * d_x
            if not plane_case:
                e_y, d_y = a * e_y + b * d_y, keep * d_y
                e_z, d_z = a * e_z + b * d_z, keep * d_z
            taken = -hdt * (s_x * (p_x + e_x))
            lost = -hdt * (s_x * (q_x + d_x))
            stored, energy = p_x * p_x, e_x * e_x
            if not plane_case:
                taken -= hdt * (s_y * (p_y + e_y) + s_z * (p_z + e_z))
                lost -= hdt * (s_y * (q_y + d_y) + s_z * (q_z + d_z))
                stored += p_y * p_y + p_z * p_z
                energy += e_y * e_y + e_z * e_z
            dash_s_lost += lost
            if a < 1.0:
                if k_s > 0.0:
                    taken += 0.5 * (stored - energy) / k_s
                if held:
                    slide_lost += taken
                else:
                    released_s += taken

            # sum up
            row[R_SPRING_S], row[R_DASH_S], row[R_DASH_N], row[R_F_N] = e_x, d_x, d_n, f_n
            if plane_case:
                h = e_x + d_x
                h_x, h_y, h_z = h * n_z, 0.0, -h * n_x
                t_x, t_y, t_z = 0.0, h, 0.0
            else:
                row[R_SPRING_S + 1], row[R_DASH_S + 1] = e_y, d_y
                row[R_SPRING_S + 2], row[R_DASH_S + 2] = e_z, d_z
                h_x, h_y, h_z = e_x + d_x, e_y + d_y, e_z + d_z
                t_x, t_y, t_z = n_y * h_z - n_z * h_y, n_z * h_x - n_x * h_z, n_x * h_y - n_y * h_x
            h_x, h_y, h_z = h_x - f_n * n_x, h_y - f_n * n_y, h_z - f_n * n_z
            ti_x, ti_y, ti_z = a_i * t_x, a_i * t_y, a_i * t_z
            tj_x, tj_y, tj_z = a_j * t_x, a_j * t_y, a_j * t_z
            if rolling:
                share_j = float(max(touched[j], 1)) if j < n else 1.0
                r_x, r_y, r_z, e_r = roll(
                    choice.rolling,
                    choice.arm,
                    row,
                    c,
                    f_n,
                    overlap,
                    hdt,
                    (r_i, m[i], inertia[i], float(max(touched[i], 1))),
                    (r[j], m[j], inertia[j], share_j),
                    (n_x, n_y, n_z),
                    (t_x, t_y, t_z),
                    (o_x, o_y, o_z),
                    (w[j, 0], w[j, 1], w[j, 2]),
                    book,
                )
                ti_x, ti_y, ti_z = ti_x + r_x, ti_y + r_y, ti_z + r_z
                if choice.rolling == ROLL_PRINTED:
                    tj_x, tj_y, tj_z = tj_x + r_x, tj_y + r_y, tj_z + r_z
                else:
                    tj_x, tj_y, tj_z = tj_x - r_x, tj_y - r_y, tj_z - r_z
                if last:
                    spring_r += e_r
            f_x, f_z = f_x + h_x, f_z + h_z
            m_y += ti_y
            if not plane_case:
                f_y += h_y
                m_x, m_z = m_x + ti_x, m_z + ti_z
            hits += 1
            if cross:
                react_touch[q] = 1
                react[q, 0], react[q, 1], react[q, 2] = h_x, h_y, h_z
                react[q, 3], react[q, 4], react[q, 5] = tj_x, tj_y, tj_z
                q += 1
            elif j < n:
                f[j, 0] -= h_x
                f[j, 2] -= h_z
                torque[j, 1] += tj_y
                if not plane_case:
                    f[j, 1] -= h_y
                    torque[j, 0] += tj_x
                    torque[j, 2] += tj_z
                touches[j] += 1

            # guards, records, account
            ratio = overlap / (2.0 * min(r_i, r[j]))
            if ratio > most:
                most = ratio
                now[N_OVERLAP_GRAIN], now[N_OVERLAP_STEP] = ids[i], step
                if ratio > limit and now[N_FAULT] == FAULT_NONE:
                    now[N_FAULT], now[N_FAULT_GRAIN] = FAULT_OVERLAP, ids[i]
                    now[N_FAULT_PARTNER] = ids[j] if j < n else j
            if events:
                keep_record(
                    row[width - N_EVENT :],
                    t,
                    dt,
                    overlap,
                    f_n,
                    e_n + row[R_ETA_N] * closing,
                    (h_x, h_y, h_z),
                    a < 1.0,
                    touched[i] > 1 or (j < n and touched[j] > 1),
                )
            if last:
                spring_n += 0.5 * e_n * overlap
                if k_s > 0.0:
                    spring_s += 0.5 * energy / k_s
                count += 1
        f[i, 0] += f_x
        f[i, 2] += f_z
        torque[i, 1] += m_y
        if not plane_case:
            f[i, 1] += f_y
            torque[i, 0] += m_x
            torque[i, 2] += m_z
        touches[i] += hits
    now[N_OVERLAP_MAX] = most
    book[B_STEP] += step_given
    book[B_DASH_N] += dash_n_lost
    book[B_DASH_S] += dash_s_lost
    book[B_SLIDE] += slide_lost
    book[B_RELEASED_N] += released_n
    book[B_RELEASED_S] += released_s
    if last:
        now[N_SPRING_N], now[N_SPRING_S], now[N_SPRING_R], now[N_N_CONTACT] = (
            spring_n,
            spring_s,
            spring_r,
            count,
        )
