"""How much of a grain lies between two levels: what a concentration over height is made of."""

import math

from ryusa.laws._law import law


@law
def sphere_slice(r: float, low: float, high: float) -> float:
    """Volume of a sphere between two horizontal planes [m3]; heights are taken from its centre.

    Parameters
    ----------
    r : radius [m].
    low, high : heights of the planes above the centre [m]; beyond the sphere they count as its pole.

    Notes
    -----
    The integral of pi (r**2 - z**2), written as one product so that thin slices lose no digits. Slices that
    follow one another add up to the sphere; where `high` is below `low` the volume is negative.

    >>> round(sphere_slice(1.0, -1.0, 1.0) / math.pi, 12)
    1.333333333333
    >>> round(sphere_slice(1.0, 0.5, 2.0) / math.pi, 12)  # a cap of height r/2: 5 pi r**3 / 24
    0.208333333333
    """
    a = min(max(low, -r), r)
    b = min(max(high, -r), r)
    return math.pi * (b - a) * (r * r - (a * a + a * b + b * b) / 3.0)


@law
def circle_slice(r: float, low: float, high: float) -> float:
    """Area of a circle between two parallel lines [m2]; heights are taken from its centre.

    Parameters
    ----------
    r : radius [m].
    low, high : heights of the lines above the centre [m]; beyond the circle they count as its pole.

    Notes
    -----
    The integral of 2 sqrt(r**2 - z**2): a plane scene seen from the side.

    >>> round(circle_slice(1.0, -2.0, 2.0) / math.pi, 12)
    1.0
    >>> round(circle_slice(1.0, 0.0, 0.5), 12)  # sqrt(3)/4 + pi/6
    0.956611477491
    """
    a = min(max(low, -r), r)
    b = min(max(high, -r), r)
    h_a, h_b = math.sqrt((r - a) * (r + a)), math.sqrt((r - b) * (r + b))
    return b * h_b - a * h_a + r * r * (math.atan2(b, h_b) - math.atan2(a, h_a))
