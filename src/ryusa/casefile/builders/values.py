"""What a builder will place: sizes and numbers of grains, the fixed bed, the periods."""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ryusa.casefile.builders.box import box_plan
from ryusa.casefile.builders.inside import CellsInside, cells_inside, enclosure_of
from ryusa.casefile.builders.schema import (
    BoxSection,
    DropSection,
    EmptySection,
    FillSection,
    FlumeSection,
    FromFile,
    PackingSection,
    SaltationSection,
    StreamSection,
)
from ryusa.casefile.builders.table import made_of, period_of, rows_of_material, table_of
from ryusa.casefile.case import Case
from ryusa.casefile.column.packed import packed
from ryusa.casefile.feeds.values import fed_in_all
from ryusa.casefile.grading import grading_of, reference_diameter
from ryusa.casefile.grains.schema import spread_of
from ryusa.casefile.grains.values import CUT, graded, laid_mean_cube, laid_shares, sized_as, slab_width
from ryusa.casefile.row.ends import width_of
from ryusa.casefile.row.reach_source import reach_of
from ryusa.casefile.row.values import bed_over, dam_span, row_plan, stream_span
from ryusa.casefile.shape import extent

FEWEST_PERIODS = 3  # largest diameters that a period must hold
PLATE_COUNTED = 1e4  # radius of a plate in diameters up to which its grains are counted one by one
DEEPEST = 20  # halvings of a cell; a grain a millionth as large as its cell loses nothing more
_ROUNDED = 4.0  # cells of the lattice of builder 'fill'
Corner = tuple[float, float, float]


def sizes(case: Case) -> tuple[float, float, float]:
    """Mean diameter as the case states it, smallest of free grains and largest that can occur [m]."""
    table = table_of(case)
    ranges = [drawn_range(case, name) for name in drawn_materials(case)]
    if table is not None:
        every = table.column("d")
        ranges.append((float(every[~table.fixed].min()), float(every.max())))
    if (reach := reach_of(case)) is not None:
        ranges.append((float(reach.d.min()), float(reach.d.max())))
    return reference_diameter(case), min(low for low, _ in ranges), max(high for _, high in ranges)


def drawn_materials(case: Case) -> set[str | None]:
    """Materials of which the builder or a feed draws the sizes; None is that of [grains]."""
    laid = set(laid_shares(case.grains, case.build)) if table_of(case) is None else set[str | None]()
    fed = {feed.material for feed in case.feeds if feed.brings}
    return laid | fed or ({None} if table_of(case) is None else set[str | None]())


def size_range(case: Case, name: str | None) -> tuple[float, float]:
    """Smallest and largest diameter of the free grains of a material [m]."""
    table = table_of(case)
    if table is None:
        return drawn_range(case, name)
    there = table.column("d")[rows_of_material(table, made_of(case.build), name)]
    ranges = [(float(there.min()), float(there.max()))] if len(there) else []
    if not ranges or name in {feed.material for feed in case.feeds if feed.brings}:
        ranges.append(drawn_range(case, name))
    return min(low for low, _ in ranges), max(high for _, high in ranges)


def room(case: Case) -> float:
    """Diameter of the sphere that holds any of the free grains, however it is turned [m]."""
    return sizes(case)[2] * extent(case)


def drawn_range(case: Case, name: str | None) -> tuple[float, float]:
    """Smallest and largest diameter of the distribution of a material [m]; None is that of [grains]."""
    sized = sized_as(case, name)
    d, grading = reference_diameter(sized), grading_of(sized)
    if grading is not None:
        return float(grading.d[0]), float(grading.d[-1])
    kind, ratio = spread_of(sized.grains)
    if kind == "uniform":
        return d * (1.0 - ratio), d * (1.0 + ratio)
    if kind == "normal":
        return d * max(1.0 - CUT * ratio, 0.05), d * (1.0 + CUT * ratio)
    width = math.sqrt(math.log1p(ratio * ratio))
    return d * math.exp(-0.5 * width * width - CUT * width), d * math.exp(-0.5 * width * width + CUT * width)


