"""Motion of one block of grains: a batch at a time laid on the table, moved there by vector instructions.

Force, velocity and position lie on the table component by component, so that one loop moves all of them and
no number has to change its lane. What is fourth in a row stays: the radius behind a position or a spin.
"""
# ruff: noqa: E741, F403, F405  (l is a lane; the places of lanes.py and the columns of rows.py, all of them plain integers)

import math
from typing import Any

from ryusa.engine._kernel import FAST, kernel
from ryusa.engine.arrays import Grains, Pairs
from ryusa.engine.four import add4, copy4, spread4
from ryusa.engine.lanes import *
from ryusa.engine.rows import *
from ryusa.engine.wet import close_interval, push_of_water, work_of_water
from ryusa.laws.motion import acceleration, acceleration_spin, semi_implicit


@kernel(fastmath=FAST, forceinline=True)
def fetch(
    kind: Variant, first: int, m: int, grains: Grains, near: Any, incoming: Any,
    incoming_start: Any, f: Any, x: Any, v: Any, w: Any, table: Any,
) -> None:  # fmt: skip
    """Lay grains first..first+m-1 on the table with all forces on them, also what other blocks stored."""
    m_all, m_bare, m_weight, inertia = grains.m, grains.m_bare, grains.m_weight, grains.inertia
    for l in range(m):
        i = first + l
        copy4(table, M_PUSH + 4 * l, f, 8 * i)
        copy4(table, M_TURN + 4 * l, f, 8 * i + 4)
        spread4(f, 8 * i, 0.0)
        spread4(f, 8 * i + 4, 0.0)
        for k in range(incoming_start[i], incoming_start[i + 1]):
            q = incoming[k]
            if near[q]:
                add4(table, M_PUSH + 4 * l, f, 8 * q)
                add4(table, M_TURN + 4 * l, f, 8 * q + 4)
                spread4(f, 8 * q, 0.0)
                spread4(f, 8 * q + 4, 0.0)
                if kind.film:
                    add4(grains.film, 4 * i, grains.film, 4 * q)
                    spread4(grains.film, 4 * q, 0.0)
        if kind.rolling or kind.events:
            grains.touched[i] = int(table[M_TURN + 4 * l + 3])
        copy4(table, M_X + 4 * l, x, 4 * i)
        copy4(table, M_V + 4 * l, v, 8 * i)
        copy4(table, M_W + 4 * l, w, 8 * i)
        spread4(table, M_DRAG + 4 * l, 0.0)
        spread4(table, M_MASS + 4 * l, m_bare[i])
        spread4(table, M_ADDED + 4 * l, m_all[i] - m_bare[i])
        spread4(table, M_WEIGHT + 4 * l, m_weight[i])
        spread4(table, M_INERTIA + 4 * l, inertia[i])
        table[M_INERTIA + 4 * l + 3] = math.inf  # the count of contacts turns nothing
    for l in range(m, MOVERS):  # lanes without a grain
        for group in (M_X, M_V, M_W, M_PUSH, M_TURN, M_DRAG, M_ADDED, M_WEIGHT):
            spread4(table, group + 4 * l, 0.0)
        spread4(table, M_MASS + 4 * l, 1.0)
        spread4(table, M_INERTIA + 4 * l, 1.0)


@kernel(fastmath=FAST)
def advance(rotation: int, dt: float, table: Any) -> None:
    """Velocities, positions and spins a step later, of every lane."""
    for k in range(4 * MOVERS):
        a = acceleration(
            table[M_PUSH + k], table[M_DRAG + k], table[M_WEIGHT + k] * table[M_GRAVITY + k],
            table[M_MASS + k], table[M_ADDED + k],
        )  # fmt: skip
        table[M_X + k], table[M_V_NEW + k] = semi_implicit(table[M_X + k], table[M_V + k], a, dt)
        if rotation:
            table[M_W_NEW + k] = table[M_W + k] + dt * acceleration_spin(
                table[M_TURN + k], table[M_INERTIA + k]
            )


