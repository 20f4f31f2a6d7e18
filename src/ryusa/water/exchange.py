"""Slices of grains in a column of cells, and the exchange of volume, momentum and speed between the two.

Grain i has the volume V_ik of its sphere, cut by two horizontal planes, in cell k. The same V_ik are the
weights in both directions, so that what the grains give equals what the cells receive, to round-off:

- concentration, phi_k = sum over grains of V_ik / (A dz);
- grains to cells, Q_k = sum over grains of Q_i V_ik / V_i;
- cells to grains, q_i = sum over cells of q_k V_ik / V_i; so the sum of Q_i q_i over grains is that of
  Q_k q_k over cells.

Sums over cells run upwards and sums over grains in the order of their ids, both in one thread: the bits
depend neither on the number of threads nor, if `ids` is given, on the order of the grains in memory.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ryusa.laws.slices import sphere_slice
from ryusa.model.scene import Floats, Scene
from ryusa.water._kernel import kernel

Ints = NDArray[np.int64]
Share = Literal["whole", "submerged"]
FOUR = 4  # quantities of cells that are averaged at once
DRY = 1.0e-15  # submerged of the volume of a grain; a smaller submerged part counts as dry (round-off)


@dataclass(frozen=True)
class Cells:
    """Cells of equal height over an area of bed; cell k lies between the faces k and k + 1.

    Attributes
    ----------
    z_low : height of the lowest face [m].
    dz : height of a cell [m].
    n : number of cells.
    area : of the bed, summed over all lanes of a plane scene [m2].
    """

    z_low: float
    dz: float
    n: int
    area: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.z_low) and 0.0 < self.dz < math.inf and 0.0 < self.area < math.inf):
            raise ValueError(f"{self}: z_low finite, dz and area positive and finite")
        if self.n < 1:
            raise ValueError(f"{self}: at least one cell")

    @property
    def volume(self) -> float:
        """Of one cell [m3]."""
        return self.area * self.dz


def with_those_away(
    scene: Scene, z_low: float, x: Floats, v: Floats, x_rest: float = 0.0
) -> tuple[Floats, Floats]:
    """Centres and velocities, with grains that are away (nan) at rest below z_low [m], in no cell of it."""
    if scene.traffic is None or not (away := np.isnan(x[:, 2])).any():
        return x, v
    x, v = np.where(away[:, None], 0.0, x), np.where(away[:, None], 0.0, v)
    x[away, 0] = x_rest
    x[away, 2] = z_low - 2.0 * scene.d[away]
    return x, v


@dataclass(frozen=True)
class Slices:
    """Volumes of grains in cells; one row per grain, in the order given.

    Attributes
    ----------
    cells : the cells that cut the grains.
    first : lowest cell a grain reaches into, shape (n_grain,).
    count : number of cells it reaches into, shape (n_grain,); 0 where it lies outside all cells.
    volume : V_ik of cell first + s in column s [m3], shape (n_grain, width); the largest grain sets the
        width, and values beyond `count` are undefined.
    whole : volume V_i of the grain [m3], shape (n_grain,).
    submerged : part of it that lies in cells, the sum of its slices [m3], shape (n_grain,).
    below, above : parts that lie below the lowest and above the highest face [m3], shape (n_grain,); with
        `submerged` they add up to `whole`, to round-off.
    order : rows in the order of the grains' ids, in which sums over grains run, shape (n_grain,).
    """

    cells: Cells
    first: Ints
    count: Ints
    volume: Floats
    whole: Floats
    submerged: Floats
    below: Floats
    above: Floats
    order: Ints

    @property
    def n_grain(self) -> int:
        """Number of grains."""
        return len(self.first)

    @cached_property
    def share(self) -> Floats:
        """Part of each grain that lies in cells, submerged over whole volume [-], shape (n_grain,)."""
        return self.submerged / self.whole

    def factors(self, share: Share) -> tuple[Floats, Floats]:
        """Factors that turn volumes of a grain into weights, in cells and outside [1/m3]."""
        return self._of_whole if share == "whole" else self._of_submerged

    @cached_property
    def _of_whole(self) -> tuple[Floats, Floats]:
        per = 1.0 / self.whole
        return per, per

    @cached_property
    def _of_submerged(self) -> tuple[Floats, Floats]:
        return factors_in_water(self.whole, self.submerged)


def slices(
    z: Floats, d: Floats, cells: Cells, ids: Ints | None = None, reuse: Slices | None = None
) -> Slices:
    """Cut grains by the faces of cells.

    Parameters
    ----------
    z : heights of the centres [m], shape (n_grain,).
    d : diameters [m], > 0, shape (n_grain,).
    cells : the cells.
    ids : id of each row, a permutation of 0 .. n_grain - 1; by default the rows are in the order of ids.
    reuse : slices of the same number of grains that are no longer needed: their memory is reused.

    Raises
    ------
    ValueError : shapes that differ, ids that are no permutation, a height or diameter out of range.

    Notes
    -----
    Both cells at a face use the same height of it, so that the slices of a grain add up exactly.

    >>> half = slices(np.array([0.0]), np.array([2.0]), Cells(z_low=0.0, dz=0.5, n=4, area=1.0))
    >>> half.volume[0, :2] / math.pi  # 0.5 - 0.5**3/3, and the cap above it
    array([0.45833333, 0.20833333])
    >>> round(float(half.share[0]), 12)
    0.5
    """
    z, d = np.ascontiguousarray(z, dtype=np.float64), np.ascontiguousarray(d, dtype=np.float64)
    if z.ndim != 1 or z.shape != d.shape:
        raise ValueError(
            f"heights of shape {z.shape}, diameters of shape {d.shape}: one height and one diameter per grain"
        )
    bad = np.flatnonzero(~(np.isfinite(z) & (d > 0.0) & np.isfinite(d)))
    if len(bad):
        raise ValueError(f"grain in row {bad[0]}: z = {z[bad[0]]:g} m, d = {d[bad[0]]:g} m")
    n = len(z)
    width = int(min(float(d.max(initial=0.0)) / cells.dz + 2.0, float(cells.n)))
    if reuse is not None and reuse.volume.shape == (n, width):
        first, count, volume, parts = reuse.first, reuse.count, reuse.volume, reuse
        whole, submerged, below, above = parts.whole, parts.submerged, parts.below, parts.above
    else:
        first, count, volume = np.empty(n, np.int64), np.empty(n, np.int64), np.empty((n, width))
        whole, submerged, below, above = (np.empty(n) for _ in range(4))
    cut_grains(
        z, 0.5 * d, cells.z_low, cells.dz, cells.n, first, count, volume, whole, submerged, below, above
    )
    return Slices(cells, first, count, volume, whole, submerged, below, above, _order(ids, n))


def concentration(grains: Slices, bed: Slices | None = None) -> Floats:
    """Concentration phi in each cell [-], shape (n,): volume of slices over volume of the cell.

    Parameters
    ----------
    grains : slices of the free grains.
    bed : slices of the fixed grains in the same cells; None leaves them out.
    """
    phi = weighted_concentration(grains, np.ones(grains.n_grain))
    if bed is None:
        return phi
    if bed.cells != grains.cells:
        raise ValueError(f"bed in {bed.cells}, free grains in {grains.cells}: must be the same cells")
    return phi + weighted_concentration(bed, np.ones(bed.n_grain))


def weighted_concentration(grains: Slices, values: Floats) -> Floats:
    """Concentration times the mean of a quantity in each cell, sum of V_ik q_i / (A dz).

    Parameters
    ----------
    grains : slices.
    values : of each grain, any unit, shape (n_grain,) or (n_grain, m).

    Returns
    -------
    phi <q> in that unit, shape (n,) or (n, m): flux of grains where q is their velocity.
    """
    table, flat = _table(values, grains.n_grain, "grain")
    sums, _ = _give(grains, table, np.ones(grains.n_grain), np.zeros(grains.n_grain))
    sums /= grains.cells.volume
    return sums[0] if flat else np.ascontiguousarray(sums.T)


def to_grains(grains: Slices, values: Floats, share: Share = "whole") -> Floats:
    """Mean of cell values over each grain.

    Parameters
    ----------
    grains : slices.
    values : of each cell (a speed [m/s], a force per volume [N/m3]), shape (n,) or (n, m).
    share : "whole", sum of V_ik q_k / V_i, with q = 0 outside the cells; "submerged", the mean over the part
        of the grain that lies in cells, and 0 where none does.

    Returns
    -------
    In the unit of `values`, shape (n_grain,) or (n_grain, m).
    """
    table, flat = _table(values, grains.cells.n, "cell")
    fours = _fours(table)
    out = np.empty((grains.n_grain, fours.shape[1]))
    mean_over_grains(grains.first, grains.count, grains.volume, grains.factors(share)[0], fours, out)
    return out[:, 0] if flat else out[:, : table.shape[1]]


def _give(grains: Slices, table: Floats, per: Floats, outer: Floats) -> tuple[Floats, Floats]:
    """Sums in cells (m, n) and outside (m, 2)."""
    sums, outside = np.zeros((table.shape[1], grains.cells.n)), np.zeros((table.shape[1], 2))
    add_to_cells(
        grains.order, grains.first, grains.count, grains.volume, grains.below, grains.above, per, outer,
        table, sums, outside,
    )  # fmt: skip
    return sums, outside


def _fours(table: Floats) -> Floats:
    """The table with columns of zeros up to a multiple of four: means of four are taken at once."""
    m = table.shape[1]
    if m % FOUR == 0:
        return table
    fours = np.zeros((len(table), -(-m // FOUR) * FOUR))
    fours[:, :m] = table
    return fours


def _order(ids: Ints | None, n: int) -> Ints:
    """Rows in the order of ids."""
    rows = np.arange(n)
    if ids is None:
        return rows
    order = np.full(n, -1, dtype=np.int64)
    if len(ids) == n and (n == 0 or (int(np.min(ids)) >= 0 and int(np.max(ids)) < n)):
        order[ids] = rows
    if len(ids) != n or np.any(order < 0):
        raise ValueError(f"ids: a permutation of 0 .. {n - 1}")
    return order


def _table(values: Floats, n: int, what: str) -> tuple[Floats, bool]:
    """Values as (n, m), and whether they were given as one column."""
    table = np.ascontiguousarray(values, dtype=np.float64)
    if table.ndim not in (1, 2) or len(table) != n:
        raise ValueError(f"values of shape {table.shape}: one row per {what}, {n} in all")
    return (table[:, None], True) if table.ndim == 1 else (table, False)


@kernel
def cut_grains(
    z: Floats, r: Floats, z_low: float, dz: float, n: int,
    first: Ints, count: Ints, volume: Floats, whole: Floats, submerged: Floats, below: Floats, above: Floats,
) -> None:  # fmt: skip
    """Write slices of every grain."""
    top = float(n)
    for i in range(z.shape[0]):
        low = math.floor(min(max((z[i] - r[i] - z_low) / dz, 0.0), top))
        high = math.ceil(min(max((z[i] + r[i] - z_low) / dz, 0.0), top))
        high = max(min(high, low + volume.shape[1]), low)
        first[i], count[i] = low, high - low
        total = 0.0
        b = z_low + low * dz - z[i]
        for s in range(high - low):
            a, b = b, z_low + (low + s + 1) * dz - z[i]
            part = max(sphere_slice(r[i], a, b), 0.0)  # at a pole round-off may make it negative
            volume[i, s] = part
            total += part
        submerged[i] = total
        whole[i] = sphere_slice(r[i], -r[i], r[i])
        below[i] = max(sphere_slice(r[i], -r[i], z_low - z[i]), 0.0)
        above[i] = max(sphere_slice(r[i], z_low + n * dz - z[i], r[i]), 0.0)


@kernel
def factors_in_water(whole: Floats, submerged: Floats) -> tuple[Floats, Floats]:
    """Factors that turn volumes of a grain into shares of its submerged part, in cells and outside [1/m3]."""
    n = len(whole)
    per, outer = np.empty(n), np.zeros(n)
    for i in range(n):
        if submerged[i] <= DRY * whole[i]:
            per[i], outer[i] = 0.0, 1.0 / whole[i]
        else:
            per[i] = 1.0 / submerged[i]
    return per, outer


@kernel
def add_to_cells(
    order: Ints, first: Ints, count: Ints, volume: Floats, below: Floats, above: Floats,
    per: Floats, outer: Floats, amounts: Floats, sums: Floats, outside: Floats,
) -> None:  # fmt: skip
    """Add amounts (n_grain, m) to the cells (m, n), and parts outside the column to outside (m, 2)."""
    for rank in range(order.shape[0]):
        i = order[rank]
        low, high = first[i], first[i] + count[i]
        for c in range(amounts.shape[1]):
            amount = amounts[i, c] * per[i]
            row = sums[c, low:high]  # a view of its own: a third of the time of sums[c, first[i] + s]
            for s in range(count[i]):
                row[s] += amount * volume[i, s]
            if below[i] > 0.0 or above[i] > 0.0:
                outside[c, 0] += amounts[i, c] * outer[i] * below[i]
                outside[c, 1] += amounts[i, c] * outer[i] * above[i]


@kernel
def mean_over_grains(
    first: Ints, count: Ints, volume: Floats, per: Floats, table: Floats, out: Floats
) -> None:
    """Means over each grain, out (n_grain, m), of cell values, table (n, m)."""
    for i in range(first.shape[0]):
        for c in range(0, table.shape[1], FOUR):
            p = q = r = t = 0.0
            for s in range(count[i]):
                part, cell = volume[i, s], table[first[i] + s]
                p += part * cell[c]
                q += part * cell[c + 1]
                r += part * cell[c + 2]
                t += part * cell[c + 3]
            out[i, c], out[i, c + 1] = p * per[i], q * per[i]
            out[i, c + 2], out[i, c + 3] = r * per[i], t * per[i]
