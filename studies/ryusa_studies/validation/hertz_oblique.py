"""Oblique impacts of elastic spheres on a plane, from sticking to sliding: Chung & Ooi, Thornton et al."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.figures.comparison import Curve
from ryusa.laws.families import DampingLaw, Slip, Unloading
from ryusa.model import ContactLaw
from ryusa.model.arrays import Floats
from ryusa.model.contact_law import contact_time_of, elastic_spheres
from ryusa.study import Finding, Found, Level, Plan, Task, calculation
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.one_impact import rebound

TITLE = "Oblique impact of elastic spheres"
DECLARED = declared(__file__)
STEPS = 400.0  # in a contact
# Young's modulus [Pa], Poisson's ratio [-], density [kg/m3]
MATERIALS = {
    "steel": (2.08e11, 0.30, 7850.0),
    "polyethylene": (1.0e9, 0.40, 1400.0),
    "aluminium alloy": (7.0e10, 0.33, 2700.0),
    "nylon": (2.5e9, 0.40, 1000.0),  # from memory: its published curve is shown, and decides nothing
    "glass": (7.0e10, 0.30, 2650.0),
}
# Test 5: radius [m], normal speed [m/s], friction, restitution; test 6: the same
SMALL, FAST, MU_5, E_5 = 1.0e-5, 5.0, 0.3, 1.0
LARGE, SLOW, MU_6, E_6 = 0.1, 0.2, 0.4, 0.5
SLIDES_5, SLIDES_6 = 5.0, 0.95  # theta from which, and q up to which, test 5 and 6 slide throughout
SLIDES = 6.0  # ours, found at the first run: from 5.8
# Of Thornton et al.: radius, normal speed, friction, as above
MIDDLE, BRISK, MU_T, SLIDES_T = 0.025, 0.5, 0.1, 7.0

FIVE = ("steel", "polyethylene")  # of test 5
PSI, SPIN, BETA = (DECLARED[one].points for one in ("recoil", "spin", "tangential-restitution"))
INELASTIC = {float(e): points for e, points in DECLARED["recoil-inelastic"].points.items()}
DASHPOTS = ("without", "with")  # a tangential dashpot


def test_5(material: str, unloading: str) -> dict[str, Floats]:
    """`recoil` at the abscissae of PSI, and `spin` at those of SPIN [-]."""
    law = _law(material, SMALL, FAST, MU_5, E_5, Unloading.of(unloading))
    psi, spin = (
        [
            _impact(law, material, SMALL, FAST, theta * MU_5 * FAST, 0.0)
            for theta in one[material][:, 0].tolist()
        ]
        for one in (PSI, SPIN)
    )
    return {
        "recoil": np.array([(v_x - SMALL * w) / (MU_5 * v_z) for v_x, v_z, w in psi]),
        "spin": np.array([-SMALL * w / (MU_5 * FAST) for _, _, w in spin]),
    }


def test_6(material: str, dashpot: str, damping_law: str) -> dict[str, Floats]:
    """Tangential restitution `beta` of the contact point of a grain that comes with spin alone [-]."""
    law = _law(material, LARGE, SLOW, MU_6, E_6, Unloading.PLAIN, DampingLaw.of(damping_law))
    law = with_dashpot(law, dashpot)
    beta: list[float] = []
    for q in BETA[material][:, 0].tolist():
        v_t = 3.5 * MU_6 * (1.0 + E_6) * SLOW / q
        v_x, _, w = _impact(law, material, LARGE, SLOW, 0.0, -v_t / LARGE)
        beta.append(-(v_x - LARGE * w) / v_t)
    return {"beta": np.array(beta)}


def half_shear(material: str) -> dict[str, Floats]:
    """`half`, `whole`: recoil of test 5 with half and all of Mindlin's tangential stiffness, by itself [-].

    Half is that of a plane which is rigid against the normal force and elastic in shear.
    """
    young, nu, rho = MATERIALS[material]
    found: dict[str, Floats] = {}
    for name, share in (("half", 0.5), ("whole", 1.0)):
        after = [
            rebound(young, nu, rho, SMALL, FAST, theta * MU_5 * FAST, MU_5, share, 4 * int(STEPS))
            for theta in PSI[material][:, 0].tolist()
        ]
        found[name] = np.array([(v_x - SMALL * w) / (MU_5 * v_z) for v_x, v_z, w in after])
    return found


def inelastic(e: float, unloading: str, dashpot: str) -> dict[str, Floats]:
    """Recoil at the abscissae of INELASTIC [-]."""
    law = elastic_spheres(
        _mass("glass", MIDDLE), MIDDLE, youngs_modulus=MATERIALS["glass"][0], poisson_ratio=0.3, speed=BRISK,
        friction=MU_T, restitution=e, restitution_shear=1.0, damping_law=DampingLaw.THORNTON,
        unloading=Unloading.of(unloading), slip=Slip.TOTAL,
    )  # fmt: skip
    law = with_dashpot(law, dashpot)
    unit = 0.5 * (1.0 + e) * MU_T * BRISK
    found = [_impact(law, "glass", MIDDLE, BRISK, x * unit, 0.0) for x in INELASTIC[e][:, 0].tolist()]
    return {"recoil": np.array([(v_x - MIDDLE * w) / unit for v_x, _, w in found])}


def with_dashpot(law: ContactLaw, dashpot: str) -> ContactLaw:
    """The law with the tangential dashpot of EDEM and LIGGGHTS, 2 sqrt(5/6) zeta sqrt(k_s m), or without."""
    return replace(law, zeta_s=math.sqrt(5.0 / 6.0 * 3.5) * law.zeta_n if dashpot == "with" else 0.0)


def _mass(material: str, r: float) -> float:
    return MATERIALS[material][2] * 4.0 / 3.0 * math.pi * r**3


def _law(
    material: str, r: float, speed: float, mu: float, e: float, unloading: Unloading,
    damping_law: DampingLaw = DampingLaw.TSUJI,
) -> ContactLaw:  # fmt: skip
    young, nu, _ = MATERIALS[material]
    return elastic_spheres(
        _mass(material, r), r, youngs_modulus=young, poisson_ratio=nu, speed=speed, friction=mu,
        restitution=e, damping_law=damping_law, unloading=unloading, slip=Slip.TOTAL,
    )  # fmt: skip


def _impact(
    law: ContactLaw, material: str, r: float, v_n: float, v_t: float, spin: float
) -> tuple[float, float, float]:
    """Velocity along and away from the plane [m/s], and spin [rad/s], after an impact."""
    rho = MATERIALS[material][2]
    dt = contact_time_of(law, _mass(material, r), r, v_n) / STEPS
    engine = registry.create()
    engine.load(*scene(
        [[0.0, 0.0, r + 0.5 * v_n * dt]], 2.0 * r, density=rho, v=[[v_t, 0.0, -v_n]],
        omega=[[0.0, spin, 0.0]], planes=[("wall", (0, 0, 0), (0, 0, 1))], contact=law, dt=dt, gravity=0.0,
    ))  # fmt: skip
    engine.advance(int(1.5 * STEPS)).raise_if_any()
    (event,) = engine.events()
    return float(event["v_end"][0]), float(event["v_end"][2]), float(event["omega_end"][1])


def _test_5(material: str, unloading: Unloading) -> Task:
    return calculation(test_5, material=material, unloading=unloading.word, seconds=0.1)


def _test_6(material: str, dashpot: str, damping_law: DampingLaw = DampingLaw.TSUJI) -> Task:
    return calculation(test_6, material=material, dashpot=dashpot, damping_law=damping_law.word, seconds=0.1)


def _half_shear(material: str) -> Task:
    return calculation(half_shear, material=material, seconds=1.0)


def _inelastic(e: float, unloading: Unloading, dashpot: str = "without") -> Task:
    return calculation(inelastic, e=e, unloading=unloading.word, dashpot=dashpot, seconds=0.1)


def tasks(plan: Plan) -> Sequence[Task]:
    """Test 5 with both ways of unloading, test 6 with and without a tangential dashpot; none when quick.

    The quick level tells whether this installation works, and a published curve is missed on any.
    """
    if plan.level is Level.QUICK:
        return []
    five = [_test_5(one, unloading) for one in FIVE for unloading in Unloading]
    slow = [_inelastic(e, unloading, d) for e in INELASTIC for unloading in Unloading for d in DASHPOTS]
    half = [_half_shear(one) for one in FIVE]
    return [
        *five,
        *half,
        *slow,
        *(_test_6(one, d, law) for one in BETA for d in DASHPOTS for law in DampingLaw),
    ]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Recoil and spin of test 5, tangential restitution of test 6."""
    if plan.level is Level.QUICK:
        return []
    return [
        _finding_5(found, "recoil", PSI, lambda theta: theta - 7.0),
        _finding_5(found, "spin", SPIN, lambda theta: np.full(len(theta), -5.0)),
        _recoil_half_shear(found),
        _tangential_restitution(found),
        _recoil_inelastic(found),
    ]  # fmt: skip


