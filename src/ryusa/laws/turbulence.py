"""Turbulence in the water column: mixing lengths, eddy viscosity, shear stress of the bed."""

import math

from ryusa.laws._law import law
from ryusa.laws.debris import pore_factor


@law
def length_prandtl(z: float, kappa: float) -> float:
    """Mixing length above a wall [m], kappa z; zero for z <= 0 [m].

    Notes
    -----
    Source: Prandtl 1925. kappa [-] is von Karman's constant, 0.40 to 0.41.

    Examples
    --------
    >>> round(length_prandtl(0.01, 0.41), 6)
    0.0041
    """
    if z <= 0.0:
        return 0.0 * kappa
    return kappa * z


@law
def length_parabolic(z: float, depth: float, kappa: float) -> float:
    """Mixing length in an open channel [m], kappa z sqrt(1 - z/depth).

    Parameters
    ----------
    z : height above the bed [m]; the length is zero for z <= 0 and z >= depth.
    depth : depth of the water [m], > 0.
    kappa : von Karman's constant [-].

    Notes
    -----
    Source: the free-surface option of YADE's HydroForceEngine (Maurin et al. 2015), which cites Nezu &
    Nakagawa 1993, Turbulence in Open-Channel Flows (not consulted). With a stress that decreases linearly to
    the surface it gives the eddy viscosity kappa u_star z (1 - z/depth) and the logarithmic law over the
    whole depth.

    Examples
    --------
    >>> round(length_parabolic(0.015, 0.02, 0.4), 6)  # 0.4 * 0.015 * sqrt(1/4)
    0.003
    """
    if z <= 0.0:
        return 0.0 * kappa
    return kappa * z * math.sqrt(max(1.0 - z / depth, 0.0))


@law
def length_parabolic_between(z: float, face: float, depth: float, kappa: float) -> float:
    """Mixing length in an open channel at a face between two cells [m].

    Parameters
    ----------
    z : height at which the gradient of the logarithmic law equals its mean gradient between the centres of
        the two cells [m], `height_between`; the height of the face over a moving bed.
    face : height of the face [m]; the length is zero for face <= 0.
    depth, kappa : as in `length_parabolic`.

    Notes
    -----
    Source: derived. sqrt(1 - z/depth) is evaluated at the face, as is the stress, and kappa z at `z`, so that
    the cells follow the logarithmic law from the wall upwards.

    Examples
    --------
    >>> round(length_parabolic_between(0.0144, 0.015, 0.02, 0.4), 6)  # 0.4 * 0.0144 * sqrt(1/4)
    0.00288
    """
    if face <= 0.0:
        return 0.0 * kappa
    return length_parabolic(face, depth, kappa) * (z / face)


@law
def length_van_driest(z: float, u_star: float, nu: float, kappa: float) -> float:
    """Mixing length above a smooth wall [m], kappa z (1 - exp(-z+/26)), z+ = z u_star/nu.

    Parameters
    ----------
    z : height above the wall [m].
    u_star : friction velocity [m/s].
    nu : kinematic viscosity [m2/s], > 0.
    kappa : von Karman's constant [-].

    Notes
    -----
    Source: van Driest 1956, J. Aeronaut. Sci. 23, 1007; the constant 26 as in the PHOENICS encyclopaedia.

    Examples
    --------
    >>> round(length_van_driest(26.0e-4, 0.01, 1.0e-6, 0.4) / 26.0e-4, 6)  # z+ = 26: 0.4 (1 - 1/e)
    0.252848
    """
    if z <= 0.0:
        return 0.0 * kappa
    return -kappa * z * math.expm1(-z * u_star / (26.0 * nu))


@law
def length_growth_li_sawamoto(phi: float, phi_max: float, dz: float, kappa: float) -> float:
    """Mixing length contributed by a layer of thickness dz [m], kappa (phi_max - phi)/phi_max dz.

    Parameters
    ----------
    phi : concentration of grains in the layer [-]; no contribution if phi >= phi_max.
    phi_max : concentration above which there is no turbulence [-], > 0.
    dz : thickness [m].
    kappa : von Karman's constant [-].

    Notes
    -----
    Source: Li & Sawamoto 1995, Coastal Eng. Japan 38, as used by Revil-Baudard & Chauchat 2013 and by Maurin
    et al. 2015; taken from the code of YADE, not from the articles. The mixing length is the sum over all
    layers below. In clear water it is kappa z.

    Examples
    --------
    >>> round(length_growth_li_sawamoto(0.3, 0.6, 0.001, 0.4), 9)
    0.0002
    """
    return kappa * max(phi_max - phi, 0.0) / phi_max * dz


