"""Water that enters a row over a bed of grains, and what becomes of water that cannot enter."""

from dataclasses import replace

import numpy as np
import pytest

from ryusa.errors import WaterError
from ryusa.laws.families import BedKind, Drive, Mixing, Pressure, SurfaceRule
from ryusa.model import Column, ColumnRow
from ryusa.model.row import EndKind, PorousSolid, RowEnd
from ryusa.water import steady
from ryusa.water._kernel import parameters_of
from ryusa.water.closures import bed_thickness
from ryusa.water.row import advance_row, row_at_rest
from ryusa.water.row_coupling import with_inlet

G, CELL, D, PACKED = 9.80665, 4e-3, 8e-3, 0.6
DROP = RowEnd(EndKind.FREE_FALL)
SAME = RowEnd(EndKind.UNIFORM)


def column(slope: float, n: int = 24, **more: object) -> Column:
    """Water over a rough bottom along a slope."""
    given: dict[str, object] = {
        "z_low": 0.0, "dz": CELL, "n": n, "depth": 0.03, "bed": BedKind.ROUGH, "k_rough": D, "d": D,
        "phi_max": PACKED, "surface": SurfaceRule.VOLUME, "g_x": G * np.sin(np.arctan(slope)),
        "drive": Drive.GRAVITY, "mixing": Mixing.LI_SAWAMOTO, **more,
    }  # fmt: skip
    return Column(**given)  # pyright: ignore[reportArgumentType]


def bed(cells: int, segments: int, n: int = 24) -> PorousSolid:
    """A bed of grains at rest in the lowest cells."""
    phi = np.zeros((segments, n))
    phi[:, :cells] = PACKED
    return PorousSolid.of_grains(phi, D, 1e-6)


def test_the_bed_ends_where_the_mean_over_a_grain_falls_below_a_third_of_packed():
    p, phi = parameters_of(column(0.1)), np.zeros(24)
    assert bed_thickness(p, phi) == 0.0
    phi[20:] = PACKED  # grains that fall are no bed
    assert bed_thickness(p, phi) == 0.0
    phi[20:], phi[:8] = 0.0, PACKED
    # means over two cells: 0.45 in the uppermost full one and 0.15 above it
    assert bed_thickness(p, phi) == pytest.approx((7.5 + 0.25 / 0.3) * CELL)
    phi[:8] = 0.28 / 0.6 * PACKED  # laid loose
    assert bed_thickness(p, phi) == pytest.approx(8 * CELL, abs=0.5 * CELL)
    phi[0] = phi[4] = 0.0  # layers of a lattice
    assert bed_thickness(p, phi) == pytest.approx(8 * CELL, abs=0.5 * CELL)
    phi[:] = PACKED
    assert bed_thickness(p, phi) == 24 * CELL


def test_water_enters_over_a_bed_at_normal_depth_and_not_within_it():
    c, q, cells, n = column(0.25), 0.03, 8, 40
    matrix = bed(cells, n)
    start = np.full(n, cells * CELL + 0.015)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=q, developed=True)
    row = with_inlet(ColumnRow(c, 0.025, np.zeros(n), G, inlet, DROP, start=start))
    assert row.upstream is not None
    normal, over = row.upstream.depth, steady(replace(c, depth=row.upstream.depth))[0]
    assert float(over.content @ over.u) == pytest.approx(q, rel=1e-6)
    now = advance_row(row, row_at_rest(row, start, matrix), 3.0, solid=matrix)
    thick = bed_thickness(parameters_of(c), matrix.phi[0])
    assert thick == pytest.approx(cells * CELL, rel=0.05)
    assert now.surface[0] == pytest.approx(thick + normal)
    flux = now.content[0] * now.u[0]
    assert flux.sum() == pytest.approx(q, rel=1e-12)
    assert not flux[:cells].any()
    assert now.passed[0] == pytest.approx(3.0 * q, rel=1e-12)
    # farther on the flow slips over the pores and becomes shallower; in them Ergun's law gives far less
    depth = now.surface[row.inner] - cells * CELL
    assert depth[:5] == pytest.approx(normal, rel=0.1)
    assert (np.diff(depth[1:]) < 0.0).all()
    assert np.abs(now.u[1:30, : cells - 1]).max() < 0.2
    assert now.u[1:30, cells + 1].min() > 0.5


