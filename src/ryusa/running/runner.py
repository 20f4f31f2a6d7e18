"""The one loop: build, advance, record, watch, stop."""

import math
import os
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ryusa.engine.seam import Engine
from ryusa.errors import CaseError, ResultsError
from ryusa.model import Scene, State
from ryusa.model.enums import EventRule
from ryusa.results import Results, schema
from ryusa.running import provenance
from ryusa.running.folder import prepare, refuse_if_not_writable, refuse_if_too_big, write_json
from ryusa.running.interrupt import listening
from ryusa.running.loop import Change, Loop
from ryusa.running.progress import Progress
from ryusa.running.recorder import Recorder, bytes_per_frame
from ryusa.running.stops import Stop
from ryusa.running.watch import Watch

if TYPE_CHECKING:
    from ryusa.casefile.schema import Case
    from ryusa.casefile.schema import Change as Entry

_MOST_STEPS = 2**62
_BEFORE = "before the first step; no run folder was made"


def run(
    case: "Case",
    folder: str | os.PathLike[str] | None = None,
    *,
    threads: int = 1,
    progress: bool = True,
    overwrite: bool = False,
    engine: Engine | None = None,
) -> Results:
    """Run a case and open what it wrote.

    Parameters
    ----------
    case : a checked case, from `ryusa.load`.
    folder : where the run goes; runs/<name of the case> when not given.
    threads : threads of the CPU engine; the numbers do not depend on it.
    progress : show a bar (or lines, where stderr is no terminal).
    overwrite : replace an earlier run in `folder`; anything but a run is never touched.
    engine : steps the grains; the CPU engine when not given.

    Returns
    -------
    results : the open run folder; its status says whether the run was interrupted (Ctrl-C).

    Raises
    ------
    CaseError, ResultsError : the case cannot be run as it stands, or the folder cannot be used.
    RunError : a number went wrong while stepping; the frames before it are in the folder.
    KeyboardInterrupt : Ctrl-C before the first step; no run folder was made. Later ones end the run in order.
    """
    with listening() as heard:
        from ryusa.build import build, change
        from ryusa.casefile.estimate import disk_for_events, disk_needed, frames_expected

        built = build(case)
        heard.raise_if_asked(_BEFORE)
        stop = Stop(
            time=math.inf if case.stop.time is None else case.stop.time,
            rest_speed=case.stop.rest.speed if case.stop.rest else 0.0,
            rest_for=case.stop.rest.duration if case.stop.rest else math.inf,
            saltations=case.stop.saltations,
            settle=case.record.settle,
        )
        changes = [
            Change(entry.at, partial(_changed, change, case, entry), words)
            for entry, words in zip(case.timeline, _words(case), strict=True)
        ]
        return run_scene(
            built.scene,
            built.state,
            folder if folder is not None else Path("runs") / case.name,
            frames=case.record.frames,
            stop=stop,
            changes=changes,
            threads=threads,
            progress=progress,
            overwrite=overwrite,
            engine=engine,
            about=_About(
                resolved=case.resolved(), text=case.text, seed=case.seed, overrides=case.overrides,
                disk=_Disk(frames_expected(case), disk_needed(case), disk_for_events(case)),
                notes=tuple(built.notes),
            ),
        )  # fmt: skip


def _changed(
    change: "Callable[[Case, Scene, Entry], Scene]", case: "Case", entry: "Entry", scene: Scene
) -> Scene:
    return change(case, scene, entry)


def _words(case: "Case") -> list[str]:
    """Entries of the timeline as the case says them, with its units, overrides applied; for the log."""
    from ryusa.casefile.read import with_overrides

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
    notes: Sequence[str] = ()  # of the builder, for the log


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
    engine: Engine | None = None,
    about: _About | None = None,
) -> Results:
    """Run a scene built grain by grain, without a case file.

    Parameters
    ----------
    scene, state : what holds still, and the first moment of what moves.
    folder : where the run goes.
    frames : time between frames [s]; frame k falls on step round(k frames/dt).
    stop : when to stop.
    changes : changes of the scene on the way, in any order.
    threads, progress, overwrite, engine : as in `run`.
    about : left to `run`.

    Returns
    -------
    results : the open run folder.

    Raises
    ------
    CaseError, ResultsError, RunError : as in `run`.
    """
    folder = Path(folder)
    about = about or _About({"title": "", "record": {"frames": frames, "settle": stop.settle}})
    _refuse(scene, frames, stop)
    with listening() as heard:
        engine = engine if engine is not None else _cpu_engine(threads)
        reasons = engine.refuses(scene)
        if reasons:
            raise CaseError("engine", type(engine).__name__, f"cannot carry this case: {'; '.join(reasons)}")
        refuse_if_not_writable(folder)
        n_frame = stop.time / frames + 1
        disk = about.disk or _Disk(n_frame, n_frame * bytes_per_frame(scene.n_grain))
        if math.isfinite(disk.n_frame):
            refuse_if_too_big(
                folder, interval=frames, n_frame=disk.n_frame,
                for_frames=disk.for_frames, for_events=disk.for_events,
            )  # fmt: skip
        origin = provenance.begin(
            threads=threads, seed=about.seed, engine=type(engine).__name__, overrides=about.overrides or {}
        )
        heard.raise_if_asked(_BEFORE)
        prepare(folder, overwrite=overwrite)
        write_json(folder / schema.PROVENANCE, origin)
        write_json(folder / schema.CASE_JSON, about.resolved)
        if about.text is not None:
            _write_text(folder / schema.CASE_TOML, about.text)
        said = Progress(folder / schema.LOG, shown=progress)
        try:
            for note in about.notes:
                said.line(str(note))
            loop = Loop(
                engine=engine, scene=scene, frames=frames, stop=stop,
                changes=sorted((round(one.at / scene.dt), k, one) for k, one in enumerate(changes)),
                recorder=Recorder(folder, scene), watch=Watch(scene, state), progress=said, origin=origin,
            )  # fmt: skip
            loop.run(state)
        finally:
            said.close()
    return Results.open(folder)


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


def _cpu_engine(threads: int) -> Engine:
    if threads < 1:
        raise CaseError("threads", threads, "must be at least 1")
    from ryusa.engine.cpu import CpuEngine

    return CpuEngine(threads=threads)


def _write_text(path: Path, text: str) -> None:
    try:
        path.write_bytes(text.encode())
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written ({error.strerror or error})") from error
