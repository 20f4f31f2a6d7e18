"""Eddies that a grain meets, one after another: how fast, for how long, and what keeps them from sorting.

The turbulent shear stress gives the strength u_tau = l |dU/dz| [m/s], l the mixing length, with u_tau**2 =
|<u'w'>|; see `turbulence`.
"""

import math

from ryusa.laws._law import law


@law
def eddy_along(r_x: float, r_z: float, u_tau: float, shear: float) -> float:
    """Speed of an eddy along the flow [m/s] whose vertical speed is r_z u_tau.

    Parameters
    ----------
    r_x, r_z : independent normal numbers, mean 0 and variance 1 [-].
    u_tau : strength of the turbulence [m/s].
    shear : velocity gradient of the water [1/s], whose sign the stress has.

    Notes
    -----
    Source: u' = (-r_z + r_x) u_tau, w' = r_z u_tau, v' = r_y u_tau, so that <u'w'> = -u_tau**2: YADE's
    HydroForceEngine, whose code was read, used by Maurin et al. 2015. The rms along, across and normal to the
    bed are 1.41, 1 and 1 u_tau; Nezu & Nakagawa 1993 (from memory) have 2.30, 1.63 and 1.27 u_star at the
    bed, falling with exp(-z/h).

    Examples
    --------
    >>> eddy_along(0.5, 1.0, 0.1, 3.0), eddy_along(0.5, 1.0, 0.1, -3.0)
    (-0.05, 0.15000000000000002)
    """
    return (r_x - math.copysign(r_z, r_z * shear)) * u_tau


@law
def eddy_life(shear: float) -> float:
    """Life of an eddy [s], 2/|dU/dz|; inf without shear, where nothing makes eddies.

    Parameters
    ----------
    shear : velocity gradient of the water [1/s].

    Notes
    -----
    Source: a walk that keeps its speed for a time T spreads with w'**2 T/2 (Taylor 1921: T is twice the
    Lagrangian time). With w' = u_tau = l |dU/dz| the life 2 l/u_tau = 2/|dU/dz| spreads fluid exactly as the
    eddy viscosity l**2 |dU/dz| does momentum, Schmidt number 1.

    Examples
    --------
    >>> eddy_life(-40.0)
    0.05
    """
    return 2.0 / abs(shear)


@law
def eddy_drift(length: float, slope: float) -> float:
    """Mean vertical speed of the fluid a grain meets [m/s], l d(u_tau)/dz.

    Parameters
    ----------
    length : mixing length [m].
    slope : gradient of u_tau along z [1/s].

    Notes
    -----
    Source: derived. Fluid stays mixed when it drifts with the gradient of its diffusivity w'**2 T/2, T =
    2 T_L; without, a walk gathers fluid, and grains, where turbulence is weak. Of that w'**2 (dT/dz)/2 comes
    by itself where an eddy's age counts in lives of where the grain is, and half of the rest where its speed
    goes with u_tau there; this is the other half, (T_L/2) d(w'**2)/dz. Walks of constant speed need twice as
    much (Legg & Raupach 1982, MacInnes & Bracco 1992, both from memory), and leave the water under the
    surface empty.

    Examples
    --------
    >>> eddy_drift(0.002, -1.5)
    -0.003
    """
    return length * slope
