"""The avalanche claims, judged on made-up flows: some under which each holds, some under which it fails."""

import math
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from ryusa.measure import Layers, Profiles, Tracks
from ryusa.measure.table import Averages
from ryusa.study import Band, Level, Outcome, Plan, carry_out
from ryusa.study.registration import Registration
from ryusa_studies import osada2004
from ryusa_studies.osada2004 import _avalanche, fig12_avalanche, fig14, fig15, fig16
from ryusa_studies.osada2004._avalanche import (
    ALL,
    BETWEEN,
    SHIPPED,
    SOFT,
    WINDOWS,
    RunPair,
    Ways,
    Window,
)
from ryusa_studies.osada2004._parts import PHI, ROTATION, SLIP
from ryusa_studies.osada2004.study import load

STANDARD = Plan(Level.STANDARD, (1, 2, 3, 4))
QUICK = Plan(Level.QUICK, (1,))
EMPTY = np.zeros(0)
PATH = Tracks((0,), *10 * [EMPTY], 4.4)
N = 20  # layers


def layers(name, value):
    return Layers(name, "-", value, np.zeros(len(value)))


def flow(speed=4.0, phi=0.5, lowest=0, in_band=0.8, **ways):
    """A flow whose speed grows with height by half, with a uniform concentration."""
    at = np.arange(N, dtype=float)
    v = speed * (0.75 + 0.5 * at / (N - 1))
    full = np.full(N, phi)
    none = np.full(N, math.nan)
    profile = Profiles(
        z=(lowest + at + 0.5) * 0.1, thickness=0.1, above="bed crest", origin=0.2, d=0.2,
        phi=layers("phi", full),
        area_fraction=layers("area_fraction", 1.5 * full), v_x=layers("v_x", v), v_z=layers("v_z", none),
        spin=layers("spin", none), temperature_x=layers("temperature_x", none),
        temperature_z=layers("temperature_z", none), flux=layers("flux", full * v), bed=none,
        t=np.arange(2.0), q=np.full(2, 0.1 * float((full * v).sum())), speed=np.full(2, speed),
        volume=np.full(2, 1.0), density=2650.0, area=1.0, lanes=1, averages=Averages("profile", (), ()),
    )  # fmt: skip
    way = Ways(
        **{
            "n": 9,
            "reversals": 10.0,
            "fine": 20.0,
            "per_metre": 5.0,
            "advance": 2.0,
            "jaggedness": 0.1,
            **ways,
        }
    )
    return Window(profile, {BETWEEN: way, ALL: way}, PATH, 100.0, 1.0, in_band, in_band)


def made(soft, stiff, plan=STANDARD):
    """What the runs would give; soft and stiff make a flow from a factor near 1, different for every seed."""
    return {
        one: dict.fromkeys(WINDOWS, (stiff if "contact.stiffness" in dict(one.overrides) else soft)(
            1.0 + 0.002 * (int(one.get("seed")) - 2)
        ))
        for one in _avalanche.tasks(plan)
    }  # fmt: skip


def words(experiment, soft, stiff):
    return {one.id: one.outcome for one in experiment.judge(made(soft, stiff), STANDARD)}


def test_the_case_ships_as_the_first_setting_and_tilts_when_the_windows_begin():
    case = _avalanche.run(SHIPPED, SOFT, 1).read()
    assert case.motion.rotation == "free"
    assert case.contact.slip == SHIPPED[SLIP]
    assert math.degrees(case.contact.friction_angle) == pytest.approx(30.0)
    assert case.timeline[0].at == pytest.approx(_avalanche.TILT)
    assert case.record.frames == pytest.approx(_avalanche.FRAME)
    assert case.stop.time == pytest.approx(_avalanche.TILT + max(end for _, end in WINDOWS.values()))


def test_the_first_setting_of_every_level_is_the_shipped_one():
    for level in Level:
        assert _avalanche.settings(Plan(level, (1,)))[0] == SHIPPED


