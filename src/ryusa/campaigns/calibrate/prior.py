"""What is known of a parameter before the observations: a distribution over a range."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, ndtri

from ryusa.units import quantity, si_unit

Floats = NDArray[np.float64]

DIGITS = 6  # of a value in a case
UNIFORM, LOG, NORMAL = "uniform", "log-uniform", "normal"


@dataclass(frozen=True)
class Prior:
    """Distribution of one parameter, in the unit in which the study writes it.

    Every distribution is that of a function of a share u, uniform from 0 to 1 (its quantile function). All
    calculations are in u, in which the prior of several parameters is a unit cube.

    Attributes
    ----------
    key : key of the case.
    kind : "uniform", "log-uniform", or "normal" between `low` and `high`.
    low, high : ends of the range [unit].
    unit : unit as written; "" for none.
    mean, sd : of the normal distribution before it is cut at the ends [unit]; nan for the others.
    """

    key: str
    kind: str
    low: float
    high: float
    unit: str = ""
    mean: float = math.nan
    sd: float = math.nan

    def at(self, u: ArrayLike) -> Floats:
        """Values at shares u [unit].

        >>> Prior("a", "uniform", 10.0, 40.0, "deg").at(0.5).item()
        25.0
        """
        shares = np.asarray(u, dtype=np.float64)
        if self.kind == LOG:
            return self.low * (self.high / self.low) ** shares
        if self.kind == NORMAL:
            below, above = self._cut()
            value = self.mean + self.sd * ndtri(below + shares * (above - below))
            return np.minimum(np.maximum(value, self.low), self.high)  # round-off at the ends
        return self.low + shares * (self.high - self.low)

    def share(self, value: ArrayLike) -> Floats:
        """Shares u of values; the inverse of `at`.

        >>> round(Prior("a", "log-uniform", 1.0, 100.0).share(10.0).item(), 12)
        0.5
        """
        held = np.asarray(value, dtype=np.float64)
        if self.kind == LOG:
            return np.log(held / self.low) / math.log(self.high / self.low)
        if self.kind == NORMAL:
            below, above = self._cut()
            return (ndtr((held - self.mean) / self.sd) - below) / (above - below)
        return (held - self.low) / (self.high - self.low)

    def text(self, u: float) -> str:
        """Value at a share, as a case takes it.

        >>> Prior("a", "uniform", 10.0, 40.0, "deg").text(1 / 3)
        '20 deg'
        """
        return f"{float(self.at(u)):.{DIGITS}g} {self.unit}".rstrip()

    @property
    def words(self) -> str:
        """The distribution in words.

        >>> Prior("a", "uniform", 10.0, 40.0, "deg").words
        'uniform from 10 to 40 deg'
        """
        ends = f"from {self.low:g} to {self.high:g} {self.unit}".rstrip()
        if self.kind == NORMAL:
            return f"normal, {self.mean:g} ± {self.sd:g}, {ends}"
        return f"{self.kind} {ends}"

    @property
    def si(self) -> tuple[str, float]:
        """SI unit, and size of the unit in it."""
        unit = si_unit(f"1 {self.unit}") if self.unit else ""
        return (unit, quantity(f"1 {self.unit}", unit)) if unit else (self.unit, 1.0)

    def _cut(self) -> tuple[float, float]:
        return float(ndtr((self.low - self.mean) / self.sd)), float(ndtr((self.high - self.mean) / self.sd))


def in_cube(priors: "tuple[Prior, ...]", u: Floats) -> Floats:
    """Values of all parameters at points of the unit cube.

    Parameters
    ----------
    priors : one per parameter.
    u : points, shape (n, n_parameters), 0 to 1.

    Returns
    -------
    values : shape (n, n_parameters), in the units of the priors.
    """
    return np.column_stack([prior.at(u[:, k]) for k, prior in enumerate(priors)])
