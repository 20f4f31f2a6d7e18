"""Concentration of a debris flow over its own bed against slope: Takahashi; Egashira, Miyamoto & Itoh.

In three dimensions: a plane packs to 0.55 at most, its grains cannot pass each other sideways, and its
friction is another. The friction angle is that of the same grains in a dry flow that comes to rest.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.laws.debris import (
    collision_factor,
    equilibrium_concentration,
    equilibrium_takahashi,
    pore_factor,
    velocity_egashira,
)
from ryusa.measure import profiles
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import (
    CaseRun,
    Finding,
    Found,
    Level,
    Plan,
    Task,
    Trial,
    case_run,
    largest_mean,
    over_seeds,
    pool_alike,
)
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "Equilibrium of a debris flow with its slope"
DECLARED = declared(__file__)
# slope -> depth of water over the bed at first: flows about as deep as each other once the bed is eroded
SLOPES = {"8 deg": "2.2 cm", "10 deg": "1.6 cm", "11 deg": "1.2 cm", "12 deg": "0.8 cm"}
SLOW = 0.05  # of the surface's speed: there begins the bed
THIN = 0.05  # concentration above which a layer of the dry flow counts [-]
STOPPED = 0.25  # of the first speed of the surface, until when the dry flow counts
RHO_S, RHO_W = 2650.0, 1000.0  # of the case files [kg/m3]
SAND = math.radians(38.0)
E, K_D, K_F, G, D = 0.7, 0.0828, 0.16, 9.81, 4.0e-3  # restitution, Egashira's constants; [m/s2], [m]


def tasks(plan: Plan) -> Sequence[Task]:
    """Every slope and the dry flow with every seed; none at the quick level."""
    if plan.level is Level.QUICK:
        return []
    return [one for seed in SAMPLING["equilibrium"].seeds(plan) for one in _of_seed(seed)]


def _of_seed(seed: int) -> list[Task]:
    """Every slope, and the dry flow last."""
    path = case_path("debris_equilibrium.toml")
    wet: list[Task] = [
        case_run(path, {"motion.slope_angle": slope, "water.depth": depth}, seed=seed)
        for slope, depth in SLOPES.items()
    ]
    return [*wet, case_run(case_path("validation/friction_angle.toml"), seed=seed)]


def measure(run: Results, one: CaseRun) -> dict[str, Any]:
    """Friction of a dry flow, or what a debris flow holds."""
    return stopping(run) if one.case == "friction_angle" else flowing(run)


def stopping(run: Results) -> dict[str, float]:
    """Friction at the lower edge of what still moves, while a dry flow comes to rest [-].

    What lies still has no momentum; so the friction at its surface takes what gravity gives to the grains
    above and what they lose.
    """
    gravity = run.scene_at(math.inf).gravity
    t, begin = np.asarray(run.frames.t), float(run.case["record"]["settle"])
    speed, times, share, first = [], [], [], math.nan
    for k in range(int(np.searchsorted(t, begin)), len(t) - 4, 4):
        found = profiles(run, begin=float(t[k]), end=float(t[k + 4]), layer=1.0, above="bed crest")
        u, phi = found.v_x.value, found.phi.value
        there = phi > THIN
        top = float(u[there][-1])
        first = top if math.isnan(first) else first
        if top < STOPPED * first:
            break
        moving = there & (u > SLOW * top)
        share.append(float(phi[moving].sum() / phi.sum()))
        speed.append(float(found.speed[0]))
        times.append(float(t[k]))
    down, into = float(gravity[0]), -float(gravity[2])
    lost = speed[0] - speed[-1]
    pressed = float(np.trapezoid(share, times))
    return {"friction": down / into + lost / (into * pressed), "time": times[-1] - times[0]}


def flowing(run: Results) -> dict[str, Any]:
    """Mean concentration between bed and surface, where those are, and how both moved."""
    found = profiles(run, layer=0.5, above="bed crest")
    half = float(found.t[0] + found.t[-1]) / 2.0
    parts = [_layer(run, found.t[0], half)["c"], _layer(run, half, math.inf)["c"]]
    middle = len(found.t) // 2
    return {
        **_layer(run, found.t[0], math.inf),
        "c_tenth": _layer(run, found.t[0], math.inf, 2.0 * SLOW)["c"],
        "error": abs(parts[1] - parts[0]) / 2.0,
        "faster": float(found.speed[middle:].mean() / found.speed[:middle].mean()) - 1.0,
    }


def _layer(run: Results, begin: float, end: float, slow: float = SLOW) -> dict[str, Any]:
    """Concentration of the flow in a window, its depth in grains, and the friction of grains on the bed."""
    found, water = profiles(run, begin, end, layer=0.5, above="bed crest"), run.water
    assert water is not None
    span = (water.t >= begin) & (water.t <= end)
    u, surface = water.u[span].mean(axis=0), float(water.z_surface[span].mean())
    top = float(np.interp(surface, water.z, u))
    z, v, phi = found.z + found.origin, found.v_x.value, found.phi.value
    low = int(np.flatnonzero((v < slow * top) & (z < surface))[-1])
    bed = float(z[low] + (slow * top - v[low]) / (v[low + 1] - v[low]) * found.thickness)
    edge = np.clip(z + 0.5 * found.thickness, bed, None) - np.clip(z - 0.5 * found.thickness, bed, None)
    solid = float((phi * edge).sum())
    gravity = run.scene.gravity
    weight = (RHO_W * (surface - bed) + (RHO_S - RHO_W) * solid) * float(gravity[0])
    tau = float(np.interp(bed, water.faces, water.tau[span].mean(axis=0)))
    shown = (water.z > bed) & (water.z < surface)
    return {
        "z": (water.z[shown] - bed) / found.d, "u": u[shown],
        "slope": math.atan2(float(gravity[0]), -float(gravity[2])),
        "c": solid / (surface - bed), "depth": (surface - bed) / found.d, "speed": top,
        "water": tau / weight, "mu": (weight - tau) / ((RHO_S - RHO_W) * solid * -float(gravity[2])),
        "densest": float(np.nanmax(phi)), "bed": bed / found.d,
    }  # fmt: skip


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Concentration over slope."""
    if plan.level is Level.QUICK:
        return []
    seeds = SAMPLING["equilibrium"].seeds(plan)
    every = [[found[one] for one in _of_seed(seed)] for seed in seeds]
    *of_slopes, dry = zip(*every, strict=True)  # runs of all seeds, by slope
    wet = [_mean(runs) for runs in of_slopes]
    slope, c = (np.array([one[key] for one in wet]) for key in ("slope", "c"))
    fine = np.linspace(8.0, 20.0, 49)
    frictions = [one["friction"] for one in dry]
    phi = math.atan(float(np.mean(frictions)))
    # each seed has its own dry flow, so that its error is in the scatter too
    off = [
        [
            one["c"] / equilibrium_concentration(one["slope"], math.atan(friction), RHO_S, RHO_W) - 1.0
            for one, friction in zip(runs, frictions, strict=True)
        ]
        for runs in of_slopes
    ]
    said = "; ".join(
        f"{math.degrees(one['slope']):.0f} deg: c {over_seeds([each['c'] for each in runs], '-')} (from a "
        f"tenth of the speed {one['c_tenth']:.3f}), depth {one['depth']:.1f} d, mean grain speed of the "
        f"second half {100.0 * one['faster']:+.0f} %, stress of grains over their weight {one['mu']:.2f}, "
        f"share of the water {one['water']:.2f}"
        for one, runs in zip(wet, of_slopes, strict=True)
    )
    return [
        DECLARED["concentration"].finding(
            [Curve("grains", np.degrees(slope), c)],
            [Curve(f"phi = {math.degrees(phi):.1f} deg, of the dry flow", fine, _curve(fine, phi, wet))],
            {"difference": largest_mean(off, "-", pool_alike(off), absolute=True)},
            [Curve("phi = 38 deg", fine, _curve(fine, SAND, wet))], runs=len(seeds),
            frictions=over_seeds(frictions, "-"), said=said,
        ),
        _velocity(wet, phi, len(seeds)),
    ]  # fmt: skip


