"""Fig. 22: a movable bed under water: locked grains move like rods; and the same with rotation."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa import figures
from ryusa.measure import Profiles, Rods, Snapshot, profiles, rods, snapshot, transport
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.studies.osada2004._parts import PHI, RATIO, SLIP, CaseRun, Found, Plan, paper_run
from ryusa.study import Band, Finding, Trial, over_seeds, pool, short

FIGURE = "fig22"
TITLE = "Movable bed under water, rotation locked and free"
CLAIMS = ("fig22", "fig22-free")
CASE = "fig22"
LOCKED, FREE = "locked", "free"
SLOPE, DEPTH = "slope (tau_star)", "bed depth"
SLOPES = {
    "1/20 (0.3)": "1/20",
    "1/10 (0.6)": "1/10",
    "3/20 (0.9)": "3/20",
    "1/5 (1.2)": "1/5",
    "1/4 (1.5)": "1/4",
}
DEPTHS = {"5 layers": "5", "8 layers": "8"}
SHIPPED = {PHI: "30 deg", SLIP: "spring", SLOPE: "1/4 (1.5)", DEPTH: "5 layers"}
MOVERS = 10  # of all windows, below which nothing is said about rods
RODS = Band(0.1, math.inf, "-", "like rods: at least a tenth of the movers more than with shuffled paths")
MORE = Band(
    math.log10(2.0),
    math.inf,
    "-",
    "unable to climb: at least twice as many in rods, 0.301 decades, as with rotation free",
)
SPINS = Band(
    100.0, math.inf, "rad/s", "spin fast: a twentieth of the movers above 100 rad/s, 16 turns a second"
)
CHANGED = Band(
    math.log10(1.1),
    math.inf,
    "-",
    "changes speed and flux: at least 10 % more, 0.041 decades, than locked grains",
)
STANDS = "nothing moves"
PART_RODS = "movers in rods minus those with shuffled paths"
PART_MORE = "movers in rods, locked over free, in decades"
PART_SPIN = "spin exceeded by a twentieth of the movers"
PART_Q = "flux, free over locked, in decades"
PART_SPEED = "speed of the movers, free over locked, in decades"
MOMENTS = 3  # drawn of a rod


@dataclass(frozen=True)
class MovableBedRun:
    """One run, after it has settled.

    Attributes
    ----------
    rods : rods, and the null model.
    q : flux of grains per width [m2/s].
    v, spin : speeds along the bed [m/s] and spins [rad/s] of grains that move, all frames together.
    profile : means over height from the mean crest of the fixed grains.
    followed : the longest rod at `MOMENTS` moments of its window; none where there is no rod.
    """

    rods: Rods
    q: float
    v: Floats
    spin: Floats
    profile: Profiles
    followed: tuple[Snapshot, ...]

    @property
    def stands(self) -> bool:
        """Whether too few move to say anything of rods."""
        return int(self.rods.movers.sum()) < MOVERS

    @property
    def excess(self) -> float:
        """Movers in rods less those with shuffled ways [-]; 0 where nothing moves."""
        return 0.0 if self.stands else self.rods.share - self.rods.null_share

    @property
    def speed(self) -> float:
        """Mean speed of grains that move [m/s]; 0 where none does."""
        return float(self.v.mean()) if len(self.v) else 0.0

    @property
    def fast_spin(self) -> float:
        """What a twentieth of the spins of movers exceeds [rad/s]."""
        return float(np.quantile(np.abs(self.spin), 0.95)) if len(self.spin) else 0.0

    @property
    def rolling(self) -> float:
        """Spin times radius over speed, means of the movers [-]; 1 for grains that roll."""
        return 0.5 * self.profile.d * float(self.spin.mean()) / self.speed if self.speed > 0.0 else math.nan


def settings(plan: Plan) -> list[dict[str, str]]:
    """Sets of free choices, the shipped one first; one choice is changed at a time."""
    changes = plan.pick(
        (),
        ((SLOPE, ("1/10 (0.6)", "1/5 (1.2)")), (PHI, ("20 deg",)), (SLIP, ("total",))),
        (
            (SLOPE, ("1/20 (0.3)", "1/10 (0.6)", "3/20 (0.9)", "1/5 (1.2)")),
            (PHI, ("10 deg", "20 deg", "40 deg")),
            (SLIP, ("total", "spring-drop")),
            (DEPTH, ("8 layers",)),
        ),
    )
    return [SHIPPED, *({**SHIPPED, name: value} for name, values in changes for value in values)]


def _run(chosen: Mapping[str, str], rotation: str, seed: int) -> CaseRun:
    """One run of the case; what is as shipped is not said."""
    changed = {
        "timeline.0.friction_angle": (chosen[PHI], SHIPPED[PHI]),
        "timeline.1.rotation": (rotation, LOCKED),
        "contact.slip": (chosen[SLIP], SHIPPED[SLIP]),
        "timeline.2.slope": (SLOPES[chosen[SLOPE]], SLOPES[SHIPPED[SLOPE]]),
        "build.layers": (DEPTHS[chosen[DEPTH]], DEPTHS[SHIPPED[DEPTH]]),
    }
    return paper_run(
        CASE, {key: value for key, (value, shipped) in changed.items() if value != shipped}, seed
    )


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Locked and free grains for every setting and seed."""
    return [
        _run(one, rotation, seed)
        for one in settings(plan)
        for rotation in (LOCKED, FREE)
        for seed in plan.seeds
    ]


