"""How a process that fails alone tells the leader, which waits for it within a call that never ends."""

import time
from collections.abc import Callable
from concurrent.futures import Future, wait
from queue import SimpleQueue
from threading import Thread
from typing import Any

from ryusa.errors import RyusaError

_LOOK = 0.2  # s between two looks for an alarm
_UNHEARD = 30.0  # s after which a process that raised the alarm ends all by itself
_ERROR, _HEARD = 1, 2  # tags


class Alarm:
    """Messages beside those of the run; made on all processes together.

    Parameters
    ----------
    comm : communicator of all processes.
    """

    def __init__(self, comm: Any) -> None:
        from mpi4py import MPI

        self._comm = comm.Dup()
        # else MPI may be called in one thread alone, and nobody listens while that one waits
        self._listens = MPI.Query_thread() == MPI.THREAD_MULTIPLE
        self._any = MPI.ANY_SOURCE
        self._sent: Any = None  # a message under way

    def ring(self, error: RyusaError) -> None:
        """Tell the leader of an error, and wait until it ends this process; return if it does not hear."""
        if not self._listens:
            return
        self._sent = self._comm.isend(error, 0, _ERROR)
        end = time.monotonic() + _UNHEARD
        while not self._comm.iprobe(0, _HEARD):
            if time.monotonic() > end:
                return
            time.sleep(_LOOK)
        while True:  # the leader writes what it can, and then ends all
            time.sleep(_LOOK)

    def heard(self) -> RyusaError | None:
        """The error of a process that raised the alarm, in the leader; None without one."""
        if not (self._listens and self._comm.iprobe(self._any, _ERROR)):
            return None
        from mpi4py import MPI

        status = MPI.Status()
        error = self._comm.recv(None, self._any, _ERROR, status)
        self._sent = self._comm.isend(None, status.Get_source(), _HEARD)
        return error


class Call:
    """A call that a `Worker` carries out."""

    def __init__(self, work: Callable[[], Any]) -> None:
        self.work = work
        self.future: Future[Any] = Future()

    def wait(self, seconds: float = _LOOK) -> bool:
        """Whether it is done after at most so many seconds."""
        return bool(wait([self.future], seconds).done)

    def result(self) -> Any:
        """What it returned, or the exception that it raised."""
        return self.future.result()


class Worker:
    """A thread for calls that may never end; the process ends without it."""

    def __init__(self) -> None:
        self._calls: SimpleQueue[Call] = SimpleQueue()
        Thread(target=self._run, daemon=True).start()

    def begin(self, work: Callable[[], Any]) -> Call:
        """Have something done."""
        call = Call(work)
        self._calls.put(call)
        return call

    def _run(self) -> None:
        while True:
            call = self._calls.get()
            try:
                call.future.set_result(call.work())
            except BaseException as error:
                call.future.set_exception(error)
