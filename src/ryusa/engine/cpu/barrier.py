"""A spin barrier for threads inside one compiled call.

A launch of numba's own parallel loops costs from 2 us (omp) to 460 us (tbb); 2,000 grains step in 100.
So threads are plain Python threads that run one compiled function without the GIL and wait at this barrier,
which costs well under a microsecond when every thread has a core.
"""

import sys
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from ryusa.engine.shared.kernel import inner

_yield_core: Any = types.ExternalFunction("sched_yield", types.int32()) if sys.platform != "win32" else None
_SPINS = 4000  # reads of the counter before the core is offered to others


@intrinsic
def _add(typingctx: Any, array: Any, value: Any) -> Any:
    """Atomically add `value` to array[0] (int64)."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        return builder.atomic_rmw("add", data, args[1], "seq_cst")

    return types.int64(array, types.int64), codegen


@intrinsic
def _load(typingctx: Any, array: Any) -> Any:
    """Atomically read array[0] (int64)."""

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        load = builder.load_atomic(data, "seq_cst", 8)
        assert load.type == ir.IntType(64)
        return load

    return types.int64(array), codegen


@inner(forceinline=False)
def wait(count: Any, n_threads: int, target: int) -> int:
    """Wait until all threads have arrived; returns the target of the next call.

    Parameters
    ----------
    count : int64 array of one element, shared by the threads, 0 before the first call.
    n_threads : number of threads; with 1 it returns at once.
    target : 0 at first, then what the last call returned.
    """
    if n_threads == 1:
        return 0
    target += n_threads
    _add(count, 1)  # pyright: ignore[reportCallIssue]  (numba fills in the typing context)
    spins = 0
    while _load(count) < target:
        spins += 1
        if spins > _SPINS:
            spins = 0
            if _yield_core is not None:
                _yield_core()
    return target
