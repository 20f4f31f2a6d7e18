"""Fig. 7: mean contact time at the bed of a saltating grain against stiffness; Fig. 6 is its path."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.figures.saltation import contact_times_over_stiffness
from ryusa.measure import Tracks, turned_time
from ryusa.results import Results
from ryusa.studies.osada2004 import _saltation
from ryusa.studies.osada2004._parts import CaseRun, Found, Plan
from ryusa.studies.osada2004._saltation import K_N, SHIPPED, SKIM, SaltationRun, sweep_run
from ryusa.study import Band, Finding, Interval, Trial, over_seeds

FIGURE = "fig7"
TITLE = "Contact time of a saltating grain, and its path"
CLAIMS = ("fig7",)
AGREES = Band(
    0.9,
    1.1,
    "-",
    "broadly agrees: mean contact time over Eq. (8) 0.9 to 1.1, finer than can be seen in a logarithmic plot",
)
PART = "mean contact time over Eq. (8)"
PATH = {**SHIPPED, K_N: "1 N/cm"}  # Fig. 6


@dataclass(frozen=True)
class Point:
    """One run; its whole path where Fig. 6 shows it."""

    hops: SaltationRun
    path: Tracks | None


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Rotation locked: every stiffness and set of choices; the run of Fig. 6."""
    runs = [sweep_run(one, seed) for one in _saltation.with_stiffness(plan) for seed in plan.seeds]
    return [*runs, _path(plan)]


def _path(plan: Plan) -> CaseRun:
    return _saltation.run(PATH, "locked", plan.seeds[0])


def measure(run: Results, one: CaseRun) -> Point:
    """Hops of all starts."""
    shown = one == _saltation.run(PATH, "locked", run.case["seed"])
    return Point(_saltation.hops(run), _saltation.whole_path(run) if shown else None)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Contact time over Eq. (8), by stiffness and choices."""
    sets = _saltation.with_stiffness(plan)
    groups = [_values(found, plan, one, "contact_time_over_eq8") for one in sets]
    skims = [found[sweep_run(one, plan.seeds[0])].hops.travel > SKIM for one in sets]
    trials = tuple(
        Trial(PART, one, over_seeds(values, "-", spread), AGREES)
        for one, values, spread in zip(sets, groups, _saltation.pooled(groups, skims), strict=True)
    )
    first = found[sweep_run(sets[0], plan.seeds[0])].hops
    times, sweep = first.found.times, _sweep(found, plan)
    skimming = [k for k, one in sweep.items() if one.travel > SKIM]
    below = (
        f"; the grain skims the crests where u t/d > {SKIM:g}, here at {', '.join(skimming)}"
        if skimming
        else ""
    )
    return (
        Finding(
            "fig7",
            trials,
            f"Two effects that Eq. (8) omits nearly cancel: added mass makes a contact "
            f"{100 * (times.added / times.eq_8 - 1):.0f} % longer, and with the dashpot the force ends "
            f"{100 * (1 - times.damped / times.added):.0f} % earlier. What remains is that the line of "
            "centres turns while the grain passes over its partner. This shortens long contacts, so the "
            f"stiffness decides{below}.",
            settings={"rotation": "locked", "starts": f"{_saltation.WIDE['build.starts']} of 30 hops a seed"},
            also=(
                f"u t/d: {_saltation.listed({k: one.travel for k, one in sweep.items()})}",
                "contacts with a single partner over Eq. (8) with added mass and dashpot: "
                + _saltation.listed({k: float(one.shortened.mean()) for k, one in sweep.items()}),
                "mean largest overlap/d: "
                + _saltation.listed({k: one.overlap for k, one in sweep.items()}, ".2g"),
            ),
        ),
    )


def _values(found: Found, plan: Plan, chosen: Mapping[str, str], name: str) -> list[float]:
    return [found[sweep_run(chosen, seed)].hops.value(name) for seed in plan.seeds]


def _sweep(found: Found, plan: Plan) -> dict[str, SaltationRun]:
    """The first seed at every stiffness, soft to stiff."""
    return {
        k: found[sweep_run({**SHIPPED, K_N: k}, plan.seeds[0])].hops
        for k in _saltation.softest(_saltation.with_stiffness(plan))
    }


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per average, run and set of choices."""
    return [
        {**one, "seed": seed, "travel": point.hops.travel, "overlap_over_d": point.hops.overlap, **row}
        for one in _saltation.with_stiffness(plan)
        for seed in plan.seeds
        if (point := found[sweep_run(one, seed)])
        for row in point.hops.found.rows()
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Contact time over stiffness; the path of Fig. 6; how contacts get shorter when they turn."""
    sweep = _sweep(found, plan)
    k = np.array([_saltation.stiffness(one) for one in sweep])
    means = [over_seeds(_values(found, plan, {**SHIPPED, K_N: one}, "contact_time"), "s") for one in sweep]
    times = next(iter(sweep.values())).found.times
    here = _saltation.stiffness(next(iter(sweep)))
    theory = np.logspace(1.0, 5.5, 46)  # [N/m]
    curves = [
        figures.StiffnessCurve("Eq. (8)", theory, times.eq_8 * np.sqrt(here / theory)),
        figures.StiffnessCurve("with added mass and dashpot", theory, times.damped * np.sqrt(here / theory)),
    ]
    skim = min(
        (_saltation.stiffness(one) for one, point in sweep.items() if point.travel < SKIM), default=0.0
    )
    pictures = {"fig07": contact_times_over_stiffness(curves, _points(k, means), skim)}
    path = found[_path(plan)].path
    if path is not None:
        pictures["fig06"] = figures.tracks(path)
    kept = [one for one in sweep.values() if one.travel < SKIM]
    if kept:
        turns = np.logspace(-3.0, 1.0, 81)
        dots = (
            np.concatenate([one.turning for one in kept]),
            np.concatenate([one.shortened for one in kept]),
        )
        pictures["fig07-turning"] = figures.turning({"rotation locked": dots}, (turns, turned_time(turns)))
    return pictures


def _points(k: np.ndarray, means: Sequence[Interval]) -> figures.StiffnessPoints:
    values = np.array([one.value for one in means])
    half = np.array([0.5 * (one.high - one.low) for one in means])
    return figures.StiffnessPoints("runs, mean over all starts", k, values, half)
