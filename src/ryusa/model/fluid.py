"""What the engine is told of the water at every grain, and what it gives back."""

from dataclasses import dataclass

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.model.column import WaterState
from ryusa.model.eddies import Eddies

# Columns of `Immersed.seen`.
U, V, W = 0, 1, 2  # speed of the water along x, y and z, fluctuations included [m/s]
SHEAR = 3  # dU/dz [1/s]
PHI = 4  # concentration of grains around it [-]
A_X = 5  # acceleration of the water along x, DU/Dt [m/s2]
EXTRA_X, EXTRA_Z = 6, 7  # force of pressure and stress beyond still water, -rho V g [N]
SHARE = 8  # of its volume that is in the water, below its surface [-]: of drag, added mass, lift, torque too
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


@dataclass(frozen=True)
class Coupled:
    """The column of water between two exchanges with its grains: beside `Immersed` all that a resume needs.

    Attributes
    ----------
    water : the water since the last exchange.
    z : heights of the free grains at the last exchange, by which they are cut [m], shape (n_grain,).
    force_z : of the water on grains along z, by volume of cells [N/m3], shape (n,).
    steps : of the engine in the interval under way.
    due : step of the next exchange.
    exchanges : done so far.
    worst : largest residual of the water's momentum over its largest term so far [-].
    eddies : those the grains are in; None without fluctuations.
    """

    water: WaterState
    z: Floats
    force_z: Floats
    steps: int
    due: int
    exchanges: int
    worst: float
    eddies: Eddies | None = None
