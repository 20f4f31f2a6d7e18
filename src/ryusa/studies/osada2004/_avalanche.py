"""What the avalanche experiments (fig14, fig15, fig16) share: case, choices, windows, pairs of runs."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ryusa.measure import Profiles, Tracks, alternating, paths, profiles, tracks
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.studies.osada2004._parts import PHI, ROTATION, SLIP, CaseRun, Found, Plan, paper_run
from ryusa.study import Band, Trial, over_seeds, pool, pseudo_values

CASE = "avalanche"
TILT = 1.0  # of the case's timeline [s]
FRAME = 0.01  # between the case's frames [s]
GRAVITY = 9.8  # [m/s2]
SLOPE = math.radians(40.0)
LAYERS, LOWEST = 10, 20  # layers of grains, and grains in the lowest one
BELOW = 2  # neighbours that a grain rests on
SOFT, STIFF = "0.01 s", "0.0001 s"  # collision times, Eq. (8)
TIMES = (SOFT, STIFF)
WINDOW = "time after tilting"
WINDOWS = {"1 to 2 s": (1.0, 2.0), "2 to 3 s": (2.0, 3.0)}
FIRST = "1 to 2 s"
PACKING = "packing"  # the choice of sizes, bed and depth
AS_SHIPPED = "as shipped"
OTHERS: dict[str, dict[str, str]] = {
    "sizes within 10 %": {"grains.spread": "0.1"},
    "random bed": {"build.bed": "random"},
    "twice as deep": {"build.layers": "20"},
}
SHIPPED = {ROTATION: "free", PHI: "30 deg", SLIP: "spring", PACKING: AS_SHIPPED}
KEYS = {ROTATION: "motion.rotation", PHI: "contact.friction_angle", SLIP: "contact.slip"}
SETTLED = {
    "d": "20 cm",
    "slope": "40 deg",
    "restitution": "0.7",
    "packing as shipped": "equal grains, 10 layers over a flat bed of grains",
}
BETWEEN, ALL = "between bed and movers", "all"  # grains whose ways are compared
FINE = 0.001  # vertical excursion, in diameters, from which the finest turns count
UNITS = {
    "fine": "fine_reversals_per_s",
    "reversals": "reversals_per_s",
    "advance": "advance_m",
    "jaggedness": "jaggedness",
}
FLOWS = Band(0.1, math.inf, "-", "both are avalanches: speed over sqrt(g d) above 0.1 in the slower one")
FLOW_PART = "mean speed over sqrt(g d), the slower of the two"
KINDS = ("creeps", "stuck", "moves")  # of pairs of runs; a setting is of the first kind that a pair of it is
STARTS = 6  # runs of the shipped setting per seed: 18 leave 25 of the 100 cm/s of fig15, 9 leave 40
SECOND = 100_000  # from one seed to the next start
MANY = 9  # seeds from which on a spread is not pooled
SPARSE, THIN = 0.05, 0.1  # concentrations: a layer of the flow; a layer whose mean speed is worth comparing


@dataclass(frozen=True)
class Ways:
    """Ways of some grains in one window; nan where there are none or none advances.

    Attributes
    ----------
    n : grains.
    reversals, fine : turns of the vertical motion per second, from 0.02 d and from 0.001 d on [1/s].
    advance : way along the bed [m].
    jaggedness : sum of their vertical ways over that of their advances [-].
    """

    n: int
    reversals: float
    fine: float
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
    rate : contacts of a grain of the lowest layer per second [1/s].
    touching : how many partners it touches, mean over time [-].
    """

    profile: Profiles
    ways: Mapping[str, Ways]
    path: Tracks
    rate: float
    touching: float

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
    def kind(self) -> str:
        """How it scatters: a pair that creeps, one with a lowest layer stuck in the bed, one that moves."""
        soft, stiff = self.soft.profile, self.stiff.profile
        least = FLOWS.low * math.sqrt(GRAVITY * soft.d)
        lowest = min(float(one.v_x.value[one.z > 0.0][0]) for one in (soft, stiff))
        if min(self.soft.speed, self.stiff.speed) < least:
            return "creeps"
        return "stuck" if lowest < least else "moves"


