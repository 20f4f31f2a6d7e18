"""Grains at the surface of the water: only what of them lies below it is in the water."""

from dataclasses import replace

import numpy as np

from ryusa.laws._law import law
from ryusa.laws.slices import sphere_slice
from ryusa.model.scene import Floats
from ryusa.water.exchange import Ints, Slices


def below(cut: Slices, z: Floats, d: Floats, surface: float) -> Slices:
    """Slices of grains up to the surface of the water, through which its forces go both ways.

    Parameters
    ----------
    cut : slices of whole grains; returned as they are where no grain reaches the surface.
    z, d : heights of their centres and their diameters [m], shape (n_grain,).
    surface : height of the surface [m].

    Returns
    -------
    Slices with what lies higher in `above`; a grain that is dry has no cell.

    >>> from ryusa.water.exchange import Cells, slices
    >>> z, d = np.array([0.0]), np.array([2.0])
    >>> half = below(slices(z, d, Cells(z_low=-1.0, dz=0.3, n=7, area=1.0)), z, d, surface=0.0)
    >>> round(float(half.share[0]), 12), int(half.count[0])
    (0.5, 4)
    """
    out = np.flatnonzero(z + 0.5 * d > surface)
    if not len(out):
        return cut
    count, volume, wet, above = cut.count.copy(), cut.volume.copy(), cut.wet.copy(), cut.above.copy()
    cells = cut.cells
    _trim(out, z, 0.5 * d, cells.z_low, cells.dz, surface, cut.first, count, volume, wet, above)
    return replace(cut, count=count, volume=volume, wet=wet, above=above)


@law  # for its compiler: a loop over arrays that calls laws
def _trim(
    out: Ints, z: Floats, r: Floats, z_low: float, dz: float, surface: float,
    first: Ints, count: Ints, volume: Floats, wet: Floats, above: Floats,
) -> None:  # fmt: skip
    """Take from the slices of the grains `out` what lies above the surface."""
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
        count[i], wet[i] = left, total
        above[i] = max(sphere_slice(r[i], surface - z[i], r[i]), 0.0)
