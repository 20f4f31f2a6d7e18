"""Air below the nappe of a dam in a row of columns: what forbids it, and about where the water lands."""

import math
from collections.abc import Iterator

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.motion import slope
from ryusa.casefile.row.ends import levels_of, peak_discharge
from ryusa.casefile.row.schema import RowDamSection, RowSection
from ryusa.casefile.row.values import RowPlan, bed_over, crest_of, critical_depth, dam_span
from ryusa.casefile.rows import ExplainRow, number, word
from ryusa.errors import CaseError
from ryusa.laws.families import Mixing, Pressure

BRINK = 0.715  # of critical depth: the depth at a free overfall (Rouse 1936)


def way_of_nappe(case: Case, plan: RowPlan, dam: RowDamSection, q: float) -> float:
    """Way from the downstream face of a dam to where its nappe lands [m], by critical flow over its crest.

    Notes
    -----
    The middle of the nappe leaves with the speed at a free overfall, and falls to the floor or the bed behind
    the dam, or to a level that is given at the end of the row. Gravity along the axis is left out.
    """
    g, critical = case.motion.gravity * math.cos(slope(case.motion)), critical_depth(case, q)
    _, behind = dam_span(plan, dam)
    end = None if case.row is None else case.row.downstream
    pool = min([] if end is None else levels_of(case, end), default=-math.inf)
    ground = float(plan.bottom[behind] + bed_over(case, plan.x[behind : behind + 1])[0])
    fall = crest_of(plan, dam) + 0.5 * BRINK * critical - max(ground, pool)
    return q / (BRINK * critical) * math.sqrt(2.0 * max(fall, 0.0) / g)


def check_air(case: Case, plan: RowPlan, keys: RowSection) -> Iterator[CaseError]:
    """Find dams with aerated = true behind which no air can lie, or whose nappe would not land in the row."""
    first = {dam_span(plan, dam)[0]: dam for dam in keys.dams}
    for k, dam in enumerate(keys.dams):
        if not dam.aerated:
            continue
        _, behind = dam_span(plan, dam)
        after, length = first.get(behind), plan.n * plan.dx
        why = {
            f'needs water.row.pressure = "{Pressure.FULL.word}": hydrostatic water does not fall freely':
                keys.pressure != Pressure.FULL.word,
            "has no place in a periodic row: give water.row.upstream and downstream":
                keys.upstream is None or keys.downstream is None,
            "has no effect on a dam that lets water through: it leaves below the crest":
                dam.concentration is not None,
            "has no effect at the end of the row: end = 'free fall' has air behind it": behind >= plan.n,
            f"has no effect before dam '{'' if after is None else after.name}', which is as high":
                after is not None and after.concentration is None
                and _whole(plan, after, behind) >= _whole(plan, dam, behind - 1),
        }  # fmt: skip
        faults = [text for text, so in why.items() if so]
        if not faults and (q := peak_discharge(case)) > 0.0:
            way, room = way_of_nappe(case, plan, dam, q), length - behind * plan.dx
            if way > room:
                faults.append(
                    f"lets the water land about {way:.3g} m behind the dam, beyond the end of the row, "
                    f"{room:.3g} m behind it: lengthen the row, or let it end at the dam with a free fall"
                )
        for text in faults:
            yield CaseError(f"water.row.dams.{k}.aerated", True, text)


def _whole(plan: RowPlan, dam: RowDamSection, segment: int) -> int:
    """Cells of a dam in a segment, as the water has it."""
    return round((crest_of(plan, dam) - float(plan.bottom[segment])) / plan.cell)


def nappe_rows(case: Case, plan: RowPlan, dam: RowDamSection, q: float, more: str) -> list[ExplainRow]:
    """Where the nappe of a dam lands, and whether its jet is known to dig; none where it clings."""
    if not dam.aerated or not q > 0.0:
        return []
    origin = "behind its face, by 1.4 times the speed of critical flow; nearer where a pool stands below it"
    way = way_of_nappe(case, plan, dam, q)
    rows = [number("water", f"nappe of '{dam.name}' lands{more}", way, "cm", origin)]
    law = case.column.mixing_length or Mixing.LI_SAWAMOTO.word  # as `choices`; a bed is that of a stream
    at = plan.x_low + dam_span(plan, dam)[1] * plan.dx + way
    if law == Mixing.LI_SAWAMOTO.word and bed_over(case, np.array([at]))[0] > 0.0:
        origin = "water.column.mixing_length: by 'shear layer' a jet stays along the bed and digs"
        text = f"by {law} it spreads over its pool at once"
        rows.append(word("water", f"jet of '{dam.name}'", text, origin, "note"))
    return rows
