"""Grains in a row of columns: weights, the bits of one column, momentum, water at rest, uplift, seepage."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.dispatch import hindered
from ryusa.laws.families import (
    BedKind,
    Buoyancy,
    Drag,
    Fluctuations,
    Hindrance,
    Lift,
    Mixing,
    Profile,
    Start,
    SurfaceRule,
)
from ryusa.model import Column, Water
from ryusa.model.row import ColumnRow, EndKind, RowEnd
from ryusa.model.row_energy import RowTerm, row_imbalance
from ryusa.model.scene import EventRule
from ryusa.water import momentum_balance as m
from ryusa.water._kernel import parameters_of
from ryusa.water.coupling import Coupling
from ryusa.water.exchange_arrays import WaterLaws
from ryusa.water.row import shape_of
from ryusa.water.row_exchange import RowTold, leave_dry_ends, meet_within_step, rates_at_stations
from ryusa.water.row_grains import GrainsInRow
from ryusa.water.row_sums import DRAG_U, N_ROW_SUM, GrainPlaces, place_grains
from ryusa.water.slice_sums import DRAG_NOW

D, G = 2.0e-3, 9.80665
WALLS = (RowEnd(EndKind.WALL), RowEnd(EndKind.WALL))


def column_of(area, tilt=0.05, **more):
    given = {"z_low": 0.0, "dz": 0.2 * D, "n": 130, "depth": 25.0 * D, "area": area, "bed": BedKind.ROUGH}
    given |= {"k_rough": 0.4 * D, "mixing": Mixing.PARABOLIC, "g_x": G * math.sin(tilt)}
    return Column(surface=SurfaceRule.VOLUME, **(given | more))


def cloud(n=40, tilt=0.05, at=None, fixed=None, density=2650.0, length=None, below=26.0, **more):
    """Grains far apart at rest, or those `at` [m]."""
    rng = np.random.default_rng(8)
    if at is None:
        at = np.zeros((n, 3))
        at[:, 0] = (np.arange(n) + 0.5) * 4.0 * D
        at[:, 2] = rng.uniform(4.0 * D, below * D, n)  # above 25 D they reach out of the water
        length = n * 4.0 * D
    water = Water(profile=Profile.COLUMN, drag=Drag.SCHILLER_NAUMANN, buoyancy=Buoyancy.STRESS, **more)
    made, state = scene(
        at, D, density=density, water=water, gravity=G, slope=tilt, period=(length, math.inf),
        plane_case=True, dt=2e-5, events=EventRule.NONE,
    )  # fmt: skip
    if fixed is not None:
        count = len(fixed)
        made = replace(made, x_fixed=fixed, d_fixed=np.full(count, D), fixed_active=np.ones(count, np.bool_))
    return made, state


def row_of(column, length, n, tilt=0.05, **more):
    return ColumnRow(column, length / n, np.zeros(n), G * math.cos(tilt), **more)


def test_weights_add_up_to_one_and_to_the_place_of_a_grain():
    x = np.random.default_rng(2).uniform(0.0, 0.3, 200)
    for ends in ({}, {"upstream": WALLS[0], "downstream": WALLS[1]}):
        row = row_of(column_of(1.0), 0.3, 10, **ends)
        places = GrainPlaces.of(len(x), 10)
        assert place_grains(x, 0.0, 0.0, shape_of(row), places) == -1
        assert places.weight.sum(axis=1) == pytest.approx(1.0, abs=1e-15)
        assert (places.weight >= 0.0).all()
        middle = (places.at - row.inner.start + 0.5) * row.dx
        inside = (x > 0.03) & (x < 0.27)
        assert (places.weight * middle).sum(axis=1)[inside] == pytest.approx(x[inside], abs=1e-15)
        bottom = 0.1 * row.x + 0.02
        place_grains(x, 0.0, 0.0, shape_of(replace(row, bottom=bottom)), places)
        part = inside if row.periodic else x > 0.0
        assert places.base[part] == pytest.approx(0.1 * x[part] + 0.02, abs=1e-15)
        assert places.tilt[part] == pytest.approx(0.1, abs=1e-12)


def test_what_passes_the_stations_is_what_segments_gain_and_lose():
    row = row_of(column_of(1.0), 0.3, 10)
    x, by = np.array([0.1012]), 2e-3
    held = []
    for at in (x, x + by, x + 0.5 * by):
        places = GrainPlaces.of(1, 10)
        place_grains(at, 0.0, 0.0, shape_of(row), places)
        held.append(np.bincount(places.at[0], places.weight[0], minlength=10))
        last = places
    passed = np.zeros(10)  # at the middle of the way: exact for weights of the second degree
    passed[last.gate[0]] = by / row.dx * np.array([1.0 - last.past[0], last.past[0]])
    assert held[1] - held[0] == pytest.approx(passed - np.roll(passed, -1), abs=1e-15)


@pytest.mark.parametrize("start", [Start.REST, Start.STEADY])
def test_a_period_of_one_segment_has_the_bits_of_one_column(start):
    length = 40 * 4.0 * D
    bed = np.column_stack([(np.arange(80) + 0.5) * 2.0 * D, np.zeros(80), np.full(80, 0.5 * D)])
    moving = {"bed": BedKind.MOVING, "mixing": Mixing.LI_SAWAMOTO, "d": D, "phi_max": 0.58}
    more = {"start": start, "seed": 3, "fluctuations": Fluctuations.RANDOM_WALK, **moving}
    column = column_of(length * D, z_low=-0.3 * D, z_bed=0.5 * D, depth=24.5 * D, n=140, **more)
    made = cloud(fixed=bed, lift=Lift.WIBERG_SMITH, hindrance=Hindrance.DI_FELICE, below=23.0)
    fixed, first = made
    row = replace(row_of(column, length, 1), bottom=np.full(1, column.z_low))
    grains = GrainsInRow.begin(fixed, row, first.x)
    state = grains.at_rest(np.full(1, column.z_surface))
    if start is Start.STEADY:
        state = grains.flowing(np.full(1, column.z_surface))
    grains = GrainsInRow.begin(fixed, row, first.x, state)
    coupling = Coupling.begin(fixed, replace(column, interval=20), first.x)
    engine = CpuEngine()
    engine.load(fixed, first)
    for _ in range(25):
        assert np.array_equal(grains.sampled, coupling.sampled)
        engine.set_fluid(coupling.sampled)
        time = coupling.steps * fixed.dt
        engine.advance(coupling.steps).raise_if_any()
        x, v, taken = engine.kinematics()
        coupling.exchange(x, v, taken)
        state = grains.exchange(state, x, v, taken, time)
        assert np.array_equal(state.u[0], coupling.state.u)
        assert np.array_equal(grains.told.w[0], coupling.state.w)
        assert np.array_equal(grains.phi[0], coupling.phi)
        assert state.surface[0] == coupling.state.z_surface
    assert grains.worst < 1e-11
    assert state.u.max() > (0.1 if start is Start.STEADY else 4e-3)


def test_grains_in_file_that_pass_leave_concentrations_even():
    """Shares by the nearest segment would vary by a tenth."""
    n, pitch = 10, 0.3 / 43
    row = row_of(column_of(1.0), 0.3, n)
    most = 0.0
    for shift in np.linspace(0.0, pitch, 7):
        places = GrainPlaces.of(43, n)
        place_grains(np.arange(43) * pitch + shift, 0.0, 0.0, shape_of(row), places)
        held = np.bincount(places.at.ravel(), places.weight.ravel(), minlength=n)
        most = max(most, float(np.abs(held / 4.3 - 1.0).max()))
    assert 0.0 < most < 1e-3


def advance_together(made, row, state, intervals, v=None, longest=20):
    """Step grains and the water of a row; yields grains, water and motion before and after every interval."""
    fixed, first = made
    if v is not None:
        first = replace(first, v=v)
    engine = CpuEngine()
    engine.load(fixed, first)
    grains = GrainsInRow.begin(fixed, row, first.x, state)
    for k in range(intervals):
        engine.set_fluid(grains.sampled)
        steps = longest if k else 1
        before = state, engine.kinematics()[1]
        engine.advance(steps).raise_if_any()
        x, v, taken = engine.kinematics()
        state = grains.exchange(state, x, v, taken, steps * fixed.dt)
        yield grains, state, before, v, steps * fixed.dt


def test_grains_and_water_together_gain_what_weight_and_bed_give_over_the_row():
    length, n = 40 * 4.0 * D, 10
    bed = np.column_stack([(np.arange(80) + 0.5) * 2.0 * D, np.zeros(80), np.full(80, 0.5 * D)])
    made = cloud(fixed=bed, lift=Lift.WIBERG_SMITH, hindrance=Hindrance.DI_FELICE)
    fixed, first = made
    moving = {"bed": BedKind.MOVING, "mixing": Mixing.LI_SAWAMOTO, "d": D, "phi_max": 0.58}
    row = row_of(column_of(length * D, **(moving | {"n": 150})), length, n)
    rng = np.random.default_rng(4)
    start = GrainsInRow.begin(fixed, row, first.x).at_rest(0.05 + 2e-3 * np.sin(2.0 * np.pi * row.x / length))
    start = replace(start, u=0.2 + 0.1 * rng.random(start.u.shape))
    at_first = np.zeros_like(first.x)
    at_first[:, 0], at_first[:, 2] = rng.normal(0.2, 0.1, len(bed) // 2), rng.normal(0.0, 0.05, len(bed) // 2)
    area = length * D / n
    for grains, now, (was, v), v_now, time in advance_together(made, row, start, 12, at_first):
        gained = float(fixed.m @ (v_now[:, 0] - v[:, 0])) / time
        water = 0.5 * (now.content + np.roll(now.content, 1, axis=0)) * now.u
        water = water - 0.5 * (was.content + np.roll(was.content, 1, axis=0)) * was.u
        gained += 1000.0 * area * float(water.sum()) / time
        b = now.budgets.sum(axis=0) * area
        weight = float(fixed.m.sum()) * fixed.gravity[0]
        given = weight + b[m.B_GRAVITY] + b[m.B_BED] + b[m.B_FIXED] + b[m.B_SURFACE]
        size = weight + abs(b[m.B_GRAVITY])
        assert gained == pytest.approx(given, abs=1e-12 * size)
        assert abs(b[m.B_DRIVER]) < 1e-12 * area * np.abs(now.budgets[:, m.B_DRIVER]).sum()
        assert abs(b[m.B_ADVECTED]) < 1e-12 * area * np.abs(now.budgets[:, m.B_ADVECTED]).sum()
        assert grains.worst < 1e-11
    assert np.ptp(now.surface) > 1e-4
    account, size = now.energy, np.abs(now.energy).max()  # of the water, grains included
    assert abs(row_imbalance(account)) < 1e-12 * size
    assert min(abs(account[RowTerm.GRAINS]), abs(account[RowTerm.DISPLACED])) > 1e-6 * size


def lattice(length, high, pitch, low=0.0):
    """Centres of grains on a lattice in a plane [m]."""
    a, b = np.arange(round(length / pitch)), np.arange(round(high / pitch))
    a, b = (one.ravel() for one in np.meshgrid(a, b))
    return np.column_stack([(a + 0.5) * pitch, 0.0 * a, low + (b + 0.5) * pitch])


@pytest.mark.parametrize("ends", [False, True])
@pytest.mark.parametrize("tilt", [0.0, 0.1])
def test_grains_at_rest_under_still_water_do_not_stir_it(tilt, ends):
    """A heap of free grains over bumps, partly out of the water, in a frame with a slope."""
    n, length = 12, 0.12
    at = lattice(length, 0.05, length / 54)
    at = at[at[:, 2] < 0.02 + 0.02 * np.cos(2.0 * np.pi * at[:, 0] / length)]
    made, _ = cloud(at=at, length=math.inf if ends or tilt else length, tilt=math.atan(tilt))
    c = column_of(length * D, math.atan(tilt), dz=D, n=40, depth=0.03)
    row = ColumnRow(c, length / n, np.zeros(n), G * math.cos(math.atan(tilt)))
    if ends or tilt:
        row = replace(row, upstream=WALLS[0], downstream=WALLS[1])
    if ends:
        row = replace(row, bottom=0.002 * np.sin(2.0 * np.pi * row.x / 0.06))
    surface = 0.03 + tilt * row.x
    start = now = GrainsInRow.begin(made, row, at).at_rest(surface)
    grains = GrainsInRow.begin(made, row, at, start)
    none = np.zeros_like(at)
    impulse = np.tile([0.0, 0.0, 0.0, 1e-4], (len(at), 1))  # drag at rest
    weight = made.m * made.gravity[0]
    for _ in range(100):
        push = grains.sampled[:, 6] + (made.m_weight - made.m) * made.gravity[0]
        assert push == pytest.approx(-1000.0 / 2650.0 * weight * grains.sampled[:, 8], abs=1e-12 * made.m[0])
        now = grains.exchange(now, at, none, impulse, 1e-3)
    assert np.abs(now.u).max() < 1e-12
    assert np.abs(grains.told.w).max() < 1e-12
    assert np.abs(now.surface - start.surface).max() < 1e-14
    assert 0.0 < grains.sampled[:, 8].min() < 1.0 or (grains.sampled[:, 8] == 0.0).any()


def test_water_stirs_where_buoyancy_is_another():
    """The test above can fail: without their share of the surface's slope, grains move the water."""
    at = lattice(0.12, 0.02, 1.1 * D)
    made, _ = cloud(at=at, length=math.inf, tilt=math.atan(0.1))
    row = row_of(column_of(0.12 * D, math.atan(0.1), dz=D, n=40, depth=0.03), 0.12, 12, math.atan(0.1))
    row = replace(row, upstream=WALLS[0], downstream=WALLS[1])
    now = GrainsInRow.begin(made, row, at).at_rest(0.03 + 0.1 * row.x)
    grains = GrainsInRow.begin(made, row, at, now)
    grains.sampled[:, 6] = (made.m - made.m_weight) * made.gravity[0]
    now = grains.exchange(now, at, np.zeros_like(at), np.tile([0.0, 0.0, 0.0, 1e-4], (len(at), 1)), 1e-3)
    assert np.abs(now.u).max() > 1e-6


