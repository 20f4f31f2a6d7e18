"""The CUDA engine: has the list made anew, launches steps in between, and tells what lies on the device."""

from dataclasses import replace
from typing import Any

import numpy as np

from ryusa.engine.cpu.engine import blocks_of
from ryusa.engine.cpu.prune import best_skin
from ryusa.engine.cpu.verlet_list import film_reach
from ryusa.engine.cuda.arrays import (
    F_ENDED,
    F_PARITY,
    F_SPILT,
    F_STEP,
    F_STOP,
    N_COLUMN,
    N_FLOW,
    N_PACE,
    NOBODY,
    P_FASTEST,
    P_SKIN,
    P_TRAVEL,
    Placed,
)
from ryusa.engine.cuda.availability import absent
from ryusa.engine.cuda.device import cuda
from ryusa.engine.cuda.device_state import Store, blocks, shape
from ryusa.engine.cuda.step import make_close, make_step
from ryusa.engine.protocol import Flags
from ryusa.engine.shared.contact_memory import closed_records, contacts_of
from ryusa.engine.shared.energy_account import begin_account, book_start, extremes_of, read_account, tally_of
from ryusa.engine.shared.entry import events_of, refuse_misfit, still_there
from ryusa.engine.shared.faults import fault_of, lost_of, unsafe_of
from ryusa.engine.shared.numbers import choice_of, energy_of_switch, numbers_of, variant_of
from ryusa.engine.shared.refusals import refusals
from ryusa.engine.shared.rows import (
    C_DT,
    C_T_ZERO,
    N_BOOKS,
    N_NOW,
    N_PEND_FLOW,
    N_SPEED_MAX,
    PENDING,
    STOP_DONE,
    STOP_EVENTS,
    STOP_LIST,
    STOP_UNSAFE,
)
from ryusa.errors import CaseError, RunError
from ryusa.model import Book, Immersed, Scene, State, Tally
from ryusa.model.contacts import N_EVENT
from ryusa.model.enums import EventRule
from ryusa.model.fluid import SHARE
from ryusa.model.scene import Floats
from ryusa.model.tally import N_BOOK

_RECORDS = 256  # room for ended contacts, beside one a grain
# What a new list moves for a grain, and a step for a listed neighbour [B]: the skin follows from such counts,
# never from a clock.
_RELIST_GRAIN, _LOOK = 4000.0, 36.0
_BATCH = 256  # steps launched before the host looks, at most


