"""Checks of a row of columns with ends and grains: what builder "stream" needs, and where grains could go."""

import math
from collections.abc import Iterator
from itertools import product

import numpy as np

from ryusa.casefile.builders.schema import BedOfRunSection, StreamSection
from ryusa.casefile.builders.table import table_of
from ryusa.casefile.builders.values import FEWEST_PERIODS, built_counts, sizes
from ryusa.casefile.case import Case
from ryusa.casefile.column.schema import ColumnSection
from ryusa.casefile.feeds.schema import ExitSection
from ryusa.casefile.feeds.values import corners_of
from ryusa.casefile.row.ends import width_of
from ryusa.casefile.row.reach_source import fed_by_reach
from ryusa.casefile.row.schema import RowSection
from ryusa.casefile.row.values import (
    Points,
    bottom_points,
    crest_of,
    dam_span,
    line_points,
    not_downstream,
    row_plan,
    stream_span,
    walls_of_stream,
)
from ryusa.casefile.section import given
from ryusa.errors import CaseError
from ryusa.laws.families import Mixing
from ryusa.model.arrays import Floats
from ryusa.model.column import AGREE

CLOSE = 1.0e-9  # beyond a bound only by rounding [m]
NAMES = ("bottom", "upstream", "downstream", "right", "left", "grains", "bed")  # taken by builder "stream"


def check_stream(case: Case, keys: RowSection) -> Iterator[CaseError]:
    """Find what is missing before a row can be divided, with keys that mean nothing in a stream."""
    build = case.build
    assert isinstance(build, StreamSection)
    if case.motion.plane:
        yield CaseError(
            "motion.plane", True, "must be false with builder 'stream', whose bottom and dams are walls in "
            "three dimensions; a narrow stream with build.walls = false is nearest to a plane",
        )  # fmt: skip
    if isinstance(build.bed, BedOfRunSection):
        yield from _bed_of_run(case, build, build.bed)
    elif not isinstance(build.bed, float | int):
        yield from _bed(case, build.bed)
    for name in ("upstream", "downstream"):
        if getattr(keys, name) is None:
            yield CaseError(f"water.row.{name}", None, "missing; builder 'stream' has two ends")
    width = width_of(case)
    least = sizes(case)[2] * (1.0 if build.walls else FEWEST_PERIODS)
    if width is None or width < least:
        what = "missing; builder 'stream' needs it, and it " if width is None else ""
        yield CaseError("water.row.width", width, f"{what}must be at least {least:.4g} m for these grains")
    yield from _column(case.column, width)
    yield from _names(case, keys)


def _bed(case: Case, line: Points | str) -> Iterator[CaseError]:
    """Find points of the thickness of the bed that do not follow one another, or lie below the bottom."""
    try:
        points = line_points(case.folder, "build.bed", line)
    except CaseError as error:
        yield error
        return
    if fault := not_downstream(points):
        yield CaseError("build.bed", None, fault)
    for k, (_, thick) in enumerate(points):
        if thick < 0.0:
            yield CaseError("build.bed", f"{thick:g} m", f"point {k + 1} must have a thickness of at least 0")
    low, high = bottom_points(case)[0][0], bottom_points(case)[-1][0]
    for k, what in ((0, "begin"), (-1, "end")):
        if getattr(case.build, what) is None and not low <= points[k][0] <= high:
            yield CaseError(
                "build.bed", f"x = {points[k][0]:g} m", f"must {what} in the row, from {low:g} to "
                f"{high:g} m, or give build.{what}",
            )  # fmt: skip


