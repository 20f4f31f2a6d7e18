"""The saltation claims, judged on made-up numbers: some under which each holds, some under which it fails."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ryusa.measure import ContactTimes, Saltation, Tracks, average
from ryusa.measure.table import Averages
from ryusa.study import Level, Outcome, Plan, carry_out
from ryusa.study.registration import Registration
from ryusa_studies.osada2004 import _saltation, fig07, fig20, fig21, hops, spin_time, water_torque
from ryusa_studies.osada2004._parts import CLOSURE, DRAG, PARTING, PHI, RATIO, SLIP, START
from ryusa_studies.osada2004._saltation import K_N, NORMAL, SHIPPED, TANGENTIAL, SaltationRun
from ryusa_studies.osada2004.figures.saltation import SpinPath
from ryusa_studies.osada2004.study import load

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1, 2, 3, 4))
MODULES = (fig07, spin_time, hops, fig20, fig21, water_torque)
EMPTY = np.zeros(0)
PATH = Tracks((0,), *10 * [EMPTY], 0.04)
BASE = {
    "contact_time": 1e-4, "contact_time_over_eq8": 1.0, "jump_height": 0.003, "jump_length": 0.04,
    "speed": 0.6, "bed_shear": 1.0, "impulse_shear": 1.0, "impulse_normal": 1.0, "shear_ratio": 1.0,
    "bed_normal": 1.0, "bed_friction": 1.0, "impulse_friction": 1.0, "spin_before": 0.0,
}  # fmt: skip
FORCES = ("bed_shear", "impulse_shear", "shear_ratio")
FRICTIONS = ("bed_friction", "impulse_friction")


def made_up(highest=0.006, impact=1.7, spreads=(0.01, 0.01), **changed):
    """Hops with the averages of BASE, some of them changed."""
    items = tuple(average(name, "-", [[value, value]]) for name, value in {**BASE, **changed}.items())
    times = ContactTimes(1.0e-4, 1.09e-4, 1.01e-4)
    found = Saltation(EMPTY, EMPTY, EMPTY, times, 0.1, Averages("saltation", items, ()))
    both = dict(zip((TANGENTIAL, NORMAL), spreads, strict=True))
    return SaltationRun(
        found, PATH, 0.002, 0.005, highest, np.array([0.1]), np.array([0.9]), impact=impact, spreads=both
    )


def scatter(one):
    """A little chance, from the seed."""
    return 1.0 + 0.002 * (int(one.get("seed")) - 2)


def stiffness(one):
    return float(one.get("contact.stiffness", "100 N/cm").split()[0])


def is_free(one):
    return one.get("motion.rotation") == "free"


def judged(module, make, plan=STANDARD):
    found = {one: make(one) for one in module.tasks(plan)}
    return {one.id: one for one in module.judge(found, plan)}


def spun(mean, gains, torque="none"):
    against = {"rolling": 0.9, "water_turn": 20.0, "beyond_dennis": 0.0}
    gains = tuple(np.array(one) for one in gains)
    return fig21.Spun(mean, mean, gains, against, SpinPath(torque, EMPTY, EMPTY))


GROWING = [[300.0, 300.0, 300.0, -50.0, 50.0, -50.0]] * 8
AT_ONCE = [[1000.0, -100.0, 100.0, -100.0, 100.0, -100.0]] * 8


def any_run(module, one):
    """A run that a part accepts."""
    if module is fig07:
        return fig07.Point(made_up(contact_time_over_eq8=scatter(one)), None)
    if module is fig21:
        return spun(900.0 * scatter(one), GROWING)
    if module is water_torque:
        return water_torque.Turned(made_up(), spun(500.0 if one.get("water.torque") else 1000.0, GROWING))
    return made_up()


@pytest.mark.parametrize("module", MODULES)
def test_every_setting_has_the_same_number_of_runs_and_its_band_is_registered(module):
    registered = Registration.read(Path(fig07.__file__).with_name("registration"))
    findings = judged(module, lambda one: any_run(module, one))
    assert set(findings) == set(module.CLAIMS)
    for finding in findings.values():
        registered.check(finding)
        assert {one.found.n for one in finding.trials} == {4}
        assert set(finding.trials[0].choices) == set(registered.claims[finding.id].factors)
        shared = {tuple(one.choices[name] for name in SHIPPED) for one in finding.trials}
        assert len(shared) == 17


def test_the_settings_are_the_same_in_every_part_and_begin_with_the_case_as_it_ships():
    assert list(SHIPPED) == [PHI, SLIP, PARTING, RATIO, DRAG, CLOSURE, START]
    shared = _saltation.settings(STANDARD)
    assert shared[0] == SHIPPED
    for more in (fig07.settings(STANDARD), hops.settings(STANDARD), water_torque.settings(STANDARD)):
        assert [{name: one[name] for name in SHIPPED} for one in more] == shared
    drags = {one.get("water.drag") for one in fig21.tasks(STANDARD)}
    assert drags == {"", "24/Re+2", "Schiller-Naumann"}
    assert {one.get("build.start_speed") for one in fig21.tasks(STANDARD)} == {"", "0 m/s"}


def test_a_stiffness_is_compared_with_another_one():
    for one in hops.tasks(STANDARD):
        assert one.get("motion.rotation") == "locked"
    sets = hops.settings(STANDARD)
    assert sets[0][hops.AGAINST] == "1 N/cm"
    assert {one[hops.AGAINST] for one in sets} == {"1 N/cm", "10 N/cm", "1000 N/cm"}


def test_fig7_holds_only_for_stiffnesses_whose_contact_times_are_those_of_eq_8():
    def make(one):
        share = 0.99 if stiffness(one) >= 10.0 else 0.7
        return fig07.Point(made_up(contact_time_over_eq8=share * scatter(one)), None)

    found = judged(fig07, make)["fig7"]
    assert 0 < found.robustness.holds < found.robustness.of
    assert found.base_outcome is Outcome.HOLDS
    soft = {one.choices[K_N] for one in found.trials if one.holds is False}
    assert soft == {"1 N/cm"}


def test_fig7_fails_where_no_contact_time_is_that_of_eq_8():
    found = judged(fig07, lambda one: fig07.Point(made_up(contact_time_over_eq8=1.3 * scatter(one)), None))
    assert found["fig7"].outcome is Outcome.FAILS


@pytest.mark.parametrize(("change", "word"), [(0.99, Outcome.HOLDS), (0.9, Outcome.FAILS)])
def test_spin_time_requires_the_same_time_locked_and_free(change, word):
    def make(one):
        return made_up(contact_time=1e-4 * (change if is_free(one) else 1.0) * scatter(one))

    assert judged(spin_time, make)["spin-time"].outcome is word


@pytest.mark.parametrize(
    ("locked", "free", "word"),
    [(0.01, 0.3, Outcome.HOLDS), (0.01, 0.01, Outcome.FAILS), (0.3, 0.3, Outcome.FAILS)],
)
def test_restitution_is_to_be_unique_with_locked_grains_and_not_with_free_ones(locked, free, word):
    def make(one):
        return made_up(spreads=2 * ((free if is_free(one) else locked) * scatter(one),))

    assert judged(spin_time, make)["spin-e"].outcome is word


def test_normal_restitution_may_be_unique_where_the_tangential_one_is_not():
    def make(one):
        return made_up(spreads=((0.3 if is_free(one) else 0.01) * scatter(one), 0.01))

    found = judged(spin_time, make)["spin-e"]
    assert found.deciding is not None
    assert (found.deciding.choice, found.deciding.levels) == (spin_time.WHICH, (TANGENTIAL,))


def test_the_spread_of_a_normal_distribution_is_its_deviation():
    values = np.random.default_rng(1).normal(0.7, 0.1, 20_000)
    assert _saltation.spread(np.append(values, np.nan)) == pytest.approx(0.1, rel=0.03)
    assert np.isnan(_saltation.spread(np.array([np.nan])))


def test_the_scatter_of_grains_that_skim_does_not_widen_the_others():
    hop, skim = _saltation.pooled([[1.0, 1.01], [3.0, 5.0]], [False, True])
    assert hop.spread < 0.01
    assert skim.spread > 1.0


@pytest.mark.parametrize("changed", ["jump_height", "jump_length", "highest"])
def test_hops_fails_below_a_stiffness_if_one_of_its_three_parts_does(changed):
    def make(one):
        value = {**BASE, "highest": 0.006}[changed] * (0.7 if stiffness(one) < 10.0 else 1.0) * scatter(one)
        return made_up(**{changed: value})

    found = judged(hops, make)["hops"]
    assert 0 < found.robustness.holds < found.robustness.of
    assert judged(hops, lambda one: made_up())["hops"].outcome is Outcome.HOLDS


def test_the_impulse_of_a_contact_may_stay_where_that_of_a_bounce_does_not():
    def make(one):
        soft = stiffness(one) != 100.0
        return made_up(impact=1.7 * scatter(one), impulse_normal=(0.6 if soft else 1.0) * scatter(one))

    found = judged(hops, make)["hops-impulse"]
    assert found.base_outcome is Outcome.HOLDS
    assert (found.robustness.holds, found.robustness.of) == (17, 17)
    assert found.counts == {"holds": 17, "fails": 17, "undecided": 0}


def test_fig20_compares_free_with_locked_under_the_same_choices():
    def make(one):
        weak = one.get("contact.slip") == "total"
        shear = (0.5 if weak else 0.2) if is_free(one) else 1.0
        changed = {name: shear * scatter(one) for name in FORCES + FRICTIONS}
        high, far = (0.009, 0.03) if is_free(one) else (0.003, 0.04)
        return made_up(jump_height=high, jump_length=far, **changed)

    found = judged(fig20, make)
    assert 0 < found["fig20-shear"].robustness.holds < found["fig20-shear"].robustness.of
    assert found["fig20"].outcome is Outcome.FAILS  # higher, but not longer


def test_the_friction_force_alone_may_be_half_where_the_whole_impulse_is_not():
    def make(one):
        whole, friction = (0.9, 0.5) if is_free(one) else (1.0, 1.0)
        changed = {name: whole * scatter(one) for name in FORCES}
        return made_up(**changed, **{name: friction * scatter(one) for name in FRICTIONS})

    found = judged(fig20, make)["fig20-shear"]
    assert found.base_outcome is Outcome.FAILS
    assert found.deciding is not None
    assert found.deciding.choice == fig20.SHEAR
    assert all("friction force alone" in one for one in found.deciding.levels)


def test_fig21_holds_for_its_first_hits_if_a_grain_gains_at_each_of_them():
    def make(one):
        return spun(900.0 * scatter(one), GROWING if one.get("build.start_speed") == "0 m/s" else AT_ONCE)

    found = judged(fig21, make)["fig21"]
    assert found.base_outcome is Outcome.FAILS
    held = {(key[START], key[fig21.READING]) for key, here in _settings(found).items() if here}
    assert held == {(_saltation.RESTING, "first three hits")}


def _settings(finding):
    class Key(dict):
        __hash__ = object.__hash__

    return {Key(key): here for key, here in finding.by_choice.items()}


def test_fig21_fails_at_another_level_even_where_spin_grows():
    found = judged(fig21, lambda one: spun(500.0 * scatter(one), GROWING))
    assert found["fig21"].outcome is Outcome.FAILS


def test_the_interval_of_a_share_of_hits_does_not_leave_what_a_share_can_be():
    def make(one):
        gains = [[1.0, 1.0, 1.0 if int(one.get("seed")) > 1 else -1.0, 1.0]] * 8
        return spun(900.0, gains)

    found = judged(fig21, make)["fig21"]
    shares = [one.found for one in found.trials if one.part == fig21.PART_GROWS]
    assert all(0.0 <= one.low <= one.value <= one.high <= 1.0 for one in shares)
    assert any(one.high == 1.0 and one.low < 1.0 for one in shares)


def with_torque(left, shear=1.0):
    def make(one):
        wet = bool(one.get("water.torque"))
        made = made_up(**{name: shear if wet else 1.0 for name in FORCES + FRICTIONS})
        return water_torque.Turned(made, spun((left if wet else 1020.0) * scatter(one), AT_ONCE))

    return make


def test_the_water_removes_a_share_of_the_spin_in_excess_of_its_rotation():
    found = judged(water_torque, with_torque(220.0, shear=0.5))
    beyond, every = (
        [one for one in found["water-torque"].trials if one.choices[water_torque.EXCESS] == way]
        for way in (water_torque.VORTICITY, water_torque.ALL)
    )
    assert beyond[0].found.value == pytest.approx(0.8, rel=1e-3)
    assert every[0].found.value == pytest.approx(1.0 - 220.0 / 1020.0, rel=1e-3)
    assert {one.outcome for one in found.values()} == {Outcome.HOLDS}
    little = judged(water_torque, with_torque(720.0))
    assert little["water-torque"].outcome is Outcome.HOLDS
    assert little["water-torque-half"].outcome is Outcome.FAILS
    assert little["water-torque-shear"].outcome is Outcome.FAILS


def test_the_torque_of_the_water_is_varied_by_law_drag_and_reynolds_number():
    tasks = water_torque.tasks(STANDARD)
    assert {one.get("water.torque") for one in tasks} == {"", "Dennis", "Stokes"}
    wet = [one for one in tasks if one.get("water.torque")]
    assert {one.get("water.viscosity") for one in wet} == {"", "4e-6 m2/s", "2.5e-7 m2/s"}
    rows = water_torque.rows({one: any_run(water_torque, one) for one in tasks}, STANDARD)
    assert len(rows) == 3 * 17 * 4
    assert {row["water_torque"] for row in rows} == {"none", "Stokes", "Dennis"}


def test_the_shipped_setting_changes_nothing_in_the_physics_of_the_case():
    changed = dict(_saltation.run(SHIPPED, "locked", 1).overrides)
    assert set(changed) == {*_saltation.MANY, "motion.rotation", "seed"}
    soft = _saltation.run({**SHIPPED, K_N: "1 N/cm"}, "locked", 1)
    assert soft.get("contact.stiffness") == "1 N/cm"
    assert soft in fig07.tasks(STANDARD)


@pytest.mark.slow
def test_the_saltation_experiments_run_and_draw_at_quick_level(tmp_path):
    parts = {module.__name__.rsplit(".", maxsplit=1)[-1]: module for module in MODULES}
    campaign = carry_out({name: load(name).tasks(QUICK) for name in parts}, load, tmp_path)
    assert not campaign.problems
    for name, module in parts.items():
        found = campaign.found[name]
        assert all(np.isfinite(t.found.value) for one in module.judge(found, QUICK) for t in one.trials)
        assert module.rows(found, QUICK)
        assert module.draw(found, QUICK)
    assert replace(campaign.found["fig21"][fig21.tasks(QUICK)[0]]).mean > 0.0
