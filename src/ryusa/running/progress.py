"""Progress of a run: a bar on a terminal, plain lines elsewhere, and the same lines in log.txt."""

import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from rich.progress import Progress as RichProgress
    from rich.progress import TaskID

_BAR_EVERY = 0.2  # s
_LINE_EVERY = 5.0  # s
_LINE_SHARE = 0.1  # of the run; one line per such share if that takes longer than _LINE_EVERY
_ESTIMATED = 1e-3  # share of the run above which the remaining time follows from the pace so far


@dataclass(frozen=True)
class ProgressNumbers:
    """Live numbers shown during a run."""

    share: float  # of the run that is done, 0 to 1, by the stop rule that is nearest
    t: float  # simulated [s]
    rate: float  # particle-steps per second
    overlap: float  # largest overlap/d
    residual: float  # of the energy account; nan without one
    hops: int | None = None  # saltations of the tracked grain with the fewest
    precision: str = ""  # of the averages that end the run
    water: str = ""  # instead of the numbers of grains, where there is none

    def __str__(self) -> str:
        if self.water:
            return f"t {self.t:.4g} s  {self.water}"
        hops = "" if self.hops is None else f"  saltations {self.hops}"
        known = f"{self.precision}  " if self.precision else ""
        account = "" if math.isnan(self.residual) else f"energy residual {self.residual:.0e}  "
        return (
            f"t {self.t:.4g} s  {known}overlap/d {self.overlap:.2g}  {account}"
            f"{self.rate / 1e6:.2f} M particle-steps/s{hops}"
        )


class Progress:
    """Lines to stderr and to log.txt; a bar instead of lines where stderr is a terminal.

    Until the run tells how long it takes, what is left follows from the time `expected` of the whole [s].
    """

    def __init__(
        self,
        log: Path,
        *,
        shown: bool,
        expected: float = math.nan,
        stream: TextIO | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._shown, self._clock, self._expected = shown, clock, expected
        self._stream = sys.stderr if stream is None else stream
        self._log = log.open("a", encoding="utf-8", buffering=1)
        self._begun = self._last = self._last_log = self._paused = clock()
        self._share = self._share_log = 0.0  # of the run that is done: at the start, at the last line
        self._bar: RichProgress | None = None
        self._task: TaskID | None = None
        if shown and self._stream.isatty():
            self._bar, self._task = _bar(self._stream)

    def line(self, text: str, *, shown: bool = True) -> None:
        """Write a line to the log and, if `shown`, to stderr."""
        self._write_log(text)
        if shown:
            self._show(text)

    def due(self) -> bool:
        """True when new numbers are due; check before computing them."""
        return self._clock() - self._last >= (_BAR_EVERY if self._bar is not None else _LINE_EVERY)

    def start_at(self, share: float) -> None:
        """Set the share that is already done; the remaining time is estimated from here."""
        self._begun, self._share = self._clock(), share
        if self._bar is not None and self._task is not None:
            self._bar.reset(self._task, now="")
            self._bar.update(self._task, completed=share)

    def update(self, moment: ProgressNumbers) -> None:
        """Show new numbers, if a line or a redraw of the bar is due."""
        now = self._clock()
        self._last = now
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, completed=moment.share, now=str(moment))
        slow = moment.share - self._share_log < _LINE_SHARE and self._share_log + _LINE_SHARE < 1.0
        if now - self._last_log < _LINE_EVERY or (slow and now - self._last_log < 12 * _LINE_EVERY):
            return
        self._last_log, self._share_log = now, moment.share
        text = f"{100 * moment.share:3.0f} %  {moment}{self._left(now, moment.share)}"
        self._write_log(text)
        if self._bar is None:
            self._show(text)

    @property
    def plain(self) -> bool:
        """Whether lines are all that there is: no bar."""
        return self._bar is None

    def pause(self) -> None:
        """The run waits: from here to `go_on` no time passes for the estimate of what remains."""
        self._paused = self._clock()

    def go_on(self) -> None:
        """The run goes on after a `pause`."""
        waited = self._clock() - self._paused
        self._begun, self._last_log = self._begun + waited, self._last_log + waited
        self.busy("")

    def busy(self, text: str) -> None:
        """Show in the bar what the run waits for, instead of its numbers."""
        if self._bar is not None and self._task is not None:
            self._bar.update(self._task, now=text)

    def close(self) -> None:
        """Remove the bar and close the log."""
        if self._bar is not None:
            self._bar.stop()
            self._bar = None
        self._log.close()

    def _left(self, now: float, share: float) -> str:
        """Words for the time left at a share of the run that is done."""
        elapsed, done = now - self._begun, share - self._share
        expected = self._expected * (1.0 - self._share) - elapsed
        left = elapsed * (1.0 - share) / done if done >= _ESTIMATED else expected
        return f"  about {left:.0f} s left" if left > 0.0 else ""

    def _write_log(self, text: str) -> None:
        if self._log.closed:
            return
        try:
            self._log.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')}  {text}\n")
        except OSError:  # the recorder reports a full disk; a lost line of the log does not matter
            return

    def _show(self, text: str) -> None:
        if not self._shown:
            return
        if self._bar is not None:
            self._bar.console.print(text, highlight=False, markup=False)
        else:
            print(text, file=self._stream, flush=True)


def _bar(stream: TextIO) -> "tuple[RichProgress, TaskID]":
    from rich.console import Console
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as RichProgress
    from rich.table import Column

    bar = RichProgress(
        TaskProgressColumn(table_column=Column(no_wrap=True, min_width=4)),
        BarColumn(bar_width=10, table_column=Column(min_width=10)),
        TimeRemainingColumn(table_column=Column(no_wrap=True, min_width=7)),
        TextColumn("{task.fields[now]}", table_column=Column(no_wrap=True, overflow="ellipsis")),
        console=Console(file=stream),
        transient=True,
    )
    task = bar.add_task("", total=1.0, now="")
    bar.start()
    return bar, task
