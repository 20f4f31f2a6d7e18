"""Scour below a dam in a row of columns over time: its depth, place, length and volume."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.along_row import dam_named
from ryusa.measure.inclined import gravity_at
from ryusa.measure.long_section import bed_line, row_of
from ryusa.measure.statistics import average
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.model.grading import laid

FEWEST = 3  # segments of bed that scour needs
ROUND_OFF = 1.0e-9  # of a height of the bed [m]
BACK = 0.25  # of a mean diameter, below which the bed counts as it was


@dataclass(frozen=True, repr=False)
class Scour(Averaged):
    """Scour below a dam at each frame; arrays of shape (n_frame,).

    Attributes
    ----------
    t : times of the frames [s].
    depth : largest depth of the bed below what it was in the first frame, normal to the axis, 0 or more [m].
    at : way from the downstream face of the dam to it [m]; nan while it is less than BACK of a mean diameter.
    length : way from the face to where the bed is as it was behind the deepest place, within BACK [m].
    volume : of the scour up to there, with the pores, per width [m2].
    head : height of the surface at the dam's upstream face over that of the tail water, vertical [m].
    tail : depth of the tail water over the last of the bed, as it was in the first frame [m].
    expected : depth below the bed that Schoklitsch 1932 expects in the end, by the mean head, tail water and
        discharge [m]; 0 where none, nan without water over the dam.
    averages : of all over the window.
    """

    t: Floats
    depth: Floats
    at: Floats
    length: Floats
    volume: Floats
    head: Floats
    tail: Floats
    expected: float
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One line for each frame."""
        columns = {
            "t_s": self.t, "depth_m": self.depth, "at_m": self.at, "length_m": self.length,
            "volume_m2": self.volume, "head_m": self.head, "tail_m": self.tail,
        }  # fmt: skip
        return lines(columns)


def scour(run: Run, begin: float | None = None, end: float = math.inf, dam: str | None = None) -> Scour:
    """Scour of the bed between a dam and the next one, or the end of the row.

    Parameters
    ----------
    run : its water is a row of columns with a dam, and it has free grains.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`. Depths count from the bed in its
        first frame.
    dam : name of a dam; default the one farthest upstream.

    Raises
    ------
    ResultsError : no such row or dam, no grains, fewer than two frames, or fewer than three segments of bed.

    Notes
    -----
    The bed is the top of what is packed, as in `long_section`. Beside the depth at the end a note has what
    Schoklitsch 1932 expects in the end of these grains, head and discharge.
    """
    found = row_of(run)
    row = found.row
    over = dam_named(row, dam)
    if over is None or not run.scene.n_grain:
        raise ResultsError("needs grains in a row of columns with a dam (water.row.dams)")
    behind = over.end
    beyond = min((one.first for one in row.dams if one.first >= behind), default=row.n_segment)
    first = settle_time(run) if begin is None else begin
    frames = np.flatnonzero((found.t >= first) & (found.t <= end))
    if len(frames) < 2:
        raise ResultsError(f"{len(frames)} frames from {first:g} to {end:g} s: scour needs two or more")
    bed, floor = bed_line(run, found, frames, "packed")[:, behind:beyond], found.floor[behind:beyond]
    covered = bed[0] > floor + 0.5 * run.scene.d_mean
    if covered.sum() < FEWEST:
        raise ResultsError(
            f"{covered.sum()} segments of bed behind dam '{over.name}': must be {FEWEST} or more"
        )
    way = (np.arange(behind, beyond) - behind + 0.5) * row.dx
    below = np.where(covered, bed[0] - bed, 0.0)
    deepest, length, volume = below.argmax(axis=1), *np.zeros((2, len(frames)))
    depth, at = np.maximum(below.max(axis=1), 0.0), np.asarray(way[deepest], np.float64)
    for m, i in enumerate(deepest.tolist()):
        if depth[m] <= BACK * run.scene.d_mean:  # a bed of single grains is as uneven
            at[m] = math.nan
            continue
        back = np.flatnonzero(below[m, i:] <= BACK * run.scene.d_mean)
        last = i + int(back[0]) if len(back) else len(way)
        length[m], volume[m] = last * row.dx, np.maximum(below[m, :last], 0.0).sum() * row.dx
    surface, ends = found.surface[frames], np.flatnonzero(covered)[-FEWEST:]
    before, low = max(over.first - 1, 0), surface[:, behind + ends].mean(axis=1)
    slope = math.atan2(*gravity_at(run, float(found.t[frames[0]])))
    apart = float(way[ends].mean()) + (behind - before - 0.5) * row.dx
    head = (surface[:, before] - low) * math.cos(slope) + apart * math.sin(slope)
    tail = low - bed[0, ends].mean()
    t = found.t[frames]
    window = (float(t[0]), float(t[-1]))
    held = (
        ("depth", depth),
        ("at", at),
        ("length", length),
        ("volume", volume),
        ("head", head),
        ("tail", tail),
    )
    means = tuple(average(name, "m2" if name == "volume" else "m", [one], window) for name, one in held)
    q = float(found.discharge[frames][:, over.end].mean())
    note = f"behind dam '{over.name}', {depth[-1]:.3g} m deep at the end, counted from t = {t[0]:.4g} s"
    if (bed[-1] <= floor + ROUND_OFF)[covered].any():
        note += ", dug to the floor"
    most = math.nan
    if q > 0.0 and head.mean() > 0.0:
        d_90 = laid(run.scene.d, run.scene.m).diameter(0.9)
        most = max(schoklitsch(float(head.mean()), q, d_90) - float(tail.mean()), 0.0)
        expects = f"{most:.3g} m" if most > 0.0 else "none"
        note += (
            f"; Schoklitsch 1932 expects {expects} in the end, within a factor of 2, of q = {q:.3g} m2/s, "
            f"D90 = {1e3 * d_90:.3g} mm and the mean head"
        )
    return Scour(t, depth, at, length, volume, head, tail, most, Averages("scour", means, (note,)))


def schoklitsch(head: float, q: float, d_90: float) -> float:
    """Depth of water over the deepest scour that a free overfall makes in the end [m].

    Parameters
    ----------
    head : height of the surface upstream over that of the tail water [m].
    q : discharge per width [m2/s].
    d_90 : diameter that 90 % of the grains by mass are finer than [m].

    Notes
    -----
    Source: Schoklitsch 1932, 4.75 head**0.2 q**0.57/d_90**0.32 with metres, seconds and d_90 in mm; its
    scatter is a factor of about 2.

    Examples
    --------
    >>> round(schoklitsch(0.115, 0.015, 0.009), 3)
    0.139
    """
    return float(4.75 * head**0.2 * q**0.57 / (1.0e3 * d_90) ** 0.32)
