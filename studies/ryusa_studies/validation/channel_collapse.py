"""Collapse of a granular column in a channel: how far it spreads, over its aspect ratio."""

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

TITLE = "Collapse of a column in a channel"
LAYERS = (13, 27, 54)  # aspect ratios of about 0.5, 1 and 2
MIDDLE = LAYERS[1]
# a control that must fail: grains that hardly slide or roll
ROUGH = {"contact.friction": "5", "rolling.coefficient": "2"}
TALL = {"timeline.0.at": "0.4 s", "stop.time": "1.2 s"}  # settles and spreads for longer


def lube(a: float) -> float:
    """Run-out over the length of a column of aspect ratio a [-], Lube et al. 2005: sand, rice, sugar.

    >>> lube(1.0), round(lube(8.0), 3)
    (1.2, 7.6)
    """
    return 1.2 * a if a < 2.3 else 1.9 * a ** (2.0 / 3.0)


def lajeunesse(a: float) -> float:
    """Run-out over the length of a column of aspect ratio a [-], Lajeunesse et al. 2005: glass beads.

    >>> lajeunesse(1.0), round(lajeunesse(8.0), 3)
    (1.8, 9.2)
    """
    return 1.8 * a if a < 3.0 else 2.3 * a ** (2.0 / 3.0)


def _run(layers: int, seed: int, rough: bool = False) -> CaseRun:
    changed = {"build.layers": f"{layers}", **(ROUGH if rough else {}), **(TALL if layers > MIDDLE else {})}
    return case_run(case_path("channel_collapse.toml"), changed, seed=seed)


def tasks(plan: Plan) -> Sequence[Task]:
    """Runs of a minute, at the full level alone: the others have an hour on two cores."""
    if plan.level is not Level.FULL:
        return []
    seeds = SAMPLING["channel_collapse"].seeds(plan)
    return [*(_run(n, seed) for seed in seeds for n in LAYERS), *(_run(MIDDLE, seed, True) for seed in seeds)]


def measure(run: Results, one: CaseRun) -> dict[str, float]:
    """Aspect ratio before the release, run-out and height over the length of the column at the end [-]."""
    del one
    t = np.asarray(run.frames.t)
    released = float(run.case["timeline"][0]["at"])
    before = run.frames.x[int(np.searchsorted(t, released, "right")) - 1]
    heap = surface(run)
    return {
        "aspect": 2.0 * float(before[:, 2].mean()) / heap.start,
        "run_out": heap.run_out / heap.start,
        "height": heap.crest / heap.start,
        "moving": heap.moving,
    }


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Run-out between the two published laws, and a control short of them."""
    if plan.level is not Level.FULL:
        return []
    seeds = SAMPLING["channel_collapse"].seeds(plan)

    def each(key: str, n: int, rough: bool = False) -> list[float]:
        return [float(found[_run(n, seed, rough)][key]) for seed in seeds]

    aspects = np.array([float(np.mean(each("aspect", n))) for n in LAYERS])
    bands = [_band(float(a)) for a in aspects]
    fine = np.linspace(0.9 * aspects[0], 1.1 * aspects[-1], 80)
    control = each("run_out", MIDDLE, True)
    low = bands[LAYERS.index(MIDDLE)].low
    return [
        comparison(
            "run-out", "Run-out of a column in a channel over its aspect ratio",
            Source(
                "Lube et al. 2005; Lajeunesse et al. 2005, both as quoted by Lagree, Staron & Popinet 2011",
                Known.QUOTED,
            ),
            Axis("height over length of the column"), Axis("run-out over length"),
            [
                Curve("grains", aspects, np.array([float(np.mean(each("run_out", n))) for n in LAYERS])),
                Curve("friction 5, rolling friction 2", aspects[1:2], np.array([float(np.mean(control))])),
            ],
            [Curve("Lube", fine, _over(lube, fine)), Curve("Lajeunesse", fine, _over(lajeunesse, fine))],
            [
                *(
                    misfit(f"aspect ratio {a:.2f}", over_seeds(each("run_out", n), "-"), "-", band)
                    for n, a, band in zip(LAYERS, aspects, bands, strict=True)
                ),
                misfit(
                    "control that must fail, less the lower limit",
                    over_seeds([one - low for one in control], "-"), "-",
                    Band(-math.inf, 0.0, "-", "grains that hardly slide or roll stay short of the laws"),
                ),
                *(
                    misfit(f"height over length at aspect ratio {a:.2f}", over_seeds(each("height", n), "-"))
                    for n, a in zip(LAYERS, aspects, strict=True)
                ),
                misfit("share of grains that move at the end", over_seeds(each("moving", LAYERS[-1]), "-")),
            ],
            {
                "grains": "2.5 mm, +- 10 %", "friction": "0.5, also on the floor", "rolling friction": "0.1",
                "channel": "periodic across, 7 diameters; column 16 diameters long",
            },
        ),
    ]  # fmt: skip


def _band(a: float) -> Band:
    laws = lube(a), lajeunesse(a)
    return Band(0.9 * min(laws), 1.1 * max(laws), "-", "between the two laws, and 10 % beyond")


def _over(law: Callable[[float], float], a: Floats) -> Floats:
    return np.array([law(float(one)) for one in a])
