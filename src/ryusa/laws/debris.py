"""Debris flow: equilibrium concentration on a slope, and the stresses of Egashira, Miyamoto and Itoh."""

import math

from ryusa.laws._law import law


@law
def equilibrium_concentration(slope: float, friction_angle: float, rho_s: float, rho_w: float) -> float:
    """Concentration at which a flow over its own bed neither erodes nor deposits [-].

    Parameters
    ----------
    slope : bed angle [rad].
    friction_angle : friction angle [rad]; internal of the bed (Takahashi) or static between grains
        (Egashira).
    rho_s, rho_w : density of grain and water [kg/m3].

    Notes
    -----
    Source: Takahashi 1978 and, equally, Egashira, Miyamoto & Itoh 1997: the friction (sigma - rho) c g h
    cos(slope) tan(friction_angle) at the bed balances the weight of the mixture along the slope, hence c =
    rho tan(slope)/((sigma - rho) (tan(friction_angle) - tan(slope))). Without upper limit, see
    `equilibrium_takahashi`; infinite if the slope is as steep as the friction angle or steeper.

    Examples
    --------
    >>> round(equilibrium_concentration(math.radians(15.0), math.radians(38.0), 2650.0, 1000.0), 3)
    0.316
    """
    spare = math.tan(friction_angle) - math.tan(slope)
    if spare <= 0.0:
        return math.inf
    return rho_w * math.tan(slope) / ((rho_s - rho_w) * spare)


@law
def equilibrium_takahashi(
    slope: float, friction_angle: float, rho_s: float, rho_w: float, c_star: float
) -> float:
    """Equilibrium concentration [-], at most 0.9 times that of the bed.

    Parameters
    ----------
    slope : bed angle [rad].
    friction_angle : internal friction of the bed [rad].
    rho_s, rho_w : density of grain and water [kg/m3].
    c_star : concentration of the bed at rest [-].

    Notes
    -----
    Source: Takahashi 1978; the limit 0.9 c_star as in public codes for debris flows.

    Examples
    --------
    >>> round(equilibrium_takahashi(math.radians(30.0), math.radians(38.0), 2650.0, 1000.0, 0.6), 9)
    0.54
    """
    most = 0.9 * c_star
    c = equilibrium_concentration(slope, friction_angle, rho_s, rho_w)
    if c > most:
        return most
    return c


@law
def collision_factor(c: float, e: float, k_d: float, rho_s: float, rho_w: float) -> float:
    """Dimensionless stress of collisions [-], f_d = tau_d/(rho d**2 (dU/dz)**2).

    Parameters
    ----------
    c : concentration [-].
    e : restitution [-]; 0.85.
    k_d : constant [-]; 0.0828.
    rho_s, rho_w : density of grain and water [kg/m3].

    Notes
    -----
    Source: Egashira, Miyamoto & Itoh 1997, k_d (1 - e**2) (sigma/rho) c**(1/3), read in public code.

    Examples
    --------
    >>> round(collision_factor(0.125, 0.5, 0.08, 2500.0, 1000.0), 9)  # 0.08 * 0.75 * 2.5 * 0.5
    0.075
    """
    return k_d * (1.0 - e * e) * rho_s / rho_w * c ** (1.0 / 3.0)


@law
def pore_factor(c: float, k_f: float) -> float:
    """Dimensionless stress of the water in the pores [-], f_f = tau_f/(rho d**2 (dU/dz)**2).

    Parameters
    ----------
    c : concentration [-].
    k_f : constant [-]; 0.16.

    Notes
    -----
    Source: Egashira, Miyamoto & Itoh 1997, k_f (1 - c)**(5/3) c**(-2/3), read in public code. It corresponds
    to a mixing length of the size of a pore, l/d = sqrt(k_f) ((1 - c)/c)**(1/3), with water in the share (1 -
    c) of the area.

    Examples
    --------
    >>> round(pore_factor(0.5, 0.16), 9)  # 0.16 * 0.5
    0.08
    """
    return k_f * max(1.0 - c, 0.0) ** (5.0 / 3.0) * c ** (-2.0 / 3.0)


@law
def static_share(c: float, c_star: float) -> float:
    """Share of the pressure between grains that is carried by enduring contacts [-].

    Parameters
    ----------
    c : concentration [-].
    c_star : concentration of the bed at rest [-].

    Notes
    -----
    Source: Egashira, Miyamoto & Itoh 1997, (c/c_star)**(1/5), read in public code.

    Examples
    --------
    >>> round(static_share(0.015625, 0.5), 9)  # 1/32
    0.5
    """
    return (c / c_star) ** 0.2


@law
def velocity_egashira(
    z: float,
    h: float,
    c: float,
    slope: float,
    friction_angle: float,
    c_star: float,
    f: float,
    rho_s: float,
    rho_w: float,
    g: float,
    d: float,
) -> float:
    """Speed along the bed [m/s] in a steady flow of uniform concentration, after Egashira, Miyamoto and Itoh.

    Parameters
    ----------
    z : height above the bed [m].
    h : depth of the flow [m].
    c : concentration, the same over the depth [-].
    slope : bed angle [rad].
    friction_angle : static friction angle between grains [rad].
    c_star : concentration of the bed at rest [-].
    f : f_d + f_f at c [-]; `collision_factor` + `pore_factor`.
    rho_s, rho_w : density of grain and water [kg/m3].
    g : gravity [m/s2].
    d : diameter [m].

    Notes
    -----
    Source: tau = p_s tan(phi_s) + rho f d**2 (dU/dz)**2 of Egashira, Miyamoto & Itoh 1997, integrated here:
    all stresses decrease linearly to the surface, hence U = (2/3) K (h**1.5 - (h - z)**1.5) with
    K**2 = g s/(rho f d**2),
    s = ((sigma - rho) c + rho) sin(slope) - (sigma - rho) c (c/c_star)**(1/5) cos(slope) tan(phi_s).
    Zero if friction alone balances the weight (s <= 0); above h the speed of the surface. The mean speed is
    3/5 of that of the surface, which gives the friction factor 6.25 f (d/h)**2 of depth-averaged models.

    Examples
    --------
    >>> angle = math.radians(30.0)
    >>> u = velocity_egashira(0.04, 0.04, 1.0e-9, angle, 0.6, 0.6, 0.25, 2650.0, 1000.0, 9.8, 0.01)
    >>> round(u, 4)  # no grains: K**2 = 4.9/(0.25 1e-4), U = (2/3) 442.72 0.008
    2.3612
    """
    heavy = (rho_s - rho_w) * c
    friction = heavy * static_share(c, c_star) * math.cos(slope) * math.tan(friction_angle)
    spare = (heavy + rho_w) * math.sin(slope) - friction
    if z <= 0.0 or spare <= 0.0:
        return 0.0
    over = max(h - z, 0.0)
    k = math.sqrt(g * spare / (rho_w * f)) / d
    return 2.0 / 3.0 * k * (h * math.sqrt(h) - over * math.sqrt(over))
