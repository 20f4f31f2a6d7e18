"""How transport is judged, without a run."""

import math

import numpy as np
import pytest

from ryusa.study import Level, Outcome, Plan
from ryusa_studies.validation import transport

PLANS = {level: Plan(level, (1,) if level is Level.QUICK else (1, 2, 3)) for level in Level}


def made(factor, level=Level.STANDARD, scatter=0.0, seeds=None):
    """What runs would give that carry a multiple of the geometric mean of the formulae, with scatter."""
    plan = PLANS[level] if seeds is None else Plan(level, seeds)
    rng = np.random.default_rng(len(plan.seeds) + plan.seeds[0])
    runs = transport.tasks(plan)
    slopes = {one: k for k, one in enumerate(dict.fromkeys(one.get("motion.slope") for one in runs))}
    stress = np.geomspace(0.06, 1.5, len(slopes)) if len(slopes) > 1 else np.array([0.3])
    rates = factor * np.exp(np.mean([np.log(one) for one in transport.formulae(stress).values()], axis=0))
    return {
        one: {
            "q_star": rates[k] * np.exp(scatter * rng.normal()), "tau_star": stress[k], "slope": 0.01,
            "depth": 20.0, "drift": 0.0, "layer": 3.0, "rest": 0.0,
        }
        for one in runs
        for k in [slopes[one.get("motion.slope")]]
    }  # fmt: skip


@pytest.mark.parametrize("level", Level)
def test_rates_between_the_formulae_are_within(level):
    (found,) = transport.judge(made(1.0, level), PLANS[level])
    assert found.outcome is Outcome.HOLDS
    assert found.trials[0].found.value == pytest.approx(1.0)


def test_rates_of_twice_the_mean_of_the_formulae_are_missed():
    """The first band, a factor of 2 beyond formulae that differ by 3, let them pass."""
    (found,) = transport.judge(made(2.0), PLANS[Level.STANDARD])
    assert found.outcome is Outcome.FAILS
    assert found.trials[0].found.value < 2.0


def test_rates_that_scatter_by_a_tenth_are_decided_alike_by_disjoint_seeds():
    for seeds in ((1, 2, 3), (4, 5, 6)):
        (found,) = transport.judge(made(1.0, scatter=0.1, seeds=seeds), Plan(Level.STANDARD, seeds))
        assert found.outcome is Outcome.HOLDS
        assert found.trials[0].found.value == 1.0


def test_rates_that_scatter_about_a_limit_are_undecided():
    (found,) = transport.judge(made(1.5, scatter=0.6), PLANS[Level.STANDARD])
    assert found.outcome is Outcome.UNDECIDED


def test_a_slope_at_rest_with_one_seed_is_undecided():
    found = made(1.0)
    one = max(found, key=lambda one: found[one]["tau_star"])
    found[one] = {**found[one], "q_star": 0.0, "rest": 1.0}
    (judged,) = transport.judge(found, PLANS[Level.STANDARD])
    assert judged.outcome is Outcome.UNDECIDED
    assert "at rest 33 % of the time" in judged.decided_by


def test_rates_far_above_all_formulae_are_missed():
    (found,) = transport.judge(made(5.0), PLANS[Level.STANDARD])
    assert found.outcome is Outcome.FAILS


def test_a_bed_at_rest_above_the_threshold_is_missed():
    (found,) = transport.judge(made(0.0, Level.QUICK), PLANS[Level.QUICK])
    assert found.trials[0].found.value == math.inf
    assert found.outcome is Outcome.FAILS


def test_below_the_threshold_nothing_is_judged():
    tau = np.array([0.1, 1.0])
    low, high = (min(one[k] for one in transport.formulae(tau).values()) for k in (0, 1))
    q = np.array([0.25 * low, high])
    above, below = transport.outside(tau, q)
    assert np.exp(below[0]) == pytest.approx(4.0)
    assert below[1] == pytest.approx(0.0)
    assert max(above) < 0.0
    assert transport.JUDGED > 0.05


def test_egashira_has_no_rate_where_the_layer_fills_the_flow():
    rates = transport.egashira([0.1, 5.0], 0.0, 10.0)
    assert rates[0] > 0.0
    assert math.isnan(rates[1])
