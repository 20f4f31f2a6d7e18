"""Open question ii again: a coefficient fitted on the heap in a wide box, the rest predicted blind."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from ryusa.cases import case_path
from ryusa.laws.transport import q_star_meyer_peter_mueller
from ryusa.measure import transport
from ryusa.results import Results
from ryusa.study import Finding, Interval, Trial, case_run, over_seeds, short
from ryusa_studies.osada2004 import _heap, rolling_friction
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import PHI, CaseRun, Found, Plan
from ryusa_studies.osada2004._rolling_fit import HeapFit, limits
from ryusa_studies.osada2004._shares import positive
from ryusa_studies.osada2004.figures.slopes import Slope, slopes
from ryusa_studies.osada2004.rolling_friction import GRAVEL, NONE, MeasuredFlow

FIGURE = "fig23"
TITLE = "A coefficient of rolling friction, fitted on the heap alone in a wide box, and then used blind"
CLAIMS = ("rolling-blind",)
BED = "bedload_3d"
COEFFICIENTS = ("0.25", "0.5", "1", "2")  # the box
ANGLES = ("30 deg", "20 deg", "40 deg")  # settings, the first as shipped
# Coefficient of each setting, by the rule of the registration.
FITTED: Mapping[str, str] = {"30 deg": "0.5", "20 deg": "1", "40 deg": "1"}
STEPS, STEPS_EACH = 10.0, 20.0  # in the shortest contact: at least, and for each unit of the coefficient
PARTNERS = 6  # in a plane packing, for which STEPS_EACH is stable
WATER_EACH = 3.3  # steps between two exchanges of water and grains, over those in a contact
SIZE = {"build.columns": "30", "build.layers": "24"}  # of the heap that is fitted
DEEP = {"motion.plane": "false", "build.columns": "20", "build.layers": "16", "build.rows": "5"}
# tau_star, and the slope that makes it with 8 cm of water over grains of 4 mm
STRESSES = {"0.1": "0.00825", "0.2": "0.0165", "0.3": "0.02475", "0.5": "0.04125"}
OTHERS = ("0.3",)  # of them, at friction angles other than the first
QUICK_STRESS = {"0.3": {"stop.time": "1.5 s", "record.settle": "0.5 s"}}
PLACE = "place of the fitted coefficient in the searched box"
HEAP, SPUN = "slope of the heap at the fitted coefficient", "blind: spin of a saltating grain"
FAST, FLUX = rolling_friction.FAST, rolling_friction.FLUX
LOAD = "blind: bed load in three dimensions at tau_star {} over Meyer-Peter and Mueller"
SPACE = "blind: slope of a heap in three dimensions"


def steps(mu_r: str) -> str:
    """Steps in the shortest contact that keep rolling springs stable (`laws.rolling.epsd_step`)."""
    return f"{max(STEPS, STEPS_EACH * float(mu_r)):g}" if mu_r != NONE else f"{STEPS:g}"


def _step(mu_r: str) -> dict[str, str]:
    """Key of the step; as the cases ship without rolling friction."""
    return {} if mu_r == NONE else {"time.steps_per_contact": steps(mu_r)}


def heap_run(mu_r: str, angle: str, seed: int, more: Mapping[str, str]) -> CaseRun:
    """One heap of Fig. 19, rotation free."""
    return rolling_friction.heap_run(mu_r, angle, seed, {**_step(mu_r), **more})


def spin_run(mu_r: str, angle: str, seed: int) -> CaseRun:
    """Four saltating grains of Fig. 21."""
    return rolling_friction.spin_run(mu_r, angle, seed, _step(mu_r))


def debris_run(mu_r: str, angle: str, seed: int) -> CaseRun:
    """One debris flow of Fig. 17, rotation free."""
    return rolling_friction.debris_run(mu_r, angle, seed, _step(mu_r))


def bed_run(tau_star: str, mu_r: str, angle: str, seed: int, more: Mapping[str, str]) -> CaseRun:
    """One bed of gravel in three dimensions, with the laws that bed load needs (docs/river.md)."""
    changed = {**rolling_friction.keys(mu_r, angle), **_step(mu_r), **more}
    changed |= {"motion.slope": STRESSES[tau_star]}
    changed |= {"water.column.interval": f"{round(WATER_EACH * float(steps(mu_r)))}"}
    return case_run(case_path(f"{BED}.toml"), changed, seed=seed)


@dataclass(frozen=True)
class Runs:
    """What is run at one level.

    Attributes
    ----------
    angles : settings.
    fitted : coefficients of the heaps of the fit.
    heap : keys of those heaps.
    space : keys of heaps in three dimensions; none at the quick level.
    beds : keys of each shear stress.
    plain : whether flows without rolling friction stand beside.
    """

    angles: tuple[str, ...]
    fitted: tuple[str, ...]
    heap: Mapping[str, str]
    space: Mapping[str, str] | None
    beds: Mapping[str, Mapping[str, str]]
    plain: bool

    @classmethod
    def of(cls, plan: Plan) -> "Runs":
        """The whole, or at the quick level one short run of each kind as shipped, without the large heap."""
        whole = cls(ANGLES, COEFFICIENTS, SIZE, DEEP, {one: {} for one in STRESSES}, plain=True)
        return plan.pick(cls(ANGLES[:1], (), {}, None, QUICK_STRESS, plain=False), whole)

    def beds_at(self, angle: str) -> Mapping[str, Mapping[str, str]]:
        """Keys of the shear stresses that are run at a friction angle."""
        return {one: more for one, more in self.beds.items() if angle == ANGLES[0] or one in OTHERS}

    def blind(self, mu_r: str, angle: str, seed: int) -> list[CaseRun]:
        """Runs that the fit does not see."""
        runs = [spin_run(mu_r, angle, seed), debris_run(mu_r, angle, seed)]
        runs += [bed_run(one, mu_r, angle, seed, more) for one, more in self.beds_at(angle).items()]
        return runs + ([heap_run(mu_r, angle, seed, self.space)] if self.space is not None else [])


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Heaps of the fit, and what is predicted at the fitted coefficient of every friction angle."""
    todo = Runs.of(plan)
    runs: list[CaseRun] = []
    for seed in plan.seeds:
        for angle in todo.angles:
            runs += [heap_run(one, angle, seed, todo.heap) for one in (FITTED[angle], *todo.fitted)]
            runs += [*todo.blind(FITTED[angle], angle, seed), rolling_friction.locked_run(seed, angle)]
        if todo.plain:
            runs += todo.blind(NONE, ANGLES[0], seed)
    return list(dict.fromkeys(runs))


