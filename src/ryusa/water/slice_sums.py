"""Sums over grains in the cells of a column: all that the water needs to know of them.

What is here looks at grains and at the water of the interval; what moves the water (`exchange_step`) looks at
these sums alone. So processes that share the grains each sum their own, and add the sums.
"""

import math

import numpy as np

from ryusa.model.fluid import DRAG
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.at_grains import DENSEST, given_by_grains
from ryusa.water.at_grains import STRESS as BY_STRESS
from ryusa.water.exchange import FOUR, Ints, add_to_cells, cut_grains, factors_in_water, mean_over_grains
from ryusa.water.exchange_arrays import BedNumbers, GrainNumbers, SliceArrays, WaterLaws
from ryusa.water.fixed_grains import drag_on_fixed
from ryusa.water.free_surface import cut_at_surface

ROW_U, ROW_W, ROW_CONTENT, ROW_SHEAR, ROW_DU_DT, ROW_DTAU_DZ = range(6)  # of the profiles of `time_step`
# rows of the sums over grains in cells: what they gave in the interval, force along x and along z [N], drag
# over slip [N s/m], that times the water that they met [N]; then where they are now, volume [m3] and flux
# upwards [m4/s], and drag over slip
GIVEN_X, GIVEN_Z, GIVEN_DRAG, GIVEN_MET, SOLID, SOLID_W, DRAG_NOW = range(7)
N_SUM = 7
RATE, BAD_GRAIN = 0, 1  # largest over grains: rate at which drag brings one to the speed of the water [1/s]
# rows of the sums over fixed grains: drag over slip, derivative of drag [N s/m], drag along z [N]
N_SUM_FIXED = 3


@kernel
def add_grains(
    cut: SliceArrays, order: Ints, per: Floats, outer: Floats, amounts: Floats, sums: Floats
) -> None:
    """Add amounts of grains (n_grain, m) to the cells, sums (m, n)."""
    outside = np.zeros((amounts.shape[1], 2))
    add_to_cells(
        order, cut.first, cut.n_cells, cut.volume, cut.below, cut.above, per, outer, amounts, sums, outside
    )


@kernel
def means_of_cells(cut: SliceArrays, per: Floats, table: Floats) -> Floats:
    """Means over each grain of cell values (n, m), m a multiple of four."""
    out = np.empty((len(per), table.shape[1]))
    mean_over_grains(cut.first, cut.n_cells, cut.volume, per, table, out)
    return out


@kernel
def sum_given(
    p: ColumnParameters, u: Floats, impulse: Floats, sampled: Floats, grains: GrainNumbers, wet: SliceArrays,
    per_dt: float, sums: Floats,
) -> None:  # fmt: skip
    """Add to the cells what the water gave to the grains, averaged over an interval.

    Parameters
    ----------
    p : the column.
    u : speed of the water along the bed in the interval [m/s], shape (n,).
    impulse, sampled : columns of `model.fluid`.
    grains, wet : the grains, and the slices of their parts below the surface.
    per_dt : one over the interval [1/s].
    sums : rows from GIVEN_X to GIVEN_MET, shape (4, n).
    """
    per, outer = factors_in_water(wet.whole, wet.submerged)
    table = np.zeros((p.n, FOUR))
    table[:, 0] = u
    met = means_of_cells(wet, per, table)[:, 0].copy()
    amounts = given_by_grains(impulse, met, grains.archimedes, sampled, per_dt)
    add_grains(wet, grains.order, per, outer, amounts, sums)


@kernel
def cut_wet(
    cut: SliceArrays, wet: SliceArrays, z: Floats, d: Floats, z_low: float, dz: float, surface: float
) -> bool:
    """Write the slices of the parts below the surface to `wet`, if a grain reaches it; whether one does."""
    n = 0
    out = np.empty(len(z), np.int64)
    for i in range(len(z)):
        if z[i] + 0.5 * d[i] > surface:
            out[n] = i
            n += 1
    if n == 0:
        return False
    wet.first[:] = cut.first
    wet.n_cells[:] = cut.n_cells
    wet.volume[:] = cut.volume
    wet.whole[:] = cut.whole
    wet.submerged[:] = cut.submerged
    wet.below[:] = cut.below
    wet.above[:] = cut.above
    cut_at_surface(
        out[:n], z, 0.5 * d, z_low, dz, surface, cut.first, wet.n_cells, wet.volume, wet.submerged, wet.above
    )
    return True


