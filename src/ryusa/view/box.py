"""The box that holds what is shown of a run, its edges, and planes within it."""

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.model.wall_shape import cut_off
from ryusa.model.walls import box_of as walls_box
from ryusa.results import Results
from ryusa.view.flow import surface_line, surfaces

Floats = NDArray[np.float64]

FAR = 3.0  # heights of what the grains take up, above which the surface of the water is not shown


def needs_grains(results: Results) -> None:
    """Say that there is nothing to show of a run without free grains.

    Raises
    ------
    ResultsError : it has none.
    """
    if not results.scene.n_grain:
        water = "; ryusa film shows its water, ryusa draw RUN long_section a moment" if results.row else ""
        raise ResultsError(f"{results.folder}: has no free grains to show in motion{water}")


def box_of(results: Results, d: Floats, centres: Iterable[Floats]) -> tuple[Floats, Floats]:
    """Lowest and highest corner of what is shown [m]: free grains at all times, fixed ones, periods, water.

    A surface far above the grains is left out: they would be dots. That along a row is not, up to half of
    its length, which sets their size.

    Parameters
    ----------
    d : diameters of the free grains shown [m], shape (n,).
    centres : of these grains, frame by frame, unwrapped or not [m], shape (n, 3) each.

    Returns
    -------
    low, high : shape (3,) each.
    """
    scene = results.scene
    r, r_fixed = 0.5 * d[:, None], 0.5 * scene.d_fixed[:, None]
    x_fixed = scene.x_fixed.reshape(-1, 3)
    low = (x_fixed - r_fixed).min(axis=0, initial=math.inf)
    high = (x_fixed + r_fixed).max(axis=0, initial=-math.inf)
    for x in centres:
        inside = x.copy()
        for axis, period in enumerate(scene.period):
            if math.isfinite(period):
                inside[:, axis] %= period
        there = np.isfinite(inside[:, 0])  # nan: a grain that has not entered, or has left
        low = np.minimum(low, (inside - r)[there].min(axis=0, initial=math.inf))
        high = np.maximum(high, (inside + r)[there].max(axis=0, initial=-math.inf))
    if scene.walls is not None:  # walls much larger than what the grains take up would make these dots
        bottom, top = walls_box(scene.walls, 0.0)
        if (top - bottom).max() < FAR * (high - low).max():
            low, high = np.minimum(low, bottom), np.maximum(high, top)
    for axis, period in enumerate(scene.period):
        if math.isfinite(period):
            low[axis], high[axis] = 0.0, period
    line = surface_line(results)
    surface, reach = surfaces(results).max(initial=-math.inf), FAR * (high[2] - low[2])
    if line is not None:
        surface = float(np.nanmax(line.z, initial=-math.inf))
        if line.x[-1] - line.x[0] < FAR * (high[0] - low[0]):
            low[0], high[0] = min(low[0], line.x[0]), max(high[0], line.x[-1])
        reach = max(reach, 0.5 * (high[0] - low[0]))
    if high[2] < surface < low[2] + reach:
        high[2] = surface
    return low, high


def corners_of(low: Floats, high: Floats) -> Floats:
    """Corners of a box, shape (8, 3): corner k has the high side of axis a where bit a of k is set."""
    return np.array([[(high if k >> a & 1 else low)[a] for a in range(3)] for k in range(8)])


def edges_of(low: Floats, high: Floats) -> Floats:
    """Edges of a box: both ends of each, shape (12, 2, 3)."""
    corner = corners_of(low, high)
    return np.array([(corner[k], corner[k | bit]) for k in range(8) for bit in (1, 2, 4) if not k & bit])


def plane_in_box(point: Floats, normal: Floats, low: Floats, high: Floats) -> Floats:
    """Corners of the part of a plane that lies in a box, in order around it, shape (n, 3); n = 0: none.

    >>> low, high = np.zeros(3), np.ones(3)
    >>> len(plane_in_box(np.full(3, 0.5), np.array([0.0, 0.0, 1.0]), low, high))
    4
    >>> len(plane_in_box(np.full(3, 0.5), np.full(3, 3.0**-0.5), low, high))
    6
    """
    side = np.cross(normal, [1.0, 0.0, 0.0] if abs(normal[0]) < 0.9 else [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    other = np.cross(normal, side)
    reach = 4.0 * float(np.linalg.norm(high - low)) + float(np.linalg.norm(point - low))
    shape = np.array(
        [point + reach * (a * side + b * other) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    )
    for axis in range(3):
        for sign, end in ((1.0, low[axis]), (-1.0, high[axis])):
            shape = cut_off(shape, sign * (shape[:, axis] - end) + 1.0e-9 * reach)
    return shape
