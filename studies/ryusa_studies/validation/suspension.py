"""A suspension settles as (1 - phi)^n, the n that follows from hindrance, drag and buoyancy."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.figures.comparison import Curve
from ryusa.laws.families import BedKind, Buoyancy, Drag, Hindrance, Profile
from ryusa.laws.hindrance import exponent_settling
from ryusa.model import Column, Water
from ryusa.model.arrays import Floats
from ryusa.model.scene import EventRule
from ryusa.study import Finding, Found, Plan, Task, calculation
from ryusa.water.coupling import Coupling
from ryusa_studies.validation.declared import declared

TITLE = "A suspension settles"
DECLARED = declared(__file__)
PHI = (0.05, 0.15, 0.3, 0.45)
RATIO, G = 1.65, 9.81
C_D = 0.44  # of the Newton range, as Schiller and Naumann's
RESPONSES, STEPS_IN_ONE, EXCHANGE = 10, 100, 5  # times m w/F over a; steps in one; steps between exchanges
BEGIN = 0.8  # first speed over the one expected
WIDE, LAYERS, BELOW = 4, 32, 40  # of the lattice; empty cells below it, to fall into


@dataclass(frozen=True)
class Range:
    """A range of drag in which it is a power of the speed."""

    words: str
    a: float  # power
    d: float  # [m]
    nu: float  # [m2/s]
    drag: Drag

    @property
    def w_0(self) -> float:
        """Settling velocity of a lone grain [m/s]."""
        if self.drag == Drag.CONSTANT:
            return math.sqrt(4.0 / 3.0 * RATIO * G * self.d / C_D)
        a = 12.0 * self.nu / self.d  # 0.4 w**2 + 24 nu/d w = (4/3) R g d
        return (math.sqrt(a * a + 0.4 * 4.0 / 3.0 * RATIO * G * self.d) - a) / 0.4


RANGES = {
    "stokes": Range("Stokes drag, Re = 1e-4", 1.0, 1.0e-4, 1.0e-4, Drag.RE_04),
    "newton": Range("Newton drag, C_D = 0.44", 2.0, 2.0e-3, 1.0e-9, Drag.CONSTANT),
}
# hindrance -> p and q of eps**-q F_0(eps**p slip), as published for model A, and whether it is one
LAWS: Mapping[str, tuple[Hindrance, float, float]] = {
    "none": (Hindrance.NONE, 0.0, 0.0),
    "power 3.1": (Hindrance.POWER, 0.0, 3.1),
    "Richardson-Zaki 3.5": (Hindrance.RICHARDSON_ZAKI, math.nan, math.nan),
    "Wen-Yu": (Hindrance.WEN_YU, 1.0, 3.65),
    "Di Felice": (Hindrance.DI_FELICE, 1.0, 3.7),
    "Gidaspow": (Hindrance.GIDASPOW, 1.0, 3.65),
}
FORMS = {"stress": Buoyancy.STRESS, "weight": Buoyancy.WEIGHT, "pressure": Buoyancy.PRESSURE}


def exponent(law: str, where: str, form: str) -> float:
    """Exponent that follows [-]."""
    kind, p, q = LAWS[law]
    if kind == Hindrance.RICHARDSON_ZAKI:
        return 3.5
    stress = form == "stress"
    if kind not in (Hindrance.NONE, Hindrance.POWER) and not stress:
        q += 1.0  # published for model A: divided by eps under model B
    return exponent_settling(RANGES[where].a, p, q, stress)


def expected(law: str, where: str, form: str, phi: Floats) -> Floats:
    """Settling velocity over that of a lone grain [-]."""
    found = (1.0 - phi) ** exponent(law, where, form)
    if LAWS[law][0] == Hindrance.GIDASPOW:  # Ergun's bed where dense
        eps = 1.0 - phi
        ergun = 0.12 * eps**3 / phi if where == "stokes" else math.sqrt(0.75 * C_D / 1.75) * eps**1.5
        found = np.where(eps < 0.8, ergun, found)
    return found


def settle(law: str, where: str, form: str) -> dict[str, Floats]:
    """Let lattices of grains of each concentration fall through a column; speed over a lone grain's [-]."""
    ends = expected(law, where, form, np.array(PHI))
    speeds = [
        _settle(LAWS[law][0], RANGES[where], FORMS[form], phi, float(end))
        for phi, end in zip(PHI, ends, strict=True)
    ]
    return {"phi": np.array(PHI), "w": np.array(speeds)}


