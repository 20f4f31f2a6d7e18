"""Forces of the water across the relative flow: shear lift, and the Magnus force on a spinning grain."""

import math

from ryusa.laws._law import step_law
from ryusa.laws.drag import reynolds
from ryusa.laws.elementary import exp, power, tanh


@step_law
def lift_wiberg_smith(top: float, bottom: float, c_l: float, rho_w: float, a_2: float, d: float) -> float:
    """Shear lift away from the bed [N] from the speeds of the water at the top and the bottom of a grain.

    Parameters
    ----------
    top, bottom : speed of the water along the bed relative to the grain, at its top and bottom [m/s].
    c_l : lift coefficient [-]; 0.2.
    rho_w : density of water [kg/m3].
    a_2 : area coefficient [-]; pi/4 for a sphere.
    d : diameter [m].

    Notes
    -----
    Source: Wiberg & Smith 1985, (1/2) rho C_L A (u_top**2 - u_bottom**2), C_L = 0.2, as given by YADE. The
    force on a grain faster than the water points to the bed.

    Examples
    --------
    >>> round(lift_wiberg_smith(0.3, 0.1, 0.2, 1000.0, 0.7854, 0.002) * 1.0e6, 4)  # 100 A_2 d**2 0.08
    25.1328
    """
    return 0.5 * rho_w * c_l * a_2 * d * d * (top - bottom) * (top + bottom)


@step_law
def shear_lift_wiberg_smith(
    top: float, bottom: float, c_l: float, rho_w: float, a_2: float, d: float
) -> tuple[float, float]:
    """Shear lift after Wiberg and Smith, in the form common to all laws of shear lift.

    Parameters
    ----------
    top, bottom, c_l, rho_w, a_2, d : as in `lift_wiberg_smith`.

    Returns
    -------
    normal : force along z, away from the bed [N].
    across : factor k [N s/m] of a force k (w x e_y), w = water - grain; zero here.

    Examples
    --------
    >>> shear_lift_wiberg_smith(0.1, 0.1, 0.2, 1000.0, 0.7854, 0.002)
    (0.0, 0.0)
    """
    return lift_wiberg_smith(top, bottom, c_l, rho_w, a_2, d), 0.0


@step_law
def saffman_mei(re: float, beta: float) -> float:
    """Ratio of the shear lift to Saffman's [-] after Mei.

    Parameters
    ----------
    re : slip d/nu [-].
    beta : shear d/(2 slip) [-].

    Notes
    -----
    Source: Mei 1992, (1 - 0.3314 sqrt(beta)) exp(-Re/10) + 0.3314 sqrt(beta) up to Re = 40 and
    0.0524 sqrt(beta Re) above, as given in OpenFOAM; a fit for 0.1 <= Re <= 100 and 0.005 < beta < 0.4 (range
    from memory). At Re = 40 it drops, by 7 % of the second branch at beta = 0.4 and by 76 % at 0.005.

    Examples
    --------
    >>> saffman_mei(0.0, 0.25), round(saffman_mei(100.0, 0.25), 3)
    (1.0, 0.262)
    """
    if re > 40.0:
        return 0.0524 * math.sqrt(beta * re)
    alpha = 0.3314 * math.sqrt(beta)
    return (1.0 - alpha) * exp(-0.1 * re) + alpha


@step_law
def lift_saffman_mei(slip: float, shear: float, d: float, nu: float, rho_w: float) -> float:
    """Factor k [N s/m] of the shear lift after Saffman and Mei.

    Parameters
    ----------
    slip : magnitude of the relative velocity of water and grain [m/s], >= 0.
    shear : dU/dz of the water along the bed [1/s]; the factor has its sign.
    d : diameter [m].
    nu : kinematic viscosity [m2/s].
    rho_w : density of water [kg/m3].

    Notes
    -----
    Source: Saffman 1965 with Mei's 1992 factor, 1.615 rho sqrt(nu) d**2 sqrt(abs(shear)) sign(shear). The
    force is k (w x e_y): F_z = k w_x, F_x = -k w_z with w = water - grain. Without slip k is Saffman's, which
    is the limit of Mei's.

    Examples
    --------
    >>> k = lift_saffman_mei(0.1, 20.0, 0.002, 1.0e-6, 1000.0)  # Re = 200, beta = 0.2
    >>> round(k / (1.615 * 1000.0 * 1.0e-3 * 4.0e-6 * math.sqrt(20.0)), 5)  # 0.0524 sqrt(40)
    0.33141
    """
    rate = abs(shear)
    k = math.copysign(1.615 * rho_w * math.sqrt(nu * rate) * d * d, shear)
    if slip == 0.0:
        return k
    return k * saffman_mei(reynolds(slip, d, nu), 0.5 * rate * d / slip)


@step_law
def shear_lift_saffman_mei(
    slip: float, shear: float, d: float, nu: float, rho_w: float
) -> tuple[float, float]:
    """Shear lift after Saffman and Mei, in the form common to all laws of shear lift.

    Parameters
    ----------
    slip, shear, d, nu, rho_w : as in `lift_saffman_mei`.

    Returns
    -------
    normal : force along z, away from the bed [N]; zero here.
    across : factor k [N s/m] of the force k (w x e_y), w = water - grain.

    Examples
    --------
    >>> shear_lift_saffman_mei(0.1, 0.0, 0.002, 1.0e-6, 1000.0)
    (0.0, 0.0)
    """
    return 0.0, lift_saffman_mei(slip, shear, d, nu, rho_w)


