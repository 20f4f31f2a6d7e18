"""Dimensionless sediment transport: q_star, tau_star, thresholds and the classical formulae."""

import math

from ryusa.laws._law import law


@law
def tau_star_from_stress(tau: float, rho_s: float, rho_w: float, g: float, d: float) -> float:
    """Dimensionless shear stress [-] from the shear stress on the bed [Pa].

    Parameters
    ----------
    tau : shear stress on the bed [Pa].
    rho_s, rho_w : density of grain and water [kg/m3].
    g : gravity [m/s2].
    d : diameter [m].

    Notes
    -----
    Source: definition (Shields), tau/((sigma - rho) g d). Some authors use g cos(slope).

    Examples
    --------
    >>> round(tau_star_from_stress(9.702, 2650.0, 1000.0, 9.8, 0.002), 9)  # 9.702/32.34
    0.3
    """
    return tau / ((rho_s - rho_w) * g * d)


@law
def q_star_from_q(q: float, ratio: float, g: float, d: float) -> float:
    """Dimensionless transport rate [-] from the volume of grains per time and width.

    Parameters
    ----------
    q : volume of grains, without voids, that passes a section per time and width [m2/s].
    ratio : R = rho_s/rho_w - 1 [-].
    g : gravity [m/s2].
    d : diameter [m].

    Notes
    -----
    Source: definition (Einstein), q/sqrt(R g d**3). Some authors use g cos(slope).

    Examples
    --------
    >>> round(q_star_from_q(1.18e-4, 1.5, 9.81 / math.sqrt(1.01), 0.006), 3)  # Frey's run 6
    0.066
    """
    return q / math.sqrt(ratio * g * d * d * d)


@law
def q_from_q_star(q_star: float, ratio: float, g: float, d: float) -> float:
    """Volume of grains per time and width [m2/s] from the dimensionless rate [-]; inverse of `q_star_from_q`.

    Examples
    --------
    >>> round(q_from_q_star(0.5, 2.0, 2.0, 1.0), 12)
    1.0
    """
    return q_star * math.sqrt(ratio * g * d * d * d)


@law
def d_star(ratio: float, g: float, d: float, nu: float) -> float:
    """Dimensionless diameter D_* [-].

    Parameters
    ----------
    ratio : R = rho_s/rho_w - 1 [-].
    g : gravity [m/s2].
    d : diameter [m].
    nu : kinematic viscosity [m2/s].

    Notes
    -----
    Source: Soulsby 1997, Eq. 75, d (R g/nu**2)**(1/3).

    Examples
    --------
    >>> round(d_star(1.65, 9.81, 0.001, 1.0e-6), 3)  # (16186.5)**(1/3)
    25.296
    """
    return d * (ratio * g / (nu * nu)) ** (1.0 / 3.0)


@law
def tau_star_critical(d_star: float) -> float:
    """Dimensionless shear stress at which grains begin to move [-], from D_* [-].

    Notes
    -----
    Source: Soulsby & Whitehouse (Soulsby 1997, Eq. 77), 0.30/(1 + 1.2 D_*) + 0.055 (1 - exp(-0.020 D_*)).

    Examples
    --------
    >>> tau_star_critical(0.0), round(tau_star_critical(50.0), 5)  # 0.3/61 + 0.055 (1 - 1/e)
    (0.3, 0.03968)
    """
    return 0.30 / (1.0 + 1.2 * d_star) + 0.055 * (1.0 - math.exp(-0.020 * d_star))


@law
def rouse_number(w_s: float, u_star: float, kappa: float) -> float:
    """Rouse number [-], settling velocity over the velocity scale of turbulence, w_s/(kappa u_star).

    Parameters
    ----------
    w_s : settling velocity [m/s].
    u_star : friction velocity [m/s].
    kappa : von Karman's constant [-]; 0.41.

    Notes
    -----
    Source: Rouse 1937, with equal turbulent diffusivities of grains and momentum. Above about 2.5 grains
    remain near the bed, below about 0.8 they are distributed over the depth.

    Examples
    --------
    >>> rouse_number(0.2, 0.25, 0.4)
    2.0
    """
    return w_s / (kappa * u_star)


