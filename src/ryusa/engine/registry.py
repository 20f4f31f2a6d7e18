"""The engines by name: where each one is, whether it can be used here, and what it is for.

The table has one line for each engine; its module is imported when it is first created. A program registers
an engine of its own the same way:

>>> register("mirror", "ryusa.engine.cpu.engine:CpuEngine", "an example")
>>> names()
('cpu', 'cuda', 'lammps', 'mirror')
>>> forget("mirror")
"""

from collections.abc import Callable, Generator
from contextlib import contextmanager
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
    leading : "module:function" that returns a context manager, for an engine that shares a run among
        processes started together: it gives True in the one that leads, and False in one that has done what
        the leader said; "" for an engine of one process.
    exact_resume : whether a resumed run has the bits of one that was not interrupted.
    remarks : what the log of every run has to say of the engine.
    """

    path: str
    summary: str
    threaded: bool = False
    probe: str = ""
    device: str = ""
    leading: str = ""
    exact_resume: bool = True
    remarks: tuple[str, ...] = ()


_ENGINES: dict[str, EngineEntry] = {}


def register(
    name: str, path: str, summary: str, *, threaded: bool = False, probe: str = "", device: str = "",
    leading: str = "", exact_resume: bool = True, remarks: tuple[str, ...] = (),
) -> None:  # fmt: skip
    """Add an engine to the table; see `EngineEntry`.

    Raises
    ------
    ValueError : the name is taken.
    """
    if name in _ENGINES:
        raise ValueError(f"an engine named {name!r} is registered already: {_ENGINES[name].path}")
    _ENGINES[name] = EngineEntry(path, summary, threaded, probe, device, leading, exact_resume, remarks)


def forget(name: str) -> None:
    """Remove an engine from the table."""
    del _ENGINES[name]


register("cpu", "ryusa.engine.cpu.engine:CpuEngine", "threads of the processor", threaded=True)
register(
    "cuda", "ryusa.engine.cuda.engine:CudaEngine", "an NVIDIA card",
    probe="ryusa.engine.cuda.availability:unavailable", device="ryusa.engine.cuda.availability:device_name",
)  # fmt: skip
register(
    "lammps", "ryusa.engine.lammps.engine:LammpsEngine", "LAMMPS, alone or under mpirun",
    probe="ryusa.engine.lammps.availability:unavailable",
    device="ryusa.engine.lammps.availability:device_name", leading="ryusa.engine.lammps.ranks:leading",
    exact_resume=False,
    remarks=(
        "LAMMPS takes slip, and torques at planes, at the radius, the CPU engine at half of the overlap; "
        "docs/big-runs.md lists what else differs along a contact",
        "LAMMPS is inspected every 1,000 steps and at frames (overlaps, speeds, places); it has no records "
        "of contacts and no account of energy by cause, and a resume is not bit for bit (docs/big-runs.md)",
    ),
)  # fmt: skip


def names() -> tuple[str, ...]:
    """Names of all engines, in the order of the table."""
    return tuple(_ENGINES)


def summary() -> str:
    """All engines in one line, for help.

    >>> summary()
    'cpu (threads of the processor), cuda (an NVIDIA card) or lammps (LAMMPS, alone or under mpirun)'
    """
    *most, last = (f"{name} ({one.summary})" for name, one in _ENGINES.items())
    return f"{', '.join(most)} or {last}"


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
    ryusa.errors.CaseError: engine = 'cuad': must be cpu (...) or lammps (...). Did you mean 'cuda'?
    """
    if name not in _ENGINES:
        raise CaseError("engine", name, f"must be {summary()}", nearest_word(name, names()))
    return _ENGINES[name]


def known(name: object) -> EngineEntry:
    """The line of an engine by a name that may be unknown, as in a run folder."""
    return _ENGINES.get(str(name), EngineEntry("", ""))


def unavailable(name: str) -> str:
    """Why an engine cannot be used here, in one line; "" where it can."""
    probe = entry(name).probe
    return _imported(probe)() if probe else ""


def device_of(name: str) -> str:
    """Device that an engine would use, where it is not the processor; only where it is available."""
    device = entry(name).device
    return _imported(device)() if device else ""


@contextmanager
def leading(name: str) -> Generator[bool]:
    """False in a process that is another's to lead, once that one is done; True in all others."""
    found = known(name).leading
    if not found or unavailable(name):
        yield True
        return
    with _imported(found)() as leads:
        yield leads


def refuse_threads(threads: int) -> None:
    """Raise a CaseError where there are no threads."""
    if threads < 1:
        raise CaseError("threads", threads, "must be at least 1")


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
    refuse_threads(threads)
    reason = unavailable(name)
    if reason:
        raise CaseError("engine", name, reason)
    if found.threaded:
        options["threads"] = threads
    return _imported(found.path)(**options)


def _imported(path: str) -> Callable[..., Any]:
    module, _, name = path.partition(":")
    return getattr(import_module(module), name)
