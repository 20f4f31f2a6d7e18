"""The energy account and the extremes of an engine: opened, read back from a state, summed.

`stats` and `terms` have a row for each block (columns of block_statistics.py and of model.tally.Term).
"""

import numpy as np

from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared.contact_history import energies_of_springs, rolling_energy
from ryusa.model import EngineBlock, Scene, State, Tally
from ryusa.model.arrays import Bools, Floats
from ryusa.model.tally import HELD, N_TERM, Term

N_ACCOUNT = 24  # doubles of the account of a block: whole cache lines
_LARGEST = 1e100  # [J]
_SUMS = (S.KINETIC, S.SPIN, S.POTENTIAL, S.SPRING_N, S.SPRING_S, S.SPRING_R, S.N_CONTACT)


def begin_account(scene: Scene, state: State, stats: Floats, terms: Floats) -> None:
    """Write what grains hold before the first step, which adds springs of pairs that begin in touch."""
    spin = state.omega if scene.rotation else np.zeros_like(state.omega)
    m, inertia = (scene.m + scene.m_added)[:, None], scene.inertia[:, None]
    stats[0, S.KINETIC], stats[0, S.SPIN] = 0.5 * np.sum(m * state.v**2), 0.5 * np.sum(inertia * spin**2)
    if scene.bodies is not None and state.bodies is not None:
        alone, bodies, moved = _alone(scene), scene.bodies, state.bodies
        stats[0, S.KINETIC] = 0.5 * np.sum((m * state.v**2)[alone])
        whole = bodies.m + bodies.sums(scene.m_added[bodies.members])
        stats[0, S.KINETIC] += 0.5 * np.sum(whole[:, None] * moved.v**2)
        stats[0, S.SPIN] = 0.5 * np.sum((inertia * spin**2)[alone])
        stats[0, S.SPIN] += 0.5 * np.sum(moved.momentum * moved.spin(bodies))
    stats[0, S.POTENTIAL] = potential_energy(scene, state)
    stats[0, S.SPEED_MAX] = np.sqrt(np.sum(state.v**2, axis=1).max(initial=0.0))
    stats[0, S.SPIN_MAX] = np.sqrt(np.sum(spin**2, axis=1).max(initial=0.0))
    terms[0, Term.START] = stats[0, [S.KINETIC, S.SPIN, S.POTENTIAL]].sum()


def enter_start(stats: Floats, terms: Floats) -> None:
    """Term as given at the start what is held after the first step, springs included."""
    terms[0, Term.START] = float(sum(stats[:, column].sum() for column in _SUMS[:-1]))


def read_account(state: State, stats: Floats, terms: Floats, block: EngineBlock | None) -> None:
    """Continue the account and the extremes of a snapshot.

    Parameters
    ----------
    stats, terms : of this engine, a row for each of its blocks; filled.
    block : of the engine itself, with the account of each of its blocks; without one the sums of the
        snapshot go to the first block, which agrees to round-off.

    Raises
    ------
    ValueError : a count, a grain or a step of the snapshot is out of range.
    """
    tally = state.tally
    stats[:, S.OVERLAP_GRAIN] = -1.0
    if tally is None:
        return
    limits = {
        "overlap_grain": (-1, len(state.x) - 1),
        "overlap_step": (0, state.step),
        "n_contact": (0, 2**53),
    }
    for name, (least, most) in limits.items():
        value = getattr(tally, name)
        if not least <= value <= most:
            raise ValueError(f"{name} = {value} in the snapshot: must be {least} to {most}")
    if block is None:
        terms[0, :N_TERM], stats[0, S.PENDING] = tally.terms, tally.pending
    else:
        terms[:, :N_TERM] = block.array("work", (len(terms), N_TERM), _LARGEST)
        stats[:, S.PENDING] = block.array("pending", (len(terms), len(S.PENDING)), _LARGEST)
    stats[:, S.OVERLAP_MAX] = tally.overlap_max
    stats[:, S.OVERLAP_GRAIN], stats[:, S.OVERLAP_STEP] = tally.overlap_grain, tally.overlap_step
    stats[:, S.SPEED_MAX], stats[:, S.SPIN_MAX] = tally.speed_max, tally.spin_max
    stats[0, _SUMS] = (*(getattr(tally, name) for name in HELD), tally.n_contact)


def account_arrays(stats: Floats, terms: Floats) -> dict[str, Floats]:
    """The account of each block, for the block of an engine (`read_account`)."""
    return {"work": terms[:, :N_TERM].copy(), "pending": stats[:, S.PENDING].copy()}


def read_walls(state: State, walls: Floats, block: EngineBlock | None) -> None:
    """Continue the impulses on walls of a snapshot, (n_block, n_wall, N_IMPULSE).

    Parameters
    ----------
    walls : filled.
    block : as in `read_account`.

    Raises
    ------
    ValueError : their number is another.
    """
    if not walls.size or state.tally is None:
        return
    if block is None or "walls" not in block.arrays:
        found = np.array(state.tally.walls)
        walls[0] = found.reshape(walls.shape[1:]) if len(found) else 0.0
    else:
        walls[:] = block.array("walls", (len(walls), walls[0].size), _LARGEST).reshape(walls.shape)


def tally_of(t: float, stats: Floats, terms: Floats, walls: tuple[float, ...] = ()) -> Tally:
    """Energy account and extremes at time t [s]; `walls` as in `Tally`."""
    block = stats[int(stats[:, S.OVERLAP_MAX].argmax())]
    held = dict(zip(HELD, (float(stats[:, column].sum()) for column in _SUMS), strict=False))
    return Tally(
        t=t,
        **held,
        terms=tuple(float(b) for b in terms[:, :N_TERM].sum(axis=0)),
        overlap_max=float(block[S.OVERLAP_MAX]),
        overlap_grain=int(block[S.OVERLAP_GRAIN]),
        overlap_step=int(block[S.OVERLAP_STEP]),
        speed_max=float(stats[:, S.SPEED_MAX].max()),
        spin_max=float(stats[:, S.SPIN_MAX].max()),
        n_contact=int(stats[:, S.N_CONTACT].sum()),
        pending=tuple(float(one) for one in stats[:, S.PENDING].sum(axis=0)),
        walls=walls,
    )


def potential_energy(scene: Scene, state: State) -> float:
    """Energy of weight and buoyancy at a state [J], from the origin, periods crossed added."""
    m, x = scene.m_weight, np.array(state.x)
    image = state.image if len(state.image) == len(x) else np.zeros((len(x), 2), np.int32)
    if scene.bodies is not None and state.bodies is not None:
        alone, moved = _alone(scene), state.bodies
        m = np.concatenate([m[alone], scene.bodies.m_weight])
        x, image = np.concatenate([x[alone], moved.x]), np.concatenate([image[alone], moved.image])
    for a in range(2):
        if np.isfinite(scene.period[a]):
            x[:, a] += image[:, a] * scene.period[a]
    return -float(np.sum(m[:, None] * x * scene.gravity))


def _alone(scene: Scene) -> Bools:
    """Grains that are no members of clumps, shape (n_grain,)."""
    alone = np.ones(scene.n_grain, np.bool_)
    if scene.bodies is not None:
        alone[scene.bodies.members] = False
    return alone


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
        springs = energies_of_springs(before, state, dropped)
        given -= springs.normal + springs.tangential
    return given
