"""Two grains, or a grain and a wall: restitution, contact time, and the result of a sliding impact."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.figures.comparison import Curve
from ryusa.laws import collision
from ryusa.laws.families import Cap, ContactTiming, Slip
from ryusa.model import ContactLaw
from ryusa.model.arrays import Floats
from ryusa.study import Finding, Found, Plan, Task, calculation
from ryusa_studies.validation.declared import declared

TITLE = "Impact of a grain"
DECLARED = declared(__file__)
ASKED = (0.1, 0.3, 0.5, 0.7, 0.9, 0.98)
FEW, MANY, MORE = 8.0, 50.0, 500.0  # steps to a contact: with exact timing, and twice at steps
PHASES = 20  # of the step at which the grains first touch
SPEED, D = 0.5, 2.0e-3  # [m/s], [m]

# Chung & Ooi 2011, test 4: aluminium oxide on a thick plate, after Kharaz et al.
RADIUS, FAST, DENSITY = 2.5e-3, 3.9, 4000.0  # [m], [m/s], [kg/m3]
E, MU = 0.98, 0.092
LIMIT = math.degrees(math.atan(3.5 * MU * (1.0 + E)))  # sliding throughout beyond it: 32.5 deg
ANGLES = (35.0, 40.0, 50.0, 60.0, 70.0, 80.0, 85.0)  # from the normal [deg]
# e_t [-], spin after it [rad/s], rebound angle of the contact point [deg]
TEST_4 = {
    35.0: (0.737, -582.0, 3.4),
    40.0: (0.781, -545.0, 11.6),
    50.0: (0.845, -457.0, 29.4),
    60.0: (0.893, -357.0, 47.8),
    70.0: (0.932, -246.0, 64.6),
    80.0: (0.966, -126.0, 78.7),
    85.0: (0.983, -63.0, 84.5),
}


def bounce(e: float, tension: bool, per_contact: float, timing: str) -> dict[str, Floats]:
    """Restitution got [-] and contact time over that of the oscillator [-], for each phase of first touch."""
    zeta = collision.zeta_for_restitution(e, tension)
    law = ContactLaw(k_n=1e4, k_s=0.0, mu=0.0, zeta_n=zeta, tension=tension, timing=ContactTiming.of(timing))
    probe, _ = scene([[0.0, 0.0, 0.01]], D, contact=law)
    t_col = collision.contact_time(zeta, math.sqrt(law.k_n / float(probe.m[0])), tension)
    dt = t_col / per_contact
    got: list[float] = []
    took: list[float] = []
    for phase in np.arange(PHASES) / PHASES:
        gap = (3.0 + phase) * SPEED * dt
        engine = registry.create()
        engine.load(*scene(
            [[0.0, 0.0, D + gap]], D, v=[[0.0, 0.0, -SPEED]], x_fixed=[[0.0, 0.0, 0.0]], d_fixed=D,
            contact=law, dt=dt, gravity=0.0, rotation=False, plane_case=True,
        ))  # fmt: skip
        engine.advance(int(6 + 2.5 * per_contact)).raise_if_any()
        (event,) = engine.events()
        got.append(float(-event["closing_end"] / event["closing_begin"]))
        took.append(float((event["t_end"] - event["t_begin"]) / t_col))
    return {"e": np.array(got), "time": np.array(took)}


def oblique(per_contact: float) -> dict[str, Floats]:
    """Test 4 of Chung & Ooi with a linear spring, spring and dashpot capped together.

    For each of ANGLES: e_t [-], spin [rad/s], rebound angle of the contact point [deg].
    """
    law = ContactLaw(
        k_n=1e7, k_s=2e7 / 7.0, mu=MU, zeta_n=collision.zeta_no_tension(E), slip=Slip.TOTAL, cap=Cap.TOTAL
    )
    rows: list[tuple[float, float, float]] = []
    for degrees in ANGLES:
        angle = math.radians(degrees)
        probe, _ = scene([[0.0, 0.0, 1.0]], 2.0 * RADIUS, density=DENSITY, contact=law)
        dt = collision.collision_time(float(probe.m[0]), law.k_n) / per_contact
        engine = registry.create()
        engine.load(*scene(
            [[0.0, 0.0, RADIUS + 1e-7]], 2.0 * RADIUS, density=DENSITY,
            v=[[FAST * math.sin(angle), 0.0, -FAST * math.cos(angle)]],
            planes=[("floor", (0, 0, 0), (0, 0, 1))], contact=law, dt=dt, gravity=0.0,
        ))  # fmt: skip
        engine.advance(int(1.5 * per_contact)).raise_if_any()
        (event,) = engine.events()
        v_x, v_z, spin = (float(one) for one in (event["v_end"][0], event["v_end"][2], event["omega_end"][1]))
        leaves = math.degrees(math.atan2(v_x - spin * RADIUS, v_z))
        rows.append((v_x / (FAST * math.sin(angle)), -spin, leaves))
    e_t, spin, leaves = np.array(rows).T
    return {"e_t": e_t, "spin": spin, "leaves": leaves}


def sliding(angle: Floats) -> tuple[Floats, Floats, Floats]:
    """e_t, spin and rebound angle of the contact point after gross sliding; angles from the normal [deg]."""
    tan = np.tan(np.radians(angle))
    spin = -2.5 * MU * (1.0 + E) * FAST * np.cos(np.radians(angle)) / RADIUS
    return 1.0 - MU * (1.0 + E) / tan, spin, np.degrees(np.arctan((tan - 3.5 * MU * (1.0 + E)) / E))


def _bounce(e: float, tension: bool, per_contact: float) -> Task:
    timing = (ContactTiming.EXACT if per_contact == FEW else ContactTiming.AT_STEPS).word
    return calculation(bounce, e=e, tension=tension, per_contact=per_contact, timing=timing, seconds=0.05)


def _oblique() -> Task:
    return calculation(oblique, per_contact=400.0, seconds=0.05)


def tasks(plan: Plan) -> Sequence[Task]:
    """Head on with and without tension, exact at 8 and at steps at 50 and 500 a contact; oblique."""
    del plan
    return [*(_bounce(e, t, n) for t in (False, True) for n in (FEW, MANY, MORE) for e in ASKED), _oblique()]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Restitution, contact time, and the three numbers of a sliding impact."""
    del plan
    return [_restitution(found), _duration(found), *_test_4(found)]


