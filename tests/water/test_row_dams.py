"""Grains beside a dam in a row of columns: none of them counts as within it, and still water stays still."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.water.test_row_grains import WALLS, D, cloud, column_of, lattice

from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import Hindrance
from ryusa.model.fluid import EXTRA_X
from ryusa.model.row import ColumnRow, EndKind, PorousSolid, RowDam, RowEnd
from ryusa.water import row_grains
from ryusa.water.row import shape_of
from ryusa.water.row_exchange import RowTold
from ryusa.water.row_grains import GrainsInRow
from ryusa.water.row_sums import GrainPlaces, gradients_at_grains, place_grains

G = 9.80665
N, LENGTH, CREST = 12, 0.12, 20  # segments, their length in all [m], cells of the dam


def dammed(tilt: float, porous: bool, grains: np.ndarray | None = None):
    """A dam of two segments over an inclined bottom, and grains on both of its sides up to its crest."""
    bottom = 0.008 - 0.08 * (np.arange(N) + 0.5) * LENGTH / N
    column = column_of(LENGTH * D, tilt, dz=D, n=40, depth=0.05)
    solid = np.zeros(N, np.int64)
    solid[5:7] = CREST
    crest = float(bottom[5:7].mean()) + CREST * D
    row = ColumnRow(
        column, LENGTH / N, bottom, G * math.cos(tilt), *WALLS, dams=(RowDam("dam", 5, 7, crest, porous),)
    )
    if porous:
        phi = np.where(np.arange(40) < solid[:, None], 0.6, 0.0)
        row = replace(row, porous=PorousSolid.of_grains(phi, D, 1e-6))
    else:
        row = replace(row, solid=solid)
    at = lattice(LENGTH, 0.03, 1.02 * D) if grains is None else grains
    away = (np.abs(at[:, 0] - 0.06) > 0.01 + 0.5 * D) & (at[:, 2] < 0.03)
    at = at[away]
    at[:, 2] += 0.008 - 0.08 * at[:, 0]
    return row, at


@pytest.mark.parametrize("porous", [False, True])
def test_all_of_a_grain_beside_a_dam_counts_in_the_segment_of_its_centre(porous):
    row, at = dammed(0.0, porous)
    made, _ = cloud(at=at, length=math.inf, tilt=0.0)
    grains = GrainsInRow.begin(made, row, at)
    free = grains.phi - (0.0 if row.porous is None else row.porous.phi)
    area = row.column.area / N * row.column.dz
    assert float(free.sum()) * area == pytest.approx(len(at) * math.pi / 6.0 * D**3, rel=1e-3)
    assert np.abs(free[5:7, : CREST - 1]).max() < 1e-15  # none within the dam
    assert free.max() < 0.7
    state = grains.at_rest(np.full(N, 0.06))
    grains = GrainsInRow.begin(made, row, at, state)
    assert grains.sampled[:, 8] == pytest.approx(1.0, abs=1e-12)  # all of it is under water


@pytest.mark.parametrize("porous", [False, True])
@pytest.mark.parametrize("tilt", [0.0, 0.1])
def test_still_water_over_grains_behind_a_dam_stays_still(tilt, porous):
    """The surface lies below the crest on both sides, at two heights where the dam is impermeable."""
    row, at = dammed(math.atan(tilt), porous)
    made, _ = cloud(at=at, length=math.inf, tilt=math.atan(tilt))
    surface = 0.036 + tilt * row.x
    if not porous:
        surface[7:] -= 0.012
    start = now = GrainsInRow.begin(made, row, at).at_rest(surface)
    grains = GrainsInRow.begin(made, row, at, start)
    impulse = np.tile([0.0, 0.0, 0.0, 1e-4], (len(at), 1))  # drag at rest
    for _ in range(100):
        push = grains.sampled[:, 6] + (made.m_weight - made.m) * made.gravity[0]
        weight = made.m * made.gravity[0] / 2.65
        assert push == pytest.approx(-weight * grains.sampled[:, 8], abs=1e-12 * made.m[0])
        now = grains.exchange(now, at, np.zeros_like(at), impulse, 1e-3)
    assert np.abs(now.u).max() < 1e-12
    assert np.abs(grains.told.w).max() < 1e-12
    assert np.abs(now.surface - start.surface).max() < 1e-14


def test_a_grain_beside_a_dam_does_not_feel_the_fall_of_the_surface_over_it():
    row, _ = dammed(0.0, False)
    x = np.array([[0.068, 0.0, 0.01], [0.075, 0.0, 0.01], [0.075, 0.0, 0.09]])
    made, _ = cloud(at=x, length=math.inf, tilt=0.0)
    grains = GrainsInRow.begin(made, row, x)
    slope = np.zeros(N + 1)
    slope[7] = 5000.0  # at the station behind the dam
    shape, told = shape_of(row), grains.told
    assert isinstance(told, RowTold)
    found = np.empty(3)
    gradients_at_grains(shape, grains._cut, grains._places, slope, 0.0, found)
    assert found[1] == 0.0  # below the crest
    assert found[2] == pytest.approx(5000.0 * 0.5 * 0.875)  # over the crest, by its weights
    places = GrainPlaces.of(3, N)
    assert place_grains(x[:, 0], row.x_low, 0.0, shape, places) == -1
    assert (places.shut[1] == [CREST, 0, 0]).all()


def test_what_grains_take_is_given_by_stations_ends_and_dam_together(monkeypatch):
    """In a row with an inlet, a dam and a drop: to round-off; each station closes by itself."""
    row, _ = dammed(0.05, False)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=0.02)
    flat = RowDam("dam", 5, 7, CREST * D, False)
    row = replace(
        row, bottom=np.zeros(N), upstream=inlet, downstream=RowEnd(EndKind.FREE_FALL), dams=(flat,),
        column=replace(row.column, g_x=G * math.sin(0.05)),
    )  # fmt: skip
    rng = np.random.default_rng(5)
    at = lattice(LENGTH, 0.045, 2.5 * D, low=D)
    at = at[(np.abs(at[:, 0] - 0.06) > 0.01 + 0.7 * D) | (at[:, 2] > CREST * D + D)]
    fixed, first = cloud(at=at, length=math.inf, tilt=0.05, hindrance=Hindrance.DI_FELICE)
    fixed = replace(fixed, world_low=(-math.inf,) * 3)
    v = np.column_stack([rng.normal(0.1, 0.1, len(at)), 0.0 * at[:, 0], rng.normal(0.0, 0.05, len(at))])
    start = GrainsInRow.begin(fixed, row, at).at_rest(np.full(N, 0.05))
    start = replace(start, u=0.2 + 0.0 * start.u)
    given: list[np.ndarray] = []
    act = row_grains.act_on_stations

    def acting(p, area, shape, *others):
        act(p, area, shape, *others)
        acts = others[-1]
        given.append(acts.force * area * p.dz)

    monkeypatch.setattr(row_grains, "act_on_stations", acting)
    engine = CpuEngine()
    engine.load(fixed, replace(first, v=v))
    state, grains = start, GrainsInRow.begin(fixed, row, at, start)
    weight = (fixed.m_weight - fixed.m) * fixed.gravity[0]
    for _ in range(6):
        told = grains.sampled.copy()
        engine.set_fluid(told)
        engine.advance(10).raise_if_any()
        x, v, impulse = engine.kinematics()
        time = 10 * fixed.dt
        beyond = 0.5 if grains.told.wet[-1].any() else 0.0  # at the start the drop has water, too
        state = grains.exchange(state, x, v, impulse, time)
        taken = float((impulse[:, 0] / time + told[:, EXTRA_X] + weight).sum())
        force = given[-1]
        whole = force.sum() - 0.5 * force[0].sum() - beyond * force[-1].sum()  # half a station lies beyond
        assert whole == pytest.approx(taken, abs=1e-12 * np.abs(force).sum())
        assert grains.worst < 1e-11
        held = 0.5 * force[0].sum() + force[[5, 7], :CREST].sum()  # by the inlet and the dam
        assert np.abs(held) > 1e-3 * np.abs(force).sum()
        assert np.abs(force[6, :CREST]).max() == 0.0
