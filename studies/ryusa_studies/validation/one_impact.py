"""One elastic impact on a plane, integrated apart from the engine, with any tangential stiffness."""

import math

from ryusa.laws import hertz


def rebound(
    young: float, nu: float, rho: float, r: float, v_n: float, v_t: float, mu: float, share: float, steps: int
) -> tuple[float, float, float]:
    """Velocity along and away from the plane [m/s], and spin [rad/s], after an impact without dashpots.

    Normal force of Hertz; tangential force by increments k_t ds, k_t = `share` of Mindlin's at the overlap of
    the moment, cut down to mu times the normal force, on the arm r less the overlap; semi-implicit Euler.

    Parameters
    ----------
    young, nu, rho, r : Young's modulus [Pa], Poisson's ratio [-], density [kg/m3], radius [m].
    v_n, v_t : approach to the plane and velocity along it [m/s], without spin.
    steps : in Hertz's contact time.

    >>> x, z, w = rebound(1e9, 0.3, 2000.0, 1e-3, 1.0, 0.1, 0.0, 1.0, 1000)  # without friction
    >>> round(x, 6), round(z, 3), w
    (0.1, 1.0, 0.0)
    """
    m = rho * 4.0 / 3.0 * math.pi * r**3
    modulus = hertz.effective_modulus(2.0 * young, nu)  # of a sphere and a rigid plane
    stiff = hertz.hertz_stiffness(modulus, r)
    ratio = share * hertz.mindlin_ratio(nu)
    dt = hertz.contact_time_hertz(v_n, m, stiff, 0.0, True) / steps
    along, away, spin, overlap, force = v_t, -v_n, 0.0, 0.0, 0.0
    while (overlap := overlap - away * dt) > 0.0:
        normal = stiff * overlap**1.5
        force -= ratio * stiff * math.sqrt(overlap) * (along - spin * (r - overlap)) * dt
        force = math.copysign(min(abs(force), mu * normal), force)
        along, away = along + force / m * dt, away + normal / m * dt
        spin -= 2.5 * force * (r - overlap) / (m * r * r) * dt
    return along, away, spin