@law
def q_star_meyer_peter_mueller(tau_star: float) -> float:
    """Dimensionless transport rate [-] after Meyer-Peter and Mueller, from tau_star [-].

    Notes
    -----
    Source: Meyer-Peter & Mueller 1948 without bed forms, 8 (tau_star - 0.047)**1.5; zero below the threshold.

    Examples
    --------
    >>> round(q_star_meyer_peter_mueller(0.297), 9), q_star_meyer_peter_mueller(0.04)  # 8 * 0.125
    (1.0, 0.0)
    """
    return 8.0 * max(tau_star - 0.047, 0.0) ** 1.5


@law
def q_star_wong_parker(tau_star: float) -> float:
    """Dimensionless transport rate [-] after Wong and Parker, exponent 1.5, from tau_star [-].

    Notes
    -----
    Source: Wong & Parker 2006, the data of Meyer-Peter and Mueller without their side-wall correction:
    3.97 (tau_star - 0.0495)**1.5; zero below the threshold.

    Examples
    --------
    >>> round(q_star_wong_parker(0.2995), 9)  # 3.97 * 0.125
    0.49625
    """
    return 3.97 * max(tau_star - 0.0495, 0.0) ** 1.5


@law
def q_star_wong_parker_steep(tau_star: float) -> float:
    """Dimensionless transport rate [-] after Wong and Parker, exponent 1.6, from tau_star [-].

    Notes
    -----
    Source: Wong & Parker 2006, the same data with a fitted exponent: 4.93 (tau_star - 0.047)**1.6.

    Examples
    --------
    >>> round(q_star_wong_parker_steep(1.047), 9)
    4.93
    """
    return 4.93 * max(tau_star - 0.047, 0.0) ** 1.6


@law
def solid_discharge_smart_jaeggi(
    q: float, slope: float, depth: float, s: float, d: float, spread: float, tau_star_c: float
) -> float:
    """Volume of sediment that steep flow carries per width and time [m2/s], after Smart and Jaeggi.

    Parameters
    ----------
    q : discharge of water per width [m2/s].
    slope : tangent of the slope of the bed [-]; the experiments had 0.005 to 0.2.
    depth : of the flow [m].
    s : density of the sediment over that of the water [-].
    d : mean diameter [m].
    spread : d_90/d_30, by mass [-]; 1 for grains of one size.
    tau_star_c : Shields number at the threshold of motion [-]; 0.05.

    Notes
    -----
    Source: Smart & Jaeggi 1983, 4/(s - 1) (d_90/d_30)**0.2 q slope**1.6 (1 - tau_star_c/tau_star) with
    tau_star = depth slope/((s - 1) d); zero below the threshold.

    Examples
    --------
    >>> round(solid_discharge_smart_jaeggi(1.0, 0.1, 0.5, 3.0, 0.25, 1.0, 0.05), 9)  # 2 * 0.1**1.6 * 0.5
    0.025118864
    """
    tau_star = depth * slope / ((s - 1.0) * d)
    share = max(tau_star - tau_star_c, 0.0) / tau_star if tau_star != 0.0 else 0.0
    return 4.0 / (s - 1.0) * spread**0.2 * q * slope**1.6 * share


@law
def q_star_ashida_michiue(tau_star: float, tau_star_e: float, tau_star_c: float) -> float:
    """Dimensionless transport rate [-] after Ashida and Michiue.

    Parameters
    ----------
    tau_star : dimensionless shear stress [-].
    tau_star_e : part of it that acts on the grains [-], `tau_star_effective`; tau_star without bed forms.
    tau_star_c : value at the threshold of motion [-]; 0.05.

    Notes
    -----
    Source: Ashida & Michiue 1972, 17 tau_e**1.5 (1 - tau_c/tau) (1 - sqrt(tau_c/tau)). Without bed forms it
    is 17 (tau - tau_c) (sqrt(tau) - sqrt(tau_c)). Formula and threshold 0.05 were taken from public code,
    which cites Parker's e-book, chapter 7. Zero below the threshold.

    Examples
    --------
    >>> round(q_star_ashida_michiue(0.2, 0.2, 0.05), 4)  # 17 * 0.15 * (0.4472 - 0.2236)
    0.5702
    >>> q_star_ashida_michiue(0.04, 0.04, 0.05)
    0.0
    """
    part = tau_star_c / tau_star
    return 17.0 * tau_star_e**1.5 * max(1.0 - part, 0.0) * max(1.0 - math.sqrt(part), 0.0)


