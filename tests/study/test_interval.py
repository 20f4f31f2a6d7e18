"""Intervals of the largest of several means, of magnitudes, and of functions of a mean."""

import math

import numpy as np
import pytest

from ryusa.study import (
    Band,
    Interval,
    at_most,
    largest_mean,
    misfit,
    not_negative,
    over_seeds,
    pool_alike,
    transformed,
)


@pytest.mark.full
@pytest.mark.parametrize("means", [(0.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.5, 0.2)])
@pytest.mark.parametrize("first", [0.3, 0.6, 1.5])
def test_the_largest_mean_is_covered_though_the_largest_number_picks_the_noise(means, first):
    rng = np.random.default_rng(6)
    hits, naive = [], []
    for _ in range(1500):
        groups = [list(rng.normal(m, first if k == 0 else 0.3, 3)) for k, m in enumerate(means)]
        found = largest_mean(groups, "-", pool_alike(groups))
        hits.append(found.low <= max(means) <= found.high)
        naive.append(np.mean(np.max(groups, axis=0)))
    # 95 % where all scatter alike; less, but not much, where Bartlett's test could not tell
    assert np.mean(hits) > (0.95 if first == 0.3 else 0.91)
    assert np.mean(naive) > max(means) + 0.02


def test_a_spread_is_pooled_over_settings_that_scatter_alike_and_over_no_others():
    rng = np.random.default_rng(9)
    alike = [list(rng.normal(0.0, 0.3, 3)) for _ in range(6)]
    found = pool_alike(alike)
    assert found is not None
    assert found.freedom == 12
    assert pool_alike([*alike, [-30.0, 0.0, 30.0]]) is None
    assert pool_alike([*alike, [1.0, 1.0, 1.0]]) is None
    assert pool_alike([*alike, [1.0, math.inf, 1.0]]) is None
    assert largest_mean(alike, "-", found).high < largest_mean(alike, "-").high


def test_the_largest_magnitude_sees_both_signs():
    found = largest_mean([[0.1, 0.2, 0.15], [-0.4, -0.5, -0.45]], "-", absolute=True)
    assert found.value == pytest.approx(0.45)
    assert found.low > 0.0
    assert largest_mean([[0.1, -0.1, 0.0]], "-", absolute=True).low == 0.0


def test_one_seed_gives_one_number():
    found = largest_mean([[0.1], [-0.4]], "-", absolute=True)
    assert (found.low, found.value, found.high) == (0.4, 0.4, 0.4)


def test_a_member_without_a_number_leaves_all_without():
    found = largest_mean([[0.1, 0.2], [math.nan, 0.2]], "-")
    assert math.isnan(found.value)
    assert Band(0.0, 1.0, "-", "").holds(found) is None


def test_an_increasing_function_carries_the_ends_along():
    logs = over_seeds(np.log([1.0, 2.0, 4.0]).tolist(), "-")
    found = transformed(logs, math.exp, "-", "geometric mean")
    assert found.value == pytest.approx(2.0)
    assert found.low == pytest.approx(math.exp(logs.low))


def test_what_cannot_be_negative_has_no_negative_end():
    assert not_negative(Interval(0.1, -0.3, 0.5, "m", 3, "")).low == 0.0
    assert math.isnan(not_negative(over_seeds([math.nan], "m")).low)


@pytest.mark.parametrize(
    ("values", "holds"), [([0.5, 0.6, 0.55], True), ([0.9, 1.2, 1.0], None), ([2.0, 2.1, 2.2], False)]
)
def test_an_error_with_an_interval_is_judged_by_the_whole_of_it(values, holds):
    made = misfit("rms", not_negative(over_seeds(values, "m")), "m", at_most(1.0, "a cell"))
    assert made.holds is holds
    assert made.band is not None
    assert made.band.unit == "m"


def test_an_infinite_error_is_missed_and_one_without_a_number_is_open():
    band = at_most(1.0, "a cell")
    assert misfit("rms", Interval(math.inf, math.inf, math.inf, "m", 3, ""), "m", band).holds is False
    assert misfit("rms", over_seeds([math.nan, 1.0], "m"), "m", band).holds is None