def test_every_setting_can_be_read_and_records_the_contacts_of_all_grains():
    for one in _avalanche.settings(STANDARD):
        case = _avalanche.run(one, SOFT, 1).read()
        assert case.record.events == "all"
        assert case.build.columns == 20


def test_every_setting_has_the_seeds_of_the_plan_and_no_others():
    runs = [(one.overrides, one.get("seed")) for one in _avalanche.tasks(STANDARD)]
    assert len(runs) == len(set(map(str, runs))) == 17 * 4 * 2
    assert len(_avalanche.settings(STANDARD)) == 17
    assert len(_avalanche.settings(QUICK)) == 1


def test_trials_have_equal_samples_and_registered_bands_and_factors():
    registered = Registration.read(Path(osada2004.__file__).parent / "registration")
    found = made(flow_at(5.0), flow_at(4.0))
    for experiment in (fig12_avalanche, fig14, fig15, fig16):
        for one in experiment.judge(found, STANDARD):
            registered.check(one)
            assert set(registered.claims[one.id].factors) == set(one.trials[0].choices)
            assert {trial.found.n for trial in one.trials} == {4}
            assert all(None not in (trial.halves or (None,)) for trial in one.trials)


@pytest.mark.parametrize(("share", "word"), [(0.8, Outcome.HOLDS), (0.3, Outcome.FAILS)])
def test_large_grains_are_in_the_band_if_most_of_their_contacts_are(share, word):
    made_up = made(flow_at(4.0, in_band=share), flow_at(4.0))
    (found,) = fig12_avalanche.judge(made_up, STANDARD)
    assert found.outcome is word
    assert all(0.0 <= one.found.low <= one.found.high <= 1.0 for one in found.trials)


def test_equal_profiles_are_alike_and_half_as_dense_ones_are_not():
    assert words(fig14, flow_at(4.0), flow_at(3.0))["fig14"] is Outcome.HOLDS
    assert words(fig14, flow_at(4.0), flow_at(4.0, phi=0.25))["fig14"] is Outcome.FAILS


def test_a_heap_at_rest_is_no_avalanche_however_alike_it_is():
    assert words(fig14, flow_at(4.0), flow_at(0.01))["fig14"] is Outcome.FAILS


def flow_at(speed, **how):
    return lambda chance: flow(speed * chance, **how)


def test_runs_are_compared_in_the_same_layers_wherever_their_profiles_begin():
    pair = RunPair(flow(2.0), flow(2.0, lowest=5))
    (soft, _), (stiff, _) = _avalanche.layers([pair])
    assert len(soft) == N + 5
    assert (soft[:5] > 0).all()
    assert (stiff[:5] == 0).all()
    assert len(_avalanche.faster([pair])) == N - 5
    assert _avalanche.unlike([pair]) == pytest.approx(10 * 0.5 / (N * 0.5))


def test_scatter_of_single_runs_is_no_difference_of_what_they_have_in_common():
    def scattered(sign):
        one = flow(4.0)
        one.profile.phi.value[:] += sign * 0.05 * (-1.0) ** np.arange(N)
        return one

    found = [RunPair(scattered(1), scattered(-1)), RunPair(scattered(-1), scattered(1))]
    assert _avalanche.unlike(found[:1]) == pytest.approx(0.2)
    assert _avalanche.unlike(found) == pytest.approx(0.0, abs=1e-12)
    limits = Band(-math.inf, 0.1, "-", "alike")
    trial = _avalanche.together(_avalanche.unlike)("profiles", {}, found[:1], limits)
    assert trial.found.value == pytest.approx(0.2)
    assert trial.halves == (False, None)


def test_speeds_of_a_layer_are_weighted_with_what_is_there():
    (phi, speed), _ = _avalanche.layers(
        [RunPair(flow(4.0), flow(4.0)), RunPair(flow(2.0, phi=0.25), flow(4.0))]
    )
    assert phi == pytest.approx(np.full(N, 0.375))
    assert speed[0] == pytest.approx(0.75 * (0.5 * 4.0 + 0.25 * 2.0) / 0.75)


