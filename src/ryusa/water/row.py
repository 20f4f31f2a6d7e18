"""A row of columns: water that varies along the stream, its state, and a step of it (design/0027)."""

import math
from dataclasses import dataclass, replace

import numpy as np

from ryusa.errors import WaterError
from ryusa.model.arrays import Floats
from ryusa.model.row import (
    DEPTH_GIVEN,
    INFLOW,
    OPEN,
    SAME_DEPTH,
    WALL,
    ColumnRow,
    EndKind,
    PorousSolid,
    RowEnd,
    RowState,
)
from ryusa.water._kernel import ColumnParameters, parameters_of
from ryusa.water.momentum_balance import DONE, N_GIVEN, N_OUT, NOT_A_NUMBER, TOO_SHORT, workspace
from ryusa.water.row_energy import EnergyArrays
from ryusa.water.row_inlet import NO_INFLOW
from ryusa.water.row_layout import NappeArrays, RowEnds, RowGrains, RowMatrix, RowShape, RowWater
from ryusa.water.row_nappe import (
    BEYOND,
    STRIKES,
    air_of,
    behind_of,
    closed,
    nappes_of,
    open_solid,
    open_state,
    opened,
    with_air,
)
from ryusa.water.row_pressure import PressureArrays
from ryusa.water.row_station import StationArrays
from ryusa.water.row_step import ASTRAY, COURANT_MET, FAULT_AT, N_SCALARS, NOT_PROJECTED, STEPS
from ryusa.water.row_step import advance_row as _advance
from ryusa.water.solve import FAULTS

NOTHING_ENTERS = (
    "No water can enter at the upper end: the first segment is dry, or its bed reaches the top of the cells",
    "Give the depth of the water that enters (water.row.upstream.depth), water in the first segment at the "
    "start, or higher cells (water.row.height).",
)
NO_PRESSURE = (
    "No pressure was found that keeps the water of every cell",
    "Look at the last frames: ryusa draw RUN long_section --at T. Shorter segments (water.row.segment), or "
    'water.row.pressure = "hydrostatic", take a steeper surface.',
)
OF_NAPPES = {
    ASTRAY + BEYOND: (
        "The nappe of an aerated dam lands beyond the end of the row",
        "Lengthen the row behind the dam (water.row.bottom), or let it end there with a free fall.",
    ),
    ASTRAY + STRIKES: (
        "The nappe of an aerated dam strikes the face of a dam behind it",
        "Set the dams farther apart, or leave out aerated = true.",
    ),
}
IN_A_ROW = {  # hints that differ from those of one column
    TOO_SHORT: "Raise the top of the cells (water.row.height), or let less water in.",
    NOT_A_NUMBER: "Look at the last frames: ryusa draw RUN long_section --at T. A step of the bottom belongs "
    "in water.row.dams, not in water.row.bottom.",
}


@dataclass(frozen=True)
class GrainAction:
    """Action of free grains on the water during a step; of the opened row where it has aerated sills."""

    phi: Floats  # of all grains, fixed ones included, at the end of the step [-], shape (n_segment, n)
    force: Floats  # [N/m3], shape (n_station, n)
    slope: Floats  # [N s/m4], shape (n_station, n)
    carried: Floats  # [-], shape (n_station, n)
    phi_w: Floats  # [m/s], shape (n_station, n)


@dataclass(frozen=True)
class RowArrays:
    """A row as the compiled step takes it, and work arrays, which each step overwrites."""

    p: ColumnParameters
    shape: RowShape
    ends: RowEnds
    work: StationArrays
    pressure: PressureArrays | None = None
    nappe: NappeArrays | None = None  # with a pressure of its own; the others are of the opened row

    @staticmethod
    def of(row: ColumnRow) -> "RowArrays":
        """Arrays of a row."""
        shape, n = shape_of(row), row.column.n
        stations, segments = len(shape.left), len(shape.bottom)
        work = StationArrays(
            np.zeros((stations, n)), np.zeros(stations), np.zeros(segments), np.zeros((segments, n)),
            np.zeros((segments, n + 1)), np.zeros((segments, n)), np.zeros((stations, n)), np.zeros(n),
            np.zeros((N_GIVEN, n)), np.zeros((6, n)), np.zeros((2, n + 1)), workspace(n),
            EnergyArrays.of(stations, segments, n), np.zeros(stations, np.int64),
            np.zeros((stations, n)),
        )  # fmt: skip
        pressure = None if row.hydrostatic else PressureArrays.of(shape, n)
        return RowArrays(
            parameters_of(row.column), shape, ends_of(row), work, pressure, nappes_of(row, shape)
        )


