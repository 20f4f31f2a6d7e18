"""The decorator of all laws: one text for the CPU engine, for CUDA kernels and for plain Python."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core.caching import IndexDataCacheFile

F = TypeVar("F", bound=Callable[..., Any])


def edition(*texts: Path) -> str:
    """Digest of the text of files, and of all Python files in and below folders."""
    digest = hashlib.sha256()
    for text in texts:
        for file in sorted(text.rglob("*.py")) if text.is_dir() else [text]:
            digest.update(file.read_bytes())
    return digest.hexdigest()


LAWS = Path(__file__).parent
FAST = {"contract", "nsz"}  # fused multiply-add, sign of zero ignored; no flag that hides a NaN
EDITION = edition(LAWS)


class _CacheFile(IndexDataCacheFile):
    """Compiled code of one function on disk, which is given out only for what it was compiled for.

    Two processes that compile a function for different types at the same time give their code the same
    number; the later index may then point to the earlier code. So the code carries its own key.
    """

    def __init__(self, kept: Any, base: str, edition: str) -> None:
        super().__init__(kept._cache_path, base, kept._source_stamp)
        self._version = f"{kept._version} {edition}"

    def save(self, key: Any, data: Any) -> None:
        """Write code and the key that it answers."""
        super().save(key, (self._version, key, data))

    def load(self, key: Any) -> Any:
        """Read the code of a key; None, so that it is compiled, where that on disk is of another."""
        found = super().load(key)
        return found[2] if found is not None and found[:2] == (self._version, key) else None


def compiled(edition: str | None, **options: Any) -> Callable[[F], F]:
    """Compile a function at its first call, and cache it on disk as long as its edition is the same.

    Without an edition there is no cache: Numba cannot cache a function whose closure holds compiled
    functions.

    Typed as identity, so that the signature survives. Numba checks its cache against the file of the function
    alone, and would keep calling an outdated law from another file. The edition is therefore added to
    the version that Numba compares before it reads the cache. This relies on private parts of Numba, which
    tests/laws/test_cache.py tests.

    A function has no `fastmath` and is not inlined by force unless the options say so. Numba would take both
    from the function that calls it first, and keep the result for all callers: the last bits of a run would
    depend on what ran before it on the machine. Inlining matters even where there is no `fastmath`: where
    the same product stands in a function and in a caller that fuses its own, LLVM makes one of the two,
    which is then not fused.
    """
    options = {"fastmath": False, "forceinline": False} | options

    def decorate(function: F) -> F:
        dispatcher: Any = numba.njit(error_model="numpy", cache=edition is not None, **options)(function)
        cache: Any = getattr(dispatcher, "_cache", None)
        if edition is not None and getattr(cache, "_cache_file", None) is not None:
            cache._cache_file = _CacheFile(cache._cache_file, cache._impl.filename_base, edition)
        return cast(F, dispatcher)

    return decorate


def law(function: F) -> F:
    """Compile a scalar law at its first call; compiled functions that call it have it inlined.

    With `error_model="numpy"` a division by zero gives inf or nan: laws never raise, and the engine stops on
    a number that is not finite.
    """
    return compiled(EDITION, forceinline=True)(function)


def step_law(function: F) -> F:
    """Compile a law that the kernels of every engine evaluate for each contact or grain in each step.

    Inlined and with fused multiply-adds, as in the kernels themselves, so that a loop over pairs or grains
    becomes vector instructions. The laws that it calls may be compiled by `law`.
    """
    return compiled(EDITION, fastmath=FAST, forceinline=True)(function)
