"""A dense dry flow down a steady incline has Bagnold's profile."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Axis, Curve
from ryusa.measure import profiles
from ryusa.model.scene import Floats
from ryusa.results import Results
from ryusa.study import (
    Band,
    CaseRun,
    Finding,
    Found,
    Level,
    Plan,
    Source,
    Task,
    at_most,
    case_run,
    comparison,
    misfit,
)

TITLE = "A dense flow down an incline"
SLOPE, G = math.radians(24.0), 9.8  # of the case file [rad], [m/s2]
LAYER = 1.0  # thickness of a layer [d]; thinner ones see the layers that grains form over the bed
CORE = (0.2, 0.8)  # of the depth, away from bed and surface


def tasks(plan: Plan) -> Sequence[Task]:
    """One run of minutes, at the full level."""
    return [case_run(case_path("validation/incline.toml"))] if plan.level is Level.FULL else []


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


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Exponent of the profile, and the inertial number over the depth."""
    if plan.level is not Level.FULL:
        return []
    ours = found[case_run(case_path("validation/incline.toml"))]
    z, u, phi, d = (np.asarray(ours[key]) for key in ("z", "u", "phi", "d"))
    s, mean = below_surface(ours)
    core = (s > CORE[0] * s[0]) & (s < CORE[1] * s[0])
    pressure = mean * G * math.cos(SLOPE) * s  # over the density of the grains [m2/s2]
    inertial = np.gradient(u, z) * float(d) / np.sqrt(np.maximum(pressure, 1e-300))
    i_mean = float(inertial[core].mean())
    law = 2.0 / 3.0 * i_mean / float(d) * math.sqrt(mean * G * math.cos(SLOPE))
    surface = float((u + law * s**1.5)[core].mean())
    spread = float(np.abs(inertial[core] / i_mean - 1.0).max())
    even = float(np.abs(phi[core] / mean - 1.0).max())
    settings = {
        "slope": "24 deg",
        "mu": "0.5",
        "e": "0.7",
        "depth": f"{s[0] / float(d):.1f} d",
        "phi": f"{mean:.3f}",
    }
    steady = misfit(
        "mean speed of the second half over the first, less 1",
        abs(float(ours["drift"])),
        "-",
        at_most(0.05, "the flow must be steady"),
    )
    return [
        comparison(
            "bagnold", "Velocity over height",
            Source("Bagnold: u = u_s - (2/3) (I/d) sqrt(phi g cos(theta)) s^1.5, s below the surface"),
            Axis("height above the bed over d"), Axis("speed", "m/s"), [Curve("grains", z / d, u)],
            [Curve("Bagnold, I of the core", z / d, surface - law * s**1.5)],
            [
                misfit(
                    "exponent of s, core", exponent(s[core], u[core]), "-",
                    Band(1.4, 1.6, "-", "3/2, and a depth of some ten grains"),
                ),
                steady,
            ],
            settings, "The core is 0.2 to 0.8 of the depth, without the layers at the bed and the surface.",
        ),
        comparison(
            "inertial-number", "Inertial number over height",
            Source("steady flow down an incline: tau/p = tan(theta) everywhere, so I is uniform"),
            Axis("height above the bed over d"), Axis("I"), [Curve("grains", (z / d)[core], inertial[core])],
            [Curve("mean of the core", (z / d)[core], np.full(int(core.sum()), i_mean))],
            [
                misfit(
                    "largest relative difference, core", spread, "-", at_most(0.1, "a depth of ten grains")
                ),
                misfit("phi, largest relative difference, core", even, "-", at_most(0.05, "phi follows I")),
            ],
            settings,
            "With layers of half a diameter the layering of grains over the bed would be visible.",
        ),
    ]  # fmt: skip
