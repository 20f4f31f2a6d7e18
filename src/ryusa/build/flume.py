"""A channel with a loose bed over fixed grains of random height; the bed settles in a run."""

import math

import numpy as np

from ryusa.build.nested_lattice import LatticeCells, filled_cells, nested_lattice, places
from ryusa.build.placement import Placement, Wall, at_rest
from ryusa.build.sizes import draw, draw_laid
from ryusa.casefile.builders.schema import FlumeSection
from ryusa.casefile.builders.values import bed_counts, flume_count
from ryusa.casefile.case import Case
from ryusa.casefile.column.bed import bed_thickness
from ryusa.casefile.column.packed import packed
from ryusa.casefile.facts import Derived
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.grains.values import graded
from ryusa.casefile.shape import extent
from ryusa.model.scene import Floats

SIDES = ("right", "left")  # looking downstream: y = 0 and y = width


def flume(case: Case, derived: Derived) -> Placement:
    """Free lattice over a base whose centres lie at z = 0 on average; groups `bed`, `right`, `left`."""
    keys = case.build
    assert isinstance(keys, FlumeSection)
    rng = np.random.default_rng(case.seed)
    d, plane = derived.d, case.motion.plane
    wide = d if plane or keys.width is None else keys.width
    x_fixed = _base(case, keys, rng, wide)
    top = float(x_fixed[:, 2].max()) + d / 2.0 if len(x_fixed) else 0.0
    sized: Floats | None = None
    cells = _cells(case, keys, wide, derived.room)
    if not graded(case):
        x = _lattice(case, keys, rng, cells, derived.room)
    else:
        sized = draw_laid(case, flume_count(case, keys), rng)
        x = nested_lattice(sized * extent(case), cells, keys.gap, keys.jitter, plane, rng)
    if plane:
        x[:, 1] = 0.0
    x[:, 2] += top
    walls = () if len(x_fixed) else (Wall("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),)
    sided = keys.walls and not plane
    if sided:
        walls += (
            Wall(SIDES[0], (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
            Wall(SIDES[1], (0.0, wide, 0.0), (0.0, -1.0, 0.0)),
        )
    z_zero, where = bed_level(case, 0.0, d / 2.0 if len(x_fixed) else None)
    notes = (f"zero of the water {where} (water.zero not given)",)
    return Placement(
        d=draw(case, len(x), rng) if sized is None else sized,
        x=x,
        v=at_rest(len(x)),
        omega=at_rest(len(x)),
        d_fixed=np.full(len(x_fixed), d),
        x_fixed=x_fixed,
        walls=walls,
        period=(keys.length, math.inf if plane or sided else wide),
        z_zero=z_zero,
        notes=notes if case.water is not None and case.water.zero is None else (),
    )


def bed_level(case: Case, base: float, crest: float | None) -> tuple[float, str]:
    """Height of the bed that water flows over [m], and where that is.

    Parameters
    ----------
    base : height from which loose grains fill the bed [m].
    crest : mean top of the fixed grains [m]; None over a plane.
    """
    keys = case.column
    if case.water is None or case.water.profile != "column" or keys.bed != "moving":
        if keys.bottom is not None:
            return keys.bottom, "at water.column.bottom"
        if crest is None:
            return base, "at the floor"
        return crest - 0.25 * reference_diameter(case), "d/4 below the mean crest of the fixed bed"
    level = base + bed_thickness(case)
    return level, f"at the top of the grains settled to the concentration {packed(case):g}"


def _base(case: Case, keys: FlumeSection, rng: np.random.Generator, wide: float) -> Floats:
    """Fixed grains of mean diameter, evenly spaced, at random or equal height around z = 0 [m]."""
    n_x, n_y = bed_counts(case)
    grid = np.stack(np.meshgrid(np.arange(n_y), np.arange(n_x), indexing="ij"), -1).reshape(-1, 2)
    x = at_rest(len(grid))
    if not len(grid):
        return x
    x[:, 0] = (grid[:, 1] + 0.5) * keys.length / n_x
    if not case.motion.plane:
        x[:, 1] = (grid[:, 0] + 0.5) * wide / n_y
    if keys.bed == "random":
        x[:, 2] = rng.uniform(-0.5, 0.5, len(x)) * keys.bed_height * reference_diameter(case)
        x[:, 2] -= x[:, 2].mean()
    return x


def _cells(case: Case, keys: FlumeSection, wide: float, room: float) -> LatticeCells:
    """Cells that hold the largest grain with its gap and fill length and width."""
    free = room * (1.0 + keys.gap)
    n_x = max(int(keys.length / free), 1)
    n_y = 1 if case.motion.plane else max(int(wide / free), 1)
    return LatticeCells((keys.length / n_x, wide / n_y, free), n_x, n_y, _thickness(case, keys, n_x))


def _thickness(case: Case, keys: FlumeSection, n_x: int) -> Floats | None:
    """Thickness of the loose bed over its mean at the middles of n_x columns; None without waves."""
    if keys.waves == 0:
        return None
    phase = 2.0 * math.pi * keys.waves * (np.arange(n_x) + 0.5) / n_x
    return np.asarray(1.0 + 0.5 * keys.wave_height / bed_thickness(case) * np.cos(phase))


def _lattice(
    case: Case, keys: FlumeSection, rng: np.random.Generator, cells: LatticeCells, room: float
) -> Floats:
    """Jittered centres from z = 0 upwards, clear of neighbours and walls [m]; the top layer is incomplete."""
    pitch = np.array(cells.pitch)
    chosen = np.sort(filled_cells(flume_count(case, keys), cells, rng))
    free = 0.5 * keys.jitter * np.maximum(pitch - room, 0.0)
    x = (places(chosen, cells) + 0.5) * pitch
    return np.asarray(x + rng.uniform(-1.0, 1.0, x.shape) * free)
