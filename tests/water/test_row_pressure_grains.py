"""Grains in a row with a pressure of its own: settling, mobility, momentum, rest, seepage, uplift."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.water.test_row_grains import WALLS, D, G, advance_together, cloud, column_of, lattice

from ryusa.laws.families import BedKind, Fluctuations, Hindrance, Lift, Mixing, Pressure
from ryusa.model.fluid import A_X, DRAG, N_IMPULSE, W
from ryusa.model.row import ColumnRow
from ryusa.model.row_energy import RowTerm, row_imbalance
from ryusa.water import momentum_balance as m
from ryusa.water import row_grains
from ryusa.water.row_coupling import RowCoupling
from ryusa.water.row_grain_sums import amounts_given
from ryusa.water.row_grains import GrainsInRow
from ryusa.water.row_layout import RowWater
from ryusa.water.row_pressure import divide_among_faces, find_rises
from ryusa.water.row_pressure_told import accelerate_with_grains
from ryusa.water.row_projection import FINE, divergence

FULL = {"pressure": Pressure.FULL}


def settling(density, intervals, steps, pitch=1.3 * D, c_m=0.5):
    """A layer of grains that starts to sink in still water in a period.

    Returns the pressure at the bottom over the weight that it has to bear when nothing accelerates any more,
    the same by the mean acceleration of the grains, and the concentration in the layer.
    """
    length = 16 * pitch
    at = lattice(length, 14 * pitch, pitch, low=8.0 * pitch)
    made, first = cloud(
        at=at, length=length, tilt=0.0, density=density, hindrance=Hindrance.DI_FELICE, c_m=c_m
    )
    made = replace(made, world_low=(-math.inf,) * 3)
    c = column_of(length * D, 0.0, dz=pitch, n=40, depth=34 * pitch, mixing=Mixing.LAMINAR)
    row = ColumnRow(c, length / 2, np.zeros(2), G, **FULL)
    start = GrainsInRow.begin(made, row, at).at_rest(np.full(2, 34 * pitch))
    borne, speeds, times = [], [], []
    for _, now, _, v, _ in advance_together((made, first), row, start, intervals, longest=steps):
        borne.append(1000.0 * float(now.pressure[:, 0].mean()) * length * D / (made.m_weight.sum() * G))
        speeds.append(float(v[:, 2].mean()))
        times.append(now.t)
    return np.array(borne), 1.0 + np.gradient(speeds, times) / G, math.pi / 6.0 * (D / pitch) ** 2


@pytest.mark.parametrize(("density", "intervals"), [(2650.0, 40), (1540.0, 50), (1048.0, 100)])
def test_pressure_below_sinking_grains_bears_their_weight_in_water(density, intervals):
    """It is (sigma - rho) g phi H at steady speed, and less by what the mixture gains of momentum before."""
    borne, by_momentum, _ = settling(density, intervals, 100)
    assert borne[10:] == pytest.approx(by_momentum[10:], abs=0.01)
    assert borne[-1] == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("density", [2650.0, 1540.0, 1048.0])
def test_grains_that_start_to_sink_accelerate_the_water_that_rises(density):
    """Without drag: v' (sigma + rho/eps (c_m + phi + c_m phi/eps)) = - (sigma - rho) g, p' = rho v' ..."""
    borne, _, phi = settling(density, 40, 2)
    eps, c_m = 1.0 - phi, 0.5
    resists = density + 1000.0 / eps * (c_m + phi + c_m * phi / eps)
    closed = 1000.0 / eps * (1.0 + c_m / eps) / resists
    assert float(borne[20:].mean()) == pytest.approx(closed, rel=0.01)


def test_without_the_mobility_of_the_grains_their_pressure_grows(monkeypatch):
    """The tests above can fail: a projection of the water alone drives light dense grains to and fro."""
    assert np.abs(settling(1048.0, 40, 2, pitch=1.001 * D)[0]).max() < 1.3
    monkeypatch.setattr(GrainsInRow, "_yields", 0.0)
    assert np.abs(settling(1048.0, 150, 2, pitch=1.001 * D)[0][-10:]).min() > 10.0


