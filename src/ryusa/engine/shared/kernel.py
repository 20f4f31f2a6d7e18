"""The decorator of engine functions: compiled once, kept on disk, never stale."""

import gc
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from ryusa.laws._law import FAST, LAWS, compiled, edition

_RARELY = 50_000, 20, 100  # thresholds of the garbage collector: a compiler makes many objects that all stay

F = TypeVar("F", bound=Callable[..., Any])

__all__ = ["FAST", "collecting_rarely", "inner", "kernel"]

_ENGINE = Path(__file__).parents[1]
# A kernel of one room is inlined into kernels of the other: both have one edition, and that of CUDA none.
_EDITION = edition(LAWS, _ENGINE / "shared", _ENGINE / "cpu", _ENGINE.parent / "model")


def kernel(**options: Any) -> Callable[[F], F]:
    """Compile a function when first called; the text of laws, model and engine is its edition."""
    return compiled(_EDITION, **options)


def inner(**options: Any) -> Callable[[F], F]:
    """A kernel that only kernels call: inlined unless told otherwise, and without an entry from Python."""
    return kernel(no_cpython_wrapper=True, no_cfunc_wrapper=True, **{"forceinline": True} | options)


@contextmanager
def collecting_rarely() -> Generator[None]:
    """Let the garbage collector run seldom while kernels are compiled, which it slows down by a seventh."""
    before = gc.get_threshold()
    gc.set_threshold(*_RARELY)
    try:
        yield
    finally:
        gc.set_threshold(*before)
