"""Closures of a column: applies the laws of turbulence and of walls to its cells and faces."""

import math

from ryusa.laws._family import numbers
from ryusa.laws.dispatch import (
    length_of_layers,
    length_through_grains,
    mixing_length,
    side_friction,
    wall_stress,
)
from ryusa.laws.families import BedKind, Mixing
from ryusa.laws.side_walls import friction_gap_laminar, side_wall_drag
from ryusa.laws.turbulence import (
    height_between,
    length_growth_li_sawamoto,
    length_pore_egashira,
    length_shear_layer,
)
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel

NO_SLIP, SMOOTH, ROUGH, MOVING = numbers(
    __name__, BedKind.NO_SLIP, BedKind.SMOOTH, BedKind.ROUGH, BedKind.MOVING
)
LAMINAR = int(Mixing.LAMINAR)
LOOSE = 1.0 / 3.0  # of the packed concentration, from which grains on the bottom are a bed, settled or not
RE_SLOW = 1500.0  # below it the flow between the side walls is laminar; both turbulent laws give less there


@kernel
def pores(p: ColumnParameters, phi: float) -> float:
    """Square of the mixing length in the pores [m2]; at most d**2, and 0 where k_f is 0."""
    if p.k_f > 0.0:
        length = min(length_pore_egashira(phi, p.d, p.k_f), p.d) if phi > 0.0 else p.d
        return length * length
    return 0.0


@kernel
def averaged(dz: float, d: float, m: int, phi: Floats) -> Floats:
    """Concentration averaged over one grain diameter in the cells 0..m [-]; unchanged where d is nan.

    The average removes the layering of a bed and the scatter of a scene with few grains. At both ends only
    the part of the window that lies in the cells is used.
    """
    mean = phi.copy()
    reach = 0.5 * d / dz - 0.5  # cells on either side, the last one partly
    if reach > 0.0:
        full = math.floor(reach)
        for k in range(m + 1):
            total, weight = 0.0, 0.0
            for j in range(max(k - full - 1, 0), min(k + full + 1, m) + 1):
                part = 1.0 if abs(j - k) <= full else reach - full
                total += part * phi[j]
                weight += part
            mean[k] = total / weight
    return mean


@kernel
def bed_thickness(p: ColumnParameters, phi: Floats) -> float:
    """Thickness of the bed of grains that lies on the bottom [m]; 0 without one.

    Notes
    -----
    It reaches from the bottom up to where the concentration phi [-] of the cells, averaged over the height of
    a grain, falls below LOOSE times that of a bed at rest; thin layers with less do not end it, up to the
    height of a grain.
    """
    cells = len(phi)
    mean, least = averaged(p.dz, p.d, cells - 1, phi), LOOSE * p.phi_max
    top = -1
    for k in range(cells):
        if mean[k] >= least:
            top = k
        elif not (k - top) * p.dz <= p.d:
            break
    if top < 0:
        return 0.0
    if top + 1 == cells:
        return cells * p.dz
    return (top + 0.5 + (mean[top] - least) / (mean[top] - mean[top + 1])) * p.dz


@kernel
def packed_below(p: ColumnParameters, m: int, phi: Floats) -> int:
    """Lowest face above all packed cells, phi >= phi_max, of the cells 0..m; 0 where none is packed."""
    for k in range(m, -1, -1):
        if phi[k] >= p.phi_max:
            return k + 1
    return 0


@kernel
def mixing_lengths(
    p: ColumnParameters, m: int, phi: Floats, z: Floats, z_surface: float, u_star: float, square: Floats
) -> None:
    """Square of the mixing length times the share of water at the faces 0..m [m2], written to `square`.

    Parameters
    ----------
    p : the column.
    m : highest wet cell.
    phi : concentration [-], shape (n,).
    z : middles of the wet part of the cells [m], shape (n,).
    z_surface : height of the surface [m].
    u_star : friction velocity at the bed [m/s], for van Driest.
    square : shape (n + 1,); zero at and above the surface, and at the bed except for the pore length.

    Notes
    -----
    Over a fixed bed the length at a face is taken at `height_between` of the two neighbouring cell middles,
    so that the cells reproduce the log law from the wall upwards. The pore length is used where it is the
    larger one; it never exceeds one grain diameter. For the length of Li & Sawamoto phi is averaged over one
    diameter, and every cell below the highest packed cell is treated as packed: otherwise the mixing length
    would grow in loose parts of the bed. YADE's HydroForceEngine (code read) does the same with the phi of
    the cells, without averaging.
    """
    square[:] = 0.0
    crest, mean = 0, phi
    grains = length_through_grains(p.mixing)
    if grains:
        mean = averaged(p.dz, p.d, m, phi)
        crest = packed_below(p, m, mean)
    depth = z_surface - p.z_bed
    walled = p.bed != MOVING
    grown = 0.0
    for f in range(1, m + 1):
        face = p.z_low + f * p.dz - p.z_bed
        low, high = z[f - 1] - p.z_bed, z[f] - p.z_bed
        at = height_between(low, high) if walled and low > 0.0 else face
        length = 0.0
        if grains:
            below, above = 0.0, 0.0
            if f > crest:
                below = length_growth_li_sawamoto(mean[f - 1], p.phi_max, p.dz, p.kappa)
            if f >= crest:
                above = length_growth_li_sawamoto(mean[f], p.phi_max, p.dz, p.kappa)
            low, high = grown + 0.5 * below, grown + below + 0.5 * above
            grown += below
            length = height_between(low, high) if walled and low > 0.0 else grown
        elif p.mixing != LAMINAR:
            length = mixing_length(p.mixing, at, face, depth, u_star, p.nu, p.kappa)
        share = 0.5 * (phi[f - 1] + phi[f])
        square[f] = max((1.0 - share) * length * length, pores(p, share))
    square[0] = pores(p, phi[0])


