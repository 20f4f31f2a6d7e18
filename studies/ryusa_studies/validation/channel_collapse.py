"""Collapse of a granular column in a channel: how far it spreads, over its aspect ratio."""

from collections.abc import Sequence

import numpy as np

from ryusa.measure import surface
from ryusa.results import Results
from ryusa.study import Band, CaseRun, Finding
from ryusa_studies.validation.collapse import CONTROL, ROUGH, run_out
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampled import SampledRuns, SeedNumbers

TITLE = "Collapse of a column in a channel"
DECLARED = declared(__file__)
LAYERS = (13, 27, 54)  # aspect ratios of about 0.5, 1 and 2
MIDDLE = LAYERS[1]
TALL = {"timeline.0.at": "0.4 s", "stop.time": "1.2 s"}  # settles and spreads for longer
RUNS = SampledRuns(
    "channel_collapse", "channel_collapse.toml",
    {
        **{one: {"build.layers": f"{one}", **(TALL if one > MIDDLE else {})} for one in LAYERS},
        CONTROL: {"build.layers": f"{MIDDLE}", **ROUGH},
    },
)  # fmt: skip
tasks = RUNS.tasks


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


@RUNS.judge
def judge(runs: SeedNumbers) -> Sequence[Finding]:
    """Run-out between the two published laws, and a control short of them."""
    laws, one = {"Lube": lube, "Lajeunesse": lajeunesse}, DECLARED["run-out"]
    heights = {
        n: one.trial("height", runs("height", n), f"{a:.2f}")
        for n, a in zip(LAYERS, runs.means("aspect", LAYERS), strict=True)
    }
    more = {"height": heights, "moving": runs("moving", LAYERS[-1])}
    return [run_out(one, runs, LAYERS, laws, lambda a: _band(lube(a), lajeunesse(a)), more)]


def _band(*laws: float) -> Band:
    return Band(0.9 * min(laws), 1.1 * max(laws), "-", "between the two laws, and 10 % beyond")