def driven(c_m=2.0, pitch=1.05 * D, tilt=0.05, density=2650.0):
    """Accelerations told to grains at rest in a period whose water alone is driven, and the closed form.

    Without drag, (1 - phi) U' = (1 - phi) g_x - phi c_m (U' - v'), (sigma/rho + c_m) v' = c_m U'.
    """
    length = 16 * pitch
    at = lattice(length, 14 * pitch, pitch, low=8.0 * pitch)
    made, first = cloud(
        at=at, length=length, tilt=0.0, density=density, hindrance=Hindrance.DI_FELICE, c_m=c_m
    )
    made = replace(made, world_low=(-math.inf,) * 3)
    c = column_of(length * D, tilt, dz=pitch, n=40, depth=34 * pitch, mixing=Mixing.LAMINAR)
    row = ColumnRow(c, length / 2, np.zeros(2), G, **FULL)
    start = GrainsInRow.begin(made, row, at).at_rest(np.full(2, 34 * pitch))
    within = np.abs(at[:, 2] - 15 * pitch) < 2 * pitch
    told = [
        float(grains.sampled[within, A_X].mean())
        for grains, *_ in advance_together((made, first), row, start, 12, longest=2)
    ]
    phi, resists = math.pi / 6.0 * (D / pitch) ** 2, c_m * density / (density + 1000.0 * c_m)
    return np.array(told), (1.0 - phi) * G * math.sin(tilt) / (1.0 - phi + phi * resists)


def test_water_that_accelerates_along_x_takes_added_mass_along(monkeypatch):
    """Where c_m phi > 1 - phi too, as in grains packed in rows; told as found, the accelerations grow."""
    for told, closed in (driven(), driven(0.5, 1.3 * D)):
        assert told[5:] == pytest.approx(closed, rel=3e-3)
    monkeypatch.setattr(row_grains, "accelerate_with_grains", lambda *_: None)
    found, closed = driven()
    assert (np.diff(np.abs(found - closed)[2:]) > 0.0).all()


def stirred(intervals=60):
    """Pushes upwards on the added mass of grains in water that was stirred at first."""
    n, pitch = 24, 1.05 * D
    length = 48 * pitch
    at = lattice(length, 14 * pitch, pitch, low=8.0 * pitch)
    made, first = cloud(at=at, length=length, tilt=0.0, hindrance=Hindrance.DI_FELICE, c_m=2.0)
    made = replace(made, world_low=(-math.inf,) * 3)
    c = column_of(length * D, 0.0, dz=pitch, n=40, depth=34 * pitch, mixing=Mixing.LAMINAR)
    row = ColumnRow(c, length / n, np.zeros(n), G, **FULL)
    start = GrainsInRow.begin(made, row, at).at_rest(np.full(n, 34 * pitch))
    start = replace(start, u=1e-3 * np.random.default_rng(1).normal(size=start.u.shape))
    return np.array([
        one[0]._met.moves.copy() for one in advance_together((made, first), row, start, intervals, longest=2)
    ])  # fmt: skip


def test_what_grains_are_told_upwards_does_not_swing_from_one_interval_to_the_next(monkeypatch):
    moves = stirred()
    settled = np.abs(moves[-1]).max()
    assert np.abs(np.diff(moves[20:], axis=0)).max() < 0.01 * settled
    monkeypatch.setattr(row_grains, "accelerate_with_grains", as_found)
    assert np.abs(np.diff(stirred()[20:], axis=0)).max() > 0.1 * settled


def test_grains_that_stay_are_told_the_same_when_others_enter_or_leave():
    made, row, start, v, _ = shaken()
    *_, (grains, now, _, _, _) = advance_together(made, row, start, 6, v)
    other = grains.among(grains.x, now)
    assert np.abs(grains._met.moves).max() > 1.0
    assert np.array_equal(other._met.moves, grains._met.moves)
    assert np.array_equal(other.sampled, grains.sampled)


