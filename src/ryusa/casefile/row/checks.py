"""Checks of a row of columns: keys that are missing or contradict others, and what a row cannot do yet."""

import math
from collections.abc import Iterator

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.column.schema import ColumnSection
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.motion import slope
from ryusa.casefile.row.end_checks import check_courses, check_ends
from ryusa.casefile.row.ends import discharge_of, levels_of, peak_discharge
from ryusa.casefile.row.nappe import check_air
from ryusa.casefile.row.reach import END
from ryusa.casefile.row.schema import RowDamSection, RowSection
from ryusa.casefile.row.stream_checks import check_places, check_stream
from ryusa.casefile.row.values import (
    MOST_CELLS,
    RowPlan,
    bed_over,
    bottom_points,
    crest_of,
    dam_at_inlet,
    dam_span,
    deepest,
    enters_fast,
    inlet_depth,
    line_points,
    not_downstream,
    reaches,
    row_plan,
    stream,
    water_alone,
)
from ryusa.casefile.section import given
from ryusa.casefile.water.schema import WaterSection
from ryusa.errors import CaseError
from ryusa.laws.families import Pressure
from ryusa.model.row import STEEPEST

MOST_SEGMENTS = 100_000
_FORMS = (
    "must be 'stress' in a row: with a sloping surface 'weight' counts the pressure twice, and with "
    "'pressure' still water would move"
)


def check_row(case: Case) -> Iterator[CaseError]:
    """Find faults of a row of columns."""
    keys, water = case.row, case.water
    if keys is None or water is None:
        return
    if water.profile != "column":
        return  # reported as a key without effect
    feeder = keys.upstream is not None and keys.upstream.end == END
    if feeder and keys.pressure == Pressure.FULL.word:
        yield CaseError(
            "water.row.pressure", keys.pressure, f"knows nothing of grains that enter by end = '{END}'; "
            f"take '{Pressure.HYDROSTATIC.word}', or [[feeds]] of grains that fall in",
        )  # fmt: skip
    if stream(case):
        found = [*check_stream(case, keys), *_ending(case), *_water(water), *_driver(case.column)]
    elif water_alone(case):
        found = [*_grains(case), *_ending(case), *_water(water), *_column(case.column)]
    else:
        yield from _among_grains(case, keys)
        return
    found += [*_lines(case, keys, water), *check_ends(case, keys), *check_courses(case)]
    found = found or [*_shape(case, keys)]
    yield from found
    if not found and stream(case):
        yield from check_places(case, keys)


def _among_grains(case: Case, keys: RowSection) -> Iterator[CaseError]:
    """Grains go in a periodic row over a level bottom, with the depth over their bed as in one column."""
    water, column, kind = case.water, case.column, case.build.kind
    assert water is not None
    for name, what in (("feeds", case.feeds), ("exits", case.exits)):
        if what:
            yield CaseError(
                name, None, "grains enter and leave a row of columns with build.kind = 'stream' alone; leave "
                "it out of a row in a period",
            )  # fmt: skip
    for name in ("upstream", "downstream", "surface", "height", "dams"):
        if getattr(keys, name):
            yield CaseError(
                f"water.row.{name}", None, f"has no place in a row with grains of builder '{kind}', "
                "which is periodic and has the depth water.depth over their bed as one column; leave it out, "
                "or take build.kind = 'stream'",
            )  # fmt: skip
    if water.buoyancy != "stress":
        yield CaseError("water.buoyancy", water.buoyancy, _FORMS)
    if column.surface == "depth":
        yield CaseError("water.column.surface", "depth", "must be 'volume' in a row, or left out")
    if column.drive not in {"slope", "pressure gradient"}:
        yield CaseError("water.column.drive", column.drive, "must be 'slope' or 'pressure gradient' in a row")
    lines = [*_lines(case, keys, water)]
    yield from lines
    if not lines and any(z != 0.0 for _, z in bottom_points(case)):
        yield CaseError(
            "water.row.bottom", None, f"must lie at z = 0 with grains of builder '{kind}', the "
            "axis along which they lie; the slope is motion.slope",
        )  # fmt: skip


