"""Carry out the runs that experiments ask for: each once, several at a time, finished ones opened again."""

import json
import signal
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from ryusa.errors import ResultsError, RunError, RyusaError
from ryusa.experiments._experiment import Plan, Variant, load
from ryusa.results import Results

_WAIT = 0.2  # s between two looks at who has finished


@dataclass(frozen=True)
class Done:
    """One run, measured."""

    one: Variant
    measured: Mapping[str, Any]  # by experiment
    opened: bool  # it was there already
    seconds: float
    problem: str = ""  # why it could not be run to its end


@dataclass
class Campaign:
    """What a campaign found.

    Attributes
    ----------
    found : measured numbers by experiment, then by run.
    n_run, n_opened : runs made, and finished runs of the very same case opened again.
    seconds : wall time.
    problems : runs that could not be carried out, with the reason.
    """

    found: dict[str, dict[Variant, Any]]
    n_run: int = 0
    n_opened: int = 0
    seconds: float = 0.0
    problems: dict[str, str] = field(default_factory=dict[str, str])


def carry_out(
    names: Iterable[str],
    plan: Plan,
    folder: Path,
    *,
    jobs: int = 1,
    again: bool = False,
    say: "Say | None" = None,
) -> Campaign:
    """Run every case that the experiments need, and measure each for every experiment that wants it.

    Parameters
    ----------
    names : experiments, of `NAMES`.
    plan : level and seeds.
    folder : runs go into `folder/<case>/<variant>`; finished runs of the very same case are opened.
    jobs : runs at a time, each in its own process on one thread; the numbers do not depend on it.
    again : run even what is there.
    say : is told what goes on.

    Raises
    ------
    KeyboardInterrupt : Ctrl-C; what was finished stays and is opened next time.
    """
    begun, say = time.monotonic(), say or Say()
    wanted: dict[Variant, list[str]] = {}
    found: dict[str, dict[Variant, Any]] = {}
    for name in names:
        found[name] = {}
        for one in load(name).cases(plan):
            users = wanted.setdefault(one, [])
            if name not in users:
                users.append(name)
    costs = {one: cost(one) for one in wanted}  # reads, and so checks, every case before anything runs
    campaign = Campaign(found)
    say.begin(costs)
    order = sorted(wanted, key=lambda one: -costs[one])  # the longest first: no core idles at the end
    for done in _done(order, wanted, folder, jobs, again, say):
        say.done(done)
        campaign.n_opened += done.opened
        campaign.n_run += not done.opened
        if done.problem:
            campaign.problems[done.one.label] = done.problem
        for name, numbers in done.measured.items():
            found[name][done.one] = numbers
    for name, measured in found.items():  # in the order asked for, whoever finished first
        found[name] = {one: measured[one] for one in load(name).cases(plan) if one in measured}
    campaign.seconds = time.monotonic() - begun
    say.end()
    return campaign


def cost(one: Variant) -> float:
    """Core seconds of a run by rule of thumb."""
    from ryusa.casefile.estimate import seconds_needed

    return seconds_needed(one.read())


def _done(
    order: Sequence[Variant],
    wanted: Mapping[Variant, Sequence[str]],
    folder: Path,
    jobs: int,
    again: bool,
    say: "Say",
) -> Iterable[Done]:
    if jobs == 1 or len(order) <= 1:
        for one in order:
            say.started(one)
            yield _one(one, tuple(wanted[one]), folder, again)
        return
    pool = ProcessPoolExecutor(jobs, mp_context=get_context("spawn"), initializer=_deaf)
    waiting = list(reversed(order))
    running: set[Future[Done]] = set()
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                one = waiting.pop()
                running.add(pool.submit(_one, one, tuple(wanted[one]), folder, again))
                say.started(one)
            ready, running = wait(running, _WAIT, FIRST_COMPLETED)
            say.tick()
            for future in ready:
                yield future.result()
    finally:
        for process in list((pool._processes or {}).values()):
            if running and process.is_alive():
                process.terminate()  # a run hears SIGTERM and closes its folder in order
        pool.shutdown(wait=True, cancel_futures=True)


