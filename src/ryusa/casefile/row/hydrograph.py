"""Discharges that follow one another at the upper end of a row: entries of [[timeline]]."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ryusa.casefile.row.schema import row_keys
from ryusa.casefile.row.values import per_width, width_of
from ryusa.casefile.rows import ExplainRow, number
from ryusa.errors import CaseError

if TYPE_CHECKING:
    from ryusa.casefile.case import Case


def hydrograph_rows(case: "Case") -> list[ExplainRow]:
    """Rows of the discharges after the first."""
    return [
        number(
            "water", f"discharge from {one.at:g} s", per_width(case, one.discharge), "m2/s",
            f"timeline.{k}.discharge",
        )
        for k, one in enumerate(case.timeline)
        if one.discharge is not None
    ]  # fmt: skip


def check_hydrograph(case: "Case") -> Iterator[CaseError]:
    """Find discharges that have no place where they could enter, and those that are none."""
    keys = row_keys(case)
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
