"""What is being compiled in this process, how long that took, and about how much is left.

Functions are compiled while the one that calls them is: each has the seconds of its own, and nothing is
counted twice. What is left is a sum over the functions that are called and have not been met: with the
seconds that each took on this machine, or by the size of its bytecode where it never was compiled here,
times what the functions of this process took over what was expected of them.
"""

import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from itertools import zip_longest
from types import MappingProxyType

from ryusa.compiled import store, tiers
from ryusa.compiled.content import Compilable, UnknownContentError, latest
from ryusa.compiled.seconds import Seconds

# Seconds for each byte of a function's bytecode and of all that it may call, as the saltation case took on
# one core of an AMD EPYC (Zen 5): with half of the functions that the text names not needed.
_A_BYTE = {"inner": (0.09e-3, 0.0), "entry": (0.25e-3, 0.02e-3), "piece": (0.25e-3, 0.02e-3)}
DIGITS = 16  # of a content that tell it from all others
_UNSURE = 2.0  # seconds that must have been compiled before their pace counts for as much as the record

_Key = tuple[str, Compilable]  # kind (`entry`, `piece` or `inner`) and function


@dataclass
class _Open:
    """A function that is being loaded or compiled."""

    key: _Key
    began: float  # [s] of the wall clock
    began_own: float  # [s] of the processor
    inside: float = 0.0  # wall time of functions within it
    inside_own: float = 0.0
    compiles: bool = False  # no store has it
    elsewhere: bool = False  # another process compiles it, and remembers its seconds


@dataclass(frozen=True)
class Done:
    """What has been compiled in a process.

    Attributes
    ----------
    functions : with those that are built into them.
    wall : wall time [s], with what is compiled at this moment.
    """

    functions: int = 0
    wall: float = 0.0

    def since(self, earlier: "Done") -> "Done":
        """What was compiled after an earlier moment."""
        return Done(self.functions - earlier.functions, self.wall - earlier.wall)


Listener = Callable[[str | None], None]  # told the name of an entry or a piece; None when it is done


class _Process:
    """The state of this process; changed only by the thread that holds Numba's lock."""

    def __init__(self) -> None:
        self.open: list[_Open] = []
        self.done = Done()
        self.met: set[_Key] = set()
        self.left: dict[_Key | str, float] = {}  # expected seconds of what has not been met; by name if new
        self.expected = self.took = 0.0  # [s] of what has been compiled
        self.own: dict[str, float] = {}  # by kind and name, since the record was last written
        self.contents: list[str] = []
        self.listeners: list[tuple[Listener, Mapping[str, float]]] = []
        self.beside: dict[_Key, float] = {}  # compiled by another process: when it will be there [s]


_now = _Process()


def compiled_beside(pieces: Sequence[Compilable]) -> None:
    """Another process has begun to compile pieces, one after the other."""
    end = time.perf_counter()
    for function in pieces:
        name = f"piece {function.name}"
        expected = next((known[name] for _, known in _now.listeners if name in known), 0.0)
        end += _record().by_name.get(f"whole {name}", expected)
        _now.beside["piece", function] = end


def done_by_another_process() -> None:
    """The function asked for last is waited for."""
    own = _now.open[-1]
    own.compiles = own.elsewhere = True
    _tell(own.key[1].name)


def done() -> Done:
    """What has been compiled so far."""
    stack, found = list(_now.open), _now.done
    if not stack or not stack[0].compiles:
        return found
    return Done(found.functions, found.wall + time.perf_counter() - stack[0].began)


def left() -> float:
    """About how much wall time [s] compiling takes yet; 0 where it takes longer than was expected."""
    stack, plan = list(_now.open), dict(_now.left)
    scale = (_now.took + _UNSURE) / (_now.expected + _UNSURE)
    total = scale * sum(seconds for key, seconds in plan.items() if key not in {one.key for one in stack})
    for one, inner in zip_longest(stack, stack[1:]):
        end = time.perf_counter() if inner is None else inner.began
        total += max(0.0, scale * plan.get(one.key, 0.0) - (end - one.began - one.inside))
    return max(total, *(end - time.perf_counter() for end in _now.beside.values()), 0.0)


def at_most(expected: Mapping[str, float]) -> float:
    """Processor time [s] that compiling some functions takes where the store has none of them.

    Parameters
    ----------
    expected : as of `told`; what comes with a package takes none.
    """
    by_name, packaged = _record().by_name, _packaged()
    return sum(
        by_name.get(f"whole {name}", seconds) for name, seconds in expected.items() if name not in packaged
    )


@contextmanager
def told(listener: Listener, expected: Mapping[str, float] = MappingProxyType({})) -> Generator[None]:
    """Tell a listener of each entry and each piece that is compiled.

    Parameters
    ----------
    listener : called in the thread that compiles, before and after.
    expected : functions that will be asked for, by kind and name, with the processor time [s] that each
        takes with all that it calls, where this machine knows no better; they count as left.
    """
    entry = (listener, expected)
    _now.listeners.append(entry)
    try:
        yield
    finally:
        _now.listeners.remove(entry)


