"""Drag on grains that are not spheres: drag coefficients by their form, and settling to compare with.

A grain is described by the diameter d of the sphere of the same volume and either by its sphericity or by two
shape factors: its drag at small Re over that on the sphere (Stokes), and the same at large Re (Newton). Each
law has a curve of its own, fitted to grains that turn freely while they settle; for spheres the laws in
`drag` are closer.
"""

import math

from ryusa.laws._law import law, step_law
from ryusa.laws.elementary import exp, log, power

_LN_10 = 2.302585092994046


@law
def shape_factors_ganser(sphericity: float) -> tuple[float, float]:
    """Shape factors of a grain by its sphericity [-]: Stokes, Newton.

    Parameters
    ----------
    sphericity : surface of the sphere of the same volume over that of the grain [-], above 0, at most 1.

    Notes
    -----
    Source: Ganser 1993 for isometric grains, 1/K_1 = (1 + 2 sphericity**-0.5)/3 and
    log10(K_2) = 1.8148 (-log10(sphericity))**0.5743; constants as in public codes that quote it (Kratos).

    >>> shape_factors_ganser(1.0)
    (1.0, 1.0)
    >>> [round(one, 4) for one in shape_factors_ganser(0.806)]  # a cube
    [1.0759, 2.9228]
    """
    stokes = (1.0 + 2.0 / math.sqrt(sphericity)) / 3.0
    less = -log(sphericity) / _LN_10
    if less <= 0.0:
        return stokes, 1.0
    return stokes, exp(_LN_10 * 1.8148 * power(less, 0.5743))


@law
def shape_factors_bagheri_bonadonna(
    elongation: float, flatness: float, fullness: float, density_ratio: float
) -> tuple[float, float]:
    """Shape factors of a grain by its lengths a >= b >= c [-]: Stokes, Newton.

    Parameters
    ----------
    elongation, flatness : b/a and c/b [-].
    fullness : d**3/(a b c), d the diameter of the sphere of the same volume [-]; 1 for an ellipsoid.
    density_ratio : density of the grain over that of the fluid [-].

    Notes
    -----
    Source: Bagheri & Bonadonna 2016, F_S = flatness elongation**1.3 fullness, F_N = flatness**2 elongation
    fullness, stokes = (F_S**(1/3) + F_S**(-1/3))/2, log10(newton) = alpha (-log10(F_N))**beta with
    alpha = 0.45 + 10/(exp(2.5 log10(density_ratio)) + 30) and
    beta = 1 - 37/(exp(3 log10(density_ratio)) + 100); constants as in public code that quotes them.

    >>> shape_factors_bagheri_bonadonna(1.0, 1.0, 1.0, 2.65)
    (1.0, 1.0)
    >>> [round(one, 3) for one in shape_factors_bagheri_bonadonna(0.5, 0.5, 1.0, 2.65)]
    [1.145, 5.085]
    """
    f_s = flatness * power(elongation, 1.3) * fullness
    f_n = flatness * flatness * elongation * fullness
    root = power(f_s, 1.0 / 3.0)
    stokes = 0.5 * (root + 1.0 / root)
    ratio = log(density_ratio) / _LN_10
    alpha = 0.45 + 10.0 / (exp(2.5 * ratio) + 30.0)
    beta = 1.0 - 37.0 / (exp(3.0 * ratio) + 100.0)
    less = -log(f_n) / _LN_10
    if less <= 0.0:
        return stokes, 1.0
    return stokes, exp(_LN_10 * alpha * power(less, beta))


@step_law
def c_d_ganser(re: float, stokes: float, newton: float) -> float:
    """Drag coefficient of a grain by its shape factors [-] after Ganser.

    Parameters
    ----------
    re : grain Reynolds number of the sphere of the same volume [-].
    stokes, newton : shape factors, `shape_factors_ganser` [-].

    Notes
    -----
    Source: Ganser 1993, K_2 (24/x (1 + 0.1118 x**0.6567) + 0.4305/(1 + 3305/x)) with x = Re newton/stokes =
    K_1 K_2 Re. For a sphere up to a quarter below measured ones about Re = 100. Infinite at Re = 0.

    >>> round(c_d_ganser(100.0, 1.0, 1.0), 3)
    0.805
    """
    x = re * newton / stokes
    return newton * (24.0 / x * (1.0 + 0.1118 * power(x, 0.6567)) + 0.4305 / (1.0 + 3305.0 / x))


