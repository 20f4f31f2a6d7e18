"""Free fall of water over an aerated sill within a row: where it lands, and what it brings there.

A row is opened behind each aerated sill: a segment that stays empty, the air, and a wall station lie between
the sill and the pool. While the pool is below the sill the last station of the sill ends in the air, as at a
free fall, and the pool begins at a wall; each cell of the water that passes flies on as a parcel, and the
same volume and momentum enter the surface of the pool in the same step. Once the pool has risen above the
sill, that station joins both as elsewhere. Energy that the fall loses is a FALL. Derivation: design/0030.
"""

import math
from dataclasses import replace

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.model.row import OPEN, WALL, ColumnRow, PorousSolid, RowState
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.exchange import Ints
from ryusa.water.momentum_balance import B_ADVECTED, B_GRAINS
from ryusa.water.row_energy import FALL, GRAINS, SURFACE, height_at, lag_of_surface
from ryusa.water.row_layout import NappeArrays, RowGrains, RowShape, RowWater
from ryusa.water.row_station import StationArrays

LANDED, BEYOND, STRIKES = range(3)  # what becomes of a parcel; the last two are faults


def nappes_of(row: ColumnRow, shape: RowShape) -> NappeArrays | None:
    """Arrays for the opened shape of a row with a pressure of its own, aerated sills or not; else None.

    A row without such a sill takes the same compiled step as one with: its lists are empty.
    """
    if row.hydrostatic:
        return None
    air = air_of(row)
    n_all, n = len(shape.bottom), row.column.n
    is_air = np.zeros(n_all, np.int64)
    is_air[air] = 1
    lands, along, upwards = np.zeros((3, n_all))
    free, given = np.zeros(len(air), np.int64), np.zeros((len(shape.left), n))
    return NappeArrays(air, is_air, free, np.zeros(len(air)), lands, along, upwards, given, np.zeros(n))


def behind_of(row: ColumnRow) -> Ints:
    """Number of the segment behind each aerated sill among all that a state holds, from upstream on."""
    return np.array(sorted(dam.end for dam in row.dams if dam.aerated), np.int64) + row.inner.start


def air_of(row: ColumnRow) -> Ints:
    """Numbers of the segments of air in the opened row; those of the wall stations are the same."""
    behind = behind_of(row)
    return behind + np.arange(len(behind))


def opened(row: ColumnRow) -> ColumnRow:
    """The row with a segment of air behind each aerated sill, and without the names of its dams."""
    at = behind_of(row) - row.inner.start
    if not len(at):
        return row
    solid = None if row.solid is None else np.insert(row.solid, at, 0)
    return replace(row, bottom=np.insert(row.bottom, at, row.bottom[at]), solid=solid, dams=())


def with_air(shape: RowShape, air: Ints) -> RowShape:
    """The shape of an opened row with its segments of air and its walls, nothing falling yet."""
    for g in air.tolist():
        shape.kind[g], shape.left[g], shape.east[g] = WALL, g + 1, g - 1
    return shape


def open_values(row: ColumnRow, values: Floats) -> Floats:
    """Values of the segments or stations of a row, and 0 in the air and at the walls of the opened row."""
    behind = behind_of(row)
    return np.insert(values, behind, 0.0, axis=0) if len(behind) else values


def open_solid(row: ColumnRow, solid: PorousSolid) -> PorousSolid:
    """A porous solid in a row with aerated sills as one in the opened row."""
    behind = behind_of(row) - row.inner.start
    return PorousSolid(*(np.insert(one, behind, 0.0, axis=0) for one in vars(solid).values()))


def open_state(row: ColumnRow, state: RowState) -> RowState:
    """The state of a row with aerated sills as that of the opened row; the state itself without any."""
    air = air_of(row)
    if not len(air):
        return state
    along = ("u", "passed", "edges", "profiles", "budgets")
    names = (*along, "volume", "content", "wet", "surface", "w", "pressure")
    found = {name: open_values(row, one) for name in names if (one := getattr(state, name)) is not None}
    found["surface"][air] = row.column.z_low
    return replace(state, **found)


def closed(values: Floats, air: Ints) -> Floats:
    """Values of the segments or stations of an opened row without those of air and the walls behind."""
    return np.delete(values, air, axis=0) if len(air) else values


@kernel
def hang(
    p: ColumnParameters, shape: RowShape, water: RowWater, after: bool, nappe: NappeArrays | None,
    books: Floats,
) -> None:  # fmt: skip
    """Let each sill end in the air, or join it to the pool that has risen above it, by the present surface.

    Notes
    -----
    With `after` a step, water of a pool that has just reached over the sill is at rest there, and the speed
    of the station is that of both together.
    """
    if nappe is None:
        return
    for s in range(len(nappe.air)):
        air = nappe.air[s]
        j, sill, pool = air - 1, air - 1, air + 1
        low = max(shape.first[sill], shape.first[pool])
        free = 1 if water.surface[pool] <= p.z_low + low * p.dz else 0
        if after and free == 0 and nappe.free[s] == 1:
            for k in range(low, p.n):
                mine, u = water.content[sill, k], water.u[j, k]
                both = mine + water.content[pool, k]
                if both > mine:
                    water.u[j, k] = mine / both * u
                    lost = mine * u**2 - both * water.u[j, k] ** 2
                    books[FALL] += 0.25 * p.rho_w * shape.dx * shape.inertia[j] * lost
        nappe.free[s] = free
        shape.right[j] = air if free == 1 else pool
        shape.west[pool] = air if free == 1 else j


