"""The row of columns of a case: its columns, its ends and its dams."""

import math
from dataclasses import replace

import numpy as np

from ryusa.build.column import column_of
from ryusa.build.placement import Placement
from ryusa.build.reach import reach_end
from ryusa.casefile.case import Case
from ryusa.casefile.choices import chosen
from ryusa.casefile.column.packed import packed
from ryusa.casefile.facts import Derived
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.motion import slope
from ryusa.casefile.row.ends import discharge_of, hydrograph_of, levels_of, stage_of, width_of
from ryusa.casefile.row.reach import END
from ryusa.casefile.row.reach_source import reach_of
from ryusa.casefile.row.schema import RowEndSection
from ryusa.casefile.row.values import RowPlan, crest_of, dam_span, row_plan, segments_of, stream
from ryusa.errors import CaseError
from ryusa.laws.families import (
    BedKind,
    Buoyancy,
    Drive,
    Fluctuations,
    Mixing,
    Pressure,
    SideWalls,
    Start,
    SurfaceRule,
)
from ryusa.model import Column, ColumnRow
from ryusa.model.arrays import Floats
from ryusa.model.row import EndKind, PorousSolid, RowDam, RowEnd

_KINDS = {
    "wall": EndKind.WALL,
    "level": EndKind.LEVEL,
    "free fall": EndKind.FREE_FALL,
    "same depth": EndKind.UNIFORM,
    "discharge": EndKind.DISCHARGE,
}


def row_of(case: Case, derived: Derived, placement: Placement) -> ColumnRow | None:
    """The row of columns of a case over its first grains; None where it has none.

    Raises
    ------
    CaseError : the row cannot be.
    """
    keys, wet = case.row, case.water
    if keys is None or wet is None:
        return None
    if (column := column_of(case, derived, placement)) is not None:
        column, pressure = replace(column, surface=SurfaceRule.VOLUME), Pressure.of(keys.pressure)
        return _among_grains(case, column, pressure, placement.period[0])
    plan = row_plan(case)
    solid, porous, dams = _dams(case, plan)
    row = ColumnRow(
        _column(case, derived, plan), plan.dx, plan.bottom.copy(), derived.g * math.cos(derived.slope),
        _end(case, keys.upstream), _end(case, keys.downstream), solid, plan.x_low, porous,
        plan.start.copy(), dams, Pressure.of(keys.pressure),
    )  # fmt: skip
    faults = row.refuses()
    if stream(case):
        faults += row.refuses_grains(Buoyancy.STRESS, placement.period[0])
    if faults:
        raise CaseError("water.row", None, "; ".join(faults))
    for one in (row.bottom, row.solid, row.start):
        if one is not None:
            one.flags.writeable = False
    return row


def _among_grains(case: Case, column: Column, pressure: Pressure, period: float) -> ColumnRow:
    """A periodic row over a bed of grains, with the surface of one column over the same bed."""
    x_low, dx, n = segments_of(case)
    g_z = case.motion.gravity * math.cos(slope(case.motion))
    bottom = np.full(n, column.z_low)
    row = ColumnRow(
        column, dx, bottom, g_z, x_low=x_low, start=np.full(n, column.z_surface), pressure=pressure
    )
    if faults := row.refuses():
        raise CaseError("water.row", None, "; ".join(faults))
    if faults := row.refuses_grains(Buoyancy.STRESS, period):  # what else it refuses, the case file did
        raise CaseError("water.row.bottom", None, "; ".join(faults))
    return row


def _column(case: Case, derived: Derived, plan: RowPlan) -> Column:
    """The column of every station, its heights over the bottom."""
    wet, keys = case.water, case.column
    assert wet is not None
    deepest = max(float((plan.start - plan.bottom).max()), 0.5 * plan.cell)
    grains = stream(case)
    return Column(
        z_low=0.0,
        dz=plan.cell,
        n=plan.n_cell,
        depth=min(deepest, plan.n_cell * plan.cell),
        rho_w=wet.density,
        nu=wet.viscosity,
        bed=BedKind.of(keys.bed),
        k_rough=derived.k_rough,
        surface=SurfaceRule.VOLUME,
        side=SideWalls.NONE if keys.side_walls is None else SideWalls.of(keys.side_friction),
        width=math.nan if keys.side_walls is None else keys.side_walls,
        g_x=derived.g * math.sin(derived.slope),
        drive=Drive.of(keys.drive),
        gradient=keys.pressure_gradient or 0.0,
        mixing=chosen(case, Mixing),
        kappa=keys.kappa,
        phi_max=packed(case),
        k_f=keys.pore_eddies,
        d=derived.d,
        seed=case.seed,
        area=plan.n * plan.dx * (width_of(case) or 1.0) if grains else 1.0,
        fluctuations=Fluctuations.of(keys.fluctuations),
        interval=keys.interval if grains else 1,
        start=Start.REST,
    )


def _end(case: Case, end: RowEndSection | None) -> RowEnd | None:
    if end is None:
        return None
    if (reach := reach_of(case)) is not None and end.end == END:
        return reach_end(case, reach)
    kind = _KINDS[end.end]
    if kind is not EndKind.DISCHARGE:
        course = stage_of(case) if end.stage is not None else None
        return RowEnd(kind, level=next(iter(levels_of(case, end)), math.nan), course=course)
    depth = math.nan if end.depth is None else end.depth
    return RowEnd(
        kind, discharge=discharge_of(case), depth=depth, developed=end.profile == "developed",
        course=hydrograph_of(case),
    )  # fmt: skip


def _dams(case: Case, plan: RowPlan) -> tuple[np.ndarray | None, PorousSolid | None, tuple[RowDam, ...]]:
    """Solid cells of the segments, the porous solid in them, and the dams by name."""
    keys, wet = case.row, case.water
    assert keys is not None and wet is not None
    solid = np.zeros(plan.n, np.int64)
    porous: list[tuple[Floats, float]] = []
    dams: list[RowDam] = []
    for dam in keys.dams:
        (first, end), crest = dam_span(plan, dam), crest_of(plan, dam)
        over = (crest - plan.bottom[first:end]) / plan.cell
        dams.append(RowDam(dam.name, first, end, crest, dam.concentration is not None, dam.aerated))
        if dam.concentration is None:
            solid[first:end] = np.round(over).astype(np.int64)
            continue
        phi = np.zeros((plan.n, plan.n_cell))
        share = np.clip(over[:, None] - np.arange(plan.n_cell), 0.0, 1.0)  # of each cell below the crest
        phi[first:end] = dam.concentration * share
        porous.append((phi, dam.diameter or reference_diameter(case)))
    matrix = [PorousSolid.of_grains(phi, d, wet.viscosity) for phi, d in porous]
    found = None
    if matrix:
        found = PorousSolid(
            *(
                np.sum([getattr(one, name) for one in matrix], axis=0)
                for name in ("phi", "linear", "quadratic")
            )
        )
        for array in vars(found).values():
            array.flags.writeable = False
    return (solid if solid.any() else None), found, tuple(dams)
