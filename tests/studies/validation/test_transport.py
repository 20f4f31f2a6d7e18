"""How transport is judged, without a run."""

import math

import numpy as np
import pytest

from ryusa.studies.validation import transport
from ryusa.study import Level, Outcome, Plan


def made(factor, level=Level.FULL):
    """What runs would give that carry a multiple of Meyer-Peter & Mueller's rate."""
    runs = transport.tasks(Plan(level, ()))
    stress = np.geomspace(0.06, 1.5, len(runs)) if len(runs) > 1 else np.array([0.3])
    rates = factor * transport.formulae(stress)["Meyer-Peter & Mueller 1948"]
    return {
        one: {
            "q_star": q, "q_error": 0.1 * q, "tau_star": tau, "tau_error": 0.0, "slope": 0.01, "depth": 20.0,
            "drift": 0.0, "layer": 3.0,
        }
        for one, tau, q in zip(runs, stress, rates, strict=True)
    }  # fmt: skip


@pytest.mark.parametrize("level", [Level.QUICK, Level.FULL])
def test_rates_of_a_formula_lie_between_the_formulae(level):
    (found,) = transport.judge(made(1.0, level), Plan(level, ()))
    assert found.outcome is Outcome.HOLDS
    assert found.trials[0].found.value == pytest.approx(1.0)


def test_rates_far_above_all_formulae_are_missed():
    (found,) = transport.judge(made(5.0), Plan(Level.FULL, ()))
    assert found.outcome is Outcome.FAILS


def test_a_bed_at_rest_above_the_threshold_is_missed():
    (found,) = transport.judge(made(0.0, Level.QUICK), Plan(Level.QUICK, ()))
    assert found.trials[0].found.value == math.inf
    assert found.outcome is Outcome.FAILS


def test_below_the_threshold_nothing_is_judged():
    tau = np.array([0.1, 1.0])
    low, high = (min(one[k] for one in transport.formulae(tau).values()) for k in (0, 1))
    q = np.array([0.25 * low, high])
    assert transport.outside(tau, q) == pytest.approx([4.0, 1.0])
    assert transport.JUDGED > 0.05


def test_egashira_has_no_rate_where_the_layer_fills_the_flow():
    rates = transport.egashira([0.1, 5.0], 0.0, 10.0)
    assert rates[0] > 0.0
    assert math.isnan(rates[1])
