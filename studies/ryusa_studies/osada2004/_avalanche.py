"""What the avalanche experiments (fig14, fig15, fig16) share: case, choices, windows, pairs of runs."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ryusa.measure import Profiles, Tracks, alternating, paths, profiles, tracks
from ryusa.measure.stability import BAND
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.study import Band, Trial, over_seeds, pseudo_values, seeds_trial
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._parts import (
    PARTING,
    PHI,
    RATIO,
    ROTATION,
    CaseRun,
    Found,
    Plan,
    paper_run,
)
from ryusa_studies.osada2004._shares import halves

CASE = "avalanche"
TILT = 1.0  # of the case's timeline [s]
FRAME = 0.01  # between the case's frames [s]
GRAVITY = 9.8  # [m/s2]
SLOPE = math.radians(40.0)
LAYERS = 10  # of grains
BELOW = 2  # neighbours that a grain rests on
SOFT, STIFF = "0.01 s", "0.0001 s"  # collision times, Eq. (8)
TIMES = (SOFT, STIFF)
WINDOW = "time after tilting"
WINDOWS = {"1 to 2 s": (1.0, 2.0), "2 to 3 s": (2.0, 3.0)}
FIRST = "1 to 2 s"
DESIGN = design("avalanche")
SHIPPED = DESIGN.base
BETWEEN, ALL = "between bed and movers", "all"  # grains whose ways are compared
FINE = 0.001  # vertical excursion, in diameters, from which the finest turns count
UNITS = {
    "fine": "fine_reversals_per_s",
    "reversals": "reversals_per_s",
    "per_metre": "reversals_per_m",
    "advance": "advance_m",
    "jaggedness": "jaggedness",
}
FLOW_PART = "mean speed over sqrt(g d), the slower of the two"
FLOWS = band("fig14", FLOW_PART)
SPARSE, THIN = 0.05, 0.1  # concentrations: a layer of the flow; a layer whose mean speed is worth comparing


@dataclass(frozen=True)
class Ways:
    """Ways of some grains in one window; nan where there are none or none advances.

    Attributes
    ----------
    n : grains.
    reversals, fine : turns of the vertical motion per second, from 0.02 d and from 0.001 d on [1/s].
    per_metre : turns from 0.02 d on of all of them over the sum of their advances [1/m].
    advance : way along the bed [m].
    jaggedness : sum of their vertical ways over that of their advances [-].
    """

    n: int
    reversals: float
    fine: float
    per_metre: float
    advance: float
    jaggedness: float


@dataclass(frozen=True)
class Window:
    """One run in one window of time.

    Attributes
    ----------
    profile : means over height; z from the crest of the bed.
    ways : how grains went, by GRAINS.
    path : ways of two grains that meet bed and movers in turn.
    rate : contacts of a grain per second [1/s].
    touching : how many partners it touches, mean over time [-].
    bed_in_band, in_band : share of the contacts with the bed, and of all, whose largest overlap is in the
        stable band [-].
    """

    profile: Profiles
    ways: Mapping[str, Ways]
    path: Tracks
    rate: float
    touching: float
    bed_in_band: float
    in_band: float

    @property
    def speed(self) -> float:
        """Speed of all grains, mean over time [m/s]."""
        return float(self.profile.speed.mean())

    @property
    def q(self) -> float:
        """Flux over the whole depth per unit width [m2/s]."""
        return float(self.profile.q.mean())


Avalanche = Mapping[str, Window]  # by name of the window


@dataclass(frozen=True)
class RunPair:
    """The run with the long and that with the short collision time, same seed, choices and window."""

    soft: Window
    stiff: Window

    @property
    def slower(self) -> float:
        """Speed of the slower run over sqrt(g d) [-]."""
        return min(self.soft.speed, self.stiff.speed) / math.sqrt(GRAVITY * self.soft.profile.d)

    @property
    def flows(self) -> bool:
        """Whether both are avalanches."""
        return self.slower > FLOWS.low


Numbers = Callable[[Sequence[RunPair]], float]  # of the pairs of one setting and window together


def each(value: Callable[[RunPair], float]) -> Numbers:
    """Mean of a number of every pair by itself."""
    return lambda found: float(np.mean([value(pair) for pair in found]))


def layers(found: Sequence[RunPair]) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Concentration and speed of the soft runs, and of the stiff ones, on common layers; 0 where is none.

    Means over pairs; the speed is weighted with concentration [m/s].
    """
    runs = [[pair.soft.profile for pair in found], [pair.stiff.profile for pair in found]]
    low, size = _places([one for half in runs for one in half])
    means: list[tuple[Floats, Floats]] = []
    for half in runs:
        phi, flux = np.zeros((2, size))
        for one in half:
            n = _numbers(one)
            phi[n - low] += np.nan_to_num(one.phi.value) / len(half)
            flux[n - low] += np.nan_to_num(one.phi.value * one.v_x.value) / len(half)
        means.append((phi, np.divide(flux, phi, out=np.zeros_like(flux), where=phi > 0.0)))
    return means[0], means[1]


