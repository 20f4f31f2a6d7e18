"""Carry out tasks, each once and several at a time; finished ones are opened."""

import signal
import threading
import time
from collections import Counter
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from ryusa.errors import RunError, RyusaError, WaterError
from ryusa.running.lock import holder
from ryusa.study.cost import CostEstimate, code_of, estimate_cost, is_other, present, refuse_if_too_big
from ryusa.study.executors import Processes, RunExecutor
from ryusa.study.fault import Fault, fault_of, noted
from ryusa.study.progress import StudyProgress
from ryusa.study.task import Calculation, Task

_WAIT = 0.2  # s between two checks for finished runs
_CLOSING = 20.0  # s that a run which was asked to end has to close its folder
LOST = (
    "the process of the run was ended from outside twice, perhaps for want of memory; the same command "
    "continues the run, and -j 1 needs the least memory"
)
Load = Callable[[str], Any]


@dataclass(frozen=True)
class TaskResult:
    """One run with its measurements."""

    one: Task
    measured: Mapping[str, Any]  # by part
    opened: bool  # the run was finished before
    seconds: float
    faults: Mapping[str, Fault] = field(default_factory=dict[str, Fault])  # by part without measurements
    commit: str = ""  # of the code that made the run, or its version
    broken: bool = False  # the run itself failed

    @property
    def problem(self) -> str:
        """Why it could not be completed or measured."""
        if self.broken:
            return next(iter(self.faults.values())).words if self.faults else ""
        return "; ".join(f"{name}: {one.words}" for name, one in self.faults.items())


@dataclass
class TaskResults:
    """Results of the tasks of a study.

    Attributes
    ----------
    found : measurements by part, then by run.
    n_run, n_opened : number of runs made, and of finished runs of the same case that were opened.
    seconds : wall time [s].
    problems : runs that could not be completed or measured, with the reason.
    missing : by part, its runs without measurements.
    commits : number of runs by the state of the code that made them.
    others : the same, only for states that are not, or may not be, the present one.
    """

    found: dict[str, dict[Any, Any]]
    n_run: int = 0
    n_opened: int = 0
    seconds: float = 0.0
    problems: dict[str, str] = field(default_factory=dict[str, str])
    missing: dict[str, dict[Task, Fault]] = field(default_factory=dict[str, dict[Task, Fault]])
    commits: Counter[str] = field(default_factory=Counter[str])
    others: Counter[str] = field(default_factory=Counter[str])

    def add(self, more: "TaskResults") -> None:
        """Take in the results of other tasks of the same study."""
        for name, found in more.found.items():
            self.found.setdefault(name, {}).update(found)
        for name, lacking in more.missing.items():
            self.missing.setdefault(name, {}).update(lacking)
        self.problems.update(more.problems)
        self.n_run += more.n_run
        self.n_opened += more.n_opened
        self.seconds += more.seconds
        self.commits += more.commits
        self.others += more.others


def carry_out(
    tasks: Mapping[str, Sequence[Task]],
    load: Load,
    folder: Path,
    *,
    jobs: int = 1,
    again: bool = False,
    progress: StudyProgress | None = None,
    where: RunExecutor | None = None,
) -> TaskResults:
    """Carry out every task once, and measure it for every part that needs it.

    Parameters
    ----------
    tasks : runs and calculations, by the part that needs them.
    load : returns a part by its name, in any process. Its `measure(results, task)` returns the numbers of a
        run, small enough to be sent between processes; those of a calculation are passed on unchanged. If a
        run fails, `failed(error)` of the part, where it exists, may return a result instead.
    folder : runs are written to `folder/<case>/<variant>`; finished runs of the same case are opened.
    jobs : number of runs at a time, each in its own process on one thread; results do not depend on it.
    again : repeat finished runs.
    progress : receives the progress.
    where : where runs are carried out; `jobs` processes of this machine if not given.

    Raises
    ------
    CaseError : a case cannot be run, or the runs do not fit on the disk; nothing was run.
    KeyboardInterrupt : Ctrl-C or SIGTERM; finished runs are kept and opened by the next call.
    """
    begun, progress = time.monotonic(), progress or StudyProgress()
    wanted = _wanted(tasks)
    where = where or Processes(jobs)
    # Reads, and so checks, every case first
    ahead = estimate_cost(wanted, folder, jobs=where.jobs, again=again)
    refuse_if_too_big(ahead, folder)
    found: dict[str, dict[Any, Any]] = {name: {} for name in tasks}
    results = TaskResults(found)
    progress.begin(ahead, folder)
    try:
        do = partial(_one, folder=folder, again=again, load=load)
        runs = _done(ahead, folder, wanted, do, where, progress)
        with _stopped_by_sigterm(), closing(runs):
            for done in runs:
                _count(results, done)
                progress.done(done.one, done.seconds, done.opened, done.problem)
    finally:
        progress.end()
    for name, measured in found.items():  # in the requested order, not in that of completion
        found[name] = {one: measured[one] for one in tasks[name] if one in measured}
    results.seconds = time.monotonic() - begun
    return results


def _wanted(tasks: Mapping[str, Sequence[Task]]) -> dict[Task, list[str]]:
    """Every task, with the names of the parts that need it."""
    wanted: dict[Task, list[str]] = {}
    for name, every in tasks.items():
        for one in every:
            users = wanted.setdefault(one, [])
            if name not in users:
                users.append(name)
    return wanted


