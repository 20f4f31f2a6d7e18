"""Fluid at the grains: what an engine is given of the water, and the impulse that it gives back."""

from dataclasses import dataclass

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.model.column import WaterState
from ryusa.model.eddies import Eddies

# Columns of `FluidAtGrains.sampled`.
U, V, W = 0, 1, 2  # velocity of the water along x, y and z, fluctuations included [m/s]
SHEAR = 3  # dU/dz [1/s]
PHI = 4  # concentration of grains [-]
A_X = 5  # acceleration of the water along x, DU/Dt [m/s2]
EXTRA_X, EXTRA_Z = 6, 7  # force of pressure and stress beyond that of still water, -rho V g [N]
SUBMERGED = 8  # share of the volume below the water surface [-]: of drag, added mass, lift and torque too
N_SAMPLED = 9
DRAG = 3  # column of `impulse`: drag over slip [N s/m]
N_IMPULSE = 4


@dataclass(frozen=True)
class FluidAtGrains:
    """Water sampled at every free grain, held while the engine steps, and the impulse on each meanwhile.

    Attributes
    ----------
    sampled : by grain, columns as above, shape (n_grain, N_SAMPLED).
    impulse : of drag, lift, Magnus force and added mass on each grain since `sampled` was set [N s], which
        the water loses; then drag over slip in the last step [N s/m]; shape (n_grain, N_IMPULSE).
    """

    sampled: Floats
    impulse: Floats

    @staticmethod
    def at_rest(n_grain: int) -> "FluidAtGrains":
        """Water at rest around every grain."""
        sampled = np.zeros((n_grain, N_SAMPLED))
        sampled[:, SUBMERGED] = 1.0
        return FluidAtGrains(sampled, np.zeros((n_grain, N_IMPULSE)))


@dataclass(frozen=True)
class CouplingState:
    """The column of water between two exchanges with its grains: with `FluidAtGrains` all a resume needs.

    Attributes
    ----------
    water : the water since the last exchange.
    z : heights of the free grains at the last exchange, by which they are cut [m], shape (n_grain,).
    force_z : of the water on grains along z, by volume of cells [N/m3], shape (n,).
    steps : of the engine in the present coupling interval.
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
