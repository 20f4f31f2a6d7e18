"""Motion of one block of grains, each moved by whole registers: the laws take all components at once.

What is fourth in a row stays what it is: the radius behind a position or a spin.
"""
# ruff: noqa: F403, F405  (the places of lanes.py and the columns of rows.py, all of them plain integers)

import math
from typing import Any

from ryusa.engine.cpu.arrays import Grains, Pairs
from ryusa.engine.cpu.batch_layout import *
from ryusa.engine.cpu.fluid_forces import close_interval, push_of_water, work_of_water
from ryusa.engine.cpu.simd.vec4 import add4, four_of, part, read4, spread4, with_last, write4
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.rows import *
from ryusa.laws.motion import acceleration, acceleration_spin, semi_implicit


@inner(fastmath=FAST, forceinline=True)
def square_of(row: Any) -> float:
    """Square of the length of a vector, the first three of a row."""
    x, y, z = part(row, 0), part(row, 1), part(row, 2)
    return x * x + y * y + z * z


@inner(fastmath=FAST, forceinline=True)
def product_of(a: Any, b: Any) -> float:
    """Scalar product of two vectors, the first three of a row."""
    return part(a, 0) * part(b, 0) + part(a, 1) * part(b, 1) + part(a, 2) * part(b, 2)


@inner(fastmath=FAST, forceinline=True)
def fetch(i: int, near: Any, incoming: Any, incoming_start: Any, f: Any, film: Any) -> None:
    """Add to the forces on grain i what other blocks stored for it; `film` may be empty."""
    for k in range(incoming_start[i], incoming_start[i + 1]):
        q = incoming[k]
        if near[q]:
            add4(f, 8 * i, f, 8 * q)
            add4(f, 8 * i + 4, f, 8 * q + 4)
            spread4(f, 8 * q, 0.0)
            spread4(f, 8 * q + 4, 0.0)
            if len(film):
                add4(film, 4 * i, film, 4 * q)
                spread4(film, 4 * q, 0.0)


@inner(fastmath=FAST, forceinline=True)
def height_of(i: int, c: Any, x: Any, image: Any) -> float:
    """Height of grain i along gravity, times gravity [m2/s2], the periods it crossed counted."""
    y_x, y_y = x[i, 0], x[i, 1]
    if image[i, 0] != 0:
        y_x += image[i, 0] * c[C_PERIOD_X]
    if image[i, 1] != 0:
        y_y += image[i, 1] * c[C_PERIOD_Y]
    return c[C_G_X] * y_x + c[C_G_Y] * y_y + c[C_G_Z] * x[i, 2]


@inner(fastmath=FAST, forceinline=True)
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
    x, v, w, then, ids, image = grains.x, grains.v, grains.w, grains.then, grains.ids, grains.image
    m_all, m_bare, m_weight, inertia = grains.m, grains.m_bare, grains.m_weight, grains.inertia
    per_m, per_inertia = grains.per_m, grains.per_inertia
    f, near, incoming, incoming_start = pairs.f, pairs.near, pairs.incoming, pairs.incoming_start
    dt, film, touched = c[C_DT], grains.film, grains.touched
    half = 0.0 if begins else 0.5 * dt
    speed_2 = spin_2 = stray_2 = 0.0
    gravity = four_of(c[C_G_X], 0.0 if kind.plane_case else c[C_G_Y], c[C_G_Z], 0.0)
    close_interval(book, now)
    if last:
        now[N_KINETIC] = now[N_SPIN] = now[N_POTENTIAL] = 0.0
    for i in range(lo, hi):
        fetch(i, near, incoming, incoming_start, f, film)
        push, turn = read4(f, 8 * i), read4(f, 8 * i + 4)
        spread4(f, 8 * i, 0.0)
        spread4(f, 8 * i + 4, 0.0)
        if kind.rolling or kind.events:
            touched[i] = int(part(turn, 3))
        place, before, spin = read4(x, 4 * i), read4(v, 8 * i), read4(w, 8 * i)
        drag, inverse = four_of(0.0, 0.0, 0.0, 0.0), per_m[i]
        if water is not None:
            write4(table, M_PUSH, push)
            write4(table, M_TURN, turn)
            table[M_ADDED] = m_all[i] - m_bare[i]
            push_of_water(kind, choice, i, c, grains, table)
            push, turn, drag = read4(table, M_PUSH), read4(table, M_TURN), read4(table, M_DRAG)
            inverse = 1.0 / (m_bare[i] + table[M_ADDED])
        a = acceleration(push, drag, m_weight[i] * gravity, inverse)
        place, after = semi_implicit(place, before, a, dt)
        whirl = spin
        if kind.rotation:  # the count of contacts, fourth, turns nothing
            whirl = spin + dt * acceleration_spin(with_last(turn, 0.0), per_inertia[i])
        if water is not None:
            write4(table, M_V, before)
            write4(table, M_V_NEW, after)
            write4(table, M_W, spin)
            write4(table, M_W_NEW, whirl)
            work_of_water(kind, choice, i, half, c, grains, table, book, now)
        if last:
            now[N_KINETIC] += 0.5 / inverse * product_of(before, after)
            now[N_SPIN] += 0.5 * inertia[i] * product_of(spin, whirl) if kind.rotation else 0.0
            now[N_POTENTIAL] -= m_weight[i] * height_of(i, c, x, image)
        write4(x, 4 * i, place)
        write4(v, 8 * i, after)
        fast, fast_spin = square_of(after), 0.0
        if kind.rotation:
            write4(w, 8 * i, whirl)
            fast_spin = square_of(whirl)
        if not fast + fast_spin < math.inf and now[N_FAULT] == FAULT_NONE:
            now[N_FAULT], now[N_FAULT_GRAIN], now[N_FAULT_PARTNER] = FAULT_NOT_A_NUMBER, ids[i], -1
        speed_2, spin_2 = max(speed_2, fast), max(spin_2, fast_spin)
        stray_2 = max(stray_2, square_of(after - read4(then, 4 * i)))
    now[N_SPEED_MAX], now[N_SPIN_MAX] = math.sqrt(speed_2), math.sqrt(spin_2)
    now[N_STRAY_MAX] = math.sqrt(stray_2)
    now[N_FAULT_SHOWN], now[N_ENDED_SHOWN] = now[N_FAULT], now[N_N_ENDED]
