"""Grains that pass an aerated sill of a row, and grains in the pool below it (design/0030)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.water.test_row_grains import D, advance_together, cloud
from tests.water.test_row_nappe import DX, DZ, SILL, at_rest, row_of

from ryusa.laws.families import Hindrance
from ryusa.model.fluid import SUBMERGED
from ryusa.model.row import EndKind, PorousSolid, RowDam, RowEnd
from ryusa.model.row_energy import row_imbalance
from ryusa.water import momentum_balance as m
from ryusa.water.row import GrainAction, RowArrays, advance_row, shape_of
from ryusa.water.row_grains import GrainsInRow
from ryusa.water.row_nappe import behind_of, closed, open_values
from ryusa.water.row_sums import GrainPlaces, place_grains
from ryusa.water.row_threads import RowThreads

CREST = 16 * DZ
FACE = (SILL + 1) * DX  # downstream face of the sill [m]


def flying(behind=0.04, down=None):
    """Grains on their way over an aerated sill, in its nappe and in the pool, and their row."""
    row = row_of({SILL: 16}, *(() if down is None else (down,)))
    row = replace(row, column=replace(row.column, area=row.dx * row.n_segment * D))
    x = np.arange(0.05, 0.5, 2.2 * D)
    at = np.column_stack([x, np.zeros(len(x)), np.where(x < FACE, CREST + 1.5 * D, 3.0 * D)])
    nappe = (x > FACE) & (x < FACE + 0.04)
    at[nappe, 2] = CREST - 4.0 * (x[nappe] - FACE) ** 2
    made = cloud(at=at, length=math.inf, tilt=0.0, hindrance=Hindrance.DI_FELICE)
    v = np.zeros_like(at)
    v[:, 0] = np.where(at[:, 0] < FACE + 0.04, 0.4, 0.1)
    v[nappe, 2] = -0.3
    start = at_rest(row, behind)
    u = np.array(start.u)
    u[: SILL + 2, 16:] = 0.4
    return made, row, replace(start, u=u), v


def test_what_grains_give_the_water_keeps_momentum_energy_and_volume():
    made, row, start, v = flying()
    given = 0.0
    for grains, now, _, _, _ in advance_together(made, row, start, 30, v):
        assert grains.worst < 1e-11
        given = max(given, float(np.abs(now.budgets[:, m.B_GRAINS]).max()))
    assert given > 1.0e-3 and float(now.passed[SILL + 1]) > 1.0e-4
    assert abs(row_imbalance(now.energy)) < 1e-12 * np.abs(now.energy).max()
    gained = float((now.volume - start.volume)[row.inner].sum()) * DX
    assert gained == pytest.approx(float(now.passed[0] - now.passed[-1]), abs=1e-15)
    assert now.u.shape == start.u.shape and grains.phi.shape == (row.n_segment, row.column.n)
    fly = (grains.x[:, 0] > FACE + DX) & (grains.x[:, 2] > 0.05)
    assert fly.any() and not grains.sampled[fly, SUBMERGED].any()


@pytest.mark.parametrize("x", [FACE - 3.0e-3, FACE + 1.0e-3])
def test_grains_that_pass_the_sill_are_what_both_segments_gain_and_lose(x):
    _, row, _, _ = flying()
    shape, by, held = shape_of(row), 2e-3, []
    for at in (x, x + by, x + 0.5 * by):
        places = GrainPlaces.of(1, row.n_segment)
        assert place_grains(np.array([at]), 0.0, 0.0, shape, places) == -1
        held.append(np.bincount(places.at[0], places.weight[0], minlength=len(shape.bottom)))
        last = places
    passed = np.zeros(len(shape.kind))  # at the middle of the way: exact for weights of the second degree
    passed[last.gate[0]] = by / row.dx * np.array([1.0 - last.past[0], last.past[0]])
    air = behind_of(row)
    flux = closed(passed, air)
    assert closed(held[1] - held[0], air)[1:-1] == pytest.approx(flux[:-1] - flux[1:], abs=1e-12)
    assert not held[0][air].any() and not held[1][air].any()
    # from the pool's side too, where the water has a wall, they pass the last station of the sill
    assert passed[int(air[0]) - 1] > 0.1 and not passed[air].any()


def test_a_run_taken_up_anew_and_one_on_threads_have_the_bits_of_one():
    made, row, start, v = flying()
    *_, (grains, now, _, _, _) = advance_together(made, row, start, 12, v)
    fixed = made[0]
    again = GrainsInRow.resume(fixed, row, now, grains.snapshot(), grains.sampled)
    shared = GrainsInRow.resume(fixed, row, now, grains.snapshot(), grains.sampled, RowThreads(2))
    shared.threads.number_for = lambda n: 2
    x, speeds = np.array(grains.x), np.array(v)
    taken = 1e-9 * np.random.default_rng(5).normal(size=(len(v), again.sampled.shape[1]))
    ends = [one.exchange(now, x + 1e-4, speeds, np.array(taken), 2e-4) for one in (grains, again, shared)]
    for other, end in zip((again, shared), ends[1:], strict=True):
        for name in ("u", "volume", "content", "w", "pressure", "energy", "budgets"):
            assert np.array_equal(getattr(ends[0], name), getattr(end, name)), name
        assert np.array_equal(grains.sampled, other.sampled)
        for name in ("w", "force_z", "u", "du_dt", "moves"):
            assert np.array_equal(getattr(grains.snapshot(), name), getattr(other.snapshot(), name)), name


def test_over_a_drowned_sill_grains_meet_the_water_that_one_without_air_has():
    made, row, start, v = flying(0.12, RowEnd(EndKind.LEVEL, level=0.12))
    plain = replace(row, dams=tuple(replace(dam, aerated=False) for dam in row.dams))
    met = []
    for one in (row, plain):
        *_, (grains, _, _, _, _) = advance_together(made, one, start, 20, v)
        met.append(grains.sampled)
    assert met[0] == pytest.approx(met[1], abs=1e-5 * float(np.abs(met[1]).max()))
    assert np.abs(met[0]).max() > 0.1


def test_a_seeping_dam_behind_an_aerated_one_keeps_grains_out_of_its_cells():
    row = row_of({SILL: 16})
    far = RowDam("slit", SILL + 10, SILL + 12, 0.03, True, False)
    shut = shape_of(replace(row, dams=(*row.dams, far))).shut
    air = behind_of(row)
    assert list(np.flatnonzero(closed(shut, air)) - 1) == [SILL, SILL + 10, SILL + 11]
    assert shut[int(air[0])] == 0


def test_a_porous_solid_behind_the_sill_counts_among_the_grains():
    made, row, start, _ = flying()
    phi = np.where(np.arange(row.column.n)[None, :] * DZ < 0.02, 0.5, 0.0) * np.ones((row.n_segment, 1))
    phi[: SILL + 1] = 0.0
    porous = replace(row, porous=PorousSolid.of_grains(phi, D, 1e-6))
    fixed, first = made
    lone = GrainsInRow.begin(fixed, row, first.x, start)
    among = GrainsInRow.begin(fixed, porous, first.x, start)
    assert among.phi - lone.phi == pytest.approx(phi, abs=1e-15)
    assert not among.told.phi[behind_of(row)].any()
    none = np.zeros((len(among.told.u), row.column.n))
    full = open_values(row, row.with_ends(phi))[1:-1]
    arrays = RowArrays.of(row)
    now = advance_row(row, start, 1e-3, grains=GrainAction(full, *[none] * 4), arrays=arrays)
    assert now.u.shape == start.u.shape
