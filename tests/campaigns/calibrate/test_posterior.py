"""Priors, emulators and posteriors against closed forms; nothing is run."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm, truncnorm

from ryusa.campaigns.calibrate.design import filling_points, next_points, settings_of
from ryusa.campaigns.calibrate.emulator import emulate
from ryusa.campaigns.calibrate.posterior import Seen, prior_sd, sample_posterior, weighted_quantile
from ryusa.campaigns.calibrate.prior import Prior

pytest.importorskip("sklearn")

SLOPE = Prior("a", "uniform", 0.0, 10.0)
OTHER = Prior("b", "uniform", -1.0, 1.0)


def a_line(u, noise=0.0, seed=1):
    """The quantity 3 + 2 a of a uniform from 0 to 10; b has no part in it."""
    return 3.0 + 2.0 * 10.0 * u[:, 0] + noise * np.random.default_rng(seed).standard_normal(len(u))


@pytest.mark.parametrize(
    ("prior", "held"),
    [
        (Prior("a", "uniform", 10.0, 40.0), lambda q: 10.0 + 30.0 * q),
        (Prior("a", "log-uniform", 1.0, 100.0), lambda q: 100.0**q),
        (
            Prior("a", "normal", 10.0, 40.0, mean=20.0, sd=8.0),
            lambda q: truncnorm.ppf(q, -10.0 / 8.0, 20.0 / 8.0, 20.0, 8.0),
        ),
    ],
)
def test_a_prior_has_the_quantiles_of_its_distribution(prior, held):
    q = np.linspace(0.001, 0.999, 57)
    assert prior.at(q) == pytest.approx(held(q), rel=1e-9)
    assert prior.share(prior.at(q)) == pytest.approx(q, abs=1e-9)


@pytest.mark.full
def test_an_emulator_finds_a_straight_line_and_the_scatter_about_it():
    u = filling_points(2, 64, 1)
    exact = emulate(u, a_line(u))
    place = np.array([[0.3, 0.5], [0.71, 0.2]])
    mean, sd = exact.at(place)
    assert mean == pytest.approx(a_line(place), abs=0.02)
    assert np.all(sd < 0.05)
    noisy = emulate(u, a_line(u, noise=1.5))
    assert noisy.noise == pytest.approx(1.5, rel=0.25)
    assert noisy.lengths[1] > 5.0 * noisy.lengths[0]  # b has no part in it


def test_the_residual_of_a_run_left_out_is_that_of_a_fit_without_it():
    u = filling_points(1, 16, 1)
    values = a_line(u, noise=0.7)
    made = emulate(u, values)
    away, sd = made.left_out()
    k = 5
    rest = np.delete(np.arange(16), k)
    from sklearn.gaussian_process import GaussianProcessRegressor

    scaled = (values - made.mean) / made.scale
    without = GaussianProcessRegressor(made.fitted.kernel_, optimizer=None, alpha=1e-10).fit(
        u[rest], scaled[rest]
    )
    mean, spread = without.predict(u[[k]], return_std=True)
    assert away[k] == pytest.approx(values[k] - (made.mean + made.scale * mean[0]), rel=1e-6)
    assert sd[k] == pytest.approx(made.scale * spread[0], rel=1e-6)


def test_the_posterior_of_a_straight_line_is_the_normal_distribution_of_the_closed_form():
    """Observed 3 + 2 a = 13 +- 0.8: a is 5 +- 0.4; b keeps its prior, and the data do not determine it."""
    u = filling_points(2, 64, 1)
    found = sample_posterior((SLOPE, OTHER), [Seen(emulate(u, a_line(u)), 13.0, 0.8)])
    assert found.mean()[0] == pytest.approx(5.0, abs=0.03)
    assert found.sd()[0] == pytest.approx(0.4, rel=0.04)
    low, high = found.interval(0, 0.95)
    assert (low, high) == pytest.approx(norm.interval(0.95, 5.0, 0.4), abs=0.05)
    assert (
        found.sd()[1]
        == pytest.approx(prior_sd([OTHER])[0], rel=0.03)
        == pytest.approx(2.0 / math.sqrt(12.0), rel=0.04)
    )
    assert list(found.learnt()) == [True, False]


@pytest.mark.full
def test_two_parameters_of_one_sum_are_found_to_depend_on_each_other():
    u = filling_points(2, 64, 1)
    both = (Prior("a", "uniform", 0.0, 1.0), Prior("b", "uniform", 0.0, 1.0))
    found = sample_posterior(both, [Seen(emulate(u, u[:, 0] + u[:, 1]), 1.0, 0.02)])
    assert found.correlation()[0, 1] < -0.98
    assert not any(found.learnt())
    mean, sd, _ = found.of(emulate(u, u[:, 0] + u[:, 1]))  # though neither is known, their sum is
    assert mean == pytest.approx(1.0, abs=0.005)
    assert sd < 0.03


@pytest.mark.full
def test_an_observation_a_thousand_times_narrower_than_the_prior_is_still_sampled():
    u = filling_points(2, 64, 1)
    seen = [Seen(emulate(u, a_line(u)), 13.0, 0.02), Seen(emulate(u, u[:, 1]), 0.25, 0.001)]
    found = sample_posterior((SLOPE, OTHER), seen)
    assert found.worth > 500.0
    assert found.mean() == pytest.approx([5.0, -0.5], abs=0.01)


def test_further_points_lie_in_the_posterior_and_are_distinct():
    u = filling_points(2, 16, 1)
    seen = [Seen(emulate(u, a_line(u, noise=0.5)), 13.0, 0.5)]
    found = sample_posterior((SLOPE, OTHER), seen)
    more = next_points(found, seen, 6, 2, 1)
    assert len({tuple(one) for one in more}) == 6
    assert np.all(np.abs(10.0 * more[:, 0] - 5.0) < 2.0)
    assert len(settings_of((SLOPE, OTHER), more).settings) == 6
    few = np.arange(len(found.u)) < 9  # of which the first is drawn nearly always
    weights = np.where(few, 0.02, 0.0) + 0.82 * (np.arange(len(few)) == 0)
    again = next_points(replace(found, weights=weights / weights.sum()), seen, 6, 2, 1)
    assert len({tuple(one) for one in again}) == 6


@pytest.mark.full
def test_a_measure_that_was_left_out_is_predicted_as_the_closed_form_has_it():
    """Observed 3 + 2 a = 13 +- 0.8: 1 - a / 2 is -1.5 +- 0.2, and a single run scatters by 0.3 about it."""
    u = np.repeat(filling_points(2, 64, 1), 2, axis=0)
    left_out = 1.0 - 5.0 * u[:, 0] + 0.3 * np.random.default_rng(2).standard_normal(len(u))
    found = sample_posterior((SLOPE, OTHER), [Seen(emulate(u, a_line(u)), 13.0, 0.8)])
    mean, sd, sample = found.of(emulate(u, left_out))
    assert mean == pytest.approx(-1.5, abs=0.1)
    assert sd == pytest.approx(0.2, rel=0.15)
    assert np.quantile(sample, (0.025, 0.975)) == pytest.approx(norm.interval(0.95, mean, 0.2), abs=0.06)
    _, run_sd, _ = found.of(emulate(u, left_out), noise=True)
    assert run_sd == pytest.approx(math.hypot(0.2, 0.3), rel=0.15)


@pytest.mark.full
def test_further_points_tell_more_where_the_posterior_is_than_as_many_of_the_prior():
    """The uncertainty of the emulator over the posterior, after four points of either kind."""

    def bent(u):
        return np.sin(9.0 * u[:, 0]) + 0.5 * u[:, 1]

    u = filling_points(2, 16, 1)
    seen = [Seen(emulate(u, bent(u)), 1.2, 0.05)]
    found = sample_posterior((SLOPE, OTHER), seen)
    left: list[float] = []
    for more in (next_points(found, seen, 4, 1, 1), filling_points(2, 4, 7)):
        every = np.concatenate([u, more])
        _, sd = emulate(every, bent(every)).at(found.u)
        left.append(math.sqrt(found.weights @ sd**2))
    assert left[0] < 0.7 * left[1]


def test_a_weighted_quantile_of_equal_weights_is_the_plain_one():
    values = np.random.default_rng(1).normal(size=20001)
    for q in (0.1, 0.5, 0.9):
        found = weighted_quantile(values, np.full(20001, 1.0 / 20001), q)
        assert found == pytest.approx(np.quantile(values, q), abs=1e-3)
