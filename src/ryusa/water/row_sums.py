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

from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.at_grains import DENSEST
from ryusa.water.at_grains import STRESS as BY_STRESS
from ryusa.water.exchange import DRY, FOUR, Ints
from ryusa.water.exchange_arrays import SliceArrays, WaterLaws
from ryusa.water.fixed_grains import drag_on_fixed
from ryusa.water.row_layout import RowShape
from ryusa.water.slice_sums import N_SUM

BUOYED = N_SUM  # row of the sums: force of the slope of the surface on the grains along x [N]
DRAG_U = N_SUM + 1  # drag over slip times the speed of the grains along x [N]
N_ROW_SUM = N_SUM + 2
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
    first, bed = shape.inner[0], shape.bed
    n = len(bed) - 2 * first
    periodic = first == 0
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
        middle = bed[first + int(cell % n)]
        # over an aerated sill grains leave through its last station, although the pool begins at a wall
        places.gate[i, 0], places.gate[i, 1] = shape.east[bed[first + int(cell % n) - 1]], shape.east[middle]
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
                here = below = bed[int(one % n)]
            else:
                here, below = bed[first + int(min(max(one, 0), n - 1))], bed[first + int(one)]
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
def means_of_segments(
    cut: SliceArrays, places: GrainPlaces, wet: Floats, table: Floats, submerged: Floats, per: Floats
) -> Floats:
    """Means over the wet part of each grain of cell values (n_segment, n, m), m a multiple of four.

    Parameters
    ----------
    wet : share of each cell below the surface [-], shape (n_segment, n).
    submerged, per : receive the submerged volume of each grain [m3], and one over it; 0 for a dry grain.
    """
    # the wet parts of a grain are found once for all quantities, of which four are summed at once
    out = np.empty((len(per), table.shape[2]))
    volume, weights, at, shut = cut.volume, places.weight, places.at, places.shut
    shared, n, flat = at.shape[1], wet.shape[1], table.reshape(-1, table.shape[2])
    cells, parts = np.empty(shared * volume.shape[1], np.int64), np.empty(shared * volume.shape[1])
    for i in range(len(per)):
        count, total = 0, 0.0
        low, reach, home = cut.first[i], cut.n_cells[i], at[i, shared // 2]
        for b in range(shared):
            apart = min(max(shut[i, b] - low, 0), reach)
            for s in range(reach):
                segment = home if s < apart else at[i, b]
                part = weights[i, b] * volume[i, s] * wet[segment, low + s]
                cells[count], parts[count] = segment * n + low + s, part
                total += part
                count += 1
        submerged[i] = total
        per[i] = 1.0 / total if total > DRY * cut.whole[i] else 0.0
        for c in range(0, table.shape[2], FOUR):
            p = q = r = t = 0.0
            for k in range(count):
                part, cell = parts[k], cells[k]
                p += part * flat[cell, c]
                q += part * flat[cell, c + 1]
                r += part * flat[cell, c + 2]
                t += part * flat[cell, c + 3]
            out[i, c], out[i, c + 1] = p * per[i], q * per[i]
            out[i, c + 2], out[i, c + 3] = r * per[i], t * per[i]
    return out


@kernel
def beside_dam(cut: SliceArrays, places: GrainPlaces, i: int, b: int) -> float:
    """Part of grain i that lies beside a dam in segment b of those that share it [-]."""
    inside, apart = 0.0, min(max(places.shut[i, b] - cut.first[i], 0), cut.n_cells[i])
    for s in range(apart):
        inside += cut.volume[i, s]
    return inside / cut.whole[i] if apart > 0 else 0.0


@kernel
def gradient_beside_dam(
    shape: RowShape, cut: SliceArrays, places: GrainPlaces, gradient: Floats, middle: Floats, rest: float,
    i: int,
) -> float:  # fmt: skip
    """Pressure gradient at grain i, part of which may lie beside a dam [Pa/m]; as `gradients_at_grains`."""
    home, mean = places.at[i, 1], 0.0
    west, east = gradient[shape.west[home]], gradient[shape.east[home]]
    before, after = beside_dam(cut, places, i, 0), beside_dam(cut, places, i, 2)
    if before > 0.0:
        west = (1.0 - before) * west + before * rest
    if after > 0.0:
        east = (1.0 - after) * east + after * rest
    own = 0.5 * (west + east)
    for b in range(N_SHARING):
        at = places.at[i, b]
        here = own if at == home else middle[at]
        apart = (before, 0.0, after)[b]
        mean += places.weight[i, b] * (here if apart == 0.0 else (1.0 - apart) * here + apart * own)
    return mean


@kernel
def gradients_at_grains(
    shape: RowShape, cut: SliceArrays, places: GrainPlaces, gradient: Floats, rest: float, out: Floats
) -> None:
    """Write the pressure gradient at each grain [Pa/m] from that at the stations (n_station,).

    `rest` is that of water at rest [Pa/m], which a grain beside a dam meets on its side.
    """
    middle = np.empty(len(shape.bottom))
    for i in range(len(middle)):
        middle[i] = 0.5 * (gradient[shape.west[i]] + gradient[shape.east[i]])
    first, weight, at, shut = cut.first, places.weight, places.at, places.shut
    for i in range(len(out)):
        if at.shape[1] > 1 and max(shut[i, 0], shut[i, 2]) > first[i]:
            out[i] = gradient_beside_dam(shape, cut, places, gradient, middle, rest, i)
            continue
        mean = 0.0
        for b in range(at.shape[1]):
            mean += weight[i, b] * middle[at[i, b]]
        out[i] = mean


@kernel
def of_both_stations(shape: RowShape, values: Floats, out: Floats) -> None:
    """Means of values of the stations (n_station, n) at both ends of each segment (n_segment, n)."""
    for i in range(len(shape.bottom)):
        for k in range(values.shape[1]):
            out[i, k] = 0.5 * (values[shape.west[i], k] + values[shape.east[i], k])


@kernel
def sum_fixed_in_row(
    p: ColumnParameters, shape: RowShape, laws: WaterLaws, bed: RowBed, cut: SliceArrays,
    places: GrainPlaces, u: Floats, w: Floats, wet: Floats, phi: Floats, sums: Floats,
) -> None:  # fmt: skip
    """Sum the drag of fixed grains in the segments, as `sum_fixed_grains`; w [m/s], shape (n_segment, n)."""
    if bed.taken or len(bed.d) == 0:
        return
    submerged, per = np.empty(len(bed.d)), np.empty(len(bed.d))
    table = np.zeros((len(shape.bottom), p.n, FOUR))
    of_both_stations(shape, u, table[:, :, 0])
    for i in range(len(shape.bottom)):
        for k in range(p.n):
            table[i, k, 1] = w[i, k]
            table[i, k, 2] = min(phi[i, k], DENSEST)
    at = means_of_segments(cut, places, wet, table, submerged, per)
    for i in range(len(bed.d)):
        at[i, 1] += at[i, 0] * places.tilt[i]
    out = np.zeros((len(bed.d), 3))
    if laws.drag != 0:
        drag_on_fixed(
            laws.drag, laws.hindrance, laws.buoyancy == BY_STRESS, laws.exponent, at,
            submerged / cut.whole, bed.d, laws.nu, laws.rho_w, laws.a_2, laws.c_d, out,
        )  # fmt: skip
    add_to_segments(cut, places, wet, bed.order, per, out, sums)
