"""Cell grids and, from them, a Verlet list of pairs.

Grains much larger than most have grids of their own, one for each class of sizes: else one boulder would make
the cells of all grains as wide as itself. Grains are sorted by cell, and by id within a cell, so that order
and list follow from positions alone: a resumed run builds the same list as the run it continues.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from ryusa.engine.cpu.faces import append_faces
from ryusa.engine.shared.array_memory import zeros
from ryusa.engine.shared.kernel import inner, kernel
from ryusa.laws.geometry import wrap
from ryusa.model.scene import Floats

Grid = tuple[np.ndarray, np.ndarray, np.ndarray]
ROUND = 1e-9  # of a cell
APART = 3.0  # usual diameters: larger grains have grids of their own


class Levels(NamedTuple):
    """Grids of grains of several classes of sizes, one after the other."""

    low: Any  # lowest corner of each grid [m], (n_level, 3)
    width: Any  # of its cells [m], (n_level, 3)
    dims: Any  # (n_level, 3)
    cells: Any  # place of its first cell in `first`, (n_level + 1,)
    grains: Any  # place of its first grain in `order`, (n_level + 1,)
    first: Any  # first slot of each cell within its grid, and one more, int32
    order: Any  # grains by cell, and by id within a cell, int32
    r_most: Any  # largest radius [m], (n_level,)


def grid_of(low: Floats, high: Floats, n: int, size: float, period: Floats) -> Grid:
    """A grid for n grains between `low` and `high` [m]; cells are at least `size` wide, at most about 4 n.

    Returns low (3), width (3), dims (3), as float64, float64 and int64 arrays.
    """
    round_about = period < math.inf
    low, high = low.copy(), high.copy()
    low[:2][round_about], high[:2][round_about] = 0.0, period[round_about]
    more = np.array([*np.where(round_about, 0.0, 1.0), 1.0])  # a period is filled, a length has a rest
    cell = size
    while np.prod(np.maximum(np.floor((high - low) / cell) + more, 1.0)) > 4.0 * n + 64.0:
        cell *= 1.26
    dims = np.maximum(np.floor((high - low) / cell) + more, 1.0)
    width = np.full(3, cell)
    width[:2][round_about] = period[round_about] / dims[:2][round_about]
    return low, width, dims.astype(np.int64)


def bounds_of(x: Floats) -> tuple[Floats, Floats]:
    """Lowest and highest coordinates [m]; zeros without grains."""
    return (x.min(axis=0), x.max(axis=0)) if len(x) else (np.zeros(3), np.zeros(3))


def sort_by_cell(x: Floats, n: int, ids: np.ndarray, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Sort x[:n] by cell, and by id within a cell.

    Returns the first slot of each cell (n_cell + 1), and the numbers in that order.
    """
    first = zeros(np.int32, int(np.prod(grid[2])) + 1)
    where, order = zeros(np.int32, n), zeros(np.int32, n)
    _sort(x, n, ids, *grid, first, where, order)
    return first, order


@inner(forceinline=True)
def _cell(x: float, low: float, width: float) -> int:
    # far from the grid a plain int() would overflow; one cell outside is as good as a thousand
    return int(min(max(math.floor((x - low) / width), -2.0), 1.0e9))


@kernel()
def _sort(
    x: Any, n: int, ids: Any, low: Any, width: Any, dims: Any, first: Any, where: Any, order: Any
) -> None:
    # a counting sort, then one by insertion in each cell, of a few grains; `where` is room for it
    last = len(first) - 1
    for i in range(n):
        a = min(max(_cell(x[i, 0], low[0], width[0]), 0), dims[0] - 1)
        b = min(max(_cell(x[i, 1], low[1], width[1]), 0), dims[1] - 1)
        c = min(max(_cell(x[i, 2], low[2], width[2]), 0), dims[2] - 1)
        where[i] = (a * dims[1] + b) * dims[2] + c
        first[where[i] + 1] += 1
    for c in range(last):
        first[c + 1] += first[c]
    for i in range(n):  # the first slot of a cell moves on to that of the next
        order[first[where[i]]] = i
        first[where[i]] += 1
    for c in range(last, 0, -1):
        first[c] = first[c - 1]
    first[0] = 0
    for c in range(last):
        for slot in range(first[c] + 1, first[c + 1]):
            i, free = order[slot], slot
            while free > first[c] and ids[order[free - 1]] > ids[i]:
                order[free] = order[free - 1]
                free -= 1
            order[free] = i


