"""Writes a run folder: frames and contact events in write-once parts, and the index that ParaView opens.

A part appears by a rename once it lies whole on the disk, then the index over all parts is replaced the same
way. Whatever kills the run, and whenever, every part that was flushed stays readable; what is lost is at most
what had gathered since: `flush_after` seconds.
"""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.model import EVENT, Scene, State, Tally
from ryusa.results import schema
from ryusa.results.scene_file import write_scene
from ryusa.running.vtkhdf import PartSize, write_atomic, write_bed, write_index, write_points
from ryusa.water.coupling import Coupling

_FLUSH_SOON = 2.0  # s between parts at the start
_FLUSH_LATE = 60.0  # and at most, while there are few
_FLUSH_SHARE = 0.01  # of the time since the start
_BUFFER = 64 << 20  # bytes gathered at most, while there are few parts
_FEW = 300  # parts; every 100 more double time and size, so that a reader never has too many files to open
_BUFFER_MOST = 1 << 30


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


class Recorder:
    """Gathers frames and contact events of one run and writes them to `folder`, which must exist."""

    def __init__(self, folder: Path, scene: Scene, *, clock: Callable[[], float] = time.monotonic) -> None:
        self.folder, self.n_grain = folder, scene.n_grain
        self.n_frame = 0  # recorded so far
        self.n_contact = 0
        self._clock, self._begun = clock, clock()
        self._flushed = self._begun
        self._parts: list[PartSize] = []
        self._n_scene = 0
        self._scenes: list[tuple[float, Scene]] = []  # those that show another bed
        self._count = 0  # frames in the buffer
        self._buffer = self._room(16)
        self._tally: list[tuple[float, ...]] = []
        self._contacts: list[NDArray[np.void]] = []
        self._waiting = 0  # contacts in the buffer
        self._water: dict[str, list[NDArray[np.float64]]] = {}
        (folder / schema.PARTS).mkdir(exist_ok=True)
        with _disk(folder):
            write_points(folder / schema.PARTS, scene)
        self.scene(scene, 0, 0.0)

    def scene(self, scene: Scene, step: int, t: float) -> None:
        """Write the scene that holds from `step`, time `t` [s], on."""

        def fill(file: h5py.File) -> None:
            write_scene(file, scene, step, t)

        with _disk(self.folder):
            write_atomic(self.folder / schema.PARTS / schema.scene_name(self._n_scene), fill)
            self._n_scene += 1
            if self._scenes and _same_bed(self._scenes[-1][1], scene):
                return
            self._scenes.append((t, scene))
            write_bed(self.folder / schema.BED, self._scenes)

    def frame(self, state: State, tally: Tally, water: Coupling | None = None) -> None:
        """Keep a frame; its arrays are copied. `water` where a column of it is solved."""
        if water is not None:
            profiles = {**vars(water.state), "phi": water.phi}
            for name in (*schema.WATER_CELLS, *schema.WATER_FACES, *schema.WATER_NUMBERS):
                self._water.setdefault(name, []).append(np.array(profiles[name]))
        if self._count == len(self._buffer["t"]):
            self._grow()
        row, k = self._buffer, self._count
        row["t"][k], row["step"][k] = state.t, state.step
        row["x"][k], row["v"][k], row["omega"][k] = state.x, state.v, state.omega
        if len(state.image):
            row["image"][k] = state.image
        self._tally.append(schema.tally_row(tally))
        self._count += 1
        self.n_frame += 1

    def contacts(self, events: NDArray[np.void]) -> None:
        """Keep contacts that ended, dtype model.EVENT."""
        if len(events):
            self._contacts.append(np.array(events, dtype=EVENT))
            self._waiting += len(events)
            self.n_contact += len(events)

    def flush_if_due(self) -> bool:
        """Write a part when enough time has passed or enough has gathered."""
        now = self._clock()
        held = self._count * bytes_per_frame(self.n_grain) + self._waiting * EVENT.itemsize
        due = now - self._flushed >= flush_after(now - self._begun, len(self._parts))
        if due or held >= buffer_limit(len(self._parts)):
            return self.flush()
        return False

    def flush(self) -> bool:
        """Write what has gathered as one part, then the index.

        Raises
        ------
        ResultsError : the disk is full or the folder is gone; parts written before stay readable.
        """
        self._flushed = self._clock()
        if self._count == 0 and self._waiting == 0:
            return False
        part = PartSize(schema.part_name(len(self._parts)), self._count, self._waiting)
        with _disk(self.folder):
            write_atomic(self.folder / schema.PARTS / part.name, self._fill)
            self._parts.append(part)
            self._count, self._waiting = 0, 0
            self._tally, self._contacts, self._water = [], [], {}
            write_index(self.folder, self._parts, self.n_grain)
        return True

    def _fill(self, file: h5py.File) -> None:
        k, first = self._count, self.n_frame - self._count
        file.attrs["format"], file.attrs["first_frame"] = schema.FORMAT, first
        for name in schema.FRAME_DATASETS:
            file.create_dataset(name, data=self._buffer[name][:k])
        file.create_dataset("point_offset", data=np.arange(first, first + k, dtype=np.int64) * self.n_grain)
        file.create_dataset("tally", data=np.array(self._tally, dtype=schema.TALLY))
        rows = np.concatenate(self._contacts) if self._contacts else np.zeros(0, dtype=EVENT)
        file.create_dataset("contacts", data=rows)
        for name, profiles in self._water.items():
            file.create_dataset(f"{schema.WATER}/{name}", data=np.array(profiles))

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


class _disk:
    """Turns what the disk says into a ResultsError that names the folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if isinstance(error, OSError) or (isinstance(error, RuntimeError) and "HDF5" in str(error)):
            raise ResultsError(
                f"{self.folder}: cannot be written ({error}). What was written before stays readable"
            ) from error
