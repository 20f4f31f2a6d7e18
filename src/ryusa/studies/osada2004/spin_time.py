"""The sentence on rotation and contact time: locked since e is then unique, not since it would matter."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures.saltation import StiffnessSeries, over_stiffness_in_cm
from ryusa.results import Results
from ryusa.studies.osada2004 import _saltation
from ryusa.studies.osada2004._parts import CaseRun, Found, Plan
from ryusa.studies.osada2004._saltation import K_N, SHIPPED, SKIM, SaltationRun, sweep_run
from ryusa.study import Band, Finding, Trial, over_seeds

FIGURE = "spin-time"
TITLE = "Contact time with rotation locked and free"
CLAIMS = ("spin-time",)
SAME = Band(0.95, 1.05, "-", "does not change: free over locked 0.95 to 1.05, half the tolerance of fig7")
PART = "mean contact time, free over locked"


SOFTEST = 100.0  # [N/m]; free grains on softer beds skim for whole seconds


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of choices with the stiffness."""
    sets = _saltation.with_stiffness(plan)
    return [one for one in sets if _saltation.stiffness(one[K_N]) >= SOFTEST]


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Locked and free for every stiffness and set of choices."""
    return [make(one, seed) for one in settings(plan) for seed in plan.seeds for make in (sweep_run, _free)]


def _free(chosen: Mapping[str, str], seed: int) -> CaseRun:
    return _saltation.run(chosen, "free", seed)


def measure(run: Results, one: CaseRun) -> SaltationRun:
    """Hops of all starts."""
    del one
    return _saltation.hops(run)


def _ratios(found: Found, plan: Plan, chosen: Mapping[str, str]) -> list[float]:
    name = "contact_time"
    return [
        found[_free(chosen, seed)].value(name) / found[sweep_run(chosen, seed)].value(name)
        for seed in plan.seeds
    ]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Free over locked, by stiffness and choices."""
    sets = settings(plan)
    groups = [_ratios(found, plan, one) for one in sets]
    skims = [found[_free(one, plan.seeds[0])].travel > SKIM for one in sets]
    trials = tuple(
        Trial(PART, one, over_seeds(values, "-", spread), SAME)
        for one, values, spread in zip(sets, groups, _saltation.pooled(groups, skims), strict=True)
    )
    locked, free = (found[make(sets[0], plan.seeds[0])] for make in (sweep_run, _free))
    speeds = [one.value("speed") for one in (locked, free)]
    turning = [float(np.median(one.turning)) for one in (locked, free)]
    return (
        Finding(
            "spin-time",
            trials,
            f"A free grain is faster along the bed ({speeds[1]:.2f} against {speeds[0]:.2f} m/s), so that "
            f"the line of centres turns more during a contact (u^2 t/(d v), median {turning[1]:.2g} "
            f"against {turning[0]:.2g}) and the contact ends earlier. This rotation decreases with the "
            "contact time, so the difference vanishes with increasing stiffness.",
            also=(
                "u t/d of the free grain: "
                + _saltation.listed({k: one.travel for k, one in _sweep(found, plan).items()}),
            ),
        ),
    )


def _sweep(found: Found, plan: Plan) -> dict[str, SaltationRun]:
    """Free runs of the first seed, soft to stiff."""
    return {k: found[_free({**SHIPPED, K_N: k}, plan.seeds[0])] for k in _saltation.softest(settings(plan))}


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per set of choices, state of rotation and seed."""
    return [
        {
            **one, "rotation": rotation, "seed": seed, "contact_time_s": run.value("contact_time"),
            "over_eq8": run.value("contact_time_over_eq8"), "speed_m_per_s": run.value("speed"),
            "travel": run.travel,
        }
        for one in settings(plan)
        for rotation, make in (("locked", sweep_run), ("free", _free))
        for seed in plan.seeds
        if (run := found[make(one, seed)])
    ]  # fmt: skip


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Contact time over Eq. (8) against stiffness, locked and free."""
    sweep = _sweep(found, plan)
    k = np.array([_saltation.stiffness(one) for one in sweep])
    lines: list[StiffnessSeries] = []
    for name, make in (("locked", sweep_run), ("free", _free)):
        means = [
            over_seeds(
                [
                    found[make({**SHIPPED, K_N: one}, seed)].value("contact_time_over_eq8")
                    for seed in plan.seeds
                ],
                "-",
            )
            for one in sweep
        ]
        half = np.array([0.5 * (one.high - one.low) for one in means])
        lines.append(StiffnessSeries(f"rotation {name}", k, np.array([one.value for one in means]), half))
    skim = min((_saltation.stiffness(one) for one, run in sweep.items() if run.travel < SKIM), default=0.0)
    return {
        "spin-time": over_stiffness_in_cm({"mean contact time over Eq. (8)  (–)": lines}, skim=skim, one=True)
    }