def as_found(shape, per_cell, c_m, rho_w, solid, sums, *others):
    """`accelerate_with_grains` with no added mass that goes along."""
    accelerate_with_grains(shape, per_cell, c_m, rho_w, solid, 0.0 * sums, *others)


def shaken(tilt=0.05):
    """Grains that fly in flowing water over fixed ones, in a period."""
    length, n = 40 * 4.0 * D, 10
    bed = np.column_stack([(np.arange(80) + 0.5) * 2.0 * D, np.zeros(80), np.full(80, 0.5 * D)])
    made = cloud(tilt=tilt, fixed=bed, lift=Lift.WIBERG_SMITH, hindrance=Hindrance.DI_FELICE, below=22.0)
    moving = {"bed": BedKind.MOVING, "mixing": Mixing.LI_SAWAMOTO, "d": D, "phi_max": 0.58, "n": 150}
    row = ColumnRow(
        column_of(length * D, tilt, **moving), length / n, np.zeros(n), G * math.cos(tilt), **FULL
    )
    rng = np.random.default_rng(4)
    at = made[1].x
    start = GrainsInRow.begin(made[0], row, at).at_rest(0.054 + 4e-3 * np.sin(2.0 * np.pi * row.x / length))
    start = replace(start, u=0.2 + 0.1 * rng.random(start.u.shape))
    v = np.zeros_like(at)
    v[:, 0], v[:, 2] = rng.normal(0.2, 0.1, len(at)), rng.normal(0.0, 0.05, len(at))
    return made, row, start, v, length * D


def test_grains_and_water_gain_what_weight_bed_and_their_shares_of_the_push_give():
    made, row, start, v, bed_area = shaken()
    fixed, area = made[0], bed_area / row.n_segment
    told = 0.0  # force of the pressure on the grains along x, told before the interval [N]
    for grains, now, (was, v_before), v_now, time in advance_together(made, row, start, 12, v):
        gained = float(fixed.m @ (v_now[:, 0] - v_before[:, 0])) / time
        water = 0.5 * (now.content + np.roll(now.content, 1, axis=0)) * now.u
        water = water - 0.5 * (was.content + np.roll(was.content, 1, axis=0)) * was.u
        gained += 1000.0 * area * float(water.sum()) / time
        b = now.budgets.sum(axis=0) * area
        weight = float(fixed.m.sum()) * fixed.gravity[0]
        given = weight + b[m.B_GRAVITY] + b[m.B_BED] + b[m.B_FIXED] + b[m.B_SURFACE] + b[m.B_DRIVER] + told
        assert gained == pytest.approx(given, abs=1e-12 * (weight + abs(b[m.B_GRAVITY])))
        assert grains.worst < 1e-11
        volume = (fixed.m - fixed.m_weight) / 1000.0 * grains.sampled[:, 8]
        told = float(volume @ grains._met.push)
    assert np.abs(now.pressure).max() > 1e-3 and abs(told) > 1e-9
    size = np.abs(now.energy).max()
    assert abs(row_imbalance(now.energy)) < 1e-12 * size
    assert min(abs(now.energy[RowTerm.GRAINS]), abs(now.energy[RowTerm.DISPLACED])) > 1e-6 * size


