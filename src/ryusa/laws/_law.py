"""The decorator every law carries: one text for the CPU engine, for CUDA kernels and for plain Python."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


def _edition() -> str:
    """Digest of the text of all laws."""
    digest = hashlib.sha256()
    for file in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(file.read_bytes())
    return digest.hexdigest()


EDITION = _edition()


def law(function: F) -> F:
    """Compile a scalar law when it is first called; typed as identity so that the signature survives.

    `error_model="numpy"` makes a division by zero give inf or nan instead of raising: laws never raise, and
    the engine stops on a number that is not finite. `fastmath=False` is said aloud because Numba would
    otherwise take it from whichever kernel calls the law first, and keep that in the cache for everybody.
    """
    dispatcher: Any = numba.njit(error_model="numpy", fastmath=False, cache=True)(function)
    # Numba's cache looks at the file of the law alone and would keep an old law called from another file: the
    # text of all laws goes into its key. Private to Numba, so tests/laws/test_cache.py watches it.
    cache: Any = getattr(dispatcher, "_cache", None)
    if hasattr(cache, "_index_key"):
        key = cache._index_key
        cache._index_key = lambda sig, codegen: (*key(sig, codegen), EDITION)
    return cast(F, dispatcher)
