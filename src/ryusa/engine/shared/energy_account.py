"""The energy account and the extremes of an engine: opened, read back from a state, summed.

`stats` and `books` have a row for each block (columns of block_statistics.py and of model.tally.Book).
"""

import numpy as np

from ryusa.engine.shared import block_statistics as S
from ryusa.laws.rolling import epsd_stiffness, reduced_radius
from ryusa.model import Scene, State, Tally
from ryusa.model.enums import Rolling
from ryusa.model.scene import Floats
from ryusa.model.tally import N_BOOK, Book

_MANY = 256  # grains from which work is cut into blocks
_BLOCKS = 4, 32  # at least and at most; in between one for 2048 grains, a power of two
N_ACCOUNT = 24  # doubles of the account of a block: whole cache lines
_SUMS = (S.KINETIC, S.SPIN, S.POTENTIAL, S.SPRING_N, S.SPRING_S, S.SPRING_R, S.N_CONTACT)


def begin_account(scene: Scene, state: State, stats: Floats, books: Floats) -> None:
    """Write what grains hold before the first step, which adds springs of pairs that begin in touch."""
    spin = state.omega if scene.rotation else np.zeros_like(state.omega)
    stats[0, S.KINETIC] = 0.5 * np.sum((scene.m + scene.m_added)[:, None] * state.v**2)
    stats[0, S.SPIN] = 0.5 * np.sum(scene.inertia[:, None] * spin**2)
    stats[0, S.POTENTIAL] = potential_energy(scene, state)
    stats[0, S.SPEED_MAX] = np.sqrt(np.sum(state.v**2, axis=1).max(initial=0.0))
    stats[0, S.SPIN_MAX] = np.sqrt(np.sum(spin**2, axis=1).max(initial=0.0))
    books[0, Book.START] = stats[0, [S.KINETIC, S.SPIN, S.POTENTIAL]].sum()


def enter_start(stats: Floats, books: Floats) -> None:
    """Book as given at the start what is held after the first step, springs included."""
    books[0, Book.START] = float(sum(stats[:, column].sum() for column in _SUMS[:-1]))


def read_account(state: State, stats: Floats, books: Floats) -> None:
    """Take over the account and the extremes of a snapshot, also one cut into other blocks.

    Raises
    ------
    ValueError : a count, a grain or a step of the snapshot that cannot be.
    """
    own, columns = state.engine, state.books.shape[1]
    limits = {
        "overlap_grain": (-1.0, len(state.x) - 1.0),
        "overlap_step": (0.0, float(state.step)),
        f"sum_{S.N_CONTACT}": (0.0, 2.0**53),
    }
    for name, (least, most) in limits.items():
        value = own.get(name, least)
        if not least <= value <= most:
            raise ValueError(f"{name} = {value:g} in the snapshot: between {least:g} and {most:g}")
    if state.books.shape == books.shape:
        books[:] = state.books
    else:
        books[0, :columns] = state.books.sum(axis=0)
    stats[:, S.PENDING] = books[:, N_BOOK : N_BOOK + len(S.PENDING)]
    books[:, N_BOOK:] = 0.0
    stats[:, S.OVERLAP_MAX] = own.get("overlap_max", 0.0)
    stats[:, S.OVERLAP_GRAIN] = own.get("overlap_grain", -1.0)
    stats[:, S.OVERLAP_STEP] = own.get("overlap_step", 0.0)
    stats[:, S.SPEED_MAX], stats[:, S.SPIN_MAX] = own.get("speed_max", 0.0), own.get("spin_max", 0.0)
    for column in _SUMS:
        stats[0, column] = own.get(f"sum_{column}", 0.0)


def extremes_of(stats: Floats) -> dict[str, float]:
    """Extremes and sums, by the names that a snapshot keeps them under."""
    block = int(stats[:, S.OVERLAP_MAX].argmax())
    own = {"speed_max": float(stats[:, S.SPEED_MAX].max()), "spin_max": float(stats[:, S.SPIN_MAX].max())}
    own["overlap_max"] = float(stats[block, S.OVERLAP_MAX])
    own["overlap_grain"] = float(stats[block, S.OVERLAP_GRAIN])
    own["overlap_step"] = float(stats[block, S.OVERLAP_STEP])
    return own | {f"sum_{column}": float(stats[:, column].sum()) for column in _SUMS}


def tally_of(t: float, stats: Floats, books: Floats) -> Tally:
    """Energy account and extremes at time t [s]."""
    own = extremes_of(stats)
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


def potential_energy(scene: Scene, state: State) -> float:
    """Energy of weight and buoyancy at a state [J], from the origin, periods crossed added."""
    x = np.array(state.x)
    for a in range(2):
        if np.isfinite(scene.period[a]) and len(state.image) == len(x):
            x[:, a] += state.image[:, a] * scene.period[a]
    return -float(np.sum(scene.m_weight[:, None] * x * scene.gravity))


def rolling_energy(scene: Scene, state: State, places: np.ndarray) -> float:
    """Energy in the rolling springs of some of a state's contacts [J]."""
    if scene.rolling.model != Rolling.EPSD:
        return 0.0
    r = 0.5 * np.concatenate([scene.d, scene.d_fixed, np.full(scene.n_plane, np.inf)])
    energy = 0.0
    for place in places:
        radius = reduced_radius(float(r[state.contacts.i[place]]), float(r[state.contacts.j[place]]))
        f = scene.rolling.coefficient * radius
        k_r = epsd_stiffness(scene.contact.k_n, f, scene.rolling.stiffness_factor)
        energy += 0.5 * float(np.sum(state.contacts.spring_r[place] ** 2)) / k_r if k_r > 0.0 else 0.0
    return energy


def energy_of_change(before: Scene, scene: Scene, state: State, dropped: np.ndarray) -> float:
    """Energy a change of the timeline gives [J]: height on a new slope, spin locked, springs let go.

    `dropped` are the places of contacts that the change takes away.
    """
    given = potential_energy(scene, state) - potential_energy(before, state)
    if before.rotation and not scene.rotation:
        given -= float(0.5 * np.sum(scene.inertia[:, None] * state.omega**2))
        given -= rolling_energy(before, state, np.arange(len(state.contacts)))
    elif len(dropped):
        given -= rolling_energy(before, state, dropped)
    if len(dropped):
        law, gone = before.contact, state.contacts
        e_n = gone.f_n[dropped] - gone.dash_n[dropped]
        given -= float(np.sum(0.5 * e_n**2 / law.k_n))
        if law.k_s > 0.0:
            given -= float(np.sum(0.5 * gone.spring_s[dropped] ** 2 / law.k_s))
    return given


def blocks_of(n: int) -> int:
    """Into how many blocks the work on n grains is cut; never by the number of threads.

    Thin blocks have many pairs with their neighbours, which cost more.
    """
    least, most = _BLOCKS
    return 1 if n < _MANY else int(min(max(2.0 ** round(np.log2(n / 2048)), least), most))
