"""Grains of a feeder reach: each enters at the upper end of a row by itself, over the bed that lies there."""

import math

import numpy as np

from ryusa.model import PASSAGE, Scene
from ryusa.model.arrays import Floats
from ryusa.model.feeds import IN, NONE, Arrivals
from ryusa.running.insertion import ATTEMPTS, Neighbours
from ryusa.water.protocol import Fluid

_STEP = 0.1  # of its diameter by which a grain is raised that has no room
_CLEAR = 1.0e-9  # of its diameter by which it is clear of the screen


def arriving(
    scene: Scene, water: Fluid, near: Neighbours, i: int, step: int, t: float, due: float
) -> tuple[np.ndarray, Floats | None]:
    """Record of a grain of a feeder reach that enters, and its place; None where it finds none.

    Parameters
    ----------
    near : grains near the upper end.
    i, due : id of the grain, and when it crossed the end of the reach [s].
    step, t : of the engine, its time [s].

    Notes
    -----
    A grain that became due since the last instant is as far beyond the screen as its velocity along x has
    brought it. Where the bottom or a grain of the bed is in its way it is raised, up to the surface of the
    water; so what creeps within the bed of the reach is not held back by a bed that lies otherwise here.
    """
    traffic = scene.traffic
    assert traffic is not None
    arrivals = traffic.arrivals
    assert arrivals is not None
    feed = traffic.feeds[arrivals.feed]
    k, d, late = i - feed.first, float(scene.d[i]), t - due
    row = np.zeros(1, PASSAGE)
    row["step"], row["t"], row["way"], row["at"] = step, t, IN, arrivals.feed
    row["grain"], row["to"], row["due"], row["d"], row["m"] = i, NONE, due, d, scene.m[i]
    row["v"], row["omega"] = arrivals.v[k], (arrivals.omega[k] if scene.rotation else 0.0)
    x = feed.low[0] + (0.5 + _CLEAR) * d
    if late < traffic.interval * scene.dt:
        x += max(float(arrivals.v[k, 0]), 0.0) * late
    row_of_water = scene.row
    assert row_of_water is not None
    tilt = 2.0 * (float(row_of_water.bottom[0]) - feed.low[2]) / row_of_water.dx
    floor = feed.low[2] + tilt * (x - row_of_water.x_low)
    lowest = floor + (0.5 + _CLEAR) * d * math.hypot(1.0, tilt)
    place = np.array([x, arrivals.y[k], max(floor + water.bed_at_inlet + arrivals.height[k], lowest)])
    surface = float(water.surface_at(np.array([x]))[0])
    for _ in range(ATTEMPTS):
        if near.free(place, d):
            row["x"] = place
            return row, place
        place[2] += _STEP * d
        if place[2] > surface:
            break
    return row, None


def listed(arrivals: Arrivals | None, feed: int) -> bool:
    """Whether the grains of a feed are those of a feeder reach."""
    return arrivals is not None and arrivals.feed == feed
