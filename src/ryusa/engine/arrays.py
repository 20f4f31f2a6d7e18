"""Arrays a kernel works on, in the engine's own order: free grains by cell, fixed grains, planes."""

from typing import Any, NamedTuple


class Grains(NamedTuple):
    """Grains by place. n free grains, n_solid with the fixed ones, n_total with the planes."""

    x: Any  # centres [m], (n_solid, 3)
    v: Any  # velocities [m/s], (n_total, 3); zero beyond n
    w: Any  # spins [rad/s], (n_total, 3); zero beyond n
    r: Any  # radii [m], (n_total,); inf for planes
    m: Any  # mass with added mass [kg], (n_total,); inf beyond n
    m_bare: Any  # mass without added mass [kg], (n,)
    m_weight: Any  # mass that gravity sees [kg], (n,)
    inertia: Any  # [kg m2], (n_total,); inf beyond n
    ids: Any  # id of each place, (n_solid,)
    image: Any  # periods crossed, (n, 2)
    tracked: Any  # whether its contacts are recorded, by id, (n,)
    f: Any  # contact force so far in this step [N], (n, 3)
    torque: Any  # contact torque so far in this step [N m], (n, 3)
    film: Any  # force of films so far in this step [N], (n, 3); (0, 0) without
    touches: Any  # contacts so far in this step, (n,)
    touched: Any  # contacts in the last step, (n,)
    seen: Any  # water at each grain, columns of model.immersed, (n, N_SEEN); (0, 0) without a column
    taken: Any  # impulse it took from the water [N s], and drag over slip, (n, N_TAKEN); (0, 0) without


class Pairs(NamedTuple):
    """Verlet list and contact memory. Partners of grain i are partners[start[i]:start[i + 1]]."""

    start: Any  # (n + 1,)
    partners: Any  # places, (n_pair,)
    live: Any  # 1 where the pair is in touch and its row holds, (n_pair,)
    mem: Any  # rows of contact memory (rows.py), (n_pair, width)
    react_start: Any  # first slot in `react` of each block, (n_block + 1,)
    react: Any  # force and torque that a block leaves for a partner in another, (n_cross, 6)
    react_touch: Any  # 1 where that slot holds a contact in this step, 2 a film, (n_cross,)
    incoming_start: Any  # slots meant for grain j: incoming[incoming_start[j]:incoming_start[j + 1]]
    incoming: Any  # (n_cross,)


class Walls(NamedTuple):
    """Planes."""

    normals: Any  # (n_plane, 3)
    points: Any  # [m], (n_plane, 3)


class Ledger(NamedTuple):
    """What each block writes down."""

    ended: Any  # records of contacts that parted, (n_block, slots, N_EVENT)
    books: Any  # energy account [J], (n_block, N_BOOKS), columns of model.tally.Book
    now: Any  # what holds now, (n_block, N_NOW), columns N_ of rows.py
