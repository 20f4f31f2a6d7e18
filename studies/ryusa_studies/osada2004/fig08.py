"""Fig. 8: largest overlap over diameter against stiffness; the paper leaves open how hard a grain hits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.laws.collision import overlap_max
from ryusa.measure import collisions
from ryusa.measure.stability import BAND
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.study import Band, Finding, Trial, over_range, over_seeds
from ryusa.units import quantity
from ryusa_studies.osada2004 import _drops, _saltation
from ryusa_studies.osada2004._drops import DropRun, Setup
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import PARTING, CaseRun, Found, Plan
from ryusa_studies.osada2004.figures import QuotedPoint, drop_chart, over_speed

FIGURE = "fig8"
TITLE = "Largest overlap against stiffness"
CLAIMS = ("fig8", "fig8-through")
SPEED, E, TIMING = "impact speed (fig8)", "restitution (fig8)", "timing (fig8)"
DESIGN = design("fig08")
K_N = 100.0  # the paper's spring [N/cm]
MEAN, HARDEST = "of a saltating grain, mean", "of a saltating grain, hardest"
QUOTED = _drops.near(0.01, "-", "0.01 at about 100 N/cm")
PART = "largest overlap/d, d = 0.2 cm, k_n = 100 N/cm"
WEAK = 0.01  # the spring that the paper calls weak [N/cm]
LADDER = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 100.0)  # [N/cm]
GREATLY = Band(0.1, np.inf, "-", "overlap greatly: ten times the 0.01 that the paper finds safe, or more")
WEAK_ONES = Band(
    WEAK, K_N, "N/cm", f"weak springs: {WEAK:g} N/cm, which the paper calls weak, to its stable {K_N:g} N/cm"
)


@dataclass(frozen=True)
class Hits:
    """Contacts of saltating grains with the bed."""

    speed: Floats  # closing speed [m/s]
    overlap: Floats  # largest, over d [-]


def stiffnesses(plan: Plan) -> tuple[float, ...]:
    """Springs of the chart [N/cm]; the softest lets no grain through its partner."""
    return plan.pick((0.1, 10.0, 1.0e4), (0.1, 1.0, 10.0, 100.0, 1000.0, 1.0e4))


def chart(plan: Plan) -> list[Setup]:
    """Drops of all diameters and springs at the shipped speed; fig11 lays its band over the same ones."""
    return [Setup(d=d, k_n=k_n) for d in _drops.SIZES for k_n in stiffnesses(plan)]


choices = DESIGN.sets


def setup(chosen: Mapping[str, str], k_n: float = K_N) -> Setup:
    """The drop of a setting, at the paper's spring or another."""
    return Setup(
        k_n=k_n, speed=chosen[SPEED], e=float(chosen[E]), parting=chosen[PARTING], timing=chosen[TIMING]
    )


def setups(plan: Plan) -> list[Setup]:
    """Every drop."""
    ladders = [setup(chosen, k_n) for chosen in choices(plan) for k_n in LADDER]
    return list(dict.fromkeys([*ladders, *chart(plan)]))


rows = _drops.rows_of(setups)


