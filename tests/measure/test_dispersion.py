"""Dispersion of random walks, flights and shear, whose mean squared displacement is known."""

import importlib
import math
from dataclasses import replace

import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.measure import dispersion
from ryusa.model import EVENT

D = 0.002
STEP = 0.01  # s between frames


def moving(make, x, plane=False):
    """A run of given centres, (n_frame, n_grain, 3), periodic along x and y."""
    run = make.run_of(STEP * np.arange(len(x)), x, 0.0 * x, np.zeros(0, EVENT))
    run.scene = replace(run.scene, plane_case=plane, period=(20 * D, 20 * D))
    return run


def walk(sizes, n_frame=400, n_grain=400, seed=1):
    """Random walks with these root mean squares of a step along x, y and z [m]."""
    steps = np.random.default_rng(seed).normal(size=(n_frame, n_grain, 3)) * sizes
    return np.cumsum(steps, axis=0)


def test_a_random_walk_has_the_diffusivity_of_its_steps(make):
    sizes = np.array([3.0, 2.0, 1.0]) * 0.02 * D
    found = dispersion(moving(make, walk(sizes)), layer=100.0)
    for name, size in zip(("along", "across", "normal"), sizes, strict=True):
        one = found[f"diffusivity_{name}"]
        expected = size**2 / (2 * STEP)
        assert one.value == pytest.approx(expected, rel=0.1)
        assert abs(one.value - expected) < 4.0 * one.error
        msd = getattr(found, name)
        np.testing.assert_allclose(msd, 2 * expected * found.lag, rtol=0.1)


def test_the_error_covers_the_truth_about_as_often_as_it_says(make):
    size, hits = 0.02 * D, 0
    for seed in range(30):
        found = dispersion(moving(make, walk(3 * [size], 200, 30, seed)), layer=1000.0)["diffusivity_across"]
        hits += abs(found.value - size**2 / (2 * STEP) * (1 - 1 / 30)) < 2.0 * found.error
    assert hits >= 24


def test_shear_and_a_common_drift_are_no_dispersion(make):
    n_frame, n_grain = 100, 200
    z = D * np.linspace(0.0, 10.0, n_grain)
    t = STEP * np.arange(n_frame)[:, None]
    x = np.zeros((n_frame, n_grain, 3))
    x[:, :, 2] = z
    x[:, :, 0] = t * 50.0 * z
    x[:, :, 1] = 0.3 * t**2
    found = dispersion(moving(make, x), layer=0.01)
    assert np.abs(found.along).max() < 1e-20
    assert np.abs(found.across).max() < 1e-20
    whole = dispersion(moving(make, x), layer=1000.0)  # one layer: the shear is left in
    spread = (50.0 * z).var()
    np.testing.assert_allclose(whole.along, spread * whole.lag**2, rtol=1e-9)


def test_straight_flights_grow_with_the_square_of_the_lag(make):
    n_frame, speed = 81, 0.1
    x = np.zeros((n_frame, 2, 3))
    x[:, :, 1] = speed * STEP * np.arange(n_frame)[:, None] * [1.0, -1.0]
    found = dispersion(moving(make, x), fit=(0.1, 0.2))
    np.testing.assert_allclose(found.across, (speed * found.lag) ** 2, rtol=1e-9)
    # a line through a parabola from 0.1 s to 0.2 s has the slope at the middle of them, 2 x 0.15 s
    assert found["diffusivity_across"].value == pytest.approx(speed**2 * 0.15, rel=1e-9)
    assert found.fit == pytest.approx((0.1, 0.2))


def test_a_plane_scene_has_no_direction_across(make):
    found = dispersion(moving(make, walk(3 * [0.01 * D], 60, 20), plane=True))
    assert [one.name for one in found.averages.items] == ["diffusivity_along", "diffusivity_normal"]


def test_dispersion_does_not_depend_on_the_chunks_of_grains(make, monkeypatch):
    run = moving(make, walk(3 * [0.1 * D], 60, 50))
    whole = dispersion(run)
    monkeypatch.setattr(importlib.import_module("ryusa.measure.dispersion"), "PLACES", 60 * 7)
    parts = dispersion(run)
    np.testing.assert_allclose(parts.along, whole.along, rtol=1e-10)
    np.testing.assert_allclose(parts.normal, whole.normal, rtol=1e-10)


def test_what_has_no_diffusivity_is_refused(make):
    run = moving(make, walk(3 * [0.01 * D], 60, 5))
    with pytest.raises(ResultsError, match="9 frames or more"):
        dispersion(run, begin=0.55)
    with pytest.raises(ResultsError, match="fewer than two lags"):
        dispersion(run, fit=(0.1, 0.1))
    run.frames.t = np.concatenate([run.frames.t[:30], run.frames.t[30:] + 0.5])
    with pytest.raises(ResultsError, match="evenly spaced"):
        dispersion(run)
    run.scene = replace(run.scene, period=(math.inf, math.inf))
    with pytest.raises(ResultsError, match="open along x"):
        dispersion(run)