def test_the_pressure_pushes_water_and_grains_by_what_is_nothing_in_a_period_and_the_bed_below():
    """Along x the shares of water and grains cancel over a period; upwards they are what the bed bears."""
    made, row, start, v, bed_area = shaken(0.0)
    none = {"x_fixed": np.zeros((0, 3)), "d_fixed": np.zeros(0), "fixed_active": np.zeros(0, bool)}
    made = replace(made[0], **none), made[1]
    *_, (grains, now, _, _, _) = advance_together(made, row, start, 6, v)
    area, arrays = bed_area / row.n_segment, grains._arrays
    a, shape, dz = arrays.pressure, arrays.shape, row.column.dz
    water = RowWater(*(np.array(getattr(now, name)) for name in RowWater._fields))
    a.p[:] = now.pressure
    find_rises(arrays.p, shape, water.wet, a)
    divide_among_faces(arrays.p, shape, water, a)
    volume = (made[0].m - made[0].m_weight) / 1000.0 * grains.sampled[:, 8]
    shares = 0.5 * (water.content[shape.left] + water.content[shape.right])
    on_water = -1000.0 * area * float((shares * a.push).sum())
    assert float(volume @ grains._met.push) == pytest.approx(-on_water, rel=1e-10)
    assert abs(on_water) > 1e-9
    lift = grains.sampled[:, 7] - volume * grains._met.moves
    out = (1.0 - grains.sampled[:, 8]) * (made[0].m - made[0].m_weight)  # no buoyancy above the water
    lift = float((lift - out * made[0].gravity[2]).sum())
    slope = np.diff(now.pressure, axis=1)[:, 0] / dz
    lift_of_water = -1000.0 * area * float((a.part * a.slope).sum())
    on_bed = now.pressure[:, 0] - 0.5 * dz * slope * grains.told.phi[:, 0]
    assert lift + lift_of_water == pytest.approx(1000.0 * area * float(on_bed.sum()), rel=1e-10)


@pytest.mark.parametrize("tilt", [0.0, 0.1])
def test_grains_at_rest_under_still_water_do_not_stir_it(tilt):
    n, length = 12, 0.12
    at = lattice(length, 0.05, length / 54)
    at = at[at[:, 2] < 0.02 + 0.02 * np.cos(2.0 * np.pi * at[:, 0] / length)]
    made, _ = cloud(at=at, length=math.inf, tilt=math.atan(tilt))
    c = column_of(length * D, math.atan(tilt), dz=D, n=40, depth=0.03)
    row = ColumnRow(c, length / n, np.zeros(n), G * math.cos(math.atan(tilt)), *WALLS, **FULL)
    row = replace(row, bottom=0.002 * np.sin(2.0 * np.pi * row.x / 0.06))
    start = now = GrainsInRow.begin(made, row, at).at_rest(0.03 + tilt * row.x)
    grains = GrainsInRow.begin(made, row, at, start)
    impulse = np.tile([0.0, 0.0, 0.0, 1e-4], (len(at), 1))  # drag at rest
    for _ in range(100):
        now = grains.exchange(now, at, np.zeros_like(at), impulse, 1e-3)
    assert max(np.abs(now.u).max(), np.abs(now.w).max(), np.abs(grains.told.w).max()) < 1e-12
    assert np.abs(now.pressure).max() < 1e-12
    assert np.abs(now.surface - start.surface).max() < 1e-14


def moving(segments, length=0.1, **more):
    """A dense layer of light grains that sinks in a period, at the first exchange."""
    pitch = 1.02 * D
    across = round(length / pitch)
    at = lattice(across * pitch, 14 * pitch, pitch, low=8.0 * pitch)
    made, first = cloud(
        at=at, length=across * pitch, tilt=0.0, density=1048.0, hindrance=Hindrance.DI_FELICE, **more
    )
    made = replace(made, world_low=(-math.inf,) * 3)
    c = column_of(across * pitch * D, 0.0, dz=pitch, n=40, depth=34 * pitch, mixing=Mixing.LAMINAR)
    row = ColumnRow(c, across * pitch / segments, np.zeros(segments), G, **FULL)
    return (made, first), row, GrainsInRow.begin(made, row, at).at_rest(np.full(segments, 34 * pitch))


