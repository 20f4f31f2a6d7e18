"""Slices in cells: exact volumes, sums that close both ways, and bits that depend on no order."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.water.cells import faces_of, to_cells

from ryusa.laws.slices import sphere_slice
from ryusa.water import exchange
from ryusa.water.exchange import Cells

D = 0.002
AREA = (20 * D) ** 2


@st.composite
def packings(draw):
    """Heights [m], diameters [m] in a ratio of up to 1:5, and cells that some grains reach out of."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n = draw(st.integers(1, 60))
    d = D * rng.uniform(1.0, 1.0 + 4.0 * draw(st.floats(0.0, 1.0)), n)
    dz = D * draw(st.floats(0.05, 3.0))
    z_low = D * draw(st.floats(-300.0, 300.0))
    n_cell = draw(st.integers(1, 40))
    z = z_low + rng.uniform(-0.2, 1.2, n) * n_cell * dz
    on_face = rng.random(n) < 0.2
    z[on_face] = z_low + np.round((z[on_face] - z_low) / dz) * dz
    touching = rng.random(n) < 0.2  # from above, the face below it
    z[touching] = z_low + np.round((z[touching] - z_low) / dz) * dz + 0.5 * d[touching]
    return z, d, Cells(z_low, dz, n_cell, AREA), rng


def dense(grains):
    """Slices as a table (n_grain, n_cell)."""
    table = np.zeros((grains.n_grain, grains.cells.n))
    for i, (first, count) in enumerate(zip(grains.first, grains.count, strict=True)):
        table[i, first : first + count] = grains.volume[i, :count]
    return table


@given(packings())
def test_slices_are_those_of_the_law_and_add_up_to_the_grain(packing):
    z, d, cells, _ = packing
    found = exchange.slices(z, d, cells)
    r, whole = 0.5 * d, math.pi / 6 * d**3
    expected = [
        [sphere_slice(r[i], *edges) for edges in pairwise(faces_of(cells) - z[i])] for i in range(len(z))
    ]
    np.testing.assert_allclose(dense(found) / whole[:, None], expected / whole[:, None], rtol=0, atol=1e-12)
    assert (dense(found) >= 0.0).all()
    np.testing.assert_allclose(found.whole, whole, rtol=1e-14)
    np.testing.assert_allclose(dense(found).sum(axis=1), found.submerged, rtol=1e-13, atol=1e-30)
    np.testing.assert_allclose((found.submerged + found.below + found.above) / whole, 1.0, rtol=1e-12)


@given(packings())
def test_concentration_holds_the_submerged_volume_of_all_grains(packing):
    z, d, cells, _ = packing
    found = exchange.slices(z, d, cells)
    phi = exchange.concentration(found)
    assert phi.shape == (cells.n,)
    assert phi.sum() * cells.volume == pytest.approx(found.submerged.sum(), rel=1e-13)
    twice = exchange.concentration(found, bed=found)
    np.testing.assert_array_equal(twice, 2.0 * phi)


@given(packings(), st.sampled_from(["whole", "submerged"]), st.sampled_from([(), (3,)]))
def test_the_momentum_given_by_grains_is_that_received_by_the_cells(packing, share, columns):
    z, d, cells, rng = packing
    found = exchange.slices(z, d, cells)
    amounts = rng.normal(size=(len(z), *columns))
    got = to_cells(found, amounts, share)
    size = np.abs(amounts).sum(axis=0)
    assert np.all(np.abs(got.cells.sum(axis=0) + got.below + got.above - amounts.sum(axis=0)) < 1e-12 * size)
    if share == "submerged":
        in_water = found.share > 1e-15
        assert np.all(np.abs(got.cells.sum(axis=0) - amounts[in_water].sum(axis=0)) <= 1e-12 * size)
    elif columns == ():
        part = amounts * found.submerged / found.whole
        assert got.cells.sum() == pytest.approx(part.sum(), abs=1e-12 * size)


