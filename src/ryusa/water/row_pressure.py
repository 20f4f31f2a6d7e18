"""Pressure of a row beyond the hydrostatic one: vertical speed at the faces, and the push on the stations.

P is p'/rho, p' the pressure beyond the hydrostatic one, in the full cells of each segment, those below the
cell of the surface. W is the vertical speed at the faces between them; the control volume of the uppermost
reaches up to the surface. Between its last full cell and the surface P falls on a straight line to zero.
Order of a step, and why each choice: design/0030.
"""

from typing import NamedTuple

import numpy as np

from ryusa.model.row import INFLOW, OPEN
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.exchange import Ints
from ryusa.water.limiter import limited
from ryusa.water.row_layout import NappeArrays, RowMatrix, RowShape, RowWater
from ryusa.water.row_multigrid import Multigrid
from ryusa.water.row_nappe import give_momentum
from ryusa.water.row_pressure_grains import PressedGrains, divide_grains
from ryusa.water.row_station import StationArrays


class PressureArrays(NamedTuple):
    """State of the pressure and work arrays of a step; faces have shape (n_all, n + 1)."""

    w: Floats  # vertical speed at the faces [m/s]: at the bottom that along it, above the top that of the top
    p: Floats  # P in the full cells, 0 in others [m2/s2], shape (n_all, n)
    tilt: Floats  # slope of the bottom at each station, shape (n_station,)
    sloped: bool  # whether any is not 0
    top: Ints  # cell of the surface of each segment; below the lowest open one where it is dry
    before: Ints  # that before the step
    next_w: Floats  # predicted W
    part: Floats  # water of the control volume of a face [m]
    gap: Floats  # distance over which P changes at a face [m]
    pull: Floats  # speed that a face gains by a difference of P [s/m]
    drag: Floats  # of a porous solid and of fixed grains on a face, over its water [1/s]
    nu: Floats  # viscosity of the cells, that of turbulence too [m2/s], shape (n_all, n)
    push: Floats  # force of P on a cell of a station, over density and length [m2/s2], (n_station, n)
    force: Floats  # the same as `Sources` takes it [N/m3]
    star: Floats  # speed at the stations before the projection [m/s]
    gain: Floats  # speed that a station gains by a difference of P [s/m]
    damp: Floats  # drag of both at a station, over its water [1/s]
    feel: Floats  # difference that a station feels of the rise of P in inclined cells [m2/s2]
    change: Floats  # of the speed there [m/s]
    a_x: Floats  # couplings of the system [1/s], shape (n_station, n)
    a_z: Floats
    diagonal: Floats  # shape (n_all, n), and so the next
    right: Floats
    found: Floats
    r: Floats
    z: Floats
    d: Floats
    y: Floats
    slope: Floats  # difference of P over `gap` at the faces [m/s2]
    within: Floats  # its mean in the cells, shape (n_all, n)
    thick: Floats  # P times the wet thickness of the cells [m3/s2]
    rub: Floats  # upward momentum that viscosity brings, over density [m3/s2], shape (n_station, n + 1)
    passed: Floats  # the same that flows along x carries
    brought: Floats  # W that a cell of a station carries to the faces below and above it, (2, n_station, n)
    grids: Multigrid
    grains: PressedGrains

    @staticmethod
    def of(shape: RowShape, n: int) -> "PressureArrays":
        """Arrays of a row whose pressure is nowhere but hydrostatic."""
        stations, segments = len(shape.left), len(shape.bottom)
        tilt = (shape.bottom[shape.right] - shape.bottom[shape.left]) / shape.dx
        cells, faces, at = (segments, n), (segments, n + 1), (stations, n)
        shapes = [*[faces] * 5, cells, *[at] * 8, faces, *[cells] * 7, faces, cells, cells]
        shapes += [(stations, n + 1), (stations, n + 1), (2, *at)]
        return PressureArrays(
            np.zeros(faces), np.zeros(cells), tilt, bool((tilt != 0.0).any()),
            np.zeros(segments, np.int64), np.zeros(segments, np.int64), *map(np.zeros, shapes),
            grids=Multigrid.of(shape.inner[1] - shape.inner[0], n),
            grains=PressedGrains.none(stations, segments, n),
        )  # fmt: skip


