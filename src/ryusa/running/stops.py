"""Stop rules: simulated time, all grains at rest, or so many saltations of every grain."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.model import Scene

HOP_RISE = (
    0.1  # d that a grain's centre must be able to rise between two bed contacts for it to count as a hop
)


@dataclass(frozen=True)
class Stop:
    """When a run ends: whichever comes first."""

    time: float = math.inf  # simulated [s]
    rest_speed: float = 0.0  # all grains slower than this [m/s], surfaces of spinning ones too ...
    rest_for: float = math.inf  # ... for this long [s]
    saltations: int | None = None  # hops that every watched grain must have done
    settle: float = 0.0  # hops before this time do not count [s]

    @property
    def endless(self) -> bool:
        """True when nothing would ever stop the run."""
        return math.isinf(self.time) and math.isinf(self.rest_for) and self.saltations is None


class Rest:
    """Watches whether every grain is slow for long enough; looked at at fixed steps, never by the clock."""

    def __init__(self, stop: Stop) -> None:
        self._stop = stop
        self.since: float | None = None  # when all were slow first [s]

    def reached(self, t: float, speed_max: float) -> bool:
        """Take the largest speed of a centre or a spinning surface [m/s] at time t [s]."""
        if speed_max >= self._stop.rest_speed:
            self.since = None
            return False
        if self.since is None:
            self.since = t
        return t - self.since >= self._stop.rest_for


class Hops:
    """Counts saltations from bed contacts.

    A hop is a flight between two bed contacts of a grain in which its centre rises more than HOP_RISE d if it
    flies freely: one longer than 2 sqrt(2 HOP_RISE d/g'), g' submerged gravity over the inertia with added
    mass. It begins after the settling time. Measures look at the flight itself; this only stops the run.
    """

    def __init__(self, scene: Scene, stop: Stop) -> None:
        g = math.hypot(*(float(component) for component in scene.gravity))
        fall = g * scene.m_weight / (scene.m + scene.m_added)
        with np.errstate(divide="ignore"):  # what floats never comes back
            self._flight = 2.0 * np.sqrt(2.0 * HOP_RISE * scene.d / np.maximum(fall, 0.0))
        self._n_grain, self._stop = scene.n_grain, stop
        self.parted = np.full(scene.n_grain, -math.inf)
        self.count = np.zeros(scene.n_grain, dtype=np.int64)
        tracked = np.asarray(scene.tracked, dtype=bool)
        self._watched = tracked if len(tracked) == scene.n_grain else np.ones(scene.n_grain, dtype=bool)

    def contacts(self, events: NDArray[np.void]) -> None:
        """Take contacts that ended, in order of ending."""
        bed = events[events["j"] >= self._n_grain]
        for i, begin, part in zip(
            bed["i"].tolist(), bed["t_begin"].tolist(), bed["t_part"].tolist(), strict=True
        ):
            parted = self.parted[i]
            if parted >= self._stop.settle and begin - parted > self._flight[i]:
                self.count[i] += 1
            self.parted[i] = max(parted, part)

    @property
    def least(self) -> int:
        """Hops of the watched grain that has fewest."""
        return int(self.count[self._watched].min()) if self._watched.any() else 0

    def reached(self) -> bool:
        """Say whether every watched grain has done enough."""
        return self._stop.saltations is not None and self.least >= self._stop.saltations
