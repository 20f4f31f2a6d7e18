"""The checkpoint file: plain arrays and numbers, checked by a digest before anything is read from them.

512 bytes come first: a magic line, the length and the SHA-256 of the rest. The rest is an HDF5 file, whose
dataset `about` is JSON: numbers, names, and the list of arrays that belong to it.
"""

import hashlib
import json
import os
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ryusa.errors import CheckpointError, ResultsError
from ryusa.results import schema
from ryusa.results.hdf5 import DAMAGE, read_dataset
from ryusa.running.disk import image, sync, write_beside

_MAGIC = b"ryusa checkpoint 2\n"
_HEAD = 512  # bytes before the HDF5 file
_ABOUT = "about"
_ABOUT_LIMIT = 16 << 20  # bytes of JSON
_MOST_ARRAYS = 500
_LARGEST = 1 << 30  # bytes, beside those of the grains
_PER_GRAIN = 20_000  # bytes at most: state, contacts with their records, and frames that wait
_AT_ONCE = 1 << 20  # bytes


@dataclass(frozen=True)
class Kept:
    """What a checkpoint holds.

    Attributes
    ----------
    about : numbers and names, as JSON can say them.
    arrays : by name; a slash makes a group.
    """

    about: dict[str, Any]
    arrays: dict[str, np.ndarray] = field(default_factory=dict[str, np.ndarray])

    def part(self, name: str) -> "Kept":
        """The numbers and arrays of one group."""
        inner = self.about.get(name)
        if not isinstance(inner, dict):
            raise CheckpointError(f"the checkpoint holds no '{name}'")
        begin = f"{name}/"
        arrays = {key.removeprefix(begin): one for key, one in self.arrays.items() if key.startswith(begin)}
        return Kept(inner, arrays)

    @staticmethod
    def together(**parts: "Kept") -> "Kept":
        """One of several groups."""
        arrays = {
            f"{name}/{key}": array for name, part in parts.items() for key, array in part.arrays.items()
        }
        return Kept({name: part.about for name, part in parts.items()}, arrays)


def write_checkpoint(folder: Path, kept: Kept) -> int:
    """Write a checkpoint; the one before stays beside it. Gives its size [B].

    Raises
    ------
    OSError : the disk is full or gone; the last checkpoint is as it was.
    """
    about = json.dumps({**kept.about, "arrays": sorted(kept.arrays)}, default=_plain).encode()

    def fill(file: h5py.File) -> None:
        file.create_dataset(_ABOUT, data=np.frombuffer(about, dtype=np.uint8))
        for name, array in kept.arrays.items():
            file.create_dataset(name, data=array)

    body = image(fill)
    head = _MAGIC + f"{len(body)} {hashlib.sha256(body).hexdigest()}\n".encode()
    path, before = folder / schema.CHECKPOINT, folder / schema.CHECKPOINT_BEFORE
    beside = write_beside(path, head.ljust(_HEAD, b"\0") + body)
    if path.is_file():
        os.replace(path, before)
    os.replace(beside, path)
    sync(folder)
    return _HEAD + len(body)


def read_checkpoint(path: Path, n_grain: int) -> Kept:
    """Read one checkpoint file of a run with so many grains.

    Raises
    ------
    CheckpointError : it is no checkpoint, cut short, damaged, or holds what none of ours holds; one line.
    """
    if path.is_symlink() or not path.is_file():
        raise CheckpointError(f"{path}: no such file (links are not followed)")
    try:
        size = path.stat().st_size
        if size > _LARGEST + _PER_GRAIN * n_grain:
            raise CheckpointError(f"{path}: {size} bytes, larger than any checkpoint of so many grains")
        with path.open("rb") as file:
            length, digest = _head(file.read(_HEAD), path)
            if size != _HEAD + length:
                raise CheckpointError(f"{path}: cut short or added to: {size - _HEAD} bytes of {length}")
            found = hashlib.sha256()
            while piece := file.read(_AT_ONCE):
                found.update(piece)
            if found.hexdigest() != digest:
                raise CheckpointError(f"{path}: damaged: its content is not that of its digest")
            file.seek(_HEAD)
            body = file.read(length)
    except (OSError, MemoryError) as error:
        raise CheckpointError(f"{path}: cannot be read ({error})") from error
    try:
        return _read(body, path)
    except ResultsError as error:
        raise CheckpointError(str(error)) from error
    except (*DAMAGE, RecursionError, MemoryError) as error:
        raise CheckpointError(f"{path}: not a checkpoint of ryusa ({error})") from error


def _plain(value: np.generic) -> Any:
    return value.item()


def _head(head: bytes, path: Path) -> tuple[int, str]:
    """Length and digest of what follows."""
    if len(head) < _HEAD or not head.startswith(_MAGIC):
        other = re.match(rb"ryusa checkpoint (\d{1,6})\n", head)
        reads = _MAGIC.split()[-1].decode()
        why = f" (format {other.group(1).decode()}, this one reads format {reads})" if other else ""
        raise CheckpointError(f"{path}: not a checkpoint of this version of ryusa{why}")
    try:
        length, digest = head[len(_MAGIC) :].split(b"\n", 1)[0].decode("ascii").split(" ")
        return int(length), digest
    except ValueError:
        raise CheckpointError(f"{path}: damaged: its first line is not readable") from None


def _read(body: bytes, path: Path) -> Kept:
    with h5py.File(h5py.h5f.open_file_image(body)) as file:
        raw = read_dataset(file, _ABOUT, path)
        if raw.dtype != np.uint8 or raw.ndim != 1 or raw.nbytes > _ABOUT_LIMIT:
            raise CheckpointError(f"{path}: '{_ABOUT}' is no text")
        about = json.loads(raw.tobytes())
        if not isinstance(about, dict):
            raise CheckpointError(f"{path}: '{_ABOUT}' is no table of keys")
        names = about.pop("arrays", None)
        if not isinstance(names, list) or len(names) > _MOST_ARRAYS:
            raise CheckpointError(f"{path}: its list of arrays is not one")
        return Kept(about, {str(name): read_dataset(file, str(name), path) for name in names})
