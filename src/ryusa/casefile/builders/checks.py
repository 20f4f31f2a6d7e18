"""Checks of [build] that need more than one key."""

import math
from collections.abc import Iterator

from ryusa.casefile.builders.box import hole
from ryusa.casefile.builders.inside import enclosure_of
from ryusa.casefile.builders.schema import (
    BoxSection,
    DropSection,
    FillSection,
    FlumeSection,
    FromFile,
    PackingSection,
    SaltationSection,
    TableSection,
)
from ryusa.casefile.builders.table import key_of, made_of, period_of, table_of
from ryusa.casefile.builders.values import (
    FEWEST_PERIODS,
    bed_opening,
    counts,
    fill_box,
    fill_inside,
    fill_most,
    flume_count,
    periodic,
    room,
    sizes,
)
from ryusa.casefile.case import Case
from ryusa.casefile.column.bed import bed_thickness
from ryusa.casefile.facts import Derived
from ryusa.casefile.grading import grading_of, reference_diameter
from ryusa.casefile.grains.schema import spread_of
from ryusa.casefile.grains.values import graded
from ryusa.casefile.motion import may_rotate
from ryusa.casefile.section import given
from ryusa.errors import CaseError
from ryusa.model.enclosure import MeshInside
from ryusa.spelling import nearest_word

SHORTEST = 8  # largest diameters in a wave of the bed, so that its cosine is seen
_FOREIGN = ("lammps-dump", "lammps-data", "xyz")
_HAS = {  # key of a table: formats in which it has an effect
    "frame": ("csv", "lammps-dump", "xyz"),
    "length_unit": _FOREIGN,
    "time_unit": _FOREIGN,
    "fixed_types": ("lammps-dump", "lammps-data"),
}


def check_builder(case: Case) -> Iterator[CaseError]:
    """Find keys of the builder that are missing, have no effect or contradict other sections."""
    build = case.build
    _, ratio = spread_of(case.grains)
    if isinstance(build, (DropSection, SaltationSection)) and ratio > 0.0:
        yield CaseError("grains.spread", ratio, f"must be 0 for builder '{build.kind}'")
    if isinstance(build, DropSection):
        if build.height is None and build.speed == 0.0:
            yield CaseError("build.height", None, "missing; a drop needs height or speed")
        if build.spin != 0.0 and not may_rotate(case.motion, case.timeline):
            yield CaseError("build.spin", build.spin, "needs motion.rotation = 'free'")
        if abs(build.offset) >= reference_diameter(case):
            yield CaseError(
                "build.offset", build.offset, "must be smaller than the diameter, or the grains do not meet"
            )
        if build.offset != 0.0 and build.partner == "plane":
            yield CaseError("build.offset", build.offset, "has no effect with partner 'plane'")
    if isinstance(build, (DropSection, SaltationSection)) and not case.motion.plane:
        key = "copies" if isinstance(build, DropSection) else "starts"
        if (lanes := getattr(build, key)) > 1:
            yield CaseError(
                f"build.{key}",
                lanes,
                "needs motion.plane = true; in three dimensions grains of two lanes could meet",
            )
    if isinstance(build, PackingSection | BoxSection) and case.motion.plane and build.rows > 1:
        yield CaseError("build.rows", build.rows, "must be 1 in a plane scene")
    if isinstance(build, PackingSection | BoxSection) and periodic(case)[1] and build.rows < FEWEST_PERIODS:
        yield CaseError("build.rows", build.rows, f"must be at least {FEWEST_PERIODS}, because y is periodic")
    if isinstance(build, TableSection):
        for key, formats in _HAS.items():
            if given(build, key) and build.format not in formats:
                allowed = f"has no effect with format '{build.format}', only with {', '.join(formats)}"
                yield CaseError(f"build.{key}", getattr(build, key), allowed)
    if made_of(case.build):
        yield from _made_of(case)
    if isinstance(build, FlumeSection):
        yield from _flume(case, build)
    if isinstance(build, BoxSection):
        yield from _box(case, build)
    if isinstance(build, PackingSection | FlumeSection) and graded(case):
        yield from _bed(case)
    if isinstance(build, FillSection):
        yield from _fill(case, build)


