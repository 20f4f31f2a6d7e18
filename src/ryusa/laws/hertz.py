"""Elastic spheres: Hertz's normal force, Mindlin's tangential stiffness, and their impacts in closed form.

Two spheres of one material, or a sphere and a flat wall (infinite radius) of the same material, overlap by x.
The normal spring is F = K x**1.5 with K = (4/3) E_e sqrt(R_e); the dashpot c x**0.25 v with a constant c
makes the restitution independent of the speed. With y = x**1.25 and d tau = sqrt(K/m) x**0.25 dt such a
contact is the linear oscillator y'' + 2 zeta w y' + w**2 y = 0, w**2 = 5/4 (Antypov & Elliott 2011, EPL 94,
50004), so that restitution over zeta is that of the linear contact (laws/collision.py) under both partings,
and only the time is a quadrature. design/0018.
"""

import math

from ryusa.laws._law import law
from ryusa.laws.collision import phase_to_largest

POINTS = 256  # of the quadrature of a contact time


@law
def effective_modulus(young: float, poisson: float) -> float:
    """Effective modulus E_e of two bodies of one material [Pa]: 1/E_e = 2 (1 - nu**2)/E.

    Parameters
    ----------
    young : Young's modulus E [Pa].
    poisson : Poisson's ratio nu [-].

    Notes
    -----
    Source: Johnson 1985, Contact Mechanics, Eq. (4.5).

    >>> effective_modulus(2.0, 0.0)
    1.0
    """
    return 0.5 * young / ((1.0 - poisson) * (1.0 + poisson))


@law
def effective_shear_modulus(young: float, poisson: float) -> float:
    """Effective shear modulus G_e of two bodies of one material [Pa]: 1/G_e = 2 (2 - nu)/G.

    Parameters
    ----------
    young : Young's modulus E [Pa].
    poisson : Poisson's ratio nu [-].

    Notes
    -----
    Source: Mindlin 1949; Johnson 1985, Eq. (7.43); G = E/(2 (1 + nu)).

    >>> effective_shear_modulus(8.0, 0.0)
    1.0
    """
    return 0.25 * young / ((1.0 + poisson) * (2.0 - poisson))


@law
def hertz_stiffness(modulus: float, r: float) -> float:
    """Stiffness K of Hertz's force K x**1.5 [N/m**1.5]: (4/3) E_e sqrt(R_e).

    Parameters
    ----------
    modulus : effective modulus E_e [Pa], from `effective_modulus`.
    r : reduced radius R_e [m]; that of the sphere on a flat wall.

    Notes
    -----
    Source: Hertz 1882; Johnson 1985, Eq. (4.23).

    >>> hertz_stiffness(0.75, 4.0)
    2.0
    """
    return 4.0 / 3.0 * modulus * math.sqrt(r)


@law
def modulus_for_stiffness(k_hertz: float, r: float, poisson: float) -> float:
    """Young's modulus [Pa] whose spheres have the stiffness K; inverse of `hertz_stiffness`.

    Parameters
    ----------
    k_hertz : K [N/m**1.5].
    r : reduced radius R_e [m].
    poisson : Poisson's ratio [-].

    >>> modulus_for_stiffness(2.0, 4.0, 0.0)
    1.5
    """
    return 1.5 * k_hertz / math.sqrt(r) * ((1.0 - poisson) * (1.0 + poisson))


@law
def hertz_force(overlap: float, k_hertz: float) -> float:
    """Normal force of two elastic spheres [N]: K x**1.5, 0 without overlap.

    Parameters
    ----------
    overlap : x [m].
    k_hertz : K [N/m**1.5].

    >>> hertz_force(4.0, 0.5), hertz_force(-1.0, 0.5)
    (4.0, 0.0)
    """
    x = max(overlap, 0.0)
    return k_hertz * x * math.sqrt(x)


@law
def hertz_energy(overlap: float, k_hertz: float) -> float:
    """Elastic energy of two spheres [J]: (2/5) F x.

    Parameters
    ----------
    overlap : x [m].
    k_hertz : K [N/m**1.5].

    >>> hertz_energy(4.0, 1.0)
    12.8
    """
    return 0.4 * overlap * hertz_force(overlap, k_hertz)


@law
def hertz_energy_of_force(f_n: float, k_hertz: float) -> float:
    """Elastic energy of two spheres that push with a force [J]: (2/5) F (F/K)**(2/3).

    Parameters
    ----------
    f_n : force of the spring F [N], >= 0.
    k_hertz : K [N/m**1.5].

    >>> round(hertz_energy_of_force(8.0, 1.0), 12)
    12.8
    """
    return 0.4 * f_n * (f_n / k_hertz) ** (2.0 / 3.0)


