"""Debris flows in a row of columns: growth, erosion, where they stop, grids, impact (design/0028)."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.laws.debris import discharge_over_bed, equilibrium_concentration, run_out
from ryusa.measure.along_row import grains_along_row
from ryusa.measure.long_section import bed_line, long_section, row_of
from ryusa.model.arrays import Floats
from ryusa.model.feeds import IN
from ryusa.results import Results
from ryusa.results.water import WaterFrames
from ryusa.study import CaseRun, Finding, Found, Level, Plan, Task, Trial, case_run
from ryusa_studies.validation import river_grids as grids
from ryusa_studies.validation import river_impact as impact
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.equilibrium import stopping

TITLE = "Debris flows in a row of columns"
DECLARED = declared(__file__)
SEEDS = (1, 2)
BED, FEED, FRICTION = "debris_bed", "debris_feed", "friction_angle"
RHO_S, RHO_W, G = 2650.0, 1000.0, 9.80665  # of the case files [kg/m3], [m/s2]
# The grains of all these cases, for the dry flow that tells their friction.
GRAINS: Mapping[str, str] = {
    "grains.diameter": "8 mm", "grains.spread": "0.2", "contact.stiffness": "200 N/cm",
    "contact.restitution": "0.5", "contact.friction_angle": "35 deg",
    "rolling.model": "spring-dashpot-slider", "rolling.arm": "reduced radius", "rolling.coefficient": "0.15",
    "build.length": "7.2 cm", "build.width": "4.5 cm",
}  # fmt: skip
# Of debris_bed: where the discharge is taken [m], heights between which the concentration of the bed is [m],
# and how long after the front the mean begins [s]
GROWN, CORE, BEHIND = 0.9, (0.008, 0.02), 0.3
# Of debris_feed: the break, the reach above it where the flow is measured [m], and for how long [s]
BREAK, ABOVE, FLOW = 0.7, (0.55, 0.65), 0.8
STEEP, GENTLE = math.radians(18.0), math.radians(3.0)
ARRIVED = 0.4  # volume per area with which the grains have arrived, in diameters
THICK = 2.0  # least thickness of a deposit, in diameters: ridges hold single grains
# Mixtures that are fed to debris_bed on a gentler slope [deg], below and above equilibrium: grains per time.
# The reach in which its bed is watched [m], and since when after the feed has begun [s]
SLOPE, RATES = 10.0, {"below": "0.08 kg/s", "above": "1.2 kg/s"}
REACH, SINCE = (0.25, 0.6), 0.6


def _friction(seed: int) -> CaseRun:
    return case_run(case_path("validation/friction_angle.toml"), GRAINS, seed=seed)


def _bed(seed: int) -> CaseRun:
    return case_run(case_path("validation/debris_bed.toml"), seed=seed)


def _mixture(side: str) -> CaseRun:
    """Grains and water that enter over a bed at a gentler slope."""
    feeder = (
        '[{ name = "feeder", low = ["3 cm", "0 cm", "5 cm"], high = ["20 cm", "3.2 cm", "8 cm"], begin = '
        f'"0.4 s", velocity = ["0.8 m/s", "0 m/s", "0 m/s"], rate = "{RATES[side]}" }}]'
    )
    gentler = {"motion.slope_angle": f"{SLOPE:g} deg", "feeds": feeder, "stop.time": "1.8 s"}
    return case_run(case_path("validation/debris_bed.toml"), gentler, seed=SEEDS[0])


def _feed(seed: int) -> CaseRun:
    return case_run(case_path("validation/debris_feed.toml"), seed=seed)


def tasks(plan: Plan) -> Sequence[Task]:
    """Two seeds of each flow, at the full level alone: three minutes each and more."""
    if plan.level is not Level.FULL:
        return []
    flows = [one(seed) for seed in SEEDS for one in (_friction, _feed, _bed)]
    return [*flows, *grids.tasks(), *(_mixture(side) for side in RATES), *impact.tasks()]


def measure(run: Results, one: CaseRun) -> Mapping[str, Floats | float]:
    """Friction of a dry flow, growth over a bed or its rise, a front's way or force, what a grid holds."""
    if one.case == BED:
        return risen(run) if one.get("feeds") else grown(run)
    of_case = {FRICTION: stopping, FEED: stopped, grids.GRID: grids.held_back, impact.CASE: impact.struck}
    return of_case[one.case](run)


