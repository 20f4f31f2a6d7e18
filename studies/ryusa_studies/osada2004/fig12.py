"""Fig. 12: the same band for large grains, and why it cannot hold two contact times that differ by 100."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa.measure.stability import BAND
from ryusa.study import Finding, Trial, over_range
from ryusa.units import quantity
from ryusa_studies.osada2004 import _drops, fig11
from ryusa_studies.osada2004._drops import DropRun, Setup
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import Found, Plan
from ryusa_studies.osada2004.figures import QuotedPoint, drop_chart

FIGURE = "fig12"
TITLE = "The stable band for large grains"
CLAIMS = ("fig12",)
SPEED = "impact speed (fig12)"
D = "20 cm"
SHIPPED = "3 m/s"  # ten times that of 0.2 cm grains: grows as the root of g d
TIMES = ("0.01 s", "0.0001 s")


def speeds(plan: Plan) -> tuple[str, ...]:
    """Impact speeds tried, the shipped one first."""
    more = ("0.1 m/s", "0.2 m/s", "0.5 m/s", "0.8 m/s", "1 m/s", "10 m/s", "20 m/s", "50 m/s", "80 m/s")
    return (SHIPPED, *plan.pick((), more))


def stiffnesses(plan: Plan) -> tuple[float, ...]:
    """Springs of the chart [N/cm]."""
    return plan.pick((1.0e3, 1.0e6, 1.0e9), (1.0e3, 1.0e4, 1.0e5, 1.0e6, 1.0e7, 1.0e8, 1.0e9))


def setups(plan: Plan) -> list[Setup]:
    """Both contact times at every speed, and the chart; what would go through its partner is left out."""
    pairs = [Setup(d=D, time=time, speed=speed) for speed in speeds(plan) for time in TIMES]
    chart = [Setup(d=d, k_n=k_n, speed=SHIPPED) for d in _drops.LARGE for k_n in stiffnesses(plan)]
    return [one for one in pairs if one.deepest < 0.9] + chart


tasks, measure, rows = _drops.tasks_of(setups), _drops.measure, _drops.rows_of(setups)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Both times in the band at one impact speed."""
    trials: list[Trial] = []
    ratios: list[float] = []
    rate: dict[str, list[float]] = {time: [] for time in TIMES}  # overlap/d per m/s
    for speed in speeds(plan):
        middles: list[float] = []
        for time in TIMES:
            one = Setup(d=D, time=time, speed=speed)
            part = f"overlap/d of a contact of {time}, d = {D}"
            if one.deepest >= 0.9:
                nothing = over_range([float("nan")], "-", "no run")
                note = f"would go through its partner (overlap/d {one.deepest:.2g})"
                trials.append(Trial(part, {SPEED: speed}, nothing, fig11.INSIDE, False, note))
                continue
            drop: DropRun = found[one.task]
            trials.append(Trial(part, {SPEED: speed}, drop.over_phases(drop.overlap, "-"), fig11.INSIDE))
            middles.append(trials[-1].found.value)
            rate[time].append(middles[-1] / quantity(speed, "m/s"))
        if len(middles) == len(TIMES):
            ratios.append(middles[0] / middles[1])
    asked = quantity(TIMES[0], "s") / quantity(TIMES[1], "s")
    width = BAND[1] / BAND[0]
    alone = [
        f"{time} for {BAND[0] / np.median(rate[time]):.2g} to {BAND[1] / np.median(rate[time]):.2g} m/s"
        for time in TIMES
    ]
    spread = f"{min(ratios):.3g}" if len(ratios) == 1 else f"{min(ratios):.3g} to {max(ratios):.3g}"
    impossible = (
        "By Eq. (8), overlap/d is proportional to the contact time: the two times differ by a factor "
        f"of {asked:.0f}, and so do the overlaps (runs, with weight: {spread}), so a band that "
        f"spans a factor of {width:g} cannot contain both"
    )
    return (
        finding(
            "fig12",
            trials,
            contradiction=impossible if min(ratios) > width else "",
            alone=" and ".join(alone),
        ),
    )


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Contact times of large grains with the band across them."""
    springs = stiffnesses(plan)
    lines, runs = fig11.times(_drops.LARGE, springs, SHIPPED, found)
    quotes = tuple(QuotedPoint(Setup(d=D, time=time).stiffness, quantity(time, "s"), D) for time in TIMES)
    words = ("Eq. (8)", f"e = 0.7, impact at {SHIPPED}; shaded: overlap/d 0.001 to 0.01")
    region = fig11.band(_drops.LARGE, springs, SHIPPED, found)
    return {"fig12": drop_chart("time", lines, runs, quoted=quotes, band=region, words=words)}
