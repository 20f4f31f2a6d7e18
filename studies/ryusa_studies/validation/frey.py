"""Bed load in a flume one bead wide, against the profiles that Frey 2014 measured."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from io import StringIO

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.measure import profiles, transport
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import (
    CaseRun,
    Finding,
    Found,
    Interval,
    Level,
    Plan,
    Task,
    case_run,
    correlation_time,
    not_negative,
    over_seeds,
    pseudo_values,
    rate_with_rests,
    share_over_runs,
    transformed,
)
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "Bed load in a narrow flume"
D, EXCESS, G, SLOPE = 6.0e-3, 1.5, 9.81, 0.1  # of the case file [m], [-], [m/s2], [rad]
LAYER = 1.0 / 12.0  # of our profiles [d]; the measured ones have 0.065 d
LOW, LEAST = 6.0, 0.01  # heights over the base [d] and concentrations that are compared, from there up
STEP = 0.5  # between the heights of the rms [d]
SETTLE = {Level.STANDARD: 15.0, Level.FULL: 25.0}  # left out: a run begins with loose beads in motion [s]
BEADS = 50  # in the length of our cell
SECOND = 1.0  # over which a rate is averaged to tell rest from motion [s]
REST = 0.01  # of the flume's rate: a single bead in motion carries ten times that
DECLARED = declared(__file__)


@dataclass(frozen=True)
class FlumeRun:
    """What tells one run of the flume from another."""

    depth: str  # of the flow over the base
    layers: str  # of beads


FLUME = {6: FlumeRun("5.3 cm", "7.08"), 14: FlumeRun("5.7 cm", "7.37"), 20: FlumeRun("5.9 cm", "7.30")}


@dataclass(frozen=True)
class Choice:
    """A set of parameters, and the runs it is tried on."""

    words: str
    walls: float  # distance between the side walls that slow the water [mm]
    sampling: str  # its line in SAMPLING
    runs: tuple[int, ...] = (6, 14, 20)
    said: str = ""


# What YADE 2023.02 takes from the water at its side walls was found from its own momentum balance: clear
# water 1.03 cm deep over a smooth bed at 0.56 m/s loses 0.00064 m2/s2 there, where the law it cites gives
# 0.0048 and Blasius with the hydraulic diameter 0.0039. Walls 28 mm apart give the same by Blasius.
CHOICES = {
    "published": Choice(
        "as published", 6.5, "frey/published",
        said="With Blasius friction on smooth walls 6.5 mm apart the water is too slow for the measured "
        "transport: bed load nearly stops. In the code of the source the wall friction is a sixth of "
        "that, see the next set.",
    ),
    "peer": Choice(
        "as published, with the reduced wall friction of the source's code", 28.0, "frey/peer",
        said="By its own momentum balance, the code of the source (YADE 2023.02) has about a sixth of the "
        "wall friction of the law that it cites; Blasius friction on walls 28 mm apart gives the same.",
    ),
}  # fmt: skip
WALLS = (10.0, 16.0, 22.0, 45.0)  # further distances, at the full level [mm]
# The script of the source (validMaurin2015.py and its post-processing, YADE 2023.02) has a cell of 1000 d and
# averages from 30 to 100 s. How long Frey averaged was not found in a source that could be read.
RESTS = (
    "The flow stops and starts. Our cell is 50 beads long and periodic: when all its beads lie still, none "
    "arrives from upstream to move them again. The script of the source averages a cell of 1000 beads from "
    "30 to 100 s, {times:.0f} times what all our runs sample, in which the flow may rest in one place and go "
    "on in another; and beads are supplied to a flume at its inlet (Boehm et al. 2004, same laboratory). The "
    "mean is judged, the rate while in motion is shown beside it."
)


def _runs(choice: Choice, run: int, plan: Plan) -> list[Task]:
    flume, sampling = FLUME[run], SAMPLING[choice.sampling]
    keys = {
        "water.depth": flume.depth, "build.layers": flume.layers,
        "stop.time": f"{sampling.length(plan.level):g} s", "record.settle": f"{SETTLE[plan.level]:g} s",
    }  # fmt: skip
    if choice.walls != CHOICES["published"].walls:
        keys["water.column.side_walls"] = f"{choice.walls:g} mm"
    return [case_run(case_path("validation/frey.toml"), keys, seed=seed) for seed in sampling.seeds(plan)]


def _choices(plan: Plan) -> dict[str, Choice]:
    """Sets of parameters by name, from narrow to wide walls; the full level has more of them."""
    if plan.level is Level.QUICK:
        return {}
    more = {f"walls-{one:g}": Choice(f"walls {one:g} mm apart", one, "frey/walls") for one in WALLS}
    every = {**CHOICES, **(more if plan.level is Level.FULL else {})}
    return dict(sorted(every.items(), key=lambda item: item[1].walls))


def tasks(plan: Plan) -> Sequence[Task]:
    """Several runs of every run of the flume with every set of parameters; none at the quick level."""
    return [
        one for choice in _choices(plan).values() for run in choice.runs for one in _runs(choice, run, plan)
    ]


def measured() -> dict[int, tuple[Floats, Floats, Floats]]:
    """Heights over the base [d], concentration [-] and speed of the beads [m/s] of each run."""
    text = case_path("validation/frey_2014.csv").read_text(encoding="utf-8")
    table = np.genfromtxt(StringIO(text), delimiter=",", comments="#", skip_header=3)
    return {
        run: (rows[:, 1], rows[:, 2], rows[:, 3]) for run in FLUME for rows in [table[table[:, 0] == run]]
    }


def rate(z: Floats, phi: Floats, u: Floats) -> float:
    """Transport rate q_star of a profile [-]; z in diameters, made dimensionless with g cos(slope)."""
    return float(np.trapezoid(phi * u, z)) * D / math.sqrt(EXCESS * G * math.cos(SLOPE) * D**3)


def measure(run: Results, one: CaseRun) -> dict[str, Floats | float]:
    """Profiles of beads and water over the window, and the transport rate of every second."""
    del one
    found = profiles(run, layer=LAYER)
    carried = transport(run, tau_star=math.nan)
    water = run.water
    assert water is not None
    since = np.asarray(water.t) >= found.t[0]
    scale = math.sqrt(EXCESS * G * math.cos(SLOPE) * D**3)
    frames = max(1, round(SECOND / float(carried.dt.mean())))
    seconds = len(carried.q) // frames
    rates = carried.q[: seconds * frames].reshape(seconds, frames).mean(axis=1) / scale
    return {
        "z": found.z / D, "phi": found.phi.value, "u": np.nan_to_num(found.v_x.value),
        "z_water": np.asarray(water.z) / D, "u_water": np.asarray(water.u)[since].mean(axis=0),
        "q_star": float(carried.averages["q"].value) / scale, "rates": rates,
        "time": float(found.t[-1] - found.t[0]),
    }  # fmt: skip


Measured = Mapping[str, Floats | float]


@dataclass(frozen=True)
class FlumeRates:
    """Transport rate of one set of parameters over that of the flume.

    Attributes
    ----------
    single : of each run [-].
    mean : mean over runs with its interval [-].
    rest : share of the time at rest [-].
    moving : rate while in motion [-]; None if no run rested, or none moved.
    correlation : integral correlation time of the rate [s].
    time : time over which one run is averaged [s].
    """

    single: Sequence[float]
    mean: Interval
    rest: Interval
    moving: Interval | None
    correlation: float
    time: float


def rates_of(runs: Sequence[Measured], q_flume: float) -> FlumeRates:
    """Set the rates of independent runs against that of the flume [-]."""
    single = [float(one["q_star"]) / q_flume for one in runs]
    series = [np.asarray(one["rates"]) / q_flume for one in runs]
    rest = [float(np.mean(one < REST)) for one in series]
    moving = [1.0 - one for one in rest]
    flow = None
    if 0.0 < sum(rest) < len(rest):
        gone = [float(one[one >= REST].mean()) for one in series if np.any(one >= REST)]
        flow = not_negative(over_seeds(gone, "-"))
    shortest = min(len(one) for one in series)
    return FlumeRates(
        single, rate_with_rests(single, moving, "-"), share_over_runs(rest), flow,
        correlation_time([one[:shortest] for one in series], SECOND), float(runs[0]["time"]),
    )  # fmt: skip


def pooled_profile(runs: Sequence[Measured]) -> tuple[Floats, Floats, Floats]:
    """Heights [d], concentration [-] and speed of the beads [m/s] over all runs together."""
    z = max((np.asarray(one["z"]) for one in runs), key=len)
    on_z = [
        (np.interp(z, one["z"], one["phi"], 0.0, 0.0), np.interp(z, one["z"], one["u"], 0.0, 0.0))
        for one in runs
    ]
    phi = np.mean([phi for phi, _ in on_z], axis=0)
    flux = np.mean([phi * u for phi, u in on_z], axis=0)
    return z, phi, np.divide(flux, phi, out=np.zeros_like(flux), where=phi > 0.0)


def pooled_water(runs: Sequence[Measured]) -> tuple[Floats, Floats]:
    """Heights [d] and mean speed of the water [m/s] over all runs, at the heights that all of them have.

    The levels of the column are counted from the deepest fixed bead, which lies elsewhere for every seed.
    """
    low = max(float(np.min(one["z_water"])) for one in runs)
    high = min(float(np.max(one["z_water"])) for one in runs)
    z = np.asarray(runs[0]["z_water"])
    z = z[(z >= low) & (z <= high)]
    return z, np.mean([np.interp(z, one["z_water"], one["u_water"]) for one in runs], axis=0)


Profile = tuple[Floats, Floats, Floats]  # heights [d], concentration [-] and speed of the beads [m/s]


def rms(
    runs: Sequence[Measured],
    reference: Profile,
    column: int,
    low: float = LOW,
    pooled: Callable[[Sequence[Measured]], Profile] = pooled_profile,
) -> Interval:
    """Root mean square difference of the profile over all runs from another, from a height on [d].

    Its square is a smooth function of means over runs (a polynomial for the concentration), so the jackknife
    removes the part that is noise between the runs, and gives the interval. A column of 1 is the
    concentration [-], 2 the speed [m/s].
    """
    z, phi, _ = reference
    at = np.arange(low, float(z[(z >= low) & (phi >= LEAST)].max()) + 1e-9, STEP)
    wanted = np.interp(at, z, reference[column])

    def square(some: Sequence[Measured]) -> float:
        ours = pooled(some)
        return float(np.mean((np.interp(at, ours[0], ours[column]) - wanted) ** 2))

    found = not_negative(over_seeds(pseudo_values(square, runs), ("", "-", "m/s")[column]))
    return transformed(found, math.sqrt, found.unit, "root of the mean square, jackknife over runs")


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Concentration and speed over height for each run and set of parameters, and the walls that fit."""
    choices = _choices(plan)
    if not choices:
        return []
    flume = measured()
    every = {
        (name, run): [found[one] for one in _runs(choice, run, plan)]
        for name, choice in choices.items()
        for run in choice.runs
    }
    rates = {(name, run): rates_of(runs, rate(*flume[run])) for (name, run), runs in every.items()}
    compared = [
        one
        for name, choice in CHOICES.items()
        for run in choice.runs
        for one in _compare(name, choice, run, flume[run], every[name, run], rates[name, run])
    ]
    return [*compared, _side_walls(choices, rates)]


