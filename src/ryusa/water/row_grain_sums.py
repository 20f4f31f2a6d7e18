"""Sums over free grains in the segments of a row of columns: what they gave to the water, and what they are.

Each sum runs in the order of the grains, so that its bits are always the same. A grain is read once for all
sums, and what a cell receives of it stands side by side in memory.
"""

import math
from typing import NamedTuple

import numpy as np

from ryusa.model.fluid import DRAG
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.at_grains import given_by_grains
from ryusa.water.exchange import DRY, Ints, cut_grains
from ryusa.water.exchange_arrays import GrainNumbers, SliceArrays
from ryusa.water.row_step import RowShape
from ryusa.water.row_sums import BUOYED, GrainPlaces, place_grains
from ryusa.water.slice_sums import BAD_GRAIN, DRAG_NOW, GIVEN_X, RATE, SOLID, SOLID_W

N_GIVEN = 5  # GIVEN_X to GIVEN_MET, and BUOYED
N_PRESENT = 3  # SOLID, SOLID_W, DRAG_NOW


class MetByGrains(NamedTuple):
    """What the grains meet of the water in an interval, each of shape (n_grain,)."""

    submerged: Floats  # volume below the surface [m3]
    per: Floats  # one over it, 0 for a dry grain [1/m3]
    u: Floats  # mean speed along x [m/s]
    gradient: Floats  # pressure gradient [Pa/m]

    @staticmethod
    def of(n_grain: int) -> "MetByGrains":
        """Arrays for a number of grains, not filled."""
        submerged, per, u, gradient = np.zeros((4, n_grain))
        return MetByGrains(submerged, per, u, gradient)


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
def add_given(
    cut: SliceArrays, places: GrainPlaces, wet: Floats, order: Ints, per: Floats, amounts: Floats,
    push: Floats, sums: Floats,
) -> None:  # fmt: skip
    """Add four amounts of each grain (n_grain, 4), and a fifth, to its cells, sums (n_segment, n, N_GIVEN).

    `wet` weighs the cells [-], shape (n_segment, n).
    """
    for rank in range(order.shape[0]):
        i = order[rank]
        low, count, home = cut.first[i], cut.n_cells[i], places.at[i, places.at.shape[1] // 2]
        p, q, r = amounts[i, 0] * per[i], amounts[i, 1] * per[i], amounts[i, 2] * per[i]
        t, o = amounts[i, 3] * per[i], push[i] * per[i]
        for b in range(places.at.shape[1]):
            weight, here = places.weight[i, b], places.at[i, b]
            apart = min(max(places.shut[i, b] - low, 0), count)
            p_b, q_b, r_b, t_b, o_b = p * weight, q * weight, r * weight, t * weight, o * weight
            for s in range(count):
                segment = home if s < apart else here
                volume, share, cell = cut.volume[i, s], wet[segment, low + s], sums[segment, low + s]
                cell[0] += p_b * volume * share
                cell[1] += q_b * volume * share
                cell[2] += r_b * volume * share
                cell[3] += t_b * volume * share
                cell[4] += o_b * volume * share


@kernel
def sum_given_in_row(
    p: ColumnParameters, shape: RowShape, wet: Floats, impulse: Floats, sampled: Floats, met: MetByGrains,
    grains: GrainNumbers, cut: SliceArrays, places: GrainPlaces, per_dt: float, sums: Floats,
) -> None:  # fmt: skip
    """Add to the segments what the water gave to the grains, averaged over an interval, as `sum_given`.

    Parameters
    ----------
    wet : share of the cells below the surface in the interval [-], shape (n_segment, n).
    met : what the grains met in the interval.
    sums : shape (N_ROW_SUM, n_segment, n).
    """
    amounts = given_by_grains(impulse, met.u, grains.archimedes, sampled, per_dt)
    push = np.zeros(len(met.u))
    if shape.steep.max() > 1.0:
        for i in range(len(push)):
            push[i] = grains.solid[i] * met.submerged[i] / cut.whole[i] * met.gradient[i]
    given = np.zeros((*wet.shape, N_GIVEN))
    add_given(cut, places, wet, grains.order, met.per, amounts, push, given)
    for i in range(wet.shape[0]):
        for k in range(p.n):
            for c in range(N_GIVEN - 1):
                sums[GIVEN_X + c, i, k] += given[i, k, c]
            sums[BUOYED, i, k] += given[i, k, N_GIVEN - 1]


@kernel
def add_present(
    cut: SliceArrays, places: GrainPlaces, wet: Floats, order: Ints, values: Floats, drag: Floats,
    sums: Floats,
) -> None:  # fmt: skip
    """Add the volume of each grain and its flux upwards, values (n_grain, 2), and its drag (n_grain,).

    The first two go to all cells it lies in, drag to wet ones; sums have the shape (n_segment, n, N_PRESENT).
    """
    volumes, weights, at, shut = cut.volume, places.weight, places.at, places.shut
    shared = at.shape[1]
    for rank in range(order.shape[0]):
        i, submerged = order[rank], 0.0
        low, count, home = cut.first[i], cut.n_cells[i], at[i, shared // 2]
        for b in range(shared):
            apart = min(max(shut[i, b] - low, 0), count)
            for s in range(count):
                segment = home if s < apart else at[i, b]
                submerged += weights[i, b] * volumes[i, s] * wet[segment, low + s]
        per = 1.0 / submerged if submerged > DRY * cut.whole[i] else 0.0
        p, q, r = values[i, 0], values[i, 1], drag[i] * per
        for b in range(shared):
            weight = weights[i, b]
            apart = min(max(shut[i, b] - low, 0), count)
            p_b, q_b, r_b = p * weight, q * weight, r * weight
            for s in range(count):
                segment = home if s < apart else at[i, b]
                volume, share, cell = volumes[i, s], wet[segment, low + s], sums[segment, low + s]
                cell[0] += p_b * volume
                cell[1] += q_b * volume
                cell[2] += r_b * volume * share


@kernel
def sum_grains_in_row(
    p: ColumnParameters, shape: RowShape, x_low: float, grains: GrainNumbers, cut: SliceArrays,
    places: GrainPlaces, x: Floats, v: Floats, impulse: Floats, sampled: Floats, met: MetByGrains,
    wet: Floats, per_dt: float, z: Floats, sums: Floats, through: Floats, largest: Floats,
) -> None:  # fmt: skip
    """Sum what the grains gave in the interval, and then what they are where they are now, as `sum_grains`.

    Parameters
    ----------
    met, wet : as in `sum_given_in_row`, of the water in the interval.
    z : receives the heights of the grains above the bottom, plus z_low [m].
    sums, through : are added to, shapes (N_ROW_SUM, n_segment, n) and (n_station, n): flux of grains [m4/s].
    largest : as in `sum_grains`.
    """
    sum_given_in_row(p, shape, wet, impulse, sampled, met, grains, cut, places, per_dt, sums)
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
        largest[RATE] = max(largest[RATE], impulse[i, DRAG] / grains.inertia[i])
    add_to_gates(cut, places, grains.order, along, through)
    present = np.zeros((*wet.shape, N_PRESENT))
    add_present(cut, places, wet, grains.order, values, impulse[:, DRAG], present)
    for i in range(wet.shape[0]):
        for k in range(p.n):
            sums[SOLID, i, k] += present[i, k, 0]
            sums[SOLID_W, i, k] += present[i, k, 1]
            sums[DRAG_NOW, i, k] += present[i, k, 2]
