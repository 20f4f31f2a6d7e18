"""Fig. 19: a heap between walls, one of which goes at once; the slope left, rotation locked or free."""

import math
from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from ryusa.figures.repose import surface as draw_surface
from ryusa.figures.slopes import Slope, slopes
from ryusa.results import Results
from ryusa.studies.osada2004 import _heap
from ryusa.studies.osada2004._parts import PHI, RATIO, ROTATION, SLIP, CaseRun, Found, Plan
from ryusa.study import Band, Finding, Trial, pool

FIGURE = "fig19"
TITLE = "Slope of a heap after the removal of its wall"
CLAIMS = ("fig19-locked", "fig19-free")
GROUND = "heap"  # the choice of size, spread, packing and floor
OTHERS: dict[str, dict[str, str]] = {
    "as shipped": {},
    "sizes within 5 %": {"grains.spread": "0.05"},
    "half as many grains": {"build.columns": "18", "build.layers": "14"},
    "floor ends at the gate": {"build.run_out": "0 cm", "build.drop": "4 cm"},
    "smooth floor": {"build.floor": "plane", "build.run_out": "0 cm"},
    "settled with friction": {"contact.friction_angle": "30 deg"},
}
BANDS = {
    "locked": Band(30.0, 36.0, "deg", "about 33 deg: 30 to 36 deg, the accuracy of a slope in a drawing"),
    "free": Band(15.0, 21.0, "deg", "about 18 deg: 15 to 21 deg, the accuracy of a slope in a drawing"),
}
STILL = Band(0.0, _heap.MOVING, "-", "the final slope: at most 1 % of the grains still move")
PAPER = {"locked": 33.0, "free": 18.0}  # deg
DECIDED = {
    "locked": "A locked grain leaves its pocket only if the slope reaches 30 deg + phi, and columns of "
    "locked grains move as rigid bodies, so the friction angle decides the slope. With the "
    "dashpot kept while sliding, as in Eqs. (2) and (3) as printed, a viscous force adds to the "
    "cap, and the heap creeps at m g/eta_s.",
    "free": "A grain that may rotate rolls out of its pocket at 30 deg whatever phi is, so friction "
    "matters little once grains roll rather than slide: packing and the run-out of the collapse "
    "determine the slope.",
}


NEAR = "15.5 deg"  # between 15 and 16 deg locked heaps, sum capped, pass the paper's slope
NEAR_STARTS = 16  # heaps per seed there: single heaps scatter by 4.6 deg, 48 of them leave 1.4 deg


def settings(plan: Plan, rotation: str) -> list[dict[str, str]]:
    """Free choices tried, the shipped one first."""
    standard = plan.pick([_base()], _deciding(rotation))
    return [*standard, *(one for one in plan.pick([], [], _others(rotation)) if one not in standard)]


def _base() -> dict[str, str]:
    return {**_heap.SHIPPED, GROUND: "as shipped"}


def _deciding(rotation: str) -> list[dict[str, str]]:
    """What decides a verdict: the friction angle, and for a locked grain whether the dashpot is capped."""
    if rotation == "free":
        return [_base(), *({**_base(), PHI: phi} for phi in ("20 deg", "40 deg"))]
    return [_base(), *({**_base(), SLIP: "total", PHI: phi} for phi in ("10 deg", NEAR, "20 deg"))]


def _others(rotation: str) -> list[dict[str, str]]:
    """Every other choice, one at a time."""
    base = _base()
    sets = [{**base, PHI: phi} for phi in ("5 deg", "10 deg", "15 deg", "20 deg", "25 deg", "40 deg")]
    phis = ("10 deg", "15 deg", "16 deg", "20 deg", "30 deg", "40 deg")
    sets += [{**base, SLIP: slip, PHI: phi} for slip in ("total", "spring-drop") for phi in phis]
    held = {**base, SLIP: "total", PHI: NEAR} if rotation == "locked" else base
    return [*sets, *({**held, GROUND: one} for one in tuple(OTHERS)[1:])]


def starts(plan: Plan, rotation: str, chosen: Mapping[str, str]) -> list[int]:
    """Seeds of the heaps, for each of the plan: several as shipped, many near the slope wanted, else one."""
    if chosen == _base():
        return _heap.starts(plan)
    near = rotation == "locked" and chosen[GROUND] == "as shipped" and chosen[SLIP] == "total"
    return _heap.starts(plan, NEAR_STARTS if near and chosen[PHI] == NEAR else 1)


