"""One exchange between grains and water as one compiled function, and the water at every grain after it.

A run of few grains spends most of its time between the compiled loops, in calls and small arrays. So all
loops of an exchange are called from here; each is the one that the other functions of this package call.
Where processes share the grains, the same loops are called one by one, with sums over processes between them.
"""

from typing import Any

import numpy as np

from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.at_grains import DENSEST, WEIGHT, sample
from ryusa.water.at_grains import STRESS as BY_STRESS
from ryusa.water.exchange import FOUR, Ints, factors_in_water
from ryusa.water.exchange_arrays import BedNumbers, GrainNumbers, SliceArrays, WaterLaws
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
from ryusa.water.processes import SharingProcesses
from ryusa.water.slice_sums import (
    BAD_GRAIN,
    DRAG_NOW,
    GIVEN_DRAG,
    GIVEN_MET,
    GIVEN_X,
    GIVEN_Z,
    N_SUM,
    N_SUM_FIXED,
    RATE,
    ROW_CONTENT,
    ROW_DTAU_DZ,
    ROW_DU_DT,
    ROW_SHEAR,
    ROW_U,
    ROW_W,
    SOLID_W,
    concentration_of_sums,
    cut_wet,
    means_of_cells,
    sum_fixed_grains,
    sum_grains,
)
from ryusa.water.time_step import time_step

NOT_FINITE = 100  # status: the height of a grain is not finite; others are those of `time_step`
# scalars that an exchange writes, beside those of `time_step`
RESIDUAL, FASTEST, REACHES, BAD = range(N_OUT, N_OUT + 4)
N_SCALAR = N_OUT + 4


@kernel
def force_on_water(p: ColumnParameters, area: float, u: Floats, sums: Floats, force_z: Floats) -> Floats:
    """Force of the water on grains along the bed, averaged over an interval, per volume of cells [N/m3].

    Each slice acts on the water with the slip in its cell; the sum over slices is the force on the grain.

    Parameters
    ----------
    p, area : the column, and the area of its bed [m2].
    u : speed of the water along the bed in the interval [m/s], shape (n,).
    sums : of `sum_given`, over all grains.
    force_z : receives the force along z per volume of cells [N/m3], shape (n,).
    """
    force = np.empty(p.n)
    volume = area * p.dz
    for k in range(p.n):
        force_z[k] = sums[GIVEN_Z, k] / volume
        force[k] = sums[GIVEN_X, k] / volume + (
            sums[GIVEN_DRAG, k] / volume * u[k] - sums[GIVEN_MET, k] / volume
        )
    return force


@kernel
def fixed_grain_forces(
    p: ColumnParameters, area: float, laws: WaterLaws, bed: BedNumbers, sums: Floats, rows: Floats,
    z_surface: float, gradient: float, force_z: Floats,
) -> tuple[Floats, Floats, Floats]:  # fmt: skip
    """Forces of the water on fixed grains per volume of cells.

    Parameters
    ----------
    p, area, laws, bed : as in `exchange_step`.
    sums : of `sum_fixed_grains`, over all fixed grains.
    rows, z_surface, gradient : water before the step.
    force_z : the drag upwards is added [N/m3], shape (n,).

    Returns
    -------
    force, slope, carried : force along the bed [N/m3], its derivative with respect to the speed of the water
        [N s/m4] and share of d tau/dz that they take in addition [-], each of shape (n,).
    """
    force, slope, carried = np.zeros(p.n), np.zeros(p.n), np.zeros(p.n)
    if bed.taken:
        return force, slope, carried
    volume = area * p.dz
    for k in range(p.n):
        force[k] = sums[0, k] / volume * rows[ROW_U, k]
        slope[k] = sums[1, k] / volume
        force_z[k] += sums[2, k] / volume
        below = min(max((z_surface - (p.z_low + k * p.dz)) / p.dz, 0.0), 1.0)
        if laws.buoyancy == BY_STRESS:
            force[k] += bed.phi[k] * below * gradient
            carried[k] = bed.phi[k]
        elif laws.buoyancy == WEIGHT:
            force[k] += bed.phi[k] * below * (gradient - p.rho_w * p.g_x)
    return force, slope, carried


@kernel
def move_water(
    p: ColumnParameters, area: float, laws: WaterLaws, bed: BedNumbers, sums: Floats, sums_fixed: Floats,
    dt: float, volume: float, scalars_before: Floats, rows_before: Floats, phi: Floats, force_z: Floats,
    rows: Floats, faces: Floats, out: Floats,
) -> int:  # fmt: skip
    """Move the water on by an interval, given the sums over all grains; it knows of no single grain.

    Parameters
    ----------
    sums, sums_fixed : of `sum_grains` and of `sum_fixed_grains`.
    others : as in `exchange_step`.

    Returns
    -------
    status : DONE, or a fault of `time_step`.
    """
    n, u = p.n, rows_before[ROW_U]
    force = force_on_water(p, area, u, sums, force_z)
    phi[:] = concentration_of_sums(p, area, sums, bed)
    fixed, slope, carried = fixed_grain_forces(
        p, area, laws, bed, sums_fixed, rows_before, scalars_before[SURFACE], scalars_before[GRADIENT],
        force_z,
    )  # fmt: skip
    given = np.zeros((N_GIVEN, n))
    given[0], given[1], given[2] = u, rows_before[ROW_CONTENT], u
    given[3], given[4], given[5], given[6] = phi, force + fixed, slope, carried
    for k in range(n):
        given[7, k] = sums[SOLID_W, k] / (area * p.dz)
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
    return DONE


