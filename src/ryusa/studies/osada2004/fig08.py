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
from ryusa.studies.osada2004 import _drops, _saltation
from ryusa.studies.osada2004._drops import DropRun, Setup
from ryusa.studies.osada2004._parts import CaseRun, Found, Plan
from ryusa.study import Finding, Trial, over_seeds
from ryusa.units import quantity

FIGURE = "fig8"
TITLE = "Largest overlap against stiffness"
CLAIMS = ("fig8",)
SPEED, E = "impact speed (fig8)", "restitution (fig8)"
K_N = 100.0  # the paper's spring [N/cm]
MEAN, HARDEST = "of a saltating grain, mean", "of a saltating grain, hardest"
QUOTED = _drops.near(0.01, "-", "0.01 at about 100 N/cm")
PART = "largest overlap/d, d = 0.2 cm, k_n = 100 N/cm"


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


def choices(plan: Plan) -> list[dict[str, str]]:
    """Impact speeds with and without loss, the shipped one first, and what a saltating grain does."""
    speeds = plan.pick(
        (_drops.SPEED,),
        (_drops.SPEED, "0.1 m/s", "0.2 m/s", "0.5 m/s", "0.6 m/s", "0.7 m/s", "0.8 m/s", "1 m/s", "2 m/s"),
    )
    sets = [{SPEED: speed, E: e} for e in plan.pick(("0.7",), ("0.7", "1")) for speed in speeds]
    return [*sets, {SPEED: MEAN, E: "0.7"}, {SPEED: HARDEST, E: "0.7"}]


def setup(chosen: Mapping[str, str]) -> Setup:
    """The drop at the paper's spring."""
    return Setup(k_n=K_N, speed=chosen[SPEED], e=float(chosen[E]))


def dropped(plan: Plan) -> list[dict[str, str]]:
    """Choices that are drops."""
    return [one for one in choices(plan) if one[SPEED] not in (MEAN, HARDEST)]


def setups(plan: Plan) -> list[Setup]:
    """Every drop."""
    return list(dict.fromkeys([setup(one) for one in dropped(plan)] + chart(plan)))


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
    for chosen in dropped(plan):
        drop: DropRun = found[setup(chosen).task]
        trials.append(Trial(PART, chosen, drop.over_phases(drop.overlap, "-"), QUOTED))
    hits: list[Hits] = [found[one] for one in saltating(plan)]
    for word, pick in ((MEAN, np.mean), (HARDEST, np.max)):
        values = over_seeds([float(pick(one.overlap)) for one in hits], "-")
        trials.append(Trial(PART, {SPEED: word, E: "0.7"}, values, QUOTED))
    base = trials[0].found.value
    wanted = quantity(_drops.SPEED, "m/s") * 0.01 / base
    speed = np.concatenate([one.speed for one in hits])
    return (
        Finding(
            "fig8",
            tuple(trials),
            "The overlap is proportional to impact speed and to the square root of mass over stiffness. "
            f"At 100 N/cm it is {base:.4f} for {_drops.SPEED}, so 0.01 requires {wanted:.2f} m/s, a fall "
            f"of {100.0 * wanted**2 / 19.6:.1f} cm in air; a saltating grain hits the bed with "
            f"{speed.mean():.2f} m/s along the normal on average and {speed.max():.2f} m/s at most.",
            {"d": _drops.DIAMETER, "k_n": "100 N/cm", "parting": _drops.NO_TENSION},
            also=(
                f"at {_drops.SPEED} an overlap of 0.01 d requires {K_N * (base / 0.01) ** 2:.0f} N/cm",
                f"{100.0 * np.mean(speed >= wanted):.0f} % of the {len(speed)} hits of the saltating grain "
                f"are at {wanted:.2f} m/s or more",
            ),
        ),
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per drop."""
    return _drops.rows(setups(plan), found)


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
    for e in dict.fromkeys(one[E] for one in dropped(plan)):
        at = sorted(
            (found[setup(one).task] for one in dropped(plan) if one[E] == e), key=lambda r: r.speed[0]
        )
        speeds, overlaps = (
            np.array([np.median(getattr(r, name)) for r in at]) for name in ("speed", "overlap")
        )
        by_speed.append((f"run, dropped, e = {e}", speeds, overlaps))
    hits = [found[one] for one in saltating(plan)]
    cloud = (np.concatenate([one.speed for one in hits]), np.concatenate([one.overlap for one in hits]))
    words = ("closed form, no weight", f"e = 0.7, impact at {_drops.SPEED}; shaded: 0.001 to 0.01")
    return {
        "fig08": figures.drop_chart(
            "overlap",
            lines,
            runs,
            quoted=[figures.QuotedPoint(100.0 * K_N, 0.01, _drops.DIAMETER)],
            levels=BAND,
            words=words,
        ),
        "fig08-speed": figures.over_speed(
            by_speed, cloud, levels=BAND, wanted=0.01, note="d = 0.2 cm, 100 N/cm; shaded: 0.001 to 0.01"
        ),
    }
