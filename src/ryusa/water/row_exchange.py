"""Compiled exchange of grains and a row of columns: forces at the stations, and the water at every grain.

A station holds half of each segment beside it, so what grains give to it, and what they are told of it, go
with half the weights that they have in these segments.
"""

from typing import NamedTuple

import numpy as np

from ryusa.model.column import STIFF
from ryusa.model.row import INFLOW, OPEN, WALL
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.at_grains import DENSEST
from ryusa.water.drive import DISCHARGE
from ryusa.water.eddies import turbulence_of_cells
from ryusa.water.exchange import FOUR
from ryusa.water.exchange_arrays import SliceArrays, WaterLaws
from ryusa.water.momentum_balance import B_FIXED, B_GRAINS, B_SHARED, GRADIENT
from ryusa.water.row_grain_sums import MetByGrains
from ryusa.water.row_layout import NappeArrays, RowEnds, RowShape, RowWater
from ryusa.water.row_nappe import with_landing
from ryusa.water.row_step import driving_gradient, fluxes_along
from ryusa.water.row_sums import (
    BUOYED,
    DRAG_U,
    GrainPlaces,
    RowBed,
    gradients_at_grains,
    means_of_segments,
    of_both_stations,
)
from ryusa.water.slice_sums import (
    DRAG_NOW,
    GIVEN_DRAG,
    GIVEN_MET,
    GIVEN_X,
    GIVEN_Z,
    ROW_CONTENT,
    ROW_DTAU_DZ,
    ROW_DU_DT,
    ROW_SHEAR,
    SOLID,
    SOLID_W,
)

SLOW = 60.0  # slip times d/nu at which both parts of drag, 24 nu/d + 0.4 w, are alike
U_TAU_SQUARE, DRIFT, PUSH, MOVES = 7, 8, 9, 10  # columns of `table_of` behind those of `sample`


class StationForces(NamedTuple):
    """Action of the grains on the water at the stations during an interval."""

    force: Floats  # of the water on grains [N/m3], shape (n_station, n)
    slope: Floats  # its derivative with respect to the speed of the water [N s/m4]
    phi_w: Floats  # concentration times vertical speed of free grains [m/s]
    fixed: Floats  # the part of `force` on fixed grains [N/m3]
    phi: Floats  # concentration of all grains in the segments [-], shape (n_segment, n)
    force_z: Floats  # force along z in the segments [N/m3]
    free_z: Floats  # the part of it on free grains


class RowTold(NamedTuple):
    """What grains are told of the water of a row."""

    stations: Floats  # rows of `time_step` at the stations, shape (n_station, 6, n)
    u: Floats  # speed there [m/s], shape (n_station, n)
    u_free: Floats  # the same as free grains meet it, `meet_within_step`
    w: Floats  # vertical speed in the segments, relative to the bottom [m/s], shape (n_segment, n)
    gradient: Floats  # pressure gradient at the stations [Pa/m], shape (n_station,)
    wet: Floats  # share of the cells of the segments below the surface [-], shape (n_segment, n)
    phi: Floats  # as in StationForces
    force_z: Floats
    moves: Floats  # push upwards on added mass, by water that accelerates [N/m3], shape (n_segment, n)


@kernel
def continue_ends(shape: RowShape, sums: Floats) -> None:
    """Let the grains beyond an open end be as those of the last segment; sums (m, n_segment, n)."""
    first, end = shape.inner
    if end - first < len(shape.bottom):
        sums[:, first - 1] = sums[:, first]
        sums[:, end] = sums[:, end - 1]


@kernel
def leave_dry_ends(shape: RowShape, wet: Floats, sums: Floats) -> None:
    """Let grains beyond an end act on no water where there is none, as beyond a free fall.

    The last station would feel the grains of a whole segment with the water of half of one: then the
    acceleration of the water and the added mass of dense grains drive each other.

    Parameters
    ----------
    wet : share of the cells of the segments below the surface [-], shape (n_segment, n).
    sums : of what acts, (m, n_segment, n).
    """
    first, end = shape.inner
    if end - first == len(shape.bottom):
        return
    for beyond in (first - 1, end):
        for k in range(wet.shape[1]):
            if wet[beyond, k] <= 0.0:
                sums[:, beyond, k] = 0.0


@kernel
def concentration_in_row(p: ColumnParameters, area: float, bed: RowBed, sums: Floats, phi: Floats) -> None:
    """Concentration of free and fixed grains in the segments, of the area [m2] each."""
    for i in range(len(phi)):
        for k in range(p.n):
            phi[i, k] = sums[SOLID, i, k] / (area * p.dz) + bed.phi[i, k]


