"""Projection of a row: the change of pressure that leaves its full cells no divergence.

The flow that a difference of P drives through a border is the transpose of the difference that a speed feels,
so that the system is symmetric, and is solved by conjugate gradients. Along an inclined bottom, whose cells
follow it, a station feels the rise of P across them as well, and drives water through their faces: nine
points instead of five (design/0030).
"""

import numpy as np

from ryusa.model.row import INFLOW, OPEN, WALL
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.exchange import Ints
from ryusa.water.row_layout import RowMatrix, RowShape, RowWater
from ryusa.water.row_multigrid import precondition, set_up
from ryusa.water.row_pressure import PressureArrays, slopes_of
from ryusa.water.row_pressure_grains import mobility_along

FINE = 1.0e-6  # largest divergence that may be left, times the height of a cell, over sqrt(g dz)
ROUND_OFF = 1.0e-13  # the same over that of the predicted speeds: less cannot be had
MOST_TURNS = 40  # of conjugate gradients; more are a fault


@kernel
def couple(
    p: ColumnParameters, shape: RowShape, dt: float, matrix: RowMatrix, slope: Floats, water: RowWater,
    a: PressureArrays,
) -> None:  # fmt: skip
    """Couplings of the full cells by the predicted speeds, which are those of `water`.

    Notes
    -----
    Water leaves a cell with the content of the segment upstream, as `fluxes_along` has it. The drag of a
    porous solid, and that of fixed grains (`slope`, as in `RowGrains`), acts on the correction too, so that
    Darcy's flow is found at once. Free grains will follow the change in the next interval.
    """
    follow, yields = a.grains.yields[0] > 0.0, a.grains.yields[0]
    for j in range(len(shape.left)):
        left, right = shape.left[j], shape.right[j]
        a.a_x[j, :], a.gain[j, :], a.damp[j, :] = 0.0, 0.0, 0.0
        if shape.kind[j] != OPEN:
            continue
        for k in range(max(shape.first[left], shape.first[right]), max(a.top[left], a.top[right])):
            b, c = water.wet[left, k], water.wet[right, k]
            u = water.u[j, k]
            content = 0.5 * (water.content[left, k] + water.content[right, k])
            drag = b * (matrix.linear[left, k] + 2.0 * matrix.quadratic[left, k] * abs(u))
            drag += c * (matrix.linear[right, k] + 2.0 * matrix.quadratic[right, k] * abs(u))
            a.damp[j, k] = (0.5 * drag + slope[j, k] * p.dz / p.rho_w) / content
            a.gain[j, k] = dt / (1.0 + a.damp[j, k] * dt) * p.dz / (0.5 * (b + c)) / shape.dx
            a.a_x[j, k] = water.content[left if u > 0.0 else right, k] * a.gain[j, k] / shape.dx
            if follow:
                a.a_x[j, k] += mobility_along(shape, water.wet, j, k, a.grains) * p.dz / shape.dx
    for i in range(shape.inner[0], shape.inner[1]):
        west, east = shape.west[i], shape.east[i]
        a.a_z[i, :], a.diagonal[i, :] = 0.0, 0.0
        for f in range(shape.first[i] + 1, a.top[i] + 1):
            a.a_z[i, f] = a.part[i, f] / a.gap[i, f] * a.pull[i, f]
            if follow:
                a.a_z[i, f] += yields * a.grains.part[i, f] / a.gap[i, f] ** 2
        for k in range(shape.first[i], a.top[i]):
            a.diagonal[i, k] = a.a_x[west, k] + a.a_x[east, k] + a.a_z[i, k] + a.a_z[i, k + 1]


@kernel
def pass_faces(shape: RowShape, flow: Floats, a: PressureArrays) -> None:
    """What a flow along x takes through the inclined faces of cells, into `slope` [m/s].

    `flow` is that of each station [m2/s], shape (n_station, n). The transpose of the mean of `within` at both
    sides of a station.
    """
    taken = a.within
    taken[:], a.slope[:] = 0.0, 0.0
    for j in range(len(shape.left)):
        if a.tilt[j] == 0.0 or shape.kind[j] == WALL:
            continue
        left, right, half = shape.left[j], shape.right[j], 0.5 * a.tilt[j]
        for k in range(max(shape.first[left], shape.first[right]), flow.shape[1]):
            taken[left, k] += half * flow[j, k]
            taken[right, k] += half * flow[j, k]
    for i in range(shape.inner[0], shape.inner[1]):
        top = a.top[i]
        for f in range(shape.first[i] + 1, top + 1):
            above = taken[i, top] if f == top else 0.5 * taken[i, f]
            a.slope[i, f] = -(0.5 * taken[i, f - 1] + above) / a.gap[i, f]


