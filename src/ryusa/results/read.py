"""A run folder opened for reading, during the run, after its end, or after it was killed.

Nothing in the folder is trusted: links are not followed, stored sizes are checked, no pickle is read. Frames
come from the write-once files in parts/, so every frame that was written is found, however the run ended.
"""

import json
import os
import re
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.model import EVENT, PASSAGE, Scene
from ryusa.model.servo import on_way
from ryusa.model.walls import N_IMPULSE
from ryusa.results import schema
from ryusa.results.frames import BodyFrames, Frames, joined
from ryusa.results.hdf5 import OpenFiles, opened, plain_dataset, read_dataset, read_integer
from ryusa.results.lazy import Part, read_frames
from ryusa.results.place import refuse_other
from ryusa.results.scene_file import read_scene
from ryusa.results.water import WaterFrames
from ryusa.version import __version__

Floats = NDArray[np.float64]
_JSON_LIMIT = 64 << 20  # bytes


@dataclass(frozen=True)
class Grains:
    """Free grains, each array of shape (n_grain,)."""

    d: Floats  # [m]
    m: Floats  # [kg]
    m_added: Floats  # [kg]
    inertia: Floats  # [kg m2]


@dataclass(frozen=True)
class Bed:
    """Fixed grains; ids start at n_grain."""

    x: Floats  # [m], shape (n_fixed, 3)
    d: Floats  # [m], shape (n_fixed,)
    active: NDArray[np.bool_]  # at the start of the run


@dataclass(frozen=True)
class Planes:
    """Planes; ids follow the fixed grains."""

    normal: Floats  # unit, into the free side, shape (n_plane, 3)
    point: Floats  # [m], shape (n_plane, 3)
    active: NDArray[np.bool_]


