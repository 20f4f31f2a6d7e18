"""Pieces that a second process compiles into the store, while this process compiles something else."""

import contextlib
import os
import pickle
import subprocess
import sys
import weakref
from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

import numba
from numba.core.compiler_lock import global_compiler_lock
from numba.core.typing.templates import signature

from ryusa.compiled import waiting
from ryusa.compiled.piece import Piece

if TYPE_CHECKING:
    from ryusa.compiled.function import Compiled


class Wanted(NamedTuple):
    """A piece that returns nothing.

    Attributes
    ----------
    make : maker of its function, of a module that can be imported.
    given : arguments of the maker, which can be pickled.
    takes : types of Numba that the piece takes.
    """

    make: Callable[..., "Compiled"]
    given: tuple[Any, ...]
    takes: tuple[Any, ...]

    @property
    def function(self) -> "Compiled":
        """What the piece is compiled from."""
        return self.make(*self.given)


class Beside:
    """Pieces on their way.

    The other process is started if a piece has to be compiled, the store would keep it and there is a core
    for it. Whatever comes of it, the pieces are then loaded, or compiled here.
    """

    def __init__(self, wanted: list[Wanted]) -> None:
        missing = [one for one in wanted if cores() > 1 and one.function.pieces.may_keep(one.takes)]
        self._process = _started(missing) if missing else None
        self._wanted = wanted
        if self._process is not None:
            self._end = weakref.finalize(self, _ended, self._process)
            waiting.compiled_beside([one.function for one in missing])

    def pieces(self) -> list[Piece]:
        """The pieces, which are waited for when a kernel is called with them."""
        return [
            Piece(signature(numba.types.none, *one.takes), partial(self._found, one)) for one in self._wanted
        ]

    def _found(self, wanted: Wanted) -> Any:
        with global_compiler_lock:  # all threads of a run ask at once
            if self._process is not None:
                with waiting.asked(wanted.function, "piece"):
                    if self._process.poll() is None:
                        waiting.done_by_another_process()
                        self._process.wait()
                self._end()
                self._process = None
            return wanted.function.pieces.made(wanted.takes)


def cores() -> int:
    """Cores that this process may use."""
    asked = getattr(os, "sched_getaffinity", None)  # not on every system
    return len(asked(0)) if asked else os.cpu_count() or 1


def _started(wanted: list[Wanted]) -> "subprocess.Popen[bytes] | None":
    told = pickle.dumps([(one.make.__module__, one.make.__name__, one.given, one.takes) for one in wanted])
    try:
        process = subprocess.Popen(
            [sys.executable, "-m", __name__],
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
    except OSError:
        return None
    with contextlib.suppress(OSError), process.stdin or contextlib.nullcontext() as pipe:
        if pipe is not None:
            pipe.write(told)
    return process


def _ended(process: "subprocess.Popen[bytes]") -> None:
    """No process is left behind by a run that broke off."""
    if process.poll() is None:
        process.terminate()
    process.wait()


def main() -> None:
    """Compile what another process asks for."""
    for module, name, given, takes in pickle.load(sys.stdin.buffer):
        getattr(import_module(module), name)(*given).pieces.compile(takes)


if __name__ == "__main__":
    main()
