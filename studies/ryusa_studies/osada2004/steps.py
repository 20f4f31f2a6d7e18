"""How many steps a contact needs: our semi-implicit runs, and the paper's forward differences beside them."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from ryusa.measure.statistics import Floats
from ryusa.study import Band, Finding, Interval, Trial, over_range
from ryusa_studies.osada2004 import _drops
from ryusa_studies.osada2004._drops import AT_STEPS, COPIES, NO_TENSION, TENSION, DropRun, Setup
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import PARTING, Found, Plan
from ryusa_studies.osada2004.figures import ReboundCurve, rebounds
from ryusa_studies.osada2004.forward_euler import restitution

FIGURE = "steps"
TITLE = "Steps per contact against abnormal rebound"
CLAIMS = ("steps",)
SCHEME, RESTITUTION = "time scheme (steps)", "restitution (steps)"
OURS = "semi-implicit"
EULER = "forward differences, spring from overlap"
SUMMED = "forward differences, spring summed as in Eq. (1)"
E, LEAST = 0.7, 10.0
DESIGN = design("steps")
# Restitution off by more is abnormal: half of what the paper's 0.6 to 0.8 for sand leaves about 0.7
OFF = 0.05
NORMAL = Band(0.0, OFF, "-", f"no abnormal rebound: e off by at most {OFF:g} from that of the case")
ABNORMAL = Band(OFF, math.inf, "-", f"abnormal rebound: e off by more than {OFF:g} in some contact")


def counts(plan: Plan) -> tuple[float, ...]:
    """Steps per contact of the runs; the case reader refuses fewer than five."""
    return plan.pick((5.0, 7.0, 10.0, 20.0, 50.0), (5.0, 7.0, 10.0, 14.0, 20.0, 50.0, 100.0))


def partings(plan: Plan) -> tuple[str, ...]:
    """Ways to part tried."""
    return plan.pick((NO_TENSION,), (NO_TENSION, TENSION))


def setups(plan: Plan) -> list[Setup]:
    """One drop per number of steps, way to part and restitution that our scheme is run with."""
    ours = {(one[PARTING], float(one[RESTITUTION])) for one in choices(plan) if one[SCHEME] == OURS}
    drawn = {(parting, E) for parting in partings(plan)}
    return [
        Setup(parting=parting, e=e, steps=steps, timing=AT_STEPS)
        for parting, e in sorted(ours | drawn)
        for steps in counts(plan)
    ]


tasks, measure = _drops.tasks_of(setups), _drops.measure


def forward(steps: float, parting: str, summed: bool, e: float = E) -> Floats:
    """Restitution of one drop by forward differences, by phase of first touch [-].

    Parameters
    ----------
    steps : steps in the shortest contact, as for the runs.
    parting : whether the dashpot may pull.
    e : restitution in the limit of small steps.
    summed : True adds k_n v dt in every step in touch, Eq. (1) as printed; False reads the overlap.

    Notes
    -----
    Mass, natural frequency and impact speed are 1.
    """
    drop = Setup(parting=parting, e=e)
    dt = drop.shortest * math.sqrt(drop.stiffness / drop.m) / steps
    starts = -(np.arange(COPIES) + 0.5) / COPIES * dt
    n_steps, tension = int(20.0 * steps) + 20, parting == TENSION
    return np.array([restitution(x, drop.zeta, dt, n_steps, summed, tension) for x in starts])


def rebound(found: Found, scheme: str, parting: str, steps: float, e: float = E) -> Floats:
    """Restitution by phase [-]; nan for a copy that never comes off."""
    if scheme != OURS:
        return forward(steps, parting, scheme == SUMMED, e)
    drop: DropRun = found[Setup(parting=parting, steps=steps, e=e, timing=AT_STEPS).task]
    return np.concatenate([drop.e, np.full(drop.copies - len(drop.e), np.nan)])


choices = DESIGN.sets


def farthest(found: Found, chosen: Mapping[str, str], steps: Sequence[float]) -> Interval:
    """How far e is off at worst over phases, and over these numbers of steps."""
    e = float(chosen[RESTITUTION])
    worst = [np.abs(rebound(found, chosen[SCHEME], chosen[PARTING], one, e) - e).max() for one in steps]
    return over_range([float(np.max(worst))], "-", f"worst of {COPIES} phases of first touch")


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Normal from ten steps on, abnormal below."""
    enough = [one for one in counts(plan) if one >= LEAST]
    few = [one for one in counts(plan) if one < LEAST]
    trials: list[Trial] = []
    for chosen in choices(plan):
        many = f"e off by at most, {enough[0]:g} to {enough[-1]:g} steps"
        less = f"e off by, {few[0]:g} to {few[-1]:g} steps"
        trials.append(Trial(many, chosen, farthest(found, chosen, enough), NORMAL))
        trials.append(Trial(less, chosen, farthest(found, chosen, few), ABNORMAL))
    at_ten = {scheme: rebound(found, scheme, NO_TENSION, LEAST) for scheme in (OURS, EULER, SUMMED)}
    words = [f"{name} {values.min():.2f} to {values.max():.2f}" for name, values in at_ten.items()]
    stable = _stable(TENSION)
    return (
        finding(
            "steps",
            trials,
            also=[_needed(scheme, name) for scheme in (EULER, SUMMED) for name in (NO_TENSION, TENSION)],
            stable=stable,
            words=", ".join(words),
        ),
    )


def _stable(parting: str) -> float:
    """Steps per contact below which forward differences make a free oscillation grow [-]."""
    drop = Setup(parting=parting)
    omega_0 = math.sqrt(drop.stiffness / drop.m)
    return drop.shortest * omega_0 / (2.0 * drop.zeta)


def _needed(scheme: str, parting: str) -> str:
    """StudyProgress from how many steps on the scheme keeps e."""
    tried = (*range(3, 40), *range(40, 200, 5))
    good = [bool(np.abs(forward(n, parting, scheme == SUMMED) - E).max() <= OFF) for n in tried]
    last = max((k for k, one in enumerate(good) if not one), default=-1)
    return f"{scheme}, {parting}: e is within {OFF:g} from {tried[last + 1]} steps on"


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per scheme, way to part and number of steps."""
    return [
        {**chosen, "steps_per_contact": steps, "e_lowest": e.min(), "e_mean": e.mean(), "e_highest": e.max()}
        for chosen in choices(plan)
        for steps in counts(plan)
        for e in [rebound(found, chosen[SCHEME], chosen[PARTING], steps, float(chosen[RESTITUTION]))]
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Restitution over steps per contact, one picture per way to part."""
    pictures: dict[str, Figure] = {}
    for parting in partings(plan):
        schemes: dict[str, ReboundCurve] = {}
        for scheme in (OURS, EULER, SUMMED):
            steps = counts(plan) if scheme == OURS else (3.0, *counts(plan))
            e = [rebound(found, scheme, parting, one) for one in steps]
            schemes[f"{scheme} (runs)" if scheme == OURS else scheme] = ReboundCurve(
                np.array(steps),
                np.array([one.mean() for one in e]),
                np.array([one.min() for one in e]),
                np.array([one.max() for one in e]),
            )
        note = f"e = 0.7 asked for, {parting}; bars: all phases of first touch"
        pictures["steps" if parting == NO_TENSION else "steps-tension"] = rebounds(
            schemes, E, OFF, LEAST, note
        )
    return pictures
