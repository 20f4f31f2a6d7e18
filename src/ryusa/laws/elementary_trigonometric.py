"""Sine, cosine and arctangent of a square root, without branch, table or library call (elementary.py).

Sine and cosine of the root of z have power series in z. The same series are the hyperbolic functions of the
root of -z: no case has to be told from another, and nothing is special about z = 0.
"""

import math

from ryusa.laws._law import step_law


@step_law
def cosine_of_root(z: float) -> float:
    """cos(sqrt(z)) [-]; cosh(sqrt(-z)) for negative z.

    Parameters
    ----------
    z : square of the angle [rad2], at most 2 in magnitude.

    Notes
    -----
    Source: Taylor series to z**10, truncated below 2e-18 at the ends of the range, 4e-15 at twice them.

    >>> round(cosine_of_root(1.0), 15), round(cosine_of_root(-1.0), 15)
    (0.54030230586814, 1.543080634815244)
    """
    tail = 1.0 / 6402373705728000.0 - z * (1.0 / 2432902008176640000.0)
    tail = 1.0 / 87178291200.0 - z * (1.0 / 20922789888000.0 - z * tail)
    tail = 1.0 / 3628800.0 - z * (1.0 / 479001600.0 - z * tail)
    tail = 1.0 / 720.0 - z * (1.0 / 40320.0 - z * tail)
    return 1.0 - z * (0.5 - z * (1.0 / 24.0 - z * tail))


@step_law
def sine_of_root(z: float) -> float:
    """sin(sqrt(z))/sqrt(z) [-]; sinh(sqrt(-z))/sqrt(-z) for negative z, 1 at 0.

    Parameters
    ----------
    z : square of the angle [rad2], at most 2 in magnitude.

    Notes
    -----
    Source: Taylor series to z**10, truncated below 1e-19 at the ends of the range, 2e-16 at twice them.

    >>> round(sine_of_root(1.0), 15), sine_of_root(0.0), round(sine_of_root(-1.0), 15)
    (0.841470984807897, 1.0, 1.175201193643801)
    """
    tail = 1.0 / 121645100408832000.0 - z * (1.0 / 51090942171709440000.0)
    tail = 1.0 / 1307674368000.0 - z * (1.0 / 355687428096000.0 - z * tail)
    tail = 1.0 / 39916800.0 - z * (1.0 / 6227020800.0 - z * tail)
    tail = 1.0 / 5040.0 - z * (1.0 / 362880.0 - z * tail)
    return 1.0 - z * (1.0 / 6.0 - z * (1.0 / 120.0 - z * tail))


@step_law
def arctan_of_root(u: float) -> float:
    """atan(sqrt(u))/sqrt(u) [-]; atanh(sqrt(-u))/sqrt(-u) for negative u, 1 at 0.

    Parameters
    ----------
    u : square of the tangent [-], at most 0.04 in magnitude: angles to pi/16.

    Notes
    -----
    Source: Taylor series to u**10, truncated below 2e-17.

    >>> round(arctan_of_root(0.04), 15) == round(math.atan(0.2) / 0.2, 15)
    True
    """
    tail = 1.0 / 17.0 - u * (1.0 / 19.0 - u * (1.0 / 21.0))
    tail = 1.0 / 13.0 - u * (1.0 / 15.0 - u * tail)
    tail = 1.0 / 9.0 - u * (1.0 / 11.0 - u * tail)
    tail = 1.0 / 5.0 - u * (1.0 / 7.0 - u * tail)
    return 1.0 - u * (1.0 / 3.0 - u * tail)


@step_law
def half_angle(tangent: float, q: float) -> float:
    """tan(w t/2)/w [s] from tan(w t)/w [s], with w**2 = q [1/s2]; tanh for negative q.

    >>> half_angle(1.0, 0.0), round(half_angle(1.0, 1.0) - math.tan(math.pi / 8.0), 15)
    (0.5, 0.0)
    """
    return tangent / (1.0 + math.sqrt(max(1.0 + q * tangent * tangent, 0.0)))
