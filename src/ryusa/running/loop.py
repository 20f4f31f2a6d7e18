"""The time loop: steps until a stop rule is met, an error occurs or a signal stops the run."""

import math
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ryusa.engine.protocol import Engine, Flags
from ryusa.errors import CheckpointError, DiskFull, RyusaError
from ryusa.model import FluidState, Scene, State
from ryusa.results import schema
from ryusa.running import provenance
from ryusa.running.checkpoint import CheckpointBlock
from ryusa.running.checkpoint_scheduler import CheckpointScheduler
from ryusa.running.compiling import compiling_told
from ryusa.running.crossing import of_heads
from ryusa.running.disk import retry_when_full
from ryusa.running.feeds import TrafficRule
from ryusa.running.folder import write_final_json, write_json
from ryusa.running.guards import energy_created
from ryusa.running.interrupt import StopSignal, catch_signals
from ryusa.running.loop_state import LoopState
from ryusa.running.pace import Pace, stepping_time
from ryusa.running.precision import PrecisionRule
from ryusa.running.progress import Progress, ProgressNumbers
from ryusa.running.recorder import Recorder
from ryusa.running.servo import ServoRule, with_servos
from ryusa.running.snapshot import engine_block
from ryusa.running.stops import RestDetector, SaltationCounter, Stop
from ryusa.running.summary import summary_lines
from ryusa.running.timeline import Change, in_order
from ryusa.running.watch import Watch
from ryusa.running.water import advanced, changed, finish_before, snapshot, started
from ryusa.water.protocol import Fluid

Done = TypeVar("Done")
_NEVER = 2**62  # steps
_DELIVER_EVERY = 65_536  # steps after which contacts go to the recorder if nothing else is due earlier