def row_at_rest(row: ColumnRow, surface: Floats, solid: PorousSolid | None = None) -> RowState:
    """Water at rest in a row.

    Parameters
    ----------
    row : the row.
    surface : height of the surface over the x axis [m], shape (n_segment,); below the bottom: no water.
    solid : porous solid in the row.

    Raises
    ------
    ValueError : the row is not valid, or the surface lies above the top of its cells.
    """
    faults = row.refuses()
    if faults:
        raise ValueError("; ".join(faults))
    c = row.column
    depth = row.with_ends(np.asarray(surface, dtype=np.float64) - row.bottom)
    if depth.max() > c.n * c.dz * (1.0 + 1e-12):
        raise ValueError(
            f"the surface lies {depth.max():g} m above the bottom, and the column is {c.n * c.dz:g} m high"
        )
    first, phi = row.solid_cells(), _phi_of(row, solid)
    level = c.z_low + np.maximum(depth, first * c.dz)
    wet = np.clip(level[:, None] - c.faces[:-1], 0.0, c.dz)
    wet[np.arange(c.n) < first[:, None]] = 0.0
    content = (1.0 - phi) * wet
    volume = np.array([cells.sum() for cells in content])  # the sum of `WaterState.at_rest`
    stations, segments = len(row.x_station), len(volume)
    made = RowState(
        np.zeros((stations, c.n)), volume, content, wet, level, np.zeros(stations),
        np.zeros((stations, 6, c.n)), np.zeros((stations, 2, c.n + 1)), np.zeros((stations, N_OUT)),
    )  # fmt: skip
    if row.hydrostatic:
        return made
    return replace(made, w=np.zeros((segments, c.n + 1)), pressure=np.zeros((segments, c.n)))


def advance_row(
    row: ColumnRow,
    state: RowState,
    time: float,
    *,
    longest: float = math.inf,
    solid: PorousSolid | None = None,
    grains: GrainAction | None = None,
    arrays: RowArrays | None = None,
) -> RowState:
    """State of the row after a time.

    Parameters
    ----------
    row, state : fixed properties, and the present state.
    time : what passes [s]; divided into equal steps where the Courant number would exceed 1/2.
    longest : longest step [s].
    solid : porous solid in the row; its concentration is that of all grains, unless `grains` are given.
    grains : action of free grains, constant during the time.
    arrays : of the row; a caller that keeps them saves the time of making them.

    Notes
    -----
    Raises `WaterError` with the place if the surface leaves the column, if grains fill a cell completely, if
    nothing can enter at an inlet, if a speed is not finite, or if the stresses of a station do not converge.
    """
    arrays, c, before = RowArrays.of(row) if arrays is None else arrays, row.column, state
    shape, nappe = arrays.shape, arrays.nappe
    if nappe is not None:
        solid = None if solid is None else open_solid(row, solid)
        row, state = opened(row), open_state(row, state)
    stations = len(shape.left)
    matrix = _matrix_of(row, solid)
    given = RowGrains(_phi_of(row, solid), *np.zeros((4, stations, c.n)), laden=solid is not None)
    if grains is not None:
        phi = row.with_ends(grains.phi)
        given = RowGrains(phi, grains.force, grains.slope, grains.carried, grains.phi_w, laden=True)
    water = RowWater(
        state.u.copy(), state.volume.copy(), state.content.copy(), state.wet.copy(), state.surface.copy(),
        state.passed.copy(),
    )  # fmt: skip
    rows, faces = np.zeros((stations, 6, c.n)), np.zeros((stations, 2, c.n + 1))
    out, scalars = np.zeros((stations, N_OUT)), np.zeros(N_SCALARS)
    pressure, own = arrays.pressure, dict[str, Floats]()
    if pressure is not None:  # whose first step takes the eddy viscosities of the last one
        faces[:] = state.edges
        pressure.w[:] = 0.0 if state.w is None else state.w
        pressure.p[:] = 0.0 if state.pressure is None else state.pressure
    arrays.work.energy.books[:] = 0.0
    status = _advance(
        arrays.p, shape, arrays.ends, matrix, given, float(time), float(longest), water, arrays.work, rows,
        faces, out, scalars, pressure, nappe,
    )  # fmt: skip
    if status != DONE:
        cause, hint = (FAULTS | {NO_INFLOW: NOTHING_ENTERS, NOT_PROJECTED: NO_PRESSURE} | OF_NAPPES)[status]
        at = scalars[FAULT_AT] - (0 if nappe is None else int((nappe.air < scalars[FAULT_AT]).sum()))
        where = row.x_low + (at - row.inner.start) * row.dx
        raise WaterError(
            f"{cause}, at x = {where:.4g} m", step=state.steps, t=state.t, hint=IN_A_ROW.get(status, hint)
        )
    energy = state.energy + arrays.work.energy.books
    if pressure is not None:
        own = {"w": pressure.w.copy(), "pressure": pressure.p.copy()}
    own |= water._asdict() | {"profiles": rows, "edges": faces, "budgets": out}
    if nappe is not None:
        own = {name: closed(one, nappe.air) for name, one in own.items()}
    for array in (*own.values(), energy):
        array.flags.writeable = False
    return replace(
        before, **own, energy=energy,
        t=state.t + time, steps=state.steps + int(scalars[STEPS]),
        courant=max(state.courant, float(scalars[COURANT_MET])),
    )  # fmt: skip