def test_a_pair_flows_where_both_runs_do():
    assert RunPair(flow(4.0), flow(4.0)).flows
    assert not RunPair(flow(4.0), flow(0.05)).flows


def test_the_least_lead_is_that_of_one_layer_with_its_own_interval():
    ahead = [5.0, 5.1, 4.9, 5.0]
    pairs = [RunPair(flow(one), flow(4.0)) for one in ahead]
    limits = Band(0.0, math.inf, "cm/s", "larger in every layer")
    found = fig15.least("least", {}, pairs, limits)
    lowest = [75.0 * (one - 4.0) for one in ahead]  # the lowest layer moves at 0.75 of the mean speed
    half = 3.182 * np.std(lowest, ddof=1) / 2.0
    assert found.found.value == pytest.approx(np.mean(lowest))
    assert found.found.low == pytest.approx(np.mean(lowest) - half, rel=1e-3)
    assert found.found.high > np.mean(lowest) + half
    assert found.halves == (True, True)


def test_one_slow_layer_among_many_is_no_chance_only_beyond_the_joint_interval():
    def pair(chance):
        one = flow(5.0)
        one.profile.v_x.value[0] = 3.0 - 0.05 + chance
        return RunPair(one, flow(4.0))

    limits = Band(0.0, math.inf, "cm/s", "larger in every layer")
    close = fig15.least("least", {}, [pair(x) for x in (-0.05, 0.03, -0.02, 0.04)], limits)
    assert close.holds is None
    clear = fig15.least("least", {}, [pair(x - 0.9) for x in (-0.05, 0.03, -0.02, 0.04)], limits)
    assert clear.holds is False


def test_fig15_requires_about_a_metre_per_second():
    assert words(fig15, flow_at(5.0), flow_at(4.0))["fig15"] is Outcome.HOLDS
    assert words(fig15, flow_at(4.1), flow_at(4.0))["fig15"] is Outcome.FAILS
    assert words(fig15, flow_at(7.0), flow_at(4.0))["fig15"] is Outcome.FAILS


def test_fig15_fails_where_a_layer_is_slower():
    def crossing(chance):
        one = flow(5.0 * chance)
        one.profile.v_x.value[0] = 0.1
        return one

    assert words(fig15, crossing, flow_at(4.0))["fig15"] is Outcome.FAILS


@pytest.mark.parametrize(
    ("soft", "word"),
    [(flow_at(5.0), Outcome.HOLDS), (flow_at(4.2), Outcome.FAILS), (flow_at(5.0, phi=0.7), Outcome.FAILS)],
)
def test_fig15_flux_requires_more_transport_at_equal_concentration(soft, word):
    assert words(fig15, soft, flow_at(4.0))["fig15-flux"] is word


JAGGED = {"per_metre": 20.0, "advance": 1.0, "jaggedness": 0.3}


def test_fig16_holds_if_short_contacts_give_jagged_and_shorter_paths():
    assert words(fig16, flow_at(4.0), flow_at(4.0, **JAGGED))["fig16"] is Outcome.HOLDS


@pytest.mark.parametrize(("name", "value"), [("per_metre", 4.0), ("advance", 3.0), ("jaggedness", 0.05)])
def test_fig16_fails_if_one_of_its_three_parts_does(name, value):
    assert words(fig16, flow_at(4.0), flow_at(4.0, **{**JAGGED, name: value}))["fig16"] is Outcome.FAILS


def test_more_reversals_per_second_alone_do_not_make_a_path_jagged():
    faster = {**JAGGED, "per_metre": 4.0, "reversals": 40.0}
    assert words(fig16, flow_at(4.0), flow_at(4.0, **faster))["fig16"] is Outcome.FAILS


