"""Water on one grain: drag coefficients, drag, buoyancy and added mass. Eqs. (10)-(11)."""

import math

from ryusa.laws._law import law, step_law
from ryusa.laws.elementary import exp, log, power


@step_law
def reynolds(speed: float, d: float, nu: float) -> float:
    """Grain Reynolds number [-] of the relative speed [m/s], diameter d [m], kinematic viscosity nu [m2/s].

    Examples
    --------
    >>> round(reynolds(0.3, 0.002, 1.0e-6), 9)
    600.0
    """
    return speed * d / nu


@step_law
def c_d_constant(c_d: float) -> float:
    """Drag coefficient independent of Re [-].

    Examples
    --------
    >>> c_d_constant(0.44)
    0.44
    """
    return c_d


@step_law
def c_d_re_04(re: float) -> float:
    """Drag coefficient 24/Re + 0.4 [-]; Stokes at small Re, 0.4 at large.

    Notes
    -----
    Source: customary for spheres in Japanese bed-load studies. Infinite at Re = 0, where `drag_factor` is
    zero.

    Examples
    --------
    >>> round(c_d_re_04(24.0), 12)
    1.4
    """
    return 24.0 / re + 0.4


@step_law
def c_d_re_2(re: float) -> float:
    """Drag coefficient 24/Re + 2 [-]; Stokes at small Re, 2 at large (angular natural grains).

    Notes
    -----
    Source: Rubey's form for natural sand. Infinite at Re = 0.

    Examples
    --------
    >>> c_d_re_2(24.0)
    3.0
    """
    return 24.0 / re + 2.0


@step_law
def c_d_schiller_naumann(re: float) -> float:
    """Drag coefficient of a smooth sphere [-] after Schiller and Naumann.

    Notes
    -----
    Source: Schiller & Naumann 1933, 24/Re (1 + 0.15 Re**0.687), and 0.44 above Re = 1000 (a step of 0.4 %).
    Infinite at Re = 0.

    Examples
    --------
    >>> round(c_d_schiller_naumann(100.0), 3), c_d_schiller_naumann(2000.0)
    (1.092, 0.44)
    """
    if re > 1000.0:
        return 0.44
    return 24.0 / re * (1.0 + 0.15 * power(re, 0.687))


@step_law
def c_d_ferguson_church(re: float, c_1: float, c_2: float) -> float:
    """Drag coefficient [-] that gives the settling velocity of Ferguson and Church.

    Parameters
    ----------
    re : grain Reynolds number [-].
    c_1 : Stokes constant [-]; 18 for spheres and sand.
    c_2 : drag coefficient at large Re [-]; 0.4 for spheres, 1.0 for natural sand.

    Notes
    -----
    Source: Ferguson & Church 2004, w = R g d**2/(c_1 nu + sqrt(0.75 c_2 R g d**3)), solved for C_D:
    (1/3) (sqrt(3/4 c_2) + sqrt(3/4 c_2 + 4 c_1/Re))**2. Infinite at Re = 0.

    Examples
    --------
    >>> round(c_d_ferguson_church(1.0e12, 18.0, 0.4), 4)
    0.4
    """
    s = 0.75 * c_2
    root = math.sqrt(s) + math.sqrt(s + 4.0 * c_1 / re)
    return root * root / 3.0


@step_law
def c_d_ferguson_church_sphere(re: float) -> float:
    """Drag coefficient of a sphere [-] after Ferguson & Church 2004 (constants 18 and 0.4).

    Examples
    --------
    >>> c_d_ferguson_church_sphere(50.0) == c_d_ferguson_church(50.0, 18.0, 0.4)
    True
    """
    return c_d_ferguson_church(re, 18.0, 0.4)


@step_law
def c_d_ferguson_church_sand(re: float) -> float:
    """Drag coefficient of natural sand [-] after Ferguson & Church 2004 (constants 18 and 1.0).

    Examples
    --------
    >>> c_d_ferguson_church_sand(50.0) == c_d_ferguson_church(50.0, 18.0, 1.0)
    True
    """
    return c_d_ferguson_church(re, 18.0, 1.0)


@step_law
def drag_factor(speed: float, c_d: float, rho_w: float, a_2: float, d: float) -> float:
    """Drag force over relative velocity [N s/m]; times U - u and V - v it gives the components.

    Parameters
    ----------
    speed : magnitude of the relative velocity of water and grain [m/s], >= 0.
    c_d : drag coefficient at that speed [-].
    rho_w : density of water [kg/m3].
    a_2 : area coefficient [-]; pi/4 for a sphere.
    d : diameter [m].

    Notes
    -----
    Source: the paper, Eqs. (10)-(11), (1/2) rho C_D A_2 d**2 abs(w). Zero at speed 0, where C_D may be
    infinite and the force vanishes.

    Examples
    --------
    >>> round(drag_factor(0.3, 0.4, 1000.0, 0.7854, 0.002), 9)
    0.000188496
    >>> drag_factor(0.0, math.inf, 1000.0, 0.7854, 0.002)
    0.0
    """
    if speed == 0.0:
        return 0.0
    return 0.5 * rho_w * c_d * a_2 * d * d * speed