def discharges(row: ColumnRow, state: RowState) -> Floats:
    """Discharge at the stations, with the mean content of the segments beside [m2/s], shape (n_station,).

    At an open end it is not what passes: `RowState.passed` is.
    """
    left, right = row.stations_between
    return (0.5 * (state.content[left] + state.content[right]) * state.u).sum(axis=1)


def shape_of(row: ColumnRow) -> RowShape:
    """Geometry of a row as the compiled step takes it."""
    air, shut, row = air_of(row), np.insert(row.cells_of_dams(), behind_of(row), 0), opened(row)
    n = row.n_segment
    bottom = row.bottom_with_ends()
    left, right = row.stations_between
    if row.periodic:
        west, east = np.arange(n), (np.arange(n) + 1) % n
    else:
        west = np.concatenate([[0], np.arange(n), [n]])
        east = np.concatenate([[0], np.arange(n) + 1, [n]])
    kind = np.full(len(left), OPEN)
    for j, end in ((0, row.upstream), (-1, row.downstream)):
        if end is not None and end.kind is EndKind.WALL:
            kind[j] = WALL
        if end is not None and end.kind is EndKind.DISCHARGE:
            kind[j] = INFLOW
    steep = 1.0 + ((bottom[right] - bottom[left]) / row.dx) ** 2
    shape = RowShape(
        left, right, west, east, row.solid_cells(), shut, np.delete(np.arange(len(bottom)), air), kind,
        bottom, steep, steep if row.hydrostatic else np.ones(len(left)), not row.hydrostatic,
        (row.inner.start, row.inner.stop),
        float(row.dx), float(row.g_z),
    )  # fmt: skip
    return with_air(shape, air)


def ends_of(row: ColumnRow) -> RowEnds:
    """Ends of a row as the compiled step takes them."""
    row = opened(row)
    n, cells = row.n_segment, row.column.n
    bottom = row.bottom_with_ends()
    rule, depth = np.full(2, SAME_DEPTH), np.zeros(2)
    discharge, profile = 0.0, np.ones(cells)
    for e, end in enumerate((row.upstream, row.downstream)):
        if end is None:
            continue
        if end.kind is EndKind.LEVEL:
            rule[e], depth[e] = DEPTH_GIVEN, max(end.level - bottom[-e], 0.0)
        elif end.kind is EndKind.FREE_FALL:
            rule[e] = DEPTH_GIVEN
        elif end.kind is EndKind.DISCHARGE:
            discharge, profile = _inflow_of(end, cells)
            if not math.isnan(end.depth):
                rule[e], depth[e] = DEPTH_GIVEN, end.depth
    count = 0 if row.periodic else 2
    return RowEnds(
        np.array([0, n + 1])[:count], np.array([1, n])[:count], rule[:count], depth[:count], discharge,
        profile,
    )  # fmt: skip


def _inflow_of(end: RowEnd, cells: int) -> tuple[float, Floats]:
    """Discharge [m2/s] and profile of an inlet."""
    profile = np.ones(cells) if end.profile is None else np.array(end.profile, dtype=np.float64)
    return float(end.discharge), profile


def _phi_of(row: ColumnRow, solid: PorousSolid | None) -> Floats:
    """Concentration of a porous solid, ends included [-]."""
    if solid is None:
        return np.zeros((row.n_segment + (0 if row.periodic else 2), row.column.n))
    return row.with_ends(solid.phi)


def _matrix_of(row: ColumnRow, solid: PorousSolid | None) -> RowMatrix:
    """A porous solid as the compiled step takes it."""
    phi = _phi_of(row, solid)
    if solid is None:
        return RowMatrix(phi, np.zeros_like(phi), np.zeros_like(phi))
    return RowMatrix(phi, row.with_ends(solid.linear), row.with_ends(solid.quadratic))