@law
def hertz_overlap(f_n: float, k_hertz: float) -> float:
    """Overlap of two spheres under a load [m]: (F/K)**(2/3); inverse of `hertz_force`.

    Parameters
    ----------
    f_n : force F [N], >= 0.
    k_hertz : K [N/m**1.5].

    >>> round(hertz_overlap(8.0, 1.0), 12)
    4.0
    """
    return (f_n / k_hertz) ** (2.0 / 3.0)


@law
def contact_radius(overlap: float, r: float) -> float:
    """Radius of the circle in which two spheres touch [m]: a = sqrt(R_e x).

    Parameters
    ----------
    overlap : x [m], >= 0.
    r : reduced radius R_e [m].

    >>> contact_radius(1.0, 4.0)
    2.0
    """
    return math.sqrt(r * overlap)


@law
def normal_stiffness_hertz(overlap: float, k_hertz: float) -> float:
    """Stiffness of the normal spring at an overlap [N/m]: dF/dx = 1.5 K sqrt(x) = 2 E_e a.

    Parameters
    ----------
    overlap : x [m], >= 0.
    k_hertz : K [N/m**1.5].

    >>> normal_stiffness_hertz(4.0, 1.0)
    3.0
    """
    return 1.5 * k_hertz * math.sqrt(overlap)


@law
def mindlin_ratio(poisson: float) -> float:
    """Tangential stiffness 8 G_e a over K sqrt(x) [-]: 3 (1 - nu)/(2 - nu), for spheres of one material.

    Parameters
    ----------
    poisson : Poisson's ratio nu [-].

    Notes
    -----
    Source: Mindlin 1949, k_s = 8 G_e a; with a = sqrt(R_e x) and K of `hertz_stiffness`. It is 2/3 of it over
    the normal stiffness dF/dx.

    >>> mindlin_ratio(0.0), mindlin_ratio(0.5)
    (1.5, 1.0)
    """
    return 3.0 * (1.0 - poisson) / (2.0 - poisson)


@law
def hertz_damping(zeta: float, k_hertz: float, m: float) -> float:
    """Constant c of the normal dashpot c x**0.25 v [N s/m**1.25]: sqrt(5) zeta sqrt(K m).

    Parameters
    ----------
    zeta : damping ratio [-]: that of the linear contact of the same restitution.
    k_hertz : K [N/m**1.5].
    m : effective mass of the pair [kg].

    Notes
    -----
    Source: Tsuji, Tanaka & Ishida 1992, Powder Technology 71, 239, alpha = sqrt(5) zeta.

    >>> round(hertz_damping(0.1, 4.0, 5.0), 12)
    1.0
    """
    return zeta * math.sqrt(5.0 * k_hertz * m)


@law
def mindlin_damping(zeta: float, k_shear: float, m: float) -> float:
    """Constant of the tangential dashpot c x**0.25 v [N s/m**1.25]: 2 zeta sqrt(k m), k = k_s/sqrt(x).

    Parameters
    ----------
    zeta : damping ratio of the tangential oscillator at any overlap [-].
    k_shear : tangential stiffness over the root of the overlap [N/m**1.5].
    m : effective mass of the pair in the tangential direction [kg].

    >>> mindlin_damping(0.1, 4.0, 25.0)
    2.0
    """
    return 2.0 * zeta * math.sqrt(k_shear * m)


@law
def overlap_max_hertz(speed: float, m: float, k_hertz: float, zeta: float) -> float:
    """Largest overlap of an impact of elastic spheres [m].

    Parameters
    ----------
    speed : closing speed at first touch v [m/s].
    m : effective mass [kg].
    k_hertz : K [N/m**1.5].
    zeta : damping ratio [-].

    Notes
    -----
    Source: Hertz, (5 m v**2/(4 K))**0.4; with the dashpot times exp(-0.8 zeta phase), phase as in
    `collision.phase_to_largest`, because y = x**1.25 is a linear oscillator.

    >>> overlap_max_hertz(1.0, 4.0, 5.0, 0.0)
    1.0
    """
    return (1.25 * m * speed * speed / k_hertz) ** 0.4 * math.exp(-0.8 * zeta * phase_to_largest(zeta))


@law
def stiffness_hertz_for_overlap(overlap: float, speed: float, m: float, zeta: float) -> float:
    """Stiffness K [N/m**1.5] that gives a largest overlap; inverse of `overlap_max_hertz`.

    Parameters
    ----------
    overlap : largest overlap [m].
    speed : closing speed at first touch [m/s].
    m : effective mass [kg].
    zeta : damping ratio [-].

    >>> stiffness_hertz_for_overlap(1.0, 1.0, 4.0, 0.0)
    5.0
    """
    return 1.25 * m * speed * speed * (math.exp(-0.8 * zeta * phase_to_largest(zeta)) / overlap) ** 2.5


