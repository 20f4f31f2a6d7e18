"""The one loop: build, advance, record, watch, stop."""

import math
import os
import sys
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ryusa.engine import registry
from ryusa.engine.protocol import Engine
from ryusa.errors import CaseError, CheckpointError, ResultsError
from ryusa.model import Scene, State
from ryusa.model.scene import EventRule
from ryusa.results import Results, schema
from ryusa.results.scene_file import scene_digest
from ryusa.running import provenance
from ryusa.running.checkpoint import Kept
from ryusa.running.disk import disk, write_whole
from ryusa.running.folder import (
    as_written,
    is_run,
    make_folder,
    prepare,
    refuse_if_not_writable,
    refuse_if_too_big,
    refuse_if_too_large,
    write_json,
)
from ryusa.running.interrupt import listening
from ryusa.running.keeper import EVERY, Keeper, identity_of
from ryusa.running.lock import locked
from ryusa.running.loop import Change, Loop
from ryusa.running.progress import Progress
from ryusa.running.recorder import Left, Recorder, bytes_per_frame
from ryusa.running.resume import Going, look
from ryusa.running.stops import Stop
from ryusa.running.watch import Watch

if TYPE_CHECKING:
    from ryusa.casefile.case import Case

_MOST_STEPS = 2**62
_BEFORE = "before the first step; no run folder was made"


def run(
    case: "Case",
    folder: str | os.PathLike[str] | None = None,
    *,
    threads: int = 1,
    progress: bool = True,
    overwrite: bool = False,
    engine: Engine | str | None = None,
    checkpoint: float = EVERY,
    resume: bool = False,
    force: bool = False,
) -> Results:
    """Run a case and open what it wrote.

    Parameters
    ----------
    case : a checked case, from `ryusa.load`.
    folder : where the run goes; runs/<name of the case> when not given.
    threads : threads of the CPU engine; the numbers do not depend on it.
    progress : show a bar (or lines, where stderr is no terminal).
    overwrite : replace an earlier run in `folder`; anything but a run is never touched.
    engine : the engine that steps the grains, by its name in `ryusa.engine.registry` or as an object; "cpu"
        when not given.
    checkpoint : wall time between two checkpoints [s]; inf for none but those asked for by a signal.
    resume : go on where an earlier run of this case in `folder` stopped; a complete one is opened, and where
        there is none the run begins. With `overwrite` it also begins where it cannot go on.
    force : go on also where the numbers will not be those of a run never stopped: another version or
        processor, another stop rule.

    Returns
    -------
    results : the open run folder; its status says whether the run was stopped (Ctrl-C).

    Raises
    ------
    CaseError, ResultsError : the case cannot be run as it stands, or the folder cannot be used.
    CheckpointError : there is a run to go on with, but not by this process, case or code.
    RunError : a number went wrong while stepping; the frames before it are in the folder.
    KeyboardInterrupt : Ctrl-C before the first step; no run folder was made. Later ones end the run in order.
    """
    with listening() as heard:
        from ryusa.build import build, change
        from ryusa.casefile import derive, resolved
        from ryusa.casefile.estimate import disk_for_events, disk_needed, frames_expected, memory_needed

        derived = derive(case)

        def make() -> _Made:
            built = build(case, derived)
            heard.raise_if_asked(_BEFORE)
            return built.scene, built.state, tuple(str(note) for note in built.notes)

        stop = Stop(
            time=math.inf if case.stop.time is None else case.stop.time,
            rest_speed=case.stop.rest.speed if case.stop.rest else 0.0,
            rest_for=case.stop.rest.duration if case.stop.rest else math.inf,
            saltations=case.stop.saltations,
            settle=case.record.settle,
        )
        changes = [
            Change(entry.at, partial(change, case, entry=entry), words)
            for entry, words in zip(case.timeline, _words(case), strict=True)
        ]
        refuse_if_too_large(memory_needed(case, derived), derived.n_grain)
        about = _About(
            resolved=resolved(case, derived), text=case.text, seed=case.seed, overrides=case.overrides,
            disk=_Disk(frames_expected(case), disk_needed(case, derived), disk_for_events(case, derived)),
            table=_table(case),
        )  # fmt: skip
        return _carry_out(
            make,
            Path(folder if folder is not None else Path("runs") / case.name),
            case.record.frames,
            stop,
            changes,
            _How(threads, progress, overwrite, engine, checkpoint, resume, force),
            about,
        )


