"""Open question ii: one coefficient of rolling friction, fitted to heap and spin, then predicted blind."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ryusa.laws.transport import q_star_meyer_peter_mueller
from ryusa.measure import profiles, spin, transport
from ryusa.results import Results
from ryusa.study import Finding, Interval, Trial, not_negative, over_seeds, short
from ryusa_studies.osada2004 import _heap
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan, paper_run
from ryusa_studies.osada2004._rolling_fit import SlopeFit, SpinFit, best_pair, limits, resampled_pairs
from ryusa_studies.osada2004._shares import positive
from ryusa_studies.osada2004.figures.slopes import Slope, slopes

FIGURE = "fig23"
TITLE = "A coefficient of rolling friction, fitted and then predicted blind"
CLAIMS = ("rolling-friction",)
SPINS, DEBRIS, BED = "saltation", "fig17", "fig22_free"
COEFFICIENTS, ANGLES = ("0.25", "0.5", "1"), ("25 deg", "40 deg")  # of the fit
MORE = ("2",)  # coefficients of the saltating grain alone: with it a heap in ten steps a contact never rests
PAIR = ("1", "25 deg")  # of the fit with seeds 1 to 4; committed before a blind run was made
NONE = "without"
NOTHING: Mapping[str, str] = {}
CHOICE, FRICTION = "rolling friction", "contact.friction_angle"
GRAVEL = 38.0  # [deg]
VERY_LARGE = 450.0  # half of the paper's 900 [rad/s]
STRESSES = {"0.1": "1/60", "0.3": "1/20", "0.5": "1/12"}  # tau_star of the movable bed, and its slope
NEAR_BED = 1.0  # height above the mean crest of the fixed grains, in diameters, up to which is near the bed
LAYER = 0.5  # of profiles, in diameters
HEAP, SPUN = "slope of the heap at the pair", "spin of a saltating grain at the pair"
FAST = "blind: grain speed near the bed in the debris flow, over locked"
FLUX = "blind: flux of the debris flow, over locked"
LOAD = "blind: bed load at tau_star {} over Meyer-Peter and Mueller"
BANDS = {
    part: band("rolling-friction", part)
    for part in (HEAP, SPUN, FAST, FLUX, *(LOAD.format(one) for one in STRESSES))
}


@dataclass(frozen=True)
class MeasuredFlow:
    """Flux [m2/s], speed near the bed [m/s]; bed load over the formula [-], and tau_star at the bed [-]."""

    q: float
    near_bed: float
    over_formula: float
    tau_star: float


def keys(mu_r: str, angle: str, key: str = FRICTION) -> dict[str, str]:
    """Keys of the law and of the friction angle that differ from those of the cases."""
    law = {"rolling.model": "spring-dashpot-slider", "rolling.coefficient": mu_r}
    return ({} if mu_r == NONE else law) | ({} if angle == "30 deg" else {key: angle})


def heap_run(mu_r: str, angle: str, seed: int, more: Mapping[str, str] = NOTHING) -> CaseRun:
    """One heap of Fig. 19, rotation free."""
    return _heap.run("free", seed, {**keys(mu_r, angle, _heap.PHI_KEY), **more})


def spin_run(mu_r: str, angle: str, seed: int, more: Mapping[str, str] = NOTHING) -> CaseRun:
    """Four saltating grains of Fig. 21."""
    changed = {**keys(mu_r, angle), **more}
    return paper_run(SPINS, changed | {"motion.rotation": "free", "build.starts": "4"}, seed)


def debris_run(mu_r: str, angle: str, seed: int, more: Mapping[str, str] = NOTHING) -> CaseRun:
    """One debris flow of Fig. 17, rotation free."""
    return paper_run(DEBRIS, {**keys(mu_r, angle), **more, "motion.rotation": "free"}, seed)


def locked_run(seed: int, angle: str = "30 deg") -> CaseRun:
    """The same with rotation locked, as the paper fitted it."""
    return paper_run(DEBRIS, keys(NONE, angle), seed)


def bed_run(tau_star: str, mu_r: str, angle: str, seed: int) -> CaseRun:
    """One movable bed in weak flow, rotation free."""
    slope = STRESSES[tau_star]
    return paper_run(BED, keys(mu_r, angle) | ({} if slope == "1/20" else {"motion.slope": slope}), seed)


def _fitted(plan: Plan) -> list[tuple[str, str]]:
    """Pairs of the fit; at the quick level there is none."""
    return [(mu_r, angle) for mu_r in plan.pick((), COEFFICIENTS) for angle in ANGLES]


def _spun(plan: Plan) -> list[tuple[str, str]]:
    return [*_fitted(plan), *((mu_r, angle) for mu_r in plan.pick((), MORE) for angle in ANGLES)]


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Heaps and saltating grains of the fit; debris flow and bed load with the pair and without."""
    runs: list[CaseRun] = []
    pairs = [PAIR, *plan.pick([], [(NONE, "30 deg")])]
    for seed in plan.seeds:
        runs += [heap_run(*one, seed) for one in (PAIR, *_fitted(plan))]
        runs += [spin_run(*one, seed) for one in (PAIR, *_spun(plan))]
        runs += [locked_run(seed), *(debris_run(*one, seed) for one in pairs)]
        runs += [bed_run(stress, *one, seed) for stress in STRESSES for one in pairs]
    return list(dict.fromkeys(runs))


