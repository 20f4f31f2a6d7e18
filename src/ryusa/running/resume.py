"""Resume: finds the step from which a run can continue, and checks that this process may do so."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ryusa.casefile.row.reach import END, NAME
from ryusa.errors import CheckpointError, ResultsError
from ryusa.model import Scene, State
from ryusa.results import schema
from ryusa.results.hdf5 import OpenFiles
from ryusa.results.lazy import Part
from ryusa.results.read import numbered, other_format, read_json, read_part, read_scenes
from ryusa.results.scene_file import scene_digest
from ryusa.running.buffered_frames import buffered_frames
from ryusa.running.checkpoint import CheckpointBlock, read_checkpoint
from ryusa.running.checkpoint_scheduler import FREE_KEYS, case_digest, code_versions
from ryusa.running.folder import is_run
from ryusa.running.loop_state import LoopState
from ryusa.running.recorder import RecordedSoFar
from ryusa.running.snapshot import state_from_block
from ryusa.running.vtkhdf import PartSize

_ANEW = "to discard it and start again, use --overwrite"
_NAMES = {"plan": "frame interval or timeline", "engine": "engine"}
_INEXACT = "the engine '{}' goes on from its own restart: not bit for bit as without the interruption"
_DERIVED = "derived"  # computed from the other sections


@dataclass(frozen=True)
class ResumePoint:
    """Step from which a run continues, and the state there.

    Attributes
    ----------
    origin : its provenance so far.
    notes : differences and damage found, for the log.
    scene : scene at the start of the run.
    recorded : for the recorder.
    x_first : centres in the first frame [m], shape (n_grain, 3).
    checkpoint, state, now : the checkpoint, its state, and the scene that was valid there; None without one:
        then the run starts at its first step and recomputes what is on the disk.
    complete : the run is complete.
    """

    origin: dict[str, Any]
    notes: tuple[str, ...] = ()
    scene: Scene | None = None
    recorded: RecordedSoFar | None = None
    x_first: np.ndarray | None = None
    checkpoint: CheckpointBlock | None = None
    state: State | None = None
    now: Scene | None = None
    complete: bool = False


def find_resume_point(
    folder: Path,
    resolved: Mapping[str, Any],
    identity: Mapping[str, Any],
    origin: Mapping[str, Any],
    *,
    force: bool,
    exact: bool = True,
) -> ResumePoint | None:
    """Find the step from which a run continues; None if the folder holds no usable data of it.

    Parameters
    ----------
    folder : the run folder.
    resolved : the present case, as case.json holds it.
    identity : of this run without its scenes, see `checkpoint_scheduler.run_identity`.
    origin : provenance of this process.
    force : allow a resume whose results are valid but not bitwise those of an uninterrupted run.
    exact : whether the engine can resume bitwise; where it cannot, the frames after the checkpoint are
        computed anew, and another processor or version is no obstacle.

    Raises
    ------
    CheckpointError, ResultsError : the run must not be continued; one line with the reason.
    """
    if not is_run(folder):
        return None
    before = read_json(folder / schema.PROVENANCE)
    if before.get("format") != schema.FORMAT:
        raise CheckpointError(f"{folder}: {other_format(before)}")
    was = read_json(folder / schema.CASE_JSON, missing_ok=True)
    if not was or not numbered(folder, schema.SCENE_NAME):
        return None  # killed at its start
    changed = changes_of(was, resolved)
    complete = before.get("status") == schema.COMPLETE
    if hard := [one for one in changed if one.split(".", 1)[0] not in FREE_KEYS]:
        other = _other_code(code_versions(before), code_versions(origin))
        raise CheckpointError(_of_another_case(folder, hard, other, complete))
    scenes = read_scenes(folder)
    block, lost = _newest(folder, scenes[0][2].n_grain)
    written_by = {"code": code_versions(before)} if block is None else block.block("identity").values
    was_stop = written_by.get("stop")
    stop_changed = any(one.split(".", 1)[0] == "stop" for one in changed) or (
        was_stop is not None and was_stop != identity["stop"]
    )
    differences = _other_feeds(scenes[0][2], resolved)
    if complete and not stop_changed and not differences:
        return ResumePoint(before, complete=True)
    if complete and block is None:
        raise CheckpointError(
            f"{folder}: the run is complete and holds no checkpoint of its end, so it cannot be "
            f"lengthened; {_ANEW}"
        )
    if stop_changed:
        differences += _other_stop(was_stop, identity["stop"], block, changed)
    code = _other_code(written_by.get("code"), code_versions(origin))
    differences += code if exact else []
    if differences and not force:
        raise CheckpointError(
            f"{folder}: {'; '.join(differences)}. With --force the run continues with valid results, but not "
            f"bitwise those of an uninterrupted run; {_ANEW}"
        )
    if block is None:
        return None if differences or not exact else _from_the_start(folder, before, scenes)
    _refuse_foreign(folder, block, was, identity, scenes)
    alike, said = exact and not differences, [] if exact else [_INEXACT.format(origin.get("engine")), *code]
    return _from_checkpoint(folder, before, scenes, block, [*lost, *differences, *said], alike=alike)


def _of_another_case(folder: Path, hard: Sequence[str], other: Sequence[str], complete: bool) -> str:
    """Say that a run is of another case, by keys that differ, and of other code."""
    state = "the run is complete, and " if complete else ""
    made = "".join(f"; {one}" for one in other)
    way = "For" if complete else f"`ryusa resume {folder}` continues the run with its own case; for"
    return (
        f"{folder}: {state}the case has changed since: {_some(hard)}{made}. "
        f"{way} the changed case choose another folder with -o; {_ANEW}"
    )


def _other_feeds(scene: Scene, case: Mapping[str, Any]) -> list[str]:
    """Feeds whose grains were drawn for another end than that of a case, as case.json holds it."""
    stop = (case.get("stop") or {}).get("time")
    own = [one for one in case.get("feeds") or () if one.get("rate") or one.get("sedigraph")]
    ends = {one["name"]: (one.get("end"), stop) for one in own}
    row = (case.get("water") or {}).get("row") or {}
    if (row.get("upstream") or {}).get("end") == END:
        ends[NAME] = (None, stop)
    found: list[str] = []
    for feed in scene.traffic.feeds if scene.traffic is not None else ():
        end = min((float(one) for one in ends.get(feed.name, ()) if one is not None), default=feed.end)
        if end == feed.end:
            continue
        then = "so that it brings none after that" if end > feed.end else "so that their sizes would differ"
        found.append(
            f"the grains of feed '{feed.name}' were drawn up to {feed.end:g} s, when the run or the feed was "
            f"to end, and not to {end:g} s, {then}"
        )
    return found


def _newest(folder: Path, n_grain: int) -> tuple[CheckpointBlock | None, list[str]]:
    """The newest undamaged checkpoint, and the faults of a newer one."""
    faults: list[str] = []
    for name in (schema.CHECKPOINT, schema.CHECKPOINT_BEFORE):
        path = folder / name
        if not path.exists() and not path.is_symlink():
            continue
        try:
            return read_checkpoint(path, n_grain), faults
        except CheckpointError as error:
            faults.append(str(error))
    if faults:
        raise CheckpointError(f"{'; '.join(faults)}. No checkpoint is left to resume from; {_ANEW}")
    return None, []


def _from_the_start(
    folder: Path, before: dict[str, Any], scenes: Sequence[tuple[int, float, Scene]]
) -> ResumePoint | None:
    first = scenes[0][2]
    parts, _ = _parts(folder, first, at_least=0)
    if not any(part.n_frame for part in parts):
        return None
    recorded = RecordedSoFar(
        [_size(part) for part in parts],
        [(scenes[0][1], first)],
        verify_until=parts[-1].end,
        last=_last(parts),
    )
    return ResumePoint(
        before,
        ("no checkpoint yet: starts at the first step, and keeps the frames on the disk",),
        first,
        recorded,
    )


def _from_checkpoint(
    folder: Path,
    before: dict[str, Any],
    scenes: Sequence[tuple[int, float, Scene]],
    block: CheckpointBlock,
    differences: list[str],
    *,
    alike: bool,
) -> ResumePoint:
    loop, recorder = block.block("loop"), block.block("recorder")
    state_of_loop = LoopState.from_block(loop, scenes[0][2])
    if state_of_loop.changed >= len(scenes):
        raise CheckpointError(f"{folder}: a scene is missing from {schema.PARTS}/; {_ANEW}")
    scene = scenes[state_of_loop.changed][2]
    state = state_from_block(block.block("state"), scene)
    try:
        n_part, parts_end, end, n_frame, n_contact = (
            int(recorder.values[name]) for name in ("n_part", "parts_end", "end", "n_frame", "n_contact")
        )
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise CheckpointError(
            f"{folder}: the state of the recorder in the checkpoint is incomplete ({error})"
        ) from error
    parts, damaged = _parts(folder, scene, at_least=n_part)
    if damaged:
        differences = [*differences, damaged]
    if not alike:
        differences += _delete(parts[n_part:])
        parts = parts[:n_part]
    reach = parts[-1].end if parts else -1
    buffered = {} if reach != parts_end else buffered_frames(recorder, scene, folder)
    n_recorded = sum(part.n_frame for part in parts) + len(buffered.get("t", ()))
    contacts = sum(part.n_contact for part in parts) + len(buffered.get("contacts", ()))
    further = reach > end
    if not further and (n_recorded, contacts) != (n_frame, n_contact):
        raise CheckpointError(
            f"{folder}: the checkpoint counts {n_frame} frames and {n_contact} contacts, {schema.PARTS}/ "
            f"holds {n_recorded} and {contacts}: they belong to different runs; {_ANEW}"
        )
    recorded = RecordedSoFar(
        [_size(part) for part in parts], [(t, one) for _, t, one in scenes[: state_of_loop.changed + 1]],
        n_frame=n_frame, n_contact=n_contact, end=end, buffered=buffered,
        verify_until=reach if further else None, last=_last(parts) if further else None,
    )  # fmt: skip
    return ResumePoint(
        before,
        tuple(differences),
        scenes[0][2],
        recorded,
        _first(parts, buffered),
        checkpoint=block,
        state=state,
        now=scene,
    )


def _parts(folder: Path, scene: Scene, *, at_least: int) -> tuple[list[Part], str]:
    """Undamaged parts in order, without a tail, and the damage found after the first `at_least`."""
    found: list[Part] = []
    files, first = OpenFiles(), 0
    for number, path in enumerate(numbered(folder, schema.PART_NAME)):
        try:
            if path.name != schema.part_name(number):
                raise ResultsError(f"{path.parent}: {schema.part_name(number)} is missing")
            part = read_part(path, first, scene, files)
        except ResultsError as error:
            if number < at_least:
                raise CheckpointError(f"{error}. It was written before the checkpoint; {_ANEW}") from error
            return found, f"{error}: recomputed"
        if part.tail:
            break
        found.append(part)
        first += part.n_frame
    if len(found) < at_least:
        raise CheckpointError(
            f"{folder}: {at_least} parts existed at the checkpoint, now {len(found)}; {_ANEW}"
        )
    return found, ""


def _size(part: Part) -> PartSize:
    return PartSize(part.path.name, part.n_frame, part.n_contact, part.end)


def _last(parts: Sequence[Part]) -> dict[str, np.ndarray] | None:
    """The last frame on the disk."""
    for part in reversed(parts):
        if part.n_frame:
            k = part.n_frame - 1
            rows = {name: part.rows(name, k, k + 1, slice(None))[0] for name in ("x", "v", "omega")}
            return rows | {"step": np.asarray(part.step[-1])}
    return None


def _first(parts: Sequence[Part], buffered: Mapping[str, np.ndarray]) -> np.ndarray:
    for part in parts:
        if part.n_frame:
            return part.rows("x", 0, 1, slice(None))[0]
    if "x" not in buffered or not len(buffered["x"]):
        raise CheckpointError(f"the first frame is missing; {_ANEW}")
    return buffered["x"][0]


def _refuse_foreign(
    folder: Path,
    block: CheckpointBlock,
    was: Mapping[str, Any],
    identity: Mapping[str, Any],
    scenes: Sequence[tuple[int, float, Scene]],
) -> None:
    """Check that the checkpoint belongs to the run in the folder, and that the plan is unchanged."""
    written_by = block.block("identity").values
    n = LoopState.from_block(block.block("loop"), scenes[0][2]).changed
    now = scene_digest(scenes[min(n, len(scenes) - 1)][2])
    if (written_by.get("case"), written_by.get("scene"), written_by.get("scene_now")) != (
        case_digest(was), scene_digest(scenes[0][2]), now,
    ):  # fmt: skip
        raise CheckpointError(f"{folder}: its checkpoint belongs to another run; {_ANEW}")
    for name in ("plan", "engine"):
        if written_by.get(name) != identity[name]:
            raise CheckpointError(f"{folder}: the run was started with another {_NAMES[name]}; {_ANEW}")


def _other_stop(
    was: Any, now: Mapping[str, Any], block: CheckpointBlock | None, changed: list[str]
) -> list[str]:
    """Why a run to the new end differs from one that had it from the start; empty if it does not.

    A later time, more saltations, a smaller error, or a rule removed only add steps. Every other rule could
    have ended the run at a step that it has passed.
    """
    said = _some([one for one in changed if one.startswith("stop.")]) or "the rule differs"
    if block is None:
        return [f"the end has changed: {said}; no checkpoint has been written yet"]
    t = float(block.block("state").values["t"])
    if not now["time"] > t:
        return [f"the end has changed: {said}; the run has reached t = {t:.6g} s already"]
    before = was if isinstance(was, Mapping) else {}
    rest = (now["rest_speed"], now["rest_for"])
    same_rest = rest == (before.get("rest_speed"), before.get("rest_for")) or math.isinf(now["rest_for"])
    hops, earlier = now["saltations"], before.get("saltations")
    more_hops = hops is None or (earlier is not None and hops >= earlier)
    stricter = _stricter(now["precision"], before.get("precision"))
    return [] if same_rest and more_hops and stricter else [f"the end has changed: {said}"]


def _stricter(now: Mapping[str, Any], before: Any) -> bool:
    """Whether averages known as well as `now` asks for are known as well as was asked `before`."""
    if not now:
        return True
    earlier = before if isinstance(before, Mapping) and before else {"": None}
    return all(
        isinstance(one, Mapping)
        and name in now
        and now[name]["unit"] == one.get("unit")
        and now[name]["amount"] <= one.get("amount", 0.0)
        for name, one in earlier.items()
    )


def _other_code(made_by: Any, mine: Mapping[str, str]) -> list[str]:
    theirs = made_by if isinstance(made_by, dict) else {}
    differ = [name for name in mine if theirs.get(name) != mine[name]]
    if not differ:
        return []
    said = ", ".join(f"{name} {str(theirs.get(name))[:60]} is now {mine[name][:60]}" for name in differ)
    return [f"the run was made on another processor or by another version: {said}"]


def _delete(parts: Sequence[Part]) -> list[str]:
    """Delete parts written after the checkpoint, written_by bits will differ."""
    for part in parts:
        part.path.unlink(missing_ok=True)
    return [f"{len(parts)} parts written after the checkpoint deleted"] if parts else []


def changes_of(was: Any, now: Any, key: str = "") -> list[str]:
    """Keys of a case that changed, with both values.

    >>> changes_of({"stop": {"time": 1.0}, "seed": 1}, {"stop": {"time": 2.0}, "seed": 1})
    ['stop.time 1.0 is now 2.0']
    """
    if isinstance(was, Mapping) and isinstance(now, Mapping):
        found: list[str] = []
        for name in dict.fromkeys([*was, *now]):
            if key or name != _DERIVED:
                found += changes_of(was.get(name), now.get(name), f"{key}.{name}" if key else str(name))
        return found
    return [] if was == now else [f"{key} {str(was)[:60]} is now {str(now)[:60]}"]


def _some(changed: Sequence[str]) -> str:
    more = f" and {len(changed) - 3} more" if len(changed) > 3 else ""
    return "; ".join(changed[:3]) + more
