"""A dense dry flow down a steady incline has Bagnold's profile."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.measure import profiles
from ryusa.model.arrays import Bools, Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Level, Plan, Task, case_run, largest_mean
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "A dense flow down an incline"
DECLARED = declared(__file__)
SLOPE, G = math.radians(24.0), 9.8  # of the case file [rad], [m/s2]
LAYER = 1.0  # thickness of a layer [d]; thinner ones see the layers that grains form over the bed
CORE = (0.2, 0.8)  # of the depth, away from bed and surface


def tasks(plan: Plan) -> Sequence[Task]:
    """Runs of minutes; none at the quick level."""
    if plan.level is Level.QUICK:
        return []
    time = {"stop.time": f"{SAMPLING['incline'].length(plan.level):g} s"}
    path = case_path("validation/incline.toml")
    return [case_run(path, time, seed=seed) for seed in SAMPLING["incline"].seeds(plan)]


def measure(run: Results, one: CaseRun) -> dict[str, Floats | float]:
    """Profiles after settling, and how the mean speed moved."""
    del one
    found = profiles(run, layer=LAYER, above="bed crest")
    keep = np.isfinite(found.v_x.value) & (found.phi.value > 0.02)
    half = len(found.speed) // 2
    drift = found.speed[half:].mean() / found.speed[:half].mean() - 1.0
    return {
        "z": found.z[keep], "phi": found.phi.value[keep], "u": found.v_x.value[keep],
        "dz": found.thickness, "d": found.d, "rho_s": found.density, "drift": float(drift),
    }  # fmt: skip


def below_surface(found: dict[str, Floats | float]) -> tuple[Floats, float]:
    """Depth below the surface by the weight above [m], shape (n,), and the core's mean concentration [-]."""
    phi, dz = np.asarray(found["phi"]), float(found["dz"])
    above = np.cumsum(phi[::-1])[::-1] * dz - 0.5 * phi * dz
    core = (above > CORE[0] * above[0]) & (above < CORE[1] * above[0])
    mean = float(phi[core].mean())
    return above / mean, mean


def exponent(s: Floats, u: Floats) -> float:
    """Exponent n of the best fit u = u_s - a s**n [-]."""
    tried = np.linspace(0.5, 3.0, 501)

    def left(n: float) -> float:
        a = np.column_stack([np.ones(len(s)), (s / s.max()) ** n])
        rest = u - a @ np.linalg.lstsq(a, u, rcond=None)[0]
        return float(rest @ rest)

    return float(tried[int(np.argmin([left(n) for n in tried]))])


@dataclass(frozen=True)
class Core:
    """What one run shows between CORE[0] and CORE[1] of its depth, without the layers at bed and surface."""

    level: NDArray[np.int64]  # number of each layer above the crest of the bed
    z: Floats  # height above the bed [d]
    u: Floats  # speed [m/s]
    s: Floats  # depth below the surface by the weight above [m]
    inside: Bools  # which layers are in the core
    inertial: Floats  # inertial number of every layer [-]
    i_mean: float  # its mean over the core
    phi: Floats  # concentration [-]
    phi_mean: float  # its mean over the core
    law: Floats  # Bagnold's profile with the inertial number of the core [m/s]
    depth: float  # [d]
    drift: float  # mean speed of the second half over the first, less 1


def core_of(ours: dict[str, Floats | float]) -> Core:
    """Set the core of one run beside Bagnold's profile."""
    z, u, phi, d = (np.asarray(ours[key]) for key in ("z", "u", "phi", "d"))
    s, mean = below_surface(ours)
    inside = (s > CORE[0] * s[0]) & (s < CORE[1] * s[0])
    pressure = mean * G * math.cos(SLOPE) * s  # over the density of the grains [m2/s2]
    inertial = np.gradient(u, z) * float(d) / np.sqrt(np.maximum(pressure, 1e-300))
    i_mean = float(inertial[inside].mean())
    law = 2.0 / 3.0 * i_mean / float(d) * math.sqrt(mean * G * math.cos(SLOPE))
    surface = float((u + law * s**1.5)[inside].mean())
    profile = surface - law * s**1.5
    level = np.rint(z / float(ours["dz"]) - 0.5).astype(np.int64)
    depth, drift = float(s[0] / d), float(ours["drift"])
    return Core(level, z / d, u, s, inside, inertial, i_mean, phi, mean, profile, depth, drift)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Exponent of the profile, and the inertial number over the depth."""
    if plan.level is Level.QUICK:
        return []
    ours = [found[one] for one in tasks(plan)]
    cores = [core_of(one) for one in ours]
    levels = reduce(np.intersect1d, [one.level for one in cores])  # layers that every run has
    core = reduce(np.intersect1d, [one.level[one.inside] for one in cores])
    inside = np.isin(levels, core)

    def at(one: Core, name: str) -> Floats:
        return getattr(one, name)[np.isin(one.level, levels)]

    def mean(name: str) -> Floats:
        return np.mean([at(one, name) for one in cores], axis=0)

    off = {
        key: largest_mean(
            np.array([at(one, key)[inside] / getattr(one, mean) - 1.0 for one in cores]).T.tolist(), "-",
            absolute=True,
        )
        for key, mean in (("inertial", "i_mean"), ("phi", "phi_mean"))
    }  # fmt: skip
    said = {
        "cores": len(cores), "time": SAMPLING["incline"].length(plan.level),
        "depth": np.mean([one.depth for one in cores]), "phi_mean": np.mean([one.phi_mean for one in cores]),
    }  # fmt: skip
    exponents = [exponent(one.s[one.inside], one.u[one.inside]) for one in cores]
    return [
        DECLARED["bagnold"].finding(
            [Curve("grains", mean("z"), mean("u"))],
            [Curve("Bagnold, I of the core", mean("z"), mean("law"))],
            {
                "exponent": exponents,
                "drift": largest_mean([[one.drift for one in cores]], "-", absolute=True),
            },
            **said,
        ),
        DECLARED["inertial-number"].finding(
            [Curve("grains", mean("z")[inside], mean("inertial")[inside])],
            [
                Curve(
                    "mean of the core", mean("z")[inside],
                    np.full(len(core), float(np.mean([one.i_mean for one in cores]))),
                ),
            ],
            off,
            **said,
        ),
    ]  # fmt: skip
