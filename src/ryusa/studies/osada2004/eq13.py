"""Eq. (13): which rolling friction lets grains that turn stand at the slope of gravel, and at what f'."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ryusa.errors import ListUnsafe, NotANumber, OverlapTooLarge, RunError
from ryusa.figures.repose import surface as draw_surface
from ryusa.figures.slopes import Slope, slopes
from ryusa.laws.rolling import rolling_arm_width
from ryusa.measure import spin
from ryusa.results import Results
from ryusa.studies.osada2004 import _heap, _saltation
from ryusa.studies.osada2004._parts import PHI, RATIO, SLIP, CaseRun, Found, Plan
from ryusa.study import Band, Finding, Interval, Level, Trial, over_seeds, pool

FIGURE = "fig23"
TITLE = "Rolling friction identified against the heap and the spin of a saltating grain"
CLAIMS = ("eq13",)
MODEL, COEFFICIENT, K_N, SIZE, SPREAD = (
    "rolling friction",
    "f' or mu_r",
    "k_n (eq13)",
    "d (eq13)",
    "sizes (eq13)",
)
PRINTED, CONSTANT, SPRING = (
    "Eq. (13) as printed",
    "against the spin, arm f' b",
    "spring-dashpot-slider, mu_r R*",
)
KINDS = {PRINTED: "printed", CONSTANT: "constant", SPRING: "spring-dashpot-slider"}
BASE = {MODEL: PRINTED, COEFFICIENT: "1", PHI: "30 deg", K_N: "100 N/cm", SIZE: "0.2 cm", SPREAD: "20 %"}
KEYS = {K_N: "contact.stiffness", SIZE: "grains.diameter", SPREAD: "grains.spread"}
GRAVEL = Band(33.0, 38.0, "deg", "between the paper's locked heap and gravel: 33 to 38 deg")
STILL = Band(0.0, _heap.MOVING, "-", "stands: at most 1 % of the grains still move at the end")
LEAST = 3  # coefficients from which one is read off between them
SPINS = ("none", PRINTED, CONSTANT, SPRING)  # for the saltating grain
SPIN_AT = {PRINTED: "1", CONSTANT: "20", SPRING: "0.5"}


@dataclass(frozen=True)
class Broken:
    """A run that could not go on."""

    message: str


def settings(plan: Plan) -> list[dict[str, str]]:
    """Models, coefficients and friction angles, the paper's own form first."""

    def one(model: str, coefficient: str, phi: str = "30 deg", **more: str) -> dict[str, str]:
        names = {"k_n": K_N, "d": SIZE, "spread": SPREAD}
        changed = {names[key]: value for key, value in more.items()}
        return {**BASE, MODEL: model, COEFFICIENT: coefficient, PHI: phi} | changed

    quick = [BASE, one(SPRING, "0.5", "40 deg")]
    standard = [
        one(PRINTED, "3"),
        one(CONSTANT, "20"),
        one(CONSTANT, "50", "40 deg"),
        one(CONSTANT, "10", k_n="25 N/cm"),  # the arm of f' = 20 at 100 N/cm, if b goes with k_n**(-1/2)
        one(SPRING, "0.2"),
        one(SPRING, "1", "40 deg"),
    ]
    full = [
        *(one(PRINTED, f) for f in ("0.3", "10")),
        *(one(CONSTANT, f, phi) for f in ("5", "20", "50", "100") for phi in ("30 deg", "40 deg")),
        *(one(SPRING, f, phi) for f in ("0.1", "0.2", "0.5", "1") for phi in ("30 deg", "40 deg")),
        *(one(CONSTANT, f, k_n="25 N/cm") for f in ("5", "20")),
        *(one(CONSTANT, f, k_n="400 N/cm") for f in ("20", "40")),
        *(one(CONSTANT, f, d="0.1 cm") for f in ("20", "40")),
        *(one(CONSTANT, f, d="0.4 cm") for f in ("10", "20")),
        *(
            one(model, f, spread=s)
            for model, f in ((CONSTANT, "20"), (SPRING, "0.5"))
            for s in ("5 %", "40 %")
        ),
        *(one(SPRING, "0.5", k_n=k) for k in ("25 N/cm", "400 N/cm")),
        *(one(SPRING, "0.5", d=d) for d in ("0.1 cm", "0.4 cm")),
    ]
    sets = [*quick, *plan.pick([], standard, [*standard, *full])]
    return [dict(pairs) for pairs in dict.fromkeys(tuple(each.items()) for each in sets)]


