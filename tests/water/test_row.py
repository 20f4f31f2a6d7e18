"""A row of columns: the bits of one column, water at rest, mass, momentum, waves, seepage."""

from dataclasses import replace

import numpy as np
import pytest

from ryusa.errors import WaterError
from ryusa.laws.families import BedKind, Drive, Mixing, Pressure, SideWalls, SurfaceRule
from ryusa.model.column import Column, Top, WaterState
from ryusa.model.row import ColumnRow, EndKind, PorousSolid, RowEnd
from ryusa.water import advance, steady
from ryusa.water.row import (
    GrainAction,
    advance_row,
    discharges,
    row_at_rest,
)
from ryusa.water.row_station import relative_residual_at

G = 9.80665
WALLS = (RowEnd(EndKind.WALL), RowEnd(EndKind.WALL))


def of_water(depth: float, n: int, **more: object) -> Column:
    """Water without friction."""
    given = {"z_low": 0.0, "dz": depth / n, "n": n + 4, "depth": depth, "nu": 1e-15, **more}
    return Column(surface=SurfaceRule.VOLUME, **given)


@pytest.mark.parametrize("n", [1, 8])
@pytest.mark.parametrize(
    "more",
    [
        {},
        {"bed": BedKind.SMOOTH},
        {"bed": BedKind.NO_SLIP, "mixing": Mixing.VAN_DRIEST, "side": SideWalls.BLASIUS, "width": 0.05},
        {"bed": BedKind.NO_SLIP, "mixing": Mixing.LAMINAR, "nu": 1e-4},
    ],
)
def test_a_period_of_any_length_has_the_bits_of_one_column(river, more, n):
    c = replace(river, surface=SurfaceRule.VOLUME, n=44, depth=0.0203, **more)
    state = WaterState.at_rest(c, np.zeros(c.n))
    row = ColumnRow(c, 0.1, np.zeros(n), G)
    now = row_at_rest(row, np.full(n, c.depth))
    for _ in range(30):
        state, _ = advance(c, state, np.zeros(c.n), None, 1e-3)
        now = advance_row(row, now, 1e-3)
    for j in range(n):
        assert np.array_equal(now.u[j], state.u)
        assert np.array_equal(now.content[j], state.content)
        assert np.array_equal(now.edges[j], [state.tau, state.nu_t])
        assert now.surface[j] == state.z_surface
    assert state.u.max() > 0.01


@pytest.mark.parametrize("drive", [Drive.GRAVITY, Drive.TAU, Drive.DISCHARGE])
def test_a_period_has_the_bits_of_one_column_among_moving_grains(bedload, drive):
    """The surface crosses cells, grains push water up and down and take momentum."""
    c = replace(bedload, surface=SurfaceRule.VOLUME, drive=drive, tau=9.7, discharge=0.01)
    n = 1 if drive is not Drive.GRAVITY else 3
    phi = 0.6 / (1.0 + np.exp((c.z - 0.02) / 1e-3))
    state = WaterState.at_rest(c, phi)
    row = ColumnRow(c, 0.05, np.zeros(n), G)
    now = row_at_rest(row, np.full(n, c.z_surface), PorousSolid(np.tile(phi, (n, 1)), *np.zeros((2, n, c.n))))
    rng = np.random.default_rng(5)
    tops = set()
    for k in range(40):
        lift = 2e-3 * np.sin(0.4 * k)
        phi = 0.6 / (1.0 + np.exp((c.z - 0.02 - lift) / 1e-3))
        slope = 2000.0 * phi
        force = slope * (state.u - 0.3 * (c.z > 0.019)) * (1.0 + 0.1 * rng.standard_normal(c.n))
        phi_w = 1e-3 * phi
        state, _ = advance(c, state, phi, force, 1e-3, slope=slope, carried=0.5 * phi, phi_w=phi_w)
        every = [np.tile(one, (n, 1)) for one in (phi, force, slope, 0.5 * phi, phi_w)]
        now = advance_row(row, now, 1e-3, grains=GrainAction(*every))
        tops.add(int(np.count_nonzero(state.content)))
        for j in range(n):
            assert np.array_equal(now.u[j], state.u)
            assert np.array_equal(now.profiles[j, 1], state.w)
            assert np.array_equal(now.profiles[j, 4], state.du_dt)
            assert np.array_equal(now.profiles[j, 5], state.dtau_dz)
    assert len(tops) > 2


