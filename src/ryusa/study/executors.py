"""Where the runs of a study are carried out: executors of `concurrent.futures`, by name.

An executor opens as one of `concurrent.futures`, and nothing else of it is used. Results do not depend on the
executor. That of a cluster is in `cluster`.
"""

import os
import signal
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from multiprocessing import get_context, parent_process
from pathlib import Path
from typing import Any, TypeVar

from ryusa.errors import CaseError
from ryusa.spelling import nearest_word
from ryusa.study.remote import ONE_THREAD, PATIENCE, leave
from ryusa.study.task import Task

Value = TypeVar("Value")


class RunExecutor(ABC):
    """Where runs are carried out.

    Attributes
    ----------
    jobs : number of runs at a time.
    lost : what a future raises if the process of its run was ended from outside.
    """

    jobs: int
    lost: tuple[type[Exception], ...] = (BrokenExecutor,)

    @abstractmethod
    def here(self, n: int, made: int) -> bool:
        """Whether n tasks, of which some are finished and `made` are not, need no process but this one."""

    @abstractmethod
    def open(self, folder: Path, tasks: Sequence[Task]) -> Executor:
        """Return an executor that is ready to carry out these tasks in a folder."""

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

    def here(self, n: int, made: int) -> bool:
        """One task at a time needs no other process."""
        del made
        return self.jobs == 1 or n <= 1

    def open(self, folder: Path, tasks: Sequence[Task]) -> Executor:
        """Return a pool of processes; they start when runs are handed over."""
        del folder, tasks
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
        deadline = time.monotonic() + PATIENCE
        for process in processes:
            process.join(max(0.0, deadline - time.monotonic()))
            if process.is_alive():
                process.kill()


def _processes(given: str, jobs: int | None) -> RunExecutor:
    if given:
        raise CaseError("on", f"processes:{given}", "must be processes alone")
    return Processes(jobs or 1)


def _dask(address: str, jobs: int | None) -> RunExecutor:
    cluster = import_module("ryusa.study.cluster")  # it stands above this module, and needs the extra cluster
    return cluster.DaskWorkers(address, jobs)


DEFAULT = "processes"
# by name; of what stands after the colon, and the number of runs at a time if it is given
EXECUTORS: dict[str, Callable[[str, int | None], RunExecutor]] = {DEFAULT: _processes, "dask": _dask}
FORMS = "processes, dask:ADDRESS"
_OF_SLURM = (
    "is not there: start workers of dask as jobs of Slurm and type --on dask:ADDRESS (docs/many-runs.md has "
    "the script), or let ryusa sweep write a job array with --emit slurm"
)


def executor_of(on: str, jobs: int | None = None) -> RunExecutor:
    """Return an executor by its name.

    Parameters
    ----------
    on : a name of `EXECUTORS`, with its address after a colon: "processes", "dask:tcp://node1:8786".
    jobs : number of runs at a time, 1 or more; if not given, one process, or all threads of dask's workers.

    Raises
    ------
    CaseError : there is no executor of that name, it cannot be reached, or `jobs` is less than 1.

    >>> executor_of("processes", 2).jobs
    2
    """
    name, _, given = on.partition(":")
    if name == "slurm":
        raise CaseError("on", on, _OF_SLURM)
    if name not in EXECUTORS:
        raise CaseError("on", on, f"must be one of {FORMS}", nearest_word(name, list(EXECUTORS)))
    if jobs is not None and jobs < 1:
        raise CaseError("jobs", jobs, "must be 1 or more")
    return EXECUTORS[name](given, jobs)


@contextmanager
def _for_a_child() -> Generator[None]:
    """Within the block processes start with one numerical thread and with Ctrl-C blocked."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(ONE_THREAD)
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
        leave()