def grown(run: Results) -> dict[str, Floats]:
    """Discharge of a flow over its bed, and that of the balance of grains and water.

    Returns
    -------
    Means of the window, `BEHIND` after the front has come to `GROWN`, until the end: water that enters `q_0`,
    water and grains that pass, `q` [m2/s], their concentration `c`, that of the bed `c_star` [-]; and over
    the times `t` [s] the discharge `series` [m2/s].
    """
    found = row_of(run)
    row, t = found.row, found.t
    settle = float(run.case["record"]["settle"])
    frames = np.arange(len(t))
    k = int(np.argmin(np.abs(t - settle)))
    grains = grains_along_row(run, row, frames).passed
    at = int(np.argmin(np.abs(row.x_station - GROWN)))
    both = grains[:, at] + found.passed[:, at]
    rate = _rates(t, both)
    high, low = float(rate[k:].max()), float(rate[k - 5 : k].mean())
    come = k + int(np.flatnonzero(rate[k:] > 0.5 * (high + low))[0])
    first = int(np.searchsorted(t, t[come] + BEHIND))
    if first > len(t) - 10:
        raise ValueError(f"the front comes to {GROWN:g} m at {t[come]:.3g} s, too late for a mean")
    time = float(t[-1] - t[first])
    q = float(both[-1] - both[first]) / time
    return {
        "t": t, "series": rate, "q": np.array(q), "first": np.array(t[first]),
        "q_0": np.array(float(found.passed[-1, 0] - found.passed[first, 0]) / time),
        "c": np.array(float(grains[-1, at] - grains[first, at]) / time / q),
        "c_star": np.array(_core(found, k)),
    }  # fmt: skip


def risen(run: Results) -> dict[str, Floats]:
    """Concentration that is fed, and how fast the bed rises below the feeder.

    Returns
    -------
    From `SINCE` after the begin of the feed until the end: `c` of what enters [-], the `rise` per time of
    the bed in `REACH`, by the volume of grains there and the concentration of the bed, `c_star` [-]; [m/s];
    and over the times `t` [s] that rise since the begin of the feed, `series` [m].
    """
    found = row_of(run)
    row, t = found.row, found.t
    k = int(np.argmin(np.abs(t - float(run.case["record"]["settle"]))))
    first = int(np.searchsorted(t, t[k] + SINCE))
    reach = (row.x > REACH[0]) & (row.x < REACH[1])
    held = grains_along_row(run, row, np.arange(len(t)))
    c_star = _core(found, k)
    volume = held.volume[:, reach].mean(axis=1)
    rows = run.passages
    steps = np.asarray(run.frames.step)
    came = (rows["way"] == IN) & (rows["step"] > steps[first])
    grains = float(rows["m"][came].sum()) / RHO_S / held.width
    water = float(found.passed[-1, 0] - found.passed[first, 0])
    return {
        "t": t, "series": (volume - volume[k]) / c_star, "c_star": np.array(c_star),
        "c": np.array(grains / (grains + water)),
        "rise": np.array(float(volume[-1] - volume[first]) / c_star / float(t[-1] - t[first])),
    }  # fmt: skip


def _rates(t: Floats, passed: Floats) -> Floats:
    """Derivative of what passed over five frames [m2/s], shape as t."""
    smooth = np.convolve(np.pad(passed, 2, mode="edge"), np.full(5, 0.2), mode="valid")
    return np.gradient(smooth, t)


def _core(found: WaterFrames, k: int) -> float:
    """Mean concentration within the bed [-] in frame k."""
    row = found.row
    z = row.column.z - row.column.z_low
    along, high = (row.x > 0.2) & (row.x < GROWN), (z > CORE[0]) & (z < CORE[1])
    return float(found.phi[k][along][:, high].mean())


def stopped(run: Results) -> dict[str, Floats]:
    """Speed, depth and concentration above a break, and the foot of the deposit behind it.

    Returns
    -------
    `u` [m/s], `h` [m] and `c` [-], means over `FLOW` since the grains have come to the reach `ABOVE` the
    break, at `came` [s]; for comparison the mean speed of the grains there, `grains` [m/s], and the
    concentration over the whole depth in the 15 cm behind the break at the end of that time, `behind` [-];
    the `foot` of the deposit behind it [m] over the times `t` [s].
    """
    found = row_of(run)
    row, t, d = found.row, found.t, run.scene.d_mean
    frames = np.arange(len(t))
    reach = (row.x > ABOVE[0]) & (row.x < ABOVE[1])
    along = grains_along_row(run, row, frames)
    held = along.volume[:, reach].mean(axis=1)
    came = float(t[np.flatnonzero(held > ARRIVED * d)[0]])
    flow = long_section(run, bed="rest", begin=came, end=came + FLOW)
    beds = bed_line(run, found, frames, "packed") - found.floor
    foot = np.array([_foot(row.x, one, THICK * d) for one in beds])
    means = {
        key: np.array(float(getattr(flow, name)[reach].mean()))
        for key, name in (("u", "speed"), ("h", "depth"), ("c", "concentration"))
    }
    after = (row.x > BREAK) & (row.x < 2.0 * BREAK - ABOVE[0])
    k = int(np.argmin(np.abs(t - came - FLOW)))
    means["behind"] = np.array(float((along.volume[k] / found.depth[k])[after].mean()))
    means["grains"] = np.array(float(flow.solid_discharge[reach].mean() / flow.volume[reach].mean()))
    return {"t": t, "foot": foot, "came": np.array(came), **means}


