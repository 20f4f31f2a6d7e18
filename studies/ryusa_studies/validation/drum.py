"""Grains in a drum that turns: angle of their surface over the Froude number, and the torque on the drum."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.figures.comparison import Curve
from ryusa.measure import dynamic_angle
from ryusa.measure.walls import walls
from ryusa.model.arrays import Floats
from ryusa.results import Results
from ryusa.study import CaseRun, Finding
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampled import SampledRuns, SeedNumbers

TITLE = "Grains in a drum"
DECLARED = declared(__file__)
G, RADIUS = 9.80665, 0.03  # [m/s2], of the case file [m]
FROUDE = (0.003, 0.01, 0.03, 0.1)  # omega^2 R/g
SLOW, SAME, FAST = FROUDE[0], FROUDE[1], FROUDE[2]
MORE = 4.0  # gravity of other runs over G; at SAME, and at the speed that has SAME under G
SETTLED, TURNED, MEASURED = 0.4, 0.25, 0.6  # [s], then turns that are left out, and measured
LEAST = 1.0  # measured [s]
ROUNDED, ANGULAR = 25.0, 40.0  # angles in slow drums, Kleinhans et al. 2011 [deg]


def _changed(froude: float, more: float) -> dict[str, str]:
    rate = math.sqrt(froude * more * G / RADIUS)
    turn = 2.0 * math.pi / rate
    begin = SETTLED + TURNED * turn
    return {
        "motion.gravity": f"{more * G:.6g} m/s2",
        "walls.0.angular_velocity": f'["0 rad/s", "{rate:.6g} rad/s", "0 rad/s"]',
        "record.settle": f"{begin:.2f} s",
        "stop.time": f"{begin + max(MEASURED * turn, LEAST):.2f} s",
    }


# Froude number and gravity over G of every run of a seed
ALL = [*((one, 1.0) for one in FROUDE), (SAME, MORE), (SAME / MORE, MORE)]
RUNS = SampledRuns("drum", "drum.toml", {one: _changed(*one) for one in ALL})
tasks = RUNS.tasks


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


@RUNS.judge
def judge(runs: SeedNumbers) -> Sequence[Finding]:
    """Balance of the torque, and the angle over the Froude number under two gravities."""

    def each(key: str, froude: float, more: float = 1.0) -> Floats:
        return runs(key, (froude, more))

    def means(key: str) -> Floats:
        return runs.means(key, [(one, 1.0) for one in FROUDE])

    differences = np.array([np.abs(each("torque", *one) / each("moment", *one) - 1.0) for one in ALL])
    froude, more = np.array(FROUDE), np.array([SAME / MORE, SAME])
    heavy = runs.means("angle", [(float(one), MORE) for one in more])
    scaled = each("angle", SAME, MORE) - each("angle", SAME)
    slowed = each("angle", SAME / MORE, MORE) - each("angle", SAME)
    return [
        DECLARED["torque"].finding(
            [Curve("on the drum", froude, means("torque"))],
            [Curve("weight times offset", froude, means("moment"))],
            {"difference": differences.max(axis=0)},
        ),
        DECLARED["froude"].finding(
            [
                Curve("surface", froude, means("angle")),
                Curve("centre of mass", froude, means("by_mass")),
                Curve("surface, 4 g", more, heavy),
            ],
            [],
            {
                "same-froude": scaled, "same-speed": slowed,
                "fast": each("angle", FAST) - each("angle", SLOW),
                "by-mass": each("angle", SAME) - each("by_mass", SAME),
            },
        ),
        DECLARED["experiments"].finding(
            [Curve("surface", froude, means("angle"))],
            [
                Curve("rounded grains", froude, np.full(len(FROUDE), ROUNDED)),
                Curve("angular grains", froude, np.full(len(FROUDE), ANGULAR)),
            ],
            {"angle": each("angle", SLOW)},
        ),
    ]  # fmt: skip