@kernel
def find_tops(shape: RowShape, wet: Floats, top: Ints) -> None:
    """Find the cell of the surface of each segment."""
    for i in range(len(top)):
        top[i] = shape.first[i] - 1
        for k in range(shape.first[i], wet.shape[1]):
            if wet[i, k] > 0.0:
                top[i] = k


@kernel
def fill_new_cells(p: ColumnParameters, shape: RowShape, wet: Floats, a: PressureArrays) -> None:
    """Give the cells that have become full the pressure of the line to the surface; 0 above the full ones."""
    for i in range(len(a.top)):
        for k in range(max(a.before[i], shape.first[i]), a.top[i]):
            a.p[i, k] = 0.0
            if k > shape.first[i]:
                room = (a.top[i] - k - 0.5) * p.dz + wet[i, a.top[i]]
                a.p[i, k] = a.p[i, k - 1] * room / (room + p.dz)
        for k in range(max(a.top[i], 0), p.n):
            a.p[i, k] = 0.0


@kernel
def viscosities(p: ColumnParameters, shape: RowShape, faces: Floats, nu: Floats) -> float:
    """Viscosity in the cells by the eddy viscosities of the stations beside; the largest returned [m2/s].

    `faces` are stresses and eddy viscosities at the stations after the last step, (n_station, 2, n + 1).
    """
    most = 0.0
    for i in range(len(nu)):
        west, east = shape.west[i], shape.east[i]
        for k in range(p.n):
            eddies = faces[west, 1, k] + faces[west, 1, k + 1] + faces[east, 1, k] + faces[east, 1, k + 1]
            nu[i, k] = p.nu + 0.25 * eddies
            most = max(most, nu[i, k])
    return most


@kernel
def carry_along(shape: RowShape, dt: float, water: RowWater, work: StationArrays, nu: Floats) -> None:
    """Momentum through the middle of each segment: what flows carries, with a limited slope, and viscosity.

    Overwrites `carried` and the speeds of the energy account, as `continuity` wrote them.
    """
    u, flux = water.u, work.flux
    for i in range(len(shape.bottom)):
        west, east = shape.west[i], shape.east[i]
        before, after = shape.west[shape.left[west]], shape.east[shape.right[east]]
        inner = shape.inner[0] <= i < shape.inner[1]
        for k in range(u.shape[1]):
            through = 0.5 * (flux[west, k] + flux[east, k])
            speed = u[west, k] if through > 0.0 else u[east, k]
            if inner and through > 0.0:
                slope = limited(u[west, k] - u[before, k], u[east, k] - u[west, k])
                speed += 0.5 * max(1.0 - abs(u[west, k]) * dt / shape.dx, 0.0) * slope
            elif inner and through < 0.0:
                slope = limited(u[east, k] - u[west, k], u[after, k] - u[east, k])
                speed -= 0.5 * max(1.0 - abs(u[east, k]) * dt / shape.dx, 0.0) * slope
            work.carried[i, k] = through * speed
            work.energy.through[i, k], work.energy.speed[i, k] = through, speed
            if inner:
                work.carried[i, k] -= water.content[i, k] * nu[i, k] * (u[east, k] - u[west, k]) / shape.dx


@kernel
def divide_among_faces(p: ColumnParameters, shape: RowShape, water: RowWater, a: PressureArrays) -> None:
    """Water and height of the control volumes of the faces, into `part` and `gap`."""
    a.part[:], a.gap[:] = 0.0, 0.0
    for i in range(shape.inner[0], shape.inner[1]):
        top = a.top[i]
        for f in range(shape.first[i] + 1, top + 1):
            a.part[i, f] = 0.5 * (water.content[i, f - 1] + water.content[i, f])
            a.gap[i, f] = p.dz if f < top else 0.5 * p.dz + water.wet[i, top]
        if top > shape.first[i]:
            a.part[i, top] += 0.5 * water.content[i, top]
        if a.grains.yields[0] > 0.0:
            divide_grains(shape, water.wet[i], top, i, a.grains)


