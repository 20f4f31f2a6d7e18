"""The decorators of all laws: one text for the CPU engine, for CUDA kernels and for plain Python."""

from collections.abc import Callable
from typing import Any, TypeVar

from ryusa.compiled.function import FAST, compiled_law

F = TypeVar("F", bound=Callable[..., Any])


def law(function: F) -> F:
    """A scalar law; compiled functions that call it have it inlined.

    Compiled, a division by zero gives inf or nan, and Python gets the same: laws never raise, and the engine
    stops on a number that is not finite.
    """
    return compiled_law(forceinline=True)(function)


def step_law(function: F) -> F:
    """A law that the kernels of every engine evaluate for each contact or grain in each step.

    Inlined and with fused multiply-adds, as in the kernels themselves, so that a loop over pairs or grains
    becomes vector instructions. The laws that it calls may be compiled by `law`.
    """
    return compiled_law(fastmath=FAST, forceinline=True)(function)


def step_law_of_bits(here: Callable[..., Any]) -> Callable[[F], F]:
    """A law of `step_law` that works on the bits of a number, in place of which Python calls `here`."""
    return compiled_law(here, fastmath=FAST, forceinline=True)
