"""Where two grains touch: Eq. (12), contact arms, the contact frame, the periodic wrap."""

import math

from ryusa.laws._law import law


@law
def overlap(r_i: float, r_j: float, distance: float) -> float:
    """How far two grains reach into each other [m]; positive in touch. Eq. (12), RS_ij.

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
    """Arm from a grain's centre to the contact point, which sits in the middle of the overlap [m].

    Parameters
    ----------
    r : radius [m].
    overlap : overlap of the pair [m].

    Notes
    -----
    The two arms of a pair add up to the distance of the centres, so the forces of a pair at this one point
    keep angular momentum to round-off. The d/2 of Eq. (7) is the limit of zero overlap.

    >>> arm(1.0e-3, 2.0e-5)
    0.00099
    """
    return r - 0.5 * overlap


@law
def wrap(step: float, period: float) -> float:
    """Shortest of the periodic images of a coordinate difference [m]; an infinite period leaves it as it is.

    Parameters
    ----------
    step : difference of two coordinates [m], at most one period and a half in size.
    period : period [m], inf where the direction is open.

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
    """Carry a tangential vector along as the contact frame turns; its length is kept.

    Parameters
    ----------
    s_x, s_y, s_z : tangential vector of the last step (spring force [N] or torque [N m]).
    n_x, n_y, n_z : unit normal now [-].
    twist : angle the pair turned about its normal within the step [rad], the mean spin of the two along n.

    Returns
    -------
    The vector, turned about n by `twist` and laid into the plane normal to n, with its old length.

    Notes
    -----
    Second order in the angle turned within a step. Source: Luding 2008, Granular Matter 10, 235, section 2.3
    (project and rescale), with the turn about the normal that keeps the law objective for a pair spinning as
    a whole.

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
