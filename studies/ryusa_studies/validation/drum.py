"""Grains in a drum that turns: angle of their surface over the Froude number, and the torque on the drum."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Axis, Curve
from ryusa.measure import dynamic_angle
from ryusa.measure.walls import walls
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
    at_most,
    case_run,
    comparison,
    misfit,
    over_seeds,
)
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "Grains in a drum"
G, RADIUS = 9.80665, 0.03  # [m/s2], of the case file [m]
FROUDE = (0.003, 0.01, 0.03, 0.1)  # omega^2 R/g
SLOW, SAME, FAST = FROUDE[0], FROUDE[1], FROUDE[2]
MORE = 4.0  # gravity of other runs over G; at SAME, and at the speed that has SAME under G
SETTLED, TURNED, MEASURED = 0.4, 0.25, 0.6  # [s], then turns that are left out, and measured
LEAST = 1.0  # measured [s]
ROUNDED, ANGULAR = 25.0, 40.0  # angles in slow drums, Kleinhans et al. 2011 [deg]


def _run(froude: float, more: float, seed: int) -> CaseRun:
    rate = math.sqrt(froude * more * G / RADIUS)
    turn = 2.0 * math.pi / rate
    begin = SETTLED + TURNED * turn
    changed = {
        "motion.gravity": f"{more * G:.6g} m/s2",
        "walls.0.angular_velocity": f'["0 rad/s", "{rate:.6g} rad/s", "0 rad/s"]',
        "record.settle": f"{begin:.2f} s",
        "stop.time": f"{begin + max(MEASURED * turn, LEAST):.2f} s",
    }
    return case_run(case_path("drum.toml"), changed, seed=seed)


def _all() -> list[tuple[float, float]]:
    """Froude number and gravity over G of every run of a seed."""
    return [*((one, 1.0) for one in FROUDE), (SAME, MORE), (SAME / MORE, MORE)]


def tasks(plan: Plan) -> Sequence[Task]:
    """Runs of a minute or less, at the full level alone: the others have an hour on two cores."""
    if plan.level is not Level.FULL:
        return []
    return [_run(*one, seed) for seed in SAMPLING["drum"].seeds(plan) for one in _all()]


def measure(run: Results, one: CaseRun) -> dict[str, float]:
    """Angles of surface and centre of mass [deg], torque on the drum, and weight times offset [N m]."""
    del one
    found = dynamic_angle(run)
    gravity = float(np.linalg.norm(run.scene.gravity))
    return {
        "angle": math.degrees(float(np.nanmean(found.surface))),
        "by_mass": math.degrees(float(found.mass.mean())),
        "torque": -float(walls(run).torque[:, 0, 1].mean()),
        "moment": float(run.scene.m.sum()) * gravity * float(found.offset.mean()),
    }


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Balance of the torque, and the angle over the Froude number under two gravities."""
    if plan.level is not Level.FULL:
        return []
    seeds = SAMPLING["drum"].seeds(plan)

    def each(key: str, froude: float, more: float = 1.0) -> Floats:
        return np.array([float(found[_run(froude, more, seed)][key]) for seed in seeds])

    def means(key: str) -> Floats:
        return np.array([float(each(key, one).mean()) for one in FROUDE])

    differences = np.array([np.abs(each("torque", *one) / each("moment", *one) - 1.0) for one in _all()])
    axis, settings = Axis("Froude number omega^2 R/g"), {
        "grains": "2 mm, +- 10 %", "friction": "0.5, also on the ends", "rolling friction": "none",
        "drum": "6 cm wide, 1.1 cm long, a quarter full",
    }  # fmt: skip
    more = np.array([SAME / MORE, SAME])
    heavy = np.array([float(each("angle", float(one), MORE).mean()) for one in more])
    scaled = each("angle", SAME, MORE) - each("angle", SAME)
    slowed = each("angle", SAME / MORE, MORE) - each("angle", SAME)
    return [
        comparison(
            "torque", "Torque on the drum and moment of the weight of its grains",
            Source("steady rotation: torque = weight times the offset of the centre of mass"),
            axis, Axis("torque", "N m"),
            [Curve("on the drum", np.array(FROUDE), means("torque"))],
            [Curve("weight times offset", np.array(FROUDE), means("moment"))],
            [
                misfit(
                    "largest relative difference", over_seeds(differences.max(axis=0).tolist(), "-"), "-",
                    at_most(0.01, "the angular momentum of the grains changes by little in half a turn"),
                ),
            ],
            settings,
        ),
        comparison(
            "froude", "Angle of the surface over the Froude number",
            Source(
                "Granular Flow in a Tumbler Under Variable g-Levels, APS DFD 2005, abstract: glass beads at "
                "1 to 25 g; the angle falls with g at a given speed, and is the same at the same such number",
                Known.QUOTED,
            ),
            axis, Axis("angle", "deg"),
            [
                Curve("surface", np.array(FROUDE), means("angle")),
                Curve("centre of mass", np.array(FROUDE), means("by_mass")),
                Curve("surface, 4 g", more, heavy),
            ],
            [],
            [
                misfit(
                    "angle under 4 g less that under g, same Froude number",
                    over_seeds(scaled.tolist(), "deg"), "deg",
                    Band(-2.0, 2.0, "deg", "the same, with the scatter of a drum of a thousand grains"),
                ),
                misfit(
                    "angle under 4 g less that under g, same speed",
                    over_seeds(slowed.tolist(), "deg"), "deg",
                    Band(-math.inf, 0.0, "deg", "it falls with gravity"),
                ),
                misfit(
                    f"angle at {FAST:g} less that at {SLOW:g}",
                    over_seeds((each("angle", FAST) - each("angle", SLOW)).tolist(), "deg"), "deg",
                    Band(0.0, math.inf, "deg", "it rises with the Froude number"),
                ),
                misfit(
                    f"surface less centre of mass at {SAME:g}",
                    over_seeds((each("angle", SAME) - each("by_mass", SAME)).tolist(), "deg"), "deg",
                ),
            ],
            settings,
        ),
        _beside_experiments(each("angle", SLOW), means("angle"), settings),
    ]  # fmt: skip


def _beside_experiments(slow: Floats, angles: Floats, settings: Mapping[str, str]) -> Finding:
    """Set the angle at the lowest Froude number, one for each seed [deg], beside published ones."""
    return comparison(
        "experiments", "Angle of the surface of a slow drum",
        Source(
            "Kleinhans et al. 2011, J. Geophys. Res. 116, E11004, abstract: avalanches in drums, 0.1 to "
            "1 g, in the mean about 25 deg with rounded and about 40 deg with angular grains",
            Known.READ,
        ),
        Axis("Froude number omega^2 R/g"), Axis("angle", "deg"),
        [Curve("surface", np.array(FROUDE), angles)],
        [
            Curve("rounded grains", np.array(FROUDE), np.full(len(FROUDE), ROUNDED)),
            Curve("angular grains", np.array(FROUDE), np.full(len(FROUDE), ANGULAR)),
        ],
        [
            misfit(
                f"angle at {SLOW:g}", over_seeds(slow.tolist(), "deg"), "deg",
            ),  # a band made when the angle was known is registered, and judges nothing
        ],
        settings,
        "The abstract gives no Froude number. The ends of a short drum carry grains too.",
    )  # fmt: skip
