"""Recorder of a run: frames and contact records in write-once files (parts), and the index for ParaView.

A part is renamed into place once it is complete on the disk; then the index over all parts is replaced in the
same way. If the run is killed at any time, every part stays readable, and at most the data of the last
`flush_after` seconds is lost.
"""

import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ryusa.errors import CheckpointError, DiskFull
from ryusa.model import EVENT, Scene, State, Tally
from ryusa.results import schema
from ryusa.results.scene_file import write_scene
from ryusa.running.checkpoint import CheckpointBlock
from ryusa.running.contact_forces import contact_forces
from ryusa.running.disk import disk_errors, free_bytes
from ryusa.running.vtkhdf import PartSize, write_bed, write_hdf5, write_index, write_points
from ryusa.water.coupling import Coupling

_FLUSH_SOON = 2.0  # s between parts at the start of a run
_FLUSH_LATE = 60.0  # upper limit, while there are few parts
_FLUSH_SHARE = 0.01  # of the time since the start
_BUFFER = 64 << 20  # bytes buffered at most, while there are few parts
_FEW = 300  # parts; each further 100 double interval and size, which limits the number of files
_BUFFER_MOST = 1 << 28
_RESERVE = 8 << 20  # bytes of the disk left free for a last checkpoint, summary and provenance


def flush_after(elapsed: float, n_part: int) -> float:
    """Seconds between two parts, after `elapsed` seconds of running and `n_part` parts."""
    return min(max(_FLUSH_SOON, _FLUSH_SHARE * elapsed), _FLUSH_LATE) * _thinning(n_part)


def buffer_limit(n_part: int) -> float:
    """Bytes that may be buffered before they are written."""
    return min(_BUFFER * _thinning(n_part), _BUFFER_MOST)


def _thinning(n_part: int) -> float:
    return 2.0 ** (max(n_part - _FEW, 0) / 100)


def bytes_per_frame(n_grain: int) -> int:
    """Disk space of one frame [B]."""
    per_grain = sum(dtype.itemsize * tail[0] for dtype, tail in _shapes() if tail)
    return n_grain * per_grain + schema.TALLY.itemsize + 24


def _shapes() -> list[tuple[np.dtype[Any], tuple[int, ...]]]:
    return list(schema.FRAME_DATASETS.values())


@dataclass(frozen=True)
class RecordedSoFar:
    """Data that an earlier process of the same run recorded; the recorder continues from there.

    Attributes
    ----------
    parts : the parts on the disk, in order, without a tail.
    scenes : scenes up to the step of the resume, each with the time from which it is valid [s].
    n_frame, n_contact : recorded up to the step of the resume.
    end : that step.
    buffered : data buffered at that step and not yet in a part; empty where parts extend beyond it.
    verify_until : last step of the last part, where parts extend beyond the resume: up to that step the run
        recomputes what is on the disk already, and compares.
    last : the last frame on the disk by dataset, for that comparison.
    """

    parts: list[PartSize]
    scenes: list[tuple[float, Scene]]
    n_frame: int = 0
    n_contact: int = 0
    end: int = 0
    buffered: Mapping[str, NDArray[Any]] = field(default_factory=dict[str, NDArray[Any]])
    verify_until: int | None = None
    last: Mapping[str, NDArray[Any]] | None = None


