"""Eq. (13): whether a moment against the torque of the shear force resists rotation, as it is proposed to."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

from ryusa.errors import ListUnsafe, NotANumber, OverlapTooLarge, RunError
from ryusa.figures.repose import surface as draw_surface
from ryusa.laws.rolling import rolling_arm_width
from ryusa.measure import spin
from ryusa.model.tally import LOSSES, Term
from ryusa.results import Results
from ryusa.study import Finding, Interval, Trial, over_seeds, seeds_trial
from ryusa_studies.osada2004 import _heap
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan, paper_run
from ryusa_studies.osada2004._shares import positive

FIGURE = "fig23"
TITLE = "Eq. (13): a moment against the torque of the shear force"
CLAIMS = ("eq13",)
CASE = "saltation"
LIMIT = "limit of M_f (eq13)"
DESIGN = design("eq13")
LIMITS = DESIGN.levels[LIMIT]
TURNING = {"motion.rotation": "free", "build.starts": "2"}  # of eight: the spin of one scatters by 2 %
SPIN, ENERGY = "mean spin with Eq. (13) over without", "energy taken by M_f over all losses in contacts"
BANDS = {part: band("eq13", part) for part in (SPIN, ENERGY)}


@dataclass(frozen=True)
class Broken:
    """A run that could not go on."""

    message: str


@dataclass(frozen=True)
class SpinningGrain:
    """Mean absolute spin [rad/s], and what rolling friction took of all losses in contacts [-]."""

    spin: float
    taken: float


settings = DESIGN.sets


def run(chosen: Mapping[str, str], seed: int) -> CaseRun:
    """One saltating grain with rolling friction."""
    return paper_run(CASE, DESIGN.overrides(chosen) | TURNING, seed)


def without(chosen: Mapping[str, str], seed: int) -> CaseRun:
    """Return the same grain without rolling friction."""
    changed = {
        key: value for key, value in DESIGN.overrides(chosen).items() if not key.startswith("rolling.")
    }
    return paper_run(CASE, changed | TURNING, seed)


def _heap_run(limit: str, seed: int) -> CaseRun:
    return _heap.run("free", seed, {**DESIGN.overrides({LIMIT: limit}), "rolling.coefficient": "1"})


def _limits(plan: Plan) -> Sequence[str]:
    """Forms that a heap is made with; it judges nothing."""
    return plan.pick((), LIMITS)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Saltating grains with and without rolling friction, and heaps with both forms of the law."""
    grains = [make(one, seed) for one in settings(plan) for make in (run, without) for seed in plan.seeds]
    heaps = [_heap_run(limit, seed) for limit in _limits(plan) for seed in plan.seeds]
    return list(dict.fromkeys([*grains, *heaps]))


def measure(results: Results, one: CaseRun) -> _heap.Heap | SpinningGrain:
    """Slope of a heap, or spin and energy of a saltating grain."""
    if one.case == _heap.CASE:
        return _heap.heap(results)
    losses = math.fsum(float(results.tally[term.name.lower()][-1]) for term in LOSSES)
    taken = float(results.tally[Term.ROLL.name.lower()][-1]) / losses
    return SpinningGrain(spin(results).averages["spin_absolute"].value, taken)


def failed(error: RunError) -> Broken | None:
    """A law that makes energy breaks the run down or throws a grain, an answer; a lost grain is none."""
    return Broken(str(error)) if isinstance(error, OverlapTooLarge | NotANumber | ListUnsafe) else None


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """The moment slows the spin, and takes energy."""
    trials: list[Trial] = []
    for chosen in settings(plan):
        group = [found[run(chosen, seed)] for seed in plan.seeds]
        note = _broken(group)
        if note:
            none = Interval(math.nan, math.nan, math.nan, "-", len(group), "no run to its end")
            trials += [Trial(part, chosen, none, band, False, note) for part, band in BANDS.items()]
            continue
        plain = [found[without(chosen, seed)].spin for seed in plan.seeds]
        ratios = [one.spin / other for one, other in zip(group, plain, strict=True)]
        trials.append(positive(SPIN, chosen, ratios, BANDS[SPIN]))
        trials.append(seeds_trial(ENERGY, chosen, [one.taken for one in group], BANDS[ENERGY]))
    beside: list[Trial] = []
    for limit in _limits(plan):
        group = [found[_heap_run(limit, seed)] for seed in plan.seeds]
        whole = [one for one in group if isinstance(one, _heap.Heap)]
        lost = over_seeds([one.rolled for one in whole], "-")
        slope = over_seeds(_heap.slopes(whole), "deg")
        key = {LIMIT: limit}
        beside.append(Trial("slope of the heap of Fig. 19, f' = 1", key, slope, None, note=_broken(group)))
        beside.append(Trial("energy taken by M_f over the height lost by the heap", key, lost, None))
    return [finding("eq13", trials, also=_arms(), beside=beside)]


def _broken(group: Sequence[Any]) -> str:
    """How many runs break down and why; empty if none does."""
    broken = [one for one in group if isinstance(one, Broken)]
    if not broken:
        return ""
    return f"breaks down in {len(broken)} of {len(group)} runs: {broken[0].message.partition('. ')[0]}"


def _arms() -> tuple[str, ...]:
    """What f' stands for in a heap: the arm f' b beside mu_r R*, by the law of the contact width."""
    r, m = 0.001, 2650.0 * math.pi / 6.0 * 0.002**3
    load = 5.0 * m * 9.8
    said: list[str] = []
    for k_n, name in ((2.5e3, "25 N/cm"), (1.0e4, "100 N/cm"), (4.0e4, "400 N/cm")):
        width = rolling_arm_width(r, r, load / k_n)
        said.append(f"mu_r = 0.2 is f' = {0.2 * 0.5 * r / width:.2g} at {name}")
    return (
        f"under the weight of 5 grains of 0.2 cm {', '.join(said)}; f' goes with 1/d at the same k_n: it is "
        "no property of the grain",
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per saltating grain, then the heaps."""
    lines: list[dict[str, object]] = []
    for chosen in settings(plan):
        for seed in plan.seeds:
            one, plain = found[run(chosen, seed)], found[without(chosen, seed)]
            numbers = (
                {"broken": one.message}
                if isinstance(one, Broken)
                else {"spin_rad_per_s": one.spin, "taken": one.taken}
            )
            lines.append({**chosen, "seed": seed, **numbers, "spin_without_rad_per_s": plain.spin})
    for limit in _limits(plan):
        for seed in plan.seeds:
            heap = found[_heap_run(limit, seed)]
            numbers = {"broken": heap.message} if isinstance(heap, Broken) else _heap.line(heap)
            lines.append({LIMIT: limit, "seed": seed, **numbers})
    return lines


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """The heap with Eq. (13) as printed, where one was made and stands."""
    for limit in _limits(plan):
        whole = [
            one
            for seed in plan.seeds
            if isinstance(one := found[_heap_run(limit, seed)], _heap.Heap) and not one.wall
        ]
        if whole:
            one = _heap.typical(whole)
            figure = draw_surface(one.seen, one.found)
            figure.suptitle(f"rolling friction, limit of $M_f$: {limit}, $f'$ = 1", fontsize=7.0)
            return {"eq13-heap": figure}
    return {}
