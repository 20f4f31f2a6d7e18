"""Torque of the water on a spinning grain, open problem (iii) of the paper."""

import math

from ryusa.laws._law import law, step_law


@step_law
def reynolds_spin(spin: float, d: float, nu: float) -> float:
    """Rotational Reynolds number Re_r = 4 R**2 abs(spin)/nu = d**2 abs(spin)/nu [-].

    Examples
    --------
    >>> round(reynolds_spin(900.0, 0.002, 1.0e-6), 6)  # the paper's fastest spin
    3600.0
    """
    return d * d * abs(spin) / nu


@step_law
def torque_stokes(spin: float, d: float, nu: float, rho_w: float) -> float:
    """Factor k [N m s] of the torque T = -k omega of the water on a slowly spinning sphere.

    Parameters
    ----------
    spin : magnitude of the spin relative to the water [rad/s]; the Stokes factor does not depend on it.
    d : diameter [m].
    nu : kinematic viscosity [m2/s].
    rho_w : density of water [kg/m3].

    Notes
    -----
    Source: Stokes limit, 8 pi mu R**3 = pi rho nu d**3. The spin decays with time constant rho_s R**2/(15
    mu).

    Examples
    --------
    >>> round(torque_stokes(1.0, 0.002, 1.0e-6, 1000.0) * 1e11, 4)
    2.5133
    """
    return math.pi * rho_w * nu * d * d * d


@step_law
def torque_dennis(spin: float, d: float, nu: float, rho_w: float) -> float:
    """Factor k [N m s] of the torque T = -k omega of the water on a spinning sphere, with fluid inertia.

    Parameters
    ----------
    spin : magnitude of the spin relative to the water [rad/s].
    d : diameter [m].
    nu : kinematic viscosity [m2/s].
    rho_w : density of water [kg/m3].

    Notes
    -----
    Source: Dennis, Singh & Ingham 1980, T = (1/2) rho R**5 C_R abs(spin) spin with
    C_R = 12.9/sqrt(Re_r) + 128.4/Re_r above Re_r = 32, and the Stokes limit 64 pi/Re_r below (the two agree
    within 0.2 % at 32). Fitted up to R**2 spin/nu = 1000: see `torque_in_range`.

    Examples
    --------
    >>> ratio = torque_dennis(900.0, 0.002, 1.0e-6, 1000.0) / torque_stokes(900.0, 0.002, 1.0e-6, 1000.0)
    >>> round(ratio, 2)
    4.49
    """
    re_r = reynolds_spin(spin, d, nu)
    if re_r <= 32.0:
        return torque_stokes(spin, d, nu, rho_w)
    r = 0.5 * d
    return 0.5 * rho_w * r * r * r * r * r * (12.9 / math.sqrt(re_r) + 128.4 / re_r) * abs(spin)


@law
def torque_in_range(spin: float, d: float, nu: float) -> bool:
    """Whether the spin is in the fitted range of `torque_dennis`, R**2 abs(spin)/nu <= 1000.

    Parameters
    ----------
    spin : spin relative to the water [rad/s].
    d : diameter [m].
    nu : kinematic viscosity [m2/s].

    Examples
    --------
    >>> torque_in_range(900.0, 0.002, 1.0e-6), torque_in_range(1100.0, 0.002, 1.0e-6)
    (True, False)
    """
    return reynolds_spin(spin, d, nu) <= 4000.0
