import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from ryusa.study import Band, Finding, Outcome, Trial, over_range, over_seeds, pool, seeds_trial

BAND = Band(1.0, 2.0, "m", "1 to 2 m")


def trial(value, low=None, high=None, part="length", **choices):
    found = over_range(
        [value if low is None else low, value, value if high is None else high], "m", "3 tries"
    )
    return Trial(part, choices, found, BAND)


def finding(*trials, contradiction=""):
    return Finding("fig4", trials, "nothing", contradiction=contradiction)


def test_an_interval_of_three_seeds_is_students():
    values = [1.0, 2.0, 4.0]
    found = over_seeds(values, "m")
    low, high = stats.t.interval(0.95, 2, np.mean(values), stats.sem(values))
    assert found.low == pytest.approx(low)
    assert found.high == pytest.approx(high)


def test_a_pooled_spread_counts_where_the_own_is_no_larger():
    noisy, quiet = [1.0, 2.0, 3.0], [5.0, 5.1, 4.9]
    spread = pool([noisy, quiet])
    assert over_seeds(noisy, "m", spread) == over_seeds(noisy, "m")
    assert over_seeds(quiet, "m", spread).high > over_seeds(quiet, "m").high
    alike = [[1.0, 2.0, 3.0], [5.0, 6.1, 7.0], [2.0, 3.0, 3.9]]
    assert over_seeds(alike[2], "m", pool(alike)).high < over_seeds(alike[2], "m").high


@pytest.mark.parametrize("sigma", [1.0, 3.0])
def test_a_setting_of_a_sweep_is_covered_even_where_it_scatters_three_times_as_much(sigma):
    rng = np.random.default_rng(5)
    hits: list[bool] = []
    for _ in range(2000):
        groups = [list(rng.normal(3.0, sigma if k == 0 else 1.0, 3)) for k in range(8)]
        one = over_seeds(groups[0], "m", pool(groups))
        hits.append(one.low <= 3.0 <= one.high)
    assert np.mean(hits) > 0.92


def test_intervals_have_their_nominal_coverage():
    rng = np.random.default_rng(4)
    hits = [over_seeds(list(rng.normal(3.0, 1.0, 3)), "m") for _ in range(2000)]
    share = np.mean([one.low <= 3.0 <= one.high for one in hits])
    assert 0.935 < share < 0.965


def test_one_seed_has_no_interval_and_nan_is_undecided():
    one = over_seeds([1.5], "m")
    assert one.low == one.value == one.high
    assert BAND.holds(over_seeds([1.5, math.nan], "m")) is None


def test_a_band_needs_the_whole_interval_inside_or_outside():
    assert trial(1.5, 1.2, 1.8).holds is True
    assert trial(3.0, 2.5, 3.5).holds is False
    assert trial(1.9, 1.7, 2.1).holds is None


@pytest.mark.parametrize(
    ("trials", "word"),
    [
        ([trial(1.5, phi="10 deg"), trial(1.6, phi="20 deg")], Outcome.HOLDS),
        ([trial(1.5, phi="10 deg"), trial(3.0, phi="20 deg")], Outcome.HOLDS),
        ([trial(3.0, phi="10 deg"), trial(1.5, phi="20 deg")], Outcome.FAILS),
        ([trial(3.0, phi="10 deg"), trial(4.0, phi="20 deg")], Outcome.FAILS),
        ([trial(1.9, 1.7, 2.1, phi="10 deg"), trial(4.0, phi="20 deg")], Outcome.UNDECIDED),
        ([trial(1.5, phi="10 deg"), trial(1.9, 1.7, 2.1, phi="20 deg")], Outcome.HOLDS),
        ([trial(1.5, part="height"), trial(3.0, part="length")], Outcome.FAILS),
        ([], Outcome.UNDECIDED),
    ],
)
def test_one_rule_turns_trials_into_a_verdict(trials, word):
    assert finding(*trials).outcome is word


def test_a_claim_excluded_by_its_equations_is_excluded_whatever_the_runs():
    assert finding(trial(1.5), contradiction="a band of 10 cannot hold 100").outcome is Outcome.EXCLUDED


def swept(holds, phis=("10 deg", "20 deg", "30 deg", "40 deg")):
    """A finding over friction angles and four other choices, that holds where the function says so."""
    others = [{"slip": slip, "start": start} for slip in ("spring", "total") for start in ("rest", "moving")]
    return finding(*(trial(1.5 if holds(phi) else 3.0, phi=phi, **one) for phi in phis for one in others))


def test_a_finding_holds_only_if_one_choice_decides_beyond_chance():
    found = swept(lambda phi: phi in ("20 deg", "30 deg"))
    assert found.outcome is Outcome.ONLY_IF
    assert found.condition == "phi 20 deg to 30 deg (8 of 8 settings, none of 8 others)"


def test_one_setting_that_holds_among_many_makes_no_condition():
    found = finding(*(trial(1.5 if k == 7 else 3.0, phi=str(k % 4), slip=str(k // 4)) for k in range(16)))
    assert (found.outcome, found.condition, found.deciding) == (Outcome.FAILS, "", None)
    assert (found.robustness.holds, found.robustness.of) == (1, 16)


def test_a_condition_that_the_other_half_of_the_seeds_does_not_confirm_is_none():
    def tried(phi, second):
        return Trial("n", {"phi": str(phi), "k": str(second)}, over_seeds([1.5], "m"), BAND)

    def of(phi, k, confirmed):
        first = phi < 2
        return replace(
            tried(phi, k), decided=first, halves=(first, first if confirmed else (phi + k) % 2 == 0)
        )

    for confirmed in (True, False):
        found = finding(*(of(phi, k, confirmed) for phi in range(4) for k in range(4)))
        assert (found.deciding is not None) is confirmed


def test_halves_of_the_seeds_are_judged_by_their_means():
    one = seeds_trial("length", {}, [1.2, 3.0, 1.4, 3.2], BAND)
    assert one.found == over_seeds([1.2, 3.0, 1.4, 3.2], "m")
    assert one.halves == (True, False)
    assert seeds_trial("length", {}, [1.5], BAND).halves == (True, None)


def test_a_decided_trial_needs_no_number():
    wall = Trial("slope", {}, over_seeds([math.nan], "deg"), BAND, decided=False, note="stands as a wall")
    assert wall.holds is False
