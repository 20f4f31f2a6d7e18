"""Rates of false alarm and of miss, and errors, on series of known answer; `rates.py` prints a table."""

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest

from ryusa.measure.steadiness import block_means, compare_quarters, truncation

SPEC = importlib.util.spec_from_file_location("rates", Path(__file__).with_name("rates.py"))
assert SPEC and SPEC.loader
rates = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(rates)

TRIALS = 400
CHANCE = 2.5  # standard deviations of a share over TRIALS series that chance may add to its band


def asked(found):
    """Those for which a band is stated."""
    return [one for one in found if one.band != rates.ANY]


def judge(rate, trials=TRIALS):
    """The share lies in its band, but for the chance of so few series."""
    share, (low, high) = rate.measure(trials, seed=7), rate.band
    most = 100.0 * CHANCE * math.sqrt(0.01 * high * (1.0 - 0.01 * high) / trials) if high < 100.0 else 0.0
    least = 100.0 * CHANCE * math.sqrt(0.01 * low * (1.0 - 0.01 * low) / trials)
    assert low - least <= share <= high + most, f"{rate.group}, {rate.what}: {share:.1f} %"


@pytest.mark.parametrize("rate", asked(rates.alarms()), ids=lambda one: one.what)
def test_a_steady_record_is_seldom_called_unsteady(rate):
    judge(rate)


@pytest.mark.full
@pytest.mark.parametrize("rate", asked(rates.misses()), ids=lambda one: one.what)
def test_a_change_is_seldom_missed_and_a_large_one_never_excuses_itself(rate):
    judge(rate, 200)


@pytest.mark.full
@pytest.mark.parametrize(
    "rate", asked([*rates.errors(), *rates.begins()]), ids=lambda one: f"{one.group}, {one.what}"
)
def test_errors_and_begins_are_right_as_often_as_asked_for(rate):
    judge(rate)


@pytest.mark.parametrize("tau", [1, 10, 100])
@pytest.mark.parametrize("times", [50, 200, 1000])
def test_the_error_of_a_correlated_series_is_right_within_20_percent(tau, times):
    assert 0.8 <= rates.mean_error(rates.long(tau, times), TRIALS, seed=7) <= 1.2


def test_the_end_of_a_transient_counts_whatever_the_length_of_the_record():
    """The error of a mean is no smaller where its blocks could leave out the first samples."""
    rng = np.random.default_rng(3)
    for n in range(90, 130, 7):
        falling = 3.0 * np.exp(-np.arange(n) / 4.0) + 0.01 * rng.normal(size=n)
        found = rates.average("q_star", "-", [falling])
        assert found.error > 0.5 * falling.mean()
        assert found.changes


def test_the_record_of_a_transient_begins_where_it_has_decayed():
    t = np.linspace(0.0, 10.0, 500)
    for seed in range(20):
        record = 1.0 + 0.1 * np.random.default_rng(seed).normal(size=500) + 5.0 * np.exp(-t / 0.5)
        assert 2.0 < 10.0 * truncation(record) < 6.0
    assert math.isnan(truncation(record + t))
    assert math.isnan(truncation(record[:19]))


def test_a_linear_trend_without_noise_hardly_raises_the_noise_it_is_held_against():
    """Variance of the means 0.104, noise 1/768, of the square of the trend times the samples of a quarter."""
    variation, drift = compare_quarters(np.arange(1000.0))
    assert variation == pytest.approx(math.sqrt(80.0), rel=0.02)
    assert drift == pytest.approx(500.0, rel=0.02)


def test_block_means_use_every_sample_once():
    for n in (5, 128, 129, 1000):
        rows = np.arange(n, dtype=np.float64)
        blocks = block_means(rows)
        assert len(blocks) == min(n, 128)
        assert blocks.mean() == pytest.approx(rows.mean(), rel=0.01)
        assert np.all(np.diff(blocks) > 0.0)
    assert block_means(np.ones((300, 4))).shape == (128, 4)


def test_a_change_without_noise_is_told_by_its_sign():
    step = np.repeat([0.0, 0.0, 1.0, 1.0], 8)
    assert compare_quarters(step) == (math.inf, 1.0)
    assert compare_quarters(-step) == (math.inf, -1.0)
    assert compare_quarters(np.zeros(19)) != compare_quarters(np.zeros(20)) == (0.0, 0.0)


def test_the_documented_rates_are_those_of_the_script_and_lie_in_their_bands():
    text = (Path(__file__).parents[2] / "docs" / "measuring.md").read_text()
    for rate in rates.every():
        line = next(one for one in text.splitlines() if f"| {rate.group} | {rate.row} |" in one)
        share, (low, high) = float(line.split("|")[3].strip(" %")), rate.band
        assert low <= share <= high, line