@kernel
def meet(a: float, b: float, c: float, u: float, g_x: float) -> tuple[float, float]:
    """Time at which a c + b t + a t**2 that falls is 0, and the way along x until then; inf if never."""
    inside = b * b - 4.0 * a * c
    if a >= 0.0:
        return math.inf, math.inf
    if inside < 0.0:  # below from the begin
        return 0.0, 0.0
    t = max((-b - math.sqrt(inside)) / (2.0 * a), 0.0)
    return t, u * t + 0.5 * g_x * t * t


@kernel
def landing(
    p: ColumnParameters, shape: RowShape, water: RowWater, sill: int, z: float, u: float, w: float,
    is_air: Ints,
) -> tuple[int, int, int, float, float]:  # fmt: skip
    """Where a parcel that leaves a sill meets the surface.

    Parameters
    ----------
    sill : last segment of the sill, with one of air behind it.
    z : height of the parcel over the x axis at the downstream end of that segment [m].
    u, w : its speeds along and normal to the x axis [m/s]; u > 0.

    Returns
    -------
    what : LANDED, BEYOND the end of the row, or it STRIKES the face of a dam.
    before, i : the segments between whose middles it lands; the same one where it lands on no line between.
    part : share of the segment `i` in it.
    t : time of its fall [s].

    Notes
    -----
    The surface is straight between the middles of segments, and level where the lowest open cell changes, at
    a wall and at an end. Air does not hinder, and gravity along the axis speeds the parcel up.
    """
    i, x, half = sill + 2, 0.5 * shape.dx, 0.5 * shape.dx
    fall = -0.5 * shape.g_z
    t, at = meet(fall, w, z - height_at(p, shape, water, i), u, p.g_x)
    if at <= x:
        return LANDED, i, i, 1.0, t
    while True:
        after = i + 1
        if after < shape.inner[1] and is_air[after] == 1:
            after += 1
        here = height_at(p, shape, water, i)
        if after >= shape.inner[1]:
            t, at = meet(fall, w, z - here, u, p.g_x)
            return LANDED if at <= x + half else BEYOND, i, i, 1.0, t
        there = height_at(p, shape, water, after)
        if shape.first[i] == shape.first[after]:
            rise = (there - here) / shape.dx
            t, at = meet(fall - 0.5 * rise * p.g_x, w - rise * u, z - here + rise * x, u, p.g_x)
            if at <= x + shape.dx:
                return LANDED, i, after, min(max((at - x) / shape.dx, 0.0), 1.0), t
        else:
            t, at = meet(fall, w, z - here, u, p.g_x)
            if at <= x + half:
                return LANDED, i, i, 1.0, t
            t = 2.0 * (x + half) / (u + math.sqrt(max(u * u + 2.0 * p.g_x * (x + half), 0.0)))
            height = z + w * t + fall * t * t
            if height < shape.bottom[after] + shape.first[after] * p.dz:
                return STRIKES, i, after, 1.0, t
            if height <= there:
                return LANDED, after, after, 1.0, t
            t, at = meet(fall, w, z - there, u, p.g_x)
            if at <= x + shape.dx:
                return LANDED, after, after, 1.0, t
        i, x = after, x + shape.dx


@kernel
def throw(
    p: ColumnParameters, shape: RowShape, water: RowWater, flux: Floats, w: Floats, nappe: NappeArrays
) -> tuple[int, int]:
    """Find where the water lands that passes aerated sills in a step, cell by cell.

    `flux` is what passes the stations [m2/s], and `w` the vertical speed at the faces [m/s] that this water
    takes along.

    Returns
    -------
    what : LANDED, or the fault of a parcel of the sill whose last segment is the second number.
    """
    if len(nappe.air) == 0:
        return LANDED, 0
    nappe.lands[:], nappe.along[:], nappe.upwards[:] = 0.0, 0.0, 0.0
    for s in range(len(nappe.air)):
        j = nappe.air[s] - 1
        w[j + 1], nappe.high[s] = w[j], 0.0
        if nappe.free[s] == 0:
            continue
        for k in range(p.n):
            flow, u = flux[j, k], water.u[j, k]
            if flow <= 0.0:
                continue
            thick = min(flow / (u * water.content[j, k]) * water.wet[j, k], p.dz)
            z = shape.bottom[j] + k * p.dz + 0.5 * thick
            up = 0.5 * (w[j, k] + w[j, k + 1])
            nappe.high[s] += flow * z
            what, before, i, part, t = landing(p, shape, water, j, z, u, up, nappe.is_air)
            if what != LANDED:
                return what, j
            for at, share in ((before, 1.0 - part), (i, part)):
                per = flow * share / shape.dx
                nappe.lands[at] += per
                nappe.along[at] += per * (u + p.g_x * t)
                nappe.upwards[at] += per * (up - shape.g_z * t)
    return LANDED, 0


