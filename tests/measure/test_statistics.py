import math

import numpy as np
import pytest

from ryusa.measure.statistics import average, block_error, ratio


def coverage(make_series, true_mean, trials=300):
    """Share of trials whose mean lies within one and two standard errors of the truth."""
    hits = np.zeros(2)
    for trial in range(trials):
        series = make_series(np.random.default_rng(trial))
        found = average("x", "-", series)
        off = abs(found.value - true_mean) / found.error
        hits += off < 1, off < 2
    return hits / trials


def test_white_noise_gets_the_textbook_error():
    series = np.random.default_rng(1).normal(3.0, 2.0, 4096)
    found = block_error([series])
    assert found.plateau
    assert found.error == pytest.approx(2.0 / math.sqrt(4096), rel=0.2)


def test_the_interval_of_white_noise_has_its_nominal_coverage():
    one, two = coverage(lambda rng: [rng.normal(1.0, 1.0, 64) for _ in range(8)], 1.0)
    assert one == pytest.approx(0.68, abs=0.09)
    assert two == pytest.approx(0.95, abs=0.05)


def test_correlated_noise_gets_a_larger_error_than_the_naive_one():
    rho, n = 0.9, 8192

    def series(rng):
        noise = rng.normal(size=n)
        out = np.empty(n)
        out[0] = noise[0] / math.sqrt(1 - rho**2)
        for k in range(1, n):
            out[k] = rho * out[k - 1] + noise[k]
        return [out]

    true = math.sqrt(1 / (1 - rho) ** 2 / n)  # large-n standard error of the mean of this process
    found = [block_error(series(np.random.default_rng(seed))) for seed in range(10)]
    assert np.mean([one.error for one in found]) == pytest.approx(true, rel=0.2)
    naive = np.std(series(np.random.default_rng(0))[0]) / math.sqrt(n)
    assert true > 3 * naive


def test_initial_states_that_differ_count_as_few_samples():
    rng = np.random.default_rng(2)
    starts = [rng.normal(offset, 0.01, 256) for offset in (-1.0, 0.0, 1.0, 2.0)]
    naive = np.concatenate(starts).std() / 32
    found = block_error(starts)
    assert found.error > 5 * naive


def test_a_series_too_short_says_so():
    assert math.isnan(block_error([[1.0]]).error)
    assert not block_error([[1.0]]).plateau
    empty = average("x", "m", [])
    assert empty.n == 0
    assert math.isnan(empty.value)
    assert not empty.steady


def test_a_trend_is_not_steady_and_noise_is():
    rng = np.random.default_rng(3)
    noise = rng.normal(size=(4, 200))
    assert average("x", "-", list(noise)).steady
    rising = average("x", "-", list(noise + np.linspace(0, 2, 200)))
    assert not rising.steady
    assert rising.drift > 3


def test_a_sinusoid_sampled_over_whole_periods_has_its_offset_as_mean():
    t = np.arange(4000) / 100
    found = average("x", "-", [5.0 + np.sin(2 * np.pi * t)])
    assert found.value == pytest.approx(5.0, abs=1e-12)
    assert found.steady


def test_numbers_that_are_missing_are_left_out():
    found = average("x", "-", [[1.0, float("nan"), 3.0]])
    assert found.n == 2
    assert found.value == 2.0


def test_a_quotient_of_sums_weighs_by_the_divisor():
    found = ratio("speed", "m/s", [[1.0, 6.0]], [[1.0, 2.0]])
    assert found.value == pytest.approx(7 / 3)


def test_a_quotient_of_proportional_series_has_no_error():
    b = np.random.default_rng(4).uniform(1, 2, 64)
    found = ratio("speed", "m/s", [3.0 * b], [b])
    assert found.value == pytest.approx(3.0)
    assert found.error == pytest.approx(0.0, abs=1e-12)