def measure(results: Results, one: CaseRun) -> _heap.Heap | float | MeasuredFlow:
    """Heap, mean spin [rad/s], or flow."""
    if one.case != BED:
        return rolling_friction.measure(results, one)
    load = transport(results)
    formula = q_star_meyer_peter_mueller(load.tau_star)
    over = load.averages["q_star"].value / formula if formula > 0.0 else math.inf
    return MeasuredFlow(load.averages["q"].value, math.nan, over, load.tau_star)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Whether the coefficient that the heap asks for lies inside the box, and serves what it has not seen."""
    todo = Runs.of(plan)
    trials: list[Trial] = []
    for angle in todo.angles:
        chosen = {PHI: angle}
        if todo.fitted:
            trials.append(_place(_fit(found, plan, angle), chosen))
        heaps = [found[heap_run(FITTED[angle], angle, seed, todo.heap)] for seed in plan.seeds]
        trials.append(_heap.slope_trial(HEAP, chosen, heaps, _heap.MEAN, band(CLAIMS[0], HEAP)))
        trials += _blind(found, plan, FITTED[angle], angle, chosen)
    beside: list[Trial] = []
    if todo.plain:
        beside = [
            Trial(one.part, {PHI: f"{ANGLES[0]}, {NONE} rolling friction"}, one.found, None, note=one.note)
            for one in _blind(found, plan, NONE, ANGLES[0], {})
        ]
    return [
        finding(
            CLAIMS[0], trials, also=_words(found, plan), beside=beside, steps=STEPS_EACH, partners=PARTNERS,
            edges=_edges(found, plan),
        )
    ]  # fmt: skip


def _fit(found: Found, plan: Plan, angle: str) -> HeapFit:
    todo = Runs.of(plan)
    return HeapFit(
        {
            float(mu_r): _heap.slopes([found[heap_run(mu_r, angle, seed, todo.heap)] for seed in plan.seeds])
            for mu_r in todo.fitted
        }
    )


def _place(fit: HeapFit, chosen: Mapping[str, str]) -> Trial:
    """Inside the box, or the edge at which the search ends, in words."""
    limit, edge = band(CLAIMS[0], PLACE), fit.edge(GRAVEL)
    if edge:
        none = Interval(math.nan, math.nan, math.nan, "-", len(fit.means), "no crossing")
        return Trial(PLACE, chosen, none, limit, decided=False, note=edge)
    tried = sorted(fit.slopes)
    place = math.log(fit.crossing(GRAVEL) / tried[0]) / math.log(tried[-1] / tried[0])
    low, high = limits(fit.places(GRAVEL))
    how = "95 % of resamples of the heaps"
    found = Interval(place, low, high, "-", sum(map(len, fit.slopes.values())), how)
    return Trial(PLACE, chosen, found, limit)


def _blind(found: Found, plan: Plan, mu_r: str, angle: str, chosen: Mapping[str, str]) -> list[Trial]:
    """What is predicted, part by part."""
    todo = Runs.of(plan)
    flows = [
        (found[debris_run(mu_r, angle, one)], found[rolling_friction.locked_run(one, angle)])
        for one in plan.seeds
    ]
    numbers: dict[str, list[float]] = {
        SPUN: [found[spin_run(mu_r, angle, one)] for one in plan.seeds],
        FAST: [free.near_bed / locked.near_bed for free, locked in flows],
        FLUX: [free.q / locked.q for free, locked in flows],
        **{
            LOAD.format(tau): [found[bed_run(tau, mu_r, angle, one, more)].over_formula for one in plan.seeds]
            for tau, more in todo.beds_at(angle).items()
        },
    }
    trials = [positive(part, chosen, values, band(CLAIMS[0], part)) for part, values in numbers.items()]
    if todo.space is not None:
        heaps = [found[heap_run(mu_r, angle, one, todo.space)] for one in plan.seeds]
        trials.append(_heap.slope_trial(SPACE, chosen, heaps, _heap.MEAN, band(CLAIMS[0], SPACE)))
    return trials


def _edges(found: Found, plan: Plan) -> str:
    """Where the search ends at an edge."""
    todo = Runs.of(plan)
    if not todo.fitted:
        return "Not fitted at this level."
    said = {angle: _fit(found, plan, angle).edge(GRAVEL) for angle in todo.angles}
    inside = [angle for angle, edge in said.items() if not edge]
    lines = [f"Friction angle {angle}: {edge}." for angle, edge in said.items() if edge]
    return " ".join(
        [*lines, f"An interior coefficient exists with {' and '.join(inside) or 'none of them'}."]
    )


def _words(found: Found, plan: Plan) -> tuple[str, ...]:
    """Slopes of the fit, the coefficient that the rule gives with these seeds, and tau_star at the bed."""
    todo = Runs.of(plan)
    lines: list[str] = []
    for angle in todo.angles if todo.fitted else ():
        fit = _fit(found, plan, angle)
        slope = ", ".join(f"{short(mean)} deg at mu_r {mu_r:g}" for mu_r, mean in fit.means)
        lines.append(
            f"friction angle {angle}: {slope}; the rule gives mu_r {short(fit.chosen(GRAVEL))} with these "
            f"seeds, used is {FITTED[angle]}"
        )
    for tau, more in todo.beds.items():
        runs = [found[bed_run(tau, FITTED[ANGLES[0]], ANGLES[0], one, more)] for one in plan.seeds]
        mean = over_seeds([one.tau_star for one in runs], "-")
        lines.append(f"tau_star at the bed, {tau} asked: {mean}")
    return tuple(lines)


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    lines: list[dict[str, object]] = []
    for one in tasks(plan):
        line = rolling_friction.line(one, found[one])
        if one.get("motion.plane") == "false":
            line["case"] = f"{one.case}, 3D"
        lines.append(line | {"steps": one.get("time.steps_per_contact")})
    return lines


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Slope of the heap over the coefficient, for every friction angle."""
    todo = Runs.of(plan)

    def of(mu_r: str, angle: str) -> list[float]:
        return [found[heap_run(mu_r, angle, seed, todo.heap)].slope() for seed in plan.seeds]

    series = [
        Slope(
            f"friction angle {angle}",
            (GRAVEL,),
            [(float(mu_r), of(mu_r, angle)) for mu_r in dict.fromkeys([*todo.fitted, FITTED[angle]])],
        )
        for angle in todo.angles
    ]
    return {"rolling-blind-slopes": slopes(series, "coefficient  $\\mu_r$  (–)", log=True)}
