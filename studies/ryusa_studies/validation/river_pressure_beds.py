"""Beds that a hydrostatic row missed, with a pressure of its own and the same limits (design/0028, 0030).

One run each of what needs hours; even beds, over which flow is uniform and pressure is that of still water,
and piles in still water are those of the hydrostatic comparisons.
"""

from collections.abc import Sequence

from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Task
from ryusa_studies.validation import river_dam as dam
from ryusa_studies.validation import river_dam_break as over_bed
from ryusa_studies.validation import river_delta as delta
from ryusa_studies.validation import river_overload as overload

FULL = {"water.row.pressure": "full"}
UNDER = ", with a pressure of its own"
BREAKS = (1, 2)  # seeds of the dam breaks
ONE = (1,)  # of all others
SHORT = dam.LOW.shares[1:]  # shares of the feed of the deposits that were too short


def tasks() -> Sequence[Task]:
    """Three hours in all: ten minutes a dam break, a delta three quarters of an hour."""
    return [
        *(over_bed.dam_break(seed, "full") for seed in BREAKS),
        *(dam.LOW.dam(share, FULL) for share in SHORT),
        *(dam.even_bed(*one) for one in dam.LOW.beds),
        *(one for seed in ONE for one in (delta.delta(seed, FULL), delta.pile(seed))),
        *(overload.bed(extra, seed, FULL) for seed in ONE for extra in (True, False)),
    ]


def measure(run: Results, one: CaseRun) -> dict[str, Floats]:
    """As the hydrostatic comparison does."""
    if one.case in dam.CASES:
        return dam.measure(run, one)
    return (overload if one.case == overload.CASE else delta).measure(run, one)


def judge(found: Found) -> Sequence[Finding]:
    """Each beside the same reference."""
    return [
        over_bed.finding(found, BREAKS, "full", UNDER),
        dam.finding(found, dam.LOW, SHORT, FULL, UNDER),
        delta.finding(found, ONE, FULL, UNDER),
        overload.finding(found, ONE, FULL, UNDER),
    ]