def measure(results: Results, one: CaseRun) -> _heap.Heap | float | MeasuredFlow:
    """Heap, mean spin [rad/s], or flow."""
    if one.case == _heap.CASE:
        return _heap.heap(results)
    if one.case == SPINS:
        return spin(results).averages["spin_absolute"].value
    profile = profiles(results, layer=LAYER, above="mean crest", bed=True)
    z, half = profile.z, 0.5 * profile.thickness
    inside = np.maximum(np.minimum(z + half, NEAR_BED * profile.d) - np.maximum(z - half, 0.0), 0.0)
    weight = np.nan_to_num(profile.phi.value) * inside
    load = transport(results)
    formula = q_star_meyer_peter_mueller(load.tau_star)
    return MeasuredFlow(
        q=load.averages["q"].value,
        near_bed=float(weight @ np.nan_to_num(profile.v_x.value)) / float(weight.sum()),
        over_formula=load.averages["q_star"].value / formula if formula > 0.0 else math.inf,
        tau_star=load.tau_star,
    )


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Whether the fitted pair serves heap and spin, and flows that the fit has not seen."""
    chosen = {CHOICE: f"mu_r {PAIR[0]}, friction angle {PAIR[1]}"}
    trials = [_slope(found, plan, chosen)]
    numbers = _numbers(found, plan, PAIR)
    trials += [positive(part, chosen, values, BANDS[part]) for part, values in numbers.items()]
    plain = _numbers(found, plan, (NONE, "30 deg")) if _fitted(plan) else {}
    beside = [
        Trial(part, {CHOICE: NONE}, not_negative(over_seeds(values, BANDS[part].unit)), None)
        for part, values in plain.items()
    ]
    stress = {
        one: float(np.mean([found[bed_run(one, *PAIR, seed)].tau_star for seed in plan.seeds]))
        for one in STRESSES
    }
    return [
        finding(
            "rolling-friction",
            trials,
            also=(
                *(f"tau_star at the bed, {one} asked: {short(mean)}" for one, mean in stress.items()),
                *_words(found, plan),
            ),
            beside=beside,
        )
    ]


def _slope(found: Found, plan: Plan, chosen: Mapping[str, str]) -> Trial:
    """Slope at the pair by the fit to all heaps; without a fit that of the heaps at the pair."""
    if not _fitted(plan):
        heaps = [found[heap_run(*PAIR, seed)] for seed in plan.seeds]
        return _heap.slope_trial(HEAP, chosen, heaps, _heap.MEAN, BANDS[HEAP])
    slope = fits(found, plan)[0]
    low, high = limits([one.at(*_key(*PAIR)) for one in slope.resamples()])
    n = sum(len(one) for one in slope.runs.values())
    how = f"95 % of resamples of the fit to {n} heaps"
    return Trial(HEAP, chosen, Interval(slope.at(*_key(*PAIR)), low, high, "deg", n, how), BANDS[HEAP])


def _numbers(found: Found, plan: Plan, pair: tuple[str, str]) -> dict[str, list[float]]:
    """Numbers of every seed with a pair, by part; without the heap, whose slope may be none."""
    flows = [(found[debris_run(*pair, seed)], found[locked_run(seed)]) for seed in plan.seeds]
    spins = {SPUN: [found[spin_run(*pair, seed)] for seed in plan.seeds]} if pair == PAIR else {}
    return {
        **spins,
        FAST: [free.near_bed / locked.near_bed for free, locked in flows],
        FLUX: [free.q / locked.q for free, locked in flows],
        **{
            LOAD.format(one): [found[bed_run(one, *pair, seed)].over_formula for seed in plan.seeds]
            for one in STRESSES
        },
    }


def _key(mu_r: str, angle: str) -> tuple[float, float]:
    return float(mu_r), float(angle.split(maxsplit=1)[0])


def fits(found: Found, plan: Plan) -> tuple[SlopeFit, SpinFit]:
    """Slope and spin over coefficient and friction angle; heaps that stand as walls have no slope."""
    slope = {
        _key(*one): _heap.slopes([found[heap_run(*one, seed)] for seed in plan.seeds])
        for one in _fitted(plan)
    }
    turned = {_key(*one): [found[spin_run(*one, seed)] for seed in plan.seeds] for one in _spun(plan)}
    return SlopeFit.of(slope), SpinFit(turned)


def _words(found: Found, plan: Plan) -> list[str]:
    """The fit of these seeds, with its intervals."""
    if not _fitted(plan):
        return []
    slope, spun = fits(found, plan)
    best, resamples = best_pair(slope, spun, GRAVEL), resampled_pairs(slope, spun, GRAVEL)
    said = [
        f"{name} {short(getattr(best, key))} ({_span([getattr(one, key) for one in resamples])})"
        for name, key in _NAMES.items()
    ]
    lines = [f"fit of these seeds, 95 % of resamples: {', '.join(said)}"]
    for angle in ANGLES:
        phi = _key("1", angle)[1]
        steep, slow = slope.coefficient(GRAVEL, phi), spun.coefficient(VERY_LARGE, phi)
        lines.append(
            f"friction angle {angle}: {GRAVEL:g} deg at mu_r {_reached(steep)}, "
            f"{VERY_LARGE:g} rad/s at mu_r {_reached(slow)}"
        )
    return lines


_NAMES: Mapping[str, Any] = {
    "mu_r": "mu_r", "friction angle in deg": "angle", "slope in deg": "slope", "spin in rad/s": "spin",
}  # fmt: skip


def _span(values: Sequence[float]) -> str:
    low, high = limits(values)
    return f"{short(low)} to {short(high)}"


def _reached(value: float) -> str:
    return short(value) if math.isfinite(value) else "none of those tried"


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    return [line(one, found[one]) for one in tasks(plan)]


def line(one: CaseRun, number: _heap.Heap | float | MeasuredFlow) -> dict[str, object]:
    """Setting and numbers of one run."""
    made: dict[str, object] = {"case": one.case, "mu_r": one.get("rolling.coefficient", NONE)}
    made |= {"friction_angle": one.get(_heap.PHI_KEY) or one.get(FRICTION, "30 deg")}
    made |= {"bed_slope": one.get("motion.slope"), "seed": one.get("seed")}
    if isinstance(number, _heap.Heap):
        return made | _heap.line(number)
    if isinstance(number, MeasuredFlow):
        return made | {
            "q_m2_per_s": number.q, "near_bed_m_per_s": number.near_bed,
            "over_formula": number.over_formula, "tau_star": number.tau_star,
        }  # fmt: skip
    return made | {"spin_rad_per_s": number}


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Slope of the heap over the coefficient, with the pair."""
    series = [
        Slope(
            f"friction angle {angle}",
            (GRAVEL,),
            [
                (float(mu_r), [found[heap_run(mu_r, angle, seed)].slope() for seed in plan.seeds])
                for mu_r, other in dict.fromkeys([*_fitted(plan), PAIR])
                if other == angle
            ],
        )
        for angle in dict.fromkeys((*ANGLES, PAIR[1]))
    ]
    shown = [one for one in series if one.points]
    return {"rolling-friction-slopes": slopes(shown, "coefficient  $\\mu_r$  (–)", log=True)}
