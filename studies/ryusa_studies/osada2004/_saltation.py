"""What the saltation experiments share (figs. 7, 20, 21, hops, spin, water torque): design and runs."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ryusa.measure import Saltation, Tracks, collisions, saltation, tracks
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.study import Interval, Pooled, Trial, over_seeds, pool, seeds_trial
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._parts import (
    CLOSURE,
    DRAG,
    PARTING,
    PHI,
    RATIO,
    SLIP,
    START,
    CaseRun,
    Plan,
    paper_run,
)

CASE = "saltation"
HOPS = 30  # of each start, as in the paper
MANY = {"build.starts": "16", "record.frames": "5 ms"}  # starts are cheap, frames in between are not
LOCKED, FREE = "locked", "free"
K_N, TORQUE, RE = "k_n", "torque law", "Re"
STIFF = "100 N/cm"  # as the case ships
SOFT = "1 N/cm"  # that of Fig. 6
FLOWING, RESTING = "with the water", "at rest"
SKIM = 0.3  # speed times contact time over diameter from which a grain skims the crests

# The free choices of all of them: one design, so that they share their runs. Each takes the factors that
# touch its claims; k_n, torque law and Re are no choice of all.
DESIGN = design("saltation")
SHARED = (PHI, SLIP, PARTING, RATIO, DRAG, CLOSURE, START)
SHIPPED = {name: DESIGN.base[name] for name in SHARED}
# Series over stiffness of the figures, the case as it ships; it judges nothing.
SERIES = (SOFT, "10 N/cm", STIFF, "1000 N/cm")
FULL_SERIES = ("0.3 N/cm", SOFT, "3 N/cm", "10 N/cm", "30 N/cm", STIFF, "300 N/cm", "1000 N/cm")
TANGENTIAL, NORMAL = "tangential", "normal"


@dataclass(frozen=True)
class SaltationRun:
    """Hops of one run, and the path of its first start after settling.

    Attributes
    ----------
    found : all hops and their averages.
    path : of the first start, a second of it.
    d : diameter [m].
    overlap : largest overlap of a bounce over the diameter, mean [-].
    highest : highest jump [m].
    turning : u**2 t/(d v) of every lone bed contact [-].
    shortened : its contact time over damped Eq. (8) [-].
    impact : its normal impulse over mass (added mass included) times closing speed, mean [-].
    spreads : half the range that holds the middle 68 % of restitutions of lone bed contacts [-].
    """

    found: Saltation
    path: Tracks
    d: float
    overlap: float
    highest: float
    turning: Floats
    shortened: Floats
    impact: float
    spreads: Mapping[str, float]

    @property
    def travel(self) -> float:
        """Speed times contact time over diameter, u t/d [-]."""
        return self.found["speed"].value * self.found.times.damped / self.d

    def value(self, name: str) -> float:
        """One average by name, or "highest" and "impact"."""
        own = {"highest": self.highest, "impact": self.impact}
        return own[name] if name in own else self.found[name].value


Group = Sequence[SaltationRun]  # the runs of one setting, by seed


def settings(plan: Plan, *more: str) -> list[dict[str, str]]:
    """Sets of the shared choices and of those named; the shipped one first."""
    names = (*SHARED, *more)
    sets = [{name: one[name] for name in names} for one in DESIGN.sets(plan)]
    return list({tuple(one.items()): one for one in sets}.values())


def run(
    chosen: Mapping[str, str], rotation: str, seed: int, more: Mapping[str, str] | None = None
) -> CaseRun:
    """One run of the case under a set of choices."""
    return paper_run(
        CASE, {**MANY, **DESIGN.overrides(chosen), "motion.rotation": rotation, **(more or {})}, seed
    )


def series(plan: Plan) -> dict[str, dict[str, str]]:
    """Keys of the case, by stiffness, of a series for the figures, soft to stiff."""
    names = plan.pick((SOFT, STIFF), SERIES, FULL_SERIES)
    return {one: {} if one == STIFF else {"contact.stiffness": one} for one in names}


def stiffness(words: str) -> float:
    """Return "100 N/cm" as 10000 N/m."""
    return 100.0 * float(words.split(maxsplit=1)[0])


@lru_cache(maxsize=2)
def hops(results: Results) -> SaltationRun:
    """Measure one run; several experiments ask for the same numbers."""
    found = saltation(results, hops=HOPS)
    begin = float(found.hops["t_begin"][0]) if len(found.hops) else 0.0
    scene = results.scene
    d = float(scene.d[0])
    touch = collisions(results, "bed")
    lone = np.isfinite(touch.restitution)
    momentum = (scene.m + scene.m_added)[touch.events["i"][lone]] * touch.speed[lone]
    return SaltationRun(
        found,
        tracks(results, [0], begin, begin + 1.0),
        d,
        overlap=float(found.bounces["overlap"].mean()) / d if len(found.bounces) else math.nan,
        highest=float(found.hops["rise"].max()) if len(found.hops) else math.nan,
        turning=touch.turning[lone],
        shortened=(touch.duration / touch.expected)[lone],
        impact=float((touch.events["impulse_n"][lone] / momentum).mean()) if lone.any() else math.nan,
        spreads={TANGENTIAL: spread(touch.restitution_s), NORMAL: spread(touch.restitution)},
    )


def measure(results: Results, one: CaseRun) -> SaltationRun:
    """Hops of all starts."""
    del one
    return hops(results)


def spread(values: Floats) -> float:
    """Half the range that holds the middle 68 % of the finite values; of a normal distribution its deviation.

    >>> round(spread(np.array([0.0, 1.0, 2.0, 3.0, 4.0, np.nan])), 2)
    1.36
    """
    kept = values[np.isfinite(values)]
    if len(kept) == 0:
        return math.nan
    low, high = np.percentile(kept, [16.0, 84.0])
    return 0.5 * float(high - low)


def whole_path(results: Results) -> Tracks:
    """Path of the first start from its first counted hop to its last."""
    mine = hops(results).found.hops
    mine = mine[mine["grain"] == 0]
    begin, end = (float(mine["t_begin"][0]), float(mine["t_end"][-1])) if len(mine) else (0.0, math.inf)
    return tracks(results, [0], begin, end)


def trials(
    claim: str,
    part: str,
    sets: Sequence[Mapping[str, str]],
    values: Sequence[Sequence[float]],
    skims: Sequence[bool] | None = None,
) -> list[Trial]:
    """One part of a claim under every setting, judged by its registered band.

    Parameters
    ----------
    claim, part : as they are registered.
    sets : settings, the shipped one first.
    values : one number per seed, by setting.
    skims : whether the grain skims the crests, by setting; it hops in all if this is left out.
    """
    spreads = pooled(values, skims or [False] * len(sets))
    return [
        seeds_trial(part, one, here, band(claim, part), of)
        for one, here, of in zip(sets, values, spreads, strict=True)
    ]


def pooled(groups: Sequence[Sequence[float]], skims: Sequence[bool]) -> list[Pooled | None]:
    """Spread for every setting: pooled over those whose grain skims the crests, and over those that hop.

    A grain that skims touches for as long as it happens to; its scatter says nothing about the others.
    """
    kinds = {
        one: pool([g for g, skim in zip(groups, skims, strict=True) if skim is one]) for one in set(skims)
    }
    return [kinds[one] for one in skims]


def skimming(runs: Group) -> bool:
    """Whether the grains of a setting skim the crests."""
    return float(np.mean([one.travel for one in runs])) > SKIM


def skims_below(sweep: Mapping[str, Group]) -> float:
    """Smallest stiffness of a series at which the grain does not skim [N/m]; 0 if there is none."""
    return min((stiffness(k) for k, here in sweep.items() if not skimming(here)), default=0.0)


def ratios(above: Group, below: Group, name: str) -> list[float]:
    """One average over that of other runs, by seed."""
    return [one.value(name) / other.value(name) for one, other in zip(above, below, strict=True)]


def ratio(above: Group, below: Group, name: str) -> Interval:
    """Mean over seeds of one average over that of other runs."""
    return over_seeds(ratios(above, below, name), "-")


def mean(runs: Group, name: str, unit: str) -> Interval:
    """Mean of one average over the seeds."""
    return over_seeds([one.value(name) for one in runs], unit)


def listed(numbers: Mapping[str, object]) -> str:
    """Write numbers by setting: "0.3 at 1 N/cm, 0.1 at 10 N/cm"."""
    return ", ".join(f"{value} at {name}" for name, value in numbers.items())
