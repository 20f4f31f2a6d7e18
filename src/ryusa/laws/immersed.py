"""Collisions under water: the effect of the water film between two grains."""

import math

from ryusa.laws._law import law
from ryusa.laws.elementary import exp, log


@law
def stokes_number(speed: float, m: float, r: float, rho_w: float, nu: float) -> float:
    """Stokes number of a collision [-]: inertia of the approach over the resistance of the film.

    Parameters
    ----------
    speed : speed of approach before the film has an effect [m/s].
    m : reduced mass of the pair [kg]; that of the grain at a wall. Legendre's St includes added mass.
    r : reduced radius of the pair [m]; that of the grain at a wall.
    rho_w : density of water [kg/m3].
    nu : kinematic viscosity [m2/s].

    Notes
    -----
    Source: m speed/(6 pi mu r**2). At a wall it is (1/9) (sigma/rho) Re = sigma d speed/(9 mu), between two
    equal grains twice that. While the film thins from h_1 to h_2, the speed decreases by speed
    ln(h_1/h_2)/St.

    Examples
    --------
    >>> m = 2700.0 * math.pi / 6.0 * 0.001**3
    >>> round(stokes_number(0.1, m, 0.0005, 1000.0, 1.0e-6), 9)  # 2700 * 1e-3 * 0.1/(9e-3)
    30.0
    """
    return m * speed / (6.0 * math.pi * rho_w * nu * r * r)


@law
def stokes_number_yade(speed: float, d: float, rho_s: float, rho_w: float, nu: float) -> float:
    """Stokes number of a collision [-] as YADE defines it.

    Parameters
    ----------
    speed : speed of approach [m/s].
    d : diameter [m].
    rho_s, rho_w : density of grain and water [kg/m3].
    nu : kinematic viscosity [m2/s].

    Notes
    -----
    Source: the test of lubrication in YADE, sigma d speed/mu: 9 times `stokes_number` at a wall, 4.5 times
    between two equal grains. With this number `restitution_davis` underestimates the loss by that factor.

    Examples
    --------
    >>> round(stokes_number_yade(0.1, 0.001, 2700.0, 1000.0, 1.0e-6), 9)
    270.0
    """
    return rho_s * d * speed / (rho_w * nu)


@law
def restitution_exponential(e_dry: float, st: float, st_c: float) -> float:
    """Restitution of an immersed collision [-], e_dry exp(-St_c/St).

    Parameters
    ----------
    e_dry : restitution in air [-].
    st : Stokes number of the collision [-], `stokes_number`.
    st_c : Stokes number at which the restitution is e_dry/e [-]; 35.

    Notes
    -----
    Source: Legendre, Daniel & Guiraud 2005 (drops) and Legendre et al. 2006 (also solid grains), St_c = 35,
    with added mass in St; fitted to the data of Gondret, Lance & Petit 2002 for spheres on a wall, whose
    rebound ends at St of about 10. The fit and its 35 were taken from public code (TrioCFD, LIGGGHTS), not
    from the articles. Never zero: 0.03 e_dry at St = 10.

    Examples
    --------
    >>> round(restitution_exponential(0.9, 35.0, 35.0), 4)
    0.3311
    >>> restitution_exponential(0.9, 0.0, 35.0)
    0.0
    """
    if st <= 0.0:
        return 0.0
    return e_dry * exp(-st_c / st)


@law
def restitution_davis(e_dry: float, st: float, roughness: float, d: float) -> float:
    """Restitution of an immersed collision [-] after the loss in the film from d/2 to the roughness.

    Parameters
    ----------
    e_dry : restitution in air [-].
    st : Stokes number of the collision [-]: `stokes_number`, or `stokes_number_yade` for the law of YADE.
    roughness : thickness of the film at which the grains touch [m].
    d : diameter [m].

    Notes
    -----
    Source: e_dry (1 + ln(2 roughness/d)/St), the lubrication of Davis, Serayssol & Hinch 1986 and Barnocky &
    Davis 1988 for rough spheres, in the form used by YADE; the two articles were not consulted. Only the loss
    of the approach is included. Limited to 0 (in YADE 0.001, because a dashpot for 0 is infinite) to e_dry.

    Examples
    --------
    >>> round(restitution_davis(0.9, 100.0, 1.0e-5, 1.0e-3), 4)  # 0.9 (1 + ln(0.02)/100)
    0.8648
    >>> restitution_davis(0.9, 1.0, 1.0e-5, 1.0e-3)
    0.0
    """
    if st <= 0.0:
        return 0.0
    left = 1.0 + log(2.0 * roughness / d) / st
    return e_dry * min(max(left, 0.0), 1.0)


@law
def lubrication_force(
    gap: float, closing: float, r: float, roughness: float, reach: float, rho_w: float, nu: float
) -> float:
    """Force of the water film between two grains [N]; positive pushes apart.

    Parameters
    ----------
    gap : distance of the two surfaces [m]; negative in touch.
    closing : speed at which the two centres approach [m/s]; positive when approaching.
    r : reduced radius of the pair [m]; that of the grain at a plane.
    roughness : length added to the gap, so that the force remains finite in touch [m].
    reach : gap above which there is no force [m].
    rho_w : density of water [kg/m3].
    nu : kinematic viscosity [m2/s].

    Notes
    -----
    Source: 6 pi mu r**2 closing/h for a thin film, with h = gap + roughness as in YADE and in Izard,
    Bonometti & Lacaze 2014, minus its value at `reach`, so that it begins continuously (after Nguyen & Ladd
    2002, from memory). Zero in touch, where the contact force acts. It also resists separation; to resist the
    approach alone, pass max(closing, 0).

    Examples
    --------
    >>> f = lubrication_force(1.0e-6, 0.01, 5.0e-4, 1.0e-6, 9.9e-5, 1000.0, 1.0e-6)
    >>> round(f * 1.0e6, 4)  # 6 pi 1e-3 2.5e-7 0.01 (5e5 - 1e4) = 0.735 pi 1e-5
    23.0907
    >>> lubrication_force(1.0e-3, 0.01, 5.0e-4, 1.0e-6, 9.9e-5, 1000.0, 1.0e-6)
    0.0
    """
    if gap < 0.0:
        return 0.0
    thin = max(reach - gap, 0.0) / ((gap + roughness) * (reach + roughness))
    return 6.0 * math.pi * rho_w * nu * r * r * closing * thin