def levels_of(d: Floats, usual: float) -> np.ndarray:
    """Level of each grain by its diameter, shape (n,): 0 up to `APART` usual ones, then by factors of 2.

    >>> levels_of(np.array([1.0, 3.0, 5.0, 9.0, 33.0]), 1.0).tolist()
    [0, 0, 1, 2, 4]
    """
    ratio = np.maximum(np.asarray(d) / (APART * usual), 0.5)
    return np.ceil(np.log2(ratio) - 1e-9).clip(0).astype(np.int64)


def one_grid(grid: Grid, first: np.ndarray, order: np.ndarray, r_most: float) -> Levels:
    """Levels of grains of one class."""
    low, width, dims = (one[None] for one in grid)
    return Levels(
        low,
        width,
        dims,
        np.array([0, len(first)]),
        np.array([0, len(order)]),
        first,
        order,
        np.array([r_most]),
    )


def grids_by_size(
    x: Floats, d: Floats, ids: np.ndarray, reach: float, period: Floats, low: Floats, high: Floats,
    largest: float,
) -> Levels:  # fmt: skip
    """Grids of grains between `low` and `high` [m], one for each class of sizes that occurs.

    Parameters
    ----------
    x, d, ids : centres and diameters of the grains [m], and what they are sorted by within a cell.
    reach : of the list beyond touch [m].
    largest : diameter for which the cells are made where there is one class only [m].
    """
    n = len(d)
    level = levels_of(d, float(np.median(d))) if n else np.zeros(0, np.int64)
    kinds = [int(one) for one in np.unique(level)] or [0]
    grids, firsts, orders, most = list[Grid](), list[np.ndarray](), list[np.ndarray](), list[float]()
    for kind in kinds:
        some = (np.flatnonzero(level == kind) if len(kinds) > 1 else np.arange(n)).astype(np.int32)
        if len(kinds) > 1:
            largest = float(d[some].max())
        grid = grid_of(low, high, len(some), largest + reach, period)
        first, order = sort_by_cell(np.ascontiguousarray(x[some]), len(some), ids[some], grid)
        grids.append(grid)
        firsts.append(first)
        orders.append(some[order])
        most.append(0.5 * largest)
    return Levels(
        np.array([one[0] for one in grids]),
        np.array([one[1] for one in grids]),
        np.array([one[2] for one in grids]),
        np.concatenate([[0], np.cumsum([len(one) for one in firsts])]),
        np.concatenate([[0], np.cumsum([len(one) for one in orders])]),
        np.concatenate(firsts),
        np.concatenate(orders),
        np.array(most),
    )


