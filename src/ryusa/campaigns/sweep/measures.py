"""Measures of a sweep: which a case can give, and the numbers of one run."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ryusa.casefile.builders.values import periodic
from ryusa.casefile.record.values import events_of
from ryusa.casefile.row.values import stream
from ryusa.casefile.shape import shapes_of
from ryusa.catalogue import MEASURES, MeasureEntry, called
from ryusa.errors import CaseError
from ryusa.measure.statistics import Average
from ryusa.results import Results
from ryusa.spelling import nearest_word

if TYPE_CHECKING:
    from ryusa.casefile.case import Case


def _along(case: "Case") -> bool:
    return periodic(case)[0] or case.domain.period_x is not None


# What a measure needs of a case: word of the catalogue -> test, and how a case gets it.
NEEDS: dict[str, tuple[Callable[["Case"], bool], str]] = {
    "column": (
        lambda case: case.water is not None and case.water.profile == "column" and case.water.row is None,
        "water.profile = 'column'",
    ),
    "row": (lambda case: case.water is not None and case.water.row is not None, "[water.row]"),
    "structures": (
        lambda case: (
            case.water is not None and case.water.row is not None and bool(case.water.row.dams or case.walls)
        ),
        "[[water.row.dams]] or [[walls]]",
    ),
    "forces": (lambda case: case.record.forces, "record.forces = true"),
    "walls": (lambda case: bool(case.walls) or stream(case), "[[walls]], or builder 'stream'"),
    "area": (
        lambda case: _along(case) or not case.motion.plane,
        "a scene that is periodic along x, or motion.plane = false",
    ),
    "traffic": (lambda case: bool(case.feeds or case.exits), "[[feeds]] or [[exits]]"),
    "period": (_along, "a scene that is periodic along x"),
    "open": (lambda case: not _along(case), "a scene that is open along x"),
    "space": (lambda case: not case.motion.plane, "motion.plane = false"),
    "events": (lambda case: events_of(case) != "none", "record.events = 'all'"),
}


def measures_of(names: Sequence[str]) -> tuple[MeasureEntry, ...]:
    """Entries of the catalogue by their names.

    Raises
    ------
    CaseError : none is given, one stands there twice, is unknown, or gives a table and no quantities.
    """
    known = {one.name: one for one in MEASURES if not one.table}
    if not names:
        raise CaseError("measure", None, f"missing; must be one of {', '.join(known)}, or several")
    for k, name in enumerate(names):
        if name not in known:
            tables = ", ".join(one.name for one in MEASURES if one.table)
            allowed = f"must be one of {', '.join(known)}; {tables} give a table, and no quantities"
            raise CaseError("measure", name, allowed, nearest_word(name, list(known)))
        if name in names[:k]:
            raise CaseError("measure", name, "stands there twice")
    return tuple(known[name] for name in names)


def refuse_measure(entry: MeasureEntry, case: "Case") -> None:
    """Refuse a measure that a case cannot give.

    Raises
    ------
    CaseError : names what the case lacks.
    """
    for word in entry.needs:
        there, how = NEEDS[word]
        if not there(case):
            raise CaseError("measure", entry.name, f"needs {how}")
    if not entry.fed and (case.feeds or case.exits):
        raise CaseError(
            "measure", entry.name, "needs the same grains throughout; feeds and exits change them"
        )
    if not entry.clumps and shapes_of(case):
        raise CaseError("measure", entry.name, "takes every sphere for a grain, and the case has clumps")


@dataclass(frozen=True)
class AtHeight:
    """A quantity over height of a measure, at one height.

    Attributes
    ----------
    measure, quantity : its measure, and its name among the `layers` of that.
    z : height above datum [m].
    """

    measure: str
    quantity: str
    z: float

    @property
    def name(self) -> str:
        """Name beside the other quantities of the measure.

        >>> AtHeight("profile", "v_x", 0.012).name
        'v_x at 12 mm'
        """
        return f"{self.quantity} at {1e3 * self.z:g} mm"


def averages_of(
    entry: MeasureEntry, results: Results, heights: Sequence[AtHeight] = ()
) -> tuple[Average, ...]:
    """Quantities of one measure of a run; those without samples are left out.

    Of a measure of one moment each quantity is one sample without an error.

    Parameters
    ----------
    entry : the measure.
    results : the run.
    heights : of its quantities over height, those that are wanted at one height too.
    """
    found: Any = called(entry)(results)
    averages = getattr(found, "averages", None)
    if averages is not None:
        every = (*averages.items, *(at_height(found, one) for one in heights))
        return tuple(one for one in every if one.n)
    nan, t = math.nan, float(getattr(found, "t", math.nan))
    return tuple(
        Average(
            str(row["quantity"]), str(row["unit"]), float(row["value"]), nan, 1, 1, 1.0, (t, t), nan, nan, nan
        )
        for row in found.rows()
    )


def at_height(found: Any, wanted: AtHeight) -> Average:
    """A quantity over height, on the straight line between the middles of two layers.

    It has no samples where the height lies beyond the layers, or where no grain ever was in one of the two.

    Parameters
    ----------
    found : what the measure gives, with `z` [m], `columns` of quantities over height, and times `t` [s].
    wanted : the quantity.
    """
    (column,) = (one for one in found.columns if one.name == wanted.quantity)
    value, error = (
        float(np.interp(wanted.z, found.z, one, left=math.nan, right=math.nan))
        for one in (column.value, column.error)
    )
    n = len(found.t) if math.isfinite(value) else 0
    window = (float(found.t[0]), float(found.t[-1]))
    return Average(
        wanted.name, column.unit, value, error, n, 1, float(n), window, math.nan, math.nan, math.nan
    )
