"""Velocity fluctuations of the water at a grain, as a sequence of eddies: speed, lifetime, drift correction.

The strength of the turbulence is u_tau = l |dU/dz| [m/s], where l is the mixing length and u_tau**2 =
|<u'w'>|; see `turbulence`.
"""

import math

from ryusa.laws._law import law


@law
def eddy_along(r_x: float, r_z: float, u_tau: float, shear: float) -> float:
    """Velocity of an eddy along the flow [m/s] whose vertical velocity is r_z u_tau.

    Parameters
    ----------
    r_x, r_z : independent normal numbers, mean 0 and variance 1 [-].
    u_tau : strength of the turbulence [m/s].
    shear : velocity gradient of the water [1/s]; the stress has its sign.

    Notes
    -----
    Source: u' = (-r_z + r_x) u_tau, w' = r_z u_tau, v' = r_y u_tau, so that <u'w'> = -u_tau**2, as in the
    code of YADE's HydroForceEngine, used by Maurin et al. 2015. The rms values along, across and normal to
    the bed are 1.41, 1 and 1 u_tau; Nezu & Nakagawa 1993 (from memory) give 2.30, 1.63 and 1.27 u_star at the
    bed, decreasing with exp(-z/h).

    Examples
    --------
    >>> eddy_along(0.5, 1.0, 0.1, 3.0), eddy_along(0.5, 1.0, 0.1, -3.0)
    (-0.05, 0.15000000000000002)
    """
    return (r_x - math.copysign(r_z, r_z * shear)) * u_tau


@law
def eddy_life(shear: float) -> float:
    """Lifetime of an eddy [s], 2/|dU/dz|; inf without shear, where no turbulence is produced.

    Parameters
    ----------
    shear : velocity gradient of the water [1/s].

    Notes
    -----
    Source: a random walk whose velocity is constant for a time T has the diffusivity w'**2 T/2 (Taylor 1921:
    T is twice the Lagrangian time). With w' = u_tau = l |dU/dz| and the lifetime 2 l/u_tau = 2/|dU/dz| the
    diffusivity of fluid equals the eddy viscosity l**2 |dU/dz|: Schmidt number 1.

    Examples
    --------
    >>> eddy_life(-40.0)
    0.05
    """
    return 2.0 / abs(shear)


@law
def eddy_drift(length: float, slope: float) -> float:
    """Mean vertical velocity of the fluid at a grain [m/s], l d(u_tau)/dz.

    Parameters
    ----------
    length : mixing length [m].
    slope : gradient of u_tau along z [1/s].

    Notes
    -----
    Source: derived. Fluid remains well mixed if it drifts with the gradient of its diffusivity w'**2 T/2, T =
    2 T_L; without drift a random walk accumulates fluid, and grains, where turbulence is weak. The part
    w'**2 (dT/dz)/2 of this drift follows from measuring the age of an eddy in local lifetimes, and half of
    the remainder from scaling its velocity with the local u_tau. This function is the other half,
    (T_L/2) d(w'**2)/dz. Walks of constant velocity need twice as much (Legg & Raupach 1982, MacInnes & Bracco
    1992, both from memory) and deplete the water below the surface.

    Examples
    --------
    >>> eddy_drift(0.002, -1.5)
    -0.003
    """
    return length * slope
