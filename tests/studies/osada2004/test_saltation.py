"""The saltation claims, judged on made-up numbers: some under which each holds, some under which it fails."""

from dataclasses import replace

import numpy as np
import pytest

from ryusa.figures.saltation import SpinPath
from ryusa.measure import ContactTimes, Saltation, Tracks, average
from ryusa.measure.table import Averages
from ryusa.studies.osada2004 import _saltation, fig07, fig20, fig21, hops, spin_time
from ryusa.studies.osada2004._parts import PHI, SLIP
from ryusa.studies.osada2004._saltation import K_N, SHIPPED, SaltationRun
from ryusa.studies.osada2004.study import load
from ryusa.study import Level, Outcome, Plan, carry_out

STANDARD = Plan(Level.STANDARD, (1, 2, 3))
FULL = Plan(Level.FULL, (1, 2, 3))
EMPTY = np.zeros(0)
PATH = Tracks((0,), *10 * [EMPTY], 0.04)
BASE = {
    "contact_time": 1e-4, "contact_time_over_eq8": 1.0, "jump_height": 0.003, "jump_length": 0.04,
    "speed": 0.6, "bed_shear": 1.0, "impulse_shear": 1.0, "shear_ratio": 1.0, "bed_normal": 1.0,
    "spin_before": 0.0,
}  # fmt: skip


def made_up(highest=0.006, **changed):
    """Hops with the averages of BASE, some of them changed."""
    items = tuple(average(name, "-", [[value, value]]) for name, value in {**BASE, **changed}.items())
    times = ContactTimes(1.0e-4, 1.09e-4, 1.01e-4)
    found = Saltation(EMPTY, EMPTY, EMPTY, times, 0.1, Averages("saltation", items, ()))
    return SaltationRun(found, PATH, 0.002, 0.005, highest, np.array([0.1]), np.array([0.9]))


def scatter(one):
    """A little chance, from the seed."""
    return 1.0 + 0.002 * (int(one.get("seed")) - 2)


def stiffness(one):
    return float(one.get("contact.stiffness", "100 N/cm").split()[0])


def judged(module, make, plan=STANDARD):
    found = {one: make(one) for one in module.tasks(plan)}
    return {one.id: one for one in module.judge(found, plan)}


def test_fig7_holds_only_for_stiffnesses_whose_contact_times_are_those_of_eq_8():
    def make(one):
        share = 0.99 if stiffness(one) >= 3.0 else 0.7
        return fig07.Point(made_up(contact_time_over_eq8=share * scatter(one)), None)

    found = judged(fig07, make)["fig7"]
    assert 0 < found.robustness.holds < found.robustness.of


def test_fig7_fails_where_no_contact_time_is_that_of_eq_8():
    found = judged(fig07, lambda one: fig07.Point(made_up(contact_time_over_eq8=1.3 * scatter(one)), None))
    assert found["fig7"].outcome is Outcome.FAILS


@pytest.mark.parametrize(("change", "word"), [(0.99, Outcome.HOLDS), (0.9, Outcome.FAILS)])
def test_spin_time_requires_the_same_time_locked_and_free(change, word):
    def make(one):
        share = change if one.get("motion.rotation") == "free" else 1.0
        return made_up(contact_time=1e-4 * share * scatter(one))

    assert judged(spin_time, make)["spin-time"].outcome is word


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


def test_fig20_compares_free_with_locked_under_the_same_choices():
    def make(one):
        free = one.get("motion.rotation") == "free"
        weak = one.get("contact.slip") == "total" and one.get("contact.friction_angle") == "10 deg"
        shear = (0.5 if weak else 0.2) if free else 1.0
        changed = {name: shear * scatter(one) for name in ("bed_shear", "impulse_shear", "shear_ratio")}
        high, far = (0.009, 0.03) if free else (0.003, 0.04)
        return fig20.Both(made_up(jump_height=high, jump_length=far, **changed), {})

    found = judged(fig20, make)
    assert 0 < found["fig20-shear"].robustness.holds < found["fig20-shear"].robustness.of
    assert found["fig20"].outcome is Outcome.FAILS  # higher, but not longer
    assert {trial.choices[PHI] for trial in found["fig20"].trials} >= {"10 deg", "30 deg"}


def test_full_fig20_varies_each_free_choice_and_the_definition_of_a_hop():
    made = {one.get("motion.rotation"): made_up() for one in fig20.tasks(FULL)}
    labels = {name: made_up().found.averages for name in fig20.RISES}
    found = judged(fig20, lambda one: fig20.Both(made[one.get("motion.rotation")], labels), FULL)
    others = {trial.choices[fig20.OTHER] for trial in found["fig20"].trials}
    assert others == {fig20.AS_SHIPPED, *fig20.OTHERS, *fig20.RISES}


def spun(mean, gains, torque="none"):
    against = {"rolling": 0.9, "water_turn": 20.0, "beyond_dennis": 0.0}
    gains = tuple(np.array(one) for one in gains)
    return fig21.Spun(made_up(), mean, mean, gains, against, SpinPath(torque, EMPTY, EMPTY))


GROWING = [[300.0, 300.0, 300.0, -50.0, 50.0, -50.0]] * 8
AT_ONCE = [[1000.0, -100.0, 100.0, -100.0, 100.0, -100.0]] * 8


def test_fig21_holds_while_it_spins_up_for_grains_that_gain_at_each_of_their_first_hits():
    def make(one):
        weak = one.get("contact.slip") == "total"
        return spun(900.0 * scatter(one), GROWING if weak else AT_ONCE)

    found = judged(fig21, make)["fig21"]
    assert 0 < found.robustness.holds < found.robustness.of


def test_fig21_fails_at_another_level_even_where_spin_grows():
    found = judged(fig21, lambda one: spun(500.0 * scatter(one), GROWING))
    assert found["fig21"].outcome is Outcome.FAILS


def test_the_water_removes_a_share_of_the_spin_in_excess_of_its_rotation():
    made = {one: spun(220.0 if one.get("water.torque") else 1020.0, AT_ONCE) for one in fig21.tasks(STANDARD)}
    assert fig21.removed(made, STANDARD, "Dennis") == pytest.approx([0.8, 0.8, 0.8])
    rows = fig21.rows(made, STANDARD)
    assert {row["water torque"] for row in rows} == {"none", "Stokes", "Dennis"}
    assert any("Dennis" in line for line in judged(fig21, made.__getitem__)["fig21"].also)


def test_the_shipped_stiffness_changes_nothing_in_the_case():
    assert _saltation.overrides({**SHIPPED, K_N: "100 N/cm"}) == {}
    assert _saltation.overrides({**SHIPPED, SLIP: "total", K_N: "1 N/cm"}) == {
        "contact.slip": "total",
        "contact.stiffness": "1 N/cm",
    }


@pytest.mark.slow
def test_the_saltation_experiments_run_and_draw_at_quick_level(tmp_path):
    plan = Plan(Level.QUICK, (1,))
    names = ("fig07", "spin_time", "hops", "fig20", "fig21")
    campaign = carry_out({name: load(name).tasks(plan) for name in names}, load, tmp_path)
    assert not campaign.problems
    for module in (fig07, spin_time, hops, fig20, fig21):
        found = campaign.found[module.__name__.rsplit(".", maxsplit=1)[-1]]
        assert all(np.isfinite(t.found.value) for one in module.judge(found, plan) for t in one.trials)
        assert module.rows(found, plan)
        assert module.draw(found, plan)
    assert replace(found[fig21.tasks(plan)[0]]).mean > 0.0
