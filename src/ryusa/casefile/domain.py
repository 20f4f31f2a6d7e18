"""[domain] and [[planes]]: periods, boundaries of the scene and flat walls."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from ryusa.casefile.builders.schema import FromFile, PackingSection
from ryusa.casefile.builders.table import key_of, period_of, table_of
from ryusa.casefile.builders.values import FEWEST_PERIODS, periodic
from ryusa.casefile.quantities import Name, Number, Point, PositiveLength
from ryusa.casefile.section import Section
from ryusa.errors import CaseError

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.derive import Derived


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


def check_planes(case: "Case") -> Iterator[CaseError]:
    """Find planes without a direction, across a period, or with a name used twice."""
    period = dict(zip("xy", periodic(case), strict=True))
    opened = "; build.periodic = false opens the ends" if isinstance(case.build, PackingSection) else ""
    for k, plane in enumerate(case.planes):
        key, normal = f"planes.{k}.normal", list(plane.normal)
        if not any(normal):
            yield CaseError(key, normal, "must not be zero")
        elif case.motion.plane and normal[1] != 0.0:
            yield CaseError(key, normal, "must have y = 0 in a plane scene")
        for axis, one in enumerate(period):
            if period[one] and normal[axis] != 0.0:
                yield CaseError(key, normal, f"must have {one} = 0, because {one} is periodic{opened}")
    names = [plane.name for plane in case.planes]
    for k, name in enumerate(names):
        if name in names[:k]:
            yield CaseError(f"planes.{k}.name", name, "is used twice")


def check_domain(case: "Case", derived: "Derived") -> Iterator[CaseError]:
    """Find periods that are too short or set by the builder, and corners in the wrong order."""
    least = FEWEST_PERIODS * derived.room
    from_file = isinstance(case.build, FromFile)
    periods = period_of(case) if from_file else (case.domain.period_x, case.domain.period_y)
    for key, period in zip(("period_x", "period_y"), periods, strict=True):
        given = getattr(case.domain, key)
        if period is not None and period < least:
            yield CaseError(
                f"domain.{key}", period, f"must be at least {FEWEST_PERIODS} largest diameters, {least:.4g} m"
            )
        if given is not None and not from_file:
            yield CaseError(
                f"domain.{key}",
                given,
                f"is set by builder '{case.build.kind}' itself; give it with builders 'table' and 'run' only",
            )
    if isinstance(case.build, FromFile):
        yield from _against_file(case)
    if case.motion.plane and case.domain.period_y is not None:
        yield CaseError("domain.period_y", case.domain.period_y, "has no effect in a plane scene")
    low, high = case.domain.low, case.domain.high
    if low is not None and high is not None and any(a >= b for a, b in zip(low, high, strict=True)):
        yield CaseError("domain.low", list(low), "must lie below domain.high in every direction")


def _against_file(case: "Case") -> Iterator[CaseError]:
    """Find periods that contradict those of the file."""
    table = table_of(case)
    if table is None or table.period is None:
        return
    for key, stated in zip(("period_x", "period_y"), table.period, strict=True):
        given = getattr(case.domain, key)
        if given is not None and not math.isclose(given, stated, rel_tol=1e-12):
            there = f"{stated:.12g} m" if math.isfinite(stated) else "open"
            yield CaseError(
                f"domain.{key}", given, f"differs from {table.name}, which is {there}; leave it out"
            )
    if case.motion.plane and math.isfinite(table.period[1]):
        yield CaseError(key_of(case), table.name, "is periodic in y, which a plane scene cannot be")
