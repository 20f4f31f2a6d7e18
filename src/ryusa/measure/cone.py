"""Slope of a round heap: height over distance from its axis, and the angle on every side."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run
from ryusa.measure.repose import surface
from ryusa.measure.snapshot import snapshot
from ryusa.measure.table import lines
from ryusa.printed import ByShape

Ints = NDArray[np.int64]

BIN = 1.5  # width of a ring, and length of a cell along it, in mean diameters
FIT = (0.2, 0.8)  # of the height of the innermost rings
SECTORS = 8  # sides of the heap, whose scatter gives the error
LEAST = 3  # rings in a fit


@dataclass(frozen=True, repr=False)
class Cone(ByShape):
    """Surface of a heap with a round foot at one moment. Angles in radians, heights above the floor.

    Attributes
    ----------
    t : time of the frame [s].
    x, y : axis of the heap: centre of mass of its grains [m].
    r, z : distance from the axis and height of the highest grain of each cell [m], shape (n_cell,).
    inside : cells that the fit uses, shape (n_cell,).
    ring_r, ring_z : middle of each ring [m] and mean height of its cells [m].
    angle : slope, positive where it falls outwards [rad].
    error : its standard error from the scatter between the sides of the heap [rad].
    sides : slope of each of 8 sides [rad].
    height : mean height of the innermost ring [m].
    foot : largest distance of a grain of the heap from the axis [m].
    grains : number of grains of the heap.
    away : number of free grains that are no part of it.
    moving : share of its grains that move [-].
    """

    t: float
    x: float
    y: float
    r: Floats
    z: Floats
    inside: NDArray[np.bool_]
    ring_r: Floats
    ring_z: Floats
    angle: float
    error: float
    sides: Floats
    height: float
    foot: float
    grains: int
    away: int
    moving: float

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per quantity."""
        values = (
            ("time", "s", self.t),
            ("slope", "deg", math.degrees(self.angle)),
            ("± s.e. between the sides", "deg", math.degrees(self.error)),
            ("least steep side", "deg", math.degrees(float(self.sides.min()))),
            ("steepest side", "deg", math.degrees(float(self.sides.max()))),
            ("height", "m", self.height),
            ("foot", "m", self.foot),
            ("grains", "-", float(self.grains)),
            ("away", "-", float(self.away)),
            ("moving_share", "-", self.moving),
        )
        return [{"quantity": name, "unit": unit, "value": value} for name, unit, value in values]

    def samples(self) -> list[dict[str, object]]:
        """One dictionary per cell."""
        return lines({"r_m": self.r, "z_m": self.z, "in_fit": self.inside})


def cone(run: Run, t: float | None = None) -> Cone:
    """Slope of a heap with a round foot, on all its sides.

    Parameters
    ----------
    run : a run folder.
    t : [s], the nearest frame is taken; default the last one.

    Raises
    ------
    ResultsError : a plane scene, or fewer than three rings between 0.2 and 0.8 of the height.

    Notes
    -----
    The heap is that of `surface`. Rings round its axis, 1.5 mean diameters wide, are cut into cells of that
    length; the height of a cell is that of the top of its highest grain, so that each is the highest of as
    many grains. The slope is a least-squares line through the cells of the rings whose mean height lies
    between 0.2 and 0.8 of that of the innermost ring with three cells.
    """
    if run.scene.plane_case:
        raise ResultsError("a plane scene holds no heap with a round foot; measure its surface")
    heap = surface(run, t)
    seen = snapshot(run, heap.t)
    chosen = np.isin(seen.grains, heap.grains)
    x, d = seen.x[chosen], seen.d[chosen]
    axis = np.average(x[:, :2], axis=0, weights=d**3)
    away, width = np.hypot(*(x[:, :2] - axis).T), BIN * float(run.scene.whole_grains()[0].mean())
    turned = np.arctan2(*(x[:, :2] - axis).T[::-1]) / (2.0 * math.pi) % 1.0
    top = x[:, 2] + 0.5 * d - heap.floor
    ring = (away / width).astype(np.int64)
    highest = _highest(ring, turned, top)
    k, r, z = ring[highest], away[highest], top[highest]
    rings = np.unique(k)
    mean = np.array([z[k == one].mean() for one in rings])
    height = float(mean[0])
    fit = rings[(mean >= FIT[0] * height) & (mean <= FIT[1] * height)]
    inside = np.isin(k, fit)
    if len(fit) < LEAST:
        raise ResultsError(
            f"{len(fit)} rings of {BIN:g} mean diameters between {FIT[0]:g} and {FIT[1]:g} of the height "
            f"{height:.3g} m; {LEAST} are needed: the heap is too small to measure a slope of"
        )
    sector = (turned[highest] * SECTORS).astype(np.int64) % SECTORS
    sides = np.array([_fall(r[one], z[one]) for one in (inside & (sector == s) for s in range(SECTORS))])
    known = sides[np.isfinite(sides)]
    return Cone(
        t=heap.t, x=float(axis[0]), y=float(axis[1]), r=r, z=z, inside=inside,
        ring_r=(rings + 0.5) * width, ring_z=mean, angle=_fall(r[inside], z[inside]),
        error=float(known.std(ddof=1)) / math.sqrt(len(known)) if len(known) > 1 else math.nan,
        sides=sides, height=height, foot=float((away + 0.5 * d).max()),
        grains=len(d), away=heap.away, moving=heap.moving,
    )  # fmt: skip


def _highest(ring: Ints, turned: Floats, top: Floats) -> Ints:
    """Number of the highest grain of each cell, cells being as long as rings are wide."""
    cells = np.maximum(np.rint(2.0 * math.pi * (ring + 0.5)).astype(np.int64), 1)
    cell = ring * 10_000 + (turned * cells).astype(np.int64)
    order = np.lexsort((top, cell))
    return order[np.append(np.diff(cell[order]) > 0, True)]


def _fall(r: Floats, z: Floats) -> float:
    """Angle of a line through points, positive where it falls [rad]; nan of fewer than three."""
    if len(r) < LEAST:
        return math.nan
    along = r - r.mean()
    return math.atan(-float((along * z).sum() / (along * along).sum()))
