"""Sizes by mass: a grading curve, what follows from it, and diameters that lay it grain by grain.

A curve is percent finer by mass over diameter, straight between its points over log d. On that axis the
sieves of a series stand evenly (each sqrt(2) or 2 times the next), and so do the limits of ISO 14688-1 (2,
6.3, 20, 63 mm, two to a decade) and the classes of Wentworth 1922, whole phi = -log2(d/mm), in which
percentiles are read off (Folk & Ward 1957); between two sieves a straight line adds no shape of its own.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from ryusa.model.arrays import Floats

SHARES = (0.10, 0.16, 0.50, 0.84, 0.90)  # finer by mass, of the diameters D10 ... D90 that are named


class GradingFault(ValueError):
    """A curve that cannot be: what is wrong, and at which point.

    Attributes
    ----------
    point : number of the point, from 0, in the order given.
    """

    def __init__(self, message: str, point: int) -> None:
        self.point = point
        super().__init__(message)


@dataclass(frozen=True)
class Grading:
    """A grading curve: share finer by mass over diameter, straight in log d between its points.

    Attributes
    ----------
    d : diameters [m], ascending, shape (n_point,), at least two.
    finer : share of the mass in grains below d [-], never falling, shape (n_point,).
    """

    d: Floats
    finer: Floats

    @classmethod
    def of(cls, points: Sequence[tuple[float, float]]) -> Self:
        """Curve of pairs of diameter [m] and share finer [-], from fine to coarse or from coarse to fine.

        Raises
        ------
        GradingFault : fewer than two points, a diameter twice or out of order, a share out of order or
            outside 0 to 1.

        >>> Grading.of([(0.002, 1.0), (0.001, 0.0)]).d.tolist()
        [0.001, 0.002]
        """
        if len(points) < 2:
            raise GradingFault("needs at least two points, one at 0 % finer and one at 100 %", 0)
        d = np.array([one for one, _ in points], dtype=np.float64)
        finer = np.array([one for _, one in points], dtype=np.float64)
        outside = np.flatnonzero(~((finer >= 0.0) & (finer <= 1.0)))
        if len(outside):
            k = int(outside[0])
            raise GradingFault(f"percent finer must be from 0 to 100, found {100.0 * finer[k]:g}", k)
        falling = bool(d[-1] < d[0])
        step = -np.diff(d) if falling else np.diff(d)
        for k in np.flatnonzero(~(step > 0.0)).tolist():
            if step[k] == 0.0:
                raise GradingFault(f"the diameter {_mm(d[k + 1])} appears twice", k + 1)
            way = "fall" if falling else "rise"
            raise GradingFault(
                f"diameters must {way} from point to point, but {_mm(d[k + 1])} comes after {_mm(d[k])}",
                k + 1,
            )
        gain = -np.diff(finer) if falling else np.diff(finer)
        for k in np.flatnonzero(gain < 0.0).tolist():
            low, high = (k + 1, k) if falling else (k, k + 1)
            raise GradingFault(
                f"percent finer must not fall towards larger diameters, but {100.0 * finer[high]:g} at "
                f"{_mm(d[high])} is less than {100.0 * finer[low]:g} at {_mm(d[low])}",
                k + 1,
            )
        return cls(d[::-1].copy(), finer[::-1].copy()) if falling else cls(d, finer)

    @property
    def closed(self) -> bool:
        """Whether the curve begins at 0 and ends at 1, so that every grain has a size."""
        return bool(self.finer[0] == 0.0 and self.finer[-1] == 1.0)

    def share_below(self, d: float) -> float:
        """Share of the mass in grains below a diameter [m].

        >>> round(Grading.of([(0.001, 0.0), (0.004, 1.0)]).share_below(0.002), 12)
        0.5
        """
        return float(np.interp(math.log(d), np.log(self.d), self.finer))

    def number_below(self, d: float) -> float:
        """Share of the number of grains below a diameter [m]; dN = dM/d^3.

        >>> even = Grading.of([(1.0, 0.0), (4.0, 1.0)])  # (1 - 1/8)/(1 - 1/64)
        >>> round(even.number_below(2.0) / (56.0 / 63.0), 12)
        1.0
        """
        if not d > self.d[0]:
            return 0.0
        k = int(np.searchsorted(self.d, d, side="left"))
        inner = np.concatenate([self.d[:k], [d]]) if k < len(self.d) else self.d
        finer = np.interp(np.log(inner), np.log(self.d), self.finer)
        return float(Grading(inner, finer)._numbers()[-1] / self._numbers()[-1])

    def diameter(self, share: float) -> float:
        """Diameter below which there is a share of the mass [m]; D50 for 0.5.

        >>> round(Grading.of([(0.001, 0.0), (0.004, 1.0)]).diameter(0.5), 12)
        0.002
        """
        return float(np.exp(np.interp(share, self.finer, np.log(self.d))))

    def cut(self, finest: float = 0.0, coarsest: float = math.inf) -> Self:
        """Closed curve of what lies between two diameters [m]: its mass alone is 100 %.

        Raises
        ------
        GradingFault : no mass lies between them.
        """
        low, high = max(finest, float(self.d[0])), min(coarsest, float(self.d[-1]))
        below, under = (self.share_below(one) for one in (low, high)) if low < high else (0.0, 0.0)
        if not under > below:
            raise GradingFault(f"no mass lies between {_mm(low)} and {_mm(high)}", 0)
        inside = (self.d > low) & (self.d < high)
        d = np.concatenate([[low], self.d[inside], [high]])
        finer = (np.concatenate([[below], self.finer[inside], [under]]) - below) / (under - below)
        first = int(np.flatnonzero(finer > 0.0)[0]) - 1  # what has no mass at the ends is no part of it
        last = int(np.flatnonzero(finer < 1.0)[-1]) + 1
        return type(self)(d[first : last + 1], finer[first : last + 1])

    @property
    def sorting(self) -> float:
        """Geometric standard deviation sqrt(D84/D16) [-]."""
        return math.sqrt(self.diameter(0.84) / self.diameter(0.16))

    @property
    def mean_cube(self) -> float:
        """Mean of d^3 over the grains [m3]: mass per grain over density and shape factor.

        Notes
        -----
        Derived: dN = dM/d^3, so that the mean is 1 over the integral of dM/d^3, and dM is proportional to
        d(log d) between two points.

        >>> even = Grading.of([(1.0, 0.0), (2.0, 1.0)])  # even in log d: 3 ln(2)/(1 - 1/8)
        >>> round(even.mean_cube / (3.0 * math.log(2.0) / (1.0 - 2.0**-3)), 12)
        1.0
        """
        return 1.0 / float(self._numbers()[-1])

    @property
    def mean_diameter(self) -> float:
        """Mean of d over the grains [m]: number mean, far below D50 where the curve is wide.

        >>> even = Grading.of([(1.0, 0.0), (2.0, 1.0)])
        >>> round(even.mean_diameter / (1.5 * (1.0 - 2.0**-2) / (1.0 - 2.0**-3)), 12)
        1.0
        """
        per_log = np.diff(self.finer) / np.diff(np.log(self.d))
        return float((per_log * -np.diff(self.d**-2.0)).sum()) / 2.0 * self.mean_cube

    def _numbers(self) -> Floats:
        """Integral of dM/d^3 from the finest grain to each point [1/m3], shape (n_point,)."""
        per_log = np.diff(self.finer) / np.diff(np.log(self.d))
        return np.concatenate([[0.0], np.cumsum(per_log * -np.diff(self.d**-3.0) / 3.0)])

    def quotas(self, n: int) -> Floats:
        """Diameters [m] of n grains that lay the curve as closely as n grains can, ascending.

        Returns
        -------
        d : one grain for every n-th of the number of grains, of the mean mass of that n-th, shape (n,).

        Notes
        -----
        Derived. The curve is cut into n parts of equal number of grains; each has one grain, and the grain
        has the mass of its part. So the mass laid up to the end of every part is what the curve asks, and in
        between it differs by less than the mass of one grain there, for the coarsest about
        `largest_share(n)`.

        >>> d = Grading.of([(0.001, 0.0), (0.004, 1.0)]).quotas(1000)
        >>> coarse = d[d > 0.002]
        >>> bool(abs((coarse**3).sum() / (d**3).sum() - 0.5) < 0.01)
        True
        """
        d, mass = self._parts(np.arange(n + 1) / max(n, 1))
        found = np.cbrt(np.diff(mass) * n * self.mean_cube)
        return np.clip(found, d[:-1], d[1:])  # the mean lies within its part but for round-off

    def largest_share(self, n: int) -> float:
        """Share of the mass in the coarsest of n grains [-]: the step of the curve laid at its end."""
        return 1.0 - float(self._parts(np.array([1.0 - 1.0 / n]))[1][0])

    def _parts(self, number: Floats) -> tuple[Floats, Floats]:
        """Diameter [m] and share of the mass below it where shares of the number of grains end."""
        numbers = self._numbers()
        wanted = number * numbers[-1]
        k = np.clip(np.searchsorted(numbers, wanted, side="right") - 1, 0, len(self.d) - 2)
        per_log = (np.diff(self.finer) / np.diff(np.log(self.d)))[k]
        inverse = self.d[k] ** -3.0 - np.divide(
            3.0 * (wanted - numbers[k]), per_log, np.zeros_like(wanted), where=per_log > 0.0
        )
        d = np.clip(np.maximum(inverse, self.d[k + 1] ** -3.0) ** (-1.0 / 3.0), self.d[k], self.d[k + 1])
        mass = self.finer[k] + per_log * np.log(d / self.d[k])
        d[number >= 1.0], mass[number >= 1.0] = self.d[-1], self.finer[-1]
        return d, mass


def laid(d: Floats, m: Floats) -> Grading:
    """Grading curve of single grains, each counting half below its own diameter.

    Parameters
    ----------
    d, m : diameters [m] and masses [kg], shape (n,).
    """
    sizes, which = np.unique(d, return_inverse=True)
    mass = np.bincount(which, weights=m, minlength=len(sizes))
    return Grading(sizes, (np.cumsum(mass) - 0.5 * mass) / mass.sum())


def _mm(d: float) -> str:
    return f"{1.0e3 * d:.6g} mm"