@kernel
def slopes_of(shape: RowShape, x: Floats, a: PressureArrays) -> None:
    """Rise of x upwards at the faces of the row, into `slope`, and its mean in the cells, into `within`.

    The bottom of a segment has no face of its own, and in the cell of the surface x goes on as below it.
    """
    a.slope[:], a.within[:] = 0.0, 0.0
    for i in range(shape.inner[0], shape.inner[1]):
        first, top = shape.first[i], a.top[i]
        for f in range(first + 1, top + 1):
            above = x[i, f] if f < top else 0.0
            a.slope[i, f] = (above - x[i, f - 1]) / a.gap[i, f]
            a.within[i, f - 1] = 0.5 * (a.slope[i, f - 1] + a.slope[i, f])
        if top > first:
            a.within[i, top] = a.slope[i, top]


@kernel
def weigh_with_thickness(p: ColumnParameters, shape: RowShape, wet: Floats, a: PressureArrays) -> None:
    """P times the wet thickness of the cells, into `thick`; in that of the surface by the line to zero."""
    a.thick[:] = 0.0
    for i in range(len(a.top)):
        first, top = shape.first[i], a.top[i]
        for k in range(first, top):
            a.thick[i, k] = a.p[i, k] * p.dz
        if top > first:
            h = wet[i, top]
            a.thick[i, top] = 0.5 * h * h * a.p[i, top - 1] / (h + 0.5 * p.dz)


@kernel
def rise_along(shape: RowShape, wet: Floats, j: int, k: int, a: PressureArrays) -> float:
    """Rise of P along x in a cell of a station, times its wet thickness [m2/s2].

    Of each segment beside, the wet thickness times P: what neighbours give to each other cancels, and what is
    left acts on steps and on the bottom.
    """
    left, right = shape.left[j], shape.right[j]
    rise = (a.thick[right, k] - a.thick[left, k]) / shape.dx
    if a.tilt[j] != 0.0:
        within = wet[left, k] * a.within[left, k] + wet[right, k] * a.within[right, k]
        rise -= 0.5 * a.tilt[j] * within
    return float(rise)


@kernel
def push_stations(
    p: ColumnParameters, shape: RowShape, given: Floats, water: RowWater, a: PressureArrays
) -> None:
    """Force of P on the stations, beside the forces `given` by grains [N/m3], both (n_station, n).

    Water takes the share of its content, grains the other.
    """
    weigh_with_thickness(p, shape, water.wet, a)
    if a.sloped:
        slopes_of(shape, a.p, a)
    for j in range(len(shape.left)):
        left, right = shape.left[j], shape.right[j]
        a.push[j, :], a.force[j, :] = 0.0, given[j]
        if shape.kind[j] != OPEN:
            continue
        for k in range(max(shape.first[left], shape.first[right]), p.n):
            h = 0.5 * (water.wet[left, k] + water.wet[right, k])
            if h <= 0.0:
                break
            share = 0.5 * (water.content[left, k] + water.content[right, k]) / h
            a.push[j, k] = -rise_along(shape, water.wet, j, k, a) * share
            a.force[j, k] -= p.rho_w * a.push[j, k] / p.dz


@kernel
def find_rises(p: ColumnParameters, shape: RowShape, wet: Floats, a: PressureArrays) -> None:
    """Rise of P [m/s2]: along x at the stations into `push`, upwards in the cells into `within`."""
    find_tops(shape, wet, a.top)
    for i in range(shape.inner[0], shape.inner[1]):
        for f in range(shape.first[i] + 1, a.top[i] + 1):
            a.gap[i, f] = p.dz if f < a.top[i] else 0.5 * p.dz + wet[i, f]
    weigh_with_thickness(p, shape, wet, a)
    slopes_of(shape, a.p, a)
    for j in range(len(shape.left)):
        left, right = shape.left[j], shape.right[j]
        a.push[j, :] = 0.0
        for k in range(max(shape.first[left], shape.first[right]), p.n):
            h = 0.5 * (wet[left, k] + wet[right, k])
            if h > 0.0 and shape.kind[j] == OPEN:
                a.push[j, k] = rise_along(shape, wet, j, k, a) / h