@kernel
def act_on_stations(
    p: ColumnParameters, area: float, shape: RowShape, u: Floats, u_free: Floats, sums: Floats,
    sums_fixed: Floats, acts: StationForces,
) -> None:  # fmt: skip
    """Forces at the stations from sums over grains in the segments, as `force_on_water`.

    Parameters
    ----------
    area : of the bottom of a segment [m2].
    u, u_free : speed of the water at the stations in the interval, and as free grains met it [m/s], shape
        (n_station, n).
    sums, sums_fixed : of `sum_grains_in_row` and of `sum_fixed_in_row`.
    acts : overwritten, but for `phi`.

    Notes
    -----
    Along an inclined bottom the balance of a station is divided by `inertia`, and drag and stress keep their
    size then, but the push of the surface's slope does not.
    """
    volume = area * p.dz
    for j in range(len(shape.left)):
        a, b = shape.left[j], shape.right[j]
        level = 1.0 - 1.0 / shape.inertia[j]
        for k in range(p.n):
            given = 0.5 * (sums[GIVEN_X, a, k] / volume + sums[GIVEN_X, b, k] / volume)
            drag = 0.5 * (sums[GIVEN_DRAG, a, k] / volume + sums[GIVEN_DRAG, b, k] / volume)
            met = 0.5 * (sums[GIVEN_MET, a, k] / volume + sums[GIVEN_MET, b, k] / volume)
            free = given + (drag * u_free[j, k] - met)
            if level > 0.0:
                free -= level * 0.5 * (sums[BUOYED, a, k] / volume + sums[BUOYED, b, k] / volume)
            fixed = 0.5 * (sums_fixed[0, a, k] / volume + sums_fixed[0, b, k] / volume) * u[j, k]
            acts.force[j, k], acts.fixed[j, k] = free + fixed, fixed
            acts.slope[j, k] = 0.5 * (sums_fixed[1, a, k] / volume + sums_fixed[1, b, k] / volume)
            acts.phi_w[j, k] = 0.5 * (sums[SOLID_W, a, k] / volume + sums[SOLID_W, b, k] / volume)
    for i in range(len(shape.bottom)):
        for k in range(p.n):
            acts.free_z[i, k] = sums[GIVEN_Z, i, k] / volume
            acts.force_z[i, k] = acts.free_z[i, k] + sums_fixed[2, i, k] / volume


@kernel
def split_budgets(
    p: ColumnParameters, shape: RowShape, acts: StationForces, water: RowWater, out: Floats
) -> None:
    """Tell in the budgets of the stations, out (n_station, N_OUT), free grains from those at rest."""
    for j in range(len(shape.left)):
        a, b = shape.left[j], shape.right[j]
        wet, free = 0.0, 0.0
        for k in range(max(shape.first[a], shape.first[b]), p.n):
            wet += water.wet[a, k] + water.wet[b, k]
            free += acts.force[j, k] - acts.fixed[j, k]
        if wet > 0.0 and shape.kind[j] == OPEN:
            out[j, B_FIXED] = out[j, B_GRAINS] + out[j, B_SHARED] + free * p.dz
            out[j, B_GRAINS], out[j, B_SHARED] = -free * p.dz, 0.0


@kernel
def fastest_in_row(p: ColumnParameters, area: float, laws: WaterLaws, sums: Floats, phi: Floats) -> float:
    """Largest rate at which drag brings water to the speed of grains [1/s], as `fastest_relaxation`."""
    fastest = 0.0
    for i in range(len(phi)):
        for k in range(p.n):
            water = laws.rho_w * max(1.0 - phi[i, k], 1.0 - DENSEST)
            fastest = max(fastest, sums[DRAG_NOW, i, k] / (area * p.dz) / water)
    return fastest


@kernel
def rates_at_stations(
    p: ColumnParameters, area: float, laws: WaterLaws, shape: RowShape, sums: Floats, told: RowTold,
    u: Floats, slow: float,
) -> Floats:  # fmt: skip
    """Rates at which drag will bring the water to the speed of the free grains [1/s], shape (n_station, n).

    Parameters
    ----------
    sums : of `sum_grains_in_row`, for the drag over slip in the last interval.
    told : what the grains met in it.
    u : speed of the water from now on [m/s], shape (n_station, n).
    slow : slip at which both parts of drag are alike, `SLOW` nu/d [m/s].

    Notes
    -----
    Drag over slip grows with the slip w as 24 nu/d + 0.4 w: a slip that has grown lets drag act faster than
    it did, one that has shrunk is not trusted to last.
    """
    volume = area * p.dz
    rates = np.zeros(u.shape)
    for j in range(len(shape.left)):
        a, b = shape.left[j], shape.right[j]
        for k in range(p.n):
            drag = sums[DRAG_NOW, a, k] + sums[DRAG_NOW, b, k]
            if shape.kind[j] == OPEN and drag > 0.0:
                speed = (sums[DRAG_U, a, k] + sums[DRAG_U, b, k]) / drag
                water = laws.rho_w * max(1.0 - 0.5 * (told.phi[a, k] + told.phi[b, k]), 1.0 - DENSEST)
                grown = (abs(u[j, k] - speed) + slow) / (abs(told.u_free[j, k] - speed) + slow)
                rates[j, k] = 0.5 * drag / volume / water * max(grown, 1.0)
    return rates


