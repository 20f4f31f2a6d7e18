"""The verdict of a calibration on models whose answer is known; nothing is run."""

import math
from pathlib import Path

import numpy as np
import pytest

from ryusa.campaigns.calibrate.coverage import BEYOND, WRONG, Counted, chance
from ryusa.campaigns.calibrate.definition import Observation, Target
from ryusa.campaigns.calibrate.design import filling_points
from ryusa.campaigns.calibrate.emulator import emulate
from ryusa.campaigns.calibrate.extend import PriorExtension, extended_prior, points_beyond
from ryusa.campaigns.calibrate.posterior import Posterior, Seen, sample_posterior
from ryusa.campaigns.calibrate.prior import Prior
from ryusa.campaigns.calibrate.sentences import headline, remarks
from ryusa.campaigns.calibrate.verdict import ONE_SEED, UNDETERMINED, UNREACHED, PriorEdge, judge

pytest.importorskip("sklearn")

A = Prior("a", "uniform", 0.0, 10.0, "deg")
B = Prior("b", "uniform", 0.0, 1.0)
NOISE = 0.5
SLOPE = Observation(Target(Path("heap.toml"), "surface", "slope"), "0", "1")


def a_line(u, noise=NOISE, seed=1):
    """The quantity 3 + 2 a, from 3 to 23; b has no part in it."""
    return 3.0 + 20.0 * u[:, 0] + noise * np.random.default_rng(seed).standard_normal(len(u))


@pytest.fixture(scope="module")
def line():
    u = np.repeat(filling_points(2, 32, 1), 2, axis=0)
    values = a_line(u)
    return emulate(u, values), values


def verdict_on(line, *observed, seeds=2, priors=(A, B)):
    made, values = line
    seen = [one if isinstance(one, Seen) else Seen(made, one, 1.0) for one in observed]
    return judge(sample_posterior(priors, seen), seen, [values] * len(seen), seeds)


def test_what_is_reached_is_determined_and_the_rest_is_not(line):
    found = verdict_on(line, 13.0)
    assert found.reached
    assert found.determined == (True, False)
    assert found.reason(1) == UNDETERMINED
    assert headline(found, (A, B)) == "Determined: a. Not determined: b (these data say too little)."
    (one,) = found.compared
    assert one.predicted == pytest.approx(13.0, abs=0.5)
    assert (one.least, one.most) == (line[1].min(), line[1].max())


@pytest.mark.parametrize(("value", "end", "to"), [(33.0, "high", 15.0), (-7.0, "low", -5.0)])
def test_an_observation_outside_all_runs_is_not_reached(line, value, end, to):
    found = verdict_on(line, value)
    assert not found.reached
    assert found.determined == (False, False)
    assert found.reason(0) == UNREACHED
    assert headline(found, (A, B)) == "The model does not reach these observations."
    (one,) = found.compared
    assert abs(one.misfit) == pytest.approx(10.0, rel=0.1)
    assert one.beyond == pytest.approx(10.0 / math.hypot(1.0, NOISE), rel=0.15)
    assert one.move is not None
    assert one.move.parameter == 0
    assert one.move.to == pytest.approx(to, abs=0.6)
    edge = found.edges[0]
    assert edge is not None
    assert edge.end == end
    said = " ".join(remarks(found, (A, B), [SLOPE], ["-"], []))
    assert "a would have to be about" in said
    assert "beyond its prior (uniform from 0 to 10 deg)" in said
    assert f"a lies at the {end} edge of its prior" in said


def test_two_observations_that_contradict_each_other_are_not_reached(line):
    """Each lies within the runs, and no value of a gives both."""
    found = verdict_on(line, 8.0, 18.0)
    assert not found.reached
    assert all(one.beyond == 0.0 for one in found.compared)
    assert not any(found.determined)


def test_a_posterior_at_an_edge_is_not_determined_though_the_model_reaches(line):
    found = verdict_on(line, 23.5)
    assert found.reached
    assert found.edges == (PriorEdge("high", 10.0), None)
    assert found.determined == (False, False)
    assert headline(found, (A, B)) == (
        "Not determined: a (at the high edge of its prior); b (these data say too little)."
    )


def test_the_edge_is_judged_by_the_density_there_over_the_largest():
    """Normal about 0.5 + k sd, cut at 1: exp(-k**2/2) at the end, over the largest value."""
    u = filling_points(1, 2**13, 1)
    for away in (0.5, 1.0, 2.0):
        weights = np.exp(-0.5 * ((u[:, 0] - (1.0 - 0.1 * away)) / 0.1) ** 2)
        low, high = Posterior((A,), u, weights / weights.sum()).at_ends(0)
        assert low < 0.01
        # averaged over half a standard deviation
        assert high == pytest.approx(math.exp(-0.5 * (away - 0.25) ** 2), abs=0.05)
    flat = Posterior((A,), u, np.full(len(u), 1.0 / len(u)))
    assert flat.at_ends(0) == pytest.approx((1.0, 1.0), abs=0.05)


def test_one_seed_determines_nothing(line):
    found = verdict_on(line, 13.0, seeds=1)
    assert found.reached
    assert not found.has_intervals
    assert found.determined == (False, False)
    assert found.reason(0) == ONE_SEED
    assert any("calibrate.seeds" in one for one in remarks(found, (A, B), [SLOPE], ["-"], []))


