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
from ryusa.study import Finding, Trial, short
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import PHI, START, CaseRun, Found, Plan, paper_run
from ryusa_studies.osada2004._shares import share_interval, share_trial

FIGURE = "fig19"
TITLE = "Flow of a tilted dry bed"
CLAIMS = ("bed18",)
SLOPE, SETTLED, COUNTS = "slope (bed18)", "settled (bed18)", "speed that counts (bed18)"
REST, MOVING = "from rest", "once moving"
WITHOUT, WITH = "without friction", "with friction"  # its angle is that of the setting
PUSH = "30 deg"  # slope of the first 0.15 s of a bed that is set moving
FLATTER = "19 deg"
DESIGN = design("bed18")
SLOPES = DESIGN.levels[SLOPE]
TILT = 0.3  # when the bed is tilted [s]
LAST = 0.3  # judged over the last so many seconds, beside as many before
FLOWS = 0.02  # of sqrt(g d), a diameter in 0.7 s
KEEPS = 0.5  # of the speed 0.3 s before; a bed one degree too flat loses 0.4 sqrt(g d) in that time
PART = "share of runs that flow"
MOST = band("bed18", PART)
CONTROLS = {  # slope, rotation of a bed that should stop or stay, both pushed
    "16 deg, rotation free": ("16 deg", "free"),
    "21 deg, rotation locked": ("21 deg", "locked"),
}


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

    def flows(self, limit: float = FLOWS) -> bool:
        """Whether it moves faster than a limit [sqrt(g d)], and not half as fast as 0.3 s before."""
        return self.speed() > limit and self.speed() > KEEPS * self.speed(LAST)


settings = DESIGN.sets


def _run(chosen: Mapping[str, str], seed: int, rotation: str = "free") -> CaseRun:
    changed = DESIGN.overrides({name: level for name, level in chosen.items() if name != SLOPE})
    if chosen[SETTLED] == WITH:
        changed |= {"contact.friction_angle": chosen[PHI]}
    if rotation != "free":
        changed |= {"timeline.1.rotation": rotation}
    slopes = (PUSH if chosen[START] == MOVING else chosen[SLOPE], chosen[SLOPE])
    for k, slope in enumerate(slopes):
        if slope != SLOPES[0]:
            changed |= {f"timeline.{2 + k}.slope_angle": slope}
    return paper_run("bed18", changed, seed)


def _beside(plan: Plan) -> list[dict[str, str]]:
    """Beds from rest, settled without friction and with: a series over the slope, which judges nothing."""
    slopes = plan.pick((), (FLATTER, *SLOPES[:3]))
    return [DESIGN.base | {SETTLED: settled, SLOPE: slope} for settled in (WITHOUT, WITH) for slope in slopes]


def _control(name: str, seed: int) -> CaseRun:
    slope, rotation = CONTROLS[name]
    return _run(DESIGN.base | {SLOPE: slope, START: MOVING}, seed, rotation)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Every setting and seed, the series over the slope, and the controls with one seed."""
    runs = [_run(one, seed) for one in (*settings(plan), *_beside(plan)) for seed in plan.seeds]
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


def _flowing(found: Found, plan: Plan, chosen: Mapping[str, str]) -> list[float]:
    """Whether the bed flows, 1 or 0 for each seed."""
    limit = float(chosen[COUNTS].split(maxsplit=1)[0])
    return [float(found[_run(chosen, seed)].flows(limit)) for seed in plan.seeds]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """It flows: fast enough, and not dying, in most runs."""
    trials = [share_trial(PART, one, _flowing(found, plan, one), 1, MOST) for one in settings(plan)]
    beside = [
        Trial(
            PART,
            {SETTLED: one[SETTLED], SLOPE: one[SLOPE]},
            share_interval(_flowing(found, plan, one), 1),
            None,
        )
        for one in _beside(plan)
    ]
    also: list[str] = []
    for name in plan.pick((), tuple(CONTROLS)):
        flow: TiltedBedRun = found[_control(name, plan.seeds[0])]
        also.append(
            f"{PUSH} until 0.45 s, then {name}: at most {short(flow.most)} sqrt(g d), "
            f"{short(flow.speed())} at the end"
        )
    return (finding("bed18", trials, also=also, beside=beside),)


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    named = [
        (one, "free", seed, _run(one, seed))
        for one in (*settings(plan), *_beside(plan))
        for seed in plan.seeds
    ]
    for name in plan.pick((), tuple(CONTROLS)):
        slope, rotation = CONTROLS[name]
        chosen = DESIGN.base | {SLOPE: slope, START: MOVING}
        named.append((chosen, rotation, plan.seeds[0], _control(name, plan.seeds[0])))
    return [
        {
            **one,
            "rotation": rotation,
            "seed": seed,
            "speed": found[run].speed(),
            "speed_before": found[run].speed(LAST),
        }
        for one, rotation, seed, run in named
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Speed over time for each slope, by packing, and the bed at the end of the fastest run."""
    panels: dict[str, dict[str, tuple[Floats, Floats]]] = {}
    seed = plan.seeds[0]
    shown = _beside(plan) or [DESIGN.base]
    for one in shown:
        flow: TiltedBedRun = found[_run(one, seed)]
        panels.setdefault(f"settled {one[SETTLED]}", {})[one[SLOPE]] = (flow.t, flow.v)
    fastest: TiltedBedRun = max((found[_run(one, seed)] for one in shown), key=lambda flow: flow.speed())
    note = "from rest, friction angle 30 deg, tilted at 0.3 s"
    return {
        "bed18": speeds(panels, fastest.d, FLOWS, fastest.g, note),
        "bed18-snapshot": draw_snapshot(fastest.last, "speed"),
    }
