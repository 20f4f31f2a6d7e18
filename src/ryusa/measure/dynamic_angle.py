"""Angle of the surface of grains in a drum that turns, over time."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.snapshot import scene_at
from ryusa.measure.statistics import average
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.model.walls import SPIN, FaceKind, pose

BIN = 1.5  # along the surface, in mean diameters
MIDDLE = 0.5  # of the surface, on which the line is fitted
LEAST = 4  # bins in a fit
LEVEL = 1.0e-6  # component along gravity up to which the axis of a drum is level


@dataclass(frozen=True, repr=False)
class DynamicAngle(Averaged):
    """Inclination of the grains in a drum, positive where they are carried up.

    Attributes
    ----------
    drum : name of the wall.
    froude : omega^2 R/g of the drum [-].
    radius : of the drum [m].
    rate : angular velocity of the drum, without its sign [rad/s].
    t : times of the frames [s], shape (n,).
    surface : angle of a line through the highest grains of the middle half of the surface [rad], shape (n,).
    mass : angle between the vertical and the line from the axis to the centre of mass [rad], shape (n,).
    offset : horizontal distance of the centre of mass from the axis [m], shape (n,).
    averages : of both angles, in degrees, and of the offset.
    """

    drum: str
    froude: float
    radius: float
    rate: float
    t: Floats
    surface: Floats
    mass: Floats
    offset: Floats
    averages: Averages

    def series(self) -> list[dict[str, object]]:
        """One dictionary per frame."""
        columns = {
            "t_s": self.t, "surface_rad": self.surface, "centre_of_mass_rad": self.mass,
            "offset_m": self.offset,
        }  # fmt: skip
        return lines(columns)


def dynamic_angle(run: Run, begin: float | None = None, end: float = math.inf) -> DynamicAngle:
    """Dynamic angle of repose in a cylinder that turns about its own level axis.

    Parameters
    ----------
    run : a run folder.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.

    Raises
    ------
    ResultsError : no such cylinder, or no frame in the window.

    Notes
    -----
    Two angles: that of a least-squares line through the highest grain of each bin, 1.5 mean diameters wide,
    over the middle half of the surface; and that of the centre of mass seen from the axis, which is the same
    where the surface is flat. The torque of the grains on the drum about its axis is their weight times the
    offset of the centre of mass, in the mean over time.
    """
    since = settle_time(run) if begin is None else begin
    every = np.asarray(run.frames.t, dtype=np.float64)
    chosen = np.flatnonzero((every >= since) & (every <= end))
    if len(chosen) == 0:
        raise ResultsError(f"no frame from t = {since:g} s to {end:g} s")
    name, centre, along, up, radius, rate, g = _drum(run, float(every[chosen[-1]]))
    d, m, width = run.scene.d, run.scene.m, BIN * float(run.scene.whole_grains()[0].mean())
    angles, masses, offsets = (np.empty(len(chosen)) for _ in range(3))
    for n, k in enumerate(chosen):
        x = np.asarray(run.frames.x[k], dtype=np.float64) - centre
        there = np.isfinite(x[:, 0])
        s, z = x[there] @ along, x[there] @ up
        offsets[n] = np.average(s, weights=m[there])
        masses[n] = math.atan2(offsets[n], -float(np.average(z, weights=m[there])))
        angles[n] = masses[n] + _rest(s, z, 0.5 * d[there], masses[n], radius, width)
    window = (float(every[chosen[0]]), float(every[chosen[-1]]))
    froude = rate * rate * radius / g
    items = (
        average("angle of the surface", "deg", [np.degrees(angles)], window),
        average("angle of the centre of mass", "deg", [np.degrees(masses)], window),
        average("offset of the centre of mass", "m", [offsets], window),
    )
    notes = (f"drum {name!r}: {rate:.4g} rad/s, radius {radius:.4g} m, Froude number {froude:.3g}",)
    return DynamicAngle(
        name, froude, radius, rate, every[chosen], angles, masses, offsets,
        Averages("dynamic_angle", items, notes),
    )  # fmt: skip


def _drum(run: Run, t: float) -> tuple[str, Floats, Floats, Floats, float, float, float]:
    """Name, point of the axis [m], direction in which grains are carried, upwards, radius, spin, gravity."""
    scene = scene_at(run, t)
    walls, g = scene.walls, float(np.linalg.norm(scene.gravity))
    if walls is None or g == 0.0:
        raise ResultsError("the run has no walls, or no gravity: no drum")
    up = -scene.gravity / g
    for f in np.flatnonzero(walls.kind == FaceKind.CYLINDER):
        w = int(walls.wall[f])
        turn, shift = pose(walls.motion[w], t)
        spin, axis = walls.motion[w, SPIN : SPIN + 3], turn @ walls.face[f, 3:6]
        rate = float(np.linalg.norm(spin))
        if rate == 0.0 or abs(float(spin @ axis)) < (1.0 - LEVEL) * rate or abs(float(axis @ up)) > LEVEL:
            continue
        centre = turn @ walls.face[f, :3] + shift
        return walls.names[w], centre, np.cross(spin / rate, -up), up, float(walls.face[f, 6]), rate, g
    raise ResultsError("the run has no cylinder that turns about its own level axis: no drum")


def _rest(s: Floats, z: Floats, r: Floats, angle: float, radius: float, width: float) -> float:
    """Angle between the line through the highest grains of the middle half and `angle` [rad]."""
    along = s * math.cos(angle) + z * math.sin(angle)
    high = z * math.cos(angle) - s * math.sin(angle) + r
    depth = float(np.quantile(high[np.abs(along) < 0.25 * radius], 0.95))  # of the surface, roughly
    half = MIDDLE * math.sqrt(max(radius * radius - depth * depth, 0.0))
    middle = np.flatnonzero(np.abs(along) < half)
    cell = np.floor(along[middle] / width).astype(np.int64)
    order = np.lexsort((high[middle], cell))
    top = middle[order[np.append(np.diff(cell[order]) > 0, True)]]
    if len(top) < LEAST:
        return math.nan
    away = along[top] - along[top].mean()
    return math.atan(float((away * high[top]).sum() / (away * away).sum()))
