"""Processes that share the grains of a run: one leads and owns the run folder, the others do what it says.

Each has a `GrainShare`. The leader sends the name of a method and its arguments to all, calls it itself,
and collects what each returned or why it failed. A signal that reaches another process is passed on to the
leader.
"""

import atexit
import os
import signal
import sys
import time
from collections.abc import Generator, Iterable
from contextlib import contextmanager
from typing import Any

from ryusa.engine.lammps.availability import started_together
from ryusa.engine.lammps.faults import LammpsFailed, RankFault, SharedFault
from ryusa.errors import CaseError, RyusaError

_END = "end"
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1)
_PATIENCE = 1.0  # s for a signal of all processes to reach this one
_BROKEN = 3  # exit code after a fault that left ranks waiting for each other


def world() -> Any:
    """Communicator of all processes that were started together; None for one process."""
    if started_together() == 1:
        return None
    from mpi4py import MPI

    return MPI.COMM_WORLD


class Relay:
    """Passes a signal that other processes received on to this one, unless it receives it itself."""

    def __init__(self) -> None:
        self._seen: set[int] = set()  # by this process
        self._told: dict[int, float] = {}  # when another process told of it first [s]

    def listen(self) -> None:
        """Note the signals of this process, which are handled as before."""
        for number in _SIGNALS:
            self._wrap(number, signal.getsignal(number))

    def _wrap(self, number: int, handler: Any) -> None:
        def handle(received: int, frame: Any) -> None:
            self._seen.add(received)
            handler(received, frame)

        if callable(handler):
            signal.signal(number, handle)

    def take(self, numbers: Iterable[int]) -> None:
        """Take what other processes tell of; mpirun signals one process after the other."""
        now = time.monotonic()
        for number in numbers:
            self._told.setdefault(number, now)
        for number, since in self._told.items():
            if number not in self._seen and now - since >= _PATIENCE:
                self._seen.add(number)
                os.kill(os.getpid(), number)


class Ranks:
    """The processes of a run, as the leader sees them."""

    def __init__(self) -> None:
        from ryusa.engine.lammps.share import GrainShare

        if started_together() > 1 and not _leads:
            raise CaseError(
                "engine", "lammps", "shares a run among processes by `mpirun -np N ryusa run` alone"
            )
        self._comm = world()
        self._share = GrainShare(self._comm)
        self._relay = Relay()
        if self._comm is not None:
            self._relay.listen()

    @property
    def water(self) -> Any:
        """Column of water of the leader; those of the other ranks move alike."""
        return self._share.water

    def all(self, method: str, *arguments: Any) -> list[Any]:
        """Call a method of every share, and return what each returned.

        Raises
        ------
        LammpsFailed : on any rank.
        RyusaError : an error of the column of water, which all ranks have.
        """
        if self._comm is None:
            try:
                return [getattr(self._share, method)(*arguments)]
            except (SharedFault, RankFault) as error:
                raise LammpsFailed(str(error)) from error
        self._comm.bcast((method, arguments), 0)
        try:
            mine = _attempt(self._share, method, arguments)
        except BaseException as error:  # the other ranks wait for this one, within LAMMPS
            _abort_at_exit(self._comm)
            if isinstance(error, RankFault):
                raise LammpsFailed(str(error)) from error
            raise
        answers = self._comm.gather((*mine, ()), 0)
        self._relay.take(one for _, _, signals in answers for one in signals)
        if isinstance(mine[0], RyusaError):
            raise mine[0]
        faults = [fault for _, fault, _ in answers if fault]
        if faults:
            raise LammpsFailed(faults[0])
        return [answer for answer, _, _ in answers]


_leads: list[bool] = []  # True while this process leads others
_aborts: list[bool] = []  # True once the end of this process ends the others


@contextmanager
def leading() -> Generator[bool]:
    """True in the process that leads; False in one that has done what it was told until the end.

    Raises
    ------
    CaseError : several processes were started, but the library of MPI makes each of them the first.
    """
    together = started_together()
    if together == 1:
        yield True
        return
    comm = world()
    if comm.Get_size() != together:
        raise CaseError(
            "engine", "lammps",
            f"{together} processes were started, but the MPI of mpi4py sees {comm.Get_size()}: start them "
            "with the mpirun that belongs to it",
        )  # fmt: skip
    if comm.Get_rank() != 0:
        _serve(comm)
        yield False
        return
    _leads.append(True)
    try:
        yield True
    finally:
        _leads.clear()
        if not _aborts:
            comm.bcast((_END, ()), 0)


def _serve(comm: Any) -> None:
    """Do what the leader says."""
    from ryusa.engine.lammps.share import GrainShare

    received: list[int] = []
    for number in _SIGNALS:
        signal.signal(number, lambda one, _: received.append(one))
    share = GrainShare(comm)
    while True:
        method, arguments = comm.bcast(None, 0)
        if method == _END:
            share.close()
            return
        try:
            answer, fault = _attempt(share, method, arguments)
        except BaseException as error:
            print(f"ryusa: rank {comm.Get_rank()}: {error}", file=sys.stderr, flush=True)
            comm.Abort(_BROKEN)
            raise
        signals, received[:] = tuple(received), []
        comm.gather((answer, fault, signals), 0)


def _attempt(share: Any, method: str, arguments: tuple[Any, ...]) -> tuple[Any, str]:
    """Call a method: its answer, or the fault that all ranks have in common."""
    try:
        return getattr(share, method)(*arguments), ""
    except SharedFault as error:
        return None, str(error)
    except RyusaError as error:  # of the column, which is the same on all ranks
        return error, str(error)


def _abort_at_exit(comm: Any) -> None:
    """End all processes when this one ends, after it has written and said what it can."""
    if not _aborts:
        _aborts.append(True)
        atexit.register(comm.Abort, _BROKEN)
