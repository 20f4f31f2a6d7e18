"""The sentences after fig. 17: without a deposit locking does no harm, free grains run away."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.study import Finding, Interval, Trial, exact, largest_mean, seeds_trial, short, transformed
from ryusa_studies.osada2004 import _debris, _debris_run
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._debris import FREE, LOCKED, SHIPPED, Value
from ryusa_studies.osada2004._debris_run import Debris
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import PHI, START, CaseRun, Found, Plan
from ryusa_studies.osada2004._shares import halves, within_0_1

FIGURE = "fig17"
TITLE = "Ito's debris flow with rotation locked and free"
CLAIMS = ("fig17-lock", "fig17-free")
REST = "grains at rest"
# Of locked grains: part -> number.
LOCK: Mapping[str, Value] = {
    "grains in contact at a moment": lambda one: one.touching,
    "movers in rods": lambda one: one.rods,
    REST: lambda one: one.rest,
}
# Of free over locked: part -> number.
RATIOS: Mapping[str, Value] = {
    "grain speed near the bed, free over locked": lambda one: one.near_bed,
    "flux, free over locked": lambda one: one.q,
}
PROFILE = "concentration in a third of the depth, free over locked, change by a factor of"
LEAST_PHI = 1.0e-3  # concentration of a third without grains, so that its change is a number
STAND = "locked grains lie at rest: no flow to compare with"
CURES: dict[str, dict[str, str]] = {
    "water torque, Dennis": {"water.torque": "Dennis"},
    "rolling friction, mu_r 0.2": {
        "rolling.model": "spring-dashpot-slider", "rolling.coefficient": "0.2",
    },
}  # fmt: skip
WITH = "rotation free, with"
# Started at rest: a series beside the design, for what locking does to grains that lie on the bed.
AT_REST = [{**SHIPPED, START: "at rest", PHI: phi} for phi in ("30 deg", "20 deg")]

measure = _debris_run.measure


def _free(chosen: Mapping[str, str], seed: int, cure: str = "") -> CaseRun:
    return _debris.run(chosen, seed, {"motion.rotation": "free", **CURES.get(cure, {})})


def _cures(plan: Plan) -> Sequence[str]:
    return plan.pick((), tuple(CURES))


def _from_rest(plan: Plan) -> list[dict[str, str]]:
    return plan.pick([], AT_REST)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Locked and free grains under every setting, and what judges nothing."""
    sets = [*_debris.settings(plan), *_from_rest(plan)]
    runs = [which(one, seed) for one in sets for which in (_debris.run, _free) for seed in plan.seeds]
    runs += [_free(SHIPPED, seed, cure) for cure in _cures(plan) for seed in plan.seeds]
    return list(dict.fromkeys(runs))


def _locked_runs(found: Found, plan: Plan, chosen: Mapping[str, str]) -> list[Debris]:
    return [found[_debris.run(chosen, seed)] for seed in plan.seeds]


def _free_runs(found: Found, plan: Plan, chosen: Mapping[str, str], cure: str = "") -> list[Debris]:
    return [found[_free(chosen, seed, cure)] for seed in plan.seeds]


def _ratio(part: str, chosen: Mapping[str, str], free: Sequence[Debris], locked: Sequence[Debris]) -> Trial:
    """Free over locked: geometric mean over seeds."""
    limits = band("fig17-free", part)
    if not _debris.flows(locked):
        return Trial(part, chosen, exact(math.nan, limits.unit), limits, note=STAND)
    logs = [math.log(RATIOS[part](a) / RATIOS[part](b)) for a, b in zip(free, locked, strict=True)]
    of_logs = seeds_trial(part, chosen, logs, replace(limits, low=math.log(limits.low)))
    return replace(of_logs, found=_factor(of_logs.found), band=limits)


def _factor(logarithm: Interval) -> Interval:
    return transformed(logarithm, math.exp, logarithm.unit, "geometric")


def _profile(chosen: Mapping[str, str], free: Sequence[Debris], locked: Sequence[Debris]) -> Trial:
    """Change of concentration, free over locked, in the third of the depth in which it changes most."""
    limits = band("fig17-free", PROFILE)
    if not _debris.flows(locked):
        return Trial(PROFILE, chosen, exact(math.nan, limits.unit), limits, note=STAND)
    both = [(np.log(_thirds(a)), np.log(_thirds(b))) for a, b in zip(free, locked, strict=True)]
    logs = np.array([a - b for a, b in both])  # (seed, third)

    def change(rows: np.ndarray) -> Interval:
        return _factor(largest_mean([list(third) for third in rows.T], limits.unit, absolute=True))

    by_half = halves(list(logs), lambda half: change(np.array(half)).value, limits)
    return Trial(PROFILE, chosen, change(logs), limits, halves=by_half)