@step_law
def magnus_rubinow_keller(d: float, rho_w: float) -> float:
    """Factor k [kg] of the Magnus force k (Omega x w) on a slowly spinning sphere.

    Parameters
    ----------
    d : diameter [m].
    rho_w : density of water [kg/m3].

    Notes
    -----
    Source: Rubinow & Keller 1961, pi rho R**3. Omega is half the curl of the water velocity minus the spin of
    the grain, and w = water - grain: a grain that rolls downstream in faster water is lifted. Valid for
    Re << 1; above, the force is far too large, see `magnus_loth` and `magnus_oesterle_dinh`.

    Examples
    --------
    >>> round(magnus_rubinow_keller(0.002, 1000.0) * 1.0e6, 4)  # pi 1e-6
    3.1416
    """
    return 0.125 * math.pi * rho_w * d * d * d


@step_law
def magnus_loth(slip: float, spin: float, d: float, nu: float, rho_w: float) -> float:
    """Factor k [kg] of the Magnus force k (Omega x w), with the inertia of the water after Loth.

    Parameters
    ----------
    slip : magnitude of the relative velocity of water and grain [m/s], >= 0.
    spin : magnitude of Omega, the spin relative to the water [rad/s], >= 0.
    d : diameter [m].
    nu : kinematic viscosity [m2/s].
    rho_w : density of water [kg/m3].

    Notes
    -----
    Source: Loth 2008, Eq. 16, as given in the saltation code of Kok: Rubinow and Keller times
    1 - (0.675 + 0.15 (1 + tanh(0.28 (s - 2)))) tanh(0.18 sqrt(Re)) with s = spin d/slip.

    Examples
    --------
    >>> k = magnus_loth(1.0, 1000.0, 0.002, 1.0e-6, 1000.0)  # s = 2, Re = 2000: 1 - 0.825
    >>> round(k / magnus_rubinow_keller(0.002, 1000.0), 4)
    0.175
    """
    k = magnus_rubinow_keller(d, rho_w)
    if slip == 0.0:
        return k
    bend = 0.675 + 0.15 * (1.0 + tanh(0.28 * (spin * d / slip - 2.0)))
    return k * (1.0 - bend * tanh(0.18 * math.sqrt(reynolds(slip, d, nu))))


@step_law
def magnus_oesterle_dinh(slip: float, spin: float, d: float, nu: float, rho_w: float) -> float:
    """Factor k [kg] of the Magnus force k (Omega x w), with the inertia of the water after Oesterle and Dinh.

    Parameters
    ----------
    slip : magnitude of the relative velocity of water and grain [m/s], >= 0.
    spin : magnitude of Omega, the spin relative to the water [rad/s], >= 0.
    d : diameter [m].
    nu : kinematic viscosity [m2/s].
    rho_w : density of water [kg/m3].

    Notes
    -----
    Source: Oesterle & Bui Dinh 1998, C_L = 0.45 + (Re_r/Re - 0.45) exp(-0.05684 Re_r**0.4 Re**0.3) with Re_r
    = spin d**2/nu; measured for 10 < Re < 140 and 2 < Re_r/Re < 12. Rubinow and Keller have C_L = Re_r/Re,
    which is also used if slip or spin is zero. At very small spin k exceeds theirs, but the force still
    vanishes with the spin.

    Examples
    --------
    >>> k = magnus_oesterle_dinh(0.05, 200.0, 0.002, 1.0e-6, 1000.0)  # Re = 100, Re_r = 800
    >>> round(k / magnus_rubinow_keller(0.002, 1000.0), 4)  # C_L/8, C_L = 0.45 + 7.55 exp(-3.280)
    0.0918
    """
    k = magnus_rubinow_keller(d, rho_w)
    if slip == 0.0 or spin == 0.0:
        return k
    re, re_r = reynolds(slip, d, nu), reynolds(spin * d, d, nu)
    lone = re_r / re
    c_l = 0.45 + (lone - 0.45) * exp(-0.05684 * power(re_r, 0.4) * power(re, 0.3))
    return k * c_l / lone


@step_law
def shear_lift_force(normal: float, across: float, u_x: float, u_z: float) -> tuple[float, float]:
    """Force of a shear lift along x and z [N].

    Parameters
    ----------
    normal, across : what a law of shear lift answers [N], [N s/m].
    u_x, u_z : velocity of the water relative to the grain [m/s].

    Notes
    -----
    Source: `normal` along z and across (u x e_y).

    Examples
    --------
    >>> shear_lift_force(1.0, 2.0, 3.0, 4.0)
    (-8.0, 7.0)
    """
    return -across * u_z, normal + across * u_x


@step_law
def magnus_force(
    k: float, o_x: float, o_y: float, o_z: float, u_x: float, u_y: float, u_z: float
) -> tuple[float, float, float]:
    """Magnus force [N], k (Omega x u).

    Parameters
    ----------
    k : factor of a Magnus law [kg].
    o_x, o_y, o_z : Omega, half the curl of the velocity of the water minus the spin of the grain [rad/s].
    u_x, u_y, u_z : velocity of the water relative to the grain [m/s].

    Examples
    --------
    >>> magnus_force(2.0, 0.0, 1.0, 0.0, 3.0, 0.0, 4.0)
    (8.0, 0.0, -6.0)
    """
    return k * (o_y * u_z - o_z * u_y), k * (o_z * u_x - o_x * u_z), k * (o_x * u_y - o_y * u_x)
