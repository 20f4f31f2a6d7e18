"""The measured profiles are those of the flume, and ours are set against them as said."""

import numpy as np
import pytest

from ryusa.casefile import derive, read
from ryusa.cases import case_path
from ryusa.study import Interval, Level, Outcome, Plan
from ryusa_studies.validation import frey

PLAN = Plan(Level.STANDARD, (1, 2, 3))


def flume_run(work):
    depth = dict(work.overrides)["water.depth"]
    return next(run for run, one in frey.FLUME.items() if one.depth == depth)


def measurement(run, factor=1.0, rest=0.0, seconds=30):
    """What a run would give whose beads have the profiles of the flume, and rest for a share of its time."""
    z, phi, u = frey.measured()[run]
    moving = factor * (1.0 - rest)
    rates = np.full(seconds, factor * frey.rate(z, phi, u))
    rates[: round(rest * seconds)] = 0.0
    return {
        "z": z, "phi": phi, "u": moving * u, "z_water": z, "u_water": 2.0 * u,
        "q_star": moving * frey.rate(z, phi, u), "rates": rates, "time": float(seconds),
    }  # fmt: skip


def judged(plan=PLAN, **how):
    """Every finding; `how` gives factors and rests of the runs of one setting, in turn."""
    count: dict = {}
    found = {}
    for work in frey.tasks(plan):
        run = flume_run(work)
        key = (run, work.get("water.column.side_walls"))
        k = count[key] = count.get(key, -1) + 1
        found[work] = measurement(run, **{name: some[k % len(some)] for name, some in how.items()})
    return {one.id: one for one in frey.judge(found, plan)}


def test_the_flux_of_the_measured_profiles_is_that_of_the_flume() -> None:
    flume = frey.measured()
    # the two rates that the literature quotes for runs 6 and 20, with g cos(slope)
    assert frey.rate(*flume[6]) == pytest.approx(0.066, abs=0.001)
    assert frey.rate(*flume[14]) == pytest.approx(0.136, abs=0.001)  # between them, as its depth is
    assert frey.rate(*flume[20]) == pytest.approx(0.194, abs=0.001)
    for z, phi, u in flume.values():
        assert np.all(np.diff(z) > 0.0)
        assert 0.4 < phi[z < 6.0].mean() < 0.6
        assert np.all(np.diff(u[z > 6.0]) > 0.0)


@pytest.mark.parametrize("level", [Level.STANDARD, Level.FULL])
def test_profiles_equal_to_the_flumes_have_no_error(level) -> None:
    for one in judged(Plan(level, (1, 2, 3))).values():
        assert one.outcome is (Outcome.SHOWN if one.id == "side-walls" else Outcome.HOLDS)
        for each in one.trials:
            if "rms" in each.part:
                assert each.found.value == pytest.approx(0.0, abs=1e-9)
            if "at rest" in each.part:
                assert (each.found.value, each.found.low) == (0.0, 0.0)
    assert frey.tasks(Plan(Level.QUICK, (1,))) == []


def test_rates_that_scatter_about_a_limit_are_undecided():
    found = judged(factor=(0.9, 1.6, 1.2))["peer-6-phi"]
    assert found.trials[0].holds is None
    assert found.outcome is Outcome.UNDECIDED


def test_a_rate_far_off_is_missed_whatever_the_scatter():
    found = judged(factor=(0.001, 0.2, 0.05))["published-20-phi"]
    assert found.trials[0].holds is False
    assert found.trials[0].found.low >= 0.0


def test_a_flow_that_stops_says_how_long_it_rests_and_what_it_carries_in_motion():
    found = judged(factor=(1.2, 1.3, 1.25), rest=(0.0, 0.9, 0.3))["peer-14-phi"]
    named = {one.part: one for one in found.trials}
    rest = named["share of the time at rest"]
    assert rest.found.value == pytest.approx(0.4)
    assert 0.0 < rest.found.low < 0.4 < rest.found.high < 1.0
    moving = named["q_star while in motion over that of the flume"]
    assert moving.found.value == pytest.approx(1.25)
    assert not rest.judged
    assert not moving.judged
    assert named["q_star over that of the flume"].holds is None
    assert "The flow stops and starts" in found.decided_by


