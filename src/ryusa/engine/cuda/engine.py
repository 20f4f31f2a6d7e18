"""The CUDA engine: rebuilds the list, launches steps in between, and reads back what lies on the device."""

from dataclasses import replace
from typing import Any

import numpy as np

from ryusa.engine.cuda import run_status as F
from ryusa.engine.cuda import step_totals as T
from ryusa.engine.cuda.arrays import RecordedGrains
from ryusa.engine.cuda.device import cuda
from ryusa.engine.cuda.device_state import DeviceState, blocks, shape
from ryusa.engine.cuda.shear import make_close_kicks, make_close_shear, make_shear
from ryusa.engine.cuda.step import make_close, make_step
from ryusa.engine.cuda.step_graph import STEPS, StepGraphs
from ryusa.engine.cuda.step_totals import NO_GRAIN
from ryusa.engine.protocol import Flags
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_memory import contacts_of, remaining_contacts
from ryusa.engine.shared.contact_records import closed_records, sorted_events
from ryusa.engine.shared.energy_account import (
    N_ACCOUNT,
    begin_account,
    energy_of_change,
    enter_start,
    read_account,
    tally_of,
)
from ryusa.engine.shared.faults import fault_of, lost_of, unsafe_of
from ryusa.engine.shared.layout import film_reach
from ryusa.engine.shared.parameters import parameters_of
from ryusa.engine.shared.refusals import check_sampled, check_state, refusals
from ryusa.engine.shared.skin import best_skin
from ryusa.engine.shared.status import STOP_DONE, STOP_EVENTS, STOP_LIST, STOP_UNSAFE
from ryusa.engine.shared.variant import choice_of, variant_of
from ryusa.errors import RunError
from ryusa.laws.families import Adhesion
from ryusa.model import EngineBlock, FluidAtGrains, Scene, State, Tally, Term
from ryusa.model.contacts import N_EVENT
from ryusa.model.fluid import SUBMERGED
from ryusa.model.scene import EventRule, Floats
from ryusa.model.state import make_read_only

VERSION = 1  # of the block in a snapshot
_FARTHEST = 1e12  # [m]; beyond there is no grain
_RECORDS = 256  # room for ended contacts, beside one a grain
# What a new list moves for a grain, and a step for a listed neighbour [B]: the skin follows from such counts,
# never from a clock.
_LIST_COST, _NEIGHBOUR_COST = 4000.0, 36.0
_BATCH = 256  # largest number of steps launched before the host reads the status