def _grains(case: Case) -> Iterator[CaseError]:
    """Things that act on grains alone."""
    if getattr(case.build, "plate", None) is not None:
        yield CaseError("build.plate", case.build.plate, "fixed grains do not act on a row of columns yet")  # pyright: ignore[reportAttributeAccessIssue]
    for k, _ in enumerate(case.walls):
        yield CaseError(
            f"walls.{k}",
            None,
            "does not act on a row of columns; what stands in the water is [[water.row.dams]]",
        )
        break
    for k, change in enumerate(case.timeline):
        if all(one is None for one in (change.slope, change.slope_angle, change.discharge, change.level)):
            yield CaseError(
                f"timeline.{k}", None,
                "a row without grains takes changes of slope, discharge and level alone",
            )  # fmt: skip


def _ending(case: Case) -> Iterator[CaseError]:
    """A row with ends runs for a time, and water needs gravity."""
    if case.stop.time is None:
        yield CaseError("stop.time", None, "missing; a row of columns ends at a time")
    if case.motion.gravity <= 0.0:
        yield CaseError("motion.gravity", case.motion.gravity, "must be above 0: a row has a free surface")


def _water(water: WaterSection) -> Iterator[CaseError]:
    """Keys of [water] that mean something else in a row, or nothing."""
    for key in ("tau_star", "u_star"):
        if getattr(water, key) is not None:
            yield CaseError(
                f"water.{key}",
                getattr(water, key),
                "has no effect in a row: the stress follows from slope, bottom and discharge; leave it out",
            )
    if water.zero is not None:
        yield CaseError(
            "water.zero", water.zero, "has no effect in a row, whose depth is measured from its bottom"
        )
    if water.depth is None and water.row is not None and water.row.surface is None:
        yield CaseError(
            "water.depth",
            None,
            "missing; a row needs the depth at the start, or its surface (water.row.surface)",
        )
    if water.depth is not None and water.row is not None and water.row.surface is not None:
        yield CaseError("water.depth", water.depth, "excludes water.row.surface; give only one of the two")
    if water.buoyancy != "stress":
        yield CaseError("water.buoyancy", water.buoyancy, _FORMS)


def _column(keys: ColumnSection) -> Iterator[CaseError]:
    """Keys of [water.column] that a row does not take."""
    if keys.bed == "moving":
        yield CaseError(
            "water.column.bed",
            "moving" if given(keys, "bed") else None,
            "must be 'rough' or 'smooth' in a row without grains",
        )
    yield from _driver(keys)
    if keys.fluctuations != "none":
        yield CaseError(
            "water.column.fluctuations", keys.fluctuations, "must be 'none' in a row without grains"
        )
    if given(keys, "interval"):
        yield CaseError(
            "water.column.interval", keys.interval, "has no effect without grains: the water moves each step"
        )


def _driver(keys: ColumnSection) -> Iterator[CaseError]:
    """Drivers, bottom and start that have no meaning where the flow follows from bottom and ends."""
    if keys.surface == "depth":
        yield CaseError("water.column.surface", "depth", "must be 'volume' in a row, or left out")
    if keys.drive not in {"slope", "pressure gradient"}:
        yield CaseError(
            "water.column.drive",
            keys.drive,
            "has no meaning in a row, whose flow has no gradient of its own: take 'slope', and give the "
            "discharge as water.row.upstream = { end = 'discharge', discharge = ... }",
        )
    if keys.discharge is not None:
        yield CaseError(
            "water.column.discharge", keys.discharge, "is given as water.row.upstream.discharge in a row"
        )
    if keys.drive == "pressure gradient" and keys.pressure_gradient is None:
        yield CaseError("water.column.pressure_gradient", None, "missing; drive 'pressure gradient' needs it")
    if keys.bottom is not None:
        yield CaseError("water.column.bottom", keys.bottom, "is given as water.row.bottom in a row")
    if keys.start == "steady":
        yield CaseError(
            "water.column.start", "steady", "must be 'rest' in a row: it finds its flow in the run itself"
        )
    if given(keys, "side_friction") and keys.side_walls is None:
        yield CaseError("water.column.side_friction", keys.side_friction, "needs water.column.side_walls")


