"""Sums over grains in the segments of a row of columns, and means over grains of what the segments hold.

Along z a grain is cut exactly, as in one column (`slice_sums`). Along x it is shared between the segment in
which its centre lies and the two beside it by quadratic B-splines, which add up to one and to the place of
the centre. A sphere cut exactly by the borders of segments would give concentrations that change while it
passes, and the water would be stirred by borders that are not there (design/0027).

What would go to cells within a dam beside a grain, the segment of its centre takes.

The part of a grain below the surface is, in each cell of each segment, the share of the cell that is wet. So
the volume of submerged grains is that by which they displace water, and grains that reach out of still water
do not move it. Cuts at the height of the surface itself, as in one column, would leave a small difference.
"""

import math
from typing import NamedTuple

import numpy as np

from ryusa.model.fluid import DRAG
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.at_grains import DENSEST, given_by_grains
from ryusa.water.at_grains import STRESS as BY_STRESS
from ryusa.water.exchange import DRY, FOUR, Ints, cut_grains
from ryusa.water.exchange_arrays import GrainNumbers, SliceArrays, WaterLaws
from ryusa.water.fixed_grains import drag_on_fixed
from ryusa.water.row_step import RowShape
from ryusa.water.slice_sums import (
    BAD_GRAIN,
    DRAG_NOW,
    GIVEN_MET,
    GIVEN_X,
    N_SUM,
    RATE,
    SOLID,
    SOLID_W,
)

BUOYED = N_SUM  # row of the sums: force of the slope of the surface on the grains along x [N]
N_ROW_SUM = N_SUM + 1
N_SHARING = 3  # segments that share a grain


class GrainPlaces(NamedTuple):
    """Where grains are in a row; an exchange overwrites it. A row of one segment shares no grain."""

    at: Ints  # segments that hold a part of each grain, shape (n_grain, N_SHARING) or (n_grain, 1)
    weight: Floats  # these parts [-], same shape
    shut: Ints  # cells below these are within a dam there: the segment of the centre takes their part
    base: Floats  # height of the bottom below its centre, less z_low of the cells [m], shape (n_grain,)
    tilt: Floats  # and its slope [-]
    gate: Ints  # stations upstream and downstream of its centre, shape (n_grain, 2)
    past: Floats  # how far its centre is from the one to the other [-], shape (n_grain,)

    @staticmethod
    def of(n_grain: int, n_segment: int) -> "GrainPlaces":
        """Arrays for a number of grains, not filled."""
        shape = (n_grain, N_SHARING if n_segment > 1 else 1)
        three = (np.zeros(n_grain) for _ in range(3))
        base, tilt, past = three
        return GrainPlaces(
            np.zeros(shape, np.int64), np.ones(shape), np.zeros(shape, np.int64), base, tilt,
            np.zeros((n_grain, 2), np.int64), past,
        )  # fmt: skip


class RowBed(NamedTuple):
    """Fixed grains in a row; none where the law of a rough wall stands for them."""

    order: Ints  # 0 .. n_bed - 1
    z: Floats  # heights of the centres above the bottom, plus z_low [m], shape (n_bed,)
    d: Floats  # diameters [m], shape (n_bed,)
    phi: Floats  # their concentration in the segments [-], shape (n_segment, n)
    taken: bool  # the wall law takes their drag and buoyancy


@kernel
def place_grains(x: Floats, x_low: float, z_low: float, shape: RowShape, places: GrainPlaces) -> int:
    """Find the segments that share each grain.

    Parameters
    ----------
    x : centres along the row [m], shape (n_grain,).
    x_low : where the first segment begins [m].
    z_low : height that cells give to the bottom [m].
    places : overwritten.

    Returns
    -------
    The first grain whose place is not finite, -1 if there is none.

    Notes
    -----
    What a grain near an open end would give to segments beyond it, the last segment takes; beyond the end it
    counts as lying there.
    """
    first, n = shape.inner[0], shape.inner[1] - shape.inner[0]
    periodic = n == len(shape.bottom)
    shared = places.at.shape[1]
    for i in range(len(x)):
        s = (x[i] - x_low) / shape.dx
        if not math.isfinite(s):
            return i
        if not periodic:
            s = min(max(s, 0.0), float(n))
        cell = math.floor(s)
        if not periodic:
            cell = min(cell, n - 1)
        t = s - cell - 0.5
        middle = first + int(cell % n)
        places.gate[i, 0], places.gate[i, 1] = shape.west[middle], shape.east[middle]
        places.past[i] = t + 0.5
        if shared == 1:
            places.at[i, 0], places.weight[i, 0] = middle, 1.0
            places.base[i], places.tilt[i] = shape.bottom[middle] - z_low, 0.0
            continue
        places.weight[i, 0] = 0.5 * (0.5 - t) ** 2
        places.weight[i, 1] = 0.75 - t * t
        places.weight[i, 2] = 0.5 * (0.5 + t) ** 2
        base = tilt = 0.0
        for b in range(shared):
            one = cell + b - 1
            if periodic:
                here = below = int(one % n)
            else:
                here, below = first + int(min(max(one, 0), n - 1)), first + int(one)
            places.at[i, b] = here
            places.shut[i, b] = shape.shut[here] if here != middle else 0
            base += places.weight[i, b] * shape.bottom[below]
            grows = (t - 0.5, -2.0 * t, t + 0.5)[b]
            tilt += grows / shape.dx * shape.bottom[below]
        places.base[i], places.tilt[i] = base - z_low, tilt
    return -1


