"""Speeds and pressure of the water within a row of columns, cell by cell, at one moment."""

from dataclasses import dataclass

import numpy as np

from ryusa.measure._run import Floats, Run
from ryusa.measure.long_section import bed_line, between_stations, dams_of, row_of
from ryusa.measure.table import lines
from ryusa.results.water import WaterFrames


@dataclass(frozen=True, repr=False)
class FlowField:
    """Water in the cells of a row; arrays of shape (n_segment, n_cell), nan outside the water.

    Attributes
    ----------
    t : time of the frame [s].
    x : middles of the segments [m], shape (n_segment,).
    z : heights of the middles of the cells over the x axis, normal to it [m].
    u, w : speeds along the x axis and normal to it, upwards [m/s]; in pores that of the pore water.
    phi : concentration of grains [-].
    pressure : beyond the hydrostatic one of the surface above [Pa]; None where the row is hydrostatic. In the
        cell of the surface it falls to 0, and is not known.
    surface, bed, floor : heights over the x axis of the surface, of the bed of grains and of the bottom with
        its closed dams [m], shape (n_segment,); the surface of a dry segment is on its floor.
    dams : name, first and last x [m] of each.
    """

    t: float
    x: Floats
    z: Floats
    u: Floats
    w: Floats
    phi: Floats
    pressure: Floats | None
    surface: Floats
    bed: Floats
    floor: Floats
    dams: tuple[tuple[str, float, float], ...]

    def rows(self) -> list[dict[str, object]]:
        """One line for each cell with water."""
        wet = np.isfinite(self.u)
        columns = {
            "x_m": np.broadcast_to(self.x[:, None], wet.shape)[wet], "z_m": self.z[wet],
            "u_m_per_s": self.u[wet], "w_m_per_s": self.w[wet], "phi": self.phi[wet],
        }  # fmt: skip
        if self.pressure is not None:
            columns["pressure_Pa"] = self.pressure[wet]
        return lines(columns)


def flow_field(run: Run, t: float | None = None) -> FlowField:
    """Speeds and pressure of the water in the cells of a row of columns.

    Parameters
    ----------
    run : with a row of columns.
    t : time [s]; that of the frame nearest to it, the last one when not given.

    Raises
    ------
    ResultsError : it has no row, or no frame yet.
    """
    found = row_of(run)
    k = len(found.t) - 1 if t is None else int(np.abs(found.t - t).argmin())
    row = found.row
    n, dz = row.column.n, row.column.dz
    low = row.bottom[:, None] + np.arange(n) * dz
    own = None
    if not row.hydrostatic:
        full = (found.content[k] > 0.0) & (low + dz < found.surface[k][:, None])
        own = np.where(full, found.pressure[k], np.nan)
    u, w = speeds_in_cells(found, k)
    phi = np.where(np.isfinite(u), found.phi[k], np.nan)
    bed = bed_line(run, found, np.array([k]), "packed")[0]
    surface = np.maximum(found.surface[k], found.floor)
    return FlowField(
        float(found.t[k]), row.x, low + 0.5 * dz, u, w, phi, own, surface, bed, found.floor, dams_of(row)
    )


def speeds_in_cells(found: WaterFrames, k: int) -> tuple[Floats, Floats]:
    """Speeds along the x axis and normal to it in the cells of a row in frame k [m/s], nan outside the water.

    Each has the shape (n_segment, n_cell).
    """
    row = found.row
    bottom, (before, after) = row.bottom_with_ends(), row.stations_between
    rise = (bottom[after] - bottom[before]) / row.dx if row.hydrostatic else np.zeros(len(before))
    upwards = found.w[k] + rise[:, None] * found.u[k]  # a hydrostatic row has w over its inclined levels
    u, w = (between_stations(row.periodic, one.T).T for one in (found.u[k], upwards))
    water = found.content[k] > 0.0
    return np.where(water, u, np.nan), np.where(water, w, np.nan)
