"""`run` and `run_scene`: build a scene, or find where a run was stopped, and step it into a run folder."""

import math
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ryusa.engine import registry
from ryusa.engine.pool import stepping
from ryusa.engine.protocol import Engine
from ryusa.errors import CaseError, CheckpointError, ResultsError
from ryusa.model import Scene, State
from ryusa.results import Results, schema
from ryusa.results.scene_file import scene_digest
from ryusa.running import provenance
from ryusa.running.case_files import files_beside, made_files, origin_of_reach, stop_rule, timeline_texts
from ryusa.running.checkpoint import CheckpointBlock
from ryusa.running.checkpoint_scheduler import CHECKPOINT_INTERVAL, CheckpointScheduler, run_identity
from ryusa.running.disk import disk_errors, write_atomically
from ryusa.running.feeds import TrafficRule
from ryusa.running.folder import (
    as_read_back,
    is_run,
    make_folder,
    prepare,
    refuse_if_not_writable,
    refuse_if_too_big,
    refuse_if_too_large,
    write_json,
)
from ryusa.running.interrupt import catch_signals
from ryusa.running.lock import locked
from ryusa.running.loop import Loop
from ryusa.running.pace import other_engines
from ryusa.running.precision import PrecisionRule
from ryusa.running.progress import Progress
from ryusa.running.record_buffer import bytes_per_frame
from ryusa.running.recorder import RecordedSoFar, Recorder
from ryusa.running.resume import ResumePoint, find_resume_point
from ryusa.running.servo import ServoRule
from ryusa.running.stops import Stop, refuse_stop
from ryusa.running.timeline import Change, refuse_changes
from ryusa.running.watch import Watch

if TYPE_CHECKING:
    from ryusa.casefile.case import Case

_BEFORE = "before the first step; no run folder was created"


def run(
    case: "Case | str | os.PathLike[str]",
    folder: str | os.PathLike[str] | None = None,
    *,
    threads: int = 1,
    progress: bool = True,
    overwrite: bool = False,
    engine: Engine | str | None = None,
    checkpoint: float = CHECKPOINT_INTERVAL,
    resume: bool = False,
    force: bool = False,
) -> Results:
    """Run a case and open its run folder.

    Parameters
    ----------
    case : a checked case, from `ryusa.load`, or the path of a case file.
    folder : the run folder; runs/<name of the case> when not given.
    threads : threads of the CPU engine; the results do not depend on it.
    progress : show a bar, or lines if stderr is not a terminal.
    overwrite : replace an earlier run in `folder`; a folder that is not a run is never changed.
    engine : its name in `ryusa.engine.registry`, or an object; "cpu" when not given.
    checkpoint : wall time between two checkpoints [s]; inf writes only those that a signal requests.
    resume : continue an earlier run of this case in `folder`; a complete one is opened, and without one the
        run starts. With `overwrite` the run also starts anew if the earlier one cannot be continued.
    force : continue also if the version, the processor or the stop rule differs; the results are then valid,
        but not bitwise those of an uninterrupted run.

    Returns
    -------
    results : the open run folder; its status says whether the run was stopped (Ctrl-C).

    Raises
    ------
    CaseError, ResultsError : the case cannot be run as it stands, or the folder cannot be used.
    CheckpointError : the earlier run cannot be continued with this case, version or processor.
    RunError : an invalid state occurred while stepping; the frames before it are in the folder.
    KeyboardInterrupt : Ctrl-C before the first step, without a run folder; later ones end the run in order.
    """
    with catch_signals() as signal:
        if isinstance(case, str | os.PathLike):
            from ryusa.casefile.read import read

            case = read(Path(case))
        from ryusa.build import build, change
        from ryusa.casefile import derive, resolved
        from ryusa.casefile.estimate import disk_for_events, disk_needed, frames_expected, memory_needed
        from ryusa.casefile.wall_time import keep_wall_time, wall_time

        registry.refuse_threads(threads)  # whose number divides the time
        derived = derive(case)
        took = wall_time(case, derived, threads=threads, engine=_name(engine))

        def make() -> _Made:
            built = build(case, derived)
            signal.raise_if_stopped(_BEFORE)
            said = other_engines(engine, built.scene.n_grain, took, threads)
            return built.scene, built.state, (*(str(note) for note in built.notes), *said)

        changes = [
            Change(entry.at, partial(change, case, entry=entry), words)
            for entry, words in zip(case.timeline, timeline_texts(case), strict=True)
        ]
        refuse_if_too_large(memory_needed(case, derived), derived.n_grain)
        about = _CaseData(
            resolved=resolved(case, derived), text=case.text, seed=case.seed, overrides=case.overrides,
            disk=_Disk(frames_expected(case), disk_needed(case, derived), disk_for_events(case, derived)),
            files=files_beside(case), made=made_files(case), stepping=took.stepping,
            keep_time=partial(keep_wall_time, case, derived, threads=threads, engine=_name(engine)),
        )  # fmt: skip
        return _run_or_resume(
            make,
            Path(folder if folder is not None else Path("runs") / case.name),
            case.record.frames,
            stop_rule(case.stop, case.record),
            changes,
            _Options(threads, progress, overwrite, engine, checkpoint, resume, force),
            about,
        )