def measure(run: Results, one: CaseRun) -> MovableBedRun:
    """Rods, flux, speeds and spins of the movers, and the longest rod on its way."""
    del one
    found = rods(run)
    profile = profiles(run, above="mean crest", bed=True)
    rows = np.searchsorted(np.asarray(run.frames.t), (float(profile.t[0]), float(profile.t[-1])))
    v = np.asarray(run.frames.v[rows[0] : rows[1] + 1], dtype=np.float64)[:, :, 0]
    spin = np.asarray(run.frames.omega[rows[0] : rows[1] + 1], dtype=np.float64)[:, :, 1]
    moves = v > profile.d / found.window  # the speed of a mover in rods
    longest = found.longest
    moments = [] if longest is None else longest.begin + found.window * np.linspace(0.0, 1.0, MOMENTS)
    return MovableBedRun(
        rods=found,
        q=transport(run).averages["q"].value,
        v=v[moves],
        spin=spin[moves],
        profile=profile,
        followed=tuple(snapshot(run, float(t)) for t in moments),
    )


def _both(found: Found, plan: Plan, chosen: Mapping[str, str]) -> list[tuple[MovableBedRun, MovableBedRun]]:
    """Locked and free run of every seed."""
    return [(found[_run(chosen, LOCKED, seed)], found[_run(chosen, FREE, seed)]) for seed in plan.seeds]


def _decades(above: float, below: float, least: float) -> float:
    """Logarithm of a ratio: fluxes of locked beds differ by factors from seed to seed."""
    return math.log10(max(above, least) / max(below, least))


def _more(locked: MovableBedRun, free: MovableBedRun) -> float:
    """Share in rods, locked over free; 0 where locked grains stand, and one in a hundred counts as least."""
    if locked.stands:
        return 0.0
    return _decades(locked.rods.share, 0.0 if free.stands else free.rods.share, 0.01)


