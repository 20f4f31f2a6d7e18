"""What the saltation experiments (fig7, spin-time, hops, fig20, fig21, eq13) share: case and choices."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ryusa.measure import Saltation, Tracks, collisions, saltation, tracks
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.studies.osada2004._parts import PHI, RATIO, SLIP, CaseRun, Plan, paper_run
from ryusa.study import Pooled, pool

CASE = "saltation"
HOPS = 30  # of each start, as in the paper
K_N = "k_n"  # a choice of fig7 and spin-time only
SHIPPED = {PHI: "30 deg", SLIP: "spring", RATIO: "2/7"}
STIFF = "100 N/cm"  # as the case ships
KEYS = {
    PHI: "contact.friction_angle",
    SLIP: "contact.slip",
    RATIO: "contact.shear_ratio",
    K_N: "contact.stiffness",
}
VALUES = {"2/7": "0.2857", "15/200": "0.075"}  # ratios as the case file takes them
PHIS = ("10 deg", "15 deg", "20 deg", "25 deg", "30 deg", "35 deg", "40 deg")
WEAK = ((SLIP, "spring-drop", "10 deg"), (SLIP, "total", "10 deg"))
STIFFNESSES = (
    "0.3 N/cm", "1 N/cm", "3 N/cm", "10 N/cm", "30 N/cm", "100 N/cm", "300 N/cm", "1000 N/cm",
)  # fmt: skip
SKIM = 0.3  # speed times contact time over diameter from which a grain skims the crests
# 8 starts of 30 hops leave 7 % on a mean height, 48 leave 3 %; starts are cheap, frames in between are not
WIDE = {"build.starts": "48", "record.frames": "5 ms"}


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
    """

    found: Saltation
    path: Tracks
    d: float
    overlap: float
    highest: float
    turning: Floats
    shortened: Floats

    @property
    def travel(self) -> float:
        """Speed times contact time over diameter, u t/d [-]."""
        return self.found["speed"].value * self.found.times.damped / self.d

    def value(self, name: str) -> float:
        """One average by name; "highest" is the highest jump."""
        return self.highest if name == "highest" else self.found[name].value


def choices(plan: Plan) -> list[dict[str, str]]:
    """Sets of free choices tried, the shipped one first: one changed at a time, weak shear; full: a grid."""
    phis = plan.pick(("30 deg",), ("10 deg", "20 deg", "30 deg", "40 deg"), PHIS)
    if plan.level == "full":
        sets = [
            {PHI: phi, SLIP: slip, RATIO: ratio}
            for slip in ("spring", "spring-drop", "total")
            for ratio in ("2/7", "15/200")
            for phi in phis
        ]
    else:
        sets = [{**SHIPPED, PHI: phi} for phi in phis]
        if plan.level == "standard":
            sets += [
                {**SHIPPED, SLIP: "spring-drop"},
                {**SHIPPED, SLIP: "total"},
                {**SHIPPED, RATIO: "15/200"},
                *({**SHIPPED, name: value, PHI: phi} for name, value, phi in WEAK),
            ]
    return [SHIPPED, *(one for one in sets if one != SHIPPED)]


def with_stiffness(plan: Plan) -> list[dict[str, str]]:
    """Sets of choices with the stiffness: the shipped set at every k_n, the others at 100 N/cm."""
    sweep = plan.pick((), tuple(k for k in STIFFNESSES if k != STIFF))
    return [
        {**SHIPPED, K_N: STIFF},
        *({**SHIPPED, K_N: k} for k in sweep),
        *({**one, K_N: STIFF} for one in choices(plan)[1:]),
    ]


def overrides(chosen: Mapping[str, str]) -> dict[str, str]:
    """Keys of the case that a set of choices changes; none for the shipped one."""
    shipped = {**SHIPPED, K_N: STIFF}
    return {
        KEYS[name]: VALUES.get(value, value)
        for name, value in chosen.items()
        if name in KEYS and shipped[name] != value
    }


def run(
    chosen: Mapping[str, str], rotation: str, seed: int, more: Mapping[str, str] | None = None
) -> CaseRun:
    """One run of the case under a set of choices."""
    return paper_run(CASE, {**overrides(chosen), "motion.rotation": rotation, **(more or {})}, seed)


def sweep_run(chosen: Mapping[str, str], seed: int) -> CaseRun:
    """Locked run of a sweep over stiffness: with many starts where only the stiffness is changed."""
    only_k = all(chosen[name] == value for name, value in SHIPPED.items())
    return run(chosen, "locked", seed, WIDE if only_k else None)


def softest(sets: Sequence[Mapping[str, str]]) -> list[str]:
    """Stiffnesses of some sets, soft to stiff."""
    return sorted({one[K_N] for one in sets}, key=stiffness)


def stiffness(words: str) -> float:
    """Return "100 N/cm" as 10000 N/m."""
    return 100.0 * float(words.split(maxsplit=1)[0])


@lru_cache(maxsize=2)
def hops(results: Results) -> SaltationRun:
    """Measure one run; several experiments ask for the same numbers."""
    found = saltation(results, hops=HOPS)
    begin = float(found.hops["t_begin"][0]) if len(found.hops) else 0.0
    d = float(results.scene.d[0])
    touch = collisions(results, "bed")
    lone = np.isfinite(touch.restitution)
    return SaltationRun(
        found,
        tracks(results, [0], begin, begin + 1.0),
        d,
        overlap=float(found.bounces["overlap"].mean()) / d if len(found.bounces) else math.nan,
        highest=float(found.hops["rise"].max()) if len(found.hops) else math.nan,
        turning=touch.turning[lone],
        shortened=(touch.duration / touch.expected)[lone],
    )


def whole_path(results: Results) -> Tracks:
    """Path of the first start from its first counted hop to its last."""
    mine = hops(results).found.hops
    mine = mine[mine["grain"] == 0]
    begin, end = (float(mine["t_begin"][0]), float(mine["t_end"][-1])) if len(mine) else (0.0, math.inf)
    return tracks(results, [0], begin, end)


def pooled(groups: Sequence[Sequence[float]], skims: Sequence[bool]) -> list[Pooled | None]:
    """Spread for every setting: pooled over those whose grain skims the crests, and over those that hop.

    A grain that skims touches for as long as it happens to; its scatter says nothing about the others.
    """
    kinds = {
        one: pool([g for g, skim in zip(groups, skims, strict=True) if skim is one]) for one in set(skims)
    }
    return [kinds[one] for one in skims]


def listed(numbers: Mapping[str, float], form: str = ".3g") -> str:
    """Write numbers by setting: "0.3 at 1 N/cm, 0.1 at 10 N/cm"."""
    return ", ".join(f"{value:{form}} at {name}" for name, value in numbers.items())
