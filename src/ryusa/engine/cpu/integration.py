"""Motion of one block of grains, each moved by whole registers: the laws take all components at once.

What is fourth in a row stays what it is: the radius behind a position or a spin.
"""
# ruff: noqa: E741  (l is a lane)

import math
from functools import cache
from typing import Any

from ryusa.compiled.function import compiled
from ryusa.compiled.piece import taken
from ryusa.engine.cpu import fluid_layout as W
from ryusa.engine.cpu.fluid_forces import make_forces_of_water
from ryusa.engine.cpu.fluid_work import (
    begin_fluid_work,
    end_fluid_work,
    make_add_fluid,
    make_book_fluid_work,
)
from ryusa.engine.cpu.simd.vec4 import add4, component, fill4, read4, vec4_of, with_fourth, write4
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.fluid import close_fluid_interval
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.status import FAULT_NONE, FAULT_NOT_A_NUMBER
from ryusa.engine.shared.variant import MotionKind
from ryusa.laws.grain_step import (
    kinetic_energy,
    potential_energy,
    rotation_step,
    translation_step,
    unwrapped,
)
from ryusa.model.tally import Term

STEP = int(Term.STEP)


@inner(fastmath=FAST, forceinline=True)
def inner_product(one: Any, other: Any) -> float:
    """Inner product of two vectors, the first three of their rows."""
    x, y, z = component(one, 0), component(one, 1), component(one, 2)
    return x * component(other, 0) + y * component(other, 1) + z * component(other, 2)


@inner(fastmath=FAST, forceinline=True)
def square_length(row: Any) -> float:
    """Square of the length of a vector, the first three of a row."""
    return inner_product(row, row)


@inner(fastmath=FAST, forceinline=True)
def kinetic_energy_of_row(m: float, before: Any, after: Any) -> float:
    """Kinetic energy [J] of a mass or a moment of inertia, its velocities the first three of a row."""
    return kinetic_energy(
        m, component(before, 0), component(before, 1), component(before, 2),
        component(after, 0), component(after, 1), component(after, 2),
    )  # fmt: skip


@inner(fastmath=FAST, forceinline=True)
def gather_incoming(i: int, active: Any, incoming: Any, incoming_start: Any, f: Any, film: Any) -> None:
    """Add to the forces on grain i what other blocks stored for it; `film` may be empty."""
    for k in range(incoming_start[i], incoming_start[i + 1]):
        q = incoming[k]
        if active[q]:
            add4(f, 8 * i, f, 8 * q)
            add4(f, 8 * i + 4, f, 8 * q + 4)
            fill4(f, 8 * q, 0.0)
            fill4(f, 8 * q + 4, 0.0)
            if len(film):
                add4(film, 4 * i, film, 4 * q)
                fill4(film, 4 * q, 0.0)


