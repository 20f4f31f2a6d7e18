"""Frames of one quantity over all parts of a run, read from the disk when they are indexed."""

import math
from bisect import bisect_right
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.model import EVENT, PASSAGE
from ryusa.results import schema
from ryusa.results.hdf5 import DAMAGE, OpenFiles, opened, plain_dataset, read_dataset

AHEAD = 1 << 16  # bytes of small frames that are read together, for most are read one after another


@dataclass(frozen=True)
class Part:
    """One write-once file with the frames first to first + n_frame - 1."""

    path: Path
    first: int
    t: NDArray[np.float64]
    step: NDArray[np.int64]
    n_contact: int
    files: OpenFiles  # shared by all parts of a run
    end: int  # step up to which this and earlier parts are complete
    tail: bool = False  # holds contacts of an incomplete part, which a resumed run writes again

    @property
    def n_frame(self) -> int:
        """Number of frames in this part."""
        return len(self.t)

    def rows(self, name: str, begin: int, end: int, grains: Any) -> NDArray[Any]:
        """Read frames begin to end - 1, counted within this part, of one grain or a slice of grains."""
        try:
            return self.files.dataset(self.path, name)[begin:end, grains]
        except DAMAGE as error:
            raise ResultsError(f"{self.path}: '{name}' cannot be read ({error})") from error

    def forces(self, k: int) -> NDArray[np.void] | None:
        """Read the contact forces of frame k, counted within this part; None where they were not recorded."""
        with opened(self.path) as file:
            if schema.N_FORCE not in file:
                return None
            ends = np.cumsum(read_dataset(file, schema.N_FORCE, self.path))
            rows = plain_dataset(file, schema.FORCES, self.path)
            if ends.shape != (self.n_frame,) or rows.shape != (ends[-1],) or rows.dtype != schema.FORCE:
                raise ResultsError(f"{self.path}: '{schema.FORCES}' does not match its frames")
            try:
                return rows[ends[k - 1] if k else 0 : ends[k]]
            except DAMAGE as error:
                raise ResultsError(f"{self.path}: '{schema.FORCES}' cannot be read ({error})") from error

    def of_walls(self, name: str, shape: tuple[int, ...]) -> NDArray[np.float64]:
        """Read a dataset of walls, schema.WALLS or schema.TRAVEL, (n_frame, *shape)."""
        with opened(self.path) as file:
            found = read_dataset(file, name, self.path)
        if found.shape != (self.n_frame, *shape) or found.dtype != np.float64:
            raise ResultsError(f"{self.path}: '{name}' does not match its frames: {schema.FOREIGN}")
        return found

    def contacts(self) -> NDArray[np.void]:
        """Read all contacts of this part, dtype model.EVENT."""
        with opened(self.path) as file:
            return read_dataset(file, "contacts", self.path).astype(EVENT, copy=False)

    def passages(self) -> NDArray[np.void]:
        """Read the grains that entered and left during this part, dtype PASSAGE."""
        with opened(self.path) as file:
            rows = read_dataset(file, schema.PASSAGES, self.path)
            if rows.dtype != PASSAGE or rows.ndim != 1:
                raise ResultsError(f"{self.path}: '{schema.PASSAGES}' has other columns: {schema.FOREIGN}")
            return rows

    def tally(self) -> NDArray[np.void]:
        """Read the energy account at each frame of this part."""
        with opened(self.path) as file:
            return read_dataset(file, "tally", self.path)