def test_a_uniform_row_has_the_profile_of_one_column_over_the_same_grains():
    """Fixed grains, eight times the same bed: drag, buoyancy and mixing length are those of the column."""
    dx, n, c = 8.0 * D, 8, {"bed": BedKind.MOVING, "mixing": Mixing.LI_SAWAMOTO, "d": D, "phi_max": 0.58}
    bed = np.array([[x * dx / 7.0, 0.0, (0.5 + 0.1 * (x % 3) + z) * D] for x in range(7) for z in range(4)])
    every = np.concatenate([bed + np.array([j * dx, 0.0, 0.0]) for j in range(n)])
    far = {"at": np.array([[0.5 * dx, 0.0, 0.09]]), "hindrance": Hindrance.DI_FELICE}
    one, first = cloud(fixed=bed, length=dx, **far)
    all_of_it, _ = cloud(fixed=every, length=n * dx, **far)
    column = column_of(dx * D, dz=0.5 * D, n=50, **c)
    coupling = Coupling.begin(one, replace(column, interval=20), first.x)
    row = row_of(replace(column, area=n * dx * D), n * dx, n)
    now = GrainsInRow.begin(all_of_it, row, first.x).at_rest(np.full(n, column.z_surface))
    grains = GrainsInRow.begin(all_of_it, row, first.x, now)
    still, x = (np.zeros((1, 3)), np.zeros((1, 4))), first.x.copy()
    for _ in range(60):
        coupling.steps = 200
        time = coupling.steps * one.dt
        coupling.exchange(x, *still)
        now = grains.exchange(now, x, *still, time)
    u = coupling.state.u
    assert u.max() > 0.05
    assert np.abs(now.u - u).max() < 1e-9 * u.max()
    assert np.abs(grains.phi - coupling.phi).max() < 1e-12