def unlike(found: Sequence[RunPair]) -> float:
    """Mean difference of concentration over mean concentration of the layers of the flow [-]."""
    (soft, _), (stiff, _) = layers(found)
    there = np.maximum(soft, stiff) > SPARSE
    return float(np.abs(soft - stiff)[there].mean() / (0.5 * (soft + stiff)[there]).mean())


def faster(found: Sequence[RunPair]) -> Floats:
    """Speed of the soft runs less that of the stiff ones in every layer that both fill [m/s]."""
    (phi_soft, soft), (phi_stiff, stiff) = layers(found)
    return (soft - stiff)[np.minimum(phi_soft, phi_stiff) > THIN]


def faster_by_layer(found: Sequence[RunPair]) -> Floats:
    """Return `faster` of each pair in the layers that all of them fill, shape (pair, layer) [m/s]."""
    low, n = _places([half.profile for pair in found for half in (pair.soft, pair.stiff)])
    rows, filled = np.zeros((len(found), n)), np.full(n, fill_value=True)
    for row, pair in zip(rows, found, strict=True):
        phi, v = np.zeros((2, 2, n))
        for k, one in enumerate((pair.soft.profile, pair.stiff.profile)):
            at = _numbers(one) - low
            phi[k, at], v[k, at] = np.nan_to_num(one.phi.value), np.nan_to_num(one.v_x.value)
        row[:] = v[0] - v[1]
        filled &= phi.min(axis=0) > THIN
    return rows[:, filled]


def _numbers(one: Profiles) -> NDArray[np.int64]:
    """Numbers of its layers, counted from the crest of the bed."""
    return np.rint(one.z / one.thickness - 0.5).astype(np.int64)


def _places(runs: Sequence[Profiles]) -> tuple[int, int]:
    """Lowest layer of all runs, and how many there are up to the highest."""
    low = min(int(_numbers(one)[0]) for one in runs)
    return low, max(int(_numbers(one)[-1]) for one in runs) - low + 1


settings = DESIGN.sets