def saltating(plan: Plan) -> list[CaseRun]:
    """The saltation of fig20, rotation locked, at 100 N/cm as it ships."""
    return [_saltation.run(_saltation.SHIPPED, "locked", seed) for seed in plan.seeds]


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Drops, and the saltation that says how hard a grain really hits."""
    return [*(one.task for one in setups(plan)), *saltating(plan)]


def measure(run: Results, one: CaseRun) -> DropRun | Hits:
    """Keep overlaps and speeds."""
    if one.case == _drops.CASE:
        return _drops.measure(run, one)
    found = collisions(run, "bed")
    return Hits(found.speed, found.overlap)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """0.01 at 100 N/cm, by impact speed."""
    trials: list[Trial] = []
    for chosen in choices(plan):
        drop: DropRun = found[setup(chosen).task]
        trials.append(Trial(PART, chosen, drop.over_phases(drop.overlap, "-"), QUOTED))
    hits: list[Hits] = [found[one] for one in saltating(plan)]
    beside: list[Trial] = []
    for word, pick in ((MEAN, np.mean), (HARDEST, np.max)):
        values = over_seeds([float(pick(one.overlap)) for one in hits], "-")
        beside.append(Trial(PART, {**DESIGN.base, SPEED: word}, values, QUOTED))
    base = trials[0].found.value
    wanted = quantity(_drops.SPEED, "m/s") * 0.01 / base
    speed = np.concatenate([one.speed for one in hits])
    return (
        finding(
            "fig8",
            trials,
            also=(
                f"at {_drops.SPEED} an overlap of 0.01 d requires {K_N * (base / 0.01) ** 2:.0f} N/cm",
                f"{100.0 * np.mean(speed >= wanted):.0f} % of the {len(speed)} hits of the saltating grain "
                f"are at {wanted:.2f} m/s or more",
            ),
            beside=beside,
            base=base,
            wanted=wanted,
            height=100.0 * wanted**2 / 19.6,
            mean=speed.mean(),
            largest=speed.max(),
        ),
        _through(found, plan),
    )


def _through(found: Found, plan: Plan) -> Finding:
    """Deep overlap on the weak spring, and the stiffest spring on which a grain passes."""
    trials: list[Trial] = []
    for chosen in choices(plan):
        ladder: list[DropRun] = [found[setup(chosen, k_n).task] for k_n in LADDER]
        weak = ladder[LADDER.index(WEAK)]
        deep = over_range(list(weak.overlap), "-", f"{len(weak.overlap)} phases of first touch")
        trials.append(Trial("largest overlap/d, d = 0.2 cm, k_n = 0.01 N/cm", chosen, deep, GREATLY))
        trials.append(_limit(chosen, [one.passed > 0 for one in ladder]))
    return finding("fig8-through", trials)


def _limit(chosen: Mapping[str, str], passes: Sequence[bool]) -> Trial:
    """The stiffest spring of the ladder on which a grain passes, up to the next stiffer one."""
    part = "stiffest spring on which a grain passes"
    last = max((k for k, one in enumerate(passes) if one), default=-1)
    if last < 0:
        none = over_range([np.nan], "N/cm", f"ladder of {len(LADDER)} springs")
        return Trial(part, chosen, none, WEAK_ONES, False, f"passes on none, down to {LADDER[0]:g} N/cm")
    ends = LADDER[last : last + 2]
    return Trial(part, chosen, over_range(list(ends), "N/cm", "a spring and the next stiffer"), WEAK_ONES)


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Overlap over k_n for all diameters, and over impact speed at the paper's spring."""
    k = np.array(stiffnesses(plan)) * 100.0
    lines, runs = [], []
    for d in _drops.SIZES:
        one = Setup(d=d)
        law = np.array([overlap_max(0.3, one.m, s, one.zeta) for s in k]) / quantity(d, "m")
        drops = [found[Setup(d=d, k_n=s).task] for s in stiffnesses(plan)]
        lines.append(figures.StiffnessCurve(d, k, law))
        runs.append(
            figures.StiffnessPoints(
                f"run, d = {d}", k, np.array([np.median(r.overlap) for r in drops]), 0 * k
            )
        )
    by_speed = []
    for e in dict.fromkeys(one[E] for one in choices(plan)):
        drops = (found[setup(one).task] for one in choices(plan) if one[E] == e)
        at = sorted((one for one in drops if one.parts), key=lambda r: r.speed[0])
        speeds, overlaps = (
            np.array([np.median(getattr(r, name)) for r in at]) for name in ("speed", "overlap")
        )
        by_speed.append((f"run, dropped, e = {e}", speeds, overlaps))
    hits = [found[one] for one in saltating(plan)]
    cloud = (np.concatenate([one.speed for one in hits]), np.concatenate([one.overlap for one in hits]))
    words = ("closed form, no weight", f"e = 0.7, impact at {_drops.SPEED}; shaded: 0.001 to 0.01")
    return {
        "fig08": drop_chart(
            "overlap",
            lines,
            runs,
            quoted=[QuotedPoint(100.0 * K_N, 0.01, _drops.DIAMETER)],
            levels=BAND,
            words=words,
        ),
        "fig08-speed": over_speed(
            by_speed, cloud, levels=BAND, wanted=0.01, note="d = 0.2 cm, 100 N/cm; shaded: 0.001 to 0.01"
        ),
    }
