"""One process writes a run folder: a lock that goes with its process, whatever ends it."""

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
except ImportError:  # a system without it: the lock says who holds it, and no more
    fcntl = None

_LIMIT = 4096  # bytes that are read of who holds a lock


@contextmanager
def locked(folder: Path) -> Generator[str]:
    """Hold the lock of a run folder, which must exist; gives who left it behind, or "".

    Raises
    ------
    ResultsError : another process writes into the folder; says which.
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
    """Who writes into a run folder now; "" where nobody does, as far as can be told."""
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
            if not _is(file, path):  # its holder took it away meanwhile
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
    """Take the lock, or say who has it."""
    who = f"process {left['pid']} on {left['host']}" if left else "another process"
    if fcntl is None:
        if left and left["host"] == socket.gethostname() and _lives(left["pid"]):
            raise ResultsError(f"{path.parent}: {who} writes into it")
        return
    try:
        fcntl.flock(file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        raise ResultsError(
            f"{path.parent}: {who} writes into it. Wait for it, or choose another folder with -o"
        ) from None
    except OSError:  # a file system that cannot lock: go by what the file says
        if left and (left["host"] != socket.gethostname() or _lives(left["pid"])):
            raise ResultsError(
                f"{path.parent}: {who} writes into it, or was killed there, which this file system cannot "
                f"tell. If it is over, remove {path}"
            ) from None


def _who(file: IO[bytes]) -> dict[str, Any]:
    """Process and host that hold the lock or left it behind; {} where that is not said."""
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
