"""Extrapolation over stiffness: y(k) = y_inf + a k**-p with an exponent that is known only as a range."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtri, stdtrit

Floats = NDArray[np.float64]

EXPONENT = (0.25, 1.0)  # range of p: slower than impacts (1/2), up to overlaps at given pressure (1) [-]
TRIED = np.linspace(*EXPONENT, 76)  # exponents at which the line is fitted [-]
REJECT = 0.01  # level of the test that leaves out exponents [-]
MISS = 0.04  # level of the interval at one exponent; with REJECT 5 % in all [-]


@dataclass(frozen=True)
class Bracket:
    """A number with the interval that holds it at 95 %; ends are infinite where nothing limits it."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Extrapolation:
    """Means at three or more stiffnesses, and every curve y_inf + a k**-p that agrees with them.

    Attributes
    ----------
    k_n : stiffnesses [N/m], shape (n,).
    mean : mean over seeds at each, in the unit of the measure.
    count : number of seeds at each.
    variance : variance between seeds, pooled over the stiffnesses.
    freedom : its degrees of freedom.

    Notes
    -----
    At a given p the curve is a line over k**-p, fitted by least squares; its intervals are Student's t with
    the variance between seeds. Exponents at which the means lie off the line by more than chance explains
    (F test, 1 %) are left out, and an interval is the union of those at 96 % over the exponents that are
    left. It holds the true number at 95 % or more whatever p is within its range (Berger & Boos 1994, J. Am.
    Stat. Assoc. 89, 1012). An error as a share of a number that is uncertain itself is bounded by Fieller's
    theorem (1954, J. R. Stat. Soc. B 16, 175).
    """

    k_n: Floats
    mean: Floats
    count: Floats
    variance: float
    freedom: int

    @property
    def scatter(self) -> Floats:
        """Half of the 95 % interval of the mean over the seeds at each stiffness."""
        return float(stdtrit(self.freedom, 0.975)) * np.sqrt(self.variance / self.count)

    @cached_property
    def _lines(self) -> tuple[Floats, Floats, Floats]:
        """Line at every exponent tried: y_inf and a, (p, 2); covariance (p, 2, 2); lack of fit (p,)."""
        x = self._x(self.k_n)
        design = np.stack([np.ones_like(x), x], axis=-1)
        inverse = np.linalg.inv(np.einsum("pji,j,pjk->pik", design, self.count, design))
        line = np.einsum("pik,pjk,j->pi", inverse, design, self.count * self.mean)
        rest = self.mean - np.einsum("pji,pi->pj", design, line)
        return line, self.variance * inverse, (self.count * rest**2).sum(axis=1)

    @cached_property
    def _kept(self) -> NDArray[np.bool_]:
        n = len(self.k_n) - 2
        return self._lines[2] <= float(fdtri(n, self.freedom, 1.0 - REJECT)) * n * self.variance

    @property
    def follows(self) -> bool:
        """Whether the means follow such a curve at any exponent of the range."""
        return bool(self._kept.any())

    @property
    def exponents(self) -> Bracket:
        """The exponent: where the means lie closest to the curve, and the range that is not left out."""
        kept = TRIED[self._kept]
        return Bracket(float(TRIED[self._best]), float(kept[0]), float(kept[-1]))

    @property
    def _best(self) -> int:
        return int(np.argmin(self._lines[2]))

    def _x(self, k_n: Floats) -> Floats:
        """k**-p in units of the stiffest, shape (p, n); 0 for an infinite stiffness."""
        return (np.asarray(k_n) / self.k_n.max())[None, :] ** -TRIED[:, None]

    def value(self, k_n: float) -> Bracket:
        """The measure at a stiffness [N/m], which may be infinite."""
        return self._bracket(self._weights(k_n), None)

    def error(self, k_n: float, against: float, relative: bool = True) -> Bracket:
        """The measure at a stiffness less that at another [N/m], as a share of the latter if `relative`."""
        below = self._weights(against)
        return self._bracket(self._weights(k_n) - below, below if relative else None)

    def _weights(self, k_n: float) -> Floats:
        """Weights of y_inf and a in the measure at a stiffness, shape (p, 2)."""
        x = self._x(np.array([k_n]))
        return np.concatenate([np.ones_like(x), x], axis=1)

    def _bracket(self, above: Floats, below: Floats | None) -> Bracket:
        """Bracket of a linear combination of y_inf and a, or of the quotient of two."""
        line, cover, _ = self._lines
        t = float(stdtrit(self.freedom, 1.0 - 0.5 * MISS))
        top, top_top = _product(above, line), _variance(above, cover, above)
        if below is None:
            half = t * np.sqrt(top_top)
            middle, low, high = top, top - half, top + half
        else:
            down, down_down = _product(below, line), _variance(below, cover, below)
            middle, low, high = _fieller(top, down, top_top, _variance(above, cover, below), down_down, t)
        kept = self._kept
        if not kept.any():
            return Bracket(float(middle[self._best]), -math.inf, math.inf)
        return Bracket(float(middle[self._best]), float(low[kept].min()), float(high[kept].max()))

    def with_seeds(self, factor: float) -> "Extrapolation":
        """The same means and scatter, were there so many times the seeds."""
        count = self.count * factor
        return replace(self, count=count, freedom=max(round(float(count.sum())) - len(count), 1))


def extrapolation(k_n: Sequence[float], values: Sequence[Sequence[float]]) -> Extrapolation:
    """Extrapolate a measure over stiffness.

    Parameters
    ----------
    k_n : three or more different stiffnesses [N/m].
    values : the measure at each, one number per seed; finite.

    Raises
    ------
    ValueError : fewer than three stiffnesses, or seeds that do not scatter.

    >>> found = extrapolation([1.0, 4.0, 16.0], [[1.9, 2.1], [1.4, 1.6], [1.15, 1.35]])
    >>> round(found.value(float("inf")).value, 2), found.exponents.value
    (1.0, 0.5)
    """
    rows = [np.asarray(one, dtype=np.float64) for one in values]
    freedom = sum(len(one) - 1 for one in rows)
    spread = sum(float(((one - one.mean()) ** 2).sum()) for one in rows)
    if len(set(k_n)) < 3 or freedom < 1 or not spread > 0.0:
        raise ValueError("needs three stiffnesses, and seeds that scatter")
    mean, count = np.array([one.mean() for one in rows]), np.array([float(len(one)) for one in rows])
    return Extrapolation(np.asarray(k_n, dtype=np.float64), mean, count, spread / freedom, freedom)


def _product(weights: Floats, line: Floats) -> Floats:
    return (weights * line).sum(axis=1)


def _variance(one: Floats, cover: Floats, other: Floats) -> Floats:
    return np.einsum("pi,pij,pj->p", one, cover, other)


def _fieller(
    top: Floats, down: Floats, top_top: Floats, top_down: Floats, down_down: Floats, t: float
) -> tuple[Floats, Floats, Floats]:
    """Quotient top/down and its interval; infinite where `down` does not differ from 0."""
    a = down**2 - t * t * down_down
    b = top * down - t * t * top_down
    c = top**2 - t * t * top_top
    known = a > 0.0
    safe = np.where(known, a, 1.0)
    half = np.sqrt(np.maximum(b * b - a * c, 0.0)) / safe
    low, high = np.where(known, b / safe - half, -np.inf), np.where(known, b / safe + half, np.inf)
    return top / np.where(down == 0.0, np.nan, down), low, high
