"""Memory for arrays: zeros at a cache line, and no more of it than is written."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest

from ryusa.engine.shared.array_memory import unwritten, zeros

MANY = 4 << 20  # doubles


@pytest.mark.parametrize("made", [zeros, unwritten])
@pytest.mark.parametrize("shape", [(0,), (3,), (5, 8), (100_000, 4)])
@pytest.mark.parametrize("dtype", [np.uint8, np.int32, np.float64])
def test_arrays_are_zero_and_begin_at_a_cache_line(made, shape, dtype):
    array = made(dtype, *shape)
    assert array.shape == shape and array.dtype == dtype
    assert (
        array.flags.c_contiguous and array.flags.writeable and (not array.size or array.ctypes.data % 64 == 0)
    )
    assert not array.any()


def resident() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc/self/statm, which Linux alone has")
def test_only_what_is_written_takes_memory_and_it_is_given_back():
    before = resident()
    array = unwritten(np.float64, MANY)
    array[: MANY // 8] = 1.0
    assert 0.9 * MANY < resident() - before < 2.0 * MANY  # an eighth of 8 bytes each, not all of them
    del array
    assert resident() - before < 0.5 * MANY
    array = zeros(np.float64, MANY)
    array[:] = 1.0
    assert resident() - before > 7.0 * MANY
    del array
    assert resident() - before < 0.5 * MANY
