"""The engines by name: where each one is, whether it can be used here, and what it is for.

The table has one line for each engine; its module is imported when it is first created. A program registers
an engine of its own the same way:

>>> register("mirror", "ryusa.engine.cpu.engine:CpuEngine", "an example")
>>> names()
('cpu', 'cuda', 'mirror')
>>> forget("mirror")
"""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

from ryusa.errors import CaseError
from ryusa.spelling import nearest_word

if TYPE_CHECKING:
    from ryusa.engine.protocol import Engine

DEFAULT = "cpu"


@dataclass(frozen=True)
class EngineEntry:
    """One line of the table.

    Attributes
    ----------
    path : "module:class"; a class that takes threads has a parameter of that name.
    summary : one line for help and reports.
    threaded : whether it shares its work among threads.
    probe : "module:function" that returns why the engine cannot be used here, "" where it can; "" is always.
    device : "module:function" that names the device that it would use; "" for the processor.
    """

    path: str
    summary: str
    threaded: bool = False
    probe: str = ""
    device: str = ""


_ENGINES: dict[str, EngineEntry] = {}


def register(
    name: str, path: str, summary: str, *, threaded: bool = False, probe: str = "", device: str = ""
) -> None:
    """Add an engine to the table; see `EngineEntry`.

    Raises
    ------
    ValueError : the name is taken.
    """
    if name in _ENGINES:
        raise ValueError(f"an engine named {name!r} is registered already: {_ENGINES[name].path}")
    _ENGINES[name] = EngineEntry(path, summary, threaded, probe, device)


def forget(name: str) -> None:
    """Remove an engine from the table."""
    del _ENGINES[name]


register("cpu", "ryusa.engine.cpu.engine:CpuEngine", "threads of the processor", threaded=True)
register(
    "cuda", "ryusa.engine.cuda.engine:CudaEngine", "an NVIDIA card",
    probe="ryusa.engine.cuda.availability:unavailable", device="ryusa.engine.cuda.availability:device_name",
)  # fmt: skip


def names() -> tuple[str, ...]:
    """Names of all engines, in the order of the table."""
    return tuple(_ENGINES)


def summary() -> str:
    """All engines in one line, for help.

    >>> summary()
    'cpu (threads of the processor) or cuda (an NVIDIA card)'
    """
    return " or ".join(f"{name} ({one.summary})" for name, one in _ENGINES.items())


def entry(name: str) -> EngineEntry:
    """The line of one engine.

    Raises
    ------
    CaseError : no engine has this name; says which there are, and the nearest.

    Examples
    --------
    >>> entry("cuad")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    ryusa.errors.CaseError: engine = 'cuad': must be cpu (...) or cuda (an NVIDIA card). Did you mean 'cuda'?
    """
    if name not in _ENGINES:
        raise CaseError("engine", name, f"must be {summary()}", nearest_word(name, names()))
    return _ENGINES[name]


def unavailable(name: str) -> str:
    """Why an engine cannot be used here, in one line; "" where it can."""
    probe = entry(name).probe
    return _imported(probe)() if probe else ""


def device_of(name: str) -> str:
    """Device that an engine would use, where it is not the processor; only where it is available."""
    device = entry(name).device
    return _imported(device)() if device else ""


def create(name: str = DEFAULT, *, threads: int = 1, **options: Any) -> "Engine":
    """Create an engine by its name.

    Parameters
    ----------
    threads : threads of an engine that shares its work among them; others ignore it.
    options : passed on to the class of the engine.

    Raises
    ------
    CaseError : no engine has this name, it cannot be used here, or there are no threads.
    """
    found = entry(name)
    if threads < 1:
        raise CaseError("threads", threads, "must be at least 1")
    reason = unavailable(name)
    if reason:
        raise CaseError("engine", name, reason)
    if found.threaded:
        options["threads"] = threads
    return _imported(found.path)(**options)


def _imported(path: str) -> Callable[..., Any]:
    module, _, name = path.partition(":")
    return getattr(import_module(module), name)
