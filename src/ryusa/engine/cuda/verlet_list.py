"""Neighbour search on the device: cells by counting, then neighbours, then the memory of pairs in touch.

Order never depends on which thread comes first: grains stand by cell and by id within a cell, neighbours by
id. Cells repeat along every axis, so that a grain far away falls into some cell and is passed over by its
distance; so the grid needs no walls.
"""

import math
from typing import Any

from ryusa.engine.cuda.arrays import DeviceGrainArrays, DevicePairArrays, DeviceWallArrays
from ryusa.engine.cuda.device import cuda, device, on_device
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.dashpots import normal_kicks, set_springs
from ryusa.laws.geometry import wrap

CHUNK = 64  # numbers that one thread adds up in a row

# Columns of the grid, doubles: period in x and y, world, corner and width of cells, reach of the list.
G_PERIOD = 0
G_LOW = 2
G_HIGH = 5
G_CORNER = 8
G_WIDTH = 11
G_REACH = 14

_set_springs, _normal_kicks = on_device(set_springs), on_device(normal_kicks)


@device
def along(x: float, corner: float, width: float, dim: int) -> int:
    """Cell of a coordinate along one axis; what is no number falls into cell 0."""
    q = (x - corner) / width
    return int(math.floor(q)) % dim if math.fabs(q) < 1.0e15 else 0  # noqa: RUF046  (on a card a float)


@cuda.jit
def fill(values: Any, value: int) -> None:
    """Set every number to one value."""
    for k in range(cuda.grid(1), values.shape[0], cuda.gridsize(1)):
        values[k] = value


@cuda.jit
def wrap_grains(n: int, x: Any, image: Any, ids: Any, grid: Any, listed: Any, lost: Any) -> None:
    """Bring grains back into the period, count it, keep where they are, by id, and find the lost one."""
    for i in range(cuda.grid(1), n, cuda.gridsize(1)):
        inside = True
        for k in range(3):
            if k < 2 and grid[G_PERIOD + k] < math.inf:
                shift = math.floor(x[i, k] / grid[G_PERIOD + k])
                if shift != 0.0:
                    x[i, k] -= shift * grid[G_PERIOD + k]
                    image[i, k] += int(shift)
            inside = inside and x[i, k] >= grid[G_LOW + k] and x[i, k] <= grid[G_HIGH + k]
            listed[ids[i], k] = x[i, k]
        if not inside:
            cuda.atomic.min(lost, 0, ids[i])


@cuda.jit
def count_cells(places: Any, x: Any, grid: Any, dims: Any, cell: Any, count: Any) -> None:
    """Cell of every grain in `places`, and grains of every cell."""
    for s in range(cuda.grid(1), places.shape[0], cuda.gridsize(1)):
        i = places[s]
        a = along(x[i, 0], grid[G_CORNER], grid[G_WIDTH], dims[0])
        b = along(x[i, 1], grid[G_CORNER + 1], grid[G_WIDTH + 1], dims[1])
        c = along(x[i, 2], grid[G_CORNER + 2], grid[G_WIDTH + 2], dims[2])
        cell[s] = (a * dims[1] + b) * dims[2] + c
        cuda.atomic.add(count, cell[s], 1)


@cuda.jit
def fill_cells(places: Any, cell: Any, first: Any, impulse: Any, order: Any) -> None:
    """Put the grains of every cell into its slots, in whatever order the threads come."""
    for s in range(cuda.grid(1), places.shape[0], cuda.gridsize(1)):
        order[first[cell[s]] + cuda.atomic.add(impulse, cell[s], 1)] = places[s]


@cuda.jit
def sort_cells(n_cell: int, first: Any, ids: Any, order: Any) -> None:
    """Bring the grains of every cell into the order of their ids."""
    for c in range(cuda.grid(1), n_cell, cuda.gridsize(1)):
        for k in range(first[c] + 1, first[c + 1]):
            one = order[k]
            at = k
            while at > first[c] and ids[order[at - 1]] > ids[one]:
                order[at] = order[at - 1]
                at -= 1
            order[at] = one


@cuda.jit
def sum_chunks(n: int, values: Any, sums: Any) -> None:
    """Sum of every chunk of values[:n]."""
    for c in range(cuda.grid(1), sums.shape[0], cuda.gridsize(1)):
        total = 0
        for k in range(c * CHUNK, min((c + 1) * CHUNK, n)):
            total += values[k]
        sums[c] = total


@cuda.jit
def scan_chunks(n: int, values: Any, before: Any) -> None:
    """Turn values[:n] into what comes before each of them, given what comes before each chunk."""
    for c in range(cuda.grid(1), before.shape[0], cuda.gridsize(1)):
        total = before[c]
        for k in range(c * CHUNK, min((c + 1) * CHUNK, n)):
            value = values[k]
            values[k] = total
            total += value