Numbers = Callable[[Sequence[RunPair]], list[float]]  # of the pairs of one setting and window: one per seed


def each(value: Callable[[RunPair], float]) -> Numbers:
    """Take a number from every pair by itself."""
    return lambda found: [value(pair) for pair in found]


def together(value: Callable[[Sequence[RunPair]], float]) -> Numbers:
    """Take a number from what all pairs give together, such as the difference of their mean profiles.

    Profiles of single runs differ by 5 to 10 % from seed to seed alone; the mean of such differences, or the
    mean of the least of many layers, measures that scatter rather than what the collision time does.
    """
    return lambda found: pseudo_values(value, found)


def layers(found: Sequence[RunPair]) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Concentration and speed of the soft runs, and of the stiff ones, on common layers; 0 where is none.

    Means over pairs; the speed is weighted with concentration [m/s].
    """
    runs = [[pair.soft.profile for pair in found], [pair.stiff.profile for pair in found]]
    numbers = [[np.rint(one.z / one.thickness - 0.5).astype(np.int64) for one in half] for half in runs]
    low = min(int(n[0]) for half in numbers for n in half)
    high = max(int(n[-1]) for half in numbers for n in half)
    means: list[tuple[Floats, Floats]] = []
    for half, places in zip(runs, numbers, strict=True):
        phi, flux = np.zeros((2, high - low + 1))
        for one, n in zip(half, places, strict=True):
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


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of free choices, the shipped one first."""
    if plan.level == "full":
        sets = [
            {**SHIPPED, ROTATION: rotation, PHI: phi, SLIP: slip}
            for rotation in ("free", "locked")
            for slip in ("spring", "spring-drop", "total")
            for phi in ("10 deg", "20 deg", "30 deg", "40 deg")
        ]
        sets += [{**SHIPPED, PACKING: one} for one in OTHERS]
    else:
        sets = [
            {**SHIPPED, ROTATION: rotation, PHI: phi, SLIP: slip}
            for rotation, phi, slip in plan.pick(
                (),
                (
                    ("free", "20 deg", "spring"),
                    ("free", "30 deg", "total"),
                    ("locked", "20 deg", "spring"),
                    ("locked", "10 deg", "total"),
                    ("locked", "20 deg", "total"),
                ),
            )
        ]
    return [SHIPPED, *(one for one in sets if one != SHIPPED)]


