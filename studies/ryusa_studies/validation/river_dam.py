"""Slope and volume of the deposit behind a dam, from the transport over even beds (design/0028)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.measure import deposit
from ryusa.measure.long_section import bed_line, row_of
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Level, Plan, case_run
from ryusa_studies.validation import river_exner as exner
from ryusa_studies.validation.declared import NONE, Settings, declared

DECLARED = declared(__file__)
DAM, EVEN = "filling_dam", "even_bed"
CASES = DAM, EVEN
FEED = 0.06  # that of filling_dam.toml [kg/s]
BOTTOM, WIDTH, DENSITY = 0.11, 0.032, 2650.0  # of filling_dam.toml, in SI
FACE = 1.4  # where its dam begins [m]


@dataclass(frozen=True)
class Dams:
    """Runs of one dam with different feeds, and the even beds that their slopes follow from."""

    name: str
    discharge: float  # [m2/s]
    high: float  # height of the dam over the bottom [m]
    shares: tuple[float, ...]  # of FEED, one run each
    beds: tuple[tuple[float, float], ...]  # slope [-] and depth [m] of the even beds
    differs: dict[str, str] = field(default_factory=dict[str, str])  # from filling_dam.toml

    def dam(self, share: float, more: Settings = NONE) -> CaseRun:
        """A run with a share of the feed, and settings that differ from its case."""
        differs = {**self.differs, "feeds.0.rate": f"{share * FEED:g} kg/s", **more}
        return case_run(case_path("validation/filling_dam.toml"), differs, seed=1)

    def tasks(self) -> list[CaseRun]:
        """All of its runs."""
        return [*(self.dam(share) for share in self.shares), *(even_bed(*one) for one in self.beds)]


LOW = Dams("dam-slope", 0.03, 0.032, (1.0, 0.5, 1.0 / 3.0), ((0.075, 0.026), (0.05, 0.030), (0.0625, 0.0315)))
# Two of these three deposits are shorter than the h/S in which their flow becomes normal (design/0028). With
# less water, on a higher dam, those of the same two feeds are longer than 1.8 h/S.
LONG = Dams(
    "dam-slope-long", 0.0175, 0.04, (0.5, 1.0 / 3.0), ((0.08, 0.016), (0.055, 0.0195), (0.0675, 0.019)),
    {
        "water.row.upstream.discharge": "0.0175 m2/s",
        "water.row.dams.0.height": "4 cm",
        "build.bed": '[["0.51 m", "0 cm"], ["1.4 m", "4 cm"]]',  # a slope of 0.065
        "water.row.surface": '[["0 m", "2 cm"], ["1.475 m", "6 cm"], ["1.6 m", "2 cm"]]',
        "stop.time": "55 s",
        "record.settle": "40 s",
    },
)  # fmt: skip
ALL = LOW, LONG


def even_bed(slope: float, depth: float) -> CaseRun:
    """A run over an even bed of a slope [-], begun with a depth of water [m] over it."""
    more = {
        "motion.slope": f"{slope:g}", "water.depth": f"'{depth:g} m'", "stop.time": "16 s",
        "record.frames": "50 ms",
    }  # fmt: skip
    return case_run(case_path("even_bed.toml"), more, seed=1)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Five dams and six even beds, at the full level alone: up to half an hour and two minutes each."""
    return [one for dams in ALL for one in dams.tasks()] if plan.level is Level.FULL else []