@kernel(fastmath=FAST)
def energies(kind: Variant, first: int, m: int, c: Any, grains: Grains, table: Any, now: Any) -> None:
    """Add energies [J] of grains first..first+m-1; the arrays still hold where they were before the step."""
    x, inertia, m_weight, image = grains.x, grains.inertia, grains.m_weight, grains.image
    for l in range(m):
        i = first + l
        along = whirl = height = 0.0
        for k in range(3):
            along += table[M_V + 4 * l + k] * table[M_V_NEW + 4 * l + k]
            if kind.rotation:
                whirl += table[M_W + 4 * l + k] * table[M_W_NEW + 4 * l + k]
        y_x, y_y = x[i, 0], x[i, 1]
        if image[i, 0] != 0:
            y_x += image[i, 0] * c[C_PERIOD_X]
        if image[i, 1] != 0:
            y_y += image[i, 1] * c[C_PERIOD_Y]
        height = c[C_G_X] * y_x + c[C_G_Y] * y_y + c[C_G_Z] * x[i, 2]
        now[N_KINETIC] += 0.5 * (table[M_MASS + 4 * l] + table[M_ADDED + 4 * l]) * along
        now[N_SPIN] += 0.5 * inertia[i] * whirl
        now[N_POTENTIAL] -= m_weight[i] * height


@kernel(fastmath=FAST, forceinline=True)
def motion(
    kind: Variant,
    water: int | None,
    choice: Choice,
    lo: int,
    hi: int,
    begins: bool,
    last: bool,
    c: Any,
    grains: Grains,
    pairs: Pairs,
    table: Any,
    book: Any,
    now: Any,
) -> None:
    """Gather what other blocks stored, add water and weight, and move grains lo..hi-1 by one step."""
    x, v, w, ids = grains.x, grains.v, grains.w, grains.ids
    f, near, incoming, incoming_start = pairs.f, pairs.near, pairs.incoming, pairs.incoming_start
    dt = c[C_DT]
    half = 0.0 if begins else 0.5 * dt
    speed_2 = spin_2 = 0.0
    for l in range(MOVERS):
        table[M_GRAVITY + 4 * l], table[M_GRAVITY + 4 * l + 2] = c[C_G_X], c[C_G_Z]
        table[M_GRAVITY + 4 * l + 1] = 0.0 if kind.plane_case else c[C_G_Y]
        table[M_GRAVITY + 4 * l + 3] = 0.0
    close_interval(book, now)
    if last:
        now[N_KINETIC] = now[N_SPIN] = now[N_POTENTIAL] = 0.0
    for first in range(lo, hi, MOVERS):
        m = min(MOVERS, hi - first)
        fetch(kind, first, m, grains, near, incoming, incoming_start, f, x, v, w, table)
        if water is not None:
            push_of_water(kind, choice, first, m, c, grains, table)
        advance(kind.rotation, dt, table)
        if water is not None:
            work_of_water(kind, choice, first, m, half, c, grains, table, book, now)
        if last:
            energies(kind, first, m, c, grains, table, now)
        for l in range(m):
            i = first + l
            copy4(x, 4 * i, table, M_X + 4 * l)
            copy4(v, 8 * i, table, M_V_NEW + 4 * l)
            a_x, a_y, a_z = table[M_V_NEW + 4 * l], table[M_V_NEW + 4 * l + 1], table[M_V_NEW + 4 * l + 2]
            square = a_x * a_x + a_y * a_y + a_z * a_z
            whirl = 0.0
            if kind.rotation:
                copy4(w, 8 * i, table, M_W_NEW + 4 * l)
                b_x, b_y, b_z = table[M_W_NEW + 4 * l], table[M_W_NEW + 4 * l + 1], table[M_W_NEW + 4 * l + 2]
                whirl = b_x * b_x + b_y * b_y + b_z * b_z
            if not square + whirl < math.inf and now[N_FAULT] == FAULT_NONE:
                now[N_FAULT], now[N_FAULT_GRAIN], now[N_FAULT_PARTNER] = FAULT_NOT_A_NUMBER, ids[i], -1
            speed_2, spin_2 = max(speed_2, square), max(spin_2, whirl)
    now[N_SPEED_MAX], now[N_SPIN_MAX] = math.sqrt(speed_2), math.sqrt(spin_2)
    now[N_FAULT_SHOWN], now[N_ENDED_SHOWN] = now[N_FAULT], now[N_N_ENDED]