class RunArrays:
    """What a run folder holds, read-only."""

    def __init__(self, folder: Path) -> None:
        """Use `Results.open`."""
        self.folder = folder
        self.provenance = read_json(folder / schema.PROVENANCE)
        if self.provenance.get("format") != schema.FORMAT:
            raise ResultsError(f"{folder}: {other_format(self.provenance)}")
        self.case = read_json(folder / schema.CASE_JSON, missing_ok=True)
        self.summary = read_json(folder / schema.SUMMARY, missing_ok=True)
        # (step, t [s], Scene) at the start and after every change of the timeline
        self.scenes = read_scenes(folder)
        self.scene: Scene = self.scenes[0][2]  # at the start of the run
        self._parts = read_parts(folder, self.scene)
        self.frames = Frames(self._parts, self.scene.n_grain, self.scene.period)
        self.bodies = None if (clumps := self.scene.bodies) is None else BodyFrames(self._parts, clumps.n)

    @classmethod
    def open(cls, folder: str | os.PathLike[str]) -> Self:
        """Open a run folder.

        Raises
        ------
        ResultsError : not a run folder, damaged, or written in another format.
        """
        path = Path(folder)
        refuse_other(path)
        return cls(path)

    @property
    def status(self) -> str:
        """One of running, complete, stopped, interrupted, failed; that of a killed run remains running."""
        return str(self.provenance.get("status"))

    @property
    def complete(self) -> bool:
        """Whether the run ended by a stop rule of its case."""
        return self.status == schema.COMPLETE

    @cached_property
    def contacts(self) -> NDArray[np.void]:
        """Contacts that ended: structured array of dtype model.EVENT, sorted by t_part [s]."""
        rows = [part.contacts() for part in self._parts if part.n_contact]
        joined = np.concatenate(rows) if rows else np.zeros(0, dtype=EVENT)
        joined = joined[np.lexsort((joined["j"], joined["i"], joined["t_part"]))]
        joined.flags.writeable = False
        return joined

    @cached_property
    def passages(self) -> NDArray[np.void]:
        """Grains that entered and left: structured array of dtype model.PASSAGE, in order; empty without."""
        rows = [part.passages() for part in self._parts] if self.scene.traffic is not None else []
        return joined(rows, PASSAGE)

    def contact_forces(self, k: int) -> NDArray[np.void]:
        """Contact forces at frame k: structured array of dtype schema.FORCE, of the step before the frame.

        Raises
        ------
        ResultsError : the case did not record them (`record.forces`).
        """
        k = range(len(self.frames))[k]
        part = self._parts[bisect_right([one.first for one in self._parts], k) - 1]
        found = part.forces(k - part.first)
        if found is None:
            raise ResultsError(
                f"{self.folder}: holds no contact forces; run the case with --set record.forces=true"
            )
        return found

    @cached_property
    def tally(self) -> dict[str, NDArray[Any]]:
        """The energy account [J] and extremes at each frame, shape (n_frame,) each; keys of schema.TALLY."""
        rows = joined([part.tally() for part in self._parts], schema.TALLY)
        return {name: rows[name] for name in schema.TALLY.names or ()}

    @cached_property
    def walls(self) -> NDArray[np.float64]:
        """Impulses on each wall and its work since the start, shape (n_frame, n_wall, N_IMPULSE)."""
        return self._of_walls(schema.WALLS, (self.scene.n_wall, N_IMPULSE), self.scene.n_wall > 0)

    @cached_property
    def wall_travel(self) -> NDArray[np.float64]:
        """Way of each wall along the direction of its servo [m], (n_frame, n_wall); 0 without one."""
        return self._of_walls(schema.TRAVEL, (self.scene.n_wall,), self.scene.has_servo)

    def _of_walls(self, name: str, shape: tuple[int, ...], recorded: bool) -> NDArray[np.float64]:
        if not recorded:
            return np.zeros((len(self.frames), *shape))
        rows = [part.of_walls(name, shape) for part in self._parts if part.n_frame]
        return np.concatenate([np.zeros((0, *shape)), *rows])

    @cached_property
    def fluid(self) -> WaterFrames | None:
        """Fields of the water at every frame, whatever its kind; None if none feels the grains."""
        if (flow := self.scene.flow) is None:
            return None
        return WaterFrames(flow, self.frames.t, **read_frames(self._parts, flow.GROUP, flow.frame_shapes()))

    @property
    def water(self) -> WaterFrames | None:
        """Profiles of the water at every frame; None if the run has no water column."""
        return None if self.scene.column is None else self.fluid

    @property
    def row(self) -> WaterFrames | None:
        """Water of a row of columns at every frame; None if the run has none."""
        return None if self.scene.row is None else self.fluid

    @property
    def grains(self) -> Grains:
        """Sizes and masses of the free grains."""
        return Grains(self.scene.d, self.scene.m, self.scene.m_added, self.scene.inertia)

    @property
    def bed(self) -> Bed:
        """Fixed grains."""
        return Bed(self.scene.x_fixed, self.scene.d_fixed, self.scene.fixed_active)

    @property
    def planes(self) -> Planes:
        """Planes with the same contact law."""
        return Planes(self.scene.plane_normal, self.scene.plane_point, self.scene.plane_active)

    def scene_at(self, t: float) -> Scene:
        """Return the scene at time `t` [s]; it changes with the timeline, and walls with their servos."""
        scene = self.scenes[max(bisect_right([begin for _, begin, _ in self.scenes], t) - 1, 0)][2]
        return scene if not scene.has_servo else on_way(scene, self.frames.t, self.wall_travel, t)

    def __repr__(self) -> str:
        return (
            f"Results({str(self.folder)!r}, {self.status}, {len(self.frames)} frames, "
            f"{self.scene.n_grain} free and {self.scene.n_fixed} fixed grains)"
        )


def other_format(origin: dict[str, Any]) -> str:
    """What a folder of another format says about who reads it."""
    told = str(origin.get("read_by"))
    who = told if re.fullmatch(r"ryusa [\w .<>=,]{1,30}", told) else "another version"
    return (
        f"format {origin.get('format')!r}, which {who} reads; this is ryusa {__version__}, which reads "
        f"{schema.FORMAT}. {schema.PROVENANCE} names the version that wrote it"
    )


