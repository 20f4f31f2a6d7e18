"""Segregation of grains whose order over height is known."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ryusa.errors import ResultsError
from ryusa.measure import segregation
from ryusa.measure.segregation import _largest
from ryusa.model import EVENT

D = 0.002


def stacked(make, z, d):
    """A run of grains that stay at the heights z [m], with diameters d [m]."""
    x = np.zeros((30, len(z), 3))
    x[:, :, 2] = z
    run = make.run_of(0.1 * np.arange(30), x, 0.0 * x, np.zeros(0, EVENT))
    run.scene = replace(run.scene, d=np.asarray(d))
    return run


def test_large_grains_on_top_give_one_below_give_minus_one(make):
    z, d = np.arange(10.0) * D, np.repeat([0.5 * D, D], 5)
    assert segregation(stacked(make, z, d))["segregation_index"].value == pytest.approx(1.0, abs=1e-12)
    assert segregation(stacked(make, -z, d))["segregation_index"].value == pytest.approx(-1.0, abs=1e-12)


def test_mixed_grains_give_zero_and_their_centres_are_weighted_by_volume(make):
    z, d = np.array([1.0, 2.0, 3.0, 2.0]) * D, np.array([1.0, 2.0, 1.0, 2.0]) * D
    found = segregation(stacked(make, z, d))
    assert found["segregation_index"].value == pytest.approx(0.0, abs=1e-12)
    z = np.array([1.0, 4.0]) * D
    found = segregation(stacked(make, z, [D, 2 * D]))
    assert found.z == pytest.approx((1.0 + 8 * 4.0) / 9 * D, rel=1e-12)
    assert found["large_over_all"].value == pytest.approx((4.0 - 33 / 9) * D, rel=1e-12)
    assert found["small_over_all"].value == pytest.approx((1.0 - 33 / 9) * D, rel=1e-12)
    assert found.share == pytest.approx(8 / 9)
    assert found.series()[0]["z_all_m"] == found.z[0]
    assert "z_m" not in found.rows()[0]  # a series, no layers


def test_grains_that_fill_a_depth_evenly_are_half_of_it_apart_when_parted():
    n, depth = 4000, 0.3
    z, volume = (np.arange(n) + 0.5) / n * depth, np.ones(n)
    for share in (0.1, 0.5, 0.8):
        large = np.arange(n) >= (1.0 - share) * n
        assert _largest(z, volume, large) == pytest.approx(0.5 * depth, rel=1e-3)


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.floats(1.1, 4.0), st.integers(1, 19))
def test_the_index_is_never_beyond_one(seed, size, n_large):
    rng = np.random.default_rng(seed)
    z, large = rng.normal(size=20), rng.permutation(20) < n_large
    volume = np.where(large, size**3, 1.0)
    apart = np.average(z[large], weights=volume[large]) - np.average(z[~large], weights=volume[~large])
    assert apart <= _largest(z, volume, large) * (1.0 + 1e-12) + 1e-12
    assert -apart <= _largest(-z, volume, large) * (1.0 + 1e-12) + 1e-12


def test_grains_of_one_size_and_a_cut_beyond_all_are_refused(make):
    with pytest.raises(ResultsError, match="no two sizes"):
        segregation(stacked(make, [0.0, 1.0], [D, D]))
    with pytest.raises(ResultsError, match="no two sizes"):
        segregation(stacked(make, [0.0, 1.0], [D, 2 * D]), cut=3 * D)
    assert segregation(stacked(make, [0.0, 1.0, 2.0], [D, 2 * D, 3 * D]), cut=2.5 * D).share == pytest.approx(
        27 / 36
    )