def counts(case: Case) -> tuple[int, int, bool]:
    """Free grains with those that feeds bring, fixed grains, and whether two free grains can meet."""
    free, fixed, meet = built_counts(case)
    return free + fed_in_all(case), fixed, meet or bool(case.feeds)


def built_counts(case: Case) -> tuple[int, int, bool]:
    """Free grains at the start, fixed grains, and whether two of these free grains can meet."""
    build = case.build
    table = table_of(case)
    if table is not None:
        n_fixed = int(table.fixed.sum())
        n_free = table.n - n_fixed
        places = len(np.unique(table.column("y")[~table.fixed])) if case.motion.plane else 1
        return n_free, n_fixed, n_free > places
    if isinstance(build, DropSection):
        free = 2 if build.partner == "free" else 1
        return build.copies * free, build.copies * (build.partner == "fixed"), build.partner == "free"
    if isinstance(build, EmptySection):
        return 0, plate_count(case, build.plate), False
    if isinstance(build, SaltationSection):
        return build.starts, build.starts * build.n_bed, False
    if isinstance(build, BoxSection):
        n_fixed = box_plan(build, sizes(case)[0], room(case), case.motion.plane).n_fixed
        return build.columns * build.rows * build.layers, n_fixed, True
    if isinstance(build, FillSection):
        return fill_count(case, build), plate_count(case, build.plate), True
    if isinstance(build, StreamSection):
        return stream_count(case), 0, True
    bed = bed_counts(case)
    if isinstance(build, FlumeSection):
        return flume_count(case, build), bed[0] * bed[1], True
    assert isinstance(build, PackingSection)
    return build.columns * build.rows * build.layers, bed[0] * bed[1], True


def plate_of(case: Case, radius: float | None) -> NDArray[np.float64]:
    """Centres of touching grains of mean diameter within a radius [m], at z = -d/2; shape (n, 3)."""
    if radius is None:
        return np.zeros((0, 3))
    d = reference_diameter(case)
    j, low, high = _plate_rows(radius / d, case.motion.plane)
    many = high - low + 1
    i = np.arange(many.sum()) - np.repeat(np.cumsum(many) - many, many) + np.repeat(low, many)
    j = np.repeat(j, many)
    order = np.lexsort((j, i))
    i, j = i[order], j[order]
    return np.stack([d * (i + 0.5 * j), d * math.sqrt(0.75) * j, np.full(len(i), -0.5 * d)], -1)


def plate_count(case: Case, radius: float | None) -> int:
    """Number of centres of `plate_of`, without laying them; by area for a radius of over 10,000 diameters."""
    if radius is None:
        return 0
    ratio = radius / reference_diameter(case)
    if ratio > PLATE_COUNTED:
        ratio = min(ratio, 1e9)  # far more than a case may ask for
        return round(2.0 * ratio) if case.motion.plane else round(math.pi / math.sqrt(0.75) * ratio * ratio)
    _, low, high = _plate_rows(ratio, case.motion.plane)
    return int((high - low + 1).sum())


