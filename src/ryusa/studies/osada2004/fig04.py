"""Fig. 4: contact time against stiffness for grains of 0.05 to 1 cm, run without loss, beside Eq. (8)."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.laws.collision import collision_time
from ryusa.studies.osada2004 import _drops
from ryusa.studies.osada2004._drops import DropRun, Setup
from ryusa.studies.osada2004._parts import CaseRun, Found, Plan
from ryusa.study import Band, Finding, Trial, over_range

FIGURE = "fig4"
TITLE = "Contact time against stiffness, Eq. (8)"
CLAIMS = ("fig4",)
DENSITY = "density (fig4)"
SOFT = 0.01  # the paper's spring [N/cm]
SLOW = "0.01 m/s"  # keeps overlaps small; without weight the contact time does not depend on it
QUOTED = _drops.near(0.01, "s", "about 0.01 s")
SHORTER = Band(0.0, 1.0, "-", "shorter: the ratio is below 1")
HEAVY = ("0.1 m/s", "0.2 m/s", "0.5 m/s")


def stiffnesses(plan: Plan) -> tuple[float, ...]:
    """Springs of the chart [N/cm]."""
    return plan.pick((0.01, 1.0, 100.0), (0.01, 0.1, 1.0, 10.0, 100.0, 1000.0, 1.0e4))


def lossless(d: str, k_n: float, density: str = _drops.DENSITY) -> Setup:
    """The drop of Eq. (8): e = 1, no weight."""
    return Setup(d=d, k_n=k_n, e=1.0, speed=SLOW, weight=False, density=density)


def densities(plan: Plan) -> tuple[str, ...]:
    """Natural sands and gravels."""
    return (_drops.DENSITY, *plan.pick((), ("2500 kg/m3", "2800 kg/m3")))


def weighted(plan: Plan) -> list[Setup]:
    """The paper's spring with the weight that Eq. (8) leaves out, at several speeds."""
    return [Setup(k_n=SOFT, e=1.0, speed=speed) for speed in plan.pick((), HEAVY)]


def setups(plan: Plan) -> list[Setup]:
    """Chart, densities, weight."""
    chart = [lossless(d, k_n) for d in _drops.SIZES for k_n in stiffnesses(plan)]
    others = [lossless(_drops.DIAMETER, SOFT, density) for density in densities(plan)[1:]]
    return chart + others + weighted(plan)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """One run per setup; there is no chance in them, so that every seed would give the same."""
    return [one.task for one in setups(plan)]


measure = _drops.measure


def times(found: Found, plan: Plan) -> np.ndarray:
    """Contact time [s], by diameter, then stiffness."""
    return np.array(
        [[np.median(found[lossless(d, k_n).task].time) for k_n in stiffnesses(plan)] for d in _drops.SIZES]
    )


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """About 0.01 s for the soft spring; shorter for small and for stiff."""
    trials: list[Trial] = []
    for density in densities(plan):
        drop: DropRun = found[lossless(_drops.DIAMETER, SOFT, density).task]
        part = "contact time, d = 0.2 cm, k_n = 0.01 N/cm"
        trials.append(Trial(part, {DENSITY: density}, drop.over_phases(drop.time, "s"), QUOTED))
    grid = times(found, plan)
    smaller = [float(r) for small, large in pairwise(grid) for r in small / large]
    stiffer = [float(r) for soft, stiff in pairwise(grid.T) for r in stiff / soft]
    base = {DENSITY: _drops.DENSITY}
    trials[1:1] = [
        Trial("contact time, next smaller over larger d", base, _ratios(smaller, "diameters"), SHORTER),
        Trial("contact time, next stiffer over softer spring", base, _ratios(stiffer, "springs"), SHORTER),
    ]
    law = np.array([[drop.eq_8 for drop in row] for row in _grid(found, plan)])
    heavy = [(one.speed, found[one.task]) for one in weighted(plan)]
    also = [f"runs over Eq. (8): {np.min(grid / law):.4f} to {np.max(grid / law):.4f}"]
    also += [
        f"with its weight, dropped at {speed}: {_over(drop)} of Eq. (8), overlap/d {_deep(drop)}"
        for speed, drop in heavy
    ]
    return (
        Finding(
            "fig4",
            tuple(trials),
            "For a mass on a spring the contact time is proportional to the square root of mass over "
            "stiffness, and so to d^(3/2). The quoted 0.01 s follows for quartz. It is a value of the "
            "formula rather than of a real contact: on so soft a spring the overlap is large, and the "
            "weight of the grain lengthens the contact.",
            {"restitution": "1", "weight": "none, as in Eq. (8)", "steps per contact": "50"},
            also=tuple(also),
        ),
    )


def _grid(found: Found, plan: Plan) -> list[list[DropRun]]:
    return [[found[lossless(d, k_n).task] for k_n in stiffnesses(plan)] for d in _drops.SIZES]


def _ratios(values: Sequence[float], of_what: str):
    return over_range(values, "-", f"{len(values)} pairs of {of_what}")


def _over(drop: DropRun) -> str:
    return f"{np.median(drop.time) / drop.eq_8:.3g}" if drop.parts else "stays, no number"


def _deep(drop: DropRun) -> str:
    return f"{np.median(drop.overlap):.2g}" if drop.parts else "none"


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per drop."""
    return _drops.rows(setups(plan), found)


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Runs on the lines of Eq. (8), and the number that the paper quotes."""
    k = np.array(stiffnesses(plan)) * 100.0
    lines, runs = [], []
    for d, time in zip(_drops.SIZES, times(found, plan), strict=True):
        m = Setup(d=d).m
        lines.append(figures.StiffnessCurve(d, k, np.array([collision_time(m, one) for one in k])))
        runs.append(figures.StiffnessPoints(f"run, d = {d}", k, time, np.zeros(len(k))))
    quote = figures.QuotedPoint(100.0 * SOFT, 0.01, _drops.DIAMETER)
    words = ("Eq. (8)", "2650 kg/m³, e = 1, no weight")
    return {"fig04": figures.drop_chart("time", lines, runs, quoted=[quote], words=words)}
