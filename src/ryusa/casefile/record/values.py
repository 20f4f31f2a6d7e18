"""What follows from [stop], [[timeline]] and [record], and its rows."""

from typing import Literal

from ryusa.casefile.builders.values import counts
from ryusa.casefile.case import Case
from ryusa.casefile.precision import measure_of
from ryusa.casefile.row.values import water_alone
from ryusa.casefile.rows import ExplainRow, word

MANY = 1000  # free grains above which contacts are recorded only on request


def events_of(case: Case) -> Literal["all", "tracked", "none"]:
    """Which contacts are recorded."""
    if case.record.events is not None:
        return case.record.events
    if water_alone(case):
        return "none"
    return "all" if counts(case)[0] <= MANY or case.stop.saltations is not None else "none"


def begin_of(case: Case) -> float:
    """Begin of the window over which averages are taken [s]: the case settles, and changes no more."""
    return max([case.record.settle, *(change.at for change in case.timeline)])


def precision_rows(case: Case) -> list[ExplainRow]:
    """One row for each average that ends the run."""
    precision = case.stop.precision
    if precision is None:
        return []
    end = "" if case.stop.time is None else f"; at the latest at stop.time, {case.stop.time:g} s"
    return [
        word(
            "stop", name, f"known to {limit}",
            f"the run ends when the average of `measure {measure_of(name)}` from t = {begin_of(case):g} s on "
            f"is steady and its standard error is this small{end}",
        )
        for name, limit in precision.limits().items()
    ]  # fmt: skip
