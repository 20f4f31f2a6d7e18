"""How long water at rest needs to come up to speed."""

import math

from ryusa.laws._law import law


@law
def spin_up_turbulent(speed: float, depth: float, u_star: float) -> float:
    """Time scale in which turbulent water at rest comes up to speed [s].

    Parameters
    ----------
    speed : mean over the depth in steady flow [m/s], > 0.
    depth : of the water above the bed [m], > 0.
    u_star : friction velocity in steady flow [m/s], > 0.

    Notes
    -----
    Momentum of the water averaged over the depth (the equation of Saint-Venant 1871 in uniform flow), dU/dt =
    u_star**2/h - c_f U**2/h with the friction of steady flow, c_f = (u_star/speed)**2, is solved by U =
    speed tanh(t/T) with T = speed h/u_star**2; that is speed/(g S) where the slope S drives. Near steady
    flow a difference from it decays with T/2.

    Examples
    --------
    >>> round(spin_up_turbulent(1.2, 0.02, 0.1), 6)
    2.4
    """
    return speed * depth / (u_star * u_star)


@law
def spin_up_laminar(depth: float, nu: float) -> float:
    """Time in which the slowest mode of viscous water on a bed falls by a factor e [s].

    Parameters
    ----------
    depth : of the water above the bed [m].
    nu : kinematic viscosity [m2/s], > 0.

    Notes
    -----
    Source: Carslaw & Jaeger 1959, diffusion in a slab with one insulated face: the modes n = 1, 3, 5... decay
    with 4 h**2/(n**2 pi**2 nu). From rest the mean speed lacks (96/pi**4) exp(-t/T) of its steady value
    once the first one is left.

    Examples
    --------
    >>> round(spin_up_laminar(0.01, 1.0e-5), 3)
    4.053
    """
    return 4.0 * depth * depth / (math.pi * math.pi * nu)
