"""Softer runs extrapolated beside stiff runs that the extrapolation does not see: design/0016.

    python tests/campaigns/soften/check_stiff.py FOLDER [NAME ...]  # the table of the note; 20 core minutes

Cases, seeds and criteria were fixed before the first of these runs. An interrupted check continues when
started again with the same folder.
"""

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import stats

from ryusa.campaigns.soften import Softening, study_of
from ryusa.campaigns.soften.scaling import softened
from ryusa.cases import case_path
from ryusa.study import Plan, ProgressLines, carry_out, case_run, over_seeds

STIFF_FROM = 101  # first seed of the stiff runs; the softer runs have seeds from 1 on


@dataclass(frozen=True)
class Check:
    """A case, what is asked of it, and how narrow the bracket must be for the check to mean anything."""

    case: str
    changes: dict[str, str]
    measure: str
    value: str
    to: str
    seeds: int  # of each softer stiffness
    stiff: dict[float, int]  # stiffness over that of the case -> seeds
    widest: float  # half of the bracket at the stiffness of the case, as a share of its middle [-]


CHECKS = {
    "bed load": Check(
        "bedload_3d.toml", {"build.length": "4.8 cm", "build.layers": "4"},
        "transport", "q_star", "10 %", 5, {1.0: 4}, 0.06,
    ),
    "heap": Check(
        "heap.toml", {"stop.time": "1.6 s"}, "surface", "slope", "10 %", 16, {1.0: 16, 4.0: 12}, 0.08
    ),
    "incline": Check(
        "validation/incline.toml",
        {
            "build.columns": "8", "build.rows": "6", "build.layers": "8", "stop.time": "4 s",
            "record.settle": "2 s", "timeline.0.slope_angle": "26 deg",
        },
        "profile", "speed", "20 %", 8, {1.0: 6}, 0.16,
    ),
}  # fmt: skip


def main(folder: Path, names: list[str]) -> None:
    """Run the checks and print a line for each criterion."""
    for name in names or CHECKS:
        one = CHECKS[name]
        study = study_of(case_path(one.case), one.measure, one.to, value=one.value, overrides=one.changes)
        part, plan, place = study.part("soften"), Plan(seeds=tuple(range(1, one.seeds + 1))), folder / name
        own = case_run(case_path(one.case), one.changes)
        stiff = {
            times: [
                case_run(
                    case_path(one.case), {**dict(softened(own, 1.0 / times).overrides)}, seed=STIFF_FROM + k
                )
                for k in range(seeds)
            ]
            for times, seeds in one.stiff.items()
        }
        tasks = [*part.tasks(plan), *(each for every in stiff.values() for each in every)]
        found = carry_out({"soften": tasks}, study.part, place, jobs=1, progress=ProgressLines()).found[
            "soften"
        ]
        answer = part.softening(found, plan)
        print(f"\n## {name}: {one.measure} {one.value}, {answer.says}")
        for each in answer.runs:
            print(f"k_n/{each.factor:g}: {each.mean:.4g}, sd {np.std(each.values, ddof=1):.2g}")
        for times, every in stiff.items():
            values = [found[each]["value"] for each in every]
            _report(one, answer, times, values)


def _report(one: Check, answer: Softening, times: float, values: list[float]) -> None:
    """Criterion 1 at one stiffness, and at that of the case criteria 2 and 3."""
    assert answer.fit is not None
    bracket, mean = answer.fit.value(times * answer.k_n), over_seeds(values, "-")
    overlap = mean.low <= bracket.high and bracket.low <= mean.high
    print(
        f"{times:g} k_n: measured {mean.value:.4g} ({mean.low:.4g} to {mean.high:.4g}), bracket "
        f"{bracket.value:.4g} ({bracket.low:.4g} to {bracket.high:.4g}): {'reached' if overlap else 'MISSED'}"
    )
    if times != 1.0:
        return
    half = 0.5 * (bracket.high - bracket.low) / bracket.value
    print(f"half of the bracket {100 * half:.1f} %: {'reached' if half <= one.widest else 'MISSED'}")
    allowed = answer.question.tolerance.amount
    for error in answer.errors:
        value, low, high = _quotient(error.runs.values, values)
        wrong = (error.within is True and (low > allowed or high < -allowed)) or (
            error.within is False and -allowed <= low and high <= allowed
        )
        print(
            f"k_n/{error.runs.factor:g}: said {error.within} ({100 * error.error.low:.1f} to "
            f"{100 * error.error.high:.1f} %), measured {100 * value:.1f} "
            f"({100 * low:.1f} to {100 * high:.1f} %): {'MISSED' if wrong else 'reached'}"
        )


def _quotient(soft: tuple[float, ...], stiff: list[float]) -> tuple[float, float, float]:
    """Mean of the softer runs over that of the stiff ones less 1, with its 95 % interval (Welch)."""
    a, b = np.asarray(soft), np.asarray(stiff)
    ratio = a.mean() / b.mean()
    parts = a.var(ddof=1) / len(a) / a.mean() ** 2, b.var(ddof=1) / len(b) / b.mean() ** 2
    freedom = sum(parts) ** 2 / (parts[0] ** 2 / (len(a) - 1) + parts[1] ** 2 / (len(b) - 1))
    half = float(stats.t.ppf(0.975, freedom)) * ratio * math.sqrt(sum(parts))
    return ratio - 1.0, ratio - 1.0 - half, ratio - 1.0 + half


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
