"""Volume, area and moments of a grain between two levels: profiles of concentration, spheres that overlap."""

import math

from ryusa.laws._law import law


@law
def sphere_slice(r: float, low: float, high: float) -> float:
    """Volume of a sphere between two horizontal planes [m3].

    Parameters
    ----------
    r : radius [m].
    low, high : heights of the planes above the centre [m]; limited to -r and r.

    Notes
    -----
    The integral of pi (r**2 - z**2), written as one product so that thin slices keep their digits. Adjoining
    slices add up to the sphere; the volume is negative if `high` is below `low`.

    >>> round(sphere_slice(1.0, -1.0, 1.0) / math.pi, 12)
    1.333333333333
    >>> round(sphere_slice(1.0, 0.5, 2.0) / math.pi, 12)  # a cap of height r/2: 5 pi r**3 / 24
    0.208333333333
    """
    a = min(max(low, -r), r)
    b = min(max(high, -r), r)
    return math.pi * (b - a) * (r * r - (a * a + a * b + b * b) / 3.0)


@law
def sphere_slice_moments(r: float, low: float, high: float) -> tuple[float, float, float]:
    """Moments of the part of a sphere between two parallel planes.

    Parameters
    ----------
    r : radius [m].
    low, high : places of the planes along their normal, from the centre [m]; limited to -r and r.

    Returns
    -------
    first : integral of z over the part, z along the normal from the centre [m4].
    along, across : integrals of z**2, and of the square of a coordinate in the planes [m5].

    Notes
    -----
    Integrals of pi z s, pi z**2 s and pi s**2/4 with s = r**2 - z**2. Adjoining slices add up to the sphere,
    whose second moments are both 4 pi r**5/15.

    >>> [round(one / math.pi, 12) for one in sphere_slice_moments(1.0, -1.0, 1.0)]
    [0.0, 0.266666666667, 0.266666666667]
    >>> [round(one / math.pi, 12) for one in sphere_slice_moments(1.0, 0.0, 1.0)]  # centroid of a half: 3 r/8
    [0.25, 0.133333333333, 0.133333333333]
    """
    a = min(max(low, -r), r)
    b = min(max(high, -r), r)
    rr, aa, bb, ab = r * r, a * a, b * b, a * b
    thick = math.pi * (b - a)
    cubic = (aa + ab + bb) / 3.0
    fifth = (aa * aa + bb * bb + ab * (aa + ab + bb)) / 5.0
    first = 0.25 * thick * (a + b) * (2.0 * rr - aa - bb)
    return first, thick * (rr * cubic - fifth), 0.25 * thick * (rr * (rr - 2.0 * cubic) + fifth)


@law
def circle_slice(r: float, low: float, high: float) -> float:
    """Area of a circle between two parallel lines [m2].

    Parameters
    ----------
    r : radius [m].
    low, high : heights of the lines above the centre [m]; limited to -r and r.

    Notes
    -----
    The integral of 2 sqrt(r**2 - z**2), for profiles of a plane scene.

    >>> round(circle_slice(1.0, -2.0, 2.0) / math.pi, 12)
    1.0
    >>> round(circle_slice(1.0, 0.0, 0.5), 12)  # sqrt(3)/4 + pi/6
    0.956611477491
    """
    a = min(max(low, -r), r)
    b = min(max(high, -r), r)
    h_a, h_b = math.sqrt((r - a) * (r + a)), math.sqrt((r - b) * (r + b))
    return b * h_b - a * h_a + r * r * (math.atan2(b, h_b) - math.atan2(a, h_a))
