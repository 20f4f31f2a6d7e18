"""A number of grains that changes, for any engine: it steps those that are there, by numbers of its own.

A scene with feeds has all grains that will ever be there, with ids that never change. The pool gives its
engine a scene of the grains that are there, in the order of ids, and translates grain numbers both ways.
Kernels know nothing of it (design/0021).
"""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.engine.protocol import Engine, Flags
from ryusa.engine.shared import record_fields as R
from ryusa.engine.shared.passages import empty_tally, everywhere
from ryusa.errors import RunError
from ryusa.model import EVENT, BodyState, Contacts, FluidAtGrains, Scene, State, Tally
from ryusa.model.arrays import Bools, Floats
from ryusa.model.fluid import N_IMPULSE, N_SAMPLED
from ryusa.model.scene import EventRule
from ryusa.model.state import make_read_only

Ints = NDArray[np.int64]
_ROWS = ("d", "m", "m_added", "m_weight", "inertia")  # of a scene, by grain
# of an account while no grain is there
_KEPT = ("terms", "overlap_max", "overlap_grain", "overlap_step", "walls")


class GrainPool:
    """Steps the grains of a scene that are there.

    Parameters
    ----------
    engine : steps them; it must have a method `forget`.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._scene: Scene | None = None
        self._there: Bools = np.zeros(0, dtype=np.bool_)
        self._inner: Scene | None = None  # of the grains that are there

    @property
    def name(self) -> str:
        """Name of the engine that steps the grains."""
        return self._engine.name

    def refuses(self, scene: Scene) -> tuple[str, ...]:
        """Reasons why the engine cannot simulate the scene; () when it can."""
        reasons = [*self._engine.refuses(scene)]
        if getattr(self._engine, "forget", None) is None:
            reasons.append(f"engine '{self.name}' steps a fixed number of grains: no feeds or exits")
        return tuple(reasons)

    def load(self, scene: Scene, state: State) -> None:
        """Take a scene and a state of all grains; also when the timeline or a feed changes them."""
        there, before = everywhere(state), self._scene
        same = before is not None and np.array_equal(there, self._there)
        self._scene, self._there, self._ids = scene, there.copy(), np.flatnonzero(there)
        self._step, self._t, self._tally = state.step, state.t, state.tally
        self._n, self._dt = scene.n_grain, scene.dt
        self._t_zero = state.t - state.step * scene.dt
        self._worst = -1 if state.tally is None else state.tally.overlap_grain
        if not len(self._ids):
            self._forget()
            self._inner = None
            return
        if not same or self._inner is None:
            self._forget()
            self._inner = _scene_of(scene, self._ids, None)
        elif state.engine is None:  # a grain left and came in again at once: no change of the timeline
            self._forget()
            self._inner = _scene_of(scene, self._ids, self._inner)
        elif scene is not before:
            self._inner = _scene_of(scene, self._ids, self._inner)
        self._engine.load(self._inner, self._state_of(state))

    def set_fluid(self, sampled: Floats) -> None:
        """Set the water at every grain for the next steps; rows of grains that are away mean nothing."""
        if self._inner is not None:
            self._engine.set_fluid(np.ascontiguousarray(sampled[self._ids]))

    def set_walls(self, motion: Floats) -> None:
        """Set the motion of the walls from this step on, as the engine does; nothing without a grain."""
        if self._inner is not None:
            self._engine.set_walls(motion)

    def kinematics(self) -> tuple[Floats, Floats, Floats]:
        """Centres [m], velocities [m/s] and impulse from the fluid by id; nan and 0 for grains away."""
        x, v = np.full((self._n, 3), np.nan), np.full((self._n, 3), np.nan)
        coupled = self._scene is not None and self._scene.coupled
        impulse = np.zeros((self._n if coupled else 0, N_IMPULSE))
        if self._inner is not None:
            x[self._ids], v[self._ids], found = self._engine.kinematics()
            if coupled:
                impulse[self._ids] = found
        return x, v, impulse

    def advance(self, n_steps: int) -> Flags:
        """Do n_steps steps, fewer if a fault stops the run."""
        if self._inner is None:
            self._pass_time(n_steps)
            return Flags()
        flags = self._engine.advance(n_steps)
        return Flags(self._named(flags.fault)) if flags.fault is not None else flags

    def grains(self) -> State:
        """Positions and motion of all grains; nan for those that are not there."""
        inner = self._engine.grains() if self._inner is not None else None
        x, v, omega = (np.full((self._n, 3), np.nan) for _ in range(3))
        image = np.zeros((self._n, 2), dtype=np.int32)
        step, t = self._step, self._t
        if inner is not None:
            step, t = inner.step, inner.t
            x[self._ids], v[self._ids], omega[self._ids] = inner.x, inner.v, inner.omega
            if len(inner.image):
                image[self._ids] = inner.image
        bodies = self._bodies_out(None if inner is None else inner.bodies)
        return State(x=x, v=v, omega=omega, step=step, t=t, image=image, present=self._there, bodies=bodies)

    def _bodies_out(self, inner: BodyState | None) -> BodyState | None:
        """Motion of all clumps; nan for those that are not there."""
        if self._scene is None or (bodies := self._scene.bodies) is None:
            return None
        x, v, momentum = (np.full((bodies.n, 3), np.nan) for _ in range(3))
        moved = BodyState(x, v, np.full((bodies.n, 4), np.nan), momentum, np.zeros((bodies.n, 2), np.int32))
        if inner is not None:
            for name, array in vars(moved).items():
                array[self._there[bodies.first]] = getattr(inner, name)
        return moved

    def state(self) -> State:
        """Read-only snapshot of all grains."""
        if self._inner is None:
            state = replace(self.grains(), tally=self._tally, fluid=self._fluid_out(None))
        else:
            inner = self._engine.state()
            contacts = self._contacts_out(inner.contacts)
            state = replace(
                self.grains(), contacts=contacts, tally=self.tally(), engine=inner.engine,
                fluid=self._fluid_out(inner.fluid),
            )  # fmt: skip
        make_read_only(state)
        return state

    def tally(self) -> Tally:
        """Energy account and extremes, summed while stepping."""
        if self._inner is None:
            return self._tally or empty_tally(self._t)
        tally = self._engine.tally()
        grain = self._worst if tally.overlap_grain < 0 else int(self._ids[tally.overlap_grain])
        return replace(tally, overlap_grain=grain)

    def events(self) -> np.ndarray:
        """Contacts ended since the last call, with the ids of all grains."""
        if self._inner is None:
            return np.zeros(0, dtype=EVENT)
        found = self._engine.events()
        if len(found):
            found["i"], found["j"] = self._ids[found["i"]], self._partners_out(found["j"])
        return found

    def _pass_time(self, n_steps: int) -> None:
        """Go on without a grain; what has been summed stays."""
        if n_steps <= 0:
            return
        old = self._tally or empty_tally(self._t)
        self._step += n_steps
        self._t = float(self._t_zero + self._step * self._dt)
        kept = {name: getattr(old, name) for name in _KEPT}
        self._tally = replace(empty_tally(self._t - self._dt), **kept)

    def _forget(self) -> None:
        forget: Any = getattr(self._engine, "forget", None)
        if forget is None:
            raise ValueError(f"engine '{self.name}' steps a fixed number of grains")
        forget()

    def _named(self, fault: RunError) -> RunError:
        """The same fault with the ids of all grains."""
        partner = fault.partner
        if partner is not None:
            partner = int(self._partners_out(np.array([partner]))[0])
        grain = int(self._ids[fault.grain]) if 0 <= fault.grain < len(self._ids) else fault.grain
        return type(fault)(
            fault.cause, grain=grain, step=fault.step, t=fault.t, hint=fault.hint, partner=partner,
            surface=fault.surface,
        )  # fmt: skip

    def _state_of(self, state: State) -> State:
        """The state of the grains that are there, for the engine."""
        ids, tally = self._ids, state.tally
        if tally is not None:
            grain = int(np.searchsorted(ids, tally.overlap_grain)) if tally.overlap_grain >= 0 else -1
            known = 0 <= grain < len(ids) and ids[grain] == tally.overlap_grain
            tally = replace(tally, overlap_grain=grain if known else -1)
        fluid = state.fluid
        if fluid is not None:
            fluid = FluidAtGrains(*(np.ascontiguousarray(one[ids]) for one in (fluid.sampled, fluid.impulse)))
        return State(
            x=np.ascontiguousarray(state.x[ids]),
            v=np.ascontiguousarray(state.v[ids]),
            omega=np.ascontiguousarray(state.omega[ids]),
            step=state.step,
            t=state.t,
            image=np.ascontiguousarray(state.image[ids]) if len(state.image) else state.image,
            contacts=self._contacts_in(state.contacts),
            tally=tally,
            bodies=None if state.bodies is None else state.bodies.some(self._bodies_there()),
            fluid=fluid,
            engine=state.engine,
        )

    def _bodies_there(self) -> Ints:
        """Clumps that are there."""
        assert self._scene is not None
        bodies = self._scene.bodies
        return np.zeros(0, np.int64) if bodies is None else np.flatnonzero(self._there[bodies.first])

    def _fluid_out(self, fluid: FluidAtGrains | None) -> FluidAtGrains | None:
        """The water at all grains, zero at those that are away; None where the water does not feel them."""
        if self._scene is None or not self._scene.coupled:
            return None
        sampled, impulse = np.zeros((self._n, N_SAMPLED)), np.zeros((self._n, N_IMPULSE))
        if fluid is not None:
            sampled[self._ids], impulse[self._ids] = fluid.sampled, fluid.impulse
        return FluidAtGrains(sampled, impulse)

    def _contacts_in(self, contacts: Contacts) -> Contacts:
        if not len(contacts):
            return contacts
        n, ids = self._n, self._ids
        place = np.full(n, -1, dtype=np.int64)
        place[ids] = np.arange(len(ids))
        free = contacts.j < n
        j = np.where(free, place[np.minimum(contacts.j, n - 1)], contacts.j - n + len(ids))
        return self._renamed(contacts, place[contacts.i], j)

    def _contacts_out(self, contacts: Contacts) -> Contacts:
        if not len(contacts):
            return contacts
        return self._renamed(contacts, self._ids[contacts.i], self._partners_out(contacts.j))

    def _partners_out(self, j: Ints) -> Ints:
        k = len(self._ids)
        return np.where(j < k, self._ids[np.minimum(j, k - 1)], j - k + self._n)

    def _renamed(self, contacts: Contacts, i: Ints, j: Ints) -> Contacts:
        """Contacts with other ids, also in their records that are open."""
        event = contacts.event
        assert self._scene is not None
        if self._scene.events != EventRule.NONE:
            event = event.copy()
            opened = (event[:, R.OVERLAP_MAX] > 0.0) & (event[:, R.PARTNER] >= 0.0)
            event[opened, R.GRAIN], event[opened, R.PARTNER] = i[opened], j[opened]
        return replace(contacts, i=i, j=j, event=event)


def stepping(engine: Engine, scene: Scene) -> Engine:
    """The engine for a scene: itself, or in a pool where grains enter and leave, or where there is none."""
    return engine if scene.traffic is None and scene.n_grain else GrainPool(engine)


def _scene_of(scene: Scene, ids: Ints, earlier: Scene | None) -> Scene:
    """The scene of the grains of some ids; `earlier` one of the same ids lends its arrays."""
    if earlier is not None:
        rows = {name: getattr(earlier, name) for name in (*_ROWS, "tracked")}
    else:
        rows = {name: getattr(scene, name)[ids] for name in _ROWS}
        rows["tracked"] = scene.tracked[ids] if len(scene.tracked) else scene.tracked
        for array in rows.values():
            array.flags.writeable = False
    materials = scene.materials
    if materials is not None:
        of = np.concatenate([materials.of[ids], materials.of[scene.n_grain :]])
        of.flags.writeable = False
        materials = replace(materials, of=of)
    bodies = scene.bodies
    if bodies is not None and earlier is not None:
        bodies = earlier.bodies
    elif bodies is not None:
        which = np.flatnonzero(np.isin(bodies.first, ids))
        bodies = bodies.some(which, np.searchsorted(ids, bodies.first[which]))
    shift = len(ids) - scene.n_grain
    groups = {
        name: (first + shift, end + shift)
        for name, (first, end) in scene.groups.items()
        if first >= scene.n_grain
    }
    return replace(scene, **rows, groups=groups, traffic=None, materials=materials, bodies=bodies)
