"""Whether a dry bed steeper than 18 deg flows by itself with rotation free."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures.flow import speeds
from ryusa.figures.snapshot import snapshot as draw_snapshot
from ryusa.measure import Snapshot, snapshot
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.studies.osada2004._parts import PHI, RATIO, SLIP, CaseRun, Found, Plan, paper_run
from ryusa.study import Band, Finding, Trial, over_range, short

FIGURE = "fig19"
TITLE = "Flow of a tilted dry bed"
CLAIMS = ("bed18",)
SLOPE, START, BED = "slope (bed18)", "start (bed18)", "bed (bed18)"
REST, MOVING = "from rest", "once moving"
PUSH = "30 deg"  # slope of the first 0.15 s of a bed that is set moving
SHIPPED = {SLOPE: "21 deg", START: REST, PHI: "30 deg", BED: "random"}
SLOPES = {REST: ("21 deg", "23 deg", "25 deg", "28 deg"), MOVING: ("19 deg", "21 deg", "23 deg", "25 deg")}
CONTROLS = {  # slope, rotation of a bed that should stop or stay, both pushed
    "16 deg, rotation free": ("16 deg", "free"),
    "21 deg, rotation locked": ("21 deg", "locked"),
}
HEAP = 18.0  # the paper's final slope of fig19 with rotation free [deg]
TOLD = 3.0  # "about 18 deg", as in fig19: a bed that is to flow is steeper by at least that [deg]
TILT = 0.3  # when the bed is tilted [s]
LAST = 0.3  # judged over the last so many seconds, beside as many before
FLOWS = 0.02  # of sqrt(g d)
MOVES = Band(
    FLOWS,
    math.inf,
    "-",
    "flows: mean speed of the free grains over the last 0.3 s above 0.02 sqrt(g d), a diameter in 0.7 s; "
    "a creeping bed is slower, and one layer of ten that rolls with sqrt(g d) gives 0.1. And not "
    "decaying: at least half the speed of the 0.3 s before. Required of every seed and every slope from "
    "21 deg",
)
KEEPS = 0.5  # of the speed 0.3 s before; a bed one degree too flat loses 0.4 sqrt(g d) in that time


@dataclass(frozen=True)
class TiltedBedRun:
    """One run.

    Attributes
    ----------
    t, v : time [s] and mean speed of the free grains along the bed [m/s], by frame.
    x : mean place of the free grains along the bed [m], by frame.
    d : mean diameter [m].
    g : acceleration of gravity [m/s2].
    last : the end.
    """

    t: Floats
    v: Floats
    x: Floats
    d: float
    g: float
    last: Snapshot

    def speed(self, back: float = 0.0) -> float:
        """Mean speed over sqrt(g d) in the last 0.3 s, or so many seconds before [-]; from the way gone."""
        end = float(self.t[-1]) - back
        way = float(np.interp(end, self.t, self.x) - np.interp(end - LAST, self.t, self.x))
        return way / LAST / math.sqrt(self.g * self.d)

    @property
    def most(self) -> float:
        """Largest mean speed after the tilt over sqrt(g d) [-]."""
        return float(self.v[self.t > TILT].max()) / math.sqrt(self.g * self.d)

    @property
    def keeps(self) -> float:
        """Speed of the last 0.3 s over that of the 0.3 s before [-]; 0 where it stood."""
        before = self.speed(LAST)
        return self.speed() / before if before > FLOWS else 0.0 if self.speed() < FLOWS else math.inf


def settings(plan: Plan) -> list[dict[str, str]]:
    """Slopes and starts; other friction angles and beds at two slopes."""

    def bed(start: str, slope: str, phi: str = "30 deg", bed: str = "random") -> dict[str, str]:
        return {SLOPE: slope, START: start, PHI: phi, BED: bed}

    both = [bed(start, one) for start in (REST, MOVING) for one in SLOPES[start]]
    angles = [bed(MOVING, one, phi) for phi in ("20 deg", "40 deg") for one in ("21 deg", "25 deg")]
    finer = [
        bed(REST, "19 deg"),
        bed(REST, "26 deg"),
        bed(REST, "27 deg"),
        bed(MOVING, "20 deg"),
        bed(MOVING, "28 deg"),
    ]
    more = [
        bed(start, one, phi, kind)
        for start in (REST, MOVING)
        for phi, kind in (("30 deg", "flat"), ("20 deg", "random"), ("40 deg", "random"))
        for one in SLOPES[start]
    ]
    every = plan.pick([SHIPPED], [*both, *angles], [*both, *angles, *finer, *more])
    return list({tuple(one.items()): one for one in every}.values())


def _run(chosen: Mapping[str, str], seed: int, rotation: str = "free") -> CaseRun:
    changed = {
        "timeline.0.friction_angle": chosen[PHI],
        "timeline.1.rotation": rotation,
        "timeline.2.slope_angle": PUSH if chosen[START] == MOVING else chosen[SLOPE],
        "timeline.3.slope_angle": chosen[SLOPE],
        "build.bed": chosen[BED],
    }
    shipped = ("30 deg", "free", "21 deg", "21 deg", "random")
    kept = {key: text for (key, text), old in zip(changed.items(), shipped, strict=True) if text != old}
    return paper_run("bed18", kept, seed)


def _control(name: str, seed: int) -> CaseRun:
    slope, rotation = CONTROLS[name]
    return _run(SHIPPED | {SLOPE: slope, START: MOVING}, seed, rotation)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Every setting and seed, and the controls with one seed."""
    runs = [_run(one, seed) for one in settings(plan) for seed in plan.seeds]
    controls = [_control(name, plan.seeds[0]) for name in plan.pick((), tuple(CONTROLS))]
    return list(dict.fromkeys([*runs, *controls]))


