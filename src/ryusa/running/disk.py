"""Atomic writes, and disk errors as exceptions of ryusa; a full disk has an exception of its own."""

import errno
import hashlib
import itertools
import os
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

import h5py

from ryusa.errors import DiskFull, ResultsError
from ryusa.running.interrupt import StopSignal

T = TypeVar("T")
_RETRY_EVERY = 1.0  # s between two attempts to write to a full disk
_DISK_TIMEOUT = 86_400.0  # s
_AT_ONCE = 1 << 20  # bytes
Content = bytes | Callable[[BinaryIO], None]  # of a file; large ones are written piece by piece
_images = itertools.count()
_FULL = {errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)}


def hdf5_image(fill: Callable[[h5py.File], None]) -> bytes:
    """Bytes of an HDF5 file, made in memory, so that the HDF5 library never writes to a full disk."""
    name = f"image-{next(_images)}.h5"  # HDF5 refuses two open files of one name, of several threads too
    with h5py.File(name, "w", driver="core", backing_store=False) as file:
        fill(file)
        file.flush()
        return file.id.get_file_image()


def hdf5_file(fill: Callable[[h5py.File], None], header: int = 0) -> Callable[[BinaryIO], None]:
    """Content of a large HDF5 file, for `write_temporary`: the arrays go to the disk one by one.

    Parameters
    ----------
    fill : creates the datasets.
    header : bytes left free before the HDF5 file.
    """

    def write(file: BinaryIO) -> None:
        behind = _BehindHeader(file, header)
        with h5py.File(behind, "w") as image:
            fill(image)
        if behind.error is not None:
            raise behind.error

    return write


def write_atomically(path: Path, content: Content) -> None:
    """Write to a temporary file and rename it, so that `path` is old or new but never partial.

    This also holds after a power failure.

    Raises
    ------
    OSError : `path` is unchanged.
    """
    os.replace(write_temporary(path, content), path)
    sync(path.parent)


def write_temporary(path: Path, content: Content) -> Path:
    """Write the future content of `path` to a temporary file beside it, and sync it to the disk.

    Raises
    ------
    OSError : the temporary file is removed.
    """
    temporary = path.with_name(f".{path.name}.new")
    try:
        with temporary.open("w+b") as file:
            if isinstance(content, bytes):
                file.write(content)
            else:
                content(file)
        sync(temporary)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    return temporary


class _BehindHeader:
    """File that HDF5 writes to, behind a header; the first error of the disk is kept in `error`.

    HDF5 does not recover from a write that fails. It is told that nothing failed, and the caller raises the
    error when HDF5 has closed the file.
    """

    def __init__(self, file: BinaryIO, header: int) -> None:
        self.error: OSError | None = None
        self._file, self._header = file, header
        self._file.write(bytes(header))

    def write(self, data: Any) -> int:
        """Write; after an error, nothing."""
        return self._unless_failed(lambda: self._file.write(data), len(data))

    def read(self, size: int) -> bytes:
        """Read what was written before; after an error, zeros."""
        return self._unless_failed(lambda: self._file.read(size), bytes(size))

    def seek(self, place: int, whence: int = os.SEEK_SET) -> int:
        """Move to a place of the HDF5 file."""
        shift = self._header if whence == os.SEEK_SET else 0
        return self._unless_failed(lambda: self._file.seek(place + shift, whence) - self._header, 0)

    def tell(self) -> int:
        """Place in the HDF5 file."""
        return self._file.tell() - self._header

    def truncate(self, size: int) -> int:
        """Set the length of the HDF5 file."""
        return self._unless_failed(lambda: self._file.truncate(size + self._header) - self._header, size)

    def flush(self) -> None:
        """Write what is buffered."""
        self._unless_failed(lambda: self._file.flush() or 0, 0)

    def _unless_failed(self, action: Callable[[], T], otherwise: T) -> T:
        try:
            return otherwise if self.error else action()
        except OSError as error:
            self.error = error
            return otherwise


def write_hdf5_behind_header(
    path: Path, fill: Callable[[h5py.File], None], size: int, header: Callable[[int, str], bytes]
) -> tuple[Path, int]:
    """Write an HDF5 file behind a header to a temporary file beside `path`, and sync it to the disk.

    Parameters
    ----------
    fill : creates the datasets.
    size : of the header [B].
    header : makes the header, of at most `size` bytes, from the length and the SHA-256 of the HDF5 file.

    Returns
    -------
    The temporary file and its length [B].

    Raises
    ------
    OSError : the temporary file is removed.
    """
    write, length = hdf5_file(fill, size), 0

    def content(file: BinaryIO) -> None:
        nonlocal length
        write(file)
        file.seek(size)
        digest = hashlib.sha256()
        while piece := file.read(_AT_ONCE):
            digest.update(piece)
        length = file.tell()
        file.seek(0)
        file.write(header(length - size, digest.hexdigest()))

    return write_temporary(path, content), length


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


def retry_when_full(action: Callable[[], T], signal: StopSignal, say: Callable[[str], None]) -> T:
    """Call a function that writes; while the disk is full, retry until a signal stops the run.

    Parameters
    ----------
    action : writes; what it returns is returned.
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
