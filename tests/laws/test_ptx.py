"""Every law also compiles for CUDA, without a graphics card: only the compiler's wheels are needed."""

import importlib
import math
from types import SimpleNamespace

import pytest
from numba import types

pytest.importorskip("numba_cuda", reason="CUDA's compiler is an extra")
cuda = pytest.importorskip("numba.cuda")

CC = (8, 0)  # compute capability compiled for
LABEL = {float: types.float64, bool: types.boolean}


@pytest.fixture(autouse=True)
def card(monkeypatch):
    """Stand for the card that numba-cuda asks when one law calls another; nothing is ever run on it."""
    dispatcher = importlib.import_module("numba.cuda.dispatcher")
    monkeypatch.setattr(dispatcher, "get_current_device", lambda: SimpleNamespace(compute_capability=CC))


@pytest.mark.full
def test_a_law_compiles_to_ptx(law):
    signature = tuple(LABEL[kind] for kind in law.kinds)
    ptx, answer = cuda.compile(law.plain, signature, device=True, abi="numba", cc=CC)
    assert ".target sm_80" in ptx
    assert answer in (types.float64, types.boolean) or set(answer.types) == {types.float64}


def test_a_kernel_calls_the_same_objects(laws):
    swing = laws["collision.restitution_no_tension"].compiled
    push = laws["geometry.turn"].compiled

    def kernel(x):
        k = cuda.grid(1)
        a, b, c = push(x[k], 0.0, 0.0, 0.0, 0.0, 1.0, 0.1)
        x[k] = swing(a) + b + c

    ptx, _ = cuda.compile(kernel, types.void(types.float64[::1]), device=False, abi="numba", cc=CC)
    assert ".entry" in ptx
    assert math.isfinite(swing(0.1))
