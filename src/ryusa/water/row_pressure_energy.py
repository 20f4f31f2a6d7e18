"""Compiled energy and momentum account of what the pressure adds to a row; terms as in `row_energy`.

The balance of a face of a segment times W of the new time gives the change of its kinetic energy, as that of
a cell of a station does. The work of the pressure on U and on W cancels but for the cell of the surface and a
change of (dt grad P)**2/2 that adds up to nothing; both are booked as SURFACE. Derivation: design/0030.
"""

from ryusa.model.row import OPEN
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel, sums
from ryusa.water.momentum_balance import B_CHANGE, B_DRIVER, B_GRAINS
from ryusa.water.row_energy import (
    DOWNSTREAM,
    FALL,
    GRAINS,
    KINETIC,
    LATE,
    POROUS,
    SHEAR,
    SURFACE,
    UPSTREAM,
    UPWIND,
)
from ryusa.water.row_layout import RowShape, RowWater
from ryusa.water.row_pressure import PressureArrays, divide_among_faces, find_tops
from ryusa.water.row_station import StationArrays


@kernel
def add_held_upwards(
    p: ColumnParameters, shape: RowShape, water: RowWater, times: float, a: PressureArrays, books: Floats
) -> None:
    """Add the kinetic energy of W to the account, `times` 1 or -1."""
    find_tops(shape, water.wet, a.top)
    divide_among_faces(p, shape, water, a)
    total = 0.0
    for i in range(shape.inner[0], shape.inner[1]):
        for f in range(shape.first[i] + 1, a.top[i] + 1):
            total += a.part[i, f] * a.w[i, f] ** 2
    books[KINETIC] += times * 0.5 * p.rho_w * shape.dx * total


@sums
def held_before(first: int, before: int, old: Floats, w: Floats) -> float:
    """Twice the kinetic energy of W in a segment before the step, over density and area [m3/s2]."""
    total = 0.0
    if before > first:
        for f in range(first + 1, before + 1):
            total += 0.5 * (old[f - 1] + old[f]) * w[f] ** 2
        total += 0.5 * old[before] * w[before] ** 2
    return total


@kernel
def book_faces(
    p: ColumnParameters, shape: RowShape, dt: float, work: StationArrays, water: RowWater, a: PressureArrays,
    books: Floats,
) -> None:  # fmt: skip
    """Add what the predicted step of W loses, and the work of the pressure of the last step on it.

    Notes
    -----
    Water that brings W to a face which then has another loses (1/2) |Q| (dW)**2; that of the lowest half cell
    follows the bottom and has no energy of its own: what it gives or takes is a FALL.
    """
    # One function: the pieces of a face, each with its own speed, are those of `gather_w`
    late, upwind, fall, shear, porous, surface, ends, grains = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    per, last = dt / shape.dx, shape.inner[1] - 1
    for i in range(shape.inner[0], shape.inner[1]):
        first, top, w = shape.first[i], a.top[i], a.next_w[i]
        west, east = shape.west[i], shape.east[i]
        fall += held_before(first, a.before[i], work.old[i], a.w[i])
        if top <= first:
            continue
        for k in range(first, p.n):
            for side in range(2):
                f = min(k + side, top)
                if f <= first:
                    continue
                old = 0.5 * work.old[i, k]
                late += old * (w[f] - a.w[i, k + side]) ** 2
                fall -= old * a.w[i, k + side] ** 2
                for j, sign in ((west, per), (east, -per)):
                    flow, brought = sign * 0.5 * work.flux[j, k], a.brought[side, j, k]
                    upwind += flow * (brought - w[f]) ** 2
                    fall -= flow * brought**2
                    if i == shape.inner[0] and j == west and len(shape.kind) != len(shape.bottom):
                        books[UPSTREAM] += 0.5 * p.rho_w * shape.dx * flow * brought**2
                        ends += flow * brought**2
                    elif i == last and j == east and len(shape.kind) != len(shape.bottom):
                        books[DOWNSTREAM] += 0.5 * p.rho_w * shape.dx * flow * brought**2
                        ends += flow * brought**2
        for f in range(first + 1, p.n + 1):
            shear -= 2.0 * per * (a.rub[west, f] - a.rub[east, f]) * w[min(f, top)]
        for f in range(first + 1, top + 1):
            flow = 0.5 * (work.q[i, f - 1] + work.q[i, f])
            rubs = water.content[i, f - 1] * a.nu[i, f - 1] / p.dz**2
            if f > first + 1:
                upwind += dt * abs(flow) * (w[f] - w[f - 1]) ** 2
                shear += 2.0 * dt * rubs * (w[f] - w[f - 1]) ** 2
            else:
                up = w[first] if flow > 0.0 else w[f]
                upwind += dt * flow * (up - w[f]) ** 2
                fall -= dt * flow * up**2
                shear += 2.0 * dt * rubs * (w[f] - w[first]) * w[f]
            porous += 2.0 * dt * a.part[i, f] * a.drag[i, f] * w[f] ** 2
            given = a.grains.force[i, f - 1] + a.grains.force[i, f] * (1.0 if f < top else 2.0)
            for k in range(f + 1, p.n if f == top else 0):  # cells that have fallen dry in the interval
                given += 2.0 * a.grains.force[i, k]
            grains -= dt * p.dz / p.rho_w * given * w[f]
            rise = (a.p[i, f] if f < top else 0.0) - a.p[i, f - 1]
            surface += 2.0 * dt * rise * a.part[i, f] / a.gap[i, f] * w[f]
    half = 0.5 * p.rho_w * shape.dx
    books[LATE] += half * late
    books[UPWIND] += half * upwind
    books[FALL] += half * (fall + ends)
    books[SHEAR] += half * shear
    books[POROUS] += half * porous
    books[GRAINS] += half * grains
    books[SURFACE] += half * surface


