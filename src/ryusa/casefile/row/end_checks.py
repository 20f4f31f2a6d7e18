"""Checks of the ends of a row: keys that are missing or have no effect, and courses that cannot be."""

from collections.abc import Iterable, Iterator
from typing import Any

from ryusa.casefile.case import Case
from ryusa.casefile.course import faults_of_course
from ryusa.casefile.row.ends import (
    HYDROGRAPH,
    STAGE,
    hydrograph_points,
    peak_discharge,
    stage_points,
    width_of,
)
from ryusa.casefile.row.reach import END
from ryusa.casefile.row.schema import RowEndSection, RowSection
from ryusa.casefile.row.values import bottom_points
from ryusa.casefile.section import given
from ryusa.errors import CaseError

_NEEDS = {"level": ("level", "stage"), "discharge": ("discharge", "hydrograph")}  # one of them
_TAKES = {
    "level": ("level", "stage"), "discharge": ("discharge", "hydrograph", "depth", "profile"),
}  # fmt: skip
_OTHER_END = "give [water.row.{}] with end = 'wall', 'level', 'free fall' or 'same depth'"


def check_ends(case: Case, keys: RowSection) -> Iterator[CaseError]:
    """Each end with what it needs, and both or none."""
    ends = {"upstream": keys.upstream, "downstream": keys.downstream}
    for name, end in ends.items():
        other = next(one for one in ends if one != name)
        if end is None and ends[other] is not None:
            yield CaseError(
                f"water.row.{name}", None, f"missing; a row has two ends, or none and is periodic: "
                f"{_OTHER_END.format(name)}",
            )  # fmt: skip
        if end is not None:
            yield from _end(case, name, end)
    if keys.upstream is None and keys.downstream is None:
        first, last = bottom_points(case)[0][1], bottom_points(case)[-1][1]
        if first != last:
            yield CaseError(
                "water.row.bottom", None, f"ends at z = {last:g} m and begins at {first:g} m, but a row "
                "without ends is periodic: give [water.row.upstream] and [water.row.downstream], or the "
                "slope as motion.slope",
            )  # fmt: skip


def _end(case: Case, name: str, end: RowEndSection) -> Iterator[CaseError]:
    key = f"water.row.{name}"
    if end.end in {"discharge", END} and name == "downstream":
        yield CaseError(
            f"{key}.end", end.end, f"can only be given upstream; {_OTHER_END.format('downstream')}"
        )
        return
    needs = _NEEDS.get(end.end, ())
    if needs and all(getattr(end, one) is None for one in needs):
        yield CaseError(f"{key}.{needs[0]}", None, f"missing; end '{end.end}' needs it, or {needs[1]}")
    if name == "upstream" and end.stage is not None:
        yield CaseError(f"{key}.stage", None, "can only be given downstream")
    for one in ("level", "stage", "discharge", "hydrograph", "depth", "profile"):
        if one not in _TAKES.get(end.end, ()) and given(end, one):
            shown = None if one in ("stage", "discharge", "hydrograph") else getattr(end, one)
            yield CaseError(f"{key}.{one}", shown, f"has no effect with end '{end.end}'")
    if end.discharge is not None:
        value, unit = end.discharge
        if not (value > 0.0 or (value == 0.0 and peak_discharge(case) > 0.0)):
            allowed = "must be above 0, along +x; or 0 where [[timeline]] has a discharge"
            yield CaseError(f"{key}.discharge", f"{value:g} {unit}", allowed)
        if unit == "m3/s" and width_of(case) is None:
            yield CaseError(
                "water.row.width", None, f"missing; {key}.discharge is in m3/s: give the width of the "
                "stream, or the discharge per width in m2/s",
            )  # fmt: skip


def check_courses(case: Case) -> Iterator[CaseError]:
    """Find a hydrograph and a stage beside what they stand for, or with values that cannot be."""
    keys = case.row
    if keys is None:
        return
    for end, name, other, key in (
        (keys.upstream, "hydrograph", "discharge", HYDROGRAPH), (keys.downstream, "stage", "level", STAGE),
    ):  # fmt: skip
        if end is None or getattr(end, name) is None:
            continue
        if getattr(end, other) is not None:
            yield CaseError(key, None, f"stands beside {key.rpartition('.')[0]}.{other}: give one of them")
        if any(getattr(one, other) is not None for one in case.timeline):
            yield CaseError(key, None, f"stands beside a {other} in [[timeline]]: give one of them")
        given = getattr(end, name)
        read = hydrograph_points if name == "hydrograph" else stage_points
        points = read(case.folder, given)
        wrong = [*faults_of_course(key, points)]
        yield from wrong
        if name == "hydrograph" and not wrong:
            yield from _discharges(case, end, points)


def _discharges(case: Case, end: RowEndSection, points: Iterable[tuple[float, Any]]) -> Iterator[CaseError]:
    """Find discharges against the stream, without a width, or beside a depth that would stay."""
    for t, (q, unit) in points:
        if not q >= 0.0:
            yield CaseError(HYDROGRAPH, f"{q:g} {unit}", f"is at {t:g} s; must be 0 or above, along +x")
            return
    if not any(q > 0.0 for _, (q, _) in points):
        yield CaseError(HYDROGRAPH, None, "brings no water: every discharge is 0")
    if end.depth is not None:
        yield CaseError(
            "water.row.upstream.depth", end.depth, "would hold the depth at every discharge of the "
            "hydrograph: leave it out, and each enters as the flow asks",
        )  # fmt: skip
    if any(unit == "m3/s" for _, (_, unit) in points) and width_of(case) is None:
        yield CaseError("water.row.width", None, f"missing; {HYDROGRAPH} has discharges of the whole width")
