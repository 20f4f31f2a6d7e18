"""A lattice for grains of many sizes: a cell of the largest holds one of them, or cells of half the width."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.casefile.builders.values import DEEPEST
from ryusa.model.scene import Floats


@dataclass(frozen=True)
class LatticeCells:
    """Block of cells from the corner at the origin upwards, each wide enough for the largest grain."""

    pitch: tuple[float, float, float]  # of a cell along x, y and z [m]
    n_x: int  # cells along x
    n_y: int  # along y, 1 in a plane scene
    thickness: Floats | None = None  # of the block at each of n_x, relative, >= 0 [-]; None: even
    only: NDArray[np.int64] | None = None  # numbers of the cells that may be filled, ascending; None: all


def nested_lattice(
    d: Floats, cells: LatticeCells, gap: float, jitter: float, plane: bool, rng: np.random.Generator
) -> Floats:
    """Centres of grains of many sizes that do not touch, well mixed, from z = 0 upwards [m].

    Parameters
    ----------
    d : diameters [m], shape (n,); the largest fits a cell.
    cells : the block; as many layers of it are filled as are needed, the highest at random places, or layers
        in proportion to its thickness.
    gap : least gap to the sides of a cell together, over the diameter of its grain [-].
    jitter : share of the free room in its cell by which a grain is displaced, 0 to 1.
    plane : y is 0, and a cell is halved along x and z alone.

    Returns
    -------
    x : centres, in the order of d, shape (n, 3).

    Notes
    -----
    On a lattice of one width a block of graded grains would be as loose as its smallest, and fall far. Here a
    grain lies in the smallest cell that holds it with its gap. From the finest level up, grains and filled
    cells of a level are shuffled and put together by eights (by fours in a plane) into cells of the next.
    """
    halved = (0, 2) if plane else (0, 1, 2)
    pitch = np.array(cells.pitch)
    level = _levels(d, float(pitch[list(halved)].min()), gap)
    grains = [np.flatnonzero(level == k) for k in range(int(level.max(initial=0)) + 1)]
    slots = _slots(halved)
    orders: list[NDArray[np.int64]] = []  # of each level, finest first: the item at each place
    n_filled = 0
    for k in reversed(range(len(grains))):
        orders.append(rng.permutation(len(grains[k]) + n_filled))
        n_filled = math.ceil(len(orders[-1]) / len(slots))
    x = np.zeros((len(d), 3))
    corners = places(filled_cells(len(orders[-1]), cells, rng), cells) * pitch
    for k, order in enumerate(reversed(orders)):
        width = pitch.copy()
        width[list(halved)] /= 2.0**k
        at = np.empty_like(corners)
        at[order] = corners
        here = grains[k]
        room = 0.5 * jitter * np.maximum(width - d[here, None], 0.0)
        x[here] = at[: len(here)] + 0.5 * width + rng.uniform(-1.0, 1.0, (len(here), 3)) * room
        if k + 1 < len(orders):
            inner = np.arange(len(orders[-2 - k]))
            filled, slot = np.divmod(inner, len(slots))
            half = width.copy()
            half[list(halved)] /= 2.0
            corners = at[len(here) :][filled] + slots[slot] * half
    if plane:
        x[:, 1] = 0.0
    return x


def _levels(d: Floats, width: float, gap: float) -> NDArray[np.int64]:
    """How often a cell of this width [m] can be halved and still hold each grain with its gap."""
    found = np.floor(np.log2(width / (d * (1.0 + gap))) + 1.0e-9)
    return np.clip(found, 0, DEEPEST).astype(np.int64)


def _slots(halved: tuple[int, ...]) -> Floats:
    """Corners of the cells of half width within a cell, in their widths, shape (2^axes, 3)."""
    found = np.zeros((1 << len(halved), 3))
    for bit, axis in enumerate(halved):
        found[:, axis] = (np.arange(len(found)) >> bit) & 1
    return found


def filled_cells(n: int, cells: LatticeCells, rng: np.random.Generator) -> NDArray[np.int64]:
    """Numbers of n cells filled from below layer by layer, shape (n,); of the highest at random places.

    A cell's number is its layer times n_x n_y, plus its place along y times n_x, plus that along x.

    Notes
    -----
    With a thickness w along x the n cells with the smallest (layer + u)/w are filled, u uniform in [0, 1) for
    each place: every place holds w times the same number of cells in the mean, its fraction at random.

    Raises
    ------
    ValueError : the thickness is negative or 0 everywhere, or too few cells may be filled.
    """
    per_layer = cells.n_x * cells.n_y
    if (only := cells.only) is not None:
        if n > len(only):
            raise ValueError(f"{n} cells are to be filled, and there are {len(only)}")
        top = only // per_layer == (only[n - 1] // per_layer if n else -1)
        below = only[:n][~top[:n]]
        return np.concatenate([below, rng.permutation(only[top])[: n - len(below)]])
    if cells.thickness is None:
        full = n // per_layer * per_layer
        return np.concatenate([np.arange(full), full + rng.permutation(per_layer)[: n - full]])
    w = np.asarray(cells.thickness, dtype=np.float64)
    if w.min() < 0.0 or w.max() == 0.0:
        raise ValueError("the relative thickness must be at least 0, and more than 0 somewhere")
    layers = np.arange(math.ceil(n * w.max() / (cells.n_y * w.sum())) + 1)
    u = rng.uniform(0.0, 1.0, (cells.n_y, cells.n_x))
    with np.errstate(divide="ignore", invalid="ignore"):
        height = np.where(w > 0.0, (layers[:, None, None] + u) / w, math.inf).ravel()
    return np.sort(np.argsort(height, kind="stable")[:n])


def places(numbers: NDArray[np.int64], cells: LatticeCells) -> NDArray[np.int64]:
    """Place of cells along x, y and z, shape (n, 3)."""
    layer, within = np.divmod(numbers, cells.n_x * cells.n_y)
    return np.stack([within % cells.n_x, within // cells.n_x, layer], -1)