@law
def speed_for_overlap_hertz(overlap: float, m: float, k_hertz: float, zeta: float) -> float:
    """Impact speed [m/s] that gives a largest overlap; inverse of `overlap_max_hertz`.

    Parameters
    ----------
    overlap : largest overlap [m].
    m : effective mass [kg].
    k_hertz : K [N/m**1.5].
    zeta : damping ratio [-].

    >>> speed_for_overlap_hertz(1.0, 4.0, 5.0, 0.0)
    1.0
    """
    undamped = overlap * math.exp(0.8 * zeta * phase_to_largest(zeta))
    return math.sqrt(0.8 * k_hertz / m * undamped**2.5)


@law
def free_phase(theta: float, zeta: float) -> float:
    """Displacement of an oscillator of unit frequency after a phase, for a unit velocity at first [-].

    Parameters
    ----------
    theta : phase [-].
    zeta : damping ratio [-].

    >>> free_phase(0.5, 0.0) == math.sin(0.5), round(free_phase(1.0, 1.0), 6)
    (True, 0.367879)
    """
    decay = math.exp(-zeta * theta)
    square = (1.0 - zeta) * (1.0 + zeta)
    if square == 0.0:
        return decay * theta
    w = math.sqrt(abs(square))
    return decay * (math.sin(w * theta) if square > 0.0 else math.sinh(w * theta)) / w


@law
def time_factor_hertz(zeta: float, tension: bool) -> float:
    """Contact time of elastic spheres over (m**2/(K**2 v))**0.2 [-]; 3.218 without damping.

    Parameters
    ----------
    zeta : damping ratio [-].
    tension : whether the dashpot may pull until the overlap ends; else to the end of the force.

    Notes
    -----
    Source: design/0014, the integral of y**-0.2 d tau over a contact, by the trapezoidal rule after a
    substitution that takes away the singularities at its ends; to 1e-9. inf with tension from zeta = 1 on.

    >>> round(time_factor_hertz(0.0, True), 4), round(time_factor_hertz(0.3, False), 4)
    (3.2181, 2.7774)
    """
    whole = 2.0 * phase_to_largest(zeta)
    if tension:
        if zeta >= 1.0:
            return math.inf
        whole = math.pi / math.sqrt((1.0 - zeta) * (1.0 + zeta))
    total = 0.0
    for k in range(1, POINTS):
        u = k / POINTS
        near, far = u**5, (1.0 - u) ** 5
        both = near + far
        slope = 5.0 * (u * (1.0 - u)) ** 4 / (both * both)  # of near/both
        total += slope * free_phase(whole * near / both, zeta) ** -0.2
    return 1.25**-0.6 * whole * total / POINTS


@law
def contact_time_hertz(speed: float, m: float, k_hertz: float, zeta: float, tension: bool) -> float:
    """Contact time of elastic spheres [s]: 2.87 (m**2/(R_e E_e**2 v))**0.2 without damping.

    Parameters
    ----------
    speed : closing speed at first touch v [m/s].
    m : effective mass [kg].
    k_hertz : K [N/m**1.5].
    zeta, tension : as in `time_factor_hertz` [-].

    Notes
    -----
    Source: Hertz 1882; Johnson 1985, Eq. (11.24). It is 2.9433 times the largest overlap over v.

    >>> t, x = contact_time_hertz(1.0, 4.0, 5.0, 0.0, True), overlap_max_hertz(1.0, 4.0, 5.0, 0.0)
    >>> round(t / x, 4)
    2.9433
    """
    return time_factor_hertz(zeta, tension) * (m * m / (k_hertz * k_hertz * speed)) ** 0.2


@law
def stiffness_hertz_for_time(t_col: float, speed: float, m: float, zeta: float, tension: bool) -> float:
    """Stiffness K [N/m**1.5] that gives a contact time; inverse of `contact_time_hertz`.

    Parameters
    ----------
    t_col : contact time [s].
    speed : closing speed at first touch [m/s].
    m : effective mass [kg].
    zeta, tension : as in `time_factor_hertz` [-].

    >>> t = contact_time_hertz(1.0, 4.0, 5.0, 0.1, False)
    >>> round(stiffness_hertz_for_time(t, 1.0, 4.0, 0.1, False), 9)
    5.0
    """
    return m * (time_factor_hertz(zeta, tension) / t_col) ** 2.5 / math.sqrt(speed)
