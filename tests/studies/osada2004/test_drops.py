from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from ryusa.casefile import derive, resolved
from ryusa.laws.collision import collision_time, overlap_max
from ryusa.study import Level, Outcome, Plan, carry_out
from ryusa.study.registration import Registration
from ryusa.units import quantity
from ryusa_studies.osada2004 import _drops, fig04, fig05, fig08, fig11, fig12, pair, steps
from ryusa_studies.osada2004._drops import DropRun, Setup
from ryusa_studies.osada2004._factors import n_settings
from ryusa_studies.osada2004.study import load

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1,))


def ideal(one, time=1.0, overlap=1.0, e=None, copies=20, ended=20):
    """A drop as the closed forms have it, or off by factors."""
    m = one.m / 2 if one.partner == "free" else one.m
    deep = overlap_max(quantity(one.speed, "m/s"), m, one.stiffness, one.zeta) / quantity(one.d, "m")
    eq_8 = collision_time(m, one.stiffness)
    each = np.ones(ended)
    return DropRun(
        d=quantity(one.d, "m"), k_n=one.stiffness, eq_8=eq_8, copies=copies, time=time * eq_8 * each,
        overlap=overlap * deep * each, speed=quantity(one.speed, "m/s") * each,
        e=(one.e if e is None else e) * each, passed=copies if overlap * deep > 1.0 else 0,
    )  # fmt: skip


def word(name, found, plan=QUICK):
    return {one.id: one.outcome for one in load(name).judge(found, plan)}[load(name).CLAIMS[0]]


def every(experiment, plan=QUICK, **how):
    return {one.task: ideal(one, **how) for one in experiment.setups(plan)}


def test_the_case_ships_as_the_base_drop_of_the_experiments():
    shipped, asked = (v.read() for v in (_drops.paper_run(_drops.CASE), Setup().task))
    assert derive(asked).dt == pytest.approx(derive(shipped).dt, rel=1e-6)
    assert asked.build.height == pytest.approx(shipped.build.height, rel=1e-2)
    assert asked.build.height_step * _drops.COPIES == pytest.approx(asked.build.height, rel=1e-3)
    assert asked.stop.time == pytest.approx(shipped.stop.time, rel=0.05)
    changed = {"build", "stop", "record", "time", "derived"}
    for name, section in resolved(asked).items():
        if name not in changed:
            assert section == resolved(shipped)[name], name


def test_a_setup_has_the_steps_and_stiffness_of_its_name():
    assert derive(Setup(steps=7.0).task.read()).steps_per_contact == pytest.approx(7.0)
    assert derive(Setup(steps=5.0, parting="tension").task.read()).steps_per_contact == pytest.approx(5.0)
    assert derive(Setup(d="20 cm", time="0.01 s").task.read()).fixed.t_undamped == pytest.approx(0.01)
    pair_of_one_dashpot = derive(Setup(partner="free", one_dashpot=True).task.read())
    assert pair_of_one_dashpot.fixed.e == pytest.approx(0.7)
    assert pair_of_one_dashpot.free.e < 0.65


def test_fig4_holds_for_eq_8_and_for_nothing_else():
    assert word("fig04", every(fig04)) is Outcome.HOLDS
    assert word("fig04", every(fig04, time=1.5)) is Outcome.FAILS
    stiff_is_slow = {
        one.task: ideal(one, time=1.0 if one.k_n == fig04.SOFT else 1.0e6 * one.k_n)
        for one in fig04.setups(QUICK)
    }
    assert word("fig04", stiff_is_slow) is Outcome.FAILS


def test_fig4_fails_where_the_weight_keeps_a_grain_on_its_partner():
    found = every(fig04)
    found[fig04.setup(fig04.DESIGN.base, "0.2 cm", fig04.SOFT).task] = ideal(
        fig04.lossless("0.2 cm", 0.01), ended=3
    )
    assert word("fig04", found) is Outcome.FAILS