@step_law
def drag_among_neighbours(
    slip: float, speed: float, factor: float, c_d: float, rho_w: float, a_2: float, d: float
) -> float:
    """Drag over relative velocity [N s/m] of a grain among others, from that of an isolated grain.

    Parameters
    ----------
    slip : magnitude of the relative velocity of water and grain [m/s], >= 0.
    speed, factor : what `hindrance` answers: slip of the isolated grain [m/s], and factor of its drag [-].
    c_d : drag coefficient at that speed [-].
    rho_w, a_2, d : as in `drag_factor`.

    Notes
    -----
    Source: the drag is `factor` times that of an isolated grain at `speed`, along the slip. Zero at slip 0.

    Examples
    --------
    >>> round(drag_among_neighbours(0.3, 0.6, 2.0, 0.4, 1000.0, 0.7854, 0.002), 9)  # 8 times as much
    0.001507968
    >>> drag_among_neighbours(0.0, 0.0, 1.0, math.inf, 1000.0, 0.7854, 0.002)
    0.0
    """
    if slip == 0.0:
        return 0.0
    return factor * drag_factor(speed, c_d, rho_w, a_2, d) * speed / slip


@law
def volume(d: float, a_3: float) -> float:
    """Volume of a grain [m3], A_3 d**3; a_3 = pi/6 for a sphere. Eqs. (10)-(11).

    Examples
    --------
    >>> volume(2.0, 0.5)
    4.0
    """
    return a_3 * d * d * d


@law
def added_mass(rho_w: float, c_m: float, volume: float) -> float:
    """Mass of water that is accelerated with a grain [kg], rho C_M V. Eqs. (10)-(11), C_M = 0.5.

    Notes
    -----
    It adds to the inertia of translation only, not to the weight or the moment of inertia.

    Examples
    --------
    >>> added_mass(1000.0, 0.5, 0.25)
    125.0
    """
    return rho_w * c_m * volume


@law
def submerged_mass(m: float, rho_w: float, volume: float) -> float:
    """Submerged mass of a grain [kg], (sigma - rho) V; times gravity it is the weight in Eqs. (10)-(11).

    Examples
    --------
    >>> round(submerged_mass(10.6e-6, 1000.0, 4.0e-9), 10)
    6.6e-06
    """
    return m - rho_w * volume


@law
def terminal_velocity_stokes(ratio: float, g: float, d: float, nu: float) -> float:
    """Settling velocity of a sphere at Re << 1 [m/s], R g d**2/(18 nu).

    Parameters
    ----------
    ratio : R = rho_s/rho_w - 1 [-].
    g : gravity [m/s2].
    d : diameter [m].
    nu : kinematic viscosity [m2/s].

    Notes
    -----
    Source: Stokes 1851.

    Examples
    --------
    >>> round(terminal_velocity_stokes(1.65, 9.8, 1.0e-4, 1.0e-6), 4)
    0.009
    """
    return ratio * g * d * d / (18.0 * nu)


@law
def terminal_velocity_ferguson_church(
    ratio: float, g: float, d: float, nu: float, c_1: float, c_2: float
) -> float:
    """Settling velocity [m/s] after Ferguson & Church 2004.

    Parameters
    ----------
    ratio : R = rho_s/rho_w - 1 [-].
    g : gravity [m/s2].
    d : diameter [m].
    nu : kinematic viscosity [m2/s].
    c_1, c_2 : 18 and 0.4 for spheres, 18 and 1.0 for natural sand [-].

    Notes
    -----
    Source: Ferguson & Church 2004, R g d**2/(c_1 nu + sqrt(0.75 c_2 R g d**3)).

    Examples
    --------
    >>> round(terminal_velocity_ferguson_church(1.65, 9.81, 0.002, 1.0e-6, 18.0, 0.4), 3)
    0.301
    """
    return ratio * g * d * d / (c_1 * nu + math.sqrt(0.75 * c_2 * ratio * g * d * d * d))


@law
def terminal_velocity_soulsby(ratio: float, g: float, d: float, nu: float) -> float:
    """Settling velocity of natural sand [m/s] after Soulsby 1997.

    Parameters
    ----------
    ratio : R = rho_s/rho_w - 1 [-].
    g : gravity [m/s2].
    d : diameter [m].
    nu : kinematic viscosity [m2/s].

    Notes
    -----
    Source: Soulsby 1997, Eq. 102, nu/d (sqrt(10.36**2 + 1.049 D) - 10.36), D = R g d**3/nu**2; taken
    from codes that quote it.

    Examples
    --------
    >>> round(terminal_velocity_soulsby(1.65, 9.81, 0.002, 1.0e-6), 4)
    0.1792
    """
    d_star = ratio * g * d * d * d / (nu * nu)
    return nu / d * (math.sqrt(10.36 * 10.36 + 1.049 * d_star) - 10.36)


@law
def terminal_velocity_dietrich(ratio: float, g: float, d: float, nu: float) -> float:
    """Settling velocity of a nearly round grain [m/s] after Dietrich 1982.

    Parameters
    ----------
    ratio : R = rho_s/rho_w - 1 [-], > 0.
    g : gravity [m/s2], > 0.
    d : diameter [m], > 0.
    nu : kinematic viscosity [m2/s], > 0.

    Notes
    -----
    Source: Dietrich 1982 as a polynomial in L = ln(sqrt(R g d) d/nu) after Parker, w = R_f sqrt(R g d); its
    five constants agree in several codes that quote it. Fitted for sqrt(R g d) d/nu from about 3 to 10**4.

    Examples
    --------
    >>> round(terminal_velocity_dietrich(1.65, 9.81, 0.002, 1.0e-6), 4)
    0.283
    """
    scale = math.sqrt(ratio * g * d)
    size = log(scale * d / nu)
    speed = -2.891394 + size * (0.95296 + size * (-0.056835 + size * (-0.002892 + 0.000245 * size)))
    return exp(speed) * scale
