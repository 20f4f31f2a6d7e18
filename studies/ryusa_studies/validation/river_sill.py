"""A thin plate and a drop within a row of columns, with air below their nappe (design/0030).

The limits were written down before any nappe was run: 3 % of the discharge and 5 % of the landing place were
asked for; those of the pool and of the jet behind a drop allow for a pool without eddies and for cells of a
third of the jet's depth.
"""

import math

from ryusa.study import at_most

DISCHARGE = at_most(0.03, "3 % of Rehbock's formula, for a plate within the row")
LANDING = at_most(0.05, "5 % of the way from the plate to where the middle of the measured nappe lands")
POOL = at_most(0.20, "20 % of the depth that Rand 1955 measured below the nappe of a drop")
JET = at_most(0.15, "15 % of the depth that Rand 1955 measured of the jet along the floor behind a drop")


def reach_of_nappe(fall: float, head: float, velocity_head: float) -> float:
    """Way from a sharp crest to where the middle of its nappe is `fall` below the crest [m].

    Parameters
    ----------
    fall : below the crest [m].
    head : energy head of the flow over the crest [m].
    velocity_head : the part of it that is u**2/(2 g) in the approach [m].

    Notes
    -----
    Blaisdell 1954 (as Chow 1959, Eqs. 14-2 to 14-6), lower and upper face: y/H = A (x/H)**2 + B x/H + C, and
    D more; for x above H/2. The lower one is that of the profile of the WES within 1 % of H up to 1.5 H.
    """
    v = velocity_head / head
    a = -0.425 + 0.25 * v
    b = 0.411 - 1.603 * v - math.sqrt(1.568 * v**2 - 0.892 * v + 0.127)
    m = 10.0 * (v - 0.208)
    c, d = 0.150 - 0.45 * v, 0.57 - 0.02 * m**2 * math.exp(m)
    rest = c + 0.5 * d + fall / head
    return head * (-b - math.sqrt(b * b - 4.0 * a * rest)) / (2.0 * a)


def drop_of_rand(q: float, high: float, g: float) -> tuple[float, float, float]:
    """Depths of the pool below the nappe of a drop and of the jet behind it, and its length [m].

    Parameters
    ----------
    q : discharge [m2/s].
    high : of the drop [m].
    g : gravity [m/s2].

    Notes
    -----
    Rand 1955, Flow geometry at straight drop spillways, by the drop number q**2/(g high**3).
    """
    number = q * q / (g * high**3)
    return 1.00 * number**0.22 * high, 0.54 * number**0.425 * high, 4.30 * number**0.27 * high
