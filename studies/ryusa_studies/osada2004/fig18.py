"""Fig. 18, a sketch: long contacts carry grains along together, short ones scatter them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.study import Finding, Trial, over_seeds, seeds_trial, short
from ryusa_studies.osada2004 import _debris, _debris_run
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._debris import DESIGN, LONGER
from ryusa_studies.osada2004._debris_run import Debris
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan, paper_run

FIGURE = "fig18"
TITLE = "Effect of long and short contacts on the paths of grains"
CLAIMS = ("fig18",)
SHIPPED = DESIGN.base
LONGEST = 0.01  # overlap over d up to which the paper calls its springs stable
PARTS: tuple[tuple[str, Callable[[Debris, Debris], float]], ...] = (
    (
        "correlation of the speeds of grains that touch, long minus short",
        lambda long, short: long.companions - short.companions,
    ),
    ("vertical speed (rms), long over short", lambda long, short: long.rms_z / short.rms_z),
    (
        "vertical speed over speed along the bed, long over short",
        lambda long, short: long.steep / short.steep,
    ),
)
SHOWN: Mapping[str, _debris.Value] = {
    "mean of the largest overlap over d, long contacts": lambda one: one.contacts["all contacts"].overlap,
    "way along the bed during a long contact over d": lambda one: one.along,
}
STAND = "grains lie at rest: no paths to compare"

measure = _debris_run.measure


def run(chosen: Mapping[str, str], seed: int) -> CaseRun:
    """Contacts so many times as long as in fig17."""
    return paper_run("fig18", DESIGN.overrides(chosen), seed)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Long and short contacts for every setting and seed, and other lengths of all else as shipped."""
    sets = [*_debris.long_settings(plan), *_lengths(plan)]
    both = [(one, seed) for one in sets for seed in plan.seeds]
    return list(dict.fromkeys(which(one, seed) for one, seed in both for which in (run, _debris.run)))


def _lengths(plan: Plan) -> list[dict[str, str]]:
    return [{**SHIPPED, LONGER: one} for one in plan.pick((), ("3", "10"))]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """More alike, and less up and down."""
    sets = _debris.long_settings(plan)
    pairs = [[(found[run(one, seed)], found[_debris.run(one, seed)]) for seed in plan.seeds] for one in sets]
    flowing = [_debris.flows([one for pair in here for one in pair]) for here in pairs]
    tried = [
        replace(
            seeds_trial(
                part, one, [value(*pair) if flow else math.nan for pair in here], band("fig18", part)
            ),
            note="" if flow else STAND,
        )
        for part, value in PARTS
        for one, here, flow in zip(sets, pairs, flowing, strict=True)
    ]
    tried += [
        Trial(part, one, over_seeds([value(long) for long, _ in here], "-"), None, note="" if flow else STAND)
        for part, value in SHOWN.items()
        for one, here, flow in zip(sets, pairs, flowing, strict=True)
    ]
    return (
        finding(
            "fig18",
            tried,
            also=(
                f"as shipped and at other lengths: {_series(found, plan)}",
                f"the paper calls springs stable up to an overlap of {LONGEST:g} d",
                _beyond(found, plan),
            ),
        ),
    )


def _mean(runs: Sequence[Debris], value: _debris.Value) -> float:
    return float(np.mean([value(one) for one in runs]))


def _series(found: Found, plan: Plan) -> str:
    short_runs = [found[_debris.run(SHIPPED, seed)] for seed in plan.seeds]
    runs = {"1": short_runs}
    for one in [*_lengths(plan), SHIPPED]:
        runs[one[LONGER]] = [found[run(one, seed)] for seed in plan.seeds]
    return "; ".join(
        f"{times} times: contact {short(_mean(here, lambda one: one.contacts['all contacts'].time))} s, "
        f"overlap {short(_mean(here, lambda one: one.contacts['all contacts'].overlap))} d on average and "
        f"{short(_mean(here, lambda one: one.contacts['all contacts'].overlap_largest))} d at most, u t/d "
        f"{short(_mean(here, lambda one: one.along))}, correlation "
        f"{short(_mean(here, lambda one: one.companions))}, "
        f"{short(_mean(here, lambda one: 100.0 * one.rms_z))} cm/s up and down, "
        f"{short(_mean(here, lambda one: one.speed))} m/s along"
        for times, here in sorted(runs.items(), key=lambda one: float(one[0]))
    )


def _beyond(found: Found, plan: Plan) -> str:
    """What contacts of 0.01 s would need, by the overlap as shipped."""
    runs = [found[_debris.run(SHIPPED, seed)] for seed in plan.seeds]
    contacts = [one.contacts["all contacts"] for one in runs]
    longer = 0.01 / float(np.mean([one.time for one in contacts]))
    overlap = longer * float(np.mean([one.overlap for one in contacts]))
    return (
        f"contacts of 0.01 s, the time that the paper takes as realistic, are {short(longer)} times as long "
        f"as those of fig17; at the same closing speed the mean overlap would be {short(overlap)} d"
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    lines: list[dict[str, object]] = []
    for one in [*_debris.long_settings(plan), *_lengths(plan)]:
        for seed in plan.seeds:
            for longer, which in ((one[LONGER], run(one, seed)), ("1", _debris.run(one, seed))):
                lines.append({**one, LONGER: longer, "seed": seed, **_debris_run.row(found[which])})
    return lines


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Ways with long and short contacts over the same length, and the profiles."""
    seed = plan.seeds[0]
    runs: dict[str, Debris] = {
        "(a) long": found[run(SHIPPED, seed)],
        "(b) short": found[_debris.run(SHIPPED, seed)],
    }
    far = min(float((one.path.x[-1] - one.path.x[0]).min()) for one in runs.values())
    return {
        "fig18": figures.tracks_side_by_side({name: one.path for name, one in runs.items()}, far, "cm"),
        "fig18-profiles": figures.profiles(
            {name: one.profile for name, one in runs.items()}, ("phi", "v_x", "temperature_z")
        ),
    }
