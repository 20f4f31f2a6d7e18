"""Arrays on the device: filled from a scene and a state, sorted by cell, and read back."""

import math
from typing import Any

import numpy as np

from ryusa.engine.cuda import verlet_list as kernels
from ryusa.engine.cuda.arrays import (
    IN_SIMULATOR,
    MOST_BLOCKS,
    ON_CARD,
    DeviceGrainArrays,
    DevicePairArrays,
    DeviceWallArrays,
    LaunchShape,
)
from ryusa.engine.cuda.availability import simulated
from ryusa.engine.cuda.device import cuda
from ryusa.engine.cuda.step_totals import NO_GRAIN
from ryusa.engine.shared.contact_memory import ContactMemory, contacts_of_grains, memory_of
from ryusa.engine.shared.layout import Layout
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.model import Scene, State
from ryusa.model.fluid import N_IMPULSE, N_SAMPLED, FluidAtGrains
from ryusa.model.scene import Floats

_MARGIN = 1.0 + 1e-9  # of a cell beyond reach: a grain on its edge may fall to either side


def shape() -> LaunchShape:
    """Launch shape on this machine."""
    return IN_SIMULATOR if simulated() else ON_CARD


def blocks(n: int) -> int:
    """Blocks for n grains; of n alone, so that sums have the same order on every card."""
    return max(1, min(-(-n // shape().threads), MOST_BLOCKS))


def launch(kernel: Any, n: int, *arguments: Any) -> None:
    """Run a kernel with about one thread for each of n."""
    kernel[blocks(n), shape().threads](*arguments)


def one(value: int) -> Any:
    """An int64 on the device."""
    return cuda.to_device(np.full(1, value))


class DeviceState:
    """What lies on the device for one scene.

    Parameters
    ----------
    scene, state : as loaded; positions are those the list is to be built from.
    variant, choice : what kernels are compiled for, and the laws.
    parameters : of the scene (shared/parameters.py).
    extent : lowest and highest corner of the grid [m], shape (2, 3); chosen from where grains stand if None.
    """

    def __init__(
        self,
        scene: Scene,
        state: State,
        variant: KernelVariant,
        choice: LawChoice,
        parameters: Floats,
        extent: Floats | None,
    ) -> None:
        self.scene, self.variant, self.n = scene, variant, scene.n_grain
        layout = self.layout = Layout(scene, variant)
        self.n_solid = layout.n_solid
        memory = memory_of(state.contacts, variant, choice, parameters, layout)
        by_id = layout.by_id(state)
        x = by_id.x.copy()
        x[:, 3] = layout.r
        self.active_fixed = (self.n + layout.active_fixed).astype(np.int32)
        still = x[self.active_fixed, :3]
        if extent is None:
            where = np.vstack([x[: self.n, :3], still])
            extent = np.stack([where.min(axis=0, initial=np.inf), where.max(axis=0, initial=-np.inf)])
        self.extent = extent
        n_touching = np.stack([contacts_of_grains(memory, self.n)] * 2)
        fluid = (
            FluidAtGrains(by_id.fluid, by_id.impulse)
            if variant.column
            else FluidAtGrains(np.zeros((1, N_SAMPLED)), np.zeros((1, N_IMPULSE)))
        )
        # both orders share what has two halves, and masses, which `reorder` reads by id
        shared: dict[str, Any] = {
            "x": cuda.to_device(np.stack([x, x])),
            "v": cuda.to_device(np.stack([by_id.v, by_id.v])),
            "w": cuda.to_device(np.stack([by_id.w, by_id.w])),
            "tracked": cuda.to_device(layout.tracked.astype(np.uint8)),
            "n_touching": cuda.to_device(n_touching),
            "m": cuda.to_device(layout.m),
            "inertia": cuda.to_device(layout.inertia),
            "m_bare": cuda.to_device(np.asarray(scene.m, np.float64)),
            "m_weight": cuda.to_device(np.asarray(scene.m_weight, np.float64)),
        }
        self._masses = cuda.to_device(
            np.column_stack([layout.m[: self.n], layout.inertia[: self.n], scene.m, scene.m_weight])
        )

        def own() -> DeviceGrainArrays:
            return DeviceGrainArrays(
                **shared,
                ids=cuda.to_device(np.arange(self.n_solid, dtype=np.int32)),
                image=cuda.to_device(np.ascontiguousarray(by_id.image)),
                fluid=cuda.to_device(fluid.sampled),
                impulse=cuda.to_device(fluid.impulse),
            )

        self.bodies, self._spare = own(), own()
        self.half = 0
        self.walls = DeviceWallArrays(
            cuda.to_device(layout.plane_normals),
            cuda.to_device(layout.plane_points),
            cuda.to_device(np.asarray(scene.plane_active, np.uint8)),
        )
        self.c = cuda.to_device(parameters)
        self.listed = cuda.to_device(np.zeros((self.n, 3)))
        self._most_cells = 2 * (self.n + len(still)) + 64
        self._cell = cuda.to_device(np.zeros(max(self.n, len(still), 1), np.int32))
        self._taken, self._first, self._first_fixed = (
            cuda.to_device(np.zeros(self._most_cells + 1, np.int32)) for _ in range(3)
        )
        self._order, self._places = (
            cuda.to_device(np.arange(max(self.n, 1), dtype=np.int32)) for _ in range(2)
        )
        self._fixed = cuda.to_device(np.zeros(max(len(still), 1), np.int32))
        self._still = cuda.to_device(self.active_fixed)
        self._rooms = 0
        self.pairs = self._by_id(memory)
        launch(
            kernels.set_springs_in_touch, self.n, self.n, variant.rotation, variant.kind,
            int(choice.rebound > 0), self.c, self.bodies, self.pairs,
        )  # fmt: skip
        self._held = self._room(0, cuda.to_device(np.zeros(self.n + 1, np.int64)))
        self.n_pair = 0

    @property
    def arrays(self) -> tuple[int, int]:
        """Tells the arrays in use from those of another list: how often room was made, and which order."""
        return self._rooms, id(self.bodies)

    def _room(self, pairs: int, start: Any) -> DevicePairArrays:
        """A list with room for so many neighbours and an eighth more, undefined beyond `start`."""
        self._rooms += 1
        room = max(pairs * 9 // 8, 1)
        return DevicePairArrays(
            start,
            cuda.device_array(room, np.int32),
            cuda.device_array(room, np.uint8),
            cuda.device_array((room, self.variant.springs), np.float64),
            cuda.device_array((room, self.variant.row_width), np.float64),
        )

    def _by_id(self, memory: ContactMemory) -> DevicePairArrays:
        """A list in the order of ids of the pairs in touch alone, each from both sides."""
        both = memory.j < self.n
        owner = np.concatenate([memory.i, memory.j[both]])
        partner = np.concatenate([memory.j, memory.i[both]])
        which = np.concatenate([np.arange(len(both)), np.flatnonzero(both)])
        order = np.lexsort((partner, owner))
        start = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=self.n))])
        which, partners = which[order], partner[order]
        states, eta, rows = memory.states[which], memory.eta[which], memory.rows[which]
        if not len(order):  # no array on a device is empty
            partners, states = np.zeros(1), np.zeros(1)
            eta, rows = np.zeros((1, self.variant.springs)), np.zeros((1, self.variant.row_width))
        return DevicePairArrays(
            cuda.to_device(start.astype(np.int64)),
            cuda.to_device(partners.astype(np.int32)),
            cuda.to_device(states.astype(np.uint8)),
            cuda.to_device(np.ascontiguousarray(eta)),
            cuda.to_device(np.ascontiguousarray(rows)),
        )

    def list_pairs(self, skin: float, film_reach: float) -> int:
        """Wrap, sort and list anew, memory carried along; returns the lowest id of a lost grain, or -1.

        Raises
        ------
        AssertionError : a pair in touch is not in the new list.
        """
        n, half = self.n, self.half
        grid, dims = self._grid(skin + film_reach)
        n_cell = int(np.prod(dims))
        grid, dims = cuda.to_device(grid), cuda.to_device(dims)
        self._hold_contacts()
        old, new, ids = self.bodies, self._spare, self.bodies.ids
        lost, missing = one(NO_GRAIN), one(NO_GRAIN)
        launch(kernels.wrap_grains, n, n, old.x[half], old.image, ids, grid, self.listed, lost)
        self._sort(self._places, n, n_cell, old.x[half], ids, grid, dims, self._first, self._order)
        still = len(self.active_fixed)
        if still:
            self._sort(
                self._still, still, n_cell, old.x[half], ids, grid, dims, self._first_fixed, self._fixed
            )
        launch(kernels.reorder, n, n, half, self._order, self._masses, old, new)
        self.bodies, self._spare = new, old
        half = self.half = 1 - half
        launch(kernels.copy_radii, n, n, half, new)

        start = self.pairs.start
        common = (
            n, self.n_solid, self.variant.plane_case, new.x[half], new.ids, self.walls, grid, dims,
            self._first, self._first_fixed, self._fixed, start,
        )  # fmt: skip
        launch(kernels.fill, n + 1, start, 0)
        launch(kernels.find_neighbours, n, 0, *common, self.pairs.partners)
        self._sum_up(start, n + 1)
        self.n_pair = int(start[n : n + 1].copy_to_host()[0])
        if self.n_pair > self.pairs.partners.shape[0]:
            self.pairs = self._room(0, start)  # frees the old arrays before the new ones are allocated
            self.pairs = self._room(self.n_pair, start)
        launch(kernels.find_neighbours, n, 1, *common, self.pairs.partners)
        launch(
            kernels.transfer_memory, n, n, self.n_solid, self.variant.rotation, self.variant.kind, half,
            self.c, self._order, new, self._held, self.pairs, missing,
        )  # fmt: skip
        grain = int(missing.copy_to_host()[0])
        if grain != NO_GRAIN:
            raise AssertionError(f"a pair of grain {grain} is in touch and not in the list")
        grain = int(lost.copy_to_host()[0])
        return -1 if grain == NO_GRAIN else grain

    def _hold_contacts(self) -> None:
        """Copy the pairs in contact, once, out of the list, which is then written anew."""
        n, start = self.n, self._held.start
        launch(kernels.fill, n + 1, start, 0)
        launch(kernels.count_touching, n, n, self.bodies.ids, self.pairs, start)
        self._sum_up(start, n + 1)
        total = int(start[n : n + 1].copy_to_host()[0])
        if total > self._held.partners.shape[0]:
            self._held = self._room(0, start)
            self._held = self._room(total, start)
        launch(kernels.hold_touching, n, n, self.bodies.ids, self.pairs, self._held)

    def _grid(self, reach: float) -> tuple[Floats, np.ndarray]:
        """Cells wide enough for a reach beyond touch [m], and no more than about two a grain."""
        scene = self.scene
        size = (2.0 * float(self.layout.r[: self.n_solid].max(initial=0.0)) + reach) * _MARGIN
        span = np.array([*scene.period, np.inf])
        closed = np.isfinite(span)
        low = np.where(closed, 0.0, self.extent[0])
        span = np.where(closed, span, self.extent[1] - self.extent[0])
        while True:
            dims = [math.floor(one / size) + (not shut) for one, shut in zip(span, closed, strict=True)]
            dims = [max(1, dim) for dim in dims]
            if math.prod(dims) <= self._most_cells:
                break
            size *= 1.26
        width = np.where(closed, span / dims, size)
        grid = np.concatenate([scene.period, scene.world_low, scene.world_high, low, width, [reach]])
        return grid, np.array(dims, np.int64)

    def _sort(
        self, places: Any, n: int, n_cell: int, x: Any, ids: Any, grid: Any, dims: Any, first: Any, order: Any
    ) -> None:
        """Order the grains at n places by cell, and by id within a cell."""
        launch(kernels.fill, n_cell + 1, first, 0)
        launch(kernels.fill, n_cell + 1, self._taken, 0)
        launch(kernels.count_cells, n, places, x, grid, dims, self._cell, first)
        self._sum_up(first, n_cell + 1)
        launch(kernels.fill_cells, n, places, self._cell, first, self._taken, order)
        launch(kernels.sort_cells, n_cell, n_cell, first, ids, order)

    def _sum_up(self, values: Any, n: int) -> None:
        """Turn values[:n] into the sums of those before each, chunks of chunks."""
        chunks = -(-n // kernels.CHUNK)
        before = cuda.to_device(np.zeros(chunks, np.int64))
        if chunks > 1:
            launch(kernels.sum_chunks, chunks, n, values, before)
            self._sum_up(before, chunks)
        launch(kernels.scan_chunks, chunks, n, values, before)

    def set_positions(self, x: Floats) -> None:
        """Put grains at x [m], by id, without wrapping or listing."""
        ids = self.ids()
        for half in (0, 1):
            all_x = self.bodies.x[half].copy_to_host()
            all_x[: self.n, :3] = x[ids]
            self.bodies.x[half].copy_to_device(all_x)

    def ids(self) -> np.ndarray:
        """Id of the free grain at each place."""
        return self.bodies.ids.copy_to_host()[: self.n]

    def by_id(self, name: str, ids: np.ndarray) -> np.ndarray:
        """One array of free grains, in the order of ids."""
        array = getattr(self.bodies, name)
        found = (array[self.half] if name in ("x", "v", "w", "n_touching") else array).copy_to_host()[
            : self.n
        ]
        out = np.empty_like(found)
        out[ids] = found
        return out

    def memory(self) -> ContactMemory:
        """Pairs in touch with their rows, in the order of ids."""
        n, count = self.n, cuda.to_device(np.zeros(self.n + 1, np.int64))
        launch(kernels.count_touching, n, n, self.bodies.ids, self.pairs, count)
        self._sum_up(count, n + 1)
        total = int(count[n : n + 1].copy_to_host()[0])
        room = max(total, 1)
        i, j = (cuda.to_device(np.zeros(room, np.int64)) for _ in range(2))
        states = cuda.to_device(np.zeros(room, np.uint8))
        eta, rows = (
            cuda.to_device(np.zeros((room, width)))
            for width in (self.variant.springs, self.variant.row_width)
        )
        launch(kernels.collect_touching, n, n, self.bodies.ids, self.pairs, count, i, j, states, eta, rows)
        i_ids, j_ids = i.copy_to_host()[:total], j.copy_to_host()[:total]
        order = np.lexsort((j_ids, i_ids))
        eta, rows = eta.copy_to_host()[:total], rows.copy_to_host()[:total]
        states = states.copy_to_host()[:total]
        return ContactMemory(i_ids[order], j_ids[order], states[order], eta[order], rows[order])
