"""What there is to go on from in a run folder, and whether this process may."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ryusa.errors import CheckpointError, ResultsError
from ryusa.model import EVENT, Scene, State
from ryusa.results import schema
from ryusa.results.hdf5 import OpenFiles
from ryusa.results.lazy import Part
from ryusa.results.read import numbered, read_json, read_part, read_scenes
from ryusa.results.scene_file import scene_digest
from ryusa.running.checkpoint import Kept, read_checkpoint
from ryusa.running.folder import is_run
from ryusa.running.keeper import MAY_CHANGE, case_digest, code_of
from ryusa.running.place import Place
from ryusa.running.recorder import Left
from ryusa.running.snapshot import state_of
from ryusa.running.vtkhdf import PartSize

_ANEW = "--overwrite begins anew"
_SAID = {"plan": "time between frames, or another timeline", "engine": "engine"}
_DERIVED = "derived"  # follows from the rest


@dataclass(frozen=True)
class Going:
    """Where a run goes on.

    Attributes
    ----------
    origin : its provenance so far.
    said : what is odd about going on, for the log.
    scene : as the run began.
    left : for the recorder.
    x_first : centres in the first frame [m], shape (n_grain, 3).
    kept, state, now : the checkpoint, its state, and the scene that held there; None where there is none:
        then the run begins at its first step, and makes again what is there.
    complete : nothing is left to do.
    """

    origin: dict[str, Any]
    said: tuple[str, ...] = ()
    scene: Scene | None = None
    left: Left | None = None
    x_first: np.ndarray | None = None
    kept: Kept | None = None
    state: State | None = None
    now: Scene | None = None
    complete: bool = False


def look(
    folder: Path,
    resolved: Mapping[str, Any],
    identity: Mapping[str, Any],
    origin: Mapping[str, Any],
    *,
    force: bool,
) -> Going | None:
    """Find where a run goes on; None where nothing is left of it but its name.

    Parameters
    ----------
    folder : the run folder.
    resolved : the case now, as case.json holds it.
    identity : of the checkpoint that this process would write (`keeper.identity_of`), scenes left out.
    origin : provenance of this process.
    force : go on where that gives right numbers, though not those of a run that was never stopped.

    Raises
    ------
    CheckpointError, ResultsError : it must not go on, and why; one line.
    """
    if not is_run(folder):
        return None
    before = read_json(folder / schema.PROVENANCE)
    if before.get("format") != schema.FORMAT:
        raise CheckpointError(f"{folder}: format {before.get('format')!r}, this ryusa writes {schema.FORMAT}")
    was = read_json(folder / schema.CASE_JSON, missing_ok=True)
    if not was or not numbered(folder, schema.SCENE_NAME):
        return None  # killed while it began
    changed = changes_of(was, resolved)
    if before.get("status") == schema.COMPLETE:
        if changed:
            raise CheckpointError(
                f"{folder}: is complete, and the case has changed since: {_some(changed)}. "
                f"Choose another folder with -o, or {_ANEW}"
            )
        return Going(before, complete=True)
    hard = [one for one in changed if one.split(".", 1)[0] not in MAY_CHANGE]
    if hard:
        raise CheckpointError(
            f"{folder}: the case has changed since: {_some(hard)}. That is another run: choose another "
            f"folder with -o, or {_ANEW}"
        )
    odd = [f"the case has changed: {_some(changed)}"] if changed else []
    scenes = read_scenes(folder)
    kept, lost = _newest(folder, scenes[0][2].n_grain)
    whose = {"code": code_of(before)} if kept is None else kept.part("identity").about
    odd += _other_code(whose.get("code"), code_of(origin))
    if not changed and whose.get("stop", identity["stop"]) != identity["stop"]:
        odd.append("the stop rule has changed")
    if odd and not force:
        raise CheckpointError(
            f"{folder}: {'; '.join(odd)}. With --force it goes on, with right numbers but not those of a run "
            f"that was never stopped; {_ANEW}"
        )
    if kept is None:
        return None if odd else _from_the_start(folder, before, scenes)
    _refuse_foreign(folder, kept, was, identity, scenes)
    return _from_checkpoint(folder, before, scenes, kept, [*lost, *odd], alike=not odd)


def _newest(folder: Path, n_grain: int) -> tuple[Kept | None, list[str]]:
    """The newest checkpoint that is whole, and what was wrong with a newer one."""
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
        raise CheckpointError(f"{'; '.join(faults)}. No checkpoint to go on from; {_ANEW}")
    return None, []


def _from_the_start(
    folder: Path, before: dict[str, Any], scenes: Sequence[tuple[int, float, Scene]]
) -> Going | None:
    first = scenes[0][2]
    parts, _ = _parts(folder, first.n_grain, at_least=0)
    if not any(part.n_frame for part in parts):
        return None
    left = Left(
        [_size(part) for part in parts], [(scenes[0][1], first)], quiet_until=parts[-1].end, last=_last(parts)
    )
    return Going(before, ("no checkpoint yet: begins again, and keeps what is there",), first, left)


def _from_checkpoint(
    folder: Path,
    before: dict[str, Any],
    scenes: Sequence[tuple[int, float, Scene]],
    kept: Kept,
    odd: list[str],
    *,
    alike: bool,
) -> Going:
    place, stood = kept.part("loop"), kept.part("recorder")
    where = Place.of(place, scenes[0][2])
    if where.changed >= len(scenes):
        raise CheckpointError(f"{folder}: a scene is missing in {schema.PARTS}/; {_ANEW}")
    scene = scenes[where.changed][2]
    state = state_of(kept.part("state"), scene)
    try:
        n_part, parts_end, end, n_frame, n_contact = (
            int(stood.about[name]) for name in ("n_part", "parts_end", "end", "n_frame", "n_contact")
        )
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise CheckpointError(f"{folder}: the checkpoint does not say what was recorded ({error})") from error
    parts, damaged = _parts(folder, scene.n_grain, at_least=n_part)
    if damaged:
        odd = [*odd, damaged]
    if not alike:
        odd += _set_aside(parts[n_part:])
        parts = parts[:n_part]
    reach = parts[-1].end if parts else -1
    assert reach is not None
    waiting = {} if reach != parts_end else _waiting(stood, scene, folder)
    recorded = sum(part.n_frame for part in parts) + len(waiting.get("t", ()))
    contacts = sum(part.n_contact for part in parts) + len(waiting.get("contacts", ()))
    further = reach > end
    if not further and (recorded, contacts) != (n_frame, n_contact):
        raise CheckpointError(
            f"{folder}: the checkpoint counts {n_frame} frames and {n_contact} contacts, {schema.PARTS}/ "
            f"holds {recorded} and {contacts}: they are not of one run; {_ANEW}"
        )
    left = Left(
        [_size(part) for part in parts], [(t, one) for _, t, one in scenes[: where.changed + 1]],
        n_frame=n_frame, n_contact=n_contact, end=end, waiting=waiting,
        quiet_until=reach if further else None, last=_last(parts) if further else None,
    )  # fmt: skip
    return Going(
        before, tuple(odd), scenes[0][2], left, _first(parts, waiting), kept=kept, state=state, now=scene
    )


def _parts(folder: Path, n_grain: int, *, at_least: int) -> tuple[list[Part], str]:
    """Whole parts in order, a tail left out, and what was found damaged among those after `at_least`."""
    found: list[Part] = []
    files, first = OpenFiles(), 0
    for number, path in enumerate(numbered(folder, schema.PART_NAME)):
        try:
            if path.name != schema.part_name(number):
                raise ResultsError(f"{path.parent}: {schema.part_name(number)} is missing")
            part = read_part(path, first, n_grain, files)
        except ResultsError as error:
            if number < at_least:
                raise CheckpointError(f"{error}. It was written before the checkpoint; {_ANEW}") from error
            return found, f"{error}: made again"
        if part.tail:
            break
        if part.end is None:
            raise CheckpointError(f"{path}: written by an earlier version; {_ANEW}")
        found.append(part)
        first += part.n_frame
    if len(found) < at_least:
        raise CheckpointError(
            f"{folder}: {at_least} parts were there at the checkpoint, now {len(found)}; {_ANEW}"
        )
    return found, ""


def _size(part: Part) -> PartSize:
    assert part.end is not None
    return PartSize(part.path.name, part.n_frame, part.n_contact, part.end)


def _last(parts: Sequence[Part]) -> dict[str, np.ndarray] | None:
    """The last frame on the disk."""
    for part in reversed(parts):
        if part.n_frame:
            k = part.n_frame - 1
            rows = {name: part.rows(name, k, k + 1, slice(None))[0] for name in ("x", "v", "omega")}
            return rows | {"step": np.asarray(part.step[-1])}
    return None


def _first(parts: Sequence[Part], waiting: Mapping[str, np.ndarray]) -> np.ndarray:
    for part in parts:
        if part.n_frame:
            return part.rows("x", 0, 1, slice(None))[0]
    if "x" not in waiting or not len(waiting["x"]):
        raise CheckpointError(f"the first frame is missing; {_ANEW}")
    return waiting["x"][0]


def _waiting(stood: Kept, scene: Scene, folder: Path) -> dict[str, np.ndarray]:
    """What had gathered and was in no part, every shape checked."""
    if not stood.arrays:
        return {}
    rows, n = stood.arrays, scene.n_grain
    try:
        k = len(rows["t"])
        shapes = {
            name: ((k, n, *tail) if name in schema.PER_GRAIN else (k,), dtype)
            for name, (dtype, tail) in schema.FRAME_DATASETS.items()
        }
        shapes |= {"tally": ((k,), schema.TALLY), "contacts": ((len(rows["contacts"]),), EVENT)}
        if scene.column is not None and k:
            n_cell, float_ = scene.column.n, np.dtype(np.float64)
            cells, faces = (schema.WATER_CELLS, (n_cell,)), (schema.WATER_FACES, (n_cell + 1,))
            for names, tail in (cells, faces, (schema.WATER_NUMBERS, ())):
                shapes |= {f"{schema.WATER}/{name}": ((k, *tail), float_) for name in names}
        if set(shapes) != set(rows):
            raise ValueError(f"datasets {', '.join(sorted(rows))}")
        for name, (shape, dtype) in shapes.items():
            if rows[name].shape != shape or rows[name].dtype != dtype:
                raise ValueError(f"'{name}' is {rows[name].shape} of {rows[name].dtype}")
    except (KeyError, ValueError, TypeError) as error:
        raise CheckpointError(
            f"{folder}: what waits in the checkpoint does not fit the run ({error})"
        ) from error
    return dict(rows)


def _refuse_foreign(
    folder: Path,
    kept: Kept,
    was: Mapping[str, Any],
    identity: Mapping[str, Any],
    scenes: Sequence[tuple[int, float, Scene]],
) -> None:
    """Hold the checkpoint against the folder it lies in, and the plan against the one now."""
    whose = kept.part("identity").about
    n = Place.of(kept.part("loop"), scenes[0][2]).changed
    now = scene_digest(scenes[min(n, len(scenes) - 1)][2])
    if (whose.get("case"), whose.get("scene"), whose.get("scene_now")) != (
        case_digest(was), scene_digest(scenes[0][2]), now,
    ):  # fmt: skip
        raise CheckpointError(f"{folder}: its checkpoint is that of another run; {_ANEW}")
    for name in ("plan", "engine"):
        if whose.get(name) != identity[name]:
            raise CheckpointError(f"{folder}: it was run with another {_SAID[name]}; {_ANEW}")


def _other_code(made_by: Any, mine: Mapping[str, str]) -> list[str]:
    theirs = made_by if isinstance(made_by, dict) else {}
    differ = [name for name in mine if theirs.get(name) != mine[name]]
    if not differ:
        return []
    said = ", ".join(f"{name} {str(theirs.get(name))[:60]} is now {mine[name][:60]}" for name in differ)
    return [f"it was run elsewhere or by another version: {said}"]


def _set_aside(parts: Sequence[Part]) -> list[str]:
    """Take away parts written after the checkpoint, which are of other bits."""
    for part in parts:
        part.path.unlink(missing_ok=True)
    return [f"{len(parts)} parts after the checkpoint set aside"] if parts else []


def changes_of(was: Any, now: Any, key: str = "") -> list[str]:
    """Keys of a case that changed, dotted, with both values.

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
