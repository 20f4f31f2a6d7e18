"""Processes that share the grains of a run: one leads and owns the run folder, the others do what it says.

Each has a `GrainShare`. The leader sends the name of a method and its arguments to all, calls it itself,
and collects what each returned or why it failed. A signal that reaches another process is passed on to the
leader. A process that fails alone raises an alarm (`alarm.py`), as the others wait for it.
"""

import atexit
import os
import signal
import sys
import time
from collections.abc import Generator, Iterable
from contextlib import contextmanager
from typing import Any

from ryusa.engine.lammps.alarm import Alarm, Worker
from ryusa.engine.lammps.availability import started_together
from ryusa.engine.lammps.faults import LammpsFailed, RankFault, SharedFault
from ryusa.errors import CaseError, RunError, RyusaError

_END = "end"
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1)
_PATIENCE = 1.0  # s for a signal of all processes to reach this one
_BROKEN = 3  # exit code after a fault that left ranks waiting for each other
_PASSED_ON = 1.0  # s for mpirun to read what a process has said
_LOST = "the ranks of LAMMPS wait for each other after an error"


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
        self._lost: RyusaError | None = None  # why the other ranks do not answer any more
        if self._comm is not None:
            self._relay.listen()
            self._worker = Worker()

    @property
    def water(self) -> Any:
        """Column of water of the leader; those of the other ranks move alike."""
        return self._share.water

    def all(self, method: str, *arguments: Any) -> list[Any]:
        """Call a method of every share, and return what each returned.

        Raises
        ------
        LammpsFailed, RunError : on any rank.
        RyusaError : an error of the column of water, which all ranks have.
        """
        if self._lost is not None:
            raise self._lost
        if self._comm is None:
            try:
                return [getattr(self._share, method)(*arguments)]
            except SharedFault as fault:
                raise fault.error from fault
        answers = self._answers(method, arguments)
        self._relay.take(one for _, _, signals in answers for one in signals)
        errors = [error for _, error, _ in answers if error is not None]
        if errors:
            raise next((one for one in errors if isinstance(one, RunError)), errors[0])
        return [answer for answer, _, _ in answers]

    def _answers(self, method: str, arguments: tuple[Any, ...]) -> list[Any]:
        """What every rank answers; in a thread of its own, which a rank that fails leaves waiting forever."""
        alarm = _leads[0]
        try:
            call = self._worker.begin(lambda: self._of_all(method, arguments))
            while not call.wait():
                if (error := alarm.heard()) is not None and not call.wait(_PATIENCE):
                    raise RankFault(error)
            return call.result()
        except BaseException as error:  # the other ranks wait for this one, within LAMMPS
            self._lost = error.error if isinstance(error, RankFault) else LammpsFailed(_LOST)
            _abort_at_exit(self._comm)
            if isinstance(error, RankFault):
                raise self._lost from error
            raise

    def _of_all(self, method: str, arguments: tuple[Any, ...]) -> list[Any]:
        self._comm.bcast((method, arguments), 0)
        answer, error = _attempt(self._share, method, arguments)
        return self._comm.gather((answer, error, ()), 0)


_leads: list[Alarm] = []  # while this process leads others
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
    alarm = Alarm(comm)
    if comm.Get_rank() != 0:
        _serve(comm, alarm)
        yield False
        return
    _leads.append(alarm)
    try:
        yield True
    finally:
        _leads.clear()
        if not _aborts:
            comm.bcast((_END, ()), 0)


def _serve(comm: Any, alarm: Alarm) -> None:
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
            answer, error = _attempt(share, method, arguments)
        except BaseException as fault:
            rank = comm.Get_rank()
            said = fault.error if isinstance(fault, RankFault) else None
            alarm.ring(said or LammpsFailed(f"rank {rank} failed: {type(fault).__name__}: {fault}"))
            print(f"ryusa: rank {rank}: {fault}", file=sys.stderr, flush=True)  # the leader did not hear it
            _abort(comm)
            raise
        signals, received[:] = tuple(received), []
        comm.gather((answer, error, signals), 0)


def _attempt(share: Any, method: str, arguments: tuple[Any, ...]) -> tuple[Any, RyusaError | None]:
    """Call a method: its answer, or the error that all ranks have in common."""
    try:
        return getattr(share, method)(*arguments), None
    except RankFault:
        raise
    except SharedFault as fault:
        return None, fault.error
    except RyusaError as error:  # of the column, which is the same on all ranks
        return None, error


def _abort_at_exit(comm: Any) -> None:
    """End all processes when this one ends, after it has written and said what it can."""
    if not _aborts:
        _aborts.append(True)
        atexit.register(_abort, comm)


def _abort(comm: Any) -> None:
    """End all processes once mpirun has passed on what they said; it drops what it has not read by then."""
    sys.stdout.flush()
    sys.stderr.flush()
    time.sleep(_PASSED_ON)
    comm.Abort(_BROKEN)
