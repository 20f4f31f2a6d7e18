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
def discharge_over_bed(q_0: float, c: float, c_star: float) -> float:
    """Discharge of water and grains that a flow reaches over a saturated bed [m2/s].

    Parameters
    ----------
    q_0 : water that enters per width [m2/s].
    c : concentration of the discharge, q_s/q_T [-].
    c_star : concentration of the bed [-].

    Notes
    -----
    Derived: a bed that is taken up gives grains c_star and water 1 - c_star for each of its volume E; with as
    much water and grains in the flow at all times q_T = q_0 + E and c q_T = c_star E. Takahashi's growth of a
    debris flow.

    Examples
    --------
    >>> discharge_over_bed(0.02, 0.3, 0.6)
    0.04
    """
    return q_0 * c_star / (c_star - c)


@law
def run_out(
    u: float,
    h: float,
    c: float,
    steep: float,
    gentle: float,
    friction: float,
    rho_s: float,
    rho_w: float,
    g: float,
) -> tuple[float, float]:
    """Way of the front of a debris flow behind a slope break [m], and the time until it stops [s].

    Parameters
    ----------
    u, h, c : speed [m/s], depth [m] and concentration [-] just above the break.
    steep, gentle : angles of the reaches above and below [rad].
    friction : dynamic friction coefficient of the grains on each other, tan(alpha) [-].
    rho_s, rho_w : density of grain and water [kg/m3].
    g : gravity [m/s2].

    Notes
    -----
    Source: V**2/G after Takahashi & Yoshida 1979, derived from momentum with a steady feed (design/0028):
    V = u cos(steep - gentle) (1 + g h cos(steep)/(2 u**2)), G = g ((sigma - rho) c cos(gentle) tan(alpha)/
    ((sigma - rho) c + rho) - sin(gentle)). The flow slows down evenly, and stops after 2 V/G. Both are
    infinite if the gentle reach is too steep to stop it.

    Examples
    --------
    >>> angle = math.radians(18.0)
    >>> way, time = run_out(1.0, 0.03, 0.4, angle, math.radians(3.0), 0.6, 2650.0, 1000.0, 9.80665)
    >>> round(way, 3), round(time, 3)
    (0.665, 1.208)
    """
    submerged = (rho_s - rho_w) * c
    v = u * math.cos(steep - gentle) * (1.0 + g * h * math.cos(steep) / (2.0 * u * u))
    slowing = g * (submerged * math.cos(gentle) * friction / (submerged + rho_w) - math.sin(gentle))
    if slowing <= 0.0:
        endless = math.inf + 0.0 * v  # nan where something given is
        return endless, endless
    return v * v / slowing, 2.0 * v / slowing


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