def run(chosen: Mapping[str, str], time: str, seed: int) -> CaseRun:
    """One run of the case; what is as shipped is not said."""
    changed = {KEYS[name]: value for name, value in chosen.items() if name in KEYS and SHIPPED[name] != value}
    changed |= OTHERS.get(chosen[PACKING], {})
    if time != SOFT:
        changed["contact.stiffness"] = f'{{ collision_time = "{time}" }}'
    return paper_run(CASE, changed, seed)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Both collision times for every setting and seed."""
    return [run(one, time, seed) for one in settings(plan) for seed in seeds(plan, one) for time in TIMES]


def seeds(plan: Plan, chosen: Mapping[str, str]) -> list[int]:
    """Seeds of a setting; the shipped one gets several for each of the plan, for 200 grains scatter much."""
    many = plan.pick(1, STARTS) if chosen == SHIPPED else 1
    return [seed + SECOND * k for k in range(many) for seed in plan.seeds]


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


def _contacts(results: Results, begin: float, end: float) -> tuple[float, float]:
    """Contacts per second, and partners touched at a time, of a grain of the lowest layer."""
    found = results.contacts
    found = found[(found["t_part"] > begin) & (found["t_begin"] < end)]
    grains = (found["i"] < LOWEST).astype(np.int64) + (found["j"] < LOWEST)
    time = np.minimum(found["t_part"], end) - np.maximum(found["t_begin"], begin)
    whole = LOWEST * (end - begin)
    return float(grains.sum()) / whole, float((grains * time).sum()) / whole


def _ways(results: Results, begin: float, end: float, grains: Sequence[int]) -> Ways:
    early = begin - 1.5 * FRAME  # frames come with a step, not at the edges; so a whole window always fits in
    found = paths(results, early, end, end - begin, grains=grains)
    advance = float(found.advance.sum())
    if not len(grains) or advance <= 0.0:
        return Ways(len(grains), math.nan, math.nan, math.nan, math.nan)
    fine = paths(results, early, end, end - begin, grains=grains, threshold=FINE)
    return Ways(
        len(grains),
        float(found.reversals.mean()),
        float(fine.reversals.mean()),
        float(found.advance.mean()),
        float(found.way_z.sum()) / advance,
    )


def _together(path: Tracks) -> Tracks:
    """Shift ways by whole periods, so that all start within the first one."""
    return replace(path, x=path.x - np.floor(path.x[:1] / path.period) * path.period)


def pairs(found: Found, plan: Plan, chosen: Mapping[str, str], window: str) -> list[RunPair]:
    """Pairs of runs of one setting, by seed."""
    return [
        RunPair(*(found[run(chosen, time, seed)][window] for time in TIMES)) for seed in seeds(plan, chosen)
    ]


def sets(plan: Plan) -> list[tuple[dict[str, str], str]]:
    """Every setting in every window, the shipped one in the first window first."""
    return [(one, window) for window in WINDOWS for one in settings(plan)]


def trials(found: Found, plan: Plan, part: str, numbers: Numbers, band: Band) -> list[Trial]:
    """One part of a claim under every setting and in every window.

    The spread between seeds is pooled over the settings of the same rotation and window, apart for those in
    which a run creeps (ratios of almost nothing) and those in which the lowest layer of a run stays in the
    pockets of the bed: whether it does is chance, and shifts the speed of all layers above. A setting of
    many seeds speaks for itself. A seed without a number is left out where most have one.
    """
    every = {(tuple(one.values()), w): pairs(found, plan, one, w) for one, w in sets(plan)}
    groups = {key: _numbers(numbers(of_key)) for key, of_key in every.items()}
    kinds = {
        key: (key[0][0], key[1], min((pair.kind for pair in of_key), key=KINDS.index))
        for key, of_key in every.items()
    }
    spread = {
        kind: pool([groups[key] for key, other in kinds.items() if other == kind])
        for kind in set(kinds.values())
    }
    return [
        Trial(
            part,
            {**one, WINDOW: window},
            over_seeds(groups[key], band.unit, spread[kinds[key]] if len(groups[key]) < MANY else None),
            band,
        )
        for one, window in sets(plan)
        for key in [(tuple(one.values()), window)]
    ]


def _numbers(values: list[float]) -> list[float]:
    """Leave out seeds without a number (no grain advances in one run), where most seeds have one."""
    kept = [value for value in values if math.isfinite(value)]
    return kept if 2 * len(kept) > len(values) else values


def flows(found: Found, plan: Plan) -> list[Trial]:
    """Both runs must be avalanches: two heaps at rest have the same profile and prove nothing."""
    return trials(found, plan, FLOW_PART, each(lambda pair: pair.slower), FLOWS)


def mean(found: Found, plan: Plan, chosen: Mapping[str, str], window: str, numbers: Numbers) -> float:
    """Mean over seeds of a number that decides nothing."""
    return float(np.mean(numbers(pairs(found, plan, chosen, window))))


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
            "grains between bed and movers": one.ways[BETWEEN].n,
            **{
                f"{what}, {grains}": getattr(ways, name)
                for grains, ways in one.ways.items()
                for name, what in UNITS.items()
            },
        }
        for chosen, window in sets(plan)
        for seed in seeds(plan, chosen)
        for time in TIMES
        for one in [found[run(chosen, time, seed)][window]]
    ]  # fmt: skip


def label(chosen: Mapping[str, str]) -> str:
    """Words for a set of choices."""
    slip = "" if chosen[SLIP] == "spring" else f", {chosen[SLIP]}"
    packing = "" if chosen[PACKING] == AS_SHIPPED else f", {chosen[PACKING]}"
    return f"{chosen[ROTATION]}, phi = {chosen[PHI]}{slip}{packing}"
