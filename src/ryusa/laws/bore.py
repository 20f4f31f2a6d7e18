"""The bore that a wall reflects, and the hydraulic jump."""

import math

from ryusa.laws._law import law


@law
def reflected_bore(u: float, h: float, g: float) -> tuple[float, float]:
    """Depth behind the bore that a wall reflects [m], and the speed with which it goes upstream [m/s].

    Parameters
    ----------
    u, h : speed [m/s] and depth [m] of the flow that comes.
    g : gravity [m/s2].

    Notes
    -----
    One layer of one fluid with hydrostatic pressure on a level bottom without friction: volume h (u + a) =
    a h_r, momentum g (h_r**2 - h**2)/2 = h u (u + a). So (r**2 - 1)(r - 1) = 2 Fr**2 r with r = h_r/h, whose
    root above 1 is found here as that of a cubic equation with three real ones, and a wall bears
    rho g h_r**2/2 per width. The form that Armanini, Larcher & Odorizzi 2011 give for the reflection of
    debris flows (abstract read), derived here.

    Examples
    --------
    >>> [round(one, 6) for one in reflected_bore(math.sqrt(8.0 / 3.0 * 9.8 * 0.1), 0.1, 9.8)]  # r = 3
    [0.3, 0.80829]
    """
    twice = 2.0 * u * u / (g * h)
    p, q = -(4.0 / 3.0 + twice), 16.0 / 27.0 - twice / 3.0  # r = y + 1/3: y**3 + p y + q = 0
    largest = 2.0 * math.sqrt(-p / 3.0)
    r = 1.0 / 3.0 + largest * math.cos(math.acos(max(3.0 * q / (p * largest), -1.0)) / 3.0)
    return r * h, math.sqrt(0.5 * g * h * (r + 1.0) / r)


@law
def conjugate_depth(h: float, froude: float) -> float:
    """Depth behind a hydraulic jump of flow of depth h [m], h/2 (sqrt(1 + 8 Fr^2) - 1) (Belanger 1828).

    >>> round(conjugate_depth(0.0233, 2.70), 3)
    0.078
    """
    return 0.5 * h * (math.sqrt(1.0 + 8.0 * froude**2) - 1.0)
