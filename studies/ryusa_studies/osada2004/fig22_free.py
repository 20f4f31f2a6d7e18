"""A movable bed with rotation free: what the lack of any resistance to rolling does."""

import math
from collections.abc import Callable, Mapping, Sequence

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.study import Finding, Trial, over_seeds, seeds_trial
from ryusa.study.interval import magnitude
from ryusa_studies.osada2004 import _movable_bed
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._movable_bed import MovableBedRun, mean
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan, paper_run
from ryusa_studies.osada2004._shares import halves

FIGURE = "fig22"
TITLE = "Movable bed under water, rotation free, without and with a resistance"
CLAIMS = ("fig22-free",)

CASE = "fig22_free"
TAU_STAR, RESISTANCE = "tau_star", "resistance"
ROLLING = {"rolling.model": "spring-dashpot-slider"}
RESISTANCES: dict[str, dict[str, str]] = {
    "rolling friction, mu_r 0.2": {**ROLLING, "rolling.coefficient": "0.2"},
    "rolling friction, mu_r 0.5": {**ROLLING, "rolling.coefficient": "0.5"},
    "water torque, Dennis": {"water.torque": "Dennis"},
}
DESIGN = design("fig22_free")
SHIPPED = DESIGN.base


settings = DESIGN.sets


def _run(chosen: Mapping[str, str], seed: int, resisted: bool) -> CaseRun:
    """One run of the case; what is as shipped is not said."""
    keys = RESISTANCES[chosen[RESISTANCE]] if resisted else {}
    return paper_run(CASE, {**DESIGN.overrides(chosen), **keys}, seed)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Every setting and seed without and with the resistance."""
    return [
        _run(one, seed, resisted)
        for one in settings(plan)
        for resisted in (False, True)
        for seed in plan.seeds
    ]


measure = _movable_bed.measure


def _runs(found: Found, plan: Plan, chosen: Mapping[str, str], resisted: bool) -> list[MovableBedRun]:
    return [found[_run(chosen, seed, resisted)] for seed in plan.seeds]


STANDS = "nothing moves, with or without the resistance"
PART_SPIN = "spin exceeded by a twentieth of the movers"
# part -> number of one run, and with how much a bed that stands counts [m/s], [m2/s]
RATIOS: Mapping[str, tuple[Callable[[MovableBedRun], float], float]] = {
    "speed of the movers, without resistance over with, in decades": (lambda one: one.speed, 1.0e-3),
    "flux, without resistance over with, in decades": (lambda one: one.q, 1.0e-7),
}


def _changed(
    part: str, chosen: Mapping[str, str], bare: Sequence[MovableBedRun], resisted: Sequence[MovableBedRun]
) -> Trial:
    """Magnitude of the logarithm of a ratio: the text says that it changes, not which way."""
    limits, (value, least) = band("fig22-free", part), RATIOS[part]
    logs = [_decades(value(a), value(b), least) for a, b in zip(bare, resisted, strict=True)]
    found = magnitude(over_seeds(logs, limits.unit))
    by_half = halves(logs, lambda half: abs(sum(half)) / len(half), limits)
    return Trial(part, chosen, found, limits, halves=by_half, note=_direction(logs))


def _decades(above: float, below: float, least: float) -> float:
    """Logarithm of a ratio; a bed that stands counts with the least value, two that stand have none."""
    above, below = (least if math.isnan(one) else max(one, least) for one in (above, below))
    return math.log10(above / below) if max(above, below) > least else math.nan


def _direction(logs: Sequence[float]) -> str:
    mean_log = sum(logs) / len(logs)
    return f"a factor of {10.0**mean_log:.3g}" if math.isfinite(mean_log) else STANDS


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Fast spin, and what a resistance to it changes."""
    tried: list[Trial] = []
    for one in settings(plan):
        bare, resisted = (_runs(found, plan, one, which) for which in (False, True))
        spins = [run.fast_spin for run in bare]
        tried.append(seeds_trial(PART_SPIN, one, spins, band("fig22-free", PART_SPIN)))
        tried += [_changed(part, one, bare, resisted) for part in RATIOS]
    return (
        finding(
            "fig22-free",
            tried,
            also=[
                f"{', '.join(value for key, value in one.items() if value != SHIPPED[key])}: "
                f"{_words(found, plan, one)}"
                for one in settings(plan)[1:]
            ],
            shipped=_words(found, plan, SHIPPED),
        ),
    )


def _words(found: Found, plan: Plan, chosen: Mapping[str, str]) -> str:
    """Spin, speed and flux without and with the resistance."""
    bare, resisted = (_runs(found, plan, chosen, which) for which in (False, True))
    return (
        f"tau_star {chosen[TAU_STAR]}, {chosen[RESISTANCE]}: without it spin times radius is "
        f"{mean([one.rolling for one in bare])} of the speed of the movers, with it "
        f"{mean([one.rolling for one in resisted])}; speed {mean([one.speed for one in bare])} against "
        f"{mean([one.speed for one in resisted])} m/s, flux {mean([1e4 * one.q for one in bare])} against "
        f"{mean([1e4 * one.q for one in resisted])} cm2/s"
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    return [
        {
            **one,
            "resisted": resisted,
            "seed": seed,
            **_movable_bed.row(found[_run(one, seed, resisted)]),
        }
        for one in settings(plan)
        for resisted in (False, True)
        for seed in plan.seeds
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Profiles without and with the resistance."""
    seed = plan.seeds[0]
    runs: dict[str, MovableBedRun] = {
        "no resistance": found[_run(SHIPPED, seed, False)],
        SHIPPED[RESISTANCE]: found[_run(SHIPPED, seed, True)],
    }
    return {
        "fig22-free": figures.profiles(
            {name: one.profile for name, one in runs.items()}, ("phi", "v_x", "spin")
        )
    }