def _lines(case: Case, keys: RowSection, water: WaterSection) -> Iterator[CaseError]:
    """Points of bottom and surface in their order, and a division into segments."""
    lines = [("bottom", keys.bottom)] + ([] if keys.surface is None else [("surface", keys.surface)])
    for name, one in lines:
        key = f"water.row.{name}"
        try:
            points = line_points(case.folder, key, one)
        except CaseError as error:
            yield error
            return
        if len(points) < 2:
            yield CaseError(key, None, "needs at least two points")
            return
        if fault := not_downstream(points, strictly=name == "bottom"):
            more = "; a step of the bottom is one of water.row.dams" if name == "bottom" else ""
            yield CaseError(key, None, f"{fault}{more}")
            return
    if keys.surface is not None:
        low, high = bottom_points(case)[0][0], bottom_points(case)[-1][0]
        points = line_points(case.folder, "water.row.surface", keys.surface)
        if points[0][0] > low or points[-1][0] < high:
            yield CaseError(
                "water.row.surface", None, f"reaches from x = {points[0][0]:g} to {points[-1][0]:g} m; must "
                f"reach over the bottom, from {low:g} to {high:g} m",
            )  # fmt: skip
    if (keys.segments is None) == (keys.segment is None):
        what = (
            "missing; give" if keys.segments is None else "excludes water.row.segment; give one of the two:"
        )
        yield CaseError(
            "water.row.segments", keys.segments, f"{what} the number of segments, or their length (segment)"
        )
        return
    length = bottom_points(case)[-1][0] - bottom_points(case)[0][0]
    if keys.segment is not None and not length / MOST_SEGMENTS <= keys.segment <= length:
        yield CaseError(
            "water.row.segment", keys.segment, f"must be at most the length of the row, {length:g} m, and "
            f"give at most {MOST_SEGMENTS:,} segments",
        )  # fmt: skip


def _shape(case: Case, keys: RowSection) -> Iterator[CaseError]:
    """What only the divided row shows: slopes, cells, dams, depths."""
    points = np.array(bottom_points(case))
    angles = np.arctan2(np.diff(points[:, 1]), np.diff(points[:, 0]))
    k = int(np.argmax(np.abs(angles)))
    if abs(angles[k]) > STEEPEST:
        yield CaseError(
            "water.row.bottom", None, f"is inclined to the x axis by {abs(math.degrees(angles[k])):.1f} deg "
            f"from x = {points[k, 0]:g} to {points[k + 1, 0]:g} m; must be at most "
            f"{math.degrees(STEEPEST):g} deg: turn the axis with motion.slope, as between two reaches of a "
            "flume, or make a step with [[water.row.dams]]",
        )  # fmt: skip
        return
    plan, column = row_plan(case), case.column
    rough = case.water.roughness or reference_diameter(case) if case.water is not None else math.nan
    if plan.n * plan.n_cell > MOST_CELLS:
        yield CaseError(
            "water.column.cell", column.cell, f"{plan.n:,} segments of {plan.n_cell:,} cells are more than "
            f"{MOST_CELLS:,}: take thicker cells, fewer segments or a lower water.row.height",
        )  # fmt: skip
    if column.bed == "rough" and plan.cell <= rough / 15.0:
        yield CaseError(
            "water.column.cell", column.cell, f"{plan.cell:.3g} m must be above 1/15 of the roughness, "
            f"{rough / 15.0:.3g} m, because Eq. (9) is zero below 1/30",
        )  # fmt: skip
    dams = [*_dams(plan, keys)]
    yield from dams or check_air(case, plan, keys)
    yield from _depths(case, plan, keys)


