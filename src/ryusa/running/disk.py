"""Writing so that a file is either as before or whole, and a full disk is told from a broken one."""

import errno
import os
import shutil
from collections.abc import Callable
from pathlib import Path

import h5py

from ryusa.errors import DiskFull, ResultsError

_FULL = {errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)}


def image(fill: Callable[[h5py.File], None]) -> bytes:
    """An HDF5 file as its bytes, made in memory: the library never meets a full disk."""
    with h5py.File("image.h5", "w", driver="core", backing_store=False) as file:
        fill(file)
        file.flush()
        return file.id.get_file_image()


def write_whole(path: Path, content: bytes) -> None:
    """Write `path` beside and rename it, so that it is as before or whole, also after a power cut.

    Raises
    ------
    OSError : nothing was changed.
    """
    os.replace(write_beside(path, content), path)
    sync(path.parent)


def write_beside(path: Path, content: bytes) -> Path:
    """Write what shall become `path` under another name, and push it to the disk.

    Raises
    ------
    OSError : what was written is gone again.
    """
    beside = path.with_name(f".{path.name}.new")
    try:
        with beside.open("wb") as file:
            file.write(content)
        sync(beside)
    except OSError:
        beside.unlink(missing_ok=True)
        raise
    return beside


def write_over(path: Path, content: bytes) -> None:
    """Write over a file in its place, which takes no more room than it has; only where there is no other."""
    with path.open("r+b") as file:
        file.write(content)
        file.truncate()
        file.flush()
    sync(path)


def sync(path: Path) -> None:
    """Push a file or folder to the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def free_bytes(place: Path) -> int:
    """Free space on the disk that holds `place` [B]."""
    return shutil.disk_usage(place).free


class disk:
    """Within the block, what the disk says is a ResultsError that names the folder; DiskFull if it is."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if not isinstance(error, OSError):
            return
        said = f"{self.folder}: cannot be written ({error.strerror or error})"
        if error.errno in _FULL:
            raise DiskFull(f"{said}. What was written before stays readable") from error
        raise ResultsError(f"{said}. What was written before stays readable") from error
