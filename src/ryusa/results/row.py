"""The water of a row of columns of a run at every frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.model import ColumnRow
from ryusa.results.lazy import Part, read_frames

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class RowFrames:
    """Water of a row at every frame: of segments, and of stations between them, from upstream on.

    Attributes
    ----------
    row : the row at the start of the run; `row.x` and `row.x_station` are where they are [m].
    t : times of the frames [s], shape (n_frame,).
    surface : height of the surface [m], shape (n_frame, n_segment); the bottom where it is dry.
    volume : water per area of a segment [m], shape (n_frame, n_segment).
    content : the part in each cell [m], shape (n_frame, n_segment, n).
    phi : concentration of grains, fixed ones included [-], shape (n_frame, n_segment, n).
    discharge : what passed a station in the last step of the water, per time and width [m2/s],
        shape (n_frame, n_station).
    passed : water that has passed since the start, per width [m2], shape (n_frame, n_station).
    tau : shear stress of the water at the bottom [Pa], shape (n_frame, n_station).
    u, w : velocity along x and upwards [m/s], shape (n_frame, n_station, n).
    energy : energy account of the water since the start, per width [J/m], indexed by
        `model.row_energy.RowTerm`, shape (n_frame, N_ROW_TERM).
    """

    row: ColumnRow
    t: Floats
    surface: Floats
    volume: Floats
    content: Floats
    phi: Floats
    discharge: Floats
    passed: Floats
    tau: Floats
    u: Floats
    w: Floats
    energy: Floats

    @property
    def floor(self) -> Floats:
        """Height of the bottom, or of the top of solid cells on it [m], shape (n_segment,)."""
        row = self.row
        return row.bottom if row.solid is None else row.bottom + row.solid * row.column.dz

    @property
    def depth(self) -> Floats:
        """Depth of the water over the floor [m], shape (n_frame, n_segment)."""
        return self.surface - self.floor


def read_row(parts: list[Part], t: Floats, row: ColumnRow) -> RowFrames:
    """Read the water of all frames.

    Raises
    ------
    ResultsError : a part lacks it, or has it in another shape.
    """
    found = read_frames(parts, row.GROUP, row.frame_shapes())
    return RowFrames(row, t, **found)