def test_water_seeps_through_a_packing_as_by_ergun():
    """Gidaspow's drag of a packing is that of Ergun; water in a slope of 0.1 that grains fill to the top."""
    pitch, n = D, 6
    dx, theta = 5.0 * pitch, math.atan(0.1)
    high = 30 * pitch
    at = lattice(n * dx, high, pitch)
    made, first = cloud(
        at=np.array([[0.5 * dx, 0.0, 1.0]]), fixed=at, length=n * dx, tilt=theta, hindrance=Hindrance.GIDASPOW
    )
    c = column_of(n * dx * D, theta, dz=pitch, n=32, depth=high, bed=BedKind.MOVING, mixing=Mixing.LAMINAR)
    row = row_of(c, n * dx, n, theta)
    now = GrainsInRow.begin(made, row, first.x).at_rest(np.full(n, high))
    grains = GrainsInRow.begin(made, row, first.x, now)
    for _ in range(40):
        now = grains.exchange(now, first.x.copy(), np.zeros((1, 3)), np.zeros((1, 4)), 0.02)
    phi = math.pi / 6.0
    assert grains.phi[:, 3:27] == pytest.approx(phi, rel=1e-12)
    one = 150.0 * 1e-6 * phi**2 / ((1.0 - phi) * D**2)
    two = 1.75 * phi / D
    exact = (-one + math.sqrt(one**2 + 4.0 * two * (1.0 - phi) * c.g_x)) / (2.0 * two)
    assert now.u[:, 10:20] == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("over", [0.97, 1.03])