@law
def length_shear_layer(thickness: float) -> float:
    """Mixing length in a free shear layer [m]; vorticity thickness [m]: speed lost over its steepest rise.

    Notes
    -----
    Source: plane wall jets widen by 0.073 of their way (Launder & Rodi 1983, Ann. Rev. Fluid Mech. 15), a
    free jet U sech(0.881 y/b)**2 by S with a viscosity S U b/(4 0.881**2). With the first rate, 0.126 of the
    thickness, 1.474 b, has this viscosity where the profile is steepest. A mixing layer
    U/2 (1 + erf(11 y/x)) (Goertler's profile, spreading parameter of Birch & Eggers 1972) has the viscosity
    U x/(4 11**2): there it is 0.113 of the thickness, sqrt(pi) x/11. The law has 0.12 for both.

    Examples
    --------
    >>> round(length_shear_layer(0.01), 6)
    0.0012
    """
    return 0.12 * thickness


@law
def length_pore_egashira(phi: float, d: float, k_f: float) -> float:
    """Mixing length in the pores of a debris flow [m]; its square is k_f (1-c)**(5/3) c**(-2/3) d**2.

    Parameters
    ----------
    phi : concentration of grains, c in the source [-], > 0; the length is infinite at 0.
    d : diameter of the grains [m].
    k_f : coefficient [-], 0.16 in the source.

    Notes
    -----
    Source: Egashira, Miyamoto & Itoh 1997; the stress of the water in the pores, rho f_f d**2 |dU/dz| dU/dz
    with f_f of `debris.pore_factor`, expressed as a mixing length. It includes the factor 1 - c.

    Examples
    --------
    >>> (
    ...     round(length_pore_egashira(0.3, 1.0, 0.16) ** 2, 3),
    ...     round(length_pore_egashira(0.5, 1.0, 0.16) ** 2, 3),
    ... )
    (0.197, 0.08)
    """
    return d * math.sqrt(pore_factor(phi, k_f))


@law
def eddy_viscosity(length: float, shear: float, eps: float) -> float:
    """Kinematic eddy viscosity [m2/s] of a mixture with the share eps of water, eps l**2 |dU/dz|.

    Parameters
    ----------
    length : mixing length [m].
    shear : velocity gradient of the water [1/s].
    eps : volume fraction of the water, 1 - phi [-].

    Notes
    -----
    Source: Prandtl 1925 for clear water; the factor eps as in Revil-Baudard & Chauchat 2013 and Maurin et al.
    2015, taken from the code of YADE.

    Examples
    --------
    >>> round(eddy_viscosity(0.004, -10.0, 0.5), 6)
    8e-05
    """
    return eps * length * length * abs(shear)


@law
def height_between(z_low: float, z_high: float) -> float:
    """Height [m] at which the gradient of the logarithmic law is its mean between two heights [m], both > 0.

    Notes
    -----
    The logarithmic mean (z_high - z_low)/ln(z_high/z_low). With mixing lengths evaluated there, the cells of
    a column follow the logarithmic law exactly, from the wall upwards.

    Examples
    --------
    >>> import math
    >>> round(height_between(1.0, math.e), 6)  # e - 1
    1.718282
    """
    if z_high == z_low:
        return z_low
    return (z_high - z_low) / math.log1p((z_high - z_low) / z_low)


@law
def u_star_smooth(u_x: float, z: float, nu: float) -> float:
    """Friction velocity [m/s] at a smooth wall from the water speed |u_x| at height z.

    Parameters
    ----------
    u_x : speed along the wall [m/s]; its sign does not matter.
    z : height above the wall [m], > 0.
    nu : kinematic viscosity [m2/s], > 0.

    Notes
    -----
    Inverse of `water.log_law_smooth`: explicit below z+ = 11.3, by Newton's method above, where it is convex.

    Examples
    --------
    >>> round(u_star_smooth(0.01, 1.0e-4, 1.0e-6), 12)  # z+ = 1
    0.01
    >>> round(u_star_smooth(2.223, 0.01, 1.0e-6), 4)  # z+ = 1000: u+ = 22.23
    0.1
    """
    speed = abs(u_x)
    guess = math.sqrt(nu * speed / z)
    if not z * guess > 11.3 * nu:
        return guess
    for _ in range(40):
        plus = math.log(z * guess / (11.3 * nu)) / 0.41 + 11.3
        change = (speed - guess * plus) / (plus + 1.0 / 0.41)
        guess += change
        if abs(change) <= 1.0e-15 * guess:
            break
    return guess