def measure(run: Results, one: CaseRun) -> dict[str, Floats]:
    """Of an even bed as for waves of a bed; of a dam the means after the settling time.

    Returns
    -------
    `x` and `bed` [m], middles of the segments and height of the bed over the bottom; `slope` of the deposit
    as `ryusa measure RUN deposit` gives it, against the horizontal, with its `error` [-]; `volume` between
    bottom and bed upstream of the dam, per width [m2]; `passes`, what goes over the dam over what comes
    [-]; `missing`, the largest difference between the grains there and those that feeds and exits left [m2].
    """
    if one.case == EVEN:
        return exner.measure(run, one)
    found, begin = row_of(run), float(run.case["record"]["settle"])
    frames = np.flatnonzero(found.t >= begin - 1e-9)
    over = (bed_line(run, found, frames, "packed") - found.floor).mean(axis=0)
    got = deposit(run, begin=begin)
    before = found.row.x < float(run.case["water"]["row"]["dams"][0]["begin"])
    rates = got.averages
    return {
        "x": found.row.x, "bed": over, "slope": np.array(rates["slope"].value),
        "error": np.array(rates["slope"].error), "volume": np.array(over[before].sum() * found.row.dx),
        "passes": np.array(rates["passed_rate"].value / rates["brought_rate"].value),
        "missing": np.array(np.abs(got.unaccounted).max()),
    }  # fmt: skip


def slope_that_carries(even: Sequence[tuple[float, float, float, float]], q: float, q_s: float) -> float:
    """Slope at which a discharge q carries q_s [m2/s] by q_s = a S^n q^m through three even beds [-].

    even : as in `river_exner.transport_slope`.
    """
    here, derivative, _ = exner.transport_slope(even, 1.0, q).tolist()  # at a slope of 1: a, and n a
    return (q_s / here) ** (here / derivative)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Slopes at each feed, and the volumes that follow from them."""
    return [finding(found, dams, dams.shares) for dams in ALL] if plan.level is Level.FULL else []


def finding(
    found: Found, dams: Dams, shares: Sequence[float], more: Settings = NONE, under: str = ""
) -> Finding:
    """Deposits of these shares of the feed; `under` says in words what settings differ from the case."""
    even = [
        (float(e["slope"]), float(e["q"]), float(e["q_s"]), float(e["error"]))
        for e in (found[even_bed(*one)] for one in dams.beds)
    ]
    runs = [found[dams.dam(share, more)] for share in shares]
    q_s = [share * FEED / (DENSITY * WIDTH) for share in shares]
    expected = [slope_that_carries(even, dams.discharge, one) for one in q_s]
    slopes = [float(one["slope"]) for one in runs]
    # tan of what the bottom falls more than the deposit; P is normal to the bottom
    fall = [math.tan(math.atan(BOTTOM) - math.atan(slope)) for slope in expected]
    volumes = [0.5 * dams.high**2 / one for one in fall]
    kind = DECLARED["{name}"]
    errors = [kind.trial("missing", max(float(one["missing"]) for one in runs))]
    for share, slope, own, one, volume in zip(shares, expected, slopes, runs, volumes, strict=True):
        errors.append(kind.trial("slope", own / slope, f"{share:.2f}"))
        errors.append(kind.trial("volume", float(one["volume"]) / volume, f"{share:.2f}"))
    names = [f"feed {share:.2f}" for share in shares]
    ours = [Curve(name, one["x"], 1e3 * one["bed"]) for name, one in zip(names, runs, strict=True)]
    x = np.linspace(0.0, FACE, 141)
    theory = [
        Curve(name, x, 1e3 * np.maximum(dams.high - (FACE - x) * one, 0.0))
        for name, one in zip(names, fall, strict=True)
    ]
    said = "; ".join(
        f"{name}: slope {own:.4f} +- {float(one['error']):.4f}, of even beds {slope:.4f}, passes "
        f"{float(one['passes']):.3f} of what comes"
        for name, own, slope, one in zip(names, slopes, expected, runs, strict=True)
    )
    beds = "; ".join(f"S {s:.4f}, q {1e4 * q:.0f}, q_s {1e4 * g:.2f} cm2/s" for s, q, g, _ in even)
    feeds = ", ".join(f"{1e4 * one:.1f}" for one in q_s)
    return kind.finding(
        ours, theory, errors, name=dams.name, high=100.0 * dams.high, q=dams.discharge, feeds=feeds,
        said=said, beds=beds, under=under,
    )  # fmt: skip
