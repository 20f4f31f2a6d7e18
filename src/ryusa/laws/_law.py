"""The decorator every law carries: one text for the CPU engine, for CUDA kernels and for plain Python."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


def law(function: F) -> F:
    """Compile a scalar law when it is first called; typed as identity so that the signature survives.

    `error_model="numpy"` makes a division by zero give inf or nan instead of raising: laws never raise, and
    the engine stops on a number that is not finite. `fastmath=False` is said aloud because Numba would
    otherwise take it from whichever kernel calls the law first, and keep that in the cache for everybody.
    """
    return cast(F, numba.njit(error_model="numpy", fastmath=False, cache=True)(function))