def _settle(law: Hindrance, where: Range, form: Buoyancy, phi: float, end: float) -> float:
    d, pitch = where.d, math.sqrt(math.pi / 6.0 / phi)  # a slab of grains one diameter wide
    a, b = (g.ravel() for g in np.meshgrid(np.arange(WIDE), np.arange(LAYERS), indexing="ij"))
    x = np.column_stack([(a + 0.5) * pitch * d, np.zeros(a.size), (b + BELOW + 0.5) * pitch * d])
    water = Water(
        profile=Profile.COLUMN, nu=where.nu, drag=where.drag, c_d=C_D, buoyancy=form, hindrance=law,
        hindrance_exponent=3.5 if law == Hindrance.RICHARDSON_ZAKI else 3.1,
    )  # fmt: skip
    response = (RATIO + 1.5) / RATIO * end * where.w_0 / G
    v = np.tile([0.0, 0.0, -BEGIN * end * where.w_0], (len(x), 1))
    fixed, first = scene(
        x, d, density=1000.0 * (RATIO + 1.0), v=v, water=water, gravity=G, plane_case=True,
        period=(WIDE * pitch * d, math.inf), dt=response / STEPS_IN_ONE, stiffness=1e-3,
        events=EventRule.NONE,
    )  # fmt: skip
    fixed = replace(fixed, world_low=(-math.inf,) * 3)
    # one layer of grains in each cell, wherever they are: the same concentration in all
    column = Column(
        z_low=0.0, dz=pitch * d, n=LAYERS + BELOW, depth=(LAYERS + BELOW) * pitch * d,
        area=WIDE * pitch * d * d, nu=where.nu, bed=BedKind.MOVING, interval=EXCHANGE,
    )  # fmt: skip
    engine = registry.create()
    engine.load(fixed, first)
    coupling = Coupling.begin(fixed, column, first.x)
    engine.set_fluid(coupling.sampled)
    middle = np.flatnonzero(b == LAYERS // 2)
    done = 0
    while done < RESPONSES / where.a * STEPS_IN_ONE:
        steps = coupling.steps
        engine.advance(steps).raise_if_any()
        engine.set_fluid(coupling.exchange(*engine.kinematics()))
        done += steps
    return -float(engine.kinematics()[1][middle, 2].mean()) / where.w_0


def _call(law: str, where: str, form: str) -> Task:
    return calculation(settle, law=law, where=where, form=form, seconds=0.5)


def tasks(plan: Plan) -> Sequence[Task]:
    """Every hindrance under every form of buoyancy in both ranges, at both levels."""
    del plan
    return [_call(law, where, form) for where in RANGES for form in FORMS for law in LAWS]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """One picture per range and form of buoyancy."""
    del plan
    return [_compare(found, where, form) for where in RANGES for form in FORMS]


def _compare(found: Found, where: str, form: str) -> Finding:
    fine = np.linspace(0.01, 0.5, 99)
    ours: list[Curve] = []
    references: list[Curve] = []
    numbers = dict[str, float]()
    for law in LAWS:
        got = found[_call(law, where, form)]
        n = exponent(law, where, form)
        name = f"{law}, n = {n:.3g}" if law != "Gidaspow" else "Gidaspow, Ergun below eps = 0.8"
        ours.append(Curve(name, got["phi"], got["w"]))
        references.append(Curve(name, fine, expected(law, where, form, fine)))
        if law == "Gidaspow":
            off = got["w"] / expected(law, where, form, got["phi"]) - 1.0
            numbers[f"{law}: largest relative difference"] = float(np.abs(off).max())
        else:
            off = np.log(got["w"]) / np.log1p(-got["phi"]) - n
            numbers[f"{law}: largest error of n"] = float(np.abs(off).max())
    return DECLARED["{where}-{form}"].finding(
        ours, references, {"off": numbers}, where=where, form=form, range=RANGES[where].words
    )
