"""Fig. 10: 42 grains fall into a box; which of them still vibrate, by stiffness and diameter."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures.snapshot import snapshot as draw_snapshot
from ryusa.figures.vibration import vibration as draw_vibration
from ryusa.measure import Snapshot, Vibration, rest_time, snapshot, vibrating_share, vibration
from ryusa.measure.statistics import Floats
from ryusa.measure.vibration import WINDOW, ExtentRule
from ryusa.results import Results
from ryusa.study import Finding, Interval, Trial, short
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._factors import FULL, design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan, paper_run
from ryusa_studies.osada2004._shares import positive, share_interval, share_trial
from ryusa_studies.osada2004.figures.vibration_threshold import over_threshold
from ryusa_studies.osada2004.forward_euler import integrate, step

FIGURE = "fig10"
TITLE = "Grains in a box: stiffness and coming to rest"
CLAIMS = ("fig10-soft", "fig10-stiff", "fig10-rule")
SOFT, STIFF = "1 N/cm", "100 N/cm"
STIFFEST = 1.0e4  # the same as STIFF [N/m]
STIFFNESS = "contact.stiffness"
THRESHOLD, MOVED, HEIGHT, SCHEME = "threshold (fig10)", "moved (fig10)", "fall (fig10)", "time scheme (fig10)"
SIZE, OVERLAP = "d (fig10)", "overlap/d (fig10)"
# in diameters per window; what a chart with an axis in cm just shows is 0.001 d, that is 0.0002 cm
THRESHOLDS = {"0.001 d": 1.0e-3, "0.00001 d": 1.0e-5, "0.0001 d": 1.0e-4, "0.01 d": 1.0e-2}
WAYS: dict[str, ExtentRule] = {
    "net": "net",
    "to and fro": "z",
}  # the paper's displacement; the span, which never aliases
OURS = "semi-implicit"
SUMMED = "forward differences, spring summed, 10 steps"
EULER = "forward differences, spring from overlap, 10 steps"
ONE_STEP = "forward differences, spring from overlap, one step for both (10 and 100 steps)"
FORWARD = (SUMMED, EULER, ONE_STEP)
STEPS = 10.0  # the paper's own limit
DESIGN = design("fig10")
ABOVE = ("0.03", "0.1")  # overlap/d asked for
OTHERS = design("fig10-others")
AT, D = 0.125, 0.002  # when the paper looks at the stiff grains [s]; its diameter [m]
MARKED = (20, 39)  # one amid the pile, one in its top layer; the text does not say where No. 1 and No. 2 lay
GRAINS = 42
SOFT_PART, STIFF_PART = "share of grains that vibrate at 0.5 s", "no grain moves after (0.5 s: never)"
RULE_PART = "share of grains that vibrate at the end"
HALF, REST, NONE = (
    band("fig10-soft", SOFT_PART),
    band("fig10-stiff", STIFF_PART),
    band("fig10-rule", RULE_PART),
)
LIMIT = 0.01  # of overlap/d, the paper's rule
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


settings = DESIGN.sets


def _run(chosen: Mapping[str, str], k_n: str, seed: int) -> CaseRun:
    return paper_run("fig10", DESIGN.overrides(chosen) | ({} if k_n == SOFT else {STIFFNESS: k_n}), seed)


other_settings = OTHERS.sets


def _other(chosen: Mapping[str, str], seed: int) -> CaseRun:
    """A box of other grains, times stretched as sqrt(d/g), stiffness from what overlap the fall may make."""
    d = float(chosen[SIZE].split(maxsplit=1)[0]) / 100.0
    speed = math.sqrt(2.0 * 9.8 * FALL * d)
    stretch = math.sqrt(d / D)
    changed = {
        "grains.diameter": chosen[SIZE],
        STIFFNESS: f'{{ overlap = {chosen[OVERLAP]}, speed = "{speed:.4g} m/s" }}',
        "build.height": f"{FALL * d:g} m",
        "stop.time": f"{0.5001 * stretch:.9g} s",
        "record.frames": f"{0.0002 * stretch:.9g} s",
    }
    given = {name: level for name, level in chosen.items() if name != OVERLAP}
    return paper_run("fig10", OTHERS.overrides(given) | changed, seed)


def _above(plan: Plan) -> list[dict[str, str]]:
    """Boxes beyond the limit of the rule, as shipped otherwise; they judge nothing."""
    return [OTHERS.base | {OVERLAP: one} for one in plan.pick((), ABOVE)]


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Soft and stiff under every setting, then other diameters."""
    runs = [_run(one, k, seed) for one in settings(plan) for k in (SOFT, STIFF) for seed in plan.seeds]
    others = [_other(one, seed) for one in (*other_settings(plan), *_above(plan)) for seed in plan.seeds]
    return list(dict.fromkeys([*runs, *others]))


