"""Water and grains together: nothing is lost between them, and a suspension settles as the laws imply."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.errors import NotANumber
from ryusa.laws import drag
from ryusa.laws.families import BedKind, Buoyancy, Drag, Hindrance, Lift, Magnus, Mixing, Profile, WaterTorque
from ryusa.laws.hindrance import exponent_settling
from ryusa.model import Column, Water
from ryusa.model.fluid import N_IMPULSE
from ryusa.model.scene import EventRule
from ryusa.water.coupling import Coupling
from ryusa.water.exchange_step import force_on_water
from ryusa.water.slice_sums import GIVEN_MET, sum_given

D, G = 2.0e-3, 9.80665
FORMS = list(Buoyancy)


def advance_together(made, column, intervals, longest=20, water_state=None):
    """Step grains and water together; yields the coupling and the engine after every interval."""
    fixed, first = made
    engine = CpuEngine()
    engine.load(fixed, first)
    coupling = Coupling.begin(fixed, replace(column, interval=longest), first.x, state=water_state)
    engine.set_fluid(coupling.sampled)
    for _ in range(intervals):
        steps, before = coupling.steps, coupling.sampled
        x, v, _ = engine.kinematics()
        engine.advance(steps).raise_if_any()
        x_now, v_now, taken = engine.kinematics()
        engine.set_fluid(coupling.exchange(x_now, v_now, taken))
        yield coupling, engine, steps, (x, v, before, x_now, v_now, taken)


def cloud(form, n=40, slope=0.05, density=2650.0, **more):
    """Grains far apart in flowing water, at rest."""
    rng = np.random.default_rng(8)
    x = np.zeros((n, 3))
    x[:, 0] = (np.arange(n) + 0.5) * 4.0 * D
    x[:, 2] = rng.uniform(4.0 * D, 20.0 * D, n)
    water = Water(profile=Profile.COLUMN, drag=Drag.SCHILLER_NAUMANN, buoyancy=form, **more)
    period = (n * 4.0 * D, math.inf)
    made = scene(
        x, D, density=density, water=water, gravity=G, slope=slope, period=period, plane_case=True, dt=2e-5,
        events=EventRule.NONE,
    )  # fmt: skip
    return made, n * 4.0 * D * D


def column_of(area, **more):
    given = {"z_low": 0.0, "dz": 0.2 * D, "n": 130, "depth": 25.0 * D, "area": area, "bed": BedKind.ROUGH}
    given |= {"k_rough": 0.4 * D, "mixing": Mixing.PARABOLIC, "g_x": G * math.sin(0.05)}
    return Column(**(given | more))


def test_a_grain_whose_height_is_not_finite_is_named_with_its_step():
    (fixed, first), area = cloud(FORMS[0])
    coupling = Coupling.begin(fixed, column_of(area), first.x)
    x = first.x.copy()
    x[7, 2] = np.nan
    with pytest.raises(NotANumber, match="height is not finite: grain 7, step 1, t ="):
        coupling.exchange(x, first.v, np.zeros((len(x), N_IMPULSE)))


@pytest.mark.parametrize("collide", [False, True])
@pytest.mark.parametrize("form", FORMS)
def test_grains_and_water_together_gain_what_weight_and_bed_give(form, collide):
    every = {"lift": Lift.WIBERG_SMITH, "magnus": Magnus.LOTH, "hindrance": Hindrance.DI_FELICE}
    (fixed, first), area = cloud(form, torque=WaterTorque.DENNIS, **every)
    if collide:  # in pairs of unlike density: a contact moves the water that goes along with a grain, too
        fixed = replace(fixed, m=fixed.m * np.where(np.arange(40) % 2, 1.0, 0.7))
        x, v = first.x.copy(), first.v.copy()
        x[1::2], v[::2] = x[::2] + np.array((0.96 * D, 0.0, 0.3 * D)), [0.5, 0.0, 0.0]
        first = replace(first, x=x, v=v)
    made, dt = (fixed, first), fixed.dt
    for coupling, _, steps, (_, v, _, _, v_now, _) in advance_together(made, column_of(area), 12):
        budget, time = coupling.budget, steps * dt
        grains = float(fixed.m @ (v_now[:, 0] - v[:, 0])) / (area * time)
        weight = float(fixed.m.sum()) * fixed.gravity[0] / area
        given = weight + budget.gravity + budget.driver + budget.bed + budget.surface
        assert grains + budget.change == pytest.approx(given, rel=1e-10, abs=1e-10 * weight)


@pytest.mark.parametrize("form", [Buoyancy.WEIGHT, Buoyancy.STRESS])
@pytest.mark.parametrize(
    ("law", "exponent"), [(Hindrance.NONE, 0.0), (Hindrance.RICHARDSON_ZAKI, 3.5), (Hindrance.POWER, 2.0)]
)
def test_a_suspension_settles_as_its_hindrance_implies(form, law, exponent):
    pitch, layers, wide, d = 1.25, 16, 8, 1.0e-4  # Stokes' range
    a, b = (g.ravel() for g in np.meshgrid(np.arange(wide), np.arange(layers), indexing="ij"))
    x = np.column_stack([(a + 0.5) * pitch * d, np.zeros(a.size), (b + 0.5) * pitch * d])
    phi = math.pi / 6 / pitch**2
    water = Water(
        profile=Profile.COLUMN, drag=Drag.SCHILLER_NAUMANN, buoyancy=form, hindrance=law,
        hindrance_exponent=exponent,
    )  # fmt: skip
    weight = 1650.0 * math.pi / 6 * d**3 * G
    w_0 = drag.terminal_velocity_stokes(1.65, G, d, 1e-6)
    for _ in range(60):  # Schiller & Naumann at this size
        re = drag.reynolds(w_0, d, 1e-6)
        w_0 *= weight / (drag.drag_factor(w_0, drag.c_d_schiller_naumann(re), 1e3, math.pi / 4, d) * w_0)
    tau = 3150.0 * math.pi / 6 * d**3 * w_0 / weight
    made = scene(
        x, d, water=water, gravity=G, plane_case=True, period=(wide * pitch * d, math.inf), dt=tau / 100.0,
        stiffness=1e-3, events=EventRule.NONE,
    )  # fmt: skip
    made = (replace(made[0], world_low=(-math.inf,) * 3), made[1])
    column = Column(
        z_low=0.0,
        dz=pitch * d,
        n=layers,
        depth=layers * pitch * d,
        area=wide * pitch * d * d,
        bed=BedKind.MOVING,
    )
    speeds = []
    for _, engine, *_ in advance_together(made, column, 40, longest=10):
        speeds.append(-float(engine.kinematics()[1][np.flatnonzero(b == layers // 2), 2].mean()))
    found = math.log(speeds[-1] / w_0) / math.log(1.0 - phi)
    if law is Hindrance.RICHARDSON_ZAKI:
        n = exponent
    else:
        n = exponent_settling(_steepness(0.7 * w_0, d), 0.0, exponent, form is Buoyancy.STRESS)
    assert found == pytest.approx(n, abs=0.02)


def _steepness(w, d):
    """Power of the speed with which the drag of Schiller & Naumann grows at speed w."""
    force = [
        drag.drag_factor(u, drag.c_d_schiller_naumann(drag.reynolds(u, d, 1e-6)), 1e3, math.pi / 4, d) * u
        for u in (0.99 * w, 1.01 * w)
    ]
    return math.log(force[1] / force[0]) / math.log(1.01 / 0.99)


@pytest.mark.parametrize(
    ("form", "stays"), [(Buoyancy.WEIGHT, True), (Buoyancy.STRESS, True), (Buoyancy.PRESSURE, False)]
)
def test_a_neutral_grain_at_the_speed_of_the_water_stays_with_it(form, stays):
    from ryusa.water import steady

    made, area = cloud(form, n=6, density=1000.0)
    column = column_of(area * 1000.0)  # so wide that the grains do not slow the water
    none = np.zeros(column.n)
    water_state, _ = steady(column, none, None)
    u = np.interp(made[1].x[:, 2], column.z, water_state.u)
    v = np.column_stack([u, 0.0 * u, 0.0 * u])
    made = (made[0], replace(made[1], v=v))
    slips = [
        np.abs(engine.kinematics()[1][:, 0] - u).max()
        for _, engine, *_ in advance_together(made, column, 40, 20, water_state)
    ]
    free = G * math.sin(0.05) * 40 * 20 * made[0].dt
    assert bool(slips[-1] < 0.02 * free) is stays


def test_fixed_grains_fill_the_cells_that_they_stand_in():
    made, area = cloud(Buoyancy.STRESS, n=6)
    count = 12
    bed = np.column_stack([(np.arange(count) + 0.5) * 2.0 * D, np.zeros(count), np.full(count, 0.5 * D)])
    fixed = replace(
        made[0], x_fixed=bed, d_fixed=np.full(count, D), fixed_active=np.ones(count, dtype=np.bool_)
    )
    coupling = Coupling.begin(fixed, column_of(area), made[1].x)
    assert coupling.phi[:5].sum() * 0.2 * D * area == pytest.approx(count * math.pi / 6 * D**3)


def test_every_slice_of_a_grain_drags_the_water_by_its_own_slip():
    made, area = cloud(Buoyancy.PRESSURE, n=6)
    fixed, first = made
    column = column_of(area, bed=BedKind.NO_SLIP, mixing=Mixing.LAMINAR)
    at_rest = Coupling.begin(fixed, column, first.x).state
    sheared = replace(at_rest, u=3.0 * (column.z - column.z_low))
    coupling = Coupling.begin(fixed, column, first.x, state=sheared)
    k_d, dt = 2.0e-5, 1e-3
    taken = np.zeros((6, 4))
    taken[:, 0], taken[:, 3] = k_d * coupling.sampled[:, 0] * dt, k_d  # drag on grains at rest
    arrays, sums = coupling._arrays, np.zeros((GIVEN_MET + 1, column.n))
    sum_given(arrays.p, sheared.u, taken, coupling.sampled, arrays.grains, arrays.cut, 1.0 / dt, sums)
    force = force_on_water(arrays.p, area, sheared.u, sums, arrays.force_z)
    volume = column.dz * area
    assert (force * volume).sum() == pytest.approx(taken[:, 0].sum() / dt, rel=1e-12)
    # of a sphere: every cell gives k_d U_k times the part of the sphere in it
    z, r = first.x[:, 2], 0.5 * D
    low = np.clip(column.faces[:-1, None] - z, -r, r)
    high = np.clip(column.faces[1:, None] - z, -r, r)
    part = (r * r * (high - low) - (high**3 - low**3) / 3.0) / (4.0 / 3.0 * r**3)
    assert force * volume == pytest.approx(k_d * sheared.u * part.sum(axis=1), rel=1e-9, abs=1e-18)
