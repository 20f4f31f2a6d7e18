"""Grains at the free surface: water acts only on the part below it, and momentum is conserved."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.water.cells import to_cells

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import BedKind, Buoyancy, Drag, Lift, Mixing, Profile, SurfaceRule, WaterTorque
from ryusa.model import Column, Water
from ryusa.model.scene import EventRule
from ryusa.water.coupling import Coupling
from ryusa.water.exchange import Cells, slices
from ryusa.water.free_surface import submerged_part

D, G = 2.0e-3, 9.80665
FORMS = list(Buoyancy)
SURFACE = 10.3 * D  # in the midst of a cell


def column_of(area, **more):
    given = {"z_low": 0.0, "dz": 0.2 * D, "n": 100, "depth": SURFACE, "area": area, "bed": BedKind.MOVING}
    return Column(**(given | more))


def made_of(heights, form=Buoyancy.STRESS, slope=0.0, **more):
    """Grains side by side at heights z [m], far from each other."""
    n = len(heights)
    x = np.column_stack([(np.arange(n) + 0.5) * 4.0 * D, np.zeros(n), heights])
    water = Water(profile=Profile.COLUMN, drag=Drag.SCHILLER_NAUMANN, buoyancy=form, **more)
    made = scene(
        x, D, water=water, gravity=G, slope=slope, period=(n * 4.0 * D, math.inf), plane_case=True, dt=2e-5,
        events=EventRule.NONE,
    )  # fmt: skip
    return made, n * 4.0 * D * D


def stepped(made, column, intervals, longest=20):
    """Grains and water together; yields coupling, steps and speeds before and after every interval."""
    engine = CpuEngine()
    engine.load(*made)
    coupling = Coupling.begin(made[0], replace(column, interval=longest), made[1].x)
    engine.set_fluid(coupling.sampled)
    for _ in range(intervals):
        steps, before = coupling.steps, engine.kinematics()[1]
        engine.advance(steps).raise_if_any()
        x, v, taken = engine.kinematics()
        engine.set_fluid(coupling.exchange(x, v, taken))
        yield coupling, engine, steps, before, v


def test_slices_end_at_the_surface():
    z, d = np.array([9.0, 10.0, 10.35, 11.2]) * D, np.full(4, D)
    whole = slices(z, d, Cells(0.0, 0.2 * D, 100, 1.0))
    cut = submerged_part(whole, z, d, SURFACE)
    high = np.clip(SURFACE - z, -0.5 * D, 0.5 * D)
    cap = math.pi * (0.25 * D * D * (high + 0.5 * D) - (high**3 + 0.125 * D**3) / 3.0)
    assert cut.submerged == pytest.approx(cap, rel=1e-12, abs=1e-24)
    assert cut.submerged + cut.above == pytest.approx(cut.whole)
    assert to_cells(cut, np.ones(4), "submerged").cells.sum() == pytest.approx(3.0)  # the last is dry
    assert to_cells(cut, np.ones(4), "submerged").above == 1.0
    assert submerged_part(whole, z, d, 12.0 * D) is whole


@pytest.mark.parametrize("form", FORMS)
def test_a_grain_above_the_surface_falls_freely(form):
    laws = {"lift": Lift.SAFFMAN_MEI, "torque": WaterTorque.STOKES}
    made, area = made_of([SURFACE + 4.0 * D], form, slope=0.1, **laws)
    every = [*stepped(made, column_of(area, g_x=G * math.sin(0.1)), 3)]
    engine, count = every[-1][1], sum(steps for _, _, steps, *_ in every)
    v = engine.kinematics()[1][0] / (count * made[0].dt)
    assert v[2] == pytest.approx(-G * math.cos(0.1), rel=1e-9)
    assert v[0] == pytest.approx(G * math.sin(0.1), rel=1e-9)


@pytest.mark.parametrize("form", FORMS)
def test_a_grain_half_in_the_water_has_half_its_buoyancy_and_added_mass(form):
    (fixed, first), area = made_of([SURFACE], form)
    engine = CpuEngine()
    engine.load(fixed, first)
    coupling = Coupling.begin(fixed, column_of(area), first.x)
    engine.set_fluid(coupling.sampled)
    engine.advance(1).raise_if_any()
    rho_s, v_z = 2650.0, engine.kinematics()[1][0, 2]
    pull = (rho_s - 0.5 * 1000.0) * G / (rho_s + 0.5 * 0.5 * 1000.0)
    assert v_z == pytest.approx(-pull * fixed.dt, rel=1e-6)


@pytest.mark.parametrize("surface", list(SurfaceRule))
@pytest.mark.parametrize("form", FORMS)
def test_momentum_closes_where_grains_pass_the_surface(form, surface):
    heights = SURFACE + np.linspace(-3.0, 3.0, 24) * D
    made, area = made_of(heights, form, slope=0.05, lift=Lift.WIBERG_SMITH)
    column = column_of(
        area, surface=surface, bed=BedKind.ROUGH, k_rough=0.4 * D, mixing=Mixing.PARABOLIC,
        g_x=G * math.sin(0.05),
    )  # fmt: skip
    fixed, levels = made[0], []
    begin = replace(made[1], v=np.tile([0.3, 0.0, -0.2], (24, 1)))
    for coupling, _, steps, v, v_now in stepped((fixed, begin), column, 30):
        budget, time = coupling.budget, steps * fixed.dt
        grains = float(fixed.m @ (v_now[:, 0] - v[:, 0])) / (area * time)
        weight = float(fixed.m.sum()) * fixed.gravity[0] / area
        given = weight + budget.gravity + budget.driver + budget.bed + budget.surface
        assert grains + budget.change == pytest.approx(given, rel=1e-10, abs=1e-9 * weight)
        levels.append(coupling.state.z_surface)
    assert (float(np.ptp(levels)) > 0.1 * column.dz) == (surface is SurfaceRule.VOLUME)


def test_the_energy_of_added_mass_is_accounted_for():
    made, area = made_of([SURFACE + 1.0 * D, SURFACE + 0.3 * D])
    begin = replace(made[1], v=np.tile([0.0, 0.0, -0.5], (2, 1)))
    *_, (_, engine, *_) = stepped((made[0], begin), column_of(area), 200, 5)
    assert float(engine.kinematics()[0][:, 2].max()) < SURFACE - 0.5 * D
    assert engine.tally().residual < 1e-3
