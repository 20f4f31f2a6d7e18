"""Ctrl-C, SIGTERM and SIGUSR1 as flags that are looked at between pieces of work.

An exception can come up inside a callback of the compiler, which drops it; a flag waits to be looked at.
"""

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass

_NAMES = {signal.SIGINT: "Ctrl-C", signal.SIGTERM: "SIGTERM"}
_KEEP = getattr(signal, "SIGUSR1", None)  # asks for a checkpoint; not every system has it


@dataclass
class Heard:
    """Who said what."""

    by: str = ""  # "Ctrl-C", "SIGTERM", or "" while nobody did
    keep: bool = False  # somebody asked for a checkpoint

    def raise_if_asked(self, when: str) -> None:
        """Raise KeyboardInterrupt if somebody said stop; `when` says what was not done."""
        if self.by:
            raise KeyboardInterrupt(f"{self.by} {when}")


_ears: list[Heard] = []  # the block that listens, if any; handlers belong to the whole process


@contextmanager
def listening() -> Generator[Heard]:
    """Keep Ctrl-C and SIGTERM as a flag within the block; a second one raises KeyboardInterrupt at once.

    SIGUSR1 asks for a checkpoint.

    A block within a listening block shares its flag. Only the main thread can listen.
    """
    if _ears:
        yield _ears[0]
        return
    heard = Heard()
    if threading.current_thread() is not threading.main_thread():
        yield heard
        return

    def hear(number: int, _: object) -> None:
        if number == _KEEP:
            heard.keep = True
            return
        if heard.by:
            raise KeyboardInterrupt(f"{heard.by}, twice")
        heard.by = _NAMES[signal.Signals(number)]

    numbers = [*_NAMES, *([] if _KEEP is None else [_KEEP])]
    before = {number: signal.signal(number, hear) for number in numbers}
    _ears.append(heard)
    try:
        yield heard
    finally:
        _ears.clear()
        for number, handler in before.items():
            signal.signal(number, handler)
