"""The extrapolation over stiffness, on synthetic data whose limit, exponent and noise are known."""

import math

import numpy as np
import pytest

from ryusa.campaigns.soften.extrapolate import EXPONENT, extrapolation

K = np.array([16.0, 4.0, 1.0])
OWN = 64.0
DRAWS = 300
# 5 % of misses, and four standard deviations of their number among so many draws
MOST_MISSES = 0.05 * DRAWS + 4.0 * math.sqrt(0.05 * 0.95 * DRAWS)


def means(y_inf, a, p):
    return y_inf + a * K**-p


def drawn(rng, y_inf, a, p, noise, seeds):
    values = means(y_inf, a, p)[:, None] + noise * rng.standard_normal((len(K), seeds))
    return extrapolation(K, values)


@pytest.mark.parametrize("p", [0.25, 0.5, 0.8, 1.0])
@pytest.mark.parametrize(("a", "noise"), [(0.0, 0.05), (0.3, 0.02), (1.0, 0.01), (-0.5, 0.1)])
def test_brackets_hold_the_truth_in_95_of_100_draws_at_every_exponent(p, a, noise):
    rng = np.random.default_rng(20)
    hard, own = 1.0, 1.0 + a * OWN**-p
    misses = np.zeros(4)
    for _ in range(DRAWS):
        found = drawn(rng, 1.0, a, p, noise, 3)
        brackets = (
            (found.value(math.inf), hard),
            (found.value(OWN), own),
            (found.error(4.0, OWN), (1.0 + a * 4.0**-p) / own - 1.0),
            (found.error(1.0, math.inf, relative=False), a),
        )
        misses += [not one.low <= truth <= one.high for one, truth in brackets]
    assert misses.max() <= MOST_MISSES


def test_one_exponent_alone_would_miss_the_limit_that_the_bracket_holds():
    # that the range of p matters: an interval at p = 1/2 misses where the truth is 1/4
    rng = np.random.default_rng(21)
    x = K**-0.5
    design = np.column_stack([np.ones(3), x])
    alone = held = 0
    for _ in range(100):
        values = means(1.0, 1.0, 0.25)[:, None] + 0.01 * rng.standard_normal((3, 3))
        line = np.linalg.lstsq(design, values.mean(axis=1), rcond=None)[0]
        error = math.sqrt(np.linalg.inv(design.T @ design)[0, 0] * 1e-4 / 3.0)
        alone += abs(line[0] - 1.0) < 2.45 * error
        found = extrapolation(K, values).value(math.inf)
        held += found.low <= 1.0 <= found.high
    assert alone < 50
    assert held >= 90


def test_precise_numbers_tell_the_exponent_and_the_limit():
    found = drawn(np.random.default_rng(22), 1.0, 1.0, 0.7, 1e-5, 4)
    assert found.exponents.low <= 0.7 <= found.exponents.high
    assert found.exponents.high - found.exponents.low < 0.02
    hard = found.value(math.inf)
    assert hard.value == pytest.approx(1.0, abs=0.01)
    assert hard.high - hard.low < 0.05


def test_numbers_that_rise_and_fall_over_the_stiffness_follow_no_power():
    rng = np.random.default_rng(23)
    values = np.array([1.0, 2.0, 1.0])[:, None] + 0.01 * rng.standard_normal((3, 3))
    found = extrapolation(K, values)
    assert not found.follows
    assert found.value(math.inf).high == math.inf


def test_an_exponent_beyond_the_range_is_refused_where_the_numbers_are_precise():
    assert not drawn(np.random.default_rng(24), 1.0, 1.0, 2.0, 1e-3, 4).follows
    assert EXPONENT[1] < 2.0


def test_a_share_of_a_number_that_may_be_zero_has_no_limits():
    found = drawn(np.random.default_rng(25), 0.0, 0.0, 0.5, 1.0, 3)
    error = found.error(1.0, math.inf)
    assert (error.low, error.high) == (-math.inf, math.inf)
    assert math.isfinite(found.error(1.0, math.inf, relative=False).high)


def test_a_stiffness_has_no_error_against_itself():
    found = drawn(np.random.default_rng(26), 1.0, 1.0, 0.5, 0.1, 3)
    error = found.error(OWN, OWN)
    assert (error.low, error.value, error.high) == (0.0, 0.0, 0.0)


def test_errors_grow_as_the_stiffness_falls():
    found = drawn(np.random.default_rng(27), 1.0, 1.0, 0.5, 0.02, 3)
    ends = [found.error(k, OWN) for k in K]
    assert ends[0].low < ends[1].low < ends[2].low
    assert ends[0].high < ends[1].high < ends[2].high


def test_more_seeds_of_the_same_scatter_narrow_every_bracket():
    found = drawn(np.random.default_rng(28), 1.0, 0.3, 0.5, 0.1, 3)
    more = found.with_seeds(4.0)
    for k in (math.inf, OWN, 4.0):
        wide, narrow = found.value(k), more.value(k)
        assert narrow.high - narrow.low < wide.high - wide.low


def test_one_seed_or_two_stiffnesses_are_not_enough():
    with pytest.raises(ValueError, match="three stiffnesses"):
        extrapolation(K, [[1.0], [2.0], [3.0]])
    with pytest.raises(ValueError, match="three stiffnesses"):
        extrapolation([1.0, 2.0], [[1.0, 1.1], [2.0, 2.1]])
