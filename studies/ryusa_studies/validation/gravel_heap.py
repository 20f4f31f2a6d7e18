"""Heaps of clumps and of spheres: the angle that shape gives, and rolling friction that stands in for it."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Axis, Curve
from ryusa.measure import cone
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import (
    Band,
    CaseRun,
    Finding,
    Found,
    Known,
    Level,
    Plan,
    Source,
    Task,
    at_most,
    case_run,
    comparison,
    misfit,
    not_negative,
    over_seeds,
)
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "Heaps of clumps and of spheres"
CLUMPS = ("pebble", "tetrahedron")
COEFFICIENTS = (0.0, 0.05, 0.1, 0.2)  # of rolling friction of spheres
ROLLING = {"rolling.model": "spring-dashpot-slider", "rolling.arm": "reduced radius"}
FREE_2D = 18.0  # slope of Osada et al. 2004, Fig. 19, rotation free [deg]
LOCKED_2D = 33.0  # rotation locked [deg]
GRAVEL = 38.0  # of real gravel, as that paper gives it [deg]


def _clumps(shape: str, seed: int) -> CaseRun:
    return case_run(case_path("gravel_heap.toml"), {"grains.shape": shape}, seed=seed)


def _spheres(coefficient: float, seed: int) -> CaseRun:
    rolling = {**ROLLING, "rolling.coefficient": f"{coefficient:g}"} if coefficient else {}
    return case_run(case_path("gravel_heap.toml"), {"grains.shape": "sphere", **rolling}, seed=seed)


def tasks(plan: Plan) -> Sequence[Task]:
    """Runs of one to three minutes, at the full level alone: the others have an hour on two cores."""
    if plan.level is not Level.FULL:
        return []
    seeds = SAMPLING["gravel_heap"].seeds(plan)
    return [
        *(_clumps(shape, seed) for seed in seeds for shape in CLUMPS),
        *(_spheres(one, seed) for seed in seeds for one in COEFFICIENTS),
    ]


def measure(run: Results, one: CaseRun) -> dict[str, float]:
    """Angle of the heap [deg], and the share of its grains that still move [-]."""
    del one
    found = cone(run)
    return {"angle": math.degrees(found.angle), "moving": found.moving}


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Clumps stand steeper than spheres; spheres stand steeper the more rolling is resisted."""
    if plan.level is not Level.FULL:
        return []
    seeds = SAMPLING["gravel_heap"].seeds(plan)

    def clumps(shape: str, key: str = "angle") -> Floats:
        return np.array([float(found[_clumps(shape, seed)][key]) for seed in seeds])

    def spheres(coefficient: float, key: str = "angle") -> Floats:
        return np.array([float(found[_spheres(coefficient, seed)][key]) for seed in seeds])

    x = np.array(COEFFICIENTS)
    slopes = np.array([spheres(one) for one in COEFFICIENTS])  # coefficient, seed
    moving = np.max(
        [*(clumps(one, "moving") for one in CLUMPS), *(spheres(one, "moving") for one in COEFFICIENTS)],
        axis=0,
    )
    settings: Mapping[str, str] = {
        "grains": "4 mm, +- 10 %, 600", "friction angle": "30 deg", "restitution": "0.5",
        "heap": "left by a cylinder lifted off a plate of fixed grains", "rolling friction of clumps": "none",
    }  # fmt: skip
    ends = np.array([x[0], x[-1]])
    return [
        comparison(
            "shape", "Angle of a heap: shape of the grains, or rolling friction of spheres",
            Source(
                "Osada, Shimizu & Wakai 2004, Fig. 19: 18 deg with rotation free, 33 deg locked, real gravel "
                "38 deg; in two dimensions",
                Known.READ,
            ),
            Axis("rolling coefficient of spheres"), Axis("angle", "deg"),
            [
                Curve("spheres", x, slopes.mean(axis=1)),
                *(
                    Curve(f"{one}s, no rolling friction", ends, np.full(2, clumps(one).mean()))
                    for one in CLUMPS
                ),
            ],
            [
                Curve("the paper, rotation free", ends, np.full(2, FREE_2D)),
                Curve("the paper, rotation locked", ends, np.full(2, LOCKED_2D)),
                Curve("real gravel, in the paper", ends, np.full(2, GRAVEL)),
            ],
            [
                *(
                    misfit(
                        f"angle of {one}s less that of spheres",
                        over_seeds((clumps(one) - slopes[0]).tolist(), "deg"), "deg",
                        Band(0.0, math.inf, "deg", "clumps lock; spheres without rolling friction roll"),
                    )
                    for one in CLUMPS
                ),
                misfit(
                    f"angle at a rolling coefficient of {COEFFICIENTS[2]:g} less that without",
                    over_seeds((slopes[2] - slopes[0]).tolist(), "deg"), "deg",
                    Band(0.0, math.inf, "deg", "the resistance to rolling is what stands in for shape"),
                ),
                misfit(
                    "share of grains that still move, largest of the heaps",
                    not_negative(over_seeds(moving.tolist(), "-")), "-",
                    at_most(0.05, "an angle of repose is that of a heap at rest"),
                ),
                *(
                    misfit(
                        f"rolling coefficient of spheres with the angle of {one}s",
                        over_seeds(
                            [_standing_in(x, slopes[:, k], float(a)) for k, a in enumerate(clumps(one))], "-"
                        ),
                    )
                    for one in CLUMPS
                ),
            ],
            settings,
            "The paper's heap is two-dimensional, and the friction of the gravel that it mentions is not "
            "known: its angles are shown, and decide nothing.",
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