@kernel
def sum_grains(
    p: ColumnParameters, grains: GrainNumbers, cut: SliceArrays, wet: SliceArrays, reaches: bool, x: Floats,
    v: Floats, impulse: Floats, sampled: Floats, u: Floats, surface: float, per_dt: float, z: Floats,
    sums: Floats, largest: Floats,
) -> bool:  # fmt: skip
    """Sum what the grains gave in the interval, and then what they are where they are now.

    Parameters
    ----------
    p, grains, cut, wet, reaches, x, v, impulse, sampled, z : as in `exchange_step`.
    u, surface : speed along the bed [m/s] and height of the surface [m] of the water in the interval.
    per_dt : one over the interval [1/s].
    sums, largest : are added to, shapes (N_SUM, n) and (2,); BAD_GRAIN: row of a grain that is not finite.

    Returns
    -------
    Whether a grain, where it is now, reaches the surface of the interval.
    """
    sum_given(p, u, impulse, sampled, grains, wet if reaches else cut, per_dt, sums[: GIVEN_MET + 1])
    for i in range(len(z)):
        z[i] = x[i, 2]
        if not math.isfinite(z[i]):
            largest[BAD_GRAIN] = i
            return False
    cut_grains(
        z, 0.5 * grains.d, p.z_low, p.dz, p.n, cut.first, cut.n_cells, cut.volume, cut.whole, cut.submerged,
        cut.below, cut.above,
    )  # fmt: skip
    values = np.empty((len(z), 2))
    for i in range(len(z)):
        solid = grains.solid[i] / cut.whole[i]
        values[i, 0], values[i, 1] = solid, v[i, 2] * solid
    one, none = np.ones(len(z)), np.zeros(len(z))
    add_grains(cut, grains.order, one, none, values, sums[SOLID : SOLID_W + 1])
    meets = cut_wet(cut, wet, z, grains.d, p.z_low, p.dz, surface)
    there = wet if meets else cut
    per, outer = factors_in_water(there.whole, there.submerged)
    drag = np.empty((len(per), 1))
    drag[:, 0] = impulse[:, DRAG]
    add_grains(there, grains.order, per, outer, drag, sums[DRAG_NOW:])
    for i in range(len(per)):
        largest[RATE] = max(largest[RATE], drag[i, 0] / grains.inertia[i])
    return meets


@kernel
def concentration_of_sums(p: ColumnParameters, area: float, sums: Floats, bed: BedNumbers) -> Floats:
    """Concentration of free and fixed grains [-], shape (n,)."""
    phi = np.empty(p.n)
    cells = area * p.dz
    for k in range(p.n):
        phi[k] = sums[SOLID, k] / cells + bed.phi[k]
    return phi


@kernel
def sum_fixed_grains(
    p: ColumnParameters, laws: WaterLaws, bed: BedNumbers, cut: SliceArrays, wet: SliceArrays, rows: Floats,
    z_surface: float, phi: Floats, sums: Floats,
) -> None:  # fmt: skip
    """Sum the drag of fixed grains, by the laws that apply to free grains.

    Parameters
    ----------
    p, laws, bed, cut, wet : as in `exchange_step`, cut and wet of the fixed grains.
    rows, z_surface : water before the step.
    phi : concentration of all grains [-], shape (n,).
    sums : are added to, shape (N_SUM_FIXED, n).

    Notes
    -----
    The drag coefficient of a grain follows from the mean speed over its volume; each slice then acts on the
    water of its cell with the speed in that cell, as for free grains. The derivative of the drag is taken in
    each cell as if the grain lay there alone. The sum is therefore exact in steady flow, and a step of any
    length is stable.
    """
    if bed.taken or len(bed.d) == 0:
        return
    there = wet if cut_wet(cut, wet, bed.z, bed.d, p.z_low, p.dz, z_surface) else cut
    per, outer = factors_in_water(there.whole, there.submerged)
    table = np.zeros((p.n, FOUR))
    for k in range(p.n):
        table[k, 0], table[k, 1] = rows[ROW_U, k], rows[ROW_W, k]
        table[k, 2] = min(phi[k], DENSEST)
    out = np.zeros((len(bed.d), 3))
    if laws.drag != 0:
        drag_on_fixed(
            laws.drag, laws.hindrance, laws.buoyancy == BY_STRESS, laws.exponent,
            means_of_cells(there, per, table), there.submerged / there.whole, bed.d, laws.nu, laws.rho_w,
            laws.a_2, laws.c_d, out,
        )  # fmt: skip
    add_grains(there, bed.order, per, outer, out, sums)
