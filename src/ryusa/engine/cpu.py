"""The CPU engine: owns the arrays, rebuilds the neighbour list, lets compiled threads march in between."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np

from ryusa.engine.carry import count_live, cross_lists, put_rows, take_rows, wrap_grains
from ryusa.engine.cells import build_list, grid_of, sort_into
from ryusa.engine.kernels import begin_row
from ryusa.engine.march import make_run
from ryusa.engine.numbers import numbers_of, potential_energy, variant_of
from ryusa.engine.rows import (
    FAULT_NOT_A_NUMBER,
    FAULT_OVERLAP,
    N_BOOKS,
    N_FAULT,
    N_FAULT_GRAIN,
    N_FAULT_PARTNER,
    N_KINETIC,
    N_N_CONTACT,
    N_N_ENDED,
    N_NOW,
    N_OVERLAP_GRAIN,
    N_OVERLAP_MAX,
    N_OVERLAP_STEP,
    N_PEND_DRAG,
    N_PEND_TORQUE,
    N_POTENTIAL,
    N_SPEED_MAX,
    N_SPIN,
    N_SPIN_MAX,
    N_SPRING_N,
    N_SPRING_R,
    N_SPRING_S,
    R_DASH_N,
    R_DASH_R,
    R_DASH_S,
    R_F_N,
    R_SPRING_R,
    R_SPRING_S,
    STOP_EVENTS,
    STOP_LIST,
    STOP_UNSAFE,
    C_SKIN,
    C_STEP_LIMIT,
    C_T_ZERO,
)
from ryusa.engine.seam import Flags
from ryusa.errors import ContactSlotsFull, GrainLost, ListUnsafe, NotANumber, OverlapTooLarge, RunError
from ryusa.model import EVENT, Book, Contacts, Scene, State, Tally
from ryusa.model.contacts import N_EVENT
from ryusa.model.enums import Arm, EventRule, Rolling
from ryusa.model.tally import N_BOOK

_MANY = 256  # grains from which work is cut into blocks
_BLOCKS = 8
# Measured, and fixed so that a run never depends on a clock: cost of a rebuild and of a step, in ns.
_REBUILD, _REBUILD_GRAIN, _STEP_GRAIN = 40_000.0, 300.0, 80.0
_SUMS = (N_KINETIC, N_SPIN, N_POTENTIAL, N_SPRING_N, N_SPRING_S, N_SPRING_R, N_N_CONTACT)


class CpuEngine:
    """Steps a scene on the CPU; the same bits for any number of threads and however steps are split into calls.

    Parameters
    ----------
    threads : threads that share a step; more than the number of blocks (1 below 256 grains, else 8) do not help.
    skin : first reach of the neighbour list beyond touch, over the smallest diameter [-]; adapts to counted work.
    """

    def __init__(self, threads: int = 1, skin: float = 0.1) -> None:
        if threads < 1:
            raise ValueError(f"threads = {threads}: at least 1")
        self._threads, self._skin_first = threads, skin
        self._pool: ThreadPoolExecutor | None = None
        self._scene: Scene | None = None

    # -- the seam ------------------------------------------------------------------------------------------------------

    def refuses(self, scene: Scene) -> tuple[str, ...]:
        """Reasons why this engine cannot carry the scene; () when it can."""
        reasons: list[str] = []
        if scene.rolling.model == Rolling.EPSD and scene.rolling.arm == Arm.CONTACT_WIDTH:
            reasons.append("the spring-dashpot-slider needs arm = 'reduced radius': its stiffness may not change in touch")
        if scene.rolling.model != Rolling.NONE and not scene.rotation:
            reasons.append("rolling friction needs rotation = 'free'")
        largest = max([0.0, *scene.d, *scene.d_fixed[scene.fixed_active]])
        for axis, length in zip("xy", scene.period, strict=True):
            if length < 3.0 * largest:
                reasons.append(f"the period in {axis} ({length:g} m) is shorter than three grain diameters ({largest:g} m)")
        return tuple(reasons)

    def load(self, scene: Scene, state: State) -> None:
        """Take a scene and a fresh state or a snapshot."""
        reasons = self.refuses(scene)
        if reasons:
            raise ValueError("; ".join(reasons))
        n, n_fixed, n_plane = scene.n_grain, scene.n_fixed, scene.n_plane
        if state.x.shape != (n, 3):
            raise ValueError(f"state.x has shape {state.x.shape}, the scene has {n} free grains")
        changed = self._scene is not None and scene is not self._scene and state.step > 0
        before = self._scene
        self._scene = scene
        self._n, self._n_solid = n, n + n_fixed
        total = n + n_fixed + n_plane
        self._step, self._t = state.step, state.t
        self._period = np.array(scene.period)

        # by id: what does not change
        inf = np.full(total - n, np.inf)
        self._r_id = np.concatenate([0.5 * scene.d, 0.5 * scene.d_fixed, np.full(n_plane, np.inf)])
        self._m_id = np.concatenate([scene.m + scene.m_added, inf])
        self._inertia_id = np.concatenate([scene.inertia, inf])
        # by place: the free grains in cell order first, then fixed grains and planes, which never move
        self._x = np.vstack([state.x, scene.x_fixed]).astype(np.float64)
        self._v = np.vstack([state.v, np.zeros((total - n, 3))])
        self._w = np.vstack([state.omega if scene.rotation else np.zeros((n, 3)), np.zeros((total - n, 3))])
        self._ids = np.arange(self._n_solid)
        self._image = (np.array(state.image, dtype=np.int32) if len(state.image) == n else np.zeros((n, 2), np.int32))
        self._f, self._torque = np.zeros((n, 3)), np.zeros((n, 3))
        self._touches, self._touched = np.zeros(n, np.int32), np.zeros(n, np.int32)
        self._tracked = scene.tracked if len(scene.tracked) == n else np.zeros(n, np.bool_)
        blocks = _BLOCKS if n >= _MANY else 1
        self._block_start = np.arange(blocks + 1) * n // blocks
        self._variant = variant_of(scene)
        self._run = make_run(self._variant)
        width = self._variant.row_width
        self._start = np.zeros(n + 1, np.int64)
        self._partners, self._live = np.zeros(0, np.int32), np.zeros(0, np.uint8)
        self._mem = np.zeros((0, width))
        slots = n // blocks + _MANY if scene.events != EventRule.NONE else 1
        self._ended = np.zeros((blocks, slots, N_EVENT if scene.events != EventRule.NONE else 1))
        self._drained: list[np.ndarray] = []
        self._now = np.zeros((blocks, N_NOW))
        self._books = np.zeros((blocks, N_BOOKS))
        self._numbers = numbers_of(scene)
        self._numbers[C_T_ZERO] = state.t - state.step * scene.dt
        self._solid_grid()

        # an engine's own numbers
        own = state.engine
        smallest = float(min([*scene.d, *scene.d_fixed])) if n + n_fixed else 1.0
        self._smallest = smallest
        self._skin = own.get("skin", self._skin_first * smallest)
        self._numbers[C_STEP_LIMIT] = 0.25 * smallest
        self._since = int(own.get("since", 0))
        if state.books.shape == (blocks, N_BOOKS):
            self._books[:] = state.books
        self._now[:, N_PEND_DRAG], self._now[:, N_PEND_TORQUE] = self._books[:, N_BOOK], self._books[:, N_BOOK + 1]
        self._books[:, N_BOOK:] = 0.0
        self._now[:, N_OVERLAP_MAX] = own.get("overlap_max", 0.0)
        self._now[:, N_OVERLAP_GRAIN] = own.get("overlap_grain", -1.0)
        self._now[:, N_OVERLAP_STEP] = own.get("overlap_step", 0.0)
        for column in _SUMS:
            self._now[0, column] = own.get(f"sum_{column}", 0.0)
        self._now[:, N_SPEED_MAX], self._now[:, N_SPIN_MAX] = own.get("speed_max", 0.0), own.get("spin_max", 0.0)

        contacts, dropped = _still_there(scene, state.contacts)
        if changed and before is not None:
            self._book_switch(before, scene, state, dropped)
        rows = self._rows_of(contacts)
        resumed = state.x_listed is not None and not changed and not len(dropped)
        now_x = self._x[:n].copy()
        if resumed:
            self._x[:n] = state.x_listed
        self._list(contacts.i, contacts.j, rows)
        if resumed:
            self._x[:n] = now_x[self._ids[:n]]
        self._travel = own.get("travel", 0.0) if resumed else 0.0
        touched = np.zeros(n, np.int32)
        np.add.at(touched, contacts.i, 1)
        free = contacts.j[contacts.j < n]
        np.add.at(touched, free, 1)
        self._touched[:] = touched[self._ids[:n]]

    def advance(self, n_steps: int) -> Flags:
        """Do n_steps steps, fewer if a fault stops the run."""
        if n_steps > 0 and self._step == 0:
            flags = self._march(1)
            self._books[0, Book.START] = self._held()
            if flags:
                return flags
            n_steps -= 1
        return self._march(n_steps)

    def state(self) -> State:
        """Read-only snapshot: all that an exact resume needs."""
        n, ids = self._n, self._ids[: self._n]
        back = np.argsort(ids)
        i, j, rows = self._take()
        books = self._books.copy()
        books[:, N_BOOK], books[:, N_BOOK + 1] = self._now[:, N_PEND_DRAG], self._now[:, N_PEND_TORQUE]
        own = {
            "skin": self._skin, "travel": self._travel, "since": float(self._since),
            "overlap_max": float(self._now[:, N_OVERLAP_MAX].max()),
            "speed_max": float(self._now[:, N_SPEED_MAX].max()), "spin_max": float(self._now[:, N_SPIN_MAX].max()),
        }
        block = int(self._now[:, N_OVERLAP_MAX].argmax())
        own["overlap_grain"] = float(self._now[block, N_OVERLAP_GRAIN])
        own["overlap_step"] = float(self._now[block, N_OVERLAP_STEP])
        own |= {f"sum_{column}": float(self._now[:, column].sum()) for column in _SUMS}
        rolling, column = bool(self._variant.rolling), self._variant.event_column
        none = np.zeros((len(i), 3))
        contacts = Contacts(
            i, j, rows[:, R_SPRING_S : R_SPRING_S + 3].copy(), rows[:, R_DASH_S : R_DASH_S + 3].copy(),
            rows[:, R_DASH_N].copy(), rows[:, R_F_N].copy(),
            rows[:, R_SPRING_R : R_SPRING_R + 3].copy() if rolling else none,
            rows[:, R_DASH_R : R_DASH_R + 3].copy() if rolling else none,
            rows[:, column:].copy() if self._variant.events else np.zeros((len(i), N_EVENT)),
        )
        state = State(
            x=self._x[:n][back], v=self._v[:n][back], omega=self._w[:n][back], step=self._step, t=self._t,
            image=self._image[back], contacts=contacts, books=books, x_listed=self._x_listed.copy(), engine=own,
        )
        for array in (state.x, state.v, state.omega, state.image, state.books, *vars(contacts).values()):
            array.flags.writeable = False
        return state

    def tally(self) -> Tally:
        """Energy account and extremes at the moment of the last force evaluation."""
        now = self._now
        block = int(now[:, N_OVERLAP_MAX].argmax())
        sums = [float(now[:, column].sum()) for column in _SUMS]
        return Tally(
            t=self._t - self._numbers[0] if self._step else self._t,
            kinetic=sums[0], spin=sums[1], potential=sums[2], spring_n=sums[3], spring_s=sums[4], spring_r=sums[5],
            books=tuple(float(b) for b in self._books[:, :N_BOOK].sum(axis=0)),
            overlap_max=float(now[block, N_OVERLAP_MAX]), overlap_grain=int(now[block, N_OVERLAP_GRAIN]),
            overlap_step=int(now[block, N_OVERLAP_STEP]), speed_max=float(now[:, N_SPEED_MAX].max()),
            spin_max=float(now[:, N_SPIN_MAX].max()), n_contact=int(sums[6]),
        )

    def events(self) -> np.ndarray:
        """Contacts ended since last asked, in order of parting."""
        self._drain()
        rows = np.concatenate(self._drained) if self._drained else np.zeros((0, N_EVENT))
        self._drained = []
        events = _structured(rows)
        return events[np.lexsort((events["j"], events["i"], events["t_part"]))]

    # -- marching ------------------------------------------------------------------------------------------------------

    def _march(self, n_steps: int) -> Flags:
        while n_steps > 0:
            threads = min(self._threads, len(self._block_start) - 1)
            count = np.zeros(1, np.int64)
            arguments = (
                threads, n_steps, self._step, True, self._travel, count, self._numbers, self._block_start,
                self._react_start, self._n, self._n_solid, self._x, self._v, self._w, self._r, self._m, self._m_bare,
                self._m_weight, self._inertia, self._ids, self._image, self._tracked, self._normals, self._points,
                self._start, self._partners, self._live, self._mem, self._f, self._torque, self._touches,
                self._touched, self._react, self._react_touch, self._incoming_start, self._incoming, self._ended,
                self._books, self._now,
            )
            if threads == 1:
                done, self._travel, stop, _ = self._run(0, *arguments)
            else:
                if self._pool is None:
                    self._pool = ThreadPoolExecutor(self._threads - 1, thread_name_prefix="ryusa")
                others = [self._pool.submit(self._run, k, *arguments) for k in range(1, threads)]
                done, self._travel, stop, _ = self._run(0, *arguments)
                for other in others:
                    other.result()
            self._step += done
            self._since += done
            n_steps -= done
            self._t = self._numbers[C_T_ZERO] + self._step * self._numbers[0]
            if stop == STOP_LIST:
                fault = self._relist()
                if fault is not None:
                    return Flags(fault)
            elif stop == STOP_EVENTS:
                self._drain()
            elif stop != 0:
                return Flags(self._fault(stop))
        return Flags()

    def _fault(self, stop: int) -> RunError:
        dt = float(self._numbers[0])
        if stop == STOP_UNSAFE:
            speed = np.linalg.norm(self._v[: self._n], axis=1)
            place = int(speed.argmax())
            return ListUnsafe(
                f"a grain moves {speed[place] * dt / self._smallest:.2g} diameters in one step ({speed[place]:.3g} m/s)",
                grain=int(self._ids[place]), step=self._step, t=self._t,
                hint="Partners may be passed without being seen: take a smaller step or look for what threw the grain.",
            )
        block = int(np.argmax(self._now[:, N_FAULT] != 0))
        fault, grain, partner = (int(self._now[block, k]) for k in (N_FAULT, N_FAULT_GRAIN, N_FAULT_PARTNER))
        where: dict[str, Any] = {
            "grain": grain, "step": self._step - 1, "t": self._t - dt, "partner": None if partner < 0 else partner
        }
        if fault == FAULT_NOT_A_NUMBER:
            return NotANumber("velocity is not finite", **where, hint="Look at the frames before: forces grew without bound.")
        if fault == FAULT_OVERLAP:
            return OverlapTooLarge(
                f"overlap is {self._now[block, N_OVERLAP_MAX]:.3g} of the smaller diameter, limit {self._scene_limit():g}",
                **where, hint="Use stiffer springs (contact.stiffness), or raise domain.overlap_limit if this is meant.",
            )
        return ContactSlotsFull("more contacts ended in one step than the record holds", **where, hint="Record fewer: record.events = 'tracked'.")

    def _scene_limit(self) -> float:
        assert self._scene is not None
        return self._scene.overlap_limit

    # -- neighbour list ------------------------------------------------------------------------------------------------

    def _solid_grid(self) -> None:
        scene = self._scene
        assert scene is not None
        n, n_fixed = self._n, scene.n_fixed
        keep = np.flatnonzero(scene.fixed_active)
        x = np.ascontiguousarray(scene.x_fixed[keep])
        self._image_fixed = x.copy()
        # fixed grains are listed from where they stand inside the period
        for k in range(2):
            if np.isfinite(self._period[k]):
                x[:, k] %= self._period[k]
                self._x[n : n + n_fixed, k] %= self._period[k]
        self._fixed_keep, self._fixed_x = keep, x
        self._normals = np.ascontiguousarray(scene.plane_normal, dtype=np.float64).reshape(-1, 3)
        self._points = np.ascontiguousarray(scene.plane_point, dtype=np.float64).reshape(-1, 3)

    def _relist(self) -> RunError | None:
        """Choose a skin from counted work, bring grains back into the period, and list pairs anew."""
        scene = self._scene
        assert scene is not None
        cost = (_REBUILD + _REBUILD_GRAIN * self._n) / max(self._since, 1)
        if cost > 0.1 * _STEP_GRAIN * self._n:
            self._skin = min(1.25 * self._skin, self._smallest)
        elif cost < 0.03 * _STEP_GRAIN * self._n:
            self._skin = max(self._skin / 1.25, 0.02 * self._smallest)
        self._since, self._travel = 0, 0.0
        i, j, rows = self._take()
        back = np.argsort(self._ids[: self._n])
        for array in (self._x, self._v, self._w):
            array[: self._n] = array[: self._n][back]
        self._image = self._image[back]
        self._touched = self._touched[back]
        self._ids[: self._n] = np.arange(self._n)
        lost = self._list(i, j, rows)
        if lost >= 0:
            place = int(np.flatnonzero(self._ids == lost)[0])
            where = ", ".join(f"{a:.4g}" for a in self._x[place])
            return GrainLost(
                f"a grain left the world at ({where}) m", grain=lost, step=self._step, t=self._t,
                hint="Widen domain.low and domain.high, or look at what threw it.",
            )
        return None

    def _list(self, i: np.ndarray, j: np.ndarray, rows: np.ndarray) -> int:
        """List pairs from positions now in id order; returns a grain outside the world, or -1."""
        scene, n = self._scene, self._n
        assert scene is not None
        lost = int(
            wrap_grains(self._x[:n], self._image, self._period, np.array(scene.world_low), np.array(scene.world_high))
        )
        self._x_listed = self._x[:n].copy()
        size = 2.0 * float(self._r_id[: self._n_solid].max(initial=0.0)) + self._skin
        low, wide, dims = grid_of(self._x, n, size, self._period)
        order = np.empty(n, np.int64)
        first = sort_into(self._x, n, low, wide, dims, order)
        for name in ("_x", "_v", "_w"):
            array = getattr(self, name)
            array[:n] = array[:n][order]
        self._image, self._touched = self._image[order], self._touched[order]
        self._ids[:n] = order
        self._r, self._m, self._inertia = self._r_id.copy(), self._m_id.copy(), self._inertia_id.copy()
        for placed in (self._r, self._m, self._inertia):
            placed[:n] = placed[:n][order]
        self._m_bare, self._m_weight = scene.m[order], scene.m_weight[order]
        keep = self._fixed_keep
        f_low, f_wide, f_dims = grid_of(self._fixed_x, len(keep), size, self._period)
        f_order = np.empty(len(keep), np.int64)
        f_first = sort_into(self._fixed_x, len(keep), f_low, f_wide, f_dims, f_order)
        free, fixed = (low, wide, dims, first, np.arange(n)), (f_low, f_wide, f_dims, f_first, keep[f_order])
        while True:
            used = build_list(
                self._x, self._r, self._ids, n, self._n_solid, self._normals, self._points, scene.plane_active,
                free, fixed, self._period, self._skin, self._start, self._partners,
            )
            if used <= len(self._partners):
                break
            room = int(1.2 * used) + 64
            self._partners = np.zeros(room, np.int32)
            self._mem, self._live = np.zeros((room, rows.shape[1])), np.zeros(room, np.uint8)
        self._live[:used] = 0
        index = np.empty(n, np.int64)
        index[order] = np.arange(n)
        missing = put_rows(n, self._start, self._partners, self._live, self._mem, index, i, j, rows)
        if missing >= 0:
            raise AssertionError(f"pair {i[missing]}, {j[missing]} is in touch and not in the list")
        self._react_start, self._incoming_start, self._incoming = cross_lists(
            n, self._block_start, self._start, self._partners
        )
        crossing = int(self._react_start[-1])
        self._react, self._react_touch = np.zeros((crossing, 6)), np.zeros(crossing, np.uint8)
        self._numbers[C_SKIN] = self._skin
        return lost

    # -- contact memory ------------------------------------------------------------------------------------------------

    def _take(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        count = count_live(int(self._start[self._n]), self._live)
        i, j = np.empty(count, np.int64), np.empty(count, np.int64)
        rows = np.empty((count, self._variant.row_width))
        take_rows(self._n, self._start, self._partners, self._live, self._mem, self._ids, i, j, rows)
        return i, j, rows

    def _rows_of(self, contacts: Contacts) -> np.ndarray:
        width, column = self._variant.row_width, self._variant.event_column
        rows = np.zeros((len(contacts), width))
        for k in range(len(contacts)):
            begin_row(
                rows[k], self._variant.rotation, int(contacts.i[k]), int(contacts.j[k]), self._numbers, self._m_id,
                self._r_id, self._inertia_id, width,
            )
        rows[:, R_SPRING_S : R_SPRING_S + 3], rows[:, R_DASH_S : R_DASH_S + 3] = contacts.spring_s, contacts.dash_s
        rows[:, R_DASH_N], rows[:, R_F_N] = contacts.dash_n, contacts.f_n
        if self._variant.rolling:
            rows[:, R_SPRING_R : R_SPRING_R + 3], rows[:, R_DASH_R : R_DASH_R + 3] = contacts.spring_r, contacts.dash_r
        if self._variant.events:
            rows[:, column:] = contacts.event
        return rows

    def _drain(self) -> None:
        for block in range(len(self._now)):
            count = int(self._now[block, N_N_ENDED])
            if count:
                self._drained.append(self._ended[block, :count].copy())
                self._now[block, N_N_ENDED] = 0.0

    # -- account -------------------------------------------------------------------------------------------------------

    def _held(self) -> float:
        return float(sum(self._now[:, column].sum() for column in _SUMS[:-1]))

    def _book_switch(self, before: Scene, scene: Scene, state: State, dropped: np.ndarray) -> None:
        """Energy that a change of the timeline gives or takes: height on a new slope, spin locked, springs let go."""
        given = potential_energy(scene, state) - potential_energy(before, state)
        if before.rotation and not scene.rotation:
            given -= float(0.5 * np.sum(scene.inertia[:, None] * state.omega**2))
        if len(dropped):
            law = before.contact
            gone = state.contacts
            e_n = gone.f_n[dropped] - gone.dash_n[dropped]
            given -= float(np.sum(0.5 * e_n**2 / law.k_n))
            if law.k_s > 0.0:
                given -= float(np.sum(0.5 * gone.spring_s[dropped] ** 2 / law.k_s))
        self._books[0, Book.SWITCH] += given


def _still_there(scene: Scene, contacts: Contacts) -> tuple[Contacts, np.ndarray]:
    """Contacts whose partner still stands, and the places of those whose partner was taken away."""
    n, n_solid = scene.n_grain, scene.n_grain + scene.n_fixed
    active = np.concatenate([np.ones(n, np.bool_), scene.fixed_active, scene.plane_active])
    keep = active[contacts.j] if len(contacts) else np.zeros(0, np.bool_)
    assert len(active) == n_solid + scene.n_plane
    if keep.all():
        return contacts, np.zeros(0, np.int64)
    return replace(contacts, **{k: a[keep] for k, a in vars(contacts).items()}), np.flatnonzero(~keep)


def _structured(rows: np.ndarray) -> np.ndarray:
    events = np.zeros(len(rows), EVENT)
    column = 0
    for name in EVENT.names or ():
        shape = EVENT[name].shape
        events[name] = rows[:, column : column + 3] if shape else rows[:, column]
        column += 3 if shape else 1
    return events
