"""Steps until a stop rule is met, a fault is found, or somebody says stop."""

import math
import time
from collections.abc import Callable
from contextlib import nullcontext, suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.engine.protocol import Engine, Flags
from ryusa.errors import CheckpointError, DiskFull, RyusaError
from ryusa.model import EVENT, Scene, State
from ryusa.results import schema
from ryusa.running import provenance
from ryusa.running.checkpoint import Kept
from ryusa.running.closing import closing_lines
from ryusa.running.folder import write_json, write_last_words
from ryusa.running.guards import energy_created
from ryusa.running.interrupt import Heard, listening
from ryusa.running.keeper import Keeper
from ryusa.running.place import Place
from ryusa.running.progress import Moment, Progress
from ryusa.running.recorder import Recorder
from ryusa.running.snapshot import kept_state
from ryusa.running.stops import Hops, Rest, Stop
from ryusa.running.watch import Watch
from ryusa.water.coupling import Coupling

_CHUNK = 0.25  # s of wall time between two looks at the clock and at Ctrl-C
_CHUNK_FIRST = (1, 16)  # steps of the first calls, before the speed is known
_COMPILING = "compiling kernels for this machine: once, some ten seconds; later runs start at once"
_NEVER = 2**62  # steps
_HAND_OVER = 65_536  # steps after which contacts are handed over where nothing else falls due before
_LOOK_FOR_ROOM = 1.0  # s between two looks whether a full disk has room again
_DISK_PATIENCE = 86_400.0  # s


@dataclass(frozen=True)
class Change:
    """One change of the timeline."""

    at: float  # [s]; falls on the nearest step
    apply: Callable[[Scene], Scene]
    what: str = "scene changed"  # for the log


