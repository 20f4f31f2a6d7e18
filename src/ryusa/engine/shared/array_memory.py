"""Memory for arrays: at a cache line, and given back to the system when they are freed.

What the C library frees it keeps for itself: arrays of up to 32 MiB would leave a hundred bytes a grain
behind that nobody uses. So large ones lie in pages of their own.
"""

import math
import mmap
from typing import Any

import numpy as np

_CACHE_LINE = 64  # [B]
_LARGE = 2 << 20  # bytes from which arrays have pages of their own, of 2 MiB where the system has such
_PRIVATE: dict[str, int] = {}  # how memory is asked for that other processes do not see; Windows has no flags
if hasattr(mmap, "MAP_PRIVATE"):
    _PRIVATE["flags"] = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS


def zeros(dtype: Any, *shape: int) -> Any:
    """Zeros that begin at a cache line: rows of eight doubles then take one line each, not two."""
    return _zeros(dtype, shape, True)


def unwritten(dtype: Any, *shape: int) -> Any:
    """Zeros, room for as much as may ever be needed: what is not written takes no memory.

    That holds of large arrays, which lie in pages of the usual size: of those of 2 MiB, what a block of
    grains leaves empty would be taken too.
    """
    return _zeros(dtype, shape, False)


def _zeros(dtype: Any, shape: tuple[int, ...], huge: bool) -> Any:
    size = math.prod(shape) * np.dtype(dtype).itemsize
    if size < _LARGE:
        raw = np.zeros(size + _CACHE_LINE, np.uint8)
        first = -raw.ctypes.data % _CACHE_LINE
        return raw[first : first + size].view(dtype).reshape(shape)
    pages = mmap.mmap(-1, size, **_PRIVATE)
    advice = "MADV_HUGEPAGE" if huge else "MADV_NOHUGEPAGE"
    if hasattr(mmap, advice):
        pages.madvise(getattr(mmap, advice))
    return np.frombuffer(pages, dtype).reshape(shape)
