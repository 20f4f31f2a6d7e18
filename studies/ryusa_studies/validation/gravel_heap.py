"""Heaps of clumps and of spheres: the angle that shape gives, and rolling friction that stands in for it."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.measure import cone
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, not_negative, over_seeds
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampled import SampledRuns, SeedNumbers

TITLE = "Heaps of clumps and of spheres"
DECLARED = declared(__file__)
CLUMPS = ("pebble", "tetrahedron")
COEFFICIENTS = (0.0, 0.05, 0.1, 0.2)  # of rolling friction of spheres
ROLLING = {"rolling.model": "spring-dashpot-slider", "rolling.arm": "reduced radius"}
FREE_2D = 18.0  # slope of Osada et al. 2004, Fig. 19, rotation free [deg]
LOCKED_2D = 33.0  # rotation locked [deg]
GRAVEL = 38.0  # of real gravel, as that paper gives it [deg]


def _spheres(coefficient: float) -> dict[str, str]:
    rolling = {**ROLLING, "rolling.coefficient": f"{coefficient:g}"} if coefficient else {}
    return {"grains.shape": "sphere", **rolling}


RUNS = SampledRuns(
    "gravel_heap", "gravel_heap.toml",
    {one: {"grains.shape": one} for one in CLUMPS} | {one: _spheres(one) for one in COEFFICIENTS},
)  # fmt: skip
tasks = RUNS.tasks


def measure(run: Results, one: CaseRun) -> dict[str, float]:
    """Angle of the heap [deg], and the share of its grains that still move [-]."""
    del one
    found = cone(run)
    return {"angle": math.degrees(found.angle), "moving": found.moving}


@RUNS.judge
def judge(runs: SeedNumbers) -> Sequence[Finding]:
    """Clumps stand steeper than spheres; spheres stand steeper the more rolling is resisted."""
    x = np.array(COEFFICIENTS)
    slopes = np.array([runs("angle", one) for one in COEFFICIENTS])  # coefficient, seed
    clumps = {one: runs("angle", one) for one in CLUMPS}
    moving = np.max([runs("moving", one) for one in RUNS.settings], axis=0)
    ends = np.array([x[0], x[-1]])
    return [
        DECLARED["shape"].finding(
            [
                Curve("spheres", x, slopes.mean(axis=1)),
                *(
                    Curve(f"{one}s, no rolling friction", ends, np.full(2, angle.mean()))
                    for one, angle in clumps.items()
                ),
            ],
            [
                Curve("the paper, rotation free", ends, np.full(2, FREE_2D)),
                Curve("the paper, rotation locked", ends, np.full(2, LOCKED_2D)),
                Curve("real gravel, in the paper", ends, np.full(2, GRAVEL)),
            ],
            {
                "steeper": {one: angle - slopes[0] for one, angle in clumps.items()},
                "by-rolling": slopes[2] - slopes[0], "moving": not_negative(over_seeds(moving.tolist(), "-")),
                "coefficient": {
                    one: [_standing_in(x, slopes[:, k], float(a)) for k, a in enumerate(angle)]
                    for one, angle in clumps.items()
                },
            },
        ),
    ]  # fmt: skip


def _standing_in(x: Floats, slopes: Floats, angle: float) -> float:
    """Coefficient at which spheres first have that angle, linear between runs; nan where none has.

    >>> _standing_in(np.array([0.0, 0.1, 0.2]), np.array([20.0, 30.0, 34.0]), 25.0)
    0.05
    >>> math.isnan(_standing_in(np.array([0.0, 0.1]), np.array([20.0, 30.0]), 31.0))
    True
    """
    for k in range(1, len(x)):
        if slopes[k - 1] <= angle <= slopes[k]:
            share = (angle - slopes[k - 1]) / (slopes[k] - slopes[k - 1])
            return float(x[k - 1] + share * (x[k] - x[k - 1]))
    return math.nan
