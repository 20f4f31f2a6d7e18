"""A gas of inelastic grains cools as Haff says."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.figures.comparison import Curve
from ryusa.laws import collision
from ryusa.model import ContactLaw
from ryusa.model.arrays import Floats
from ryusa.model.scene import EventRule
from ryusa.study import Finding, Found, Level, Plan, Task, at_most, calculation, largest_mean, misfit
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "A granular gas cools"
DECLARED = declared(__file__)
E, PHI = 0.9, 0.02
# Of the first lattice, 2450 grains; the box is periodic along and across, floor and lid stop z.
WIDE, HIGH = 7, 50
D, SPEED = 1.0e-3, 0.1  # [m]; root of T_0/m [m/s]
OVERLAP = 0.01  # over d, of a grain at 2 SPEED
STEPS = 10.0  # in a contact, whose restitution is exact
SHOTS = 61


def cooling_time(height: float) -> float:
    """Time tau_0 of T = T_0/(1 + t/tau_0)**2 [s] in a box of that height [m]."""
    density = PHI * 6.0 / math.pi / D**3
    chi = (1.0 - 0.5 * PHI) / (1.0 - PHI) ** 3
    among = (1.0 - E**2) / 3.0 * 4.0 * math.sqrt(math.pi) * chi * density * D**2 * SPEED
    walls = 4.0 / 3.0 * (1.0 - E**2) * SPEED / math.sqrt(2.0 * math.pi) / height
    return 2.0 / (among + walls)


def cool(seed: int, times: float) -> dict[str, Floats]:
    """Granular temperature over the first [-] over time over tau_0 [-]."""
    rng = np.random.default_rng(seed)
    pitch = (math.pi / 6.0 / PHI) ** (1.0 / 3.0) * D
    a, b, c = (
        g.ravel() for g in np.meshgrid(np.arange(WIDE), np.arange(WIDE), np.arange(HIGH), indexing="ij")
    )
    x = (np.column_stack([a, b, c]) + 0.5) * pitch
    v = rng.normal(0.0, SPEED, x.shape)
    v -= v.mean(axis=0)
    v *= SPEED / np.sqrt((v**2).mean())
    zeta = collision.zeta_no_tension(E)
    probe, _ = scene([[0.0, 0.0, 1.0]], D)
    k_n = collision.stiffness_for_overlap(OVERLAP * D, 2.0 * SPEED, 0.5 * float(probe.m[0]), zeta)
    law = ContactLaw(k_n=k_n, k_s=0.0, mu=0.0, zeta_n=zeta)
    height = HIGH * pitch
    fixed, first = scene(
        x, D, v=v, contact=law, gravity=0.0, rotation=False, period=(WIDE * pitch, WIDE * pitch),
        planes=[("floor", (0, 0, -0.5 * D), (0, 0, 1)), ("lid", (0, 0, height + 0.5 * D), (0, 0, -1))],
        steps_per_contact=STEPS, events=EventRule.NONE,
    )  # fmt: skip
    engine = registry.create()
    engine.load(fixed, first)
    tau = cooling_time(height)
    every = max(1, round(times * tau / fixed.dt / (SHOTS - 1)))
    t, hot = [0.0], [1.0]
    for _ in range(SHOTS - 1):
        engine.advance(every).raise_if_any()
        now = engine.state()
        t.append(now.t / tau)
        hot.append(float((now.v**2).mean()) / SPEED**2)
    return {"t": np.array(t), "T": np.array(hot)}


def tasks(plan: Plan) -> Sequence[Task]:
    """Independent gases, in quick one for a short while."""
    times, seeds = SAMPLING["gas"].length(plan.level), SAMPLING["gas"].seeds(plan)
    return [calculation(cool, seed=seed, times=times, seconds=2.0 * times) for seed in seeds]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Slope of 1/sqrt(T): what it cools, over what Haff says."""
    every = [found[one] for one in tasks(plan)]
    t, hot = (np.mean([one[key] for one in every], axis=0) for key in ("t", "T"))
    off = [1.0 / float(np.polyfit(one["t"], 1.0 / np.sqrt(one["T"]), 1)[0]) - 1.0 for one in every]
    return [
        DECLARED["haff"].finding(
            [Curve("2450 grains", t, hot)], [Curve("Haff", t, (1.0 + t) ** -2.0)],
            {
                "tau_0": misfit(
                    "tau_0 over that of theory, less 1", largest_mean([off], "-", absolute=True), "-",
                    at_most(
                        0.15 if plan.level is Level.QUICK else 0.03,
                        "statistics of collisions, and finite contact times",
                    ),
                ),
            },
            gases=len(every), single=", ".join(f"{100.0 * one:+.1f} %" for one in off),
        )
    ]  # fmt: skip
