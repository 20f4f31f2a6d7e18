"""Clumps in water: settling by the law of their form, momentum and energy kept, the same bits."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.engine.conftest import D, bits, run
from tests.water.test_coupling import advance_together

from ryusa.build import scene
from ryusa.build.clumps import random_orientations, with_clumps
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws._family import evaluate
from ryusa.laws.families import (
    BedKind,
    Buoyancy,
    ContactTiming,
    Drag,
    DragOfForm,
    Fluctuations,
    Hindrance,
    Lift,
    Magnus,
    Mixing,
    Profile,
    Rebound,
    WaterTorque,
)
from ryusa.model import Column, Term, Water
from ryusa.model.clump import drag_form, shape
from ryusa.model.scene import EventRule
from ryusa.water.coupling import Coupling

FLOOR = ("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
KEYS = {"timing": ContactTiming.AT_STEPS, "events": EventRule.NONE}
STILL = Water(
    profile=Profile.STILL, drag=Drag.SCHILLER_NAUMANN, drag_of_form=DragOfForm.BAGHERI_BONADONNA,
    torque=WaterTorque.STOKES,
)  # fmt: skip
G, NU = 9.80665, 1.0e-6
DEEP = {"planes": [("deep", (0.0, 0.0, -100.0), (0.0, 0.0, 1.0))]}  # the world reaches so far


@pytest.mark.full
@pytest.mark.parametrize("law", list(DragOfForm))
@pytest.mark.parametrize("form", ["dumbbell", "blade"])
def test_a_clump_settles_as_the_law_of_its_form_implies(law, form):
    """Weight under water against C_D at the terminal Reynolds number, of the sphere of the same volume."""
    water = replace(STILL, drag_of_form=law)
    made = scene(x=[[0, 0, 0]], d=D, omega=[[30.0, 5.0, 3.0]], water=water, dt=1e-4, **DEEP, **KEYS)
    fixed, state = with_clumps(*made, [shape(form)])
    engine = run((fixed, state), 20_000)
    stokes, newton, sphericity = drag_form(law, shape(form), 2.65)

    def excess(u):
        re = u * D / NU
        if law == DragOfForm.SPHERE:
            c_d = evaluate(Drag.SCHILLER_NAUMANN, re=re)
        else:
            c_d = evaluate(law, re=re, stokes=stokes, newton=newton, sphericity=sphericity)
        return 0.75 * c_d * u * u - 1.65 * G * D

    assert -engine.state().bodies.v[0, 2] == pytest.approx(brentq(excess, 1e-3, 10.0), rel=1e-9)
    assert engine.tally().residual < 1e-9


@pytest.mark.full
def test_the_spin_of_a_clump_decays_by_the_torque_on_its_sphere():
    """About a principal axis, slowly enough for Stokes: d(omega)/dt = -pi mu d^3 omega/I."""
    water = replace(STILL, nu=1e-4)
    made = scene(x=[[0, 0, 0]], d=D, omega=[[0.0, 0.0, 0.1]], water=water, gravity=0.0, dt=1e-6, **KEYS)
    fixed, state = with_clumps(*made, [shape("rod")])
    rate = math.pi * 1000.0 * 1e-4 * D**3 / float(fixed.bodies.inertia[0, 2])
    engine = run((fixed, state), 5000)
    left = engine.state().bodies.spin(fixed.bodies)[0, 2] / 0.1
    assert left == pytest.approx(math.exp(-rate * engine.state().t), rel=2e-3)
    assert left < 0.9


@pytest.mark.full
@pytest.mark.parametrize("profile", [Profile.STILL, Profile.UNIFORM])
def test_a_clump_of_one_sphere_in_water_does_as_the_sphere(profile):
    water = replace(STILL, profile=profile, u_uniform=0.3, drag_of_form=DragOfForm.SPHERE)
    how = {
        "x": [[0, 0, 0.75 * D], [0.25 * D, 0.35 * D, 2.0 * D]], "v": [[0.1, 0.02, -0.3], [0.0, 0.0, -1.0]],
        "omega": [[10.0, 20.0, 3.0], [0.0, 5.0, 0.0]], "planes": [FLOOR], "water": water, "dt": 2e-6,
    }  # fmt: skip
    alone = run(scene(d=D, **KEYS, **how), 3000)
    turned = random_orientations(2, np.random.default_rng(3))
    made = scene(d=D, **KEYS, **how)
    fixed, state = with_clumps(*made, [shape("sphere")], orientation=turned)
    clump = run((replace(fixed, dt=made[0].dt), state), 3000)
    for name in ("x", "v", "omega"):
        assert np.allclose(getattr(clump.grains(), name), getattr(alone.grains(), name), rtol=1e-8)
    for name in ("kinetic", "spin", "potential"):
        assert getattr(clump.tally(), name) == pytest.approx(getattr(alone.tally(), name), rel=1e-8)
    assert clump.tally().terms == pytest.approx(alone.tally().terms, rel=1e-6, abs=1e-16)


def cloud(form="rod", buoyancy=Buoyancy.STRESS, part=0.7, seed=8, **more):
    """Clumps and spheres in flowing water over a floor, falling, in three dimensions."""
    rng = np.random.default_rng(seed)
    pitch = 3.0 * D
    x = np.stack(np.meshgrid(np.arange(4), np.arange(4), np.arange(5), indexing="ij"), -1).reshape(-1, 3)
    x = (x + np.array([0.5, 0.5, 0.6])) * pitch
    water = Water(
        profile=Profile.COLUMN, drag=Drag.SCHILLER_NAUMANN, drag_of_form=DragOfForm.BAGHERI_BONADONNA,
        buoyancy=buoyancy, hindrance=Hindrance.DI_FELICE, lift=Lift.WIBERG_SMITH, magnus=Magnus.LOTH,
        torque=WaterTorque.DENNIS,
    )  # fmt: skip
    period = (4.0 * pitch, 4.0 * pitch)
    made = scene(
        x, D, v=rng.normal(0.0, 0.2, x.shape), water=water, gravity=G, slope=0.05, period=period,
        planes=[FLOOR], dt=1e-5, stiffness=2e3, **KEYS,
    )  # fmt: skip
    which = np.where(rng.uniform(size=len(x)) < part, 0, -1)
    fixed, state = with_clumps(
        *made, [shape(form)], form_of=which, orientation=random_orientations(len(x), rng)
    )
    column = Column(
        z_low=0.0, dz=0.5 * D, n=60, depth=24.0 * D, area=period[0] * period[1], bed=BedKind.ROUGH,
        k_rough=D, mixing=Mixing.PARABOLIC, g_x=G * math.sin(0.05), **more,
    )  # fmt: skip
    return (replace(fixed, dt=1e-5), state), column


def momentum(scene, state):
    """Of all grains along the bed, each clump as one [N s]."""
    alone = scene.bodies.of_grain(scene.n_grain) < 0
    return float(scene.m[alone] @ state.v[alone, 0] + scene.bodies.m @ state.bodies.v[:, 0])


@pytest.mark.full
@pytest.mark.parametrize("buoyancy", list(Buoyancy))
def test_clumps_and_a_column_gain_together_what_weight_and_bed_give(buoyancy):
    """Until the first touches the floor, whose friction would count too."""
    made, column = cloud(buoyancy=buoyancy)
    fixed, before = made
    before, area = momentum(fixed, before), column.area
    for coupling, engine, steps, _ in advance_together(made, column, 12):
        budget, time = coupling.budget, steps * fixed.dt
        now = momentum(fixed, engine.grains())
        grains, before = (now - before) / (area * time), now
        weight = float(fixed.m.sum()) * fixed.gravity[0] / area
        given = weight + budget.gravity + budget.driver + budget.bed + budget.surface
        assert grains + budget.change == pytest.approx(given, rel=1e-9, abs=1e-9 * weight)
    assert engine.tally().n_contact == 0
    assert engine.tally().residual < 1e-6


@pytest.mark.full
def test_clumps_in_a_column_give_the_same_bits_for_any_threads_and_after_a_resume():
    made, column = cloud()
    column = replace(column, interval=20)

    def onward(engine, coupling, intervals):
        for _ in range(intervals):
            engine.advance(coupling.steps).raise_if_any()
            engine.set_fluid(coupling.exchange(*engine.kinematics()))

    def begun(threads):
        engine = CpuEngine(threads=threads)
        engine.load(*made)
        coupling = Coupling.begin(made[0], column, made[1].x)
        engine.set_fluid(coupling.sampled)
        return engine, coupling

    one, two = begun(1), begun(2)
    onward(*one, 60)
    onward(*two, 60)
    assert bits(one[0].state()) == bits(two[0].state())
    assert one[0].tally() == two[0].tally()
    half = one[0].state(), one[1].snapshot()
    onward(*one, 60)
    again = CpuEngine()
    again.load(made[0], half[0])
    coupling = Coupling.resume(made[0], column, half[1], half[0].fluid.sampled)
    onward(again, coupling, 60)
    assert bits(again.state()) == bits(one[0].state())
    assert np.array_equal(again.state().bodies.momentum, one[0].state().bodies.momentum)
    assert again.tally() == one[0].tally()
    assert again.tally().terms[Term.DASH_N] != 0.0  # some met
    assert again.tally().residual < 1e-3


@pytest.mark.full
def test_a_clump_in_a_column_of_still_water_settles_as_one_sphere_of_its_drag():
    """Many cells and no neighbours: the column gives the terminal velocity of the isolated clump."""
    water = replace(STILL, profile=Profile.COLUMN, buoyancy=Buoyancy.WEIGHT)
    wide = 40.0 * D
    made = scene(
        x=[[0.5 * wide, 0.5 * wide, 400.0 * D]],
        d=D,
        water=water,
        period=(wide, wide),
        dt=1e-4,
        **DEEP,
        **KEYS,
    )
    fixed, state = with_clumps(*made, [shape("disc")])
    fixed = replace(fixed, dt=1e-4)
    column = Column(z_low=0.0, dz=10.0 * D, n=60, depth=580.0 * D, area=wide * wide, g_x=0.0)
    *_, (_, engine, _, _) = advance_together((fixed, state), column, 200, longest=10)
    alone = run(
        with_clumps(*scene(x=[[0, 0, 0]], d=D, water=STILL, dt=1e-4, **DEEP, **KEYS), [shape("disc")]), 20_000
    )
    settled = alone.state().bodies.v[0, 2]
    assert engine.state().bodies.v[0, 2] == pytest.approx(settled, rel=2e-3)


def test_what_clumps_in_water_cannot_have_is_refused_by_name():
    made, column = cloud()
    fixed = made[0]
    assert CpuEngine().refuses(fixed) == ()
    dry = replace(fixed, bodies=replace(fixed.bodies, drag_form=np.zeros((0, 3))))
    assert "bodies.drag_form" in CpuEngine().refuses(dry)[0]
    films = replace(fixed, water=replace(fixed.water, rebound=Rebound.EXPONENTIAL))
    assert "rebound must be dry" in " ".join(CpuEngine().refuses(films))
    stirred = replace(fixed, flow=replace(column, fluctuations=Fluctuations.RANDOM_WALK))
    assert "without fluctuations" in " ".join(CpuEngine().refuses(stirred))
    wrong = replace(fixed, bodies=replace(fixed.bodies, drag_form=-fixed.bodies.drag_form))
    assert "drag_form is not finite and positive" in " ".join(CpuEngine().refuses(wrong))
