"""What long contacts do to a flow: a series over the collision time at one restitution."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ryusa.figures.comparison import Axis, Curve, compared
from ryusa.measure import collisions, companions, profiles
from ryusa.results import Results
from ryusa.study import Finding, Trial, over_seeds, short
from ryusa_studies.osada2004 import _debris, fig18
from ryusa_studies.osada2004._debris_run import concentration
from ryusa_studies.osada2004._findings import finding
from ryusa_studies.osada2004._parts import CLOSURE, CaseRun, Found, Plan, paper_run

FIGURE = "long-contacts"
TITLE = "Speed, flux and paths against collision time, overlap and way during a contact"
CLAIMS = ("long-contacts",)
FLOW, LONGER = "flow", "contacts longer by"
AVALANCHE = "dry avalanche"
# The debris flow of fig17 under some closures of the water, by the name of the closure.
CLOSURES = (
    "Li-Sawamoto over a rough bed",
    "eddies in pores, k_f 0.16",
    "parabolic mixing length",
    "no wall law, drag of the fixed grains",
)
TIMES = ("1", "3", "10", "30")  # times those of fig17, about 0.06 ms
# Collision times of the avalanche by how many times 0.0001 s they are; the last is the case as it ships.
FALLS: dict[str, dict[str, str]] = {
    "1": {"contact.stiffness": '{ collision_time = "0.0001 s" }'},
    "10": {"contact.stiffness": '{ collision_time = "0.001 s" }'},
    "100": {},
}
SECOND = (2.0, 3.0)  # window of the avalanche: the second second after it tilts [s]
STABLE = 0.01  # overlap over d up to which the paper calls springs stable


@dataclass(frozen=True)
class LongContacts:
    """One run in its window.

    Attributes
    ----------
    time : mean collision time [s].
    overlap : largest overlap over d, mean over contacts [-].
    closing : closing speed at first touch over the mean speed along the bed [-].
    along : way along the bed during a contact over d: u t/d [-].
    speed, q : mean speed along the bed [m/s]; flux per width [m2/s].
    phi : concentration, mean over the height that holds 95 % of the grains [-].
    steep : root mean square of the vertical speed over the mean speed along the bed [-].
    companions : correlation of the speeds of grains that touch [-].
    """

    time: float
    overlap: float
    closing: float
    along: float
    speed: float
    q: float
    phi: float
    steep: float
    companions: float


Value = Callable[[LongContacts], float]
SHOWN: Mapping[str, tuple[str, Value]] = {
    "mean collision time": ("s", lambda one: one.time),
    "largest overlap over d, mean over contacts": ("-", lambda one: one.overlap),
    "way along the bed during a contact over d": ("-", lambda one: one.along),
    "closing speed over speed along the bed": ("-", lambda one: one.closing),
    "speed along the bed": ("m/s", lambda one: one.speed),
    "flux": ("m2/s", lambda one: one.q),
    "concentration": ("-", lambda one: one.phi),
    "vertical speed over speed along the bed": ("-", lambda one: one.steep),
    "correlation of the speeds of grains that touch": ("-", lambda one: one.companions),
}


def settings(plan: Plan) -> list[dict[str, str]]:
    """Flows and collision times; the debris flow as shipped with its longest contacts first."""
    sets = [{FLOW: flow, LONGER: longer} for flow in CLOSURES for longer in reversed(TIMES)]
    sets += [{FLOW: AVALANCHE, LONGER: longer} for longer in reversed(FALLS)]
    return plan.pick([sets[0], sets[len(TIMES) - 1]], sets)


def run(chosen: Mapping[str, str], seed: int) -> CaseRun:
    """One run of a flow."""
    if chosen[FLOW] == AVALANCHE:
        return paper_run("avalanche", FALLS[chosen[LONGER]], seed)
    debris = {**fig18.SHIPPED, CLOSURE: chosen[FLOW]}
    if chosen[LONGER] == TIMES[0]:
        return _debris.run(debris, seed)
    return fig18.run({**debris, LONGER: chosen[LONGER]}, seed)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Every flow, collision time and seed."""
    return [run(one, seed) for one in settings(plan) for seed in plan.seeds]