def test_one_run_whose_grains_hardly_advance_does_not_outweigh_the_others():
    def soft(advance):
        return RunPair(flow(4.0, advance=advance), flow(4.0, advance=1.0))

    assert fig16._ratio([soft(0.001), soft(2.0), soft(1.999)], "advance", ALL) == pytest.approx(0.75)
    nothing = RunPair(flow(4.0, advance=math.nan), flow(4.0))
    assert fig16._ratio([nothing, soft(2.0), soft(2.0)], "advance", ALL) == pytest.approx(0.5)
    assert math.isnan(fig16._ratio([nothing, nothing, soft(2.0)], "advance", ALL))


def test_in_sums_over_the_runs_a_grain_that_hardly_advances_counts_as_little_as_it_advances():
    def pair(advance, per_metre):
        return RunPair(
            flow(4.0, advance=advance, per_metre=per_metre), flow(4.0, advance=1.0, per_metre=10.0)
        )

    runs = [pair(0.001, 5000.0), pair(1.0, 10.0), pair(1.0, 10.0)]  # 5, 10 and 10 turns a grain
    assert fig16._ratio(runs, "per_metre", ALL) < 0.01
    assert fig16._ratio_of_sums(runs, "per_metre", ALL) == pytest.approx(10.0 / (25.0 / 2.001))
    assert fig16._ratio_of_sums(runs, "advance", ALL) == pytest.approx(3.0 / 2.001)
    nothing = RunPair(flow(4.0, advance=math.nan), flow(4.0))
    assert math.isnan(fig16._ratio_of_sums([nothing, nothing, *runs[1:2]], "per_metre", ALL))


def test_fig16_fails_where_one_of_the_two_only_creeps():
    assert words(fig16, flow_at(4.0), flow_at(0.05, **JAGGED))["fig16"] is Outcome.FAILS


def test_fig16_fails_where_no_grain_alternates():
    nothing = {
        "n": 0,
        "reversals": math.nan,
        "per_metre": math.nan,
        "advance": math.nan,
        "jaggedness": math.nan,
    }
    (found,) = fig16.judge(made(flow_at(4.0), flow_at(4.0, **nothing)), STANDARD)
    assert found.outcome is Outcome.FAILS
    assert all(one.note for one in found.trials if "over sqrt(g d)" not in one.part)


def test_a_seed_without_a_number_is_left_out_where_most_have_one():
    def trial(*advances):
        pairs = [RunPair(flow(4.0, advance=one), flow(4.0, advance=one)) for one in advances]
        value = partial(fig16._ratio, name="advance", grains=ALL)
        return _avalanche.together(value)("advance", {}, pairs, Band(0.0, 1.0, "-", "shorter")).found

    assert trial(1.0, math.nan, 2.0).n == 2
    assert math.isnan(trial(1.0, math.nan, math.nan).value)


def test_choices_are_those_that_experiments_share():
    for experiment in (fig14, fig15, fig16):
        for one in experiment.judge(made(flow_at(5.0), flow_at(4.0)), STANDARD):
            assert {ROTATION, PHI, SLIP} <= set(one.trials[0].choices)
            first = {**SHIPPED, _avalanche.WINDOW: _avalanche.FIRST}
            assert first.items() <= one.trials[0].choices.items()


@pytest.mark.slow
def test_the_shipped_pair_flows_and_is_drawn(tmp_path):
    names = ("fig12_avalanche", "fig14", "fig15", "fig16")
    campaign = carry_out({name: load(name).tasks(QUICK) for name in names}, load, tmp_path)
    assert not campaign.problems
    for name, experiment in zip(names, (fig12_avalanche, fig14, fig15, fig16), strict=True):
        found = campaign.found[name]
        assert experiment.draw(found, QUICK)
        assert experiment.rows(found, QUICK)
        assert experiment.judge(found, QUICK)
    pair = _avalanche.pairs(campaign.found["fig14"], QUICK, SHIPPED, _avalanche.FIRST)[0]
    assert pair.slower > 1.0
