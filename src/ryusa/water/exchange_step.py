"""One exchange between grains and water as one compiled function, and the water at every grain after it.

A run of few grains spends most of its time between the compiled loops, in calls and small arrays. So all
loops of an exchange are called from here; each is the one that the other functions of this package call.
"""

import math
from typing import NamedTuple

import numpy as np

from ryusa.model.fluid import DRAG
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.at_grains import DENSEST, WEIGHT, given_by_grains, sample
from ryusa.water.at_grains import STRESS as BY_STRESS
from ryusa.water.exchange import (
    FOUR,
    Ints,
    Slices,
    add_to_cells,
    cut_grains,
    factors_in_water,
    mean_over_grains,
)
from ryusa.water.fixed_grains import drag_on_fixed
from ryusa.water.free_surface import cut_at_surface
from ryusa.water.momentum_balance import (
    B_BED,
    B_CHANGE,
    B_DRIVER,
    B_FIXED,
    B_GRAINS,
    B_GRAVITY,
    B_LID,
    B_SHARED,
    B_SIDE,
    B_SURFACE,
    DONE,
    GRADIENT,
    N_GIVEN,
    N_OUT,
    SURFACE,
)
from ryusa.water.time_step import time_step

NOT_FINITE = 100  # status: the height of a grain is not finite; others are those of `time_step`
ROW_U, ROW_W, ROW_CONTENT, ROW_SHEAR, ROW_DU_DT, ROW_DTAU_DZ = range(6)  # of the profiles of `time_step`
# scalars that an exchange writes, beside those of `time_step`
RESIDUAL, FASTEST, REACHES, BAD = range(N_OUT, N_OUT + 4)
N_SCALAR = N_OUT + 4


class SliceArrays(NamedTuple):
    """Arrays of `exchange.Slices`, which an exchange overwrites."""

    first: Ints
    n_cells: Ints  # `Slices.count`
    volume: Floats
    whole: Floats
    submerged: Floats
    below: Floats
    above: Floats

    @staticmethod
    def of(cut: Slices) -> "SliceArrays":
        """Arrays of these slices, not copied."""
        return SliceArrays(cut.first, cut.count, cut.volume, cut.whole, cut.submerged, cut.below, cut.above)

    def copy(self) -> "SliceArrays":
        """Arrays of the same values."""
        ints = self.first.copy(), self.n_cells.copy()
        parts = self.whole.copy(), self.submerged.copy(), self.below.copy(), self.above.copy()
        return SliceArrays(*ints, self.volume.copy(), *parts)


class GrainNumbers(NamedTuple):
    """Numbers of the free grains that are constant during a run, each of shape (n_grain,)."""

    order: Ints  # 0 .. n_grain - 1
    d: Floats  # diameter [m]
    solid: Floats  # volume A_3 d**3 [m3]
    archimedes: Floats  # buoyancy of still water along the bed [N]
    inertia: Floats  # mass and added mass [kg]


class BedNumbers(NamedTuple):
    """Fixed grains, n_bed of them; none where the law of a rough wall stands for them."""

    order: Ints  # 0 .. n_bed - 1
    z: Floats  # heights of the centres [m], shape (n_bed,)
    d: Floats  # diameters [m], shape (n_bed,)
    phi: Floats  # concentration of all fixed grains in the cells [-], shape (n,)
    taken: bool  # the wall law takes their drag and buoyancy


class WaterLaws(NamedTuple):
    """Choices and constants of the forces of water on grains."""

    drag: int
    hindrance: int
    buoyancy: int
    exponent: float
    nu: float
    rho_w: float
    a_2: float
    c_d: float
    g_x: float
    g_z: float


@kernel
def cells_of_grains(
    cut: SliceArrays, order: Ints, per: Floats, outer: Floats, amounts: Floats, n: int
) -> Floats:
    """Amounts of grains (n_grain, m) summed in the cells, shape (m, n)."""
    sums, outside = np.zeros((amounts.shape[1], n)), np.zeros((amounts.shape[1], 2))
    add_to_cells(
        order, cut.first, cut.n_cells, cut.volume, cut.below, cut.above, per, outer, amounts, sums, outside
    )
    return sums


