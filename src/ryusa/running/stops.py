"""Stop rules: simulated time, all grains at rest, or a number of saltations of every grain."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ryusa.casefile.precision import ErrorLimit
from ryusa.engine.protocol import Engine
from ryusa.errors import CaseError
from ryusa.model import Scene
from ryusa.model.scene import EventRule

_MOST_STEPS = 2**62
# Rise of the centre, in d, that a flight between two bed contacts must allow to be a saltation.
HOP_RISE = 0.1


@dataclass(frozen=True)
class Stop:
    """Conditions that end a run; the first one that is met ends it."""

    time: float = math.inf  # simulated [s]
    rest_speed: float = 0.0  # all grains slower than this [m/s], at their centre and surface ...
    rest_for: float = math.inf  # ... for this long [s]
    saltations: int | None = None  # saltations that every tracked grain must have made
    settle: float = 0.0  # saltations that begin before this time, and averages of it, do not count [s]
    precision: Mapping[str, ErrorLimit] = field(default_factory=dict[str, ErrorLimit])  # of averages

    @property
    def endless(self) -> bool:
        """True if no condition would ever end the run."""
        return math.isinf(self.time) and math.isinf(self.rest_for) and self.saltations is None


def refuse_stop(stop: Stop, scene: Scene, frames: float) -> None:
    """Refuse a run that would never end, or whose steps or frames cannot be made.

    Raises
    ------
    CaseError : names the key.
    """
    if stop.endless:
        raise CaseError(
            "stop", None, "needs time, saltations or rest: without one of them the run would never end"
        )
    if not frames >= scene.dt:
        raise CaseError("record.frames", f"{frames:g} s", f"must be at least one step, {scene.dt:g} s")
    if math.isfinite(stop.time) and stop.time / scene.dt > _MOST_STEPS:
        raise CaseError(
            "stop.time", f"{stop.time:g} s", f"gives more steps of {scene.dt:g} s than can be counted"
        )
    if stop.saltations is not None and scene.events == EventRule.NONE:
        raise CaseError("record.events", "none", "must be 'all' or 'tracked' when saltations end the run")


class RestDetector:
    """Detects that every grain has been slow for long enough; evaluated at fixed steps."""

    def __init__(self, stop: Stop) -> None:
        self._stop = stop
        self.since: float | None = None  # time since which all grains are slow [s]

    def check_steps(self, dt: float) -> int | None:
        """Steps of dt [s] between two checks, four within the time that counts as rest; None: never."""
        if math.isinf(self._stop.rest_for):
            return None
        return max(1, round(self._stop.rest_for / 4 / dt))

    def fastest(self, engine: Engine, scene: Scene) -> float:
        """Largest present speed of a grain [m/s], at its centre or, if it spins in place, at its surface."""
        fastest = engine.tally().speed_max
        if fastest >= self._stop.rest_speed or not scene.rotation:
            return fastest
        spin = np.linalg.norm(engine.grains().omega, axis=1)
        surface = spin * scene.d / 2  # nan where a grain is not there
        return max(fastest, float(surface[~np.isnan(surface)].max(initial=0.0)))

    def reached(self, t: float, speed_max: float) -> bool:
        """Update with the largest speed of a centre or a spinning surface [m/s] at time t [s]."""
        if speed_max >= self._stop.rest_speed:
            self.since = None
            return False
        if self.since is None:
            self.since = t
        return t - self.since >= self._stop.rest_for


class SaltationCounter:
    """Counts saltations from bed contacts.

    A saltation is a flight between two bed contacts of a grain that lasts longer than that of a free flight
    that rises by HOP_RISE d, 2 sqrt(2 HOP_RISE d/g'); g' is submerged weight over mass with added mass. It
    must begin after the settling time. The count only ends the run; measures evaluate the recorded flights.
    """

    def __init__(self, scene: Scene, stop: Stop) -> None:
        g = math.hypot(*(float(component) for component in scene.gravity))
        fall = g * scene.m_weight / (scene.m + scene.m_added)
        with np.errstate(divide="ignore"):  # a floating grain does not return
            self._flight = 2.0 * np.sqrt(2.0 * HOP_RISE * scene.d / np.maximum(fall, 0.0))
        self._n_grain, self._stop = scene.n_grain, stop
        self.parted = np.full(scene.n_grain, -math.inf)
        self.count = np.zeros(scene.n_grain, dtype=np.int64)
        tracked = np.asarray(scene.tracked, dtype=bool)
        self._tracked = tracked if len(tracked) == scene.n_grain else np.ones(scene.n_grain, dtype=bool)

    def contacts(self, events: NDArray[np.void]) -> None:
        """Update with contacts that ended, in order of their end."""
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
        """Smallest count among the tracked grains."""
        return int(self.count[self._tracked].min()) if self._tracked.any() else 0

    def reached(self) -> bool:
        """True if every tracked grain has made the required number."""
        return self._stop.saltations is not None and self.least >= self._stop.saltations