class CudaEngine:
    """Steps a scene on a CUDA device; the same bits however steps are split into calls.

    Parameters
    ----------
    skin : first reach of the neighbour list beyond touch, over the smallest diameter [-]; adapts to
        counted work.
    """

    name = "cuda"

    def __init__(self, skin: float = 0.1) -> None:
        self._skin_first = skin
        self._scene: Scene | None = None
        self._records_drained: list[np.ndarray] = []

    def refuses(self, scene: Scene) -> tuple[str, ...]:
        """Reasons why this engine cannot simulate the scene; () when it can. Those of the CPU engine."""
        walls = ("walls are simulated by engine 'cpu' alone",) if scene.n_face else ()
        mixed = ("several materials are simulated by engine 'cpu' alone",) if scene.materials else ()
        clumps = ("clumps are simulated by engine 'cpu' alone",) if scene.bodies else ()
        sticky = scene.contact.adhesion != Adhesion.NONE
        adhesion = ("adhesion is simulated by engine 'cpu' alone",) if sticky else ()
        row = ("a row of columns of water goes with engine 'cpu' alone",) if scene.row else ()
        return (*refusals(scene), *row, *walls, *mixed, *clumps, *adhesion)

    def load(self, scene: Scene, state: State) -> None:
        """Take a scene and an initial state or a snapshot; enter a change of the scene in the account."""
        reasons = self.refuses(scene)
        if reasons:
            raise ValueError("; ".join(reasons))
        check_state(scene, state)
        before, self._scene = self._scene, scene
        self._contact = scene.contact
        changed = before is not None and before is not scene and state.step > 0
        self._n = n = scene.n_grain
        self._variant, self._choice = variant_of(scene), choice_of(scene)
        self._step_kernel = make_step(self._variant, self._choice, shape())
        self._close_kernel = make_close(shape())
        if self._variant.exact:
            self._close_kernel = make_close_kicks(shape())
            self._shear_kernel = make_shear(self._variant, self._choice, shape())
            self._close_shear_kernel = make_close_shear(shape())
        self._smallest = scene.d_min
        self._parameters = parameters_of(scene)
        self._parameters[P.T_ZERO] = state.t - state.step * scene.dt
        self._room = n + _RECORDS if scene.events != EventRule.NONE else 1
        self._n_list = 0
        stats, terms = np.zeros((1, S.N_STATISTIC)), np.zeros((1, N_ACCOUNT))
        read_account(state, stats, terms, None)  # its one row is the sum
        own = self._read_block(state)

        contacts, dropped = remaining_contacts(scene, state.contacts)
        self._records_drained = self._records_drained if changed else []
        if before is not None and changed:
            terms[0, Term.SWITCH] += energy_of_change(before, scene, state, dropped)
            self._records_drained.append(closed_records(state, dropped))
        resumed = own is not None and not changed and not len(dropped)
        self._travel, x, extent = 0.0, state.x, None
        if own is not None and resumed:
            self._travel = own.number("travel", 0.0, np.inf)
            x = own.array("x_listed", (n, 3), _FARTHEST)
        if own is not None and not changed:
            extent = own.array("extent", (2, 3), _FARTHEST)
        self._fluid = None
        if self._variant.column:
            self._fluid = (state.fluid or FluidAtGrains.at_rest(n)).sampled.copy()
        placed = State(
            x=x, v=state.v, omega=state.omega, image=state.image, fluid=state.fluid, contacts=contacts
        )
        self._graphs = StepGraphs()
        self._device = DeviceState(scene, placed, self._variant, self._choice, self._parameters, extent)
        self._status = np.zeros(F.N_STATUS, np.int64)
        self._status[F.STEP], self._status[F.OVERFLOWED] = state.step, NO_GRAIN
        if state.step == 0:
            begin_account(scene, state, stats, terms)
        self._motion = np.zeros(F.N_MOTION)
        self._motion[F.FASTEST] = stats[0, S.SPEED_MAX]
        self._d_status, self._d_motion = cuda.to_device(self._status), cuda.to_device(self._motion)
        self._d_stats, self._d_terms = cuda.to_device(stats), cuda.to_device(terms)
        self._d_ended = cuda.to_device(np.zeros((self._room, N_EVENT)))
        self._d_partial = cuda.to_device(np.zeros(blocks(n) * T.N_COLUMN))
        if self._variant.exact and not resumed:  # a pair may have parted since the last kick
            self._skin = max(self._skin, self._least_skin())
        self._list_pairs()
        if resumed:
            self._device.set_positions(state.x)

    def forget(self) -> None:
        """Forget the scene: the next one is loaded as by a new engine, not as a change of the timeline."""
        self._scene = None

    def advance(self, n_steps: int) -> Flags:
        """Do n_steps steps, fewer if a fault stops the run."""
        if n_steps > 0 and self._step == 0:
            flags = self._advance(1)
            stats, terms = self._d_stats.copy_to_host(), self._d_terms.copy_to_host()
            enter_start(stats, terms)
            self._d_terms.copy_to_device(terms)
            if flags:
                return flags
            n_steps -= 1
        return self._advance(n_steps)

    def grains(self) -> State:
        """Where grains are and how they move, without contacts and energy account: a frame."""
        device, ids = self._device, self._device.ids()
        return State(
            x=np.ascontiguousarray(device.by_id("x", ids)[:, :3]),
            v=np.ascontiguousarray(device.by_id("v", ids)[:, :3]),
            omega=np.ascontiguousarray(device.by_id("w", ids)[:, :3]),
            step=self._step,
            t=self._t,
            image=device.by_id("image", ids),
        )

    def state(self) -> State:
        """Read-only snapshot: all that an exact resume needs."""
        device, ids = self._device, self._device.ids()
        contacts = contacts_of(device.memory(), self._variant)
        fluid = None
        if self._variant.column:
            fluid = FluidAtGrains(device.by_id("fluid", ids), device.by_id("impulse", ids))
        state = replace(
            self.grains(),
            contacts=contacts,
            tally=self.tally(),
            fluid=fluid,
            engine=self._block(),
        )
        make_read_only(state)
        return state

    def kinematics(self) -> tuple[Floats, Floats, Floats]:
        """Centres [m], velocities [m/s] and impulse from the fluid (model.fluid), by id."""
        device, ids = self._device, self._device.ids()
        impulse = device.by_id("impulse", ids) if self._variant.column else np.zeros((0, 0))
        return (
            np.ascontiguousarray(device.by_id("x", ids)[:, :3]),
            np.ascontiguousarray(device.by_id("v", ids)[:, :3]),
            impulse,
        )

    def set_walls(self, motion: Floats) -> None:
        """Refuse: this engine has no walls but planes."""
        raise ValueError("the cuda engine has no [[walls]]")

    def set_fluid(self, sampled: Floats) -> None:
        """Set the water at every grain for the next steps, and count its impulse anew."""
        check_sampled(sampled, None if self._fluid is None else self._fluid.shape)
        assert self._fluid is not None
        assert self._scene is not None
        device, ids = self._device, self._device.ids()
        more = sampled[:, SUBMERGED] - self._fluid[:, SUBMERGED]
        if self._step and more.any():  # energy of the water that moves along with a grain, or no longer does
            v = device.by_id("v", ids)[:, :3]
            stats = self._d_stats.copy_to_host()
            stats[0, S.PENDING_FLOW] += float((0.5 * self._scene.m_added * more * np.sum(v**2, axis=1)).sum())
            self._d_stats.copy_to_device(stats)
        self._fluid = sampled.copy()
        device.bodies.fluid.copy_to_device(np.ascontiguousarray(sampled[ids]))
        device.bodies.impulse.copy_to_device(np.zeros(device.bodies.impulse.shape))

    def tally(self) -> Tally:
        """Energy account and extremes at the moment of the last force evaluation."""
        t = float(self._t - self._parameters[P.DT]) if self._step else self._t
        return tally_of(t, self._d_stats.copy_to_host(), self._d_terms.copy_to_host())

    def events(self) -> np.ndarray:
        """Contacts ended since the last call, in order of parting."""
        self._drain_records()
        rows, self._records_drained = self._records_drained, []
        return sorted_events(rows)

    @property
    def _step(self) -> int:
        return int(self._status[F.STEP])

    @property
    def _t(self) -> float:
        return float(self._parameters[P.T_ZERO] + self._step * self._parameters[P.DT])

    def _advance(self, n_steps: int) -> Flags:
        """Launch steps until they are done; a step that comes after a stop passes over itself."""
        target = self._step + n_steps
        self._status[F.TARGET] = target
        self._d_status.copy_to_device(self._status)
        while self._step < target:
            if self._list_is_due():
                fault = self._rebuild_list()
                if fault is not None:
                    return Flags(fault)
            was = self._step
            graphs, rest = divmod(min(target - was, self._until_list()), STEPS)
            for _ in range(rest):
                self._launch(0)
            for _ in range(graphs):
                self._graphs.launch(self._device.arrays, self._launch)
            self._download_status()
            self._since += self._step - was
            stop = int(self._status[F.STOP])
            if stop == STOP_EVENTS:
                self._drain_records()
            elif stop == STOP_UNSAFE:
                return Flags(self._unsafe_grain())
            elif stop not in (STOP_DONE, STOP_LIST):
                assert self._scene is not None
                return Flags(
                    fault_of(
                        self._d_stats.copy_to_host(),
                        self._parameters,
                        self._scene,
                        self._grains_by_id(),
                        self._step - 1,
                    )
                )
        return Flags()

    def _launch(self, stream: Any) -> None:
        """Launch one step."""
        device, n_block, cut = self._device, blocks(self._n), shape()
        self._step_kernel[n_block, cut.threads, stream, 8 * cut.shared_doubles](
            self._n, device.n_solid, device.c, self._d_status, device.bodies, device.walls, device.pairs,
            self._d_ended, self._d_partial,
        )  # fmt: skip
        self._close_kernel[1, cut.closers, stream, 8 * cut.segments * T.N_COLUMN](
            n_block, self._room, device.c, self._d_partial, self._d_status, self._d_motion, self._d_terms,
            self._d_stats,
        )  # fmt: skip
        if self._variant.exact:
            self._shear_kernel[n_block, cut.threads, stream, 8 * cut.threads * T.N_OF_SHEAR](
                self._n, device.n_solid, device.c, self._d_status, self._d_motion, device.bodies,
                device.walls, device.pairs, self._d_partial,
            )  # fmt: skip
            self._close_shear_kernel[1, cut.closers, stream, 8 * cut.segments * T.N_OF_SHEAR](
                n_block, self._room, device.c, self._d_partial, self._d_status, self._d_motion, self._d_stats
            )

    def _list_is_due(self) -> bool:
        """Whether pairs have to be listed anew; with exact timing a kernel tells, between kicks and shear."""
        if self._variant.exact:
            return int(self._status[F.STOP]) == STOP_LIST
        return 2.0 * self._travel > self._skin

    def _until_list(self) -> int:
        """Steps to launch before the status is read: about as many as the list stays valid."""
        displacement = self._motion[F.FASTEST] * self._parameters[P.DT]
        left = 0.5 * self._skin - self._travel
        return _BATCH if displacement * _BATCH <= left else max(1, int(left / displacement) + 1)

    def _download_status(self) -> None:
        """Read where the run stands."""
        self._d_status.copy_to_host(self._status)
        self._d_motion.copy_to_host(self._motion)
        self._travel = float(self._motion[F.TRAVEL])
        self._device.half = int(self._status[F.CURRENT])

    def _upload_status(self) -> None:
        """Tell the device where the run stands."""
        self._status[F.STOP], self._status[F.CURRENT] = STOP_DONE, self._device.half
        self._motion[F.TRAVEL], self._motion[F.SKIN] = self._travel, self._skin
        self._d_status.copy_to_device(self._status)
        self._d_motion.copy_to_device(self._motion)

    def _rebuild_list(self) -> RunError | None:
        """Choose a skin from counted work, bring grains back into the period, and list pairs anew."""
        skin = best_skin(
            self._skin, 2.0 * self._travel / max(self._since, 1), _LIST_COST * self._n,
            _NEIGHBOUR_COST * self._device.n_pair,
        )  # fmt: skip
        self._skin = min(max(skin, 0.02 * self._smallest), self._smallest)
        self._skin = max(self._skin, self._least_skin())
        self._since, self._travel, self._n_list = 0, 0.0, self._n_list + 1
        lost = self._list_pairs()
        return self._lost_grain(lost) if lost >= 0 else None

    def _least_skin(self) -> float:
        """Reach of a list that finds a pair that parted in the last step, with exact timing in two [m]."""
        return 2.001 * (1 + self._variant.exact) * float(self._motion[F.FASTEST] * self._parameters[P.DT])

    def _list_pairs(self) -> int:
        lost = self._device.list_pairs(self._skin, film_reach(self._device.scene))
        self._upload_status()
        return lost

    def _drain_records(self) -> None:
        self._download_status()
        count = int(self._status[F.ENDED])
        if count:
            self._records_drained.append(self._d_ended[:count].copy_to_host())
            self._status[F.ENDED] = 0
            if self._status[F.STOP] == STOP_EVENTS:
                self._status[F.STOP] = STOP_DONE
            self._d_status.copy_to_device(self._status)

    def _lost_grain(self, grain: int) -> RunError:
        return lost_of(self._grains_by_id(), self._contact, grain, self._step, self._t)

    def _unsafe_grain(self) -> RunError:
        return unsafe_of(self._grains_by_id(), self._n, self._parameters, self._smallest, self._step, self._t)

    def _grains_by_id(self) -> Any:
        """Grains by id, for a fault message."""
        device, ids = self._device, self._device.ids()
        x, v, w = (device.by_id(name, ids) for name in ("x", "v", "w"))
        return RecordedGrains(x, v, w, np.arange(self._n), None, None)

    def _read_block(self, state: State) -> EngineBlock | None:
        """Skin of a snapshot; returns the block, None where another engine wrote the snapshot.

        Raises
        ------
        ValueError : the block has another version, or a value out of range.
        """
        own = state.block_of(self.name, VERSION)
        self._skin, self._since = self._skin_first * self._smallest, 0
        if own is not None and self._scene is not None:
            self._skin = own.number("skin", 0.0, self._scene.d_max)
            self._since = int(own.number("since", 0.0, state.step))
        return own

    def _block(self) -> EngineBlock:
        """What an exact resume needs beside the state."""
        arrays = {"x_listed": self._device.listed.copy_to_host(), "extent": self._device.extent.copy()}
        numbers = {"skin": self._skin, "travel": self._travel, "since": float(self._since)}
        return EngineBlock(self.name, VERSION, arrays, numbers)
