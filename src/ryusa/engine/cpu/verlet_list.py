"""The Verlet list of the CPU engine: grains in cell order, and the pairs that may touch before the next."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.arrays import CandidateArrays, GrainArrays, PairArrays, WallArrays
from ryusa.engine.cpu.block_exchange import number_crossing_pairs
from ryusa.engine.cpu.cell_list import build_list, grid_of, sort_by_cell, wrap_grains
from ryusa.engine.cpu.prune import copy_rows_in, copy_rows_out, count_touching
from ryusa.engine.shared.contact_memory import ContactMemory
from ryusa.engine.shared.layout import Layout, aligned, film_reach
from ryusa.engine.shared.variant import KernelVariant
from ryusa.model import Scene, State
from ryusa.model.scene import Floats

# Results of a task for blocks first..last-1, in order.
Share = Callable[[Callable[[int, int], Any]], list[Any]]

_CACHED = 8192  # grains that a cache holds: more have to be prefetched


class BlockLayout(Layout):
    """The layout of a scene cut into blocks of grains, and the lists built from it."""

    def __init__(self, scene: Scene, blocks: int, variant: KernelVariant) -> None:
        super().__init__(scene, variant)
        self.block_start = np.arange(blocks + 1) * self.n // blocks
        self.walls = WallArrays(self.plane_normals, self.plane_points)

    def empty_pairs(self) -> PairArrays:
        """A Verlet list without pairs."""
        none = np.zeros(0, np.int64)
        return PairArrays(
            0, np.zeros(self.n + 1, np.int64), np.zeros(0, np.uint32), none, np.zeros(0, np.uint32),
            np.zeros(0, np.uint8), none, none, aligned(0, 8),
        )  # fmt: skip

    def empty_candidates(self, pairs: np.ndarray) -> CandidateArrays:
        """A list of candidate pairs, empty, with room for so many in each block."""
        first = np.concatenate([[0], np.cumsum(pairs)])
        total = int(first[-1])
        i, j, target, index = (np.zeros(total, np.uint32) for _ in range(4))
        touching, rows = np.zeros(total, np.uint8), aligned(total, self.variant.row_width)
        eta = np.zeros((total if self.many_dashpots else 1, self.variant.springs))
        return CandidateArrays(
            first, np.zeros(len(pairs), np.int64), i, j, target, index, touching, eta, rows
        )

    def grains_by_id(self, state: State) -> GrainArrays:
        """Grain arrays of a state, still in the order of ids."""
        n, scene = self.n, self.scene
        return GrainArrays(
            **self.by_id(state)._asdict(),
            v_pruned=aligned(n, 4),
            m=self.m,
            m_bare=scene.m,
            m_weight=scene.m_weight,
            inertia=self.inertia,
            per_m=1.0 / self.m[:n],
            per_inertia=1.0 / self.inertia[:n],
            ids=np.arange(self.n_solid),
            tracked=self.tracked,
            n_touching=np.zeros(n, np.int32),
            film=np.zeros((0, 0)),
        )

    def unsorted(self, grains: GrainArrays) -> GrainArrays:
        """The arrays that move, back in the order of ids."""
        n = self.n
        back = np.argsort(grains.ids[:n])
        moved: dict[str, Any] = {}
        for name in ("x", "v", "w"):
            moved[name] = getattr(grains, name)
            moved[name][:n] = moved[name][:n][back]
        with_fluid = back[: len(grains.fluid)]
        return grains._replace(
            **moved,
            image=grains.image[back],
            n_touching=grains.n_touching[back],
            ids=np.arange(self.n_solid),
            fluid=grains.fluid[with_fluid],
            impulse=grains.impulse[with_fluid],
        )

    def list_pairs(
        self, by_id: GrainArrays, starts: np.ndarray, skin: float, share: Share
    ) -> tuple[GrainArrays, PairArrays, Floats, int]:
        """Bring grains into the period, sort them by cell, and list their pairs.

        Parameters
        ----------
        by_id : arrays in the order of ids; positions are brought inside the period.
        starts : of the old list, from which the room of the new one is estimated.
        skin : reach of the list beyond touch and films [m].
        share : distributes the blocks over threads.

        Returns
        -------
        Grains in cell order, the new list, the positions it was built from [m] (by id), and the first
        grain outside the world or -1.
        """
        n, scene, period = self.n, self.scene, self.period
        x = by_id.x
        lost = int(wrap_grains(x[:n], by_id.image, period, self.low, self.high))
        listed = x[:n, :3].copy()
        skin = skin + film_reach(scene)
        size = self.largest + skin
        grid = grid_of(x, n, size, period)
        first, order = sort_by_cell(x, n, grid)
        grains = self._in_cell_order(by_id, order)
        bed = np.ascontiguousarray(self.x_fixed[self.standing])
        bed_grid = grid_of(bed, len(bed), size, period)
        bed_first, bed_order = sort_by_cell(bed, len(bed), bed_grid)
        free = (*grid, first, np.arange(n))
        fixed = (*bed_grid, bed_first, self.standing[bed_order])
        start = np.zeros(n + 1, np.int64)
        blocks = self.block_start

        def list_some(first: int, last: int) -> tuple[int, np.ndarray]:
            lo, hi = blocks[first], blocks[last]
            room = int(1.1 * (starts[hi] - starts[lo])) + 256
            while True:
                partners = np.empty(room, np.uint32)
                used = build_list(
                    lo, hi, grains.x, grains.ids, n, self.n_solid, self.walls, scene.plane_active, free,
                    fixed, period, skin, scene.plane_case, start, partners,
                )  # fmt: skip
                if used >= 0:
                    return hi, partners[:used]
                room = 2 * room

        found = share(list_some)
        for hi, some in found[:-1]:
            start[hi:n] += len(some)
        partners = np.concatenate([some for _, some in found])
        start[n] = len(partners)
        cross_start, crossing, incoming_start, incoming = number_crossing_pairs(
            n, self.block_start, start, partners
        )
        rows = n + len(self.block_start) - 1 + len(crossing)
        slab = int(1.1 * n / grid[2][0]) + B.LANES if n > _CACHED else n
        grains = grains._replace(film=np.zeros((rows, 4) if self.variant.film else (0, 0)))
        return (
            grains,
            PairArrays(
                slab, start, partners, cross_start, crossing, np.zeros(rows, np.uint8), incoming_start,
                incoming, aligned(rows, 8),
            ),
            listed,
            lost,
        )  # fmt: skip

    def _in_cell_order(self, by_id: GrainArrays, order: np.ndarray) -> GrainArrays:
        """Grain arrays sorted; the large ones that move are sorted in place."""
        n, scene = self.n, self.scene
        place = np.arange(len(self.r))
        place[:n] = order
        for array in (by_id.x, by_id.v, by_id.w):
            array[:n] = array[order]
        return by_id._replace(
            m=self.m[place],
            m_bare=scene.m[order],
            m_weight=scene.m_weight[order],
            inertia=self.inertia[place],
            per_m=1.0 / self.m[order],
            per_inertia=1.0 / self.inertia[order],
            ids=place[: self.n_solid].copy(),
            image=by_id.image[order],
            n_touching=by_id.n_touching[order],
            fluid=by_id.fluid[order[: len(by_id.fluid)]],
            impulse=by_id.impulse[order[: len(by_id.fluid)]],
        )

    def place_memory(self, grains: GrainArrays, candidates: CandidateArrays, memory: ContactMemory) -> int:
        """Put the memory of touching pairs into a list of candidates; returns the first not in it, or -1."""
        index = np.empty(self.n, np.int64)
        index[grains.ids[: self.n]] = np.arange(self.n)
        block_of = np.repeat(np.arange(len(candidates.count)), np.diff(self.block_start))
        return int(copy_rows_in(self.n, candidates, block_of, index, *memory))


def collect_memory(n: int, grains: GrainArrays, candidates: CandidateArrays) -> ContactMemory:
    """Copy ids and rows of all pairs in touch, in list order."""
    count = count_touching(candidates)
    width = candidates.rows.shape[1]
    i, j = np.empty(count, np.int64), np.empty(count, np.int64)
    memory = ContactMemory(
        i, j, np.empty(count, np.uint8), np.empty((count, candidates.eta.shape[1])), np.empty((count, width))
    )
    copy_rows_out(n, candidates, grains.ids, *memory)
    return memory