def _made_of(case: Case) -> Iterator[CaseError]:
    table = table_of(case)
    assert table is not None
    there = sorted({one for one, fixed in zip(table.group, table.fixed, strict=True) if one and not fixed})
    for group in made_of(case.build):
        if group not in there:
            text = f"is no group of free grains of {table.name}, which has {', '.join(there) or 'none'}"
            yield CaseError(f"build.made_of.{group}", None, text, nearest_word(group, there))


def check_fill(case: Case) -> Iterator[CaseError]:
    """Find a builder 'fill' that does not say where its grains go; most checks need their number."""
    build = case.build
    if not isinstance(build, FillSection):
        return
    if build.inside is None:
        if build.low is None or build.high is None:
            key = "build.low" if build.low is None else "build.high"
            yield CaseError(key, None, "missing; give low and high, or inside with the name of a wall")
        return
    for key in ("low", "high"):
        if given(build, key):
            yield CaseError(f"build.{key}", None, "excludes build.inside; give only one of the two")
    if build.periodic:
        yield CaseError("build.periodic", True, "needs build.low and build.high, the period")
    if case.motion.plane:
        yield CaseError("build.inside", build.inside, "needs motion.plane = false, as [[walls]] do")
        return
    try:
        fill_inside(case, build)
    except CaseError as error:
        yield error


def _fill(case: Case, build: FillSection) -> Iterator[CaseError]:
    most = fill_most(case, build)
    if build.number is not None and build.most is not None:
        yield CaseError("build.number", build.number, "excludes build.most; give only one of the two")
    elif build.number is not None and 0 < most < build.number:
        what, where = ("box", "the box") if build.inside is None else ("wall", f"'{build.inside}'")
        yield CaseError(
            "build.number", build.number, f"do not fit: {where} holds {most:,}; ask for no more, or take "
            f"smaller grains, a smaller build.gap or a larger {what}"
        )  # fmt: skip
    if build.inside is not None:
        if most < 1:
            yield _empty(case, build)
        return
    low, high = fill_box(build)
    if any(a >= b for a, b in zip(low, high, strict=True)):
        yield CaseError("build.low", list(low), "must lie below build.high in every direction")
    elif counts(case)[0] < 1:
        least = sizes(case)[2] * (1.0 + build.gap)
        yield CaseError("build.high", list(high), f"holds no grain: a grain needs {least:.4g} m each way")
    if build.periodic and build.plate is not None:
        yield CaseError("build.plate", build.plate, "cannot be in a periodic box: a plate is round")
    for k, one in enumerate(periodic(case)):
        least = FEWEST_PERIODS * sizes(case)[2]
        if one and high[k] - low[k] < least:
            text = f"must be at least {least:.4g} m above build.low in {'xy'[k]}, which is periodic"
            yield CaseError("build.high", list(high), text)


def _empty(case: Case, build: FillSection) -> CaseError:
    """A wall that holds no grain, and why it may be."""
    enclosure, least = enclosure_of(case.folder, case.walls, build), room(case) * (1.0 + build.gap)
    across = " x ".join(f"{one:.3g}" for one in enclosure.high - enclosure.low)
    whole = ", the cell of a sieve curve as a whole" if graded(case) else ""
    text = (
        f"holds no grain: it is {across} m, and one needs {least:.4g} m each way{whole}; take smaller grains"
    )
    if isinstance(enclosure, MeshInside) and min(enclosure.high - enclosure.low) > least:
        text += (
            " or, where this is a vessel with thick walls, which are then what is inside, a mesh of its "
            "inner surface, or build.low and build.high"
        )
    return CaseError("build.inside", build.inside, text)