PARTS: dict[str, tuple[tuple[str, Callable[[MovableBedRun, MovableBedRun], float], Band], ...]] = {
    "fig22": (
        (PART_RODS, lambda locked, free: locked.excess, RODS),
        (PART_MORE, _more, MORE),
    ),
    "fig22-free": (
        (PART_SPIN, lambda locked, free: free.fast_spin, SPINS),
        (PART_SPEED, lambda locked, free: _decades(free.speed, locked.speed, 1.0e-3), CHANGED),
        (PART_Q, lambda locked, free: _decades(free.q, locked.q, 1.0e-7), CHANGED),
    ),
}


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Rods where grains are locked, spin and flux where they are free."""
    tried: dict[str, list[Trial]] = {}
    for claim, parts in PARTS.items():
        for part, value, band in parts:
            groups = [[value(*pair) for pair in _both(found, plan, one)] for one in settings(plan)]
            spread = pool(groups) if part in {PART_RODS, PART_SPIN} else None
            for one, values in zip(settings(plan), groups, strict=True):
                trial = Trial(part, dict(one), over_seeds(values, band.unit, spread), band)
                tried.setdefault(claim, []).append(_standing(trial, claim, _both(found, plan, one)))
    return (
        Finding(
            "fig22",
            tuple(tried["fig22"]),
            "A locked grain cannot roll out of the pocket between two others; it moves only with its row. "
            f"Touching neighbours therefore keep their arrangement and creep together. {_words(found, plan)}",
            _settings(),
            also=_lengths(found, plan),
        ),
        Finding(
            "fig22-free",
            tuple(tried["fig22-free"]),
            "A grain that may rotate leaves its pocket at 30 deg whatever the friction, rolls, and the "
            f"bed below it yields. {_spins(found, plan)}",
            _settings(),
            also=(
                "without rolling friction and water torque only contacts reduce the spin",
                "locked grains at rest count with a flux of 1e-7 m2/s, a speed of 1 mm/s",
            ),
        ),
    )


def _standing(trial: Trial, claim: str, runs: Sequence[tuple[MovableBedRun, MovableBedRun]]) -> Trial:
    """Say so where locked grains do not move at all: then there is no rod."""
    if claim != "fig22" or not all(locked.stands for locked, _ in runs):
        return trial
    return Trial(trial.part, trial.choices, trial.found, trial.band, False, STANDS)


def _settings() -> dict[str, str]:
    return {
        "d": "0.2 cm, sizes +-10 %",
        "k_n": "100 N/cm",
        RATIO: "2/7",
        "restitution": "0.7",
        "bed": "100 grains over fixed ones of random height, settled without friction",
        "water": "column, 2 cm deep, Li-Sawamoto",
        "window": "1 to 2 s",
        "rod": "movers that touch (gap below 0.05 d) throughout 0.07 s = 5 sqrt(d/g), in which they go 1 d "
        "or more and turn about each other by less than 15 deg",
        "null model": "every mover goes the way of one picked from its layer and any window",
    }


def _mean(values: Sequence[float]) -> str:
    kept = [value for value in values if math.isfinite(value)]
    return short(float(np.mean(kept))) if kept else "none"


def _by_rotation(found: Found, plan: Plan, chosen: Mapping[str, str]) -> dict[str, list[MovableBedRun]]:
    runs = _both(found, plan, chosen)
    return {LOCKED: [locked for locked, _ in runs], FREE: [free for _, free in runs]}


def _words(found: Found, plan: Plan) -> str:
    words: list[str] = []
    for rotation, runs in _by_rotation(found, plan, SHIPPED).items():
        share, null = (_mean([getattr(one.rods, name) for one in runs]) for name in ("share", "null_share"))
        movers = _mean([float(one.rods.movers.mean()) for one in runs])
        words.append(f"{rotation} {share} of {movers} movers (shuffled {null})")
    return f"In rods, as shipped: {'; '.join(words)}."


def _spins(found: Found, plan: Plan) -> str:
    runs = _by_rotation(found, plan, SHIPPED)[FREE]
    largest = max((float(np.abs(one.spin).max()) for one in runs if len(one.spin)), default=math.nan)
    return (
        f"As shipped: spin times radius is {_mean([one.rolling for one in runs])} of the speed, the largest "
        f"spin {short(largest)} rad/s; mean speed of the movers {_mean([one.speed for one in runs])} against "
        f"{_mean([one.speed for one in _by_rotation(found, plan, SHIPPED)[LOCKED]])} m/s."
    )


def _lengths(found: Found, plan: Plan) -> tuple[str, ...]:
    """How long rods are, and how the shares go with the choices."""
    lines: list[str] = []
    for one in settings(plan):
        name = ", ".join(value for key, value in one.items() if value != SHIPPED[key]) or "as shipped"
        parts: list[str] = []
        for rotation, runs in _by_rotation(found, plan, one).items():
            share, null, length = (
                _mean([getattr(bed.rods, what) for bed in runs])
                for what in ("share", "null_share", "mean_length")
            )
            parts.append(f"{rotation} {share} in rods, {null} shuffled, {length} grains a rod")
        lines.append(f"{name}: {'; '.join(parts)}")
    return tuple(lines)


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    lines: list[dict[str, object]] = []
    for one in settings(plan):
        for rotation in (LOCKED, FREE):
            for seed in plan.seeds:
                bed: MovableBedRun = found[_run(one, rotation, seed)]
                lines.append(
                    {
                        **one, "rotation": rotation, "seed": seed, "movers": int(bed.rods.movers.sum()),
                        "windows": len(bed.rods.begin), "in_rods": bed.rods.share,
                        "shuffled": bed.rods.null_share, "kept": bed.rods.kept,
                        "grains_in_a_rod": bed.rods.mean_length, "q_m2_per_s": bed.q,
                        "speed_of_movers_m_per_s": bed.speed, "spin_95_rad_per_s": bed.fast_spin,
                    }
                )  # fmt: skip
    return lines


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """The longest rod on its way, how long rods are, and the profiles."""
    seed = plan.seeds[0]
    locked: MovableBedRun = found[_run(SHIPPED, LOCKED, seed)]
    free: MovableBedRun = found[_run(SHIPPED, FREE, seed)]
    pictures = {
        "fig22-lengths": figures.rod_lengths({LOCKED: locked.rods, FREE: free.rods}),
        "fig22-free": figures.profiles({LOCKED: locked.profile, FREE: free.profile}, ("phi", "v_x", "spin")),
    }
    longest = locked.rods.longest
    if longest is not None:
        pictures = {"fig22": figures.rods(locked.followed, longest.grains), **pictures}
    return pictures