def _dams(plan: RowPlan, keys: RowSection) -> Iterator[CaseError]:
    """Dams that are in the row, one segment thick at least, below the top of the cells."""
    names = [one.name for one in keys.dams]
    taken: dict[int, str] = {}
    for k, dam in enumerate(keys.dams):
        key = f"water.row.dams.{k}"
        if dam.name in names[:k]:
            yield CaseError(f"{key}.name", dam.name, "is used twice")
        if (dam.crest is None) == (dam.height is None):
            yield CaseError(
                f"{key}.crest", dam.crest, "needs the height of its crest: exactly one of crest and height"
            )
            return
        if dam.diameter is not None and dam.concentration is None:
            yield CaseError(
                f"{key}.diameter", dam.diameter, "has no effect without concentration: the dam is impermeable"
            )
        for name, at in (("begin", dam.begin), ("end", dam.end)):
            if not plan.x_low - 1e-9 <= at <= plan.x_low + plan.n * plan.dx + 1e-9:
                last = plan.x_low + plan.n * plan.dx
                yield CaseError(f"{key}.{name}", at, f"must lie in the row, {plan.x_low:g} to {last:g} m")
        if not dam.begin < dam.end:
            yield CaseError(f"{key}.end", dam.end, f"must lie downstream of its begin, {dam.begin:g} m")
            return
        first, end = dam_span(plan, dam)
        if first == end:
            yield CaseError(
                f"{key}.begin", dam.begin, f"from {dam.begin:g} to {dam.end:g} m lies no middle of a "
                f"segment; a dam is at least one segment thick ({plan.dx:.4g} m), because a thin plate would "
                "let through far more than it does. Take a shorter water.row.segment",
            )  # fmt: skip
            return
        yield from _dam(plan, dam, key, first, end)
        for i in range(first, end):
            if taken.setdefault(i, dam.name) != dam.name:
                yield CaseError(
                    f"{key}.begin", dam.begin, f"lies in dam '{taken[i]}'; dams stand side by side"
                )
                return


def _dam(plan: RowPlan, dam: RowDamSection, key: str, first: int, end: int) -> Iterator[CaseError]:
    over = crest_of(plan, dam) - plan.bottom[first:end]
    at = f"{key}.crest" if dam.crest is not None else f"{key}.height"
    shown = dam.crest if dam.crest is not None else dam.height
    if over.min() < 0.5 * plan.cell:
        yield CaseError(
            at, shown, f"must rise at least half a cell, {0.5 * plan.cell:.3g} m, above the bottom"
        )
    elif over.max() >= (plan.n_cell - 1) * plan.cell:
        yield CaseError(
            at, shown, f"must stay below the top of the cells, {plan.n_cell * plan.cell:.4g} m over the "
            "bottom; raise water.row.height",
        )  # fmt: skip


def _depths(case: Case, plan: RowPlan, keys: RowSection) -> Iterator[CaseError]:
    """Water at the start within the cells, and a row that is not dry for ever."""
    high = plan.n_cell * plan.cell
    depth = plan.start - plan.bottom
    if keys.height is not None and depth.max() > high * (1.0 + 1e-12):
        yield CaseError(
            "water.row.height", keys.height, f"must be at least the depth at the start, {depth.max():.4g} m"
        )
    elif keys.height is not None and deepest(case, plan) > high:
        yield CaseError(
            "water.row.height", keys.height, f"must be at least {deepest(case, plan):.4g} m, the depth to be "
            "expected (at the start, of normal flow on the bed, behind dams, below a level)",
        )  # fmt: skip
    wet = any(levels_of(case, one) for one in (keys.upstream, keys.downstream) if one is not None)
    if depth.max() <= 0.0 and not wet and not peak_discharge(case) > 0.0:
        yield CaseError(
            "water.row.surface", None, "lies below the bottom everywhere, and no water enters: the row would "
            "stay dry",
        )  # fmt: skip
    yield from _inlet(case, plan, keys)
    largest = float(np.abs(np.arctan(np.diff(plan.bottom) / plan.dx)).max(initial=0.0))
    if abs(slope(case.motion)) + largest > math.radians(60.0):
        yield CaseError(
            "motion.slope", case.motion.slope, "is too steep for water in layers: at most 60 deg in all"
        )


def _inlet(case: Case, plan: RowPlan, keys: RowSection) -> Iterator[CaseError]:
    """A dry first segment gives no depth to an inlet that has none itself, and no bed or dam below it."""
    end, q = keys.upstream, discharge_of(case)
    if end is None or not q > 0.0 or inlet_depth(case) is not None or plan.start[0] > plan.bottom[0]:
        return
    over_bed = bed_over(case, plan.x)[0] >= reference_diameter(case)
    if over_bed or dam_at_inlet(case, plan) > 0.0 or enters_fast(case, q):
        return
    why = "normal flow is not supercritical there"
    if reaches(case, q)[0].froude > 1.0:
        why = f"normal depth is less than a cell of {plan.cell:.3g} m"
    yield CaseError(
        "water.row.upstream.depth", None, f"missing; the first segment is dry at the start and {why}, so "
        "that the water that enters has no depth: give it, or water in the first segment at the start "
        "(water.depth or water.row.surface)",
    )  # fmt: skip