@cache
def make_integrate(kind: MotionKind) -> Any:
    """Build the piece that moves the grains of a block: integrate(lo, hi, begins, last, b, work, held)."""
    plane, rotation, counted = bool(kind.plane_case), bool(kind.rotation), bool(kind.counted)
    water, column, of_bodies, exact = bool(kind.water), bool(kind.column), bool(kind.bodies), bool(kind.exact)
    forces_of_water: Any = make_forces_of_water(column, kind.laws) if water else None
    add_fluid = make_add_fluid(column, bool(kind.film), kind.laws.torque != 0)
    book_fluid_work = make_book_fluid_work(column, bool(kind.film), kind.laws.torque != 0)

    @compiled(fastmath=FAST)
    def integrate(lo: int, hi: int, begins: bool, last: bool, b: int, work: Any, held: Any) -> None:
        """Gather what other blocks stored, add water and weight, and move grains lo..hi-1 by one step.

        With exact timing they get their velocities alone: they move after the shear of their contacts.
        """
        # One function: the state of a grain stays in registers. Members of bodies only gather
        held, work = taken(held), taken(work)
        c, grains, pairs, batch = held.c, held.grains, held.pairs, work.water
        account, stats = held.accounts.terms[b], held.accounts.stats[b]
        x = grains.x
        v = grains.v
        w = grains.w
        v_pruned = grains.v_pruned
        ids = grains.ids
        image = grains.image
        m_bare, m_weight, inertia = grains.m_bare, grains.m_weight, grains.inertia
        per_m, per_inertia = grains.per_m, grains.per_inertia
        f, active, incoming, incoming_start = pairs.f, pairs.active, pairs.incoming, pairs.incoming_start
        dt, film, n_touching = c[P.DT], grains.film, grains.n_touching
        half = 0.0 if begins else 0.5 * dt
        speed_2 = spin_2 = velocity_change_2 = work_before = work_after = 0.0
        gravity = vec4_of(c[P.G_X], 0.0 if plane else c[P.G_Y], c[P.G_Z], 0.0)
        close_fluid_interval(account, stats)
        if last:
            stats[S.KINETIC] = stats[S.SPIN] = stats[S.POTENTIAL] = 0.0
        if water:
            begin_fluid_work(batch)
        for i in range(lo, hi):
            l = (i - lo) % W.LANES
            if water and l == 0:
                forces_of_water(i, min(i + W.LANES, hi), c, grains, batch)
            gather_incoming(i, active, incoming, incoming_start, f, film)
            push, turn = read4(f, 8 * i), read4(f, 8 * i + 4)
            if counted:
                n_touching[i] = int(component(turn, 3))
            if of_bodies and held.bodies.member[ids[i]]:
                continue
            fill4(f, 8 * i, 0.0)
            fill4(f, 8 * i + 4, 0.0)
            x_new, before, spin = read4(x, 4 * i), read4(v, 8 * i), read4(w, 8 * i)
            pull, twist = push, turn
            drag, inverse = vec4_of(0.0, 0.0, 0.0, 0.0), per_m[i]
            if water:
                push, turn, drag = add_fluid(i, l, push, turn, film, batch)
                if column:
                    inverse = 1.0 / (m_bare[i] + batch[W.ADDED + l])
            x_new, after = translation_step(x_new, before, push, drag, m_weight[i] * gravity, inverse, dt)
            whirl = spin
            if rotation:  # the count of contacts, fourth, turns nothing
                whirl = rotation_step(spin, with_fourth(turn, 0.0), per_inertia[i], dt)
            if water:
                book_fluid_work(
                    i, l, half, dt, before, after, spin, whirl, grains.impulse, film,
                    batch,
                )  # fmt: skip
            if exact:
                work_before += inner_product(pull, before) + inner_product(twist, spin)
                work_after += inner_product(pull, after) + inner_product(twist, whirl)
            if last:
                stats[S.KINETIC] += kinetic_energy_of_row(1.0 / inverse, before, after)
                stats[S.SPIN] += kinetic_energy_of_row(inertia[i], spin, whirl) if rotation else 0.0
                stats[S.POTENTIAL] += potential_energy(
                    m_weight[i], c[P.G_X], c[P.G_Y], c[P.G_Z], unwrapped(x[i, 0], image[i, 0], c[P.PERIOD_X]),
                    unwrapped(x[i, 1], image[i, 1], c[P.PERIOD_Y]), x[i, 2],
                )  # fmt: skip
            if not exact:
                write4(x, 4 * i, x_new)
            write4(v, 8 * i, after)
            fast, fast_spin = square_length(after), 0.0
            if rotation:
                write4(w, 8 * i, whirl)
                fast_spin = square_length(whirl)
            if not fast + fast_spin < math.inf and stats[S.FAULT] == FAULT_NONE:
                stats[S.FAULT], stats[S.FAULT_GRAIN], stats[S.FAULT_PARTNER] = FAULT_NOT_A_NUMBER, ids[i], -1
            speed_2, spin_2 = max(speed_2, fast), max(spin_2, fast_spin)
            velocity_change_2 = max(velocity_change_2, square_length(after - read4(v_pruned, 4 * i)))
        if water:
            end_fluid_work(batch, account, stats)
        if exact:
            account[STEP] += half * work_before
            stats[S.PENDING_STEP] += 0.5 * dt * work_after
        stats[S.SPEED_MOVED], stats[S.SPIN_MAX] = math.sqrt(speed_2), math.sqrt(spin_2)
        stats[S.VELOCITY_CHANGE_MOVED] = math.sqrt(velocity_change_2)

    return integrate


@inner(fastmath=FAST)
def post(stats: Any) -> None:
    """Copy to where other threads read it what they need to know of a block that has moved.

    Between the two barriers of a step: a thread that is ahead may move its blocks before the first one, while
    another still reads what was posted in the step before.
    """
    stats[S.SPEED_MAX], stats[S.VELOCITY_CHANGE_MAX] = stats[S.SPEED_MOVED], stats[S.VELOCITY_CHANGE_MOVED]
    stats[S.FAULT_POSTED], stats[S.N_ENDED_POSTED] = stats[S.FAULT], stats[S.N_ENDED]