@pytest.mark.parametrize("wave", [0.0, 0.004])
def test_the_flux_of_water_and_grains_has_no_divergence_after_a_step(wave):
    """With what the grains will do to the change of pressure, over a level bottom and a wavy one."""
    made, row, start = moving(24)
    row = replace(row, bottom=wave * np.sin(2.0 * np.pi * (np.arange(24) + 0.5) / 24))
    start = GrainsInRow.begin(made[0], row, made[1].x).at_rest(np.full(24, 34 * 1.02 * D))
    *_, (grains, now, _, _, _) = advance_together(made, row, start, 3, longest=20)
    arrays = grains._arrays
    a, water = arrays.pressure, RowWater(*(np.array(getattr(now, name)) for name in RowWater._fields))
    left = divergence(arrays.p, arrays.shape, arrays.work.flux, water, a, np.zeros_like(a.p))
    assert np.abs(a.found).max() > 1e-9
    assert left < 2.0 * FINE * math.sqrt(G * row.column.dz)


def test_pressure_settles_where_the_water_takes_several_steps_in_an_interval():
    made, row, start = moving(32)
    borne = []
    for _, now, _, _, _ in advance_together(made, row, start, 12, longest=400):
        borne.append(1000.0 * now.pressure[:, 0] * row.column.area / (made[0].m_weight.sum() * G))
    assert now.steps > 3 * 12
    assert borne[-1] == pytest.approx(1.0, abs=0.05)


def test_a_grain_that_enters_the_water_is_not_thrown_back():
    """Its flux begins within a step, and the pressure of that step is not told for a whole interval."""
    at = np.array([[0.05, 0.0, 0.02], [0.03, 0.0, 0.01]])
    made, _ = cloud(at=at, length=0.1, tilt=0.0, hindrance=Hindrance.DI_FELICE)
    made = replace(made, world_low=(-math.inf,) * 3)
    c = column_of(0.1 * D, 0.0, dz=D, n=30, depth=0.04, mixing=Mixing.LAMINAR)
    row = ColumnRow(c, 0.01, np.zeros(10), G, start=np.full(10, 0.04), **FULL)
    made = replace(made, flow=row)
    water = replace(RowCoupling.begin(made, row, at), steps=100)
    entered = water.among(at, 7)
    assert (entered.steps, entered.due) == (100, 107)
    v = np.array([[0.3, 0.0, -0.2], [0.0, 0.0, 0.0]])
    told = entered.exchange(at, v, np.zeros((2, 4)))
    weight = made.m_weight * G
    assert np.abs(told[:, 6:8]).max() < 3.0 * weight[0]
    assert (still := replace(water, row=replace(row, pressure=Pressure.HYDROSTATIC)).among(at, 7)).due == 8
    assert still.steps == 1


def test_the_drift_by_turbulence_gives_the_water_nothing_upwards():
    """Its drag is balanced by the normal stress of the turbulence, which W leaves out; eddies bear grains."""
    made, row, start, v, _ = shaken()
    turbulent = replace(row, column=replace(row.column, fluctuations=Fluctuations.RANDOM_WALK, seed=3))
    *_, (grains, _, _, speeds, _) = advance_together(made, turbulent, start, 6, v)
    taken = np.zeros((len(v), N_IMPULSE))
    taken[:, DRAG] = 1e-3
    taken[:, 2] = 1e-3 * (grains.sampled[:, W] - speeds[:, 2]) * 1e-3  # over an interval of 1 ms
    assert np.abs(grains._met.drift).max() > 1e-3
    shape, cut = grains._arrays.shape, grains._cut
    with_grains = taken, grains.sampled, grains._met, grains._grains, cut, 1e3
    given = amounts_given(shape, *with_grains)[:, 1]
    volume = grains._grains.solid * grains._met.submerged / cut.whole
    without = 1e-3 * (grains.sampled[:, W] - grains._met.drift - speeds[:, 2])
    assert given == pytest.approx(without + volume * grains._met.moves, abs=1e-15)
    with_all = amounts_given(
        shape._replace(own=False), taken, grains.sampled, grains._met, grains._grains, cut, 1e3
    )
    assert with_all[:, 1] == pytest.approx(taken[:, 2] * 1e3, abs=1e-15)