@lru_cache(maxsize=1)
def _schemes() -> Mapping[CaseRun, set[str]]:
    """Forward schemes that a setting asks for, by its run with seed 1; all of them as shipped."""
    wanted: dict[CaseRun, set[str]] = {_run(DESIGN.base, k, 1): set(FORWARD) for k in (SOFT, STIFF)}
    pairs = [(_run(one, k, 1), one) for one in DESIGN.settings(FULL) for k in (SOFT, STIFF)]
    for run, one in [*pairs, *((_other(one, 1), one) for one in OTHERS.settings(FULL))]:
        wanted.setdefault(run, set()).update({one[SCHEME]} - {OURS})
    return wanted


def measure(run: Results, one: CaseRun) -> Fall:
    """Motion in windows of 0.01 s, or in proportion to sqrt(d/g); the same by forward differences."""
    d = float(run.scene.d.mean())
    window = WINDOW * math.sqrt(d / D)
    first = paper_run("fig10", {key: value for key, value in one.overrides if key != "seed"}, 1)
    forward: dict[str, Vibration] = {}
    for scheme in sorted(_schemes().get(first, ())):
        dt = step(run.scene, STEPS, STIFFEST if scheme == ONE_STEP else math.nan)
        forward[scheme] = again(run, dt, window, summed=scheme == SUMMED)
    return Fall(
        moved=vibration(run, window),
        overlap=float(np.max(run.tally["overlap_max"])),
        start=snapshot(run, 0.0),
        later=snapshot(run, AT),
        forward=forward,
    )


def again(run: Results, dt: float, window: float, *, summed: bool) -> Vibration:
    """Motion within windows of the grains of a run by forward differences, from its first places.

    Parameters
    ----------
    run : equal grains in a plane among fixed ones of the same size; dry, no cohesion.
    dt, window : time step, and length of a window [s].
    summed : the spring is the sum of k_n v dt, Eq. (1) as printed; else it is read from the overlap.
    """
    scene, frames = run.scene, run.frames
    every, end = float(np.median(np.diff(frames.t))), float(frames.t[-1])
    t, x = integrate(scene, np.asarray(frames.x[0]), dt, end, every, summed=summed)
    moved = SimpleNamespace(t=t, x=x, omega=np.zeros_like(x))
    return vibration(cast(Any, SimpleNamespace(scene=scene, frames=moved)), window)


def share(moved: Vibration, threshold: str, way: str) -> float:
    """Share of grains that vibrate in the last window [-]."""
    return float(vibrating_share(moved, moved.diameters(THRESHOLDS[threshold]), WAYS[way])[-1])


def rests(moved: Vibration, threshold: str, way: str) -> float:
    """From when on no grain moves [s]; the end of the run where one still does."""
    found = rest_time(moved, moved.diameters(THRESHOLDS[threshold]), WAYS[way])
    return float(moved.end[-1]) if math.isnan(found) else found


def _vibrating(runs: Sequence[Fall], chosen: Mapping[str, str]) -> list[float]:
    """Number of grains that vibrate in the last window, by seed."""
    return [GRAINS * share(one.by(chosen[SCHEME]), chosen[THRESHOLD], chosen[MOVED]) for one in runs]


def _both(plan: Plan, found: Found) -> tuple[list[Trial], list[Trial]]:
    """Trials of the soft and the stiff box."""
    soft: list[Trial] = []
    stiff: list[Trial] = []
    for one in settings(plan):
        runs, stiffs = ([found[_run(one, k, seed)] for seed in plan.seeds] for k in (SOFT, STIFF))
        soft.append(share_trial(SOFT_PART, one, _vibrating(runs, one), GRAINS, HALF))
        late = [rests(run.by(one[SCHEME]), one[THRESHOLD], one[MOVED]) for run in stiffs]
        stiff.append(positive(STIFF_PART, one, late, REST))
    return soft, stiff