def measure(run: Results, one: CaseRun) -> TiltedBedRun:
    """Mean motion along the bed and the last moment."""
    del one
    return TiltedBedRun(
        t=np.asarray(run.frames.t),
        v=np.asarray(run.frames.v[:])[:, :, 0].mean(axis=1),
        x=np.asarray(run.frames.x[:])[:, :, 0].mean(axis=1),
        d=float(run.scene.d.mean()),
        g=float(np.linalg.norm(run.scene.gravity)),
        last=snapshot(run),
    )


def flattest(found: Found, plan: Plan, start: str) -> float:
    """Flattest slope on which every seed flows, as shipped otherwise [deg]; inf if none does."""
    good = [
        _degrees(one[SLOPE])
        for one in settings(plan)
        if one == SHIPPED | {SLOPE: one[SLOPE], START: start}
        and all(_flows(found[_run(one, seed)]) for seed in plan.seeds)
    ]
    return min(good, default=math.inf)


def _degrees(text: str) -> float:
    return float(text.split(maxsplit=1)[0])


def _flows(flow: TiltedBedRun) -> bool:
    return flow.speed() > FLOWS and flow.keeps > KEEPS


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """It flows: fast enough, and not dying."""
    trials: list[Trial] = []
    for one in settings(plan):
        slope = one[SLOPE]
        if _degrees(slope) < HEAP + TOLD:
            continue
        runs: list[TiltedBedRun] = [found[_run(one, seed)] for seed in plan.seeds]
        flowing = sum(_flows(run) for run in runs)
        decided = True if flowing == len(runs) else None if flowing else False
        chosen = {name: value for name, value in one.items() if name != SLOPE}
        speed = over_range([run.speed() for run in runs], "-", f"{len(runs)} seeds")
        note = "" if flowing in (0, len(runs)) else f"flows with {flowing} of {len(runs)} seeds"
        part = f"mean speed over sqrt(g d), last 0.3 s, slope {slope}"
        trials.append(Trial(part, chosen, speed, MOVES, decided, note))
    also: list[str] = []
    for start in plan.pick((), (REST, MOVING)):
        angle = flattest(found, plan, start)
        words = f"{angle:g} deg" if math.isfinite(angle) else "none of those tried"
        also.append(
            f"lowest slope that flows {start}, friction angle {SHIPPED[PHI]}, all seeds: {words}; the "
            f"paper's heap with rotation free ends at {HEAP:g} deg"
        )
    for name in plan.pick((), tuple(CONTROLS)):
        flow: TiltedBedRun = found[_control(name, plan.seeds[0])]
        also.append(
            f"{PUSH} until 0.45 s, then {name}: at most {short(flow.most)} sqrt(g d), "
            f"{short(flow.speed())} at the end"
        )
    return (
        Finding(
            "bed18",
            tuple(trials),
            "There are two angles: a bed at rest, here as dense as grains settle without friction, must "
            "first break its packing, while a moving bed continues to flow at a lower slope. A collapsing "
            f"heap stops near the second angle. {_words(found, plan)}",
            {
                "bed": "200 grains, 10 layers, sizes +-20 %, dry",
                "k_n": "100 N/cm",
                "rotation": "free",
                SLIP: "spring",
                RATIO: "2/7",
            },
            also=tuple(also),
        ),
    )


def _words(found: Found, plan: Plan) -> str:
    """Both angles, where slopes were tried for them."""
    if plan.level == "quick":
        return "From one slope tried from rest neither angle follows."
    words = [f"{start} from {flattest(found, plan, start):g} deg" for start in (REST, MOVING)]
    return f"Of the slopes tried, all seeds flow {' and '.join(words)}."


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    named = [(one, "free", seed, _run(one, seed)) for one in settings(plan) for seed in plan.seeds]
    for name in plan.pick((), tuple(CONTROLS)):
        slope, rotation = CONTROLS[name]
        named.append(
            (SHIPPED | {SLOPE: slope, START: MOVING}, rotation, plan.seeds[0], _control(name, plan.seeds[0]))
        )
    return [
        {
            **one,
            "rotation": rotation,
            "seed": seed,
            "speed": found[run].speed(),
            "speed_before": found[run].speed(LAST),
            "keeps": found[run].keeps,
        }
        for one, rotation, seed, run in named
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Speed over time for each slope, by start, and the bed at the end of the fastest run."""
    panels: dict[str, dict[str, tuple[Floats, Floats]]] = {}
    seed = plan.seeds[0]
    shown = [one for one in settings(plan) if one == SHIPPED | {SLOPE: one[SLOPE], START: one[START]}]
    for one in sorted(shown, key=lambda one: one[SLOPE]):
        flow: TiltedBedRun = found[_run(one, seed)]
        panels.setdefault(one[START], {})[one[SLOPE]] = (flow.t, flow.v)
    if plan.pick(False, True):
        for name in CONTROLS:
            flow = found[_control(name, seed)]
            panels[MOVING][name] = (flow.t, flow.v)
    fastest: TiltedBedRun = max((found[_run(one, seed)] for one in shown), key=lambda flow: flow.speed())
    note = f"friction angle {SHIPPED[PHI]}, tilted at 0.3 s (once moving: {PUSH} until 0.45 s)"
    return {
        "bed18": speeds(panels, fastest.d, FLOWS, fastest.g, note),
        "bed18-snapshot": draw_snapshot(fastest.last, "speed"),
    }
