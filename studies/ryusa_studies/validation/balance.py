"""In steady flow bed and fixed grains carry the downslope weight of water and grains, whatever the buoyancy.

What grains give to the bed is read from the contacts' own impulses, which know nothing of the water.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.figures.comparison import Curve
from ryusa.laws.families import BedKind, Buoyancy, Drag, Hindrance, Mixing, Profile, Start
from ryusa.model import EVENT, Column, Scene, State, Water
from ryusa.model.arrays import Floats
from ryusa.model.scene import EventRule
from ryusa.study import Finding, Found, Interval, Plan, Task, calculation, largest_mean
from ryusa.water.coupling import Coupling
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.sampling import SAMPLING

TITLE = "The bed carries the weight of the mixture"
DECLARED = declared(__file__)
D, G, SLOPE, WIDE = 2.0e-3, 9.80665, 0.1, 20  # [m], [m/s2], [rad], grains
SETTLE = 1.0  # [s]
PARTS = 10  # of that time
FORMS = {"stress": Buoyancy.STRESS, "weight": Buoyancy.WEIGHT, "pressure": Buoyancy.PRESSURE}
_IMPULSE_X = (EVENT.fields or {})["impulse"][1] // 8  # its column in an open record


class Impulses(NamedTuple):
    """By area of bed over a time [Pa s]."""

    weight: float  # along the slope, of water and grains
    contacts: float  # of fixed grains on free ones; negative slows them
    water: float  # stress of the bed, drag of fixed grains, and what passes the surface
    gain: float  # of momentum


def moving_bed(form: Buoyancy, seed: int) -> tuple[tuple[Scene, State], Column]:
    """Two layers of loose grains on a row of fixed ones of random height, under water four grains deep."""
    rng = np.random.default_rng(4 + seed)  # seed 1 is the bed of all tables before there were seeds
    row = np.zeros((WIDE, 3))
    row[:, 0], row[:, 2] = (np.arange(WIDE) + 0.5) * D, rng.uniform(0.0, 0.5, WIDE) * D
    a, b = (g.ravel() for g in np.meshgrid(np.arange(16), np.arange(2), indexing="ij"))
    x = np.column_stack([(a + 0.5 + 0.3 * b) * 1.25 * D, 0.0 * a, (1.7 + 1.15 * b) * D])
    water = Water(
        profile=Profile.COLUMN, drag=Drag.SCHILLER_NAUMANN, hindrance=Hindrance.DI_FELICE, buoyancy=form
    )
    made = scene(
        x, D * rng.uniform(0.9, 1.1, len(x)), x_fixed=row, d_fixed=D, gravity=G, slope=SLOPE, stiffness=100.0,
        water=water, period=(WIDE * D, math.inf), plane_case=True, events=EventRule.ALL,
    )  # fmt: skip
    column = Column(
        z_low=-0.5 * D, dz=0.1 * D, n=120, depth=4.0 * D, z_bed=2.0 * D, area=WIDE * D * D,
        bed=BedKind.MOVING, mixing=Mixing.LI_SAWAMOTO, phi_max=0.55, d=D, g_x=G * math.sin(SLOPE),
        start=Start.STEADY, interval=100,
    )  # fmt: skip
    return made, column


class ChannelFlow:
    """Grains and water, and the impulses of their contacts with the bed."""

    def __init__(self, form: Buoyancy, seed: int) -> None:
        (self.fixed, first), self.column = moving_bed(form, seed)
        self.engine = registry.create()
        self.engine.load(self.fixed, first)
        self.coupling = Coupling.begin(self.fixed, self.column, first.x)
        self.engine.set_fluid(self.coupling.sampled)

    def run(self, time: float) -> Impulses:
        """Step on for a time [s] and add up what came in and what went out."""
        fixed, column, coupling = self.fixed, self.column, self.coupling
        v, u = self.engine.kinematics()[1], coupling.state
        weight, contacts, water, spent = 0.0, -self._held(), 0.0, 0.0
        self.engine.events()
        while spent < time:
            steps = coupling.steps
            dt = steps * fixed.dt
            self.engine.advance(steps).raise_if_any()
            events = self.engine.events()
            contacts += self._of_fixed(events["i"], events["j"], events["impulse"][:, 0])
            self.engine.set_fluid(coupling.exchange(*self.engine.kinematics()))
            budget = coupling.budget
            if budget is not None:
                weight += (budget.gravity + fixed.m.sum() * fixed.gravity[0] / column.area) * dt
                water += (budget.bed + budget.fixed + budget.surface) * dt
            spent += dt
        gain = float(fixed.m @ (self.engine.kinematics()[1] - v)[:, 0]) / column.area
        now = coupling.state
        gain += column.rho_w * float(now.content @ now.u - u.content @ u.u)
        return Impulses(float(weight), (contacts + self._held()) / column.area, float(water), gain)

    def _held(self) -> float:
        """What contacts that are not over have given so far [N s]."""
        now = self.engine.state().contacts
        return self._of_fixed(now.i, now.j, now.event[:, _IMPULSE_X])

    def _of_fixed(self, i: Any, j: Any, impulse: Floats) -> float:
        """Sum of what fixed grains gave along the bed [N s]."""
        n = self.fixed.n_grain
        return float(impulse[(j >= n) & (i < n)].sum())


def weigh(form: str, time: float, seed: int) -> dict[str, Floats]:
    """Impulses in PARTS of a time [s] after settling [Pa s], shape (PARTS, 4); mean grain speed [m/s]."""
    flow = ChannelFlow(FORMS[form], seed)
    flow.run(SETTLE)
    parts = [flow.run(time / PARTS) for _ in range(PARTS)]
    return {"parts": np.array(parts), "speed": np.array(flow.engine.kinematics()[1][:, 0].mean())}


def _calls(form: str, plan: Plan) -> list[Task]:
    time = SAMPLING["balance"].length(plan.level)
    return [
        calculation(weigh, form=form, time=time, seed=seed, seconds=5.0 * (SETTLE + time))
        for seed in SAMPLING["balance"].seeds(plan)
    ]


def tasks(plan: Plan) -> Sequence[Task]:
    """Every form of buoyancy over beds of several seeds; quick for a shorter time."""
    return [one for form in FORMS for one in _calls(form, plan)]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """What the bed carries over the weight, averaged over a growing time."""
    time = SAMPLING["balance"].length(plan.level) * (1.0 + np.arange(PARTS)) / PARTS
    ours: list[Curve] = []
    numbers = dict[str, Interval]()
    closes = 0.0
    for form in FORMS:
        ratios: list[Floats] = []
        for one in _calls(form, plan):
            weight, contacts, water, gain = np.cumsum(found[one]["parts"], axis=0).T
            ratios.append(-(contacts + water) / weight)
            off = np.abs(weight + contacts + water - gain) / weight
            closes = max(closes, float(off.max()))
        ours.append(Curve(f"buoyancy {form}", time, np.mean(ratios, axis=0)))
        numbers[form] = largest_mean([[float(one[-1]) - 1.0 for one in ratios]], "-", absolute=True)
    weighed = DECLARED["bed-stress"].finding(
        ours, [Curve("1", time, np.ones(PARTS))], {"bed": numbers, "closes": closes}
    )
    return [weighed]
