"""Lay grains out in cell order and list their pairs; the memory of touching pairs comes along."""

from typing import Any, NamedTuple

import numpy as np

from ryusa.engine.arrays import Grains, Pairs, Walls
from ryusa.engine.carry import count_live, cross_lists, put_rows, take_rows, wrap_grains
from ryusa.engine.cells import build_list, grid_of, sort_into
from ryusa.model import Scene, State
from ryusa.model.enums import Profile
from ryusa.model.immersed import Immersed
from ryusa.model.scene import Floats


class Memory(NamedTuple):
    """Touching pairs by id, with their rows (rows.py)."""

    i: np.ndarray
    j: np.ndarray
    rows: Floats


class Layout:
    """What of a scene the list needs, by id, and how to lay it out."""

    def __init__(self, scene: Scene, blocks: int, width: int) -> None:
        n, n_fixed, n_plane = scene.n_grain, scene.n_fixed, scene.n_plane
        self.n, self.n_solid, self.width = n, n + n_fixed, width
        inf = np.full(n_fixed + n_plane, np.inf)
        self.r = np.concatenate([0.5 * scene.d, 0.5 * scene.d_fixed, np.full(n_plane, np.inf)])
        self.m = np.concatenate([scene.m + scene.m_added, inf])
        self.inertia = np.concatenate([scene.inertia, inf])
        self.tracked = scene.tracked if len(scene.tracked) == n else np.zeros(n, np.bool_)
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
        live, touch = np.zeros(0, np.uint8), np.zeros(0, np.uint8)
        return Pairs(
            np.zeros(self.n + 1, np.int64), np.zeros(0, np.int32), live, np.zeros((0, self.width)),
            np.zeros(len(self.block_start), np.int64), np.zeros((0, 6)), touch,
            np.zeros(self.n + 1, np.int64), none,
        )  # fmt: skip

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
        return Grains(
            x=np.vstack([state.x, self.x_fixed]),
            v=np.vstack([state.v, still]),
            w=np.vstack([spin, still]),
            r=self.r,
            m=self.m,
            m_bare=scene.m,
            m_weight=scene.m_weight,
            inertia=self.inertia,
            ids=np.arange(self.n_solid),
            image=image,
            tracked=self.tracked,
            f=np.zeros((n, 3)),
            torque=np.zeros((n, 3)),
            film=np.zeros((n, 3) if film_reach(scene) > 0.0 else (0, 0)),
            touches=np.zeros(n, np.int32),
            touched=np.zeros(n, np.int32),
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
        self, by_id: Grains, pairs: Pairs, skin: float, memory: Memory
    ) -> tuple[Grains, Pairs, Floats, int]:
        """Wrap, sort and list.

        Parameters
        ----------
        by_id : arrays in the order of ids; positions are brought inside the period.
        pairs : the old list, whose arrays are used again where they are large enough.
        skin : reach of the list beyond touch and films [m].
        memory : pairs in touch.

        Returns
        -------
        Grains in cell order, the new list, the positions it was built from [m] (by id), and the first
        grain outside the world or -1.
        """
        n, scene, period = self.n, self.scene, self.period
        x = by_id.x
        lost = int(wrap_grains(x[:n], by_id.image, period, self.low, self.high))
        listed = x[:n].copy()
        skin = skin + film_reach(scene)
        size = 2.0 * float(self.r[: self.n_solid].max(initial=0.0)) + skin
        low, wide, dims = grid_of(x, n, size, period)
        order = np.empty(n, np.int64)
        first = sort_into(x, n, low, wide, dims, order)
        place = np.arange(len(self.r))
        place[:n] = order
        grains = by_id._replace(
            x=x[place[: self.n_solid]],
            v=by_id.v[place],
            w=by_id.w[place],
            r=self.r[place],
            m=self.m[place],
            m_bare=scene.m[order],
            m_weight=scene.m_weight[order],
            inertia=self.inertia[place],
            ids=place[: self.n_solid].copy(),
            image=by_id.image[order],
            touched=by_id.touched[order],
            seen=by_id.seen[order[: len(by_id.seen)]],
            taken=by_id.taken[order[: len(by_id.seen)]],
        )
        bed = np.ascontiguousarray(self.x_fixed[self.standing])
        bed_low, bed_wide, bed_dims = grid_of(bed, len(bed), size, period)
        bed_order = np.empty(len(bed), np.int64)
        bed_first = sort_into(bed, len(bed), bed_low, bed_wide, bed_dims, bed_order)
        free = (low, wide, dims, first, np.arange(n))
        fixed = (bed_low, bed_wide, bed_dims, bed_first, self.standing[bed_order])
        start, partners, live, mem = pairs.start, pairs.partners, pairs.live, pairs.mem
        while True:
            used = build_list(
                grains.x, grains.r, grains.ids, n, self.n_solid, self.walls, scene.plane_active,
                free, fixed, period, skin, scene.plane_case, start, partners,
            )  # fmt: skip
            if used <= len(partners):
                break
            room = int(1.2 * used) + 64
            partners, live, mem = (
                np.zeros(room, np.int32),
                np.zeros(room, np.uint8),
                np.zeros((room, self.width)),
            )
        live[:used] = 0
        index = np.empty(n, np.int64)
        index[order] = np.arange(n)
        missing = put_rows(n, start, partners, live, mem, index, memory.i, memory.j, memory.rows)
        if missing >= 0:
            raise AssertionError(
                f"pair {memory.i[missing]}, {memory.j[missing]} is in touch and not in the list"
            )
        react_start, incoming_start, incoming = cross_lists(n, self.block_start, start, partners)
        crossing = int(react_start[-1])
        return (
            grains,
            Pairs(
                start, partners, live, mem, react_start, np.zeros((crossing, 6)),
                np.zeros(crossing, np.uint8),
                incoming_start, incoming,
            ),
            listed,
            lost,
        )  # fmt: skip


def film_reach(scene: Scene) -> float:
    """Gap below which films resist [m]; 0 where there are none."""
    return 0.0 if scene.water.profile == Profile.NONE else scene.water.film_reach


def take_memory(n: int, grains: Grains, pairs: Pairs) -> Memory:
    """Copy ids and rows of all pairs in touch, in list order."""
    count = count_live(int(pairs.start[n]), pairs.live)
    memory = Memory(
        np.empty(count, np.int64), np.empty(count, np.int64), np.empty((count, pairs.mem.shape[1]))
    )
    take_rows(n, pairs.start, pairs.partners, pairs.live, pairs.mem, grains.ids, *memory)
    return memory