def _thirds(one: Debris) -> np.ndarray:
    return np.maximum(one.thirds, LEAST_PHI)


def _lock(part: str, chosen: Mapping[str, str], runs: Sequence[Debris]) -> Trial:
    """One part of what is asked of locked grains; a single run that comes to rest is harm."""
    trial = seeds_trial(part, chosen, [LOCK[part](one) for one in runs], band("fig17-lock", part))
    trial = replace(trial, found=within_0_1(trial.found))
    still = sum(not _debris.flows([one]) for one in runs)
    if part != REST or still == 0:
        return trial
    one, other = (
        trial.halves[half] if trial.halves and _debris.flows(runs[half::2]) else False for half in (0, 1)
    )
    return replace(
        trial, decided=False, note=f"{still} of {len(runs)} runs come to rest", halves=(one, other)
    )


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Locked grains move apart from one another; free ones lose the grip on the bed."""
    sets = _debris.settings(plan)
    lock = [_lock(part, one, _locked_runs(found, plan, one)) for part in LOCK for one in sets]
    faster: list[Trial] = []
    for one in sets:
        free, locked = _free_runs(found, plan, one), _locked_runs(found, plan, one)
        faster += [*(_ratio(part, one, free, locked) for part in RATIOS), _profile(one, free, locked)]
    locked = _locked_runs(found, plan, SHIPPED)
    beside = [
        _ratio(part, {WITH: cure}, _free_runs(found, plan, SHIPPED, cure), locked)
        for part in RATIOS
        for cure in _cures(plan)
    ]

    def text(rotation: str, name: str) -> str:
        runs = _free_runs(found, plan, SHIPPED) if rotation == FREE else locked
        return short(float(np.mean([getattr(one, name) for one in runs])))

    both = partial(_both, text)
    return (
        finding(
            "fig17-lock",
            lock,
            also=(
                *_rest(found, plan),
                f"movers in rods, as shipped: {text(LOCKED, 'rods')}; with shuffled paths "
                f"{text(LOCKED, 'null')}; the same measure gives fig22 its rods",
                "the measured profiles that the paper fitted are not in its text",
            ),
        ),
        finding(
            "fig17-free",
            faster,
            also=(
                f"speed of the second half second over that of the first {both('drift', '')}",
                "concentration in the lower, middle and upper third: "
                f"{_three(_free_runs(found, plan, SHIPPED))} against {_three(locked)}",
                f"a twentieth of the free grains spin faster than {text(FREE, 'spin')} rad/s",
            ),
            beside=beside,
            near_bed=both("near_bed", "m/s"),
            speed=both("speed", "m/s"),
        ),
    )


def _both(text: Callable[[str, str], str], name: str, unit: str) -> str:
    return f"{text(FREE, name)} against {text(LOCKED, name)} {unit}".strip()


def _three(runs: Sequence[Debris]) -> str:
    return ", ".join(short(one) for one in np.mean([run.thirds for run in runs], axis=0))


def _rest(found: Found, plan: Plan) -> list[str]:
    """What becomes of grains that begin at rest on the bed, locked and free."""
    return [
        f"started at rest, friction angle {one[PHI]}: locked {_speeds(_locked_runs(found, plan, one))}, free "
        f"{_speeds(_free_runs(found, plan, one))} m/s"
        for one in _from_rest(plan)
    ]


def _speeds(runs: Sequence[Debris]) -> str:
    low, high = (short(end(one.speed for one in runs)) for end in (min, max))
    return f"{low} to {high}"


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    sets = [*_debris.settings(plan), *_from_rest(plan)]
    named = [
        (one, rotation, seed, which(one, seed))
        for one in list({tuple(one.items()): one for one in sets}.values())
        for rotation, which in ((LOCKED, _debris.run), (FREE, _free))
        for seed in plan.seeds
    ]
    named += [
        (SHIPPED, f"{FREE}, {cure}", seed, _free(SHIPPED, seed, cure))
        for cure in _cures(plan)
        for seed in plan.seeds
    ]
    return [
        {**one, "rotation": rotation, "seed": seed, **_debris_run.row(found[which])}
        for one, rotation, seed, which in named
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Profiles of locked and free grains, and of what could slow the free ones."""
    seed = plan.seeds[0]
    runs: dict[str, Debris] = {
        LOCKED: found[_debris.run(SHIPPED, seed)],
        FREE: found[_free(SHIPPED, seed)],
        **{f"{FREE}, {cure}": found[_free(SHIPPED, seed, cure)] for cure in _cures(plan)},
    }
    shown = {name: one.profile for name, one in runs.items()}
    return {"fig17-free": figures.profiles(shown, ("phi", "v_x", "spin"))}
