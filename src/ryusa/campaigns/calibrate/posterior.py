"""What the observations say of the parameters: weighted points of the prior."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri
from scipy.stats import qmc

from ryusa.campaigns.calibrate.emulator import Emulator
from ryusa.campaigns.calibrate.prior import Prior, in_cube

Floats = NDArray[np.float64]

POINTS = 2**13  # of a round of sampling
ROUNDS = 6
ENOUGH = 1000.0  # points that the weighted ones are worth, from which no further round is made
LEAST = 100.0  # below it the points are too few for a result
WIDER = 1.5  # standard deviations of a proposal over those found so far
PRIOR_SHARE = 0.2  # of the points that a proposal takes from the prior
# Standard deviation of the posterior over that of the prior, from which nothing was learnt.
UNDETERMINED = 0.8
ONE_SIGMA, TWO_SIGMA = 0.6827, 0.95


@dataclass(frozen=True)
class Seen:
    """An observation as the posterior takes it, in SI.

    Attributes
    ----------
    emulator : of the quantity.
    value, error : observed value and its standard error.
    discrepancy : standard deviation of what the model itself may be off by; 0 for a model without error.
    """

    emulator: Emulator
    value: float
    error: float
    discrepancy: float = 0.0

    @property
    def width(self) -> float:
        """Standard deviation of the observation about the mean of the model."""
        return math.hypot(self.error, self.discrepancy)


@dataclass(frozen=True)
class Posterior:
    """Weighted points of the unit cube of the parameters.

    Attributes
    ----------
    priors : parameters.
    u : points, shape (n, n_parameters).
    weights : shape (n,), with sum 1.
    """

    priors: tuple[Prior, ...]
    u: Floats
    weights: Floats

    @property
    def values(self) -> Floats:
        """The points in the units of the priors, shape (n, n_parameters)."""
        return in_cube(self.priors, self.u)

    @property
    def worth(self) -> float:
        """Number of equally weighted points that these are worth [-]."""
        return 1.0 / float(np.sum(self.weights**2))

    def mean(self) -> Floats:
        """Means, in the units of the priors."""
        return self.weights @ self.values

    def sd(self) -> Floats:
        """Standard deviations, in the units of the priors."""
        return np.sqrt(self.weights @ (self.values - self.mean()) ** 2)

    def interval(self, k: int, share: float) -> tuple[float, float]:
        """Central interval of parameter k that holds a share [unit of its prior]."""
        low, high = (
            weighted_quantile(self.values[:, k], self.weights, q) for q in (0.5 - share / 2, 0.5 + share / 2)
        )
        return low, high

    def correlation(self) -> Floats:
        """Correlation coefficients, shape (n_parameters, n_parameters); 1 where nothing scatters."""
        away = self.values - self.mean()
        cov = (self.weights[:, None] * away).T @ away
        sd = np.sqrt(np.diag(cov))
        return cov / np.outer(sd, sd) if np.all(sd > 0.0) else np.eye(len(sd))

    def narrowing(self) -> Floats:
        """Standard deviation of every parameter over that of its prior [-]."""
        return self.sd() / prior_sd(self.priors)

    def learnt(self) -> NDArray[np.bool_]:
        """Whether the observations say something of each parameter."""
        return self.narrowing() < UNDETERMINED

    def at_ends(self, k: int) -> tuple[float, float]:
        """Posterior over prior at the low and at the high end of parameter k, over its largest value [-].

        Notes
        -----
        Both are densities in the share of the prior, in which the prior is uniform: the mass within half a
        standard deviation of the end, or within a tenth of the range where that is less, over that of the
        window of this width that holds most.
        """
        order = np.argsort(self.u[:, k])
        u, upto = self.u[order, k], np.cumsum(self.weights[order])
        sd = math.sqrt(float(self.weights @ (self.u[:, k] - self.weights @ self.u[:, k]) ** 2))
        width = min(max(0.5 * sd, 1e-6), 0.1)
        starts = np.concatenate([[0.0, 1.0 - width], np.clip(u[:: max(len(u) // 1000, 1)], 0.0, 1.0 - width)])
        held = np.interp(starts + width, u, upto, 0.0, 1.0) - np.interp(starts, u, upto, 0.0, 1.0)
        return float(held[0] / held.max()), float(held[1] / held.max())

    def resampled(self, seed: int = 0) -> Floats:
        """Points of equal weight, drawn from the weighted ones, shape (n, n_parameters)."""
        return self.u[np.random.default_rng(seed).choice(len(self.u), POINTS, p=self.weights)]

    def of(self, emulator: Emulator, seed: int = 0, noise: bool = False) -> tuple[float, float, Floats]:
        """Mean, standard deviation and sample of a quantity over the posterior, in its unit.

        Parameters
        ----------
        emulator : of the quantity.
        seed : of the sample.
        noise : whether the scatter of a single run is part of it.
        """
        mean, sd = emulator.at(self.resampled(seed))
        width = np.hypot(sd, emulator.noise) if noise else sd
        sample = mean + width * np.random.default_rng(seed + 1).standard_normal(len(mean))
        return float(mean.mean()), float(sample.std()), sample


def prior_sd(priors: Sequence[Prior]) -> Floats:
    """Standard deviations of the priors, in their units."""
    middle = (np.arange(4096) + 0.5) / 4096
    return np.array([one.at(middle).std() for one in priors])


def weighted_quantile(values: Floats, weights: Floats, q: float) -> float:
    """Quantile of weighted values.

    >>> weighted_quantile(np.array([3.0, 1.0, 2.0]), np.array([0.25, 0.25, 0.5]), 0.5)
    2.0
    """
    order = np.argsort(values)
    along = np.cumsum(weights[order]) - 0.5 * weights[order]
    return float(np.interp(q, along, values[order]))


def log_likelihood(seen: Sequence[Seen], u: Floats) -> Floats:
    """Logarithm of the likelihood of the observations, but for a constant.

    Each observation is normal about the mean of the emulator, with the sum of the variances of its error, of
    the discrepancy of the model and of the emulator for want of runs. Errors of observations are taken as
    independent.
    """
    total = np.zeros(len(u))
    for one in seen:
        mean, sd = one.emulator.at(u)
        var = one.width**2 + sd**2
        total -= 0.5 * ((one.value - mean) ** 2 / var + np.log(var))
    return total


def sample_posterior(priors: tuple[Prior, ...], seen: Sequence[Seen], seed: int = 0) -> Posterior:
    """Weigh points of the prior by their likelihood, in rounds that come nearer to where it is large.

    Notes
    -----
    Importance sampling with a proposal that is adapted: the first points fill the prior (a scrambled Sobol
    sequence). Of the points of a later round a fifth does too; the others follow a normal distribution with
    the weighted mean of the points so far and 1.5 times their standard deviations. A point counts by its
    likelihood over the density of the mixture of all rounds (O. Cappe et al. 2004, J. Comput. Graph. Stat.
    13, 907; A. Owen & Y. Zhou 2000, J. Am. Stat. Assoc. 95, 135). The prior is uniform in the cube, so that
    it does not appear.
    """
    n = len(priors)
    u = qmc.Sobol(n, scramble=True, rng=np.random.default_rng(seed)).random(POINTS)
    found = log_likelihood(seen, u)
    proposals: list[tuple[Floats, Floats]] = []
    weights = _weights(found, u, proposals)
    for k in range(1, ROUNDS):
        if 1.0 / np.sum(weights**2) >= ENOUGH:
            break
        mean = weights @ u
        away = u - mean
        cov = WIDER**2 * (weights[:, None] * away).T @ away + 1e-12 * np.eye(n)
        root: Floats = np.linalg.cholesky(cov).astype(np.float64)
        proposals.append((mean, root))
        fresh = _proposed(n, mean, root, seed + k)
        u = np.concatenate([u, fresh])
        found = np.concatenate([found, log_likelihood(seen, fresh)])
        weights = _weights(found, u, proposals)
    return Posterior(priors, u, weights)


def _proposed(n: int, mean: Floats, root: Floats, seed: int) -> Floats:
    """Points of a round: some of the prior, others of a normal distribution, less those outside the prior."""
    every = qmc.Sobol(n, scramble=True, rng=np.random.default_rng(seed)).random(POINTS)
    count = round(PRIOR_SHARE * POINTS)
    near = mean + ndtri(every[count:]) @ root.T
    inside = np.all((near >= 0.0) & (near <= 1.0), axis=1)
    return np.concatenate([every[:count], near[inside]])


def _weights(found: Floats, u: Floats, proposals: Sequence[tuple[Floats, Floats]]) -> Floats:
    """Weights of all points against the mixture of everything that was proposed."""
    density = np.ones(len(u))  # of the first round, uniform
    for mean, root in proposals:
        away = np.linalg.solve(root, (u - mean).T)
        norm = math.log(2.0 * math.pi) * len(mean) / 2 + float(np.sum(np.log(np.diag(root))))
        normal = np.exp(-0.5 * np.sum(away**2, axis=0) - norm)
        density += PRIOR_SHARE + (1.0 - PRIOR_SHARE) * normal
    weights = np.exp(found - found.max()) / density
    return weights / weights.sum()
