"""Profiles over height: sums that must close, a rigid body, a random gas, and one grain by hand."""

import importlib
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.campaigns.sweep.measures import AtHeight, at_height
from ryusa.catalogue import MEASURES
from ryusa.errors import ResultsError
from ryusa.measure import profiles
from ryusa.measure.statistics import standard_error, standard_errors
from ryusa.model import EVENT

D = 0.002
LENGTH, WIDTH = 20 * D, D


@pytest.fixture
def flow(make):
    """Random grains of several sizes that move at random, in a plane scene or in three dimensions."""

    def build(n=50, n_frame=40, plane=True, lanes=1, seed=0, speed=None, depth=10 * D):
        rng = np.random.default_rng(seed)
        scene = make.scene(n)
        scene = replace(
            scene, d=D * rng.uniform(0.8, 1.2, n), slab_width=WIDTH, plane_case=plane,
            period=(LENGTH, math.inf if plane else 5 * D),
            x_fixed=scene.x_fixed[:20], d_fixed=scene.d_fixed[:20], fixed_active=scene.fixed_active[:20],
        )  # fmt: skip
        scene = replace(scene, m=2650.0 * np.pi / 6 * scene.d**3)
        x = rng.uniform(0.0, 1.0, (n_frame, n, 3)) * [LENGTH, 0.0 if plane else 5 * D, depth] + [0, 0, 2 * D]
        x[:, :, 1] += (np.arange(n) % lanes) * 4 * D
        v = rng.normal(0.3, 0.1, x.shape) if speed is None else np.broadcast_to(speed, x.shape)
        return SimpleNamespace(
            case={"record": {}},
            frames=SimpleNamespace(t=np.arange(n_frame) * 0.01, x=x, v=v, omega=0.0 * x + [0.0, 7.0, 0.0]),
            contacts=np.zeros(0, EVENT),
            scene=scene,
            tally={},
        )

    return build


def test_a_quantity_at_one_height_lies_on_the_line_between_two_layers(flow):
    run = flow(plane=False)
    found = profiles(run)
    entry = next(one for one in MEASURES if one.name == "profile")
    assert entry.layers == tuple(one.name for one in found.columns)
    a, b = found.z[6:8]
    for name in ("phi", "v_x", "flux"):
        (column,) = (one for one in found.columns if one.name == name)
        one = at_height(found, AtHeight("profile", name, a + 0.25 * (b - a)))
        assert one.value == pytest.approx(0.75 * column.value[6] + 0.25 * column.value[7], rel=1e-12)
        assert one.error == pytest.approx(0.75 * column.error[6] + 0.25 * column.error[7], rel=1e-12)
        assert (one.unit, one.n) == (column.unit, 40)
    for z in (found.z[0] - 1e-6, found.z[-1] + 1e-6):
        assert at_height(found, AtHeight("profile", "phi", z)).n == 0


@pytest.mark.parametrize("plane", [True, False])
@pytest.mark.parametrize("layer", [0.25, 0.7])
def test_layers_add_up_to_all_grains_and_their_flux(flow, plane, layer):
    run = flow(plane=plane)
    found = profiles(run, layer=layer)
    ball = np.pi / 6 * run.scene.d**3
    area = LENGTH * (WIDTH if plane else 5 * D)
    assert found.phi.value.sum() * found.thickness == pytest.approx(ball.sum() / area, rel=1e-13)
    carried = (ball * run.frames.v[:, :, 0]).sum(axis=1) / area
    assert found.q == pytest.approx(carried, rel=1e-12)
    assert found.flux.value.sum() * found.thickness == pytest.approx(carried.mean(), rel=1e-12)
    assert found.density == pytest.approx(2650.0)
    if plane:
        disc = (np.pi / 4 * run.scene.d**2).sum() / LENGTH
        assert found.area_fraction.value.sum() * found.thickness == pytest.approx(disc, rel=1e-12)
    else:
        assert np.isnan(found.area_fraction.value).all()


def test_a_rigid_body_has_one_speed_and_no_temperature(flow):
    found = profiles(flow(speed=(0.37, 0.0, -0.11)))
    there = found.phi.value > 0
    np.testing.assert_allclose(found.v_x.value[there], 0.37, rtol=1e-13)
    np.testing.assert_allclose(found.v_z.value[there], -0.11, rtol=1e-13)
    np.testing.assert_allclose(found.spin.value[there], 7.0, rtol=1e-13)
    np.testing.assert_allclose(found.temperature_x.value[there], 0.0, atol=1e-14)
    np.testing.assert_allclose(found.speed, 0.37, rtol=1e-13)
    assert np.nanmax(found.v_x.error) < 1e-14


