"""The near list of a run as the engine keeps it: its room, and the clock by which it is cut."""

import numpy as np

from ryusa.engine.arrays import Grains, Near, Pairs
from ryusa.engine.lanes import LANES
from ryusa.engine.listing import Layout, Memory, Share, film_reach
from ryusa.engine.near import cut_blocks
from ryusa.engine.rows import K_LANES, K_LEAST, K_MOST, K_SINCE, K_SKIN, K_TOUCHING, K_TRAVEL, N_CLOCK
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
        self.clock[K_SKIN] = _SKIN * smallest
        self.make_room(np.full(blocks, layout.n // blocks))

    def begin(
        self, grains: Grains, wide: Pairs, skin: float, travel: float, parted: float, numbers: Floats,
        memory: Memory, share: Share,
    ) -> None:  # fmt: skip
        """Cut from a new wide list, and lay in the memory of pairs in touch.

        Parameters
        ----------
        skin, travel : reach of the wide list beyond touch, and how far the fastest grain has gone since [m].
        parted : how far a pair in touch may have parted in the last step [m].
        share : has threads share the blocks.
        """
        layout, clock, kind = self._layout, self.clock, self._layout.kind
        clock[K_LEAST], clock[K_MOST] = _LEAST * self._smallest, 0.5 * skin
        clock[K_SKIN] = min(max(clock[K_SKIN], clock[K_LEAST]), clock[K_MOST])
        clock[K_TRAVEL], clock[K_SINCE] = travel, 0.0
        reach_on = max(float(clock[K_SKIN]), parted) + film_reach(layout.scene)
        self.pairs.count[:] = 0

        wanted = np.zeros(len(layout.block_start) - 1, np.int64)

        def cut_some(first: int, last: int) -> None:
            cut_blocks(
                first, last, layout.block_start, layout.n, layout.n_solid, reach_on, kind.plane_case, numbers,
                grains, layout.walls, wide, self.pairs, self.spares[0], wanted,
            )  # fmt: skip

        share(cut_some)
        while wanted.any():
            self.make_room(wanted)
            share(cut_some)
        layout.remember(grains, self.pairs, memory)
        clock[K_LANES], clock[K_TOUCHING] = float(self.pairs.count.sum()), float(len(memory.i))

    def make_room(self, wanted: np.ndarray) -> None:
        """Make room for so many pairs in each block, and some more; what is in the list stays.

        Raises
        ------
        AssertionError : a pair in touch was found beyond reach.
        """
        old, room, wanted = self.pairs, np.diff(self.pairs.first), wanted.astype(np.int64)
        if (wanted < 0).any():
            raise AssertionError("a pair in touch is not in the list")
        room = np.maximum(room, (wanted > 0) * (wanted + wanted // 8 + LANES))
        new = self._layout.room_for(room)
        many = self._layout.many_dashpots
        if not many:
            new.eta[:] = old.eta
        for b, have in enumerate(old.count):
            a, k = int(old.first[b]), int(new.first[b])
            for name in ("i", "j", "to", "pair", "live", "rows", *(("eta",) if many else ())):
                getattr(new, name)[k : k + have] = getattr(old, name)[a : a + have]
            new.count[b] = have
        self.pairs = new
        self.spares = [self._layout.room_for(room.max(keepdims=True)) for _ in range(self._threads)]
