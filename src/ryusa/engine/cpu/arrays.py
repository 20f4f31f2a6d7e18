"""Arrays a kernel works on, in the engine's own order: free grains by cell, fixed grains, planes."""

from typing import Any, NamedTuple

import numpy as np

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu import fluid_layout as W
from ryusa.engine.cpu import prune_schedule as K
from ryusa.engine.cpu.body_lanes import body_lanes
from ryusa.engine.shared.array_memory import zeros
from ryusa.engine.shared.kernel import kernel


class GrainArrays(NamedTuple):
    """Grains by place. n free grains, n_solid with the fixed ones, n_total with planes and faces.

    Vectors lie in rows of four doubles, a whole vector register; the fourth column is named with each. Where
    nothing is added to masses, as of dry grains that are no members of bodies, `m_bare` and `m_weight` are
    the first n of `m`.
    """

    x: Any  # centres and radius [m], (n_total, 4); inf the radius of planes
    v: Any  # velocities [m/s], and 0, (n_total, 4); zero beyond n
    v_pruned: Any  # velocities at the last pruning [m/s], and 0, (n, 4)
    w: Any  # spins [rad/s], and the radius [m], (n_total, 4); zero beyond n; beside v in one cache line
    m: Any  # mass with added mass [kg], (n_total,); inf beyond n
    m_bare: Any  # mass without added mass [kg], (n,)
    m_weight: Any  # mass that gravity sees [kg], (n,)
    inertia: Any  # [kg m2], (n_total,); inf beyond n
    per_m: Any  # one over mass with added mass [1/kg], (n,)
    per_inertia: Any  # one over moment of inertia [1/(kg m2)], (n,)
    ids: Any  # id of each place, int32, (n_solid,)
    image: Any  # periods crossed, (n, 2)
    tracked: Any  # whether its contacts are recorded, by id, (n,); (0,) unless some are named
    n_touching: Any  # contacts in the last step, (n,); (0,) without rolling friction and records
    # force of films in this step [N], and between kicks, with exact timing, shifts times masses [kg m],
    # (rows of `PairArrays.f`, 4); (0, 0) without either
    film: Any
    fluid: Any  # water at each grain, columns of model.fluid, (n, N_SAMPLED); (0, 0) without a column
    impulse: Any  # impulse from the water [N s], and drag over slip, (n, N_IMPULSE); (0, 0) without


class PairArrays(NamedTuple):
    """The Verlet list: every pair that may touch before the list is rebuilt, and the rows that forces go to.

    Partners of grain i are partners[start[i]:start[i + 1]]. `f` has a row for each free grain, then one for
    each block for forces that are not used (those on fixed grains and planes), then one for each pair
    whose partner belongs to another block: that force waits there until the partner's block gathers it.
    """

    slab: int  # places between two layers of cells: so much later come partners not met before
    span: int  # blocks that share pairs are at most so many blocks apart, the last one beside the first
    start: Any  # int32, (n + 1,)
    partners: Any  # places, uint32, (n_pair,)
    cross_start: Any  # first crossing pair of each block, (n_block + 1,)
    crossing: Any  # numbers of the pairs that cross, (n_cross,)
    active: Any  # 1 where the crossing pair of a row of `f` is a candidate, (n + n_block + n_cross,)
    incoming_start: Any  # int32; rows for grain j: incoming[incoming_start[j]:incoming_start[j + 1]]
    incoming: Any  # int32, (n_cross,)
    f: Any  # force [N], nothing, torque [N m] and contacts so far in this step, (n + n_block + n_cross, 8)


class CandidateArrays(NamedTuple):
    """Candidate pairs: those that may touch within the next few steps, with the memory of those that do.

    Each block has room for pairs first[b] to first[b + 1], all that it has in the Verlet list, of which
    count[b] are taken, in the order of that list. What was never taken takes no memory
    (shared/layout.py: `unwritten`).
    """

    first: Any  # (n_block + 1,)
    count: Any  # (n_block,)
    i: Any  # place of the grain that owns the pair, (n_near,)
    j: Any  # place of its partner
    target: Any  # row of `PairArrays.f` for the partner
    touching: Any  # state of the pair (shared/contact_instants.py), 0 where the row holds nothing
    eta: Any  # dashpots and stiffnesses (shared/memory_rows.py); one row for all where they are alike
    rows: Any  # memory (shared/memory_rows.py), (n_near, width); it and `eta` hold where they touch
    # only in scenes with walls, else of length 0
    face: Any  # candidates that are planes or faces, for each block from first[b] on, (n_near,)
    face_grain: Any  # their grains, (n_near,)
    face_number: Any  # numbers of the planes, then of the faces, (n_near,)
    slot: Any  # place of each candidate that is one of them among those of its block, (n_near,)
    met: Any  # how grains meet them in a block (faces.py), workspace of its thread, (n_near, N_MET)
    face_count: Any  # how many of them are candidates, (n_block,)