def bumpy(tilt: float) -> tuple[ColumnRow, PorousSolid]:
    """A porous bed with bumps over a wavy bottom, in a frame with a slope."""
    theta, n = np.arctan(tilt), 30
    c = Column(
        z_low=0.0, dz=0.004, n=30, depth=0.05, bed=BedKind.ROUGH, k_rough=0.002, mixing=Mixing.PARABOLIC,
        g_x=G * np.sin(theta), surface=SurfaceRule.VOLUME,
    )  # fmt: skip
    x = (np.arange(n) + 0.5) * 0.01
    top = 0.05 + 0.02 * np.cos(2.0 * np.pi * x / 0.17)
    phi = np.random.default_rng(3).uniform(0.48, 0.6, (n, c.n)) * (c.z < top[:, None])
    row = ColumnRow(c, 0.01, 0.004 * np.sin(2.0 * np.pi * x / 0.3), G * np.cos(theta), *WALLS)
    return row, PorousSolid.of_grains(phi, 0.003, c.nu)


@pytest.mark.parametrize("drag", [True, False])
@pytest.mark.parametrize("tilt", [0.0, 0.1])
def test_still_water_over_a_bumpy_porous_bed_stays_still(tilt, drag):
    row, solid = bumpy(tilt)
    if not drag:
        solid = replace(solid, linear=0.0 * solid.phi, quadratic=0.0 * solid.phi)
    start = row_at_rest(row, 0.045 + tilt * row.x, solid)
    now = advance_row(row, start, 0.5, longest=1e-3, solid=solid)
    assert now.steps >= 500
    assert np.abs(now.u).max() < 1e-12
    assert np.abs(now.surface - start.surface).max() < 1e-14


def test_water_whose_surface_is_not_level_moves():
    """The test above can fail: a surface that is not level drives water."""
    row, solid = bumpy(0.1)
    start = row_at_rest(row, 0.045 + 0.0999 * row.x, solid)
    assert np.abs(advance_row(row, start, 0.1, longest=1e-3, solid=solid).u).max() > 1e-6


def test_water_from_any_start_half_of_it_dry_keeps_its_mass_and_momentum_budget(river):
    rng, n = np.random.default_rng(1), 40
    c = replace(river, dz=0.005, n=60, depth=0.1, surface=SurfaceRule.VOLUME, g_x=0.0)
    bottom = 0.01 * np.sin(np.arange(n))
    solid = np.where(np.arange(n) == 20, 10, 0)
    row = ColumnRow(c, 0.02, 0.1 * bottom, G, *WALLS, solid=solid)
    now = row_at_rest(row, np.where(rng.random(n) < 0.5, 0.0, rng.uniform(0.0, 0.15, n)))
    volume = now.volume[row.inner].sum()
    for _ in range(5):
        now = advance_row(row, now, 0.2, longest=2e-3)
        assert now.volume[row.inner].sum() == pytest.approx(volume, rel=1e-14)
        assert (now.volume >= 0.0).all()
        assert max(relative_residual_at(one) for one in now.budgets) < 1e-11
    assert now.courant <= 0.5 + 1e-12


def test_momentum_without_friction_is_kept_in_a_period_with_a_bore():
    n = 60
    row = ColumnRow(of_water(0.1, 10, nu=1e-20), 0.02, np.zeros(n), G)
    start = row_at_rest(row, 0.1 + 0.02 * np.sin(2.0 * np.pi * row.x / 1.2))
    now = advance_row(row, replace(start, u=np.full_like(start.u, 0.3)), 2.0)
    assert np.ptp(now.surface) > 0.01
    before = 0.3 * start.volume.sum()
    assert discharges(row, now).sum() == pytest.approx(before, rel=1e-12)


def test_a_dam_breaks_over_a_dry_bed_as_ritter_says_and_finer_grids_are_nearer():
    errors = []
    for dx in (0.04, 0.02):
        row = ColumnRow(of_water(0.1, 1), dx, np.zeros(round(4.0 / dx)), G, *WALLS)
        now = advance_row(row, row_at_rest(row, 0.1 * (row.x < 2.0)), 0.6)
        c, s = np.sqrt(G * 0.1), (row.x - 2.0) / 0.6
        exact = np.clip(2.0 * c - s, 0.0, 3.0 * c) ** 2 / (9.0 * G)
        errors.append(float(np.abs(now.surface[row.inner] - exact).mean() / 0.1))
    assert errors[1] < 0.75 * errors[0]
    assert errors[1] < 0.0108  # twice that of the prototype


