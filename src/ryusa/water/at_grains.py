"""Loops over grains between engine and water: what they gave to the water, and what they are told of it."""

import numpy as np

from ryusa.laws._family import numbers
from ryusa.laws.families import Buoyancy
from ryusa.model.fluid import A_X, DRAG, EXTRA_X, EXTRA_Z, PHI, SHEAR, SUBMERGED, U, V, W
from ryusa.model.scene import Floats
from ryusa.water._kernel import kernel

WEIGHT, STRESS, PRESSURE = numbers(__name__, Buoyancy.WEIGHT, Buoyancy.STRESS, Buoyancy.PRESSURE)
DENSEST = 0.99  # concentrations are limited to this value, so that every cell keeps some water


@kernel
def given_by_grains(
    impulse: Floats, met: Floats, archimedes: Floats, sampled: Floats, per_dt: float
) -> Floats:
    """Amounts that each grain gives to the cells, shape (n_grain, 4).

    Force along x and along z [N]; drag over slip [N s/m], and that times the water that it met [N].

    Parameters
    ----------
    impulse, sampled : columns of `model.fluid`.
    met : mean speed of the water over the grain along x [m/s], shape (n_grain,).
    archimedes : buoyancy of still water along x [N], shape (n_grain,).
    per_dt : one over the interval [1/s].
    """
    amounts = np.empty((len(met), 4))
    for i in range(len(met)):
        k_d = impulse[i, DRAG]
        amounts[i, 0] = impulse[i, 0] * per_dt + (archimedes[i] + sampled[i, EXTRA_X])
        amounts[i, 1] = impulse[i, 2] * per_dt
        amounts[i, 2], amounts[i, 3] = k_d, k_d * met[i]
    return amounts


@kernel
def sample(
    at: Floats, share: Floats, volume: Floats, eddy: Floats, buoyancy: int, gradient: float, rho_w: float,
    g_x: float, g_z: float, sampled: Floats,
) -> None:  # fmt: skip
    """Fill `sampled`, columns of `model.fluid`, with the water at each grain.

    Parameters
    ----------
    at : means over each grain of u, w, shear, phi and du_dt of the water, and for the buoyancy `stress`
        of dtau_dz and of the vertical force per volume of water, shape (n_grain, 5 or 7).
    share, volume : submerged part [-] and volume of each grain [m3], shape (n_grain,).
    eddy : velocity of the eddy at each grain [m/s], shape (n_grain, 3); (0, 3) without.
    buoyancy : number of `Buoyancy`.
    gradient : driving pressure gradient [Pa/m].
    rho_w, g_x, g_z : density of the water [kg/m3], gravity [m/s2].
    """
    for i in range(len(share)):
        sampled[i, U], sampled[i, V], sampled[i, W] = at[i, 0], 0.0, at[i, 1]
        if len(eddy):
            sampled[i, U] += eddy[i, 0]
            sampled[i, V] += eddy[i, 1]
            sampled[i, W] += eddy[i, 2]
        sampled[i, SHEAR], sampled[i, PHI] = at[i, 2], min(at[i, 3], DENSEST)
        sampled[i, A_X], sampled[i, SUBMERGED] = at[i, 4], share[i]
        solid = volume[i] * share[i]
        out = (1.0 - share[i]) * volume[i] * rho_w  # no buoyancy on the part above the water
        sampled[i, EXTRA_X], sampled[i, EXTRA_Z] = out * g_x, out * g_z
        if buoyancy == STRESS:
            sampled[i, EXTRA_X] += solid * (at[i, 5] + gradient + rho_w * g_x)
            sampled[i, EXTRA_Z] += solid * at[i, 6]
        elif buoyancy == WEIGHT:
            sampled[i, EXTRA_X] += solid * gradient
        else:
            sampled[i, EXTRA_X] += solid * rho_w * g_x