@kernel
def book_push(
    p: ColumnParameters, shape: RowShape, dt: float, laden: bool, work: StationArrays, water: RowWater,
    a: PressureArrays, books: Floats, out: Floats,
) -> None:  # fmt: skip
    """Add what pressure, viscosity along x and the limited slopes do at the stations in the predicted step.

    To be called with the old speeds in `water` and the new ones in `work`. In `out` the push of the pressure
    goes from the grains, among whose forces it was given, to the driver.
    """
    per, half = 1.0 / shape.dx, 0.5 * p.rho_w * dt
    for j in range(len(shape.left)):
        if shape.kind[j] != OPEN:
            continue
        left, right = shape.left[j], shape.right[j]
        pushed, work_done, carried = 0.0, 0.0, 0.0
        for k in range(max(shape.first[left], shape.first[right]), work.last[j] + 1):
            u, old = work.solved[j, k], water.u[j, k]
            pushed += a.push[j, k]
            work_done += a.push[j, k] * u
            go, come = work.energy.through[right, k], work.energy.through[left, k]
            if go > 0.0:
                carried -= go * ((work.energy.speed[right, k] - u) ** 2 - (old - u) ** 2)
            if come < 0.0:
                carried += come * ((work.energy.speed[left, k] - u) ** 2 - (old - u) ** 2)
        books[UPWIND] += half * carried
        books[SURFACE] -= p.rho_w * shape.dx * dt * work_done
        if laden:
            books[GRAINS] -= p.rho_w * shape.dx * dt * work_done
        out[j, B_DRIVER] += p.rho_w * pushed
        out[j, B_GRAINS] -= p.rho_w * pushed
    rubbed = 0.0
    for i in range(shape.inner[0], shape.inner[1]):
        west, east = shape.west[i], shape.east[i]
        for k in range(p.n):
            rubs = water.content[i, k] * a.nu[i, k] * (water.u[east, k] - water.u[west, k]) * per
            if rubs != 0.0:
                here = work.u[west, k] if shape.kind[west] == OPEN else 0.0
                there = work.u[east, k] if shape.kind[east] == OPEN else 0.0
                rubbed += rubs * (there - here)
    books[SHEAR] += p.rho_w * dt * rubbed


@kernel
def book_projection(
    p: ColumnParameters, shape: RowShape, dt: float, water: RowWater, a: PressureArrays, books: Floats,
    rows: Floats, out: Floats,
) -> None:  # fmt: skip
    """Add what the change of the pressure does to U and W, and let profiles and budgets have the final U."""
    surface, porous = 0.0, 0.0
    for j in range(len(shape.left)):
        if shape.kind[j] != OPEN:
            continue
        left, right, change, dragged = shape.left[j], shape.right[j], 0.0, 0.0
        for k in range(p.n):
            gains = water.u[j, k] - a.star[j, k]
            rows[j, 0, k] = water.u[j, k]
            if a.gain[j, k] == 0.0:
                continue
            rows[j, 4, k] += gains / dt
            moves = 0.5 * (water.content[left, k] + water.content[right, k]) * gains
            mean = 0.5 * (water.u[j, k] + a.star[j, k])
            drag = a.damp[j, k] * dt * moves
            surface -= (moves + drag) * mean
            porous += drag * mean
            change += moves / dt
            dragged += drag / dt
        out[j, B_CHANGE] += p.rho_w * change
        out[j, B_GRAINS] -= p.rho_w * dragged
        out[j, B_DRIVER] += p.rho_w * (change + dragged)
    for i in range(shape.inner[0], shape.inner[1]):
        for f in range(shape.first[i] + 1, a.top[i] + 1):
            above = a.found[i, f] if f < a.top[i] else 0.0
            gains = -a.pull[i, f] * (above - a.found[i, f - 1])
            mean = a.next_w[i, f] - 0.5 * gains
            moves = a.part[i, f] * gains
            drag = a.drag[i, f] * dt * moves
            surface -= (moves + drag) * mean
            porous += drag * mean
    books[SURFACE] += p.rho_w * shape.dx * surface
    books[POROUS] += p.rho_w * shape.dx * porous
