"""Why the paper locks rotation: restitution is not unique with it, and contact time does not change."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa.study import Finding, over_seeds, short
from ryusa_studies.osada2004 import _saltation
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan
from ryusa_studies.osada2004._saltation import (
    FREE,
    K_N,
    LOCKED,
    NORMAL,
    SHIPPED,
    TANGENTIAL,
    Group,
    SaltationRun,
)
from ryusa_studies.osada2004.figures.saltation import StiffnessSeries, over_stiffness_in_cm

FIGURE = "spin-time"
TITLE = "Contact time and restitution with rotation locked and free"
CLAIMS = ("spin-time", "spin-e")
PART = "mean contact time, free over locked"
WHICH = "which restitution"
SPREADS = {rotation: f"spread of restitution, rotation {rotation}" for rotation in (LOCKED, FREE)}


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of choices, each with a stiffness."""
    return _saltation.settings(plan, K_N)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Locked and free for every set of choices, and for the series over stiffness."""
    both = [(one, rotation) for one in settings(plan) for rotation in (LOCKED, FREE)]
    runs = [_saltation.run(*one, seed) for one in both for seed in plan.seeds]
    runs += [
        _series(keys, rotation, seed)
        for keys in _saltation.series(plan).values()
        for rotation in (LOCKED, FREE)
        for seed in plan.seeds
    ]
    return list(dict.fromkeys(runs))


def _series(keys: Mapping[str, str], rotation: str, seed: int) -> CaseRun:
    return _saltation.run(SHIPPED, rotation, seed, keys)


measure = _saltation.measure


def _group(found: Found, plan: Plan, chosen: Mapping[str, str], rotation: str) -> Group:
    return [found[_saltation.run(chosen, rotation, seed)] for seed in plan.seeds]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Contact time free over locked; spread of restitution of either."""
    sets = settings(plan)
    runs = {rot: [_group(found, plan, one, rot) for one in sets] for rot in (LOCKED, FREE)}
    skims = [_saltation.skimming(here) for here in runs[FREE]]
    ratios = [
        _saltation.ratios(free, locked, "contact_time")
        for free, locked in zip(runs[FREE], runs[LOCKED], strict=True)
    ]
    ways = (TANGENTIAL, NORMAL)
    spreads = [
        trial
        for rotation, part in SPREADS.items()
        for way in ways
        for trial in _saltation.trials(
            "spin-e",
            part,
            [{**one, WHICH: way} for one in sets],
            [[one.spreads[way] for one in here] for here in runs[rotation]],
            [_saltation.skimming(here) for here in runs[rotation]],
        )
    ]
    locked, free = runs[LOCKED][0], runs[FREE][0]
    speeds = [np.mean([one.value("speed") for one in here]) for here in (locked, free)]
    turning = [np.mean([np.median(one.turning) for one in here]) for here in (locked, free)]
    sweep = _sweep(found, plan)
    return (
        finding(
            "spin-time",
            _saltation.trials("spin-time", PART, sets, ratios, skims),
            also=[
                f"as shipped, rotation {rot}, {words}: "
                + _saltation.listed(
                    {k: short(float(np.mean([value(one) for one in here[rot]]))) for k, here in sweep.items()}
                )
                for rot in (LOCKED, FREE)
                for words, value in (
                    ("contact time over Eq. (8)", lambda one: one.value("contact_time_over_eq8")),
                    ("u t/d", lambda one: one.travel),
                )
            ],
            held=speeds[1],
            rolling=speeds[0],
            held_turning=turning[1],
            rolling_turning=turning[0],
        ),
        finding("spin-e", spreads),
    )


def _sweep(found: Found, plan: Plan) -> dict[str, dict[str, list[SaltationRun]]]:
    """Runs of the series by stiffness, soft to stiff, and rotation."""
    return {
        k: {rot: [found[_series(keys, rot, seed)] for seed in plan.seeds] for rot in (LOCKED, FREE)}
        for k, keys in _saltation.series(plan).items()
    }


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per set of choices, state of rotation and seed."""
    return [
        {
            **one, "rotation": rotation, "seed": seed, "contact_time_s": run.value("contact_time"),
            "over_eq8": run.value("contact_time_over_eq8"), "speed_m_per_s": run.value("speed"),
            "travel": run.travel,
            **{f"spread_of_{way}_restitution": value for way, value in run.spreads.items()},
        }
        for one in settings(plan)
        for rotation in (LOCKED, FREE)
        for seed, run in zip(plan.seeds, _group(found, plan, one, rotation), strict=True)
    ]  # fmt: skip


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Contact time over Eq. (8) against stiffness, locked and free."""
    sweep = _sweep(found, plan)
    k = np.array([_saltation.stiffness(one) for one in sweep])
    lines: list[StiffnessSeries] = []
    for rotation in (LOCKED, FREE):
        means = [
            over_seeds([one.value("contact_time_over_eq8") for one in here[rotation]], "-")
            for here in sweep.values()
        ]
        half = np.array([0.5 * (one.high - one.low) for one in means])
        lines.append(StiffnessSeries(f"rotation {rotation}", k, np.array([one.value for one in means]), half))
    skim = _saltation.skims_below({one: here[FREE] for one, here in sweep.items()})
    return {
        "spin-time": over_stiffness_in_cm({"mean contact time over Eq. (8)  (–)": lines}, skim=skim, one=True)
    }
