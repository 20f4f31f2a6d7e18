"""In steady flow the bed carries the weight of water and grains, whatever the form of buoyancy.

What grains give to the bed is read from the contacts' own impulses, which know nothing of the water.
"""

import math

import numpy as np
import pytest

from ryusa.build import scene
from ryusa.engine.cpu import CpuEngine
from ryusa.model import Column, Water
from ryusa.model.column import Bed, Mixing, Start
from ryusa.model.contacts import EVENT
from ryusa.model.enums import Buoyancy, Drag, EventRule, Hindrance, Profile
from ryusa.water.coupling import Coupling

D, G, SLOPE, WIDE = 2.0e-3, 9.80665, 0.1, 20
IMPULSE_X = EVENT.fields["impulse"][1] // 8  # its column in an open record


def moving_bed(form):
    """Two layers of loose grains on a row of fixed ones of random height, under water four grains deep."""
    rng = np.random.default_rng(5)
    row = np.zeros((WIDE, 3))
    row[:, 0], row[:, 2] = (np.arange(WIDE) + 0.5) * D, rng.uniform(0.0, 0.5, WIDE) * D
    a, b = (g.ravel() for g in np.meshgrid(np.arange(16), np.arange(2), indexing="ij"))
    x = np.column_stack([(a + 0.5 + 0.3 * b) * 1.25 * D, 0.0 * a, (1.7 + 1.15 * b) * D])
    laws = {"drag": Drag.SCHILLER_NAUMANN, "hindrance": Hindrance.DI_FELICE, "buoyancy": form}
    made = scene(
        x, D * rng.uniform(0.9, 1.1, len(x)), x_fixed=row, d_fixed=D, gravity=G, slope=SLOPE, stiffness=100.0,
        water=Water(profile=Profile.COLUMN, **laws), period=(WIDE * D, math.inf), plane_case=True,
        events=EventRule.ALL,
    )  # fmt: skip
    column = Column(
        z_low=-0.5 * D, dz=0.1 * D, n=120, depth=4.0 * D, z_bed=2.0 * D, area=WIDE * D * D, bed=Bed.MOVING,
        mixing=Mixing.LI_SAWAMOTO, phi_max=0.55, d=D, g_x=G * math.sin(SLOPE), start=Start.STEADY,
    )  # fmt: skip
    return made, column


def of_fixed(i, j, impulse, fixed):
    """Sum of what fixed grains gave along the bed [N s]."""
    there = (j >= fixed.n_grain) & (i < fixed.n_grain)
    return float(impulse[there].sum())


class Flow:
    """Grains and water, and the impulses of their contacts with the bed."""

    def __init__(self, form):
        (self.fixed, first), self.column = moving_bed(form)
        self.engine = CpuEngine()
        self.engine.load(self.fixed, first)
        self.coupling = Coupling.begin(self.fixed, self.column, 100, first.x)
        self.engine.immerse(self.coupling.seen)

    def held(self):
        """What contacts that are not over have given so far."""
        now = self.engine.state().contacts
        return of_fixed(now.i, now.j, now.event[:, IMPULSE_X], self.fixed)

    def run(self, time):
        """Impulses by area of bed over a time [Pa s]: weight, contacts, stress and drag on the bed, gain."""
        fixed, column, coupling = self.fixed, self.column, self.coupling
        v, u = self.engine.drift()[1], coupling.state
        weight, contacts, water, spent = 0.0, -self.held(), 0.0, 0.0
        self.engine.events()
        while spent < time:
            steps = coupling.steps
            dt = steps * fixed.dt
            self.engine.advance(steps).raise_if_any()
            events = self.engine.events()
            contacts += of_fixed(events["i"], events["j"], events["impulse"][:, 0], fixed)
            self.engine.immerse(coupling.exchange(*self.engine.drift()))
            budget = coupling.budget
            weight += (budget.gravity + fixed.m.sum() * fixed.gravity[0] / column.area) * dt
            water += (budget.bed + budget.fixed + budget.surface) * dt
            spent += dt
        contacts = (contacts + self.held()) / column.area
        gain = float(fixed.m @ (self.engine.drift()[1] - v)[:, 0]) / column.area
        now = coupling.state
        gain += 1000.0 * float(now.content @ now.u - u.content @ u.u)
        return weight, contacts, water, gain


@pytest.mark.parametrize("form", list(Buoyancy))
def test_bed_and_fixed_grains_carry_the_weight_of_the_mixture(form):
    flow = Flow(form)
    flow.run(1.0)
    weight, contacts, water, gain = flow.run(2.5)
    assert -contacts > 0.8 * weight
    assert weight + contacts + water == pytest.approx(gain, abs=1e-9 * weight)
    assert -(contacts + water) == pytest.approx(weight, rel=0.01)
    assert np.mean(flow.engine.drift()[1][:, 0]) > 0.02  # [m/s]; it is bed load that the contacts carry
