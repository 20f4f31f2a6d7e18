"""Lay grains out in cell order and list their pairs; the memory of touching pairs comes along."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ryusa.engine.cpu.arrays import Grains, Near, Pairs, Walls, aligned
from ryusa.engine.cpu.batch_layout import LANES
from ryusa.engine.cpu.block_exchange import cross_lists, wrap_grains
from ryusa.engine.cpu.cell_list import build_list, grid_of, sort_into
from ryusa.engine.cpu.prune import count_live, put_rows, take_rows
from ryusa.engine.shared.rows import Variant
from ryusa.model import Scene, State
from ryusa.model.enums import Damping, Profile, Rebound
from ryusa.model.fluid import Immersed
from ryusa.model.scene import Floats

Share = Callable[
    [Callable[[int, int], Any]], list[Any]
]  # results of a task for blocks first..last-1, in order


_CACHED = 8192  # grains that a cache holds: more have to be asked for in time


class Memory(NamedTuple):
    """Touching pairs by id, with their dashpots and rows (rows.py)."""

    i: np.ndarray
    j: np.ndarray
    eta: Floats
    rows: Floats


class Layout:
    """What of a scene the list needs, by id, and how to lay it out."""

    def __init__(self, scene: Scene, blocks: int, kind: Variant) -> None:
        n, n_fixed, n_plane = scene.n_grain, scene.n_fixed, scene.n_plane
        self.n, self.n_solid, self.kind = n, n + n_fixed, kind
        inf = np.full(n_fixed + n_plane, np.inf)
        self.r = np.concatenate([0.5 * scene.d, 0.5 * scene.d_fixed, np.full(n_plane, np.inf)])
        self.largest = 2.0 * float(self.r[: self.n_solid].max(initial=0.0))
        self.m = np.concatenate([scene.m + scene.m_added, inf])
        self.inertia = np.concatenate([scene.inertia, inf])
        self.tracked = scene.tracked if len(scene.tracked) == n else np.zeros(n, np.bool_)
        law, water = scene.contact, scene.water
        self.many_dashpots = law.damping != Damping.CONSTANTS or water.rebound != Rebound.DRY
        self.period, self.scene = np.array(scene.period), scene
        self.low, self.high = np.array(scene.world_low), np.array(scene.world_high)
        self.block_start = np.arange(blocks + 1) * n // blocks
        self.walls = Walls(
            np.ascontiguousarray(scene.plane_normal, dtype=np.float64).reshape(-1, 3),
            np.ascontiguousarray(scene.plane_point, dtype=np.float64).reshape(-1, 3),
        )
        # fixed grains are listed from where they stand inside the period
        self.x_fixed = np.array(scene.x_fixed, dtype=np.float64).reshape(-1, 3)
        for k in np.flatnonzero(np.isfinite(self.period)):
            self.x_fixed[:, k] %= self.period[k]
        self.standing = np.flatnonzero(scene.fixed_active)

    def empty_pairs(self) -> Pairs:
        """A list without pairs."""
        none = np.zeros(0, np.int64)
        return Pairs(
            0, np.zeros(self.n + 1, np.int64), np.zeros(0, np.uint32), none, np.zeros(0, np.uint32),
            np.zeros(0, np.uint8), none, none, aligned(0, 8),
        )  # fmt: skip

    def room_for(self, pairs: np.ndarray) -> Near:
        """An empty near list with room for so many pairs in each block."""
        first = np.concatenate([[0], np.cumsum(pairs)])
        total = int(first[-1])
        i, j, to, pair = (np.zeros(total, np.uint32) for _ in range(4))
        live, rows = np.zeros(total, np.uint8), aligned(total, self.kind.row_width)
        eta = np.zeros((total if self.many_dashpots else 1, 2))
        return Near(first, np.zeros(len(pairs), np.int64), i, j, to, pair, live, eta, rows)

    def by_id(self, state: State) -> Grains:
        """Arrays of a state, still in the order of ids."""
        n, scene = self.n, self.scene
        still = np.zeros((len(self.r) - n, 3))
        image = np.array(state.image, dtype=np.int32) if len(state.image) == n else np.zeros((n, 2), np.int32)
        spin = state.omega if scene.rotation else np.zeros((n, 3))
        none = Immersed(np.zeros((0, 0)), np.zeros((0, 0)))
        if scene.water.profile == Profile.COLUMN:
            none = Immersed.still(n)
        immersed = state.immersed or none
        x, v, w = _vectors(len(self.r))
        x[:, :3] = np.vstack([state.x, self.x_fixed, still[len(self.x_fixed) :]])
        v[:n, :3], w[:n, :3] = state.v, spin
        x[:, 3] = w[:, 3] = self.r
        return Grains(
            x=x,
            v=v,
            then=aligned(n, 4),
            w=w,
            m=self.m,
            m_bare=scene.m,
            m_weight=scene.m_weight,
            inertia=self.inertia,
            per_m=1.0 / self.m[:n],
            per_inertia=1.0 / self.inertia[:n],
            ids=np.arange(self.n_solid),
            image=image,
            tracked=self.tracked,
            touched=np.zeros(n, np.int32),
            film=np.zeros((0, 0)),
            seen=np.array(immersed.seen),
            taken=np.array(immersed.taken),
        )

    def unsorted(self, grains: Grains) -> Grains:
        """The arrays that move, back in the order of ids."""
        n = self.n
        back = np.argsort(grains.ids[:n])
        moved: dict[str, Any] = {}
        for name in ("x", "v", "w"):
            moved[name] = getattr(grains, name)
            moved[name][:n] = moved[name][:n][back]
        wet = back[: len(grains.seen)]
        return grains._replace(
            **moved,
            image=grains.image[back],
            touched=grains.touched[back],
            ids=np.arange(self.n_solid),
            seen=grains.seen[wet],
            taken=grains.taken[wet],
        )

    def list_pairs(
        self, by_id: Grains, starts: np.ndarray, skin: float, share: Share
    ) -> tuple[Grains, Pairs, Floats, int]:
        """Wrap, sort and list.

        Parameters
        ----------
        by_id : arrays in the order of ids; positions are brought inside the period.
        starts : of the old list, which tells how much room the new one may need.
        skin : reach of the list beyond touch and films [m].
        share : has threads share the blocks.

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
        first, order = sort_into(x, n, grid)
        place = np.arange(len(self.r))
        place[:n] = order
        for array in (x, by_id.v, by_id.w):  # in place: there may be a million of them
            array[:n] = array[order]
        grains = by_id._replace(
            m=self.m[place],
            m_bare=scene.m[order],
            m_weight=scene.m_weight[order],
            inertia=self.inertia[place],
            per_m=1.0 / self.m[order],
            per_inertia=1.0 / self.inertia[order],
            ids=place[: self.n_solid].copy(),
            image=by_id.image[order],
            touched=by_id.touched[order],
            seen=by_id.seen[order[: len(by_id.seen)]],
            taken=by_id.taken[order[: len(by_id.seen)]],
        )
        bed = np.ascontiguousarray(self.x_fixed[self.standing])
        bed_grid = grid_of(bed, len(bed), size, period)
        bed_first, bed_order = sort_into(bed, len(bed), bed_grid)
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
        cross_start, crossing, incoming_start, incoming = cross_lists(n, self.block_start, start, partners)
        rows = n + len(self.block_start) - 1 + len(crossing)
        slab = int(1.1 * n / grid[2][0]) + LANES if n > _CACHED else n
        grains = grains._replace(film=np.zeros((rows, 4) if self.kind.film else (0, 0)))
        return (
            grains,
            Pairs(
                slab, start, partners, cross_start, crossing, np.zeros(rows, np.uint8), incoming_start,
                incoming, aligned(rows, 8),
            ),
            listed,
            lost,
        )  # fmt: skip

    def remember(self, grains: Grains, near: Near, memory: Memory) -> int:
        """Lay the memory of touching pairs into a near list; returns the first that is not in it, or -1."""
        index = np.empty(self.n, np.int64)
        index[grains.ids[: self.n]] = np.arange(self.n)
        block_of = np.repeat(np.arange(len(near.count)), np.diff(self.block_start))
        return int(put_rows(self.n, near, block_of, index, *memory))


def _vectors(n: int) -> tuple[Floats, Floats, Floats]:
    """Room for x, v and w of n places (arrays.Grains); v and w share a line."""
    both = aligned(n, 8)
    return aligned(n, 4), both[:, :4], both[:, 4:]


def film_reach(scene: Scene) -> float:
    """Gap below which films resist [m]; 0 where there are none."""
    return 0.0 if scene.water.profile == Profile.NONE else scene.water.film_reach


def take_memory(n: int, grains: Grains, near: Near) -> Memory:
    """Copy ids and rows of all pairs in touch, in list order."""
    count = count_live(near)
    width = near.rows.shape[1]
    i, j = np.empty(count, np.int64), np.empty(count, np.int64)
    memory = Memory(i, j, np.empty((count, 2)), np.empty((count, width)))
    take_rows(n, near, grains.ids, *memory)
    return memory