@kernel
def add_to_segments(
    cut: SliceArrays,
    places: GrainPlaces,
    wet: Floats,
    order: Ints,
    per: Floats,
    amounts: Floats,
    sums: Floats,
) -> None:
    """Add amounts of grains (n_grain, m) to the cells of the segments, sums (m, n_segment, n).

    `wet` weighs the cells [-], shape (n_segment, n).
    """
    for rank in range(order.shape[0]):
        i = order[rank]
        low, high = cut.first[i], cut.first[i] + cut.n_cells[i]
        for c in range(amounts.shape[1]):
            amount = amounts[i, c] * per[i]
            home = places.at[i, places.at.shape[1] // 2]
            for b in range(places.at.shape[1]):
                part = amount * places.weight[i, b]
                apart = min(max(places.shut[i, b] - low, 0), cut.n_cells[i])
                if apart > 0:
                    row, share = sums[c, home, low:high], wet[home, low:high]
                    for s in range(apart):
                        row[s] += part * cut.volume[i, s] * share[s]
                row, share = sums[c, places.at[i, b], low:high], wet[places.at[i, b], low:high]
                for s in range(apart, cut.n_cells[i]):
                    row[s] += part * cut.volume[i, s] * share[s]


@kernel
def add_to_gates(cut: SliceArrays, places: GrainPlaces, order: Ints, amounts: Floats, sums: Floats) -> None:
    """Add what grains carry along x (n_grain,) to the cells of the stations, sums (n_station, n).

    The shares at both stations are the derivatives of the weights: what passes the stations is exactly what
    the segments gain and lose while grains move.
    """
    for rank in range(order.shape[0]):
        i = order[rank]
        low, high = cut.first[i], cut.first[i] + cut.n_cells[i]
        for b in range(2):
            part = amounts[i] * (places.past[i] if b == 1 else 1.0 - places.past[i])
            row, apart = sums[places.gate[i, b], low:high], 0
            if places.at.shape[1] > 1:  # nothing passes into a dam
                apart = min(max(places.shut[i, 2 * b] - low, 0), cut.n_cells[i])
            for s in range(apart, cut.n_cells[i]):
                row[s] += part * cut.volume[i, s]


@kernel
def means_of_segments(
    cut: SliceArrays, places: GrainPlaces, wet: Floats, per: Floats, table: Floats
) -> Floats:
    """Means over the wet part of each grain of cell values (n_segment, n, m), m a multiple of four."""
    out = np.empty((len(per), table.shape[2]))
    for i in range(len(per)):
        for c in range(0, table.shape[2], FOUR):
            p = q = r = t = 0.0
            home = places.at[i, places.at.shape[1] // 2]
            for b in range(places.at.shape[1]):
                here, weight = places.at[i, b], places.weight[i, b]
                cells, share = table[here], wet[here]
                apart = min(max(places.shut[i, b] - cut.first[i], 0), cut.n_cells[i])
                for s in range(apart):
                    k = cut.first[i] + s
                    part, cell = weight * cut.volume[i, s] * wet[home, k], table[home, k]
                    p += part * cell[c]
                    q += part * cell[c + 1]
                    r += part * cell[c + 2]
                    t += part * cell[c + 3]
                for s in range(apart, cut.n_cells[i]):
                    k = cut.first[i] + s
                    part, cell = weight * cut.volume[i, s] * share[k], cells[k]
                    p += part * cell[c]
                    q += part * cell[c + 1]
                    r += part * cell[c + 2]
                    t += part * cell[c + 3]
            out[i, c], out[i, c + 1] = p * per[i], q * per[i]
            out[i, c + 2], out[i, c + 3] = r * per[i], t * per[i]
    return out


@kernel
def submerge(cut: SliceArrays, places: GrainPlaces, wet: Floats, submerged: Floats) -> Floats:
    """Write the submerged volume of each grain [m3], and return one over it; 0 for a dry grain.

    `wet` is the share of each cell below the surface [-], shape (n_segment, n).
    """
    per = np.zeros(len(submerged))
    for i in range(len(submerged)):
        total, low, home = 0.0, cut.first[i], places.at[i, places.at.shape[1] // 2]
        for b in range(places.at.shape[1]):
            weight, share = places.weight[i, b], wet[places.at[i, b]]
            apart = min(max(places.shut[i, b] - low, 0), cut.n_cells[i])
            for s in range(apart):
                total += weight * cut.volume[i, s] * wet[home, low + s]
            for s in range(apart, cut.n_cells[i]):
                total += weight * cut.volume[i, s] * share[low + s]
        submerged[i] = total
        if total > DRY * cut.whole[i]:
            per[i] = 1.0 / total
    return per


@kernel
def beside_dam(cut: SliceArrays, places: GrainPlaces, i: int, b: int) -> float:
    """Part of grain i that lies beside a dam in segment b of those that share it [-]."""
    inside, apart = 0.0, min(max(places.shut[i, b] - cut.first[i], 0), cut.n_cells[i])
    for s in range(apart):
        inside += cut.volume[i, s]
    return inside / cut.whole[i] if apart > 0 else 0.0


@kernel
def gradient_at(
    shape: RowShape, cut: SliceArrays, places: GrainPlaces, gradient: Floats, rest: float, i: int
) -> float:
    """Pressure gradient at grain i [Pa/m] from that at the stations (n_station,).

    `rest` is that of water at rest [Pa/m], which a grain beside a dam meets on its side.
    """
    shared, mean = places.at.shape[1], 0.0
    home = places.at[i, shared // 2]
    west, east = gradient[shape.west[home]], gradient[shape.east[home]]
    before, after = 0.0, 0.0
    if shared > 1:
        before, after = beside_dam(cut, places, i, 0), beside_dam(cut, places, i, 2)
        if before > 0.0:
            west = (1.0 - before) * west + before * rest
        if after > 0.0:
            east = (1.0 - after) * east + after * rest
    middle = 0.5 * (west + east)
    for b in range(shared):
        at, apart = places.at[i, b], 0.0
        here = middle if at == home else 0.5 * (gradient[shape.west[at]] + gradient[shape.east[at]])
        if shared > 1 and b != 1:
            apart = before if b == 0 else after
        mean += places.weight[i, b] * (here if apart == 0.0 else (1.0 - apart) * here + apart * middle)
    return mean


@kernel
def of_both_stations(shape: RowShape, values: Floats, out: Floats) -> None:
    """Means of values of the stations (n_station, n) at both ends of each segment (n_segment, n)."""
    for i in range(len(shape.bottom)):
        for k in range(values.shape[1]):
            out[i, k] = 0.5 * (values[shape.west[i], k] + values[shape.east[i], k])


@kernel
def sum_given_in_row(
    p: ColumnParameters, shape: RowShape, u: Floats, gradient: Floats, wet: Floats, impulse: Floats,
    sampled: Floats, grains: GrainNumbers, cut: SliceArrays, places: GrainPlaces, per_dt: float, sums: Floats,
) -> None:  # fmt: skip
    """Add to the segments what the water gave to the grains, averaged over an interval, as `sum_given`.

    Parameters
    ----------
    u, gradient : speed of the water at the stations in the interval [m/s], shape (n_station, n), and pressure
        gradient there [Pa/m], shape (n_station,).
    wet : share of the cells below the surface in the interval [-], shape (n_segment, n).
    sums : shape (N_ROW_SUM, n_segment, n).
    """
    submerged = np.empty(len(grains.d))
    per = submerge(cut, places, wet, submerged)
    table = np.zeros((len(shape.bottom), p.n, FOUR))
    of_both_stations(shape, u, table[:, :, 0])
    met = means_of_segments(cut, places, wet, per, table)[:, 0].copy()
    amounts = given_by_grains(impulse, met, grains.archimedes, sampled, per_dt)
    add_to_segments(cut, places, wet, grains.order, per, amounts, sums[GIVEN_X : GIVEN_MET + 1])
    if shape.steep.max() > 1.0:
        push = np.empty((len(per), 1))
        for i in range(len(per)):
            here = gradient_at(shape, cut, places, gradient, -p.rho_w * p.g_x, i)
            push[i, 0] = grains.solid[i] * submerged[i] / cut.whole[i] * here
        add_to_segments(cut, places, wet, grains.order, per, push, sums[BUOYED:])


@kernel
def sum_grains_in_row(
    p: ColumnParameters, shape: RowShape, x_low: float, grains: GrainNumbers, cut: SliceArrays,
    places: GrainPlaces, x: Floats, v: Floats, impulse: Floats, sampled: Floats, u: Floats, gradient: Floats,
    wet: Floats, per_dt: float, z: Floats, sums: Floats, through: Floats, largest: Floats,
) -> None:  # fmt: skip
    """Sum what the grains gave in the interval, and then what they are where they are now, as `sum_grains`.

    Parameters
    ----------
    u, gradient, wet : as in `sum_given_in_row`, of the water in the interval.
    z : receives the heights of the grains above the bottom, plus z_low [m].
    sums, through : are added to, shapes (N_ROW_SUM, n_segment, n) and (n_station, n): flux of grains [m4/s].
    largest : as in `sum_grains`.
    """
    sum_given_in_row(p, shape, u, gradient, wet, impulse, sampled, grains, cut, places, per_dt, sums)
    bad = place_grains(x[:, 0], x_low, p.z_low, shape, places)
    for i in range(len(z)):
        z[i] = x[i, 2] - places.base[i]
        if bad < 0 and not math.isfinite(z[i]):
            bad = i
    if bad >= 0:
        largest[BAD_GRAIN] = bad
        return
    cut_grains(
        z, 0.5 * grains.d, p.z_low, p.dz, p.n, cut.first, cut.n_cells, cut.volume, cut.whole, cut.submerged,
        cut.below, cut.above,
    )  # fmt: skip
    values, along = np.empty((len(z), 2)), np.empty(len(z))
    for i in range(len(z)):
        solid = grains.solid[i] / cut.whole[i]
        values[i, 0] = solid
        values[i, 1] = (v[i, 2] - v[i, 0] * places.tilt[i]) * solid
        along[i] = v[i, 0] * solid
    all_of_it = np.ones(wet.shape)
    add_to_segments(cut, places, all_of_it, grains.order, np.ones(len(z)), values, sums[SOLID : SOLID_W + 1])
    add_to_gates(cut, places, grains.order, along, through)
    per = submerge(cut, places, wet, np.empty(len(z)))
    drag = np.empty((len(per), 1))
    drag[:, 0] = impulse[:, DRAG]
    add_to_segments(cut, places, wet, grains.order, per, drag, sums[DRAG_NOW : DRAG_NOW + 1])
    for i in range(len(per)):
        largest[RATE] = max(largest[RATE], drag[i, 0] / grains.inertia[i])


@kernel
def sum_fixed_in_row(
    p: ColumnParameters, shape: RowShape, laws: WaterLaws, bed: RowBed, cut: SliceArrays,
    places: GrainPlaces, u: Floats, w: Floats, wet: Floats, phi: Floats, sums: Floats,
) -> None:  # fmt: skip
    """Sum the drag of fixed grains in the segments, as `sum_fixed_grains`; w [m/s], shape (n_segment, n)."""
    if bed.taken or len(bed.d) == 0:
        return
    submerged = np.empty(len(bed.d))
    per = submerge(cut, places, wet, submerged)
    table = np.zeros((len(shape.bottom), p.n, FOUR))
    of_both_stations(shape, u, table[:, :, 0])
    for i in range(len(shape.bottom)):
        for k in range(p.n):
            table[i, k, 1] = w[i, k]
            table[i, k, 2] = min(phi[i, k], DENSEST)
    at = means_of_segments(cut, places, wet, per, table)
    for i in range(len(bed.d)):
        at[i, 1] += at[i, 0] * places.tilt[i]
    out = np.zeros((len(bed.d), 3))
    if laws.drag != 0:
        drag_on_fixed(
            laws.drag, laws.hindrance, laws.buoyancy == BY_STRESS, laws.exponent, at,
            submerged / cut.whole, bed.d, laws.nu, laws.rho_w, laws.a_2, laws.c_d, out,
        )  # fmt: skip
    add_to_segments(cut, places, wet, bed.order, per, out, sums)
