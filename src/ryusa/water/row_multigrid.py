"""V-cycle for the pressure of a row: pairs of columns become one, and whole columns are relaxed.

The cells are flat, so that what couples them strongly is vertical: along z everything is solved exactly, and
only along x is the system made coarser. Even columns and odd ones lie in arrays of their own, cell by cell,
so that all inner loops run over columns; where a cell has no pressure of its own stands a row of the
identity. Relaxed are the even columns, then the odd ones, and on the way back the odd ones first: the cycle
is symmetric and conjugate gradients may use it. Design, and what other solvers take: design/0030.
"""

from typing import NamedTuple

import numpy as np

from ryusa.model.scene import Floats
from ryusa.water._kernel import kernel
from ryusa.water.exchange import Ints

COARSEST = 4  # columns at most on the coarsest grid


class Multigrid(NamedTuple):
    """The grids, finest first, one after the other in flat arrays; on each (2, n, width) with a rim."""

    width: Ints  # columns of one parity and the rim on both sides, shape (n_grid,)
    begin: Ints  # where each grid begins, shape (n_grid + 1,)
    west: Floats  # coupling to the column west [1/s]
    down: Floats  # coupling to the cell below
    leak: Floats  # what couples a cell to p' = 0
    pivot: Floats  # one over the pivot of its elimination along z
    factor: Floats  # multiplier of that elimination
    right: Floats  # right-hand sides
    z: Floats  # solutions

    @staticmethod
    def of(columns: int, n: int) -> "Multigrid":
        """Grids for a number of columns of n cells."""
        counts = [columns]
        while counts[-1] > COARSEST:
            counts.append((counts[-1] + 1) // 2)
        width = np.array([(count + 1) // 2 + 2 for count in counts])
        begin = np.concatenate([[0], np.cumsum(2 * n * width)])
        return Multigrid(width, begin, *np.zeros((7, int(begin[-1]))))


@kernel
def on_grid(values: Floats, grid: int, n: int, m: Multigrid) -> Floats:
    """The part of a flat array that belongs to a grid, shape (2, n, width)."""
    return values[m.begin[grid] : m.begin[grid + 1]].reshape((2, n, m.width[grid]))


@kernel
def set_up(
    low: int, high: int, n: int, first: Ints, top: Ints, a_x: Floats, a_z: Floats, diagonal: Floats,
    m: Multigrid,
) -> None:  # fmt: skip
    """Take over the couplings of the columns `low` to `high`, add them up on coarser grids, and eliminate.

    Parameters
    ----------
    first, top : the lowest cell of each column that has a pressure of its own, and the one past the last.
    a_x, a_z : couplings to the column west, by the station at its west end (`a_x[i - low]` of column i), and
        to the cell below.
    diagonal : sums of all couplings, those to p' = 0 too.
    """
    west, down, leak = on_grid(m.west, 0, n, m), on_grid(m.down, 0, n, m), on_grid(m.leak, 0, n, m)
    for at in range(high - low):
        i, s, c = low + at, at % 2, at // 2 + 1
        for k in range(n):
            west[s, k, c], down[s, k, c], leak[s, k, c] = 0.0, 0.0, 0.0
        for k in range(first[i], top[i]):
            east = 0.0
            if at > 0 and first[i - 1] <= k < top[i - 1]:
                west[s, k, c] = a_x[at, k]
            if i + 1 < high and first[i + 1] <= k < top[i + 1]:
                east = a_x[at + 1, k]
            if k > first[i]:
                down[s, k, c] = a_z[i, k]
            up = a_z[i, k + 1] if k + 1 < top[i] else 0.0
            leak[s, k, c] = diagonal[i, k] - west[s, k, c] - east - down[s, k, c] - up
    for grid in range(len(m.width)):
        if grid > 0:
            coarsen(grid, n, m)
        eliminate(grid, n, m)


@kernel
def coarsen(grid: int, n: int, m: Multigrid) -> None:
    """Couplings of a grid from those of the finer one: along z they add, across the border they halve."""
    west, down, leak = on_grid(m.west, grid, n, m), on_grid(m.down, grid, n, m), on_grid(m.leak, grid, n, m)
    fine = grid - 1
    w, d, free = on_grid(m.west, fine, n, m), on_grid(m.down, fine, n, m), on_grid(m.leak, fine, n, m)
    for c in range(1, m.width[fine] - 1):
        s, at = (c - 1) % 2, (c - 1) // 2 + 1
        for k in range(n):
            west[s, k, at] = 0.5 * w[0, k, c]
            down[s, k, at] = d[0, k, c] + d[1, k, c]
            leak[s, k, at] = free[0, k, c] + free[1, k, c]


@kernel
def eliminate(grid: int, n: int, m: Multigrid) -> None:
    """Factors of the columns of a grid."""
    west, down, leak = on_grid(m.west, grid, n, m), on_grid(m.down, grid, n, m), on_grid(m.leak, grid, n, m)
    pivot, factor = on_grid(m.pivot, grid, n, m), on_grid(m.factor, grid, n, m)
    for s in range(2):
        for k in range(n):
            for c in range(1, m.width[grid] - 1):
                east = west[1, k, c] if s == 0 else west[0, k, c + 1]
                up = down[s, k + 1, c] if k + 1 < n else 0.0
                d = leak[s, k, c] + west[s, k, c] + east + down[s, k, c] + up
                if d <= 0.0:
                    d = 1.0
                if k > 0:
                    factor[s, k, c] = down[s, k, c] * pivot[s, k - 1, c]
                    d -= factor[s, k, c] * down[s, k, c]
                pivot[s, k, c] = 1.0 / d


@kernel
def relax(
    s: int, n: int, west: Floats, down: Floats, pivot: Floats, factor: Floats, right: Floats, z: Floats
) -> None:
    """Solve the columns of one parity, with those of the other as they are."""
    wide = z.shape[2] - 1
    for k in range(n):
        if s == 0:
            for c in range(1, wide):
                z[0, k, c] = right[0, k, c] + west[0, k, c] * z[1, k, c - 1] + west[1, k, c] * z[1, k, c]
        else:
            for c in range(1, wide):
                z[1, k, c] = right[1, k, c] + west[1, k, c] * z[0, k, c] + west[0, k, c + 1] * z[0, k, c + 1]
    for k in range(1, n):
        for c in range(1, wide):
            z[s, k, c] += factor[s, k, c] * z[s, k - 1, c]
    for c in range(1, wide):
        z[s, n - 1, c] *= pivot[s, n - 1, c]
    for k in range(n - 2, -1, -1):
        for c in range(1, wide):
            z[s, k, c] = (z[s, k, c] + down[s, k + 1, c] * z[s, k + 1, c]) * pivot[s, k, c]


@kernel
def relax_on(grid: int, s: int, n: int, m: Multigrid) -> None:
    """`relax` on a grid."""
    relax(
        s, n, on_grid(m.west, grid, n, m), on_grid(m.down, grid, n, m), on_grid(m.pivot, grid, n, m),
        on_grid(m.factor, grid, n, m), on_grid(m.right, grid, n, m), on_grid(m.z, grid, n, m),
    )  # fmt: skip


@kernel
def cycle(n: int, m: Multigrid) -> None:
    """One V-cycle from `right` of the finest grid to `z` there."""
    last = len(m.width) - 1
    for grid in range(last + 1):
        z = on_grid(m.z, grid, n, m)
        z[:] = 0.0
        relax_on(grid, 0, n, m)
        relax_on(grid, 1, n, m)
        if grid == last:
            break
        west, coarse = on_grid(m.west, grid, n, m), on_grid(m.right, grid + 1, n, m)
        for c in range(1, m.width[grid] - 1):  # what is left over in the even columns; none in the odd ones
            s, at = (c - 1) % 2, (c - 1) // 2 + 1
            for k in range(n):
                coarse[s, k, at] = west[0, k, c] * z[1, k, c - 1] + west[1, k, c] * z[1, k, c]
    relax_on(last, 0, n, m)
    relax_on(last, 1, n, m)
    relax_on(last, 0, n, m)
    for grid in range(last - 1, -1, -1):
        z, coarse = on_grid(m.z, grid, n, m), on_grid(m.z, grid + 1, n, m)
        for c in range(1, m.width[grid] - 1):  # the odd columns are solved next
            for k in range(n):
                z[0, k, c] += coarse[(c - 1) % 2, k, (c - 1) // 2 + 1]
        relax_on(grid, 1, n, m)
        relax_on(grid, 0, n, m)


@kernel
def precondition(low: int, high: int, n: int, r: Floats, z: Floats, m: Multigrid) -> None:
    """One V-cycle for the columns `low` to `high`, from r to z, both of shape (n_segment, n)."""
    right, found = on_grid(m.right, 0, n, m), on_grid(m.z, 0, n, m)
    for at in range(high - low):
        for k in range(n):
            right[at % 2, k, at // 2 + 1] = r[low + at, k]
    cycle(n, m)
    for at in range(high - low):
        for k in range(n):
            z[low + at, k] = found[at % 2, k, at // 2 + 1]
