"""A case explained: every number that follows from it, with its unit and its origin."""

from ryusa.casefile.builders.rows import fill_rows
from ryusa.casefile.case import Case
from ryusa.casefile.column.rows import column_rows, origin_of_u_star
from ryusa.casefile.contact.impact import impact_rows
from ryusa.casefile.contact.rows import contact_rows, damping_rows
from ryusa.casefile.derive import derive
from ryusa.casefile.estimate import cost_rows
from ryusa.casefile.facts import Derived
from ryusa.casefile.feeds.rows import traffic_rows
from ryusa.casefile.films import film_rows
from ryusa.casefile.grains.values import grain_rows
from ryusa.casefile.laws import law_rows
from ryusa.casefile.materials.rows import material_rows
from ryusa.casefile.record.time import time_rows
from ryusa.casefile.record.values import precision_rows
from ryusa.casefile.row.rows import row_rows
from ryusa.casefile.row.values import water_alone
from ryusa.casefile.rows import ExplainRow
from ryusa.casefile.shape import shape_rows
from ryusa.casefile.unusual import unusual_rows
from ryusa.casefile.walls.rows import wall_rows
from ryusa.casefile.water.rows import rotation_rows, water_rows


def explain(case: Case, derived: Derived | None = None) -> list[ExplainRow]:
    """Rows of name, value, unit and origin, as `ryusa check` prints them.

    Parameters
    ----------
    case : a checked case.
    derived : what follows from it; computed when not given.
    """
    found = derived or derive(case)
    if water_alone(case):
        return [*unusual_rows(case), *row_rows(case, found), *law_rows(case), *cost_rows(case, found)]
    return [
        *unusual_rows(case),
        *grain_rows(case, found),
        *shape_rows(case, found),
        *traffic_rows(case),
        *contact_rows(case, found),
        *damping_rows(case.contact, case.motion, found),
        *material_rows(case),
        *wall_rows(case, found),
        *fill_rows(case),
        *time_rows(case, found),
        *impact_rows(case, found),
        *water_rows(case, found, origin_of_u_star(case) if case.water is not None else ""),
        *film_rows(case, found),
        *column_rows(case, found),
        *row_rows(case, found),
        *rotation_rows(case, found),
        *law_rows(case),
        *precision_rows(case),
        *cost_rows(case, found),
    ]
