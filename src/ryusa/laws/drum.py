"""Drums that turn about a level axis."""

import math

from ryusa.laws._law import law


@law
def critical_rate(radius: float, d: float, g: float) -> float:
    """Angular velocity of a drum from which a grain stays on its shell all round [rad/s].

    Parameters
    ----------
    radius : of the drum [m].
    d : diameter of the grain [m], below twice the radius.
    g : gravity [m/s2].

    Notes
    -----
    At the top the centrifugal force at radius - d/2 is the weight: omega**2 (radius - d/2) = g. With
    g = 9.81 m/s2 that is 42.3/sqrt(D - d) revolutions a minute, the critical speed of ball mills.

    Examples
    --------
    >>> rate = critical_rate(0.5, 0.0, 9.81)
    >>> round(rate * 60.0 / (2.0 * math.pi), 1)
    42.3
    """
    return math.sqrt(g / (radius - 0.5 * d))