def test_a_discrepancy_is_stated_with_what_it_hides(line):
    found = verdict_on(line, Seen(line[0], 28.0, 1.0, 4.0))
    (one,) = found.compared
    assert abs(one.misfit) < 2.0 < abs(one.strict_misfit)
    (said,) = [one for one in remarks(found, (A, B), [SLOPE], ["-"], []) if "discrepancy" in one]
    assert "widens its error from 1 to 4.12, and all intervals with it; it corrects no bias" in said
    assert "standard deviations away" in said


@pytest.mark.full
def test_no_parameter_is_named_that_the_emulator_knows_nothing_of():
    u = np.repeat(filling_points(2, 32, 1), 2, axis=0)
    values = 10.0 + np.random.default_rng(1).standard_normal(len(u))
    found = verdict_on((emulate(u, values), values), 30.0)
    assert not found.reached
    assert found.compared[0].move is None


def test_runs_that_follow_no_parameter_give_no_verdict_on_the_model_within_them():
    u = np.repeat(filling_points(2, 8, 1), 2, axis=0)
    values = 10.0 + np.random.default_rng(1).standard_normal(len(u))
    made = emulate(u, values)
    found = verdict_on((made, values), Seen(made, float(values.max()) - 0.01, 0.1))
    assert not found.reached and found.compared[0].untold
    assert headline(found, (A, B)).startswith("These runs do not tell whether the model reaches")
    assert any("may reverse it" in one for one in remarks(found, (A, B), [SLOPE], ["-"], []))
    assert verdict_on((made, values), Seen(made, 30.0, 0.1)).refusal == UNREACHED


@pytest.mark.full
def test_intervals_and_verdicts_are_right_as_often_as_they_say(line):
    """60 truths on a line with scatter, each observed once, and each moved out of reach."""
    made, values = line
    rng = np.random.default_rng(5)
    counted = Counted((A, B), [values], 2)
    for truth in rng.random((60, 2)):
        width = math.hypot(0.5, made.noise / math.sqrt(2.0))
        value = 3.0 + 20.0 * truth[0] + width * rng.standard_normal()
        counted.add(truth, [Seen(made, value, width)], rng)
    found = counted.coverage()
    assert found.beyond == 60
    assert found.admitted <= WRONG * 60
    assert found.determined <= WRONG * 60
    assert found.unreached <= WRONG * 60
    n = len(found.truths)
    for share, inside in found.inside.items():
        low, high = chance(n, share)
        assert low - 3 <= inside[:, 0].sum() <= high + 3  # the noise was found from 64 runs only


@pytest.mark.full
def test_a_parameter_beyond_its_prior_is_seldom_called_determined(line):
    """The true a lies up to 2 deg beyond its prior, four standard deviations of the observation."""
    rng = np.random.default_rng(7)
    wrong = 0
    for truth in 10.0 + 2.0 * np.linspace(0.0, 1.0, 60):
        found = verdict_on(line, 3.0 + 2.0 * truth + rng.standard_normal(), priors=(A, B))
        wrong += found.determined[0]
    assert wrong <= WRONG * 60


def test_out_of_reach_is_far_beyond_what_the_verdict_allows():
    assert BEYOND >= 2.0 * 2.0


@pytest.mark.parametrize(
    ("prior", "end", "taken", "low", "high"),
    [
        (A, "high", lambda value: True, 0.0, 15.0),
        (A, "low", lambda value: True, -5.0, 10.0),
        (A, "high", lambda value: value <= 12.0, 0.0, 12.0),
        (Prior("a", "log-uniform", 1.0, 100.0), "high", lambda value: True, 1.0, 1000.0),
        (Prior("a", "normal", 0.0, 10.0, mean=5.0, sd=2.0), "high", lambda value: True, 0.0, 15.0),
    ],
)
def test_a_prior_is_extended_as_far_as_the_cases_take_it(prior, end, taken, low, high):
    found = extended_prior(prior, end, taken)
    assert found is not None
    assert (found.low, found.high) == pytest.approx((low, high), abs=0.02)
    assert taken(found.high)
    assert (found.kind, found.key) == (prior.kind, prior.key)


def test_a_prior_that_ends_at_a_limit_is_not_extended():
    assert extended_prior(Prior("a", "uniform", 0.0, 1.0), "low", lambda value: value >= 0.0) is None


def test_the_points_of_an_extension_fill_what_was_added():
    wider = Prior("a", "uniform", 0.0, 15.0, "deg")
    u = points_beyond([PriorExtension(A, wider, "high")], (wider, B), 16, 1)
    assert u.shape == (16, 2)
    assert np.all(wider.at(u[:, 0]) >= 10.0)
    assert u[:, 0].max() > 0.95
    assert np.ptp(u[:, 1]) > 0.9


@pytest.mark.full
def test_an_extended_design_finds_what_the_prior_had_shut_out():
    """Observed 29, which a = 13 gives: out of reach to 10, determined to 15."""
    wider = extended_prior(A, "high", lambda value: True)
    assert wider is not None
    first = np.repeat(filling_points(2, 32, 1), 2, axis=0)
    more = np.repeat(points_beyond([PriorExtension(A, wider, "high")], (wider, B), 16, 1), 2, axis=0)
    u = np.concatenate([first * np.array([10.0 / 15.0, 1.0]), more])
    values = 3.0 + 30.0 * u[:, 0] + NOISE * np.random.default_rng(1).standard_normal(len(u))
    seen = [Seen(emulate(u, values), 29.0, 1.0)]
    posterior = sample_posterior((wider, B), seen)
    found = judge(posterior, seen, [values], 2)
    assert found.determined == (True, False)
    assert posterior.mean()[0] == pytest.approx(13.0, abs=0.4)
