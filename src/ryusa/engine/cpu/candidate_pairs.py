"""The near list of a run as the engine keeps it: its room, and the clock by which it is cut."""

import numpy as np

from ryusa.engine.cpu.arrays import Grains, Near, Pairs, workplace
from ryusa.engine.cpu.batch_layout import LANES
from ryusa.engine.cpu.prune import cut_blocks, steps_ahead
from ryusa.engine.cpu.verlet_list import Layout, Memory, Share, film_reach
from ryusa.engine.shared.rows import (
    C_DT,
    K_AHEAD,
    K_LANES,
    K_LASTS,
    K_LEAST,
    K_MOST,
    K_ROOM,
    K_SINCE,
    K_SKIN,
    K_STRAY,
    K_TOUCHING,
    N_CLOCK,
    ROUNDED_UP,
)
from ryusa.model.scene import Floats

_SKIN = 0.003  # first reach, over the smallest diameter
_LEAST = 1e-4  # smallest
_AHEAD = 20.0  # steps it should last at first


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
        self.clock[K_SKIN], self.clock[K_AHEAD] = _SKIN * smallest, _AHEAD
        self.make_room(np.full(blocks, layout.n // blocks))

    def begin(
        self, grains: Grains, wide: Pairs, skin: float, way: float, numbers: Floats, memory: Memory,
        share: Share,
    ) -> None:  # fmt: skip
        """Cut from a new wide list, and lay in the memory of pairs in touch.

        Parameters
        ----------
        skin : reach of the wide list beyond touch [m].
        way : how far the fastest grain went in the last step [m].
        share : has threads share the blocks.

        Raises
        ------
        AssertionError : a pair in touch is not in the wide list.
        """
        layout, clock, kind = self._layout, self.clock, self._layout.kind
        clock[K_LEAST], clock[K_MOST] = _LEAST * self._smallest, 0.5 * skin
        clock[K_SKIN] = min(max(clock[K_SKIN], clock[K_LEAST]), clock[K_MOST])
        clock[K_STRAY] = clock[K_SINCE] = 0.0
        clock[K_ROOM] = 0.5 * layout.period.min() - layout.largest - film_reach(layout.scene)
        clock[K_LASTS] = steps_ahead(clock, way)
        reach_on = ROUNDED_UP * float(clock[K_SKIN]) + film_reach(layout.scene)
        ahead = float(clock[K_LASTS] * numbers[C_DT])
        wanted = np.zeros(len(layout.block_start) - 1, np.int64)

        def cut_some(first: int, last: int) -> None:
            cut_blocks(
                first, last, layout.block_start, layout.n, layout.n_solid, reach_on, ahead, kind.plane_case,
                numbers, grains, layout.walls, wide, self.pairs, self.spares[0], workplace(), wanted,
            )  # fmt: skip

        while True:
            self.pairs.count[:] = 0
            share(cut_some)
            while wanted.any():
                self.make_room(wanted)
                share(cut_some)
            missing = layout.remember(grains, self.pairs, memory)
            if missing < 0:
                break
            if reach_on > skin + film_reach(layout.scene):
                raise AssertionError(
                    f"pair {memory.i[missing]}, {memory.j[missing]} is in touch and not in the list"
                )
            reach_on *= 2.0  # somebody moved grains apart that a snapshot has in touch
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
