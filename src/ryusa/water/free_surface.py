"""Grains at the free surface: water acts only on the part below it."""

from dataclasses import replace

import numpy as np

from ryusa.laws.slices import sphere_slice
from ryusa.model.scene import Floats
from ryusa.water._kernel import kernel
from ryusa.water.exchange import Ints, Slices


def submerged_part(cut: Slices, z: Floats, d: Floats, surface: float) -> Slices:
    """Slices of the parts of grains below the water surface, on which water and grains act on each other.

    Parameters
    ----------
    cut : slices of whole grains; returned unchanged where no grain reaches the surface.
    z, d : heights of their centres and their diameters [m], shape (n_grain,).
    surface : height of the surface [m].

    Returns
    -------
    Slices whose part above the surface is in `above`; a grain above the water has no cell.

    >>> from ryusa.water.exchange import Cells, slices
    >>> z, d = np.array([0.0]), np.array([2.0])
    >>> half = submerged_part(slices(z, d, Cells(z_low=-1.0, dz=0.3, n=7, area=1.0)), z, d, surface=0.0)
    >>> round(float(half.share[0]), 12), int(half.count[0])
    (0.5, 4)
    """
    out = np.flatnonzero(z + 0.5 * d > surface)
    if not len(out):
        return cut
    count = cut.count.copy()
    volume = cut.volume.copy()
    submerged = cut.submerged.copy()
    above = cut.above.copy()
    cells = cut.cells
    cut_at_surface(
        out, z, 0.5 * d, cells.z_low, cells.dz, surface, cut.first, count, volume, submerged, above
    )
    return replace(cut, count=count, volume=volume, submerged=submerged, above=above)


@kernel
def cut_at_surface(
    out: Ints, z: Floats, r: Floats, z_low: float, dz: float, surface: float,
    first: Ints, count: Ints, volume: Floats, submerged: Floats, above: Floats,
) -> None:  # fmt: skip
    """Remove the part above the surface from the slices of the grains `out`."""
    for k in range(out.shape[0]):
        i = int(out[k])
        total = 0.0
        left = 0
        for s in range(count[i]):
            low = z_low + (first[i] + s) * dz
            if low >= surface:
                break
            if low + dz > surface:
                volume[i, s] = max(sphere_slice(r[i], low - z[i], surface - z[i]), 0.0)
            total += volume[i, s]
            left += 1
        count[i], submerged[i] = left, total
        above[i] = max(sphere_slice(r[i], surface - z[i], r[i]), 0.0)