def read_json(path: Path, *, missing_ok: bool = False) -> dict[str, Any]:
    """Read a JSON object from a file of a run folder."""
    if missing_ok and not path.exists() and not path.is_symlink():
        return {}
    if path.is_symlink() or not path.is_file():
        raise ResultsError(f"{path}: no such file in the run folder (links are not followed)")
    try:
        if path.stat().st_size > _JSON_LIMIT:
            raise ResultsError(f"{path}: larger than {_JSON_LIMIT >> 20} MB, not written by ryusa")
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise ResultsError(f"{path}: not readable as JSON ({error})") from error
    if not isinstance(found, dict):
        raise ResultsError(f"{path}: expected a table of keys, found {type(found).__name__}")
    return found


def numbered(folder: Path, pattern: "Any") -> list[Path]:
    """Files in parts/ whose names match the pattern, in order."""
    parts = folder / schema.PARTS
    if parts.is_symlink():
        raise ResultsError(f"{parts}: is a link; links are not followed")
    try:
        return sorted(entry for entry in parts.iterdir() if pattern.fullmatch(entry.name))
    except OSError as error:
        raise ResultsError(f"{parts}: cannot be listed ({error})") from error


def read_scenes(folder: Path) -> list[tuple[int, float, Scene]]:
    """Read the scenes of a run, each with the step and the time [s] from which it is valid."""
    scenes = [read_scene(path) for path in numbered(folder, schema.SCENE_NAME)]
    if not scenes:
        raise ResultsError(f"{folder}: the run was stopped before its first scene was written")
    if len({scene.n_grain for _, _, scene in scenes}) > 1:
        raise ResultsError(f"{folder}: its scenes differ in their number of grains")
    return scenes


def read_parts(folder: Path, scene: Scene) -> list[Part]:
    """Open all parts of a run, in order."""
    parts: list[Part] = []
    files = OpenFiles()
    first = 0
    for number, path in enumerate(numbered(folder, schema.PART_NAME)):
        if path.name != schema.part_name(number):
            raise ResultsError(f"{path.parent}: {schema.part_name(number)} is missing")
        part = read_part(path, first, scene, files)
        parts.append(part)
        first += part.n_frame
    return parts


def read_part(path: Path, first: int, scene: Scene, files: OpenFiles) -> Part:
    """Open a part whose first frame has number `first`; every shape is checked."""
    with opened(path) as file:
        t, step = read_dataset(file, "t", path), read_dataset(file, "step", path)
        k = len(t) if t.ndim == 1 else -1
        for name, (dtype, tail) in schema.FRAME_DATASETS.items():
            shape = (k, scene.n_grain, *tail) if name in schema.PER_GRAIN else (k,)
            _check(plain_dataset(file, name, path), shape, dtype, path)
        n_body = -1 if scene.bodies is None else scene.bodies.n
        for name, (dtype, tail) in schema.BODY_DATASETS.items() if n_body >= 0 else ():
            _check(plain_dataset(file, name, path), (k, n_body, *tail), dtype, path)
        tally = plain_dataset(file, "tally", path)
        _check(tally, (k,), schema.TALLY, path)
        contacts = plain_dataset(file, "contacts", path)
        _check(contacts, (contacts.shape[0] if contacts.ndim == 1 else -1,), EVENT, path)
        end, tail = (read_integer(file, name, path) for name in (schema.END_STEP, schema.TAIL))
        return Part(
            path=path, first=first, t=t, step=step, n_contact=len(contacts), files=files, end=end,
            tail=bool(tail),
        )  # fmt: skip


def _check(dataset: h5py.Dataset, shape: tuple[int, ...], dtype: np.dtype[Any], path: Path) -> None:
    if dataset.shape != shape or dataset.dtype != dtype:
        said = f"is {dataset.shape} of {dataset.dtype}, expected {shape} of {dtype}"
        if dtype.names and dataset.shape == shape:  # they would fill a screen
            said = "has other columns"
        raise ResultsError(f"{path}: '{dataset.name}' {said}: {schema.FOREIGN}")
