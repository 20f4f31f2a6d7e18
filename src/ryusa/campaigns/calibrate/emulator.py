"""A Gaussian process through the runs: the mean of a quantity between them, and the scatter of single runs.

The kernel and its fit are scikit-learn's (`ryusa[calibrate]`).
"""

import importlib.util
import math
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve

from ryusa.errors import ResultsError

Floats = NDArray[np.float64]

RESTARTS = 4  # of the fit, from random numbers
SHORTEST, LONGEST = 0.05, 20.0  # lengths over which a quantity changes, in shares of the prior
QUIETEST = 1e-8  # variance of the noise over that of the data: a quantity without chance


def need_sklearn() -> None:
    """Raise an error that says how to install scikit-learn where it is missing."""
    if importlib.util.find_spec("sklearn") is None:
        raise ResultsError("ryusa calibrate needs scikit-learn: pip install 'ryusa[calibrate]'")


@dataclass(frozen=True)
class Emulator:
    """A quantity over the unit cube of the parameters.

    Attributes
    ----------
    fitted : scikit-learn's regressor, of the quantity less `mean` over `scale`.
    mean, scale : mean and standard deviation of the data, in the unit of the quantity.
    noise : standard deviation of single runs about the mean, between seeds [unit of the quantity].
    lengths : distance over which the quantity changes, by parameter [share of the prior].
    """

    fitted: Any
    mean: float
    scale: float
    noise: float
    lengths: Floats

    def at(self, u: Floats) -> tuple[Floats, Floats]:
        """Mean of the quantity over seeds, and its standard deviation by want of runs.

        Parameters
        ----------
        u : points, shape (n, n_parameters).

        Returns
        -------
        mean, sd : shape (n,), in the unit of the quantity. The scatter of single runs is not in sd.
        """
        mean, sd = self.fitted.predict(u, return_std=True)
        # scikit-learn's standard deviation is that of a new run: it has the noise in it
        var = np.maximum((self.scale * sd) ** 2 - self.noise**2, 0.0)
        return self.mean + self.scale * mean, np.sqrt(var)

    def covariance(self, u: Floats) -> Floats:
        """Covariance of the mean at points, shape (n, n) [unit squared]."""
        _, cov = self.fitted.predict(u, return_cov=True)
        return self.scale**2 * cov - self.noise**2 * np.eye(len(u))

    def left_out(self) -> tuple[Floats, Floats]:
        """Every run less what the others predict, and the standard deviation of that [unit of the quantity].

        Notes
        -----
        C. E. Rasmussen & C. K. I. Williams (2006), Gaussian Processes for Machine Learning, Eq. (5.12): of
        run i the residual is (K^-1 y)_i / (K^-1)_ii and its variance 1/(K^-1)_ii.
        """
        inverse = np.diag(cho_solve((self.fitted.L_, True), np.eye(len(self.fitted.L_))))
        return self.scale * self.fitted.alpha_.ravel() / inverse, self.scale / np.sqrt(inverse)


def emulate(u: Floats, values: Floats, seed: int = 0) -> Emulator:
    """Fit an emulator to runs, with the scatter between seeds as noise.

    Parameters
    ----------
    u : points of the runs in the unit cube, shape (n, n_parameters); every seed of a point is a row.
    values : the quantity, shape (n,).
    seed : of the restarts of the fit.
    """
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    lengths: Any = np.full(u.shape[1], 0.5)  # one a parameter; the stub has a float
    mean, scale = float(values.mean()), float(values.std())
    scale = scale if scale > 0.0 else 1.0
    kernel = ConstantKernel(1.0, (1e-2, 1e3)) * RBF(lengths, (SHORTEST, LONGEST)) + WhiteKernel(
        0.1, (QUIETEST, 2.0)
    )
    fitted = GaussianProcessRegressor(kernel, n_restarts_optimizer=RESTARTS, random_state=seed, alpha=1e-10)
    with warnings.catch_warnings():
        # a length or a noise at the end of its range is an answer: the quantity does not depend on it
        warnings.simplefilter("ignore", ConvergenceWarning)
        fitted.fit(u, (values - mean) / scale)
    found: Any = fitted.kernel_
    noise = scale * math.sqrt(float(found.k2.noise_level))
    return Emulator(fitted, mean, scale, noise, np.atleast_1d(np.asarray(found.k1.k2.length_scale)))
