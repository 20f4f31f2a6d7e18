"""A row of columns over distance and time: depth, discharges, bed."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.catalogue import BEDS
from ryusa.errors import ResultsError
from ryusa.measure._run import Run, settle_time
from ryusa.measure.along_row import grains_along_row
from ryusa.measure.inclined import fall_of, gravity_at, pull_of
from ryusa.measure.long_section import (
    THIN,
    Bed,
    Floats,
    bed_line,
    between_stations,
    column_name,
    dams_of,
    row_of,
)
from ryusa.measure.table import lines
from ryusa.printed import ByShape
from ryusa.spelling import known_word


@dataclass(frozen=True, repr=False)
class DepthHistory(ByShape):
    """A row over distance and time; arrays of shape (n_frame, n_segment).

    Attributes
    ----------
    t : times of the frames [s], shape (n_frame,).
    x : middles of the segments [m], shape (n_segment,).
    depth : from the bed to the surface [m], as in `LongSection`.
    discharge : of water, mean of both ends of a segment [m2/s].
    froude : Froude number as in `LongSection` [-], in the first frame with the discharge of grains by their
        speeds; nan where it is dry.
    dams : name, first and last x [m] of each.
    bed : height of the bed [m].
    volume : of free grains per area [m]; 0 in a run without.
    solid_discharge : of grains since the frame before, mean of both ends [m2/s]; nan in the first.
    grains : whether there are free grains.
    """

    t: Floats
    x: Floats
    depth: Floats
    discharge: Floats
    froude: Floats
    dams: tuple[tuple[str, float, float], ...]
    bed: Floats
    volume: Floats
    solid_discharge: Floats
    grains: bool = False

    @property
    def bed_change(self) -> Floats:
        """Rise of the bed since the first of the frames, at `t[0]` [m]."""
        return self.bed - self.bed[0]

    def rows(self) -> list[dict[str, object]]:
        """One line for each frame and segment."""
        columns = {
            "t": self.t[:, None], "x": self.x, "depth": self.depth, "discharge": self.discharge,
            "froude": self.froude,
        }  # fmt: skip
        if self.grains:
            columns |= {
                "bed": self.bed, "bed_change": self.bed_change,
                "volume": self.volume, "solid_discharge": self.solid_discharge,
            }  # fmt: skip
        return lines({column_name(name): values for name, values in columns.items()})


def depth_history(
    run: Run, begin: float | None = None, end: float = math.inf, bed: Bed = "packed"
) -> DepthHistory:
    """Find depth, bed and discharges of a row of columns over distance and time.

    Parameters
    ----------
    run : its water is a row of columns.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`. The rise of the bed counts from
        its first frame: a bed that is laid loose sinks while it settles.
    bed : what ends the bed, as in `long_section`.

    Raises
    ------
    CaseError : `bed` is no such word.
    ResultsError : the run has no row of columns, or no frame in the window.
    """
    known_word(bed, BEDS, "bed")
    found = row_of(run)
    begin = settle_time(run) if begin is None else begin
    row, frames = found.row, np.flatnonzero((found.t >= begin) & (found.t <= end))
    if not len(frames):
        raise ResultsError(f"the run has no frame from {begin:g} to {end:g} s")
    beds = bed_line(run, found, frames, bed)
    depth = np.maximum(found.surface[frames] - beds, 0.0)
    through = between_stations(row.periodic, found.discharge[frames])
    volume, solid, both = np.zeros(depth.shape), np.zeros(depth.shape), through
    if run.scene.n_grain:
        held = grains_along_row(run, row, frames)
        rates = np.diff(held.passed, axis=0) / np.diff(found.t[frames])[:, None]
        solid = between_stations(row.periodic, np.concatenate([held.flux[:1], rates]))
        volume, both = held.volume, through + solid
        solid[0] = math.nan
    thick, fall = np.where(depth > THIN, depth, math.nan), fall_of(row)
    pull = np.array([pull_of(fall, *gravity_at(run, one)) for one in found.t[frames].tolist()])
    return DepthHistory(
        found.t[frames], row.x, depth, through, np.abs(both) / np.sqrt(pull * thick**3), dams_of(row), beds,
        volume, solid, bool(run.scene.n_grain),
    )  # fmt: skip