def test_a_flow_that_never_stops_has_no_word_about_rests():
    found = judged(factor=(1.0, 1.05, 0.95))["peer-20-phi"]
    assert found.outcome is Outcome.HOLDS
    assert "stops" not in found.decided_by
    assert [one.part for one in found.trials][2:] == ["share of the time at rest"]


def test_noise_between_runs_is_no_misfit_of_the_profile():
    flume = frey.measured()[20]
    z, phi, u = flume
    rng = np.random.default_rng(8)
    runs = [{"z": z, "phi": phi * (1.0 + 0.1 * rng.normal(size=len(z))), "u": u} for _ in range(40)]
    single = np.mean([frey.rms([one], flume, 1).value for one in runs])
    whole = frey.rms(runs, flume, 1)
    assert whole.value < 0.4 * single
    assert whole.low < single


def test_the_speed_of_the_runs_together_is_that_of_their_beads():
    z = np.linspace(5.5, 9.0, 50)
    fast = {"z": z, "phi": np.full(50, 0.3), "u": np.full(50, 0.4)}
    still = {"z": z[:30], "phi": np.full(30, 0.1), "u": np.zeros(30)}
    heights, phi, u = frey.pooled_profile([fast, still])
    assert heights is z
    assert phi[0] == pytest.approx(0.2)
    assert u[0] == pytest.approx(0.3)  # three of four beads move
    assert u[-1] == pytest.approx(0.4)


def _ratio(low, value, high):
    return Interval(value, low, high, "-", 3, "")


def test_water_whose_levels_begin_elsewhere_is_averaged_at_the_same_heights():
    low, high = np.arange(-1.0, 4.0, 0.5), np.arange(-0.8, 4.6, 0.5)
    runs = [{"z_water": low, "u_water": 2.0 * low}, {"z_water": high, "u_water": 4.0 * high}]
    z, u = frey.pooled_water(runs)
    assert z == pytest.approx(np.arange(-0.5, 4.0, 0.5))
    assert u == pytest.approx(3.0 * z)


def test_the_walls_that_fit_lie_between_those_that_surely_do_not():
    widths = np.array([6.5, 16.0, 22.0, 28.0, 45.0])
    ratios = [
        _ratio(0.0, 0.1, 0.2), _ratio(0.3, 0.5, 0.7), _ratio(0.6, 0.9, 1.2),
        _ratio(0.8, 1.1, 1.4), _ratio(1.5, 1.8, 2.1),
    ]  # fmt: skip
    found = frey.matching(widths, ratios)
    assert (found.low, found.high, found.unit) == (16.0, 45.0, "mm")
    assert found.value == pytest.approx(25.0)


def test_walls_that_were_not_bracketed_have_an_open_end():
    found = frey.matching(np.array([6.5, 28.0]), [_ratio(0.0, 0.1, 0.2), _ratio(0.3, 0.9, 1.5)])
    assert found.low == 6.5
    assert found.high == np.inf
    assert np.isnan(found.value)


def test_the_page_names_the_ends_where_the_distance_cannot_be_interpolated():
    (first, *_) = judged(factor=(0.2, 0.21, 0.22))["side-walls"].trials
    assert first.note == "more than 28 mm"
    (first, *_) = judged(factor=(2.0, 2.1, 2.2))["side-walls"].trials
    assert first.note == "less than 6.5 mm"
    (first, *_) = judged(factor=(0.5, 1.5, 3.2))["side-walls"].trials
    assert "none of these" in first.note


def test_every_run_is_of_the_published_flume() -> None:
    for work in frey.tasks(PLAN):
        case = read(case_path("validation/frey.toml"), dict(work.overrides))
        assert case.stop.time is not None
        assert case.water is not None and case.water.column is not None
        # Walls 6.5 mm apart nearly stop the flow: 10 s are enough to tell its rate from that of the flume.
        least = 10.0 if case.water.column.side_walls == pytest.approx(6.5e-3) else 20.0
        assert case.stop.time - case.record.settle >= least
        assert derive(case).n_grain in {354, 365, 368}
