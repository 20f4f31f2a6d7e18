"""What enters a row upstream and what lies beyond its ends: discharge and level, constant or over time."""

import math
from pathlib import Path
from typing import Any

from ryusa.casefile.case import Case
from ryusa.casefile.course import Points, points_of
from ryusa.casefile.row.reach_source import reach_of
from ryusa.casefile.row.schema import Discharge, RowEndSection, RowSection, read_discharge
from ryusa.model.course import Course
from ryusa.units import quantity

HYDROGRAPH, STAGE = "water.row.upstream.hydrograph", "water.row.downstream.stage"


def discharge_of(case: Case) -> float:
    """Discharge per width that enters upstream [m2/s]; nan where none is given."""
    if (reach := reach_of(case)) is not None:
        return reach.discharge
    end = keys_of_row(case).upstream
    if (course := hydrograph_of(case)) is not None:
        return course.at(0.0)
    if end is None or end.discharge is None:
        return math.nan
    return per_width(case, end.discharge)


def hydrograph_of(case: Case) -> Course | None:
    """Discharge per width over time [m2/s] that enters upstream; None where none is given."""
    end = keys_of_row(case).upstream
    if end is None or end.hydrograph is None:
        return None
    points = hydrograph_points(case.folder, end.hydrograph)
    return Course(tuple(t for t, _ in points), tuple(per_width(case, q) for _, q in points))


def hydrograph_points(folder: Path, given: Any) -> Points:
    """Points of a hydrograph as given, or as its file holds them."""
    return points_of(folder, HYDROGRAPH, given, "q", read_discharge, "'t [s],q [m3/s]'")


def stage_of(case: Case) -> Course | None:
    """Height of the surface beyond the lower end over time [m]; None where none is given."""
    end = keys_of_row(case).downstream
    if end is None or end.stage is None:
        return None
    return Course(*map(tuple, zip(*stage_points(case.folder, end.stage), strict=True)))  # pyright: ignore[reportArgumentType]


def stage_points(folder: Path, given: Any) -> Points:
    """Points of a stage as given, or as its file holds them."""
    return points_of(folder, STAGE, given, "z", _metres, "'t [s],z [m]'")


def _metres(value: str) -> float:
    return quantity(value, "m")


def levels_of(case: Case, end: RowEndSection) -> list[float]:
    """Heights of the surface beyond an end during a run [m], that of the start first; none elsewhere."""
    row, first = keys_of_row(case), [] if end.level is None else [end.level]
    if end is not row.downstream:
        return first
    if (course := stage_of(case)) is not None:
        first = [course.at(0.0), *course.extremes(0.0, case.stop.time or math.inf)]
    return first + [one.level for one in case.timeline if one.level is not None]


def per_width(case: Case, discharge: Discharge) -> float:
    """A discharge per width [m2/s]; nan for one of the whole width where that is not given."""
    value, unit = discharge
    if unit == "m2/s":
        return value
    width = width_of(case)
    return math.nan if width is None else value / width


def peak_discharge(case: Case) -> float:
    """Largest discharge per width that enters upstream during the run [m2/s]; nan where none is given."""
    return max(_discharges(case))


def least_discharge(case: Case) -> float:
    """Smallest discharge per width that enters upstream during the run [m2/s]; nan where none is given."""
    return min(_discharges(case))


def _discharges(case: Case) -> list[float]:
    if (course := hydrograph_of(case)) is not None:
        return [*course.extremes(0.0, case.stop.time or math.inf)]
    steps = [per_width(case, one.discharge) for one in case.timeline if one.discharge is not None]
    return [discharge_of(case), *steps]


def width_of(case: Case) -> float | None:
    """Width of the stream [m]; None if not given."""
    return keys_of_row(case).width or case.column.side_walls


def keys_of_row(case: Case) -> RowSection:
    """Keys of [water.row] of a case that has one."""
    keys = case.row
    assert keys is not None
    return keys
