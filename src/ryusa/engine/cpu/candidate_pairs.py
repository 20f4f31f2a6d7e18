"""The candidate pairs of a run: their arrays, and the schedule by which they are pruned."""

from collections.abc import Callable

import numpy as np

from ryusa.compiled.piece import Piece
from ryusa.engine.cpu import prune_schedule as K
from ryusa.engine.cpu.arrays import StepArrays, Workspace, workspace_of_thread
from ryusa.engine.cpu.prune import prune_blocks
from ryusa.engine.cpu.prune_schedule import ROUNDED_UP, steps_ahead
from ryusa.engine.cpu.verlet_list import (
    NAMED_BY_PLACE,
    BlockLayout,
    Share,
    copy_memory,
    count_memory,
    room_for_memory,
)
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_memory import ContactMemory
from ryusa.engine.shared.layout import film_reach

NOT_LISTED = "a pair in touch is not in the list"
_SKIN = 0.003  # first reach, over the smallest diameter
_LEAST = 1e-4  # smallest
_KEPT = 64 << 20  # room for memory that is kept from list to list [B]: new pages take time
_AHEAD = 20.0  # steps it should last at first


class CandidatePairs:
    """Pairs that may touch within the next few steps, pruned again while stepping (time_loop.py).

    Parameters
    ----------
    layout : of the scene.
    threads : number that prune at once.
    smallest : diameter [m].
    """

    def __init__(self, layout: BlockLayout, threads: int, smallest: float) -> None:
        blocks = len(layout.block_start) - 1
        self._layout, self._threads, self._smallest = layout, min(threads, blocks), smallest
        self._work: dict[int, Workspace] = {}  # by the first block of a thread
        self.schedule = np.zeros(K.N_SCHEDULE)
        self.schedule[K.SKIN], self.schedule[K.AHEAD] = _SKIN * smallest, _AHEAD
        self._free()

    def begin(
        self,
        prune: Piece,
        held: Callable[[int], StepArrays],
        skin: float,
        displacement: float,
        memory: list[ContactMemory],
        place_of: np.ndarray,
        share: Share,
    ) -> None:
        """Prune a new Verlet list, and move the memory of pairs in touch into it.

        Parameters
        ----------
        prune : the piece that prunes (prune.py).
        held : arrays of a step, with the list as it is when they are asked for.
        memory : in parts; the list is emptied.
        place_of : place of each grain that the memory names.
        skin : reach of the Verlet list beyond touch [m].
        displacement : of the fastest grain in the last step [m].
        share : distributes the blocks over threads.

        Raises
        ------
        AssertionError : a pair in touch is not in the Verlet list.
        """
        layout, schedule, variant = self._layout, self.schedule, self._layout.variant
        schedule[K.LEAST], schedule[K.MOST] = _LEAST * self._smallest, 0.5 * skin
        schedule[K.SKIN] = min(max(schedule[K.SKIN], schedule[K.LEAST]), schedule[K.MOST])
        schedule[K.APPROACH] = schedule[K.SINCE] = 0.0
        schedule[K.IMAGE_ROOM] = 0.5 * layout.period.min() - layout.largest - film_reach(layout.scene)
        schedule[K.LASTS] = steps_ahead(schedule, displacement)
        reach_on = ROUNDED_UP * float(schedule[K.SKIN]) + film_reach(layout.scene)
        ahead = float(schedule[K.LASTS] * held(0).c[P.DT])
        schedule[K.TOUCHING] = float(sum(len(one.i) for one in memory))
        self._make_room(np.diff(held(0).pairs.start[layout.block_start]))

        def prune_some(first: int, last: int) -> bool:
            work = self._work.get(first) or self._work.setdefault(first, workspace_of_thread())
            return prune_blocks(prune, first, last, reach_on, ahead, variant.plane_case, work, held(0))

        while True:
            if not all(share(prune_some)):
                raise AssertionError(NOT_LISTED)
            missing = layout.place_memory(place_of, self.pairs, memory, share)
            if missing is None:
                break
            if reach_on > skin + film_reach(layout.scene):
                names = [int(held(0).grains.ids[place_of[k]]) if k < layout.n else int(k) for k in missing]
                raise AssertionError(f"pair {names[0]}, {names[1]} is in touch and not in the list")
            reach_on *= 2.0  # somebody moved grains apart that a snapshot has in touch
        schedule[K.CANDIDATES] = float(self.pairs.count.sum())

    def take_memory(self, share: Share) -> list[ContactMemory]:
        """The memory of the pairs in touch, named by places, in parts; the list of candidates ends.

        Where there is much of it, each block is a part, and the room that it was in is freed.
        """
        pairs, count = self.pairs, count_memory(self.pairs, share)
        much = pairs.rows.nbytes > _KEPT

        def take_some(first: int, last: int) -> list[ContactMemory]:
            parts: list[ContactMemory] = []
            for a in range(first, last, 1 if much else last - first):
                b = a + 1 if much else last
                parts.append(room_for_memory(count[b] - count[a], pairs))
                copy_memory(a, b, NAMED_BY_PLACE, self._layout.n, pairs, parts[-1])
            return parts

        taken = [one for parts in share(take_some) for one in parts]
        pairs.count[:] = 0
        if much:
            self._free()
        return taken

    def _free(self) -> None:
        """Begin without pairs, and without room for any."""
        self.pairs = self._layout.empty_candidates(np.zeros(len(self._layout.block_start) - 1, np.int64))
        self.spares = [self._layout.room_for_touching(0) for _ in range(self._threads)]

    def _make_room(self, listed: np.ndarray) -> None:
        """Begin empty lists, with room for all pairs that the blocks have in the Verlet list."""
        if (np.diff(self.pairs.first) < listed).any():
            self._free()
            self.pairs = self._layout.empty_candidates(listed + listed // 8)
            most = int(np.diff(self.pairs.first).max())
            self.spares = [self._layout.room_for_touching(most) for _ in range(self._threads)]
