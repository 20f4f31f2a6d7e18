"""Fit of a rolling coefficient and a friction angle to the slope of a heap and a saltating grain's spin."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from ryusa.study import CONFIDENCE

RESAMPLES = 1999
STEP, COARSE = 2.5, 13  # between friction angles [deg], and coefficients, where a pair is searched for

Runs = Mapping[tuple[float, float], Sequence[float]]  # numbers of all seeds, by coefficient and angle [deg]


@dataclass(frozen=True)
class SlopeFit:
    """Least squares of the slope against ln mu_r, its square, the friction angle and the product of both.

    Attributes
    ----------
    runs : slopes [deg].
    terms : of the fit, in the order 1, ln mu_r, (ln mu_r)**2, angle, angle ln mu_r.
    """

    runs: Runs
    terms: Sequence[float]

    @classmethod
    def of(cls, runs: Runs) -> "SlopeFit":
        """Fit it."""
        rows = [(_row(*key), value) for key, values in runs.items() for value in values]
        left, right = (np.array(one, dtype=np.float64) for one in zip(*rows, strict=True))
        return cls(runs, [float(one) for one in np.linalg.lstsq(left, right, rcond=None)[0]])

    def at(self, mu_r: float, angle: float) -> float:
        """Value of the fit [deg]."""
        return float(np.dot(_row(mu_r, angle), self.terms))

    def resampled(self, random: np.random.Generator) -> "SlopeFit":
        """Fit again, to the fitted values with residuals drawn from those of all runs."""
        left = np.array([value - self.at(*key) for key, values in self.runs.items() for value in values])
        left *= math.sqrt(len(left) / (len(left) - len(self.terms)))
        return SlopeFit.of(
            {
                key: [self.at(*key) + float(one) for one in random.choice(left, len(values))]
                for key, values in self.runs.items()
            }
        )

    def resamples(self, n: int = RESAMPLES) -> list["SlopeFit"]:
        """Repeat the fit for so many resamples."""
        random = np.random.default_rng(1)
        return [self.resampled(random) for _ in range(n)]

    def coefficient(self, wanted: float, angle: float) -> float:
        """Smallest coefficient within those tried at which the fit has a value; nan if at none."""
        one, x, square, y, both = self.terms
        turned = _row(1.0, angle)[3]
        roots = np.roots([square, x + both * turned, one + y * turned - wanted])
        ends = [math.log(key[0]) for key in self.runs]
        inside = [float(r.real) for r in roots if r.imag == 0.0 and min(ends) <= r.real <= max(ends)]
        return math.exp(min(inside)) if inside else math.nan


def _row(mu_r: float, angle: float) -> list[float]:
    x, y = math.log(mu_r), (angle - 30.0) / 10.0
    return [1.0, x, x * x, y, x * y]


@dataclass(frozen=True)
class SpinFit:
    """Mean logarithm of the spin over seeds, linear between the coefficients (in ln mu_r) and angles tried.

    Attributes
    ----------
    runs : spins [rad/s], at every pair of the coefficients and angles tried.
    """

    runs: Runs

    @cached_property
    def _between(self) -> Any:
        mu_r, angle = (sorted({key[k] for key in self.runs}) for k in (0, 1))
        means = [[np.log(self.runs[one, other]).mean() for other in angle] for one in mu_r]
        return RegularGridInterpolator((np.log(mu_r), angle), means)

    def at(self, mu_r: float, angle: float) -> float:
        """Spin between those measured [rad/s]."""
        return math.exp(float(self._between((math.log(mu_r), angle))))

    def resampled(self, random: np.random.Generator) -> "SpinFit":
        """Draw seeds anew at every coefficient and angle."""
        return SpinFit(
            {
                key: [float(one) for one in random.choice(values, len(values))]
                for key, values in self.runs.items()
            }
        )

    def coefficient(self, wanted: float, angle: float) -> float:
        """Smallest coefficient tried at which the spin has fallen to a value; nan if at none."""
        tried = sorted({key[0] for key in self.runs})
        logs = [math.log(self.at(one, angle) / wanted) for one in tried]
        for (mu_r, here), (after, there) in pairwise(zip(tried, logs, strict=True)):
            if here >= 0.0 > there:
                return mu_r * (after / mu_r) ** (here / (here - there))
        return math.nan


@dataclass(frozen=True)
class Pair:
    """Coefficient [-] and friction angle [deg]; the slope [deg] and the spin [rad/s] that they give."""

    mu_r: float
    angle: float
    slope: float
    spin: float


def best_pair(slope: SlopeFit, spin: SpinFit, wanted: float) -> Pair:
    """Of all pairs that give a slope the one with the smallest spin; if none does, the nearest in slope.

    Parameters
    ----------
    slope, spin : fits over the same coefficients and angles.
    wanted : slope [deg].
    """
    tried, angles = (sorted({key[k] for key in slope.runs}) for k in (0, 1))
    between = [float(one) for one in np.arange(angles[0], angles[-1] + STEP / 2.0, STEP)]
    pairs = [(slope.coefficient(wanted, one), one) for one in between]
    good = [one for one in pairs if math.isfinite(one[0])]
    if good:
        best = min(good, key=lambda one: spin.at(*one))
    else:
        every = [(float(mu), one) for mu in np.geomspace(tried[0], tried[-1], COARSE) for one in between]
        best = min(every, key=lambda one: abs(slope.at(*one) - wanted))
    return Pair(*best, slope.at(*best), spin.at(*best))


def resampled_pairs(slope: SlopeFit, spin: SpinFit, wanted: float, n: int = RESAMPLES) -> list[Pair]:
    """Repeat the fit for so many resamples."""
    random = np.random.default_rng(1)
    return [best_pair(slope.resampled(random), spin.resampled(random), wanted) for _ in range(n)]


def limits(values: Sequence[float]) -> tuple[float, float]:
    """Limits of the middle 95 % of resamples; nan counts as beyond the largest.

    >>> limits([3.0, 1.0, 2.0])
    (1.0, 3.0)
    """
    ordered = np.sort(np.nan_to_num(np.asarray(values, dtype=np.float64), nan=math.inf))
    ends = (1.0 - CONFIDENCE) / 2.0 * (len(ordered) - 1)
    return float(ordered[math.floor(ends)]), float(ordered[math.ceil(len(ordered) - 1 - ends)])


@dataclass(frozen=True)
class HeapFit:
    """Slope of heaps over the rolling coefficient at one friction angle, linear in ln mu_r in between.

    Attributes
    ----------
    slopes : by coefficient, of every heap that has one [deg]; heaps that stand as walls have none.
    """

    slopes: Mapping[float, Sequence[float]]

    @cached_property
    def means(self) -> list[tuple[float, float]]:
        """Coefficient and mean slope, of coefficients with a heap that has a slope."""
        return [(one, float(np.mean(values))) for one, values in sorted(self.slopes.items()) if len(values)]

    def crossing(self, wanted: float) -> float:
        """Smallest coefficient at which the mean slope has risen to a value; nan if at none tried."""
        for (mu_r, here), (after, there) in pairwise(self.means):
            if here < wanted <= there:
                return mu_r * (after / mu_r) ** ((wanted - here) / (there - here))
        return math.nan

    def chosen(self, wanted: float) -> float:
        """The crossing; if there is none, the smallest coefficient that comes as near as any to the value.

        As near as any is within one standard error of the nearest mean, with the spread of all heaps.
        """
        found = self.crossing(wanted)
        if math.isfinite(found):
            return found
        away = [(abs(slope - wanted), mu_r) for mu_r, slope in self.means]
        nearest, best = min(away)
        error = self.spread() / math.sqrt(max(len(self.slopes[best]), 1))
        return min(mu_r for distance, mu_r in away if distance <= nearest + error)

    def spread(self) -> float:
        """Standard deviation between seeds, of all coefficients together [deg]; 0 with one seed."""
        left = [value - np.mean(values) for values in self.slopes.values() for value in values]
        free = len(left) - len(self.means)
        return math.sqrt(float(np.sum(np.square(left))) / free) if free > 0 else 0.0

    def edge(self, wanted: float) -> str:
        """Edge of the box at which the search ends, in words; empty where one inside has the value."""
        if math.isfinite(self.crossing(wanted)):
            return ""
        (least, first), (most, last) = self.means[0], self.means[-1]
        top, mu_r = max((slope, mu_r) for mu_r, slope in self.means)
        if top < wanted:
            levels = (
                f"the mean slope is nowhere above {top:.3g} deg (mu_r {mu_r:g}), {last:.3g} deg at the edge"
            )
            return (
                f"no coefficient tried gives {wanted:g} deg: upper edge of the box, mu_r {most:g}; {levels}"
            )
        return f"lower edge of the box, mu_r {least:g}, where the slope is {first:.3g} deg already"

    def resampled(self, random: np.random.Generator) -> "HeapFit":
        """Draw heaps anew at every coefficient."""
        return HeapFit(
            {
                one: [float(x) for x in random.choice(values, len(values))] if len(values) else []
                for one, values in self.slopes.items()
            }
        )

    def places(self, wanted: float, n: int = RESAMPLES) -> list[float]:
        """Place of the crossing in the box, from 0 at its lower to 1 at its upper edge, of resamples."""
        random = np.random.default_rng(1)
        tried = sorted(self.slopes)
        width = math.log(tried[-1] / tried[0])
        return [
            math.log(one.crossing(wanted) / tried[0]) / width
            for one in (self.resampled(random) for _ in range(n))
        ]
