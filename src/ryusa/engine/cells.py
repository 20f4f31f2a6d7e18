"""Who is near whom: a cell grid and, from it, a Verlet list of pairs.

Grains are sorted by cell, and by id within a cell, so that order and list follow from positions alone: a
resumed run builds the same list as the run it continues.
"""

import math
from typing import Any

import numpy as np

from ryusa.engine._kernel import kernel
from ryusa.laws.geometry import wrap


@kernel()
def grid_of(x: Any, n: int, size: float, period: Any) -> Any:
    """Bounds of a grid over x[:n]; cells are at least `size` wide and no more than about four a grain.

    Returns low (3), width (3), dims (3), as float64, float64 and int64 arrays.
    """
    low = np.zeros(3)
    width = np.full(3, size)
    dims = np.ones(3, np.int64)
    if n == 0:
        return low, width, dims
    high = np.zeros(3)
    for k in range(3):
        if k < 2 and period[k] < math.inf:
            low[k], high[k] = 0.0, period[k]
        else:
            low[k] = high[k] = x[0, k]
            for i in range(1, n):
                low[k] = min(low[k], x[i, k])
                high[k] = max(high[k], x[i, k])
    cell = size
    while True:
        total = 1.0
        for k in range(3):
            total *= max(
                1.0, math.floor((high[k] - low[k]) / cell) + (0.0 if k < 2 and period[k] < math.inf else 1.0)
            )
        if total <= 4.0 * n + 64.0:
            break
        cell *= 1.26
    for k in range(3):
        if k < 2 and period[k] < math.inf:
            dims[k] = max(1, math.floor(period[k] / cell))
            width[k] = period[k] / dims[k]
        else:
            dims[k] = math.floor((high[k] - low[k]) / cell) + 1
            width[k] = cell
    return low, width, dims


@kernel()
def _cell(x: float, low: float, width: float) -> int:
    # far from the grid a plain int() would overflow; one cell outside is as good as a thousand
    return int(min(max(math.floor((x - low) / width), -2.0), 1.0e9))


@kernel()
def sort_into(x: Any, n: int, low: Any, width: Any, dims: Any, order: Any) -> Any:
    """Counting sort of x[:n] by cell; fills `order` and returns the first slot of each cell (n_cell + 1)."""
    n_cell = dims[0] * dims[1] * dims[2]
    first = np.zeros(n_cell + 1, np.int64)
    where = np.empty(n, np.int64)
    for i in range(n):
        a = min(max(_cell(x[i, 0], low[0], width[0]), 0), dims[0] - 1)
        b = min(max(_cell(x[i, 1], low[1], width[1]), 0), dims[1] - 1)
        c = min(max(_cell(x[i, 2], low[2], width[2]), 0), dims[2] - 1)
        where[i] = (a * dims[1] + b) * dims[2] + c
        first[where[i] + 1] += 1
    for c in range(n_cell):
        first[c + 1] += first[c]
    fill = first[:-1].copy()
    for i in range(n):
        order[fill[where[i]]] = i
        fill[where[i]] += 1
    return first


@kernel(forceinline=True)
def _beside(c: int, step: int, n: int, periodic: bool) -> int:
    # index along one axis of a cell one step from cell c, or -1; in few periodic cells each comes once
    a = c + step
    if periodic:
        return -1 if (n == 1 and step != 0) or (n == 2 and step < 0) else (a + n) % n
    return a if 0 <= a < n else -1


@kernel(forceinline=True)
def _list_near(
    i: int, offset: int, low: Any, width: Any, dims: Any, first: Any, order: Any, x: Any, ids: Any,
    period: Any, skin: float, lanes: bool, partners: Any, used: int,
) -> int:  # fmt: skip
    """Append to `partners` all grains of one grid with a higher id than grain i and within its reach.

    Parameters
    ----------
    offset : added to the numbers in the grid to get places (free grains 0, fixed grains n).
    low, width, dims, first, order : the grid, of `grid_of` and `sort_into`.
    lanes : a plane scene, where grains at another y are in another lane and never met.
    partners : uint32 array to fill from `used`.

    Returns
    -------
    The new count, or -1 where `partners` is too short.
    """
    x_i, y_i, z_i, r_i, id_i = x[i, 0], x[i, 1], x[i, 2], x[i, 3] + skin, ids[i]
    l_x, l_y, n_x, n_y, n_z = period[0], period[1], dims[0], dims[1], dims[2]
    c_x, c_y, c_z = _cell(x_i, low[0], width[0]), _cell(y_i, low[1], width[1]), _cell(z_i, low[2], width[2])
    bottom, top = max(c_z - 1, 0), min(c_z + 1, n_z - 1)
    if top < bottom:
        return used
    for k in range(9):
        a = _beside(c_x, k // 3 - 1, n_x, l_x < math.inf)
        b = _beside(c_y, k % 3 - 1, n_y, l_y < math.inf)
        if a < 0 or b < 0:
            continue
        column = (a * n_y + b) * n_z
        begin, end = first[column + bottom], first[column + top + 1]  # cells of a column lie side by side
        if used + end - begin >= len(partners):
            return -1
        for slot in range(begin, end):  # no branch: who is near cannot be foretold
            j = order[slot] + offset
            d_x, d_y, d_z = wrap(x[j, 0] - x_i, l_x), wrap(x[j, 1] - y_i, l_y), x[j, 2] - z_i
            reach = r_i + x[j, 3]
            met = (d_x * d_x + d_y * d_y + d_z * d_z < reach * reach) & (ids[j] > id_i)
            partners[used] = j
            used += int(met & ((not lanes) | (x[j, 1] == y_i)))
    return used


@kernel(nogil=True)
def build_list(
    lo: int,
    hi: int,
    x: Any,
    ids: Any,
    n: int,
    n_solid: int,
    walls: Any,
    active_planes: Any,
    free_grid: Any,
    fixed_grid: Any,
    period: Any,
    skin: float,
    lanes: bool,
    start: Any,
    partners: Any,
) -> int:
    """Fill the Verlet list of grains lo..hi-1, each pair under its lower id, and return the pairs found.

    Partners of grain i begin at partners[start[i]]. Free ones come first, then fixed grains, then planes,
    each in a fixed order. Returns -1 where `partners` is too short.
    """
    low, width, dims, first, order = free_grid
    low_b, width_b, dims_b, first_b, order_b = fixed_grid
    normals, points = walls.normals, walls.points
    used, bed = 0, len(order_b) > 0
    for i in range(lo, hi):
        start[i] = used
        used = _list_near(i, 0, low, width, dims, first, order, x, ids, period, skin, lanes, partners, used)
        if bed and used >= 0:
            used = _list_near(
                i, n, low_b, width_b, dims_b, first_b, order_b, x, ids, period, skin, lanes, partners, used
            )
        if used < 0 or used + len(normals) > len(partners):
            return -1
        for k in range(len(normals)):
            gap = 0.0
            for a in range(3):
                gap += (x[i, a] - points[k, a]) * normals[k, a]
            if active_planes[k] and gap < x[i, 3] + skin:
                partners[used] = n_solid + k
                used += 1
    return used