@kernel
def carry_w(
    p: ColumnParameters, shape: RowShape, dt: float, water: RowWater, work: StationArrays, a: PressureArrays
) -> None:
    """What passes each station of the upward momentum: W that the flow carries, and what viscosity brings."""
    for j in range(len(shape.left)):
        left, right = shape.left[j], shape.right[j]
        a.rub[j, :], a.passed[j, :] = 0.0, 0.0
        for k in range(p.n):
            flow = work.flux[j, k]
            up = left if flow > 0.0 else right
            before, after = shape.left[shape.west[up]], shape.right[shape.east[up]]
            half = 0.5 * max(1.0 - abs(water.u[j, k]) * dt / shape.dx, 0.0)
            content = 0.5 * (water.content[left, k] + water.content[right, k])
            rubs = 0.25 * content * (a.nu[left, k] + a.nu[right, k]) / shape.dx
            for side in range(2):
                f = k + side
                slope = limited(a.w[up, f] - a.w[before, f], a.w[after, f] - a.w[up, f])
                speed = a.w[up, f] + (half if flow > 0.0 else -half) * slope
                a.brought[side, j, k] = speed
                a.passed[j, f] += 0.5 * flow * speed
                if shape.kind[j] == OPEN:
                    a.rub[j, f] -= rubs * (a.w[right, f] - a.w[left, f])


@kernel
def gather_w(
    p: ColumnParameters, shape: RowShape, dt: float, water: RowWater, work: StationArrays, a:
    PressureArrays, i: int, right: Floats,
) -> None:  # fmt: skip
    """Momentum of the faces of a segment before stresses and pressure, over density [m2/s], into `right`."""
    first, top, n, per = shape.first[i], a.top[i], p.n, dt / shape.dx
    west, east, given = shape.west[i], shape.east[i], a.grains.force[i]
    for f in range(first + 1, n):
        right[f] = 0.5 * (work.old[i, f - 1] + work.old[i, f]) * a.w[i, f]
        right[f] += per * (a.passed[west, f] + a.rub[west, f] - a.passed[east, f] - a.rub[east, f])
        right[f] -= dt * p.dz / p.rho_w * 0.5 * (given[f - 1] + given[f])
    for f in range(top + 1, n):  # the uppermost face has all above it
        right[top] += right[f]
    right[top] += 0.5 * work.old[i, n - 1] * a.w[i, n]
    right[top] += per * (a.passed[west, n] + a.rub[west, n] - a.passed[east, n] - a.rub[east, n])
    right[top] -= dt * p.dz / p.rho_w * 0.5 * given[n - 1]


