"""Rotation of a rigid body: orientation as a quaternion, and a symplectic step.

The orientation is a unit quaternion (q_w, q_x, q_y, q_z) that turns the body frame into space; the body frame
is that of the principal axes, numbered 1, 2, 3. The angular momentum is kept in space, where a torque changes
it as a force changes a momentum, and no torque leaves it alone to the bit.
"""

import math

from ryusa.laws._law import step_law
from ryusa.laws.elementary_trigonometric import cosine_of_root, sine_of_root


@step_law
def rotate(
    x: float, y: float, z: float, q_w: float, q_x: float, q_y: float, q_z: float
) -> tuple[float, float, float]:
    """Turn a vector from the body frame into space.

    Parameters
    ----------
    x, y, z : components in the body frame, here of an arm [m].
    q_w, q_x, q_y, q_z : orientation, a unit quaternion [-].

    Notes
    -----
    v + 2 q_w (q x v) + 2 q x (q x v).

    >>> rotate(1.0, 2.0, 3.0, 0.5, 0.5, 0.5, 0.5)  # a third of a turn about the diagonal
    (3.0, 1.0, 2.0)
    """
    t_x, t_y, t_z = 2.0 * (q_y * z - q_z * y), 2.0 * (q_z * x - q_x * z), 2.0 * (q_x * y - q_y * x)
    return (
        x + q_w * t_x + (q_y * t_z - q_z * t_y),
        y + q_w * t_y + (q_z * t_x - q_x * t_z),
        z + q_w * t_z + (q_x * t_y - q_y * t_x),
    )


@step_law
def rotate_back(
    x: float, y: float, z: float, q_w: float, q_x: float, q_y: float, q_z: float
) -> tuple[float, float, float]:
    """Turn a vector from space into the body frame; inverse of `rotate`.

    Parameters
    ----------
    x, y, z : components in space, here of an arm [m].
    q_w, q_x, q_y, q_z : orientation, a unit quaternion [-].

    >>> rotate_back(3.0, 1.0, 2.0, 0.5, 0.5, 0.5, 0.5)
    (1.0, 2.0, 3.0)
    """
    return rotate(x, y, z, q_w, -q_x, -q_y, -q_z)


@step_law
def turn_about_first(
    q_w: float,
    q_a: float,
    q_b: float,
    q_c: float,
    l_a: float,
    l_b: float,
    l_c: float,
    over: float,
    dt: float,
) -> tuple[float, float, float, float, float, float]:
    """Exact motion of a body whose kinetic energy is that about axis a alone.

    Parameters
    ----------
    q_w, q_a, q_b, q_c : orientation [-]; axes a, b, c are the three axes in cyclic order.
    l_a, l_b, l_c : angular momentum in the body frame [N m s].
    over : 1 over the moment of inertia about a [1/(kg m2)].
    dt : time [s].

    Returns
    -------
    q_w, q_a, q_b, q_c : orientation after dt [-].
    l_b, l_c : angular momentum after dt; l_a does not change [N m s].

    Notes
    -----
    Source: Miller et al. 2002, J. Chem. Phys. 116, 8649: a rotation about a by the angle l_a dt/I_a. Its sine
    and cosine are series that are exact to round-off up to 2.8 rad, and to 4e-15 up to 4 rad.

    >>> q_w, q_a, q_b, q_c, l_b, l_c = turn_about_first(1.0, 0.0, 0.0, 0.0, math.pi, 1.0, 0.0, 0.5, 1.0)
    >>> round(q_w, 9), round(q_a, 9), round(l_b, 9), round(l_c, 9)  # a quarter of a turn
    (0.707106781, 0.707106781, 0.0, -1.0)
    """
    half = 0.5 * (l_a * over * dt)
    c, s = cosine_of_root(half * half), half * sine_of_root(half * half)
    c_l, s_l = (c - s) * (c + s), 2.0 * c * s
    return (
        c * q_w - s * q_a,
        c * q_a + s * q_w,
        c * q_b + s * q_c,
        c * q_c - s * q_b,
        c_l * l_b + s_l * l_c,
        c_l * l_c - s_l * l_b,
    )


