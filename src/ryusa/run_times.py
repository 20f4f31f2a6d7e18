"""How long runs took on this machine, over the rule of thumb, by kind of case.

One small file beside the compiled code. A ratio holds for the kind of processor that made it: the folder may
be on a disk that several machines share. RYUSA_RUN_TIMES=off in the environment keeps and asks for nothing.
"""

import math
import os
from functools import lru_cache
from pathlib import Path
from typing import Any

from ryusa.compiled import small_json, store
from ryusa.compiled.processor import own

_FILE = "run_times.json"
_LATEST = 9  # ratios that are kept of a kind
_MOST = 400  # kinds that are kept; the latest


def ratios_of(kind: str) -> tuple[float, ...]:
    """Wall time over the rule of thumb of the latest runs of a kind on this kind of processor."""
    return _held().get(_key(kind), ()) if _kept() else ()


def add(kind: str, ratio: float) -> None:
    """Keep the ratio of one more run; where it cannot be written nothing happens."""
    if not _kept() or not 0.0 < ratio < math.inf:
        return
    held = dict(_held())  # with what other processes have added
    held[_key(kind)] = (*held.pop(_key(kind), ()), round(ratio, 3))[-_LATEST:]  # the latest kind comes last
    small_json.write(_file(), dict(list(held.items())[-_MOST:]))


def _kept() -> bool:
    return os.environ.get("RYUSA_RUN_TIMES") != "off"


def _key(kind: str) -> str:
    return f"{own().name}: {kind}"


def _file() -> Path:
    return store.folder() / _FILE


def _held() -> dict[str, tuple[float, ...]]:
    file = _file()
    try:
        state = file.stat()
    except OSError:
        return {}
    return _read(file, state.st_mtime_ns, state.st_size)


@lru_cache(maxsize=1)
def _read(file: Path, _changed: int, _size: int) -> dict[str, tuple[float, ...]]:
    found: Any = small_json.read(file)
    if not isinstance(found, dict):
        return {}
    table: dict[str, Any] = found
    return {kind: whole for kind, every in table.items() if (whole := _whole(every))}


def _whole(every: Any) -> tuple[float, ...]:
    """Those ratios that are numbers above 0: others may have written the file."""
    found: list[Any] = every if isinstance(every, list) else []
    return tuple(float(one) for one in found if isinstance(one, int | float) and 0.0 < one < math.inf)
