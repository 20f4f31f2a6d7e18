"""Grains on a jittered lattice in a box or inside a wall of the case; they settle in a run."""

import math

import numpy as np

from ryusa.build.nested_lattice import LatticeCells, nested_lattice
from ryusa.build.placement import Placement, at_rest
from ryusa.build.sizes import draw, draw_laid
from ryusa.casefile.builders.schema import FillSection
from ryusa.casefile.builders.values import (
    fill_box,
    fill_cells,
    fill_count,
    fill_inside,
    periodic,
    plate_of,
)
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.grains.values import graded
from ryusa.casefile.shape import extent
from ryusa.model.scene import Floats


def fill(case: Case, derived: Derived) -> Placement:
    """Lattice in the middle of the box, or in a wall, filled from below; a periodic box is the period.

    Group `floor`, a plate.
    """
    keys = case.build
    assert isinstance(keys, FillSection)
    rng = np.random.default_rng(case.seed)
    if keys.inside is not None:
        return _inside(case, keys, derived, rng)
    pitch = derived.room * (1.0 + keys.gap)
    n_x, n_y, n_z = fill_cells(case, keys)
    low, high = (np.array(one) for one in fill_box(keys))
    corner = 0.5 * (low + high - pitch * np.array([n_x, n_y, n_z]))
    corner[2] = low[2]
    sized: Floats | None = None
    if not graded(case):
        cells = np.stack(np.meshgrid(np.arange(n_z), np.arange(n_y), np.arange(n_x), indexing="ij"), -1)
        cells = cells.reshape(-1, 3)[: fill_count(case, keys), ::-1]
        free = 0.5 * keys.jitter * keys.gap * derived.room
        x = corner + (cells + 0.5) * pitch
        x = x + rng.uniform(-free, free, x.shape)  # neighbours stay `room` apart on each axis
    else:
        sized = draw_laid(case, fill_count(case, keys), rng)
        block = LatticeCells((pitch, pitch, pitch), n_x, n_y)
        x = corner + nested_lattice(
            sized * extent(case), block, keys.gap, keys.jitter, case.motion.plane, rng
        )
    if case.motion.plane:
        x[:, 1] = 0.0
    period = tuple(float(high[k] - low[k]) if one else math.inf for k, one in enumerate(periodic(case)))
    sized = draw(case, len(x), rng) if sized is None else sized
    return _placed(case, keys, derived, x, sized, (period[0], period[1]))


def _inside(case: Case, keys: FillSection, derived: Derived, rng: np.random.Generator) -> Placement:
    """Lattice in a wall; a grain near it is displaced by as much as keeps it whole inside."""
    laid, n = fill_inside(case, keys), fill_count(case, keys)
    grid, open_ = laid.grid, (math.inf, math.inf)
    if graded(case):
        sized = draw_laid(case, n, rng)
        block = LatticeCells((grid.side, grid.side, grid.side), *grid.shape[:2], only=laid.numbers)
        x = np.array(grid.corner) + nested_lattice(
            sized * extent(case), block, keys.gap, keys.jitter, False, rng
        )
        return _placed(case, keys, derived, x, sized, open_)
    free = 0.5 * keys.jitter * keys.gap * derived.room
    aside = rng.uniform(-free, free, (n, 3))
    far = np.linalg.norm(aside, axis=1)
    aside *= np.minimum(1.0, laid.free[:n] / np.maximum(far, 1.0e-300))[:, None]
    return _placed(case, keys, derived, grid.middles(laid.numbers[:n]) + aside, draw(case, n, rng), open_)


def _placed(
    case: Case, keys: FillSection, derived: Derived, x: Floats, d: Floats, period: tuple[float, float]
) -> Placement:
    n, plate = len(x), plate_of(case, keys.plate)
    return Placement(
        d=d, x=x, v=at_rest(n), omega=at_rest(n),
        period=period,
        d_fixed=np.full(len(plate), derived.d), x_fixed=plate,
        fixed_groups=(("floor", 0, len(plate)),) if len(plate) else (),
    )  # fmt: skip
