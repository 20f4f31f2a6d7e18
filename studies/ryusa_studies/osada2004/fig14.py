"""Fig. 14: concentration over height of a dry avalanche, collision time 0.01 s and 0.0001 s."""

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.study import Finding, short
from ryusa_studies.osada2004 import _avalanche
from ryusa_studies.osada2004._avalanche import FIRST, SHIPPED, SOFT, STIFF, RunPair, together, unlike
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import Found, Plan

FIGURE = "fig14"
TITLE = "Concentration of a dry avalanche"
CLAIMS = ("fig14",)
PART = "difference of the two profiles of concentration, means over seeds, over their mean"
ALIKE = band("fig14", PART)

tasks, measure, rows = _avalanche.tasks, _avalanche.measure, _avalanche.rows


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Alike, where both are avalanches."""
    alike = _avalanche.trials(found, plan, PART, together(unlike), ALIKE)
    base = _avalanche.pairs(found, plan, SHIPPED, FIRST)
    depth = [float(np.mean([(p.soft if k == 0 else p.stiff).profile.top() for p in base])) for k in range(2)]
    volume = float(np.mean([p.soft.profile.volume.mean() for p in base]))
    return (
        finding(
            "fig14",
            (*alike, *_avalanche.flows(found, plan)),
            also=_scatter(base),
            volume=short(100 * volume),
            least=short(100 * depth[0]),
            most=short(100 * depth[1]),
        ),
    )


def _scatter(base: Sequence[RunPair]) -> tuple[str, ...]:
    """How much two runs of the same collision time differ that have other seeds."""
    if len(base) < 2:
        return ()
    halves = {SOFT: [one.soft for one in base], STIFF: [one.stiff for one in base]}
    lines = [
        f"{short(float(np.mean([unlike([RunPair(a, b)]) for a, b in combinations(runs, 2)])))} with {time}"
        for time, runs in halves.items()
    ]
    return (f"single runs that differ only in the seed differ by {', '.join(lines)}",)


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Concentration against height, as in the paper."""
    (pair, *_) = _avalanche.pairs(found, plan, SHIPPED, FIRST)
    both = {SOFT: pair.soft.profile, STIFF: pair.stiff.profile}
    return {"fig14": figures.profiles(both, ("phi",), area=True)}
