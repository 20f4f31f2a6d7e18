"""The eddy that each grain is in."""

from dataclasses import dataclass

import numpy as np

from ryusa.model.arrays import Floats


@dataclass(frozen=True)
class Eddies:
    """The eddy that each free grain is in now; all that a walk through turbulence needs to go on.

    Attributes
    ----------
    r : normal numbers of the eddy along x, y and z, which times the strength of the turbulence give its speed
        [-], shape (n_grain, 3).
    spent : share of its life that is over [-], shape (n_grain,).
    count : eddies the grain has left, which number the next one, shape (n_grain,), int64.
    """

    r: Floats
    spent: Floats
    count: np.ndarray