@kernel
def divergence(
    p: ColumnParameters, shape: RowShape, flux: Floats, water: RowWater, a: PressureArrays, out: Floats
) -> float:
    """Divergence of the speeds U and W in the full cells, into `out` [m/s]; the largest returned.

    `flux` is that through an inlet [m2/s]; through others the speeds of `water` give it.
    """
    through, flows, most = a.slope, a.change, 0.0
    through[:] = 0.0
    for j in range(len(shape.left)):
        left, right = shape.left[j], shape.right[j]
        flows[j, :] = 0.0
        if shape.kind[j] != WALL:
            for k in range(max(shape.first[left], shape.first[right]), p.n):
                u = water.u[j, k]
                flows[j, k] = u * water.content[left if u > 0.0 else right, k]
    if a.sloped:
        pass_faces(shape, flows, a)
    for i in range(shape.inner[0], shape.inner[1]):
        first, top = shape.first[i], a.top[i]
        out[i, :] = 0.0
        for f in range(first + 1, top + 1):
            through[i, f] += a.part[i, f] / a.gap[i, f] * a.next_w[i, f] + a.grains.up[i, f]
        for k in range(first, top):
            total = through[i, k + 1] - (through[i, k] if k > first else 0.0)
            for j, sign in ((shape.west[i], -1.0), (shape.east[i], 1.0)):
                if shape.kind[j] == INFLOW:
                    total += sign * flux[j, k] / shape.dx
                elif shape.kind[j] == OPEN:
                    total += sign * (flows[j, k] + a.grains.along[j, k]) / shape.dx
            out[i, k] = total
            most = max(most, abs(total))
    return most


@kernel
def multiply(p: ColumnParameters, shape: RowShape, x: Floats, a: PressureArrays, y: Floats) -> float:
    """Multiply x by the system, into y, in the full cells; the product of both returned."""
    total = 0.0
    if a.sloped:
        add_inclined(p, shape, x, a, y)
    for i in range(shape.inner[0], shape.inner[1]):
        west, east = shape.west[i], shape.east[i]
        before, after, own = shape.left[west], shape.right[east], 0.0
        for k in range(shape.first[i], a.top[i]):
            value = a.diagonal[i, k] * x[i, k] - a.a_x[west, k] * x[before, k] - a.a_x[east, k] * x[after, k]
            if k > shape.first[i]:
                value -= a.a_z[i, k] * x[i, k - 1]
            if k + 1 < a.top[i]:
                value -= a.a_z[i, k + 1] * x[i, k + 1]
            y[i, k] = value + y[i, k] if a.sloped else value
            own += y[i, k] * x[i, k]
        total += own
    return total


@kernel
def add_inclined(p: ColumnParameters, shape: RowShape, x: Floats, a: PressureArrays, y: Floats) -> None:
    """What inclined faces add to the product: a station feels the rise of x, and drives flow through them."""
    slopes_of(shape, x, a)
    change, a.feel[:] = a.change, 0.0
    change[:] = 0.0
    for j in range(len(shape.left)):
        if a.tilt[j] == 0.0:
            continue
        left, right = shape.left[j], shape.right[j]
        for k in range(p.n):
            if a.gain[j, k] != 0.0:
                a.feel[j, k] = 0.5 * shape.dx * a.tilt[j] * (a.within[left, k] + a.within[right, k])
                change[j, k] = -a.a_x[j, k] * shape.dx * (x[right, k] - x[left, k] - a.feel[j, k])
    pass_faces(shape, change, a)
    for i in range(shape.inner[0], shape.inner[1]):
        west, east = shape.west[i], shape.east[i]
        for k in range(shape.first[i], a.top[i]):
            flow = a.a_x[east, k] * a.feel[east, k] - a.a_x[west, k] * a.feel[west, k]
            y[i, k] = flow + a.slope[i, k + 1] - (a.slope[i, k] if k > shape.first[i] else 0.0)


