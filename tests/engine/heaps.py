"""Small heaps of every kind, and what it means that two engines agree on them."""

import math

import numpy as np
import pytest
from tests.engine.conftest import D, elastic_law

from ryusa.build import scene
from ryusa.laws.families import (
    Above,
    Arm,
    Buoyancy,
    ContactTiming,
    DampingLaw,
    Drag,
    Hindrance,
    Lift,
    Magnus,
    Profile,
    Rebound,
    Rolling,
    Slip,
    Unloading,
    WaterTorque,
)
from ryusa.model import RollingLaw, Water
from ryusa.model.fluid import A_X, EXTRA_X, N_SAMPLED, PHI, SHEAR, SUBMERGED, U
from ryusa.model.scene import EventRule

FLOW = Water(
    profile=Profile.LOG_ROUGH, u_star=0.1, k_rough=D, depth=2.5 * D, above=Above.DRY, drag=Drag.RE_04,
    torque=WaterTorque.DENNIS,
)  # fmt: skip
FILM = Water(
    profile=Profile.STILL, drag=Drag.SCHILLER_NAUMANN, asperity=0.01 * D, film_reach=0.05 * D,
    rebound=Rebound.EXPONENTIAL, torque=WaterTorque.STOKES,
)  # fmt: skip
COLUMN = Water(
    profile=Profile.COLUMN, drag=Drag.SCHILLER_NAUMANN, hindrance=Hindrance.DI_FELICE,
    buoyancy=Buoyancy.STRESS, lift=Lift.SAFFMAN_MEI, magnus=Magnus.LOTH, torque=WaterTorque.DENNIS,
)  # fmt: skip
EXACT = {"timing": ContactTiming.EXACT, "steps_per_contact": 8.0, "stir": 0.3, "walls": True}
KINDS = {
    "3D": {"events": EventRule.NONE},
    "3D, records": {},
    "plane, records": {"plane_case": True},
    "dashpot dropped": {"slip": Slip.SPRING_DROP},
    "capped together": {"slip": Slip.TOTAL},
    "capped together, plane": {"slip": Slip.TOTAL, "plane_case": True},
    "may pull, walls": {"tension": True, "walls": True},
    "no rotation": {"rotation": False, "events": EventRule.NONE},
    "flow, rolling spring, records": {
        "water": FLOW, "rolling": RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, 0.1), "events": EventRule.ALL,
    },
    "rolling as printed": {"rolling": RollingLaw(Rolling.PRINTED, Arm.CONTACT_WIDTH, 0.3)},
    "twisting, rolling spring": {
        "rolling": RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, 0.1, twisting=0.05),
    },
    "rolling, constant, plane": {
        "rolling": RollingLaw(Rolling.CONSTANT, Arm.REDUCED_RADIUS, 0.1), "plane_case": True,
    },
    "films": {"water": FILM},
    "column": {"water": COLUMN, "events": EventRule.NONE},
    "exact timing": {**EXACT, "events": EventRule.NONE},
    "exact timing, records": EXACT,
    "exact timing, plane, may pull": {**EXACT, "plane_case": True, "tension": True},
    "exact timing, dashpot dropped, no rotation": {
        **EXACT, "slip": Slip.SPRING_DROP, "rotation": False, "tension": True,
    },
    "exact timing, capped together, rolling spring": {
        **EXACT, "slip": Slip.TOTAL, "rolling": RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, 0.1),
    },
    "elastic spheres, 3D": {"contact": elastic_law(0.1, 2.0e6), "events": EventRule.NONE, "walls": True},
    "elastic spheres, plane, may pull, records": {
        "contact": elastic_law(0.1, 2.0e6, damping_law=DampingLaw.TSUJI, unloading=Unloading.PLAIN),
        "plane_case": True,
    },
    "elastic spheres, capped together, films, rolling": {
        "contact": elastic_law(0.1, 2.0e6, slip=Slip.TOTAL), "water": FILM,
        "rolling": RollingLaw(Rolling.EPSD, Arm.REDUCED_RADIUS, 0.1),
    },
    "exact timing, films": {**EXACT, "water": FILM},
    "exact timing, column": {**EXACT, "water": COLUMN, "events": EventRule.NONE},
}  # fmt: skip