@kernel
def finish(
    p: ColumnParameters, area: float, laws: WaterLaws, grains: GrainNumbers, cut: SliceArrays,
    wet: SliceArrays, meets: bool, surface: float, z: Floats, phi: Floats, sums: Floats, largest: Floats,
    out: Floats,
) -> None:  # fmt: skip
    """Cut the grains at the new surface, and find the fastest relaxation by drag.

    Parameters
    ----------
    meets, surface : of `sum_grains`: whether a grain reaches the surface of the interval, and its height [m].
    sums, largest : of `sum_grains`, over all grains.
    others : as in `exchange_step`.
    """
    if out[SURFACE] != surface:
        meets = cut_wet(cut, wet, z, grains.d, p.z_low, p.dz, out[SURFACE])
    out[REACHES] = 1.0 if meets else 0.0
    out[FASTEST] = fastest_relaxation(p, area, laws, sums[DRAG_NOW], largest[RATE], phi)


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
    surface = scalars_before[SURFACE]
    sums, largest = np.zeros((N_SUM, p.n)), np.array([0.0, -1.0])
    meets = sum_grains(
        p, grains, cut, wet, reaches, x, v, impulse, sampled, rows_before[ROW_U], surface, 1.0 / dt, z, sums,
        largest,
    )  # fmt: skip
    out[BAD] = largest[BAD_GRAIN]
    if out[BAD] >= 0.0:
        return NOT_FINITE
    fixed = np.zeros((N_SUM_FIXED, p.n))
    sum_fixed_grains(
        p, laws, bed, bed_cut, bed_wet, rows_before, surface, concentration_of_sums(p, area, sums, bed), fixed
    )
    status = move_water(
        p, area, laws, bed, sums, fixed, dt, volume, scalars_before, rows_before, phi, force_z, rows, faces,
        out,
    )  # fmt: skip
    if status == DONE:
        finish(p, area, laws, grains, cut, wet, meets, surface, z, phi, sums, largest, out)
    return status


def exchange_of_processes(
    processes: SharingProcesses, ids: Ints, a: Any, motion: tuple[Floats, Floats, Floats, Floats], dt: float,
    volume: float, scalars_before: Floats, rows_before: Floats, phi: Floats, rows: Floats, faces: Floats,
    out: Floats,
) -> int:  # fmt: skip
    """`exchange_step` where processes share the grains: each sums its own, and all move the same water.

    Parameters
    ----------
    processes : that share them.
    ids : of the grains in this process.
    a : arrays of `exchange_arrays.ExchangeArrays`.
    motion : x, v, impulse, sampled.
    others : as in `exchange_step`; out[BAD] is the id of a grain.
    """
    p, surface = a.p, scalars_before[SURFACE]
    sums, largest = np.zeros((N_SUM, p.n)), np.array([0.0, -1.0])
    meets = sum_grains(
        p, a.grains, a.cut, a.wet, a.reaches, *motion, rows_before[ROW_U], surface, 1.0 / dt, a.z, sums,
        largest,
    )  # fmt: skip
    if largest[BAD_GRAIN] >= 0.0:
        largest[BAD_GRAIN] = ids[int(largest[BAD_GRAIN])]
    processes.largest(largest)
    out[BAD] = largest[BAD_GRAIN]
    if out[BAD] >= 0.0:
        return NOT_FINITE
    processes.add(sums)
    fixed = np.zeros((N_SUM_FIXED, p.n))
    if a.bed.phi.any() and not a.bed.taken:
        there = concentration_of_sums(p, a.area, sums, a.bed)
        sum_fixed_grains(p, a.laws, a.bed, a.bed_cut, a.bed_wet, rows_before, surface, there, fixed)
        processes.add(fixed)
    status = move_water(
        p, a.area, a.laws, a.bed, sums, fixed, dt, volume, scalars_before, rows_before, phi, a.force_z, rows,
        faces, out,
    )  # fmt: skip
    if status == DONE:
        finish(p, a.area, a.laws, a.grains, a.cut, a.wet, meets, surface, a.z, phi, sums, largest, out)
    return status


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
    p: ColumnParameters, area: float, laws: WaterLaws, drag: Floats, by_grain: float, phi: Floats
) -> float:
    """Largest rate at which drag brings water to the speed of grains or grains to that of water [1/s].

    Parameters
    ----------
    drag : over slip, summed in cells [N s/m], shape (n,).
    by_grain : largest rate of a grain [1/s].
    """
    fastest = 0.0
    for k in range(p.n):
        water = laws.rho_w * max(1.0 - phi[k], 1.0 - DENSEST)
        fastest = max(fastest, drag[k] / (area * p.dz) / water)
    return max(fastest, by_grain)


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
