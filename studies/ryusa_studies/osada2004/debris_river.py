"""Open question i of the paper: flow and deposition of a debris flow at the scale of a real river."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures.comparison import Axis, Curve, compared
from ryusa.measure import front
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.study import Finding, Trial, exact, over_seeds, seeds_trial
from ryusa_studies.osada2004._bands import band
from ryusa_studies.osada2004._factors import design
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CaseRun, Found, Plan, paper_run

FIGURE = "debris-river"
TITLE = "A debris flow at the scale of a river, with deposition"
CLAIMS = ("debris-river", "debris-river-time")
CASE = "debris_river"
LONG, SHORT = "0.01 s", "0.001 s"  # collision times of d = 20 cm, Eq. (8)
DESIGN = design("debris_river")
BREAK = 25.0  # where the slope changes [m]
STRETCH = 27.5, 40.0  # between which the speed of the front is taken [m]
STABLE = 0.001, 0.01  # overlaps over d that the paper calls stable [-]
REST = 0.1  # speed over sqrt(g d) below which a grain is at rest [-]
GRAVITY = 9.8  # [m/s2]
REST_PART = "share of the grains past the break that are at rest at the end"
OVERLAP_PART = "largest overlap over d, mean over contacts"
WAY_PART = "way of the front past the break, collision time 0.01 s over 0.001 s"
STAYED_PART = "grains at rest past the break, collision time 0.01 s over 0.001 s"
NOTHING = "no grain comes to rest past the break in some run: nothing to compare with"


@dataclass(frozen=True)
class River:
    """One run.

    Attributes
    ----------
    past : grains that are past the break at the end, or have left.
    at_rest : of them, those that are there and at rest.
    overlap : largest overlap over d, mean over contacts of the tracked grains after settling [-].
    below, above : shares of those contacts with overlaps below and above what the paper calls stable [-].
    t, front : times of the frames [s] and place beyond which 5 % of the volume that has moved is [m].
    speed : mean speed of that front over STRETCH [m/s]; nan where it does not come so far.
    """

    past: int
    at_rest: int
    overlap: float
    below: float
    above: float
    t: Floats
    front: Floats
    speed: float

    @property
    def share(self) -> float:
        """At rest, of the grains past the break [-]; nan without any."""
        return self.at_rest / self.past if self.past else math.nan

    @property
    def way(self) -> float:
        """Way of the front past the break at the end [m]."""
        return float(self.front[-1]) - BREAK


settings = DESIGN.sets


def paired(plan: Plan) -> list[dict[str, str]]:
    """Sets for which both collision times are run; few, as the short one takes ten times as many steps."""
    return DESIGN.settings(plan.pick(0, 0, 4))


def run(chosen: Mapping[str, str], time: str, seed: int) -> CaseRun:
    """One run of the case; what is as shipped is not said."""
    changed = DESIGN.overrides(chosen)
    if time != LONG:
        changed["contact.stiffness"] = f'{{ collision_time = "{time}" }}'
    return paper_run(CASE, changed, seed)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """The long collision time for every setting and seed, the short one for some of these settings."""
    long = [run(one, LONG, seed) for one in settings(plan) for seed in plan.seeds]
    return [*long, *(run(one, SHORT, seed) for one in paired(plan) for seed in plan.seeds)]


def measure(results: Results, one: CaseRun) -> River:
    """What has come to rest past the break, the front, and the overlaps."""
    del one
    scene, settle = results.scene, float(results.case["record"]["settle"])
    x, v = (np.asarray(of[-1], dtype=np.float64) for of in (results.frames.x, results.frames.v))
    there = np.isfinite(x[:, 0])
    still = np.linalg.norm(np.where(there[:, None], v, 0.0), axis=1) < REST * math.sqrt(
        GRAVITY * scene.d_mean
    )
    past = there & (np.where(there, x[:, 0], 0.0) > BREAK)
    contacts = results.contacts
    overlaps = contacts["overlap_max"][contacts["t_part"] > settle] / scene.d_mean
    moving = front(results)
    begin, end = (np.flatnonzero(moving.front > at) for at in STRETCH)
    speed = math.nan
    if len(end) and end[0] > begin[0]:
        way = moving.front[end[0]] - moving.front[begin[0]]
        speed = float(way / (moving.t[end[0]] - moving.t[begin[0]]))
    return River(
        int(past.sum() + (~there).sum()),
        int((past & still).sum()),
        _mean(overlaps),
        _mean((overlaps < STABLE[0]).astype(np.float64)),
        _mean((overlaps > STABLE[1]).astype(np.float64)),
        moving.t,
        moving.front,
        speed,
    )


def _mean(values: Floats) -> float:
    return float(values.mean()) if len(values) else math.nan


def _runs(found: Found, plan: Plan, chosen: Mapping[str, str], time: str) -> list[River]:
    return [found[run(chosen, time, seed)] for seed in plan.seeds]


def _trial(claim: str, part: str, chosen: Mapping[str, str], values: Sequence[float]) -> Trial:
    """Mean over seeds; without a number where some run has none."""
    limits = band(claim, part)
    if all(map(math.isfinite, values)):
        return seeds_trial(part, chosen, values, limits)
    return Trial(part, chosen, exact(math.nan, limits.unit), limits, note=NOTHING)


def _alone(found: Found, plan: Plan, part: str, value: Callable[[River], float]) -> list[Trial]:
    """One part with the long collision time, under every setting."""
    return [
        _trial(CLAIMS[0], part, one, [value(river) for river in _runs(found, plan, one, LONG)])
        for one in settings(plan)
    ]


def _pairs(found: Found, plan: Plan, part: str, value: Callable[[River, River], float]) -> list[Trial]:
    """One part of the long over the short collision time, by seed."""
    trials: list[Trial] = []
    for one in paired(plan):
        both = zip(*(_runs(found, plan, one, time) for time in (LONG, SHORT)), strict=True)
        trials.append(_trial(CLAIMS[1], part, one, [value(long, short) for long, short in both]))
    return trials


def _ways(long: River, short: River) -> float:
    return long.way / short.way if short.way > 0.0 else math.nan


def _stayed(long: River, short: River) -> float:
    return long.at_rest / short.at_rest if short.at_rest else math.nan


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Whether grains come to rest, with overlaps that are stable; whether the collision time matters."""
    first = settings(plan)[0]
    numbers: Mapping[str, tuple[str, Callable[[River], float]]] = {
        "speed of the front from 27.5 to 40 m": ("m/s", lambda one: one.speed),
        "its way past the break": ("m", lambda one: one.way),
        "share at rest": ("-", lambda one: one.share),
        "overlap over d": ("-", lambda one: one.overlap),
        f"share of contacts above {STABLE[1]:g} d": ("-", lambda one: one.above),
        f"and below {STABLE[0]:g} d": ("-", lambda one: one.below),
    }
    also = tuple(
        f"collision time {time}, as shipped: "
        + ", ".join(
            f"{name} {over_seeds([value(one) for one in _runs(found, plan, first, time)], unit)}"
            for name, (unit, value) in numbers.items()
        )
        for time in (LONG, SHORT)
    )
    runs = [
        *_alone(found, plan, REST_PART, lambda one: one.share),
        *_alone(found, plan, OVERLAP_PART, lambda one: one.overlap),
    ]
    pairs = [*_pairs(found, plan, WAY_PART, _ways), *_pairs(found, plan, STAYED_PART, _stayed)]
    return (finding("debris-river", runs, also=also), finding("debris-river-time", pairs, also=also))


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    return [
        {
            **chosen, "collision time": time, "seed": seed, "past_break": one.past, "at_rest": one.at_rest,
            "overlap_over_d": one.overlap, "share_below_band": one.below, "share_above_band": one.above,
            "way_past_break_m": one.way, "front_speed_m_per_s": one.speed,
        }
        for time, sets in ((LONG, settings(plan)), (SHORT, paired(plan)))
        for chosen in sets
        for seed, one in zip(plan.seeds, _runs(found, plan, chosen, time), strict=True)
    ]  # fmt: skip


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Front over time with both collision times."""
    first, seed = settings(plan)[0], plan.seeds[0]
    curves = [
        Curve(f"collision time {time}", one.t, one.front)
        for time in (LONG, SHORT)
        for one in [found[run(first, time, seed)]]
    ]
    return {"debris-river": compared(Axis("time", "s"), Axis("front", "m"), curves, [])}