@contextmanager
def asked(function: Compilable, kind: str) -> Generator[None]:
    """Load or compile a function of a kind within this block."""
    own = _Open((kind, function), time.perf_counter(), time.thread_time())
    _now.open.append(own)
    try:
        yield
    except BaseException:
        _close(own, whole=False)
        raise
    _close(own, whole=True)


def missed() -> None:
    """No store has the function asked for last: it is compiled now."""
    own = _now.open[-1]
    own.compiles = True
    if own.key not in _now.left:
        _plan(own.key)
    if len(_now.open) == 1:
        _tell(own.key[1].name)


def own_seconds() -> float:
    """Processor time [s] of the function asked for last, without the functions compiled within it."""
    own = _now.open[-1]
    return time.thread_time() - own.began_own - own.inside_own


def _close(own: _Open, *, whole: bool) -> None:
    wall, seconds = time.perf_counter() - own.began, time.thread_time() - own.began_own
    _now.open.pop()
    if _now.open:
        _now.open[-1].inside += wall
        _now.open[-1].inside_own += seconds
    kind, function = own.key
    _now.met.add(own.key)
    _now.beside.pop(own.key, None)
    if own.elsewhere:
        _now.done = Done(_now.done.functions + 1, _now.done.wall + wall)
        _tell(None)
        return
    expected = 0.0
    if _now.left:  # what it calls and has not asked for is not needed
        over = {own.key, *(("inner", one) for one in _reach(function))}
        expected = sum(_now.left.pop(key, 0.0) for key in over)
    if own.compiles:
        _now.expected += expected
        _now.took += wall - own.inside
        if whole:
            name = f"{kind} {function.name}"
            _now.own[name] = _now.own.get(name, 0.0) + seconds - own.inside_own
            _now.contents += _content(own.key)
            _now.done = Done(_now.done.functions + 1, _now.done.wall)
    if not _now.open and own.compiles:
        _now.done = Done(_now.done.functions, _now.done.wall + wall)
        _now.left.clear()
        _now.own[f"whole {kind} {function.name}"] = seconds
        _record().add(_now.own, _now.contents)
        _now.own, _now.contents = {}, []
        _tell(None)


def _tell(name: str | None) -> None:
    for listener, _ in list(_now.listeners):
        listener(name)


def _plan(key: _Key) -> None:
    """Expect a function that is compiled and what it calls; with an outermost one what else will be."""
    _expect(key)
    if len(_now.open) > 1:
        return
    for _, expected in list(_now.listeners):
        for named, seconds in expected.items():
            kind, _, name = named.partition(" ")
            if (made := latest.get(name)) is None:  # it will be made for a kind of case
                if named in _packaged():
                    continue
                _now.left[named] = _record().by_name.get(f"whole {named}", seconds)
            elif (other := (kind, made)) not in {*_now.met, *_now.beside} and not _remembered(other):
                _expect(other)


def _expect(key: _Key) -> None:
    kind, function = key
    by_name = _record().by_name
    known = f"{kind} {function.name}" in by_name
    if key not in _now.left:
        _now.left[key] = by_name.get(f"{kind} {function.name}", _by_size(kind, function))
    for one in _reach(function):
        inside = ("inner", one)
        if inside not in _now.left and inside not in _now.met and not _remembered(inside):
            # of a function that was compiled here before, what is not known was not needed
            otherwise = 0.0 if known else _by_size("inner", one)
            _now.left[inside] = by_name.get(f"inner {one.name}", otherwise)


def _by_size(kind: str, function: Compilable) -> float:
    """Seconds that a function is expected to take by its size."""
    own, called = _A_BYTE[kind]
    more = sum(_bytes(one) for one in _reach(function)) if called else 0
    return own * _bytes(function) + called * more


def _bytes(function: Compilable) -> int:
    return len(function.py_func.__code__.co_code)


def _reach(function: Compilable) -> dict[Compilable, None]:
    """All compiled functions that a function may call, at any depth."""
    found: dict[Compilable, None] = {}
    open_, function_known = [function], _content(("inner", function))
    while open_ and function_known:
        for one in open_.pop().calls:
            if one not in found:
                found[one] = None
                open_.append(one)
    return found


def _content(key: _Key) -> list[str]:
    try:
        return [f"{key[0]} {key[1].content[:DIGITS]}"]
    except UnknownContentError:
        return []


def _remembered(key: _Key) -> bool:
    """Whether a function has been compiled here as it is, or comes with a package."""
    return any(one in _record().contents or one in _packaged() for one in _content(key))


@cache
def _packaged() -> frozenset[str]:
    """Kinds with names and with contents of the code that is only read."""
    found = [one.about for tier in tiers.in_order() if not tier.writable for one in tier.listed()]
    return frozenset(f"{one['kind']} {one.get(part, '')}" for one in found for part in ("name", "content"))


def _record() -> Seconds:
    return _record_in(store.own().folder)


_record_in = cache(Seconds)