def _foot(x: Floats, thick: Floats, least: float) -> float:
    """How far behind the break a deposit of that thickness goes on without a gap [m]; 0 if there is none."""
    first = int(np.searchsorted(x, BREAK))
    thin = np.flatnonzero(thick[first:] < least)
    if not len(thin) or thin[0] == 0:
        return 0.0 if len(thin) else float(x[-1] - BREAK)
    k = first + int(thin[0]) - 1
    part = (thick[k] - least) / (thick[k] - thick[k + 1])
    return float(x[k] + part * (x[k + 1] - x[k]) - BREAK)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Each flow beside its balance."""
    if plan.level is not Level.FULL:
        return []
    return [_growth(found), _stop(found), grids.of_grids(found), _sign(found), impact.of_front(found)]


def _growth(found: Found) -> Finding:
    """Discharge over the bed."""
    runs = [found[_bed(seed)] for seed in SEEDS]
    numbers = [{key: float(one[key]) for key in ("q", "q_0", "c", "c_star", "first")} for one in runs]
    laws = [discharge_over_bed(one["q_0"], one["c"], one["c_star"]) for one in numbers]
    ratios = [one["q"] / law for one, law in zip(numbers, laws, strict=True)]
    worst = max(ratios, key=lambda ratio: abs(ratio - 1.0))
    t = runs[0]["t"]
    said = "; ".join(
        f"water that enters {1e4 * one['q_0']:.0f} cm2/s, water and grains that pass {1e4 * one['q']:.0f}, "
        f"by the balance {1e4 * law:.0f}, c {one['c']:.3f}, c_star {one['c_star']:.3f}"
        for one, law in zip(numbers, laws, strict=True)
    )
    window = np.linspace(numbers[0]["first"], t[-1], 41)
    inner = slice(2, -3)  # whole five frames
    return DECLARED["growth"].finding(
        [Curve("water and grains", t[inner], runs[0]["series"][inner])],
        [Curve("balance, mean of the window", window, np.full(41, laws[0]))], {"discharge": worst},
        ratios=', '.join(f'{one:.3f}' for one in ratios), said=said,
    )  # fmt: skip


def _stop(found: Found) -> Finding:
    """Way of the front behind the break."""
    friction = _tan_alpha(found)
    runs = [found[_feed(seed)] for seed in SEEDS]
    laws = [_way(float(one["u"]), one, friction) for one in runs]
    slower = [_way(float(one["grains"]), one, friction) for one in runs]
    ways = [float(one["foot"][-1]) for one in runs]
    ratios = [measured / way for measured, (way, _) in zip(ways, laws, strict=True)]
    of_grains = [measured / way for measured, (way, _) in zip(ways, slower, strict=True)]
    worst = max(ratios, key=lambda ratio: abs(ratio - 1.0))
    one, (way, time) = runs[0], laws[0]
    since = np.linspace(0.0, min(time, 2.0), 41)
    begin = float(one["came"]) + (BREAK - sum(ABOVE) / 2.0) / float(one["u"])
    said = "; ".join(
        f"u {float(each['u']):.2f} m/s, h {100.0 * float(each['h']):.1f} cm, c {float(each['c']):.3f}, x_L "
        f"{law:.2f} m, measured {measured:.2f} m; grains alone {float(each['grains']):.2f} m/s, c behind the "
        f"break {float(each['behind']):.2f}"
        for each, (law, _), measured in zip(runs, laws, ways, strict=True)
    )
    return DECLARED["stop"].finding(
        [Curve("front", one["t"], one["foot"])],
        [Curve("momentum", begin + since, way * (1.0 - (1.0 - since / time) ** 2))],
        {"way": worst, "of-grains": float(np.mean(of_grains))}, friction=friction,
        ratios=', '.join(f'{ratio:.3f}' for ratio in ratios), said=said,
    )  # fmt: skip


def _way(u: float, one: Mapping[str, Floats], friction: float) -> tuple[float, float]:
    """Way of the front [m] and time until it stops [s] at a speed u [m/s], by its depth and concentration."""
    return run_out(u, float(one["h"]), float(one["c"]), STEEP, GENTLE, friction, RHO_S, RHO_W, G)


def _sign(found: Found) -> Finding:
    """Whether the bed is eroded below the concentration of equilibrium, and rises above it."""
    friction = _tan_alpha(found)
    c_eq = equilibrium_concentration(math.radians(SLOPE), math.atan(friction), RHO_S, RHO_W)
    runs = {side: found[_mixture(side)] for side in RATES}
    errors = list[Trial]()
    for side, one in runs.items():
        errors.append(DECLARED["sign"].trial(f"rise-{side}", float(one["rise"])))
        errors.append(DECLARED["sign"].trial(f"c-{side}", float(one["c"]) / c_eq))
    curves = [Curve(side, one["t"], one["series"]) for side, one in runs.items()]
    fed = ", ".join(f"{float(one['c']):.3f}" for one in runs.values())
    return DECLARED["sign"].finding(curves, [], errors, c_eq=c_eq, friction=friction, fed=fed)


def _tan_alpha(found: Found) -> float:
    """Friction of a dry flow of the same grains that comes to rest, mean over the seeds [-]."""
    return float(np.mean([float(found[_friction(seed)]["friction"]) for seed in SEEDS]))