def run(chosen: Mapping[str, str], time: str, seed: int) -> CaseRun:
    """One run of the case, with the contacts of all grains; what is as shipped is not said."""
    changed = {**DESIGN.overrides(chosen), "record.events": "all"}
    if time != SOFT:
        changed["contact.stiffness"] = f'{{ collision_time = "{time}" }}'
    return paper_run(CASE, changed, seed)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Both collision times for every setting and seed."""
    return [run(one, time, seed) for one in settings(plan) for seed in plan.seeds for time in TIMES]


@lru_cache(maxsize=2)
def measure(results: Results, one: CaseRun) -> Avalanche:
    """Profiles and ways in every window of one run; three experiments ask for the same numbers."""
    del one
    return {name: _window(results, TILT + begin, TILT + end) for name, (begin, end) in WINDOWS.items()}


def _window(results: Results, begin: float, end: float) -> Window:
    turning = [int(g) for g in alternating(results, begin, end).grains]
    middle = max(len(turning) // 2 - 1, 0)  # neither the most nor the least restless ones are shown
    return Window(
        profiles(results, begin, end, above="bed crest", bed=True),
        {
            BETWEEN: _ways(results, begin, end, turning),
            ALL: _ways(results, begin, end, range(results.scene.n_grain)),
        },
        _together(tracks(results, turning[middle : middle + 2], begin, end)),
        *_contacts(results, begin, end),
    )


def _contacts(results: Results, begin: float, end: float) -> tuple[float, float, float, float]:
    """Contacts per second and partners touched at a time of a grain; shares in the band, bed and all."""
    found = results.contacts
    found = found[(found["t_part"] > begin) & (found["t_begin"] < end)]
    n = results.scene.n_grain  # fixed grains follow the free ones
    bed = np.maximum(found["i"], found["j"]) >= n
    grains = np.where(bed, 1, 2)
    time = np.minimum(found["t_part"], end) - np.maximum(found["t_begin"], begin)
    whole = n * (end - begin)
    overlap = found["overlap_max"] / results.scene.d.mean()
    inside = (overlap > BAND[0]) & (overlap < BAND[1])
    return (
        float(grains.sum()) / whole,
        float((grains * time).sum()) / whole,
        _share(inside[bed]),
        _share(inside),
    )


def _share(inside: NDArray[np.bool_]) -> float:
    return float(inside.mean()) if len(inside) else math.nan


def _ways(results: Results, begin: float, end: float, grains: Sequence[int]) -> Ways:
    early = begin - 1.5 * FRAME  # frames come with a step, not at the edges; so a whole window always fits in
    found = paths(results, early, end, end - begin, grains=grains)
    advance = float(found.advance.sum())
    if not len(grains) or advance <= 0.0:
        return Ways(len(grains), *5 * [math.nan])
    fine = paths(results, early, end, end - begin, grains=grains, threshold=FINE)
    return Ways(
        len(grains),
        float(found.reversals.mean()),
        float(fine.reversals.mean()),
        float(found.reversals.sum()) * (end - begin) / advance,
        float(found.advance.mean()),
        float(found.way_z.sum()) / advance,
    )


def _together(path: Tracks) -> Tracks:
    """Shift ways by whole periods, so that all start within the first one."""
    return replace(path, x=path.x - np.floor(path.x[:1] / path.period) * path.period)


def pairs(found: Found, plan: Plan, chosen: Mapping[str, str], window: str) -> list[RunPair]:
    """Pairs of runs of one setting, by seed."""
    return [RunPair(*(found[run(chosen, time, seed)][window] for time in TIMES)) for seed in plan.seeds]


def sets(plan: Plan) -> list[tuple[dict[str, str], str]]:
    """Every setting in every window, the shipped one in the first window first."""
    return [(one, window) for window in WINDOWS for one in settings(plan)]


Judged = Callable[[str, Mapping[str, str], Sequence[RunPair], Band], Trial]  # part, choices, pairs, band


def apart(value: Callable[[RunPair], float]) -> Judged:
    """Judge the mean over seeds of a number that every pair has by itself."""
    return lambda part, chosen, found, limits: seeds_trial(
        part, chosen, [value(pair) for pair in found], limits
    )


def together(value: Numbers) -> Judged:
    """Judge what all pairs give together, such as the difference of their mean profiles, by its jackknife.

    Profiles of single runs differ by 5 to 10 % from seed to seed alone; the mean of such differences measures
    that scatter rather than what the collision time does. A seed without a number (no grain advances in one
    run) is left out where most have one.
    """

    def judged(part: str, chosen: Mapping[str, str], found: Sequence[RunPair], limits: Band) -> Trial:
        kept = [pair for pair in found if math.isfinite(value([pair]))]
        kept = kept if 2 * len(kept) > len(found) else found
        spread = over_seeds(pseudo_values(value, kept), limits.unit)
        how = f"jackknife, {spread.how}" if spread.n > 1 else spread.how
        return Trial(part, chosen, replace(spread, how=how), limits, halves=halves(kept, value, limits))

    return judged


def trials(found: Found, plan: Plan, part: str, judged: Judged, limits: Band) -> list[Trial]:
    """One part of a claim under every setting and in every window.

    No spread is pooled: settings in which a run creeps or sticks to the bed scatter unlike those that flow.
    """
    return [
        judged(part, {**one, WINDOW: window}, pairs(found, plan, one, window), limits)
        for one, window in sets(plan)
    ]


def flows(found: Found, plan: Plan) -> list[Trial]:
    """Both runs must be avalanches: two heaps at rest have the same profile and prove nothing."""
    return trials(found, plan, FLOW_PART, apart(lambda pair: pair.slower), FLOWS)


def mean(found: Found, plan: Plan, chosen: Mapping[str, str], window: str, numbers: Numbers) -> float:
    """Number of all seeds that decides nothing."""
    return numbers(pairs(found, plan, chosen, window))


def creep(chosen: Mapping[str, str], time: str) -> float:
    """Mean speed at which dashpots alone hold layers in lasting contact [m/s].

    A dashpot that friction does not cap drags like a viscous liquid: layer k of n carries the weight along
    the slope of n + 1 - k layers on its contacts, slides at (n + 1 - k) m g sin(theta)/(2 eta_s), and the
    mean over the layers of the sums of these is (n + 1)(2 n + 1)/6 times m g sin(theta)/(2 eta_s).
    """
    from ryusa.casefile.derive import derive

    found = derive(run(chosen, time, 1).read())
    weight = found.m_weight * GRAVITY * math.sin(SLOPE)
    return (LAYERS + 1) * (2 * LAYERS + 1) / 6.0 * weight / (BELOW * found.free.eta_s)


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run and window."""
    return [
        {
            **chosen, "collision time": time, "seed": seed, WINDOW: window,
            "speed_m_per_s": one.speed, "q_m2_per_s": one.q, "top_m": one.profile.top(),
            "contacts_per_s": one.rate,
            "touching": one.touching,
            "bed_in_band": one.bed_in_band, "in_band": one.in_band,
            "grains between bed and movers": one.ways[BETWEEN].n,
            **{
                f"{what}, {grains}": getattr(ways, name)
                for grains, ways in one.ways.items()
                for name, what in UNITS.items()
            },
        }
        for chosen, window in sets(plan)
        for seed in plan.seeds
        for time in TIMES
        for one in [found[run(chosen, time, seed)][window]]
    ]  # fmt: skip


def label(chosen: Mapping[str, str]) -> str:
    """Words for a set of choices."""
    changed = [
        f"{name} {value}" if name in (PHI, ROTATION, PARTING, RATIO) else value
        for name, value in chosen.items()
        if value != SHIPPED[name]
    ]
    return ", ".join(changed) or "as shipped"
