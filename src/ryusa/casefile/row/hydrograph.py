"""Discharge and level that change at the ends of a row: entries of [[timeline]], a hydrograph, a stage."""

import math
from collections.abc import Iterator

from ryusa.casefile.case import Case
from ryusa.casefile.row.ends import (
    HYDROGRAPH,
    STAGE,
    hydrograph_of,
    per_width,
    stage_of,
    width_of,
)
from ryusa.casefile.rows import ExplainRow, number, word
from ryusa.errors import CaseError
from ryusa.model.course import Course


def hydrograph_rows(case: Case) -> list[ExplainRow]:
    """Rows of the discharges and levels after the first."""
    rows = [
        number(
            "water", f"discharge from {one.at:g} s", per_width(case, one.discharge), "m2/s",
            f"timeline.{k}.discharge",
        )
        for k, one in enumerate(case.timeline)
        if one.discharge is not None
    ]  # fmt: skip
    rows += [
        number("water", f"level downstream from {one.at:g} s", one.level, "m", f"timeline.{k}.level")
        for k, one in enumerate(case.timeline)
        if one.level is not None
    ]
    if (course := hydrograph_of(case)) is not None:
        rows.append(_course(case.stop.time or math.inf, "hydrograph", course, "m2/s", HYDROGRAPH))
        volume = course.total(case.stop.time or 0.0) - course.total(0.0)
        rows.append(number("water", "water that enters", volume, "m2", f"per width; {HYDROGRAPH}"))
    if (course := stage_of(case)) is not None:
        rows.append(_course(case.stop.time or math.inf, "stage downstream", course, "m", STAGE))
    return rows


def _course(end: float, name: str, course: Course, unit: str, key: str) -> ExplainRow:
    """A course from its first point to its last."""
    text = f"{min(course.y):.4g} to {max(course.y):.4g} {unit}"
    late = f"; the run ends at {end:g} s" if end < course.t[-1] else ""
    early = f"; constant from {course.t[-1]:g} s on" if end > course.t[-1] else ""
    return word(
        "water", name, text,
        f"{key}: {len(course.t)} points from {course.t[0]:g} to {course.t[-1]:g} s, straight between"
        f"{late}{early}",
        "note" if late else "",
    )  # fmt: skip


def check_hydrograph(case: Case) -> Iterator[CaseError]:
    """Find discharges and levels of the timeline without the end they belong to, and those that are none."""
    keys = case.row
    below = None if keys is None else keys.downstream
    for k, one in enumerate(case.timeline):
        if one.level is not None and (below is None or below.end != "level"):
            allowed = "needs water.row.downstream with end = 'level'"
            yield CaseError(f"timeline.{k}.level", f"{one.level:g} m", allowed)
    end = None if keys is None else keys.upstream
    for k, one in enumerate(case.timeline):
        if one.discharge is None:
            continue
        key, (value, unit) = f"timeline.{k}.discharge", one.discharge
        shown = f"{value:g} {unit}"
        if keys is None:
            yield CaseError(key, shown, "needs [water.row]; a single column has motion.slope as its driver")
        elif end is None or end.end != "discharge":
            yield CaseError(key, shown, "needs water.row.upstream with end = 'discharge'")
        elif end.depth is not None:
            yield CaseError(
                "water.row.upstream.depth", end.depth, "would hold the depth at every discharge of the "
                "timeline: leave it out, and each enters as the flow asks",
            )  # fmt: skip
            return
        elif not value >= 0.0:
            yield CaseError(key, shown, "must be 0 or above, along +x")
        elif unit == "m3/s" and width_of(case) is None:
            yield CaseError("water.row.width", None, f"missing; {key} is a discharge of the whole width")