def _mean(runs: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Mean of the numbers of all seeds; the profile is interpolated at the heights of the first."""
    z = runs[0]["z"]
    profile = np.mean([np.interp(z, one["z"], one["u"], right=math.nan) for one in runs], axis=0)
    reached = np.isfinite(profile)
    numbers = {key: float(np.mean([one[key] for one in runs])) for key in runs[0] if key not in ("z", "u")}
    return {**numbers, "z": z[reached], "u": profile[reached]}


def _velocity(wet: Sequence[dict[str, Any]], phi: float, runs: int) -> Finding:
    """Speed of the water over height, beside the law of a uniform mixture."""
    ours: list[Curve] = []
    theirs: list[Curve] = []
    numbers: list[Trial] = []
    for one in wet:
        name = f"{math.degrees(one['slope']):.0f} deg"
        z, u = one["z"], one["u"]
        slope, depth = one["slope"], D * one["depth"]
        c = equilibrium_takahashi(slope, phi, RHO_S, RHO_W, one["densest"])
        f = collision_factor(c, E, K_D, RHO_S, RHO_W) + pore_factor(c, K_F)
        law = [
            velocity_egashira(D * float(at), depth, c, slope, phi, one["densest"], f, RHO_S, RHO_W, G, D)
            for at in z
        ]
        ours.append(Curve(name, u, z))
        theirs.append(Curve(name, np.array(law), z))
        ratio = float(u[-1]) / law[-1] if law[-1] > 0.0 else math.nan
        numbers.append(DECLARED["velocity"].trial("surface", ratio, name))
    return DECLARED["velocity"].finding(ours, theirs, numbers, runs=runs)


def _curve(slopes: Floats, phi: float, wet: Sequence[dict[str, Any]]) -> Floats:
    densest = max(one["densest"] for one in wet)
    return np.array(
        [equilibrium_takahashi(math.radians(float(one)), phi, RHO_S, RHO_W, densest) for one in slopes]
    )
