"""Fig. 10: 42 grains fall into a box; which of them still vibrate, by stiffness and diameter."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from matplotlib.figure import Figure

from ryusa.engine.forward_euler import integrate, step
from ryusa.figures.snapshot import snapshot as draw_snapshot
from ryusa.figures.vibration import vibration as draw_vibration
from ryusa.figures.vibration_threshold import over_threshold
from ryusa.measure import Snapshot, Vibration, rest_time, snapshot, vibrating_share, vibration
from ryusa.measure.statistics import Floats
from ryusa.measure.vibration import WINDOW, ExtentRule
from ryusa.results import Results
from ryusa.studies.osada2004._parts import PHI, RATIO, ROTATION, SLIP, CaseRun, Found, Plan, paper_run
from ryusa.study import Band, Finding, Interval, Trial, over_range, over_seeds, pool, short

FIGURE = "fig10"
TITLE = "Grains in a box: stiffness and coming to rest"
CLAIMS = ("fig10-soft", "fig10-stiff", "fig10-rule")
SOFT, STIFF = "1 N/cm", "100 N/cm"
STIFFEST = 1.0e4  # the same as STIFF [N/m]
THRESHOLD, MOVED, HEIGHT, SCHEME = "threshold (fig10)", "moved (fig10)", "fall (fig10)", "time scheme (fig10)"
# in diameters per window; what a chart with an axis in cm just shows is 0.001 d, that is 0.0002 cm
THRESHOLDS = {
    "0.001 d": 1.0e-3,
    "0.00001 d": 1.0e-5,
    "0.00003 d": 3.0e-5,
    "0.0001 d": 1.0e-4,
    "0.0003 d": 3.0e-4,
    "0.01 d": 1.0e-2,
}
WAYS: dict[str, ExtentRule] = {
    "net": "net",
    "to and fro": "z",
}  # the paper's displacement; the span, which never aliases
OURS = "semi-implicit"
SUMMED = "forward differences, spring summed, 10 steps"
EULER = "forward differences, spring from overlap, 10 steps"
ONE_STEP = "forward differences, spring from overlap, one step for both (10 and 100 steps)"
STEPS = 10.0  # the paper's own limit
SHIPPED = {ROTATION: "locked", HEIGHT: "1 cm", PHI: "30 deg", SCHEME: OURS}
KEYS = {ROTATION: "motion.rotation", HEIGHT: "build.height", PHI: "contact.friction_angle"}
AT, D = 0.125, 0.002  # when the paper looks at the stiff grains [s]; its diameter [m]
MARKED = (20, 39)  # one amid the pile, one in its top layer; the text does not say where No. 1 and No. 2 lay
HALF = Band(0.3, 0.6, "-", "nearly half of the 42 in the window that ends at 0.5 s: a share of 0.3 to 0.6")
REST = Band(
    -math.inf, 0.13, "s", "at rest by 0.125 s, resolved to one window of 0.01 s: no grain moves after 0.13 s"
)
NONE = Band(0.0, 0.0, "-", "no vibration: not a single grain in the last window")
LIMIT = 0.01  # of overlap/d, the paper's rule
SIZES = ("0.05 cm", "1 cm", "0.1 cm", "0.5 cm")
OVERLAPS = ("0.005", "0.03", "0.002", "0.01", "0.1")
SECOND = 1000  # from one seed to the next start
FALL = 5.0  # diameters, as the shipped 1 cm


@dataclass(frozen=True)
class Fall:
    """One run: motion in windows, largest overlap/d, two moments, and the same by forward differences."""

    moved: Vibration
    overlap: float
    start: Snapshot
    later: Snapshot
    forward: Mapping[str, Vibration]

    def by(self, scheme: str) -> Vibration:
        """Motion under a time scheme."""
        return self.moved if scheme == OURS else self.forward[scheme]


def settings(plan: Plan) -> list[dict[str, str]]:
    """What the text leaves open about the box, the shipped ones first."""
    schemes = [SHIPPED | {SCHEME: name} for name in (OURS, SUMMED, EULER, ONE_STEP)]
    free = [SHIPPED | {ROTATION: "free"}]
    lower = [SHIPPED | {ROTATION: one, HEIGHT: "0 cm"} for one in ("locked", "free")]
    angles = [SHIPPED | {PHI: one} for one in ("20 deg", "40 deg")]
    more = [SHIPPED | {ROTATION: "free", PHI: one} for one in ("20 deg", "40 deg")]
    higher = [SHIPPED | {ROTATION: one, HEIGHT: "2 cm"} for one in ("locked", "free")]
    others = plan.pick([], [*free, *lower, *angles], [*free, *lower, *angles, *more, *higher])
    return [*schemes, *others]


def starts(plan: Plan, chosen: Mapping[str, str] = SHIPPED) -> list[int]:
    """Seeds of the paper's own box: several for each of the plan, for no two falls are alike."""
    changed = [name for name in KEYS if chosen[name] != SHIPPED[name]]
    count = plan.pick(1, 4 if not changed else 1 if PHI in changed else 2, 8)
    return [seed + SECOND * one for seed in plan.seeds for one in range(count)]