@cuda.jit
def reorder(
    n: int, half: int, order: Any, masses: Any, old: DeviceGrainArrays, new: DeviceGrainArrays
) -> None:
    """Lay free grains out anew: place s gets what stood at place order[s].

    `masses` holds mass, inertia, bare mass and mass of the weight by id.
    """
    for s in range(cuda.grid(1), n, cuda.gridsize(1)):
        o = order[s]
        name = old.ids[o]
        for k in range(4):
            new.x[1 - half, s, k] = old.x[half, o, k]
            new.v[1 - half, s, k] = old.v[half, o, k]
            new.w[1 - half, s, k] = old.w[half, o, k]
        new.n_touching[1 - half, s] = old.n_touching[half, o]
        new.ids[s] = name
        new.m[s], new.inertia[s] = masses[name, 0], masses[name, 1]
        new.m_bare[s], new.m_weight[s] = masses[name, 2], masses[name, 3]
        for k in range(2):
            new.image[s, k] = old.image[o, k]
        if old.fluid.shape[0] == n:
            for k in range(old.fluid.shape[1]):
                new.fluid[s, k] = old.fluid[o, k]
            for k in range(old.impulse.shape[1]):
                new.impulse[s, k] = old.impulse[o, k]


@cuda.jit
def copy_radii(n: int, half: int, bodies: DeviceGrainArrays) -> None:
    """Give the half that a step will write the radii of the half that holds."""
    for i in range(cuda.grid(1), n, cuda.gridsize(1)):
        bodies.x[1 - half, i, 3] = bodies.x[half, i, 3]
        bodies.v[1 - half, i, 3] = bodies.v[half, i, 3]
        bodies.w[1 - half, i, 3] = bodies.w[half, i, 3]


@device
def within_reach(i: int, j: int, plane_case: int, x: Any, grid: Any) -> bool:
    """Whether two grains come within reach; in a plane scene another y is another lane, never met."""
    if plane_case and x[j, 1] != x[i, 1]:
        return False
    reach = x[i, 3] + x[j, 3] + grid[G_REACH]
    d_x = wrap(x[j, 0] - x[i, 0], grid[G_PERIOD])
    d_y = wrap(x[j, 1] - x[i, 1], grid[G_PERIOD + 1])
    d_z = x[j, 2] - x[i, 2]
    return d_x * d_x + d_y * d_y + d_z * d_z < reach * reach


@device
def insert(begin: int, end: int, j: int, n_solid: int, ids: Any, partners: Any) -> None:
    """Put a neighbour among those of one grain, in the order of ids; `end` is one beyond the last."""
    mine = ids[j] if j < n_solid else j
    at = end
    while at > begin:
        other = partners[at - 1]
        if (ids[other] if other < n_solid else other) < mine:
            break
        partners[at] = other
        at -= 1
    partners[at] = j