@kernel
def predict_w(
    p: ColumnParameters, shape: RowShape, dt: float, matrix: RowMatrix, water: RowWater, work: StationArrays,
    a: PressureArrays, nappe: NappeArrays | None,
) -> None:  # fmt: skip
    """Predict W of each segment with the pressure of the last step: explicit along x, implicit along z.

    Notes
    -----
    The water of a face is half of each cell beside it, of the uppermost all of the cell of the surface. Old
    water has the speed of the face to which it belonged, so that momentum is kept when the surface changes
    its cell; what comes along x has that of the segment upstream with a limited slope.
    """
    for i in range(shape.inner[0], shape.inner[1]):
        first, top = shape.first[i], a.top[i]
        bottom = along_bottom(shape, water.u, a.tilt, i)
        a.next_w[i, :] = bottom
        a.pull[i, :], a.drag[i, :] = 0.0, 0.0
        if top <= first:
            continue
        low, middle, high, right = work.step.a, work.step.b, work.step.c, work.step.r
        gather_w(p, shape, dt, water, work, a, i, right)
        if nappe is not None:
            right[top] += dt * nappe.upwards[i]
        per_dt, per_dz2 = 1.0 / dt, 1.0 / p.dz**2
        for f in range(first + 1, top + 1):
            k, part, per_gap = f - 1, a.part[i, f], 1.0 / a.gap[i, f]  # the row of the system, and the water
            below = 0.5 * (work.q[i, f - 1] + work.q[i, f])
            above = 0.5 * (work.q[i, f] + work.q[i, f + 1]) if f < top else 0.0
            drag = matrix.linear[i, k] + matrix.linear[i, f]
            drag += (matrix.quadratic[i, k] + matrix.quadratic[i, f]) * abs(a.w[i, f])
            fixed = a.grains.drag[i, k] + a.grains.drag[i, f] * (1.0 if f < top else 2.0)
            a.drag[i, f] = 0.5 * (a.gap[i, f] * drag + p.dz / p.rho_w * fixed) / part
            under = water.content[i, k] * a.nu[i, k] * per_dz2
            over = water.content[i, f] * a.nu[i, f] * per_dz2 if f < top else 0.0
            low[k] = -max(below, 0.0) - under
            high[k] = min(above, 0.0) - over
            middle[k] = part * (per_dt + a.drag[i, f]) + max(above, 0.0) - min(below, 0.0) + under + over
            rise = (a.p[i, f] if f < top else 0.0) - a.p[i, k]
            right[k] = right[f] * per_dt - rise * part * per_gap
            a.pull[i, f] = dt / (1.0 + a.drag[i, f] * dt) * per_gap
        right[first] -= low[first] * bottom
        for k in range(first + 1, top):
            middle[k - 1] = 1.0 / middle[k - 1]
            e = low[k] * middle[k - 1]
            middle[k] -= e * high[k - 1]
            right[k] -= e * right[k - 1]
        a.next_w[i, top] = right[top - 1] / middle[top - 1]
        for f in range(top - 1, first, -1):
            a.next_w[i, f] = (right[f - 1] - high[f - 1] * a.next_w[i, f + 1]) * middle[f - 1]
        for f in range(top + 1, p.n + 1):
            a.next_w[i, f] = a.next_w[i, top]


@kernel
def along_bottom(shape: RowShape, u: Floats, tilt: Floats, i: int) -> float:
    """Vertical speed of the water that follows the bottom of a segment [m/s]."""
    west, east, k = shape.west[i], shape.east[i], shape.first[i]
    return float(0.5 * (tilt[west] * u[west, k] + tilt[east] * u[east, k]))


@kernel
def begin_pressure(
    p: ColumnParameters, shape: RowShape, dt: float, matrix: RowMatrix, given: Floats, water: RowWater,
    work: StationArrays, a: PressureArrays, nappe: NappeArrays | None,
) -> None:  # fmt: skip
    """All that the pressure has to do once the surface has moved, before the stations are solved."""
    find_tops(shape, water.wet, a.top)
    fill_new_cells(p, shape, water.wet, a)
    divide_among_faces(p, shape, water, a)
    carry_along(shape, dt, water, work, a.nu)
    push_stations(p, shape, given, water, a)
    give_momentum(p, shape, a.top, a.force, nappe)
    carry_w(p, shape, dt, water, work, a)
    predict_w(p, shape, dt, matrix, water, work, a, nappe)


@kernel
def keep_w(shape: RowShape, u: Floats, a: PressureArrays) -> None:
    """Take over W; beyond an open end it is as in the last segment, at an inlet that along the bottom."""
    low, high = shape.inner
    for i in range(low, high):
        a.w[i] = a.next_w[i]
    if high - low < len(shape.bottom):
        a.w[low - 1], a.w[high] = 0.0, 0.0
        if shape.kind[0] == OPEN:
            a.w[low - 1] = a.w[low]
        elif shape.kind[0] == INFLOW:
            for f in range(a.w.shape[1]):
                a.w[low - 1, f] = a.tilt[0] * u[0, min(f, u.shape[1] - 1)]
        if shape.kind[len(shape.kind) - 1] == OPEN:
            a.w[high] = a.w[high - 1]