@dataclass(frozen=True)
class _Disk:
    """Expected size of a run, as `ryusa check` prints it."""

    n_frame: float
    for_frames: float  # [B]
    for_events: float = 0.0  # [B]


@dataclass(frozen=True)
class _CaseData:
    """Data of a case beyond its scene."""

    resolved: dict[str, Any]
    text: str | None = None
    seed: int | None = None
    overrides: dict[str, str] | None = None
    disk: _Disk | None = None
    files: Mapping[str, Path] = field(default_factory=dict[str, Path])  # copied beside the case, by name
    made: Mapping[str, bytes] = field(default_factory=dict[str, bytes])  # taken from other runs, by name
    stepping: float = math.nan  # wall time that its steps are expected to take [s]
    keep_time: Callable[[int, float, float], None] | None = None  # told steps, their seconds [s], grains


@dataclass(frozen=True)
class _Options:
    """Options of a run beyond the case."""

    threads: int
    progress: bool
    overwrite: bool
    engine: Engine | str | None
    checkpoint: float
    resume: bool
    force: bool


def run_scene(
    scene: Scene,
    state: State,
    folder: str | os.PathLike[str],
    *,
    frames: float,
    stop: Stop,
    changes: Sequence[Change] = (),
    forces: bool = False,
    threads: int = 1,
    progress: bool = True,
    overwrite: bool = False,
    engine: Engine | str | None = None,
    checkpoint: float = CHECKPOINT_INTERVAL,
    resume: bool = False,
    force: bool = False,
) -> Results:
    """Run a scene built grain by grain, without a case file.

    Parameters
    ----------
    scene, state, folder, stop : the scene, the initial state, the run folder, and when to stop.
    frames : time between frames [s]; frame k falls on step round(k frames/dt).
    changes : changes of the scene during the run, in any order.
    forces : record contact forces with every frame, as record.forces of a case does.
    threads, progress, overwrite, engine, checkpoint, resume, force : as in `run`; a resume needs all of
        the others as they were.

    Returns
    -------
    results : the open run folder.

    Raises
    ------
    CaseError, ResultsError, CheckpointError, RunError : as in `run`.
    """
    from ryusa.casefile.estimate import SETTLED, memory_of_grains

    needed = memory_of_grains(scene.n_grain, scene.n_fixed, SETTLED, scene.contact.timing, scene.coupled)
    refuse_if_too_large(needed, scene.n_grain)
    scene = replace(scene, forces=forces or scene.forces)
    record = {"frames": frames, "settle": stop.settle, **({"forces": True} if scene.forces else {})}
    about = _CaseData({"title": "", "record": record})
    options = _Options(threads, progress, overwrite, engine, checkpoint, resume, force)
    return _run_or_resume(lambda: (scene, state, ()), Path(folder), frames, stop, changes, options, about)


