"""Geometry of a contact: overlap (Eq. (12)), arms, rotation of the contact frame, periodic images."""

import math

from ryusa.laws._law import law


@law
def overlap(r_i: float, r_j: float, distance: float) -> float:
    """Overlap of two grains [m]; positive in touch. Eq. (12), RS_ij.

    Parameters
    ----------
    r_i, r_j : radii of the two grains [m].
    distance : distance of their centres [m].

    Notes
    -----
    Source: the paper, Eq. (12).

    >>> overlap(1.0e-3, 1.0e-3, 1.5e-3)
    0.0005
    """
    return (r_i + r_j) - distance


@law
def arm(r: float, overlap: float) -> float:
    """Arm from the centre of a grain to the contact point, which is in the middle of the overlap [m].

    Parameters
    ----------
    r : radius [m].
    overlap : overlap of the pair [m].

    Notes
    -----
    The two arms of a pair add up to the distance of the centres. Both forces of the pair act at this point,
    which conserves angular momentum to round-off. The d/2 of Eq. (7) is the limit of zero overlap.

    >>> arm(1.0e-3, 2.0e-5)
    0.00099
    """
    return r - 0.5 * overlap


@law
def wrap(step: float, period: float) -> float:
    """Shortest periodic image of a coordinate difference [m]; unchanged if the period is infinite.

    Parameters
    ----------
    step : difference of two coordinates [m], at most one and a half periods in magnitude.
    period : period [m], inf if the direction is not periodic.

    >>> wrap(0.9, 1.0), wrap(-0.9, 1.0), wrap(0.9, float("inf"))
    (-0.09999999999999998, 0.09999999999999998, 0.9)
    """
    half = 0.5 * period
    if step > half:
        return step - period
    if step < -half:
        return step + period
    return step


@law
def turn(
    s_x: float, s_y: float, s_z: float, n_x: float, n_y: float, n_z: float, twist: float
) -> tuple[float, float, float]:
    """Rotate a tangential vector with the contact frame, keeping its length.

    Parameters
    ----------
    s_x, s_y, s_z : tangential vector of the previous step (spring force [N] or torque [N m]).
    n_x, n_y, n_z : present unit normal [-].
    twist : rotation of the pair about its normal during the step [rad]: mean spin of the two along n, times
        dt.

    Returns
    -------
    The vector, rotated about n by `twist` and projected onto the plane normal to n, with its old length.

    Notes
    -----
    Second order in the angle of rotation per step. Source: Luding 2008, Granular Matter 10, 235, section 2.3
    (projection and rescaling), with the rotation about the normal, without which the law would not be
    objective for a pair that spins as a whole.

    >>> turn(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    (1.0, 0.0, 0.0)
    """
    old = s_x * s_x + s_y * s_y + s_z * s_z
    if old == 0.0:
        return 0.0, 0.0, 0.0
    t_x = s_x + twist * (n_y * s_z - n_z * s_y)
    t_y = s_y + twist * (n_z * s_x - n_x * s_z)
    t_z = s_z + twist * (n_x * s_y - n_y * s_x)
    along = t_x * n_x + t_y * n_y + t_z * n_z
    t_x -= along * n_x
    t_y -= along * n_y
    t_z -= along * n_z
    new = t_x * t_x + t_y * t_y + t_z * t_z
    if new == 0.0:
        return 0.0, 0.0, 0.0
    scale = math.sqrt(old / new)
    return scale * t_x, scale * t_y, scale * t_z
