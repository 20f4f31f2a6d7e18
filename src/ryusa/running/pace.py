"""How fast a run goes: grains times steps per second, and steps between two looks at the clock."""

import math
import time
from dataclasses import dataclass, field

from ryusa.casefile.wall_time import WallTime
from ryusa.compiled import waiting
from ryusa.engine import registry

_LONG = 2.0  # days on the CPU engine from which other engines are named
_CHUNK = 0.25  # s of wall time between two checks of clock and signals
_CHUNK_FIRST = (1, 16)  # steps of the first calls, while the speed is unknown


def other_engines(engine: object, n_grain: int, took: WallTime, threads: int) -> tuple[str, ...]:
    """A note on a long run of the CPU engine, with the engines that may serve better; or none.

    Parameters
    ----------
    engine : as asked for; None is that of the CPU.
    n_grain : number of grains.
    took : wall time that the run is expected to take on these threads.
    threads : threads of the engine.
    """
    days = took.seconds / 86_400.0
    if engine not in {None, registry.DEFAULT} or not _LONG <= days < math.inf:
        return ()
    others = [name for name in registry.names() if name != registry.DEFAULT]
    here = [
        f"--engine {name} ({registry.unavailable(name) or registry.entry(name).summary})" for name in others
    ]
    return (
        f"about {days:.2g} days on {threads} thread{'s' if threads > 1 else ''}, {took.basis} "
        f"({n_grain:,} grains). Other engines: {'; '.join(here)} (docs/big-runs.md)",
    )


def stepping_time() -> float:
    """A wall clock that stands still while a function is compiled [s]."""
    return time.monotonic() - waiting.done().wall


@dataclass
class Pace:
    """Speed of a run, from the wall time of the calls of its engine; compiling does not count.

    Attributes
    ----------
    calls : calls so far.
    """

    calls: int = 0
    _speed: float = 0.0  # steps per second, running mean
    _since: float = 0.0  # wall time without compiling, when kernels were ready
    _moved: int = 0  # grains times steps since then
    _compiled_before: float = field(default_factory=lambda: waiting.done().wall)  # by earlier runs

    def begin(self, compiled: float) -> None:
        """Count from now on, in a run that has compiled for some time before [s]."""
        self._since = stepping_time()
        self._compiled_before -= compiled

    def took(self, n_steps: int, n_grain: int, begun: float) -> None:
        """Take a call of n_steps steps of n_grain grains that began at a `stepping_time` [s]."""
        now = stepping_time()
        speed = n_steps / max(now - begun, 1e-9)
        if self.calls <= 1:
            self._since, self._moved, self._speed = now, 0, speed
        else:
            self._moved += n_grain * n_steps
            self._speed += 0.3 * (speed - self._speed)
        self.calls += 1

    @property
    def steps(self) -> int:
        """Steps of the next call at most."""
        if self.calls < len(_CHUNK_FIRST):
            return _CHUNK_FIRST[self.calls]
        return max(1, int(self._speed * _CHUNK))

    @property
    def compiled(self) -> float:
        """Wall time of the run so far in which it compiled [s]."""
        return waiting.done().wall - self._compiled_before

    @property
    def rate(self) -> float:
        """Particle-steps per second since compilation, recording included."""
        return self._moved / max(stepping_time() - self._since, 1e-9)