_Made = tuple[Scene, State, Sequence[str]]  # and notes of the builder, for the log


def _run_or_resume(
    make: Callable[[], _Made],
    folder: Path,
    frames: float,
    stop: Stop,
    changes: Sequence[Change],
    options: _Options,
    about: _CaseData,
) -> Results:
    """Run from the first step, or resume."""
    with catch_signals() as signal:
        engine = _engine(options.engine, options.threads)
        origin = provenance.begin(
            threads=options.threads, seed=about.seed, engine=engine.name, overrides=about.overrides or {}
        ) | origin_of_reach(about.made)  # fmt: skip
        resolved = as_read_back(about.resolved)
        identity = run_identity(
            origin, resolved, frames=frames, stop=stop, changes=[(one.at, one.what) for one in changes]
        )
        run = _Run(folder, frames, stop, changes, options, engine, origin, resolved, about, identity)
        first: tuple[str, ...] = ("no run to resume: starts from the beginning",) if options.resume else ()
        if options.resume and is_run(folder):
            refuse_if_not_writable(folder)
            with locked(folder):
                try:
                    going = find_resume_point(
                        folder, resolved, identity, origin, force=options.force,
                        exact=registry.known(engine.name).exact_resume,
                    )  # fmt: skip
                except CheckpointError as error:
                    if not options.overwrite:
                        raise
                    going, first = None, (f"starts from the beginning: {error}",)
                if going is not None and going.complete:
                    return _already_complete(folder, options)
                if going is not None:
                    return run.resume_from(going, make)
        scene, state, notes = make()
        refuse_stop(stop, scene, frames)
        reasons = stepping(engine, scene).refuses(scene)
        if reasons:
            raise CaseError("engine", engine.name, f"does not support this case: {'; '.join(reasons)}")
        refuse_changes(engine, scene, changes)
        refuse_if_not_writable(folder)
        n_frame = stop.time / frames + 1
        fits = about.disk or _Disk(n_frame, n_frame * bytes_per_frame(scene.n_grain))
        if math.isfinite(fits.n_frame):
            refuse_if_too_big(
                folder, interval=frames, n_frame=fits.n_frame,
                for_frames=fits.for_frames, for_events=fits.for_events,
            )  # fmt: skip
        signal.raise_if_stopped(_BEFORE)
        make_folder(folder, overwrite=options.overwrite or options.resume)
        with locked(folder):
            prepare(folder)
            run.write_case()
            return run.begin(scene, state, (*first, *notes, *registry.known(engine.name).remarks))


def _already_complete(folder: Path, options: _Options) -> Results:
    results = Results.open(folder)
    if options.progress:
        print(f"{folder}: the run is already complete ({results.provenance.get('message')})", file=sys.stderr)
    return results