def test_seepage_through_a_porous_dam_is_that_of_dupuit():
    across, out = 20, 3
    c = of_water(0.12, 40, nu=1e-6, bed=BedKind.NO_SLIP)
    n = across + 2 * out
    phi = np.full((n, c.n), 0.6)
    phi[:out] = phi[-out:] = 0.0
    solid = PorousSolid.of_grains(phi, 1.5e-3, c.nu, inertia=False)
    ends = RowEnd(EndKind.LEVEL, level=0.12), RowEnd(EndKind.LEVEL, level=0.03)
    row = ColumnRow(c, 0.4 / across, np.zeros(n), G, *ends)
    now = row_at_rest(row, np.interp(row.x, [0.06, 0.46], [0.12, 0.03]), solid)
    now = advance_row(row, now, 8.0, longest=5e-3, solid=solid)
    conductivity = G * 0.4**3 * 1.5e-3**2 / (150.0 * 1e-6 * 0.6**2)
    exact = conductivity * (0.12**2 - 0.03**2) / 0.8
    assert discharges(row, now)[n // 2] == pytest.approx(exact, rel=0.064)


@pytest.mark.parametrize("pressure", list(Pressure))
def test_the_flow_on_a_reach_inclined_to_the_axis_is_that_along_it(river, pressure):
    """Normal depth and stress at 10 deg, in a frame that lies level."""
    alpha = np.radians(10.0)
    c = replace(river, surface=SurfaceRule.VOLUME, n=48, dz=5e-4, nu=1e-12)
    own = steady(replace(c, g_x=G * np.sin(alpha)))[0]
    q = float(own.content @ own.u)
    level = replace(c, g_x=0.0, dz=c.dz / np.cos(alpha), n=120)
    bottom = -np.tan(alpha) * (np.arange(20) + 0.5) * 0.05
    profile = np.append(own.u, np.full(72, own.u[-1]))
    inlet = RowEnd(EndKind.DISCHARGE, discharge=q, profile=profile, depth=0.02 / np.cos(alpha))
    row = ColumnRow(level, 0.05, bottom, G, inlet, RowEnd(EndKind.UNIFORM), pressure=pressure)
    now = row_at_rest(row, bottom + 0.022)
    now = advance_row(row, replace(now, u=np.full_like(now.u, 1.8)), 6.0)
    depth = now.surface[row.inner] * np.cos(alpha)
    assert depth[-5] == pytest.approx(0.02, rel=0.005)
    assert now.edges[-5, 0, 0] == pytest.approx(own.tau[0], rel=0.01)


def test_a_dry_bottom_above_the_water_beside_it_stays_dry():
    c = of_water(0.1, 20, bed=BedKind.NO_SLIP)
    bottom = np.where(np.arange(20) < 12, 0.0, 0.003 * (np.arange(20) - 11))
    row = ColumnRow(c, 0.02, bottom, G, *WALLS)
    start = row_at_rest(row, np.full(20, 0.008))
    now = advance_row(row, start, 1.0)
    assert np.array_equal(now.volume, start.volume)
    assert not now.u.any()


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"dx": 0.0}, "dx = 0 m"),
        ({"upstream": WALLS[0]}, "two ends"),
        ({"bottom": np.array([0.0, 0.05, 0.0])}, "inclined"),
        ({"solid": np.array([0, 99, 0])}, "solid: one number of 0 to"),
        ({"upstream": RowEnd(EndKind.LEVEL), "downstream": WALLS[1]}, "upstream: this end needs the height"),
        ({"upstream": WALLS[0], "downstream": RowEnd(EndKind.DISCHARGE, discharge=1.0)}, "upstream end"),
    ],
)
def test_a_row_that_cannot_be_solved_is_refused(river, more, says):
    c = replace(river, surface=SurfaceRule.VOLUME)
    given = {"column": c, "dx": 0.1, "bottom": np.zeros(3), "g_z": G, **more}
    with pytest.raises(ValueError, match=says):
        row_at_rest(ColumnRow(**given), np.full(3, 0.01))


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"surface": SurfaceRule.DEPTH}, "keep the volume"),
        ({"top": Top.LID}, "no lid"),
        ({"drive": Drive.DISCHARGE, "discharge": 0.1}, "driver discharge"),
    ],
)
def test_a_column_that_makes_no_row_is_refused(river, more, says):
    c = replace(river, **{"surface": SurfaceRule.VOLUME, **more})
    assert any(says in one for one in ColumnRow(c, 0.1, np.zeros(3), G).refuses())


def test_water_above_the_top_of_the_cells_stops_the_run_and_names_the_place(river):
    c = replace(river, surface=SurfaceRule.VOLUME)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=0.05)
    row = ColumnRow(c, 0.1, np.zeros(4), G, inlet, WALLS[1])
    with pytest.raises(WaterError, match="above the top of the column, at x = "):
        advance_row(row, row_at_rest(row, np.full(4, 0.015)), 5.0)