def _compare(
    name: str,
    choice: Choice,
    run: int,
    flume: tuple[Floats, Floats, Floats],
    runs: Sequence[Measured],
    rates: FlumeRates,
) -> list[Finding]:
    z, phi, u = flume
    z_ours, phi_ours, u_ours = pooled_profile(runs)
    q_flume = rate(z, phi, u)
    z_water, u_water = pooled_water(runs)
    words = {
        "set": choice.words, "runs": len(runs), "time": rates.time, "q": q_flume,
        "u": float(u_water[-1]), "correlated": _correlated(rates), "name": name, "run": run,
        "said": choice.said, "single": ", ".join(f"{one:.2g}" for one in rates.single),
        "rests": "",
    }  # fmt: skip
    if rates.moving is not None:
        words["rests"] = " " + RESTS.format(times=1000.0 * 70.0 / (BEADS * rates.time * len(runs)))
    shown = {"rest": rates.rest, "moving": rates.moving}
    window = (z_ours >= LOW - 1.0) & (z_ours <= float(z.max()))
    water = [Curve("water", z_water, u_water)]
    return [
        DECLARED["{name}-{run}-phi"].finding(
            [Curve("beads", z_ours[window], phi_ours[window])], [Curve(f"Frey, run {run}", z, phi)],
            {"q_star": rates.mean, "rms": rms(runs, flume, 1), **shown}, **words,
        ),
        DECLARED["{name}-{run}-u"].finding(
            [Curve("beads", z_ours[window], u_ours[window])], [Curve(f"Frey, run {run}", z, u)],
            {"rms": rms(runs, flume, 2), **shown}, water, **words,
        ),
    ]  # fmt: skip


