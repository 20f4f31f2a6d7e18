"""Elastic spheres: impacts after Hertz at several speeds, and oblique ones that slide throughout."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.figures.comparison import Curve
from ryusa.laws import hertz
from ryusa.laws.families import DampingLaw, Slip
from ryusa.model import ContactLaw
from ryusa.model.arrays import Floats
from ryusa.model.contact_law import contact_time_of, elastic_spheres, hertz_stiffness_of, largest_overlap_of
from ryusa.study import Finding, Found, Plan, Task, calculation
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.impact import ANGLES, DENSITY, FAST, LIMIT, MU, RADIUS, TEST_4, E, sliding

TITLE = "Impact of elastic spheres"
DECLARED = declared(__file__)
# Chung & Ooi 2011: Young's modulus [Pa], Poisson's ratio [-], density [kg/m3], radius [m], closing speed
# [m/s]; a rigid wall takes twice the modulus, since 1/E_e is then that of one body
TESTS = {
    "test 1, glass": (4.8e10, 0.20, 2800.0, 0.010, 20.0),
    "test 1, limestone": (2.0e10, 0.25, 2500.0, 0.010, 20.0),
    "test 2, aluminium alloy": (2.0 * 7.0e10, 0.30, 2699.0, 0.100, 0.2),
    "test 2, magnesium alloy": (2.0 * 4.0e10, 0.35, 1800.0, 0.100, 0.2),
}
ASKED = (0.2, 0.4, 0.6, 0.8, 0.98)  # restitution; test 3 and beyond
SPEEDS = (0.01, 0.1, 1.0)  # [m/s]
STEPS, FINE = 25.0, 400.0  # steps in a contact: by default, and near the limit
PHASES = 20  # of the step at which the grains first touch
YOUNG, NU = 3.8e11, 0.23  # of aluminium oxide, tests 3 and 4 [Pa], [-]


def head_on(name: str, per_contact: float) -> dict[str, Floats]:
    """Contact time, largest overlap and largest force, each over that of Hertz."""
    young, nu, rho, r, speed = TESTS[name]
    two = name.startswith("test 1")
    m = rho * 4.0 / 3.0 * math.pi * r**3 * (0.5 if two else 1.0)
    r_eff = 0.5 * r if two else r
    law = elastic_spheres(
        m, r_eff, youngs_modulus=young, poisson_ratio=nu, speed=speed, friction=0.35, restitution=1.0
    )
    t_col, largest = contact_time_of(law, m, r_eff, speed), largest_overlap_of(law, m, r_eff, speed)
    dt = t_col / per_contact
    gap = 3.5 * speed * dt
    if two:
        x, v, planes = (
            [[0.0] * 3, [0.0, 0.0, 2.0 * r + gap]],
            [[0.0, 0.0, 0.5 * speed], [0.0, 0.0, -0.5 * speed]],
            [],
        )
    else:
        x, v, planes = [[0.0, 0.0, r + gap]], [[0.0, 0.0, -speed]], [("wall", (0, 0, 0), (0, 0, 1))]
    engine = registry.create()
    engine.load(*scene(x, 2.0 * r, density=rho, v=v, planes=planes, contact=law, dt=dt, gravity=0.0))
    force = 0.0
    for _ in range(int(8 + 1.2 * per_contact)):
        engine.advance(1).raise_if_any()
        force = max(force, float(engine.state().contacts.f_n.max(initial=0.0)))
    (event,) = engine.events()
    return {
        "time": np.array([(event["t_end"] - event["t_begin"]) / t_col]),
        "overlap": np.array([event["overlap_max"] / largest]),
        "force": np.array([force / hertz.hertz_force(largest, hertz_stiffness_of(law, r_eff))]),
    }


def bounce(e: float, damping_law: str) -> dict[str, Floats]:
    """Restitution at SPEEDS for each phase of first touch, with the step of the fastest impact."""
    m = DENSITY * 4.0 / 3.0 * math.pi * RADIUS**3
    law = _aluminium_oxide(m, max(SPEEDS), e, DampingLaw.of(damping_law))
    dt = contact_time_of(law, m, RADIUS, max(SPEEDS)) / STEPS
    got = np.zeros((len(SPEEDS), PHASES))
    for k, speed in enumerate(SPEEDS):
        steps = int(8 + 2.0 * contact_time_of(law, m, RADIUS, speed) / dt)
        for p in range(PHASES):
            gap = (3.0 + p / PHASES) * speed * dt
            engine = registry.create()
            engine.load(*scene(
                [[0.0, 0.0, RADIUS + gap]], 2.0 * RADIUS, density=DENSITY, v=[[0.0, 0.0, -speed]],
                planes=[("wall", (0, 0, 0), (0, 0, 1))], contact=law, dt=dt, gravity=0.0,
            ))  # fmt: skip
            engine.advance(steps).raise_if_any()
            (event,) = engine.events()
            got[k, p] = -event["closing_end"] / event["closing_begin"]
    return {"e": got}


def oblique(per_contact: float) -> dict[str, Floats]:
    """Test 4 of Chung & Ooi: e_t [-], spin [rad/s], rebound angle of the contact point [deg] for ANGLES."""
    m = DENSITY * 4.0 / 3.0 * math.pi * RADIUS**3
    rows: list[tuple[float, float, float]] = []
    for degrees in ANGLES:
        angle = math.radians(degrees)
        normal = FAST * math.cos(angle)
        law = _aluminium_oxide(m, normal, E, DampingLaw.THORNTON)
        dt = contact_time_of(law, m, RADIUS, normal) / per_contact
        engine = registry.create()
        engine.load(*scene(
            [[0.0, 0.0, RADIUS + 0.5 * normal * dt]], 2.0 * RADIUS, density=DENSITY,
            v=[[FAST * math.sin(angle), 0.0, -normal]], planes=[("wall", (0, 0, 0), (0, 0, 1))], contact=law,
            dt=dt, gravity=0.0,
        ))  # fmt: skip
        engine.advance(int(1.5 * per_contact)).raise_if_any()
        (event,) = engine.events()
        v_x, v_z, spin = (float(one) for one in (event["v_end"][0], event["v_end"][2], event["omega_end"][1]))
        leaves = math.degrees(math.atan2(v_x - spin * RADIUS, v_z))
        rows.append((v_x / (FAST * math.sin(angle)), -spin, leaves))
    return dict(zip(("e_t", "spin", "leaves"), np.array(rows).T, strict=True))


def _aluminium_oxide(m: float, speed: float, e: float, damping_law: DampingLaw) -> ContactLaw:
    return elastic_spheres(
        m, RADIUS, youngs_modulus=2.0 * YOUNG, poisson_ratio=NU, speed=speed, friction=MU, restitution=e,
        damping_law=damping_law, slip=Slip.TOTAL,
    )  # fmt: skip


def _head_on(name: str) -> Task:
    return calculation(head_on, name=name, per_contact=FINE, seconds=0.5)


def _bounce(e: float, damping_law: DampingLaw) -> Task:
    return calculation(bounce, e=e, damping_law=damping_law.word, seconds=0.3)


def _oblique() -> Task:
    return calculation(oblique, per_contact=FINE, seconds=0.05)


def tasks(plan: Plan) -> Sequence[Task]:
    """Head on after tests 1 and 2, at several speeds, and oblique after test 4."""
    del plan
    return [*map(_head_on, TESTS), *(_bounce(e, d) for d in DampingLaw for e in ASKED), _oblique()]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Hertz's contact time, overlap and force; restitution over speed; a sliding impact."""
    del plan
    return [_impact(found), _restitution(found), _sliding(found)]