def test_a_grain_passes_where_its_spring_cannot_stop_it_within_a_diameter():
    _, slow = fig08.judge(every(fig08) | hits(QUICK, 0.3, 0.0042), QUICK)
    _, limit = slow.base
    assert (limit.found.low, limit.found.high) == (0.001, 0.002)  # 0.0016 N/cm by the closed form
    assert slow.outcome is Outcome.FAILS
    _, deep = fig08.judge(every(fig08, overlap=10.0) | hits(QUICK, 0.3, 0.0042), QUICK)
    assert (deep.base[1].found.low, deep.base[1].found.high) == (0.1, 0.2)
    assert deep.outcome is Outcome.HOLDS
    _, never = fig08.judge(every(fig08, overlap=0.1) | hits(QUICK, 0.3, 0.0042), QUICK)
    assert never.base[1].holds is False


REGISTRATION = Registration.read(Path(fig04.__file__).parent / "registration")


@pytest.mark.parametrize("part", [fig04, fig05, pair, fig08, steps])
@pytest.mark.parametrize("plan", [QUICK, STANDARD])
def test_every_setting_is_judged_by_the_same_registered_bands(part, plan):
    found = every(part, plan) | (hits(plan, 0.3, 0.0042) if part is fig08 else {})
    for finding in part.judge(found, plan):
        REGISTRATION.check(finding)
        claim = REGISTRATION.claims[finding.id]
        assert sorted(claim.factors) == sorted(part.DESIGN.base)
        per_setting = Counter(tuple(one.choices.items()) for one in finding.trials)
        assert len(set(per_setting.values())) == 1
        assert len(per_setting) == len(part.DESIGN.settings(n_settings(plan)))


def test_fig5_fails_where_the_time_differs_or_the_grain_stays():
    assert word("fig05", every(fig05, time=0.93)) is Outcome.HOLDS
    assert word("fig05", every(fig05, time=1.3)) is Outcome.FAILS
    stays = every(fig05, time=0.93)
    stays[fig05.setup(fig05.choices(QUICK)[0], 0.1).task] = ideal(Setup(k_n=0.1), ended=7)
    (found,) = fig05.judge(stays, QUICK)
    assert found.outcome is Outcome.FAILS
    assert "0.1 N/cm" in found.trials[0].note


def test_half_the_mass_differs_too_much_from_the_whole():
    assert word("pair", every(pair)) is Outcome.FAILS
    alike = {
        one.task: ideal(one, time=2**0.5 if one.partner == "free" else 1.0) for one in pair.setups(QUICK)
    }
    assert word("pair", alike) is Outcome.HOLDS


def hits(plan, speed, overlap):
    return {one: fig08.Hits(np.full(9, speed), np.full(9, overlap)) for one in fig08.saltating(plan)}


def test_fig8_needs_a_harder_hit_than_a_saltating_grain_gives():
    soft = hits(QUICK, 0.3, 0.0042)
    found, _ = fig08.judge(every(fig08) | soft, QUICK)
    assert found.outcome is Outcome.FAILS
    assert "requires 0.72 m/s" in found.decided_by
    assert word("fig08", every(fig08, overlap=2.4) | soft) is Outcome.HOLDS
    assert word("fig08", every(fig08, overlap=2.4) | hits(QUICK, 0.72, 0.01)) is Outcome.HOLDS
    swept, _ = fig08.judge(every(fig08, STANDARD) | hits(STANDARD, 0.3, 0.0042), STANDARD)
    assert 0 < swept.robustness.holds < swept.robustness.of


def test_fig11_holds_between_a_soft_and_a_hard_hit():
    assert word("fig11", every(fig11)) is Outcome.HOLDS
    assert word("fig11", every(fig11, overlap=5.0)) is Outcome.FAILS
    (swept,) = fig11.judge(every(fig11, STANDARD), STANDARD)
    assert 0 < swept.robustness.holds < swept.robustness.of


