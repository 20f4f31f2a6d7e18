"""The loose bed under a column of water: how thick it lies, where it ends, and the depth of water over it."""

import math

from ryusa.casefile.builders.schema import FlumeSection, PackingSection
from ryusa.casefile.builders.values import bed_area, counts
from ryusa.casefile.case import Case
from ryusa.casefile.column.packed import packed
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.grains.values import laid_mean_cube


def bed_thickness(case: Case) -> float:
    """Thickness of the free grains settled to the concentration `packed` [m]; nan if unknown.

    A base of fixed grains of random height takes up to half a layer more.
    """
    return counts(case)[0] * case.grains.shape_volume * laid_mean_cube(case) / (bed_area(case) * packed(case))


def bed_top(case: Case) -> float:
    """Height of the top of the free grains settled to the concentration `packed` [m]; nan if unknown."""
    build, d = case.build, reference_diameter(case)
    if isinstance(build, FlumeSection):
        return bed_thickness(case)
    if not isinstance(build, PackingSection):
        return math.nan
    crest = {"plane": 0.0, "flat": d, "random": (1.0 + 0.5 * build.bed_height) * d}[build.bed]
    return crest + bed_thickness(case)


def water_over(case: Case) -> float:
    """Depth of the water over the loose bed of a column [m]; negative where the surface lies within the bed.

    It is `water.depth` itself where that is measured from the top of the bed, over a fixed bed, and where the
    bed is not known.
    """
    wet = case.water
    if wet is None or wet.depth is None:
        return math.nan
    over_loose = wet.profile == "column" and case.column.bed == "moving"
    if wet.zero is None or not over_loose:
        return wet.depth
    top = bed_top(case)
    return wet.depth if math.isnan(top) else wet.zero + wet.depth - top
