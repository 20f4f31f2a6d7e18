"""Fig. 16: ways of grains that meet bed and movers in turn, collision time 0.01 s and 0.0001 s."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.study import Finding, Trial, short
from ryusa_studies.osada2004 import _avalanche
from ryusa_studies.osada2004._avalanche import (
    ALL,
    BETWEEN,
    FIRST,
    SHIPPED,
    SOFT,
    STIFF,
    RunPair,
    Ways,
    together,
)
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import Found, Plan

FIGURE = "fig16"
TITLE = "Paths of grains in a dry avalanche"
CLAIMS = ("fig16",)
GRAINS = "grains"
RUNS = "number of all runs"
BY_RUN, SUMMED = "mean of the runs", "sums over the runs"
# part of the claim -> what it is of each run
PARTS = {
    "reversals of the vertical motion per metre of advance, 0.0001 s over 0.01 s": "per_metre",
    "advance along the bed in 1 s, 0.0001 s over 0.01 s": "advance",
    "vertical path over advance, 0.0001 s over 0.01 s": "jaggedness",
}
NONE = "no grain meets bed and movers in turn, or none advances, in one of the runs"

tasks, measure, rows = _avalanche.tasks, _avalanche.measure, _avalanche.rows


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Jagged, short and not in layers."""
    tried = [
        replace(one, choices={**one.choices, GRAINS: grains, RUNS: runs})
        for runs, ratio_of in ((BY_RUN, _ratio), (SUMMED, _ratio_of_sums))
        for grains in (BETWEEN, ALL)
        for part, name in PARTS.items()
        for ratio in [together(partial(ratio_of, name=name, grains=grains))]
        for one in map(_without, _avalanche.trials(found, plan, part, ratio, band("fig16", part)))
    ]
    tried += [
        replace(one, choices={**one.choices, GRAINS: grains, RUNS: runs})
        for runs in (BY_RUN, SUMMED)
        for grains in (BETWEEN, ALL)
        for one in _avalanche.flows(found, plan)
    ]
    base = _avalanche.pairs(found, plan, SHIPPED, FIRST)
    words = {
        (name, grains): " against ".join(
            short(_mean([getattr(one.ways[grains], name) for one in runs]))
            for runs in ([pair.soft for pair in base], [pair.stiff for pair in base])
        )
        for name in ("n", "reversals", "fine", "per_metre", "advance", "jaggedness")
        for grains in (BETWEEN, ALL)
    }

    def said(grains: str) -> str:
        return (
            f"{words['per_metre', grains]} vertical reversals per metre of advance "
            f"({words['reversals', grains]} per second), {words['advance', grains]} m of advance, "
            f"{words['jaggedness', grains]} m of vertical path per metre of advance"
        )

    seconds = "; ".join(
        f"{_avalanche.label(one)}, {window}: "
        f"{short(_avalanche.mean(found, plan, one, window, partial(_ratio, name='reversals', grains=ALL)))}"
        for one, window in _avalanche.sets(plan)
        if all(pair.flows for pair in _avalanche.pairs(found, plan, one, window))
    )
    return (
        finding(
            "fig16",
            tried,
            also=(
                "grains that touch the bed and moving grains alternately, wherever they began: "
                f"{words['n', BETWEEN]}",
                f"all grains: {said(ALL)}",
                f"not judged, vertical reversals per second, all grains, {STIFF} over {SOFT}: {seconds}",
                f"vertical turns a second counted from {_avalanche.FINE:g} d, grains between bed and movers: "
                f"{words['fine', BETWEEN]}; all grains: {words['fine', ALL]}",
            ),
            between=said(BETWEEN),
        ),
    )


def _ratio(found: Sequence[RunPair], name: str, grains: str) -> float:
    """Mean of the stiff runs over that of the soft ones; nan where most pairs have nothing to compare.

    Not the mean of their ratios: one soft run whose grains hardly advance would outweigh all others.
    """
    both = [[getattr(one.ways[grains], name) for one in (pair.soft, pair.stiff)] for pair in found]
    kept = [pair for pair in both if all(map(math.isfinite, pair))]
    soft, stiff = np.mean(kept, axis=0) if 2 * len(kept) > len(both) else (math.nan, math.nan)
    return float(stiff / soft) if soft != 0.0 else math.nan


def _ratio_of_sums(found: Sequence[RunPair], name: str, grains: str) -> float:
    """Ratio of what all grains of all stiff runs do to what those of all soft ones do.

    Turns and vertical ways of all runs are summed, and divided by the sum of all advances: in the mean of the
    runs one whose grains hardly advance has so many turns a metre that it outweighs all others.
    """
    both = [(pair.soft.ways[grains], pair.stiff.ways[grains]) for pair in found]
    kept = [pair for pair in both if all(math.isfinite(one.advance) for one in pair)]
    if 2 * len(kept) <= len(both):
        return math.nan
    soft, stiff = (_of_all([pair[k] for pair in kept], name) for k in (0, 1))
    return stiff / soft if soft != 0.0 else math.nan


def _of_all(ways: Sequence[Ways], name: str) -> float:
    """Turns or vertical way per advance of all grains of these runs, or their mean advance."""
    weights = [one.n if name == "advance" else one.n * one.advance for one in ways]
    return float(np.average([getattr(one, name) for one in ways], weights=weights))


def _mean(values: Sequence[float]) -> float:
    """Mean of the seeds that have a number."""
    kept = [value for value in values if math.isfinite(value)]
    return float(np.mean(kept)) if kept else math.nan


def _without(one: Trial) -> Trial:
    """Let a trial without a number fail: there are no such ways to compare."""
    return one if math.isfinite(one.found.value) else replace(one, decided=False, note=NONE)


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Two ways of each run over the bed, as in the paper."""
    (pair, *_) = _avalanche.pairs(found, plan, SHIPPED, FIRST)
    ways = {f"(a) {SOFT}": pair.soft.path, f"(b) {STIFF}": pair.stiff.path}
    far = max(float((one.x - one.x[0, 0]).max()) for one in ways.values())
    return {"fig16": figures.tracks_side_by_side(ways, far + float(pair.soft.profile.d), "cm")}