def _plate_rows(ratio: float, plane: bool) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Rows of a hexagonal plate that have centres within `ratio` diameters, first and last place of each."""
    ratio *= 1.0 + 1e-12  # a centre on the edge belongs to the plate
    reach = 0 if plane else int(ratio / math.sqrt(0.75))
    j = np.arange(-reach, reach + 1)
    half = np.sqrt(np.maximum(ratio * ratio - 0.75 * j * j, 0.0))
    low, high = np.ceil(-half - 0.5 * j).astype(np.int64), np.floor(half - 0.5 * j).astype(np.int64)
    kept = high >= low
    return j[kept], low[kept], high[kept]


def bed_counts(case: Case) -> tuple[int, int]:
    """Fixed grains of the bed of a packing or a flume along x and y; (0, 0) over a plane."""
    build = case.build
    if isinstance(build, FlumeSection):
        return (0, 0) if build.bed == "plane" else _side_by_side(case, build)
    if not isinstance(build, PackingSection) or build.bed == "plane":
        return 0, 0
    d, pitch = sizes(case)[0], room(case) * (1.0 + build.gap)
    fewest = 3 if build.periodic else 1
    n_x, n_y = (max(round(count * pitch / d), fewest) for count in (build.columns, build.rows))
    return n_x, 1 if case.motion.plane else n_y


def bed_opening(case: Case) -> float:
    """Largest grain that could slip through the fixed grains of the bed of a packing or a flume [m].

    Amid four grains of a rectangle in three dimensions, between two in a plane scene, the highest beside the
    lowest; negative where they are closer than a diameter.
    """
    build, (n_x, n_y) = case.build, bed_counts(case)
    if n_x == 0:
        return 0.0
    assert isinstance(build, PackingSection | FlumeSection)
    d = sizes(case)[0]
    if isinstance(build, FlumeSection):
        long, wide = build.length, build.width or d
    else:
        long, wide = (count * room(case) * (1.0 + build.gap) for count in (build.columns, build.rows))
    rise = build.bed_height * d if build.bed == "random" else 0.0
    across = 0.0 if case.motion.plane else wide / n_y
    return math.sqrt((long / n_x) ** 2 + across**2 + rise**2) - d


def _side_by_side(case: Case, build: FlumeSection) -> tuple[int, int]:
    """Mean grains that fit length and width of a flume."""
    d = reference_diameter(case)
    return max(int(build.length / d * (1.0 + 1e-9)), 1), max(int((build.width or d) / d * (1.0 + 1e-9)), 1)


def flume_count(case: Case, build: FlumeSection) -> int:
    """Free grains of a flume; of several sizes as many as have the volume of those layers."""
    n_x, n_y = _side_by_side(case, build)
    each = reference_diameter(case) ** 3 / laid_mean_cube(case) if graded(case) else 1.0
    return round(build.layers * n_x * n_y * each)


def fill_cells(case: Case, build: FillSection) -> tuple[int, int, int]:
    """Cells of the lattice of builder 'fill' along x, y and z, in its box or round its wall."""
    if build.inside is not None:
        return fill_inside(case, build).grid.shape
    pitch = room(case) * (1.0 + build.gap)
    x, y, z = (
        max(int((high - low) / pitch * (1.0 + 1e-9)), 0) for low, high in zip(*fill_box(build), strict=True)
    )
    return x, 1 if case.motion.plane else y, z


def fill_box(build: FillSection) -> tuple[Corner, Corner]:
    """Lower and upper corner of the box of builder 'fill' [m]."""
    assert build.low is not None and build.high is not None
    return build.low, build.high


def fill_inside(case: Case, build: FillSection) -> CellsInside:
    """Cells of builder 'fill' in the wall that it names; of a sieve curve, those that lie inside wholly."""
    pitch = room(case) * (1.0 + build.gap)
    return cells_inside(enclosure_of(case.folder, case.walls, build), pitch, room(case), graded(case))


def fill_count(case: Case, build: FillSection) -> int:
    """Free grains of builder 'fill': as many as fit, or fewer if asked for."""
    held = fill_most(case, build)
    return min(held, build.number or build.most or held)


def fill_most(case: Case, build: FillSection) -> int:
    """Grains that builder 'fill' can lay; of several sizes what its cells hold, halved for smaller ones.

    Notes
    -----
    A grain of level k, with d <= d_max/2^k, takes 8^-k of a cell (4^-k in a plane). Sizes by quota differ by
    up to two grains from the share of a level, and the grains of a level are rounded up to a whole cell of
    the next: together less than `_ROUNDED` cells for each material.
    """
    inside = build.inside is not None
    cells = len(fill_inside(case, build).numbers) if inside else math.prod(fill_cells(case, build))
    if not graded(case):
        return cells
    laid = laid_shares(case.grains, case.build)
    each = sum(share * _cells_of_a_grain(case, name) for name, share in laid.items())
    return max(cells, int((cells - _ROUNDED * len(laid)) / each))


def stream_cells(case: Case) -> tuple[float, tuple[float, float], NDArray[np.int64], int]:
    """Lattice of builder 'stream': where it begins [m], its pitch along x and y [m], its columns, rows.

    The columns are those beside dams, numbered from where the lattice begins; each spans a pitch along x.
    """
    build = case.build
    assert isinstance(build, StreamSection)
    begin, end = stream_span(case)
    free, width = room(case) * (1.0 + build.gap), width_of(case) or 0.0
    n_x, n_y = max(int((end - begin) / free * (1.0 + 1e-9)), 1), max(int(width / free * (1.0 + 1e-9)), 1)
    pitch, plan = (end - begin) / n_x, row_plan(case)
    low, close = begin + np.arange(n_x) * pitch, 1.0e-9 * pitch
    beside = np.ones(n_x, np.bool_)
    for dam in case.water.row.dams if case.water is not None and case.water.row is not None else ():
        first, last = (plan.x_low + i * plan.dx for i in dam_span(plan, dam))
        beside &= (low + pitch <= first + close) | (low >= last - close)
    return begin, (pitch, width / n_y), np.flatnonzero(beside), n_y


def stream_thickness(case: Case) -> NDArray[np.float64]:
    """Thickness of the settled bed in the columns of the lattice of builder 'stream' [m]."""
    begin, (pitch, _), columns, _ = stream_cells(case)
    return bed_over(case, np.asarray(begin + (columns + 0.5) * pitch, dtype=np.float64))


def stream_count(case: Case) -> int:
    """Free grains of the bed of builder 'stream': their volume over its area is thickness times `packed`."""
    build = case.build
    assert isinstance(build, StreamSection)
    if build.bed == 0.0:
        return 0
    pitch, thick = stream_cells(case)[1][0], stream_thickness(case)
    volume = float(thick.sum()) * packed(case) * pitch * (width_of(case) or 0.0)
    return max(round(volume / (case.grains.shape_volume * laid_mean_cube(case))), 0)


def _cells_of_a_grain(case: Case, name: str | None) -> float:
    """Cells of the largest grain that a grain of a material takes in the mean [-]."""
    halved = 4.0 if case.motion.plane else 8.0
    widest = sizes(case)[2]
    grading = grading_of(sized_as(case, name))
    if grading is None:  # each as its largest
        level = math.floor(math.log2(widest / drawn_range(case, name)[1]) + 1.0e-9)
        return halved ** -min(level, DEEPEST)
    below = [grading.number_below(widest * 0.5**k * (1.0 + 1.0e-12)) for k in range(DEEPEST)]
    return sum((a - b) / halved**k for k, (a, b) in enumerate(pairwise([*below, 0.0])))


def bed_area(case: Case) -> float:
    """Area of bed under a packing, a flume or a periodic box, a slab in the plane [m2]; nan for others."""
    build, slab = case.build, slab_width(case)
    if isinstance(build, FlumeSection):
        return build.length * (slab if case.motion.plane or build.width is None else build.width)
    if isinstance(build, PackingSection):
        pitch = room(case) * (1.0 + build.gap)
        return build.columns * pitch * (slab if case.motion.plane else build.rows * pitch)
    if isinstance(build, FillSection) and build.periodic:
        low, high = fill_box(build)
        x, y = high[0] - low[0], high[1] - low[1]
        return x * (slab if case.motion.plane else y)
    return math.nan


def periodic(case: Case) -> tuple[bool, bool]:
    """Whether x and y are periodic."""
    build = case.build
    if isinstance(build, FlumeSection):
        return True, not (case.motion.plane or build.walls)
    if isinstance(build, PackingSection | FillSection):
        return build.periodic, build.periodic and not case.motion.plane
    if isinstance(build, BoxSection):
        return False, not case.motion.plane
    if isinstance(build, StreamSection):
        return False, not build.walls
    if isinstance(build, FromFile):
        x, y = period_of(case)
        return math.isfinite(x), math.isfinite(y)
    return isinstance(build, SaltationSection), False
