"""Fig. 22: a movable bed under water, rotation locked: whether its grains move like rods."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from matplotlib.figure import Figure

from ryusa import figures
from ryusa.study import Finding, Interval, Trial, exact, over_seeds, pseudo_values
from ryusa_studies.osada2004 import _movable_bed
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._movable_bed import MovableBedRun, mean
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan, paper_run
from ryusa_studies.osada2004._shares import halves
from ryusa_studies.osada2004.figures import rod_lengths, rods

FIGURE = "fig22"
TITLE = "Movable bed under water, rotation locked and free"
CLAIMS = ("fig22",)
CASE = "fig22"
LOCKED, FREE = "locked", "free"
SLOPE = "slope (tau_star)"
DESIGN = design("fig22")
SHIPPED = DESIGN.base
MOVERS = 10  # locked, of all seeds and windows, below which nothing is said about rods
STANDS = "nothing moves"
PART_RODS = "movers in rods minus those with shuffled paths"
PART_MORE = "movers in rods, locked over free, in decades"
PART_LESS = "movers in rods, locked minus free"  # judged for two hours of 2026-11-21, as registered; shown
LEAST = 0.01  # share in rods that counts as least in a ratio
Runs = Sequence[tuple[MovableBedRun, MovableBedRun]]  # locked and free, by seed

measure = _movable_bed.measure


settings = DESIGN.sets


def _run(chosen: Mapping[str, str], rotation: str, seed: int) -> CaseRun:
    """One run of the case; what is as shipped is not said."""
    free = {} if rotation == LOCKED else {"timeline.1.rotation": rotation}
    return paper_run(CASE, {**DESIGN.overrides(chosen), **free}, seed)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Locked and free grains for every setting and seed."""
    return [
        _run(one, rotation, seed)
        for one in settings(plan)
        for rotation in (LOCKED, FREE)
        for seed in plan.seeds
    ]


def _both(found: Found, plan: Plan, chosen: Mapping[str, str]) -> Runs:
    """Locked and free run of every seed."""
    return [(found[_run(chosen, LOCKED, seed)], found[_run(chosen, FREE, seed)]) for seed in plan.seeds]


def _movers(runs: Sequence[MovableBedRun]) -> int:
    return sum(int(one.rods.movers.sum()) for one in runs)


def _share(runs: Sequence[MovableBedRun]) -> float:
    """Movers in rods over all movers of these runs; nan where nothing moves [-]."""
    movers = _movers(runs)
    return sum(float(one.rods.bound.sum()) for one in runs) / movers if movers else math.nan


def _excess(pairs: Runs) -> float:
    """Movers in rods less those with shuffled paths [-]."""
    locked = [one for one, _ in pairs]
    movers = _movers(locked)
    return _share(locked) - sum(float(one.rods.null.sum()) for one in locked) / movers if movers else math.nan


def _more(pairs: Runs) -> float:
    """Share in rods, locked over free, in decades; one in a hundred counts as least."""
    locked, free = (_share([pair[k] for pair in pairs]) for k in (0, 1))
    free = LEAST if math.isnan(free) else max(free, LEAST)
    return math.nan if math.isnan(locked) else math.log10(max(locked, LEAST) / free)


def _difference(pairs: Runs) -> float:
    """Share in rods, locked minus free."""
    return _share([locked for locked, _ in pairs]) - _share([free for _, free in pairs])


# part -> number of the runs of all seeds together, and the largest magnitude that it can have
PARTS: Mapping[str, tuple[Callable[[Runs], float], float]] = {
    PART_RODS: (_excess, 1.0),
    PART_MORE: (_more, -math.log10(LEAST)),
}


def _trial(part: str, chosen: Mapping[str, str], pairs: Runs) -> Trial:
    """One part under one setting, all seeds together, with its jackknife over seeds."""
    value, most = PARTS[part]
    limits = band("fig22", part)
    if _movers([locked for locked, _ in pairs]) < MOVERS:
        return Trial(part, chosen, exact(math.nan, limits.unit), limits, note=STANDS)
    found = _jackknife(value, pairs, most)
    return Trial(part, chosen, found, limits, halves=halves(pairs, value, limits))


def _jackknife(value: Callable[[Runs], float], pairs: Runs, most: float) -> Interval:
    """Number of all seeds together with its jackknife over them, cut to what it can be."""
    spread = over_seeds(pseudo_values(value, pairs), "-")
    return replace(
        spread, low=max(-most, spread.low), high=min(most, spread.high), how=f"jackknife, {spread.how}"
    )


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Rods where grains are locked, and fewer where they are free."""
    tried = [_trial(part, one, _both(found, plan, one)) for part in PARTS for one in settings(plan)]
    shipped = _both(found, plan, SHIPPED)
    if _movers([locked for locked, _ in shipped]) >= MOVERS:
        tried.append(Trial(PART_LESS, SHIPPED, _jackknife(_difference, shipped, 1.0), None))
    return (finding("fig22", tried, also=[_words(found, plan, one) for one in settings(plan)]),)


def _words(found: Found, plan: Plan, chosen: Mapping[str, str]) -> str:
    """Movers, shares in rods and lengths under one setting."""
    name = ", ".join(value for key, value in chosen.items() if value != SHIPPED[key]) or "as shipped"
    pairs = _both(found, plan, chosen)
    parts: list[str] = []
    for k, rotation in enumerate((LOCKED, FREE)):
        runs = [pair[k] for pair in pairs]
        nulls = [one.rods.null_share for one in runs]
        parts.append(
            f"{rotation} {mean([_share(runs)])} of {_movers(runs)} movers in rods, {mean(nulls)} shuffled, "
            f"{mean([one.rods.mean_length for one in runs])} grains a rod, flux "
            f"{mean([1e4 * one.q for one in runs])} cm2/s"
        )
    return f"{name}: {'; '.join(parts)}"


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    return [
        {**one, "rotation": rotation, "seed": seed, **_movable_bed.row(found[_run(one, rotation, seed)])}
        for one in settings(plan)
        for rotation in (LOCKED, FREE)
        for seed in plan.seeds
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """The longest rod on its way, how long rods are, and the profiles."""
    seed = plan.seeds[0]
    locked: MovableBedRun = found[_run(SHIPPED, LOCKED, seed)]
    free: MovableBedRun = found[_run(SHIPPED, FREE, seed)]
    pictures = {
        "fig22-lengths": rod_lengths({LOCKED: locked.rods, FREE: free.rods}),
        "fig22-profiles": figures.profiles(
            {LOCKED: locked.profile, FREE: free.profile}, ("phi", "v_x", "spin")
        ),
    }
    longest = locked.rods.longest
    if longest is not None:
        pictures = {"fig22": rods(locked.followed, longest.grains), **pictures}
    return pictures