@kernel
def meet_within_step(shape: RowShape, dt: float, rates: Floats, sums: Floats, told: RowTold) -> None:
    """Let free grains meet water that drag has brought nearer to them, where a step does not resolve that.

    Parameters
    ----------
    dt : the interval, of one step [s].
    rates : of `rates_at_stations`.
    sums : of `sum_grains_in_row`, for the grains now.
    told : `u_free` is overwritten where needed.

    Notes
    -----
    Little water in a dense fast flow takes their speed v within less than a step. There the grains meet
    (u + e v)/(1 + e) with e = r dt - 1/4, r the rate of the water: an implicit step for that part of r dt
    which an explicit one does not resolve. The water moves by r dt/(1 + e) of the difference, never by more
    than all of it, and has what the grains have not: momentum is kept.
    """
    for j in range(len(shape.left)):
        a, b = shape.left[j], shape.right[j]
        for k in range(rates.shape[1]):
            excess = rates[j, k] * dt - STIFF
            if excess > 0.0:
                drag = sums[DRAG_NOW, a, k] + sums[DRAG_NOW, b, k]
                speed = (sums[DRAG_U, a, k] + sums[DRAG_U, b, k]) / drag
                told.u_free[j, k] = (told.u[j, k] + excess * speed) / (1.0 + excess)


@kernel
def tell(
    p: ColumnParameters, area: float, shape: RowShape, ends: RowEnds, dt: float, driver: float,
    sums: Floats, through: Floats, water: RowWater, flux: Floats, tilt: Floats, budgets: Floats,
    told: RowTold, nappe: NappeArrays | None,
) -> None:  # fmt: skip
    """Complete what the grains are told, with what varies along the row.

    Parameters
    ----------
    dt, driver : interval [s], and pressure gradient of the driver [Pa/m].
    sums, through : of `sum_grains_in_row`, for the concentrations and speeds of free grains now.
    water : after the interval; at an inlet its speeds are set anew.
    flux, tilt : work arrays, as in `StationArrays`.
    budgets : of the last step.
    told : `stations` as the step wrote them, and `phi`; the rest is overwritten.
    nappe : of an opened row, after its last step.

    Notes
    -----
    Mixture that converges rises: eps w = - phi w_p - integral from the bottom of d(eps U + phi u_p)/dx. The
    acceleration of the water gains U dU/dx, with the difference from upstream that carries the momentum.
    """
    volume, per_dx = area * p.dz, 1.0 / shape.dx
    fluxes_along(p, shape, ends, told.phi, dt, water, flux, tilt)
    told.u[:] = water.u
    told.u_free[:] = water.u
    told.wet[:] = water.wet / p.dz
    rise = np.zeros((len(shape.bottom), p.n))  # of the mixture, by what converges below [m/s]
    periodic = len(shape.kind) == len(shape.bottom)
    for i in range(len(shape.bottom)):
        west, east = shape.west[i], shape.east[i]
        below, entering = 0.0, flux[west]
        if nappe is not None:
            entering = with_landing(shape, i, entering, water.wet[i], nappe)
        # grains do not pass a wall, an inlet, or the upper end of a row, where a screen holds them
        come = 1.0 if shape.kind[west] == OPEN and (periodic or i > 0) else 0.0
        go = 1.0 if shape.kind[east] == OPEN else 0.0
        for k in range(p.n):
            grains = go * through[east, k] / area - come * through[west, k] / area
            more = flux[east, k] - entering[k] + grains
            rise[i, k] = -(below + 0.5 * more) * per_dx
            below += more
            told.w[i, k] = 0.0
            if water.wet[i, k] > 0.0:
                free = sums[SOLID_W, i, k] / volume
                told.w[i, k] = (rise[i, k] - free) / max(1.0 - told.phi[i, k], 1.0 - DENSEST)
    for j in range(len(shape.left)):
        a, b = shape.left[j], shape.right[j]
        told.gradient[j] = driving_gradient(p, shape, j, water, driver)
        if p.drive == DISCHARGE:
            told.gradient[j] = budgets[j, GRADIENT]
        if shape.kind[j] == WALL:  # at rest: the pressure holds the weight
            told.gradient[j] = -p.rho_w * p.g_x
        before, after = shape.west[a], shape.east[b]
        for k in range(p.n):
            if not water.content[a, k] + water.content[b, k] > 0.0 or shape.kind[j] != OPEN:
                continue
            u = water.u[j, k]
            eps = 1.0 - 0.5 * (told.phi[a, k] + told.phi[b, k])
            up = before if u > 0.0 else after
            varies = 0.0
            if shape.kind[up] != OPEN or told.stations[up, ROW_CONTENT, k] > 0.0:
                varies = (u - water.u[up, k]) * per_dx if u > 0.0 else (water.u[up, k] - u) * per_dx
            lift = 0.5 * (rise[a, k] + rise[b, k]) / max(eps, 1.0 - DENSEST)
            told.stations[j, ROW_DU_DT, k] += u * varies + lift * told.stations[j, ROW_SHEAR, k]
    for j in range(len(shape.left)):
        if shape.kind[j] == INFLOW:
            told.stations[j] = told.stations[j + 1]
            told.gradient[j] = told.gradient[j + 1]


