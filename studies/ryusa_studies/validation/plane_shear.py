"""Plane shear at constant pressure: friction over the inertial number."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Axis, Curve
from ryusa.figures.plane_shear import GLASS_BEADS
from ryusa.laws.dense_flow import mu_of_inertial_number
from ryusa.measure import plane_shear
from ryusa.model.arrays import Floats
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
    case_run,
    comparison,
    misfit,
    over_seeds,
)
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "Plane shear at constant pressure"
SPEEDS = {0.12: 1.4, 0.3: 1.0, 0.8: 0.8}  # of the lid [m/s], and length of a run [s]
CONTROL = 0.12  # speed at which grains without friction are sheared too [m/s]
FRICTION = 0.5  # of the case file
NEAR = 0.15  # of the law of glass beads, in which grains with friction are to lie


def _run(speed: float, friction: float, seed: int) -> CaseRun:
    # less stiff than the case: k_n/(P d) of 2500, three quarters of the steps
    changed = {
        "walls.1.velocity": f'["{speed:g} m/s", "0 m/s", "0 m/s"]',
        "contact.friction": f"{friction:g}", "contact.stiffness": "2500 N/m",
        "stop.time": f"{SPEEDS[speed]:g} s",
    }  # fmt: skip
    return case_run(case_path("shear_cell.toml"), changed, seed=seed)


def _all() -> list[tuple[float, float]]:
    """Speed and friction of every run of a seed."""
    return [*((one, FRICTION) for one in SPEEDS), (CONTROL, 0.0)]


def tasks(plan: Plan) -> Sequence[Task]:
    """Runs of half a minute, at the full level alone: the others have an hour on two cores."""
    if plan.level is not Level.FULL:
        return []
    return [_run(*one, seed) for seed in SAMPLING["plane_shear"].seeds(plan) for one in _all()]


def measure(run: Results, one: CaseRun) -> dict[str, float]:
    """Friction, inertial number and concentration [-], and what steady linear shear does not have [-]."""
    del one
    found = plane_shear(run)
    return {
        "mu": found.mu, "inertial": found.inertial, "phi": found["phi"].value,
        "curvature": found.curvature, "unbalanced": abs(found.base + 1.0),
    }  # fmt: skip


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Friction beside the law of glass beads, and whether the shear was linear and steady."""
    if plan.level is not Level.FULL:
        return []
    seeds = SAMPLING["plane_shear"].seeds(plan)

    def each(key: str, speed: float, friction: float = FRICTION) -> Floats:
        return np.array([float(found[_run(speed, friction, seed)][key]) for seed in seeds])

    def means(key: str) -> Floats:
        return np.array([float(each(key, speed).mean()) for speed in SPEEDS])

    def over_law(speed: float, friction: float = FRICTION) -> list[float]:
        inertial, mu = each("inertial", speed, friction), each("mu", speed, friction)
        return [m / mu_of_inertial_number(i, *GLASS_BEADS) for i, m in zip(inertial, mu, strict=True)]

    inertial, axis = means("inertial"), Axis("inertial number")
    fine = np.geomspace(0.5 * inertial.min(), 2.0 * inertial.max(), 60)
    law = np.array([mu_of_inertial_number(float(one), *GLASS_BEADS) for one in fine])
    settings = {
        "grains": "2 mm, +- 20 %", "friction": f"{FRICTION:g}", "restitution": "0.7",
        "k_n/(P d)": "2500", "cell": "12 x 9 diameters, periodic, 9 high, plates with ridges",
    }  # fmt: skip
    curvature = np.max([each("curvature", speed) for speed in SPEEDS], axis=0)
    unbalanced = np.max([each("unbalanced", speed) for speed in SPEEDS], axis=0)
    smooth = np.array([each("inertial", CONTROL, 0.0).mean()]), np.array([each("mu", CONTROL, 0.0).mean()])
    return [
        comparison(
            "friction", "Friction over the inertial number",
            Source(
                "Jop, Forterre & Pouliquen 2006: mu = mu_s + (mu_2 - mu_s)/(I_0/I + 1), glass beads, as "
                "quoted in public codes: tan(20.9 deg), tan(32.76 deg), 0.279",
                Known.QUOTED,
            ),
            axis, Axis("friction"),
            [Curve("grains", inertial, means("mu")), Curve("without friction", *smooth)],
            [Curve("glass beads", fine, law)],
            [
                *(
                    misfit(
                        f"friction over that of the law, lid at {speed:g} m/s",
                        over_seeds(over_law(speed), "-"), "-",
                        Band(1.0 - NEAR, 1.0 + NEAR, "-", "beads differ from spheres of one friction"),
                    )
                    for speed in SPEEDS
                ),
                misfit(
                    f"control: grains without friction, lid at {CONTROL:g} m/s",
                    over_seeds(over_law(CONTROL, 0.0), "-"), "-",
                    Band(-math.inf, 0.75, "-", "well below the band of grains with friction"),
                ),
            ],
            settings,
        ),
        comparison(
            "steady", "Shear that is steady and the same at all heights",
            Source("without gravity, stress and inertial number are uniform, and so is the shear rate"),
            axis, Axis("concentration"),
            [Curve("grains", inertial, means("phi"))], [],
            [
                misfit(
                    "velocity from a line, over its range, middle 60 % of the grains",
                    over_seeds(curvature.tolist(), "-"), "-",
                    Band(-math.inf, 0.1, "-", "half a layer of grains"),
                ),
                misfit(
                    "shear force on the base over that on the lid, less 1",
                    over_seeds(unbalanced.tolist(), "-"), "-",
                    Band(-math.inf, 0.05, "-", "the momentum stored is bounded: the error falls as 1/time"),
                ),
            ],
            settings,
        ),
    ]  # fmt: skip
