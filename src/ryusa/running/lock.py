"""Lock of a run folder, so that one process writes to it; the system releases it when the process ends."""

import json
import os
import socket
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from ryusa.errors import ResultsError
from ryusa.results import schema

try:
    import fcntl
except ImportError:  # a system without flock: the lock file only names its holder
    fcntl = None

_LIMIT = 4096  # bytes read from a lock file


@contextmanager
def locked(folder: Path) -> Generator[str]:
    """Hold the lock of an existing run folder; yields the process that left a stale lock, or "".

    Raises
    ------
    ResultsError : another process writes to the folder; the message names it.
    """
    path = folder / schema.LOCK
    try:
        file, left = _taken(path)
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written ({error.strerror or error})") from error
    try:
        yield left
    finally:
        with suppress(OSError):
            path.unlink(missing_ok=True)
        file.close()


def holder(folder: Path) -> str:
    """Process that writes to a run folder now; "" if none is known."""
    path = folder / schema.LOCK
    flags = os.O_RDONLY | os.O_CLOEXEC | getattr(os, "O_NOFOLLOW", 0)
    try:
        file = os.fdopen(os.open(path, flags), "rb")
    except OSError:
        return ""
    with file:
        left = _who(file)
        try:
            _hold(file, path, left, shared=True)
        except ResultsError:
            return f"process {left['pid']} on {left['host']}" if left else "another process"
    return ""


def _taken(path: Path) -> tuple[IO[bytes], str]:
    flags = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | getattr(os, "O_NOFOLLOW", 0)
    while True:
        file = os.fdopen(os.open(path, flags, 0o644), "r+b")
        try:
            left = _who(file)
            _hold(file, path, left)
            if not _is(file, path):  # its holder has removed it meanwhile
                file.close()
                continue
            file.seek(0)
            file.truncate()
            file.write(json.dumps({"pid": os.getpid(), "host": socket.gethostname()}).encode())
            file.flush()
            return file, f"process {left['pid']} on {left['host']}" if left else ""
        except BaseException:
            file.close()
            raise


def _hold(file: IO[bytes], path: Path, left: dict[str, Any], *, shared: bool = False) -> None:
    """Acquire the lock, or raise an error that names its holder."""
    who = f"process {left['pid']} on {left['host']}" if left else "another process"
    if fcntl is None:
        if left and left["host"] == socket.gethostname() and _lives(left["pid"]):
            raise ResultsError(f"{path.parent}: {who} is writing to it")
        return
    try:
        fcntl.flock(file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        raise ResultsError(
            f"{path.parent}: {who} is writing to it. Wait until it ends, or choose another folder with -o"
        ) from None
    except OSError:  # a file system without locks: rely on the content of the file
        if left and (left["host"] != socket.gethostname() or _lives(left["pid"])):
            raise ResultsError(
                f"{path.parent}: {who} is writing to it, or was killed: this file system has no locks to "
                f"tell which. If that process has ended, remove {path}"
            ) from None


def _who(file: IO[bytes]) -> dict[str, Any]:
    """Process and host named in a lock file; {} if it names none."""
    try:
        found = json.loads(file.read(_LIMIT))
        return {"pid": int(found["pid"]), "host": str(found["host"])[:100]}
    except (ValueError, KeyError, TypeError, OverflowError, RecursionError):
        return {}


def _is(file: IO[bytes], path: Path) -> bool:
    try:
        there = path.stat(follow_symlinks=False)
    except OSError:
        return False
    mine = os.fstat(file.fileno())
    return (there.st_dev, there.st_ino) == (mine.st_dev, mine.st_ino)


def _lives(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:
        return True
    return True
