"""Where the runs of a study are carried out: executors of `concurrent.futures`, by name.

An executor opens as one of `concurrent.futures`, and nothing else of it is used: a cluster whose client gives
such an executor needs one class here. Results do not depend on the executor.
"""

import os
import signal
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context, parent_process
from typing import Any, TypeVar

from ryusa.errors import CaseError
from ryusa.spelling import nearest_word

Value = TypeVar("Value")

_PATIENCE = 5.0  # s until the process of a run that does not close its folder is killed
_ONE_THREAD = {name: "1" for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}


class RunExecutor(ABC):
    """Where runs are carried out.

    Attributes
    ----------
    jobs : number of runs at a time.
    here : whether runs are carried out one after the other by the calling process itself.
    lost : what a future raises if the process of its run was ended from outside.
    """

    jobs: int
    here = False
    lost: tuple[type[Exception], ...] = (BrokenExecutor,)

    @abstractmethod
    def open(self) -> Executor:
        """Return an executor that is ready to take runs."""

    def submit(self, pool: Executor, call: Callable[..., Value], *given: Any) -> Future[Value]:
        """Hand one call to an open executor."""
        return pool.submit(call, *given)

    @abstractmethod
    def stop(self, pool: Executor) -> None:
        """End every run that is under way; each closes its folder, and can be continued."""


class Processes(RunExecutor):
    """Processes of this machine, each with one numerical thread.

    Parameters
    ----------
    jobs : number of processes; 1 needs none but the calling one.
    """

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs
        self.here = jobs == 1

    def open(self) -> Executor:
        """Return a pool of processes; they start when runs are handed over."""
        return ProcessPoolExecutor(self.jobs, mp_context=get_context("spawn"), initializer=_settle_in)

    def submit(self, pool: Executor, call: Callable[..., Value], *given: Any) -> Future[Value]:
        """Hand one call to the pool; a process that starts for it has one numerical thread."""
        with _for_a_child():
            return pool.submit(call, *given)

    def stop(self, pool: Executor) -> None:
        """End all processes: on SIGTERM a run closes its folder; a process that does not end is killed."""
        processes = list((getattr(pool, "_processes", None) or {}).values())
        pool.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            if process.is_alive():
                process.terminate()
        deadline = time.monotonic() + _PATIENCE
        for process in processes:
            process.join(max(0.0, deadline - time.monotonic()))
            if process.is_alive():
                process.kill()


EXECUTORS: dict[str, Callable[[int], RunExecutor]] = {"processes": Processes}
DEFAULT = "processes"


def executor_of(name: str, jobs: int) -> RunExecutor:
    """Return an executor by its name.

    Parameters
    ----------
    name : a name of `EXECUTORS`.
    jobs : number of runs at a time, 1 or more.

    Raises
    ------
    CaseError : there is no executor of that name, or `jobs` is less than 1.

    >>> executor_of("processes", 2).jobs
    2
    """
    if name not in EXECUTORS:
        raise CaseError(
            "on", name, f"must be one of {', '.join(EXECUTORS)}", nearest_word(name, list(EXECUTORS))
        )
    if jobs < 1:
        raise CaseError("jobs", jobs, "must be 1 or more")
    return EXECUTORS[name](jobs)


@contextmanager
def _for_a_child() -> Generator[None]:
    """Within the block processes start with one numerical thread and with Ctrl-C blocked."""
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    os.environ.update(_ONE_THREAD)
    can_hold = hasattr(signal, "pthread_sigmask")
    if can_hold:
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        if can_hold:
            signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _settle_in() -> None:
    """Ignore Ctrl-C, because the parent ends the runs by SIGTERM, and end with the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # a run installs its own handler
    threading.Thread(target=_leave_with_parent, daemon=True).start()


def _leave_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(_PATIENCE)
        os._exit(1)
