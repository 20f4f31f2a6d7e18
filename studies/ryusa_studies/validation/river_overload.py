"""A bed that is fed more than it carries on rises as the transport over even beds says (design/0028)."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.measure.along_row import grains_along_row
from ryusa.measure.long_section import bed_line, row_of
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Level, Plan, case_run
from ryusa_studies.validation import river_dam as dam
from ryusa_studies.validation import river_exner as exner
from ryusa_studies.validation.declared import NONE, Settings, declared

DECLARED = declared(__file__)

CASE = "overload"
SEEDS = (1, 2)
SLOPE, DISCHARGE = 0.0625, 0.0333  # of the case, in SI
EXTRA = 0.03055 / (2650.0 * 0.032)  # what the second feeder brings per width [m2/s]
FED, SILL = 0.2, 2.875  # end of the feeders, and begin of the sill [m]
BEGIN, WINDOW = 4.0, 2.0  # of the second feeder, and over which the bed is averaged at the end [s]
WITHOUT = (
    '[{ name = "feeder", low = ["5 cm", "0 cm", "7 cm"], high = ["20 cm", "3.2 cm", "10 cm"], '
    'rate = "0.0611 kg/s", velocity = ["1 m/s", "0 m/s", "0 m/s"] }]'
)
POINTS = 24  # of the contour on which a Laplace transform is inverted


def rise(x: Floats, t: float, extra: float, core: float, diffusion: float, steep: float, f: float) -> Floats:
    """Rise of an even bed of half-infinite length under a constant extra feed at x = 0 from t = 0 on [m].

    Parameters
    ----------
    x : distance [m].
    t : time [s].
    extra : extra feed dq, volume of grains per width and time [m2/s].
    core : concentration of the bed, 1 - p [-].
    diffusion : K = (dq_s/dS at constant q)/(1 - p) [m2/s].
    steep : 3 S/h_0 [1/m].
    f : 1 - Fr^2 [-], at most 0: above a Froude number of 1 what the feed does at x = 0 is all that comes in.

    Notes
    -----
    Linear theory with constant discharge, friction slope S (h_0/h)^3 and q_s of that slope alone
    (design/0028).
    A disturbance exp(s t + lambda x) has s = steep K lambda^2/(steep - f lambda). Of its two roots that which
    decays downstream carries the feed, and the Laplace transform of the rise is

        - lambda dq/((1 - p) s^2) exp(lambda x).

    With f = 0 this is (2 dq/(1 - p)) sqrt(t/K) ierfc(x/(2 sqrt(K t))); for any f the volume with pores is
    dq t/(1 - p). Inverted on the fixed Talbot contour (Abate & Valko 2004, Int. J. Numer. Meth. Engng 60,
    979).
    """
    r = 0.4 * POINTS / t
    angle = np.arange(1, POINTS) * math.pi / POINTS
    cot = 1.0 / np.tan(angle)
    s = np.concatenate([[r + 0j], r * angle * (cot + 1j)])
    weight = np.concatenate(
        [[0.5 * np.exp(r * t) + 0j], np.exp(s[1:] * t) * (1.0 + 1j * (angle + (angle * cot - 1.0) * cot))]
    )
    root = (-s * f - np.sqrt(s * s * f * f + 4.0 * steep * steep * diffusion * s)) / (2.0 * steep * diffusion)
    image = -root * extra / (core * s * s) * np.exp(root * np.asarray(x, dtype=np.float64)[:, None])
    return r / POINTS * (weight * image).real.sum(axis=1)


def bed(extra: bool, seed: int, more: Settings = NONE) -> CaseRun:
    """A bed with or without the extra feed, with settings that differ from its case."""
    differs = {**({} if extra else {"feeds": WITHOUT}), **more}
    return case_run(case_path("validation/overload.toml"), differs, seed=seed)


def tasks(plan: Plan) -> Sequence[CaseRun]:
    """Two runs with and two without the extra feed, at the full level alone: half an hour each.

    The even beds are those of `river_dam`.
    """
    if plan.level is not Level.FULL:
        return []
    return [bed(extra, seed) for seed in SEEDS for extra in (True, False)]


def measure(run: Results, one: CaseRun) -> dict[str, Floats]:
    """Bed and volume of grains along the row, means over the last two seconds.

    Returns
    -------
    `x`, `bed` and `volume` [m], middles of the segments, height of the bed, grains per area without pores;
    `t` [s], middle of the window, and `end` [s], its last frame; `passed` [m2], grains that went over the
    sill until that frame; `there` [m2], all grains upstream of the sill in it, those on the apron of the
    feeders too.
    """
    del one
    found = row_of(run)
    frames = np.flatnonzero(found.t >= found.t[-1] - WINDOW + 1e-9)
    held = grains_along_row(run, found.row, frames)
    whole = grains_along_row(run, found.row, np.array([0, len(found.t) - 1]))
    over = int(np.searchsorted(found.row.x_station, SILL))
    return {
        "x": found.row.x, "bed": bed_line(run, found, frames, "packed").mean(axis=0),
        "volume": held.volume.mean(axis=0), "t": np.array(found.t[frames].mean()),
        "end": np.array(found.t[-1]),
        "passed": np.array(whole.passed[-1, over] - whole.passed[0, over]),
        "there": np.array(whole.volume[-1][:over].sum() * found.row.dx),
    }  # fmt: skip


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """The rise of the bed against linear theory."""
    return [finding(found, SEEDS)] if plan.level is Level.FULL else []


def finding(found: Found, seeds: Sequence[int], more: Settings = NONE, under: str = "") -> Finding:
    """The rise of beds with these seeds; `under` says in words what settings differ from the case."""
    even = [found[dam.even_bed(*one)] for one in dam.LOW.beds]
    points = [(float(e["slope"]), float(e["q"]), float(e["q_s"]), float(e["error"])) for e in even]
    q_s, derivative, error = exner.transport_slope(points, SLOPE, DISCHARGE).tolist()
    flow = even[-1]  # that of the slope and nearly the discharge of the case
    core, depth, froude = (float(flow[key]) for key in ("core", "depth", "froude"))
    diffusion, steep, f = derivative / core, 3.0 * SLOPE / depth, 1.0 - froude**2
    pairs = [[found[bed(extra, seed, more)] for extra in (True, False)] for seed in seeds]
    x, t = pairs[0][0]["x"], float(pairs[0][0]["t"]) - BEGIN
    reach = (x > FED) & (x < SILL)
    at = x[reach] - FED
    rises = [(fed["bed"] - bare["bed"])[reach] for fed, bare in pairs]
    theory = rise(at, t, EXTRA, core, diffusion, steep, f)
    mean = np.mean(rises, axis=0)
    share = float(mean @ theory / (theory @ theory))
    off = float(np.sqrt(((mean - share * theory) ** 2).mean()) / theory.max())
    fed_for = float(pairs[0][0]["end"]) - BEGIN
    stored = [
        float((fed["there"] + fed["passed"] - bare["there"] - bare["passed"]) / (EXTRA * fed_for))
        for fed, bare in pairs
    ]
    each = ", ".join(f"{float(one @ theory / (theory @ theory)):.3f}" for one in rises)
    return DECLARED["overload"].finding(
        [Curve(f"seed {seed}", at, 1e3 * one) for seed, one in zip(seeds, rises, strict=True)],
        [Curve("linear theory", at, 1e3 * theory)],
        {"rise": share, "shape": off, "stored": float(np.mean(stored)), "error": error},
        extra=1e4 * EXTRA, t=t, each=each, diffusion=1e4 * diffusion, derivative=1e4 * derivative,
        core=core, q_s=1e4 * q_s, q_s_2=EXTRA / q_s, depth=1e3 * depth, froude=froude, under=under,
    )  # fmt: skip
