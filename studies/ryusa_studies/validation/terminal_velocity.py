"""One grain that falls in still water, under every drag law; beside it the formulae of the field."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.figures.comparison import Curve
from ryusa.laws import drag
from ryusa.laws.families import Drag, Profile
from ryusa.model import Water
from ryusa.model.arrays import Floats
from ryusa.model.scene import EventRule
from ryusa.study import Finding, Found, Plan, Task, calculation
from ryusa_studies.validation.declared import declared

TITLE = "One grain falls in still water"
DECLARED = declared(__file__)
RATIO, G, NU = 1.65, 9.81, 1.0e-6  # quartz in water: [-], [m/s2], [m2/s]
DEFAULT = "Schiller-Naumann"  # of spheres
WATER_20 = (998.2, 1.004e-6)  # water of 20 deg C [kg/m3], [m2/s]
MEASURED = (0.1e-3, 0.25e-3, 0.5e-3, 1.0e-3, 2.0e-3, 4.0e-3)  # of 0.05 to 5 mm that were measured [m]
SIZES = (0.1e-3, 0.2e-3, 0.5e-3, 1.0e-3, 2.0e-3, 4.0e-3, 6.0e-3)  # [m]
FINE = np.geomspace(SIZES[0], SIZES[-1], 60)
STEPS = 4000  # 20 response times
LAWS: Mapping[str, tuple[Drag, Callable[[float], float]]] = {
    "constant 0.4": (Drag.CONSTANT, lambda _: 0.4),
    "24/Re + 0.4": (Drag.RE_04, drag.c_d_re_04),
    "24/Re + 2": (Drag.RE_2, drag.c_d_re_2),
    "Schiller-Naumann": (Drag.SCHILLER_NAUMANN, drag.c_d_schiller_naumann),
    "Ferguson-Church sphere": (Drag.FERGUSON_CHURCH_SPHERE, drag.c_d_ferguson_church_sphere),
    "Ferguson-Church sand": (Drag.FERGUSON_CHURCH_SAND, drag.c_d_ferguson_church_sand),
}
FIELD: Mapping[str, Callable[[float], float]] = {
    "Soulsby 1997, natural sand": lambda d: drag.terminal_velocity_soulsby(RATIO, G, d, NU),
    "Dietrich 1982, nearly round": lambda d: drag.terminal_velocity_dietrich(RATIO, G, d, NU),
    "Ferguson & Church 2004, sand": lambda d: drag.terminal_velocity_ferguson_church(
        RATIO, G, d, NU, 18.0, 1.0
    ),
}


def root(c_d: Callable[[float], float], d: float, ratio: float = RATIO, nu: float = NU) -> float:
    """Speed at which drag carries the submerged weight [m/s]: C_D(w d/nu) w**2 = (4/3) R g d."""
    weight, low, high = 4.0 / 3.0 * ratio * G * d, 1e-9, 20.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if c_d(middle * d / nu) * middle**2 < weight else (low, middle)
    return low


def fall(
    law: str, sizes: Sequence[float] = SIZES, rho_w: float = 1000.0, nu: float = NU
) -> dict[str, Floats]:
    """Speed of quartz after 20 response times from rest [m/s], stepped by the engine, by size [m]."""
    kind, c_d = LAWS[law]
    rho_s = 1000.0 * (RATIO + 1.0)
    ratio, speeds = rho_s / rho_w - 1.0, []
    for d in sizes:
        water = Water(profile=Profile.STILL, drag=kind, c_d=0.4, rho_w=rho_w, nu=nu)
        response = (ratio + 1.5) / ratio * root(c_d, d, ratio, nu) / G  # added mass included
        made = scene(
            [[0.0, 0.0, 0.0]], d, density=rho_s, water=water, gravity=G,
            dt=20.0 * response / STEPS, plane_case=True, events=EventRule.NONE,
        )  # fmt: skip
        engine = registry.create()
        engine.load(replace(made[0], world_low=(-math.inf,) * 3), made[1])
        engine.advance(STEPS).raise_if_any()
        speeds.append(-float(engine.state().v[0, 2]))
    return {"d": np.array(sizes), "w": np.array(speeds)}


def _call(law: str) -> Task:
    return calculation(fall, law=law, seconds=0.2)


def gibbs(d: float, rho_s: float, rho_w: float, nu: float) -> float:
    """Settling velocity of a sphere by the fit of Gibbs, Matthews & Link 1971 to their measurements [m/s].

    Their constants want cgs units.
    """
    r, solid, water, eta = 50.0 * d, 1e-3 * rho_s, 1e-3 * rho_w, 1e-3 * rho_w * 1e4 * nu
    root = 9.0 * eta**2 + 981.0 * r**2 * water * (solid - water) * (0.015476 + 0.19841 * r)
    return 0.01 * (math.sqrt(root) - 3.0 * eta) / (water * (0.011607 + 0.14881 * r))


def _measured() -> Task:
    rho_w, nu = WATER_20
    return calculation(fall, law=DEFAULT, sizes=MEASURED, rho_w=rho_w, nu=nu, seconds=0.2)


def tasks(plan: Plan) -> Sequence[Task]:
    """Every drag law, and spheres as they were measured; they take no time, so both levels have all."""
    del plan
    return [*(_call(law) for law in LAWS), _measured()]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Set the stepped grain against the root of the balance, and two of our laws against the field's."""
    del plan
    ours = {law: found[_call(law)]["w"] for law in LAWS}
    mm = 1e3 * np.array(SIZES)
    roots = DECLARED["drag-laws"].finding(
        [Curve(law, mm, w) for law, w in ours.items()],
        [Curve(law, 1e3 * FINE, np.array([root(LAWS[law][1], float(d)) for d in FINE])) for law in LAWS],
        {
            "difference": {
                law: max(abs(w / root(LAWS[law][1], d) - 1.0) for d, w in zip(SIZES, speeds, strict=True))
                for law, speeds in ours.items()
            },
        },
    )  # fmt: skip
    shown = ("Schiller-Naumann", "Ferguson-Church sphere", "Ferguson-Church sand")
    law_of = {"Soulsby 1997, natural sand": shown[2], "Dietrich 1982, nearly round": shown[0]}
    field = DECLARED["field"].finding(
        [Curve(law, mm, ours[law]) for law in shown],
        [Curve(name, 1e3 * FINE, np.array([w(float(d)) for d in FINE])) for name, w in FIELD.items()],
        {
            "difference": {
                f"{law} against {name}":
                max(abs(w / FIELD[name](d) - 1.0) for d, w in zip(SIZES, ours[law], strict=True))
                for name, law in law_of.items()
            },
        },
    )  # fmt: skip
    seen = found[_measured()]["w"]
    known = [gibbs(d, 1000.0 * (RATIO + 1.0), *WATER_20) for d in MEASURED]
    spheres = DECLARED["spheres"].finding(
        [Curve(DEFAULT, 1e3 * np.array(MEASURED), seen)],
        [Curve("Gibbs et al.", 1e3 * FINE, np.array([gibbs(d, 2650.0, *WATER_20) for d in FINE]))],
        {"mm": {f"{1e3 * d:g}": w / one - 1.0 for d, one, w in zip(MEASURED, known, seen, strict=True)}},
    )  # fmt: skip
    return [roots, field, spheres]
