"""State of the random walk of the grains through turbulence."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ryusa.model.arrays import Floats


@dataclass(frozen=True)
class Eddies:
    """The present eddy of each free grain: the complete state of the random walk.

    Attributes
    ----------
    r : normal random numbers along x, y and z [-]; velocity of the eddy over the strength of the turbulence,
        shape (n_grain, 3).
    spent : age of the eddy over its lifetime [-], shape (n_grain,).
    count : number of eddies that the grain has left, the index of the present one, shape (n_grain,), int64.
    """

    r: Annotated[Floats, "grain", 3]
    spent: Annotated[Floats, "grain"]
    count: Annotated[NDArray[np.int64], "grain"]