@kernel
def solve(p: ColumnParameters, shape: RowShape, most: float, a: PressureArrays) -> int:
    """The change of P that removes the divergence in `right`, into `found`; turns, or -1 without success.

    `most` is the largest divergence [m/s].
    """
    a.found[:], a.r[:], a.d[:] = 0.0, 0.0, 0.0
    enough = max(FINE * np.sqrt(shape.g_z * p.dz), ROUND_OFF * most)
    if most <= enough:
        return 0
    low, high, before = shape.inner[0], shape.inner[1], 1.0
    set_up(low, high, p.n, shape.first, a.top, a.a_x, a.a_z, a.diagonal, a.grids)
    for i in range(low, high):
        for k in range(shape.first[i], a.top[i]):
            a.r[i, k] = -a.right[i, k]
    for turn in range(MOST_TURNS):
        precondition(low, high, p.n, a.r, a.z, a.grids)
        now = product(shape, a.top, a.r, a.z)
        part = now / before if turn > 0 else 0.0
        before = now
        for i in range(low, high):
            for k in range(shape.first[i], a.top[i]):
                a.d[i, k] = a.z[i, k] + part * a.d[i, k]
        way = now / multiply(p, shape, a.d, a, a.y)
        left = 0.0
        for i in range(low, high):
            for k in range(shape.first[i], a.top[i]):
                a.found[i, k] += way * a.d[i, k]
                a.r[i, k] -= way * a.y[i, k]
                left = max(left, abs(a.r[i, k]))
        if left <= enough:
            return turn + 1
        if not np.isfinite(left):
            return -1
    return -1


@kernel
def product(shape: RowShape, top: Ints, x: Floats, y: Floats) -> float:
    """Product of two fields of the full cells, summed segment by segment."""
    total = 0.0
    for i in range(shape.inner[0], shape.inner[1]):
        own = 0.0
        for k in range(shape.first[i], top[i]):
            own += x[i, k] * y[i, k]
        total += own
    return total


@kernel
def correct(p: ColumnParameters, shape: RowShape, water: RowWater, a: PressureArrays) -> None:
    """Take the change of P out of all speeds; `star` keeps those of the stations before."""
    a.star[:] = water.u
    follow, yields = a.grains.yields[0] > 0.0, a.grains.yields[0]
    if a.sloped:
        slopes_of(shape, a.found, a)
    for j in range(len(shape.left)):
        left, right = shape.left[j], shape.right[j]
        if shape.kind[j] != OPEN:
            continue
        last, a.change[j, :] = -1, 0.0
        for k in range(p.n):
            if a.gain[j, k] != 0.0:
                rise = a.found[right, k] - a.found[left, k]
                if a.tilt[j] != 0.0:
                    rise -= 0.5 * shape.dx * a.tilt[j] * (a.within[left, k] + a.within[right, k])
                water.u[j, k] -= a.gain[j, k] * rise
                if follow:
                    a.change[j, k] = -mobility_along(shape, water.wet, j, k, a.grains) * p.dz * rise
                    a.grains.along[j, k] += a.change[j, k]
            if water.wet[left, k] + water.wet[right, k] > 0.0 and k >= max(
                shape.first[left], shape.first[right]
            ):
                last = k
        for k in range(max(last + 1, 1), p.n):
            if last >= 0:
                water.u[j, k] = water.u[j, last]
    if follow and a.sloped:
        pass_faces(shape, a.change, a)
        a.grains.up[:] += a.slope
    for i in range(shape.inner[0], shape.inner[1]):
        top = a.top[i]
        for f in range(shape.first[i] + 1, top + 1):
            above = a.found[i, f] if f < top else 0.0
            rise = above - a.found[i, f - 1]
            a.next_w[i, f] -= a.pull[i, f] * rise
            if follow:
                a.grains.up[i, f] -= yields * a.grains.part[i, f] / a.gap[i, f] ** 2 * rise
        for f in range(max(top, shape.first[i]) + 1, p.n + 1):
            a.next_w[i, f] = a.next_w[i, top] if top > shape.first[i] else a.next_w[i, f]
        for k in range(shape.first[i], top):
            a.p[i, k] += a.found[i, k]


@kernel
def project(
    p: ColumnParameters, shape: RowShape, dt: float, matrix: RowMatrix, slope: Floats, water: RowWater,
    flux: Floats, a: PressureArrays,
) -> int:  # fmt: skip
    """Change P, U in `water` and W so that no full cell gains water; turns, or -1 without success."""
    couple(p, shape, dt, matrix, slope, water, a)
    most = divergence(p, shape, flux, water, a, a.right)
    turns = solve(p, shape, most, a)
    correct(p, shape, water, a)
    return turns


@kernel
def worst_segment(shape: RowShape, a: PressureArrays) -> int:
    """The segment with the largest divergence left."""
    worst, most = shape.inner[0], -1.0
    for i in range(shape.inner[0], shape.inner[1]):
        for k in range(shape.first[i], a.top[i]):
            if not abs(a.r[i, k]) <= most:
                worst, most = i, abs(a.r[i, k])
    return worst
