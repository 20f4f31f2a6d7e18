"""Collisions under water: what is left of the speed of approach, over the Stokes number."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.engine.protocol import Engine
from ryusa.figures.comparison import Curve
from ryusa.laws.families import Drag, Profile, Rebound
from ryusa.model import Water
from ryusa.model.arrays import Floats
from ryusa.study import Finding, Found, Plan, Task, calculation
from ryusa_studies.validation.declared import declared

TITLE = "Impact of a grain under water"
DECLARED = declared(__file__)
D, DENSITY, NU, RHO, C_M = 2.0e-3, 2650.0, 1.0e-6, 1000.0, 0.5  # [m], [kg/m3], [m2/s], [kg/m3], [-]
E_DRY, LEAST, ST_C, ROUGH = 0.9, 0.01, 35.0, 2.0e-5  # [-], [-], [-], [m]
REACH, GAP = 0.2 * D, 1.0e-6  # of a film, and between grains about to touch [m]
# Either way a film takes this over St of the speed into it: the integral over the gap of
# m dv = -6 pi mu r^2 (1/(gap + ROUGH) - 1/(REACH + ROUGH)) dgap.
TAKEN = math.log((REACH + ROUGH) / ROUGH) - REACH / (REACH + ROUGH)
ASKED = (5.0, 8.0, 12.0, 20.0, 35.0, 60.0, 100.0, 200.0, 500.0, 1000.0)  # Stokes numbers
# Stokes number of a pair over that of the grain against a wall: reduced mass over reduced radius squared
PARTNERS = {"wall": 1.0, "fixed grain": 4.0, "free grain": 2.0}
MUCH = 0.1  # restitution from which on a difference is told relative to it [-]
COARSE, FINE = 50.0, 300.0  # steps to a dry contact
LAWS = {"exponential": Rebound.EXPONENTIAL, "Davis": Rebound.DAVIS}
STILL = Water(
    profile=Profile.STILL, drag=Drag.NONE, nu=NU, rho_w=RHO, c_m=C_M, asperity=ROUGH, e_least=LEAST, st_c=ST_C
)


def asked(law: str, st: Floats) -> Floats:
    """Restitution that a law asks for at Stokes numbers [-], written out once more."""
    if law == "exponential":
        return np.maximum(E_DRY * np.exp(-ST_C / st), LEAST)
    return np.maximum(E_DRY * (1.0 + math.log(2.0 * ROUGH / D) / st), LEAST)


def through(st: Floats) -> Floats:
    """Speed out of a film over speed into it [-]: what the film takes coming and going, and e dry between."""
    return E_DRY * (1.0 - TAKEN / st) - TAKEN / st


def speed_of(st: float, partner: str) -> float:
    """Speed of approach at a Stokes number, (sigma + C_M rho) d v/(9 mu) against a wall [m/s]."""
    return st / PARTNERS[partner] * 9.0 * RHO * NU / ((DENSITY + C_M * RHO) * D)


def bounce(law: str, partner: str, per_contact: float) -> dict[str, Floats]:
    """Restitution at each Stokes number of `ASKED` [-], of one contact each."""
    got: list[float] = []
    for st in ASKED:
        speed = speed_of(st, partner)
        engine, dt = _pair(speed, partner, replace(STILL, rebound=LAWS[law]), per_contact, GAP)
        engine.advance(int(GAP / (speed * dt)) + 2).raise_if_any()
        while not len(ended := engine.events()):
            engine.advance(int(2.0 * per_contact)).raise_if_any()
        got.append(-float(ended["closing_end"][0] / ended["closing_begin"][0]))
    return {"e": np.array(got)}


def film(partner: str) -> dict[str, Floats]:
    """Speed out of a film over speed into it [-], at each Stokes number of `ASKED`."""
    got: list[float] = []
    for st in ASKED:
        speed = speed_of(st, partner)
        engine, dt = _pair(speed, partner, replace(STILL, film_reach=REACH), FINE, 1.1 * REACH)
        gap, leaves = 0.0, 0.0
        while leaves <= 0.0 or gap < 1.1 * REACH:
            engine.advance(int(0.1 * REACH / (speed * dt)) + 1).raise_if_any()
            gap, leaves = _apart(engine, partner)
        got.append(leaves / speed)
    return {"e": np.array(got)}


def _pair(speed: float, partner: str, water: Water, per_contact: float, gap: float) -> tuple[Engine, float]:
    """A grain on its way down to its partner, and the time step."""
    x, v = [[0.0, 0.0, (0.5 * D if partner == "wall" else D) + gap]], [[0.0, 0.0, -speed]]
    if partner == "free grain":
        x, v = [*x, [0.0, 0.0, 0.0]], [[0.0, 0.0, -0.5 * speed], [0.0, 0.0, 0.5 * speed]]
    made = scene(
        x, D, v=v, density=DENSITY, restitution=E_DRY, water=water,
        steps_per_contact=per_contact, gravity=0.0,
        planes=[("wall", (0, 0, 0), (0, 0, 1))] if partner == "wall" else (),
        x_fixed=[[0.0, 0.0, 0.0]] if partner == "fixed grain" else None, d_fixed=D,
    )  # fmt: skip
    engine = registry.create()
    engine.load(*made)
    return engine, made[0].dt


def _apart(engine: Engine, partner: str) -> tuple[float, float]:
    """Gap between a grain and its partner [m], and how fast it opens [m/s]."""
    now = engine.state()
    z, w = float(now.x[0, 2]), float(now.v[0, 2])
    if partner == "free grain":
        return z - float(now.x[1, 2]) - D, w - float(now.v[1, 2])
    return z - (0.5 * D if partner == "wall" else D), w


def _bounce(law: str, partner: str, per_contact: float) -> Task:
    return calculation(bounce, law=law, partner=partner, per_contact=per_contact, seconds=0.05)


def _film(partner: str) -> Task:
    return calculation(film, partner=partner, seconds=3.0)


def tasks(plan: Plan) -> Sequence[Task]:
    """Both laws on every partner at two time steps, and films; at both levels."""
    del plan
    laws = [_bounce(law, partner, n) for law in LAWS for partner in PARTNERS for n in (COARSE, FINE)]
    return [*laws, *(_film(partner) for partner in PARTNERS)]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Both laws as asked, films as they follow, and all three beside spheres on a wall."""
    del plan
    return [*(_law(found, name) for name in LAWS), _films(found), _trend(found)]