def _group(found: Found, plan: Plan, chosen: Mapping[str, str]) -> list[Any]:
    return [found[run(chosen, seed)] for seed in _starts(plan, chosen)]


def _starts(plan: Plan, chosen: Mapping[str, str]) -> list[int]:
    """Seeds of the heaps: one for each of the plan's; at the full level several where `_words` compares."""
    compared = chosen in settings(Plan(Level.STANDARD, plan.seeds))
    return _heap.starts(plan, plan.pick(1, 1, _heap.STARTS if compared else 1))


def run(chosen: Mapping[str, str], seed: int) -> CaseRun:
    """One heap; stretched in time as sqrt(d) where the grains are of another size."""
    more = {"rolling.model": KINDS[chosen[MODEL]], "rolling.coefficient": chosen[COEFFICIENT]}
    more |= {key: _value(chosen[name]) for name, key in KEYS.items() if chosen[name] != BASE[name]}
    stretch = _first(chosen[SIZE]) / _first(BASE[SIZE])
    if stretch != 1.0:
        more["build.run_out"] = f"{30.0 * stretch:g} cm"
        times = {"timeline.0.at": 0.49, "timeline.1.at": 0.49, "timeline.2.at": 0.5, "stop.time": 2.0}
        more |= {key: f"{t * math.sqrt(stretch):.6g} s" for key, t in times.items()}
    return _heap.run({PHI: chosen[PHI]}, "free", seed, more)


def _first(text: str) -> float:
    return float(text.split(maxsplit=1)[0])


def _value(text: str) -> str:
    return str(_first(text) / 100.0) if text.endswith("%") else text


def _spin(model: str, seed: int) -> CaseRun:
    """A saltating grain that turns, with a rolling friction or without."""
    more = {} if model == "none" else {"rolling.model": KINDS[model], "rolling.coefficient": SPIN_AT[model]}
    return _saltation.run(_saltation.SHIPPED, "free", seed, more)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Heaps under every setting and without rolling friction; saltating grains under each form."""
    plain = [_heap.run({PHI: phi}, "free", seed) for phi in _angles(plan) for seed in plan.seeds]
    heaps = [run(chosen, seed) for chosen in settings(plan) for seed in _starts(plan, chosen)]
    return [*heaps, *plain, *(_spin(model, seed) for model in SPINS for seed in plan.seeds)]


def _angles(plan: Plan) -> list[str]:
    return plan.pick(["30 deg"], ["30 deg", "40 deg"])


def measure(results: Results, one: CaseRun) -> _heap.Heap | float:
    """Slope of a heap, or mean absolute spin of a saltating grain [rad/s]."""
    return _heap.heap(results) if one.case == _heap.CASE else spin(results).averages["spin_absolute"].value


def failed(error: RunError) -> Broken | None:
    """A law that makes energy breaks the run down or throws a grain, an answer; a lost grain is none."""
    return Broken(str(error)) if isinstance(error, OverlapTooLarge | NotANumber | ListUnsafe) else None


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Slope of gravel, and a heap that stands still."""
    sets = settings(plan)
    groups = [_group(found, plan, chosen) for chosen in sets]
    spread = pool([_heap.slopes(_whole(group)) for group in groups])
    printed: list[Trial] = []
    others: list[Trial] = []
    for chosen, group in zip(sets, groups, strict=True):
        trials = printed if chosen[MODEL] == PRINTED else others
        broken = [one for one in group if isinstance(one, Broken)]
        if broken:
            note = (
                f"breaks down in {len(broken)} of {len(group)} runs: {broken[0].message.partition('. ')[0]}"
            )
            none = Interval(math.nan, math.nan, math.nan, "deg", len(group), "no run to its end")
            trials += [Trial(part, chosen, none, GRAVEL, False, note) for part in ("final slope", "standing")]
            continue
        slope, decided, note = _heap.slope_interval(group, spread)
        trials.append(Trial("final slope", chosen, slope, GRAVEL, decided, note))
        trials.append(Trial("standing", chosen, _heap.moving(group), STILL))
    decided_by = (
        "In Eq. (13) M_f opposes M_t, the torque of the shear force, not the spin. On a rolling grain M_f "
        "itself causes the shear force of the next M_t: it brakes and drives alternately, and can create "
        f"energy. {_verdict_of(others)}"
    )
    common = {
        "wanted": "33 to 38 deg with rotation free, standing at the end",
        "heap": "as fig19, 500 grains",
        SLIP: "spring",
        RATIO: "2/7",
    }
    also = (*_identified(found, plan), *_words(found, plan), *_arms())
    return [Finding("eq13", tuple(printed), decided_by, common, also=also, beside=tuple(others))]


