"""numba-cuda as this room uses it."""

from collections.abc import Callable
from importlib import import_module
from types import FunctionType
from typing import Any, TypeVar

from ryusa.engine.cuda.availability import simulated

F = TypeVar("F", bound=Callable[..., Any])

cuda: Any = import_module("numba.cuda")  # its own types do not know what a kernel may say


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
    return FunctionType(text.__code__, known, text.__name__, text.__defaults__, text.__closure__)