@kernel
def means_of_cells(cut: SliceArrays, per: Floats, table: Floats) -> Floats:
    """Means over each grain of cell values (n, m), m a multiple of four."""
    out = np.empty((len(per), table.shape[1]))
    mean_over_grains(cut.first, cut.n_cells, cut.volume, per, table, out)
    return out


@kernel
def force_on_water(
    p: ColumnParameters, area: float, u: Floats, impulse: Floats, sampled: Floats, grains: GrainNumbers,
    wet: SliceArrays, per_dt: float, force_z: Floats,
) -> Floats:  # fmt: skip
    """Force of the water on grains along the bed, averaged over an interval, per volume of cells [N/m3].

    Each slice acts on the water with the slip in its cell; the sum over slices is the force on the grain.

    Parameters
    ----------
    p, area : the column, and the area of its bed [m2].
    u : speed of the water along the bed in the interval [m/s], shape (n,).
    impulse, sampled : columns of `model.fluid`.
    grains, wet : the grains, and the slices of their parts below the surface.
    per_dt : one over the interval [1/s].
    force_z : receives the force along z per volume of cells [N/m3], shape (n,).
    """
    per, outer = factors_in_water(wet.whole, wet.submerged)
    table = np.zeros((p.n, FOUR))
    table[:, 0] = u
    met = means_of_cells(wet, per, table)[:, 0].copy()
    amounts = given_by_grains(impulse, met, grains.archimedes, sampled, per_dt)
    sums = cells_of_grains(wet, grains.order, per, outer, amounts, p.n)
    force = np.empty(p.n)
    volume = area * p.dz
    for k in range(p.n):
        force_z[k] = sums[1, k] / volume
        force[k] = sums[0, k] / volume + (sums[2, k] / volume * u[k] - sums[3, k] / volume)
    return force


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
def add_fixed_grains(
    p: ColumnParameters, area: float, laws: WaterLaws, bed: BedNumbers, cut: SliceArrays, wet: SliceArrays,
    rows: Floats, z_surface: float, gradient: float, given: Floats, force_z: Floats,
) -> tuple[Floats, Floats, Floats]:  # fmt: skip
    """Forces of the water on fixed grains per volume of cells, by the laws that apply to free grains.

    Parameters
    ----------
    p, area, laws, bed, cut, wet : as in `exchange_step`, cut and wet of the fixed grains.
    rows, z_surface, gradient : water before the step.
    given : row 3 is the concentration of all grains [-].
    force_z : the drag upwards is added [N/m3], shape (n,).

    Returns
    -------
    force, slope, carried : force along the bed [N/m3], its derivative with respect to the speed of the water
        [N s/m4] and share of d tau/dz that they take in addition [-], each of shape (n,).

    Notes
    -----
    The drag coefficient of a grain follows from the mean speed over its volume; each slice then acts on the
    water of its cell with the speed in that cell, as for free grains. The derivative of the drag is taken in
    each cell as if the grain lay there alone. The sum is therefore exact in steady flow, and a step of any
    length is stable.
    """
    force, slope, carried = np.zeros(p.n), np.zeros(p.n), np.zeros(p.n)
    if bed.taken:
        return force, slope, carried
    volume = area * p.dz
    if len(bed.d) > 0:
        there = wet if cut_wet(cut, wet, bed.z, bed.d, p.z_low, p.dz, z_surface) else cut
        per, outer = factors_in_water(there.whole, there.submerged)
        table = np.zeros((p.n, FOUR))
        for k in range(p.n):
            table[k, 0], table[k, 1] = rows[ROW_U, k], rows[ROW_W, k]
            table[k, 2] = min(given[3, k], DENSEST)
        out = np.zeros((len(bed.d), 3))
        if laws.drag != 0:
            drag_on_fixed(
                laws.drag, laws.hindrance, laws.buoyancy == BY_STRESS, laws.exponent,
                means_of_cells(there, per, table), there.submerged / there.whole, bed.d, laws.nu, laws.rho_w,
                laws.a_2, laws.c_d, out,
            )  # fmt: skip
        sums = cells_of_grains(there, bed.order, per, outer, out, p.n)
        for k in range(p.n):
            force[k] = sums[0, k] / volume * rows[ROW_U, k]
            slope[k] = sums[1, k] / volume
            force_z[k] += sums[2, k] / volume
    for k in range(p.n):
        below = min(max((z_surface - (p.z_low + k * p.dz)) / p.dz, 0.0), 1.0)
        if laws.buoyancy == BY_STRESS:
            force[k] += bed.phi[k] * below * gradient
            carried[k] = bed.phi[k]
        elif laws.buoyancy == WEIGHT:
            force[k] += bed.phi[k] * below * (gradient - p.rho_w * p.g_x)
    return force, slope, carried