@cuda.jit
def find_neighbours(
    write: int, n: int, n_solid: int, plane_case: int, x: Any, ids: Any, walls: DeviceWallArrays, grid: Any,
    dims: Any, first: Any, first_fixed: Any, fixed: Any, start: Any, partners: Any,
) -> None:  # fmt: skip
    """Count the neighbours of every grain into `start`, or, once that is summed up, write them."""
    for i in range(cuda.grid(1), n, cuda.gridsize(1)):
        begin = start[i] if write else 0
        end = begin
        c_x = along(x[i, 0], grid[G_CORNER], grid[G_WIDTH], dims[0])
        c_y = along(x[i, 1], grid[G_CORNER + 1], grid[G_WIDTH + 1], dims[1])
        c_z = along(x[i, 2], grid[G_CORNER + 2], grid[G_WIDTH + 2], dims[2])
        # each of the cells around once, also where they are fewer than three
        n_x, n_y, n_z = min(dims[0], 3), min(dims[1], 3), min(dims[2], 3)
        for s in range(n_x * n_y * n_z):
            a = (c_x + s // (n_y * n_z) - n_x // 3 + dims[0]) % dims[0]
            b = (c_y + s // n_z % n_y - n_y // 3 + dims[1]) % dims[1]
            c = (c_z + s % n_z - n_z // 3 + dims[2]) % dims[2]
            cell = (a * dims[1] + b) * dims[2] + c
            for j in range(first[cell], first[cell + 1]):
                if j != i and within_reach(i, j, plane_case, x, grid):
                    if write:
                        insert(begin, end, j, n_solid, ids, partners)
                    end += 1
            for slot in range(first_fixed[cell], first_fixed[cell + 1]):
                j = fixed[slot]
                if within_reach(i, j, plane_case, x, grid):
                    if write:
                        insert(begin, end, j, n_solid, ids, partners)
                    end += 1
        for k in range(walls.normals.shape[0]):
            gap = 0.0
            for a in range(3):
                gap += (x[i, a] - walls.points[k, a]) * walls.normals[k, a]
            if walls.active[k] and gap < x[i, 3] + grid[G_REACH]:
                if write:
                    insert(begin, end, n_solid + k, n_solid, ids, partners)
                end += 1
        if not write:
            start[i] = end


@cuda.jit
def transfer_memory(
    n: int, n_solid: int, rotation: int, kind: int, half: int, c: Any, order: Any, bodies: DeviceGrainArrays,
    held: DevicePairArrays, pairs: DevicePairArrays, missing: Any,
) -> None:  # fmt: skip
    """Give every neighbour its dashpots, and the pairs in contact their memory, to both sides.

    `held` has them once, with the grain of the lower id, by the places before. `missing` gets the lowest id
    of such a grain whose partner in contact is not in the new list.
    """
    x = bodies.x[half]
    width, springs = pairs.rows.shape[1], pairs.eta.shape[1]
    for i in range(cuda.grid(1), n, cuda.gridsize(1)):
        found = 0
        for k in range(pairs.start[i], pairs.start[i + 1]):
            j = pairs.partners[k]
            own = j >= n or bodies.ids[j] > bodies.ids[i]
            a, b = (i, j) if own else (j, i)
            was_a, was_b = order[a], order[b] if b < n else b
            at, end = held.start[was_a], held.start[was_a + 1]
            while at < end and held.partners[at] != was_b:
                at += 1
            if at < end:
                pairs.touching[k] = held.touching[at]
                for e in range(springs):
                    pairs.eta[k, e] = held.eta[at, e]
                for e in range(width):
                    pairs.rows[k, e] = held.rows[at, e]
                found += 1 if own else 0
            else:
                pairs.touching[k] = 0
                for e in range(min(width, M.END_ROLLING)):
                    pairs.rows[k, e] = 0.0
                _set_springs(k, a, b, rotation, kind, c, bodies.m, x, bodies.inertia, pairs.eta)
        if found < held.start[order[i] + 1] - held.start[order[i]]:
            cuda.atomic.min(missing, 0, bodies.ids[i])


@cuda.jit
def set_springs_in_touch(
    n: int,
    rotation: int,
    kind: int,
    immersed: int,
    c: Any,
    bodies: DeviceGrainArrays,
    pairs: DevicePairArrays,
) -> None:
    """Give pairs in contact, by ids, the springs that a card computes: a resumed run has the same bits so.

    `immersed`: their normal dashpots were set when they touched, and stay.
    """
    for i in range(cuda.grid(1), n, cuda.gridsize(1)):
        for k in range(pairs.start[i], pairs.start[i + 1]):
            j, eta_n = pairs.partners[k], pairs.eta[k, M.ETA_N]
            _set_springs(
                k, min(i, j), max(i, j), rotation, kind, c, bodies.m, bodies.x[0], bodies.inertia, pairs.eta
            )
            if immersed:
                pairs.eta[k, M.ETA_N] = eta_n
                if kind == M.OF_KICKS:
                    _normal_kicks(k, c[P.K_N], pairs.eta[k, M.MASS], c[P.DT], pairs.eta)


@cuda.jit
def count_touching(n: int, ids: Any, pairs: DevicePairArrays, count: Any) -> None:
    """Pairs in contact of which each grain has the lower id."""
    for i in range(cuda.grid(1), n, cuda.gridsize(1)):
        total = 0
        for k in range(pairs.start[i], pairs.start[i + 1]):
            j = pairs.partners[k]
            if pairs.touching[k] != 0 and (j >= n or ids[j] > ids[i]):
                total += 1
        count[i] = total


@cuda.jit
def hold_touching(n: int, ids: Any, pairs: DevicePairArrays, held: DevicePairArrays) -> None:
    """Copy the pairs in contact to `held`, whose `start` is known, from the side with the lower id."""
    for i in range(cuda.grid(1), n, cuda.gridsize(1)):
        at = held.start[i]
        for k in range(pairs.start[i], pairs.start[i + 1]):
            j = pairs.partners[k]
            if pairs.touching[k] != 0 and (j >= n or ids[j] > ids[i]):
                held.partners[at], held.touching[at] = j, pairs.touching[k]
                for e in range(pairs.eta.shape[1]):
                    held.eta[at, e] = pairs.eta[k, e]
                for e in range(pairs.rows.shape[1]):
                    held.rows[at, e] = pairs.rows[k, e]
                at += 1


@cuda.jit
def collect_touching(
    n: int, ids: Any, pairs: DevicePairArrays, start: Any, i_ids: Any, j_ids: Any, states: Any, eta: Any,
    rows: Any,
) -> None:  # fmt: skip
    """Copy ids, states and memory of the pairs in touch."""
    for i in range(cuda.grid(1), n, cuda.gridsize(1)):
        at = start[i]
        for k in range(pairs.start[i], pairs.start[i + 1]):
            j = pairs.partners[k]
            if pairs.touching[k] != 0 and (j >= n or ids[j] > ids[i]):
                i_ids[at] = ids[i]
                j_ids[at] = ids[j] if j < n else j
                states[at] = pairs.touching[k]
                for e in range(pairs.eta.shape[1]):
                    eta[at, e] = pairs.eta[k, e]
                for e in range(pairs.rows.shape[1]):
                    rows[at, e] = pairs.rows[k, e]
                at += 1
