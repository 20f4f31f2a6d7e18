"""Water over a bed: velocity profiles (Eq. (9) and others) and friction velocity."""

import math

from ryusa.laws._law import law, step_law
from ryusa.laws.elementary import log, log10


@step_law
def log_law_rough(z: float, u_star: float, k_rough: float) -> float:
    """Water speed at height z over a hydraulically rough bed. Eq. (9).

    Parameters
    ----------
    z : height above the zero of the profile [m].
    u_star : friction velocity [m/s].
    k_rough : equivalent roughness [m], > 0.

    Returns
    -------
    u_x : speed along the bed [m/s].

    Notes
    -----
    Source: the paper, Eq. (9); log is base 10. The printed law is negative below about k_rough/30, where zero
    is used instead; zero for z <= 0.

    Examples
    --------
    >>> round(log_law_rough(0.002, 0.1, 0.002), 3)  # at z = k_rough: 8.5 u_star
    0.85
    >>> log_law_rough(0.00006, 0.1, 0.002)  # below k_rough/30
    0.0
    """
    if z <= 0.0:
        return 0.0
    return max(u_star * (8.5 + 5.75 * log10(z / k_rough)), 0.0)


@step_law
def log_law_smooth(z: float, u_star: float, nu: float) -> float:
    """Water speed at height z over a hydraulically smooth bed.

    Parameters
    ----------
    z : height above the bed [m].
    u_star : friction velocity [m/s].
    nu : kinematic viscosity [m2/s], > 0.

    Returns
    -------
    u_x : speed along the bed [m/s].

    Notes
    -----
    Source: the two-layer law of the wall, u+ = z+ up to z+ = 11.3 and u+ = ln(z+/11.3)/0.41 + 11.3 above
    (the classical u+ = ln(z+)/0.41 + 5.4 in a form that is continuous). Zero for z <= 0.

    Examples
    --------
    >>> round(log_law_smooth(1.0e-4, 0.01, 1.0e-6), 4)  # z+ = 1: u+ = 1
    0.01
    >>> round(log_law_smooth(0.01, 0.1, 1.0e-6) / 0.1, 2)  # z+ = 1000
    22.23
    """
    if z <= 0.0:
        return 0.0
    z_plus = z * u_star / nu
    if z_plus <= 11.3:
        return u_star * z_plus
    return u_star * (log(z_plus / 11.3) / 0.41 + 11.3)


@step_law
def uniform(z: float, speed: float) -> float:
    """Water speed of a plug flow [m/s]: `speed` for z > 0 [m], else zero.

    Examples
    --------
    >>> uniform(0.01, 0.3), uniform(-0.01, 0.3)
    (0.3, 0.0)
    """
    if z <= 0.0:
        return 0.0
    return speed


@step_law
def still(z: float) -> float:
    """Water at rest: zero speed [m/s] at every height z [m].

    Examples
    --------
    >>> still(0.01)
    0.0
    """
    return 0.0


@law
def u_star_from_tau_star(tau_star: float, rho_s: float, rho_w: float, g: float, d: float) -> float:
    """Friction velocity [m/s] from the dimensionless shear stress (Shields number).

    Parameters
    ----------
    tau_star : u_star**2 / ((rho_s/rho_w - 1) g d) [-].
    rho_s, rho_w : density of grain and water [kg/m3].
    g : gravity [m/s2].
    d : diameter [m].

    Notes
    -----
    Source: definition of tau_star; the saltation case of the paper has 0.3.

    Examples
    --------
    >>> round(u_star_from_tau_star(0.3, 2650.0, 1000.0, 9.8, 0.002), 4)
    0.0985
    """
    return math.sqrt(tau_star * (rho_s / rho_w - 1.0) * g * d)


@law
def tau_star_from_u_star(u_star: float, rho_s: float, rho_w: float, g: float, d: float) -> float:
    """Dimensionless shear stress [-] from the friction velocity [m/s]; inverse of `u_star_from_tau_star`.

    Examples
    --------
    >>> round(tau_star_from_u_star(0.0985, 2650.0, 1000.0, 9.8, 0.002), 3)
    0.3
    """
    return u_star * u_star / ((rho_s / rho_w - 1.0) * g * d)


@law
def u_star_from_slope(depth: float, slope: float, g: float) -> float:
    """Friction velocity of steady uniform flow [m/s]: bed stress balances the weight along the slope.

    Parameters
    ----------
    depth : water depth normal to the bed [m].
    slope : bed angle [rad].
    g : gravity [m/s2].

    Notes
    -----
    Source: u_star**2 = g depth sin(slope).

    Examples
    --------
    >>> import math
    >>> round(u_star_from_slope(0.02, math.atan(1 / 20), 9.8), 4)  # the paper's saltation
    0.0989
    """
    return math.sqrt(g * depth * math.sin(slope))