def run(chosen: Mapping[str, str], rotation: str, seed: int) -> CaseRun:
    """One run."""
    return _heap.run(chosen, rotation, seed, OTHERS[chosen[GROUND]])


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Locked and free under every setting and seed."""
    return [
        run(chosen, rotation, seed)
        for rotation in BANDS
        for chosen in settings(plan, rotation)
        for seed in starts(plan, rotation, chosen)
    ]


def measure(results: Results, one: CaseRun) -> _heap.Heap:
    """Slope at the end."""
    del one
    return _heap.heap(results)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Locked about 33 deg, free about 18 deg."""
    return [_judged(found, plan, rotation) for rotation in BANDS]


def _judged(found: Found, plan: Plan, rotation: str) -> Finding:
    sets = settings(plan, rotation)
    heaps = [
        [found[run(chosen, rotation, seed)] for seed in starts(plan, rotation, chosen)] for chosen in sets
    ]
    spread = pool([_heap.slopes([one for one in group if not one.wall]) for group in heaps])
    trials: list[Trial] = []
    for chosen, group in zip(sets, heaps, strict=True):
        slope, decided, note = _heap.slope_interval(group, spread)
        trials.append(Trial("final slope", chosen, slope, BANDS[rotation], decided, note))
        trials.append(Trial("share of grains still moving", chosen, _heap.moving(group), STILL))
    ranges = [math.degrees(one.found.spread) for group in heaps for one in group if not one.wall]
    ends = [one.t_end - one.t_gate for group in heaps for one in group]
    also = (
        f"one slope changes with the height range of the fit by up to {max(ranges, default=math.nan):.0f} "
        "deg",
        f"observed for {min(ends):.1f} to {max(ends):.1f} s after the removal of the gate",
    )
    common = {
        ROTATION: rotation,
        RATIO: "2/7",
        "slope": "mean of four fits between 10 and 90 % of the height, last frame",
        "packing": "settled without friction, turning; phi and rotation set 0.01 s before the gate goes",
    }
    return Finding(f"fig19-{rotation}", tuple(trials), DECIDED[rotation], common, also=also)


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    lines: list[dict[str, object]] = []
    for rotation in BANDS:
        for chosen in settings(plan, rotation):
            for seed in starts(plan, rotation, chosen):
                one: _heap.Heap = found[run(chosen, rotation, seed)]
                lines.append({"rotation": rotation, **chosen, "seed": seed, **_heap.line(one)})
    return lines


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """The heaps as the paper shows them, and slope against friction angle."""
    pictures: dict[str, Figure] = {}
    for rotation in BANDS:
        sets = settings(plan, rotation)
        groups = [[found[run(one, rotation, seed)] for seed in starts(plan, rotation, one)] for one in sets]
        closest = min(range(len(sets)), key=lambda k: abs(_mean(groups[k]) - PAPER[rotation]))
        shown = {f"fig19-{rotation}": 0, f"fig19-{rotation}-closest": closest}
        for name, k in shown.items() if closest else [(f"fig19-{rotation}", 0)]:
            one = _typical(groups[k])
            words = ", ".join(f"{key} {value}" for key, value in sets[k].items() if key != GROUND)
            figure = draw_surface(one.seen, one.found)
            figure.suptitle(f"rotation {rotation}, {words}", fontsize=7.0)
            pictures[name] = figure
    series = [
        Slope(
            f"rotation {rotation}, slip {slip}",
            (PAPER[rotation],),
            [
                (
                    float(chosen[PHI].split()[0]),
                    _heap.slopes([found[run(chosen, rotation, s)] for s in starts(plan, rotation, chosen)]),
                )
                for chosen in settings(plan, rotation)
                if chosen[SLIP] == slip and chosen[GROUND] == "as shipped"
            ],
        )
        for rotation in BANDS
        for slip in ("spring", "spring-drop", "total")
    ]
    pictures["fig19-slopes"] = slopes([one for one in series if one.points])
    return pictures


def _mean(group: Sequence[_heap.Heap]) -> float:
    """Mean slope of the heaps that have one [deg]; inf where most have none."""
    kept = _heap.slopes([one for one in group if not one.wall])
    return sum(kept) / len(kept) if 2 * len(kept) > len(group) else math.inf


def _typical(group: Sequence[_heap.Heap]) -> _heap.Heap:
    """Heap whose slope is nearest to the mean; the first one where they stand like walls."""
    mean = _mean(group)
    sloping = [one for one in group if not one.wall]
    return (
        min(sloping, key=lambda one: abs(math.degrees(one.slope) - mean)) if math.isfinite(mean) else group[0]
    )
