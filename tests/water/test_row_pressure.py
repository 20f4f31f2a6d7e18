"""A row with a pressure of its own: waves, porous beds, closure, the projection. Gates: design/0030."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ryusa.laws.families import BedKind, Drive, Mixing, Pressure, SurfaceRule
from ryusa.model.column import Column
from ryusa.model.row import OPEN, ColumnRow, EndKind, PorousSolid, RowEnd, RowState
from ryusa.model.row_energy import row_imbalance
from ryusa.water.row import RowArrays, advance_row, row_at_rest
from ryusa.water.row_coupling import _residual
from ryusa.water.row_layout import RowMatrix, RowWater
from ryusa.water.row_pressure import divide_among_faces, find_tops
from ryusa.water.row_projection import FINE, couple, divergence, multiply, project
from ryusa_studies.validation import river_pressure as gates

G = 9.80665
WALLS = (RowEnd(EndKind.WALL), RowEnd(EndKind.WALL))


def of_water(dz: float, n: int, depth: float, **more: object) -> Column:
    given = {"z_low": 0.0, "dz": dz, "n": n, "depth": depth, "nu": 1e-15, "surface": SurfaceRule.VOLUME}
    return Column(**(given | more))


ROUGH = {"nu": 1e-6, "bed": BedKind.ROUGH, "k_rough": 0.002, "mixing": Mixing.PARABOLIC}


@pytest.mark.parametrize("kh", gates.LENGTHS)
def test_a_standing_wave_has_the_frequency_of_its_length(kh):
    ratio = float(gates.standing(kh, 10, gates.FULL)["ratio"])
    assert abs(ratio - 1.0) < gates.DECLARED["waves"].band("kh", f"{kh:g}").high


def test_a_hydrostatic_row_has_every_wave_as_fast_as_a_long_one():
    expected = math.sqrt(3.0 / math.tanh(3.0))
    assert float(gates.standing(3.0, 10, gates.HYDROSTATIC)["ratio"]) == pytest.approx(expected, rel=2e-3)


def porous(row_n: int, c: Column, top: np.ndarray) -> PorousSolid:
    phi = np.random.default_rng(3).uniform(0.48, 0.6, (row_n, c.n)) * (c.z < top[:, None])
    return PorousSolid.of_grains(phi, 0.003, 1e-6)


@pytest.mark.parametrize("tilt", [0.0, 0.1])
def test_still_water_over_a_porous_wavy_bed_with_a_dam_stays_still(tilt):
    n, angle = 30, math.atan(tilt)
    x = (np.arange(n) + 0.5) * 0.01
    c = of_water(0.004, 30, 0.05, g_x=G * math.sin(angle), **ROUGH)
    solid = porous(n, c, 0.05 + 0.02 * np.cos(2.0 * np.pi * x / 0.17))
    dam = np.where((np.arange(n) > 12) & (np.arange(n) < 16), 8, 0)
    row = ColumnRow(
        c, 0.01, 0.004 * np.sin(2.0 * np.pi * x / 0.3), G * math.cos(angle), *WALLS, solid=dam,
        pressure=Pressure.FULL,
    )  # fmt: skip
    start = row_at_rest(row, 0.075 + tilt * row.x, solid)
    now = advance_row(row, start, 0.5, longest=1e-3, solid=solid)
    assert max(np.abs(now.u).max(), np.abs(now.w).max()) < 2e-14
    assert np.abs(now.surface - start.surface).max() < 1e-15


def flows() -> list[tuple[str, ColumnRow, RowState, PorousSolid | None]]:
    """Waves over all that a row can have."""
    n = 60
    x = (np.arange(n) + 0.5) * 0.01
    c = of_water(0.004, 40, 0.08, **ROUGH)
    wavy, solid = 0.01 * np.sin(2.0 * np.pi * x / 0.3), porous(n, c, 0.03 + 0.01 * np.cos(20.0 * x))
    dam = np.where((np.arange(n) > 32) & (np.arange(n) < 36), 8, 0)
    inlet, drop = RowEnd(EndKind.DISCHARGE, discharge=0.02), RowEnd(EndKind.FREE_FALL)
    given = [
        ("flume", 0.0 * x, None, None, WALLS),
        ("wavy, porous, with a dam", wavy, solid, dam, WALLS),
        ("period", wavy, solid, None, (None, None)),
        ("odd period", 0.0 * x[1:], None, None, (None, None)),
        ("river", -0.05 * x, None, None, (inlet, drop)),
        ("pond", -0.05 * x, None, dam, (inlet, RowEnd(EndKind.LEVEL, level=0.06))),
        ("uniform outlet", -0.3 * x, None, None, (replace(inlet, depth=0.02), RowEnd(EndKind.UNIFORM))),
    ]
    found = []
    for name, bottom, stone, blocks, ends in given:
        row = ColumnRow(c, 0.01, bottom, G, *ends, solid=blocks, pressure=Pressure.FULL)
        falls = bottom if ends[0] is not None and ends[0].kind is EndKind.DISCHARGE else 0.0
        surface = 0.09 + 0.01 * np.cos(2.0 * np.pi * row.x / (n * 0.01)) + falls
        found.append((name, row, row_at_rest(row, surface, stone), stone))
    c = replace(c, n=60)
    row = ColumnRow(c, 0.01, 0.0 * x, G, *WALLS, pressure=Pressure.FULL)
    found.append(("over a dry bed", row, row_at_rest(row, np.where(row.x < 0.2, 0.1, 0.0)), None))
    return found


@pytest.mark.parametrize("flow", flows(), ids=lambda one: one[0])
def test_volume_momentum_and_energy_close(flow):
    _, row, start, solid = flow
    now, arrays, worst = start, RowArrays.of(row), 0.0
    for _ in range(5):
        now = advance_row(row, now, 0.1, solid=solid, arrays=arrays)
        worst = max(worst, _residual(now.budgets))
    gained = float((now.volume - start.volume)[row.inner].sum()) * row.dx
    entered = 0.0 if row.periodic else float(now.passed[0] - now.passed[-1])
    assert gained - entered == pytest.approx(0.0, abs=1e-13 * float(start.volume.sum()) * row.dx)
    assert worst < 1e-12
    assert abs(row_imbalance(now.energy)) < 1e-12 * np.abs(now.energy).max()
    assert np.abs(now.w).max() > 1e-3


def test_momentum_of_waves_in_a_period_is_that_at_the_start():
    c = of_water(0.1 / 12, 20, 0.1, nu=1e-20)
    row = ColumnRow(c, 0.02, np.zeros(60), G, pressure=Pressure.FULL)
    now = row_at_rest(row, 0.1 + 0.02 * np.sin(2.0 * np.pi * row.x / 1.2))
    now = replace(now, u=np.full_like(now.u, 0.3))
    left, right = row.stations_between

    def momentum(state: RowState) -> float:
        return float((0.5 * (state.content[left] + state.content[right]) * state.u).sum())

    later = advance_row(row, now, 1.0)
    assert momentum(later) == pytest.approx(momentum(now), rel=1e-13)


def test_a_run_cut_in_two_has_the_bits_of_one():
    _, row, start, solid = flows()[5]
    whole = advance_row(row, advance_row(row, start, 0.2, solid=solid), 0.2, solid=solid)
    again = advance_row(
        row, advance_row(row, start, 0.2, solid=solid), 0.2, solid=solid, arrays=RowArrays.of(row)
    )
    for name in ("u", "volume", "content", "w", "pressure", "energy", "budgets", "profiles"):
        assert np.array_equal(getattr(whole, name), getattr(again, name)), name
    assert np.abs(whole.pressure).max() > 1e-3


def disturbed(bottom: float, periodic: bool, rough: float) -> tuple[RowArrays, RowWater, RowMatrix]:
    """Arrays for a projection: random speeds, and depths that differ by up to `rough` [m]."""
    n, rng = 24, np.random.default_rng(1)
    x = (np.arange(n) + 0.5) * 0.02
    ends = (None, None) if periodic else (WALLS[0], RowEnd(EndKind.LEVEL, level=0.08))
    row = ColumnRow(
        of_water(0.01, 12, 0.08), 0.02, bottom * np.sin(2.0 * np.pi * x / 0.24), G, *ends,
        pressure=Pressure.FULL,
    )  # fmt: skip
    start = row_at_rest(row, 0.08 + row.bottom + rough * rng.uniform(-1.0, 1.0, n))
    arrays = RowArrays.of(row)
    water = RowWater(*(np.array(getattr(start, name)) for name in RowWater._fields))
    a, shape = arrays.pressure, arrays.shape
    assert a is not None
    water.u[:] = rng.uniform(-0.1, 0.1, water.u.shape) * (shape.kind == OPEN)[:, None]
    find_tops(shape, water.wet, a.top)
    divide_among_faces(arrays.p, shape, water, a)
    a.next_w[:] = rng.uniform(-0.1, 0.1, a.next_w.shape)
    a.pull[:] = np.where(a.gap > 0.0, 1e-3 / np.where(a.gap > 0.0, a.gap, 1.0), 0.0)
    return arrays, water, RowMatrix(*np.zeros((3, *water.wet.shape)))


@pytest.mark.parametrize("bottom", [0.0, 0.01])
@pytest.mark.parametrize("periodic", [False, True])
def test_the_system_is_symmetric(bottom, periodic):
    arrays, water, nothing = disturbed(bottom, periodic, 0.015)
    a, p, shape = arrays.pressure, arrays.p, arrays.shape
    assert a is not None
    couple(p, shape, 1e-3, nothing, np.zeros_like(water.u), water, a)
    full, rng = np.zeros(water.wet.shape, bool), np.random.default_rng(2)
    for i in range(*shape.inner):
        full[i, shape.first[i] : a.top[i]] = True
    one, two = (rng.normal(size=full.shape) * full for _ in range(2))
    y_one, y_two = np.zeros_like(one), np.zeros_like(two)
    assert multiply(p, shape, one, a, y_one) == pytest.approx((one * y_one).sum(), rel=1e-12)
    multiply(p, shape, two, a, y_two)
    assert (one * y_two).sum() == pytest.approx((two * y_one).sum(), rel=1e-12)
    assert (one * y_one).sum() > 0.0


@pytest.mark.parametrize("bottom", [0.0, 0.01])
@pytest.mark.parametrize("periodic", [False, True])
def test_the_projection_leaves_no_divergence(bottom, periodic):
    arrays, water, nothing = disturbed(bottom, periodic, 0.0)  # each cell with the same water as the next
    a, p, shape, flux = arrays.pressure, arrays.p, arrays.shape, arrays.work.flux
    assert a is not None
    before = divergence(p, shape, flux, water, a, a.right)
    assert before > 0.01
    assert 0 < project(p, shape, 1e-3, nothing, np.zeros_like(water.u), water, flux, a) <= 20
    assert divergence(p, shape, flux, water, a, a.right) <= 1.01 * FINE * math.sqrt(G * p.dz)


@pytest.mark.parametrize("kd", gates.IN_BED)
def test_pressure_within_a_porous_bed_under_a_wave_is_that_of_darcy(kd):
    run = gates.pore(kd)
    assert np.abs(run["p"] - run["exact"]).max() < gates.DECLARED["pore-waves"].band("kd", f"{kd:g}").high
    assert run["p"][0] < 0.9


def ramp(c: Column, tilt: float, fall: float, pressure: Pressure) -> RowState:
    """Water that starts from rest down a uniform slope of tilt + fall, of which `fall` is in the bottom."""
    n = 20
    angle = math.atan(tilt)
    c = replace(c, g_x=G * math.sin(angle))
    ends = RowEnd(EndKind.UNIFORM), RowEnd(EndKind.UNIFORM)
    x = (np.arange(n) + 0.5) * 0.01
    row = ColumnRow(c, 0.01, -fall * x, G * math.cos(angle), *ends, pressure=pressure)
    return advance_row(row, row_at_rest(row, 0.03 + row.bottom), 0.05)


def test_water_on_an_inclined_bottom_starts_as_on_an_inclined_axis():
    """Hydrostatic, the inertia across the axis is a factor of U; with the pressure it is that of W."""
    c = of_water(0.002, 24, 0.03)
    along = ramp(c, 0.3, 0.0, Pressure.FULL)
    inclined = ramp(c, 0.0, 0.3, Pressure.FULL)
    u, w = inclined.u[10, 2:14], inclined.w[10, 2:14]
    assert np.hypot(u, w) == pytest.approx(along.u[10, 2:14], rel=0.01)
    assert w == pytest.approx(-0.3 * u, rel=0.02)


def test_what_it_cannot_carry_is_refused_by_name():
    row = ColumnRow(of_water(0.01, 10, 0.05), 0.02, np.zeros(1), G, pressure=Pressure.FULL)
    driven = replace(row, column=replace(row.column, drive=Drive.DISCHARGE, discharge=0.01))
    assert any("pressure" in fault for fault in driven.refuses())
