"""The near list of a run as the engine keeps it: its room, and the clock by which it is cut."""

import numpy as np

from ryusa.engine.arrays import Grains, Near, Pairs
from ryusa.engine.lanes import LANES
from ryusa.engine.listing import Layout, Memory, film_reach
from ryusa.engine.near import cut
from ryusa.engine.rows import K_LANES, K_LEAST, K_MOST, K_SINCE, K_SKIN, K_TRAVEL, K_WAY, N_CLOCK
from ryusa.model.scene import Floats

_SKIN = 0.01  # first reach, over the smallest diameter
_LEAST = 1e-4  # smallest


class NearList:
    """Pairs that may touch within the next few steps, cut anew while stepping (engine/march.py).

    Parameters
    ----------
    layout : of the scene.
    threads : how many cut at once.
    smallest : diameter [m].
    """

    def __init__(self, layout: Layout, threads: int, smallest: float) -> None:
        blocks = len(layout.block_start) - 1
        self._layout, self._threads, self._smallest = layout, min(threads, blocks), smallest
        self.pairs = layout.room_for(np.zeros(blocks, np.int64))
        self.spares: list[Near] = []
        self.clock = np.zeros(N_CLOCK)
        self.clock[K_SKIN], self.clock[K_WAY] = _SKIN * smallest, 1.25
        self.make_room()

    def begin(
        self, grains: Grains, wide: Pairs, skin: float, travel: float, parted: float, numbers: Floats,
        memory: Memory,
    ) -> None:  # fmt: skip
        """Cut from a new wide list, and lay in the memory of pairs in touch.

        Parameters
        ----------
        skin, travel : reach of the wide list beyond touch, and how far the fastest grain has gone since [m].
        parted : how far a pair in touch may have parted in the last step [m].
        """
        layout, clock, kind = self._layout, self.clock, self._layout.kind
        clock[K_LEAST], clock[K_MOST] = _LEAST * self._smallest, 0.5 * skin
        clock[K_SKIN] = min(max(clock[K_SKIN], clock[K_LEAST]), clock[K_MOST])
        clock[K_TRAVEL], clock[K_SINCE] = travel, 0.0
        reach_on = max(float(clock[K_SKIN]), parted) + film_reach(layout.scene)
        self.pairs.count[:] = 0
        for b, (lo, hi) in enumerate(zip(layout.block_start[:-1], layout.block_start[1:], strict=True)):
            while not cut(
                b, lo, hi, layout.n, layout.n_solid, reach_on, kind.plane_case, kind.rotation, numbers,
                grains, layout.walls, wide, self.pairs, self.spares[0],
            ):  # fmt: skip
                self.make_room()
        layout.remember(grains, self.pairs, memory)
        clock[K_LANES] = float(self.pairs.count.sum())

    def make_room(self) -> None:
        """Half as much room again in every block, and at least one pair a grain."""
        old, count = self.pairs, self.pairs.count
        room = np.maximum(np.diff(old.first) * 3 // 2, self._layout.n // len(count) + LANES)
        new = self._layout.room_for(room)
        for b, have in enumerate(count):
            a, k = int(old.first[b]), int(new.first[b])
            for name in ("i", "j", "to", "pair", "live", "eta", "rows"):
                getattr(new, name)[k : k + have] = getattr(old, name)[a : a + have]
            new.count[b] = have
        self.pairs = new
        self.spares = [self._layout.room_for(room.max(keepdims=True)) for _ in range(self._threads)]
