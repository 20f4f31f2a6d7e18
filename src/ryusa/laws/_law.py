"""The decorator of all laws: one text for the CPU engine, for CUDA kernels and for plain Python."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

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


def compiled(edition: str | None, **options: Any) -> Callable[[F], F]:
    """Compile a function at its first call, and cache it on disk as long as its edition is the same.

    Without an edition there is no cache: Numba cannot cache a function whose closure holds compiled
    functions.

    Typed as identity, so that the signature survives. Numba checks its cache against the file of the function
    alone, and would keep calling an outdated law from another file. The edition is therefore added to
    the version that Numba compares before it reads the cache. This relies on private parts of Numba, which
    tests/laws/test_cache.py tests.
    """

    def decorate(function: F) -> F:
        dispatcher: Any = numba.njit(error_model="numpy", cache=edition is not None, **options)(function)
        kept: Any = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
        if kept is not None:
            kept._version = f"{kept._version} {edition}"
        return cast(F, dispatcher)

    return decorate


def law(function: F) -> F:
    """Compile a scalar law at its first call.

    With `error_model="numpy"` a division by zero gives inf or nan: laws never raise, and the engine stops on
    a number that is not finite. `fastmath=False` is explicit because Numba would otherwise take the flags of
    the kernel that calls the law first, and cache the result for all callers.
    """
    return compiled(EDITION, fastmath=False)(function)


def step_law(function: F) -> F:
    """Compile a law that the kernels of every engine evaluate for each contact or grain in each step.

    Inlined and with fused multiply-adds, as in the kernels themselves, so that a loop over pairs or grains
    becomes vector instructions. The laws that it calls may be compiled by `law`.
    """
    return compiled(EDITION, fastmath=FAST, forceinline=True)(function)
