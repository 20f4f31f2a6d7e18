"""A delta grows into a pool: grains kept, speed of its front, and its slope (design/0027)."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.measure.along_row import grains_along_row
from ryusa.measure.long_section import bed_line, row_of
from ryusa.model.arrays import Floats
from ryusa.model.feeds import IN, OUT
from ryusa.results import Results
from ryusa.results.water import WaterFrames
from ryusa.study import CaseRun, Finding, Found, Level, Plan, Task, case_run
from ryusa_studies.validation.declared import NONE, Settings, declared

DECLARED = declared(__file__)

SEEDS = (1, 2)
CASES = DELTA, PILE = "delta", "pile"
BEGIN, END = 30.0, 60.0  # when the deposit has its slope, and the front is short of the outlet [s]
FLAT = 0.635  # where the floor of the pool begins to be level [m]
LAST = 1.1  # frames in which the foot of the front has come farther are left out [m]
THICK = 0.005  # of a deposit on the floor: one diameter [m]
LIP = 0.08  # from the middle of the front upstream to the flux that feeds it [m]
CORE = 0.015, 0.035  # heights between which the concentration of the deposit is taken [m]
FLANK = 0.25, 0.75  # shares of its height between which a slope is fitted


def delta(seed: int, more: Settings = NONE) -> CaseRun:
    """A delta, with settings that differ from its case."""
    return case_run(case_path("delta.toml"), {"stop.time": f"{END:g} s", **more}, seed=seed)


def pile(seed: int) -> CaseRun:
    """A pile of the same grains in still water."""
    return case_run(case_path("validation/pile.toml"), seed=seed)


def tasks(plan: Plan) -> Sequence[Task]:
    """Two deltas and two piles, at the full level alone: an hour and a quarter of an hour each."""
    if plan.level is not Level.FULL:
        return []
    return [one(seed) for seed in SEEDS for one in (delta, pile)]


def measure(run: Results, one: CaseRun) -> dict[str, Floats]:
    """Numbers of a delta or of a pile.

    Returns
    -------
    Of a pile the `angle` of its flanks at the end [deg]. Of a delta, for the frames `t` [s] from BEGIN on in
    which the foot of the front is on the level floor, its middle `front` and where the flux that comes to it
    would have brought it, `expected` [m]; the mean `angle` of the front [deg], of the frames in which two
    segments or more lie in its flank; the `core`, its concentration
    [-]; and `missing`, what feeds brought, less what left and what is there, over what was brought [-].
    """
    found = row_of(run)
    if one.case == PILE:
        beds = bed_line(run, found, np.array([len(found.t) - 1]), "packed")[0]
        flanks = [_slope(beds[::way], found.row.dx) for way in (1, -1)]
        return {"angle": np.array(math.degrees(math.atan(float(np.mean(flanks)))))}
    frames = np.arange(len(found.t))
    beds = bed_line(run, found, frames, "packed")
    held = grains_along_row(run, found.row, frames)
    rise = np.array([_front(found.row.x, line) for line in beds])
    foot = np.array([_foot(found.row.x, line) for line in beds])
    near = np.maximum.accumulate(foot) <= LAST
    on = np.flatnonzero((foot > FLAT + 2.0 * found.row.dx) & (found.t >= BEGIN - 1e-9) & near)
    if len(on) < 20:
        raise ValueError(
            f"the front is on the level floor in {len(on)} frames and comes to {foot.max():.3g} m: it must "
            f"be there in 20 or more, before {LAST:g} m"
        )
    dt = np.diff(found.t)
    rate = np.diff(held.passed, axis=0) / dt[:, None]
    core = _core(found, rise, on)
    moved = [rise[on[0]]]
    for k in on[1:]:
        at = rise[k] - LIP
        flux = float(np.interp(at, found.row.x_station, rate[k - 1]))
        high = float(np.interp(at, found.row.x, beds[k]))
        moved.append(moved[-1] + flux * float(dt[k - 1]) / (high * core))
    slopes = [_slope(beds[k][_reach(found, rise[k])], found.row.dx) for k in on]
    rows, m = run.passages, run.scene.m
    brought = float(rows["m"][rows["way"] == IN].sum())
    there = float(m[np.isfinite(np.asarray(run.frames.x[-1])[:, 0])].sum())
    left = float(rows["m"][rows["way"] == OUT].sum())
    return {
        "t": found.t[on], "front": rise[on], "expected": np.array(moved), "core": np.array(core),
        "angle": np.array(math.degrees(math.atan(float(np.nanmean(slopes))))),
        "missing": np.array(abs(brought - left - there) / brought),
    }  # fmt: skip


def _front(x: Floats, bed: Floats) -> float:
    """Where the deposit comes down through half of its height within twelve segments before its foot [m].

    nan where it does not come on to the level floor.
    """
    if not (last := _end(x, bed)):
        return math.nan
    half = 0.5 * float(bed[last - 12 : last].max())
    k = int(np.flatnonzero(bed[: last + 1] >= half)[-1])
    return float(x[k] + (x[k + 1] - x[k]) * (bed[k] - half) / (bed[k] - bed[k + 1]))


def _end(x: Floats, bed: Floats) -> int:
    """Last segment of the deposit that reaches on to the level floor; 0 where it does not come so far.

    Grains that have rolled ahead lie apart from it.
    """
    first = int(np.searchsorted(x, FLAT))
    bare = np.flatnonzero(bed[first:] < THICK)
    return first + int(bare[0]) - 1 if len(bare) and bare[0] > 0 else 0


def _foot(x: Floats, bed: Floats) -> float:
    """Where the deposit ends on the level floor [m]; 0 where it does not come so far."""
    last = _end(x, bed)
    return float(x[last]) if last else 0.0


def _reach(found: WaterFrames, front: float) -> slice:
    """Segments from before the front to its foot, in the order in which the bed falls."""
    x = found.row.x
    return slice(int(np.searchsorted(x, front - LIP)), int(np.searchsorted(x, front + 1.5 * LIP)))


def _slope(bed: Floats, dx: float) -> float:
    """Slope of the last flank of a line that falls to its end [-], between shares of its height."""
    top = int(np.argmax(bed))
    flank = bed[top:]
    high = float(flank[0] - flank.min())
    inner = (flank - flank.min() > FLANK[0] * high) & (flank - flank.min() < FLANK[1] * high)
    at = np.flatnonzero(inner)
    if len(at) < 2:
        return math.nan
    at = np.arange(at[0], at[-1] + 1)
    return -float(np.polyfit(at * dx, flank[at], 1)[0])


def _core(found: WaterFrames, front: Floats, on: np.ndarray) -> float:
    """Mean concentration within the deposit at the last frame, upstream of its front and over the floor."""
    row, k = found.row, int(on[-1])
    z = row.column.z - row.column.z_low
    along = (row.x > FLAT) & (row.x < front[k] - 0.5 * LIP)
    high = (z > CORE[0]) & (z < CORE[1])
    return float(found.phi[k][along][:, high].mean())


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """The delta beside its balance, and its front beside a pile of the same grains."""
    if plan.level is not Level.FULL:
        return []
    return [finding(found, SEEDS)]


def finding(found: Found, seeds: Sequence[int], more: Settings = NONE, under: str = "") -> Finding:
    """What deltas do beside piles in still water; `under` says in words what settings differ."""
    deltas = [found[delta(seed, more)] for seed in seeds]
    piles = [found[pile(seed)] for seed in seeds]
    ways = [
        float((got["front"][-1] - got["front"][0]) / (got["expected"][-1] - got["front"][0]))
        for got in deltas
    ]
    steeper = [float(a["angle"] - b["angle"]) for a, b in zip(deltas, piles, strict=True)]
    worst_way, worst_angle = max(ways, key=lambda way: abs(way - 1.0)), max(steeper, key=abs)
    one = deltas[0]
    each = ", ".join(f"{float(got['angle']):.1f}" for got in deltas)
    own = ", ".join(f"{float(got['angle']):.1f}" for got in piles)
    return DECLARED["delta"].finding(
        [Curve("front", one["t"], one["front"])], [Curve("front", one["t"], one["expected"])],
        {"missing": max(float(got["missing"]) for got in deltas), "way": worst_way, "angle": worst_angle},
        ways=', '.join(f'{way:.3f}' for way in ways), core=float(one['core']), each=each, own=own,
        seeds=len(seeds), under=under,
    )  # fmt: skip
