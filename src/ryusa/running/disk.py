"""Atomic writes, and disk errors as exceptions of ryusa; a full disk has an exception of its own."""

import errno
import itertools
import os
import shutil
import time
from collections.abc import Callable
from pathlib import Path

import h5py

from ryusa.errors import DiskFull, ResultsError
from ryusa.running.interrupt import StopSignal

_RETRY_EVERY = 1.0  # s between two attempts to write to a full disk
_DISK_TIMEOUT = 86_400.0  # s
_images = itertools.count()
_FULL = {errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)}


def hdf5_image(fill: Callable[[h5py.File], None]) -> bytes:
    """Bytes of an HDF5 file, made in memory, so that the HDF5 library never writes to a full disk."""
    name = f"image-{next(_images)}.h5"  # HDF5 refuses two open files of one name, of several threads too
    with h5py.File(name, "w", driver="core", backing_store=False) as file:
        fill(file)
        file.flush()
        return file.id.get_file_image()


def write_atomically(path: Path, content: bytes) -> None:
    """Write to a temporary file and rename it, so that `path` is old or new but never partial.

    This also holds after a power failure.

    Raises
    ------
    OSError : `path` is unchanged.
    """
    os.replace(write_temporary(path, content), path)
    sync(path.parent)


def write_temporary(path: Path, content: bytes) -> Path:
    """Write the future content of `path` to a temporary file beside it, and sync it to the disk.

    Raises
    ------
    OSError : the temporary file is removed.
    """
    temporary = path.with_name(f".{path.name}.new")
    try:
        with temporary.open("wb") as file:
            file.write(content)
        sync(temporary)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    return temporary


def overwrite(path: Path, content: bytes) -> None:
    """Overwrite a file in place, which needs no free space; not atomic."""
    with path.open("r+b") as file:
        file.write(content)
        file.truncate()
        file.flush()
    sync(path)


def sync(path: Path) -> None:
    """Sync a file or folder to the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def free_bytes(place: Path) -> int:
    """Free space on the disk that holds `place` [B]."""
    return shutil.disk_usage(place).free


class disk_errors:
    """Raise an OSError of the block as a ResultsError that names the folder, or as DiskFull."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if not isinstance(error, OSError):
            return
        message = f"{self.folder}: cannot be written ({error.strerror or error})"
        if error.errno in _FULL:
            raise DiskFull(f"{message}. Data written before remains readable") from error
        raise ResultsError(f"{message}. Data written before remains readable") from error


def retry_when_full(action: Callable[[], bool], signal: StopSignal, say: Callable[[str], None]) -> bool:
    """Call a function that writes; while the disk is full, retry until a signal stops the run.

    Parameters
    ----------
    action : writes, and returns whether it wrote anything.
    signal : signals received so far.
    say : writes a line about the pause, and one when it is over.

    Raises
    ------
    DiskFull : the disk stayed full until a signal came, or for a day.
    """
    begun, reported = time.monotonic(), False
    while True:
        try:
            done = action()
        except DiskFull as error:
            if signal.stop or time.monotonic() - begun > _DISK_TIMEOUT:
                raise
            if not reported:
                say(f"paused: {error}. The run continues when there is free space; Ctrl-C stops it")
            reported = True
            time.sleep(_RETRY_EVERY)
            continue
        if reported:
            say("free space is available again: the run continues")
        return done
