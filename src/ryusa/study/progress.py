"""Progress of a study, on stderr: a bar on a terminal, a line every ten seconds elsewhere."""

import sys
import time
from collections.abc import Callable

from ryusa.study.cost import CostEstimate, duration
from ryusa.study.task import Task


class StudyProgress:
    """Receives the progress of a study; shows nothing."""

    def begin(self, ahead: CostEstimate) -> None:
        """Called before the first run, with the estimated cost of all runs."""

    def started(self, one: Task) -> None:
        """Called when a run begins."""

    def done(self, one: Task, seconds: float, opened: bool, problem: str) -> None:
        """Called when a run has ended."""

    def tick(self) -> None:
        """Called several times a second."""

    def end(self) -> None:
        """Called when all runs have ended, or the study was interrupted."""


class ProgressLines(StudyProgress):
    """Shows a bar on a terminal, a line every ten seconds elsewhere; on stderr."""

    EVERY = 10.0  # s between two lines if stderr is not a terminal

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
        self._last = clock()
        self._bar = Progress(
            TextColumn("{task.completed:.0f}/{task.total:.0f} runs", table_column=Column(no_wrap=True)),
            BarColumn(bar_width=20),
            TextColumn("{task.fields[words]}", table_column=Column(no_wrap=True, overflow="ellipsis")),
            console=self._console, transient=True,
        )  # fmt: skip
        self._task = None

    def begin(self, ahead: CostEstimate) -> None:
        """Print the estimated cost and open the bar."""
        self._costs, self._jobs = dict(ahead.costs), ahead.jobs
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
        cost = self._costs.pop(one, 0.0)
        if not opened:
            self._run_cost += cost
            self._run_seconds += seconds
        if problem:
            self._console.print(f"{one.label}: {problem}", markup=False, soft_wrap=True)
        self.tick()

    def tick(self) -> None:
        """Show the progress, at most every ten seconds."""
        now = self._clock()
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
            self._task = None

    def left(self) -> float:
        """Remaining wall time [s]: the estimate, corrected by its error in the runs made so far."""
        wrong = self._run_seconds / self._run_cost if self._run_cost > 0.0 else 1.0
        now = self._clock()
        rest = [
            max(0.0, cost * wrong - (now - self._now[one] if one in self._now else 0.0))
            for one, cost in self._costs.items()
        ]
        return max(sum(rest) / self._jobs, max(rest, default=0.0))