def _rule(plan: Plan, found: Found) -> Finding:
    """Boxes with overlap/d below 0.01 have no vibrating grains at their end."""
    trials: list[Trial] = []
    for one in other_settings(plan):
        runs: list[Fall] = [found[_other(one, seed)] for seed in plan.seeds]
        trial = share_trial(RULE_PART, one, _vibrating(runs, one), GRAINS, NONE)
        beyond = sum(run.overlap >= LIMIT for run in runs)
        if beyond:
            note = f"overlap/d reaches {LIMIT} in {beyond} of {len(runs)} runs: they do not test the rule"
            nan = math.nan
            trial = Trial(RULE_PART, one, Interval(nan, nan, nan, "-", len(runs), note), NONE, note=note)
        trials.append(trial)
    beside: list[Trial] = []
    for one in _above(plan):
        runs = [found[_other(one, seed)] for seed in plan.seeds]
        for threshold in THRESHOLDS:
            key = {OVERLAP: one[OVERLAP], THRESHOLD: threshold, MOVED: "to and fro"}
            hits = _vibrating(runs, one | key)
            beside.append(Trial(RULE_PART, key, share_interval(hits, GRAINS), None))
    return finding(
        "fig10-rule",
        trials,
        also=(
            "overlap/d reached: "
            + short(max(found[_other(one, s)].overlap for one in other_settings(plan) for s in plan.seeds))
            + " at most",
        ),
        beside=beside,
    )


def _left(runs: Sequence[Fall], t: float, scheme: str = OURS) -> float:
    """Median over grains and runs of the span in z in the window that ends at t [mean diameters]."""
    moved = [one.by(scheme) for one in runs]
    return float(np.median([one.span_z[np.abs(one.end - t).argmin()] / one.d_mean for one in moved]))


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Soft: nearly half of the grains vibrate; stiff: all are at rest; and the rule for other diameters."""
    soft, stiff = _both(plan, found)
    runs: list[Fall] = [found[_run(DESIGN.base, SOFT, seed)] for seed in plan.seeds]
    stiffs: list[Fall] = [found[_run(DESIGN.base, STIFF, seed)] for seed in plan.seeds]
    overlap = [float(np.median([one.overlap for one in some])) for some in (runs, stiffs)]
    net = float(np.median([np.abs(one.moved.net[-1]) / one.moved.d_mean for one in runs]))
    also = [
        f"largest overlap/d {short(overlap[0])} at {SOFT}, {short(overlap[1])} at {STIFF}",
        f"half of the grains on soft springs vibrate at 0.5 s if the threshold is {short(net)} d net, or "
        f"{short(_left(runs, 0.5))} d to and fro: less than a ten-thousandth of a millimetre",
    ]
    for name in (OURS, *FORWARD):
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
        finding(
            "fig10-soft",
            soft,
            also=also,
            left_3=short(_left(runs, 0.3)),
            left_5=short(_left(runs, 0.5)),
            euler=short(_left(runs, 0.5, EULER)),
            stiff=short(_left(stiffs, 0.5, EULER)),
        ),
        finding("fig10-stiff", stiff),
        _rule(plan, found),
    )


def _mean(runs: Sequence[Fall], scheme: str, threshold: str, way: str) -> float:
    return float(np.mean([share(one.by(scheme), threshold, way) for one in runs]))


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per setting and seed, of the soft, the stiff and the other boxes."""
    lines: list[dict[str, object]] = []

    def add(one: Mapping[str, str], k_n: str, run: CaseRun) -> None:
        fall: Fall = found[run]
        moved, how = fall.by(one[SCHEME]), (one[THRESHOLD], one[MOVED])
        lines.append(
            {
                SIZE: "0.2 cm", OVERLAP: "", HEIGHT: "5 d", **one, "k_n": k_n, "seed": run.get("seed"),
                "overlap_over_d": fall.overlap, "share_at_end": share(moved, *how),
                "rests_from_s": rests(moved, *how),
            }
        )  # fmt: skip

    for one in settings(plan):
        for seed in plan.seeds:
            add(one, SOFT, _run(one, SOFT, seed))
            add(one, STIFF, _run(one, STIFF, seed))
    for one in (*other_settings(plan), *_above(plan)):
        for seed in plan.seeds:
            add(one, "by overlap", _other(one, seed))
    return lines


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Fig. 9 and fig. 10 as printed, and the share of vibrating grains over the threshold."""
    runs: dict[str, Fall] = {k: found[_run(DESIGN.base, k, plan.seeds[0])] for k in (SOFT, STIFF)}
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
