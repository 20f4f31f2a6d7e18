"""Progress of a command that works through frames: a bar on a terminal, a line for each tenth elsewhere."""

import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager

_AFTER = 2.0  # s before the first line: a quick command shows none


@contextmanager
def shown_progress(what: str, *, quiet: bool) -> Generator[Callable[[float], None]]:
    """Yield what is to be called with the share that is done, 0 to 1; it shows the time left on stderr."""
    if quiet:
        yield lambda share: None
    elif sys.stderr.isatty():
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

        with Progress(
            TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn(),
            console=Console(stderr=True), transient=True,
        ) as bar:  # fmt: skip
            task = bar.add_task(what, total=1.0)
            yield lambda share: bar.update(task, completed=share)
    else:
        yield _Lines(what).update


class _Lines:
    def __init__(self, what: str) -> None:
        self._what, self._begun, self._next = what, time.monotonic(), 0.0

    def update(self, share: float) -> None:
        taken = time.monotonic() - self._begun
        if taken > _AFTER and self._next <= share < 1.0:
            self._next = share + 0.1
            left = taken * (1.0 - share) / share
            print(
                f"{self._what}: {100.0 * share:.0f} %, about {left:.0f} s left", file=sys.stderr, flush=True
            )