def _below(found: Found, material: str, key: str, rows: Floats) -> float:
    """Largest difference from a published curve of test 5, below the sliding branch [-]."""
    off = found[_test_5(material, Unloading.PLAIN)][key] - rows[:, 1]
    return float(np.abs(off[rows[:, 0] < SLIDES_5 - 0.1]).max())


def _sliding(
    found: Found, key: str, rows: Mapping[str, Floats], law: Callable[[Floats], Floats], begin: float
) -> float:
    """Largest difference from the law of gross sliding from theta = `begin` on, of both materials [-]."""
    off = [
        (found[_test_5(one, unloading)][key] - law(rows[one][:, 0]))[rows[one][:, 0] > begin - 0.1]
        for one in FIVE for unloading in Unloading
    ]  # fmt: skip
    return float(np.abs(np.concatenate(off)).max())


def _finding_5(
    found: Found, key: str, table: Mapping[str, Floats], law: Callable[[Floats], Floats]
) -> Finding:
    ours = [
        Curve(f"{one}, {unloading.word}", table[one][:, 0], found[_test_5(one, unloading)][key])
        for one in FIVE for unloading in Unloading
    ]  # fmt: skip
    return DECLARED[key].finding(
        ours, [Curve(f"{one}, Chung & Ooi", table[one][:, 0], table[one][:, 1]) for one in FIVE],
        {
            "below": {one: _below(found, one, key, table[one]) for one in FIVE},
            "slides": _sliding(found, key, table, law, SLIDES),
            "first": _sliding(found, key, table, law, SLIDES_5),
        },
        [Curve(one, points[:, 0], points[:, 1]) for one, points in table.items() if one not in FIVE],
    )  # fmt: skip


