"""Rows of `ryusa check` about a row of columns: its grid, its flow, its dams and its time step."""

import math

import numpy as np

from ryusa.casefile.builders.table import bed_of_run, table_of
from ryusa.casefile.builders.values import sizes
from ryusa.casefile.case import Case
from ryusa.casefile.column.packed import packed
from ryusa.casefile.facts import Derived
from ryusa.casefile.motion import slope
from ryusa.casefile.row.capacity import GENTLEST, STEEPEST, DamDeposit, capacity, dam_deposit, shields_number
from ryusa.casefile.row.ends import discharge_of, least_discharge, peak_discharge, width_of
from ryusa.casefile.row.hydrograph import hydrograph_rows
from ryusa.casefile.row.nappe import nappe_rows
from ryusa.casefile.row.pressure_rows import pressure_rows
from ryusa.casefile.row.reach_rows import reach_rows
from ryusa.casefile.row.reach_source import reach_of
from ryusa.casefile.row.schema import RowDamSection, RowSection
from ryusa.casefile.row.values import (
    COURANT,
    SPARE,
    THINNEST,
    WEIR,
    Reach,
    RowPlan,
    bed_points,
    cell_of,
    crest_of,
    critical_depth,
    dam_span,
    fastest,
    inlet_depth,
    reaches,
    row_plan,
    segments_of,
    stream,
    stream_span,
    water_alone,
)
from ryusa.casefile.rows import ExplainRow, Flag, count, number, word
from ryusa.casefile.walls.mesh import box_of

# Segments of a crest, and q/(sqrt(g) H^1.5) over it in a row, of `ryusa validate river` (design/0027)
_CRESTS = ((1, 0.561), (2, 0.513), (3, 0.497), (5, 0.484), (10, 0.476))
WHOLE = 0.01  # of a cell: a dam that is as near to whole cells is of them
BESIDE = 6.0  # grains on a segment: with 3 a bed under a jet blew up in 0.2 s, with 10 and 13 none did
_NEAR = 0.15  # distance of a Froude number from 1 within which a flow is undular in nature


