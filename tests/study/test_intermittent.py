"""Flows that stop and start, made up as a flow with two states, whose mean and correlation time are known."""

import math

import numpy as np
import pytest
from scipy import stats

from ryusa.study import correlation_time, over_seeds, rate_with_rests, share_over_runs

RATE = 1.3  # while in motion


def telegraph(rng, moves, rests, length, step=0.05):
    """Motion (1) or rest (0) at equal times; mean durations of both, and of the run."""
    now, out = rng.random() < moves / (moves + rests), []
    while len(out) * step < length:
        n = rng.exponential(moves if now else rests) / step
        out += [float(now)] * max(1, round(n))
        now = not now
    return np.array(out[: round(length / step)])


@pytest.mark.parametrize(("moves", "rests", "length"), [(1.0, 1.0, 1.0), (3.0, 1.0, 1.0), (1.0, 1.0, 5.0)])
@pytest.mark.parametrize("n", [3, 6])
def test_the_mean_of_a_flow_that_stops_is_covered_where_students_interval_misses_it(moves, rests, length, n):
    rng = np.random.default_rng(3)
    true, hits, students = RATE * moves / (moves + rests), [], []
    for _ in range(400):
        share = [float(telegraph(rng, moves, rests, length).mean()) for _ in range(n)]
        rates = [RATE * one * (1.0 + 0.05 * rng.normal()) for one in share]
        found, plain = rate_with_rests(rates, share, "-"), over_seeds(rates, "-")
        # runs that never changed are judged as a steady flow: nothing in them tells that it stops
        hits.append(found.low <= true <= found.high or min(share) == 1.0 or max(share) == 0.0)
        students.append(plain.low <= true <= plain.high)
        assert 0.0 <= found.low <= found.value <= found.high
    assert np.mean(hits) > 0.93
    assert np.mean(hits) >= np.mean(students)


def test_the_share_of_a_clustered_sample_is_covered():
    rng = np.random.default_rng(4)
    hits = []
    for _ in range(500):
        found = share_over_runs([float(telegraph(rng, 1.0, 1.0, 2.0).mean()) for _ in range(6)])
        hits.append(found.low <= 0.5 <= found.high)
    assert 0.91 < np.mean(hits) < 0.99


def test_shares_of_runs_that_are_all_alike_count_as_one_trial_each():
    low, high = stats.beta.ppf([0.025, 0.975], 6.5, 0.5)
    found = share_over_runs([1.0] * 6)
    assert (found.value, found.low, found.high) == (1.0, pytest.approx(low), 1.0)
    assert high < 1.0  # the end of the interval is the end of the range where the share is
    none = share_over_runs([0.0] * 6)
    assert (none.low, none.high) == (0.0, pytest.approx(1.0 - low))


@pytest.mark.parametrize("shares", [[0.0, 0.01, 0.0], [1.0, 1.0, 0.97], [0.0, 1.0, 0.0], [0.3, 0.4, 0.2]])
def test_the_interval_of_a_share_stays_a_share(shares):
    found = share_over_runs(shares)
    assert 0.0 <= found.low <= found.value <= found.high <= 1.0
    assert found.low < found.high


def test_a_flow_that_never_rests_has_students_interval():
    rates = [1.0, 1.1, 1.3]
    assert rate_with_rests(rates, [1.0] * 3, "-") == over_seeds(rates, "-")


def test_one_run_has_no_interval():
    assert rate_with_rests([0.7], [0.5], "-").low == rate_with_rests([0.7], [0.5], "-").high == 0.7
    assert share_over_runs([0.4]).low == 0.4


def test_beds_at_rest_carry_nothing_and_no_less():
    found = rate_with_rests([1e-5, 4e-5, 1e-5], [0.0] * 3, "-")
    assert found.low == 0.0
    assert found.high < 1e-3


def test_one_run_that_moved_among_beds_at_rest_leaves_the_rate_open():
    found = rate_with_rests([0.0, 0.0, 1.2], [0.0, 0.0, 1.0], "-")
    assert found.low == 0.0
    assert found.high > 0.7


def test_the_correlation_time_is_that_of_the_flow():
    rng = np.random.default_rng(5)
    moves, rests, step = 2.0, 1.0, 0.05
    true = 1.0 / (1.0 / moves + 1.0 / rests)
    found = correlation_time([telegraph(rng, moves, rests, 80.0, step) for _ in range(200)], step)
    assert found == pytest.approx(true, rel=0.2)


def test_runs_too_short_to_tell_have_half_their_length_as_correlation_time():
    assert correlation_time([np.ones(20), np.zeros(20)], 0.5) == 5.0
    assert math.isnan(correlation_time([np.ones(20)], 0.5))
    assert math.isnan(correlation_time([np.ones(20), np.ones(20)], 0.5))