def test_water_that_rises_lifts_grains_at_the_critical_gradient(over):
    """Water enters below a layer of grains and rises: they lift at i = (sigma/rho - 1) (1 - p)."""
    pitch, dx = 1.25 * D, 10.0 * D
    at = lattice(dx, 12 * pitch, pitch, low=4.0 * pitch)
    made = cloud(at=at, length=math.inf, tilt=0.0, hindrance=Hindrance.DI_FELICE)
    fixed = made[0]
    made = (replace(fixed, world_low=(-math.inf,) * 3), made[1])
    phi = math.pi / 6.0 * D**3 / (pitch**2 * D)
    law = int(Drag.SCHILLER_NAUMANN), int(Hindrance.DI_FELICE), True, 0.0
    weight, low, high = float(fixed.m_weight[0]) * G, 0.0, 1.0
    for _ in range(60):
        w = 0.5 * (low + high)
        k = hindered(*law, w, phi, D, 1e-6, 1000.0, math.pi / 4.0, 0.0)
        low, high = (w, high) if k * w / (1.0 - phi) < weight else (low, w)
    c = column_of(dx * D, 0.0, dz=pitch, n=40, depth=30 * pitch)
    profile = np.full(40, 1e-12)
    profile[0] = 1.0
    q = over * w * (1.0 - phi) * dx
    row = ColumnRow(c, dx, np.zeros(1), G, RowEnd(EndKind.DISCHARGE, discharge=q, profile=profile), WALLS[1])
    start = GrainsInRow.begin(fixed, row, at).at_rest(np.full(1, 30 * pitch))
    *_, (grains, _, _, v, _) = advance_together(made, row, start, 8, longest=10)
    assert grains.told.w[1, 7:13] == pytest.approx(over * w, rel=1e-2)
    inner = at[:, 2] > 7 * pitch
    inner &= at[:, 2] < 13 * pitch
    assert (v[inner, 2] > 0.0).all() if over > 1.0 else (v[inner, 2] < 0.0).all()
    gradient = grains.told.force_z[1, 7:13] / (1.0 - phi) / (1000.0 * G)
    assert gradient == pytest.approx(1.65 * phi, rel=0.05 + 2.0 * abs(over - 1.0))