DENSE = np.geomspace(4.5, 1200.0, 120)


def _law(found: Found, name: str) -> Finding:
    st = np.array(ASKED)
    law = asked(name, st)
    off = {n: np.array([found[_bounce(name, one, n)]["e"] - law for one in PARTNERS]) for n in (COARSE, FINE)}
    worst = {n: float(np.abs(each / law)[:, law >= MUCH].max()) for n, each in off.items()}
    return DECLARED[name.lower()].finding(
        [Curve(f"{one}, {FINE:g} steps", st, found[_bounce(name, one, FINE)]["e"]) for one in PARTNERS],
        [Curve("as asked", DENSE, asked(name, DENSE))],
        {"difference": float(np.abs(off[FINE]).max()), "relative": worst[FINE], "coarse": worst[COARSE]},
    )  # fmt: skip


def _films(found: Found) -> Finding:
    st = np.array(ASKED)
    got = {one: found[_film(one)]["e"] for one in PARTNERS}
    return DECLARED["film"].finding(
        [Curve(one, st, e) for one, e in got.items()], [Curve("closed form", DENSE, through(DENSE))],
        {"difference": max(float(np.abs(e - through(st)).max()) for e in got.values())},
    )  # fmt: skip


def _trend(found: Found) -> Finding:
    st, ends = np.array(ASKED), 10.0
    got = {f"rebound '{name}'": found[_bounce(name, "wall", FINE)]["e"] for name in LAWS}
    got["film 'lubrication'"] = found[_film("wall")]["e"]
    return DECLARED["trend"].finding(
        [Curve(name, st, e / E_DRY) for name, e in got.items()],
        [
            Curve("none below about 10", np.array([st[0], ends]), np.zeros(2)),
            Curve("that in air", np.array([500.0, st[-1]]), np.ones(2)),
        ],
        {
            "restitution": {
                name: float(np.interp(math.log(ends), np.log(st), e / E_DRY)) for name, e in got.items()
            },
        },
    )  # fmt: skip
