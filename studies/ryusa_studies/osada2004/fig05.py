"""Fig. 5: contact time with e = 0.7 against Eq. (8), which knows neither dashpot nor weight."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.laws.collision import collision_time, contact_time_no_tension, contact_time_tension
from ryusa.study import Band, Finding, Trial, over_range
from ryusa_studies.osada2004 import _drops
from ryusa_studies.osada2004._drops import EXACT, NO_TENSION, TENSION, DropRun, Setup
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import PARTING, Found, Plan
from ryusa_studies.osada2004.figures import drop_chart

FIGURE = "fig5"
TITLE = "Contact time with e = 0.7 beside Eq. (8)"
CLAIMS = ("fig5",)
SPEED, TIMING = "impact speed (fig5)", "timing (fig5)"
DESIGN = design("fig05")
HARDLY = Band(0.9, 1.1, "-", f"hardly differs: 0.9 to 1.1 of Eq. (8), {_drops.ABOUT}")
STAYS = "stays on its partner: weight against a soft spring"


def stiffnesses(plan: Plan) -> tuple[float, ...]:
    """Springs of the chart [N/cm]; softer ones let a grain of 1 m/s through its partner."""
    return plan.pick((0.1, 10.0, 1000.0), (0.1, 1.0, 10.0, 100.0, 1000.0))


choices = DESIGN.sets


def setup(chosen: Mapping[str, str], k_n: float) -> Setup:
    """One drop under a set of choices."""
    return Setup(k_n=k_n, speed=chosen[SPEED], parting=chosen[PARTING], timing=chosen[TIMING])


def setups(plan: Plan) -> list[Setup]:
    """Every drop."""
    return [setup(chosen, k_n) for chosen in choices(plan) for k_n in stiffnesses(plan)]


tasks, measure, rows = _drops.tasks_of(setups), _drops.measure, _drops.rows_of(setups)


def ratio(drop: DropRun) -> float:
    """Contact time over Eq. (8) [-], middle of the phases; nan where the grain stays."""
    return float(np.median(drop.time) / drop.eq_8) if drop.parts else math.nan


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Within 10 % of Eq. (8) for every spring."""
    trials: list[Trial] = []
    ends = f"{stiffnesses(plan)[0]:g} to {stiffnesses(plan)[-1]:g} N/cm"
    part = f"contact time over Eq. (8), farthest from 1 of k_n = {ends}"
    for chosen in choices(plan):
        drops: list[DropRun] = [found[setup(chosen, k_n).task] for k_n in stiffnesses(plan)]
        stay = [f"{k_n:g} N/cm" for k_n, one in zip(stiffnesses(plan), drops, strict=True) if not one.parts]
        if stay:
            nothing = over_range([math.nan], "-", "phases of first touch")
            trials.append(Trial(part, chosen, nothing, HARDLY, False, f"{STAYS} ({', '.join(stay)})"))
            continue
        worst = max(drops, key=lambda one: abs(ratio(one) - 1.0))
        trials.append(Trial(part, chosen, worst.over_phases(worst.time / worst.eq_8, "-"), HARDLY))
    zeta = {name: Setup(parting=name).zeta for name in (NO_TENSION, TENSION)}
    no_pull = contact_time_no_tension(zeta[NO_TENSION], 1.0) / math.pi
    pull = contact_time_tension(zeta[TENSION], 1.0) / math.pi
    every = [(one, found[one.task]) for one in setups(plan)]
    slack = [(one.heaviness, float(np.median(drop.e))) for one, drop in every if drop.parts]
    light = sorted((one.heaviness, HARDLY.low <= ratio(drop) <= HARDLY.high) for one, drop in every)
    most = max((h for k, (h, _) in enumerate(light) if all(good for _, good in light[: k + 1])), default=0.0)
    least = min(slack, key=lambda one: one[1])
    return (
        finding(
            "fig5",
            trials,
            also=(
                f"weight reduces the restitution too: e = {least[1]:.2f} instead of 0.7 at g/(v omega_0) = "
                f"{least[0]:.2f}",
                f"within 10 % in every run with g/(v omega_0) up to {most:.2g}",
            ),
            no_pull=no_pull,
            pull=pull,
        ),
    )


def _named(speed: str, values: np.ndarray) -> str:
    """Label of a series; says where points are missing."""
    return f"run, {speed}" + ("; on the softest it stays" if np.isnan(values).any() else "")


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Both times over k_n, as in the paper, and their ratio for every choice."""
    k = np.array(stiffnesses(plan)) * 100.0
    nothing = np.zeros(len(k))
    law = figures.StiffnessCurve("Eq. (8)", k, np.array([collision_time(Setup().m, one) for one in k]))
    ratios = {
        tuple(chosen.values()): np.array([ratio(found[setup(chosen, one).task]) for one in stiffnesses(plan)])
        for chosen in choices(plan)
    }
    runs = [
        figures.StiffnessPoints(f"run, e = 0.7, {parting}, {timing}", k, values * law.y, nothing)
        for (speed, parting, timing), values in ratios.items()
        if speed == _drops.SPEED
    ]
    alike = [key for key in ratios if key[2] == EXACT or len(ratios) == 1]
    by_speed = [
        figures.StiffnessPoints(
            _named(f"{speed}, {parting}", ratios[speed, parting, timing]),
            k,
            ratios[speed, parting, timing],
            nothing,
        )
        for speed, parting, timing in sorted(alike, key=lambda one: float(one[0].split()[0]))
    ]
    one = figures.StiffnessCurve("Eq. (8)", k, np.ones(len(k)))
    words = f"d = 0.2 cm, impact at {_drops.SPEED}"
    return {
        "fig05": drop_chart("time", [law], runs, words=("Eq. (8)", words)),
        "fig05-speed": drop_chart(
            "ratio", [one], by_speed, levels=(HARDLY.low, HARDLY.high), legend="above",
            words=("Eq. (8)", "e = 0.7, with weight, exact timing; shaded: 10 %"),
        ),
    }  # fmt: skip
