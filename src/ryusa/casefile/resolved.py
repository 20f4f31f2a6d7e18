"""A case with everything that follows from it, as plain data: the content of case.json."""

import math
from dataclasses import asdict
from typing import Any

from ryusa.casefile.case import Case
from ryusa.casefile.choices import chosen
from ryusa.casefile.column.packed import packed
from ryusa.casefile.column.schema import CELL, ONLY_IN_A_COLUMN
from ryusa.casefile.contact.resolved import resolved_contact
from ryusa.casefile.derive import derive
from ryusa.casefile.facts import Derived
from ryusa.casefile.grading import points_of
from ryusa.casefile.grains.values import slab_width
from ryusa.casefile.record.values import events_of
from ryusa.casefile.row.values import bottom_points, line_points, row_plan, segments_of, stream, water_alone
from ryusa.casefile.shape import spheres_of
from ryusa.laws.families import Mixing, SurfaceRule


def resolved(case: Case, derived: Derived | None = None) -> dict[str, Any]:
    """Give the case as plain data in SI with what follows filled in; numbers that do not exist are None."""
    data: dict[str, Any] = case.model_dump(mode="json", by_alias=True)
    del data["schema"]  # of the words of a file, and says nothing of what is computed
    found = derived or derive(case)
    data["grains"] |= {"diameter": found.d, "sieve_curve": points_of(case)}
    data["contact"] = resolved_contact(case)
    data["motion"] |= {"slope": math.tan(found.slope), "slope_angle": found.slope}
    data["motion"]["slab_width"] = slab_width(case)
    data["record"]["events"] = events_of(case)
    data["time"] |= {"step": found.dt, "steps_per_contact": found.steps_per_contact}
    if case.water is not None:
        data["water"] |= {"u_star": found.u_star, "tau_star": found.tau_star, "roughness": found.k_rough}
        _resolve_column(case, found, data["water"])
    for section in (*data["planes"], *data["walls"], *data["feeds"]):
        if section["material"] is None:
            del section["material"]
    for name, section in data["shapes"].items():
        section["made_of"] = spheres_of(case, name)
    for section in (*data["feeds"], *data["exits"]):
        if section["moves_with"] is None:
            del section["moves_with"]
    if not case.materials:
        del data["grains"]["mixture"], data["grains"]["bed_material"]
    for key in (
        "feeds",
        "exits",
        "materials",
        "pairs",
        "shapes",
    ):  # left out where there are none, as in cases of earlier versions
        if not data[key]:
            del data[key]
    for key in ("inside", "number"):  # of builder "fill", so too
        if key in data["build"] and data["build"][key] is None:
            del data["build"][key]
    data["derived"] = asdict(found)
    return _plain(data)


def _resolve_column(case: Case, found: Derived, data: dict[str, Any]) -> None:
    """Fill in the column of water; where there is none, its keys say nothing."""
    wet = case.water
    assert wet is not None
    if wet.profile == "column":
        keys = case.column
        cell = keys.cell or CELL * found.d
        data["column"] = keys.model_dump(mode="json") | {
            "cell": cell,
            "mixing_length": chosen(case, Mixing).word,
        }
        data["column"]["surface"] = chosen(case, SurfaceRule).word
        if wet.row is None:
            del data["row"]
        else:
            _resolve_row(case, data)
        data["column"]["packed"] = packed(case)
        return
    for key in ONLY_IN_A_COLUMN:
        del data[key]


def _resolve_row(case: Case, data: dict[str, Any]) -> None:
    """Fill in the row of columns: its lines as points, and what it is divided into.

    Cells over a bed of grains are those of one column.
    """
    row, (_, dx, n) = data["row"], segments_of(case)
    row |= {"segments": n, "segment": dx}
    for end in (row["upstream"], row["downstream"]):
        if end is not None and end["run"] is None:
            del end["run"]  # as in cases of earlier versions
    row["bottom"] = [list(one) for one in bottom_points(case)]
    if row["surface"] is not None:
        row["surface"] = [list(one) for one in line_points(case.folder, "water.row.surface", row["surface"])]
    if water_alone(case) or stream(case):
        plan = row_plan(case)
        data["column"]["cell"] = plan.cell
        row["height"] = plan.n_cell * plan.cell


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