def _run(chosen: Mapping[str, str], k_n: str, seed: int) -> CaseRun:
    changed = {KEYS[name]: chosen[name] for name in KEYS if chosen[name] != SHIPPED[name]}
    return paper_run("fig10", changed | ({} if k_n == SOFT else {"contact.stiffness": k_n}), seed)


def _other(size: str, overlap: str, rotation: str, seed: int) -> CaseRun:
    """A box of other grains, times stretched as sqrt(d/g), stiffness from what overlap the fall may make."""
    d = float(size.split(maxsplit=1)[0]) / 100.0
    speed = math.sqrt(2.0 * 9.8 * FALL * d)
    stretch = math.sqrt(d / D)
    changed = {
        "grains.diameter": size,
        "contact.stiffness": f'{{ overlap = {overlap}, speed = "{speed:.4g} m/s" }}',
        "build.height": f"{FALL * d:g} m",
        "stop.time": f"{0.5001 * stretch:.9g} s",
        "record.frames": f"{0.0002 * stretch:.9g} s",
    }
    return paper_run("fig10", changed | ({} if rotation == "locked" else {KEYS[ROTATION]: rotation}), seed)


def others(plan: Plan, rotation: str) -> list[CaseRun]:
    """Runs with other diameters; with free rotation fewer of them."""
    sizes, overlaps = plan.pick(SIZES[:2], SIZES), plan.pick(OVERLAPS[:2], OVERLAPS)
    if rotation == "free":
        overlaps = plan.pick((), OVERLAPS[:1], OVERLAPS)
    seeds = plan.pick(plan.seeds[:1], plan.seeds[:1], plan.seeds)
    return [_other(size, one, rotation, seed) for size in sizes for one in overlaps for seed in seeds]


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Soft and stiff under every setting, then other diameters."""
    runs = [_run(one, k, seed) for one in settings(plan) for k in (SOFT, STIFF) for seed in starts(plan, one)]
    return list(dict.fromkeys([*runs, *others(plan, "locked"), *others(plan, "free")]))


def measure(run: Results, one: CaseRun) -> Fall:
    """Motion in windows of 0.01 s, or in proportion to sqrt(d/g); forward differences in the shipped box."""
    d = float(run.scene.d.mean())
    window = WINDOW * math.sqrt(d / D)
    forward: dict[str, Vibration] = {}
    if {key for key, _ in one.overrides} <= {"seed", "contact.stiffness"}:
        own, stiff = step(run.scene, STEPS), step(run.scene, STEPS, STIFFEST)
        forward = {name: again(run, own, summed=name == SUMMED) for name in (SUMMED, EULER)}
        alike = math.isclose(own, stiff)
        forward[ONE_STEP] = forward[EULER] if alike else again(run, stiff, summed=False)
    return Fall(
        moved=vibration(run, window),
        overlap=float(np.max(run.tally["overlap_max"])),
        start=snapshot(run, 0.0),
        later=snapshot(run, AT),
        forward=forward,
    )


def again(run: Results, dt: float, *, summed: bool) -> Vibration:
    """Motion within windows of 0.01 s of the grains of a run by forward differences, from its first places.

    Parameters
    ----------
    run : equal grains in a plane among fixed ones of the same size; dry, slip rule "spring", no cohesion.
    dt : time step [s].
    summed : the spring is the sum of k_n v dt, Eq. (1) as printed; else it is read from the overlap.
    """
    scene, frames = run.scene, run.frames
    every, end = float(np.median(np.diff(frames.t))), float(frames.t[-1])
    t, x = integrate(scene, np.asarray(frames.x[0]), dt, end, every, summed=summed)
    moved = SimpleNamespace(t=t, x=x, omega=np.zeros_like(x))
    return vibration(cast(Any, SimpleNamespace(scene=scene, frames=moved)))


def share(moved: Vibration, threshold: str, way: str) -> float:
    """Share of grains that vibrate in the last window [-]."""
    return float(vibrating_share(moved, moved.diameters(THRESHOLDS[threshold]), WAYS[way])[-1])


def rests(moved: Vibration, threshold: str, way: str) -> float:
    """From when on no grain moves [s]; the end of the run where one still does."""
    found = rest_time(moved, moved.diameters(THRESHOLDS[threshold]), WAYS[way])
    return float(moved.end[-1]) if math.isnan(found) else found


def _both(plan: Plan, found: Found) -> tuple[list[Trial], list[Trial]]:
    """Trials of the soft and the stiff box; thresholds are the same for both."""
    soft: list[Trial] = []
    stiff: list[Trial] = []
    for threshold in THRESHOLDS:
        for way in WAYS:
            shares: list[list[float]] = []
            times: list[list[float]] = []
            for one in settings(plan):
                moved = [
                    [found[_run(one, k, seed)].by(one[SCHEME]) for seed in starts(plan, one)]
                    for k in (SOFT, STIFF)
                ]
                shares.append([share(run, threshold, way) for run in moved[0]])
                times.append([rests(run, threshold, way) for run in moved[1]])
            spread = pool(shares)
            for one, some, late in zip(settings(plan), shares, times, strict=True):
                chosen = {**one, THRESHOLD: threshold, MOVED: way}
                soft.append(
                    Trial(
                        "share of grains that vibrate at 0.5 s", chosen, over_seeds(some, "-", spread), HALF
                    )
                )
                stiff.append(
                    Trial("no grain moves after (0.5 s: never)", chosen, over_seeds(late, "s"), REST)
                )
    return soft, stiff


def _worst(runs: Sequence[Fall], threshold: str, way: str) -> Interval:
    values = [share(one.moved, threshold, way) for one in runs]
    return over_range([max(values, default=math.nan)], "-", f"worst of {len(runs)} runs")


def _some(runs: Sequence[Fall], threshold: str) -> int:
    """How many runs have a grain that moves to and fro at the end."""
    return sum(share(one.moved, threshold, "to and fro") > 0.0 for one in runs)


def _rule(plan: Plan, found: Found) -> Finding:
    """No run with overlap/d below 0.01 has vibrating grains at its end."""
    trials: list[Trial] = []
    also: list[str] = []
    for rotation in plan.pick(("locked",), ("locked", "free")):
        runs: list[Fall] = [found[one] for one in others(plan, rotation)]
        below = [one for one in runs if one.overlap < LIMIT]
        above = [one for one in runs if one.overlap >= LIMIT]
        for threshold in THRESHOLDS:
            for way in WAYS:
                chosen = {ROTATION: rotation, THRESHOLD: threshold, MOVED: way}
                trials.append(
                    Trial(
                        "largest share of grains that vibrate at the end",
                        chosen,
                        _worst(below, threshold, way),
                        NONE,
                    )
                )
        words = [
            f"{name}: {_some(below, name)} of {len(below)} below, {_some(above, name)} of {len(above)} above"
            for name in sorted(THRESHOLDS, key=lambda name: THRESHOLDS[name])
        ]
        also.append(
            f"rotation {rotation}, runs with a grain that moves to and fro at the end by more than a "
            f"threshold, overlap/d below 0.01 and above: {'; '.join(words)}"
        )
    runs = [found[one] for one in others(plan, "locked")]
    above = [one for one in runs if one.overlap >= LIMIT]
    above_all = (
        f"of {len(above)} locked runs above it {_some(above, '0.001 d')} vibrate by 0.001 d at the end"
    )
    return Finding(
        "fig10-rule",
        tuple(trials),
        "Dry boxes with equal overlap/d are similar at all diameters, with times in units of sqrt(d/g), "
        "so the rule holds for all diameters or for none. There is no threshold at 0.01: the lower "
        f"overlap/d, the smaller and the shorter the motion left by the fall; {above_all}.",
        {
            "d": ", ".join(SIZES),
            "overlap/d asked for": ", ".join(plan.pick(OVERLAPS[:2], OVERLAPS)),
            "window and run": "0.01 s and 0.5 s at 0.2 cm, in proportion to sqrt(d/g)",
        },
        also=tuple(also),
    )


def _left(runs: Sequence[Fall], t: float, scheme: str = OURS) -> float:
    """Median over grains and runs of the span in z in the window that ends at t [mean diameters]."""
    moved = [one.by(scheme) for one in runs]
    return float(np.median([one.span_z[np.abs(one.end - t).argmin()] / one.d_mean for one in moved]))


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Soft: nearly half of the grains vibrate; stiff: all are at rest; and the rule for other diameters."""
    soft, stiff = _both(plan, found)
    runs: list[Fall] = [found[_run(SHIPPED, SOFT, seed)] for seed in starts(plan)]
    stiffs: list[Fall] = [found[_run(SHIPPED, STIFF, seed)] for seed in starts(plan)]
    shared = {"d": "0.2 cm", "grains": "42, all alike", "window": "0.01 s"}
    overlap = [float(np.median([one.overlap for one in some])) for some in (runs, stiffs)]
    net = float(np.median([np.abs(one.moved.net[-1]) / one.moved.d_mean for one in runs]))
    also = [
        f"largest overlap/d {short(overlap[0])} at {SOFT}, {short(overlap[1])} at {STIFF}",
        f"half of the grains on soft springs vibrate at 0.5 s if the threshold is {short(net)} d net, or "
        f"{short(_left(runs, 0.5))} d to and fro: less than a ten-thousandth of a millimetre",
    ]
    for name in (OURS, SUMMED, EULER, ONE_STEP):
        net, wide = (
            [_mean(some, name, *how) for some in (runs, stiffs)]
            for how in (("0.001 d", "net"), ("0.0001 d", "to and fro"))
        )
        also.append(
            f"{name}: share beyond 0.001 d net {net[0]:.2f} at {SOFT} and {net[1]:.2f} at {STIFF}, beyond "
            f"0.0001 d to and fro {wide[0]:.2f} and {wide[1]:.2f}; median grain to and fro "
            f"{short(_left(runs, 0.5, name))} d and {short(_left(stiffs, 0.5, name))} d"
        )
    return (
        Finding(
            "fig10-soft",
            tuple(soft),
            "The motion left by the fall is damped by the dashpots at a rate proportional to sqrt(k_n), "
            "ten times more slowly in the soft box: the median grain oscillates by "
            f"{short(_left(runs, 0.3))} d at 0.3 s and {short(_left(runs, 0.5))} d at 0.5 s. It is not "
            "sustained, so the threshold decides. Forward differences sustain it if the spring force is "
            f"calculated from the overlap and a contact has ten steps ({short(_left(runs, 0.5, EULER))} d "
            f"at 0.5 s, but then the stiff box vibrates too, {short(_left(stiffs, 0.5, EULER))} d); with "
            "the spring force summed as printed they do not.",
            {**shared, SLIP: "spring", RATIO: "2/7", "k_n": SOFT},
            also=tuple(also),
        ),
        Finding(
            "fig10-stiff",
            tuple(stiff),
            "A stiff pile loses its oscillation within hundredths of a second. How long grains go on "
            "moving depends on the height of the fall and, with rotation free, on rolling, which is "
            "hardly resisted.",
            {**shared, SLIP: "spring", RATIO: "2/7", "k_n": STIFF},
        ),
        _rule(plan, found),
    )


