"""[domain] and [[planes]]: periods, boundaries of the scene and flat walls."""

from typing import Annotated

from pydantic import Field

from ryusa.casefile.quantities import Name, Number, Point, PositiveLength
from ryusa.casefile.section import Section


class DomainSection(Section):
    """Periods, outer box and the overlap that stops a run."""

    period_x: PositiveLength | None = None
    """Period in x, for builders "table" and "run" where the file states none; others set their own."""
    period_y: PositiveLength | None = None
    """Period in y, for builders "table" and "run" where the file states none; others set their own."""
    low: Point | None = None
    """Lower corner of the outer box; a grain that leaves the box is lost and stops the run. By default a box
    far larger than the first grains need."""
    high: Point | None = None
    """Upper corner of the outer box."""
    overlap_limit: Annotated[Number, Field(gt=0, le=1)] = 0.5
    """Overlap over the smaller of two diameters that stops the run."""


class PlaneSection(Section):
    """A flat wall with the same contact law as the grains."""

    name: Name
    """Name of the plane; [[timeline]] can remove it by this name."""
    point: Point
    """A point on the plane."""
    normal: tuple[Number, Number, Number]
    """Direction from the plane towards the grains, of any length."""
    material: Name | None = None
    """Material of [materials]; that of [contact] when not given."""
