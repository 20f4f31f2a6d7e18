"""Verdicts in three parts: the base case, the share of settings, and the choice that decides."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ryusa.study import Band, Finding, Outcome, Trial, exact
from ryusa.study.verdict import effects, robustness

FACTORS = {"phi": ("20", "25", "30"), "slip": ("spring", "total"), "c_d": ("a", "b", "c")}
SETTINGS = [tuple(zip(FACTORS, values, strict=True)) for values in itertools.product(*FACTORS.values())]


def test_the_interval_of_a_share_is_that_of_wilson():
    found = robustness([True] * 8 + [False] * 2)
    assert (found.holds, found.of, found.undecided) == (8, 10, 0)
    z, n, p = 1.959963984540054, 10, 0.8
    middle, half = (p + z * z / (2 * n)), z * np.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    assert (found.low, found.high) == pytest.approx(
        ((middle - half) / (1 + z * z / n), (middle + half) / (1 + z * z / n))
    )


def test_an_undecided_setting_may_hold_or_fail():
    found = robustness([True] * 8 + [False] * 2 + [None] * 3)
    assert (found.holds, found.fails, found.of, found.undecided) == (8, 2, 13, 3)
    assert found.low == robustness([True] * 8 + [False] * 5).low
    assert found.high == robustness([True] * 11 + [False] * 2).high


@given(st.lists(st.sampled_from([True, False, None]), max_size=30))
def test_the_interval_of_a_share_lies_within_0_and_1_and_holds_the_share(held):
    found = robustness(held)
    assert 0.0 <= found.low <= found.high <= 1.0
    if found.of:
        assert found.low - 1e-12 <= found.holds / found.of <= found.high + 1e-12


def test_the_choice_that_decides_is_found_with_the_values_at_which_the_finding_holds():
    first, *others = effects({one: dict(one)["slip"] == "total" for one in SETTINGS})
    assert (first.choice, first.levels, first.significant) == ("slip", ("total",), True)
    assert not any(one.significant for one in others)
    three = effects({one: dict(one)["phi"] != "20" for one in SETTINGS})
    assert (three[0].choice, three[0].levels, three[0].significant) == ("phi", ("25", "30"), True)


def test_one_success_among_many_settings_decides_nothing():
    held = dict.fromkeys(SETTINGS, False)
    held[SETTINGS[7]] = True
    assert not any(one.significant for one in effects(held))


def test_chance_is_called_an_effect_in_at_most_one_study_in_twenty():
    draw = np.random.default_rng(3)
    pairs = [one for one in SETTINGS if dict(one)["phi"] != "30" and dict(one)["c_d"] != "c"]
    named = [
        any(one.significant for one in effects({s: bool(draw.integers(2)) for s in [*pairs]}))
        for _ in range(300)
    ]
    assert np.mean(named) <= 0.05 + 2.0 * np.sqrt(0.05 * 0.95 / 300)


def test_a_choice_that_does_not_vary_among_decided_settings_has_no_effect():
    held = {one: (None if dict(one)["slip"] == "total" else dict(one)["phi"] == "20") for one in SETTINGS}
    assert "slip" not in {one.choice for one in effects(held)}
    assert effects(dict.fromkeys(SETTINGS)) == []


def read_twice(window):
    """Settings whose runs are read in two windows of time."""
    return {(*one, ("window", w)): window(one, w) for one in SETTINGS for w in ("early", "late")}


def test_another_reading_of_the_same_runs_is_no_further_setting():
    alike = read_twice(lambda one, _: dict(one)["slip"] == "total")
    trials = [Trial("n", dict(key), exact(0.0, "-"), None, decided=held) for key, held in alike.items()]
    found = Finding("a", tuple(trials), readings=("window",))
    assert (found.robustness.holds, found.robustness.of) == (9, 18)
    assert Finding("a", tuple(trials)).robustness.of == 36
    once = {one.choice: one.p for one in effects({key: dict(key)["slip"] == "total" for key in SETTINGS})}
    read = {one.choice: one.p for one in effects(alike, ("window",))}
    assert read["slip"] == pytest.approx(once["slip"] * 4 / 3)  # corrected for four choices, not three
    assert effects(alike)[0].p < 1e-3 * read["slip"]  # what counting each run twice would claim


def test_a_reading_that_decides_is_found_among_all_readings():
    by_window = read_twice(lambda _, window: window == "late")
    first, *others = effects(by_window, ("window",))
    assert (first.choice, first.levels, first.significant) == ("window", ("late",), True)
    assert others == []  # by the first reading nothing holds, so no other choice has an effect to show


def test_where_no_seed_enters_every_other_setting_confirms_the_condition():
    def found(held):
        trials = [Trial("n", dict(key), exact(0.0, "-"), None, decided=yes) for key, yes in held.items()]
        return Finding("a", tuple(trials))

    one = found({key: dict(key)["slip"] == "total" for key in sorted(SETTINGS, key=lambda key: key[0][1])})
    assert not one.has_seeds
    halves = one.by_half(0), one.by_half(1)
    assert [len(half) for half in halves] == [9, 9]
    assert not set(halves[0]) & set(halves[1])
    by_chance = {key: k % 2 == 0 and dict(key)["slip"] == "total" for k, key in enumerate(one.by_choice)}
    assert found(by_chance).deciding is None  # it holds in one half alone


def test_the_base_verdict_is_that_of_the_case_as_it_ships_alone():
    band = Band(0.0, 1.0, "-", "")
    trials = tuple(
        Trial("n", {"phi": phi}, exact(value, "-"), band) for phi, value in (("30", 2.0), ("20", 0.5))
    )
    found = Finding("a", trials)
    assert (found.outcome, found.base_outcome) == (Outcome.FAILS, Outcome.FAILS)
    assert (found.robustness.holds, found.robustness.of) == (1, 2)
    assert found.deciding is None