def _table(case: "Case") -> Path | None:
    """The table of first grains, where it can lie beside the case in the run folder as it does now."""
    from ryusa.casefile.builders.schema import TableSection

    if not isinstance(case.build, TableSection) or case.path is None:
        return None
    name = case.build.file
    plain = Path(name).name == name and Path(name).suffix not in {".json", ".toml", ".vtkhdf", ".h5", ".txt"}
    return case.path.resolve().parent / name if plain and not name.startswith(".") else None


def _words(case: "Case") -> list[str]:
    """Entries of the timeline as the case says them, with its units, overrides applied; for the log."""
    from ryusa.casefile.overrides import with_overrides

    said = with_overrides(tomllib.loads(case.text), case.overrides).get("timeline", [])
    if len(said) != len(case.timeline):  # a case made in Python has no text
        said = [{key: getattr(entry, key) for key in entry.model_fields_set} for entry in case.timeline]
    return [", ".join(f"{key} {one[key]}" for key in sorted(set(one) - {"at"})) for one in said]


@dataclass(frozen=True)
class _Disk:
    """What a run will write at most, or by guess; the numbers of `ryusa check`."""

    n_frame: float
    for_frames: float  # [B]
    for_events: float = 0.0  # [B]


@dataclass(frozen=True)
class _About:
    """What a case adds to a bare scene."""

    resolved: dict[str, Any]
    text: str | None = None
    seed: int | None = None
    overrides: dict[str, str] | None = None
    disk: "_Disk | None" = None
    table: Path | None = None  # of first grains, which the case names


@dataclass(frozen=True)
class _How:
    """What a user says of a run beside the case."""

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
    threads: int = 1,
    progress: bool = True,
    overwrite: bool = False,
    engine: Engine | str | None = None,
    checkpoint: float = EVERY,
    resume: bool = False,
    force: bool = False,
) -> Results:
    """Run a scene built grain by grain, without a case file.

    Parameters
    ----------
    scene, state : what holds still, and the first moment of what moves.
    folder : where the run goes.
    frames : time between frames [s]; frame k falls on step round(k frames/dt).
    stop : when to stop.
    changes : changes of the scene on the way, in any order.
    threads, progress, overwrite, engine, checkpoint, resume, force : as in `run`; to go on, everything else
        must be given as it was.

    Returns
    -------
    results : the open run folder.

    Raises
    ------
    CaseError, ResultsError, CheckpointError, RunError : as in `run`.
    """
    from ryusa.casefile.estimate import MEMORY_PER_GRAIN, MEMORY_WITH_EVENTS

    each = MEMORY_PER_GRAIN if scene.events == EventRule.NONE else MEMORY_WITH_EVENTS
    refuse_if_too_large((scene.n_grain + scene.n_fixed) * each, scene.n_grain)
    about = _About({"title": "", "record": {"frames": frames, "settle": stop.settle}})
    how = _How(threads, progress, overwrite, engine, checkpoint, resume, force)
    return _carry_out(lambda: (scene, state, ()), Path(folder), frames, stop, changes, how, about)


_Made = tuple[Scene, State, Sequence[str]]  # and notes of the builder, for the log


def _carry_out(
    make: Callable[[], _Made],
    folder: Path,
    frames: float,
    stop: Stop,
    changes: Sequence[Change],
    how: _How,
    about: _About,
) -> Results:
    """Run from the first step, or go on."""
    with listening() as heard:
        engine = _engine(how.engine, how.threads)
        origin = provenance.begin(
            threads=how.threads, seed=about.seed, engine=engine.name,
            overrides=about.overrides or {},
        )  # fmt: skip
        resolved = as_written(about.resolved)
        whose = identity_of(
            origin, resolved, frames=frames, stop=stop, changes=[(one.at, one.what) for one in changes]
        )
        run = _Run(folder, frames, stop, changes, how, engine, origin, resolved, about, whose)
        first: tuple[str, ...] = ("nothing to go on from: the run begins",) if how.resume else ()
        if how.resume and is_run(folder):
            refuse_if_not_writable(folder)
            with locked(folder):
                try:
                    going = look(folder, resolved, whose, origin, force=how.force)
                except CheckpointError as error:
                    if not how.overwrite:
                        raise
                    going, first = None, (f"begins anew: {error}",)
                if going is not None and going.complete:
                    return _said_complete(folder, how)
                if going is not None:
                    return run.go_on(going, make)
        scene, state, notes = make()
        _refuse(scene, frames, stop)
        reasons = engine.refuses(scene)
        if reasons:
            raise CaseError("engine", engine.name, f"cannot carry this case: {'; '.join(reasons)}")
        refuse_if_not_writable(folder)
        n_frame = stop.time / frames + 1
        fits = about.disk or _Disk(n_frame, n_frame * bytes_per_frame(scene.n_grain))
        if math.isfinite(fits.n_frame):
            refuse_if_too_big(
                folder, interval=frames, n_frame=fits.n_frame,
                for_frames=fits.for_frames, for_events=fits.for_events,
            )  # fmt: skip
        heard.raise_if_asked(_BEFORE)
        make_folder(folder, overwrite=how.overwrite or how.resume)
        with locked(folder):
            prepare(folder)
            run.write_case()
            return run.begin(scene, state, (*first, *notes))