@kernel
def exchange_step(
    p: ColumnParameters, area: float, laws: WaterLaws, grains: GrainNumbers, bed: BedNumbers,
    cut: SliceArrays, wet: SliceArrays, bed_cut: SliceArrays, bed_wet: SliceArrays, reaches: bool,
    x: Floats, v: Floats, impulse: Floats, sampled: Floats, dt: float, volume: float, scalars_before: Floats,
    rows_before: Floats, z: Floats, phi: Floats, force_z: Floats, rows: Floats, faces: Floats, out: Floats,
) -> int:  # fmt: skip
    """Give the water what the grains took in the interval, and move it on.

    Parameters
    ----------
    p, area, laws : the column, the area of its bed [m2], and the forces on its grains.
    grains, bed : free and fixed grains.
    cut, wet : slices of the free grains, and of their parts below the surface where one `reaches` it; both
        are overwritten by those at the new positions.
    bed_cut, bed_wet : the same of the fixed grains; `bed_wet` is work space.
    x, v, impulse, sampled : as in `Coupling.exchange`.
    dt : the interval [s].
    volume : water per area of bed [m].
    scalars_before, rows_before : scalars and profiles that the last call wrote.
    z, phi, force_z : receive the heights of the grains [m], the concentration [-] and the force of the water
        on grains along z per volume of cells [N/m3].
    rows, faces, out : profiles as in `time_step`, and scalars, shape (N_SCALAR,).

    Returns
    -------
    status : DONE, a fault of `time_step`, or NOT_FINITE with the grain in `out[BAD]`.
    """
    n, cells = p.n, area * p.dz
    u = rows_before[ROW_U]
    force = force_on_water(p, area, u, impulse, sampled, grains, wet if reaches else cut, 1.0 / dt, force_z)
    for i in range(len(z)):
        z[i] = x[i, 2]
        if not math.isfinite(z[i]):
            out[BAD] = i
            return NOT_FINITE
    cut_grains(
        z, 0.5 * grains.d, p.z_low, p.dz, n, cut.first, cut.n_cells, cut.volume, cut.whole, cut.submerged,
        cut.below, cut.above,
    )  # fmt: skip
    values = np.empty((len(z), 2))
    for i in range(len(z)):
        solid = grains.solid[i] / cut.whole[i]
        values[i, 0], values[i, 1] = solid, v[i, 2] * solid
    one, none = np.ones(len(z)), np.zeros(len(z))
    both = cells_of_grains(cut, grains.order, one, none, values, n)
    given = np.zeros((N_GIVEN, n))
    for k in range(n):
        phi[k] = both[0, k] / cells + bed.phi[k]
        given[3, k], given[7, k] = phi[k], both[1, k] / cells
    fixed, slope, carried = add_fixed_grains(
        p, area, laws, bed, bed_cut, bed_wet, rows_before, scalars_before[SURFACE], scalars_before[GRADIENT],
        given, force_z,
    )  # fmt: skip
    given[0], given[1], given[2] = u, rows_before[ROW_CONTENT], u
    given[4], given[5], given[6] = force + fixed, slope, carried
    status = time_step(p, given, volume, 1.0 / dt, rows, faces, out)
    if status != DONE:
        return status
    taken = 0.0
    for k in range(n):
        taken += fixed[k]
    for k in range(n):
        if rows[ROW_CONTENT, k] > 0.0:
            taken += slope[k] * (rows[ROW_U, k] - u[k])
    taken *= p.dz
    out[B_GRAINS] += taken
    out[B_FIXED] = out[B_SHARED] - taken
    out[B_SHARED] = 0.0
    out[RESIDUAL] = relative_residual(out)
    meets = cut_wet(cut, wet, z, grains.d, p.z_low, p.dz, out[SURFACE])
    out[REACHES] = 1.0 if meets else 0.0
    out[FASTEST] = fastest_relaxation(p, area, laws, grains, wet if meets else cut, impulse, phi)
    return DONE


