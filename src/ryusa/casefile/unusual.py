"""Rows of `ryusa check` that warn of values far from those of sediment in water: most are slips of a unit."""

from collections.abc import Iterator

from ryusa.casefile.case import Case
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.row.values import crest_of, dam_span, row_plan, stream, water_alone
from ryusa.casefile.rows import ExplainRow, number

DENSITY = (300.0, 20_000.0)  # of grains [kg/m3]
WATER_DENSITY = (600.0, 2_500.0)  # [kg/m3]
VISCOSITY = (2.0e-7, 1.0e-4)  # kinematic [m2/s]
DEPTH = (0.5, 200.0)  # over the diameter of the grains [-]
DAM = 0.5  # height of a dam over the length of its row [-]


def unusual_rows(case: Case) -> list[ExplainRow]:
    """One row for each value that lies far outside what is met in nature and in laboratories."""
    return [
        number("unusual", key, value, unit, f"{what}: check number and unit", "warning")
        for key, value, unit, (low, high), what in _values(case)
        if not low <= value <= high
    ]


def _values(case: Case) -> Iterator[tuple[str, float, str, tuple[float, float], str]]:
    """Key, value, unit, range and what lies in it."""
    water, alone = case.water, water_alone(case)
    if not alone:
        rock = "pumice has about 500, quartz 2650, steel 7800, gold 19300 kg/m3"
        yield "grains.density", case.grains.density, "kg/m3", DENSITY, rock
        for name, one in case.materials.items():
            if one.density is not None:
                yield f"materials.{name}.density", one.density, "kg/m3", DENSITY, rock
    if water is None:
        return
    yield "water.density", water.density, "kg/m3", WATER_DENSITY, "fresh water has 1000, sea water 1025 kg/m3"
    text = "the kinematic viscosity of water at 20 degC is 1e-6 m2/s, its dynamic viscosity 1e-3 Pa s"
    yield "water.viscosity", water.viscosity, "m2/s", VISCOSITY, text
    if water.depth is not None and not alone:
        d = reference_diameter(case)
        low = DEPTH[0] if stream(case) else 0.0  # without a stream, water that covers no grain is refused
        text = f"{water.depth / d:.3g} diameters of the grains"
        yield "water.depth", water.depth, "m", (low * d, DEPTH[1] * d), text
    keys = case.row
    if keys is not None and keys.dams:
        plan = row_plan(case)
        for dam in keys.dams:
            first, end = dam_span(plan, dam)
            high, length = crest_of(plan, dam) - float(plan.bottom[first:end].min()), plan.n * plan.dx
            text = f"height over the bottom, in a row of {length:.3g} m"
            yield f"dam '{dam.name}'", high, "m", (0.0, DAM * length), text
