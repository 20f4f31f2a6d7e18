"""One grain, one time step: the scheme, and the work and the impulse of the forces on the grain.

Every engine calls these functions. Those of the scheme are written for one component; an engine may pass all
components as one vector. At x(n) the velocity is v(n-1/2), and the step ends with v(n+1/2): a force acts over
the second half of one velocity interval and the first half of the next.
"""

from ryusa.laws._law import step_law
from ryusa.laws.motion import acceleration, acceleration_spin, semi_implicit


@step_law
def translation_step(
    x: float, v: float, force: float, drag: float, weight: float, inverse_m: float, dt: float
) -> tuple[float, float]:
    """Advance one component of position and velocity by a step.

    Parameters
    ----------
    x : position at step n [m].
    v : velocity at n - 1/2 [m/s].
    force : sum of the forces of contacts, lift, flow and films [N].
    drag : drag of the water [N].
    weight : submerged weight [N].
    inverse_m : inverse of the sum of mass and added mass [1/kg].
    dt : time step [s].

    Returns
    -------
    x, v : position at n + 1 [m], velocity at n + 1/2 [m/s].

    Notes
    -----
    Source: the paper, Eqs. (5)-(6) in air and (10)-(11) in water, with the scheme of `motion.semi_implicit`.

    >>> translation_step(0.0, 1.0, 3.0, 1.0, -2.0, 0.5, 0.5)
    (0.75, 1.5)
    """
    return semi_implicit(x, v, acceleration(force, drag, weight, inverse_m), dt)


@step_law
def rotation_step(w: float, torque: float, inverse_inertia: float, dt: float) -> float:
    """Advance one component of the spin by a step [rad/s]. Eq. (7).

    Parameters
    ----------
    w : spin at n - 1/2 [rad/s].
    torque : sum of the torques of contacts and of the water [N m].
    inverse_inertia : inverse of the moment of inertia [1/(kg m2)].
    dt : time step [s].

    >>> rotation_step(1.0, 3.0, 0.5, 0.5)
    1.75
    """
    return w + dt * acceleration_spin(torque, inverse_inertia)


@step_law
def resisted_torque(torque: float, k_t: float, w: float) -> float:
    """One component of the torque on a grain with the resistance of the water [N m].

    Parameters
    ----------
    torque : torque of contacts [N m].
    k_t : torque of the water over spin (`torque.torque_stokes`) [N m s].
    w : spin of the grain minus that of the water [rad/s].

    >>> resisted_torque(3.0, 0.5, 2.0)
    2.0
    """
    return torque - k_t * w


@step_law
def flow_force(extra: float, added: float, a_water: float) -> float:
    """One component of the force of an accelerating flow on a grain, free or fixed [N].

    Parameters
    ----------
    extra : force of pressure gradient and stress, beyond the buoyancy of still water [N].
    added : added mass of the grain [kg].
    a_water : acceleration of the water [m/s2].

    >>> flow_force(1.0, 0.5, 2.0)
    2.0
    """
    return extra + added * a_water


@step_law
def impulse_from_fluid(
    drag: float, lift: float, added: float, a_water: float, v: float, v_new: float, dt: float
) -> float:
    """One component of the impulse that a grain received from the water in a step [N s].

    Parameters
    ----------
    drag, lift : forces of the water [N].
    added : added mass of the grain [kg]; its momentum is part of the momentum of the grain, not of the water.
    a_water : acceleration of the water [m/s2].
    v, v_new : velocity of the grain before and after the step [m/s].
    dt : time step [s].

    >>> impulse_from_fluid(3.0, 1.0, 0.5, 2.0, 1.0, 2.0, 0.5)
    2.0
    """
    return dt * (drag + lift + added * a_water) - added * (v_new - v)


@step_law
def work_of_force(before: float, after: float, f: float, v: float, v_new: float) -> tuple[float, float]:
    """Work of one component of a force over the half interval before x(n), and over the one after it [J].

    Parameters
    ----------
    before, after : durations of the two half intervals [s]; the first is 0 in the first step of a run.
    f : force [N].
    v, v_new : velocity before and after the step [m/s].

    >>> work_of_force(0.5, 0.25, 3.0, 2.0, 4.0)
    (3.0, 3.0)
    """
    return before * (f * v), after * (f * v_new)


@step_law
def kinetic_energy(m: float, v_x: float, v_y: float, v_z: float, u_x: float, u_y: float, u_z: float) -> float:
    """Kinetic energy at x(n) that is consistent with the work by velocity interval [J].

    Parameters
    ----------
    m : mass and added mass [kg]; for the energy of rotation the moment of inertia [kg m2], with spins.
    v_x, v_y, v_z, u_x, u_y, u_z : velocity before and after the step [m/s].

    >>> kinetic_energy(2.0, 1.0, 0.0, 1.0, 3.0, 0.0, 1.0)
    4.0
    """
    return 0.5 * m * (v_x * u_x + v_y * u_y + v_z * u_z)


@step_law
def unwrapped(x: float, image: float, period: float) -> float:
    """Coordinate of a grain without periodic wrapping [m].

    Parameters
    ----------
    x : coordinate within the period [m].
    image : number of periods crossed [-].
    period : period [m]; inf, with `image` 0, if the direction is not periodic.

    >>> unwrapped(0.5, 2.0, 1.0), unwrapped(0.5, 0.0, float("inf"))
    (2.5, 0.5)
    """
    return x + image * period if image != 0.0 else x


@step_law
def potential_energy(m: float, g_x: float, g_y: float, g_z: float, x: float, y: float, z: float) -> float:
    """Potential energy of the submerged weight [J].

    Parameters
    ----------
    m : submerged mass [kg].
    g_x, g_y, g_z : gravity [m/s2].
    x, y, z : centre of the grain, `unwrapped` [m].

    >>> potential_energy(2.0, 0.0, 0.0, -9.5, 1.0, 1.0, 2.0)
    38.0
    """
    return -m * (g_x * x + g_y * y + g_z * z)
