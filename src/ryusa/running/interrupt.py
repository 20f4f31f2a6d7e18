"""Ctrl-C, SIGTERM and SIGUSR1 as flags, which the loop checks between calls of the engine.

An exception raised inside a callback of the compiler would be dropped; a flag stays set until it is checked.
"""

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass

_NAMES = {signal.SIGINT: "Ctrl-C", signal.SIGTERM: "SIGTERM"}
_CHECKPOINT = getattr(signal, "SIGUSR1", None)  # requests a checkpoint; not every system has it


@dataclass
class StopSignal:
    """Signals received so far."""

    stop: str = ""  # "Ctrl-C", "SIGTERM", or "" while none was received
    checkpoint: bool = False  # a checkpoint was requested

    def raise_if_stopped(self, when: str) -> None:
        """Raise KeyboardInterrupt if a stop was requested; `when` names the stage of the run."""
        if self.stop:
            raise KeyboardInterrupt(f"{self.stop} {when}")


_active: list[
    StopSignal
] = []  # of the block that handles signals, if any; handlers belong to the whole process


@contextmanager
def catch_signals() -> Generator[StopSignal]:
    """Turn Ctrl-C and SIGTERM into a flag within the block; a second one raises KeyboardInterrupt at once.

    SIGUSR1 requests a checkpoint. A nested block shares the flag of the outer one. Only the main thread can
    handle signals.
    """
    if _active:
        yield _active[0]
        return
    received = StopSignal()
    if threading.current_thread() is not threading.main_thread():
        yield received
        return

    def handle(number: int, _: object) -> None:
        if number == _CHECKPOINT:
            received.checkpoint = True
            return
        if received.stop:
            raise KeyboardInterrupt(f"{received.stop}, twice")
        received.stop = _NAMES[signal.Signals(number)]

    numbers = [*_NAMES, *([] if _CHECKPOINT is None else [_CHECKPOINT])]
    before = {number: signal.signal(number, handle) for number in numbers}
    _active.append(received)
    try:
        yield received
    finally:
        _active.clear()
        for number, handler in before.items():
            signal.signal(number, handler)
