"""Rows of `ryusa check` on the pressure of a row: what a hydrostatic one lacks, what its own asks for."""

import math

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.column.packed import packed
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.motion import slope
from ryusa.casefile.row.ends import discharge_of, peak_discharge
from ryusa.casefile.row.schema import RowSection
from ryusa.casefile.row.values import WEIR, RowPlan, bed_points, dam_span, reaches, stream
from ryusa.casefile.rows import ExplainRow, number, word
from ryusa.laws.families import Pressure
from ryusa.laws.porous import ergun_linear

SHORT = 3.0  # heads: over a crest that is longer the flow is nearly along it
PER_HEAD = 4.0  # segments in a head that resolve a flow over a crest (docs/river.md)
ANTIDUNES = 0.84  # Froude number from which on a loose bed grows antidunes; Kennedy 1963
DILATES = 0.05  # by which a dense bed becomes looser when it is sheared
FALLS = 0.1  # of the time of fall through its own height: pores that fill faster do not matter


def pressure_rows(case: Case, keys: RowSection, plan: RowPlan) -> list[ExplainRow]:
    """Rows on the pressure of the row of a case."""
    heads = {dam.name: _head(case) for dam in keys.dams if dam.concentration is None}
    if keys.pressure == Pressure.HYDROSTATIC.word:
        missing = [*_curved(case, keys, plan, heads), *_free_surface(case, keys, plan), *_pores(case)]
        if not missing:
            return []
        what = ", ".join(dict.fromkeys(name for name, _ in missing))
        origin = f'{"; ".join(why for _, why in missing)}. water.row.pressure = "full" has it'
        return [word("water", "hydrostatic, so without", what, origin, "note")]
    thin = [head for head in heads.values() if 0.0 < head < PER_HEAD * plan.dx]
    if not thin:
        return []
    fine = f"{100.0 * min(thin) / PER_HEAD:.2g} cm"
    origin = f"{PER_HEAD:g} or more resolve crest and jet; take water.row.segment = {fine}"
    return [number("water", "segments in the head over a crest", min(thin) / plan.dx, "-", origin, "note")]


def _head(case: Case) -> float:
    """Energy head over a dam [m], at the largest discharge; 0 without one."""
    q = peak_discharge(case)
    g = case.motion.gravity * math.cos(slope(case.motion))
    return float((q / (WEIR * math.sqrt(g))) ** (2.0 / 3.0)) if q > 0.0 else 0.0


def _curved(case: Case, keys: RowSection, plan: RowPlan, heads: dict[str, float]) -> list[tuple[str, str]]:
    """Places at which the flow bends within a few depths."""
    said: list[tuple[str, str]] = []
    for dam in keys.dams:
        first, end = dam_span(plan, dam)
        long = (end - first) * plan.dx
        if (head := heads.get(dam.name, 0.0)) > 0.0 and long < SHORT * head:
            said.append(("bent flow", f"over '{dam.name}' on a crest {long / head:.2g} heads long"))
    if keys.downstream is not None and keys.downstream.end == "free fall" and discharge_of(case) > 0.0:
        said.append(("bent flow", "within about three depths of the free fall"))
    return said


def _free_surface(case: Case, keys: RowSection, plan: RowPlan) -> list[tuple[str, str]]:
    """Steep fronts, and waves over a loose bed."""
    said: list[tuple[str, str]] = []
    depth = (plan.start - plan.bottom).clip(0.0)
    steps = np.minimum(np.abs(np.diff(np.maximum(plan.start, plan.bottom))), np.abs(np.diff(depth)))
    step = float(steps.max(initial=0.0))
    if keys.surface is not None and step > 0.25 * float(depth.max()) > 0.0:
        said.append(("front", f"from a step of {100.0 * step:.3g} cm in the surface"))
    q = discharge_of(case)
    if stream(case) and case.build.kind == "stream" and q > 0.0:
        fast = [one.froude for one in reaches(case, q) if one.froude > ANTIDUNES]
        if fast:
            said.append(("antidunes", f"on a loose bed at a Froude number up to {max(fast):.2g}"))
    return said


def _pores(case: Case) -> list[tuple[str, str]]:
    """Pore pressure of a bed that is sheared, where its pores do not fill in a moment."""
    if not stream(case) or case.water is None or case.build.kind != "stream" or case.build.bed == 0.0:
        return []
    thick = max(z for _, z in bed_points(case))
    water, phi, g = case.water, packed(case), case.motion.gravity
    drag = ergun_linear(phi, reference_diameter(case), water.viscosity)  # over the speed in the pores
    pull = (case.grains.density / water.density - 1.0) * g * phi
    if not pull > 0.0:
        return []
    fills = DILATES * thick * drag / ((1.0 - phi) ** 2 * pull)
    fall = math.sqrt(2.0 * thick / g)
    if fills < FALLS * fall:
        return []
    about = f"pores of the bed take {fills:.2g} s to fill when it dilates by {100.0 * DILATES:g} %"
    return [("drainage sideways", about)]
