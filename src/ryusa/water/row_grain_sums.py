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
from ryusa.water.row_layout import RowShape
from ryusa.water.row_sums import BUOYED, DRAG_U, GrainPlaces, place_grains
from ryusa.water.slice_sums import BAD_GRAIN, DRAG_NOW, GIVEN_X, RATE, SOLID, SOLID_W

N_GIVEN = 5  # GIVEN_X to GIVEN_MET, and BUOYED
N_PRESENT = 4  # SOLID, SOLID_W, DRAG_NOW, DRAG_U


class MetByGrains(NamedTuple):
    """What the grains meet of the water in an interval, each of shape (n_grain,)."""

    submerged: Floats  # volume below the surface [m3]
    per: Floats  # one over it, 0 for a dry grain [1/m3]
    u: Floats  # mean speed along x [m/s]
    gradient: Floats  # pressure gradient [Pa/m]
    push: Floats  # force along x by the pressure of its own that a row may have [N/m3]
    moves: Floats  # and upwards on the added mass, by water that accelerates [N/m3]
    drift: Floats  # then: drift upwards by turbulence that is not the same everywhere [m/s]

    @staticmethod
    def of(n_grain: int) -> "MetByGrains":
        """Arrays for a number of grains, not filled."""
        return MetByGrains(*np.zeros((7, n_grain)))


@kernel
def amounts_given(
    shape: RowShape, impulse: Floats, sampled: Floats, met: MetByGrains, grains: GrainNumbers,
    cut: SliceArrays, per_dt: float,
) -> Floats:  # fmt: skip
    """What each grain gives to the water, averaged over an interval, shape (n_grain, N_GIVEN).

    A pressure of its own pushes water and grains each by their share, so that its push is nothing given. Then
    the drag of the drift upwards is not given either: it is balanced by the rise of the turbulence's normal
    stress, which W leaves out. That of the other fluctuations is, which bear suspended grains.
    """
    amounts = np.zeros((len(met.u), N_GIVEN))
    four = given_by_grains(impulse, met.u, grains.archimedes, sampled, per_dt)
    sloping = shape.inertia.max() > 1.0
    for i in range(len(amounts)):
        for c in range(N_GIVEN - 1):
            amounts[i, c] = four[i, c]
        if sloping:
            amounts[i, N_GIVEN - 1] = grains.solid[i] * met.submerged[i] / cut.whole[i] * met.gradient[i]
        if shape.own:
            volume = grains.solid[i] * met.submerged[i] / cut.whole[i]
            amounts[i, 0] -= volume * met.push[i]
            amounts[i, 1] += volume * met.moves[i] - impulse[i, DRAG] * met.drift[i]
    return amounts


@kernel
def owns(begin: int, end: int, at: Ints, i: int) -> bool:
    """Whether one of the segments that share grain i is from `begin` to `end`-1."""
    mine = False
    for b in range(at.shape[1]):
        mine = mine or begin <= at[i, b] < end
    return mine