class TouchingPairs(NamedTuple):
    """Pairs in touch of one block, while its candidates are listed anew; columns as of CandidateArrays."""

    i: Any
    j: Any
    touching: Any
    eta: Any
    rows: Any


class WallArrays(NamedTuple):
    """Planes and faces."""

    normals: Any  # (n_plane, 3)
    points: Any  # [m], (n_plane, 3)
    faces: Any  # FaceArrays (faces.py), None in scenes without walls


class AccountArrays(NamedTuple):
    """What each block records."""

    ended: Any  # records of contacts that parted, (n_block, slots, N_EVENT)
    terms: Any  # energy account [J], (n_block, N_ACCOUNT), columns of model.tally.Term
    stats: Any  # statistics, (n_block, N_STATISTIC), columns of shared/block_statistics.py
    walls: Any  # impulses on walls since the start, (n_block, n_wall, N_IMPULSE), columns of model.walls


class Workspace(NamedTuple):
    """Workspace of one thread (`workspace_of_thread`)."""

    batch: Any  # a batch of touching pairs (batch_layout.py)
    water: Any  # a batch of grains in water (fluid_layout.py)
    bodies: Any  # a batch of bodies in water (bodies_in_water.py)
    separation: Any  # separation from i to j and sum of radii [m] of candidates, four each, (4 * LANES,)
    velocity: Any  # velocity of j against i [m/s], and 0, of candidates, (4 * LANES,)
    inside: Any  # 1 where a candidate touches, (LANES,)
    face_lanes: Any  # lanes of the batch that are faces, and how many at place LANES, (LANES + 1,)
    selected: Any  # selected candidates, the first of them in the batch, (2 * LANES,), uint32
    schedule: Any  # this thread's copy of the prune schedule, (N_SCHEDULE,)


class StepArrays(NamedTuple):
    """All that a step reads and writes, lent to its pieces as one (compiled/piece.py)."""

    n: int  # free grains
    n_solid: int  # with fixed grains
    plane_case: int
    c: Any  # parameters (shared/parameters.py)
    material: Any  # of each grain, by id, and
    table: Any  # parameters for each two materials; None where there is one material
    block_start: Any  # first grain of each block, (n_block + 1,)
    choice: Any  # LawChoice (shared/variant.py)
    grains: Any  # GrainArrays
    walls: Any  # WallArrays
    pairs: Any  # PairArrays
    candidates: Any  # CandidateArrays
    spare: Any  # TouchingPairs, room for those of any block, of one thread
    accounts: Any  # AccountArrays
    bodies: Any  # BodyArrays (rigid_bodies.py); None where there are none


def workspace_of_thread() -> Workspace:
    """Room for one thread."""
    return Workspace(
        zeros(np.float64, B.SIZE), zeros(np.float64, W.SIZE), body_lanes(), zeros(np.float64, 4 * B.LANES),
        zeros(np.float64, 4 * B.LANES), zeros(np.float64, B.LANES), np.zeros(B.LANES + 1, np.uint32),
        np.zeros(2 * B.LANES, np.uint32), zeros(np.float64, K.N_SCHEDULE),
    )  # fmt: skip


@kernel()
def rows_by_id(ids: Any, rows: Any, out: Any) -> None:
    """Put rows that lie by place in the order of ids; of each as many numbers as `out` has columns."""
    for i in range(len(ids)):
        for k in range(out.shape[1]):
            out[ids[i], k] = rows[i, k]


@kernel()
def same_column(ids: Any, rows: Any, placed: Any, k: int) -> bool:
    """Whether column k of rows that lie by id is that of rows in the order of places."""
    same = True
    for i in range(len(ids)):
        same = same and rows[ids[i], k] == placed[i, k]
    return same


@kernel()
def rows_by_place(ids: Any, rows: Any, out: Any) -> None:
    """Put rows that lie by id in the order of places."""
    for i in range(len(ids)):
        for k in range(out.shape[1]):
            out[i, k] = rows[ids[i], k]
