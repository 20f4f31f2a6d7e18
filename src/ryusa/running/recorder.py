"""Writes a run folder: frames and contact events in write-once parts, and the index that ParaView opens.

A part appears by a rename once it lies whole on the disk, then the index over all parts is replaced the same
way. Whatever kills the run, and whenever, every part that was flushed stays readable; what is lost is at most
what had gathered since: `flush_after` seconds.
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
from ryusa.running.checkpoint import Kept
from ryusa.running.disk import disk, free_bytes
from ryusa.running.vtkhdf import PartSize, write_atomic, write_bed, write_index, write_points
from ryusa.water.coupling import Coupling

_FLUSH_SOON = 2.0  # s between parts at the start
_FLUSH_LATE = 60.0  # and at most, while there are few
_FLUSH_SHARE = 0.01  # of the time since the start
_BUFFER = 64 << 20  # bytes gathered at most, while there are few parts
_FEW = 300  # parts; every 100 more double time and size, so that a reader never has too many files to open
_BUFFER_MOST = 1 << 28
_RESERVE = 8 << 20  # bytes of the disk left free, so that a checkpoint and the last words still fit


def flush_after(elapsed: float, n_part: int) -> float:
    """Seconds between two parts, after `elapsed` seconds of running and `n_part` parts."""
    return min(max(_FLUSH_SOON, _FLUSH_SHARE * elapsed), _FLUSH_LATE) * _thinning(n_part)


def buffer_limit(n_part: int) -> float:
    """Bytes that may gather before they are written."""
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
class Left:
    """What an earlier process of the same run left behind; the recorder goes on from there.

    Attributes
    ----------
    parts : the parts on the disk, in order, without a tail.
    scenes : scenes that hold up to where the run goes on, with the time from which each does [s].
    n_frame, n_contact : recorded up to where the run goes on.
    end : step up to which that is.
    waiting : what had gathered there and is in no part; empty where parts reach further.
    quiet_until : step at which the last part ends, where parts reach further than where the run goes on:
        until then the run makes again what the disk already has.
    last : the last frame on the disk by dataset, with which that one is compared.
    """

    parts: list[PartSize]
    scenes: list[tuple[float, Scene]]
    n_frame: int = 0
    n_contact: int = 0
    end: int = 0
    waiting: Mapping[str, NDArray[Any]] = field(default_factory=dict[str, NDArray[Any]])
    quiet_until: int | None = None
    last: Mapping[str, NDArray[Any]] | None = None


class Recorder:
    """Gathers frames and contact events of one run and writes them to `folder`, which must exist."""

    def __init__(
        self,
        folder: Path,
        scene: Scene,
        *,
        clock: Callable[[], float] = time.monotonic,
        left: Left | None = None,
    ) -> None:
        self.folder, self.n_grain = folder, scene.n_grain
        self.n_frame = 0  # recorded so far
        self.n_contact = 0
        self._clock, self._begun = clock, clock()
        self._flushed = self._begun
        self._parts: list[PartSize] = []
        self._index_is_old = False
        self._shelved = 0  # shelves of the index that this process wrote
        self.first_scene = scene if left is None else left.scenes[0][1]
        self._end = 0  # step up to which all is gathered or written
        self._n_scene = 0
        self._scenes: list[tuple[float, Scene]] = []  # those that show another bed
        self._count = 0  # frames in the buffer
        self._buffer = self._room(16)
        self._tally: list[tuple[float, ...]] = []
        self._contacts: list[NDArray[np.void]] = []
        self._waiting = 0  # contacts in the buffer
        self._water: dict[str, list[NDArray[np.float64]]] = {}
        self._quiet_until: int | None = None
        self._left: Left | None = None
        (folder / schema.PARTS).mkdir(exist_ok=True)
        with disk(folder):
            write_points(folder / schema.PARTS, scene)
            if left is None:
                self.scene(scene, 0, 0.0)
            else:
                self._take_over(left)

    def scene(self, scene: Scene, step: int, t: float) -> bool:
        """Write the scene that holds from `step`, time `t` [s], on; asked again where the disk was full."""

        def fill(file: h5py.File) -> None:
            write_scene(file, scene, step, t)

        with disk(self.folder):
            write_atomic(self.folder / schema.PARTS / schema.scene_name(self._n_scene), fill)
            shown = self._shown(t, scene)
            if shown is not self._scenes:
                write_bed(self.folder / schema.BED, shown)
        self._scenes, self._n_scene = shown, self._n_scene + 1
        return True

    def frame(self, state: State, tally: Tally, water: Coupling | None = None) -> None:
        """Keep a frame; its arrays are copied. `water` where a column of it is solved."""
        self.n_frame += 1
        if self._quiet_until is not None:
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
        self._tally.append(schema.tally_row(tally))
        self._count += 1

    def contacts(self, events: NDArray[np.void]) -> None:
        """Keep contacts that ended, dtype model.EVENT."""
        self.n_contact += len(events)
        if len(events) and self._quiet_until is None:
            self._contacts.append(np.array(events, dtype=EVENT))
            self._waiting += len(events)

    def reached(self, step: int) -> None:
        """All frames and contacts up to `step` have been handed over.

        Raises
        ------
        CheckpointError : the parts on the disk, which end here, are not what this run made.
        """
        self._end = step
        if self._quiet_until is None or step < self._quiet_until:
            return
        there = sum(part.n_frame for part in self._parts), sum(part.n_contact for part in self._parts)
        if step > self._quiet_until or there != (self.n_frame, self.n_contact):
            raise CheckpointError(
                f"{self.folder}: going on gave {self.n_frame} frames and {self.n_contact} contacts up to "
                f"step {step}, but {there[0]} and {there[1]} are there up to step {self._quiet_until}. "
                "It is not the same run; --overwrite begins anew"
            )
        self._quiet_until = None

    def flush_if_due(self) -> bool:
        """Write a part when enough time has passed or enough has gathered."""
        now = self._clock()
        due = now - self._flushed >= flush_after(now - self._begun, len(self._parts))
        if due or self.held >= buffer_limit(len(self._parts)):
            return self.flush()
        return False

    def flush_if_large(self) -> None:
        """Write a part where so much has gathered that a checkpoint should not carry it."""
        if self.held >= _BUFFER:
            with suppress(DiskFull):
                self.flush()

    @property
    def held(self) -> int:
        """What has gathered and is in no part yet [B]."""
        return self._count * bytes_per_frame(self.n_grain) + self._waiting * EVENT.itemsize

    def flush(self) -> bool:
        """Write what has gathered as one part, then the index.

        Raises
        ------
        DiskFull, ResultsError : the disk is full or the folder is gone. Parts written before stay readable,
            and what has gathered is kept for another try.
        """
        self._flushed = self._clock()
        if self._count or self._waiting:
            self._write_part()
            self._count, self._waiting = 0, 0
            self._tally, self._contacts, self._water = [], [], {}
        elif not self._index_is_old:
            return False
        self._write_index()
        self._index_is_old = False
        return True

    def tail(self, events: NDArray[np.void]) -> None:
        """Write contacts of a stretch that was not finished; going on puts the next part in its place."""
        if len(events) and self._quiet_until is None:
            self.contacts(events)
            self._write_part(tail=True)
            self._write_index()

    def kept(self) -> Kept:
        """Where the recorder stands, and what has gathered, for a checkpoint."""
        about = {"n_frame": self.n_frame, "n_contact": self.n_contact, "end": self._end}
        about |= {"n_part": len(self._parts), "parts_end": self._parts[-1].end if self._parts else -1}
        return Kept(about, self._rows() if self.held else {})

    def _write_part(self, *, tail: bool = False) -> None:
        part = PartSize(schema.part_name(len(self._parts)), self._count, self._waiting, self._end)

        def fill(file: h5py.File) -> None:
            first = sum(one.n_frame for one in self._parts)
            file.attrs["format"], file.attrs["first_frame"] = schema.FORMAT, first
            file.attrs[schema.END_STEP], file.attrs[schema.TAIL] = self._end, int(tail)
            offsets = np.arange(first, first + part.n_frame, dtype=np.int64) * self.n_grain
            file.create_dataset("point_offset", data=offsets)
            for name, rows in self._rows().items():
                file.create_dataset(name, data=rows)

        with disk(self.folder):
            if free_bytes(self.folder) < self.held + _RESERVE and not tail:
                raise DiskFull(f"{self.folder}: nearly no room is left. What was written stays readable")
            write_atomic(self.folder / schema.PARTS / part.name, fill)
        self._parts.append(part)
        self._index_is_old = True

    def _write_index(self) -> None:
        with disk(self.folder):
            self._shelved = write_index(self.folder, self._parts, self.n_grain, self._shelved)

    def _rows(self) -> dict[str, NDArray[Any]]:
        """What has gathered, by dataset of a part."""
        rows: dict[str, NDArray[Any]] = {name: self._buffer[name][: self._count] for name in self._buffer}
        rows["tally"] = np.array(self._tally, dtype=schema.TALLY)
        rows["contacts"] = np.concatenate(self._contacts) if self._contacts else np.zeros(0, dtype=EVENT)
        return rows | {f"{schema.WATER}/{name}": np.array(one) for name, one in self._water.items()}

    def _take_over(self, left: Left) -> None:
        """Stand where an earlier process stood."""
        self._left, self._parts = left, list(left.parts)
        self._quiet_until = left.quiet_until
        self.n_frame, self.n_contact = left.n_frame, left.n_contact
        self._n_scene, self._end = len(left.scenes), left.end
        for t, scene in left.scenes:
            self._scenes = self._shown(t, scene)
        write_bed(self.folder / schema.BED, self._scenes)
        if left.waiting:
            self._take_rows(left.waiting)
        if self._parts:
            self._write_index()

    def _take_rows(self, waiting: Mapping[str, NDArray[Any]]) -> None:
        self._count = len(waiting["t"])
        while self._count > len(self._buffer["t"]):
            self._grow()
        for name, rows in self._buffer.items():
            rows[: self._count] = waiting[name]
        self._tally = waiting["tally"].tolist()
        self._contacts, self._waiting = [waiting["contacts"]], len(waiting["contacts"])
        begin = f"{schema.WATER}/"
        for name, rows in waiting.items():
            if name.startswith(begin):
                self._water[name.removeprefix(begin)] = list(rows)

    def _compare(self, state: State) -> None:
        """Hold the last frame on the disk against the same one, made again."""
        last = self._left.last if self._left is not None else None
        if last is None or state.step != int(last["step"]):
            return
        for name in ("x", "v", "omega"):
            if not np.array_equal(last[name], getattr(state, name), equal_nan=True):
                raise CheckpointError(
                    f"{self.folder}: the frame at step {state.step}, made again, is not the one that is "
                    "there. It is not the same run; --overwrite begins anew"
                )

    def _shown(self, t: float, scene: Scene) -> list[tuple[float, Scene]]:
        """Scenes that show another bed than the one before, with this one if it does."""
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
