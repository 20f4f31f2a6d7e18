"""The decorators of engine functions."""

from collections.abc import Callable
from typing import Any, TypeVar

from ryusa.compiled.function import FAST, compiled

F = TypeVar("F", bound=Callable[..., Any])

__all__ = ["FAST", "inner", "kernel"]


def kernel(**options: Any) -> Callable[[F], F]:
    """Compile a function when first called."""
    return compiled(**options)


def inner(**options: Any) -> Callable[[F], F]:
    """A kernel that only kernels call: inlined unless told otherwise."""
    return compiled(**{"forceinline": True} | options)
