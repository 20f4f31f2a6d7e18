"""Recorder of a run: frames and contact records in write-once files (parts), and the index for ParaView.

A part is renamed into place once it is complete on the disk; then the index over all parts is replaced in the
same way. A thread of their own does both while the run goes on, one part at a time, so that memory stays
bounded. If the run is killed at any time, every part stays readable, and what was recorded since the last one
is lost.
"""

import threading
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
from ryusa.model import Scene, State, Tally
from ryusa.results import schema
from ryusa.results.scene_file import write_scene
from ryusa.running.checkpoint import CheckpointBlock
from ryusa.running.disk import disk_errors, free_bytes, hdf5_file, write_atomically
from ryusa.running.folder import write_json
from ryusa.running.record_buffer import RecordBuffer
from ryusa.running.vtkhdf import PartSize, write_bed, write_hdf5, write_index, write_points
from ryusa.water.protocol import Fluid

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
        self.folder = folder
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
        self._buffer = RecordBuffer(self.first_scene)
        self._writing: _PartBeingWritten | None = None
        self._failed = False  # the last attempt to write
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

    def frame(
        self,
        state: State,
        tally: Tally,
        water: Fluid | None = None,
        travel: NDArray[np.float64] | None = None,
        placed: Scene | None = None,
    ) -> None:
        """Add a frame to the buffer, as copies of its arrays.

        Parameters
        ----------
        water : where a column or a row of columns is solved.
        travel : of walls that servos press [m], shape (n_wall,), where there are some.
        placed : then the scene with these walls where they are, which gives contact forces their directions.
        """
        self.n_frame += 1
        if self._verify_until is not None:
            self._compare(state)
            return
        self._buffer.frame(state, tally, water, travel, placed)

    def contacts(self, events: NDArray[np.void]) -> None:
        """Add contacts that ended to the buffer, dtype model.EVENT; the array is kept."""
        self.n_contact += len(events)
        if self._verify_until is None:
            self._buffer.contacts(events)

    def passages(self, rows: NDArray[np.void]) -> None:
        """Add grains that entered or left to the buffer, dtype model.PASSAGE."""
        if self._verify_until is None and len(rows):
            self._buffer.passages(rows)

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

    def flush_if_due(self, summary: Callable[[], Mapping[str, Any]] | None = None) -> bool:
        """Begin to write a part if the time since the last one or the size of the buffer requires it.

        Parameters
        ----------
        summary : numbers of the run so far, written as summary.json after the part.

        Returns
        -------
        begun : whether there was anything to write. After a failure it is written on return.

        Raises
        ------
        DiskFull, ResultsError : the part begun before could not be written; the buffer has its content again.
        """
        if self._failed:
            return self.flush()
        if self._writing is not None and not self._writing.is_alive():
            self.settle()
        now = self._clock()
        due = now - self._flushed >= flush_after(now - self._begun, len(self._parts))
        if not due and self.buffered < buffer_limit(len(self._parts)):
            return False
        self.settle()
        self._flushed = now
        if not self._buffer:
            return False
        self._writing = self._part(None if summary is None else summary())
        self._writing.start()
        return True

    def flush_if_large(self) -> None:
        """Wait for the part being written; write another if the buffer is too large for a checkpoint."""
        with suppress(DiskFull):
            self.settle()
            if self.buffered >= _BUFFER:
                self.flush()

    @property
    def buffered(self) -> int:
        """Size of the data of which no part has been begun [B]."""
        return self._buffer.nbytes

    def flush(self) -> bool:
        """Write the buffer as one part, then the index; returns when both are on the disk.

        Raises
        ------
        DiskFull, ResultsError : the disk is full or the folder does not exist. Earlier parts stay readable,
            and the buffer is kept for another attempt.
        """
        self.settle()
        self._flushed = self._clock()
        if self._buffer:
            self._writing = self._part()
            self._writing.run()
            self.settle()
        elif self._index_is_old:
            self.write_index()
            self._failed = False
        else:
            return False
        return True

    def settle(self) -> None:
        """Wait until the part being written is on the disk.

        Raises
        ------
        DiskFull, ResultsError : it could not be written; the buffer has its content again.
        """
        writing, self._writing = self._writing, None
        if writing is None:
            return
        if writing.is_alive():
            writing.join()
        self._failed = writing.error is not None
        if writing.error is not None:
            if not writing.complete:
                writing.content.extend(self._buffer.rows())
                self._buffer = writing.content
            raise writing.error

    def tail(self, events: NDArray[np.void]) -> None:
        """Write contacts of an unfinished stretch as a tail, to be replaced when the run is resumed."""
        if len(events) and self._verify_until is None:
            self.settle()
            self.contacts(events)
            self.write_part(self._buffer, self._end, tail=True)
            self.write_index()

    def to_block(self) -> CheckpointBlock:
        """State and buffer of the recorder, for a checkpoint."""
        about = {"n_frame": self.n_frame, "n_contact": self.n_contact, "end": self._end}
        about |= {"n_part": len(self._parts), "parts_end": self._parts[-1].end if self._parts else -1}
        return CheckpointBlock(about, self._buffer.rows() if self._buffer else {})

    def _part(self, summary: Mapping[str, Any] | None = None) -> "_PartBeingWritten":
        """Take the buffer out, to be written."""
        content, self._buffer = self._buffer, RecordBuffer(self.first_scene)
        return _PartBeingWritten(self, content, self._end, summary)

    def write_part(self, content: RecordBuffer, end: int, *, tail: bool = False) -> None:
        """Write one part; `end` is the step up to which all has been recorded."""
        part = PartSize(schema.part_name(len(self._parts)), content.n_frame, content.n_contact, end)
        n = self.first_scene.n_grain

        def fill(file: h5py.File) -> None:
            first = sum(one.n_frame for one in self._parts)
            file.attrs["format"], file.attrs["first_frame"] = schema.FORMAT, first
            file.attrs[schema.END_STEP], file.attrs[schema.TAIL] = end, int(tail)
            offsets = np.arange(first, first + part.n_frame, dtype=np.int64) * n
            file.create_dataset("point_offset", data=offsets)
            content.write(file)

        with disk_errors(self.folder):
            if free_bytes(self.folder) < content.nbytes + _RESERVE and not tail:
                raise DiskFull(
                    f"{self.folder}: the disk is almost full. Data written before remains readable"
                )
            write_atomically(self.folder / schema.PARTS / part.name, hdf5_file(fill))
        self._parts.append(part)
        self._index_is_old = True

    def write_index(self) -> None:
        """Write the index over all parts."""
        with disk_errors(self.folder):
            n = self.first_scene.n_grain
            clumps = self.first_scene.bodies is not None
            self._n_subindex = write_index(self.folder, self._parts, n, self._n_subindex, clumps)
        self._index_is_old = False

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
            self._buffer.extend(earlier.buffered)
        if self._parts:
            self.write_index()

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


class _PartBeingWritten(threading.Thread):
    """Writes a part, then the index, then the summary; what goes wrong is kept for the recorder."""

    def __init__(
        self, recorder: Recorder, content: RecordBuffer, end: int, summary: Mapping[str, Any] | None
    ) -> None:
        super().__init__(name="ryusa-recorder")
        self.content, self.error, self.complete = content, None, False
        self._recorder, self._end, self._summary = recorder, end, summary

    def run(self) -> None:
        """Write; called by `start` in a thread of its own."""
        try:
            self._recorder.write_part(self.content, self._end)
            self.complete = True
            self._recorder.write_index()
            if self._summary is not None:
                with suppress(DiskFull):
                    write_json(self._recorder.folder / schema.SUMMARY, self._summary)
        except BaseException as error:
            self.error = error


def _same_bed(a: Scene, b: Scene) -> bool:
    same = np.array_equal(a.fixed_active, b.fixed_active) and np.array_equal(a.plane_active, b.plane_active)
    return same and (
        a.walls is None
        or b.walls is None
        or (np.array_equal(a.walls.active, b.walls.active) and np.array_equal(a.walls.motion, b.walls.motion))
    )
