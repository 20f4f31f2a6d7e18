"""The forces of the water in the motion of a grain: added to its own, their work booked, their impulse kept.

Vectors are rows of four doubles; what is fourth in a row is nothing.
"""
# ruff: noqa: E741  (l is a lane)

from functools import cache
from typing import Any

from ryusa.engine.cpu import fluid_layout as W
from ryusa.engine.cpu.simd.vec4 import fill4, read4, vec4_of, with_fourth, write4
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.laws.grain_step import impulse_from_fluid, resisted_torque, work_of_force
from ryusa.model.tally import Term

B_DRAG, B_TORQUE, B_LIFT, B_FLOW = int(Term.DRAG), int(Term.TORQUE), int(Term.LIFT), int(Term.FLOW)
B_FILM = int(Term.FILM)


@inner(fastmath=FAST, forceinline=True)
def begin_fluid_work(batch: Any) -> None:
    """Set the work of the water on a block to zero."""
    for place in range(W.WORK, W.SIZE):
        batch[place] = 0.0


@cache
def make_add_fluid(column: bool, films: bool, torque: bool) -> Any:
    """Build add_fluid(i, l, push, turn, film, batch) for what the scene has."""

    @inner(fastmath=FAST, forceinline=True)
    def add_fluid(i: int, l: int, push: Any, turn: Any, film: Any, batch: Any) -> tuple[Any, Any, Any]:
        """Force and torque on grain i, on lane l, with those of the water; and the drag."""
        drag = batch[W.K_D + l] * with_fourth(read4(batch, W.SLIP + 4 * l), 0.0)
        if column:
            push = push + (read4(batch, W.LIFT + 4 * l) + read4(batch, W.FLOW + 4 * l))
        if films:
            push = push + read4(film, 4 * i)
        if torque:
            turn = resisted_torque(turn, batch[W.K_T + l], read4(batch, W.SPIN + 4 * l))
        return push, turn, drag

    return add_fluid


@inner(fastmath=FAST, forceinline=True)
def _book(at: int, before: float, after: float, f: Any, v: Any, v_new: Any, batch: Any) -> None:
    """Add the work of a force in both half intervals."""
    done, pending = work_of_force(before, after, f, v, v_new)
    write4(batch, at, read4(batch, at) + done)
    write4(batch, at + 4, read4(batch, at + 4) + pending)


@cache
def make_book_fluid_work(column: bool, films: bool, torque: bool) -> Any:
    """Build book_fluid_work for what the scene has."""

    @inner(fastmath=FAST, forceinline=True)
    def book_fluid_work(
        i: int, l: int, half: float, dt: float, before: Any, after: Any, spin: Any, whirl: Any, impulse: Any,
        film: Any, batch: Any,
    ) -> None:  # fmt: skip
        """Book the work of the water on grain i, on lane l, and the impulse that the water owes.

        `half` is half a step [s], or nothing in the first; velocity `before` and `after` the step [m/s],
        `spin` and `whirl` likewise [rad/s]. Films are emptied.
        """
        later = 0.5 * dt
        drag = batch[W.K_D + l] * with_fourth(read4(batch, W.SLIP + 4 * l), 0.0)
        _book(W.DRAG_WORK, half, later, drag, before, after, batch)
        if column:
            lift, flow = read4(batch, W.LIFT + 4 * l), read4(batch, W.FLOW + 4 * l)
            _book(W.LIFT_WORK, half, later, lift, before, after, batch)
            _book(W.FLOW_WORK, half, later, flow, before, after, batch)
            a_water = vec4_of(batch[W.A_X + l], 0.0, 0.0, 0.0)
            given = impulse_from_fluid(drag, lift, batch[W.ADDED + l], a_water, before, after, dt)
            write4(impulse, 4 * i, with_fourth(read4(impulse, 4 * i) + given, batch[W.K_D + l]))
        if films:
            _book(W.FILM_WORK, half, later, read4(film, 4 * i), before, after, batch)
            fill4(film, 4 * i, 0.0)
        if torque:  # k_t times the spin against the water
            resistance = batch[W.K_T + l] * read4(batch, W.SPIN + 4 * l)
            _book(W.TORQUE_WORK, half, later, resistance, spin, whirl, batch)

    return book_fluid_work


@inner(fastmath=FAST)
def _total(batch: Any, at: int) -> float:
    return batch[at] + batch[at + 1] + batch[at + 2]


@inner(fastmath=FAST)
def end_fluid_work(batch: Any, account: Any, stats: Any) -> None:
    """Add the work of the water on a block to its account."""
    account[B_DRAG] += _total(batch, W.DRAG_WORK)
    account[B_LIFT] += _total(batch, W.LIFT_WORK)
    account[B_FLOW] += _total(batch, W.FLOW_WORK)
    account[B_FILM] -= _total(batch, W.FILM_WORK)
    account[B_TORQUE] -= _total(batch, W.TORQUE_WORK)
    stats[S.PENDING_DRAG] += _total(batch, W.DRAG_WORK + 4)
    stats[S.PENDING_LIFT] += _total(batch, W.LIFT_WORK + 4)
    stats[S.PENDING_FLOW] += _total(batch, W.FLOW_WORK + 4)
    stats[S.PENDING_FILM] += _total(batch, W.FILM_WORK + 4)
    stats[S.PENDING_TORQUE] -= _total(batch, W.TORQUE_WORK + 4)
