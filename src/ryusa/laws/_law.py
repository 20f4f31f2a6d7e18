"""The decorator every law carries: one text for the CPU engine, for CUDA kernels and for plain Python."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


def edition(*texts: Path) -> str:
    """Digest of the text of files, and of all Python files in folders and in those below them."""
    digest = hashlib.sha256()
    for text in texts:
        for file in sorted(text.rglob("*.py")) if text.is_dir() else [text]:
            digest.update(file.read_bytes())
    return digest.hexdigest()


LAWS = Path(__file__).parent
FAST = {"contract", "nsz"}  # fused multiply-add and no care for the sign of zero; nothing that hides a NaN
EDITION = edition(LAWS)


def compiled(edition: str | None, **options: Any) -> Callable[[F], F]:
    """Compile a function when it is first called, and keep it on disk as long as its edition is the same.

    Without an edition it is not kept: Numba cannot keep what was built from other compiled functions.

    Typed as identity, so that the signature survives. Numba's cache looks at the function's own file alone
    and would go on calling an old law from another file: the edition becomes a part of the version that it
    compares before it reads what it kept. That is private to Numba, so tests/laws/test_cache.py watches it.
    """

    def decorate(function: F) -> F:
        dispatcher: Any = numba.njit(error_model="numpy", cache=edition is not None, **options)(function)
        kept: Any = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
        if kept is not None:
            kept._version = f"{kept._version} {edition}"
        return cast(F, dispatcher)

    return decorate


def law(function: F) -> F:
    """Compile a scalar law when it is first called.

    `error_model="numpy"` makes a division by zero give inf or nan instead of raising: laws never raise, and
    the engine stops on a number that is not finite. `fastmath=False` is said aloud because Numba would
    otherwise take it from whichever kernel calls the law first, and keep that in the cache for everybody.
    """
    return compiled(EDITION, fastmath=False)(function)


def step_law(function: F) -> F:
    """Compile the step of a contact or of a grain, one text that the kernels of every engine call.

    Inlined and with fused multiply-adds, as the kernels themselves are, so that a loop over pairs becomes
    vector instructions. The laws it calls are compiled as `law` says.
    """
    return compiled(EDITION, fastmath=FAST, forceinline=True)(function)
