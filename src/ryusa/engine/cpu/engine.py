"""The CPU engine: owns the arrays, rebuilds the Verlet list, and runs compiled threads in between."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ryusa.engine.cpu.arrays import (
    AccountArrays,
    StepArrays,
    rows_by_id,
    rows_by_place,
    same_column,
    workspace_of_thread,
)
from ryusa.engine.cpu.candidate_pairs import NOT_LISTED, CandidatePairs
from ryusa.engine.cpu.contact_rows import has_short_rows, lengthened, shortened
from ryusa.engine.cpu.prune_schedule import COST_TEST
from ryusa.engine.cpu.rigid_bodies import body_arrays, body_shares, body_state, place_members, wrap_bodies
from ryusa.engine.cpu.snapshot import contact_rows, grain_rows, place_by_id
from ryusa.engine.cpu.threads import Threads
from ryusa.engine.cpu.time_loop import PiecesOfStep, run
from ryusa.engine.cpu.verlet_list import BlockLayout, blocks_of, collect_memory, count_memory
from ryusa.engine.protocol import Flags
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_memory import (
    ContactMemory,
    contacts_of,
    contacts_of_grains,
    memory_of,
    remaining_contacts,
)
from ryusa.engine.shared.contact_records import closed_records, sorted_events
from ryusa.engine.shared.energy_account import (
    N_ACCOUNT,
    account_arrays,
    begin_account,
    energy_of_change,
    enter_start,
    read_account,
    read_walls,
    tally_of,
)
from ryusa.engine.shared.faults import fault_of, lost_of, unsafe_of
from ryusa.engine.shared.layout import film_reach
from ryusa.engine.shared.materials import common_parameters, material_arrays
from ryusa.engine.shared.refusals import check_sampled, check_state, refusals
from ryusa.engine.shared.skin import best_skin
from ryusa.engine.shared.status import STOP_EVENTS, STOP_LIST, STOP_PAIR, STOP_UNSAFE
from ryusa.engine.shared.variant import choice_of, variant_of
from ryusa.engine.shared.wall_pose import BEFORE, set_poses
from ryusa.errors import RunError
from ryusa.model import EngineBlock, FluidAtGrains, Scene, State, Tally, Term
from ryusa.model.contacts import N_EVENT
from ryusa.model.fluid import SUBMERGED
from ryusa.model.pieces import RowsInPieces
from ryusa.model.scene import EventRule, Floats
from ryusa.model.state import make_read_only
from ryusa.model.walls import N_IMPULSE

VERSION = 1  # of the block in a snapshot
_FARTHEST = 1e12  # [m]; beyond there is no grain
_RECORDS = 256  # room for ended contacts in a block, beside one a grain
# Measured, and fixed so that a run never depends on a clock: cost of a Verlet list [ns], and steps
# between two prunings.
_LIST, _LIST_GRAIN, _STEPS_A_CUT = 300_000.0, 600.0, 16.0
_FEW = 256  # grains up to which making a list costs far more than keeping its pairs


class CpuEngine:
    """Steps a scene on the CPU; the same bits for any number of threads and any split into calls.

    Parameters
    ----------
    threads : threads that share a step; more than there are blocks (`blocks_of`) are idle.
    skin : first reach of the neighbour list beyond touch, over the smallest diameter [-]; adapts to
    counted work.
    """

    name = "cpu"

    def __init__(self, threads: int = 1, skin: float = 0.1) -> None:
        self._threads, self._skin_first = Threads(threads), skin
        self._work = [workspace_of_thread() for _ in range(threads)]
        self._records_drained: list[np.ndarray] = []
        self._scene: Scene | None = None

    def refuses(self, scene: Scene) -> tuple[str, ...]:
        """Reasons why this engine cannot simulate the scene; () when it can."""
        return refusals(scene)

    def load(self, scene: Scene, state: State) -> None:
        """Take a scene and an initial state or a snapshot; enter a change of the scene in the account."""
        reasons = self.refuses(scene)
        if reasons:
            raise ValueError("; ".join(reasons))
        check_state(scene, state)
        n = scene.n_grain
        before, self._scene = self._scene, scene
        changed = before is not None and before is not scene and state.step > 0
        self._n, self._step, self._t = n, state.step, state.t
        self._variant = variant_of(scene)
        self._choice = choice_of(scene)
        blocks = blocks_of(n, scene.plane_case)
        self._layout = BlockLayout(scene, blocks, self._variant)
        self._parameters = common_parameters(scene)
        self._material, self._table = material_arrays(scene)
        self._bodies = None
        if scene.bodies is not None and state.bodies is not None:
            self._bodies = body_arrays(scene, scene.bodies, state.bodies)
        self._smallest = scene.d_min
        self._parameters[P.T_ZERO] = state.t - state.step * scene.dt
        records = (n // blocks + _RECORDS, N_EVENT) if scene.events != EventRule.NONE else (1, 1)
        self._accounts = AccountArrays(
            np.zeros((blocks, *records)), np.zeros((blocks, N_ACCOUNT)), np.zeros((blocks, S.N_STATISTIC)),
            np.zeros((blocks, scene.n_wall, N_IMPULSE)),
        )  # fmt: skip
        self._n_list, own = 0, self._read_block(state)
        self._grains, self._pairs = self._layout.grains_by_id(state), self._layout.empty_pairs()
        self._candidates = CandidatePairs(self._layout, self._threads.count, self._smallest)
        # from here on another process may compile what a step needs
        self._pieces = PiecesOfStep(self._variant, self._choice, self._held(0), self._work[0])

        contacts, dropped = remaining_contacts(scene, state.contacts)
        self._records_drained = self._records_drained if changed else []
        if before is not None and changed:
            self._accounts.terms[0, Term.SWITCH] += energy_of_change(before, scene, state, dropped)
            self._records_drained.append(closed_records(state, dropped))
        memory = memory_of(contacts, self._variant, self._choice, self._parameters, self._layout)
        memory = shortened(memory) if has_short_rows(self._variant) else memory
        by_id = self._grains
        if len(by_id.n_touching):
            by_id.n_touching[:] = contacts_of_grains(memory, n)
        resumed = own is not None and not changed and not len(dropped)
        self._travel, self._kicked = 0.0, False
        if own is not None and resumed:
            by_id.x[:n, :3] = own.array("x_listed", (n, 3), _FARTHEST)
            self._travel = own.number("travel", 0.0, np.inf)
        self._set_poses()
        if resumed and own is not None and (faces := self._layout.walls.faces) is not None:
            shape = (len(faces.poses), BEFORE)  # walls too stood elsewhere when the pairs were listed
            faces.poses[:, :BEFORE] = own.array("poses_listed", shape, _FARTHEST)
        place_of, _ = self._list_pairs(np.zeros(blocks + 1, np.int64))
        self._set_poses()
        if resumed:
            self._grains.x[:n, :3] = state.x[self._grains.ids[:n]]
        self._parameters[P.SKIN] = self._skin
        self._prune(memory.parts(blocks), place_of)
        if state.step == 0:
            begin_account(scene, state, self._accounts.stats, self._accounts.terms)

    def forget(self) -> None:
        """Forget the scene: the next one is loaded as by a new engine, not as a change of the timeline."""
        self._scene = None

    def advance(self, n_steps: int) -> Flags:
        """Do n_steps steps, fewer if a fault stops the run."""
        if n_steps > 0 and self._step == 0:
            flags = self._advance(1)
            enter_start(self._accounts.stats, self._accounts.terms)
            if flags:
                return flags
            n_steps -= 1
        return self._advance(n_steps)

    def grains(self) -> State:
        """Where grains are and how they move, without contacts and energy account: a frame."""
        grains, place = self._grains, place_by_id(self._grains.ids, self._n)
        return State(
            x=grains.x[place, :3],
            v=grains.v[place, :3],
            omega=grains.w[place, :3],
            step=self._step,
            t=self._t,
            image=grains.image[place],
            bodies=None if self._bodies is None else body_state(self._bodies),
        )

    def state(self) -> State:
        """Read-only snapshot: all that an exact resume needs."""
        n, grains, place = self._n, self._grains, place_by_id(self._grains.ids, self._n)
        memory = collect_memory(n, grains.ids, self._candidates.pairs, self._share)
        memory = lengthened(memory) if has_short_rows(self._variant) else memory
        state = replace(
            self.grains(),
            contacts=contacts_of(memory, self._variant),
            tally=self.tally(),
            fluid=FluidAtGrains(grains.fluid[place], grains.impulse[place]) if self._variant.column else None,
            engine=self._block({"x_listed": self._x_listed[place]}),
        )
        make_read_only(state)
        return state

    def state_in_pieces(self) -> tuple[State, tuple[RowsInPieces, ...]]:
        """`state` without the arrays of grains and contacts, and these by the names of its fields."""
        pairs, column, none = self._candidates.pairs, bool(self._variant.column), np.zeros((0, 3))
        state = State(
            none, none, none, self._step, self._t, tally=self.tally(), engine=self._block({}),
            fluid=FluidAtGrains(none, none) if column else None,
            bodies=None if self._bodies is None else body_state(self._bodies),
        )  # fmt: skip
        count, ids = int(count_memory(pairs, self._share)[-1]), self._grains.ids
        rows = grain_rows(self._grains, self._n, self._x_listed, column)
        return state, (rows, contact_rows(self._n, ids, pairs, count, self._variant))

    def kinematics(self) -> tuple[Floats, Floats, Floats]:
        """Centres [m], velocities [m/s] and impulse from the fluid (model.fluid), by id."""
        grains, n = self._grains, self._n
        x, v, impulse = np.empty((n, 3)), np.empty((n, 3)), np.empty(grains.impulse.shape)
        rows_by_id(grains.ids[:n], grains.x, x)
        rows_by_id(grains.ids[:n], grains.v, v)
        rows_by_id(grains.ids[: len(impulse)], grains.impulse, impulse)
        return x, v, impulse

    def set_fluid(self, sampled: Floats) -> None:
        """Set the water at every grain for the next steps, and count its impulse anew."""
        check_sampled(sampled, self._grains.fluid.shape if self._variant.column else None)
        grains, ids = self._grains, self._grains.ids[: self._n]
        if self._step and not same_column(ids, sampled, grains.fluid, SUBMERGED):
            # energy of the water that moves along with a grain, or no longer does
            more = sampled[ids, SUBMERGED] - grains.fluid[:, SUBMERGED]
            added = grains.m[: self._n] - grains.m_bare[: self._n]
            v = grains.v[: self._n, :3]
            if self._bodies is not None:
                v = v.copy()
                body_shares(self._bodies, added, v)
            gain = np.zeros(self._n)
            gain[ids] = 0.5 * added * more * np.sum(v**2, axis=1)
            self._accounts.stats[0, S.PENDING_FLOW] += float(gain.sum())
        rows_by_place(ids, sampled, grains.fluid)
        grains.impulse[:] = 0.0

    def set_walls(self, motion: Floats) -> None:
        """Set the motion of the walls from this step on, as `Engine.set_walls`.

        Raises
        ------
        ValueError : the scene has no walls, or the shape is another.
        """
        faces = self._layout.walls.faces
        if faces is None or faces.motion.shape != motion.shape:
            raise ValueError(f"motion has shape {motion.shape}, which is not that of the walls of the scene")
        faces.motion[:] = motion

    def tally(self) -> Tally:
        """Energy account and extremes at the moment of the last force evaluation."""
        t = float(self._t - self._parameters[P.DT]) if self._step else self._t
        walls = self._accounts.walls.sum(axis=0).ravel()
        return tally_of(t, self._accounts.stats, self._accounts.terms, tuple(walls.tolist()))

    def events(self) -> np.ndarray:
        """Contacts ended since the last call, in order of parting."""
        self._drain_records()
        rows, self._records_drained = self._records_drained, []
        return sorted_events(rows)

    def _advance(self, n_steps: int) -> Flags:
        while n_steps > 0:
            done, stop = self._run(n_steps)
            n_steps -= done
            if stop == STOP_LIST:
                fault = self._rebuild_list()
                if fault is not None:
                    return Flags(fault)
            elif stop == STOP_PAIR:
                raise AssertionError(NOT_LISTED)
            elif stop == STOP_EVENTS:
                self._drain_records()
            elif stop == STOP_UNSAFE:
                return Flags(
                    unsafe_of(self._grains, self._n, self._parameters, self._smallest, self._step, self._t)
                )
            elif stop:
                at = self._step - (not self._kicked)  # of a step that is done, or of the kick of the next
                scene = self._layout.scene
                return Flags(fault_of(self._accounts.stats, self._parameters, scene, self._grains, at))
        return Flags()

    def _run(self, n_steps: int) -> tuple[int, int]:
        """Let the threads step; returns how many steps were done, and why they stopped (shared/status.py)."""
        layout, threads = self._layout, min(self._threads.count, len(self._layout.block_start) - 1)
        reach, count, faces = film_reach(layout.scene), np.zeros(1, np.int64), layout.walls.faces
        begin = (threads, n_steps, self._step, self._kicked, self._travel, reach)
        shared = (*begin, count, self._pieces.of_step, *self._pieces.between_kicks)
        schedule = self._candidates.schedule
        calls = [
            partial(run, k, *shared, self._held(k), faces, self._bodies, self._work[k], schedule)
            for k in range(threads)
        ]
        done, self._travel, stop, self._kicked = self._threads.together(calls)[0]
        self._step += done
        self._since += done
        self._t = float(self._parameters[P.T_ZERO] + self._step * self._parameters[P.DT])
        return done, stop

    def _held(self, thread: int) -> StepArrays:
        """All that a thread reads and writes in a step."""
        layout = self._layout
        return StepArrays(
            self._n, layout.n_solid, self._variant.plane_case, self._parameters, self._material, self._table,
            layout.block_start, self._choice, self._grains, layout.walls, self._pairs, self._candidates.pairs,
            self._candidates.spares[thread], self._accounts, self._bodies,
        )  # fmt: skip

    def _rebuild_list(self) -> RunError | None:
        """Choose a skin from counted work, bring grains back into the period, and list pairs anew."""
        # each list is freed before the next is made
        room, listed = self._pairs.start[self._layout.block_start], float(self._pairs.start[-1])
        self._pairs, self._x_listed = self._layout.empty_pairs(), np.zeros((0, 3))
        memory = self._candidates.take_memory(self._share)
        apart = listed - sum(len(one.i) for one in memory)  # from counts that a resumed run has too
        skin = best_skin(
            self._skin, 2.0 * self._travel / max(self._since, 1), _LIST + _LIST_GRAIN * self._n,
            COST_TEST * apart / _STEPS_A_CUT,
        )  # fmt: skip
        # pairs in touch may have parted in the last step, with exact timing in the one before: their account
        # is still to be closed
        parted = 2.001 * (1 + self._variant.exact) * self._fastest_displacement()
        self._skin = max(min(max(skin, 0.02 * self._smallest), self._most_skin()), parted)
        self._since, self._travel, self._n_list = 0, 0.0, self._n_list + 1
        self._set_poses()
        if self._bodies is not None:
            wrap_bodies(self._bodies, self._layout.period)
        place_of, lost = self._list_pairs(room)
        self._prune(memory, place_of)
        self._parameters[P.SKIN] = self._skin
        if lost < 0:
            return None
        return lost_of(self._grains, self._layout.scene.contact, lost, self._step, self._t)

    def _set_poses(self) -> None:
        """Put walls where they are at this step."""
        faces, c = self._layout.walls.faces, self._parameters
        if faces is not None:
            set_poses(c[P.T_ZERO] + self._step * c[P.DT], c[P.DT], faces.motion, faces.poses)

    def _list_pairs(self, room: np.ndarray) -> tuple[np.ndarray, int]:
        """Sort the grains and list their pairs; returns the new place of each, and a lost grain or -1."""
        if (faces := self._layout.walls.faces) is not None:
            self._poses_listed = faces.poses[:, :BEFORE].copy()
        found = self._layout.sort_grains(self._grains, self._skin, self._share)
        self._grains, self._x_listed = found.grains, found.listed
        self._grains, self._pairs = self._layout.list_pairs(found, room, self._skin, self._share)
        if self._bodies is not None and (bodies := self._layout.scene.bodies) is not None:
            self._bodies = place_members(self._bodies, bodies.members, self._grains.ids[: self._n])
        return found.place_of, found.lost

    def _prune(self, memory: list[ContactMemory], place_of: np.ndarray) -> None:
        displacement = self._fastest_displacement()
        self._candidates.begin(
            self._pieces.prune, self._held, self._skin, displacement, memory, place_of, self._share
        )

    def _share(self, task: Callable[[int, int], Any]) -> list[Any]:
        """Results of a task for blocks first..last-1, in order, one for each thread."""
        return self._threads.share(len(self._layout.block_start) - 1, task)

    def _most_skin(self) -> float:
        """Largest reach of a list beyond touch [m]: a few grains that hop over a bed go far."""
        return (8.0 if self._n <= _FEW else 1.0) * self._smallest

    def _fastest_displacement(self) -> float:
        """How far the fastest grain, or a point of a wall, went in the last step [m]."""
        faces = self._layout.walls.faces
        speed = max(float(self._accounts.stats[:, S.SPEED_MAX].max()), 0.0 if faces is None else faces.speed)
        return float(speed * self._parameters[P.DT])

    def _drain_records(self) -> None:
        for block, row in enumerate(self._accounts.stats):
            count = int(row[S.N_ENDED])
            if count:
                self._records_drained.append(self._accounts.ended[block, :count].copy())
                row[S.N_ENDED] = 0.0

    def _block(self, of_grains: dict[str, np.ndarray]) -> EngineBlock:
        """What an exact resume needs beside the state."""
        arrays = of_grains | account_arrays(self._accounts.stats, self._accounts.terms)
        if self._layout.walled:
            arrays["walls"] = self._accounts.walls.reshape(len(self._accounts.walls), -1).copy()
            arrays["poses_listed"] = self._poses_listed
        numbers = {"skin": self._skin, "travel": self._travel, "since": float(self._since)}
        return EngineBlock(self.name, VERSION, arrays, numbers)

    def _read_block(self, state: State) -> EngineBlock | None:
        """Skin and account of a snapshot; returns the block, None where another engine wrote the snapshot.

        Raises
        ------
        ValueError : the block has another version, or a value out of range.
        """
        own = state.block_of(self.name, VERSION)
        self._skin, self._since = self._skin_first * self._smallest, 0
        if own is not None:
            self._skin = own.number("skin", 0.0, max(self._most_skin(), self._layout.largest))
            self._since = int(own.number("since", 0.0, state.step))
        read_account(state, self._accounts.stats, self._accounts.terms, own)
        read_walls(state, self._accounts.walls, own)
        return own