class CudaEngine:
    """Steps a scene on a CUDA device; the same bits however steps are split into calls.

    Parameters
    ----------
    skin : first reach of the neighbour list beyond touch, over the smallest diameter [-]; adapts to
        counted work.

    Raises
    ------
    CaseError : there is no CUDA device, and what is missing.
    """

    def __init__(self, skin: float = 0.1) -> None:
        reason = absent()
        if reason:
            raise CaseError("engine", "cuda", reason)
        self._skin_first = skin
        self._scene: Scene | None = None
        self._drained: list[np.ndarray] = []

    def refuses(self, scene: Scene) -> tuple[str, ...]:
        """Reasons why this engine cannot carry the scene; () when it can. Those of the CPU engine."""
        return refusals(scene)

    def load(self, scene: Scene, state: State) -> None:
        """Take a scene and a fresh state or a snapshot; a scene changed on the way is booked."""
        reasons = self.refuses(scene)
        if reasons:
            raise ValueError("; ".join(reasons))
        refuse_misfit(scene, state)
        before, self._scene = self._scene, scene
        changed = before is not None and before is not scene and state.step > 0
        self._n = n = scene.n_grain
        self._variant, self._choice = variant_of(scene), choice_of(scene)
        self._step_kernel = make_step(self._variant, self._choice, shape())
        self._close_kernel = make_close(shape())
        self._smallest = float(np.concatenate([scene.d, scene.d_fixed]).min(initial=np.inf))
        self._numbers = numbers_of(scene)
        self._numbers[C_T_ZERO] = state.t - state.step * scene.dt
        self._room = n + _RECORDS if scene.events != EventRule.NONE else 1
        self._relisted = 0
        now, books = self._read_own(state)

        contacts, dropped = still_there(scene, state.contacts)
        self._drained = self._drained if changed else []
        if before is not None and changed:
            books[0, Book.SWITCH] += energy_of_switch(before, scene, state, dropped)
            self._drained.append(closed_records(state, dropped))
        resumed = state.x_listed is not None and not changed and not len(dropped)
        own = state.engine
        extent = np.array([own.get(f"extent_{k}", np.nan) for k in range(6)]).reshape(2, 3)
        self._travel = own.get("travel", 0.0) if resumed else 0.0
        self._seen = None
        if self._variant.column:
            self._seen = (state.immersed or Immersed.still(n)).seen.copy()
        x = state.x_listed if resumed and state.x_listed is not None else state.x
        placed = State(
            x=x, v=state.v, omega=state.omega, image=state.image, immersed=state.immersed, contacts=contacts
        )
        known = extent if np.isfinite(extent).all() and not changed else None
        self._store = Store(scene, placed, self._variant, self._choice, self._numbers, known)
        self._flow = np.zeros(N_FLOW, np.int64)
        self._flow[F_STEP], self._flow[F_SPILT] = state.step, NOBODY
        if state.step == 0:
            begin_account(scene, state, now, books)
        self._pace = np.zeros(N_PACE)
        self._pace[P_FASTEST] = now[0, N_SPEED_MAX]
        self._d_flow, self._d_pace = cuda.to_device(self._flow), cuda.to_device(self._pace)
        self._d_now, self._d_books = cuda.to_device(now), cuda.to_device(books)
        self._d_ended = cuda.to_device(np.zeros((self._room, N_EVENT)))
        self._d_partial = cuda.to_device(np.zeros(blocks(n) * N_COLUMN))
        self._list()
        if resumed:
            self._store.place_at(state.x)

    def advance(self, n_steps: int) -> Flags:
        """Do n_steps steps, fewer if a fault stops the run."""
        if n_steps > 0 and self._step == 0:
            flags = self._march(1)
            now, books = self._d_now.copy_to_host(), self._d_books.copy_to_host()
            book_start(now, books)
            self._d_books.copy_to_device(books)
            if flags:
                return flags
            n_steps -= 1
        return self._march(n_steps)

    def grains(self) -> State:
        """Where grains are and how they move, without contacts and books: a frame."""
        store, ids = self._store, self._store.ids()
        return State(
            x=np.ascontiguousarray(store.by_id("x", ids)[:, :3]),
            v=np.ascontiguousarray(store.by_id("v", ids)[:, :3]),
            omega=np.ascontiguousarray(store.by_id("w", ids)[:, :3]),
            step=self._step,
            t=self._t,
            image=store.by_id("image", ids),
        )

    def state(self) -> State:
        """Read-only snapshot: all that an exact resume needs."""
        store, ids = self._store, self._store.ids()
        now = self._d_now.copy_to_host()
        books = np.zeros((blocks_of(self._n), N_BOOKS))  # as many rows as the CPU engine keeps
        books[0] = self._d_books.copy_to_host()[0]
        books[0, N_BOOK : N_BOOK + len(PENDING)] = now[0, PENDING]
        contacts = contacts_of(store.memory(), self._variant)
        immersed = None
        if self._variant.column:
            immersed = Immersed(store.by_id("seen", ids), store.by_id("taken", ids))
        state = replace(
            self.grains(),
            contacts=contacts,
            books=books,
            x_listed=store.listed.copy_to_host(),
            immersed=immersed,
            engine=self._own(now),
        )
        wet = vars(immersed).values() if immersed else ()
        for array in (
            state.x, state.v, state.omega, state.image, state.books, *vars(contacts).values(), *wet,
        ):  # fmt: skip
            array.flags.writeable = False
        return state

    def drift(self) -> tuple[Floats, Floats, Floats]:
        """Centres [m], velocities [m/s] and what was taken from the water (model.fluid), by id."""
        store, ids = self._store, self._store.ids()
        taken = store.by_id("taken", ids) if self._variant.column else np.zeros((0, 0))
        return (
            np.ascontiguousarray(store.by_id("x", ids)[:, :3]),
            np.ascontiguousarray(store.by_id("v", ids)[:, :3]),
            taken,
        )

    def immerse(self, seen: Floats) -> None:
        """Tell every grain its water for the steps to come, and begin to count its impulse anew.

        Parameters
        ----------
        seen : by id, columns of `model.fluid`, shape (n_grain, N_SEEN).

        Raises
        ------
        ValueError : the scene has no column of water, or the shape is another.
        """
        if self._seen is None or self._scene is None:
            raise ValueError("the scene has no column of water: water.profile is not COLUMN")
        if seen.shape != self._seen.shape:
            raise ValueError(f"seen has shape {seen.shape}, not {self._seen.shape}")
        store, ids = self._store, self._store.ids()
        more = seen[:, SHARE] - self._seen[:, SHARE]
        if self._step and more.any():  # energy of the water that moves along with a grain, or no longer does
            v = store.by_id("v", ids)[:, :3]
            now = self._d_now.copy_to_host()
            now[0, N_PEND_FLOW] += float((0.5 * self._scene.m_added * more * np.sum(v**2, axis=1)).sum())
            self._d_now.copy_to_device(now)
        self._seen = seen.copy()
        store.bodies.seen.copy_to_device(np.ascontiguousarray(seen[ids]))
        store.bodies.taken.copy_to_device(np.zeros(store.bodies.taken.shape))

    def tally(self) -> Tally:
        """Energy account and extremes at the moment of the last force evaluation."""
        t = float(self._t - self._numbers[C_DT]) if self._step else self._t
        return tally_of(t, self._d_now.copy_to_host(), self._d_books.copy_to_host())

    def events(self) -> np.ndarray:
        """Contacts ended since last asked, in order of parting."""
        self._drain()
        rows = np.concatenate(self._drained) if self._drained else np.zeros((0, N_EVENT))
        self._drained = []
        return events_of(rows)

    @property
    def _step(self) -> int:
        return int(self._flow[F_STEP])

    @property
    def _t(self) -> float:
        return float(self._numbers[C_T_ZERO] + self._step * self._numbers[C_DT])

    def _march(self, n_steps: int) -> Flags:
        """Launch steps until they are done; a step that comes after a stop passes over itself."""
        target, store = self._step + n_steps, self._store
        n_block, cut = blocks(self._n), shape()
        step = self._step_kernel[n_block, cut.threads, 0, 8 * cut.desk]
        close = self._close_kernel[1, cut.closers, 0, 8 * cut.segments * N_COLUMN]
        while self._step < target:
            if 2.0 * self._travel > self._skin:
                fault = self._relist()
                if fault is not None:
                    return Flags(fault)
            was = self._step
            for _ in range(min(target - was, self._until_list())):
                step(
                    target, self._n, store.n_solid, store.c, self._d_flow, store.bodies, store.walls,
                    store.pairs, self._d_ended, self._d_partial,
                )  # fmt: skip
                close(
                    target, n_block, self._room, store.c, self._d_partial, self._d_flow, self._d_pace,
                    self._d_books, self._d_now,
                )  # fmt: skip
            self._look()
            self._since += self._step - was
            stop = int(self._flow[F_STOP])
            if stop == STOP_EVENTS:
                self._drain()
            elif stop == STOP_UNSAFE:
                return Flags(self._unsafe())
            elif stop not in (STOP_DONE, STOP_LIST):
                return Flags(fault_of(self._d_now.copy_to_host(), self._numbers, self._step - 1))
        return Flags()

    def _until_list(self) -> int:
        """Steps to launch before looking: about as many as the list will hold for."""
        way = self._pace[P_FASTEST] * self._numbers[C_DT]
        left = 0.5 * self._skin - self._travel
        return _BATCH if way * _BATCH <= left else max(1, int(left / way) + 1)

    def _look(self) -> None:
        """Read where the run stands."""
        self._d_flow.copy_to_host(self._flow)
        self._d_pace.copy_to_host(self._pace)
        self._travel = float(self._pace[P_TRAVEL])
        self._store.half = int(self._flow[F_PARITY])

    def _say(self) -> None:
        """Tell the device where the run stands."""
        self._flow[F_STOP], self._flow[F_PARITY] = STOP_DONE, self._store.half
        self._pace[P_TRAVEL], self._pace[P_SKIN] = self._travel, self._skin
        self._d_flow.copy_to_device(self._flow)
        self._d_pace.copy_to_device(self._pace)

    def _relist(self) -> RunError | None:
        """Choose a skin from counted work, bring grains back into the period, and list pairs anew."""
        skin = best_skin(
            self._skin, 2.0 * self._travel / max(self._since, 1), _RELIST_GRAIN * self._n,
            _LOOK * self._store.n_pair,
        )  # fmt: skip
        self._skin = min(max(skin, 0.02 * self._smallest), self._smallest)
        # a pair that parted in the last step still has an account to close
        self._skin = max(self._skin, 2.001 * float(self._pace[P_FASTEST] * self._numbers[C_DT]))
        self._since, self._travel, self._relisted = 0, 0.0, self._relisted + 1
        lost = self._list()
        return self._lost(lost) if lost >= 0 else None

    def _list(self) -> int:
        lost = self._store.list_pairs(self._skin, film_reach(self._store.scene))
        self._say()
        return lost

    def _drain(self) -> None:
        self._look()
        count = int(self._flow[F_ENDED])
        if count:
            self._drained.append(self._d_ended[:count].copy_to_host())
            self._flow[F_ENDED] = 0
            if self._flow[F_STOP] == STOP_EVENTS:
                self._flow[F_STOP] = STOP_DONE
            self._d_flow.copy_to_device(self._flow)

    def _lost(self, grain: int) -> RunError:
        return lost_of(self._placed(), grain, self._step, self._t)

    def _unsafe(self) -> RunError:
        return unsafe_of(self._placed(), self._n, self._numbers, self._smallest, self._step, self._t)

    def _placed(self) -> Any:
        """What a fault tells of grains, by id."""
        store, ids = self._store, self._store.ids()
        x, v, w = (store.by_id(name, ids) for name in ("x", "v", "w"))
        return Placed(x, v, w, np.arange(self._n), None, None)

    def _read_own(self, state: State) -> tuple[Floats, Floats]:
        """The engine's own numbers from a snapshot; returns what holds now, and the books."""
        now, books = np.zeros((1, N_NOW)), np.zeros((1, N_BOOKS))
        self._skin = state.engine.get("skin", self._skin_first * self._smallest)
        self._since = int(state.engine.get("since", 0))
        read_account(state, now, books)
        return now, books

    def _own(self, now: Floats) -> dict[str, float]:
        """The engine's own numbers, as a snapshot keeps them; the names are those of the CPU engine."""
        own = {"skin": self._skin, "travel": self._travel, "since": float(self._since)}
        own |= {f"extent_{k}": float(value) for k, value in enumerate(self._store.extent.ravel())}
        return own | extremes_of(now)
