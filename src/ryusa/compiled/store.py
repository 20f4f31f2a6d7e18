"""Where compiled code is kept: one file for each function, types, compiler and processor.

The name of a file is a digest of all of these (content.py, processor.py), so that a file is right or is not
found. It is written under another name and then renamed: two processes that write the same file write the
same. A file that is damaged, or that another program wrote, is not read; a folder that is full or closed
means that code is compiled in every process, and `trouble` says why.
"""

import contextlib
import hashlib
import json
import os
import tempfile
import time
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import platformdirs

from ryusa.compiled.processor import Processor
from ryusa.compiled.processor import own as own_processor
from ryusa.compiled.seconds import Seconds

_MAGIC = b"ryusa kernel 1\n"
_HASH = hashlib.sha256().digest_size
_SUFFIX = ".kernel"
_DAY = 86_400.0  # [s]
UNUSED_DAYS = 90  # after which code is removed
LARGEST = 512 * 2**20  # [bytes] above which the code that was not used for longest is removed


@dataclass(frozen=True)
class Kept:
    """What a store holds of one function.

    Attributes
    ----------
    file : where.
    about : name, kind (`inner` is built into other code, `piece` is called by address, `entry` from
        Python), seconds of processor time that compiling took without what it calls, processor, the first
        digits of its content.
    size : bytes on disk.
    used : when it was last read or written [s since 1970], to a day.
    """

    file: Path
    about: dict[str, Any]
    size: int
    used: float


@dataclass
class Store:
    """A folder of compiled code.

    Attributes
    ----------
    folder : where; made when something is kept.
    processor : the kind of processor that its code is for.
    writable : whether this program keeps code there.
    trouble : why nothing could be read or kept; empty where nothing went wrong.
    """

    folder: Path
    processor: Processor
    writable: bool = True
    trouble: str = ""
    _tidied: bool = field(default=False, repr=False)

    def can_keep(self) -> bool:
        """Whether something can be written here."""
        place = self.folder
        while not place.exists() and place != place.parent:
            place = place.parent
        return self.writable and os.access(place, os.W_OK) and place.is_dir()

    def load(self, key: str) -> bytes | None:
        """Code of a key; None where there is none, or none that is whole."""
        file = self._file(key)
        try:
            raw = file.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            self.trouble = f"{file}: {error.strerror}"
            return None
        found = _opened(raw)
        if found is None or found[0].get("key") != key:
            return None
        with contextlib.suppress(OSError):
            if self.writable and time.time() - file.stat().st_mtime > _DAY:
                os.utime(file)
        try:
            return zlib.decompress(found[1])
        except zlib.error:
            return None

    def save(self, key: str, about: dict[str, Any], data: bytes) -> None:
        """Keep the code of a key; if the disk does not take it, `trouble` says so."""
        if not self.writable:
            return
        head = json.dumps({"key": key, **about}).encode()
        body = len(head).to_bytes(4, "little") + head + zlib.compress(data, 1)
        file = self._file(key)
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            handle, name = tempfile.mkstemp(dir=file.parent, prefix=".", suffix=".part")
            try:
                with os.fdopen(handle, "wb") as out:
                    out.write(_MAGIC + hashlib.sha256(body).digest() + body)
                os.replace(name, file)
            except OSError:
                with contextlib.suppress(OSError):
                    os.unlink(name)
                raise
        except OSError as error:
            self.trouble = f"{self.folder}: {error.strerror}"
            return
        if not self._tidied:
            self._tidied = True
            self.tidy()

    def listed(self) -> Iterator[Kept]:
        """All that is whole, in the order of the names of files."""
        for file in sorted(self.folder.glob(f"??/*{_SUFFIX}")):
            try:
                raw, state = file.read_bytes(), file.stat()
            except OSError:
                continue
            found = _opened(raw)
            if found is not None:
                yield Kept(file, found[0], state.st_size, state.st_mtime)

    def size(self) -> tuple[int, int]:
        """Files, and bytes in all."""
        sizes = [size for _, size, _ in self._states()]
        return len(sizes), sum(sizes)

    def clear(self) -> int:
        """Remove all code; returns how many files went."""
        gone = 0
        for file, _, _ in self._states():
            with contextlib.suppress(OSError):
                file.unlink()
                gone += 1
        Seconds(self.folder).forget_contents()
        return gone

    def tidy(self) -> None:
        """Remove what was not used for long, and what is too much."""
        states = sorted(self._states(), key=lambda one: one[2])
        total = sum(size for _, size, _ in states)
        oldest = time.time() - UNUSED_DAYS * _DAY
        for file, size, used in states:
            if used >= oldest and total <= LARGEST:
                break
            with contextlib.suppress(OSError):
                file.unlink()
                total -= size

    def _file(self, key: str) -> Path:
        return self.folder / key[:2] / f"{key[2:]}{_SUFFIX}"

    def _states(self) -> Iterator[tuple[Path, int, float]]:
        for pattern in (f"??/*{_SUFFIX}", "??/.*.part"):
            for file in self.folder.glob(pattern):
                with contextlib.suppress(OSError):
                    state = file.stat()
                    yield file, state.st_size, state.st_mtime


def _opened(raw: bytes) -> tuple[dict[str, Any], bytes] | None:
    """What a file says about its code, and the code; None where it is not whole."""
    start = len(_MAGIC) + _HASH
    body = raw[start:]
    if raw[: len(_MAGIC)] != _MAGIC or hashlib.sha256(body).digest() != raw[len(_MAGIC) : start]:
        return None
    length = int.from_bytes(body[:4], "little")
    return json.loads(body[4 : 4 + length]), body[4 + length :]


def folder() -> Path:
    """RYUSA_CACHE, else `ryusa` in NUMBA_CACHE_DIR, else the user's folder for caches on this system."""
    for name, below in (("RYUSA_CACHE", ""), ("NUMBA_CACHE_DIR", "ryusa")):
        if os.environ.get(name):
            return Path(os.environ[name]).expanduser() / below
    return Path(platformdirs.user_cache_dir("ryusa", appauthor=False)) / "kernels"


@cache
def own() -> Store:
    """The store of this user."""
    return Store(folder(), own_processor())