@law
def wall_smooth(u_x: float, z: float, nu: float) -> tuple[float, float]:
    """Stress on a smooth wall over density [m2/s2], with the sign of u_x, and its derivative by u_x [m/s].

    Parameters
    ----------
    u_x : water speed at height z [m/s].
    z : height above the wall [m], > 0.
    nu : kinematic viscosity [m2/s], > 0.

    Notes
    -----
    Source: the two-layer law of `water.log_law_smooth`; linear in u_x for z+ <= 11.3.

    Examples
    --------
    >>> stress, slope = wall_smooth(0.01, 1.0e-4, 1.0e-6)  # nu u/z and nu/z
    >>> round(stress, 9), round(slope, 9)
    (0.0001, 0.01)
    """
    u_star = u_star_smooth(u_x, z, nu)
    if not z * u_star > 11.3 * nu:
        return nu * u_x / z, nu / z
    return math.copysign(u_star * u_star, u_x), 2.0 * u_star / (abs(u_x) / u_star + 1.0 / 0.41)


@law
def wall_no_slip(u_x: float, z: float, nu: float, square: float) -> tuple[float, float]:
    """Stress on a no-slip wall over density [m2/s2], with the sign of u_x, and its derivative by u_x [m/s].

    Parameters
    ----------
    u_x : water speed at height z [m/s].
    z : height above the wall [m], > 0.
    nu : kinematic viscosity [m2/s].
    square : square of the mixing length at the wall, times the volume fraction of water [m2]; 0 if laminar.

    Notes
    -----
    Source: (nu + nu_t) u_x/z with nu_t of `eddy_viscosity` at the velocity gradient u_x/z.

    Examples
    --------
    >>> stress, slope = wall_no_slip(0.01, 1.0e-4, 1.0e-6, 0.0)  # nu u/z and nu/z
    >>> round(stress, 9), round(slope, 9)
    (0.0001, 0.01)
    """
    nu_t = eddy_viscosity(1.0, u_x / z, square)
    return (nu + nu_t) * u_x / z, (nu + 2.0 * nu_t) / z


@law
def wall_rough(u_x: float, z: float, k_rough: float) -> tuple[float, float]:
    """Stress on a rough wall over density [m2/s2], with the sign of u_x, and its derivative [m/s]. Eq. (9).

    Parameters
    ----------
    u_x : water speed at height z [m/s].
    z : height above the zero of the profile [m], above k_rough/30.
    k_rough : equivalent roughness [m], > 0.

    Notes
    -----
    Source: the paper, Eq. (9), solved for u_star.

    Examples
    --------
    >>> stress, slope = wall_rough(0.85, 0.002, 0.002)  # at z = k_rough u_star is u/8.5
    >>> round(stress, 9), round(slope, 9)
    (0.01, 0.023529412)
    """
    plus = 8.5 + 5.75 * math.log10(z / k_rough)
    rate = abs(u_x) / (plus * plus)
    return rate * u_x, 2.0 * rate


@law
def speed_mean_rough(depth: float, u_star: float, k_rough: float) -> float:
    """Mean of Eq. (9) over the depth [m/s]; times the depth it is the discharge per unit width.

    Parameters
    ----------
    depth : depth of the water above the zero of the profile [m].
    u_star : friction velocity [m/s].
    k_rough : equivalent roughness [m], > 0.

    Notes
    -----
    Source: integral of Eq. (9) of the paper from the height where it becomes positive, about k_rough/30.

    Examples
    --------
    >>> round(speed_mean_rough(0.02, 0.1, 0.002), 3)  # about 0.1 (6.0 + 5.75)
    1.176
    """
    zero = k_rough * 10.0 ** (-8.5 / 5.75)
    if depth <= zero:
        return 0.0 * u_star
    return u_star * 5.75 / math.log(10.0) * (math.log(depth / zero) - 1.0 + zero / depth)
