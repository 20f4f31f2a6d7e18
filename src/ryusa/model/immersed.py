"""What the engine is told of the water at every grain, and what it gives back."""

from dataclasses import dataclass

import numpy as np

from ryusa.model.scene import Floats

# Columns of `Immersed.seen`.
U, V, W = 0, 1, 2  # speed of the water along x, y and z, fluctuations included [m/s]
SHEAR = 3  # dU/dz [1/s]
PHI = 4  # concentration of grains around it [-]
A_X = 5  # acceleration of the water along x, DU/Dt [m/s2]
EXTRA_X, EXTRA_Z = 6, 7  # force of pressure and stress beyond still water, -rho V g [N]
SHARE = 8  # of its volume that is in the water [-]
N_SEEN = 9
DRAG = 3  # column of `taken`: drag over slip [N s/m]
N_TAKEN = 4


@dataclass(frozen=True)
class Immersed:
    """Water at every free grain, held while the engine steps, and the impulse each has taken meanwhile.

    Attributes
    ----------
    seen : by grain, columns as above, shape (n_grain, N_SEEN).
    taken : impulse of drag, lift, Magnus force and added mass on each grain since `seen` was given [N s],
        what the water owes; then its drag over slip in the last step [N s/m]; shape (n_grain, 4).
    """

    seen: Floats
    taken: Floats

    @staticmethod
    def still(n_grain: int) -> "Immersed":
        """Water at rest around every grain."""
        seen = np.zeros((n_grain, N_SEEN))
        seen[:, SHARE] = 1.0
        return Immersed(seen, np.zeros((n_grain, N_TAKEN)))