@step_law
def c_d_bagheri_bonadonna(re: float, stokes: float, newton: float) -> float:
    """Drag coefficient of a grain by its shape factors [-] after Bagheri and Bonadonna.

    Parameters
    ----------
    re : grain Reynolds number of the sphere of the same volume [-].
    stokes, newton : shape factors, `shape_factors_bagheri_bonadonna` [-].

    Notes
    -----
    Source: Bagheri & Bonadonna 2016, newton (24/x (1 + 0.125 x**(2/3)) + 0.46/(1 + 5330/x)) with
    x = Re newton/stokes; constants as in public code that quotes them. For a sphere up to a fifth below
    measured ones about Re = 100. Infinite at Re = 0.

    >>> round(c_d_bagheri_bonadonna(100.0, 1.0, 1.0), 3)
    0.895
    """
    x = re * newton / stokes
    return newton * (24.0 / x * (1.0 + 0.125 * power(x, 2.0 / 3.0)) + 0.46 / (1.0 + 5330.0 / x))


@step_law
def c_d_haider_levenspiel(re: float, sphericity: float) -> float:
    """Drag coefficient of a grain of given sphericity [-].

    Parameters
    ----------
    re : grain Reynolds number of the sphere of the same volume [-].
    sphericity : surface of the sphere of the same volume over that of the grain [-].

    Notes
    -----
    Source: Haider & Levenspiel 1989, 24/Re (1 + A Re**B) + C/(1 + D/Re); constants as in public codes that
    quote it (OpenFOAM). Fitted for a sphericity of 0.67 to 1 and Re < 25,000. Infinite at Re = 0.

    >>> round(c_d_haider_levenspiel(100.0, 1.0), 2)
    1.15
    """
    p = sphericity
    a = exp(2.3288 - 6.4581 * p + 2.4486 * p * p)
    b = 0.0964 + 0.5565 * p
    c = exp(4.9050 - 13.8944 * p + 18.4222 * p * p - 10.2599 * p * p * p)
    d = exp(1.4681 + 12.2584 * p - 20.7322 * p * p + 15.8855 * p * p * p)
    return 24.0 / re * (1.0 + a * power(re, b)) + c / (1.0 + d / re)


@law
def terminal_velocity_corey(
    ratio: float, g: float, d: float, nu: float, corey: float, roundness: float
) -> float:
    """Settling velocity of natural grains [m/s] by Corey's shape factor and roundness, after Dietrich 1982.

    Parameters
    ----------
    ratio : R = rho_s/rho_w - 1 [-], > 0.
    g : gravity [m/s2], > 0.
    d : diameter of the sphere of the same volume [m], > 0.
    nu : kinematic viscosity [m2/s], > 0.
    corey : c/sqrt(a b) [-], above 0.15, at most 1.
    roundness : on the scale of Powers [-]; 6 perfectly round, natural grains 3 to 4.

    Notes
    -----
    Source: Dietrich 1982, w**3 = R g nu R_3 10**(R_1 + R_2) with polynomials in log10(R g d**3/nu**2); its
    constants agree in several codes that quote it. Fitted for R g d**3/nu**2 from 0.05 to 5e9.

    >>> round(terminal_velocity_corey(1.65, 9.81, 0.002, 1.0e-6, 1.0, 6.0), 3)
    0.283
    >>> round(terminal_velocity_corey(1.65, 9.81, 0.002, 1.0e-6, 0.7, 3.5), 3)
    0.194
    """
    size = log(ratio * g * d * d * d / (nu * nu)) / _LN_10
    r_1 = -3.76715 + size * (1.92944 + size * (-0.09815 + size * (-0.00575 + size * 0.00056)))
    bend = math.tanh(size - 4.6)
    flat = 1.0 - corey
    r_2 = log(1.0 - flat / 0.85) / _LN_10 + 0.3 * (0.5 - corey) * flat * flat * (size - 4.6)
    if flat > 0.0:
        r_2 -= power(flat, 2.3) * bend
    r_3 = power(0.65 - corey / 2.83 * bend, 1.0 + (3.5 - roundness) / 2.5)
    return power(ratio * g * nu * r_3 * exp(_LN_10 * (r_1 + r_2)), 1.0 / 3.0)
