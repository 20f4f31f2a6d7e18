"""The struck grain free to move: contact time beside that on a fixed grain."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.laws.collision import collision_time
from ryusa.study import Band, Finding, Trial, over_range
from ryusa_studies.osada2004 import _drops, fig05
from ryusa_studies.osada2004._drops import EXACT, Setup
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import PARTING, Found, Plan
from ryusa_studies.osada2004.figures import drop_chart

FIGURE = "pair"
TITLE = "Contact time with the struck grain free to move"
CLAIMS = ("pair",)
SPEED, DASHPOT, TIMING = "impact speed (pair)", "dashpot (pair)", "timing (pair)"
OF_FIXED = "that of the fixed partner"
DESIGN = design("pair")
SHIPPED = DESIGN.base
LITTLE = Band(
    0.9, 1.1, "-", f"should not differ much: 0.9 to 1.1 of the fixed case, as for fig5; {_drops.ABOUT}"
)


choices = DESIGN.sets


def two(chosen: Mapping[str, str], k_n: float) -> tuple[Setup, Setup]:
    """The drop on a free and on a fixed grain."""
    speed, parting = chosen[SPEED], chosen[PARTING]
    fixed = Setup(k_n=k_n, speed=speed, parting=parting, timing=chosen[TIMING])
    return replace(fixed, partner="free", one_dashpot=chosen[DASHPOT] == OF_FIXED), fixed


def setups(plan: Plan) -> list[Setup]:
    """Every drop."""
    ways = [two(chosen, k_n) for chosen in choices(plan) for k_n in fig05.stiffnesses(plan)]
    return list(dict.fromkeys(one for way in ways for one in way))


tasks, measure, rows = _drops.tasks_of(setups), _drops.measure, _drops.rows_of(setups)


def ratio(found: Found, chosen: Mapping[str, str], k_n: float) -> float:
    """Contact time with a free over that with a fixed partner [-]."""
    free, fixed = (found[one.task] for one in two(chosen, k_n))
    return float(np.median(free.time) / np.median(fixed.time))


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Free over fixed, over all springs."""
    springs = fig05.stiffnesses(plan)
    part = f"contact time, free over fixed partner, k_n = {springs[0]:g} to {springs[-1]:g} N/cm"
    trials = [
        Trial(
            part,
            chosen,
            over_range([ratio(found, chosen, k_n) for k_n in springs], "-", f"{len(springs)} springs"),
            LITTLE,
        )
        for chosen in choices(plan)
    ]
    middle = trials[0].found.value
    also = [f"on the paper's log-log chart {middle:.2f} is {abs(np.log10(middle)):.2f} of a decade"]
    one_dashpot = [one for one in choices(plan) if one[DASHPOT] == OF_FIXED and one[TIMING] == EXACT]
    if one_dashpot:
        e = np.median(found[two(one_dashpot[0], springs[-1])[0].task].e)
        also.append(f"one dashpot for both: e = {e:.2f} between free grains where it is 0.7 on a fixed one")
    return (finding("pair", trials, also=also),)


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Both times over k_n beside Eq. (8) with the mass and with half of it."""
    springs = fig05.stiffnesses(plan)
    k, m = np.array(springs) * 100.0, Setup().m
    lines = [
        figures.StiffnessCurve("Eq. (8)", k, np.array([collision_time(one, s) for s in k]))
        for one in (m, m / 2.0)
    ]
    runs = [
        figures.StiffnessPoints(
            label, k, np.array([np.median(found[two(SHIPPED, s)[at].task].time) for s in springs]), 0 * k
        )
        for label, at in (("run, struck grain fixed", 1), ("run, struck grain free", 0))
    ]
    words = ("Eq. (8) with m, and with m/2", f"d = 0.2 cm, e = 0.7, impact at {_drops.SPEED}")
    return {"pair": drop_chart("time", lines, runs, words=words)}
