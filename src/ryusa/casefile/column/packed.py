"""Concentration of a loose bed at rest."""

from ryusa.casefile.case import Case
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.grains.values import slab_width

# concentration of a bed at rest [-]; in a plane scene, of spheres in a slab one diameter wide
PACKED, PACKED_PLANE = 0.61, 0.55


def packed(case: Case) -> float:
    """Concentration of the bed at rest [-], at which the mixing length is zero."""
    keys = case.column
    if keys.packed is not None:
        return keys.packed
    if not case.motion.plane:
        return PACKED
    return PACKED_PLANE * reference_diameter(case) / slab_width(case)
