"""Depths of water that is held up: backwater, jumps and bores, and the level of a closed basin."""

import math
from functools import lru_cache

import numpy as np

from ryusa.laws import turbulence, water
from ryusa.model.arrays import Floats

MOST_STATIONS = 400  # of a backwater


def backwater(
    up: Floats, dx: float, q: float, below: float, critical: float, g: float, rough: float, nu: float
) -> Floats:
    """Depths of the steady flow of a discharge, as if all of it were subcritical [m], shape (n,).

    Parameters
    ----------
    up : heights of the bed over a level line, from upstream to downstream [m], shape (n,).
    dx : distance of two of them [m].
    q, critical : discharge per width [m2/s] and its critical depth [m].
    below : height of the surface beyond the lower end over that line [m]; -inf below a fall.
    g, rough, nu : gravity [m/s2], roughness, 0 of a smooth bed [m], viscosity [m2/s].

    Notes
    -----
    The standard step method (Chow 1959, section 10-4) from the lower end upstream: head falls by friction as
    in normal flow of the same depth, and is at least that of critical flow.

    >>> flat = backwater(np.zeros(50), 0.1, 0.03, -np.inf, 0.0451, 9.81, 0.004, 1e-6)
    >>> bool(flat[-1] == 0.0451), bool(0.055 < flat[0] < 0.08)
    (True, True)
    """
    every = max(len(up) // MOST_STATIONS, 1)
    stations = np.append(np.arange(0, len(up) - 1, every), len(up) - 1)
    found = _backwater(
        np.ascontiguousarray(up[stations]).tobytes(), every * dx, q, below, critical, g, rough, nu
    )
    return np.asarray(np.interp(np.arange(len(up)), stations, found), dtype=np.float64)


@lru_cache(maxsize=16)
def _backwater(
    heights: bytes, dx: float, q: float, below: float, critical: float, g: float, rough: float, nu: float
) -> Floats:
    up = np.frombuffer(heights)
    found = np.full(len(up), critical)
    for k in range(len(up) - 1, -1, -1):
        least, depth = up[k] + 1.5 * critical, critical
        if below > least:
            low, high = critical, below - up[k]
            for _ in range(40):
                depth = 0.5 * (low + high)
                enough = up[k] + depth + 0.5 * q * q / (g * depth**2) >= below
                low, high = (low, depth) if enough else (depth, high)
        found[k] = depth
        below = max(below, least) + dx * _friction_slope(q / depth, depth, g, rough, nu)
    return found


def _friction_slope(speed: float, depth: float, g: float, rough: float, nu: float) -> float:
    """Loss of head over the way at a mean speed [m/s] and depth [m], that of normal flow [-]."""
    low, high, shear = 0.0, speed, speed  # friction velocity
    for _ in range(40):
        shear = 0.5 * (low + high)
        if rough == 0.0:
            mean = water.log_law_smooth(depth / math.e, shear, nu)
        else:
            mean = turbulence.speed_mean_rough(depth, shear, rough)
        low, high = (shear, high) if mean < speed else (low, shear)
    return shear**2 / (g * depth)


def bore_depth(h: float, froude: float) -> float:
    """Depth behind a bore that stops flow of depth h [m] where it meets a wall or water at rest.

    Notes
    -----
    Source: u = (h_2 - h) sqrt(g (h + h_2)/(2 h h_2)) (Stoker 1957, section 10.7).

    >>> round(bore_depth(0.023, 2.75), 3)
    0.104
    """
    low, high = h, h * (2.0 + 4.0 * froude**2)
    for _ in range(60):
        deep = 0.5 * (low + high)
        stopped = (deep / h - 1.0) * math.sqrt(0.5 * (1.0 + h / deep))
        low, high = (deep, high) if stopped < froude else (low, deep)
    return high


def level_of_basin(up: Floats, dx: float, volume: float) -> float:
    """Level of a volume per width [m2] in the deepest basin of a bottom [m].

    Parameters
    ----------
    up, dx : as of `backwater`.

    >>> v = np.abs(np.linspace(-1.0, 1.0, 2001))
    >>> round(level_of_basin(v, 0.001, 0.01), 3)
    0.1
    """
    at = int(up.argmin())

    def held(level: float) -> float:
        dry = np.flatnonzero(up >= level)
        first, last = int(dry[dry < at].max(initial=-1)) + 1, int(dry[dry > at].min(initial=len(up)))
        return float((level - up[first:last]).sum()) * dx

    low, high = float(up.min()), float(up.max()) + volume / (len(up) * dx)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if held(middle) < volume else (low, middle)
    return high
