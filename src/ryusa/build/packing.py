"""Layers of grains on a jittered lattice over a bed of random height; they settle in a run."""

import numpy as np

from ryusa.build.flume import bed_level
from ryusa.build.nested_lattice import LatticeCells, nested_lattice
from ryusa.build.placement import Placement, Wall, at_rest
from ryusa.build.sizes import draw, draw_laid
from ryusa.casefile.builders.schema import PackingSection
from ryusa.casefile.builders.values import bed_counts
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.grains.values import graded
from ryusa.casefile.shape import extent
from ryusa.model.scene import Floats


def packing(case: Case, derived: Derived) -> Placement:
    """Free lattice above the bed, periodic in x (and in y in three dimensions) or open; group `bed`."""
    keys = case.build
    assert isinstance(keys, PackingSection)
    rng = np.random.default_rng(case.seed)
    d, room, plane = derived.d, derived.room, case.motion.plane
    pitch = room * (1.0 + keys.gap)
    wide, deep = keys.columns * pitch, keys.rows * pitch
    inf = float("inf")
    period = (wide, inf if plane else deep) if keys.periodic else (inf, inf)
    x_fixed, top, walls = at_rest(0), 0.0, (Wall("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),)
    if keys.bed != "plane":
        x_fixed, walls = _bed(case, keys, rng, wide, deep), ()
        top = float(x_fixed[:, 2].max()) + d / 2.0
    sized: Floats | None = None
    if not graded(case):
        x = _lattice(keys, pitch, room, rng)
    else:
        sized = draw_laid(case, keys.columns * keys.rows * keys.layers, rng)
        cells = LatticeCells((pitch, pitch, pitch), keys.columns, keys.rows)
        x = nested_lattice(sized * extent(case), cells, keys.gap, keys.jitter, plane, rng)
    if plane:
        x[:, 1] = 0.0
    x[:, 2] += top
    n = len(x)
    v = at_rest(n)
    v[:, 0] = keys.speed
    crest = float(np.mean(x_fixed[:, 2])) + d / 2.0 if len(x_fixed) else 0.0
    sizes = draw(case, n, rng) if sized is None else sized
    z_zero, where = bed_level(case, crest, crest if len(x_fixed) else None)
    notes: list[str] = []
    if case.water is not None and case.water.zero is None:
        notes.append(f"zero of the water profile {where} (water.zero not given)")
    return Placement(
        d=sizes,
        x=x,
        v=v,
        omega=at_rest(n),
        d_fixed=np.full(len(x_fixed), d),
        x_fixed=x_fixed,
        walls=walls,
        period=period,
        z_zero=z_zero,
        notes=tuple(notes),
    )


def _lattice(keys: PackingSection, pitch: float, room: float, rng: np.random.Generator) -> Floats:
    """Jittered centres from z = 0 upwards [m]; neighbours stay `room` apart on each axis."""
    cells = np.stack(
        np.meshgrid(np.arange(keys.layers), np.arange(keys.rows), np.arange(keys.columns), indexing="ij"), -1
    )
    x = (cells.reshape(-1, 3)[:, ::-1] + 0.5) * pitch
    free = 0.5 * keys.jitter * keys.gap * room
    return np.asarray(x + rng.uniform(-free, free, x.shape))


def _bed(case: Case, keys: PackingSection, rng: np.random.Generator, wide: float, deep: float) -> Floats:
    """Fixed grains of mean diameter, evenly spaced under the block, at random or equal height [m]."""
    n_x, n_y = bed_counts(case)
    d = reference_diameter(case)
    grid = np.stack(np.meshgrid(np.arange(n_y), np.arange(n_x), indexing="ij"), -1).reshape(-1, 2)
    x = at_rest(len(grid))
    x[:, 0] = (grid[:, 1] + 0.5) * wide / n_x
    if not case.motion.plane:
        x[:, 1] = (grid[:, 0] + 0.5) * deep / n_y
    x[:, 2] = d / 2.0
    if keys.bed == "random":
        x[:, 2] += rng.uniform(0.0, keys.bed_height * d, len(x))
    return x
