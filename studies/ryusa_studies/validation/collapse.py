"""Collapse of a granular column on a plane: how far it spreads, over its aspect ratio."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Axis, Curve
from ryusa.measure import surface
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
    case_run,
    comparison,
    misfit,
    over_seeds,
)
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "Collapse of a column"
GRAINS = (1800, 3600, 7200)  # aspect ratios of about 0.5, 1 and 2
# Of the tube [m], of the case file [s]; in which the foot is sought.
RADIUS, RELEASED, SECTORS = 0.025, 0.3, 12
# a control that must fail: grains that hardly slide or roll
ROUGH = {"contact.friction": "5", "rolling.coefficient": "2"}


def lube(a: float) -> float:
    """Run-out over the radius of a column of aspect ratio a [-], Lube et al. 2004.

    >>> lube(1.0), lube(4.0)
    (1.24, 3.2)
    """
    return 1.24 * a if a < 1.7 else 1.6 * math.sqrt(a)


def lajeunesse(a: float) -> float:
    """Run-out over the radius of a column of aspect ratio a [-], Lajeunesse et al. 2004.

    >>> lajeunesse(0.5), lajeunesse(4.0)
    (0.5, 4.0)
    """
    return a if a < 0.74 else 2.0 * math.sqrt(a)


def _run(grains: int, seed: int, rough: bool = False) -> CaseRun:
    changed = {"build.most": f"{grains}", **(ROUGH if rough else {})}
    if grains > 3600:  # a higher box, and longer on the way
        changed |= {"build.high": '["1.75 cm", "1.75 cm", "18 cm"]', "walls": _TALL}
    return case_run(case_path("column_collapse.toml"), changed, seed=seed)


_TALL = (
    '[{ name = "tube", shape = "cylinder", at = ["0 cm", "0 cm", "0 cm"], '
    'axis = ["0 cm", "0 cm", "20 cm"], radius = "2.5 cm" }]'
)


def tasks(plan: Plan) -> Sequence[Task]:
    """Runs of a minute, at the full level alone: the others have an hour on two cores."""
    if plan.level is not Level.FULL:
        return []
    seeds = SAMPLING["collapse"].seeds(plan)
    return [*(_run(n, seed) for seed in seeds for n in GRAINS), *(_run(3600, seed, True) for seed in seeds)]


def measure(run: Results, one: CaseRun) -> dict[str, float]:
    """Aspect ratio before the release [-], and run-out over the radius of the tube at the end [-]."""
    del one
    t = np.asarray(run.frames.t)
    before = run.frames.x[int(np.searchsorted(t, RELEASED, "right")) - 1]
    heap = surface(run, floor=0.0)
    x, r = run.frames.x[-1][heap.grains], 0.5 * run.scene.d[heap.grains]
    away = np.hypot(x[:, 0], x[:, 1]) + r
    sector = np.floor((np.arctan2(x[:, 1], x[:, 0]) / (2.0 * math.pi) + 0.5) * SECTORS).astype(int) % SECTORS
    foot = float(np.mean([away[sector == k].max() for k in range(SECTORS)]))
    return {
        "aspect": 2.0 * float(before[:, 2].mean()) / RADIUS,
        "run_out": foot / RADIUS - 1.0,
        "height": heap.crest / RADIUS,
        "moving": heap.moving,
    }


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Run-out between the two published laws, and a control beyond them."""
    if plan.level is not Level.FULL:
        return []
    seeds = SAMPLING["collapse"].seeds(plan)

    def mean(key: str, n: int, rough: bool = False) -> list[float]:
        return [float(found[_run(n, seed, rough)][key]) for seed in seeds]

    aspects = np.array([float(np.mean(mean("aspect", n))) for n in GRAINS])
    bands = [_band(float(a)) for a in aspects]
    fine = np.linspace(0.9 * aspects[0], 1.1 * aspects[-1], 80)
    control = mean("run_out", 3600, True)
    low = bands[GRAINS.index(3600)].low
    return [
        comparison(
            "run-out", "Run-out of a column over its aspect ratio",
            Source("Lube et al. 2004; Lajeunesse et al. 2004: dry grains of several kinds", Known.QUOTED),
            Axis("height over radius of the column"), Axis("run-out over radius"),
            [
                Curve("grains", aspects, np.array([float(np.mean(mean("run_out", n))) for n in GRAINS])),
                Curve("friction 5, rolling friction 2", aspects[1:2], np.array([float(np.mean(control))])),
            ],
            [Curve("Lube", fine, _over(lube, fine)), Curve("Lajeunesse", fine, _over(lajeunesse, fine))],
            [
                *(
                    misfit(f"aspect ratio {a:.2f}", over_seeds(mean("run_out", n), "-"), "-", band)
                    for n, a, band in zip(GRAINS, aspects, bands, strict=True)
                ),
                misfit(
                    "control that must fail, less the lower limit",
                    over_seeds([one - low for one in control], "-"), "-",
                    Band(-math.inf, 0.0, "-", "grains that hardly slide or roll stay short of the laws"),
                ),
                misfit("share of grains that move at the end", over_seeds(mean("moving", 3600), "-")),
            ],
            {
                "grains": "2.5 mm, +- 10 %", "friction": "0.5", "rolling friction": "0.1",
                "radius": "10 diameters",
            },
        ),
    ]  # fmt: skip


def _band(a: float) -> Band:
    laws = lube(a), lajeunesse(a)
    return Band(0.9 * min(laws), 1.1 * max(laws), "-", "between the two laws, and 10 % beyond")


def _over(law: Callable[[float], float], a: Floats) -> Floats:
    return np.array([law(float(one)) for one in a])