def _whole(group: Sequence[Any]) -> list[_heap.Heap]:
    """Give the heaps of a group that have a slope."""
    return [one for one in group if isinstance(one, _heap.Heap) and not one.wall]


def _verdict_of(others: Sequence[Trial]) -> str:
    """Which other forms reach the slope and stand, in words."""
    held = Finding("eq13", tuple(others), "").by_choice
    words: list[str] = []
    for model in (CONSTANT, SPRING):
        mine = [one for key, one in held.items() if dict(key)[MODEL] == model]
        stands = [one.holds for one in others if one.choices[MODEL] == model and one.part == "standing"]
        if mine:
            words.append(
                f"{model}: reaches the slope of gravel and stands in {mine.count(True)} of {len(mine)} "
                f"settings (undecided in {mine.count(None)}), stands in {stands.count(True)}"
            )
    return f"Other forms. {'; '.join(words)}." if words else ""


def _identified(found: Found, plan: Plan) -> list[str]:
    """Coefficient at which each form first reaches the lower edge of gravel's slope, between those tried."""
    lines: list[str] = []
    sets = settings(plan)
    for key in dict.fromkeys(tuple((k, v) for k, v in one.items() if k != COEFFICIENT) for one in sets):
        fixed = dict(key)
        tried = sorted(float(one[COEFFICIENT]) for one in sets if fixed.items() <= one.items())
        if fixed[MODEL] == PRINTED or len(tried) < LEAST:
            continue
        crossings: list[float] = []
        for seed in plan.seeds:
            heaps = [found[run({**fixed, COEFFICIENT: f"{f:g}"}, seed)] for f in tried]
            if all(isinstance(one, _heap.Heap) for one in heaps):
                crossings.append(_crossing(tried, _heap.slopes(heaps), GRAVEL.low))
        reached = [one for one in crossings if math.isfinite(one)]
        words = f"{min(reached):.2g} to {max(reached):.2g}" if reached else f"not reached up to {tried[-1]:g}"
        lines.append(
            f"{fixed[MODEL]}, phi {fixed[PHI]}, k_n {fixed[K_N]}, d {fixed[SIZE]}, sizes {fixed[SPREAD]}: "
            f"coefficient for {GRAVEL.low:g} deg {words} ({len(reached)} of {len(crossings)} seeds reach it)"
        )
    return lines


def _crossing(f: Sequence[float], slopes_: Sequence[float], wanted: float) -> float:
    """First coefficient at which the slope passes a wanted one, between logarithms; nan if none.

    >>> round(_crossing([1.0, 10.0, 100.0], [20.0, 30.0, 40.0], 35.0), 2)
    31.62
    """
    for k, (a, b) in enumerate(pairwise(slopes_)):
        if a < wanted <= b:
            share = (wanted - a) / (b - a)
            return math.exp(math.log(f[k]) + share * math.log(f[k + 1] / f[k]))
    return math.nan