def test_the_band_of_the_runs_is_that_of_the_closed_form():
    found = every(fig11, STANDARD)
    springs = fig08.stiffnesses(STANDARD)
    edges = fig11.band(_drops.SIZES, springs, _drops.SPEED, found)
    for d, k in zip(_drops.SIZES, edges.k_low, strict=True):
        assert Setup(d=d, k_n=k / 100.0).deepest == pytest.approx(0.01, rel=1e-6)


@pytest.mark.parametrize("plan", [QUICK, STANDARD])
def test_two_times_that_differ_by_100_do_not_fit_a_band_of_10(plan):
    (found,) = fig12.judge(every(fig12, plan), plan)
    assert found.outcome is Outcome.EXCLUDED
    assert "100" in found.contradiction


def test_fig12_would_hold_if_overlaps_were_alike():
    alike = every(fig12)
    for one in fig12.setups(QUICK)[:2]:
        alike[one.task] = ideal(one, overlap=0.005 / one.deepest)
    assert word("fig12", alike) is Outcome.HOLDS


def test_the_rule_of_ten_steps_is_tested_on_both_sides_of_ten():
    always_right = every(steps)
    (found,) = steps.judge(always_right, QUICK)
    assert [one.holds for one in found.base] == [True, False]
    off_below = {one.task: ideal(one, e=0.8 if one.steps < 10 else 0.72) for one in steps.setups(QUICK)}
    (found,) = steps.judge(off_below, QUICK)
    assert [one.holds for one in found.base] == [True, True]
    off_at_ten = {one.task: ideal(one, e=0.8) for one in steps.setups(QUICK)}
    (found,) = steps.judge(off_at_ten, QUICK)
    assert [one.holds for one in found.base] == [False, True]


@pytest.mark.parametrize("parting", ["no tension", "tension"])
@pytest.mark.parametrize("summed", [False, True])
def test_forward_differences_approach_the_restitution_with_small_steps(parting, summed):
    errors = [np.abs(steps.forward(n, parting, summed) - 0.7).max() for n in (200, 400, 800)]
    assert errors[2] < 0.01
    assert errors[0] > 1.5 * errors[1] > 2.25 * errors[2]


def test_forward_differences_gain_energy_at_ten_steps():
    assert steps.forward(10, "tension", summed=False).min() > 1.0
    assert steps.forward(10, "no tension", summed=False).min() > 1.0
    assert steps.forward(20, "tension", summed=False).max() < 1.0  # beyond pi/(2 zeta), which is 14


@pytest.mark.full
def test_the_runs_of_steps_keep_restitution_at_ten_and_lose_it_at_five(tmp_path):
    campaign = carry_out({name: load(name).tasks(QUICK) for name in ("steps",)}, load, tmp_path)
    assert not campaign.problems
    found = campaign.found["steps"]
    at = {one.steps: found[one.task] for one in steps.setups(QUICK)}
    assert all(one.parts for one in at.values())
    assert np.abs(at[10.0].e - 0.7).max() < 0.03
    assert np.abs(at[5.0].e - 0.7).max() > 0.05
    assert np.abs(at[50.0].time / at[50.0].eq_8 - 0.929).max() < 5e-3
    assert np.ptp(at[50.0].e) > 0.0  # the copies touch at different phases
    for picture in steps.draw(found, QUICK).values():
        picture.canvas.draw()


def test_a_run_on_a_very_weak_spring_passes_and_one_on_a_firm_spring_does_not(tmp_path):
    drops = [
        Setup(k_n=0.001),
        Setup(k_n=0.02),
        Setup(k_n=0.02, speed="2 m/s"),
        Setup(k_n=100.0, speed="2 m/s"),
    ]
    slow = Setup(k_n=0.001, speed="0.1 m/s")  # falls on faster than it hits
    campaign = carry_out({"fig08": [one.task for one in [*drops, slow]]}, load, tmp_path)
    assert not campaign.problems
    assert [campaign.found["fig08"][one.task].passed for one in drops] == [20, 0, 20, 0]
