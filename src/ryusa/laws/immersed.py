"""Collisions under water: what the film between two grains takes before they touch."""

import math

from ryusa.laws._law import law


@law
def stokes_number(speed: float, m: float, r: float, rho_w: float, nu: float) -> float:
    """Stokes number of a collision [-]: inertia of the approach against the film between the two.

    Parameters
    ----------
    speed : speed of approach before the film is felt [m/s].
    m : reduced mass of the pair [kg]; the grain's own against a wall. With added mass St is Legendre's.
    r : reduced radius of the pair [m]; the grain's own against a wall.
    rho_w : density of water [kg/m3].
    nu : kinematic viscosity [m2/s].

    Notes
    -----
    Source: m speed/(6 pi mu r**2). Against a wall it is (1/9) (sigma/rho) Re = sigma d speed/(9 mu), between
    two equal grains twice that. In a film of thickness h the speed falls by speed ln(h_1/h_2)/St between h_1
    and h_2.

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
    Source: YADE's check of its lubrication, sigma d speed/mu: 9 times `stokes_number` against a wall, 4.5
    times between two equal grains. `restitution_davis` with this number takes that much too little from the
    approach.

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
    st_c : Stokes number that sets the fall [-]; 35.

    Notes
    -----
    Source: Legendre, Daniel & Guiraud 2005 (drops) and Legendre et al. 2006 (also solid grains), St_c = 35,
    with added mass in St; drawn through the data of Gondret, Lance & Petit 2002 for spheres on a wall, whose
    rebound ends at St about 10. The fit and its 35 were read in public code (TrioCFD, LIGGGHTS), not in the
    articles. Never zero: 0.03 e_dry at St = 10.

    Examples
    --------
    >>> round(restitution_exponential(0.9, 35.0, 35.0), 4)
    0.3311
    >>> restitution_exponential(0.9, 0.0, 35.0)
    0.0
    """
    if st <= 0.0:
        return 0.0
    return e_dry * math.exp(-st_c / st)


@law
def restitution_davis(e_dry: float, st: float, roughness: float, d: float) -> float:
    """Restitution of an immersed collision [-]: what the film takes between d/2 and the roughness.

    Parameters
    ----------
    e_dry : restitution in air [-].
    st : Stokes number of the collision [-]; `stokes_number`, or `stokes_number_yade` to have YADE's law.
    roughness : thickness of the film at which the grains touch [m].
    d : diameter [m].

    Notes
    -----
    Source: e_dry (1 + ln(2 roughness/d)/St), the lubrication of Davis, Serayssol & Hinch 1986 and Barnocky &
    Davis 1988 for rough spheres, in the form YADE uses; those two articles were not consulted. Only the
    approach is counted. Between 0 (YADE keeps 0.001, because a dashpot for 0 is infinite) and e_dry.

    Examples
    --------
    >>> round(restitution_davis(0.9, 100.0, 1.0e-5, 1.0e-3), 4)  # 0.9 (1 + ln(0.02)/100)
    0.8648
    >>> restitution_davis(0.9, 1.0, 1.0e-5, 1.0e-3)
    0.0
    """
    if st <= 0.0:
        return 0.0
    left = 1.0 + math.log(2.0 * roughness / d) / st
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
    r : reduced radius of the pair [m]; the grain's own against a plane.
    roughness : added to the gap, so that the force stays finite in touch [m].
    reach : gap from which on there is no force [m].
    rho_w : density of water [kg/m3].
    nu : kinematic viscosity [m2/s].

    Notes
    -----
    Source: 6 pi mu r**2 closing/h for a thin film, with h = gap + roughness as YADE and Izard, Bonometti &
    Lacaze 2014 have it, less its value at `reach`, so that it begins without a jump (after Nguyen & Ladd
    2002, from memory). None in touch, where the contact takes over. It also holds back grains that part;
    who wants the approach alone hands in max(closing, 0).

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