def _deaf() -> None:
    """Leave Ctrl-C to the parent, which ends the runs with SIGTERM."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _one(one: Variant, names: Sequence[str], folder: Path, again: bool) -> Done:
    """Run, or open, and measure; what goes wrong in one run comes back as words and spares the others."""
    begun = time.monotonic()
    try:
        run, opened = _run(one, folder / one.folder, again)
        measured = {name: load(name).measure(run, one) for name in names}
    except (RunError, ResultsError) as error:
        return Done(one, {}, opened=False, seconds=time.monotonic() - begun, problem=str(error))
    return Done(one, measured, opened, time.monotonic() - begun)


def _run(one: Variant, folder: Path, again: bool) -> tuple[Results, bool]:
    from ryusa.running.runner import run

    case = one.read()
    old = None if again else _earlier(folder)
    if old is not None and old.complete and old.case == json.loads(json.dumps(case.resolved())):
        return old, True
    done = run(case, folder, threads=1, progress=False, overwrite=True)
    if not done.complete:  # a run that was stopped is no basis for a verdict
        raise KeyboardInterrupt
    return done, False


def _earlier(folder: Path) -> Results | None:
    """Open what lies there; a run that another version wrote or that is damaged counts as none."""
    if not (folder / "case.json").is_file():
        return None
    try:
        return Results.open(folder)
    except RyusaError:
        return None


class Say:
    """Told what goes on; says nothing."""

    def begin(self, costs: Mapping[Variant, float]) -> None:
        """All runs, with what each costs."""

    def started(self, one: Variant) -> None:
        """A run begins."""

    def done(self, done: Done) -> None:
        """A run is over."""

    def tick(self) -> None:
        """Time went by."""

    def end(self) -> None:
        """All runs are over."""


class Lines(Say):
    """A bar on a terminal, a line now and then elsewhere; on stderr."""

    EVERY = 10.0  # s between two lines where stderr is no terminal

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn

        self._console = Console(stderr=True, highlight=False)
        self._costs: dict[Variant, float] = {}
        self._now: dict[Variant, float] = {}
        self._run_cost = self._run_seconds = 0.0
        self._finished = 0
        self._begun = self._last = time.monotonic()
        self._bar = Progress(
            TextColumn("{task.completed:.0f}/{task.total:.0f} runs"), BarColumn(bar_width=20),
            TextColumn("{task.fields[words]}"), console=self._console, transient=True,
        )  # fmt: skip
        self._task = None

    def begin(self, costs: Mapping[Variant, float]) -> None:
        """Open the bar."""
        self._costs, self._begun = dict(costs), time.monotonic()
        if costs and self._console.is_terminal:
            self._task = self._bar.add_task("", total=len(costs), words="")
            self._bar.start()

    def started(self, one: Variant) -> None:
        """Remember who is running."""
        self._now[one] = time.monotonic()
        self.tick()

    def done(self, done: Done) -> None:
        """Count it, and learn from it how long the rest will take."""
        self._finished += 1
        self._now.pop(done.one, None)
        cost = self._costs.pop(done.one, 0.0)
        if not done.opened:
            self._run_cost += cost
            self._run_seconds += done.seconds
        if done.problem:
            self._console.print(f"{done.one.label}: {done.problem}", markup=False)
        self.tick()

    def tick(self) -> None:
        """Show it, if it is time."""
        now = time.monotonic()
        words = f"{self._left()}now: {', '.join(one.label for one in self._now)}"
        total = self._finished + len(self._costs)
        if self._task is not None:
            self._bar.update(self._task, completed=self._finished, words=words[: self._console.width - 40])
        elif now - self._last > self.EVERY and self._now:
            self._last = now
            print(f"{self._finished}/{total} runs, {words}", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Take the bar away."""
        if self._task is not None:
            self._bar.stop()
            self._task = None

    def _left(self) -> str:
        """Time left, from what the runs so far took against what was thought."""
        if self._run_seconds < 1.0:
            return ""
        elapsed = time.monotonic() - self._begun
        speed = self._run_cost / elapsed  # thought-of core seconds done per second
        left = sum(self._costs.values()) / speed
        return f"about {left / 60:.0f} min left, " if left > 90.0 else f"about {left:.0f} s left, "