@kernel
def turbulence_at_stations(p: ColumnParameters, shape: RowShape, phi: Floats, edges: Floats) -> Floats:
    """Square of u_tau [m2/s2] and drift velocity [m/s] at the stations, shape (2, n_station, n).

    `edges` are stresses and eddy viscosities of `RowState`, `phi` as in `RowTold`.
    """
    out, mean = np.empty((2, len(shape.left), p.n)), np.empty(p.n)
    for j in range(len(shape.left)):
        for k in range(p.n):
            mean[k] = 0.5 * (phi[shape.left[j], k] + phi[shape.right[j], k])
        turbulence_of_cells(p, edges[j, 0], edges[j, 1], mean, out[0, j], out[1, j])
    return out


@kernel
def table_of(shape: RowShape, told: RowTold, turbulence: Floats) -> Floats:
    """What grains are told of the cells of the segments, shape (n_segment, n, 8 or 12).

    `turbulence`, of `turbulence_at_stations`, goes to U_TAU_SQUARE and DRIFT; of the length 0 without
    fluctuations. PUSH and MOVES, for `press_grains`, are there with a pressure of its own.
    """
    turbulent = len(turbulence) > 0
    wide = turbulent or shape.own
    table = np.zeros((told.phi.shape[0], told.phi.shape[1], 3 * FOUR if wide else 2 * FOUR))
    of_both_stations(shape, told.u_free, table[:, :, 0])
    of_both_stations(shape, told.stations[:, ROW_SHEAR], table[:, :, 2])
    of_both_stations(shape, told.stations[:, ROW_DU_DT], table[:, :, 4])
    of_both_stations(shape, told.stations[:, ROW_DTAU_DZ], table[:, :, 5])
    if turbulent:
        of_both_stations(shape, turbulence[0], table[:, :, U_TAU_SQUARE])
        of_both_stations(shape, turbulence[1], table[:, :, DRIFT])
    for i in range(len(table)):
        for k in range(table.shape[1]):
            table[i, k, 1], table[i, k, 3] = told.w[i, k], told.phi[i, k]
            table[i, k, 6] = told.force_z[i, k] / max(1.0 - told.phi[i, k], 1.0 - DENSEST)
    return table


@kernel
def means_at_grains(
    p: ColumnParameters, shape: RowShape, cut: SliceArrays, places: GrainPlaces, told: RowTold,
    table: Floats, met: MetByGrains,
) -> Floats:  # fmt: skip
    """Means over each grain of what it is told of the water, as `sample` takes them; `met` is overwritten.

    `table` is that of `table_of`, whose columns the means have.
    """
    at = means_of_segments(cut, places, told.wet, table, met.submerged, met.per)
    gradients_at_grains(shape, cut, places, told.gradient, -p.rho_w * p.g_x, met.gradient)
    for i in range(len(at)):
        met.u[i] = at[i, 0]
        if shape.own:
            met.push[i], met.moves[i] = at[i, PUSH], at[i, MOVES]
            met.drift[i] = at[i, DRIFT]
        at[i, 1] += at[i, 0] * places.tilt[i]
        at[i, 5] += met.gradient[i]
    return at