def row_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Rows about the row of a case; none where it has none."""
    keys = case.row
    if keys is None:
        return []
    alone = water_alone(case)
    if not alone and not stream(case):
        return _segments(case, "periodic")
    plan = row_plan(case)
    about = [*_grid(case, keys, plan), *_flow(case, keys), *_dams(case, keys, plan)]
    about += pressure_rows(case, keys, plan)
    if alone:
        return [*about, *_step(case, derived, plan)]
    return [*about, *_bed(case), *_walls(case), *_eddies(case, plan)]


def _walls(case: Case) -> list[ExplainRow]:
    """Walls of a stream that only its grains meet."""
    rows: list[ExplainRow] = []
    if case.build.kind == "stream" and case.build.walls and case.column.side_walls is None:
        about = "build.walls; give water.column.side_walls = water.row.width for their friction on the water"
        rows.append(word("water", "side walls", "for grains alone", about, "note"))
    dams = () if (keys := case.row) is None else keys.dams
    without: list[str] = []
    for k, one in enumerate(case.walls):
        low, high = box_of(case.folder, one, f"walls.{k}")
        if not any(dam.begin < high[0] and dam.end > low[0] for dam in dams):
            without.append(f"'{one.name}'")
    if not without:
        return rows
    names = ", ".join(without)
    about = "water flows through them; for the water give a dam of [[water.row.dams]] within each"
    return [*rows, word("water", "walls for grains alone", names, about, "note")]


def _eddies(case: Case, plan: RowPlan) -> list[ExplainRow]:
    """Segments so small that the eddies of a grain or two drive their water."""
    width, d = width_of(case), sizes(case)[0]
    if case.column.fluctuations == "none" or width is None:
        return []
    beside = plan.dx * width / (0.25 * math.pi * d**2)
    if beside >= BESIDE:
        return []
    about = (
        f"less than {BESIDE:g}: with water.column.fluctuations eddies of single grains drive "
        "the water of a segment, whose shear makes stronger ones, until speeds are absurd; take a wider "
        "stream, longer segments, or fluctuations = 'none'"
    )
    return [number("water", "grains side by side on a segment", beside, "", about, "warning")]


def _segments(case: Case, ends: str) -> list[ExplainRow]:
    x_low, dx, n = segments_of(case)
    return [
        number("water", "length of the row", n * dx, "m", f"x = {x_low:g} to {x_low + n * dx:g} m"),
        word("water", "ends", ends, "upstream - downstream"),
        count("water", "segments", n, f"of {100.0 * dx:.4g} cm"),
    ]


def _grid(case: Case, keys: RowSection, plan: RowPlan) -> list[ExplainRow]:
    high = plan.n_cell * plan.cell
    by = (
        "water.row.height" if keys.height is not None else f"{SPARE:g} times the largest depth to be expected"
    )
    ends = "periodic" if keys.upstream is None else f"{keys.upstream.end} - {_end(keys)}"
    floor = plan.bottom.copy()
    for dam in keys.dams:
        if dam.concentration is None:
            taken = slice(*dam_span(plan, dam))
            floor[taken] = np.maximum(floor[taken], crest_of(plan, dam))
    return [
        *_segments(case, ends),
        number("water", "cell", plan.cell, "cm", f"{plan.n_cell} up to {100.0 * high:.4g} cm: {by}"),
        number(
            "water", "water at the start", float((plan.start - floor).clip(0.0).sum() * plan.dx), "m2",
            "per width",
        ),
    ]  # fmt: skip


def _bed(case: Case) -> list[ExplainRow]:
    """The bed at the start."""
    if case.build.kind != "stream" or case.build.bed == 0.0:
        return [word("water", "bed at the start", "none", "build.bed not given: all grains come from feeds")]
    points, (begin, end) = bed_points(case), stream_span(case)
    if (bed := bed_of_run(case.build)) is not None:
        table = table_of(case)
        assert table is not None
        origin = (
            f"mean from x = {begin:g} to {end:g} m; {table.n:,} grains as in {bed.run} at {table.t:.4g} s"
        )
        thick = sum(thick for _, thick in points[1:-1]) / len(points[1:-1])
        return [number("water", "bed at the start", thick, "cm", origin)]
    origin = f"build.bed, from x = {begin:g} to {end:g} m, settled to the concentration {packed(case):g}"
    most, least = (f([thick for _, thick in points]) for f in (max, min))
    if most > least:
        origin = f"the thickest of {origin}; {100.0 * least:.4g} cm where it is thinnest"
    return [number("water", "bed at the start", most, "cm", origin)]


def _end(keys: RowSection) -> str:
    return "" if keys.downstream is None else keys.downstream.end


def _flow(case: Case, keys: RowSection) -> list[ExplainRow]:
    """Discharge, critical depth, and normal flow on each reach."""
    q, peak = discharge_of(case), peak_discharge(case)
    if not peak > 0.0:
        return hydrograph_rows(case)
    origin = "water.row.upstream.discharge"
    if keys.upstream is not None and keys.upstream.hydrograph is not None:
        origin = "water.row.upstream.hydrograph at the start"
    if keys.upstream is not None and keys.upstream.discharge is not None:
        value, unit = keys.upstream.discharge
        origin += "" if unit == "m2/s" else f", {value:g} m3/s over a width of {width_of(case):g} m"
    if (reach := reach_of(case)) is not None:
        origin = f"of the feeder reach, mean from {reach.begin:g} to {reach.end:g} s"
        origin += f"; {100.0 * reach.in_bed:.2g} % of it in its bed"
    rows = [
        number("water", "discharge", q, "m2/s", origin),
        number("water", "critical depth", critical_depth(case, q), "cm", "(q^2/(g cos(slope)))^(1/3)"),
        *hydrograph_rows(case),
        *reach_rows(case),
    ]
    for more, each in (("", q), (", at the peak", peak))[: 2 if peak > q else 1]:
        for one in reaches(case, each) if each > 0.0 else ():
            rows += _reach(one, more)
            rows += _transport(case, one, each, more) if stream(case) else []
    least = least_discharge(case)
    thin, cell = reaches(case, least)[0], cell_of(case)
    given = inlet_depth(case) is not None
    if not given and thin.froude > 1.0 and thin.normal <= THINNEST * cell:
        origin = (
            f"normal depth of {least:.3g} m2/s, {100.0 * thin.normal:.3g} cm, is less than a cell of "
            f"{100.0 * cell:.3g} cm: take a thinner water.column.cell, or give water.row.upstream.depth"
        )
        rows.append(word("water", "depth at the upper end", "that of the row", origin, "note"))
    return rows


def _transport(case: Case, one: Reach, q: float, more: str) -> list[ExplainRow]:
    """Shields number and capacity of normal flow on a reach; a slope beyond the formula has no capacity."""
    stress = shields_number(case, one.slope, one.normal)
    if math.isnan(stress):
        return []
    where = f"x = {one.begin:g} to {one.end:g} m{more}"
    rows = [number("water", f"Shields number, {where}", stress, "-", "of normal flow and the mean diameter")]
    if math.isnan(most := capacity(case, one.slope, q)):
        allowed = f"the formula holds for slopes from {GENTLEST:g} to {STEEPEST:g}"
        return [*rows, word("water", f"capacity, {where}", "not known", allowed)]
    mass = most * case.grains.density * (width_of(case) or 0.0)
    origin = f"{mass:.3g} kg/s over the width, of uniform flow; Smart & Jaeggi 1983: a scale"
    return [*rows, number("water", f"capacity, {where}", most, "m2/s", origin)]


def _reach(one: Reach, more: str) -> list[ExplainRow]:
    where = f"x = {one.begin:g} to {one.end:g} m{more}"
    if not one.normal > 0.0:
        return [
            word("water", f"normal depth, {where}", "none", f"slope {math.tan(one.slope):.4g}: does not fall")
        ]
    kind = "supercritical" if one.froude > 1.0 else "subcritical"
    flag: Flag = ""
    if abs(one.froude - 1.0) < _NEAR:
        kind, flag = f"{kind}, near critical: real water has waves that a hydrostatic row lacks", "note"
    law = f"slope {math.tan(one.slope):.4g}, mean of the log law; without side walls"
    return [
        number("water", f"normal depth, {where}", one.normal, "cm", law),
        number("water", f"Froude number, {where}", one.froude, "-", f"of normal flow: {kind}", flag),
    ]


def _dams(case: Case, keys: RowSection, plan: RowPlan) -> list[ExplainRow]:
    rows: list[ExplainRow] = []
    q = peak_discharge(case)
    more = ", at the peak" if q > discharge_of(case) else ""
    for dam in keys.dams:
        first, end = dam_span(plan, dam)
        crest = crest_of(plan, dam)
        high = crest - float(plan.bottom[first:end].min())
        kept, flag = _in_whole_cells(dam, plan, crest)
        kind = "impermeable" if dam.concentration is None else f"porous, concentration {dam.concentration:g}"
        rows.append(
            number(
                "water",
                f"dam '{dam.name}'",
                high,
                "cm",
                f"over the bottom at its foot, x = {plan.x_low + first * plan.dx:g} to "
                f"{plan.x_low + end * plan.dx:g} m; {kind}, {end - first} segments{kept}",
                flag,
            )
        )
        if dam.concentration is None and q > 0.0:
            head = (q / (WEIR * math.sqrt(case.motion.gravity * math.cos(slope(case.motion))))) ** (2.0 / 3.0)
            origin = f"critical flow without loss, q = (2/3)^1.5 sqrt(g) H^1.5; {_own_head(end - first)}"
            rows.append(number("water", f"energy head over '{dam.name}'{more}", head, "cm", origin))
            rows += nappe_rows(case, plan, dam, q, more)
        if stream(case) and (found := dam_deposit(case, dam)) is not None:
            rows += _deposit_behind(dam.name, found)
    return rows


def _in_whole_cells(dam: RowDamSection, plan: RowPlan, crest: float) -> tuple[str, Flag]:
    """Say where the crest of an impermeable dam lies for the water, whose cells it takes whole."""
    first, end = dam_span(plan, dam)
    if dam.concentration is not None or end == first:
        return "", ""
    over = crest - plan.bottom[first:end]
    whole = np.round(over / plan.cell) * plan.cell
    off = whole - over
    if float(np.abs(off).max()) < WHOLE * plan.cell:
        return "", ""
    heights = f"{100.0 * whole.min():.4g}"
    heights += f" to {100.0 * whole.max():.4g}" if whole.max() - whole.min() > WHOLE * plan.cell else ""
    said = f"; for the water it is {heights} cm high, in whole cells of {100.0 * plan.cell:.4g} cm"
    return said, "note"


def _own_head(segments: int) -> str:
    """How much larger the energy head over a crest of so many segments is in a row (design/0027)."""
    n, passes = np.array(_CRESTS).T
    more = (WEIR / float(np.interp(segments, n, passes))) ** (2.0 / 3.0) - 1.0
    over = f"{segments} segment{'s' * (segments > 1)}"
    return f"in a row about {100.0 * abs(more):.0f} % {'more' if more > 0.0 else 'less'} over {over}"


def _deposit_behind(name: str, found: DamDeposit) -> list[ExplainRow]:
    """Slope of the deposit behind a dam, and the time in which it fills."""
    slope_of = "at which the flow carries the feed, Smart & Jaeggi 1983"
    if found.slope < GENTLEST * (1.0 + 1e-6):
        slope_of = f"that of the feed is less, where the formula of Smart & Jaeggi 1983 ends: {GENTLEST:g}"
    flag = ""
    if 0.0 < found.length < found.adapts:
        slope_of += (
            f"; the deposit is {found.length:.3g} m long, less than the h/S = {found.adapts:.3g} m in which "
            "the flow becomes normal: it will be shorter"
        )
        flag = "note"
    behind = number("water", f"slope of the deposit behind '{name}'", found.slope, "-", slope_of, flag)
    if not found.volume > 0.0:
        return [behind, word("water", f"time to fill '{name}'", "full", "the bed at the start is as high")]
    up_to = "the feed" if found.reaches_feed else "where the deposit meets the bed"
    origin, flag = f"{found.volume:.3g} m2 per width, from the crest up to {up_to}", ""
    if found.time > found.lasts:
        origin, flag = f"{origin}; the feed lasts {found.lasts:.4g} s", "note"
    return [behind, number("water", f"time to fill '{name}'", found.time, "s", origin, flag)]


def _step(case: Case, derived: Derived, plan: RowPlan) -> list[ExplainRow]:
    speed = fastest(case, plan)
    courant = speed * derived.dt / plan.dx
    origin = (
        "time.step"
        if case.time.step is not None
        else f"an even part of record.frames, Courant number {COURANT:g}"
    )
    more = "" if courant <= COURANT * (1.0 + 1e-9) else "; the row divides each step until it is 0.5"
    return [
        number("time", "dt", derived.dt, "s", origin),
        number(
            "time", "Courant number", courant, "-",
            f"{speed:.3g} m/s, the fastest wave to be expected, times dt over a segment{more}",
        ),
    ]  # fmt: skip