@step_law
def rotor_step(
    q_w: float,
    q_x: float,
    q_y: float,
    q_z: float,
    l_x: float,
    l_y: float,
    l_z: float,
    over_1: float,
    over_2: float,
    over_3: float,
    dt: float,
) -> tuple[float, float, float, float, float, float, float]:
    """Orientation of a rigid body after a step without torque [-], and the angular momentum in its frame.

    Parameters
    ----------
    q_w, q_x, q_y, q_z : orientation at first, a unit quaternion [-].
    l_x, l_y, l_z : angular momentum in space, which no step changes [N m s].
    over_1, over_2, over_3 : 1 over the principal moments of inertia [1/(kg m2)].
    dt : time step [s].

    Notes
    -----
    Source: NO_SQUISH, Miller et al. 2002, J. Chem. Phys. 116, 8649, as read in LAMMPS (fix rigid/nve): exact
    turns about axes 3, 2, 1, 2, 3 by half, half, a whole, half and half a step; symplectic, reversible, of
    second order. Here with the angular momentum in place of the momenta conjugate to the quaternion: the
    same map. It keeps the angular momentum; its error in the energy stays bounded, and is none where all
    moments are equal. The quaternion is brought back to length 1, against round-off alone.

    >>> [round(one, 9) for one in rotor_step(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, math.pi, 1.0, 0.7, 0.5, 1.0)[:4]]
    [0.707106781, 0.0, 0.0, 0.707106781]
    """
    a, b, c = rotate_back(l_x, l_y, l_z, q_w, q_x, q_y, q_z)
    half = 0.5 * dt
    q_w, q_z, q_x, q_y, a, b = turn_about_first(q_w, q_z, q_x, q_y, c, a, b, over_3, half)
    q_w, q_y, q_z, q_x, c, a = turn_about_first(q_w, q_y, q_z, q_x, b, c, a, over_2, half)
    q_w, q_x, q_y, q_z, b, c = turn_about_first(q_w, q_x, q_y, q_z, a, b, c, over_1, dt)
    q_w, q_y, q_z, q_x, c, a = turn_about_first(q_w, q_y, q_z, q_x, b, c, a, over_2, half)
    q_w, q_z, q_x, q_y, a, b = turn_about_first(q_w, q_z, q_x, q_y, c, a, b, over_3, half)
    scale = 1.0 / math.sqrt(q_w * q_w + q_x * q_x + q_y * q_y + q_z * q_z)
    return q_w * scale, q_x * scale, q_y * scale, q_z * scale, a, b, c


@step_law
def spin(
    q_w: float,
    q_x: float,
    q_y: float,
    q_z: float,
    l_x: float,
    l_y: float,
    l_z: float,
    over_1: float,
    over_2: float,
    over_3: float,
) -> tuple[float, float, float]:
    """Spin of a rigid body, in space [rad/s].

    Parameters
    ----------
    q_w, q_x, q_y, q_z : orientation, a unit quaternion [-].
    l_x, l_y, l_z : angular momentum in space [N m s].
    over_1, over_2, over_3 : 1 over the principal moments of inertia [1/(kg m2)].

    >>> spin(1.0, 0.0, 0.0, 0.0, 2.0, 3.0, 4.0, 0.5, 1.0, 0.25)
    (1.0, 3.0, 1.0)
    """
    a, b, c = rotate_back(l_x, l_y, l_z, q_w, q_x, q_y, q_z)
    return rotate(over_1 * a, over_2 * b, over_3 * c, q_w, q_x, q_y, q_z)


@step_law
def angular_momentum(
    q_w: float,
    q_x: float,
    q_y: float,
    q_z: float,
    omega_x: float,
    omega_y: float,
    omega_z: float,
    inertia_1: float,
    inertia_2: float,
    inertia_3: float,
) -> tuple[float, float, float]:
    """Angular momentum of a rigid body, in space [N m s]; inverse of `spin`.

    Parameters
    ----------
    q_w, q_x, q_y, q_z : orientation, a unit quaternion [-].
    omega_x, omega_y, omega_z : spin in space [rad/s].
    inertia_1, inertia_2, inertia_3 : principal moments of inertia [kg m2].

    >>> angular_momentum(1.0, 0.0, 0.0, 0.0, 1.0, 3.0, 1.0, 2.0, 1.0, 4.0)
    (2.0, 3.0, 4.0)
    """
    a, b, c = rotate_back(omega_x, omega_y, omega_z, q_w, q_x, q_y, q_z)
    return rotate(inertia_1 * a, inertia_2 * b, inertia_3 * c, q_w, q_x, q_y, q_z)


@step_law
def rotational_energy(
    q_w: float,
    q_x: float,
    q_y: float,
    q_z: float,
    l_x: float,
    l_y: float,
    l_z: float,
    over_1: float,
    over_2: float,
    over_3: float,
) -> float:
    """Kinetic energy of the rotation of a rigid body [J].

    Parameters
    ----------
    q_w, q_x, q_y, q_z : orientation, a unit quaternion [-].
    l_x, l_y, l_z : angular momentum in space [N m s].
    over_1, over_2, over_3 : 1 over the principal moments of inertia [1/(kg m2)].

    >>> rotational_energy(1.0, 0.0, 0.0, 0.0, 2.0, 3.0, 4.0, 0.5, 1.0, 0.25)
    7.5
    """
    a, b, c = rotate_back(l_x, l_y, l_z, q_w, q_x, q_y, q_z)
    return 0.5 * (over_1 * a * a + over_2 * b * b + over_3 * c * c)