def _flume(case: Case, build: FlumeSection) -> Iterator[CaseError]:
    plane, (_, across), (_, _, largest) = case.motion.plane, periodic(case), sizes(case)
    if plane and build.width is not None:
        yield CaseError(
            "build.width", build.width, "has no effect in a plane scene; give motion.slab_width instead"
        )
    if not plane and build.width is None:
        yield CaseError("build.width", None, "missing; a flume in three dimensions needs a width")
    for key, value, least in (
        ("length", build.length, FEWEST_PERIODS * largest),
        ("width", build.width, FEWEST_PERIODS * largest if across else largest),
    ):
        if value is not None and value < least:
            yield CaseError(f"build.{key}", value, f"must be at least {least:.4g} m for grains of this size")
    if flume_count(case, build) < 1:
        yield CaseError("build.layers", build.layers, "gives no grain; take more layers or a longer flume")
    yield from _waves(case, build)


def _waves(case: Case, build: FlumeSection) -> Iterator[CaseError]:
    """Find waves without a height or a height without waves, too many of them, and troughs without grains."""
    if build.waves == 0 and build.wave_height == 0.0:
        return
    if build.wave_height == 0.0:
        yield CaseError("build.wave_height", None, "missing; waves of the bed need a height")
        return
    if build.waves == 0:
        yield CaseError("build.waves", None, "missing; give the number of waves along the length, such as 1")
        return
    largest = sizes(case)[2]
    if build.waves > (most := int(build.length / (SHORTEST * largest))):
        yield CaseError(
            "build.waves", build.waves, f"must be at most {most}: a wave must be {SHORTEST} grains long or "
            "longer"
        )  # fmt: skip
    if build.wave_height > (highest := 2.0 * (bed_thickness(case) - largest)):
        yield CaseError(
            "build.wave_height", build.wave_height, f"must be at most {max(highest, 0.0):.4g} m, so that one "
            "layer of grains is left in the troughs; take lower waves or more layers"
        )  # fmt: skip


def _bed(case: Case) -> Iterator[CaseError]:
    """Find a sieve curve whose finest grains fall through the bed of fixed grains."""
    finest, opening = sizes(case)[1], bed_opening(case)
    if finest > opening or any(plane.normal[2] > 0.0 for plane in case.planes):
        return
    yield CaseError(
        "grains.finest",
        case.grains.finest,
        f"the smallest grain, {finest:.3g} m, slips through openings of up to {opening:.2g} m between the "
        "fixed grains of the bed; give a larger finest, build.bed = 'plane', or a plane in [[planes]] under "
        "the bed",
    )


def _box(case: Case, build: BoxSection) -> Iterator[CaseError]:
    if build.floor == "plane":
        for key in ("run_out", "drop", "floor_height"):
            value = getattr(build, key)
            if value is not None and (key == "drop" or value > 0.0):
                yield CaseError(
                    f"build.{key}", value, "has no effect with floor 'plane', which is flat and unbounded"
                )
    d, d_min, _ = sizes(case)
    closer = "smaller spread" if grading_of(case) is None else "larger finest"
    if d_min <= (free := hole(build, case.motion.plane)) * d:
        yield CaseError(
            "grains.spread" if grading_of(case) is None else "grains.finest",
            None,
            f"the smallest grain, {d_min:.3g} m, slips through openings of up to {free:.2g} d between the "
            f"fixed grains of mean diameter; take a {closer} (or build.floor_height), or build.floor = "
            "'plane' and build.walls = 'planes'",
        )
    caught = build.drop is not None or any(plane.normal[2] > 0.0 for plane in case.planes)
    for number, change in enumerate(case.timeline):
        ends = build.floor == "grains" and (
            change.remove == "back" or (change.remove == "gate" and build.run_out == 0.0)
        )
        if not caught and (ends or change.remove == "floor"):
            ways = ["build.run_out (a longer floor)"] if change.remove == "gate" else []
            ways += ["build.drop (a plane that catches them)"] if build.floor == "grains" else []
            ways += ["build.floor = 'plane'"] if ends else []
            yield CaseError(
                f"timeline.{number}.remove",
                change.remove,
                f"lets grains fall beside the floor; give {', '.join([*ways, 'a plane in [[planes]]'])}",
            )


def check_domain(case: Case, derived: Derived) -> Iterator[CaseError]:
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


def _against_file(case: Case) -> Iterator[CaseError]:
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
        yield CaseError(key_of(case.build), table.name, "is periodic in y, which a plane scene cannot be")
