"""The Verlet list of the CPU engine: grains in cell order, and the pairs that may touch before the next."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.arrays import CandidateArrays, GrainArrays, PairArrays, WallArrays
from ryusa.engine.cpu.block_exchange import number_crossing_pairs
from ryusa.engine.cpu.cell_list import (
    APART,
    bounds_of,
    build_list,
    grid_of,
    grids_by_size,
    one_grid,
    sort_by_cell,
)
from ryusa.engine.cpu.contact_rows import SHORT, has_short_rows
from ryusa.engine.cpu.faces import N_MET, face_arrays
from ryusa.engine.cpu.prune import copy_rows_in, copy_rows_out, count_touching
from ryusa.engine.cpu.reorder import like, move_grains, wrap_grains
from ryusa.engine.shared.contact_memory import ContactMemory
from ryusa.engine.shared.layout import Layout, aligned, film_reach
from ryusa.engine.shared.variant import KernelVariant
from ryusa.model import Scene, State
from ryusa.model.scene import Floats

# Results of a task for blocks first..last-1, in order.
Share = Callable[[Callable[[int, int], Any]], list[Any]]

_MANY = 256  # grains from which work is divided into blocks
_BLOCKS = 4, 32  # at least and at most; in between one for 2048 grains (`blocks_of`), a power of two
_CACHED = 8192  # grains that a cache holds: more have to be prefetched


class ListedPairs(NamedTuple):
    """Grains in cell order, and their pairs."""

    grains: GrainArrays
    pairs: PairArrays
    x: Floats  # positions the list was built from [m], by place, (n, 3)
    place_of: np.ndarray  # place of each grain, by the one it had before, (n,)
    lost: int  # lowest id outside the world, or -1


class BlockLayout(Layout):
    """The layout of a scene cut into blocks of grains, and the lists built from it."""

    def __init__(self, scene: Scene, blocks: int, variant: KernelVariant) -> None:
        super().__init__(scene, variant)
        self.block_start = np.arange(blocks + 1) * self.n // blocks
        faces = face_arrays(scene.walls, self.n_solid + scene.n_plane) if scene.walls is not None else None
        self.walls = WallArrays(self.plane_normals, self.plane_points, faces if scene.n_face else None)
        self.walled = 1 if scene.n_face else None
        self.body: np.ndarray | None = None  # number of the rigid body of each grain, by id (`build_list`)
        if scene.bodies is not None:
            of = scene.bodies.of_grain(self.n)
            self.body = np.arange(self.n_solid) + scene.bodies.n
            self.body[: self.n][of >= 0] = of[of >= 0]

    def empty_pairs(self) -> PairArrays:
        """A Verlet list without pairs."""
        none = np.zeros(0, np.int64)
        return PairArrays(
            0, 0, np.zeros(self.n + 1, np.int64), np.zeros(0, np.uint32), none, np.zeros(0, np.uint32),
            np.zeros(0, np.uint8), none, none, aligned(0, 8),
        )  # fmt: skip

    def empty_candidates(self, pairs: np.ndarray) -> CandidateArrays:
        """A list of candidate pairs, empty, with room for so many in each block."""
        first = np.concatenate([[0], np.cumsum(pairs)])
        total = int(first[-1])
        i, j, target, index = (np.zeros(total, np.uint32) for _ in range(4))
        width = len(SHORT) if has_short_rows(self.variant) else self.variant.row_width
        touching, rows = np.zeros(total, np.uint8), aligned(total, width)
        eta = np.zeros((total if self.many_dashpots else 1, self.variant.springs))
        room = total if self.walled else 0
        face, grain, number, slot = (np.zeros(room, np.uint32) for _ in range(4))
        return CandidateArrays(
            first, np.zeros(len(pairs), np.int64), i, j, target, index, touching, eta, rows,
            face, grain, number, slot, aligned(room, N_MET),
            np.zeros(len(pairs) if self.walled else 0, np.int64),
        )  # fmt: skip

    def grains_by_id(self, state: State) -> GrainArrays:
        """Grain arrays of a state, still in the order of ids."""
        n, scene = self.n, self.scene
        return GrainArrays(
            **self.by_id(state)._asdict(),
            v_pruned=aligned(n, 4),
            m=self.m,
            m_bare=np.array(scene.m),  # no longer read-only, which would be another type to a kernel
            m_weight=np.array(scene.m_weight),
            inertia=self.inertia,
            per_m=1.0 / self.m[:n],
            per_inertia=1.0 / self.inertia[:n],
            ids=np.arange(self.n_solid),
            tracked=np.array(self.tracked),  # likewise
            n_touching=np.zeros(n, np.int32),
            film=np.zeros((0, 0)),
        )

    def list_pairs(self, old: GrainArrays, starts: np.ndarray, skin: float, share: Share) -> ListedPairs:
        """Bring grains into the period, sort them by cell, and list their pairs.

        Parameters
        ----------
        old : grains in any order; positions are brought inside the period.
        starts : of the old list, from which the room of the new one is estimated.
        skin : reach of the list beyond touch and films [m].
        share : distributes the blocks over threads.
        """
        n, scene, period, blocks = self.n, self.scene, self.period, self.block_start
        bounds = np.full((len(blocks) - 1, 2, 3), [[[np.inf] * 3, [-np.inf] * 3]])
        outside = share(
            lambda a, b: wrap_grains(
                blocks[a], blocks[b], old.x, old.image, old.ids, period, self.low, self.high, bounds[a]
            )
        )
        low, high = (bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)) if n else bounds_of(old.x[:0, :3])
        skin = skin + film_reach(scene)
        # grains lie in memory by the cells of most of them, whatever the size of the largest
        usual = float(2.0 * np.median(old.x[:n, 3])) if n else self.largest
        grid = grid_of(low, high, n, min(self.largest, APART * usual) + skin, period)
        first, order = sort_by_cell(old.x, n, old.ids, grid)
        grains, listed, place_of = like(n, old), np.empty((n, 3)), np.empty(n, np.int64)
        share(lambda a, b: move_grains(blocks[a], blocks[b], order, old, grains, place_of, listed))
        bed = np.ascontiguousarray(self.x_fixed[self.standing])
        if self.largest <= APART * usual:
            free = one_grid(grid, first, np.arange(n), 0.5 * self.largest)
        else:
            d = 2.0 * grains.x[:n, 3]
            free = grids_by_size(grains.x[:n, :3], d, grains.ids[:n], skin, period, low, high, self.largest)
        d = 2.0 * self.r[n + self.standing]
        fixed = grids_by_size(bed, d, self.standing, skin, period, *bounds_of(bed), self.largest)
        fixed = fixed._replace(order=self.standing[fixed.order])
        start = np.zeros(n + 1, np.int64)

        def list_some(first: int, last: int) -> tuple[int, np.ndarray]:
            lo, hi = blocks[first], blocks[last]
            room = int(1.1 * (starts[hi] - starts[lo])) + 256
            while True:
                partners = np.empty(room, np.uint32)
                used = build_list(
                    lo, hi, grains.x, grains.ids, n, self.n_solid, self.walls, scene.plane_active, free,
                    fixed, period, skin, scene.plane_case, self.walled, self.body, start, partners,
                )  # fmt: skip
                if used >= 0:
                    return hi, partners[:used]
                room = 2 * room

        found = share(list_some)
        for hi, some in found[:-1]:
            start[hi:n] += len(some)
        partners = np.concatenate([some for _, some in found])
        start[n] = len(partners)
        cross_start, crossing, incoming_start, incoming, span = number_crossing_pairs(
            n, blocks, start, partners, share
        )
        rows = n + len(blocks) - 1 + len(crossing)
        slab = int(1.1 * n / grid[2][0]) + B.LANES if n > _CACHED else n
        pairs = PairArrays(
            slab, span, start, partners, cross_start, crossing, np.zeros(rows, np.uint8), incoming_start,
            incoming, aligned(rows, 8),
        )  # fmt: skip
        grains = grains._replace(
            film=aligned(rows, 4) if self.variant.film or self.variant.exact else np.zeros((0, 0))
        )
        return ListedPairs(grains, pairs, listed, place_of, min((i for i in outside if i >= 0), default=-1))

    def place_memory(
        self, place_of: np.ndarray, candidates: CandidateArrays, memory: ContactMemory, share: Share
    ) -> int:
        """Put the memory of touching pairs into a list of candidates; returns the first not in it, or -1.

        `place_of` gives the places now of the grains that the memory names.
        """
        count, blocks = len(memory.i), self.block_start
        ends = [k * count // (len(blocks) - 1) for k in range(len(blocks))]
        missing = share(
            lambda a, b: copy_rows_in(ends[a], ends[b], self.n, blocks, candidates, place_of, *memory)
        )
        return min((k for k in missing if k >= 0), default=-1)


def room_for_memory(count: int, candidates: CandidateArrays) -> ContactMemory:
    """Room for the names and rows of so many pairs of a list of candidates."""
    eta = candidates.eta
    return ContactMemory(
        np.empty(count, np.uint32), np.empty(count, np.uint32), np.empty(count, np.uint8),
        np.empty((1 if len(eta) == 1 else count, eta.shape[1])), np.empty((count, candidates.rows.shape[1])),
    )  # fmt: skip


def count_memory(candidates: CandidateArrays, share: Share) -> np.ndarray:
    """Number of the first pair in touch of each block, and of all, (n_block + 1,)."""
    count = np.zeros(len(candidates.count) + 1, np.int64)
    share(lambda a, b: count_touching(a, b, candidates, count))
    return np.cumsum(count)


def collect_memory(n: int, ids: np.ndarray, candidates: CandidateArrays, share: Share) -> ContactMemory:
    """Copy the names and rows of all pairs in touch, in list order.

    Grains are named by `ids`, or by their places where it is empty.
    """
    count = count_memory(candidates, share)
    memory = room_for_memory(count[-1], candidates)
    memory.eta[:] = candidates.eta[: len(memory.eta)]
    ends = candidates.first[:-1] + candidates.count

    def copy_some(first: int, last: int) -> None:
        for b in range(first, last):
            copy_rows_out(candidates.first[b], ends[b], count[b], n, candidates, ids, *memory)

    share(copy_some)
    return memory


def blocks_of(n: int, plane_case: bool) -> int:
    """Number of blocks for n grains; it does not depend on the number of threads.

    Thin blocks have many pairs with their neighbours, which cost more: in space, where blocks are slabs,
    there are more than 16 only if each has 8192 grains.
    """
    least, most = _BLOCKS
    if n < _MANY:
        return 1
    blocks = int(min(max(2.0 ** round(np.log2(n / 2048)), least), most))
    return blocks if plane_case else min(blocks, max(16, int(2.0 ** round(np.log2(n / 8192)))))
