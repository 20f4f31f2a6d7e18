"""A sphere on a plane: it slides until it rolls, and rolling friction stops it."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.figures.comparison import Curve
from ryusa.laws.families import Arm, Rolling, Slip
from ryusa.model import ContactLaw, RollingLaw
from ryusa.model.arrays import Floats
from ryusa.study import Finding, Found, Plan, Task, calculation, relative
from ryusa_studies.validation.declared import declared

TITLE = "A sphere slides and rolls"
DECLARED = declared(__file__)
G, D, K_N = 9.80665, 2.0e-3, 1.0e3  # [m/s2], [m], [N/m]
MU, FAST = 0.3, 0.2  # sliding: [-], [m/s]
MU_R, SLOW = 0.05, 0.02  # rolling: [-], [m/s]
SHOTS = 41
MODELS = {"constant": Rolling.CONSTANT, "spring-dashpot-slider": Rolling.EPSD}


def slide() -> dict[str, Floats]:
    """Speed [m/s] and spin [rad/s] over time [s] of a sphere set down with speed and no spin."""
    law = ContactLaw(k_n=K_N, k_s=2 / 7 * K_N, mu=MU, zeta_n=0.3, zeta_s=0.3, slip=Slip.SPRING_DROP)
    return _watch(law, None, FAST, 0.0, 2.0 * 2.0 * FAST / (7.0 * MU * G))


def roll(model: str) -> dict[str, Floats]:
    """Place [m] and speed [m/s] over time [s] of a sphere that rolls against rolling friction."""
    law = ContactLaw(k_n=K_N, k_s=2 / 7 * K_N, mu=0.5, zeta_n=0.3, zeta_s=0.3)
    # without its dashpot, which would brake harder than the slider until the slider moves
    rolling = RollingLaw(MODELS[model], Arm.REDUCED_RADIUS, MU_R, zeta_r=0.0)
    return _watch(law, rolling, SLOW, SLOW / (0.5 * D), 1.5 * SLOW / (5.0 / 7.0 * MU_R * G))


def _watch(
    law: ContactLaw, rolling: RollingLaw | None, v: float, omega: float, time: float
) -> dict[str, Floats]:
    probe, _ = scene([[0.0, 0.0, 1.0]], D, contact=law)
    sunk = float(probe.m[0]) * G / law.k_n
    fixed, first = scene(
        [[0.0, 0.0, 0.5 * D - sunk]], D, v=[[v, 0.0, 0.0]], omega=[[0.0, omega, 0.0]],
        planes=[("floor", (0, 0, 0), (0, 0, 1))], contact=law, rolling=rolling, gravity=G, plane_case=True,
        allow_overlap=True,
    )  # fmt: skip
    engine = registry.create()
    engine.load(fixed, first)
    every = max(1, math.ceil(time / fixed.dt / (SHOTS - 1)))
    rows: list[tuple[float, float, float, float]] = []
    for shot in range(SHOTS):
        if shot:
            engine.advance(every).raise_if_any()
        now = engine.state()
        rows.append((now.t, float(now.x[0, 0]), float(now.v[0, 0]), float(now.omega[0, 1])))
    t, x, speed, spin = np.array(rows).T
    return {"t": t, "x": x, "v": speed, "omega": spin}


def _roll(model: str) -> Task:
    return calculation(roll, model=model)


def tasks(plan: Plan) -> Sequence[Task]:
    """Sliding into rolling, and both laws of rolling friction, at both levels."""
    del plan
    return [calculation(slide), *(_roll(one) for one in MODELS)]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Speed while sliding and after it; way until it stops."""
    del plan
    return [_slides(found), *(_stops(found, one) for one in MODELS)]


def _slides(found: Found) -> Finding:
    ours = found[calculation(slide)]
    t = ours["t"]
    law = np.maximum(FAST - MU * G * t, 5.0 / 7.0 * FAST)
    return DECLARED["slide-to-roll"].finding(
        [Curve("speed", t, ours["v"]), Curve("spin times radius", t, 0.5 * D * ours["omega"])],
        [
            Curve("speed", t, law),
            Curve("spin times radius", t, np.minimum(2.5 * MU * G * t, 5.0 / 7.0 * FAST)),
        ],
        {"difference": relative(ours["v"], law), "last": abs(float(ours["v"][-1] / law[-1]) - 1.0)},
    )  # fmt: skip


def _stops(found: Found, model: str) -> Finding:
    ours = found[_roll(model)]
    t, brake = ours["t"], 5.0 / 7.0 * MU_R * G
    until = np.minimum(t, SLOW / brake)
    law = SLOW * until - 0.5 * brake * until**2
    stop = 0.5 * SLOW**2 / brake
    return DECLARED["stops-{model}"].finding(
        [Curve("way", t, 1e3 * ours["x"])], [Curve("way", t, 1e3 * law)],
        {"difference": relative(ours["x"], law), "distance": abs(float(ours["x"][-1]) / stop - 1.0)},
        model=model,
    )  # fmt: skip
