"""Compiled inlet of a row of columns: water enters over the dam or the bed there (design/0027)."""

import math

from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.closures import bed_thickness

NO_INFLOW = 5  # status beside those of `momentum_balance`: nothing can enter at the inlet


@kernel
def depth_over_bed(bed: float, depth: float, given: bool, q: float, g_z: float) -> float:
    """Depth over the bottom of water that enters over a bed [m].

    Parameters
    ----------
    bed : its thickness [m].
    depth : of the entering water over its bed where it is `given`; else that of the row over its bottom [m].
    q, g_z : discharge per width [m2/s], and gravity normal to the x axis [m/s2].

    Notes
    -----
    Tranquil water does not enter with less than critical depth over the bed, (q**2/g_z)**(1/3), which it has
    at a brink where the surface of the row lies lower.
    """
    if given:
        return bed + depth
    return max(depth, bed + (q * q / g_z) ** (1.0 / 3.0))


@kernel
def inflow(
    p: ColumnParameters, q: float, profile: Floats, first: int, phi: Floats, content: Floats, wet: Floats,
    u: Floats, flux: Floats,
) -> None:  # fmt: skip
    """Speeds [m/s] and fluxes [m2/s] at the inlet, overwritten, so that the discharge is kept.

    Parameters
    ----------
    q : discharge per width [m2/s].
    profile : speeds over height to any scale, shape (n,); over a bed its height counts from there.
    first : number of solid cells of the first segment.
    phi, content, wet : concentration of grains [-], water [m] and wet thickness [m] of the cells beyond the
        end, shape (n,).

    Notes
    -----
    Nothing enters within the bed: its pores take water from above, as their pressure gradient asks.
    """
    bed, total = first * p.dz + bed_thickness(p, phi[first:]), 0.0
    for k in range(p.n):
        u[k] = profile[k]
        if bed > 0.0:
            u[k] = _share_over(p, bed, k, wet[k]) * _speed_at(profile, max(k - bed / p.dz, 0.0))
        total += content[k] * u[k]
    scale = q / total if total > 0.0 else 0.0
    for k in range(p.n):
        u[k] = scale * u[k]
        flux[k] = content[k] * u[k]


@kernel
def _share_over(p: ColumnParameters, bed: float, k: int, wet: float) -> float:
    """Part of the water of a cell that lies over the bed [-]; of a dry cell, whether the cell does."""
    within = bed - k * p.dz
    if within <= 0.0:
        return 1.0
    return max(wet - within, 0.0) / wet if wet > 0.0 else 0.0


@kernel
def _speed_at(profile: Floats, at: float) -> float:
    """Speed of a profile at a place between the middles of its cells, straight between them."""
    k = min(math.floor(at), len(profile) - 2)
    return float(profile[k] + (at - k) * (profile[k + 1] - profile[k]))