def test_a_random_gas_has_its_mean_concentration_and_temperature_within_the_error(flow):
    run = flow(n=200, n_frame=400, depth=20 * D)
    found = profiles(run, layer=0.5)
    inside = (found.z > 4 * D) & (found.z < 20 * D)
    expected = (np.pi / 6 * run.scene.d**3).sum() / (LENGTH * WIDTH * 20 * D)
    off = (found.phi.value[inside] - expected) / found.phi.error[inside]
    assert np.sqrt(np.mean(off**2)) < 1.6
    off = (found.temperature_x.value[inside] - 0.01) / found.temperature_x.error[inside]
    assert np.sqrt(np.mean(off**2)) < 1.6
    off = (found.v_x.value[inside] - 0.3) / found.v_x.error[inside]
    assert np.sqrt(np.mean(off**2)) < 1.6


def test_one_grain_cut_in_half_agrees_with_hand_calculation(flow):
    run = flow(n=1, n_frame=1)
    scene = replace(run.scene, d=np.array([D]))
    run.scene, run.frames.x = scene, np.array([[[0.0, 0.0, 3 * D]]])
    found = profiles(run, layer=0.5)
    half = np.pi / 12 * D**3 / (LENGTH * WIDTH * 0.5 * D)
    assert found.phi.value[found.phi.value > 0] == pytest.approx([half, half], rel=1e-13)
    assert found.z[found.phi.value > 0] == pytest.approx([2.75 * D, 3.25 * D])
    assert np.isnan(found.phi.error).all()


def test_lanes_are_averaged(flow):
    one, two = profiles(flow(lanes=1), layer=0.5), profiles(flow(lanes=2), layer=0.5)
    assert (one.lanes, two.lanes) == (1, 2)
    np.testing.assert_allclose(two.phi.value, 0.5 * one.phi.value, rtol=1e-13)
    np.testing.assert_allclose(two.v_x.value, one.v_x.value, rtol=1e-13)


def test_heights_are_counted_from_the_datum_or_from_a_crest_that_is_named(flow):
    run = flow()
    low = run.scene.x_fixed - [0.0, 0.0, 0.5 * D]
    low[0, 2] += 0.5 * D  # one grain stands out
    run.scene = replace(run.scene, x_fixed=low)
    datum, crest, mean = (profiles(run, layer=0.1, above=one) for one in ("datum", "bed crest", "mean crest"))
    assert (datum.origin, crest.origin) == pytest.approx((0.0, D))
    assert mean.origin == pytest.approx((0.5 + 0.5 / len(low)) * D)
    for found in (crest, mean):
        assert found.top(0.5) + found.origin == pytest.approx(datum.top(0.5), abs=0.02 * D)


def test_the_bed_is_counted_only_on_request_and_apart(flow):
    run = flow()
    without, found = profiles(run), profiles(run, bed=True)
    assert np.isnan(without.bed).all()
    ball = np.pi / 6 * run.scene.d_fixed**3
    assert found.bed.sum() * found.thickness == pytest.approx(ball.sum() / (LENGTH * WIDTH), rel=1e-13)
    assert found.phi.value.sum() == pytest.approx(without.phi.value.sum(), rel=1e-13)


def test_a_section_of_bed_counts_the_grains_over_it(flow):
    run = flow(n_frame=200)
    run.frames.x[:, :, 0] += 3 * LENGTH  # unwrapped
    parts = [profiles(run, between=(a, a + LENGTH / 4)) for a in np.arange(4) * LENGTH / 4]
    whole = profiles(run)
    assert np.mean([one.q for one in parts], axis=0) == pytest.approx(whole.q, rel=1e-12)


def test_results_do_not_depend_on_the_chunks_in_which_frames_are_read(flow, monkeypatch):
    whole = profiles(flow())
    monkeypatch.setattr(importlib.import_module("ryusa.measure.slices_in_layers"), "CHUNK", 350)
    found = profiles(flow())
    np.testing.assert_array_equal(found.phi.value, whole.phi.value)
    np.testing.assert_array_equal(found.q, whole.q)


def test_what_cannot_be_measured_is_said(flow):
    run = flow()
    with pytest.raises(ResultsError, match="no frame"):
        profiles(run, begin=99.0)
    run.scene = replace(run.scene, period=(math.inf, math.inf))
    with pytest.raises(ResultsError, match="open along x"):
        profiles(run)
    run.scene = replace(run.scene, period=(LENGTH, math.inf), plane_case=False)
    with pytest.raises(ResultsError, match="open along y"):
        profiles(run)


def test_the_table_names_units_and_the_top_holds_nearly_everything(flow):
    found = profiles(flow())
    assert {"z_m", "phi", "v_x_m_per_s", "temperature_x_m2_per_s2", "phi_error"} <= set(found.rows()[0])
    assert found.z[0] < found.top(0.5) < found.top() < found.z[-1] + found.thickness
    assert len(found.series()) == 40


def test_errors_of_many_columns_are_those_of_each(flow):
    rng = np.random.default_rng(3)
    for n in (1, 2, 5, 64, 333):
        columns = np.cumsum(rng.normal(size=(n, 7)), axis=0) * 0.1 + rng.normal(size=(n, 7)) * np.arange(7)
        columns[:, 6] = 4.0
        expected = [standard_error([column]).error for column in columns.T]
        np.testing.assert_allclose(standard_errors(columns), expected, rtol=1e-10, atol=1e-15)
