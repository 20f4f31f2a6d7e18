"""The energy account and extremes of every engine: begun, read back, told.

`now` and `books` have a row for each block (columns N_ of rows.py and of model.tally.Book).
"""

import numpy as np

from ryusa.engine.shared.numbers import potential_energy
from ryusa.engine.shared.rows import (
    N_KINETIC,
    N_N_CONTACT,
    N_OVERLAP_GRAIN,
    N_OVERLAP_MAX,
    N_OVERLAP_STEP,
    N_POTENTIAL,
    N_SPEED_MAX,
    N_SPIN,
    N_SPIN_MAX,
    N_SPRING_N,
    N_SPRING_R,
    N_SPRING_S,
    PENDING,
)
from ryusa.model import Book, Scene, State, Tally
from ryusa.model.scene import Floats
from ryusa.model.tally import N_BOOK

_SUMS = (N_KINETIC, N_SPIN, N_POTENTIAL, N_SPRING_N, N_SPRING_S, N_SPRING_R, N_N_CONTACT)


def begin_account(scene: Scene, state: State, now: Floats, books: Floats) -> None:
    """Write what grains hold before the first step, which adds springs of pairs that begin in touch."""
    spin = state.omega if scene.rotation else np.zeros_like(state.omega)
    now[0, N_KINETIC] = 0.5 * np.sum((scene.m + scene.m_added)[:, None] * state.v**2)
    now[0, N_SPIN] = 0.5 * np.sum(scene.inertia[:, None] * spin**2)
    now[0, N_POTENTIAL] = potential_energy(scene, state)
    now[0, N_SPEED_MAX] = np.sqrt(np.sum(state.v**2, axis=1).max(initial=0.0))
    now[0, N_SPIN_MAX] = np.sqrt(np.sum(spin**2, axis=1).max(initial=0.0))
    books[0, Book.START] = now[0, [N_KINETIC, N_SPIN, N_POTENTIAL]].sum()


def book_start(now: Floats, books: Floats) -> None:
    """Book as given at the start what is held after the first step, springs included."""
    books[0, Book.START] = float(sum(now[:, column].sum() for column in _SUMS[:-1]))


def read_account(state: State, now: Floats, books: Floats) -> None:
    """Take over the account and the extremes of a snapshot, also one cut into other blocks.

    Raises
    ------
    ValueError : a count, a grain or a step of the snapshot that cannot be.
    """
    own, columns = state.engine, state.books.shape[1]
    limits = {
        "overlap_grain": (-1.0, len(state.x) - 1.0),
        "overlap_step": (0.0, float(state.step)),
        f"sum_{N_N_CONTACT}": (0.0, 2.0**53),
    }
    for name, (least, most) in limits.items():
        value = own.get(name, least)
        if not least <= value <= most:
            raise ValueError(f"{name} = {value:g} in the snapshot: between {least:g} and {most:g}")
    if state.books.shape == books.shape:
        books[:] = state.books
    else:
        books[0, :columns] = state.books.sum(axis=0)
    now[:, PENDING] = books[:, N_BOOK : N_BOOK + len(PENDING)]
    books[:, N_BOOK:] = 0.0
    now[:, N_OVERLAP_MAX] = own.get("overlap_max", 0.0)
    now[:, N_OVERLAP_GRAIN] = own.get("overlap_grain", -1.0)
    now[:, N_OVERLAP_STEP] = own.get("overlap_step", 0.0)
    now[:, N_SPEED_MAX], now[:, N_SPIN_MAX] = own.get("speed_max", 0.0), own.get("spin_max", 0.0)
    for column in _SUMS:
        now[0, column] = own.get(f"sum_{column}", 0.0)


def extremes_of(now: Floats) -> dict[str, float]:
    """Extremes and sums, by the names that a snapshot keeps them under."""
    block = int(now[:, N_OVERLAP_MAX].argmax())
    own = {"speed_max": float(now[:, N_SPEED_MAX].max()), "spin_max": float(now[:, N_SPIN_MAX].max())}
    own["overlap_max"] = float(now[block, N_OVERLAP_MAX])
    own["overlap_grain"] = float(now[block, N_OVERLAP_GRAIN])
    own["overlap_step"] = float(now[block, N_OVERLAP_STEP])
    return own | {f"sum_{column}": float(now[:, column].sum()) for column in _SUMS}


def tally_of(t: float, now: Floats, books: Floats) -> Tally:
    """Energy account and extremes at time t [s]."""
    own = extremes_of(now)
    sums = [own[f"sum_{column}"] for column in _SUMS]
    return Tally(
        t=t,
        kinetic=sums[0],
        spin=sums[1],
        potential=sums[2],
        spring_n=sums[3],
        spring_s=sums[4],
        spring_r=sums[5],
        books=tuple(float(b) for b in books[:, :N_BOOK].sum(axis=0)),
        overlap_max=own["overlap_max"],
        overlap_grain=int(own["overlap_grain"]),
        overlap_step=int(own["overlap_step"]),
        speed_max=own["speed_max"],
        spin_max=own["spin_max"],
        n_contact=int(sums[6]),
    )
