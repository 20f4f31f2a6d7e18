"""Fixed grains: forces of the water on them, and the steady flow with which a run starts."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import BedKind, Buoyancy, Drag, Hindrance, Mixing, Profile, Start
from ryusa.model import Column, Water
from ryusa.model.scene import EventRule
from ryusa.water.coupling import Coupling
from ryusa.water.fixed_grains import settled_concentration

D, G, SLOPE = 2.0e-3, 9.80665, 0.05
FORMS = list(Buoyancy)


def bed(form, layers=5, wide=12):
    """Layers of fixed grains under flowing water, and one free grain far above."""
    a, b = (g.ravel() for g in np.meshgrid(np.arange(wide), np.arange(layers), indexing="ij"))
    x = np.column_stack([(a + 0.5 + 0.5 * (b % 2)) * 1.1 * D, 0.0 * a, (b + 0.5) * D])
    laws = {"drag": Drag.SCHILLER_NAUMANN, "hindrance": Hindrance.DI_FELICE, "buoyancy": form}
    made = scene(
        [[0.01, 0.0, 12.0 * D]], D, x_fixed=x, d_fixed=D, water=Water(profile=Profile.COLUMN, **laws),
        gravity=G, slope=SLOPE, period=(wide * 1.1 * D, math.inf), plane_case=True, dt=2e-5,
        events=EventRule.NONE,
    )  # fmt: skip
    column = Column(
        z_low=0.0, dz=0.1 * D, n=160, depth=10.0 * D, z_bed=5.0 * D, area=wide * 1.1 * D * D,
        bed=BedKind.MOVING, mixing=Mixing.LI_SAWAMOTO, phi_max=0.5, g_x=G * math.sin(SLOPE), d=D,
    )  # fmt: skip
    return made, column


def alone(made, column, **more):
    """The bed without its free grain."""
    fixed, _ = made
    none = {name: np.zeros(0) for name in ("d", "m", "m_added", "m_weight", "inertia")}
    return Coupling.begin(replace(fixed, **none), column, np.zeros((0, 3)), **more)


@pytest.mark.parametrize("form", FORMS)
def test_fixed_grains_carry_the_rest_of_the_weight_of_the_water(form):
    made, column = bed(form)
    coupling = alone((replace(made[0], dt=1e-3), made[1]), column)
    none = np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 4))
    speeds = []
    for _ in range(1000):
        coupling.exchange(*none)
        assert coupling.budget.relative < 1e-10
        speeds.append(coupling.state.u[-1])
    budget = coupling.budget
    assert speeds[-1] == pytest.approx(speeds[-300], rel=1e-2)
    assert abs(budget.change) < 0.02 * budget.gravity
    assert abs(budget.grains) < 1e-10 * budget.gravity
    assert -budget.fixed == pytest.approx(budget.gravity + budget.bed, rel=0.02)
    assert -budget.fixed > 0.9 * budget.gravity


@pytest.mark.parametrize("form", FORMS)
def test_a_long_step_over_fixed_grains_is_stable_and_ends_in_the_same_flow(form):
    made, column = bed(form)
    fine = alone((replace(made[0], dt=2e-3), made[1]), column)
    none = np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 4))
    for _ in range(400):
        fine.exchange(*none)
    coarse = alone((replace(made[0], dt=1.0), made[1]), column)
    for _ in range(60):
        coarse.exchange(*none)
    assert coarse.state.u == pytest.approx(fine.state.u, rel=1e-3, abs=1e-3)


def test_fixed_grains_under_a_rough_wall_take_no_force():
    made, column = bed(Buoyancy.STRESS)
    rough = replace(column, z_low=5.0 * D, n=110, bed=BedKind.ROUGH, k_rough=D, mixing=Mixing.PARABOLIC)
    coupling = alone(made, rough)
    coupling.exchange(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 4)))
    assert coupling.budget.fixed == 0.0


@pytest.mark.parametrize("form", FORMS)
def test_a_steady_start_is_the_steady_flow_over_the_bed(form):
    made, column = bed(form)
    column = replace(column, start=Start.STEADY)
    coupling = Coupling.begin(made[0], column, made[1].x)
    first = coupling.state
    assert (first.t, first.step) == (0.0, 0)
    wet = np.clip(15.0 * D - column.faces[:-1], 0.0, column.dz)
    assert first.content == pytest.approx((1.0 - coupling.phi) * wet)
    deep = column.z < 3.0 * D
    assert (first.u[deep] < 0.05 * first.u[-1]).all()
    over = np.interp(6.0 * D, column.faces, first.tau)
    assert over == pytest.approx(1000.0 * column.g_x * 9.0 * D, rel=0.01)
    engine = CpuEngine()
    engine.load(*made)
    engine.set_fluid(coupling.sampled)
    engine.advance(1).raise_if_any()
    assert engine.state().v[0, 0] > 0.0


def test_still_water_begins_at_rest_either_way():
    made, column = bed(Buoyancy.STRESS)
    still = replace(column, g_x=0.0, start=Start.STEADY)
    level = replace(made[0], gravity=np.array([0.0, 0.0, -G]))
    assert (Coupling.begin(level, still, made[1].x).state.u == 0.0).all()


def test_settled_grains_have_the_packed_concentration_and_none_is_lost():
    _, column = bed(Buoyancy.STRESS)
    free = np.where((column.z > 6.0 * D) & (column.z < 9.0 * D), 0.3, 0.0)
    fixed = np.where(column.z < D, 0.4, 0.0)
    phi = settled_concentration(column, fixed, free, D)
    assert phi.sum() == pytest.approx(free.sum() + fixed.sum(), rel=0.01)  # of the mean at the lowest cells
    assert phi[0] == pytest.approx(0.5)
    end = D + (0.3 * 3.0 - 0.1) / 0.5 * D
    assert np.interp(-0.25, -phi, column.z) == pytest.approx(end, abs=column.dz)


@pytest.mark.parametrize("form", FORMS)
def test_water_among_fixed_grains_never_flows_backwards(form):
    made, column = bed(form)
    coupling = alone((replace(made[0], dt=1e-3), made[1]), column)
    for _ in range(60):
        coupling.exchange(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 4)))
    assert coupling.state.u.min() >= 0.0