def measure(results: Results, one: CaseRun) -> LongContacts:
    """Numbers of one run in its window."""
    begin, end = SECOND if one.case == "avalanche" else (None, math.inf)
    profile = profiles(results, begin, end, above="mean crest", bed=True)
    first, last = np.searchsorted(np.asarray(results.frames.t), (float(profile.t[0]), float(profile.t[-1])))
    z = np.asarray(results.frames.x[first : last + 1], dtype=np.float64)[:, :, 2] - profile.origin
    v_z = np.asarray(results.frames.v[first : last + 1], dtype=np.float64)[:, :, 2]
    touch = collisions(results, settle=begin, end=end)
    averages = touch.averages if len(touch.events) else None
    speed = float(profile.speed.mean())
    time, overlap, closing = (
        math.nan if averages is None else averages[name].value
        for name in ("duration", "overlap_over_d", "closing_speed")
    )
    return LongContacts(
        time=time,
        overlap=overlap,
        closing=closing / speed,
        along=speed * time / profile.d,
        speed=speed,
        q=float(profile.q.mean()),
        phi=concentration(profile, 0.0, float(np.quantile(z, 0.95))),
        steep=float(np.sqrt((v_z**2).mean())) / speed,
        companions=companions(results, begin, end),
    )


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Nothing is judged: every number for every flow and collision time."""
    tried = [
        Trial(part, one, over_seeds([value(run_) for run_ in _runs(found, plan, one)], unit), None)
        for part, (unit, value) in SHOWN.items()
        for one in settings(plan)
    ]
    return (
        finding("long-contacts", tried, also=[_words(found, plan, flow) for flow in _flows(plan)]),
    )  # fmt: skip


def _flows(plan: Plan) -> list[str]:
    return list(dict.fromkeys(one[FLOW] for one in settings(plan)))


def _runs(found: Found, plan: Plan, chosen: Mapping[str, str]) -> list[LongContacts]:
    return [found[run(chosen, seed)] for seed in plan.seeds]


def _series(found: Found, plan: Plan, flow: str, value: Value) -> np.ndarray:
    """Mean over seeds for every collision time of a flow, the shortest first."""
    sets = [one for one in settings(plan) if one[FLOW] == flow]
    means = [np.mean([value(one) for one in _runs(found, plan, chosen)]) for chosen in sets]
    return np.array(means, dtype=np.float64)[::-1]


def _words(found: Found, plan: Plan, flow: str) -> str:
    """What the longest contacts of a flow change, and the longest that stay within the stable range."""
    series = {name: _series(found, plan, flow, value) for name, (_, value) in SHOWN.items()}
    steep = series["vertical speed over speed along the bed"]
    overlap = series["largest overlap over d, mean over contacts"]
    along = series["way along the bed during a contact over d"]
    speed = series["speed along the bed"]
    stable = [k for k, here in enumerate(overlap) if here <= STABLE]
    within = (
        f"up to an overlap of {STABLE:g} d (u t/d {short(float(along[stable[-1]]))}) they are "
        f"{short(float(steep[stable[-1]] / steep[0]))} times as steep"
        if stable
        else f"even the shortest contacts overlap by more than {STABLE:g} d"
    )
    return (
        f"{flow}: with the longest contacts (overlap {short(overlap[-1])} d, u t/d {short(along[-1])}) paths "
        f"are {short(steep[-1] / steep[0])} times as steep as with the shortest and grains go "
        f"{short(speed[-1] / speed[0])} times as fast; {within}; closing speed "
        f"{short(series['closing speed over speed along the bed'][0])} of the speed along the bed"
    )


def rows(found: Found, plan: Plan) -> list[dict[str, object]]:
    """One line per run."""
    return [
        {**one, "seed": seed, **{name: value(found[run(one, seed)]) for name, (_, value) in SHOWN.items()}}
        for one in settings(plan)
        for seed in plan.seeds
    ]


def draw(found: Found, plan: Plan) -> Mapping[str, Figure]:
    """Paths and speed, as parts of those with the shortest contacts, against overlap and u t/d."""
    across = {
        "overlap": ("largest overlap over d, mean", lambda one: one.overlap),
        "along": ("way during a contact over d, u t/d", lambda one: one.along),
    }
    up = {
        "steep": ("steepness of paths, shortest contacts = 1", lambda one: one.steep),
        "speed": ("speed, shortest contacts = 1", lambda one: one.speed),
    }
    pictures: dict[str, Figure] = {}
    for name, (y_label, y) in up.items():
        for other, (x_label, x) in across.items():
            curves = [
                Curve(flow, _series(found, plan, flow, x), _over_first(_series(found, plan, flow, y)))
                for flow in _flows(plan)
            ]
            pictures[f"long-contacts-{name}-{other}"] = compared(
                Axis(x_label, log=True), Axis(y_label), curves, ()
            )
    return pictures


def _over_first(values: np.ndarray) -> np.ndarray:
    return values / values[0]
