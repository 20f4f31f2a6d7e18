"""Walls: the nearest point of a face, and the motion of a wall."""

import math

from ryusa.laws._law import law


@law
def nearest_on_triangle(
    d_1: float, d_2: float, s_11: float, s_12: float, s_22: float
) -> tuple[float, float, float]:
    """Nearest point of a triangle, a + v e_1 + w e_2.

    Parameters
    ----------
    d_1, d_2 : products of the vector from corner a to the point with the edges e_1 and e_2 from a [m2].
    s_11, s_12, s_22 : products of the edges with each other [m2].

    Returns
    -------
    v, w : coordinates along the edges, each at least 0, their sum at most 1 [-].
    inside : 1 where the point lies over the face, 0 where its nearest point is on an edge or a corner [-].

    Notes
    -----
    Source: Ericson 2005, Real-Time Collision Detection, section 5.1.5 (Voronoi regions of a triangle).

    >>> nearest_on_triangle(0.25, 0.25, 1.0, 0.0, 1.0), nearest_on_triangle(2.0, -1.0, 1.0, 0.0, 1.0)
    ((0.25, 0.25, 1.0), (1.0, 0.0, 0.0))
    """
    d_3, d_4 = d_1 - s_11, d_2 - s_12
    d_5, d_6 = d_1 - s_12, d_2 - s_22
    v_a, v_b, v_c = d_3 * d_6 - d_5 * d_4, d_5 * d_2 - d_1 * d_6, d_1 * d_4 - d_3 * d_2
    total = v_a + v_b + v_c
    if v_a > 0.0 and v_b > 0.0 and v_c > 0.0:  # the usual one first
        return v_b / total, v_c / total, 1.0
    if d_1 <= 0.0 and d_2 <= 0.0:
        return 0.0, 0.0, 0.0
    if d_3 >= 0.0 and d_4 <= d_3:
        return 1.0, 0.0, 0.0
    if d_6 >= 0.0 and d_5 <= d_6:
        return 0.0, 1.0, 0.0
    if v_c <= 0.0 and d_1 >= 0.0 and d_3 <= 0.0:
        return d_1 / (d_1 - d_3), 0.0, 0.0
    if v_b <= 0.0 and d_2 >= 0.0 and d_6 <= 0.0:
        return 0.0, d_2 / (d_2 - d_6), 0.0
    along, back = d_4 - d_3, d_5 - d_6
    if v_a <= 0.0 and along >= 0.0 and back >= 0.0:
        w = along / (along + back)
        return 1.0 - w, w, 0.0
    return v_b / total, v_c / total, 1.0


@law
def nearest_on_disc(away: float, radius: float) -> float:
    """Factor that takes a vector in the plane of a disc, from its centre, to the nearest point of it [-].

    Parameters
    ----------
    away : length of the vector [m].
    radius : of the disc [m].

    >>> nearest_on_disc(0.5, 1.0), nearest_on_disc(4.0, 1.0)
    (1.0, 0.25)
    """
    return 1.0 if away <= radius else radius / away


@law
def nearest_on_cylinder(along: float, away: float, radius: float, length: float) -> tuple[float, float]:
    """Nearest point of the shell of a cylinder.

    Parameters
    ----------
    along : coordinate along the axis, from one end [m].
    away : distance from the axis, greater than 0 [m].
    radius, length : of the shell [m].

    Returns
    -------
    along : coordinate of the nearest point [m].
    factor : that takes the vector from the axis to the nearest point [-].

    >>> nearest_on_cylinder(3.0, 0.5, 1.0, 2.0)
    (2.0, 2.0)
    """
    return min(max(along, 0.0), length), radius / away


@law
def turned_about(
    x: float, y: float, z: float, a_x: float, a_y: float, a_z: float, angle: float
) -> tuple[float, float, float]:
    """A vector turned about a unit axis, right-handed [m].

    Parameters
    ----------
    x, y, z : vector [m].
    a_x, a_y, a_z : unit axis [-].
    angle : [rad].

    Notes
    -----
    Source: the formula of Rodrigues.

    >>> [round(one, 12) for one in turned_about(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, math.pi / 2.0)]
    [0.0, 1.0, 0.0]
    """
    c, s = math.cos(angle), math.sin(angle)
    along = (a_x * x + a_y * y + a_z * z) * (1.0 - c)
    return (
        c * x + s * (a_y * z - a_z * y) + along * a_x,
        c * y + s * (a_z * x - a_x * z) + along * a_y,
        c * z + s * (a_x * y - a_y * x) + along * a_z,
    )


@law
def swing(amplitude: float, rate: float, t: float, phase: float) -> float:
    """Displacement of an oscillating wall since t = 0 [m].

    Parameters
    ----------
    amplitude : half the stroke [m].
    rate : angular frequency [rad/s].
    t : time since the oscillation began [s].
    phase : at its beginning [rad].

    >>> round(swing(0.01, 2.0 * math.pi, 0.25, 0.0), 12)
    0.01
    """
    return amplitude * (math.sin(rate * t + phase) - math.sin(phase))


@law
def swing_speed(amplitude: float, rate: float, t: float, phase: float) -> float:
    """Speed of an oscillating wall, the derivative of `swing` [m/s].

    Parameters
    ----------
    amplitude, rate, t, phase : as in `swing`.

    >>> round(swing_speed(0.01, 2.0, 0.0, 0.0), 12)
    0.02
    """
    return amplitude * rate * math.cos(rate * t + phase)


@law
def servo_speed(
    asked: float, found: float, contacts: float, k_n: float, interval: float, most: float
) -> float:
    """Speed of a servo wall in its direction until the next correction [m/s].

    Parameters
    ----------
    asked, found : force on the grains in the direction of the servo [N].
    contacts : number of contacts of the wall for which it is made [-]; 0 for a wall that touches nothing.
    k_n : stiffness of one [N/m].
    interval : time from one correction to the next [s].
    most : largest speed [m/s]; a wall that touches nothing has it.

    Notes
    -----
    Itasca, PFC, wall servo: a wall on N contacts changes its force by N k_n per distance, and half of what is
    missing is made good in an interval. Grains that yield only make the wall slower. The speed must be linear
    in the force, with a number of contacts that does not follow it: else the mean force of a wall on moving
    grains, where the mean speed is zero, is not the one asked for (design/0019).

    >>> [round(servo_speed(10.0, found, 4.0, 1e4, 1e-3, 0.2), 9) for found in (8.0, 1e4, 0.0)]
    [0.025, -0.2, 0.125]
    >>> servo_speed(10.0, 0.0, 0.0, 1e4, 1e-3, 0.2)
    0.2
    """
    if contacts == 0.0:
        return most
    speed = 0.5 * (asked - found) / (max(contacts, 1.0) * k_n * interval)
    return most * max(min(speed / most, 1.0), -1.0)
