"""A quantity over time, straight between points: a hydrograph, a stage, a sedigraph."""

import math
from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise


@dataclass(frozen=True)
class Course:
    """A quantity over time, straight between points and constant before the first and after the last.

    Attributes
    ----------
    t, y : times [s], ascending (twice the same is a jump), and values.
    """

    t: tuple[float, ...]
    y: tuple[float, ...]

    def at(self, time: float) -> float:
        """Value at a time [s]; at a jump that after it."""
        return self._between(bisect_right(self.t, time), time)

    def before(self, time: float) -> float:
        """Value just before a time [s]; at a jump that before it."""
        return self._between(bisect_left(self.t, time), time)

    def _between(self, k: int, time: float) -> float:
        """Value at a time in front of point k."""
        if k in (0, len(self.t)):
            return self.y[0 if k == 0 else -1]
        (a, b), (p, q) = self.t[k - 1 : k + 1], self.y[k - 1 : k + 1]
        return p + (q - p) * (time - a) / (b - a)

    def total(self, time: float) -> float:
        """Integral from the first point to a time [s]; negative before it."""
        k = bisect_right(self.t, time)
        if k == 0:
            return self.y[0] * (time - self.t[0])
        return self._totals[k - 1] + 0.5 * (self.y[k - 1] + self.before(time)) * (time - self.t[k - 1])

    @cached_property
    def _totals(self) -> list[float]:
        """Integral from the first point to each."""
        pieces = (
            0.5 * (p + q) * (b - a) for (a, b), (p, q) in zip(pairwise(self.t), pairwise(self.y), strict=True)
        )
        return [*accumulate(pieces, initial=0.0)]

    def when(self, total: float) -> float:
        """Last time up to which `total` of a course without negative values is no more than given [s]."""
        k = bisect_right(self._totals, total)
        if k in (0, len(self.t)):
            return self.t[0 if k == 0 else -1]
        (a, b), (p, q), rest = self.t[k - 1 : k + 1], self.y[k - 1 : k + 1], total - self._totals[k - 1]
        slope = (q - p) / (b - a)  # p s + slope s**2/2 = rest
        speed = p + math.sqrt(max(p * p + 2.0 * slope * rest, 0.0))
        return a + 2.0 * rest / speed if speed > 0.0 else a

    def mean(self, begin: float, end: float) -> float:
        """Mean from begin to end [s]."""
        return (self.total(end) - self.total(begin)) / (end - begin) if end > begin else self.at(begin)

    def extremes(self, begin: float, end: float) -> tuple[float, float]:
        """Lowest and highest value from begin to end [s]."""
        found = [y for t, y in zip(self.t, self.y, strict=True) if begin <= t <= end]
        found += [self.at(begin), self.before(end) if math.isfinite(end) else self.y[-1]]
        return min(found), max(found)
