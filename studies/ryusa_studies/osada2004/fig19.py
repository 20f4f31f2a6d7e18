"""Fig. 19: a heap between walls, one of which goes at once; the slope left, rotation locked or free."""

import math
from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from ryusa.figures.repose import surface as draw_surface
from ryusa.results import Results
from ryusa.study import Finding, Trial
from ryusa_studies.osada2004 import _heap
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import PACKING, PHI, SLIP, CaseRun, Found, Plan
from ryusa_studies.osada2004.figures.slopes import Slope, slopes

FIGURE = "fig19"
TITLE = "Slope of a heap after the removal of its wall"
CLAIMS = ("fig19-locked", "fig19-free")
FIT = "height range"  # of the slope: read from the same run
WITH_FRICTION = "settled with friction"  # its angle is that of the setting
DESIGN = design("fig19")
SLOPE_PART, MOVING_PART = "final slope", "share of grains still moving"
BANDS = {rotation: band(f"fig19-{rotation}", SLOPE_PART) for rotation in ("locked", "free")}
PAPER = {"locked": 33.0, "free": 18.0}  # deg
# Slopes of locked heaps pass what is asked between the levels of the friction angle: shown beside.
BETWEEN = ("12 deg", "14 deg", "16 deg")


settings = DESIGN.sets


def run(chosen: Mapping[str, str], rotation: str, seed: int) -> CaseRun:
    """One run."""
    changed = DESIGN.overrides(chosen)
    if chosen[PACKING] == WITH_FRICTION:
        changed |= {"contact.friction_angle": chosen[PHI]}
    return _heap.run(rotation, seed, changed)


def between(plan: Plan) -> dict[str, list[CaseRun]]:
    """Locked heaps with friction angles between the levels, by angle."""
    return {
        phi: [_heap.run("locked", seed, {_heap.PHI_KEY: phi}) for seed in plan.seeds]
        for phi in plan.pick((), BETWEEN)
    }


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Locked and free under every setting and seed, and what stands beside them."""
    runs = [run(one, rotation, seed) for rotation in BANDS for one in settings(plan) for seed in plan.seeds]
    runs += [one for some in between(plan).values() for one in some]
    return list(dict.fromkeys(runs))


def measure(results: Results, one: CaseRun) -> _heap.Heap:
    """Slope at the end."""
    del one
    return _heap.heap(results)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Locked about 33 deg, free about 18 deg."""
    return [_judged(found, plan, rotation) for rotation in BANDS]


def _group(found: Found, plan: Plan, chosen: Mapping[str, str], rotation: str) -> list[_heap.Heap]:
    return [found[run(chosen, rotation, seed)] for seed in plan.seeds]


def _judged(found: Found, plan: Plan, rotation: str) -> Finding:
    sets = settings(plan)
    heaps = [_group(found, plan, chosen, rotation) for chosen in sets]
    trials: list[Trial] = []
    still = band(f"fig19-{rotation}", MOVING_PART)
    for chosen, group in zip(sets, heaps, strict=True):
        trials += [
            _heap.slope_trial(SLOPE_PART, chosen, group, chosen[FIT], BANDS[rotation]),
            _heap.moving_trial(MOVING_PART, chosen, group, still),
        ]
    ranges = [math.degrees(one.found.spread) for group in heaps for one in group if not one.wall]
    ends = [one.t_end - one.t_gate for group in heaps for one in group]
    walls = sum(one.wall for group in heaps for one in group)
    also = (
        f"{walls} of {len(ends)} heaps of all settings stand as a wall",
        f"one slope changes with the height range of the fit by up to {max(ranges, default=math.nan):.0f} "
        "deg",
        f"observed for {min(ends):.1f} to {max(ends):.1f} s after the removal of the gate",
    )
    beside = tuple(
        _heap.slope_trial(SLOPE_PART, {PHI: phi}, [found[one] for one in runs], _heap.MEAN, BANDS[rotation])
        for phi, runs in (between(plan) if rotation == "locked" else {}).items()
    )
    return finding(f"fig19-{rotation}", trials, also=also, beside=beside)


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    named = [
        (rotation, chosen, seed, run(chosen, rotation, seed))
        for rotation in BANDS
        for chosen in settings(plan)
        for seed in plan.seeds
    ]
    named += [
        ("locked", {**DESIGN.base, PHI: phi}, seed, one)
        for phi, runs in between(plan).items()
        for seed, one in zip(plan.seeds, runs, strict=True)
    ]
    return [
        {"rotation": rotation, **chosen, "seed": seed, **_heap.line(found[one])}
        for rotation, chosen, seed, one in named
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """The heaps as the paper shows them, and slope against friction angle."""
    sets = settings(plan)
    pictures: dict[str, Figure] = {}
    for rotation in BANDS:
        one = _heap.typical(_group(found, plan, sets[0], rotation))
        pictures[f"fig19-{rotation}"] = draw_surface(one.seen, one.found)
        pictures[f"fig19-{rotation}"].suptitle(f"rotation {rotation}, as shipped", fontsize=7.0)
    series = [
        Slope(
            f"rotation {rotation}, slip {slip}",
            (PAPER[rotation],),
            [
                (
                    float(phi.split()[0]),
                    [one.slope() for chosen in alike for one in _group(found, plan, chosen, rotation)],
                )
                for phi in DESIGN.levels[PHI]
                if (alike := [chosen for chosen in sets if chosen[SLIP] == slip and chosen[PHI] == phi])
            ],
        )
        for rotation in BANDS
        for slip in DESIGN.levels[SLIP]
    ]
    pictures["fig19-slopes"] = slopes([one for one in series if one.points])
    return pictures
