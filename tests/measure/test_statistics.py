import math

import numpy as np
import pytest

from ryusa.measure.statistics import average, ratio, standard_error


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
    found = average("x", "-", [series])
    assert not found.short
    assert found.error == pytest.approx(2.0 / math.sqrt(4096), rel=0.2)


def test_the_interval_of_white_noise_has_its_nominal_coverage():
    one, two = coverage(lambda rng: [rng.normal(1.0, 1.0, 64) for _ in range(8)], 1.0)
    assert one == pytest.approx(0.68, abs=0.09)
    assert two == pytest.approx(0.95, abs=0.05)


@pytest.mark.parametrize("n", [2, 3, 5, 12])
def test_an_error_of_few_samples_is_widened_so_that_it_covers_68_percent(n):
    one, _ = coverage(lambda rng: [rng.normal(1.0, 1.0, n)], 1.0, trials=2000)
    assert one == pytest.approx(0.683, abs=0.035)


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
    found = [standard_error(series(np.random.default_rng(seed))) for seed in range(10)]
    assert np.mean([one.error for one in found]) == pytest.approx(true, rel=0.2)
    naive = np.std(series(np.random.default_rng(0))[0]) / math.sqrt(n)
    assert true > 3 * naive


def test_initial_states_that_differ_count_as_few_samples():
    rng = np.random.default_rng(2)
    starts = [rng.normal(offset, 0.01, 256) for offset in (-1.0, 0.0, 1.0, 2.0)]
    naive = np.concatenate(starts).std() / 32
    found = standard_error(starts)
    assert found.error > 5 * naive
    assert found.independent == 4
    assert found.error == pytest.approx(1.197 * np.std([-1.0, 0.0, 1.0, 2.0], ddof=1) / 2, rel=0.02)


def test_starts_of_one_sample_each_have_the_error_of_their_spread():
    values = [1.0, 2.0, 4.0, 9.0, 3.0, 2.5]
    found = standard_error([[one] for one in values])
    assert found.freedom == 5
    assert found.error == pytest.approx(1.111 * np.std(values, ddof=1) / math.sqrt(6), rel=1e-3)


def test_starts_that_swing_together_do_not_count_as_so_many_records():
    """A surge of the flow moves all grains: a hundred grains are worth no more than one."""
    rng = np.random.default_rng(5)
    alone, together = [], []
    for _ in range(40):
        surge = np.repeat(rng.normal(size=64), 4)
        grains = [surge + 0.1 * rng.normal(size=256) for _ in range(20)]
        together.append(standard_error(grains).error)
        alone.append(standard_error([surge]).error)
    assert np.mean(together) == pytest.approx(np.mean(alone), rel=0.1)


def test_a_series_too_short_says_so():
    assert math.isnan(standard_error([[1.0]]).error)
    assert average("x", "m", [[1.0]]).short
    assert average("x", "m", [np.random.default_rng(1).normal(size=12)]).verdict == "too short"
    empty = average("x", "m", [])
    assert empty.n == 0
    assert math.isnan(empty.value)
    assert not empty.steady
    assert empty.verdict == "-"


def test_a_trend_is_not_steady_and_noise_is():
    rng = np.random.default_rng(3)
    noise = rng.normal(size=(4, 200))
    assert average("x", "-", list(noise)).steady
    rising = average("x", "-", list(noise + np.linspace(0, 2, 200)))
    assert not rising.steady
    assert rising.drift == pytest.approx(1.0, abs=0.2)
    assert rising.verdict.startswith("no, drift +")


def test_a_drift_is_in_the_unit_of_its_quantity_however_quiet_the_record_was_before():
    """An outlet that the first grains reach after half of the window."""
    rate = np.where(np.arange(80) < 40, 0.0, 0.024 + 1e-9 * np.random.default_rng(2).normal(size=80))
    found = ratio("rate_out", "kg/s", [0.02 * rate], [np.full(80, 0.02)])
    assert found.changes
    assert found.drift == pytest.approx(0.024)
    assert found.verdict == "no, drift +0.024"
    assert average("x", "-", [np.cos(np.arange(400) * np.pi / 200.0)]).verdict == "no, it varies"


def test_starts_of_different_lengths_that_all_rise_are_not_steady():
    rng = np.random.default_rng(6)
    starts = [rng.normal(size=n) + np.linspace(0, 3, n) for n in (9, 14, 30, 41)]
    assert average("x", "-", starts).changes
    steady = [average("x", "-", [rng.normal(size=n) for n in (9, 14, 30, 41)]) for _ in range(200)]
    assert sum(one.changes for one in steady) <= 14


def test_a_record_that_does_not_change_at_all_is_steady():
    found = average("x", "-", [np.full(40, 0.1)])
    assert found.steady
    assert found.error == pytest.approx(0.0, abs=1e-15)
    b = np.random.default_rng(4).uniform(1, 2, 64)
    assert ratio("speed", "m/s", [0.1 * b], [b]).steady


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
