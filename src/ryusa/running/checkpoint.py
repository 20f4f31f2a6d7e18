"""The checkpoint file: plain arrays and numbers, verified by a digest before they are read.

A header of 512 bytes holds a magic line, and the length and SHA-256 of the rest. The rest is an HDF5 file,
whose dataset `about` is JSON: numbers, names, and the list of its arrays.
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
from ryusa.model.pieces import RowsInPieces
from ryusa.results import schema
from ryusa.results.hdf5 import DAMAGE, read_dataset
from ryusa.running.disk import sync, write_hdf5_behind_header

_NAME, _FORMAT = b"ryusa checkpoint ", 2  # the format is raised when older checkpoints cannot be read
_MAGIC = _NAME + f"{_FORMAT}\n".encode()
_HEAD = 512  # bytes before the HDF5 file
_ABOUT = "about"
_ABOUT_LIMIT = 16 << 20  # bytes of JSON
_MOST_ARRAYS = 500
_LARGEST = 1 << 30  # bytes, in addition to those of the grains
_PER_GRAIN = 20_000  # bytes at most: state, contacts with their records, and buffered frames
_AT_ONCE = 1 << 20  # bytes


@dataclass(frozen=True)
class CheckpointBlock:
    """Numbers and arrays of a checkpoint, or of one part of it.

    Attributes
    ----------
    values : numbers and names that JSON can represent.
    arrays : by name; a slash separates a group from its members.
    rows : more arrays, made while they are written; a block that was read has none.
    """

    values: dict[str, Any]
    arrays: dict[str, np.ndarray] = field(default_factory=dict[str, np.ndarray])
    rows: tuple[RowsInPieces, ...] = ()

    def block(self, name: str) -> "CheckpointBlock":
        """The numbers and arrays of one group."""
        inner = self.values.get(name)
        if not isinstance(inner, dict):
            raise CheckpointError(f"the checkpoint has no part '{name}'")
        begin = f"{name}/"
        arrays = {key.removeprefix(begin): one for key, one in self.arrays.items() if key.startswith(begin)}
        return CheckpointBlock(inner, arrays)

    @staticmethod
    def merged(**parts: "CheckpointBlock") -> "CheckpointBlock":
        """Merge several blocks into one, each as a group."""
        arrays = {
            f"{name}/{key}": array for name, part in parts.items() for key, array in part.arrays.items()
        }
        rows = tuple(one.within(name) for name, part in parts.items() for one in part.rows)
        return CheckpointBlock({name: part.values for name, part in parts.items()}, arrays, rows)


def write_checkpoint(folder: Path, block: CheckpointBlock) -> int:
    """Write a checkpoint, keep the previous one temporary it, and return the size [B].

    Raises
    ------
    OSError : the disk is full or not available; the last checkpoint is unchanged.
    """
    names = sorted([*block.arrays, *(name for rows in block.rows for name in rows.names)])
    about = json.dumps({**block.values, "arrays": names}, default=_plain).encode()

    def fill(file: h5py.File) -> None:
        file.create_dataset(_ABOUT, data=np.frombuffer(about, dtype=np.uint8))
        for name, array in block.arrays.items():
            file.create_dataset(name, data=array)
        for rows in block.rows:
            _write_rows(file, rows)

    def head(length: int, digest: str) -> bytes:
        return _MAGIC + f"{length} {digest}\n".encode()

    path, before = folder / schema.CHECKPOINT, folder / schema.CHECKPOINT_BEFORE
    temporary, length = write_hdf5_behind_header(path, fill, _HEAD, head)
    if path.is_file():
        os.replace(path, before)
    os.replace(temporary, path)
    sync(folder)
    return length


def _write_rows(file: h5py.File, rows: RowsInPieces) -> None:
    """Write arrays piece by piece."""
    made, begin = dict[str, Any](), 0
    for piece in rows.pieces():
        end = begin + len(piece[rows.names[0]])
        for name in rows.names:
            part = piece[name]
            if name not in made:
                made[name] = file.create_dataset(name, (rows.count, *part.shape[1:]), part.dtype)
            if begin < end:
                made[name][begin:end] = part
        begin = end


def read_checkpoint(path: Path, n_grain: int) -> CheckpointBlock:
    """Read a checkpoint file of a run with `n_grain` grains.

    Raises
    ------
    CheckpointError : not a checkpoint, truncated, damaged, or with content that ryusa does not write.
    """
    if path.is_symlink() or not path.is_file():
        raise CheckpointError(f"{path}: no such file (links are not followed)")
    try:
        size = path.stat().st_size
        if size > _LARGEST + _PER_GRAIN * n_grain:
            raise CheckpointError(f"{path}: {size} bytes, larger than any checkpoint of {n_grain} grains")
        with path.open("rb") as file:
            length, digest = _head(file.read(_HEAD), path)
            if size != _HEAD + length:
                raise CheckpointError(
                    f"{path}: wrong length: {size - _HEAD} bytes after the header, which says {length}"
                )
            found = hashlib.sha256()
            while piece := file.read(_AT_ONCE):
                found.update(piece)
            if found.hexdigest() != digest:
                raise CheckpointError(f"{path}: damaged: its content does not match its SHA-256")
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
    """Length and digest of the rest of the file."""
    if len(head) < _HEAD or not head.startswith(_NAME):
        raise CheckpointError(f"{path}: not a checkpoint of ryusa")
    if not head.startswith(_MAGIC):
        written = re.match(rb"(\d{1,6})\n", head[len(_NAME) :])
        other = f"format {written.group(1).decode()}" if written else "an unknown format"
        raise CheckpointError(
            f"{path}: a checkpoint in {other}; this version of ryusa reads format {_FORMAT}. Resume with the "
            f"version named in {schema.PROVENANCE}"
        )
    try:
        length, digest = head[len(_MAGIC) :].split(b"\n", 1)[0].decode("ascii").split(" ")
        return int(length), digest
    except ValueError:
        raise CheckpointError(f"{path}: damaged: its header is not readable") from None


def _read(body: bytes, path: Path) -> CheckpointBlock:
    with h5py.File(h5py.h5f.open_file_image(body)) as file:
        raw = read_dataset(file, _ABOUT, path)
        if raw.dtype != np.uint8 or raw.ndim != 1 or raw.nbytes > _ABOUT_LIMIT:
            raise CheckpointError(f"{path}: '{_ABOUT}' is not text")
        about = json.loads(raw.tobytes())
        if not isinstance(about, dict):
            raise CheckpointError(f"{path}: '{_ABOUT}' is not a table of keys")
        names = about.pop("arrays", None)
        if not isinstance(names, list) or len(names) > _MOST_ARRAYS:
            raise CheckpointError(f"{path}: its list of arrays is not valid")
        return CheckpointBlock(about, {str(name): read_dataset(file, str(name), path) for name in names})
