"""Bed load from the threshold to sheet flow beside the classical formulae, the bed's stress as measured."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.laws import debris
from ryusa.laws import transport as laws
from ryusa.measure import transport, water
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
    exact,
    largest_mean,
    not_negative,
    over_seeds,
    pool_alike,
    transformed,
)
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "Sediment transport rate over bed shear stress"
DECLARED = declared(__file__)
SLOPES = {"bedload_3d": (0.005, 0.00825, 0.0132, 0.0248), "sheet_flow": (0.0275, 0.0468, 0.07)}
DEEP = {0.07: {"build.layers": "14", "build.length": "4.5 cm"}}  # fewer would move down to the last one
QUICK = {"motion.slope": "0.0248", "record.settle": "1 s"}
JUDGED = 0.08  # tau_star from where on every formula is far enough above its threshold
CRITICAL = 0.05  # of Ashida & Michiue
AT_REST = 0.01  # of the mean rate: less than this between two frames is rest
FINE = np.geomspace(0.05, 2.5, 120)
# of Egashira, Miyamoto & Itoh, for sand: friction between grains, c in the layer, p_d/p_s, e, k_d, k_f
PHI_S, C_S, ALPHA, E, K_D, K_F = math.radians(38.5), 0.3, 0.25, 0.85, 0.0828, 0.16


def _settings(plan: Plan) -> list[tuple[str, dict[str, str]]]:
    """Case and its changes for slopes from the threshold to sheet flow; quick one short run."""
    time = {"stop.time": f"{SAMPLING['transport'].length(plan.level):g} s"}
    if plan.level is Level.QUICK:
        return [("bedload_3d", {**QUICK, **time})]
    return [
        (case, {"motion.slope": f"{slope:g}", **DEEP.get(slope, {}), **time})
        for case, slopes in SLOPES.items()
        for slope in slopes
    ]


def _runs(plan: Plan) -> list[list[Task]]:
    """Runs of every slope, one for each seed."""
    return [
        [case_run(case_path(f"{case}.toml"), keys, seed=seed) for seed in SAMPLING["transport"].seeds(plan)]
        for case, keys in _settings(plan)
    ]


def tasks(plan: Plan) -> Sequence[Task]:
    """Every slope with every seed."""
    return [one for runs in _runs(plan) for one in runs]


def measure(run: Results, one: CaseRun) -> dict[str, float]:
    """Rate, stress, depth of the water in grains, how the rate moved, and the time in which nothing did."""
    del one
    moved, flow = transport(run), water(run)
    rate = moved.averages["q_star"]
    half = len(moved.q_star) // 2
    before = float(moved.q_star[:half].mean())
    return {
        "q_star": rate.value, "tau_star": moved.tau_star,
        "rest": float(np.mean(moved.q_star < AT_REST * rate.value)) if rate.value > 0.0 else 1.0,
        "slope": math.atan2(float(run.scene.gravity[0]), -float(run.scene.gravity[2])),
        "depth": (flow.surface - flow.bed) / moved.d,
        "drift": float(moved.q_star[half:].mean()) / before - 1.0 if before > 0.0 else math.nan,
        "layer": moved.averages["layer_thickness"].value / moved.d,
    }  # fmt: skip


def egashira(tau_star: Any, slope: float, depth: float) -> Floats:
    """Rate of Egashira, Miyamoto & Itoh with constants for sand [-]; nan where the layer fills the flow."""
    f = debris.collision_factor(C_S, E, K_D, 2650.0, 1000.0) + debris.pore_factor(C_S, K_F)
    return np.array(
        [laws.q_star_egashira(float(tau), slope, PHI_S, C_S, ALPHA, f, depth) for tau in tau_star]
    )


def formulae(tau_star: Any) -> dict[str, Floats]:
    """Rate of the formulae that judge [-], of gravel beds in flumes with little slope."""
    each = {
        "Meyer-Peter & Mueller 1948": laws.q_star_meyer_peter_mueller,
        "Wong & Parker 2006": laws.q_star_wong_parker,
        "Ashida & Michiue 1972": lambda tau: laws.q_star_ashida_michiue(tau, tau, CRITICAL),
    }
    return {name: np.array([law(float(tau)) for tau in tau_star]) for name, law in each.items()}


def outside(tau_star: Floats, q_star: Floats) -> Floats:
    """Logarithm of how many times a rate lies above the highest formula, and below the lowest [-].

    Shape (2, n); both are negative between the formulae.
    """
    band = np.array(list(formulae(tau_star).values()))
    with np.errstate(divide="ignore"):
        return np.log(np.array([q_star / band.max(axis=0), band.min(axis=0) / q_star]))


@dataclass(frozen=True)
class Compared:
    """Rates of the slopes that are judged, over the formulae."""

    worst: Interval  # largest factor outside the formulae
    middle: Interval  # geometric mean of the rate over that of the formulae
    scatter: Interval  # about that mean, as a factor


def compare(tau: Floats, q: Floats) -> Compared:
    """Set rates [-] at stresses [-] against the formulae; both of shape (slopes, seeds).

    Rates scatter by a share of themselves, so their logarithms are averaged. A slope at rest with every seed
    lies infinitely far below the formulae; one at rest with some seeds has no logarithm, and is not decided.
    """
    if not q.size or not q.any(axis=1).all():
        missed = exact(math.inf, "-")
        return Compared(missed, exact(0.0, "-"), exact(math.nan, "-"))
    sides = np.concatenate([outside(stress, rate) for stress, rate in zip(tau, q, strict=True)])
    mean = np.exp(np.mean([np.log(one) for one in formulae(tau.ravel()).values()], axis=0))
    with np.errstate(divide="ignore"):
        off = np.log(q / mean.reshape(q.shape))
    spread = pool_alike(off.tolist())
    worst = not_negative(largest_mean(sides.tolist(), "-", spread))
    middle = over_seeds(off.mean(axis=0).tolist(), "-")
    scatter = over_seeds([float(one.std()) if np.isfinite(one).all() else math.nan for one in off.T], "-")
    return Compared(*(transformed(one, math.exp, "-", "factor") for one in (worst, middle, scatter)))


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Rates over stress, and how far they lie from the formulae."""
    each = [[found[one] for one in runs] for runs in _runs(plan)]

    def of(key: str) -> Floats:
        return np.array([[one[key] for one in runs] for runs in each])

    tau, q = of("tau_star"), of("q_star")
    stress, rates, slope, depth, drift, layer, rest = (
        of(key).mean(axis=1) for key in ("tau_star", "q_star", "slope", "depth", "drift", "layer", "rest")
    )
    made = compare(tau[stress >= JUDGED], q[stress >= JUDGED])
    moved = "; ".join(
        f"tau_star {t:.3g}: q_star {over_seeds(list(one), '-')}, layer {thick:.1f} d, second half "
        f"{100.0 * s:+.0f} %" + (f", at rest {100.0 * r:.0f} % of the time" if r > 0.0 else "")
        for t, one, thick, s, r in zip(stress, q, layer, drift, rest, strict=True)
    )
    return [
        DECLARED["rate"].finding(
            [Curve("grains", stress, rates)],
            [Curve(name, FINE, one) for name, one in formulae(FINE).items()],
            {"factor": made.worst, "middle": made.middle, "scatter": made.scatter},
            [Curve("Egashira, Miyamoto & Itoh 1997, level bed", FINE, egashira(FINE, 0.0, 1.0e9))],
            tan=", ".join(f"{math.tan(one):.3g}" for one in slope),
            one=", ".join(f"{one:.0f} d" for one in depth), shape=q.shape[1], judged=JUDGED, moved=moved,
        )
    ]  # fmt: skip
