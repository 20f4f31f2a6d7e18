"""Bed load from the threshold to sheet flow beside the classical formulae, the bed's stress as measured."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Axis, Curve
from ryusa.laws import debris
from ryusa.laws import transport as laws
from ryusa.measure import transport, water
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

TITLE = "Sediment transport rate over bed shear stress"
SLOPES = {"bedload_3d": (0.005, 0.00825, 0.0132, 0.0248), "sheet_flow": (0.0275, 0.0468, 0.07)}
DEEP = {0.07: {"build.layers": "14", "build.length": "4.5 cm"}}  # fewer would move down to the last one
QUICK = {"motion.slope": "0.0248", "stop.time": "2 s", "record.settle": "1 s"}
JUDGED = 0.08  # tau_star from where on every formula is far enough above its threshold
CRITICAL = 0.05  # of Ashida & Michiue
FINE = np.geomspace(0.05, 2.5, 120)
# of Egashira, Miyamoto & Itoh, for sand: friction between grains, c in the layer, p_d/p_s, e, k_d, k_f
PHI_S, C_S, ALPHA, E, K_D, K_F = math.radians(38.5), 0.3, 0.25, 0.85, 0.0828, 0.16


def tasks(plan: Plan) -> Sequence[Task]:
    """Slopes from the threshold to sheet flow; quick one short run."""
    if plan.level is Level.QUICK:
        return [case_run(case_path("bedload_3d.toml"), QUICK)]
    return [
        case_run(case_path(f"{case}.toml"), {"motion.slope": f"{slope:g}", **DEEP.get(slope, {})})
        for case, slopes in SLOPES.items()
        for slope in slopes
    ]


def measure(run: Results, one: CaseRun) -> dict[str, float]:
    """Rate, stress, their errors, the depth of the water in grains, and how the rate moved."""
    del one
    moved, flow = transport(run), water(run)
    rate = moved.averages["q_star"]
    half = len(moved.q_star) // 2
    before = float(moved.q_star[:half].mean())
    return {
        "q_star": rate.value, "q_error": rate.error,
        "tau_star": moved.tau_star, "tau_error": moved.tau_error,
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
    """How many times a rate lies above the highest formula or below the lowest [-]; 1 between them."""
    band = np.array(list(formulae(tau_star).values()))
    with np.errstate(divide="ignore"):
        return np.maximum(1.0, np.maximum(q_star / band.max(axis=0), band.min(axis=0) / q_star))


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Rates over stress, and how far they lie from the formulae."""
    each = [found[one] for one in tasks(plan)]
    tau, q, slope, depth, drift = (
        np.array([one[key] for one in each]) for key in ("tau_star", "q_star", "slope", "depth", "drift")
    )
    judged = (tau >= JUDGED) & (q > 0.0)
    mean = np.exp(np.mean([np.log(one) for one in formulae(tau[judged]).values()], axis=0))
    off = np.log(q[judged] / mean) if judged.any() else np.array([math.nan])
    still = int(((tau >= JUDGED) & ~(q > 0.0)).sum())
    worst = float(outside(tau[judged], q[judged]).max()) if judged.any() and not still else math.inf
    moved = "; ".join(
        f"tau_star {t:.3g}: q_star {r:.3g} +- {one['q_error']:.1g}, layer {one['layer']:.1f} d, "
        f"second half {100.0 * s:+.0f} %"
        for t, r, s, one in zip(tau, q, drift, each, strict=True)
    )
    return [
        comparison(
            "rate", "Transport rate from the threshold to sheet flow",
            Source(
                "8 (tau_star - 0.047)^1.5; 3.97 (tau_star - 0.0495)^1.5; 17 (tau_star - 0.05) "
                "(tau_star^0.5 - 0.05^0.5): fits to flume data, as in public codes", Known.QUOTED,
            ),
            Axis("tau_star at the bed", log=True), Axis("q_star", log=True), [Curve("grains", tau, q)],
            [Curve(name, FINE, one) for name, one in formulae(FINE).items()],
            [
                misfit(
                    "largest factor outside the formulae", worst, "-",
                    at_most(
                        2.0,
                        "the formulae differ by a factor of 3, and measurements scatter about each by "
                        "a factor of 2",
                    ),
                ),
                misfit(
                    "geometric mean of the rate over that of the formulae", float(np.exp(off.mean())), "-",
                    Band(0.5, 2.0, "-", "the same"),
                ),
                misfit("scatter about that mean, as a factor", float(np.exp(off.std())), "-"),
            ],
            {
                "grains": "spheres of 4 mm +- 10 %, free to spin, mu = 0.577, e = 0.5, no dashpot "
                "along the contact",
                "slopes": ", ".join(f"{math.tan(one):.3g}" for one in slope),
                "depth": ", ".join(f"{one:.0f} d" for one in depth),
            },
            "tau_star is the stress of the clear water, extrapolated to the height where the "
            f"concentration is half that of the bed at rest (docs/theory.md); judged from {JUDGED} "
            f"upwards. {moved}.",
            [Curve("Egashira, Miyamoto & Itoh 1997, level bed", FINE, egashira(FINE, 0.0, 1.0e9))],
        )
    ]  # fmt: skip