def _impact(found: Found) -> Finding:
    place = np.arange(len(TESTS), dtype=np.float64) + 1.0
    ours = {
        key: np.array([found[_head_on(n)][key][0] for n in TESTS]) for key in ("time", "overlap", "force")
    }
    worst = {key: float(np.abs(one - 1.0).max()) for key, one in ours.items()}
    return DECLARED["elastic-impact"].finding(
        [Curve(key, place, one) for key, one in ours.items()], [Curve("Hertz", place, np.ones(len(place)))],
        worst,
    )  # fmt: skip


def _restitution(found: Found) -> Finding:
    every = {d: np.array([found[_bounce(e, d)]["e"].mean(axis=1) for e in ASKED]) for d in DampingLaw}
    asked = np.array(ASKED)
    phases = [np.abs(found[_bounce(e, d)]["e"] - e).max() for d in DampingLaw for e in ASKED]
    off = max(float(np.abs(one - asked[:, None]).max()) for one in every.values())
    spread = max(float(np.ptp(one, axis=1).max()) for one in every.values())
    return DECLARED["restitution-speed"].finding(
        [
            Curve(f"{d.word}, {speed:g} m/s", asked, every[d][:, k]) for d in DampingLaw
            for k, speed in enumerate(SPEEDS)
        ],
        [Curve("as asked", np.array([0.0, 1.0]), np.array([0.0, 1.0]))],
        {"mean": off, "between": spread, "phase": float(max(phases))},
    )  # fmt: skip


def _sliding(found: Found) -> Finding:
    ours, angle = found[_oblique()], np.array(ANGLES)
    law, fine = sliding(angle), np.linspace(LIMIT + 0.1, 89.0, 80)
    table = np.array([[TEST_4[one][k] for k in range(3)] for one in ANGLES]).T
    keys = ("e_t", "spin", "leaves")
    rows = np.array([ours[key] for key in keys])
    size = np.array([np.abs(law[0]).max(), np.abs(law[1]).max(), 1.0])
    closed = [float(np.abs(one - that).max() / s) for one, that, s in zip(rows, law, size, strict=True)]
    read = [float(np.abs(one - that).max() / s) for one, that, s in zip(rows, table, size, strict=True)]
    return DECLARED["oblique"].finding(
        [Curve("elastic spheres, 400 steps a contact", angle, ours["e_t"])],
        [Curve("gross sliding", fine, sliding(fine)[0]), Curve("Chung & Ooi, test 4", angle, table[0])],
        dict(zip((*keys, *(f"{key}-read" for key in keys)), (*closed, *read), strict=True)),
    )  # fmt: skip
