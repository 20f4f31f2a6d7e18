"""Water along a row of columns: at one moment, and its depth over distance and time."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.laws.families import BedKind
from ryusa.measure._run import Run
from ryusa.measure.snapshot import scene_at
from ryusa.measure.water import HALF, averaged_over_grain, height_reached
from ryusa.model import ColumnRow
from ryusa.model.row import EndKind
from ryusa.results.row import RowFrames

Floats = NDArray[np.float64]
THIN = 1.0e-6  # depth below which a segment counts as dry [m]


@dataclass(frozen=True)
class LongSection:
    """Water of a row at one moment, by segment; arrays of shape (n_segment,).

    Attributes
    ----------
    t : time of the frame [s].
    slope : of the x axis, positive where it falls downstream [rad].
    x : middles of the segments [m].
    bottom, floor : height of the bottom, and of it with the dams that let no water through [m].
    bed : height of the top of the loose bed [m], as in `measure.water`; the floor without one.
    surface : height of the surface [m]; the floor where it is dry.
    depth : from the bed to the surface [m]; 0 where the surface lies in the bed.
    discharge : mean of both ends of a segment [m2/s].
    speed : discharge over depth [m/s]; nan where it is dry.
    froude : speed over that of a long wave, sqrt(g_z depth) [-].
    critical : critical depth of the discharge [m].
    energy : height of the energy line, surface + speed**2/(2 g) [m].
    tau : shear stress at the bottom, mean of both ends [Pa].
    dams : name, first and last x [m] of each.
    """

    t: float
    slope: float
    x: Floats
    bottom: Floats
    floor: Floats
    bed: Floats
    surface: Floats
    depth: Floats
    discharge: Floats
    speed: Floats
    froude: Floats
    critical: Floats
    energy: Floats
    tau: Floats
    dams: tuple[tuple[str, float, float], ...]

    def elevation(self, z: Floats) -> Floats:
        """Vertical height of points at the heights z normal to the x axis [m]; 0 at the origin."""
        return z * math.cos(self.slope) - self.x * math.sin(self.slope)

    def rows(self) -> list[dict[str, object]]:
        """One line for each segment."""
        names = (
            "x", "bottom", "floor", "bed", "surface", "depth", "speed", "froude", "discharge", "critical",
            "energy", "tau",
        )  # fmt: skip
        table = [getattr(self, name).tolist() for name in names]
        return [dict(zip(names, one, strict=True)) for one in zip(*table, strict=True)]


def long_section(run: Run, t: float | None = None) -> LongSection:
    """Find the water along a row of columns.

    Parameters
    ----------
    run : its water is a row of columns.
    t : time [s]; that of the frame nearest to it, the last one when not given.

    Raises
    ------
    ResultsError : the run has no row of columns, or no frame.
    """
    found = row_of(run)
    k = len(found.t) - 1 if t is None else int(np.argmin(np.abs(found.t - t)))
    row = found.row
    g_x, _, minus_g_z = np.asarray(scene_at(run, float(found.t[k])).gravity).tolist()
    g_z = -minus_g_z
    through, (bed,) = _between(row.periodic, found.discharge[k]), _beds(run, found, np.array([k]))
    depth = np.maximum(found.surface[k] - bed, 0.0)
    stress = found.tau[k].copy()
    if row.upstream is not None and row.upstream.kind is EndKind.DISCHARGE:
        stress[0] = stress[1]  # the speeds of an inlet are given, so that no stress is solved for
    wet = depth > THIN
    speed = np.divide(through, depth, out=np.full(len(depth), math.nan), where=wet)
    wave = np.sqrt(g_z * np.maximum(depth, 0.0))
    return LongSection(
        t=float(found.t[k]),
        slope=math.atan2(g_x, g_z),
        x=row.x,
        bottom=np.array(row.bottom),
        floor=found.floor,
        bed=bed,
        surface=found.surface[k],
        depth=depth,
        discharge=through,
        speed=speed,
        froude=np.divide(np.abs(speed), wave, out=np.full(len(depth), math.nan), where=wet),
        critical=np.cbrt(through**2 / g_z),
        energy=found.surface[k] + speed**2 / (2.0 * math.hypot(g_x, g_z)),
        tau=_between(row.periodic, stress),
        dams=_dams(row),
    )


@dataclass(frozen=True)
class DepthHistory:
    """Depth of a row over distance and time; arrays of shape (n_frame, n_segment).

    Attributes
    ----------
    t : times of the frames [s], shape (n_frame,).
    x : middles of the segments [m], shape (n_segment,).
    depth : from the bed to the surface [m], as in `LongSection`.
    discharge : mean of both ends of a segment [m2/s].
    froude : Froude number [-]; nan where it is dry.
    dams : name, first and last x [m] of each.
    """

    t: Floats
    x: Floats
    depth: Floats
    discharge: Floats
    froude: Floats
    dams: tuple[tuple[str, float, float], ...]

    def rows(self) -> list[dict[str, object]]:
        """One line for each frame and segment."""
        n, m = self.depth.shape
        columns = {
            "t": np.repeat(self.t, m), "x": np.tile(self.x, n), "depth": self.depth.ravel(),
            "discharge": self.discharge.ravel(), "froude": self.froude.ravel(),
        }  # fmt: skip
        values = [one.tolist() for one in columns.values()]
        return [dict(zip(columns, one, strict=True)) for one in zip(*values, strict=True)]


def depth_history(run: Run, begin: float = 0.0, end: float = math.inf) -> DepthHistory:
    """Find depth and Froude number of a row of columns over distance and time.

    Parameters
    ----------
    run : its water is a row of columns.
    begin, end : window [s].

    Raises
    ------
    ResultsError : the run has no row of columns, or no frame in the window.
    """
    found = row_of(run)
    row, shown = found.row, (found.t >= begin) & (found.t <= end)
    if not shown.any():
        raise ResultsError(f"the run has no frame from {begin:g} to {end:g} s")
    beds = _beds(run, found, np.flatnonzero(shown))
    depth = np.maximum(found.surface[shown] - beds, 0.0)
    through = _between(row.periodic, found.discharge[shown])
    thick = np.where(depth > THIN, depth, math.nan)
    return DepthHistory(
        found.t[shown], row.x, depth, through, np.abs(through) / np.sqrt(row.g_z * thick**3), _dams(row)
    )


def row_of(run: Run) -> RowFrames:
    """Frames of the row of columns of a run.

    Raises
    ------
    ResultsError : it has none.
    """
    found = run.row
    if found is None:
        raise ResultsError("needs a run whose water is a row of columns (water.row)")
    if not len(found.t):
        raise ResultsError("the run has no frame yet")
    return found


def _beds(run: Run, found: RowFrames, frames: NDArray[np.int64]) -> Floats:
    """Height of the loose bed in some frames, or of the floor without one [m], shape (n_frame, n_segment)."""
    floors = np.tile(found.floor, (len(frames), 1))
    column = found.row.column
    if not run.scene.n_grain or column.bed != BedKind.MOVING:
        return floors
    cells, least = run.scene.d_mean / column.dz, HALF * column.phi_max
    for m, k in enumerate(frames.tolist()):
        for i, bottom in enumerate(found.row.bottom.tolist()):
            even = averaged_over_grain(found.phi[k, i], cells)
            top = height_reached(column.z - column.z_low + bottom, even, least)
            floors[m, i] = max(floors[m, i], top) if math.isfinite(top) else floors[m, i]
    return floors


def _dams(row: ColumnRow) -> tuple[tuple[str, float, float], ...]:
    """Name, first and last x of the dams [m]."""
    return tuple((one.name, row.x_low + one.first * row.dx, row.x_low + one.end * row.dx) for one in row.dams)


def _between(periodic: bool, stations: Floats) -> Floats:
    """Means of both ends of the segments, of values at the stations, which are the last axis."""
    after = np.roll(stations, -1, axis=-1) if periodic else stations[..., 1:]
    return 0.5 * ((stations if periodic else stations[..., :-1]) + after)