@dataclass
class Loop:
    """The one loop. What is recorded and when it stops follow from steps alone, never from the clock."""

    engine: Engine
    scene: Scene
    frames: float  # time between frames [s]
    stop: Stop
    changes: list[tuple[int, int, Change]]  # (step, order, change), sorted; taken off the front
    recorder: Recorder
    watch: Watch
    progress: Progress
    origin: dict[str, Any]  # provenance of a run that has begun
    keeper: Keeper | None = None  # writes checkpoints
    status: str = schema.RUNNING
    message: str = ""
    _step: int = 0
    _t_zero: float = 0.0
    _first: int = 0  # step of frame 0
    _frame: int = 1  # number of the next one
    _n_changed: int = 0  # entries of the timeline done
    _heard: Heard = field(default_factory=Heard)
    _resting: bool = False
    _hopped: bool = False
    _gathered: list[NDArray[np.void]] = field(default_factory=list[NDArray[np.void]])
    _calls: int = 0
    _water: Coupling | None = None
    _speed: float = 0.0  # steps per second, lately
    _warm: tuple[int, float] = (0, 0.0)  # step and wall time when kernels were ready
    _begun: float = field(default_factory=time.monotonic)
    _stands: bool = False  # the engine has a state

    def run(self, state: State, kept: Kept | None = None) -> None:
        """Run to the end, whatever it is; the run folder is whole when this returns or raises.

        Parameters
        ----------
        state : the first moment, or that of a checkpoint; then `scene` is the one that held there.
        kept : where the loop stood, its part of a checkpoint.
        """
        try:
            with listening() as self._heard:
                self._run(state, kept)
                self._with_room(self.recorder.flush)
                if self.status == schema.STOPPED:
                    self._keep()
                    self._write_tail()
        except BaseException as error:
            self.status, self.message = schema.FAILED, str(error) or type(error).__name__
            if isinstance(error, KeyboardInterrupt):
                self.status = schema.INTERRUPTED
            elif isinstance(error, DiskFull) and self._heard.by:
                self.status, self.message = schema.STOPPED, f"{self._heard.by} while the disk was full"
            # one of our own is said by whoever catches it
            self.progress.line(f"{self.status}: {self.message}", shown=not isinstance(error, RyusaError))
            for last in self._last():
                with suppress(RyusaError, OSError):
                    last()
            raise
        self.progress.line(f"{self.status}: {self.message}")
        for line in closing_lines(self._close()):
            self.progress.line(line)
        if self.keeper is not None and self.status == schema.COMPLETE:
            self.keeper.remove()

    def _last(self) -> tuple[Callable[[], Any], ...]:
        """What a run that ends early still writes; where the engine took no state, that it failed."""
        whole = self.recorder.flush, self._write_tail, self._close
        return whole if self._stands else (self._last_words,)

    def _run(self, state: State, kept: Kept | None) -> None:
        if kept is None:
            self._begin(state)
        else:
            self._go_on(state, kept)
        last, look_every = self._last_step(), self._look_every()
        while not self._done(last):
            next_frame = self._first + round(self._frame * self.frames / self.scene.dt)
            next_change = self.changes[0][0] if self.changes else _NEVER
            next_look = (self._step // look_every + 1) * look_every
            hand_over = (self._step // _HAND_OVER + 1) * _HAND_OVER
            due = min(next_frame, next_change, next_look, last)
            if not self._go_to(min(due, hand_over)):
                continue
            self._hand_over()
            if self._step == next_frame:
                self._record()
                self._frame += 1
            if self._step == due:
                self._hopped = self._hops.reached()
            if self._step == next_look and not self.changes:
                self._resting = self._rest.reached(self._t, self._fastest())
            self._change_if_due()
            self._end_stretch()

    def _begin(self, state: State) -> None:
        self._step, self._t_zero = state.step, state.t - state.step * self.scene.dt
        self._first = state.step
        self._rest, self._hops = Rest(self.stop), Hops(self.scene, self.stop)
        with self.progress.patience(_COMPILING):
            self.engine.load(self.scene, state)
        self._stands = True
        self._begin_water(state)
        self._record()
        self._change_if_due()
        self.recorder.reached(self._step)
        self._with_room(self.recorder.flush)

    def _go_on(self, state: State, kept: Kept) -> None:
        """Stand where the checkpoint was written, which may be any step."""
        self._step, self._warm = state.step, (state.step, time.monotonic())
        self._rest, self._hops = Rest(self.stop), Hops(self.recorder.first_scene, self.stop)
        place = Place.of(kept, self.scene)
        self._t_zero, self._first, self._frame = place.t_zero, place.first, place.frame
        self._resting, self._hopped = place.resting, place.hopped
        self._rest.since = place.since
        self._hops.parted[:], self._hops.count[:] = place.parted, place.hops
        self._gathered = [place.gathered] if len(place.gathered) else []
        self._begun -= place.wall
        self._n_changed = place.changed
        try:
            with self.progress.patience(_COMPILING):
                self.engine.load(self.scene, state)
            self._begin_water(state)
            self._stands = True
            self.progress.starts_at(self._moment().share)
        except (ValueError, ArithmeticError, AssertionError) as error:
            raise CheckpointError(f"the checkpoint's state cannot be gone on from ({error})") from error

    def _place(self) -> "Place":
        return Place(
            t_zero=self._t_zero, first=self._first, frame=self._frame, changed=self._n_changed,
            resting=self._resting, hopped=self._hopped, since=self._rest.since,
            wall=time.monotonic() - self._begun, parted=self._hops.parted, hops=self._hops.count,
            gathered=self._sorted(),
        )  # fmt: skip

    def _end_stretch(self) -> None:
        """All up to this step is done and recorded."""
        self.recorder.reached(self._step)
        if self._with_room(self.recorder.flush_if_due):
            with suppress(DiskFull):
                write_json(self.recorder.folder / schema.SUMMARY, self._summary())
        self._keep_if_due()

    def _go_to(self, target: int) -> bool:
        """Advance to a step in calls of bounded wall time; False when somebody said stop on the way."""
        while self._step < target and not self._heard.by:
            self._advance(min(target - self._step, self._chunk()))
            if self.progress.due():
                self.progress.update(self._moment())
            if self._step < target:
                self._keep_if_due()
        return self._step == target

    def _keep_if_due(self) -> None:
        if self.keeper is not None and (self._heard.keep or self.keeper.due()):
            asked, self._heard.keep = self._heard.keep, False
            self._keep(told=asked)

    def _keep(self, *, told: bool = False) -> None:
        """Write a checkpoint of this very step; one that finds no room is told, and the last one stays."""
        if self.keeper is None or self._step == self._first:
            return
        self.recorder.flush_if_large()
        parts = {"loop": self._place().kept(), "watch": self.watch.kept(), "recorder": self.recorder.kept()}
        try:
            self.keeper.write(kept_state(self.state()), self.scene, parts)
        except RyusaError as error:
            self.progress.line(f"no checkpoint: {error}")
            return
        if self.status == schema.STOPPED:
            self.progress.line(f"checkpoint at step {self._step}: ryusa resume {self.recorder.folder}")
        elif told:
            self.progress.line(f"checkpoint at step {self._step}, t = {self._t:.6g} s, as asked")

    def _gather(self) -> None:
        events = self.engine.events()
        if len(events):
            self._gathered.append(np.array(events, dtype=EVENT))

    def _sorted(self) -> NDArray[np.void]:
        """Contacts that ended in this stretch, in an order that does not know how it was cut into calls."""
        if not self._gathered:
            return np.zeros(0, dtype=EVENT)
        rows = np.concatenate(self._gathered)
        return rows[np.lexsort((rows["t_begin"], rows["j"], rows["i"], rows["t_part"]))]

    def _hand_over(self) -> None:
        events, self._gathered = self._sorted(), []
        self.recorder.contacts(events)
        self.watch.contacts(events)
        if self.stop.saltations is not None:
            self._hops.contacts(events)

    def _write_tail(self) -> None:
        """Leave what ended in the stretch that was not finished, for whoever reads and does not go on."""
        self.recorder.tail(self._sorted())

    def _with_room(self, action: Callable[[], bool]) -> bool:
        """Do what writes; where the disk is full, wait until there is room or somebody says stop."""
        begun, said = time.monotonic(), False
        while True:
            try:
                done = action()
            except DiskFull as error:
                if self._heard.by or time.monotonic() - begun > _DISK_PATIENCE:
                    raise
                if not said:
                    self.progress.line(f"paused: {error}. It goes on when there is room; Ctrl-C stops it")
                said = True
                time.sleep(_LOOK_FOR_ROOM)
                continue
            if said:
                self.progress.line("there is room again: the run goes on")
            return done

    def _advance(self, n_steps: int) -> None:
        begun = time.monotonic()
        with self.progress.patience(_COMPILING) if self._calls == 0 else nullcontext():
            flags = self._steps(n_steps)
        self._gather()
        if flags:
            self._step = self.engine.grains().step
            flags.raise_if_any()
        now = time.monotonic()
        speed = n_steps / max(now - begun, 1e-9)
        if self._calls <= 1:
            self._warm, self._speed = (self._step, now), speed
        else:
            self._speed += 0.3 * (speed - self._speed)
        self._calls += 1

    def _steps(self, n_steps: int) -> Flags:
        """Step the engine; on the way, water and grains hand over what they did to each other."""
        end = self._step + n_steps
        while self._step < end:
            due = end if self._water is None else self._water.due
            k = min(end, due) - self._step
            flags = self.engine.advance(k)
            if flags:
                return flags
            self._step += k
            if self._water is not None and self._step == due:
                self.engine.set_fluid(self._water.exchange(*self.engine.kinematics()))
        return Flags()

    def _begin_water(self, state: State) -> None:
        """Fill the column of water, where the scene has one, and tell the grains; or go on as it stood."""
        column = self.scene.column
        if column is None:
            return
        if state.coupling is not None and state.fluid is not None:
            sampled = state.fluid.sampled
            self._water = Coupling.resume(self.scene, column, column.interval, state.coupling, sampled)
            return
        x, _, _ = self.engine.kinematics()
        self._water = Coupling.begin(self.scene, column, column.interval, x, step=self._step)
        self.engine.set_fluid(self._water.sampled)

    def state(self) -> State:
        """Snapshot of grains and water: all that an exact resume needs."""
        state = self.engine.state()
        return state if self._water is None else replace(state, coupling=self._water.snapshot())

    def _chunk(self) -> int:
        if self._calls < len(_CHUNK_FIRST):
            return _CHUNK_FIRST[self._calls]
        return max(1, int(self._speed * _CHUNK))

    def _change_if_due(self) -> None:
        while self.changes and self.changes[0][0] <= self._step:
            _, _, change = self.changes.pop(0)
            state = self.engine.state()
            self.scene = change.apply(self.scene)
            self.engine.load(self.scene, state)
            self._gather()
            self._n_changed += 1
            if self._water is not None and self.scene.column is not None:
                self._water.change(self.scene, self.scene.column)
            self.watch.scene = self.scene
            scene, step, t = self.scene, self._step, self._t
            self._with_room(lambda scene=scene, step=step, t=t: self.recorder.scene(scene, step, t))
            self._rest = Rest(self.stop)
            self.progress.line(f"t = {self._t:.6g} s: {change.what}")

    def _record(self) -> None:
        state, tally = self.engine.grains(), self.engine.tally()
        self.recorder.frame(state, tally, self._water)
        self.watch.frame(tally)
        if fault := energy_created(self.scene, state, tally):
            self.recorder.reached(self._step)  # this frame belongs to the run that failed
            raise fault

    def _fastest(self) -> float:
        """Fastest grain now [m/s]: its centre, or its surface where it spins in place."""
        fastest = self.engine.tally().speed_max
        if fastest >= self.stop.rest_speed or not self.scene.rotation:
            return fastest
        spin = np.linalg.norm(self.engine.grains().omega, axis=1)
        return max(fastest, float((spin * self.scene.d / 2).max(initial=0.0)))

    @property
    def _t(self) -> float:
        return self._t_zero + self._step * self.scene.dt

    def _last_step(self) -> int:
        return (
            _NEVER if math.isinf(self.stop.time) else round((self.stop.time - self._t_zero) / self.scene.dt)
        )

    def _look_every(self) -> int:
        """Steps between two looks at the largest speed; four within the time that counts as rest."""
        return (
            _NEVER
            if math.isinf(self.stop.rest_for)
            else max(1, round(self.stop.rest_for / 4 / self.scene.dt))
        )

    def _done(self, last: int) -> bool:
        if self._heard.by:
            self.status, self.message = schema.STOPPED, f"{self._heard.by} at t = {self._t:.6g} s"
        elif self._step >= last:
            self.status, self.message = schema.COMPLETE, f"reached {self.stop.time:g} s"
        elif self._hopped:
            self.status, self.message = schema.COMPLETE, f"every grain did {self._hops.least} saltations"
        elif self._resting:
            self.status = schema.COMPLETE
            self.message = f"all grains slower than {self.stop.rest_speed:g} m/s for {self.stop.rest_for:g} s"
        return self.status != schema.RUNNING

    def _rate(self) -> float:
        """Particle-steps per second since the kernels were ready, recording included."""
        step, since = self._warm
        return self.scene.n_grain * (self._step - step) / max(time.monotonic() - since, 1e-9)

    def _moment(self) -> Moment:
        tally, hops = self.engine.tally(), None
        share = self._t / self.stop.time
        if self.stop.saltations is not None:
            hops = self._hops.least
            share = max(share, hops / self.stop.saltations)
        return Moment(min(share, 1.0), self._t, self._rate(), tally.overlap_max, tally.residual, hops)

    def _summary(self) -> dict[str, Any]:
        numbers = self.watch.numbers(self.engine.tally())
        if self._water is not None:
            numbers["water"] = self._water.numbers()
            numbers["warnings"] = [*numbers["warnings"], *self._water.warnings()]
        return {
            "t": self._t,
            "steps": self._step,
            "dt": self.scene.dt,
            "frames": self.recorder.n_frame,
            "contacts": self.recorder.n_contact,
            "events": self.scene.events.name.lower(),
            "saltations": None if self.stop.saltations is None else self._hops.count.tolist(),
            "wall": time.monotonic() - self._begun,
            "particle_steps_per_second": self._rate(),
            **numbers,
        }

    def _close(self) -> dict[str, Any]:
        summary = self._summary()
        self._last_words()
        write_json(self.recorder.folder / schema.SUMMARY, summary)
        return summary

    def _last_words(self) -> None:
        closed = {**self.origin, "status": self.status, "message": self.message, "end": provenance.now()}
        write_last_words(self.recorder.folder / schema.PROVENANCE, closed)