@inner(forceinline=True)
def _append_partners(
    i: int, offset: int, level: int, levels: Any, x: Any, ids: Any, period: Any, skin: float,
    plane_case: bool, body: Any, partners: Any, used: int,
) -> int:  # fmt: skip
    """Append to `partners` all grains of one level with a higher id than grain i and within its reach.

    Parameters
    ----------
    offset : added to the numbers in the grid to get places (free grains 0, fixed grains n).
    levels : grids of `grids_by_size`.
    plane_case : grains at another y are in another lane and never met.
    body : number of the rigid body of each grain, by id, another for each grain of its own; two of one body
        never meet. None where there are none.
    partners : uint32 array to fill from `used`.

    Returns
    -------
    The new count, or -1 where `partners` is too short.
    """
    low, width, dims = levels.low[level], levels.width[level], levels.dims[level]
    first, order = levels.first[levels.cells[level] :], levels.order[levels.grains[level] :]
    x_i, y_i, z_i, r_i, id_i = x[i, 0], x[i, 1], x[i, 2], x[i, 3] + skin, ids[i]
    l_x, l_y, n_x, n_y, n_z = period[0], period[1], dims[0], dims[1], dims[2]
    c_x, c_y, c_z = _cell(x_i, low[0], width[0]), _cell(y_i, low[1], width[1]), _cell(z_i, low[2], width[2])
    far = r_i + levels.r_most[level]  # a grain larger than those of the level looks over more than one cell
    most_x = max(math.ceil(far / width[0] - ROUND), 1)
    most_y = max(math.ceil(far / width[1] - ROUND), 1)
    most_z = max(math.ceil(far / width[2] - ROUND), 1)
    bottom, top = max(c_z - most_z, 0), min(c_z + most_z, n_z - 1)
    if top < bottom:
        return used
    begin_x, count_x = _cells_round(c_x, most_x, n_x, l_x < math.inf)
    begin_y, count_y = _cells_round(c_y, most_y, n_y, l_y < math.inf)
    for k in range(count_x * count_y):
        a, b = begin_x + k // count_y, begin_y + k % count_y
        if l_x < math.inf:
            a = (a + n_x) % n_x
        if l_y < math.inf:
            b = (b + n_y) % n_y
        column = (a * n_y + b) * n_z
        begin, end = first[column + bottom], first[column + top + 1]  # cells of a column lie side by side
        if used + end - begin >= len(partners):
            return -1
        for slot in range(begin, end):  # no branch: which pairs are near is not predictable
            j = order[slot] + offset
            d_x, d_y, d_z = wrap(x[j, 0] - x_i, l_x), wrap(x[j, 1] - y_i, l_y), x[j, 2] - z_i
            reach = r_i + x[j, 3]
            met = (d_x * d_x + d_y * d_y + d_z * d_z < reach * reach) & (ids[j] > id_i)
            if body is not None:
                met = met & (body[ids[j]] != body[id_i])
            partners[used] = j
            used += int(met & ((not plane_case) | (x[j, 1] == y_i)))
    return used


@inner(forceinline=True)
def _cells_round(c: int, most: int, n: int, periodic: bool) -> tuple[int, int]:
    """First cell along one axis that is at most `most` from cell c, below 0 in a period, and how many."""
    if periodic:
        return (c - most, 2 * most + 1) if 2 * most + 1 <= n else (c - (n - 1) // 2, n)
    first, last = max(c - most, 0), min(c + most, n - 1)
    return first, max(last - first + 1, 0)


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
    free_grids: Any,
    fixed_grids: Any,
    period: Any,
    skin: float,
    plane_case: bool,
    walled: int | None,
    body: Any,
    start: Any,
    partners: Any,
) -> int:
    """Fill the Verlet list of grains lo..hi-1, each pair under its lower id, and return the pairs found.

    Partners of grain i begin at partners[start[i]]. Free ones come first, then fixed grains, then planes,
    then faces, each in a fixed order. Returns -1 where `partners` is too short.
    """
    normals, points = walls.normals, walls.points
    used, bed = 0, len(fixed_grids.order) > 0
    for i in range(lo, hi):
        start[i] = used
        for level in range(len(free_grids.r_most)):
            used = _append_partners(
                i, 0, level, free_grids, x, ids, period, skin, plane_case, body, partners, used
            )
            if used < 0:
                return -1
        if bed:
            for level in range(len(fixed_grids.r_most)):
                used = _append_partners(
                    i, n, level, fixed_grids, x, ids, period, skin, plane_case, body, partners, used
                )
                if used < 0:
                    return -1
        if used + len(normals) > len(partners):
            return -1
        for k in range(len(normals)):
            gap = 0.0
            for a in range(3):
                gap += (x[i, a] - points[k, a]) * normals[k, a]
            if active_planes[k] and gap < x[i, 3] + skin:
                partners[used] = n_solid + k
                used += 1
        if walled is not None:
            used = append_faces(
                x[i, 0], x[i, 1], x[i, 2], x[i, 3] + skin, period[0], period[1], walls.faces, partners, used
            )
            if used < 0:
                return -1
    return used
