"""The decorator of engine functions: compiled once, kept on disk, never stale."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

from ryusa.laws._law import EDITION

F = TypeVar("F", bound=Callable[..., Any])
FAST = {"contract", "nsz"}  # fused multiply-add and no care for the sign of zero; nothing that hides a NaN


def _edition() -> str:
    digest = hashlib.sha256(EDITION.encode())
    for room in (Path(__file__).parent, Path(__file__).parent.parent / "model"):
        for file in sorted(room.glob("*.py")):
            digest.update(file.read_bytes())
    return digest.hexdigest()


_EDITION = _edition()


def kernel(**options: Any) -> Callable[[F], F]:
    """Compile a function when first called; the text of laws, model and engine is part of its key on disk.

    Numba looks at the function's own file alone, and would go on calling an old law from another file.
    """

    def decorate(function: F) -> F:
        dispatcher: Any = numba.njit(error_model="numpy", cache=True, **options)(function)
        cache: Any = getattr(dispatcher, "_cache", None)
        if hasattr(cache, "_index_key"):
            key = cache._index_key
            cache._index_key = lambda sig, codegen: (*key(sig, codegen), _EDITION)
        return cast(F, dispatcher)

    return decorate
