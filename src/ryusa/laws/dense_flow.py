"""Dense granular flow: the inertial number, and friction as a function of it."""

import math

from ryusa.laws._law import law


@law
def inertial_number(shear_rate: float, d: float, rho_s: float, p: float) -> float:
    """Time in which a grain moves by d under the pressure, over that in which it is sheared by d [-].

    Parameters
    ----------
    shear_rate : [1/s].
    d : diameter [m].
    rho_s : density of the grains [kg/m3].
    p : pressure between them [Pa], > 0.

    Notes
    -----
    Source: GDR MiDi 2004, Eur. Phys. J. E 14, 341: I = shear_rate d/sqrt(p/rho_s).

    Examples
    --------
    >>> round(inertial_number(22.36, 0.002, 2500.0, 500.0), 3)
    0.1
    """
    return shear_rate * d * math.sqrt(rho_s / p)


@law
def mu_of_inertial_number(inertial: float, mu_s: float, mu_2: float, i_0: float) -> float:
    """Shear stress over pressure in steady dense flow [-].

    Parameters
    ----------
    inertial : inertial number [-], >= 0.
    mu_s : friction at rest [-]; tan(20.9 deg) for glass beads.
    mu_2 : friction at large inertial numbers [-]; tan(32.76 deg).
    i_0 : inertial number at which half of the difference is reached [-]; 0.279.

    Notes
    -----
    Source: Jop, Forterre & Pouliquen 2006, Nature 441, 727: mu = mu_s + (mu_2 - mu_s)/(i_0/I + 1). The
    numbers are those of their glass beads as public codes quote them.

    Examples
    --------
    >>> mu_s, mu_2 = math.tan(math.radians(20.9)), math.tan(math.radians(32.76))
    >>> round(mu_of_inertial_number(0.279, mu_s, mu_2, 0.279), 3)
    0.513
    """
    return mu_s + (mu_2 - mu_s) * inertial / (i_0 + inertial)


@law
def split_bottom_centre(r_s: float, h: float) -> float:
    """Radius of the middle of a shear zone at the surface of grains over a split bottom [m].

    Parameters
    ----------
    r_s : radius at which the bottom is split [m].
    h : height of the grains [m], up to some 0.6 r_s.

    Notes
    -----
    Source: Fenistein & van Hecke 2003, Nature 425, 256; from memory, 1 - R_c/R_s = (H/R_s)**(5/2). Nothing
    is judged by it. The article says that the zone moves to the axis and widens as the grains stand higher.

    Examples
    --------
    >>> round(split_bottom_centre(0.05, 0.025), 4)
    0.0412
    """
    return r_s * (1.0 - (h / r_s) ** 2.5)
