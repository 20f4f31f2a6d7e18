"""Impacts of two elastic spheres that spin: Chung & Ooi, tests 7 and 8."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.build import Material, scene
from ryusa.engine import registry
from ryusa.figures.comparison import Curve
from ryusa.laws.families import DampingLaw, Slip, Unloading
from ryusa.model.arrays import Floats
from ryusa.model.contact_law import contact_time_of, elastic_spheres
from ryusa.study import Finding, Found, Level, Plan, Task, calculation
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.hertz_oblique import (
    DASHPOTS,
    E_6,
    LARGE,
    MATERIALS,
    MU_6,
    SLIDES_6,
    SLOW,
    STEPS,
    with_dashpot,
)

TITLE = "Impact of two elastic spheres that spin"
DECLARED = declared(__file__)
YOUNG, NU, RHO = MATERIALS["aluminium alloy"]
R, SPEED, MU, E = LARGE, SLOW, MU_6, E_6  # of test 6: radius [m], speed [m/s], friction, restitution
SPINS = (0.175, 0.6, 2.0, 6.0, 21.0)  # of both spheres, opposite to each other, test 7 [rad/s]
LARGER, HEAVIER = 5.0, 1000.0  # radius and density of the second sphere of test 8, over those of the first
BETA = DECLARED["two-spheres"].points["B"]  # test 8, case B


def test_7() -> dict[str, Floats]:
    """`along`, velocity along the contact, and `kept`, change of spin, each over that of the surface [-].

    Two equal spheres that spin against each other as two gears do: their surfaces do not move on each other.
    """
    along, kept = list[float](), list[float]()
    for spin in SPINS:
        (v_1, w_1), (v_2, w_2) = _impact(1.0, 1.0, SPEED, (spin, -spin), "with", DampingLaw.TSUJI)
        along.append(max(abs(v_1[0]), abs(v_2[0])) / (R * spin))
        kept.append(max(abs(w_1 - spin), abs(w_2 + spin)) / spin)
    return {"along": np.array(along), "kept": np.array(kept)}


def test_8(dashpot: str, damping_law: str) -> dict[str, Floats]:
    """Tangential restitution `beta` of the contact point at the abscissae of BETA [-]."""
    beta: list[float] = []
    for q in BETA[:, 0].tolist():
        v_t = 3.5 * MU * (1.0 + E) * SPEED / q
        spins = (-v_t / R, 0.0)
        (v, w), _second = _impact(LARGER, HEAVIER, 0.0, spins, dashpot, DampingLaw.of(damping_law))
        beta.append(-(v[0] - R * w) / v_t)
    return {"beta": np.array(beta)}


def _impact(
    larger: float, heavier: float, speed: float, spins: tuple[float, float], dashpot: str, damping: DampingLaw
) -> list[tuple[Floats, float]]:
    """Velocity [m/s] and spin [rad/s] of both spheres after the upper one has come down on the lower one."""
    radius, rho = R * np.array((1.0, larger)), RHO * np.array((1.0, heavier))
    m = rho * 4.0 / 3.0 * math.pi * radius**3
    m_e, r_e = float(m[0] * m[1] / m.sum()), float(radius[0] * radius[1] / radius.sum())
    law = elastic_spheres(
        m_e, r_e, youngs_modulus=YOUNG, poisson_ratio=NU, speed=SPEED + speed, friction=MU, restitution=E,
        damping_law=damping, unloading=Unloading.PLAIN, slip=Slip.TOTAL,
    )  # fmt: skip
    law = with_dashpot(law, dashpot)
    dt = contact_time_of(law, m_e, r_e, SPEED + speed) / STEPS
    apart = float(radius.sum()) + 0.5 * (SPEED + speed) * dt
    of, engine = ("upper", "lower"), registry.create()
    engine.load(*scene(
        [[0.0, 0.0, apart], [0.0, 0.0, 0.0]], 2.0 * radius,
        materials=[Material(name, density=one) for name, one in zip(of, rho, strict=True)],
        made_of={"grains": of},
        v=[[0.0, 0.0, -SPEED], [0.0, 0.0, speed]], omega=[[0.0, spins[0], 0.0], [0.0, spins[1], 0.0]],
        contact=law, dt=dt, gravity=0.0,
    ))  # fmt: skip
    engine.advance(int(1.5 * STEPS)).raise_if_any()
    if len(engine.events()) != 1:
        raise ValueError("two spheres that meet once left no record of one contact")
    state = engine.state()
    return [(state.v[k], float(state.omega[k, 1])) for k in range(2)]


def _test_7() -> Task:
    return calculation(test_7, seconds=0.1)


def _test_8(dashpot: str, damping_law: DampingLaw) -> Task:
    return calculation(test_8, dashpot=dashpot, damping_law=damping_law.word, seconds=0.1)


def tasks(plan: Plan) -> Sequence[Task]:
    """Test 7, and test 8 with and without a tangential dashpot; none when quick, as of single impacts."""
    if plan.level is Level.QUICK:
        return []
    return [_test_7(), *(_test_8(one, law) for one in DASHPOTS for law in DampingLaw)]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """What two spheres as gears leave of their spin, and tangential restitution of test 8."""
    return [] if plan.level is Level.QUICK else [_gears(found), _tangential_restitution(found)]


def _gears(found: Found) -> Finding:
    ours, spins, none = found[_test_7()], np.array(SPINS), np.zeros(len(SPINS))
    return DECLARED["gears"].finding(
        [Curve("velocity along the contact", spins, ours["along"])], [Curve("none", spins, none)],
        {"along": ours["along"].max(), "spin": ours["kept"].max()},
    )  # fmt: skip


def _tangential_restitution(found: Found) -> Finding:
    q, read = BETA.T
    slides, sticks = q < SLIDES_6, q > SLIDES_6
    ours = {one: found[_test_8(one, DampingLaw.THORNTON)]["beta"] for one in DASHPOTS}
    pulls = {one: found[_test_8(one, DampingLaw.TSUJI)]["beta"] for one in DASHPOTS}
    closed = max(float(np.abs(one - (q - 1.0))[slides].max()) for one in ours.values())
    digitised = max(float(np.abs(one - read)[slides].max()) for one in ours.values())
    return DECLARED["two-spheres"].finding(
        [Curve(f"{one} dashpot, Tsuji", q, pulls[one]) for one in DASHPOTS], [Curve("Chung & Ooi", q, read)],
        {
            "slides": closed, "slides-read": digitised,
            **{one: float(np.abs(pulls[one] - read)[sticks].max()) for one in DASHPOTS},
        },
    )  # fmt: skip
