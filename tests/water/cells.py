"""What grains give to cells, by the kernel with which an exchange adds it up."""

from typing import NamedTuple

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.water.exchange import Cells, Share, Slices, add_to_cells


class CellTotals(NamedTuple):
    """Amounts given to each cell, (n,) or (n, m), and below and above the column, () or (m,)."""

    cells: Floats
    below: Floats
    above: Floats


def to_cells(grains: Slices, amounts: Floats, share: Share = "whole") -> CellTotals:
    """Distribute amounts of grains, (n_grain,) or (n_grain, m), over the cells in which they lie."""
    flat, table = amounts.ndim == 1, amounts.reshape(len(amounts), *amounts.shape[1:] or (1,))
    sums, outside = np.zeros((table.shape[1], grains.cells.n)), np.zeros((table.shape[1], 2))
    add_to_cells(
        grains.order, grains.first, grains.count, grains.volume, grains.below, grains.above,
        *grains.factors(share), np.ascontiguousarray(table, dtype=np.float64), sums, outside,
    )  # fmt: skip
    below, above = outside.T
    return CellTotals(sums[0], below[0], above[0]) if flat else CellTotals(sums.T, below, above)


def faces_of(cells: Cells) -> Floats:
    """Heights of the faces [m], shape (n + 1,)."""
    return cells.z_low + np.arange(cells.n + 1, dtype=np.float64) * cells.dz
