"""The Verlet list of the CPU engine: grains in cell order, and the pairs that may touch before the next."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.arrays import CandidateArrays, GrainArrays, PairArrays, TouchingPairs, WallArrays
from ryusa.engine.cpu.block_exchange import number_crossing_pairs
from ryusa.engine.cpu.cell_list import (
    APART,
    Levels,
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
from ryusa.engine.shared.array_memory import unwritten, zeros
from ryusa.engine.shared.contact_memory import ContactMemory
from ryusa.engine.shared.layout import Layout, film_reach
from ryusa.engine.shared.variant import KernelVariant
from ryusa.model import Scene, State
from ryusa.model.scene import EventRule, Floats

# Results of a task for blocks first..last-1, in order.
Share = Callable[[Callable[[int, int], Any]], list[Any]]

NAMED_BY_PLACE = np.zeros(0, np.int32)  # in place of ids
_MANY = 256  # grains from which work is divided into blocks
_BLOCKS = 4, 32  # at least and at most; in between one for 2048 grains (`blocks_of`), a power of two
_CACHED = 8192  # grains that a cache holds: more have to be prefetched


class SortedGrains(NamedTuple):
    """Grains in the order of cells."""

    grains: GrainArrays
    free: Levels  # their grids
    layers: int  # of cells by which they lie in memory
    listed: Floats  # where they are [m], by place, (n, 3)
    place_of: np.ndarray  # place of each grain, by the one it had before, int32, (n,)
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
            0, 0, np.zeros(self.n + 1, np.int32), np.zeros(0, np.uint32), none, np.zeros(0, np.uint32),
            np.zeros(0, np.uint8), none.astype(np.int32), none.astype(np.int32), zeros(np.float64, 0, 8),
        )  # fmt: skip

    def empty_candidates(self, pairs: np.ndarray) -> CandidateArrays:
        """A list of candidate pairs, empty, with room for so many in each block."""
        first = np.concatenate([[0], np.cumsum(pairs)])
        total = int(first[-1])
        width = len(SHORT) if has_short_rows(self.variant) else self.variant.row_width
        i, j, target = (unwritten(np.uint32, total) for _ in range(3))
        room = total if self.walled else 0
        face, grain, number, slot = (unwritten(np.uint32, room) for _ in range(4))
        return CandidateArrays(
            first, np.zeros(len(pairs), np.int64), i, j, target, unwritten(np.uint8, total),
            self._room_for_springs(total), unwritten(np.float64, total, width),
            face, grain, number, slot, unwritten(np.float64, room, N_MET),
            np.zeros(len(pairs) if self.walled else 0, np.int64),
        )  # fmt: skip

    def room_for_touching(self, count: int) -> TouchingPairs:
        """Room for so many pairs in touch."""
        width = len(SHORT) if has_short_rows(self.variant) else self.variant.row_width
        return TouchingPairs(
            unwritten(np.uint32, count), unwritten(np.uint32, count), unwritten(np.uint8, count),
            self._room_for_springs(count), unwritten(np.float64, count, width),
        )  # fmt: skip

    def _room_for_springs(self, count: int) -> Floats:
        if self.many_dashpots:
            return unwritten(np.float64, count, self.variant.springs)
        return np.zeros((1, self.variant.springs))

    def grains_by_id(self, state: State) -> GrainArrays:
        """Grain arrays of a state, still in the order of ids."""
        n, scene, m, inertia = self.n, self.scene, self.m, self.inertia
        counted = bool(self.variant.rolling or self.variant.events)

        def mass(given: Floats) -> Floats:
            # no longer read-only, which would be another type to a kernel
            return m[:n] if np.array_equal(given, m[:n]) else np.array(given)

        return GrainArrays(
            **self.by_id(state)._asdict(),
            v_pruned=zeros(np.float64, n, 4),
            m=m,
            m_bare=mass(scene.m),
            m_weight=mass(scene.m_weight),
            inertia=inertia,
            per_m=1.0 / m[:n],
            per_inertia=1.0 / inertia[:n],
            ids=np.arange(self.n_solid, dtype=np.int32),
            tracked=np.array(self.tracked if scene.events == EventRule.TRACKED else self.tracked[:0]),
            n_touching=np.zeros(n if counted else 0, np.int32),
            film=np.zeros((0, 0)),
        )

    def sort_grains(self, old: GrainArrays, skin: float, share: Share) -> SortedGrains:
        """Bring grains into the period, and sort them by cell.

        Parameters
        ----------
        old : grains in any order; positions are brought inside the period.
        skin : reach of the list beyond touch and films [m].
        share : distributes the blocks over threads.
        """
        n, period, blocks = self.n, self.period, self.block_start
        bounds = np.full((len(blocks) - 1, 2, 3), [[[np.inf] * 3, [-np.inf] * 3]])
        outside = share(
            lambda a, b: wrap_grains(
                blocks[a], blocks[b], old.x, old.image, old.ids, period, self.low, self.high, bounds[a]
            )
        )
        low, high = (bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)) if n else bounds_of(old.x[:0, :3])
        reach = skin + film_reach(self.scene)
        # grains lie in memory by the cells of most of them, whatever the size of the largest
        usual = float(2.0 * np.median(old.x[:n, 3])) if n else self.largest
        grid = grid_of(low, high, n, min(self.largest, APART * usual) + reach, period)
        first, order = sort_by_cell(old.x, n, old.ids, grid)
        grains, listed, place_of = like(n, old), zeros(np.float64, n, 3), zeros(np.int32, n)
        share(lambda a, b: move_grains(blocks[a], blocks[b], order, old, grains, place_of, listed))
        if self.largest <= APART * usual:
            order[:] = np.arange(n, dtype=np.int32)
            free = one_grid(grid, first, order, 0.5 * self.largest)
        else:
            d = 2.0 * grains.x[:n, 3]
            free = grids_by_size(grains.x[:n, :3], d, grains.ids[:n], reach, period, low, high, self.largest)
        lost = min((i for i in outside if i >= 0), default=-1)
        return SortedGrains(grains, free, int(grid[2][0]), listed, place_of, lost)

    def list_pairs(
        self, found: SortedGrains, room: np.ndarray, skin: float, share: Share
    ) -> tuple[GrainArrays, PairArrays]:
        """List the pairs of sorted grains; returns them too, with room for what films and shears need.

        Parameters
        ----------
        room : first pair of each block, and of one more, in the old list, from which that of this one is
            estimated.
        skin, share : as for `sort_grains`.
        """
        n, scene, period, blocks, grains = self.n, self.scene, self.period, self.block_start, found.grains
        reach = skin + film_reach(scene)
        bed = np.ascontiguousarray(self.x_fixed[self.active_fixed])
        d = 2.0 * grains.x[n + self.active_fixed, 3]
        fixed = grids_by_size(bed, d, self.active_fixed, reach, period, *bounds_of(bed), self.largest)
        fixed = fixed._replace(order=self.active_fixed[fixed.order])
        start = zeros(np.int32, n + 1)

        def list_some(first: int, last: int) -> tuple[int, np.ndarray]:
            lo, hi = blocks[first], blocks[last]
            size = int(1.1 * (room[last] - room[first])) + 256
            while True:
                partners = unwritten(np.uint32, size)
                used = build_list(
                    lo, hi, grains.x, grains.ids, n, self.n_solid, self.walls, scene.plane_active, found.free,
                    fixed, period, reach, scene.plane_case, self.walled, self.body, start, partners,
                )  # fmt: skip
                if used >= 0:
                    return hi, partners[:used]
                size = 2 * size

        parts = share(list_some)
        for hi, some in parts[:-1]:
            start[hi:n] += len(some)
        partners = np.concatenate([some for _, some in parts]) if len(parts) > 1 else parts[0][1]
        start[n] = len(partners)
        cross_start, crossing, incoming_start, incoming, span = number_crossing_pairs(
            n, blocks, start, partners, share
        )
        rows = n + len(blocks) - 1 + len(crossing)
        slab = int(1.1 * n / found.layers) + B.LANES if n > _CACHED else n
        pairs = PairArrays(
            slab, span, start, partners, cross_start, crossing, np.zeros(rows, np.uint8), incoming_start,
            incoming, zeros(np.float64, rows, 8),
        )  # fmt: skip
        film = zeros(np.float64, rows, 4) if self.variant.film or self.variant.exact else np.zeros((0, 0))
        return grains._replace(film=film), pairs

    def place_memory(
        self, place_of: np.ndarray, candidates: CandidateArrays, memory: list[ContactMemory], share: Share
    ) -> tuple[int, int] | None:
        """Move the memory of pairs in touch into a list of candidates.

        What has been moved is freed, one part after the other: there is never room for both.

        Parameters
        ----------
        place_of : places now of the grains that the memory names.
        memory : in parts; what is left of each is what comes after a pair not in the list.

        Returns
        -------
        Names of the first pair that is not in the list, or None.
        """
        none, parts, blocks = room_for_memory(0, candidates), len(memory), len(self.block_start) - 1

        def place_some(first: int, last: int) -> None:
            for k in range(first * parts // blocks, last * parts // blocks):
                one = memory[k]
                done = copy_rows_in(self.n, self.block_start, candidates, place_of, *one)
                memory[k] = none if done == len(one.i) else one.after(done)

        share(place_some)
        left = next((one for one in memory if len(one.i)), None)
        return None if left is None else (int(left.i[0]), int(left.j[0]))


def room_for_memory(count: int, candidates: CandidateArrays) -> ContactMemory:
    """Room for the names and rows of so many pairs of a list of candidates."""
    springs = candidates.eta.shape[1]
    return ContactMemory(
        unwritten(np.uint32, count), unwritten(np.uint32, count), unwritten(np.uint8, count),
        np.zeros((1, springs)) if len(candidates.eta) == 1 else unwritten(np.float64, count, springs),
        unwritten(np.float64, count, candidates.rows.shape[1]),
    )  # fmt: skip


def count_memory(candidates: CandidateArrays, share: Share) -> np.ndarray:
    """Number of the first pair in touch of each block, and of all, (n_block + 1,)."""
    count = np.zeros(len(candidates.count) + 1, np.int64)
    share(lambda a, b: count_touching(a, b, candidates, count))
    return np.cumsum(count)


def copy_memory(
    first: int, last: int, ids: np.ndarray, n: int, candidates: CandidateArrays, into: ContactMemory
) -> None:
    """Copy names and rows of the pairs in touch of blocks first..last-1, in list order.

    Grains are named by `ids`, or by their places where it is empty.
    """
    copy_rows_out(first, last, 0, candidates.first[-1], n, candidates, ids, *into)


def collect_memory(n: int, ids: np.ndarray, candidates: CandidateArrays, share: Share) -> ContactMemory:
    """Copy names, by id, and rows of all pairs in touch, in list order."""
    count = count_memory(candidates, share)
    memory = room_for_memory(count[-1], candidates)
    share(lambda a, b: copy_memory(a, b, ids, n, candidates, memory.after(count[a])))
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
