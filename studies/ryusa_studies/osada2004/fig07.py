"""Fig. 7: mean contact time at the bed of a saltating grain against stiffness; Fig. 6 is its path."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.measure import Tracks, turned_time
from ryusa.results import Results
from ryusa.study import Finding, short
from ryusa_studies.osada2004 import _saltation
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan
from ryusa_studies.osada2004._saltation import (
    K_N,
    LOCKED,
    SHIPPED,
    SKIM,
    SOFT,
    STIFF,
    SaltationRun,
    listed,
)
from ryusa_studies.osada2004.figures.saltation import contact_times_over_stiffness

FIGURE = "fig7"
TITLE = "Contact time of a saltating grain, and its path"
CLAIMS = ("fig7",)
PART = "mean contact time over Eq. (8)"


@dataclass(frozen=True)
class Point:
    """One run; its whole path where Fig. 6 shows it."""

    hops: SaltationRun
    path: Tracks | None


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of choices, each with a stiffness."""
    return _saltation.settings(plan, K_N)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Rotation locked: every set of choices, and the series over stiffness."""
    runs = [_run(one, seed) for one in settings(plan) for seed in plan.seeds]
    runs += [_series(keys, seed) for keys in _saltation.series(plan).values() for seed in plan.seeds]
    return list(dict.fromkeys(runs))


def _run(chosen: Mapping[str, str], seed: int) -> CaseRun:
    return _saltation.run(chosen, LOCKED, seed)


def _series(keys: Mapping[str, str], seed: int) -> CaseRun:
    return _saltation.run(SHIPPED, LOCKED, seed, keys)


def measure(run: Results, one: CaseRun) -> Point:
    """Hops of all starts."""
    shown = one == _run({**SHIPPED, K_N: SOFT}, run.case["seed"])
    return Point(_saltation.hops(run), _saltation.whole_path(run) if shown else None)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Contact time over Eq. (8), by choices and stiffness."""
    sets = settings(plan)
    runs = [[found[_run(one, seed)].hops for seed in plan.seeds] for one in sets]
    values = [[one.value("contact_time_over_eq8") for one in here] for here in runs]
    trials = _saltation.trials("fig7", PART, sets, values, [_saltation.skimming(here) for here in runs])
    times, sweep = runs[0][0].found.times, _sweep(found, plan)
    skimming = [k for k, here in sweep.items() if _saltation.skimming(here)]
    below = (
        f"; the grain skims the crests where u t/d > {SKIM:g}, here at {', '.join(skimming)}"
        if skimming
        else ""
    )
    shown = {
        "mean contact time over Eq. (8)": ("contact_time_over_eq8", "-"),
        "mean jump height": ("jump_height", "m"),
    }
    return (
        finding(
            "fig7",
            trials,
            also=(
                *(
                    f"as shipped, {words}: "
                    + listed({k: _saltation.mean(here, *what) for k, here in sweep.items()})
                    for words, what in shown.items()
                ),
                "as shipped, u t/d: "
                + listed({k: short(_average([one.travel for one in here])) for k, here in sweep.items()}),
                "as shipped, mean largest overlap/d: "
                + listed({k: short(_average([one.overlap for one in here])) for k, here in sweep.items()}),
            ),
            longer=100 * (times.added / times.eq_8 - 1),
            shorter=100 * (1 - times.damped / times.added),
            below=below,
        ),
    )


def _average(values: Sequence[float]) -> float:
    return float(np.mean(values))


def _sweep(found: Found, plan: Plan) -> dict[str, list[SaltationRun]]:
    """All seeds at every stiffness of the series, soft to stiff."""
    return {
        k: [found[_series(keys, seed)].hops for seed in plan.seeds]
        for k, keys in _saltation.series(plan).items()
    }


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per average, run and set of choices."""
    runs = [(one, seed, found[_run(one, seed)].hops) for one in settings(plan) for seed in plan.seeds]
    runs += [
        ({**SHIPPED, K_N: k}, seed, one)
        for k, here in _sweep(found, plan).items()
        for seed, one in zip(plan.seeds, here, strict=True)
        if k != STIFF
    ]
    return [
        {**chosen, "seed": seed, "travel": one.travel, "overlap_over_d": one.overlap, **row}
        for chosen, seed, one in runs
        for row in one.found.rows()
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Contact time over stiffness; the path of Fig. 6; how contacts get shorter when they turn."""
    sweep = _sweep(found, plan)
    k = np.array([_saltation.stiffness(one) for one in sweep])
    means = [_saltation.mean(here, "contact_time", "s") for here in sweep.values()]
    points = figures.StiffnessPoints(
        "runs, mean over all starts",
        k,
        np.array([one.value for one in means]),
        np.array([0.5 * (one.high - one.low) for one in means]),
    )
    times = sweep[STIFF][0].found.times
    theory = np.logspace(1.0, 5.5, 46)  # [N/m]
    scale = np.sqrt(_saltation.stiffness(STIFF) / theory)
    curves = [
        figures.StiffnessCurve("Eq. (8)", theory, times.eq_8 * scale),
        figures.StiffnessCurve("with added mass and dashpot", theory, times.damped * scale),
    ]
    pictures = {"fig07": contact_times_over_stiffness(curves, points, _saltation.skims_below(sweep))}
    path = found[_run({**SHIPPED, K_N: SOFT}, plan.seeds[0])].path
    if path is not None:
        pictures["fig06"] = figures.tracks(path)
    kept = [here[0] for here in sweep.values() if not _saltation.skimming(here)]
    if kept:
        turns = np.logspace(-3.0, 1.0, 81)
        dots = (
            np.concatenate([one.turning for one in kept]),
            np.concatenate([one.shortened for one in kept]),
        )
        pictures["fig07-turning"] = figures.turning({"rotation locked": dots}, (turns, turned_time(turns)))
    return pictures