def _order(ahead: CostEstimate) -> list[Task]:
    """Finished tasks first, then the longest of each case, then the longest first.

    The first run of a case compiles its code: two that begin together would both compile it. The longest
    come before the short ones, so that no core is idle at the end.
    """
    longest = sorted(ahead.costs, key=lambda one: -ahead.costs[one])
    firsts = {one.folder.partition("/")[0]: one for one in reversed(longest)}.values()
    return [*ahead.there, *sorted(longest, key=lambda one: one not in firsts)]


def _count(results: TaskResults, done: TaskResult) -> None:
    results.n_opened += done.opened
    results.n_run += not done.opened
    if done.commit:
        results.commits[done.commit] += 1
        if is_other(done.commit, done.opened):
            results.others[done.commit] += 1
    if done.problem:
        results.problems[done.one.label] = done.problem
    for name, numbers in done.measured.items():
        results.found[name][done.one] = numbers
    for name, fault in done.faults.items():
        results.missing.setdefault(name, {})[done.one] = fault


def _done(
    ahead: CostEstimate,
    folder: Path,
    wanted: Mapping[Task, Sequence[str]],
    do: Callable[[Task, Sequence[str]], TaskResult],
    where: RunExecutor,
    progress: StudyProgress,
) -> Generator[TaskResult]:
    """Results as they come; a run whose process was ended from outside is tried once more, by itself."""
    order = _order(ahead)
    if not order or where.here(len(order), len(ahead.costs)):
        for one in order:
            progress.started(one)
            yield do(one, tuple(wanted[one]))
        return
    lost: list[Task] = []
    yield from _in_pool(order, folder, where.jobs, wanted, do, where, progress, lost.append)
    # which of the runs that were under way ended the pool is not known: each has a pool to itself
    for one in dict.fromkeys(lost):
        again: list[Task] = []
        yield from _in_pool([one], folder, 1, wanted, do, where, progress, again.append)
        if again:
            yield TaskResult(one, {}, False, 0.0, dict.fromkeys(wanted[one], Fault(LOST)), broken=True)


def _in_pool(
    order: Sequence[Task],
    folder: Path,
    jobs: int,
    wanted: Mapping[Task, Sequence[str]],
    do: Callable[[Task, Sequence[str]], TaskResult],
    where: RunExecutor,
    progress: StudyProgress,
    lose: Callable[[Task], None],
) -> Generator[TaskResult]:
    """Results of runs, `jobs` at a time; a pool that breaks is replaced, and the runs in it are lost."""
    pool = where.open(folder, order)
    waiting = list(reversed(order))
    running: dict[Future[TaskResult], Task] = {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                one = waiting.pop()
                try:
                    future = where.submit(pool, do, one, tuple(wanted[one]))
                except BrokenExecutor:  # a process ended between two runs
                    where.stop(pool)
                    pool = where.open(folder, order)
                    future = where.submit(pool, do, one, tuple(wanted[one]))
                running[future] = one
                progress.started(one)
            ready, _ = wait(running, _WAIT, FIRST_COMPLETED)
            progress.tick()
            for future in ready:
                one = running.pop(future)
                try:
                    done = future.result()
                except where.lost:
                    progress.lost(one)
                    lose(one)
                    continue
                except RyusaError:  # of the executor itself; those of a run are part of its result
                    raise
                except Exception as error:  # the measurements cannot be sent between processes
                    faults = dict.fromkeys(wanted[one], fault_of(error))
                    done = TaskResult(one, {}, False, 0.0, faults, broken=True)
                yield done
    finally:
        if running or waiting:
            where.stop(pool)
        else:
            pool.shutdown(wait=True)


@contextmanager
def _stopped_by_sigterm() -> Generator[None]:
    """Within the block SIGTERM has the effect of Ctrl-C."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(_: int, __: object) -> None:
        raise KeyboardInterrupt("SIGTERM")

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _one(one: Task, names: Sequence[str], *, folder: Path, again: bool, load: Load) -> TaskResult:
    """Run or open a task, and measure it; errors are returned in words and do not affect other runs."""
    begun = time.monotonic()
    measured: dict[str, Any] = {}
    faults: dict[str, Fault] = {}
    place = folder / one.folder
    parts = {name: load(name) for name in names}  # first: a calculation may be a function of a part
    try:
        _wait_for_another(place)
        answer = None if again else one.open(place)
        opened = answer is not None
        if not opened:
            answer = one.make(place, anew=again)
    # for some parts a failed run is a result, for example of a scheme that creates energy
    except (RunError, WaterError) as error:
        for name in names:
            faults[name] = fault_of(error)
            with noted(faults, name):
                hook = getattr(parts[name], "failed", None)
                if hook is not None and (said := hook(error)) is not None:
                    measured[name] = said
                    del faults[name]
        return TaskResult(one, measured, False, time.monotonic() - begun, faults, present(), broken=True)
    except Exception as error:
        faults = dict.fromkeys(names, fault_of(error))
        return TaskResult(one, {}, False, time.monotonic() - begun, faults, broken=True)
    for name in names:
        with noted(faults, name):
            measured[name] = answer if isinstance(one, Calculation) else parts[name].measure(answer, one)
    made_by = code_of(one.origin(place) or {})
    return TaskResult(one, measured, opened, time.monotonic() - begun, faults, made_by)


def _wait_for_another(place: Path) -> None:
    """Give another process that writes to the folder time to end: one whose worker was lost is closing it."""
    late = time.monotonic() + _CLOSING
    while holder(place) and time.monotonic() < late:
        time.sleep(_WAIT)