def _bed_of_run(case: Case, build: StreamSection, bed: BedOfRunSection) -> Iterator[CaseError]:
    """Find a run whose grains this stream cannot hold, or that are others, and keys without effect."""
    for name in ("begin", "end", "gap", "jitter"):
        if given(build, name):
            yield CaseError(f"build.{name}", getattr(build, name), "has no effect on the bed of a run")
    if case.grains.mixture:
        yield CaseError(
            "grains.mixture", None, "has no effect on the bed of a run, whose grains are of [grains]"
        )
    try:
        table = table_of(case)
    except CaseError as error:
        yield error
        return
    assert table is not None
    key = "build.bed.run"
    if table.fixed.any() or not table.n:
        what = "fixed grains" if table.n else "no grain"
        yield CaseError(key, bed.run, f"holds {what}; must be a run of builder 'stream' with a bed")
        return
    low, high = bottom_points(case)[0][0], bottom_points(case)[-1][0]
    x, y, d = (table.column(name) for name in ("x", "y", "d"))
    if x.min() < low or x.max() > high:
        yield CaseError(
            key, bed.run, f"has grains from x = {x.min():.4g} to {x.max():.4g} m; must lie in the row, from "
            f"{low:g} to {high:g} m",
        )  # fmt: skip
    width, across = width_of(case), math.inf if table.period is None else table.period[1]
    if table.period is not None and width is not None:
        if math.isfinite(across) == build.walls:
            kind = "periodic across" if math.isfinite(across) else "between side walls"
            yield CaseError(key, bed.run, f"is {kind}; build.walls must be {str(not build.walls).lower()}")
        elif not build.walls and not math.isclose(across, width, rel_tol=AGREE):
            yield CaseError(key, bed.run, f"is {across:g} m wide; water.row.width must be the same")
    if width is not None and build.walls and (y.min() < 0.0 or y.max() > width):
        yield CaseError(key, bed.run, f"has grains up to y = {y.max():g} m; water.row.width is {width:g} m")
    if "m" in table.columns:
        density = float(table.column("m").sum() / (math.pi / 6.0 * d**3).sum())
        if not math.isclose(density, case.grains.density, rel_tol=1.0e-6):
            yield CaseError(
                key, bed.run, f"has grains of {density:.6g} kg/m3; grains.density must be the same"
            )


def _column(keys: ColumnSection, width: float | None) -> Iterator[CaseError]:
    if keys.bed == "moving":
        yield CaseError(
            "water.column.bed", None if "bed" not in keys.model_fields_set else "moving",
            "must be 'rough' or 'smooth' in a stream, the rigid bottom where no grains lie",
        )  # fmt: skip
    law = None if keys.mixing_length is None else Mixing.of(keys.mixing_length)
    if law not in (None, Mixing.LAMINAR) and "grains" not in law.marks:
        yield CaseError(
            "water.column.mixing_length", keys.mixing_length, "counts from the rigid bottom, through any "
            "deposit; must be 'Li-Sawamoto', 'shear layer' or 'none' in a stream, or left out",
        )  # fmt: skip
    if keys.side_walls is not None and width is not None and keys.side_walls < (1.0 - AGREE) * width:
        yield CaseError(
            "water.column.side_walls", keys.side_walls, f"must be at least water.row.width, {width:g} m"
        )


def _names(case: Case, keys: RowSection) -> Iterator[CaseError]:
    """Names of dams, which are walls for the grains, and of what the builder makes are used once."""
    others = (*case.walls, *case.planes, *case.feeds, *case.exits)
    taken = {*NAMES, *(one.name for one in others)}
    for k, dam in enumerate(keys.dams):
        if dam.name in taken:
            yield CaseError(f"water.row.dams.{k}.name", dam.name, "is used twice; builder 'stream' takes "
                            f"{', '.join(NAMES)} itself")  # fmt: skip
    for kind, entries in (("walls", case.walls), ("planes", case.planes), ("feeds", case.feeds),
                          ("exits", case.exits)):  # fmt: skip
        for k, one in enumerate(entries):
            if one.name in NAMES:
                yield CaseError(f"{kind}.{k}.name", one.name, "is a name that builder 'stream' gives itself")
    own = {*NAMES[:3], *walls_of_stream(case)}
    for k, entry in enumerate(case.timeline):
        if entry.remove in own:
            yield CaseError(
                f"timeline.{k}.remove", entry.remove, "cannot be removed: it is one for grains and water"
            )


