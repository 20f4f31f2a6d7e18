"""Many steps launched at once, as a graph that the card works through by itself.

Numba takes the 200 arguments of a step apart in Python at each launch, 0.25 ms a step: a graph of steps does
it once. It holds the addresses of the arrays, so that other arrays need one of their own.
"""

from collections.abc import Callable
from importlib import import_module
from typing import Any

from ryusa.engine.cuda.availability import simulated
from ryusa.engine.cuda.device import cuda

STEPS = 16  # of one graph
_KEPT = 2  # grains lie in one of two orders


class StepGraphs:
    """Graphs of STEPS steps, for the arrays in use."""

    def __init__(self) -> None:
        self._kept: dict[tuple[int, int], _Graph] = {}
        self._stream: Any = None if simulated() else cuda.stream()

    def launch(self, arrays: tuple[int, int], launch_step: Callable[[Any], None]) -> None:
        """Do STEPS steps on these arrays (DeviceState.arrays); `launch_step` launches one on a stream."""
        if self._stream is None:
            for _ in range(STEPS):
                launch_step(0)
            return
        if arrays not in self._kept:
            while len(self._kept) >= _KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[arrays] = self._captured(launch_step)
        self._kept[arrays].launch(int(self._stream.handle))

    def _captured(self, launch_step: Callable[[Any], None]) -> "_Graph":
        driver, stream = _driver(), int(self._stream.handle)
        _checked(
            driver.cuStreamBeginCapture(stream, driver.CUstreamCaptureMode.CU_STREAM_CAPTURE_MODE_RELAXED)
        )
        try:
            for _ in range(STEPS):
                launch_step(self._stream)
        finally:
            graph = _checked(driver.cuStreamEndCapture(stream))
        executable = _checked(driver.cuGraphInstantiate(graph, 0))
        _checked(driver.cuGraphDestroy(graph))
        return _Graph(executable)


class _Graph:
    """A graph that can be launched."""

    def __init__(self, executable: Any) -> None:
        self._executable = executable

    def launch(self, stream: int) -> None:
        _checked(_driver().cuGraphLaunch(self._executable, stream))

    def __del__(self) -> None:
        _driver().cuGraphExecDestroy(self._executable)


def _driver() -> Any:
    return import_module("cuda.bindings.driver")


def _checked(answer: tuple[Any, ...]) -> Any:
    """What a call of the driver gave beside its error code."""
    code, *given = answer
    if code != _driver().CUresult.CUDA_SUCCESS:
        raise RuntimeError(f"the CUDA driver answers {code.name} to a graph of steps")
    return given[0] if given else None
