"""Meshes that stand in a row of columns: whether they lie in it, and agree with its dams."""

from collections.abc import Iterator

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.row.values import RowPlan, crest_of, row_plan, stream
from ryusa.casefile.rows import ExplainRow, number
from ryusa.errors import CaseError
from ryusa.model.arrays import Floats

Boxes = list[tuple[str, Floats, Floats]]  # name of the wall, lowest and highest corner [m]

LONGEST = 2.0  # lengths of the row: a mesh along x
UNITS = {"mm": 1.0e-3, "cm": 1.0e-2, "in": 0.0254, "ft": 0.3048, "m": 1.0}  # a file may be in [m]


def check_mesh_in_row(
    case: Case, key: str, unit: str, low: Floats, high: Floats, d: float
) -> Iterator[CaseError]:
    """Find a mesh too long for the row, or beside, above or below it; `d` is the largest grain [m]."""
    if not stream(case):
        return
    plan = row_plan(case)
    length = plan.n * plan.dx
    x_end, top = plan.x_low + length, float(plan.bottom.max()) + plan.n_cell * plan.cell
    along = float(high[0] - low[0])
    text = ""
    if along > LONGEST * length:
        text = f"is {along:.3g} m long, where the row is {length:.3g} m"
    elif high[0] < plan.x_low or low[0] > x_end:
        text = (
            f"lies between x = {low[0]:.3g} and {high[0]:.3g} m, beside the row, which reaches from "
            f"{plan.x_low:.3g} to {x_end:.3g} m"
        )
    elif low[2] > top or high[2] < float(plan.bottom.min()) - d:
        text = (
            f"lies between z = {low[2]:.3g} and {high[2]:.3g} m, where the row has its bottom from "
            f"{plan.bottom.min():.3g} m on and ends at {top:.3g} m"
        )
    if text:
        yield CaseError(key, None, f"{text}: check unit, scale and place{_guess(unit, along, length, d)}")


def _guess(unit: str, along: float, length: float, d: float) -> str:
    """How long a mesh would be in the units in which it is from a grain to the whole row long."""
    if unit not in UNITS:
        return ""
    lengths = {one: along / UNITS[unit] * factor for one, factor in UNITS.items() if one != unit}
    fits = [f"in {one} {long:.3g} m" for one, long in lengths.items() if d <= long <= length]
    return f". It would be {', '.join(fits)} long" if fits else ""


def dam_rows(case: Case, meshes: Boxes, d: float) -> list[ExplainRow]:
    """Warnings about dams whose crest is not that of the mesh which stands there."""
    keys = case.row
    if keys is None or not keys.dams or not stream(case):
        return []
    plan = row_plan(case)
    rows: list[ExplainRow] = []
    for dam in keys.dams:
        crest = crest_of(plan, dam)
        there = [one for one in meshes if one[1][0] < dam.end and one[2][0] > dam.begin]
        if not there:
            continue
        name, low, high = max(there, key=lambda one: float(one[2][2]))
        foot = _bottom(plan, 0.5 * (dam.begin + dam.end))
        tall = max(crest - foot, float(high[2]) - foot)
        off = float(high[2]) - crest
        if abs(off) > max(d, 0.25 * tall) or dam.begin < low[0] - d or dam.end > high[0] + d:
            about = (
                f"of dam '{dam.name}', x = {dam.begin:.3g} to {dam.end:.3g} m; the mesh of walls.{name} "
                f"there has {high[2]:.3g} m, x = {low[0]:.3g} to {high[0]:.3g} m: water and grains meet two "
                "structures"
            )
            rows.append(number("row", "crest", crest, "m", about, "warning"))
    return rows


def _bottom(plan: RowPlan, x: float) -> float:
    return float(np.interp(x, plan.x, plan.bottom))
