"""Fig. 4: contact time against stiffness for grains of 0.05 to 1 cm, run without loss, beside Eq. (8)."""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.laws.collision import collision_time
from ryusa.study import Band, Finding, Interval, Trial, over_range
from ryusa_studies.osada2004 import _drops
from ryusa_studies.osada2004._drops import DropRun, Setup
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import Found, Plan
from ryusa_studies.osada2004.figures import QuotedPoint, drop_chart

FIGURE = "fig4"
TITLE = "Contact time against stiffness, Eq. (8)"
CLAIMS = ("fig4",)
DENSITY, WEIGHT, SPEED, TIMING = "density (fig4)", "weight (fig4)", "impact speed (fig4)", "timing (fig4)"
NONE = "none, as in Eq. (8)"
SOFT = 0.01  # the paper's spring [N/cm]
FIRM = 100.0  # of the ratios of diameters [N/cm]
SPRINGS = (0.01, 1.0, 100.0)  # of the ratios of springs [N/cm]
DESIGN = design("fig04")
QUOTED = _drops.near(0.01, "s", "about 0.01 s")
SHORTER = Band(0.0, 1.0, "-", "shorter: the ratio is below 1")
STAYS = "stays on its partner: weight against a soft spring"


def stiffnesses(plan: Plan) -> tuple[float, ...]:
    """Springs of the chart [N/cm]."""
    return plan.pick((0.01, 1.0, 100.0), (0.01, 0.1, 1.0, 10.0, 100.0, 1000.0, 1.0e4))


def lossless(d: str, k_n: float) -> Setup:
    """The drop of Eq. (8): e = 1, no weight."""
    return setup(DESIGN.base, d, k_n)


def setup(chosen: Mapping[str, str], d: str, k_n: float) -> Setup:
    """One drop in a setting."""
    return Setup(
        d=d, k_n=k_n, e=1.0, speed=chosen[SPEED], weight=chosen[WEIGHT] != NONE, density=chosen[DENSITY],
        timing=chosen[TIMING],
    )  # fmt: skip


def compared(chosen: Mapping[str, str]) -> tuple[list[Setup], list[Setup]]:
    """Drops by diameter, and by spring from the softest on, each shorter or longer than the one before."""
    sizes = [setup(chosen, d, FIRM) for d in _drops.SIZES]
    return sizes, [setup(chosen, _drops.DIAMETER, k_n) for k_n in SPRINGS]


def setups(plan: Plan) -> list[Setup]:
    """The chart, and what each setting compares."""
    chart = [lossless(d, k_n) for d in _drops.SIZES for k_n in stiffnesses(plan)]
    sets = [compared(chosen) for chosen in DESIGN.sets(plan)]
    return list(dict.fromkeys([*chart, *(one for sizes, springs in sets for one in (*sizes, *springs))]))


tasks, measure, rows = _drops.tasks_of(setups), _drops.measure, _drops.rows_of(setups)


def times(found: Found, plan: Plan) -> np.ndarray:
    """Contact time [s], by diameter, then stiffness."""
    return np.array(
        [[np.median(found[lossless(d, k_n).task].time) for k_n in stiffnesses(plan)] for d in _drops.SIZES]
    )


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """About 0.01 s for the soft spring; shorter for small and for stiff."""
    trials: list[Trial] = []
    for chosen in DESIGN.sets(plan):
        sizes, springs = ([found[one.task] for one in each] for each in compared(chosen))
        soft: DropRun = springs[0]
        quoted = "contact time, d = 0.2 cm, k_n = 0.01 N/cm"
        trials += [
            _trial(quoted, chosen, [soft], soft.over_phases(soft.time, "s"), QUOTED),
            _shorter("contact time, next smaller over larger d", chosen, sizes[::-1], "diameters"),
            _shorter("contact time, next stiffer over softer spring", chosen, springs, "springs"),
        ]
    grid = times(found, plan)
    law = np.array([[drop.eq_8 for drop in row] for row in _grid(found, plan)])
    also = [f"runs over Eq. (8): {np.min(grid / law):.4f} to {np.max(grid / law):.4f}"]
    return (finding("fig4", trials, also=also),)


def _grid(found: Found, plan: Plan) -> list[list[DropRun]]:
    return [[found[lossless(d, k_n).task] for k_n in stiffnesses(plan)] for d in _drops.SIZES]


def _shorter(part: str, chosen: Mapping[str, str], drops: Sequence[DropRun], of_what: str) -> Trial:
    """Contact times, each over the one before."""
    times = [float(np.median(one.time)) if one.parts else math.nan for one in drops]
    ratios = over_range([b / a for a, b in pairwise(times)], "-", f"{len(drops) - 1} pairs of {of_what}")
    return _trial(part, chosen, drops, ratios, SHORTER)


def _trial(
    part: str, chosen: Mapping[str, str], drops: Sequence[DropRun], value: Interval, band: Band
) -> Trial:
    """A trial that fails where a grain stays and has no contact time."""
    if all(one.parts for one in drops):
        return Trial(part, chosen, value, band)
    return Trial(part, chosen, value, band, False, STAYS)


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Runs on the lines of Eq. (8), and the number that the paper quotes."""
    k = np.array(stiffnesses(plan)) * 100.0
    lines, runs = [], []
    for d, time in zip(_drops.SIZES, times(found, plan), strict=True):
        m = Setup(d=d).m
        lines.append(figures.StiffnessCurve(d, k, np.array([collision_time(m, one) for one in k])))
        runs.append(figures.StiffnessPoints(f"run, d = {d}", k, time, np.zeros(len(k))))
    quote = QuotedPoint(100.0 * SOFT, 0.01, _drops.DIAMETER)
    words = ("Eq. (8)", "2650 kg/m³, e = 1, no weight")
    return {"fig04": drop_chart("time", lines, runs, quoted=[quote], words=words)}
