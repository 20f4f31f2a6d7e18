"""Bed load in a flume one bead wide, against the profiles that Frey 2014 measured."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from io import StringIO

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Axis, Curve
from ryusa.measure import profiles, transport
from ryusa.model.scene import Floats
from ryusa.results import Results
from ryusa.study import (
    Band,
    CaseRun,
    Finding,
    Found,
    Known,
    Level,
    Plan,
    Source,
    Task,
    at_most,
    case_run,
    comparison,
    misfit,
)

TITLE = "Bed load in a narrow flume"
D, EXCESS, G, SLOPE = 6.0e-3, 1.5, 9.81, 0.1  # of the case file [m], [-], [m/s2], [rad]
LAYER = 1.0 / 12.0  # of our profiles [d]; the measured ones have 0.065 d
LOW, LEAST = 6.0, 0.01  # heights over the base [d] and concentrations that are compared, from there up
STEP = 0.5  # between the heights of the rms [d]
SOURCE = Source(
    "Frey 2014, profiles as digitised in YADE's validation of Maurin, Chauchat, Chareyre & Frey 2015",
    Known.QUOTED,
)


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
    overrides: Mapping[str, str]
    runs: tuple[int, ...]


# What YADE 2023.02 takes from the water at its side walls was found from its own momentum balance: clear
# water 1.03 cm deep over a smooth bed at 0.56 m/s loses 0.00064 m2/s2 there, where the law it cites gives
# 0.0048 and Blasius with the hydraulic diameter 0.0039. Walls 28 mm apart give the same by Blasius.
SAID = {
    "published": (
        "With Blasius friction on smooth walls 6.5 mm apart the water is too slow for the measured "
        "transport: bed load nearly stops. In the code of the source the wall friction is a sixth of "
        "that, see the next set."
    ),
    "peer": (
        "By its own momentum balance, the code of the source (YADE 2023.02) has about a sixth of the wall "
        "friction of the law that it cites; Blasius friction on walls 28 mm apart gives the same."
    ),
}
CHOICES = {
    "published": Choice("as published", {}, (6, 14, 20)),
    "peer": Choice(
        "as published, with the reduced wall friction of the source's code",
        {"water.column.side_walls": "28 mm"},
        (6, 14, 20),
    ),
}


def _work(choice: str, run: int) -> CaseRun:
    flume = FLUME[run]
    keys = {"water.depth": flume.depth, "build.layers": flume.layers, **CHOICES[choice].overrides}
    return case_run(case_path("validation/frey.toml"), keys)


def tasks(plan: Plan) -> Sequence[Task]:
    """Six runs of some minutes, at the full level."""
    if plan.level is not Level.FULL:
        return []
    return [_work(name, run) for name, choice in CHOICES.items() for run in choice.runs]


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
    """Profiles of beads and water over the window, and the transport rate with its error."""
    del one
    found = profiles(run, layer=LAYER)
    carried = transport(run, tau_star=math.nan)
    water = run.water
    assert water is not None
    since = np.asarray(water.t) >= found.t[0]
    scale = math.sqrt(EXCESS * G * math.cos(SLOPE) * D**3)
    q = carried.averages["q"]
    return {
        "z": found.z / D, "phi": found.phi.value, "u": np.nan_to_num(found.v_x.value),
        "z_water": np.asarray(water.z) / D, "u_water": np.asarray(water.u)[since].mean(axis=0),
        "q_star": q.value / scale, "q_error": q.error / scale, "time": float(found.t[-1] - found.t[0]),
    }  # fmt: skip


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Concentration and speed over height for each run and each set of parameters."""
    if plan.level is not Level.FULL:
        return []
    flume = measured()
    return [
        one
        for name, choice in CHOICES.items()
        for run in choice.runs
        for one in _compare(name, choice, run, flume[run], found[_work(name, run)])
    ]


def _compare(
    name: str,
    choice: Choice,
    run: int,
    flume: tuple[Floats, Floats, Floats],
    ours: Mapping[str, Floats | float],
) -> list[Finding]:
    z, phi, u = flume
    there = (z >= LOW) & (phi >= LEAST)
    at = np.arange(LOW, float(z[there].max()) + 1e-9, STEP)
    z_ours, phi_ours, u_ours = (np.asarray(ours[key]) for key in ("z", "phi", "u"))

    def rms(a: Floats, b: Floats) -> float:
        return float(np.sqrt(np.mean((np.interp(at, z_ours, a) - np.interp(at, z, b)) ** 2)))

    q_star, q_flume = float(ours["q_star"]), rate(z, phi, u)
    settings = {
        "set": choice.words,
        "averaged over": f"{float(ours['time']):.0f} s",
        "q_star": f"{q_star:.3f} +- {float(ours['q_error']):.3f}, the flume {q_flume:.3f}",
        "water at the surface": f"{float(np.asarray(ours['u_water'])[-1]):.2f} m/s",
    }
    window = (z_ours >= LOW - 1.0) & (z_ours <= float(z.max()))
    height = Axis("height over the base over d")
    return [
        comparison(
            f"{name}-{run}-phi", f"Run {run}, {choice.words}: concentration", SOURCE, height, Axis("phi"),
            [Curve("beads", z_ours[window], phi_ours[window])], [Curve(f"Frey, run {run}", z, phi)],
            [
                misfit(
                    "q_star over that of the flume", q_star / q_flume, "-",
                    Band(0.7, 1.3, "-", "the code that was fitted to this flume agrees within 30 %"),
                ),
                misfit("rms of phi", rms(phi_ours, phi), "-", at_most(0.05, "a tenth of the concentration "
                                                                            "of a packed bed")),
            ],
            settings, SAID[name],
        ),
        comparison(
            f"{name}-{run}-u", f"Run {run}, {choice.words}: speed", SOURCE, height, Axis("speed", "m/s"),
            [Curve("beads", z_ours[window], u_ours[window])], [Curve(f"Frey, run {run}", z, u)],
            [misfit("rms of u", rms(u_ours, u), "m/s", at_most(0.05, "a tenth of the speed of the water"))],
            settings, SAID[name],
            [Curve("water", np.asarray(ours["z_water"]), np.asarray(ours["u_water"]))],
        ),
    ]  # fmt: skip
