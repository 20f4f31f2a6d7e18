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


@kernel()
def _neighbours(c: int, n: int, periodic: bool, out: Any) -> int:
    # indices along one axis of the cells next to cell c, each once
    count = 0
    for step in range(-1, 2):
        a = c + step
        if periodic:
            if (n == 1 and step != 0) or (n == 2 and step < 0):
                continue
            out[count] = (a + n) % n
            count += 1
        elif 0 <= a < n:
            out[count] = a
            count += 1
    return count


@kernel()
def list_pairs(
    x: Any,
    ids: Any,
    offset: int,
    grid: Any,
    period: Any,
    skin: float,
    lanes: bool,
    i: int,
    half: bool,
    partners: Any,
    used: int,
) -> int:
    """Append to `partners` all grains of one grid within reach of grain i; returns the new count.

    Parameters
    ----------
    offset : added to the numbers in the grid to get the index into x (free grains 0, fixed grains n).
    grid : low, width, dims, first and order of `grid_of` and `sort_into`.
    lanes : a plane scene, where grains at another y are in another lane and never met.
    half : only partners with a higher id (each free pair once); grain i itself never.
    partners : uint32 array to fill from `used`; where it is too short counting goes on without writing.
    """
    low, width, dims, first, order = grid
    near = np.empty((3, 3), np.int64)
    count = np.empty(3, np.int64)
    for k in range(3):
        count[k] = _neighbours(
            _cell(x[i, k], low[k], width[k]), dims[k], k < 2 and period[k] < math.inf, near[k]
        )
    for a in range(count[0]):
        for b in range(count[1]):
            for c in range(count[2]):
                cell = (near[0, a] * dims[1] + near[1, b]) * dims[2] + near[2, c]
                for slot in range(first[cell], first[cell + 1]):
                    j = order[slot] + offset
                    if half and ids[j] <= ids[i]:
                        continue
                    if lanes and x[j, 1] != x[i, 1]:
                        continue
                    reach = x[i, 3] + x[j, 3] + skin
                    d_x = wrap(x[j, 0] - x[i, 0], period[0])
                    d_y = wrap(x[j, 1] - x[i, 1], period[1])
                    d_z = x[j, 2] - x[i, 2]
                    if d_x * d_x + d_y * d_y + d_z * d_z < reach * reach:
                        if used < len(partners):
                            partners[used] = j
                        used += 1
    return used


@kernel()
def build_list(
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
    """Fill the Verlet list: partners of grain i are partners[start[i]:start[i + 1]]; returns the pairs found.

    Free partners come first, then fixed grains, then planes, each in a fixed order. When the result is
    larger than len(partners) the list is not usable: make room and call again.
    """
    used = 0
    normals, points = walls.normals, walls.points
    for i in range(n):
        start[i] = used
        used = list_pairs(x, ids, 0, free_grid, period, skin, lanes, i, True, partners, used)
        if len(fixed_grid[4]) > 0:
            used = list_pairs(x, ids, n, fixed_grid, period, skin, lanes, i, False, partners, used)
        for k in range(len(normals)):
            gap = 0.0
            for a in range(3):
                gap += (x[i, a] - points[k, a]) * normals[k, a]
            if active_planes[k] and gap < x[i, 3] + skin:
                if used < len(partners):
                    partners[used] = n_solid + k
                used += 1
    start[n] = used
    return used
