"""The energy account of the water of a row: it closes to round-off, and losses are those of closed forms."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from ryusa.laws.families import BedKind, Drive, Mixing, SideWalls, SurfaceRule
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, PorousSolid, RowEnd, RowState
from ryusa.model.row_energy import ROW_LOSSES, RowTerm, row_imbalance
from ryusa.water import steady
from ryusa.water.row import GrainAction, advance_row, row_at_rest
from ryusa_studies.validation import river_energy

G, RHO = 9.80665, 1000.0
WALLS = (RowEnd(EndKind.WALL), RowEnd(EndKind.WALL))
DROP = RowEnd(EndKind.FREE_FALL)
SCHEME = [RowTerm.FALL, RowTerm.UPWIND, RowTerm.LATE, RowTerm.SURFACE]
FRICTION = [RowTerm.BED, RowTerm.SIDE, RowTerm.SHEAR, RowTerm.POROUS]
ROUGH = {"nu": 1e-6, "bed": BedKind.ROUGH, "k_rough": 0.002, "mixing": Mixing.PARABOLIC}


def of_water(depth: float, n: int, more: int = 4, **given: object) -> Column:
    """Water without friction, unless `given` says more."""
    about = {"z_low": 0.0, "dz": depth / n, "n": n + more, "depth": depth, "nu": 1e-15, **given}
    return Column(surface=SurfaceRule.VOLUME, **about)


def sums(state: RowState, terms: list[RowTerm]) -> float:
    return float(state.energy[terms].sum())


def flows() -> Iterator[tuple[str, ColumnRow, RowState, PorousSolid | None, float]]:
    """Water over all that a row can have, with the time to follow it."""
    row = ColumnRow(of_water(0.1, 10, **ROUGH), 0.02, np.zeros(60), G, *WALLS)
    yield "dam break", row, row_at_rest(row, np.where(row.x < 0.6, 0.1, 0.02)), None, 0.5
    yield "over a dry bed", row, row_at_rest(row, np.where(row.x < 0.6, 0.1, 0.0)), None, 0.5
    n, rng = 40, np.random.default_rng(1)
    solid = np.where(np.arange(n) == 20, 6, 0)
    row = ColumnRow(
        of_water(0.1, 12, 20, **ROUGH), 0.02, 0.004 * np.sin(np.arange(n)), G, *WALLS, solid=solid
    )
    start = row_at_rest(row, np.where(rng.random(n) < 0.5, -0.1, rng.uniform(0.0, 0.15, n)))
    yield "half dry, with a dam", row, start, None, 1.0
    c = of_water(0.1, 20, 30, side=SideWalls.BLASIUS, width=0.2, g_x=0.01 * G, **ROUGH)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=0.03)
    solid = np.where((np.arange(n) > 24) & (np.arange(n) < 28), 16, 0)
    row = ColumnRow(c, 0.02, np.zeros(n), G, inlet, DROP, solid=solid)
    yield "weir and drop", row, row_at_rest(row, np.where(np.arange(n) < 28, 0.16, 0.02)), None, 2.0
    phi = np.full((20, 24), 0.6)
    phi[:4] = phi[-4:] = 0.0
    porous = PorousSolid.of_grains(phi, 4e-3, 1e-6)
    ends = RowEnd(EndKind.LEVEL, level=0.12), RowEnd(EndKind.LEVEL, level=0.03)
    row = ColumnRow(of_water(0.12, 20, **ROUGH), 0.02, np.zeros(20), G, *ends)
    yield "porous dam", row, row_at_rest(row, np.linspace(0.12, 0.03, 20), porous), porous, 1.0
    bottom = 0.2 * np.maximum(0.4 - (np.arange(n) + 0.5) * 0.02, 0.0)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=0.03, depth=0.02)
    row = ColumnRow(of_water(0.05, 12, 12, **ROUGH), 0.02, bottom, G, inlet, RowEnd(EndKind.UNIFORM))
    yield "slope break", row, row_at_rest(row, bottom + 0.02), None, 2.0
    c = of_water(0.1, 10, side=SideWalls.BLASIUS, width=0.1, drive=Drive.GRADIENT, gradient=50.0, **ROUGH)
    row = ColumnRow(c, 0.02, np.zeros(20), G)
    yield "a period", row, row_at_rest(row, 0.09 + 0.01 * np.sin(5.0 * np.pi * row.x)), None, 1.0
    row = ColumnRow(replace(c, drive=Drive.DISCHARGE, discharge=0.02), 0.02, np.zeros(1), G)
    yield "a discharge in one segment", row, row_at_rest(row, np.full(1, 0.1)), None, 1.0


@pytest.mark.parametrize("flow", list(flows()), ids=lambda flow: flow[0])
def test_the_account_closes_to_round_off(flow):
    _, row, now, solid, time = flow
    for _ in range(4):
        now = advance_row(row, now, time / 4, solid=solid)
    largest = np.abs(now.energy).max()
    assert largest > 0.01
    assert abs(row_imbalance(now.energy)) < 1e-13 * max(largest, RHO * G * 0.005)
    assert sums(now, [RowTerm.BED, RowTerm.SHEAR]) > 0.0
    assert sums(now, [RowTerm.UPWIND]) >= 0.0 and sums(now, [RowTerm.LATE]) > 0.0


def test_the_account_closes_among_grains_that_are_given_as_forces(bedload):
    """Grains push water up and down, and take momentum; the surface crosses cells."""
    c, n = replace(bedload, surface=SurfaceRule.VOLUME), 6
    row = ColumnRow(c, 0.01, 0.05 * np.arange(n)[::-1] * 0.01, G, *WALLS)
    rng = np.random.default_rng(5)
    packed = 0.5 * (c.z < 0.015)
    solid = PorousSolid(np.tile(0.1 * packed, (n, 1)), np.full((n, c.n), 3.0), np.full((n, c.n), 10.0))
    now = row_at_rest(row, row.bottom + 0.03, solid)
    for _ in range(20):
        phi = packed * rng.uniform(0.8, 1.2, (n, c.n)) + solid.phi
        force, slope = rng.normal(3e3, 1e3, (n + 1, c.n)), rng.uniform(0.0, 5.0, (n + 1, c.n))
        none = np.zeros((n + 1, c.n))
        grains = GrainAction(phi, force, slope, none, none)
        now = advance_row(row, now, 1e-3, solid=solid, grains=grains)
    size = np.abs(now.energy).max()
    assert abs(row_imbalance(now.energy)) < 1e-12 * size
    for term in (RowTerm.GRAINS, RowTerm.DISPLACED, RowTerm.POROUS):
        assert abs(now.energy[term]) > 1e-3 * size, term.name


def test_a_wave_without_friction_loses_what_the_scheme_says_and_less_in_shorter_segments():
    lost = []
    for n in (50, 100):
        row = ColumnRow(of_water(0.1, 4), 2.0 / n, np.zeros(n), G, *WALLS)
        start = row_at_rest(row, 0.08 + 0.005 * np.cos(np.pi * row.x / 2.0))
        now = advance_row(row, start, 4.0)
        assert sums(now, FRICTION) == pytest.approx(0.0, abs=1e-12)
        held = sums(now, [RowTerm.KINETIC, RowTerm.POTENTIAL])
        assert held < 0.0
        assert sums(now, SCHEME) == pytest.approx(-held, rel=1e-9)
        lost.append(-held / (0.25 * RHO * G * 0.005**2 * 2.0))  # over the energy of the wave
    assert 0.0 < lost[1] < 0.55 * lost[0] < 0.01


def test_what_gravity_gives_to_uniform_flow_bed_walls_and_friction_take():
    c = of_water(0.05, 15, side=SideWalls.BLASIUS, width=0.1, g_x=0.02 * G, **ROUGH)
    row = ColumnRow(c, 0.05, np.zeros(8), G)
    flow = steady(c)[0]
    begin = replace(row_at_rest(row, np.full(8, 0.05)), u=np.tile(flow.u, (8, 1)))
    now = advance_row(row, begin, 1.0)
    given = RHO * c.g_x * float(flow.content @ flow.u) * 8 * 0.05 * 1.0
    assert now.energy[RowTerm.GRAVITY] == pytest.approx(given, rel=1e-9)
    assert sums(now, FRICTION) == pytest.approx(given, rel=1e-9)
    assert sums(now, SCHEME) == pytest.approx(0.0, abs=1e-9 * given)


def test_a_bore_loses_what_its_depths_say():
    found = river_energy.bore()
    assert found["lost"][-1] == pytest.approx(found["exact"][-1], rel=0.005)


def test_a_dam_break_over_a_dry_bed_loses_less_in_shorter_segments():
    """Without friction nothing is lost: what is given to the flow by its fall is its kinetic energy."""
    lost = []
    for dx in (0.01, 0.005):
        row = ColumnRow(of_water(0.1, 1), dx, np.zeros(round(2.0 / dx)), G, *WALLS)
        now = advance_row(row, row_at_rest(row, np.where(row.x < 1.0, 0.1, 0.0)), 0.3)
        lost.append(sums(now, list(ROW_LOSSES)) / now.energy[RowTerm.KINETIC])
    assert 0.0 < lost[1] < 0.7 * lost[0] < 0.05