@kernel
def relative_residual(out: Floats) -> float:
    """`Budget.relative` of the scalars of a step [-]."""
    gains = out[B_GRAVITY] + out[B_DRIVER] + out[B_BED] + out[B_LID] + out[B_SIDE]
    residual = out[B_CHANGE] - (gains + out[B_GRAINS] + out[B_FIXED] + out[B_SHARED] + out[B_SURFACE])
    largest = abs(out[B_FIXED])
    for k in range(B_GRAVITY, B_CHANGE + 1):
        largest = max(largest, abs(out[k]))
    return abs(residual) / largest if largest > 0.0 else 0.0


@kernel
def fastest_relaxation(
    p: ColumnParameters, area: float, laws: WaterLaws, grains: GrainNumbers, wet: SliceArrays,
    impulse: Floats, phi: Floats,
) -> float:  # fmt: skip
    """Largest rate at which drag brings water to the speed of grains or grains to that of water [1/s]."""
    per, outer = factors_in_water(wet.whole, wet.submerged)
    drag = np.empty((len(per), 1))
    drag[:, 0] = impulse[:, DRAG]
    sums = cells_of_grains(wet, grains.order, per, outer, drag, p.n)
    fastest = 0.0
    for k in range(p.n):
        water = laws.rho_w * max(1.0 - phi[k], 1.0 - DENSEST)
        fastest = max(fastest, sums[0, k] / (area * p.dz) / water)
    for i in range(len(per)):
        fastest = max(fastest, drag[i, 0] / grains.inertia[i])
    return fastest


@kernel
def water_at_grains(
    p: ColumnParameters, laws: WaterLaws, grains: GrainNumbers, wet: SliceArrays, rows: Floats,
    gradient: float, phi: Floats, force_z: Floats, eddies: Floats, sampled: Floats,
) -> None:  # fmt: skip
    """Fill `sampled`, columns of `model.fluid`, with the water at every grain.

    Parameters
    ----------
    p, laws, grains, wet : as in `exchange_step`.
    rows, gradient : profiles of the water, and its driving pressure gradient [Pa/m].
    phi, force_z : concentration [-], and force on grains along z per volume of cells [N/m3], shape (n,).
    eddies : velocity of the eddy at each grain [m/s], shape (n_grain, 3); (0, 3) without.
    """
    per, _ = factors_in_water(wet.whole, wet.submerged)
    table = np.zeros((p.n, 2 * FOUR))
    for k in range(p.n):
        table[k, 0], table[k, 1], table[k, 2] = rows[ROW_U, k], rows[ROW_W, k], rows[ROW_SHEAR, k]
        table[k, 3], table[k, 4] = phi[k], rows[ROW_DU_DT, k]
        if laws.buoyancy == BY_STRESS:
            table[k, 5] = rows[ROW_DTAU_DZ, k]
            table[k, 6] = force_z[k] / max(1.0 - phi[k], 1.0 - DENSEST)
    sample(
        means_of_cells(wet, per, table), wet.submerged / wet.whole, grains.solid, eddies, laws.buoyancy,
        gradient, laws.rho_w, laws.g_x, laws.g_z, sampled,
    )  # fmt: skip
