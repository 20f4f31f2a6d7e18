"""A kernel that copies an array: the bandwidth that a card's memory reaches. For card.py."""

import time
from typing import Any

import numpy as np
from numba import cuda

REPEATS = 5


@cuda.jit
def copy(a: Any, b: Any) -> None:
    """Copy a to b."""
    for k in range(cuda.grid(1), a.shape[0], cuda.gridsize(1)):
        b[k] = a[k]


def bandwidth(size: int, blocks: int, threads: int) -> dict[str, Any]:
    """What copying an array of `size` doubles moves, read and written."""
    a, b = (cuda.to_device(np.zeros(size)) for _ in range(2))
    taken: list[float] = []
    for _ in range(REPEATS + 1):
        cuda.synchronize()
        begun = time.perf_counter()
        copy[blocks, threads](a, b)
        cuda.synchronize()
        taken.append(time.perf_counter() - begun)
    return {"copying GB/s": 16e-9 * size / min(taken[1:])}