@dataclass
class _Run:
    """One process that writes a run folder."""

    folder: Path
    frames: float
    stop: Stop
    changes: Sequence[Change]
    options: _Options
    engine: Engine
    origin: dict[str, Any]
    resolved: dict[str, Any]
    about: _CaseData
    identity: dict[str, Any]  # of the checkpoints it writes

    def write_case(self) -> None:
        """Write the provenance of the run, and its case."""
        write_json(self.folder / schema.PROVENANCE, self.origin)
        write_json(self.folder / schema.CASE_JSON, self.resolved)
        if self.about.text is not None:
            _write_text(self.folder / schema.CASE_TOML, self.about.text)
        for name, path in self.about.files.items():
            copy = self.folder / name
            if path != copy.resolve():
                with disk_errors(self.folder):
                    copy.parent.mkdir(parents=True, exist_ok=True)
                    write_atomically(copy, path.read_bytes())
        for name, content in self.about.made.items():
            with disk_errors(self.folder):
                write_atomically(self.folder / name, content)

    def begin(self, scene: Scene, state: State, notes: Sequence[str]) -> Results:
        """Run from the first step."""
        done = self._loop(scene, scene, state, Watch(scene, state), notes, None, None)
        made = done.summary
        if done.complete and self.about.keep_time is not None and made["steps"] > state.step:
            steps, took = made["steps"] - state.step, made["wall"] - made["compiled"]
            self.about.keep_time(steps, took, made["particle_steps_per_second"] * took / steps)
        return done

    def resume_from(self, going: ResumePoint, make: Callable[[], _Made]) -> Results:
        """Continue from the state of an earlier process."""
        notes = list(going.notes)
        if going.state is None or going.now is None or going.checkpoint is None:
            scene, state, _ = make()
            if going.scene is None or scene_digest(scene) != scene_digest(going.scene):
                raise CheckpointError(
                    f"{self.folder}: the case now gives another scene than before; to discard it and start "
                    "again, use --overwrite"
                )
            now, watch, block = scene, Watch(scene, state), None
        else:
            scene, now, state, block = going.scene or going.now, going.now, going.state, going.checkpoint
            watch = Watch(scene, State.at_rest(going.x_first if going.x_first is not None else state.x))
            watch.restore(block.block("watch"))
            watch.scene = now
        resumed = {name: self.origin[name] for name in ("begin", "ryusa", "commit", "threads", "command")}
        resumed |= {"step": state.step, "t": state.t, "said": list(notes)}
        earlier = going.origin.get("resumed")
        earlier = earlier if isinstance(earlier, list) else []
        self.origin = {
            **going.origin, "overrides": self.origin["overrides"], "status": schema.RUNNING, "message": "",
            "end": None, "resumed": [*earlier, resumed],
        }  # fmt: skip
        self.write_case()
        notes.insert(0, f"resumed at step {state.step}, t = {state.t:.6g} s")
        return self._loop(scene, now, state, watch, notes, going.recorded, block)

    def _loop(
        self,
        first: Scene,
        now: Scene,
        state: State,
        watch: Watch,
        notes: Sequence[str],
        recorded: RecordedSoFar | None,
        block: CheckpointBlock | None,
    ) -> Results:
        reporter = Progress(
            self.folder / schema.LOG, shown=self.options.progress, expected=self.about.stepping
        )
        try:
            for note in notes:
                reporter.line(note)
            done = 0 if recorded is None else len(recorded.scenes) - 1
            traffic = TrafficRule.of(now)
            if traffic is not None and block is not None:
                traffic.restore(block.block("traffic"), state)
            servo = ServoRule.of(now, state.t)
            if servo is not None and block is not None:
                servo.restore(block.block("servo"))
            changes = sorted((round(one.at / now.dt), k, one) for k, one in enumerate(self.changes))
            loop = Loop(
                engine=stepping(self.engine, now), scene=now, frames=self.frames, stop=self.stop,
                changes=changes[done:],
                recorder=Recorder(self.folder, now, earlier=recorded), watch=watch, progress=reporter,
                origin=self.origin,
                precision=PrecisionRule(
                    self.folder, self.stop.precision,
                    max([self.stop.settle, *(one.at for one in self.changes)]), self.frames,
                ),
                checkpoints=CheckpointScheduler(self.folder, self.identity, first, self.options.checkpoint),
                traffic=traffic, servo=servo, threads=self.options.threads,
            )  # fmt: skip
            loop.run(state, None if block is None else block.block("loop"))
        finally:
            reporter.close()
        return Results.open(self.folder)


def _name(named: Engine | str | None) -> str:
    return named if isinstance(named, str) else registry.DEFAULT if named is None else named.name


def _engine(named: Engine | str | None, threads: int) -> Engine:
    """The engine asked for, by name or as it is."""
    if isinstance(named, str | None):
        return registry.create(named or registry.DEFAULT, threads=threads)
    return named


def _write_text(path: Path, text: str) -> None:
    try:
        path.write_bytes(text.encode())
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written ({error.strerror or error})") from error