@kernel
def with_landing(shape: RowShape, i: int, west: Floats, wet: Floats, nappe: NappeArrays) -> Floats:
    """What enters a segment through its upstream end and, in the cell of its surface, from above [m2/s]."""
    if not nappe.lands[i] > 0.0:
        return west
    top = -1
    for k in range(len(west)):
        nappe.row[k] = west[k]
        if wet[k] > 0.0:
            top = k
    if top >= 0:
        nappe.row[top] += nappe.lands[i] * shape.dx
    return nappe.row


@kernel
def give_momentum(
    p: ColumnParameters, shape: RowShape, top: Ints, force: Floats, nappe: NappeArrays | None
) -> None:
    """Give what lands its momentum along x to the stations beside, in the cell of the surface of its segment.

    `force` [N/m3] is what the stations are given as that of grains. Where one of both is a wall or closed at
    that height the other takes all.
    """
    if nappe is None or len(nappe.air) == 0:
        return
    nappe.given[:] = 0.0
    for i in range(shape.inner[0], shape.inner[1]):
        if not nappe.lands[i] > 0.0 or top[i] < shape.first[i]:
            continue
        k, west, east = top[i], shape.west[i], shape.east[i]
        one, two = takes(shape, west, k), takes(shape, east, k)
        for j, share in ((west, one / max(one + two, 1.0)), (east, two / max(one + two, 1.0))):
            nappe.given[j, k] += share * nappe.along[i]
            force[j, k] -= p.rho_w * share * nappe.along[i] / p.dz


@kernel
def takes(shape: RowShape, j: int, k: int) -> float:
    """1 where a station has a balance in a wet cell of a segment beside it, else 0."""
    low = max(shape.first[shape.left[j]], shape.first[shape.right[j]], 0)
    return 1.0 if shape.kind[j] == OPEN and k >= low else 0.0


@kernel
def book_nappes(
    p: ColumnParameters, shape: RowShape, dt: float, grains: RowGrains, work: StationArrays,
    water: RowWater, top: Ints, w: Floats, nappe: NappeArrays | None, books: Floats, out: Floats,
) -> None:  # fmt: skip
    """Add what the fall and the plunge lose: energy that leaves the sills less what the pool gains by it.

    To be called with the predicted speeds, of which `w` are those at the faces. What W carries over a sill is
    a FALL already. In `out` the momentum goes from the grains to what the flow brings.
    """
    if nappe is None or len(nappe.air) == 0:
        return
    weight, energy, fall = p.rho_w * shape.g_z, work.energy, 0.0
    for s in range(len(nappe.air)):
        air = nappe.air[s]
        if nappe.free[s] == 0:
            continue
        # the account has what leaves at the height that the pressure there is for, but falls from its own
        total, at = work.total[air - 1], height_at(p, shape, water, air - 1)
        fall += weight * dt * total * height_at(p, shape, water, air)
        above = weight * dt * (nappe.high[s] - total * (at - energy.push[air - 1] * shape.dx / weight))
        fall += above
        books[SURFACE] -= above
        for k in range(p.n):
            leaves = energy.through[air, k] * energy.speed[air, k] ** 2
            strikes = -energy.through[air + 1, k] * energy.speed[air + 1, k] ** 2  # the wall behind the sill
            fall += 0.5 * p.rho_w * dt * (leaves + strikes)
    area = p.rho_w * shape.dx * dt
    for j in range(len(shape.kind)):
        for k in range(p.n):
            if nappe.given[j, k] != 0.0:
                fall -= area * nappe.given[j, k] * work.solved[j, k]
                out[j, B_ADVECTED] += p.rho_w * nappe.given[j, k]
                out[j, B_GRAINS] -= p.rho_w * nappe.given[j, k]
                if grains.laden:
                    books[GRAINS] -= area * nappe.given[j, k] * work.solved[j, k]
    for i in range(shape.inner[0], shape.inner[1]):
        lands = nappe.lands[i]
        if not lands > 0.0:
            continue
        fall -= weight * dt * shape.dx * lands * height_at(p, shape, water, i)
        gain = float(-dt / shape.dx * (work.total[shape.east[i]] - work.total[shape.west[i]]))
        for amount, sign in ((gain + dt * lands, 1.0), (gain, -1.0)):  # the second is booked without it
            low = lag_of_surface(p, amount, grains.phi[i], water.content[i], water.wet[i], water.surface[i])
            books[SURFACE] += sign * weight * shape.dx * low
        for j in (shape.west[i], shape.east[i]):
            if takes(shape, j, top[i]) > 0.0:
                fall += 0.25 * area * lands * work.solved[j, top[i]] ** 2
        if top[i] > shape.first[i]:
            up = w[i, top[i]]
            fall -= area * (nappe.upwards[i] * up - 0.5 * lands * up**2)
    books[FALL] += fall