@given(packings(), st.sampled_from(["whole", "submerged"]))
def test_gather_and_scatter_conserve_work(packing, share):
    z, d, cells, rng = packing
    found = exchange.slices(z, d, cells)
    force, speed = rng.normal(size=len(z)), rng.normal(size=cells.n)
    by_grains = force * exchange.to_grains(found, speed, share)
    by_cells = to_cells(found, force, share).cells * speed
    assert by_grains.sum() == pytest.approx(by_cells.sum(), abs=1e-12 * np.abs(force).sum())


@given(packings())
def test_the_stress_on_grains_is_that_removed_from_the_cells(packing):
    z, d, cells, rng = packing
    found = exchange.slices(z, d, cells)
    tau = rng.normal(size=cells.n + 1)
    felt = found.whole * exchange.to_grains(found, np.diff(tau) / cells.dz)
    given_up = exchange.concentration(found) * np.diff(tau) / cells.dz * cells.volume
    assert felt.sum() == pytest.approx(given_up.sum(), abs=1e-12 * np.abs(felt).sum() + 1e-30)


@given(packings())
def test_a_uniform_flow_is_sampled_exactly(packing):
    z, d, cells, _ = packing
    found = exchange.slices(z, d, cells)
    u = np.full((cells.n, 2), [0.7, -3.0])
    wet = found.share > 1e-15
    np.testing.assert_allclose(exchange.to_grains(found, u)[:, 0], 0.7 * found.share, rtol=1e-12)
    np.testing.assert_allclose(
        exchange.to_grains(found, u, "submerged")[wet], u[:1].repeat(wet.sum(), 0), rtol=1e-12
    )
    assert not exchange.to_grains(found, u, "submerged")[~wet].any()
    linear = 5.0 * (faces_of(cells) - cells.z_low)
    np.testing.assert_allclose(
        exchange.to_grains(found, np.diff(linear) / cells.dz), 5.0 * found.share, rtol=1e-10
    )


@given(packings(), st.integers(0, 2**32 - 1))
def test_bits_do_not_depend_on_where_grains_lie_in_memory(packing, seed):
    z, d, cells, rng = packing
    v, speed = rng.normal(size=(len(z), 2)), rng.normal(size=cells.n)
    ids = np.random.default_rng(seed).permutation(len(z))
    one, other = exchange.slices(z, d, cells), exchange.slices(z[ids], d[ids], cells, ids=ids)
    np.testing.assert_array_equal(exchange.concentration(other), exchange.concentration(one))
    np.testing.assert_array_equal(
        exchange.weighted_concentration(other, v[ids]), exchange.weighted_concentration(one, v)
    )
    first, second = to_cells(one, v), to_cells(other, v[ids])
    np.testing.assert_array_equal(second.cells, first.cells)
    np.testing.assert_array_equal(second.above, first.above)
    np.testing.assert_array_equal(second.below, first.below)
    np.testing.assert_array_equal(exchange.to_grains(other, speed), exchange.to_grains(one, speed)[ids])


def test_reused_memory_gives_the_same_bits():
    rng = np.random.default_rng(1)
    d, cells = D * rng.uniform(1.0, 2.0, 50), Cells(0.0, 0.3 * D, 40, AREA)
    old = exchange.slices(rng.uniform(-D, 14 * D, 50), d, cells)
    z = rng.uniform(-D, 14 * D, 50)
    fresh = exchange.slices(z, d, cells)
    phi = exchange.concentration(fresh)
    reused = exchange.slices(z, d, cells, reuse=old)
    assert reused.volume is old.volume
    np.testing.assert_array_equal(exchange.concentration(reused), phi)
    np.testing.assert_array_equal(reused.submerged, fresh.submerged)


