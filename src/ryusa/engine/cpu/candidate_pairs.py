"""The candidate pairs of a run: their arrays, and the schedule by which they are pruned."""

from collections.abc import Callable

import numpy as np

from ryusa.compiled.piece import Piece
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu import prune_schedule as K
from ryusa.engine.cpu.arrays import CandidateArrays, StepArrays, Workspace, workspace_of_thread
from ryusa.engine.cpu.prune import prune_blocks
from ryusa.engine.cpu.prune_schedule import ROUNDED_UP, steps_ahead
from ryusa.engine.cpu.verlet_list import BlockLayout, Share
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_memory import ContactMemory
from ryusa.engine.shared.layout import film_reach

_SKIN = 0.003  # first reach, over the smallest diameter
_LEAST = 1e-4  # smallest
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
        self.pairs = layout.empty_candidates(np.zeros(blocks, np.int64))
        self.spares: list[CandidateArrays] = []
        self._work: dict[int, Workspace] = {}  # by the first block of a thread
        self.schedule = np.zeros(K.N_SCHEDULE)
        self.schedule[K.SKIN], self.schedule[K.AHEAD] = _SKIN * smallest, _AHEAD
        self.make_room(np.full(blocks, layout.n // blocks))

    def begin(
        self,
        prune: Piece,
        held: Callable[[int], StepArrays],
        skin: float,
        displacement: float,
        memory: ContactMemory,
        place_of: np.ndarray,
        share: Share,
    ) -> None:
        """Prune a new Verlet list, and copy the memory of pairs in touch into it.

        Parameters
        ----------
        prune : the piece that prunes (prune.py).
        held : arrays of a step, with the list as it is when they are asked for.
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
        wanted = np.zeros(len(layout.block_start) - 1, np.int64)

        def prune_some(first: int, last: int) -> None:
            work = self._work.get(first) or self._work.setdefault(first, workspace_of_thread())
            prune_blocks(prune, first, last, reach_on, ahead, variant.plane_case, work, held(0), wanted)

        while True:
            self.pairs.count[:] = 0
            share(prune_some)
            while wanted.any():
                self.make_room(wanted)
                share(prune_some)
            missing = layout.place_memory(place_of, self.pairs, memory, share)
            if missing < 0:
                break
            if reach_on > skin + film_reach(layout.scene):
                i, j = memory.i[missing], memory.j[missing]
                names = [int(held(0).grains.ids[place_of[k]]) if k < layout.n else int(k) for k in (i, j)]
                raise AssertionError(f"pair {names[0]}, {names[1]} is in touch and not in the list")
            reach_on *= 2.0  # somebody moved grains apart that a snapshot has in touch
        schedule[K.CANDIDATES], schedule[K.TOUCHING] = float(self.pairs.count.sum()), float(len(memory.i))

    def make_room(self, wanted: np.ndarray) -> None:
        """Make room for so many pairs in each block, and some more; what is in the list stays.

        Raises
        ------
        AssertionError : a pair in touch was found beyond reach.
        """
        old, room, wanted = self.pairs, np.diff(self.pairs.first), wanted.astype(np.int64)
        if (wanted < 0).any():
            raise AssertionError("a pair in touch is not in the list")
        room = np.maximum(room, (wanted > 0) * (wanted + wanted // 8 + B.LANES))
        new = self._layout.empty_candidates(room)
        many = self._layout.many_dashpots
        if not many:
            new.eta[:] = old.eta
        for b, have in enumerate(old.count):
            a, k = int(old.first[b]), int(new.first[b])
            for name in ("i", "j", "target", "index", "touching", "rows", *(("eta",) if many else ())):
                getattr(new, name)[k : k + have] = getattr(old, name)[a : a + have]
            new.count[b] = have
        self.pairs = new
        self.spares = [self._layout.empty_candidates(room.max(keepdims=True)) for _ in range(self._threads)]
