"""Exchange between water and grains: the water at every grain, and the impulse on it."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.printed import ByShape

# Columns of `FluidAtGrains.sampled`.
U, V, W = 0, 1, 2  # velocity of the water along x, y and z, fluctuations included [m/s]
SHEAR = 3  # dU/dz [1/s]
PHI = 4  # concentration of grains [-]
A_X = 5  # acceleration of the water along x, DU/Dt [m/s2]
EXTRA_X, EXTRA_Z = 6, 7  # force of pressure and stress in excess of that of still water, -rho V g [N]
SUBMERGED = 8  # share of the volume below the water surface [-]; scales drag, added mass, lift and torque too
N_SAMPLED = 9
# Columns of what a grain keeps for the column of water between exchanges, in whatever process it is.
KEPT_Z = 0  # height at the last exchange [m]
KEPT_R, KEPT_SPENT, KEPT_COUNT = 1, 4, 5  # of its eddy (model.eddies): r fills three columns
N_KEPT = 6
DRAG = 3  # column of `impulse`: drag over slip [N s/m]
N_IMPULSE = 4


@dataclass(frozen=True, repr=False)
class FluidAtGrains(ByShape):
    """Water at every free grain during a coupling interval, and the impulse on it since then.

    Attributes
    ----------
    sampled : water at each grain, columns as above.
    impulse : impulse of drag, lift, Magnus force and added mass on each grain since `sampled` was set [N s],
        taken from the water; then drag over slip in the last step [N s/m].
    """

    sampled: Annotated[Floats, "grain", N_SAMPLED]
    impulse: Annotated[Floats, "grain", N_IMPULSE]

    @staticmethod
    def at_rest(n_grain: int) -> "FluidAtGrains":
        """Water at rest around every grain."""
        sampled = np.zeros((n_grain, N_SAMPLED))
        sampled[:, SUBMERGED] = 1.0
        return FluidAtGrains(sampled, np.zeros((n_grain, N_IMPULSE)))