def test_a_grain_half_out_of_the_water_agrees_with_hand_calculation():
    cells = Cells(z_low=0.0, dz=D, n=3, area=AREA)
    found = exchange.slices(np.array([3 * D, 1.5 * D, -D]), np.full(3, D), cells)
    np.testing.assert_allclose(found.share, [0.5, 1.0, 0.0])
    assert found.above[0] == pytest.approx(math.pi / 12 * D**3)
    assert found.below[2] == pytest.approx(math.pi / 6 * D**3)
    weight = np.array([2.0, 4.0, 8.0])
    got = to_cells(found, weight)
    np.testing.assert_allclose([*got.cells, got.below, got.above], [0.0, 4.0, 1.0, 8.0, 1.0], atol=1e-15)
    got = to_cells(found, weight, "submerged")
    np.testing.assert_allclose([*got.cells, got.below, got.above], [0.0, 4.0, 2.0, 8.0, 0.0], atol=1e-15)
    speed = np.array([1.0, 2.0, 3.0])
    np.testing.assert_allclose(exchange.to_grains(found, speed), [1.5, 2.0, 0.0])
    np.testing.assert_allclose(exchange.to_grains(found, speed, "submerged"), [3.0, 2.0, 0.0])


def test_the_flux_of_a_cell_is_concentration_times_speed():
    cells = Cells(z_low=0.0, dz=D, n=2, area=AREA)
    found = exchange.slices(np.array([D, 0.5 * D]), np.full(2, D), cells)
    half = math.pi / 12 * D**3 / (AREA * D)
    np.testing.assert_allclose(exchange.concentration(found), [3 * half, half])
    np.testing.assert_allclose(
        exchange.weighted_concentration(found, np.array([1.0, -2.0])), [-3 * half, half]
    )


@pytest.mark.parametrize("share", [0.4, 0.2, 0.1])
def test_a_linear_flow_is_sampled_at_the_centre_in_the_limit_of_thin_cells(share):
    cells = Cells(z_low=0.0, dz=share * D, n=int(12 / share), area=AREA)
    z = np.random.default_rng(0).uniform(2 * D, 10 * D, 300)
    found = exchange.slices(z, np.full(300, D), cells)
    off = exchange.to_grains(found, 3.0 * (faces_of(cells)[:-1] + 0.5 * cells.dz)) / 3.0 - z
    assert np.abs(off).max() < 0.06 * share**2 * D


def test_no_grains_are_accepted():
    none = exchange.slices(np.zeros(0), np.zeros(0), Cells(0.0, D, 4, AREA))
    assert not exchange.concentration(none).any()
    assert to_cells(none, np.zeros((0, 2))).cells.shape == (4, 2)
    assert exchange.to_grains(none, np.ones(4)).shape == (0,)


def test_invalid_input_is_refused():
    cells = Cells(0.0, D, 4, AREA)
    one = exchange.slices(np.zeros(1), np.full(1, D), cells)
    with pytest.raises(ValueError, match="dz and area positive"):
        Cells(0.0, -D, 4, AREA)
    with pytest.raises(ValueError, match="at least one cell"):
        Cells(0.0, D, 0, AREA)
    with pytest.raises(ValueError, match="row 1: z = nan"):
        exchange.slices(np.array([0.0, np.nan]), np.full(2, D), cells)
    with pytest.raises(ValueError, match="row 0"):
        exchange.slices(np.zeros(1), np.zeros(1), cells)
    with pytest.raises(ValueError, match="permutation"):
        exchange.slices(np.zeros(2), np.full(2, D), cells, ids=np.array([1, 1]))
    with pytest.raises(ValueError, match="one row per grain"):
        exchange.weighted_concentration(one, np.zeros(2))
    with pytest.raises(ValueError, match="one row per cell"):
        exchange.to_grains(one, np.zeros(5))
    with pytest.raises(ValueError, match="the same cells"):
        exchange.concentration(one, bed=exchange.slices(np.zeros(1), np.full(1, D), Cells(0.0, D, 5, AREA)))
