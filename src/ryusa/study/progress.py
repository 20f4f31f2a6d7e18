"""Progress of a study, on stderr: a bar on a terminal, a line every ten seconds elsewhere."""

import sys
import time
from collections.abc import Callable
from pathlib import Path

from ryusa.study.cost import CostEstimate, duration
from ryusa.study.task import Task


class StudyProgress:
    """Receives the progress of a study; shows nothing."""

    def begin(self, ahead: CostEstimate, folder: Path) -> None:
        """Called before the first run, with the estimated cost of all runs and the folder that holds them."""

    def started(self, one: Task) -> None:
        """Called when a run begins."""

    def done(self, one: Task, seconds: float, opened: bool, problem: str) -> None:
        """Called when a run has ended."""

    def lost(self, one: Task) -> None:
        """Called when the process of a run was ended from outside; the run is tried once more."""

    def tick(self) -> None:
        """Called several times a second."""

    def end(self) -> None:
        """Called when all runs have ended, or the study was interrupted."""


class ProgressLines(StudyProgress):
    """Shows a bar on a terminal, a line every ten seconds elsewhere; on stderr."""

    EVERY = 10.0  # s between two lines if stderr is not a terminal
    LOOK = 2.0  # s between two readings of how far the runs are
    LEAST = 0.05  # share from which it is used: before, compilation and the first part weigh too much

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn
        from rich.table import Column

        self._console = Console(stderr=True, highlight=False)
        self._clock = clock
        self._costs: dict[Task, float] = {}
        self._now: dict[Task, float] = {}  # start time of each
        self._run_cost = self._run_seconds = 0.0  # estimated and measured, of the runs made
        self._finished = self._total = 0
        self._jobs = 1
        self._folder = Path()
        self._shares: dict[Task, float] = {}  # that are done, of the runs that go on
        self._last = self._looked = clock()
        self._bar = Progress(
            TextColumn("{task.completed:.0f}/{task.total:.0f} runs", table_column=Column(no_wrap=True)),
            BarColumn(bar_width=20),
            TextColumn("{task.fields[words]}", table_column=Column(no_wrap=True, overflow="ellipsis")),
            console=self._console, transient=True,
        )  # fmt: skip
        self._task = None

    def begin(self, ahead: CostEstimate, folder: Path) -> None:
        """Print the estimated cost and open the bar."""
        self._costs, self._jobs, self._folder = dict(ahead.costs), ahead.jobs, folder
        self._finished = 0  # a study that asks for more runs begins again with these
        self._total = len(ahead.costs) + len(ahead.there)
        if not self._total:
            return
        self._console.print(str(ahead), markup=False, soft_wrap=True)
        if self._console.is_terminal:
            self._task = self._bar.add_task("", total=self._total, words="")
            self._bar.start()

    def started(self, one: Task) -> None:
        """Note when a run began."""
        self._now[one] = self._clock()
        self.tick()

    def done(self, one: Task, seconds: float, opened: bool, problem: str) -> None:
        """Count the run, and correct the estimate of the remaining time."""
        self._finished += 1
        self._now.pop(one, None)
        self._shares.pop(one, None)
        cost = self._costs.pop(one, 0.0)
        if not opened:
            self._run_cost += cost
            self._run_seconds += seconds
        if problem:
            self._console.print(f"{one.label}: {problem}", markup=False, soft_wrap=True)
        self.tick()

    def lost(self, one: Task) -> None:
        """Say that the run is tried once more."""
        self._now.pop(one, None)
        self._shares.pop(one, None)
        self._console.print(
            f"{one.label}: its process was ended from outside; it is tried once more, by itself",
            markup=False, soft_wrap=True,
        )  # fmt: skip

    def tick(self) -> None:
        """Show the progress, at most every ten seconds."""
        now = self._clock()
        if now - self._looked > self.LOOK:
            self._looked = now
            shares = {one: one.share(self._folder / one.folder) for one in self._now}
            self._shares = {
                one: share for one, share in shares.items() if share is not None and share > self.LEAST
            }
        left = self.left()
        words = f"about {duration(left)} left, " if left > 0.0 else ""
        words += f"now: {', '.join(one.label for one in self._now)}"
        if self._task is not None:
            self._bar.update(self._task, completed=self._finished, words=words)
        elif now - self._last > self.EVERY and self._now:
            self._last = now
            print(f"{self._finished}/{self._total} runs, {words}", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Close the bar."""
        if self._task is not None:
            self._bar.stop()
            self._bar.remove_task(self._task)
            self._task = None

    def left(self) -> float:
        """Remaining wall time [s].

        A run that goes on takes what its share of simulated time says; one that does not tell its share takes
        its estimated cost, and at least a tenth of that longer, however late it is. Costs are corrected by
        what the runs made so far, and those that tell their share, take more than was estimated.
        """
        now = self._clock()
        expected = {
            one: (now - self._now[one]) / share for one, share in self._shares.items() if one in self._now
        }
        cost = self._run_cost + sum(self._costs.get(one, 0.0) for one in expected)
        wrong = (self._run_seconds + sum(expected.values())) / cost if cost > 0.0 else 1.0
        rest: list[float] = []
        for one, estimate in self._costs.items():
            if one not in self._now:
                rest.append(estimate * wrong)
                continue
            spent, whole = now - self._now[one], expected.get(one, estimate * wrong)
            rest.append(whole - spent if one in expected else max(whole - spent, 0.1 * max(whole, spent)))
        return max(sum(rest) / self._jobs, max(rest, default=0.0))
