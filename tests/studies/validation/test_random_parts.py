"""Gas, balance and incline judged from results made up, with and without scatter between seeds."""

import math

import numpy as np
import pytest

from ryusa.study import Level, Outcome, Plan
from ryusa_studies.validation import balance, gas, incline

SETS = ((1, 2, 3), (4, 5, 6))


def gases(plan, off, scatter):
    """Gases that cool as Haff says, with a time tau_0 that is off."""
    rng = np.random.default_rng(plan.seeds[0])
    t = np.linspace(0.0, 2.0, 61)
    return {
        one: {"t": t, "T": (1.0 + t / (1.0 + off + scatter * rng.normal())) ** -2.0}
        for one in gas.tasks(plan)
    }


@pytest.mark.parametrize("seeds", SETS)
@pytest.mark.parametrize(
    ("off", "scatter", "word"),
    [
        (0.015, 0.01, Outcome.HOLDS),
        (-0.015, 0.01, Outcome.HOLDS),
        (0.03, 0.01, Outcome.UNDECIDED),
        (0.06, 0.01, Outcome.FAILS),
    ],
)
def test_a_gas_is_judged_by_the_mean_of_several(seeds, off, scatter, word):
    plan = Plan(Level.STANDARD, seeds)
    (found,) = gas.judge(gases(plan, off, scatter), plan)
    assert found.outcome is word
    assert found.trials[0].found.value == pytest.approx(abs(off), abs=3.0 * scatter / math.sqrt(12))


def test_one_gas_of_the_quick_level_is_judged_by_its_number():
    plan = Plan(Level.QUICK, (1,))
    (found,) = gas.judge(gases(plan, 0.1, 0.0), plan)
    assert found.outcome is Outcome.HOLDS
    assert found.trials[0].found.low == found.trials[0].found.high == pytest.approx(0.1)


def weighed(plan, scatter, bias=0.0):
    """Impulses of beds that carry the weight but for what is stored, in ten parts."""
    rng = np.random.default_rng(plan.seeds[0])
    found = {}
    for one in balance.tasks(plan):
        parts = np.tile([1.0, -0.7, -0.3, 0.0], (balance.PARTS, 1))
        stored = balance.PARTS * (bias + scatter * rng.normal())
        parts[-1, 2] -= stored
        parts[-1, 3] = -stored
        found[one] = {"parts": parts, "speed": np.array(0.1)}
    return found


@pytest.mark.parametrize("seeds", SETS)
@pytest.mark.parametrize(
    ("scatter", "bias", "word"),
    [
        (0.001, 0.002, Outcome.HOLDS),
        (0.02, 0.0, Outcome.UNDECIDED),
        (0.001, 0.02, Outcome.FAILS),
        (0.001, -0.02, Outcome.FAILS),
    ],
)
def test_the_weight_on_the_bed_is_judged_by_the_mean_over_beds(seeds, scatter, bias, word):
    plan = Plan(Level.STANDARD, seeds)
    (found,) = balance.judge(weighed(plan, scatter, bias), plan)
    assert found.outcome is word
    assert found.trials[-1].found.value == pytest.approx(0.0, abs=1e-12)  # momentum is conserved in any


def flows(plan, power=1.5, scatter=0.0, drift=0.0):
    """Dense flows whose speed below the surface has some power of the depth."""
    rng = np.random.default_rng(plan.seeds[0])
    d, n = 2.0e-3, 13
    found = {}
    for k, one in enumerate(incline.tasks(plan)):
        z = d * (np.arange(n) - 0.5 + (0 if k else 1))[: n - k]  # not all have the same layers
        depth = float(z[-1]) + 0.5 * d
        s = depth - z
        law = 2.0 / 3.0 * 0.13 / d * math.sqrt(0.56 * incline.G * math.cos(incline.SLOPE))
        u = 0.4 - law * depth**1.5 * (s / depth) ** power
        found[one] = {
            "z": z, "phi": np.full(len(z), 0.56), "u": u * (1.0 + scatter * rng.normal(size=len(z))),
            "dz": d, "d": d, "rho_s": 2650.0, "drift": drift * rng.choice([-1.0, 1.0]),
        }  # fmt: skip
    return found


def outcomes(**how):
    plan = Plan(Level.STANDARD, (1, 2, 3))
    return {one.id: one.outcome for one in incline.judge(flows(plan, **how), plan)}


def test_bagnolds_profile_is_within_and_another_power_is_missed():
    assert outcomes()["bagnold"] is Outcome.HOLDS
    assert outcomes(power=2.5)["bagnold"] is Outcome.FAILS


def test_layers_that_scatter_as_much_as_the_limit_decide_nothing():
    assert outcomes(scatter=0.02)["inertial-number"] is Outcome.UNDECIDED
    assert outcomes(drift=0.06)["bagnold"] is Outcome.UNDECIDED


def test_layers_are_matched_by_their_height():
    plan = Plan(Level.STANDARD, (1, 2, 3))
    found = flows(plan)
    for chart in (one.chart for one in incline.judge(found, plan)):
        assert chart is not None
        ours = chart.ours[0]
        assert len(ours.x) == len(ours.y)
        assert np.diff(ours.x) == pytest.approx(1.0)
    assert incline.tasks(Plan(Level.QUICK, (1,))) == []
    assert incline.judge({}, Plan(Level.QUICK, (1,))) == []
