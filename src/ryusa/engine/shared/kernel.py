"""The decorator of engine functions: compiled once, kept on disk, never stale."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from ryusa.laws._law import FAST, LAWS, compiled, edition

F = TypeVar("F", bound=Callable[..., Any])

__all__ = ["FAST", "inner", "kernel"]

_ENGINE = Path(__file__).parents[1]
# A kernel of one room is inlined into kernels of the other: both have one edition, and that of CUDA none.
_EDITION = edition(LAWS, _ENGINE / "shared", _ENGINE / "cpu", _ENGINE.parent / "model")


def kernel(**options: Any) -> Callable[[F], F]:
    """Compile a function when first called; the text of laws, model and engine is its edition."""
    return compiled(_EDITION, **options)


def inner(**options: Any) -> Callable[[F], F]:
    """A kernel that only kernels call: without an entry from Python, which takes its time to compile."""
    return kernel(no_cpython_wrapper=True, no_cfunc_wrapper=True, **options)
