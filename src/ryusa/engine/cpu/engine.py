"""The CPU engine: owns the arrays, has the neighbour list rebuilt, lets compiled threads march in between."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from ryusa.engine.cpu.arrays import Ledger, workplace
from ryusa.engine.cpu.candidate_pairs import NearList
from ryusa.engine.cpu.prune import best_skin
from ryusa.engine.cpu.time_loop import make_run
from ryusa.engine.cpu.verlet_list import Layout, Memory, take_memory
from ryusa.engine.protocol import Flags
from ryusa.engine.shared.contact_memory import closed_records, contacts_of, memory_of
from ryusa.engine.shared.energy_account import begin_account, book_start, extremes_of, read_account, tally_of
from ryusa.engine.shared.entry import events_of, refuse_misfit, still_there
from ryusa.engine.shared.faults import fault_of, lost_of, unsafe_of
from ryusa.engine.shared.numbers import choice_of, energy_of_switch, numbers_of, variant_of
from ryusa.engine.shared.refusals import refusals
from ryusa.engine.shared.rows import (
    C_DT,
    C_SKIN,
    C_T_ZERO,
    COST_LOOK,
    N_BOOKS,
    N_FULL,
    N_N_ENDED,
    N_NOW,
    N_PEND_FLOW,
    N_SPEED_MAX,
    PENDING,
    STOP_EVENTS,
    STOP_LIST,
    STOP_ROOM,
    STOP_UNSAFE,
)
from ryusa.errors import RunError
from ryusa.model import Book, Immersed, Scene, State, Tally
from ryusa.model.contacts import N_EVENT
from ryusa.model.enums import EventRule
from ryusa.model.fluid import SHARE
from ryusa.model.scene import Floats
from ryusa.model.tally import N_BOOK

_MANY = 256  # grains from which work is cut into blocks
_RECORDS = 256  # room for ended contacts in a block, beside one a grain
_BLOCKS = 4, 32  # at least and at most; in between one for 2048 grains, a power of two
# Measured, and fixed so that a run never depends on a clock: cost of a wide list [ns], and how often it is
# looked through.
_LIST, _LIST_GRAIN, _STEPS_A_CUT = 300_000.0, 600.0, 16.0


class CpuEngine:
    """Steps a scene on the CPU; the same bits for any number of threads and any split into calls.

    Parameters
    ----------
    threads : threads that share a step; more than there are blocks (`blocks_of`) are idle.
    skin : first reach of the neighbour list beyond touch, over the smallest diameter [-]; adapts to
    counted work.
    """

    def __init__(self, threads: int = 1, skin: float = 0.1) -> None:
        if threads < 1:
            raise ValueError(f"threads = {threads}: at least 1")
        self._threads, self._skin_first = threads, skin
        self._work = [workplace() for _ in range(threads)]
        others = threads - 1  # the caller works too
        self._pool = ThreadPoolExecutor(others, thread_name_prefix="ryusa") if others else None
        self._drained: list[np.ndarray] = []
        self._scene: Scene | None = None

    def refuses(self, scene: Scene) -> tuple[str, ...]:
        """Reasons why this engine cannot carry the scene; () when it can."""
        return refusals(scene)

    def load(self, scene: Scene, state: State) -> None:
        """Take a scene and a fresh state or a snapshot; a scene changed on the way is booked."""
        reasons = self.refuses(scene)
        if reasons:
            raise ValueError("; ".join(reasons))
        refuse_misfit(scene, state)
        n = scene.n_grain
        before, self._scene = self._scene, scene
        changed = before is not None and before is not scene and state.step > 0
        self._n, self._step, self._t = n, state.step, state.t
        self._variant = variant_of(scene)
        self._choice = choice_of(scene)
        self._run = make_run(self._variant)
        blocks = blocks_of(n)
        self._layout = Layout(scene, blocks, self._variant)
        self._numbers = numbers_of(scene)
        self._smallest = float(np.concatenate([scene.d, scene.d_fixed]).min(initial=np.inf))
        self._numbers[C_T_ZERO] = state.t - state.step * scene.dt
        records = (n // blocks + _RECORDS, N_EVENT) if scene.events != EventRule.NONE else (1, 1)
        self._ledger = Ledger(
            np.zeros((blocks, *records)), np.zeros((blocks, N_BOOKS)), np.zeros((blocks, N_NOW))
        )
        self._relisted = 0
        self._read_own(state)

        contacts, dropped = still_there(scene, state.contacts)
        self._drained = self._drained if changed else []
        if before is not None and changed:
            self._ledger.books[0, Book.SWITCH] += energy_of_switch(before, scene, state, dropped)
            self._drained.append(closed_records(state, dropped))
        memory = memory_of(contacts, self._variant, self._choice, self._numbers, self._layout)
        by_id = self._layout.by_id(state)
        for touching in (contacts.i, contacts.j[contacts.j < n]):
            np.add.at(by_id.touched, touching, 1)
        resumed = state.x_listed is not None and not changed and not len(dropped)
        if resumed:
            by_id.x[:n, :3] = state.x_listed
        self._travel = state.engine.get("travel", 0.0) if resumed else 0.0
        self._grains, self._pairs, self._x_listed, _ = self._layout.list_pairs(
            by_id, self._layout.empty_pairs().start, self._skin, self._share
        )
        if resumed:
            self._grains.x[:n, :3] = state.x[self._grains.ids[:n]]
        self._numbers[C_SKIN] = self._skin
        self._near = NearList(self._layout, self._threads, self._smallest)
        self._cut_near(memory)
        if state.step == 0:
            begin_account(scene, state, self._ledger.now, self._ledger.books)

    def advance(self, n_steps: int) -> Flags:
        """Do n_steps steps, fewer if a fault stops the run."""
        if n_steps > 0 and self._step == 0:
            flags = self._march(1)
            book_start(self._ledger.now, self._ledger.books)
            if flags:
                return flags
            n_steps -= 1
        return self._march(n_steps)

    def grains(self) -> State:
        """Where grains are and how they move, without contacts and books: a frame."""
        n, grains = self._n, self._grains
        back = np.argsort(grains.ids[:n])
        return State(
            x=grains.x[:n, :3][back],
            v=grains.v[:n, :3][back],
            omega=grains.w[:n, :3][back],
            step=self._step,
            t=self._t,
            image=grains.image[back],
        )

    def state(self) -> State:
        """Read-only snapshot: all that an exact resume needs."""
        n, grains = self._n, self._grains
        back = np.argsort(grains.ids[:n])
        books = self._ledger.books.copy()
        books[:, N_BOOK : N_BOOK + len(PENDING)] = self._ledger.now[:, PENDING]
        contacts = contacts_of(take_memory(n, grains, self._near.pairs), self._variant)
        state = replace(
            self.grains(),
            contacts=contacts,
            books=books,
            x_listed=self._x_listed.copy(),
            immersed=Immersed(grains.seen[back], grains.taken[back]) if self._variant.column else None,
            engine=self._own(),
        )
        wet = vars(state.immersed).values() if state.immersed else ()
        for array in (
            state.x, state.v, state.omega, state.image, state.books, *vars(contacts).values(), *wet,
        ):  # fmt: skip
            array.flags.writeable = False
        return state

    def drift(self) -> tuple[Floats, Floats, Floats]:
        """Centres [m], velocities [m/s] and what was taken from the water (model.fluid), by id."""
        n, ids = self._n, self._grains.ids[: self._n]
        x, v, taken = np.empty((n, 3)), np.empty((n, 3)), np.empty(self._grains.taken.shape)
        x[ids], v[ids] = self._grains.x[:n, :3], self._grains.v[:n, :3]
        taken[ids[: len(taken)]] = self._grains.taken
        return x, v, taken

    def immerse(self, seen: Floats) -> None:
        """Tell every grain its water for the steps to come, and begin to count its impulse anew.

        Parameters
        ----------
        seen : by id, columns of `model.fluid`, shape (n_grain, N_SEEN).

        Raises
        ------
        ValueError : the scene has no column of water, or the shape is another.
        """
        if not self._variant.column:
            raise ValueError("the scene has no column of water: water.profile is not COLUMN")
        if seen.shape != self._grains.seen.shape:
            raise ValueError(f"seen has shape {seen.shape}, not {self._grains.seen.shape}")
        grains, ids = self._grains, self._grains.ids[: self._n]
        more = seen[ids, SHARE] - grains.seen[:, SHARE]
        if self._step and more.any():  # energy of the water that moves along with a grain, or no longer does
            added = grains.m[: self._n] - grains.m_bare[: self._n]
            gain = np.zeros(self._n)
            gain[ids] = 0.5 * added * more * np.sum(grains.v[: self._n, :3] ** 2, axis=1)
            self._ledger.now[0, N_PEND_FLOW] += float(gain.sum())
        grains.seen[:] = seen[ids]
        grains.taken[:] = 0.0

    def tally(self) -> Tally:
        """Energy account and extremes at the moment of the last force evaluation."""
        t = float(self._t - self._numbers[C_DT]) if self._step else self._t
        return tally_of(t, self._ledger.now, self._ledger.books)

    def events(self) -> np.ndarray:
        """Contacts ended since last asked, in order of parting."""
        self._drain()
        rows = np.concatenate(self._drained) if self._drained else np.zeros((0, N_EVENT))
        self._drained = []
        return events_of(rows)

    def _march(self, n_steps: int) -> Flags:
        layout, threads = self._layout, min(self._threads, len(self._layout.block_start) - 1)
        while n_steps > 0:
            arguments = (
                threads, n_steps, self._step, self._travel, np.zeros(1, np.int64), self._numbers,
                layout.block_start, self._n, layout.n_solid, self._grains, layout.walls, self._pairs,
                self._near.pairs,
            )  # fmt: skip
            more = (self._choice, self._near.clock)
            others = (
                [
                    self._pool.submit(
                        self._run, k, *arguments, self._near.spares[k], self._ledger, self._work[k], *more
                    )
                    for k in range(1, threads)
                ]
                if self._pool
                else []
            )
            done, self._travel, stop = self._run(
                0, *arguments, self._near.spares[0], self._ledger, self._work[0], *more
            )
            for other in others:
                other.result()
            self._step += done
            self._since += done
            n_steps -= done
            self._t = float(self._numbers[C_T_ZERO] + self._step * self._numbers[C_DT])
            if stop == STOP_LIST:
                fault = self._relist()
                if fault is not None:
                    return Flags(fault)
            elif stop == STOP_ROOM:
                self._near.make_room(self._ledger.now[:, N_FULL])
            elif stop == STOP_EVENTS:
                self._drain()
            elif stop == STOP_UNSAFE:
                return Flags(
                    unsafe_of(self._grains, self._n, self._numbers, self._smallest, self._step, self._t)
                )
            elif stop:
                return Flags(fault_of(self._ledger.now, self._numbers, self._step - 1))
        return Flags()

    def _relist(self) -> RunError | None:
        """Choose a skin from counted work, bring grains back into the period, and list pairs anew."""
        memory = take_memory(self._n, self._grains, self._near.pairs)
        apart = float(self._pairs.start[-1]) - len(memory.i)  # from counts that a resumed run has too
        skin = best_skin(
            self._skin, 2.0 * self._travel / max(self._since, 1), _LIST + _LIST_GRAIN * self._n,
            COST_LOOK * apart / _STEPS_A_CUT,
        )  # fmt: skip
        # pairs in touch may have parted in the last step: their account is still to be closed
        parted = 2.001 * self._way()
        self._skin = max(min(max(skin, 0.02 * self._smallest), self._smallest), parted)
        self._since, self._travel, self._relisted = 0, 0.0, self._relisted + 1
        starts, self._pairs = self._pairs.start, self._layout.empty_pairs()  # frees the old list
        by_id = self._layout.unsorted(self._grains)
        self._grains, self._pairs, self._x_listed, lost = self._layout.list_pairs(
            by_id, starts, self._skin, self._share
        )
        self._cut_near(memory)
        self._numbers[C_SKIN] = self._skin
        return lost_of(self._grains, lost, self._step, self._t) if lost >= 0 else None

    def _cut_near(self, memory: Memory) -> None:
        self._near.begin(
            self._grains, self._pairs, self._skin, self._way(), self._numbers, memory,
            self._share,
        )  # fmt: skip

    def _share(self, task: Callable[[int, int], Any]) -> list[Any]:
        """Results of a task for blocks first..last-1, in order, one for each thread."""
        blocks = len(self._layout.block_start) - 1
        ends = [k * blocks // self._threads for k in range(self._threads + 1)]
        parts = [(a, b) for a, b in pairwise(ends) if b > a]
        others = [self._pool.submit(task, *part) for part in parts[1:]] if self._pool else []
        return [task(*parts[0]), *(other.result() for other in others)]

    def _way(self) -> float:
        """How far the fastest grain went in the last step [m]."""
        return float(self._ledger.now[:, N_SPEED_MAX].max() * self._numbers[C_DT])

    def _drain(self) -> None:
        for block, row in enumerate(self._ledger.now):
            count = int(row[N_N_ENDED])
            if count:
                self._drained.append(self._ledger.ended[block, :count].copy())
                row[N_N_ENDED] = 0.0

    def _own(self) -> dict[str, float]:
        """The engine's own numbers, as a snapshot keeps them."""
        own = {"skin": self._skin, "travel": self._travel, "since": float(self._since)}
        return own | extremes_of(self._ledger.now)

    def _read_own(self, state: State) -> None:
        self._skin = state.engine.get("skin", self._skin_first * self._smallest)
        self._since = int(state.engine.get("since", 0))
        read_account(state, self._ledger.now, self._ledger.books)


def blocks_of(n: int) -> int:
    """Into how many blocks the work on n grains is cut; never by the number of threads.

    Thin blocks have many pairs with their neighbours, which cost more.
    """
    least, most = _BLOCKS
    return 1 if n < _MANY else int(min(max(2.0 ** round(np.log2(n / 2048)), least), most))
