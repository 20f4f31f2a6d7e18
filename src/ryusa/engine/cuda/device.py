"""numba-cuda as this room uses it."""

from collections.abc import Callable
from importlib import import_module
from types import CellType, FunctionType
from typing import Any, TypeVar

from ryusa.engine.cuda.availability import simulated
from ryusa.laws import _family

F = TypeVar("F", bound=Callable[..., Any])

cuda: Any = import_module("numba.cuda")  # its own types do not know what a kernel may say
if not simulated():  # few grains fill no card, and the user need not be told at each launch
    settings: Any = import_module("numba.cuda.core.config")
    settings.CUDA_LOW_OCCUPANCY_WARNINGS = 0


def device(function: F) -> F:
    """A function that kernels call."""
    return cuda.jit(device=True)(function)


def on_device(function: F) -> F:
    """The text of a function of the CPU engine, compiled for the device; laws need no such help."""
    return device(_plain(function) if simulated() else _text(function))


def _text(function: Any) -> Any:
    return function.py_func


def _plain(function: Any) -> Any:
    """The text with what it calls of the engine as text too: compiled, it knows no array of the simulator."""
    text = _text(function)
    known = dict(text.__globals__)
    for name in text.__code__.co_names:
        one = known.get(name)
        if hasattr(one, "py_func") and one.__module__.startswith("ryusa.engine"):
            known[name] = _plain(one)
        elif name in known:
            known[name] = _choice(one)
    return FunctionType(text.__code__, known, text.__name__, text.__defaults__, text.__closure__)


def _choice(one: Any) -> Any:
    """The text of a choice among laws, which no cache keeps and every process would compile; else as given.

    The laws themselves stay compiled.
    """
    text = getattr(one, "py_func", None)
    if text is None or text.__module__ != _family.__name__:
        return one
    held = tuple(CellType(_choice(cell.cell_contents)) for cell in text.__closure__ or ())
    return FunctionType(text.__code__, text.__globals__, text.__name__, text.__defaults__, held)