@law
def tau_star_effective(
    speed: float, depth: float, tau_star: float, ratio: float, g: float, d: float
) -> float:
    """Dimensionless shear stress on the grains in the presence of bed forms [-], after Ashida and Michiue.

    Parameters
    ----------
    speed : mean speed of the water [m/s].
    depth : depth of the water [m].
    tau_star : dimensionless shear stress [-].
    ratio : R = rho_s/rho_w - 1 [-].
    g : gravity [m/s2].
    d : diameter [m].

    Notes
    -----
    Source: Ashida & Michiue 1972, speed/u_star_e = 6 + 2.5 ln(depth/(d (1 + 2 tau_star))), read in public
    code.

    Examples
    --------
    >>> round(tau_star_effective(0.6, 0.02, 0.5, 1.0, 10.0, 0.01), 9)  # depth/(2 d) = 1: u_star_e = 0.1
    0.1
    """
    u_star = speed / (6.0 + 2.5 * math.log(depth / (d * (1.0 + 2.0 * tau_star))))
    return u_star * u_star / (ratio * g * d)


@law
def bedload_layer(tau_star: float, slope: float, friction_angle: float, c_s: float, alpha: float) -> float:
    """Thickness of the moving layer over the diameter [-], h_s/d, after Egashira, Miyamoto and Itoh.

    Parameters
    ----------
    tau_star : dimensionless shear stress [-].
    slope : bed angle [rad].
    friction_angle : static friction angle between grains, phi_s [rad].
    c_s : concentration in the layer [-]; half that of the bed, 0.3.
    alpha : ratio of the pressure of collisions to the static pressure [-]; 0.25.

    Notes
    -----
    Source: Egashira, Miyamoto & Itoh 1997, tau_star/(c_s cos(slope) (tan(phi_s)/(1 + alpha) - tan(slope))),
    taken from public code. Infinite if the slope is too steep for a layer.

    Examples
    --------
    >>> round(bedload_layer(0.3, 0.0, math.atan(0.5), 0.3, 0.25), 9)
    2.5
    """
    holds = math.tan(friction_angle) / (1.0 + alpha) - math.tan(slope)
    if holds <= 0.0:
        return math.inf
    return tau_star / (c_s * math.cos(slope) * holds)


@law
def q_star_egashira(
    tau_star: float, slope: float, friction_angle: float, c_s: float, alpha: float, f: float, depth: float
) -> float:
    """Dimensionless transport rate of bed load [-] after Egashira, Miyamoto and Itoh.

    Parameters
    ----------
    tau_star : dimensionless shear stress [-].
    slope : bed angle [rad].
    friction_angle : static friction angle between grains, phi_s [rad].
    c_s : concentration in the moving layer [-]; half that of the bed, 0.3.
    alpha : ratio of the pressure of collisions to the static pressure [-]; 0.25.
    f : f_d + f_f at c_s [-]; `debris.collision_factor` + `debris.pore_factor`.
    depth : depth of the flow over the diameter [-].

    Notes
    -----
    Source: Egashira, Miyamoto & Itoh 1997, (4/15) K_1**2 K_2 tau_star**2.5/sqrt(f_d + f_f) with K_1 =
    1/(cos(slope) (tan(phi_s)/(1 + alpha) - tan(slope))) and K_2 = sqrt(1 - h_s/h)/c_s; composed of the layer
    thickness and the mean speed in public code. There is no threshold. nan if the layer fills the depth: the
    flow is then a debris flow.

    Examples
    --------
    >>> q_star = q_star_egashira(0.3, 0.0, math.atan(0.5), 0.3, 0.25, 0.25, 1.0e12)
    >>> round(q_star, 4)  # (4/15) 6.25/0.3 sqrt(0.00243)/0.5
    0.5477
    """
    layer = bedload_layer(tau_star, slope, friction_angle, c_s, alpha)
    if layer >= depth:
        return math.nan
    return 4.0 / 15.0 * c_s * layer * layer * math.sqrt(tau_star * (1.0 - layer / depth) / f)