def _mean(runs: Sequence[Fall], scheme: str, threshold: str, way: str) -> float:
    return float(np.mean([share(one.by(scheme), threshold, way) for one in runs]))


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run, time scheme, threshold and way to count."""
    lines: list[dict[str, object]] = []
    for one, fall in found.items():
        d = fall.moved.d_mean
        for scheme in (OURS, *fall.forward):
            moved = fall.by(scheme)
            for threshold in THRESHOLDS:
                for way in WAYS:
                    row: dict[str, object] = {"d_m": d, "k_n": one.get("contact.stiffness", SOFT)}
                    row |= {name: one.get(key, SHIPPED[name]) for name, key in KEYS.items()}
                    row |= {"seed": one.get("seed"), SCHEME: scheme, THRESHOLD: threshold, MOVED: way}
                    row |= {"overlap_over_d": fall.overlap, "share_at_end": share(moved, threshold, way)}
                    lines.append({**row, "rests_from_s": rests(moved, threshold, way)})
    return lines


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Fig. 9 and fig. 10 as printed, and the share of vibrating grains over the threshold."""
    runs: dict[str, Fall] = {k: found[_run(SHIPPED, k, plan.seeds[0])] for k in (SOFT, STIFF)}
    pictures = {"fig09-start": draw_snapshot(runs[SOFT].start, "none")}
    for letter, (k, fall) in zip("ab", runs.items(), strict=True):
        pictures[f"fig10{letter}"] = draw_vibration(fall.moved, MARKED, title=f"$k_n$ = {k}")
        pictures[f"fig09-{'soft' if k == SOFT else 'stiff'}"] = draw_snapshot(fall.later, "speed")
    moved: dict[str, dict[str, Floats]] = {}
    for k, fall in runs.items():
        names = {
            OURS: fall.moved,
            "forward, summed": fall.forward[SUMMED],
            "forward, overlap": fall.forward[EULER],
        }
        moved[k] = {name: one.span_z[-1] / one.d_mean for name, one in names.items()}
    pictures["fig10-threshold"] = over_threshold(
        moved, (HALF.low, HALF.high), "nearly half\n(Osada et al. 2004)",
        "to and fro in z, last 0.01 s before 0.5 s; forward: 10 steps per contact",
    )  # fmt: skip
    return pictures
