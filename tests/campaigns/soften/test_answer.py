"""What `ryusa soften` says of synthetic numbers: every outcome, and its reason."""

import math

import numpy as np
import pytest

from ryusa.campaigns.soften import Answer, Question, SofterRuns
from ryusa.campaigns.soften.answer import answered
from ryusa.casefile.precision import ErrorLimit

K_N = 6400.0
FACTORS = (4.0, 16.0, 64.0)
BED_LOAD = Question("transport", "q_star", "-", ErrorLimit(0.05))
HEAP = Question("surface", "slope", "rad", ErrorLimit(0.05, "rad"))


def runs_of(values, **more):
    return [
        SofterRuns(factor, K_N / factor, math.sqrt(factor), tuple(float(each) for each in one), **more)
        for factor, one in zip(FACTORS, values, strict=True)
    ]


def runs(a, p=0.5, noise=0.002, seeds=3, y_inf=1.0, draw=1):
    """Runs of y_inf + a (k/k of the case)**-p with normal noise."""
    rng = np.random.default_rng(draw)
    mean = y_inf + a * np.array(FACTORS) ** p
    return runs_of(mean[:, None] + noise * rng.standard_normal((3, seeds)))


def test_a_case_that_stiffness_does_not_change_is_called_so_with_a_bound():
    found = answered(BED_LOAD, K_N, runs(0.0))
    assert found.answer is Answer.ALL
    assert found.softest is not None
    assert found.softest.runs.factor == 64.0
    most = max(abs(found.softest.error.low), abs(found.softest.error.high))
    assert f"makes no difference larger than {100 * most:.3g} %" in found.says
    assert "8 times fewer steps" in found.says


def test_the_softest_within_the_tolerance_is_named_and_softer_ones_are_not():
    found = answered(BED_LOAD, K_N, runs(0.02, noise=0.001))  # true errors 2, 5.9 and 13.7 % of 1.02
    assert found.answer is Answer.SOME
    assert found.softest is not None
    assert found.softest.runs.k_n == 1600.0
    assert [one.within for one in found.errors] == [True, False, False]
    assert "The softest within 5 % is k_n = 1600 N/m (1/4)" in found.says
    assert "k_n = 100 N/m (1/64) is outside" in found.says


def test_none_is_within_where_every_interval_is_outside():
    found = answered(BED_LOAD, K_N, runs(0.2))
    assert found.answer is Answer.NONE
    assert found.softest is None
    assert "None of these is within 5 %" in found.says


def test_nothing_is_said_where_seeds_scatter_more_than_the_tolerance():
    found = answered(BED_LOAD, K_N, runs(0.0, noise=0.2))
    assert found.answer is Answer.UNKNOWN
    assert found.softest is None
    assert "Cannot be said: seeds scatter by more than the tolerance" in found.says
    assert found.seeds > 3
    assert f"about {found.seeds} seeds" in found.says


def test_so_many_seeds_as_are_proposed_decide_in_most_draws():
    proposed = answered(BED_LOAD, K_N, runs(0.0, noise=0.06)).seeds
    decided = [
        answered(BED_LOAD, K_N, runs(0.0, noise=0.06, seeds=2 * proposed, draw=draw)).softest is not None
        for draw in range(20)
    ]
    assert sum(decided) >= 15


@pytest.mark.parametrize("draw", range(40))
def test_noise_alone_is_never_taken_for_a_stiffness_within_the_tolerance(draw):
    # the true error of the stiffest is 10 %, twice the tolerance, beneath noise of 30 %
    found = answered(BED_LOAD, K_N, runs(0.1, noise=0.3, draw=draw))
    assert found.softest is None


def test_a_bracket_within_the_tolerance_is_refused_where_means_are_less_well_known():
    # against a stiffness close by, the curve makes errors small however much the seeds scatter
    near = [
        SofterRuns(factor, K_N / factor, 1.0, tuple(1.0 + 0.1 * np.array([-1.0, 0.0, 1.0])))
        for factor in (1.01, 8.0, 64.0)
    ]
    found = answered(BED_LOAD, K_N, near)
    assert found.errors[0].error.high < 0.05
    assert found.answer is Answer.UNKNOWN


def test_seeds_that_all_give_the_same_number_are_no_measure_of_chance():
    found = answered(BED_LOAD, K_N, runs_of([[1.0] * 3, [1.1] * 3, [1.3] * 3]))
    assert found.answer is Answer.UNKNOWN
    assert "all seeds give the same transport q_star" in found.says
    still = answered(BED_LOAD, K_N, runs_of([[0.0] * 3] * 3))
    assert "transport q_star is 0 in every run" in still.says


def test_a_jump_between_two_stiffnesses_is_not_extrapolated():
    rng = np.random.default_rng(5)
    found = answered(BED_LOAD, K_N, runs_of(np.array([1.0, 2.0, 1.0])[:, None] + 0.01 * rng.random((3, 3))))
    assert found.answer is Answer.UNKNOWN
    assert "the means do not follow y_inf + a k^-p" in found.says


def test_a_stiffness_without_numbers_is_left_out_and_two_are_too_few():
    rows = [[1.0, 1.1], [1.0, 1.1], [1.0, math.nan]]
    found = answered(BED_LOAD, K_N, runs_of(rows, problem="grains overlap by 0.5 d"))
    assert found.answer is Answer.UNKNOWN
    assert "2 of 3 stiffnesses gave a number" in found.says
    assert "k_n = 100 N/m (1/64): grains overlap by 0.5 d" in found.says
    assert any("left out" in one for one in found.remarks)


def test_a_tolerance_in_the_unit_of_the_number_needs_no_share_of_it():
    found = answered(HEAP, K_N, runs(0.0, y_inf=0.0, noise=0.005))
    assert found.answer is Answer.ALL
    assert " rad" in found.says
    share = answered(BED_LOAD, K_N, runs(0.0, y_inf=0.0, noise=0.005))
    assert share.answer is Answer.UNKNOWN


def test_errors_against_hard_grains_are_larger_than_against_the_case():
    hard = Question("transport", "q_star", "-", ErrorLimit(0.05), against_hard=True)
    to_case, to_hard = (answered(one, K_N, runs(0.02, noise=0.001)) for one in (BED_LOAD, hard))
    assert to_hard.reference == math.inf
    for near, far in zip(to_case.errors, to_hard.errors, strict=True):
        assert far.error.value > near.error.value
        assert far.error.high - far.error.low > near.error.high - near.error.low


def test_what_check_warns_of_and_uneven_scatter_are_passed_on():
    rng = np.random.default_rng(6)
    noise = np.array([0.001, 0.001, 0.5])[:, None] * rng.standard_normal((3, 5))
    found = answered(BED_LOAD, K_N, runs_of(1.0 + noise, warnings=("travel per contact u t/d 0.5",)))
    assert "k_n = 100 N/m (1/64): travel per contact u t/d 0.5" in found.remarks
    assert any("Bartlett" in one for one in found.remarks)
    even = answered(BED_LOAD, K_N, runs(0.0))
    assert not even.remarks