@pytest.mark.parametrize("pressure", list(Pressure))
@pytest.mark.parametrize("slope", [0.1, 0.001])  # swift water, and tranquil
@pytest.mark.parametrize("laid", [0, 2])  # cells of grains on it
def test_a_dam_at_the_inlet_is_a_floor(pressure: Pressure, slope: float, laid: int):
    """Water enters over it with the depth and the profile that it has over a bottom as high."""
    c, q, cells, n = column(slope), 0.02, 5, 12
    inlet, found = RowEnd(EndKind.DISCHARGE, discharge=q, developed=True), []
    for solid in (0, cells):
        start, phi = np.full(n, 0.04 + solid * CELL), np.zeros((n, c.n + solid))
        phi[:, solid : solid + laid] = PACKED
        grains = PorousSolid.of_grains(phi, D, 1e-6)
        row = ColumnRow(
            replace(c, n=c.n + solid), 0.025, np.zeros(n), G, inlet, SAME, start=start, pressure=pressure,
            solid=np.full(n, solid),
        )  # fmt: skip
        row = with_inlet(row)
        now = advance_row(row, row_at_rest(row, start, grains), 0.5, solid=grains)
        found.append((now.u[:-1, solid:], now.surface - solid * CELL, now.passed))
        assert not now.u[:, :solid].any()
    for floor, dam in zip(*found, strict=True):
        assert dam == pytest.approx(floor, rel=1e-9, abs=1e-12)


def test_without_a_bed_an_inlet_keeps_its_bits():
    """A layer of grains as dense as a debris flow at its upper end is none."""
    c, n = column(0.25), 6
    inlet = RowEnd(EndKind.DISCHARGE, discharge=0.03, profile=np.linspace(1.0, 2.0, 24), depth=0.02)
    row, thin = ColumnRow(c, 0.025, np.zeros(n), G, inlet, DROP), bed(8, n)
    thin = PorousSolid(0.3 * thin.phi, 0.0 * thin.phi, 0.0 * thin.phi)
    now = advance_row(row, row_at_rest(row, np.full(n, 0.02), thin), 0.1, solid=thin)
    content = (1.0 - thin.phi[0]) * np.clip(0.02 - np.arange(24) * CELL, 0.0, CELL)
    assert np.array_equal(now.content[0], content)
    total = 0.0
    for one in (content * np.linspace(1.0, 2.0, 24)).tolist():
        total += one
    assert np.array_equal(now.u[0], 0.03 / total * np.linspace(1.0, 2.0, 24))


@pytest.mark.parametrize("surface", [0.02, 0.06])
def test_tranquil_water_enters_over_a_bed_at_critical_depth_or_that_of_the_row(surface: float):
    c, q, n = column(0.0), 0.02, 20
    matrix, start = bed(8, n), np.full(n, surface)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=q, developed=True)
    row = with_inlet(ColumnRow(c, 0.025, np.zeros(n), G, inlet, DROP, start=start))
    now = advance_row(row, row_at_rest(row, start, matrix), 0.01, solid=matrix)
    thick, critical = bed_thickness(parameters_of(c), matrix.phi[0]), (q * q / G) ** (1.0 / 3.0)
    assert now.surface[0] >= thick + critical * (1.0 - 1e-12)
    if surface < thick:
        assert now.surface[0] == pytest.approx(thick + critical)
    now = advance_row(row, now, 2.0, solid=matrix)
    assert now.passed[0] == pytest.approx(2.01 * q, rel=1e-12)


def test_water_that_cannot_enter_a_dry_segment_stops_the_run():
    c, start = column(0.0), np.zeros(6)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=0.02, developed=True)
    row = with_inlet(ColumnRow(c, 0.025, np.zeros(6), G, inlet, DROP, start=start))
    with pytest.raises(WaterError, match=r"No water can enter at the upper end.* at x = 0 m"):
        advance_row(row, row_at_rest(row, start), 0.1)


def test_a_uniform_inlet_enters_at_normal_depth_where_it_is_faster_than_waves():
    start = np.full(6, 0.02)
    for slope, fast in ((0.1, True), (0.001, False)):
        ends = [
            with_inlet(
                ColumnRow(
                    column(slope), 0.025, np.zeros(6), G,
                    RowEnd(EndKind.DISCHARGE, discharge=0.02, developed=developed), DROP, start=start,
                )
            ).upstream
            for developed in (True, False)
        ]  # fmt: skip
        assert ends[0] is not None and ends[1] is not None
        assert ends[1].profile is None
        assert np.isnan(ends[1].depth) == (not fast)
        if fast:
            assert ends[0].depth == ends[1].depth