class Recorder:
    """Buffers frames and contact records of one run and writes them to `folder`, which must exist."""

    def __init__(
        self,
        folder: Path,
        scene: Scene,
        *,
        clock: Callable[[], float] = time.monotonic,
        earlier: RecordedSoFar | None = None,
    ) -> None:
        self.folder, self.n_grain = folder, scene.n_grain
        self.n_frame = 0  # frames recorded so far
        self.n_contact = 0
        self._clock, self._begun = clock, clock()
        self._flushed = self._begun
        self._parts: list[PartSize] = []
        self._index_is_old = False
        self._n_subindex = 0  # sub-indices that this process wrote
        self.first_scene = scene if earlier is None else earlier.scenes[0][1]
        self._end = 0  # step up to which all is buffered or written
        self._n_scene = 0
        self._scenes: list[tuple[float, Scene]] = []  # scenes that differ in the visible bed
        self._count = 0  # frames in the buffer
        self._buffer = self._room(16)
        self._tally: list[tuple[float, ...]] = []
        self._contacts: list[NDArray[np.void]] = []
        self._n_buffered_contacts = 0  # contacts in the buffer
        self._forces: list[NDArray[np.void]] | None = (
            [] if scene.forces else None
        )  # of each frame in the buffer
        self._water: dict[str, list[NDArray[np.float64]]] = {}
        self._verify_until: int | None = None
        self._earlier: RecordedSoFar | None = None
        (folder / schema.PARTS).mkdir(exist_ok=True)
        with disk_errors(folder):
            write_points(folder / schema.PARTS, scene)
            if earlier is None:
                self.scene(scene, 0, 0.0)
            else:
                self._continue_from(earlier)

    def scene(self, scene: Scene, step: int, t: float) -> bool:
        """Write the scene that is valid from `step`, time `t` [s], on; may be repeated after a full disk."""

        def fill(file: h5py.File) -> None:
            write_scene(file, scene, step, t)

        with disk_errors(self.folder):
            write_hdf5(self.folder / schema.PARTS / schema.scene_name(self._n_scene), fill)
            shown = self._shown(t, scene)
            if shown is not self._scenes:
                write_bed(self.folder / schema.BED, shown)
        self._scenes, self._n_scene = shown, self._n_scene + 1
        return True

    def frame(self, state: State, tally: Tally, water: Coupling | None = None) -> None:
        """Add a frame to the buffer, as copies of its arrays; with `water` where a column is solved."""
        self.n_frame += 1
        if self._verify_until is not None:
            self._compare(state)
            return
        if water is not None:
            profiles = {**vars(water.state), "phi": water.phi}
            for name in (*schema.WATER_CELLS, *schema.WATER_FACES, *schema.WATER_NUMBERS):
                self._water.setdefault(name, []).append(np.array(profiles[name]))
        while self._count == len(self._buffer["t"]):
            self._grow()
        row, k = self._buffer, self._count
        row["t"][k], row["step"][k] = state.t, state.step
        row["x"][k], row["v"][k], row["omega"][k] = state.x, state.v, state.omega
        if len(state.image):
            row["image"][k] = state.image
        if self._forces is not None:
            self._forces.append(contact_forces(state, self.first_scene))
        self._tally.append(schema.tally_row(tally))
        self._count += 1

    def contacts(self, events: NDArray[np.void]) -> None:
        """Add contacts that ended to the buffer, dtype model.EVENT."""
        self.n_contact += len(events)
        if len(events) and self._verify_until is None:
            self._contacts.append(np.array(events, dtype=EVENT))
            self._n_buffered_contacts += len(events)

    def reached(self, step: int) -> None:
        """Note that all frames and contacts up to `step` have been added.

        Raises
        ------
        CheckpointError : the parts on the disk up to this step differ from this run.
        """
        self._end = step
        if self._verify_until is None or step < self._verify_until:
            return
        there = sum(part.n_frame for part in self._parts), sum(part.n_contact for part in self._parts)
        if step > self._verify_until or there != (self.n_frame, self.n_contact):
            raise CheckpointError(
                f"{self.folder}: the resumed run gave {self.n_frame} frames and {self.n_contact} contacts up "
                f"to step {step}, but the folder holds {there[0]} and {there[1]} up to step "
                f"{self._verify_until}: it is not the same run; to discard it and start again, use "
                "--overwrite"
            )
        self._verify_until = None

    def flush_if_due(self) -> bool:
        """Write a part if the time since the last one or the size of the buffer requires it."""
        now = self._clock()
        due = now - self._flushed >= flush_after(now - self._begun, len(self._parts))
        if due or self.buffered >= buffer_limit(len(self._parts)):
            return self.flush()
        return False

    def flush_if_large(self) -> None:
        """Write a part if the buffer is too large to be stored in a checkpoint."""
        if self.buffered >= _BUFFER:
            with suppress(DiskFull):
                self.flush()

    @property
    def buffered(self) -> int:
        """Size of the data that is not yet in a part [B]."""
        forces = sum(one.nbytes for one in self._forces or ())
        frames = self._count * bytes_per_frame(self.n_grain)
        return frames + forces + self._n_buffered_contacts * EVENT.itemsize

    def flush(self) -> bool:
        """Write the buffer as one part, then the index.

        Raises
        ------
        DiskFull, ResultsError : the disk is full or the folder does not exist. Earlier parts stay readable,
            and the buffer is kept for another attempt.
        """
        self._flushed = self._clock()
        if self._count or self._n_buffered_contacts:
            self._write_part()
            self._count, self._n_buffered_contacts = 0, 0
            self._tally, self._contacts, self._water = [], [], {}
            self._forces = None if self._forces is None else []
        elif not self._index_is_old:
            return False
        self._write_index()
        self._index_is_old = False
        return True

    def tail(self, events: NDArray[np.void]) -> None:
        """Write contacts of an unfinished stretch as a tail, to be replaced when the run is resumed."""
        if len(events) and self._verify_until is None:
            self.contacts(events)
            self._write_part(tail=True)
            self._write_index()

    def to_block(self) -> CheckpointBlock:
        """State and buffer of the recorder, for a checkpoint."""
        about = {"n_frame": self.n_frame, "n_contact": self.n_contact, "end": self._end}
        about |= {"n_part": len(self._parts), "parts_end": self._parts[-1].end if self._parts else -1}
        return CheckpointBlock(about, self._rows() if self.buffered else {})

    def _write_part(self, *, tail: bool = False) -> None:
        part = PartSize(schema.part_name(len(self._parts)), self._count, self._n_buffered_contacts, self._end)

        def fill(file: h5py.File) -> None:
            first = sum(one.n_frame for one in self._parts)
            file.attrs["format"], file.attrs["first_frame"] = schema.FORMAT, first
            file.attrs[schema.END_STEP], file.attrs[schema.TAIL] = self._end, int(tail)
            offsets = np.arange(first, first + part.n_frame, dtype=np.int64) * self.n_grain
            file.create_dataset("point_offset", data=offsets)
            for name, rows in self._rows().items():
                file.create_dataset(name, data=rows)

        with disk_errors(self.folder):
            if free_bytes(self.folder) < self.buffered + _RESERVE and not tail:
                raise DiskFull(
                    f"{self.folder}: the disk is almost full. Data written before remains readable"
                )
            write_hdf5(self.folder / schema.PARTS / part.name, fill)
        self._parts.append(part)
        self._index_is_old = True

    def _write_index(self) -> None:
        with disk_errors(self.folder):
            self._n_subindex = write_index(self.folder, self._parts, self.n_grain, self._n_subindex)

    def _rows(self) -> dict[str, NDArray[Any]]:
        """Content of the buffer, by dataset of a part."""
        rows: dict[str, NDArray[Any]] = {name: self._buffer[name][: self._count] for name in self._buffer}
        rows["tally"] = np.array(self._tally, dtype=schema.TALLY)
        rows["contacts"] = np.concatenate(self._contacts) if self._contacts else np.zeros(0, dtype=EVENT)
        if self._forces is not None:
            rows[schema.N_FORCE] = np.array([len(one) for one in self._forces], dtype=np.int64)
            rows[schema.FORCES] = np.concatenate([np.zeros(0, dtype=schema.FORCE), *self._forces])
        return rows | {f"{schema.WATER}/{name}": np.array(one) for name, one in self._water.items()}

    def _continue_from(self, earlier: RecordedSoFar) -> None:
        """Take over the state of an earlier process."""
        self._earlier, self._parts = earlier, list(earlier.parts)
        self._verify_until = earlier.verify_until
        self.n_frame, self.n_contact = earlier.n_frame, earlier.n_contact
        self._n_scene, self._end = len(earlier.scenes), earlier.end
        for t, scene in earlier.scenes:
            self._scenes = self._shown(t, scene)
        write_bed(self.folder / schema.BED, self._scenes)
        if earlier.buffered:
            self._take_rows(earlier.buffered)
        if self._parts:
            self._write_index()

    def _take_rows(self, buffered: Mapping[str, NDArray[Any]]) -> None:
        self._count = len(buffered["t"])
        while self._count > len(self._buffer["t"]):
            self._grow()
        for name, rows in self._buffer.items():
            rows[: self._count] = buffered[name]
        self._tally = buffered["tally"].tolist()
        self._contacts, self._n_buffered_contacts = [buffered["contacts"]], len(buffered["contacts"])
        if self._forces is not None:
            ends = np.cumsum(buffered[schema.N_FORCE])
            self._forces = np.split(buffered[schema.FORCES], ends[:-1]) if self._count else []
        begin = f"{schema.WATER}/"
        for name, rows in buffered.items():
            if name.startswith(begin):
                self._water[name.removeprefix(begin)] = list(rows)

    def _compare(self, state: State) -> None:
        """Compare the last frame on the disk with the recomputed one."""
        last = self._earlier.last if self._earlier is not None else None
        if last is None or state.step != int(last["step"]):
            return
        for name in ("x", "v", "omega"):
            if not np.array_equal(last[name], getattr(state, name), equal_nan=True):
                raise CheckpointError(
                    f"{self.folder}: the recomputed frame at step {state.step} differs from the one on the "
                    "disk: it is not the same run. To discard it and start again, use --overwrite"
                )

    def _shown(self, t: float, scene: Scene) -> list[tuple[float, Scene]]:
        """Scenes that differ in the visible bed, with this one if it does."""
        if self._scenes and _same_bed(self._scenes[-1][1], scene):
            return self._scenes
        return [*self._scenes, (t, scene)]

    def _room(self, k: int) -> dict[str, NDArray[Any]]:
        return {
            name: np.zeros((k, self.n_grain, *tail) if name in schema.PER_GRAIN else (k,), dtype=dtype)
            for name, (dtype, tail) in schema.FRAME_DATASETS.items()
        }

    def _grow(self) -> None:
        wider = self._room(2 * len(self._buffer["t"]))
        for name, rows in self._buffer.items():
            wider[name][: len(rows)] = rows
        self._buffer = wider


def _same_bed(a: Scene, b: Scene) -> bool:
    return np.array_equal(a.fixed_active, b.fixed_active) and np.array_equal(a.plane_active, b.plane_active)
