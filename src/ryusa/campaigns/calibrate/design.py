"""Points at which cases are run: first such that fill the prior, then where the posterior needs them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from ryusa.campaigns.calibrate.posterior import Posterior, Seen
from ryusa.campaigns.calibrate.prior import Prior
from ryusa.campaigns.sweep.design import LIST, Setting, SweepAxis, SweepDesign

Floats = NDArray[np.float64]

CANDIDATES = 400  # of a round of further points


def filling_points(n_parameters: int, n: int, seed: int) -> Floats:
    """Points that fill the unit cube, shape (n, n_parameters): a scrambled Sobol sequence, n a power of 2."""
    return qmc.Sobol(n_parameters, scramble=True, rng=np.random.default_rng(seed)).random(n)


def next_points(posterior: Posterior, seen: Sequence[Seen], n: int, seeds: int, seed: int) -> Floats:
    """Points of the posterior at which runs would make the emulators better known, shape (n, n_parameters).

    Parameters
    ----------
    posterior : from the runs so far.
    seen : observations.
    n : number of points.
    seeds : runs of each.
    seed : of the candidates.

    Notes
    -----
    One point after the other: where the sum over observations of the variance of the emulator over that of
    the observation is largest, among points drawn from the posterior. The variance falls by each point that
    is chosen as if it had been run (a Gaussian process needs no value for that).
    """
    rng = np.random.default_rng(seed)
    drawn = rng.choice(len(posterior.u), CANDIDATES, p=posterior.weights)
    u = posterior.u[np.unique(drawn)]  # one of great weight is drawn many times
    held = [one.emulator.covariance(u) for one in seen]
    chosen: list[int] = []
    for _ in range(min(n, len(u))):
        gain = np.sum([np.diag(cov) / one.width**2 for cov, one in zip(held, seen, strict=True)], axis=0)
        gain[chosen] = -1.0  # the same point with the same seeds would be the same run
        best = int(np.argmax(gain))
        chosen.append(best)
        held = [
            cov
            - np.outer(cov[:, best], cov[best]) / (cov[best, best] + one.emulator.noise**2 / seeds + 1e-300)
            for cov, one in zip(held, seen, strict=True)
        ]
    return u[chosen]


def settings_of(priors: Sequence[Prior], u: Floats) -> SweepDesign:
    """Points of the unit cube as settings of a case; points that are written alike count once."""
    settings: list[Setting] = [
        {prior.key: prior.text(float(share)) for prior, share in zip(priors, row, strict=True)} for row in u
    ]
    distinct = list({tuple(one.items()): one for one in settings}.values())
    axis = SweepAxis({prior.key: tuple(one[prior.key] for one in distinct) for prior in priors})
    return SweepDesign(LIST, (axis,), tuple(distinct), len(settings) - len(distinct))
