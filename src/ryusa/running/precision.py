"""Precision as a stop rule: averages measured while the run goes, until their standard errors are small.

Frames are counted from the begin of the window, and averages are measured at certain counts: 60, and from
there each 1/8 larger (design/0013 says why). When the rule is met depends on recorded frames alone, so that a
run that was stopped and continued, or ran on other threads, ends at the same step.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ryusa.casefile.precision import INDEPENDENT, ErrorLimit, measure_of
from ryusa.catalogue import MEASURES, load
from ryusa.errors import ResultsError
from ryusa.results import Results

if TYPE_CHECKING:
    from ryusa.measure.statistics import Average

_GROWTH = 8  # each number of frames is larger than the one before by an eighth
_TIMES = 2  # successive measurements that must be good enough


def counts() -> Iterator[int]:
    """Numbers of frames in the window at which averages are measured.

    >>> from itertools import islice
    >>> list(islice(counts(), 5))
    [60, 68, 77, 87, 98]
    """
    count = INDEPENDENT
    while True:
        yield count
        count += math.ceil(count / _GROWTH)


@dataclass(frozen=True)
class KnownAverage:
    """An average, and the standard error that it may have."""

    average: "Average"
    limit: ErrorLimit

    @property
    def enough(self) -> bool:
        """True where a long record is steady and its error as small as asked for; no share of 0 is known."""
        one, allowed = self.average, self.limit.of(self.average.value)
        small = allowed > 0.0 and one.error <= allowed
        return small and one.steady and one.independent >= INDEPENDENT

    @property
    def longer(self) -> float:
        """Window needed over the present one [-], as the error falls with 1/sqrt(T); nan if unknown."""
        one, allowed = self.average, self.limit.of(self.average.value)
        if not (allowed > 0.0 and one.independent > 0.0):
            return math.nan
        return max((one.error / allowed) ** 2, INDEPENDENT / one.independent)

    def __str__(self) -> str:
        one = self.average
        unit = "" if one.unit == "-" else f" {one.unit}"
        error = f"{one.error:.2g}{unit}"
        if one.value and not self.limit.unit:
            error = f"{100.0 * one.error / abs(one.value):.2g} %"
        doubts = f", worth {one.independent:.0f} of {INDEPENDENT} independent samples"
        doubt = doubts if one.independent < INDEPENDENT else ""
        doubt += f", steady: {one.verdict}" if one.changes else ""
        return f"{one.name} = {one.value:.4g}{unit} ± {error} ({self.limit} asked for{doubt})"


class PrecisionRule:
    """Ends a run when averages are known well enough.

    Parameters
    ----------
    folder : the run folder, from which the averages are measured.
    limits : by average, its largest standard error; empty: the rule is never met.
    begin : begin of the window [s].
    frames : time between frames [s].
    """

    def __init__(self, folder: Path, limits: Mapping[str, ErrorLimit], begin: float, frames: float) -> None:
        self._folder, self._limits, self._begin, self._frames = folder, limits, begin, frames
        self.known: tuple[KnownAverage, ...] = ()  # at the last measurement
        self._why = f"fewer than {INDEPENDENT} frames after t = {begin:g} s"  # where nothing is known
        self._good = 0  # successive measurements that were good enough

    @property
    def asked(self) -> bool:
        """True if the case asks for a precision."""
        return bool(self._limits)

    @property
    def met(self) -> bool:
        """True if the last two measurements were good enough."""
        return self.asked and self._good >= _TIMES

    def due(self, frame: int, t_first: float) -> bool:
        """True if averages are to be measured at this frame; frame 0 has the time t_first [s]."""
        return self.asked and self._count(frame, t_first) in self._until(frame, t_first)

    def measure(self, frame: int) -> None:
        """Measure the averages over all frames of the window up to this one; they must be in the folder."""
        results = Results.open(self._folder)
        end = float(results.frames.t[frame])
        found: list[Average] = []
        try:
            for name in dict.fromkeys(measure_of(one) for one in self._limits):
                entry = next(one for one in MEASURES if one.name == name)
                averages = load(entry.function)(results, begin=self._begin, end=end).averages
                found += [averages[one] for one in entry.precision if one in self._limits]
        except (ResultsError, KeyError) as error:  # such as a column without clear water; that may change
            self._why, found = str(error), []
        self.take(found)

    def take(self, averages: "list[Average]") -> None:
        """Hold new averages against what is asked for."""
        self.known = tuple(KnownAverage(one, self._limits[one.name]) for one in averages)
        good = len(self.known) == len(self._limits) and all(one.enough for one in self.known)
        self._good = self._good + 1 if good else 0

    def restore(self, frame: int, t_first: float) -> None:
        """Measure again what had been measured up to this frame, as far as the rule depends on it."""
        if self.asked:
            first = frame - self._count(frame, t_first)
            for count in self._until(frame, t_first)[-_TIMES:]:
                self.measure(first + count)

    def share(self, t: float) -> float:
        """Share of the run that is done at time t [s], by the errors last measured; 0 if unknown."""
        if not self.known:
            return 0.0
        begin, end = self.known[0].average.window
        needed = begin + (end - begin) * self._longer()
        return t / needed if needed > 0.0 else 0.0

    def missed(self) -> str:
        """What is said of the precision at the end of a run that reached its last time."""
        return f"; precision {self._verdict()}: {self}" if self.asked else ""

    def _verdict(self) -> str:
        """Whether the precision is reached; else how much longer the run would have to be."""
        if self.known and all(one.enough for one in self.known):
            return "reached"
        said, longer = "not reached", self._longer()
        if longer > 1.0:
            begin, end = self.known[0].average.window
            said += f", about {(end - begin) * (longer - 1.0):.2g} s more are needed (error ~ 1/sqrt(T))"
        changing = [one.average.name for one in self.known if one.average.changes]
        if changing:
            said += f", {' and '.join(changing)} not steady (a later record.settle leaves out the start)"
        return said

    def _longer(self) -> float:
        """Window that the slowest average needs over the present one [-]; nan where one is unknown."""
        every = [one.longer for one in self.known]
        return max(every) if every and math.isfinite(sum(every)) else math.nan

    def __str__(self) -> str:
        return ", ".join(str(one) for one in self.known) or self._why

    def summary(self) -> dict[str, Any]:
        """The last measurement as plain data, for summary.json."""
        return {
            "reached": bool(self.known) and all(one.enough for one in self.known),
            "text": f"{self._verdict()}: {self}",
            "averages": [
                {
                    "name": one.average.name,
                    "unit": one.average.unit,
                    "value": _or_none(one.average.value),
                    "standard_error": _or_none(one.average.error),
                    "asked_for": str(one.limit),
                    "steady": one.average.steady,
                    "window": list(one.average.window),
                }
                for one in self.known
            ],
        }

    def _count(self, frame: int, t_first: float) -> int:
        """Number of frames in the window up to this one."""
        return frame + 1 - max(math.ceil((self._begin - t_first) / self._frames - 1e-9), 0)

    def _until(self, frame: int, t_first: float) -> list[int]:
        """Numbers of frames at which averages have been measured up to this frame."""
        found: list[int] = []
        for count in counts():
            if count > self._count(frame, t_first):
                return found
            found.append(count)
        return found


def _or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None