@kernel
def add_given(
    begin: int, end: int, cut: SliceArrays, places: GrainPlaces, wet: Floats, order: Ints, per: Floats,
    amounts: Floats, sums: Floats,
) -> None:  # fmt: skip
    """Add amounts of each grain (n_grain, N_GIVEN) to its cells, sums (n_segment, n, N_GIVEN).

    Parameters
    ----------
    begin, end : only the segments from the first to the one before the second receive.
    wet : weighs the cells [-], shape (n_segment, n).
    """
    volumes, weights, at, shut = cut.volume, places.weight, places.at, places.shut
    for rank in range(order.shape[0]):
        i = order[rank]
        if not owns(begin, end, at, i):
            continue
        low, count, home = cut.first[i], cut.n_cells[i], at[i, at.shape[1] // 2]
        p, q, r = amounts[i, 0] * per[i], amounts[i, 1] * per[i], amounts[i, 2] * per[i]
        t, o = amounts[i, 3] * per[i], amounts[i, 4] * per[i]
        for b in range(at.shape[1]):
            weight, apart = weights[i, b], min(max(shut[i, b] - low, 0), count)
            p_b, q_b, r_b, t_b, o_b = p * weight, q * weight, r * weight, t * weight, o * weight
            for s in range(count):
                segment = home if s < apart else at[i, b]
                if not begin <= segment < end:
                    continue
                volume, share, cell = volumes[i, s], wet[segment, low + s], sums[segment, low + s]
                cell[0] += p_b * volume * share
                cell[1] += q_b * volume * share
                cell[2] += r_b * volume * share
                cell[3] += t_b * volume * share
                cell[4] += o_b * volume * share


@kernel
def cut_in_row(
    p: ColumnParameters, shape: RowShape, x_low: float, grains: GrainNumbers, cut: SliceArrays,
    places: GrainPlaces, x: Floats, v: Floats, impulse: Floats, z: Floats, largest: Floats,
) -> Floats:  # fmt: skip
    """Place and cut the grains where they are now; parameters as of `sum_grains_in_row`.

    Returns
    -------
    values : of each grain, what its cells receive over its slices: solid volume, its flux upwards, drag over
        slip, that times its speed along x, and its flux along x, shape (n_grain, N_PRESENT + 1).
    """
    values = np.empty((len(z), N_PRESENT + 1))
    bad = place_grains(x[:, 0], x_low, p.z_low, shape, places)
    for i in range(len(z)):
        z[i] = x[i, 2] - places.base[i]
        if bad < 0 and not math.isfinite(z[i]):
            bad = i
    if bad >= 0:
        largest[BAD_GRAIN] = bad
        return values
    cut_grains(
        z, 0.5 * grains.d, p.z_low, p.dz, p.n, cut.first, cut.n_cells, cut.volume, cut.whole, cut.submerged,
        cut.below, cut.above,
    )  # fmt: skip
    for i in range(len(z)):
        solid = grains.solid[i] / cut.whole[i]
        values[i, 0] = solid
        values[i, 1] = (v[i, 2] - v[i, 0] * places.tilt[i]) * solid
        values[i, 2] = impulse[i, DRAG]
        values[i, 3] = impulse[i, DRAG] * v[i, 0]
        values[i, N_PRESENT] = v[i, 0] * solid
        largest[RATE] = max(largest[RATE], impulse[i, DRAG] / grains.inertia[i])
    return values


@kernel
def add_present(
    begin: int, end: int, cut: SliceArrays, places: GrainPlaces, wet: Floats, order: Ints, values: Floats,
    sums: Floats, through: Floats,
) -> None:  # fmt: skip
    """Add values of `cut_in_row` to cells, sums (n_segment, n, N_PRESENT) and through (n_station, n).

    Parameters
    ----------
    begin, end : as of `add_given`; the same for stations.

    Notes
    -----
    Volume and its flux go to all cells in which a grain lies, drag to wet ones. The shares of the flux along
    x at both stations beside a grain are the derivatives of its weights: what passes the stations is exactly
    what the segments gain and lose while grains move.
    """
    volumes, weights, at, shut = cut.volume, places.weight, places.at, places.shut
    shared = at.shape[1]
    for rank in range(order.shape[0]):
        i, submerged = order[rank], 0.0
        low, count, home = cut.first[i], cut.n_cells[i], at[i, shared // 2]
        for b in range(2):
            gate = places.gate[i, b]
            if not begin <= gate < end:
                continue
            part = values[i, N_PRESENT] * (places.past[i] if b == 1 else 1.0 - places.past[i])
            apart = min(max(shut[i, 2 * b] - low, 0), count) if shared > 1 else 0  # nothing passes into a dam
            for s in range(apart, count):
                through[gate, low + s] += part * volumes[i, s]
        if not owns(begin, end, at, i):
            continue
        for b in range(shared):
            apart = min(max(shut[i, b] - low, 0), count)
            for s in range(count):
                segment = home if s < apart else at[i, b]
                submerged += weights[i, b] * volumes[i, s] * wet[segment, low + s]
        per = 1.0 / submerged if submerged > DRY * cut.whole[i] else 0.0
        p, q, r, t = values[i, 0], values[i, 1], values[i, 2] * per, values[i, 3] * per
        for b in range(shared):
            weight, apart = weights[i, b], min(max(shut[i, b] - low, 0), count)
            p_b, q_b, r_b, t_b = p * weight, q * weight, r * weight, t * weight
            for s in range(count):
                segment = home if s < apart else at[i, b]
                if not begin <= segment < end:
                    continue
                volume, share, cell = volumes[i, s], wet[segment, low + s], sums[segment, low + s]
                cell[0] += p_b * volume
                cell[1] += q_b * volume
                cell[2] += r_b * volume * share
                cell[3] += t_b * volume * share


@kernel
def as_rows(given: Floats, present: Floats, sums: Floats) -> None:
    """Write what cells received, (n_segment, n, N_GIVEN) and (n_segment, n, N_PRESENT), as rows of `sums`."""
    for i in range(given.shape[0]):
        for k in range(given.shape[1]):
            for c in range(N_GIVEN - 1):
                sums[GIVEN_X + c, i, k] = given[i, k, c]
            sums[BUOYED, i, k] = given[i, k, N_GIVEN - 1]
            sums[SOLID, i, k], sums[SOLID_W, i, k] = present[i, k, 0], present[i, k, 1]
            sums[DRAG_NOW, i, k], sums[DRAG_U, i, k] = present[i, k, 2], present[i, k, 3]


@kernel
def sum_grains_in_row(
    p: ColumnParameters, shape: RowShape, x_low: float, grains: GrainNumbers, cut: SliceArrays,
    places: GrainPlaces, x: Floats, v: Floats, impulse: Floats, sampled: Floats, met: MetByGrains,
    wet: Floats, per_dt: float, z: Floats, sums: Floats, through: Floats, largest: Floats,
) -> None:  # fmt: skip
    """Sum what the grains gave in the interval, and then what they are where they are now, as `sum_grains`.

    Parameters
    ----------
    wet, met : share of the cells below the surface in the interval [-], shape (n_segment, n), and what the
        grains met in it.
    z : receives the heights of the grains above the bottom, plus z_low [m].
    sums : overwritten, shape (N_ROW_SUM, n_segment, n).
    through : is added to, flux of grains [m4/s], shape (n_station, n).
    largest : as in `sum_grains`.
    """
    given, present = np.zeros((*wet.shape, N_GIVEN)), np.zeros((*wet.shape, N_PRESENT))
    amounts = amounts_given(shape, impulse, sampled, met, grains, cut, per_dt)
    add_given(0, len(wet), cut, places, wet, grains.order, met.per, amounts, given)
    values = cut_in_row(p, shape, x_low, grains, cut, places, x, v, impulse, z, largest)
    if largest[BAD_GRAIN] >= 0.0:
        return
    add_present(0, len(wet), cut, places, wet, grains.order, values, present, through)
    as_rows(given, present, sums)