class LazyFrames:
    """An array of shape (n_frame, n_grain, n) that is read from the disk when indexed; results are read-only.

    The first index may be a number, a slice or a list of frames, the second a number or a slice of grains:
    only these are read. `numpy.asarray` reads all.
    """

    def __init__(
        self, parts: list[Part], name: str, n_grain: int, lift: NDArray[np.float64] | None = None
    ) -> None:
        dtype, tail = (schema.FRAME_DATASETS | schema.BODY_DATASETS)[name]
        n_frame = parts[-1].first + parts[-1].n_frame if parts else 0
        self.shape: tuple[int, ...] = (n_frame, n_grain, *tail)
        self.dtype: np.dtype[Any] = dtype
        self._parts, self._name, self._lift = parts, name, lift
        self._starts = [part.first for part in parts]
        self._held: tuple[int, NDArray[Any]] = (0, np.zeros(0, dtype))  # frames read ahead, from which on
        self._together = AHEAD // max(dtype.itemsize * math.prod(self.shape[1:]), 1)

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return len(self.shape)

    def __len__(self) -> int:
        return self.shape[0]

    def __iter__(self) -> Iterator[NDArray[Any]]:
        return (self[k] for k in range(len(self)))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.asarray(self[:], dtype=dtype)

    def __getitem__(self, key: Any) -> NDArray[Any]:
        keys = key if isinstance(key, tuple) else (key,)
        if Ellipsis in [k for k in keys if not isinstance(k, np.ndarray)]:
            at = next(i for i, k in enumerate(keys) if k is Ellipsis)
            keys = keys[:at] + (slice(None),) * (self.ndim - len(keys) + 1) + keys[at + 1 :]
        frames, rest = keys[0], keys[1:]
        grains, rest = self._grains(rest)
        if isinstance(frames, int | np.integer):
            found = self._one(range(len(self))[int(frames)], grains)
            found = found[rest] if rest else found
        else:
            found = self._frames(frames, grains)
            found = found[(slice(None), *rest)] if rest else found
        found = np.asarray(found)
        found.flags.writeable = False
        return found

    def _grains(self, rest: tuple[Any, ...]) -> tuple[Any, tuple[Any, ...]]:
        """Part of the grain index to apply while reading, and the part to apply in memory."""
        if not rest:
            return slice(None), ()
        grains = rest[0]
        if isinstance(grains, int | np.integer):
            return range(self.shape[1])[int(grains)], rest[1:]
        if isinstance(grains, slice) and (grains.step is None or grains.step > 0):
            return grains, (slice(None), *rest[1:])
        return slice(None), rest

    def _frames(self, frames: Any, grains: Any) -> NDArray[Any]:
        if isinstance(frames, slice):
            wanted = range(len(self))[frames]
            if wanted.step == 1 or len(wanted) == 0:
                return self._read(wanted.start, len(wanted), grains)
            chosen = np.arange(wanted.start, wanted.stop, wanted.step)
        else:
            chosen = np.asarray(frames)
            if chosen.dtype == np.bool_:
                if chosen.shape != (len(self),):
                    raise IndexError(f"a mask of {len(self)} frames is needed, got shape {chosen.shape}")
                chosen = np.flatnonzero(chosen)
            if chosen.ndim != 1 or (len(chosen) and not np.issubdtype(chosen.dtype, np.integer)):
                raise IndexError("frames are chosen by a number, a slice, a list of numbers or a mask")
            if len(chosen) and (chosen.min() < -len(self) or chosen.max() >= len(self)):
                raise IndexError(f"frame out of range: there are {len(self)}")
            chosen = np.where(chosen < 0, chosen + len(self), chosen)
        if len(chosen) == 0:
            return self._read(0, 0, grains)
        low, high = int(chosen.min()), int(chosen.max()) + 1
        if high - low <= 2 * len(chosen):  # most of the range: one read is faster than many small ones
            return self._read(low, high - low, grains)[chosen - low]
        return np.concatenate([self._read(int(k), 1, grains) for k in chosen])

    def _one(self, k: int, grains: Any) -> NDArray[Any]:
        """Frame k; where frames are small, with its neighbours in the same part, which are kept."""
        if self._together < 2 or grains != slice(None):
            return self._read(k, 1, grains)[0]
        begin, held = self._held
        if not begin <= k < begin + len(held):
            part = self._parts[bisect_right(self._starts, k) - 1]
            begin = max(part.first, k - k % self._together)
            end = min(part.first + part.n_frame, k - k % self._together + self._together)
            try:
                held = self._read(begin, end - begin, grains)
            except ResultsError:  # damage beside it
                return self._read(k, 1, grains)[0]
            self._held = (begin, held)
        return held[k - begin]

    def _read(self, begin: int, count: int, grains: Any) -> NDArray[Any]:
        """Read frames begin to begin + count - 1, part by part."""
        pieces: list[NDArray[Any]] = []
        end = begin + count
        at = bisect_right(self._starts, begin) - 1
        while begin < end:
            part = self._parts[at]
            stop = min(end, part.first + part.n_frame)
            if stop > begin:
                pieces.append(self._lifted(part, begin - part.first, stop - part.first, grains))
            begin, at = max(begin, stop), at + 1
        if not pieces:
            kept = np.zeros((self.shape[1],))[grains].shape
            return np.zeros((0, *kept, *self.shape[2:]), dtype=self.dtype)
        return pieces[0] if len(pieces) == 1 else np.concatenate(pieces)

    def _lifted(self, part: Part, begin: int, end: int, grains: Any) -> NDArray[Any]:
        rows = part.rows(self._name, begin, end, grains)
        if self._lift is not None and self._lift.any():
            image = part.rows("image", begin, end, grains)
            rows[..., :2] += image * self._lift[:2]
        return rows


def read_frames(
    parts: list[Part], group: str, shapes: Mapping[str, tuple[int, ...]]
) -> dict[str, NDArray[np.float64]]:
    """Read datasets of one group over all frames, each as one read-only array.

    Parameters
    ----------
    shapes : of one frame of each dataset.

    Raises
    ------
    ResultsError : a part lacks one, or has it in another shape.
    """
    rows: dict[str, list[NDArray[np.float64]]] = {name: [] for name in shapes}
    for part in parts:
        if not part.n_frame:
            continue
        with opened(part.path) as file:
            for name, tail in shapes.items():
                key, shape = f"{group}/{name}", (part.n_frame, *tail)
                if key not in file:
                    raise ResultsError(f"{part.path}: has no '{key}': {schema.FOREIGN}")
                got = plain_dataset(file, key, part.path)
                if got.shape != shape or got.dtype != np.float64:
                    raise ResultsError(
                        f"{part.path}: '{key}' is {got.shape} of {got.dtype}, expected {shape} of float64"
                    )
                rows[name].append(read_dataset(file, key, part.path))
    found = {name: np.concatenate(one) if one else np.zeros((0, *shapes[name])) for name, one in rows.items()}
    for array in found.values():
        array.flags.writeable = False
    return found