def check_places(case: Case, keys: RowSection) -> Iterator[CaseError]:
    """Find a bed outside the row or without a grain, feeds outside it, and ends that lose grains."""
    build = case.build
    assert isinstance(build, StreamSection)
    low, high = bottom_points(case)[0][0], bottom_points(case)[-1][0]
    begin, end = stream_span(case)
    fed = fed_by_reach(case.row) or any(feed.brings for feed in case.feeds)
    if build.bed == 0.0 and not fed:
        yield CaseError(
            "build.bed", None, "gives no grain, and no feed brings one: give a thickness, or [[feeds]]"
        )
    for name in ("begin", "end"):
        value = getattr(build, name)
        if value is not None and not low <= value <= high:
            yield CaseError(f"build.{name}", value, f"must lie in the row, from {low:g} to {high:g} m")
    if not begin < end:
        yield CaseError("build.begin", build.begin, f"must lie before the end of the bed, {end:g} m")
        return
    if build.bed != 0.0 and built_counts(case)[0] < 1:
        shown = build.bed if isinstance(build.bed, float | int) else None
        yield CaseError("build.bed", shown, "gives no grain: take a thicker or longer bed")
    for k, feed in enumerate(case.feeds):
        if feed.moves_with is None and (corners := corners_of(feed)) is not None:
            yield from _feed(case, keys, f"feeds.{k}", feed.name, *corners)
    if keys.downstream is not None and keys.downstream.end != "wall":
        yield from _outlet(case, high)


def _feed(
    case: Case, keys: RowSection, key: str, name: str, low: Floats, high: Floats
) -> Iterator[CaseError]:
    """Find a feed with its corners [m] beyond the row or its side walls, below the bottom, or in a dam."""
    points, width, build = bottom_points(case), width_of(case), case.build
    begin, end = points[0][0], points[-1][0]
    if low[0] < begin - CLOSE or high[0] > end + CLOSE:
        yield CaseError(key, name, f"must lie in the row, from x = {begin:g} to {end:g} m")
        return
    assert isinstance(build, StreamSection)
    if width is not None and build.walls and (low[1] < -CLOSE or high[1] > width + CLOSE):
        yield CaseError(key, name, f"must lie between the side walls, y = 0 and {width:g} m")
    x, z = np.array(points).T
    inner = z[(x > low[0]) & (x < high[0])].tolist()
    floor = max([*np.interp([low[0], high[0]], x, z).tolist(), *inner])
    if low[2] < floor - CLOSE:
        yield CaseError(key, name, f"reaches below the bottom, which is as high as z = {floor:g} m there")
    plan = row_plan(case)
    for dam in keys.dams:
        first, last = (plan.x_low + i * plan.dx for i in dam_span(plan, dam))
        crest = crest_of(plan, dam)
        if low[0] < last - CLOSE and high[0] > first + CLOSE and low[2] < crest - CLOSE:
            yield CaseError(
                key, name, f"lies in the dam '{dam.name}', which stands from x = {first:g} to {last:g} m and "
                f"up to z = {crest:g} m",
            )  # fmt: skip


def _outlet(case: Case, high: float) -> Iterator[CaseError]:
    """All that passes the lower end must leave through an exit."""
    if any(one.low is None and (one.point is None or not any(one.normal or ())) for one in case.exits):
        return  # reported with the exit
    plan, wide = row_plan(case), width_of(case) or 0.0
    step, floor = 1.0e-6 * plan.dx, bottom_points(case)[-1][1]
    heights = np.linspace(floor, floor + plan.n_cell * plan.cell, 9)
    for y, z in product(np.linspace(0.01, 0.99, 5) * wide, heights):
        if not any(_beyond(one, (high + step, float(y), float(z))) for one in case.exits):
            yield CaseError(
                "exits", None, f"none takes grains at x = {high:g} m, the lower end of the row, at y = "
                f"{y:.3g} and z = {z:.3g} m, where they would leave the water: give one, such as name = "
                f"'outlet', point = ['{high:g} m', '0 m', '0 m'], normal = [1, 0, 0]",
            )  # fmt: skip
            return


def _beyond(one: ExitSection, x: tuple[float, float, float]) -> bool:
    """Whether a point [m] is beyond an exit that stays where it is."""
    if one.moves_with is not None:
        return False
    if one.point is not None and one.normal is not None:
        return sum(n * (a - b) for n, a, b in zip(one.normal, x, one.point, strict=True)) > 0.0
    if one.low is None or one.high is None:
        return False
    return all(a <= b <= c for a, b, c in zip(one.low, x, one.high, strict=True))