def _correlated(rates: FlumeRates) -> str:
    if math.isnan(rates.correlation):
        return "not known"
    if rates.correlation >= 0.49 * rates.time:
        return f"as long as the runs of {rates.time:.0f} s or longer"
    return f"{rates.correlation:.1f} s"


def _side_walls(choices: Mapping[str, Choice], rates: Mapping[tuple[str, int], FlumeRates]) -> Finding:
    """Distance between the side walls at which the rate is that of the flume."""
    widths = np.array([one.walls for one in choices.values()])
    each = {run: [rates[name, run].mean for name in choices] for run in FLUME}
    fits = {run: matching(widths, some) for run, some in each.items()}
    return DECLARED["side-walls"].finding(
        [Curve(f"run {run}", widths, np.array([one.value for one in some])) for run, some in each.items()],
        [Curve("flume", widths, np.ones(len(widths)))],
        [
            replace(DECLARED["side-walls"].trial("distance", one, run), note=_bracket(one))
            for run, one in fits.items()
        ],
        distances=", ".join(f"{one:g} mm" for one in widths),
    )  # fmt: skip


def _bracket(fits: Interval) -> str:
    """Ends of an interval whose number could not be interpolated, in words."""
    if math.isfinite(fits.value):
        return ""
    ends = [f"more than {fits.low:g} mm"] if fits.low > 0.0 else []
    ends += [f"less than {fits.high:g} mm"] if math.isfinite(fits.high) else []
    return " and ".join(ends) or "at none of these distances does the interval exclude the flume's rate"


def matching(widths: Floats, ratios: Sequence[Interval]) -> Interval:
    """Width at which a ratio that grows with it is 1 [mm], from its intervals at some widths, narrow to wide.

    >>> low, high = Interval(0.2, 0.1, 0.3, "-", 3, ""), Interval(1.8, 1.5, 2.1, "-", 3, "")
    >>> str(matching(np.array([6.5, 28.0]), [low, high]))
    '17.2 mm (6.5 to 28)'
    """
    below = [w for w, one in zip(widths, ratios, strict=True) if one.high < 1.0]
    above = [w for w, one in zip(widths, ratios, strict=True) if one.low > 1.0]
    low, high = max(below, default=0.0), min(above, default=math.inf)
    grows = np.maximum.accumulate([one.value for one in ratios])
    value = float(np.interp(1.0, grows, widths)) if grows[0] < 1.0 <= grows[-1] else math.nan
    how = f"95 % of the rate excludes the flume's beyond these ends; {len(widths)} distances"
    return Interval(value, float(low), float(high), "mm", ratios[0].n, how)