@kernel
def bound_by_layers(p: ColumnParameters, m: int, phi: Floats, z: Floats, u: Floats, square: Floats) -> None:
    """Bound the mixing length by the thickness of the layers over which the highest speed is lost.

    Parameters
    ----------
    p, m, phi : the column, its highest wet cell, and concentration [-], shape (n,).
    z, u : middles of the wet part of the cells [m], and speeds there [m/s], shape (n,).
    square : of `mixing_lengths` [m2], overwritten; what the pores have stays.

    Notes
    -----
    One layer reaches from the highest speed to the surface, above a jet along the bed, the other down to the
    bed, a mixing layer as behind a step. A bound counts in full from a shape factor of 3 on, as layers have
    that part from a wall or end in still water, and not at all below 2, as along walls.
    """
    if not length_of_layers(p.mixing):
        return
    at = 0
    for k in range(1, m + 1):
        if abs(u[k]) > abs(u[at]):
            at = k
    if u[at] == 0.0:
        return
    # down to a bed of grains, whose drag slows the water in their pores
    low = min(math.floor(bed_thickness(p, phi[: m + 1]) / p.dz + 0.5), at)
    along = math.copysign(1.0, u[at])
    bound_by_layer(p, at, m, along, phi, z, u, square)
    bound_by_layer(p, at, low, along, phi, z, u, square)


@kernel
def bound_by_layer(
    p: ColumnParameters, at: int, end: int, along: float, phi: Floats, z: Floats, u: Floats, square: Floats
) -> None:
    """The same at the faces between the cell of the highest speed and that at the end of a layer."""
    way = 1 if end > at else -1
    highest, least, steepest = along * u[at], along * u[at], 0.0
    lost, carried = 0.0, 0.0  # thickness of displacement, and of momentum [m]
    for k in range(at + way, end + way, way):
        here, before, gap = along * u[k], along * u[k - way], abs(z[k] - z[k - way])
        least, steepest = min(least, here), max(steepest, (before - here) / gap)
        for one in (before / highest, here / highest):
            lost += 0.5 * gap * (1.0 - one)
            carried += 0.5 * gap * (1.0 - one) * one
    if not steepest > 0.0:
        return
    most = length_shear_layer((highest - least) / steepest)
    part = min(max(lost / carried - 2.0, 0.0), 1.0) if carried > 0.0 else 1.0
    for f in range(min(at, end) + 1, max(at, end) + 1):
        share = 0.5 * (phi[f - 1] + phi[f])
        length, bound = math.sqrt(square[f]), math.sqrt(1.0 - share) * most
        if length > bound:
            length += part * (bound - length)
            square[f] = max(length * length, pores(p, share))


@kernel
def bed_stress(p: ColumnParameters, u: float, z: float, square: float) -> tuple[float, float]:
    """Bed stress over density [m2/s2] and its derivative [m/s]; u [m/s] at the height z [m] above the bed.

    `square` [m2] is the value of `mixing_lengths` at the bed, used where no wall law applies.
    """
    return wall_stress(p.bed, u, z, p.nu, p.k_rough, square)


@kernel
def bed_shear(p: ColumnParameters, u: float, z: float, stress: float) -> float:
    """Velocity gradient [1/s] in the lowest cell, z [m] above the wall; stress over density [m2/s2]."""
    if p.bed == ROUGH or (p.bed == SMOOTH and z * math.sqrt(abs(stress)) > 11.3 * p.nu):
        return math.copysign(math.sqrt(abs(stress)), stress) / (p.kappa * z)
    return u / z


@kernel
def side_drag(p: ColumnParameters, u: float) -> tuple[float, float]:
    """Deceleration by the side walls at speed u [m/s2], and its derivative with respect to u [1/s]."""
    re = 2.0 * abs(u) * p.width / p.nu
    if not re > 0.0:
        return 0.0 * u, 0.0
    friction = friction_gap_laminar(re)
    power = 1.0  # the drag grows with this power of the speed
    if p.side and re > RE_SLOW:
        turbulent = side_friction(p.side, re)
        if turbulent > friction:
            friction, power = turbulent, 1.75
    drag = side_wall_drag(u, friction, p.width)
    return drag, power * drag / u