@pytest.mark.parametrize("form", [Buoyancy.WEIGHT, Buoyancy.PRESSURE])
def test_buoyancy_that_a_row_cannot_carry_is_refused_by_name(form):
    made, first = cloud()
    made = replace(made, water=replace(made.water, buoyancy=form))
    row = row_of(column_of(1.0), 40 * 4.0 * D, 10)
    with pytest.raises(ValueError, match=f"buoyancy = '{form.word}'.*take 'stress'"):
        GrainsInRow.begin(made, row, first.x)


def test_a_row_whose_length_is_not_the_period_of_the_grains_is_refused():
    made, first = cloud()
    with pytest.raises(ValueError, match="must agree"):
        GrainsInRow.begin(made, row_of(column_of(1.0), 0.3, 10), first.x)


def test_drag_within_less_than_a_step_leaves_the_motion_as_short_steps_have_it():
    """A viscous liquid and dense grains set off down a slope, at rates that long steps do not resolve.

    A hundred long steps: each is a hundredth of the time, and the scheme of first order.
    """
    length, found = 40 * D, {}
    at = lattice(length, 20.0 * D, 1.02 * D, low=D)
    for dt in (2e-5, 1e-6):
        fixed, first = cloud(at=at, length=length, nu=6e-4, hindrance=Hindrance.DI_FELICE)
        fixed = replace(fixed, dt=dt)
        row = row_of(column_of(length * D, nu=6e-4), length, 4)
        start = GrainsInRow.begin(fixed, row, first.x).at_rest(np.full(4, 0.05))
        stiff = 0.0
        for one in advance_together((fixed, first), row, start, round(2e-3 / dt), longest=1):
            grains, now, _, v, _ = one
            stiff = max(stiff, grains.fastest * dt)
            found[dt] = stiff, grains.fastest_grain * dt, v[:, 0].mean(), now.u[:, 10:90].mean()
    (stiff, by_grain, v, u), (_, _, v_short, u_short) = found.values()
    assert stiff > 1.5 and by_grain < 1.0
    assert v == pytest.approx(v_short, rel=0.05)
    assert u == pytest.approx(u_short, rel=0.15)  # 1 + e times its slip, which is a hundredth of that