@dataclass
class Loop:
    """The time loop of a run. Recording and stopping depend on steps alone, never on the clock."""

    engine: Engine
    scene: Scene
    frames: float  # time between frames [s]
    stop: Stop
    changes: list[tuple[int, int, Change]]  # (step, order, change), sorted; consumed from the front
    recorder: Recorder
    watch: Watch
    progress: Progress
    origin: dict[str, Any]  # provenance of the run
    precision: PrecisionRule
    checkpoints: CheckpointScheduler | None = None  # writes checkpoints
    traffic: TrafficRule | None = None  # feeds and exits
    servo: ServoRule | None = None  # walls pressed on the grains
    threads: int = 1  # share the exchange with a row of columns
    status: str = schema.RUNNING
    message: str = ""
    _step: int = 0
    _t_zero: float = 0.0
    _first: int = 0  # step of frame 0
    _frame: int = 1  # number of the next one
    _n_changed: int = 0  # entries of the timeline done
    _signal: StopSignal = field(default_factory=StopSignal)
    _at_rest: bool = False  # for as long as the stop rule requires
    _saltations_done: bool = False  # every tracked grain has made the required number
    _gathered: list[NDArray[np.void]] = field(default_factory=list[NDArray[np.void]])
    _water: Fluid | None = None
    _pace: Pace = field(default_factory=Pace)
    _begun: float = field(default_factory=time.monotonic)
    _loaded: bool = False  # the engine has a state

    def run(self, state: State, block: CheckpointBlock | None = None) -> None:
        """Run to the end; the run folder is complete and readable when this returns or raises.

        Parameters
        ----------
        state : initial state, or that of a checkpoint; then `scene` is the one that was valid there.
        block : state of the loop, its part of a checkpoint.
        """
        try:
            with catch_signals() as self._signal, compiling_told(self.progress, self.scene):
                self._run(state, block)
                self._retry_when_full(self.recorder.flush)
                self._write_checkpoint()  # a complete run keeps it too: it can be lengthened
                if self.status == schema.STOPPED:
                    self._write_tail()
        except BaseException as error:
            self.status, self.message = schema.FAILED, str(error) or type(error).__name__
            if isinstance(error, KeyboardInterrupt):
                self.status = schema.INTERRUPTED
            elif isinstance(error, DiskFull) and self._signal.stop:
                self.status, self.message = schema.STOPPED, f"{self._signal.stop} while the disk was full"
            # an error of ryusa is reported by the caller that catches it
            self.progress.line(f"{self.status}: {self.message}", shown=not isinstance(error, RyusaError))
            for action in self._final_actions():
                with suppress(RyusaError, OSError):
                    action()
            raise
        self.progress.line(f"{self.status}: {self.message}")
        for line in summary_lines(self._retry_when_full(self._close), self.scene.flow):
            self.progress.line(line)
        if self.checkpoints is not None and self.status == schema.COMPLETE:
            self.checkpoints.remove_earlier()

    def _final_actions(self) -> tuple[Callable[[], Any], ...]:
        """Final writes of a run that ends early; only the provenance if the engine took no state."""
        # that the run failed is written before its summary, which may meet the fault again
        whole = self.recorder.flush, self._write_tail, self._write_provenance, self._close
        return whole if self._loaded else (self._write_provenance,)

    def _run(self, state: State, block: CheckpointBlock | None) -> None:
        if block is None:
            self._begin(state)
        else:
            self._continue_from(state, block)
        last, check_steps = self._last_step(), self._rest.check_steps(self.scene.dt) or _NEVER
        while not self._done(last):
            next_frame = self._first + round(self._frame * self.frames / self.scene.dt)
            next_change = self.changes[0][0] if self.changes else _NEVER
            next_check = (self._step // check_steps + 1) * check_steps
            next_pass = _NEVER if self.traffic is None else self.traffic.next_step(self._step, next_change)
            next_press = _NEVER if self.servo is None else self.servo.next_step(self.scene, self._step)
            due = min(next_frame, next_change, next_check, next_pass, next_press, last)
            if not self._advance_to(min(due, (self._step // _DELIVER_EVERY + 1) * _DELIVER_EVERY)):
                continue
            if self.traffic is not None and self._step == next_pass:
                self._pass_grains(self.traffic)
            self._deliver_contacts()
            if self.servo is not None and self._step == next_press:
                self.servo.correct(self.scene, self.engine, self._step, self._t)
            if self._step == next_frame:
                self._record()
                self._frame += 1
            if self._step == due:
                self._saltations_done = self._saltations.reached()
            fed = self.traffic is None or self.traffic.finished
            if self._step == next_check and fed and not self.changes:
                fastest = self._rest.fastest(self.engine, self.scene)
                self._at_rest = self._rest.reached(self._t, fastest)
            self._change_if_due()
            self._end_stretch()
            if self._step == next_frame and self.precision.due(self._frame - 1, self._t_first):
                self._measure_precision()

    def _begin(self, state: State) -> None:
        self._step, self._t_zero = state.step, state.t - state.step * self.scene.dt
        self._first = state.step
        self._rest, self._saltations = RestDetector(self.stop), SaltationCounter(self.scene, self.stop)
        if self.traffic is not None:
            begun = self.traffic.begin(self.scene, state)
            state = begun.state
            self.recorder.passages(begun.rows)
        self._load(state)
        self._record()
        self._change_if_due()
        self.recorder.reached(self._step)
        self._retry_when_full(self.recorder.flush)

    def _continue_from(self, state: State, block: CheckpointBlock) -> None:
        """Continue at the step of a checkpoint, which may be any step."""
        self._step = state.step
        self._rest = RestDetector(self.stop)
        self._saltations = SaltationCounter(self.recorder.first_scene, self.stop)
        saved = LoopState.from_block(block, self.scene)
        self._pace.begin(saved.compiled)
        self._t_zero, self._first, self._frame = saved.t_zero, saved.first, saved.frame
        self._rest.since = saved.since
        self._saltations.parted[:], self._saltations.count[:] = saved.parted, saved.hops
        # a rule that was met may have been removed, or asks for more now
        self._at_rest = saved.resting and math.isfinite(self.stop.rest_for)
        self._saltations_done = saved.hopped and self._saltations.reached()
        self._gathered = [saved.gathered] if len(saved.gathered) else []
        self._begun -= saved.wall
        self._n_changed = saved.changed
        try:
            self._load(state)
            if self.precision.asked:
                self._retry_when_full(self.recorder.flush)
                self.precision.restore(self._frame - 1, self._t_first)
            self.progress.start_at(self._progress_numbers().share)
        except (ValueError, ArithmeticError, AssertionError) as error:
            raise CheckpointError(f"the state in the checkpoint cannot be used ({error})") from error

    def _load(self, state: State) -> None:
        self.engine.load(with_servos(self.scene, self.servo), state)
        self._loaded = True
        self._start_water(state)

    def _loop_state(self) -> LoopState:
        self._collect_contacts()
        return LoopState(
            t_zero=self._t_zero, first=self._first, frame=self._frame, changed=self._n_changed,
            resting=self._at_rest, hopped=self._saltations_done, since=self._rest.since,
            wall=time.monotonic() - self._begun, parted=self._saltations.parted, hops=self._saltations.count,
            gathered=in_order(self._gathered), compiled=self._pace.compiled,
        )  # fmt: skip

    def _end_stretch(self) -> None:
        """Complete a stretch: all up to this step is done and recorded."""
        self.recorder.reached(self._step)
        self._retry_when_full(lambda: self.recorder.flush_if_due(self._summary))
        self._checkpoint_if_due()

    def _advance_to(self, target: int) -> bool:
        """Advance to a step in calls of bounded wall time; False if a signal stopped it on the way."""
        while self._step < target and not self._signal.stop:
            self._advance(min(target - self._step, self._chunk()))
            if self.progress.due():
                self.progress.update(self._progress_numbers())
            if self._step < target:
                self._checkpoint_if_due()
        return self._step == target

    def _checkpoint_if_due(self) -> None:
        if self.checkpoints is not None and (self._signal.checkpoint or self.checkpoints.due()):
            requested, self._signal.checkpoint = self._signal.checkpoint, False
            self._write_checkpoint(requested=requested)

    def _write_checkpoint(self, *, requested: bool = False) -> None:
        """Write a checkpoint at this step; if that fails, report it and keep the last one."""
        if self.checkpoints is None or self._step == self._first:
            return
        self.recorder.flush_if_large()
        parts = {
            "loop": self._loop_state().to_block(),
            "watch": self.watch.to_block(),
            "recorder": self.recorder.to_block(),
        }
        rules = {"traffic": self.traffic, "servo": self.servo}
        parts |= {name: rule.to_block() for name, rule in rules.items() if rule is not None}
        try:
            self.checkpoints.write(engine_block(self.engine, self._water_now()), self.scene, parts)
        except RyusaError as error:
            self.progress.line(f"no checkpoint written: {error}")
            return
        if self.status == schema.STOPPED:
            self.progress.line(
                f"checkpoint written at step {self._step}; continue with: ryusa resume {self.recorder.folder}"
            )
        elif requested:
            self.progress.line(f"checkpoint written at step {self._step}, t = {self._t:.6g} s, on request")

    def _collect_contacts(self) -> None:
        if len(events := self.engine.events()):
            self._gathered.append(events)

    def _deliver_contacts(self) -> None:
        self._collect_contacts()
        events, self._gathered = in_order(self._gathered), []
        self.recorder.contacts(events)
        self.watch.contacts(events)
        if self.stop.saltations is not None:
            self._saltations.contacts(events)

    def _write_tail(self) -> None:
        """Write contacts of the unfinished stretch, so that a reader of the stopped run finds them."""
        self._collect_contacts()
        self.recorder.tail(in_order(self._gathered))

    def _retry_when_full(self, action: Callable[[], Done]) -> Done:
        return retry_when_full(action, self._signal, self.progress.line)

    def _advance(self, n_steps: int) -> None:
        begun = stepping_time()
        flags = self._steps(n_steps)
        if flags:
            self._step = self.engine.grains().step
            flags.raise_if_any()
        n_grain = self.scene.n_grain if self.traffic is None else self.traffic.n_present
        self._pace.took(n_steps, n_grain, begun)

    def _steps(self, n_steps: int) -> Flags:
        """Step the engine, and the water that its grains feel."""
        self._step, flags = advanced(self.engine, self._water, self._step, n_steps)
        return flags

    def _start_water(self, state: State) -> None:
        self._water = started(self.scene, self.engine, state, self._step, self.threads)

    def state(self) -> State:
        """Snapshot of grains and water, sufficient for an exact resume."""
        state, water = self.engine.state(), self._water_now()
        return state if water is None else replace(state, coupling=water)

    def _water_now(self) -> FluidState | None:
        return None if self._water is None else snapshot(self.engine, self._water)

    def _chunk(self) -> int:
        return self._pace.steps

    def _pass_grains(self, traffic: TrafficRule) -> None:
        """Let grains leave and enter, and go on with those that are there."""
        scene, water = with_servos(self.scene, self.servo), self._water
        passed = traffic.at_instant(scene, self.engine, self._step, self._t, water)
        if passed is not None:
            self._collect_contacts()
            self._gathered.append(passed.events)
            self.engine.load(scene, passed.state)
            if passed.water is not None:
                self._water = passed.water
                self.engine.set_fluid(passed.water.sampled)
            self.recorder.passages(passed.rows)
        if self._water is not None:
            x = of_heads(self.scene, self.engine.grains())[0][self.scene.heads]
            self._water.refuse_lost(x, np.flatnonzero(self.scene.heads), self._step, self._t)
        for line in traffic.news(self._step, self._t):
            self.progress.line(line)

    def _change_if_due(self) -> None:
        while self.changes and self.changes[0][0] <= self._step:
            _, _, change = self.changes.pop(0)
            after = change.apply(self.scene)
            if self._water is not None:
                finish_before(self.engine, self._water, self._step, after)
            state, self.scene = self.engine.state(), after
            self.engine.load(with_servos(self.scene, self.servo), state)
            self._collect_contacts()
            self._n_changed += 1
            if self._water is not None:
                changed(self.engine, self._water, self.scene)
            self.watch.scene = self.scene
            scene, step, t = self.scene, self._step, self._t
            self._retry_when_full(lambda scene=scene, step=step, t=t: self.recorder.scene(scene, step, t))
            self._rest = RestDetector(self.stop)
            self.progress.line(f"t = {self._t:.6g} s: {change.what}")

    def _record(self) -> None:
        state, tally = self.engine.state() if self.scene.forces else self.engine.grains(), self.engine.tally()
        travel = self.servo and self.servo.travel_at(self._t)
        self.recorder.frame(state, tally, self._water, travel, with_servos(self.scene, self.servo))
        self.watch.frame(tally)
        if fault := energy_created(self.scene, state, tally, self.watch.rest):
            self.recorder.reached(self._step)  # the frame of the failure is recorded
            raise fault

    def _measure_precision(self) -> None:
        self._retry_when_full(self.recorder.flush)
        self.precision.measure(self._frame - 1)
        self.progress.line(f"t = {self._t:.6g} s: {self.precision}", shown=False)

    @property
    def _t(self) -> float:
        return self._t_zero + self._step * self.scene.dt

    @property
    def _t_first(self) -> float:
        return self._t_zero + self._first * self.scene.dt

    def _last_step(self) -> int:
        end = self.stop.time
        return _NEVER if math.isinf(end) else round((end - self._t_zero) / self.scene.dt)

    def _done(self, last: int) -> bool:
        if self._signal.stop:
            self.status, self.message = schema.STOPPED, f"{self._signal.stop} at t = {self._t:.6g} s"
        elif self.precision.met:
            self.status, self.message = schema.COMPLETE, f"known well enough: {self.precision}"
        elif self._step >= last:
            if self.precision.asked:
                self._measure_precision()
            self.status = schema.COMPLETE
            self.message = f"reached {self.stop.time:g} s{self.precision.missed()}"
        elif self._saltations_done:
            self.status = schema.COMPLETE
            self.message = f"every tracked grain made {self._saltations.least} saltations"
        elif self._at_rest:
            slow = f"{self.stop.rest_speed:g} m/s (centre and surface) for {self.stop.rest_for:g} s"
            self.status, self.message = schema.COMPLETE, f"all grains slower than {slow}"
        return self.status != schema.RUNNING

    def _progress_numbers(self) -> ProgressNumbers:
        tally, hops = self.engine.tally(), None
        share = self._t / self.stop.time
        if self.stop.saltations is not None:
            hops = self._saltations.least
            share = max(share, hops / self.stop.saltations)
        share, rate = min(max(share, self.precision.share(self._t)), 1.0), self._pace.rate
        known = str(self.precision) if self.precision.asked else ""
        water = "" if self._water is None or self.scene.n_grain else self._water.text
        return ProgressNumbers(share, self._t, rate, tally.overlap_max, tally.residual, hops, known, water)

    def _summary(self) -> dict[str, Any]:
        numbers = self.watch.summary(self.engine.tally())
        if self._water is not None:
            numbers["water"] = self._water.numbers()
            numbers["warnings"] = [*numbers["warnings"], *self._water.warnings()]
        if self.traffic is not None:
            self.traffic.enter(numbers, self._step, self._t)
        return {
            "t": self._t,
            "steps": self._step,
            "dt": self.scene.dt,
            "frames": self.recorder.n_frame,
            "contacts": self.recorder.n_contact,
            "events": self.scene.events.name.lower(),
            "saltations": None if self.stop.saltations is None else self._saltations.count.tolist(),
            "wall": time.monotonic() - self._begun,
            "compiled": self._pace.compiled,
            "particle_steps_per_second": self._pace.rate,
            **numbers,
            **({"precision": self.precision.summary()} if self.precision.asked else {}),
        }

    def _close(self) -> dict[str, Any]:
        summary = self._summary()
        self._write_provenance()
        write_json(self.recorder.folder / schema.SUMMARY, summary)
        return summary

    def _write_provenance(self) -> None:
        closed = {**self.origin, "status": self.status, "message": self.message, "end": provenance.now()}
        write_final_json(self.recorder.folder / schema.PROVENANCE, closed)