def _said_complete(folder: Path, how: _How) -> Results:
    results = Results.open(folder)
    if how.progress:
        print(f"{folder}: is complete already ({results.provenance.get('message')})", file=sys.stderr)
    return results


@dataclass
class _Run:
    """One process that writes a run folder."""

    folder: Path
    frames: float
    stop: Stop
    changes: Sequence[Change]
    how: _How
    engine: Engine
    origin: dict[str, Any]
    resolved: dict[str, Any]
    about: _About
    identity: dict[str, Any]  # of the checkpoints it writes

    def write_case(self) -> None:
        """Write where the run came from, and its case."""
        write_json(self.folder / schema.PROVENANCE, self.origin)
        write_json(self.folder / schema.CASE_JSON, self.resolved)
        if self.about.text is not None:
            _write_text(self.folder / schema.CASE_TOML, self.about.text)
        table = self.about.table
        if table is not None and table.parent != self.folder.resolve():
            with disk(self.folder):
                write_whole(self.folder / table.name, table.read_bytes())

    def begin(self, scene: Scene, state: State, notes: Sequence[str]) -> Results:
        """From the first step."""
        return self._loop(scene, scene, state, Watch(scene, state), notes, None, None)

    def go_on(self, going: Going, make: Callable[[], _Made]) -> Results:
        """From where an earlier process stood."""
        notes = list(going.said)
        if going.state is None or going.now is None or going.kept is None:
            scene, state, _ = make()
            if going.scene is None or scene_digest(scene) != scene_digest(going.scene):
                raise CheckpointError(
                    f"{self.folder}: the case gives another scene now than it did; --overwrite begins anew"
                )
            now, watch, kept = scene, Watch(scene, state), None
        else:
            scene, now, state, kept = going.scene or going.now, going.now, going.state, going.kept
            watch = Watch(scene, State.at_rest(going.x_first if going.x_first is not None else state.x))
            watch.go_on(kept.part("watch"))
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
        notes.insert(0, f"goes on from step {state.step}, t = {state.t:.6g} s")
        return self._loop(scene, now, state, watch, notes, going.left, kept)

    def _loop(
        self,
        first: Scene,
        now: Scene,
        state: State,
        watch: Watch,
        notes: Sequence[str],
        left: Left | None,
        kept: Kept | None,
    ) -> Results:
        said = Progress(self.folder / schema.LOG, shown=self.how.progress)
        try:
            for note in notes:
                said.line(note)
            done = 0 if left is None else len(left.scenes) - 1
            changes = sorted((round(one.at / now.dt), k, one) for k, one in enumerate(self.changes))
            loop = Loop(
                engine=self.engine, scene=now, frames=self.frames, stop=self.stop, changes=changes[done:],
                recorder=Recorder(self.folder, now, left=left), watch=watch, progress=said,
                origin=self.origin, keeper=Keeper(self.folder, self.identity, first, self.how.checkpoint),
            )  # fmt: skip
            loop.run(state, None if kept is None else kept.part("loop"))
        finally:
            said.close()
        return Results.open(self.folder)


def _refuse(scene: Scene, frames: float, stop: Stop) -> None:
    if stop.endless:
        raise CaseError("stop", None, "needs a time, saltations or rest, else the run would never end")
    if not frames >= scene.dt:
        raise CaseError("record.frames", f"{frames:g} s", f"must be at least one step, {scene.dt:g} s")
    if math.isfinite(stop.time) and stop.time / scene.dt > _MOST_STEPS:
        raise CaseError(
            "stop.time", f"{stop.time:g} s", f"is more steps of {scene.dt:g} s than can be counted"
        )
    if stop.saltations is not None and scene.events == EventRule.NONE:
        raise CaseError("record.events", "none", "must be 'all' or 'tracked' when saltations end the run")


def _engine(named: Engine | str | None, threads: int) -> Engine:
    """The engine asked for, by name or as it is."""
    if named is not None and not isinstance(named, str):
        return named
    return registry.create(named or registry.DEFAULT, threads=threads)


def _write_text(path: Path, text: str) -> None:
    try:
        path.write_bytes(text.encode())
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written ({error.strerror or error})") from error
