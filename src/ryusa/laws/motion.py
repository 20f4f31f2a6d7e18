"""Equations of motion of one grain, Eqs. (5)-(7) and (10)-(11), and their time integration."""

from ryusa.laws._law import law


@law
def inertia_sphere(m: float, d: float) -> float:
    """Moment of inertia of a sphere [kg m2], m d**2/10. Eq. (7); m [kg] without added mass, d [m].

    Examples
    --------
    >>> round(inertia_sphere(10.0, 2.0), 12)
    4.0
    """
    return 0.1 * m * d * d


@law
def acceleration(contact: float, drag: float, weight: float, inverse_m: float) -> float:
    """One component of the acceleration of a grain [m/s2].

    Parameters
    ----------
    contact : sum of contact forces on the grain [N]; Eqs. (5)-(6).
    drag : drag force [N], zero in air; Eqs. (10)-(11).
    weight : submerged weight, submerged mass times the component of gravity [N].
    inverse_m : inverse of the sum of mass and added mass [1/kg]; stored, because a division in every step is
        slow.

    Notes
    -----
    Source: the paper, Eqs. (5)-(6) in air and (10)-(11) in water, where
    rho (sigma/rho + C_M) A_3 d**3 is m + m_added.

    Examples
    --------
    >>> acceleration(3.0, 1.0, -2.0, 0.5)
    1.0
    """
    return (contact + drag + weight) * inverse_m


@law
def acceleration_spin(torque: float, inverse_inertia: float) -> float:
    """One component of the angular acceleration of a grain [rad/s2]. Eq. (7).

    Parameters
    ----------
    torque : torque on the grain [N m].
    inverse_inertia : inverse of the moment of inertia [1/(kg m2)].

    Examples
    --------
    >>> acceleration_spin(3.0, 0.5)
    1.5
    """
    return torque * inverse_inertia


@law
def semi_implicit(x: float, v: float, a: float, dt: float) -> tuple[float, float]:
    """One step of the scheme of ryusa: first the velocity, then the position with the new velocity.

    Parameters
    ----------
    x : position [m] (or angle [rad]).
    v : velocity [m/s], half a step before x.
    a : acceleration at x [m/s2].
    dt : time step [s].

    Returns
    -------
    x, v : position and velocity one step later [m], [m/s].

    Notes
    -----
    Symplectic Euler, the same as leapfrog with v shifted by half a step. Stable in a linear contact for
    omega_0 dt <= 2 (sqrt(1 + zeta**2) - zeta).

    Examples
    --------
    >>> semi_implicit(0.0, 1.0, 2.0, 0.5)
    (1.0, 2.0)
    """
    v = v + a * dt
    return x + v * dt, v


@law
def forward_euler(x: float, v: float, a: float, dt: float) -> tuple[float, float]:
    """One step of forward Euler, kept only for the study of the time step.

    Parameters
    ----------
    x, v, a, dt : as in `semi_implicit` [m, m/s, m/s2, s], but v and x belong to the same time.

    Notes
    -----
    It adds energy to every contact: with e = 0.7 in the case, the restitution exceeds 1 at ten steps per
    contact.

    Examples
    --------
    >>> forward_euler(0.0, 1.0, 2.0, 0.5)
    (0.5, 2.0)
    """
    return x + v * dt, v + a * dt
