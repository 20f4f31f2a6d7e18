"""Collapse of a granular column on a plane: how far it spreads, over its aspect ratio."""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.measure import surface
from ryusa.results import Results
from ryusa.study import Band, CaseRun, Finding, misfit, over_seeds
from ryusa_studies.validation.declared import Declared, Numbers, declared
from ryusa_studies.validation.sampled import SampledRuns, SeedNumbers

TITLE = "Collapse of a column"
DECLARED = declared(__file__)
GRAINS = (1800, 3600, 7200)  # aspect ratios of about 0.5, 1 and 2
# Of the tube [m], of the case file [s]; in which the foot is sought.
RADIUS, RELEASED, SECTORS = 0.025, 0.3, 12
# a control that must fail: grains that hardly slide or roll
ROUGH = {"contact.friction": "5", "rolling.coefficient": "2"}
CONTROL = "friction 5, rolling friction 2"
TALL = {  # a higher box, and longer on the way
    "build.high": '["1.75 cm", "1.75 cm", "18 cm"]',
    "walls": '[{ name = "tube", shape = "cylinder", at = ["0 cm", "0 cm", "0 cm"], '
    'axis = ["0 cm", "0 cm", "20 cm"], radius = "2.5 cm" }]',
}
RUNS = SampledRuns(
    "collapse", "column_collapse.toml",
    {
        **{one: {"build.most": f"{one}", **(TALL if one > GRAINS[1] else {})} for one in GRAINS},
        CONTROL: {"build.most": f"{GRAINS[1]}", **ROUGH},
    },
)  # fmt: skip
tasks = RUNS.tasks
Law = Callable[[float], float]


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


@RUNS.judge
def judge(runs: SeedNumbers) -> Sequence[Finding]:
    """Run-out between the two published laws, and a control beyond them."""
    laws = {"Lube": lube, "Lajeunesse": lajeunesse}
    more = {"moving": runs("moving", GRAINS[1])}
    return [run_out(DECLARED["run-out"], runs, GRAINS, laws, lambda a: _band(lube(a), lajeunesse(a)), more)]


def run_out(
    finding: Declared, runs: SeedNumbers, columns: Sequence[int], laws: Mapping[str, Law],
    band: Callable[[float], Band], more: Numbers,
) -> Finding:  # fmt: skip
    """Run-out of columns beside laws, and of the control, whose grains are those of the second column.

    Parameters
    ----------
    columns : settings of `runs` from low to high.
    band : what is asked at an aspect ratio.
    more : further numbers.
    """
    aspects = runs.means("aspect", columns)
    fine = np.linspace(0.9 * aspects[0], 1.1 * aspects[-1], 80)
    ratios = {one: float(a) for one, a in zip(columns, aspects, strict=True)}
    return finding.finding(
        [
            Curve("grains", aspects, runs.means("run_out", columns)),
            Curve(CONTROL, aspects[1:2], runs.means("run_out", [CONTROL])),
        ],
        [Curve(name, fine, np.array([law(float(a)) for a in fine])) for name, law in laws.items()],
        {
            "aspect": {
                one: misfit(
                    f"aspect ratio {a:.2f}", over_seeds(runs("run_out", one).tolist(), "-"), "-", band(a)
                )
                for one, a in ratios.items()
            },
            "control": runs("run_out", CONTROL) - band(ratios[columns[1]]).low,
            **more,
        },
    )  # fmt: skip


def _band(*laws: float) -> Band:
    return Band(0.9 * min(laws), 1.1 * max(laws), "-", "between the two laws, and 10 % beyond")