def _words(found: Found, plan: Plan) -> list[str]:
    """What decides nothing but belongs to the story: no rolling friction, energy made, spin, f' over k_n."""
    lines: list[str] = []
    for phi in _angles(plan):
        plain = _heap.slopes([found[_heap.run({PHI: phi}, "free", seed)] for seed in plan.seeds])
        lines.append(f"without rolling friction the heap at phi {phi} has {np.nanmean(plain):.3g} deg")
    for chosen in settings(plan):
        heaps = _group(found, plan, chosen)
        lost = [one.rolled for one in heaps if isinstance(one, _heap.Heap)]
        if chosen[MODEL] == PRINTED and lost:
            word = "takes" if np.mean(lost) > 0.0 else "makes"
            lines.append(
                f"Eq. (13) as printed at f' = {chosen[COEFFICIENT]} {word} "
                f"{abs(100.0 * np.mean(lost)):.2g} % of the energy the heap falls through"
            )
    spins = {model: [found[_spin(model, seed)] for seed in plan.seeds] for model in SPINS}
    spread = pool([[x for x in spun if not isinstance(x, Broken)] for spun in spins.values()])
    for model, spun in spins.items():
        words = (
            "breaks the run down"
            if any(isinstance(one, Broken) for one in spun)
            else str(over_seeds(spun, "rad/s", spread))
        )
        name = "without rolling friction" if model == "none" else f"{model}, {SPIN_AT[model]}"
        lines.append(f"mean spin of a saltating grain, {name}: {words}")
    pair = [
        {**BASE, MODEL: CONSTANT, COEFFICIENT: f, K_N: k} for f, k in (("20", "100 N/cm"), ("10", "25 N/cm"))
    ]
    if all(chosen in settings(plan) for chosen in pair):
        stiff, soft = (
            float(np.nanmean(_heap.slopes(_whole(_group(found, plan, chosen))))) for chosen in pair
        )
        lines.append(
            f"half the f' on a spring a quarter as stiff, the same arm f' b, gives {soft:.3g} beside "
            f"{stiff:.3g} deg; were f' a property of the grain, f' = 20 would do so on both springs"
        )
    return lines


def _arms() -> list[str]:
    """What f' stands for in a heap: the arm f' b beside mu_r R*, by the law of the contact width."""
    r, m = 0.001, 2650.0 * math.pi / 6.0 * 0.002**3
    load = 5.0 * m * 9.8
    said: list[str] = []
    for k_n, name in ((2.5e3, "25 N/cm"), (1.0e4, "100 N/cm"), (4.0e4, "400 N/cm")):
        width = rolling_arm_width(r, r, load / k_n)
        said.append(f"mu_r = 0.2 is f' = {0.2 * 0.5 * r / width:.2g} at {name}")
    return [
        "under the weight of 5 grains of 0.2 cm " + ", ".join(said) + "; f' goes with 1/d at the same k_n"
    ]


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per heap, then the spin of the saltating grains."""
    lines: list[dict[str, object]] = []
    for chosen in settings(plan):
        for seed in _starts(plan, chosen):
            one = found[run(chosen, seed)]
            numbers = {"broken": one.message} if isinstance(one, Broken) else _heap.line(one)
            lines.append({**chosen, "seed": seed, **numbers})
    for model in SPINS:
        for seed in plan.seeds:
            spun = found[_spin(model, seed)]
            numbers = {"broken": spun.message} if isinstance(spun, Broken) else {"mean_spin_rad_per_s": spun}
            lines.append({MODEL: model, COEFFICIENT: SPIN_AT.get(model, ""), "seed": seed, **numbers})
    return lines


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Slope over coefficient for each form, and the heap that comes nearest to gravel."""
    sets = [chosen for chosen in settings(plan) if all(chosen[name] == BASE[name] for name in KEYS)]
    best, nearest = math.inf, None
    series: list[Slope] = []
    for model in KINDS:
        for phi in dict.fromkeys(chosen[PHI] for chosen in sets):
            points: list[tuple[float, list[float]]] = []
            for chosen in sets:
                group = _group(found, plan, chosen)
                if chosen[MODEL] != model or chosen[PHI] != phi or any(isinstance(x, Broken) for x in group):
                    continue
                points.append((float(chosen[COEFFICIENT]), _heap.slopes(group)))
                off = abs(math.degrees(group[0].slope) - 0.5 * (GRAVEL.low + GRAVEL.high))
                if off < best:
                    best, nearest = off, (chosen, group[0])
            if points:
                series.append(Slope(f"{model}, phi {phi}", (GRAVEL.low, GRAVEL.high), points))
    figures = {"eq13-slopes": slopes(series, "coefficient  $f'$ or $\\mu_r$  (–)", log=True)}
    if nearest is not None:
        chosen, one = nearest
        figures["eq13-heap"] = draw_surface(one.seen, one.found)
        words = f"{chosen[MODEL]} = {chosen[COEFFICIENT]}, phi {chosen[PHI]}, rotation free"
        figures["eq13-heap"].suptitle(words, fontsize=7.0)
    return figures