def _recoil_half_shear(found: Found) -> Finding:
    rows = PSI
    ours = {one: found[_half_shear(one)] for one in FIVE}
    engine = {one: found[_test_5(one, Unloading.PLAIN)]["recoil"] for one in FIVE}
    same = max(float(np.abs(ours[one]["whole"] - engine[one]).max()) for one in FIVE)
    off = {one: np.abs(ours[one]["half"] - rows[one][:, 1])[rows[one][:, 0] < SLIDES_5 - 0.1] for one in FIVE}
    return DECLARED["recoil-half-shear"].finding(
        [Curve(one, rows[one][:, 0], ours[one]["half"]) for one in FIVE],
        [Curve(f"{one}, Chung & Ooi", rows[one][:, 0], rows[one][:, 1]) for one in FIVE],
        {"below": {one: float(off[one].max()) for one in FIVE}, "engine": same},
    )  # fmt: skip


def _tangential_restitution(found: Found) -> Finding:
    rows = BETA
    slid, closed = ({law: list[float]() for law in DampingLaw} for _ in range(2))
    stuck = dict[str, float]()
    for one, points in rows.items():
        q, read = points.T
        for dashpot in DASHPOTS:
            for law in DampingLaw:
                beta = found[_test_6(one, dashpot, law)]["beta"]
                if one != "nylon":
                    slid[law].append(float(np.abs(beta - read)[q < SLIDES_6].max()))
                closed[law].append(float(np.abs(beta - (q - 1.0))[q < SLIDES_6].max()))
                if law is DampingLaw.TSUJI:
                    stuck[f"{one}, {dashpot} dashpot"] = float(np.abs(beta - read)[q > SLIDES_6].max())
    ends, pulls = DampingLaw.THORNTON, DampingLaw.TSUJI
    return DECLARED["tangential-restitution"].finding(
        [
            Curve(f"{one}, {dashpot} dashpot", rows[one][:, 0], found[_test_6(one, dashpot)]["beta"])
            for one in BETA for dashpot in DASHPOTS
        ],
        [Curve(f"{one}, Chung & Ooi", points[:, 0], points[:, 1]) for one, points in rows.items()],
        {
            "slides-read": max(slid[ends]), "slides": max(closed[ends]),
            "first-read": max(slid[pulls]), "first": max(closed[pulls]),
            "sticks": stuck,
        },
    )  # fmt: skip


def _recoil_inelastic(found: Found) -> Finding:
    rows = INELASTIC
    off: dict[str, list[float]] = {one: [] for one in DASHPOTS}
    above = list[float]()
    for e, points in rows.items():
        x, read = points.T
        for dashpot in DASHPOTS:
            ours = found[_inelastic(e, Unloading.RESCALED, dashpot)]["recoil"]
            off[dashpot].append(float(np.abs(ours - read)[x < SLIDES_T].max()))
            if dashpot == "with":
                above.append(float(np.abs(ours - (x - 7.0))[x > SLIDES_T].max()))
    return DECLARED["recoil-inelastic"].finding(
        [
            Curve(
                f"e = {e:g}, {dashpot} tangential dashpot", rows[e][:, 0],
                found[_inelastic(e, Unloading.RESCALED, dashpot)]["recoil"],
            )
            for e in INELASTIC for dashpot in DASHPOTS
        ],
        [Curve(f"e = {e:g}, Thornton et al.", points[:, 0], points[:, 1]) for e, points in rows.items()],
        {
            "hard": off["with"][0], "soft": off["with"][1], "slides": max(above),
            "first-hard": off["without"][0], "first-soft": off["without"][1],
        },
    )  # fmt: skip
