"""The hole that a jet digs below a sill with air under its nappe, by Schoklitsch (design/0030)."""

from collections.abc import Sequence

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.measure.long_section import row_of
from ryusa.measure.scour import scour
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Task, case_run
from ryusa_studies.validation.declared import declared

DECLARED = declared(__file__)

CASE = "scour"
LAST = 5.0  # at the end of the run, over which the depth is averaged [s]


def jet(seed: int = 1) -> CaseRun:
    """The packaged case."""
    return case_run(case_path("scour.toml"), seed=seed)


def tasks() -> Sequence[Task]:
    """Ten minutes."""
    return [jet()]


def measure(run: Results, _one: CaseRun) -> dict[str, Floats]:
    """Numbers of a scour.

    Returns
    -------
    Over the times `t` [s] the `depth` of the hole [m]; `expected`, that of Schoklitsch in the end, mean
    `head` and `tail` water [m], and discharge `q` over the dam [m2/s].
    """
    found, row = scour(run), row_of(run)
    over = row.row.dams[0]
    q = row.discharge[row.t >= found.t[0]][:, over.end].mean()
    return {
        "t": found.t, "depth": found.depth, "expected": np.array(found.expected), "q": np.array(q),
        "head": np.array(found.head.mean()), "tail": np.array(found.tail.mean()),
    }  # fmt: skip


def judge(found: Found) -> Sequence[Finding]:
    """Depth after 15 s over that in the end."""
    one = found[jet()]
    t, depth, expected = one["t"], one["depth"], float(one["expected"])
    ratio = float(depth[t > t[-1] - LAST].mean()) / expected
    finding = DECLARED["scour"].finding(
        [Curve("row", t, 1e2 * depth)],
        [Curve("Schoklitsch, in the end", t[[0, -1]], np.full(2, 1e2 * expected))],
        {"depth": ratio}, head=1e2 * float(one["head"]), tail=1e2 * float(one["tail"]), q=float(one["q"]),
    )  # fmt: skip
    return [finding]