def told_at(row, u_free):
    """What grains are told in a row, with one speed that they met."""
    stations, segments, n = (
        row.n_segment + (not row.periodic),
        row.n_segment + 2 * (not row.periodic),
        row.column.n,
    )
    return RowTold(
        np.zeros((stations, 6, n)), np.zeros((stations, n)), np.full((stations, n), u_free),
        np.zeros((segments, n)), np.zeros(stations), *np.zeros((4, segments, n)),
    )  # fmt: skip


def test_the_rate_of_drag_follows_a_slip_that_has_grown():
    row = row_of(column_of(1.0), 1.0, 2)
    p, shape, told = parameters_of(row.column), shape_of(row), told_at(row, 0.2)
    sums = np.zeros((N_ROW_SUM, *told.phi.shape))
    sums[DRAG_NOW], sums[DRAG_U] = 3.0, 3.0 * 0.1
    laws, s = WaterLaws.of(cloud()[0]), 60.0 * 1e-6 / D
    alike, slower, faster = (
        rates_at_stations(p, 0.5, laws, shape, sums, told, np.full(told.u.shape, u), s)
        for u in (0.2, 0.15, 0.5)
    )
    assert np.array_equal(slower, alike)  # a slip that has shrunk may come back
    assert faster == pytest.approx(alike * (0.4 + s) / (0.1 + s), rel=1e-12)
    told.u[:] = 0.5
    told.u_free[:] = 0.5
    meet_within_step(shape, 0.2 / alike.max(), alike, sums, told)
    assert (told.u_free == 0.5).all()  # a step resolves it
    meet_within_step(shape, 10.25 / alike.max(), alike, sums, told)
    assert told.u_free == pytest.approx((0.5 + 10.0 * 0.1) / 11.0, rel=1e-12)


def test_grains_beyond_an_end_act_on_no_water_where_there_is_none():
    ends = {"upstream": RowEnd(EndKind.WALL), "downstream": RowEnd(EndKind.FREE_FALL)}
    row = row_of(column_of(1.0), 1.0, 2, **ends)
    sums, wet = np.ones((2, 4, row.column.n)), np.ones((4, row.column.n))
    wet[3], wet[0, 60:] = 0.0, 0.0
    leave_dry_ends(shape_of(row), wet, sums)
    assert (sums[:, 3] == 0.0).all() and (sums[:, 0, 60:] == 0.0).all()
    assert (sums[:, 1:3] == 1.0).all() and (sums[:, 0, :60] == 1.0).all()