def heap(plane_case=False, walls=False, seed=5, stir=0.1, **more):
    """Some twenty grains of several sizes that press on each other and on a rough bed, periodic."""
    rng = np.random.default_rng(seed)
    wide, deep, high = (5, 1, 4) if plane_case else (4, 3, 2)
    a, b, c = (
        g.ravel() for g in np.meshgrid(np.arange(wide), np.arange(deep), np.arange(high), indexing="ij")
    )
    pitch = 1.005 * D
    x = np.column_stack([a * pitch, b * pitch, (c + 0.97) * 0.985 * D])
    x += rng.uniform(-0.01, 0.01, x.shape) * D * [1.0, not plane_case, 1.0]
    bed = np.column_stack([a * pitch, b * pitch, rng.uniform(-0.02, 0.02, len(a)) * D])[c == 0]
    at_steps = {"timing": ContactTiming.AT_STEPS}
    kind = {"events": EventRule.ALL, "friction": 0.3, "stiffness": 2e3} | at_steps | more
    planes = [("lid", (0.0, 0.0, (high + 0.45) * D), (0.0, 0.0, -1.0))] if walls else []
    return scene(
        x, D * (1.0 + rng.uniform(-0.01, 0.005, len(x))), x_fixed=bed, d_fixed=D, planes=planes,
        v=rng.normal(0.0, stir, x.shape) * [1.0, not plane_case, 1.0], slope=math.radians(25.0),
        omega=rng.normal(0.0, 20.0, x.shape) * [not plane_case, 1.0, not plane_case],
        plane_case=plane_case, period=(wide * pitch, math.inf if plane_case else deep * pitch),
        allow_overlap=True, **kind,
    )  # fmt: skip


def told(fixed, seed=9):
    """Water at every grain, of every kind."""
    rng = np.random.default_rng(seed)
    seen = np.zeros((fixed.n_grain, N_SAMPLED))
    seen[:, U : U + 3] = rng.normal(0.2, 0.1, (fixed.n_grain, 3))
    seen[:, SHEAR], seen[:, PHI], seen[:, A_X] = 30.0, 0.3, rng.normal(0.0, 1.0, fixed.n_grain)
    seen[:, EXTRA_X : EXTRA_X + 2] = rng.normal(0.0, 1e-6, (fixed.n_grain, 2))
    seen[:, SUBMERGED] = rng.choice([0.0, 0.4, 1.0], fixed.n_grain)
    return seen


def loaded(engine, made):
    engine.load(*made)
    if made[0].water.profile == Profile.COLUMN:
        engine.set_fluid(told(made[0]))
    return engine


def apart(a, b, fixed):
    """Largest difference of two states' positions [m], whichever periodic image each engine holds."""
    off = a.x - b.x
    for axis, period in enumerate(fixed.period):
        if math.isfinite(period):
            off[:, axis] -= period * np.round(off[:, axis] / period)
    return float(np.abs(off).max())


def alike(mine, theirs, share):
    """Every sum and extreme agrees to this share of the largest."""
    held = ("kinetic", "spin", "potential", "spring_n", "spring_s", "spring_r")
    size = max(abs(getattr(theirs, name)) for name in held)
    assert [getattr(mine, name) for name in held] == pytest.approx(
        [getattr(theirs, name) for name in held], rel=1e-9, abs=share * size
    )
    assert mine.terms == pytest.approx(theirs.terms, rel=1e-9, abs=share * max(map(abs, theirs.terms)))
    for name in ("overlap_max", "speed_max", "spin_max", "t"):
        assert getattr(mine, name) == pytest.approx(getattr(theirs, name), rel=1e-9)
    assert (mine.n_contact, mine.overlap_grain) == (theirs.n_contact, theirs.overlap_grain)
