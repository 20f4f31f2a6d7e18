"""How many grains a case asks for, how large they are, and the bed they make."""

import math

import numpy as np

from ryusa.casefile.box import box_plan
from ryusa.casefile.builders import Box, Drop, Flume, Packing, Saltation, Table
from ryusa.casefile.column import PACKED, PACKED_PLANE, Column
from ryusa.casefile.schema import Case, Spread
from ryusa.casefile.table import table_of

CUT = 2.5  # standard deviations at which normal and lognormal sizes are cut


def spread_of(case: Case) -> tuple[str, float]:
    """Shape and relative width of the size distribution."""
    spread = case.grains.spread
    return (spread.kind, spread.ratio) if isinstance(spread, Spread) else ("uniform", float(spread))


def sizes(case: Case) -> tuple[float, float, float]:
    """Mean diameter as the case states it, smallest of free grains and largest that can occur [m]."""
    table = table_of(case)
    if table is not None:
        every = table.column("d")
        return case.grains.diameter, float(every[~table.fixed].min()), float(every.max())
    d, (kind, ratio) = case.grains.diameter, spread_of(case)
    if kind == "uniform":
        return d, d * (1.0 - ratio), d * (1.0 + ratio)
    if kind == "normal":
        return d, d * max(1.0 - CUT * ratio, 0.05), d * (1.0 + CUT * ratio)
    width = math.sqrt(math.log1p(ratio * ratio))
    return (
        d,
        d * math.exp(-0.5 * width * width - CUT * width),
        d * math.exp(-0.5 * width * width + CUT * width),
    )


def counts(case: Case) -> tuple[int, int, bool]:
    """Free grains, fixed grains, and whether two free grains can meet."""
    build = case.build
    table = table_of(case)
    if table is not None:
        n_fixed = int(table.fixed.sum())
        n_free = table.n - n_fixed
        places = len(np.unique(table.column("y")[~table.fixed])) if case.motion.plane else 1
        return n_free, n_fixed, n_free > places
    if isinstance(build, Drop):
        free = 2 if build.partner == "free" else 1
        return build.copies * free, build.copies * (build.partner == "fixed"), build.partner == "free"
    if isinstance(build, Saltation):
        return build.starts, build.starts * build.n_bed, False
    if isinstance(build, Box):
        d, _, d_max = sizes(case)
        n_fixed = box_plan(build, d, d_max, case.motion.plane).n_fixed
        return build.columns * build.rows * build.layers, n_fixed, True
    bed = bed_counts(case)
    if isinstance(build, Flume):
        return flume_count(case), bed[0] * bed[1], True
    assert isinstance(build, Packing)
    return build.columns * build.rows * build.layers, bed[0] * bed[1], True


def bed_counts(case: Case) -> tuple[int, int]:
    """Fixed grains of the bed of a packing or a flume along x and y; (0, 0) over a plane."""
    build = case.build
    if isinstance(build, Flume):
        return (0, 0) if build.bed == "plane" else _side_by_side(case, build)
    if not isinstance(build, Packing) or build.bed == "plane":
        return 0, 0
    d, _, d_max = sizes(case)
    pitch = d_max * (1.0 + build.gap)
    fewest = 3 if build.periodic else 1
    n_x, n_y = (max(round(count * pitch / d), fewest) for count in (build.columns, build.rows))
    return n_x, 1 if case.motion.plane else n_y


def _side_by_side(case: Case, build: Flume) -> tuple[int, int]:
    """Mean grains that fit length and width of a flume."""
    d = case.grains.diameter
    return max(int(build.length / d * (1.0 + 1e-9)), 1), max(int((build.width or d) / d * (1.0 + 1e-9)), 1)


def flume_count(case: Case) -> int:
    """Free grains of a flume."""
    assert isinstance(case.build, Flume)
    n_x, n_y = _side_by_side(case, case.build)
    return round(case.build.layers * n_x * n_y)


def bed_area(case: Case) -> float:
    """Area of bed under the grains of a packing or a flume, a slab in a plane scene [m2]; nan for others."""
    build, slab = case.build, case.motion.slab_width or case.grains.diameter
    if isinstance(build, Flume):
        return build.length * (slab if case.motion.plane or build.width is None else build.width)
    if isinstance(build, Packing):
        pitch = sizes(case)[2] * (1.0 + build.gap)
        return build.columns * pitch * (slab if case.motion.plane else build.rows * pitch)
    return math.nan


def bed_thickness(case: Case) -> float:
    """How high free grains lie above their bed once as dense as `water.column.packed` [m]; nan if unknown.

    The base of fixed grains of random height takes up to half a layer more.
    """
    d, (kind, ratio) = case.grains.diameter, spread_of(case)
    # mean of d**3: uniform sizes have a variance of ratio**2/3, the others of ratio**2
    cube = d**3 * (1.0 + 3.0 * ratio**2 / (3.0 if kind == "uniform" else 1.0))
    return counts(case)[0] * case.grains.shape_volume * cube / (bed_area(case) * packed(case))


def bed_top(case: Case) -> float:
    """Height where loose grains end once as dense as `water.column.packed` [m]; nan if unknown."""
    build, d = case.build, case.grains.diameter
    if isinstance(build, Flume):
        return bed_thickness(case)
    if not isinstance(build, Packing):
        return math.nan
    crest = {"plane": 0.0, "flat": d, "random": (1.0 + 0.5 * build.bed_height) * d}[build.bed]
    return crest + bed_thickness(case)


def water_over(case: Case) -> float:
    """Depth of the water over the loose bed of a column [m]; below zero where it ends in the bed.

    It is `water.depth` where that counts from the top of the bed, over a fixed bed, and where the bed is not
    known.
    """
    wet = case.water
    if wet is None or wet.depth is None:
        return math.nan
    over_loose = wet.profile == "column" and (wet.column or Column()).bed == "moving"
    if wet.zero is None or not over_loose:
        return wet.depth
    top = bed_top(case)
    return wet.depth if math.isnan(top) else wet.zero + wet.depth - top


def packed(case: Case) -> float:
    """Concentration of a case's bed at rest, where eddies have no room [-]."""
    keys = (case.water and case.water.column) or Column()
    if keys.packed is not None:
        return keys.packed
    if not case.motion.plane:
        return PACKED
    d = sizes(case)[0]
    return PACKED_PLANE * d / (case.motion.slab_width or d)


def periodic(case: Case) -> tuple[bool, bool]:
    """Whether x and y are periodic."""
    build = case.build
    if isinstance(build, Flume):
        return True, not (case.motion.plane or build.walls)
    if isinstance(build, Packing):
        return build.periodic, build.periodic and not case.motion.plane
    if isinstance(build, Box):
        return False, not case.motion.plane
    if isinstance(build, Table):
        return case.domain.period_x is not None, case.domain.period_y is not None
    return isinstance(build, Saltation), False