NAMED = {False: "force never pulls", True: "dashpot may pull"}


def _restitution(found: Found) -> Finding:
    def worst(steps: float, mean: bool) -> float:
        every = [found[_bounce(e, t, steps)]["e"] - e for t in NAMED for e in ASKED]
        return float(max(abs(one.mean()) if mean else np.abs(one).max() for one in every))

    asked = np.array(ASKED)
    return DECLARED["restitution"].finding(
        [
            Curve(f"{words}, 50 steps a contact", asked, _mean(found, "e", tension, MANY))
            for tension, words in NAMED.items()
        ],
        [Curve("as asked", np.array([0.0, 1.0]), np.array([0.0, 1.0]))],
        {
            "exact": worst(FEW, False), "mean": worst(MANY, True), "steps-50": worst(MANY, False),
            "steps-500": worst(MORE, False),
        },
    )  # fmt: skip


def _mean(found: Found, what: str, tension: bool, steps: float) -> Floats:
    return np.array([found[_bounce(e, tension, steps)][what].mean() for e in ASKED])


def _duration(found: Found) -> Finding:
    asked = np.array(ASKED)
    every = {(t, n): _mean(found, "time", t, n) for t in NAMED for n in (FEW, MANY, MORE)}
    worst = {n: max(float(np.abs(every[t, n] - 1.0).max()) for t in NAMED) for n in (FEW, MANY, MORE)}
    return DECLARED["contact-time"].finding(
        [Curve(f"{NAMED[t]}, {n:g} steps a contact", asked, times) for (t, n), times in every.items()],
        [Curve("closed form", asked, np.ones(len(asked)))],
        {"exact": worst[FEW], "steps-50": worst[MANY], "steps-500": worst[MORE]},
    )  # fmt: skip


def _test_4(found: Found) -> Sequence[Finding]:
    ours = found[_oblique()]
    angle = np.array(ANGLES)
    law = sliding(angle)
    fine = np.linspace(LIMIT + 0.1, 89.0, 80)
    made: list[Finding] = []
    for k, key in enumerate(("e_t", "spin", "leaves")):
        table = np.array([TEST_4[one][k] for one in ANGLES])
        largest = (1.0, 1.0) if key == "leaves" else (np.abs(law[k]).max(), np.abs(table).max())
        made.append(DECLARED[f"oblique-{key.replace('_', '-')}"].finding(
            [Curve("linear spring, 400 steps a contact", angle, ours[key])],
            [Curve("gross sliding", fine, sliding(fine)[k]), Curve("Chung & Ooi, test 4", angle, table)],
            {
                "closed": float(np.abs(ours[key] - law[k]).max() / largest[0]),
                "read": float(np.abs(ours[key] - table).max() / largest[1]),
            },
        ))  # fmt: skip
    return made
