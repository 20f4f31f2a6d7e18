"""The movable bed: rods of locked grains, spin of free ones."""

import math
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from ryusa.measure import Averages, Rods
from ryusa.study import Level, Outcome, Plan, carry_out
from ryusa.study.registration import Registration
from ryusa_studies.osada2004 import _debris, fig22, fig22_free
from ryusa_studies.osada2004._movable_bed import MovableBedRun
from ryusa_studies.osada2004.fig22 import FREE, LOCKED, SLOPE
from ryusa_studies.osada2004.study import load

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1, 2, 3, 4))


def bed(share, q=1e-4, speed=0.1, spin=0.0, movers=100, null=0.02):
    """A run with so large a share of its movers in rods of three."""
    n = round(share * movers)
    found = Rods(
        begin=np.zeros(1), movers=np.array([movers]), touching=np.array([movers]), bound=np.array([n]),
        lengths=np.array([0, 0, 0, n // 3]), null=np.array([null * movers]), longest=None, window=0.07,
        averages=Averages("rods", (), ()),
    )  # fmt: skip
    v = np.full(movers, speed)
    return MovableBedRun(rods=found, q=q, v=v, spin=np.full(movers, spin), profile=None, followed=())  # type: ignore[arg-type]


def rotation(one):
    return one.get("timeline.1.rotation", LOCKED)


def resisted(one):
    return one.get("rolling.model") != "" or one.get("water.torque") != ""


def judged(module, plan, of):
    found = {one: of(one) for one in module.tasks(plan)}
    (finding,) = module.judge(found, plan)
    return finding


def as_told(one):
    return bed(0.6) if rotation(one) == LOCKED else bed(0.03)


def rolling(one):
    return bed(0.0, q=1e-4, speed=0.1) if resisted(one) else bed(0.0, q=2e-4, speed=0.15, spin=300.0)


@pytest.fixture(autouse=True)
def without_profile(monkeypatch):
    """Beds of this file have no profile, whose diameter the spin is set against."""
    monkeypatch.setattr(MovableBedRun, "rolling", 0.8)


@pytest.mark.parametrize("plan", [QUICK, STANDARD])
def test_rods_of_locked_grains_and_fast_spin_of_free_ones_agree_with_the_paper(plan):
    assert judged(fig22, plan, as_told).outcome is Outcome.HOLDS
    assert judged(fig22_free, plan, rolling).outcome is Outcome.HOLDS


@pytest.mark.parametrize(("module", "of"), [(fig22, as_told), (fig22_free, rolling)])
def test_every_setting_has_the_same_number_of_runs(module, of):
    finding = judged(module, STANDARD, of)
    assert {one.found.n for one in finding.trials} == {4}
    assert len(module.settings(STANDARD)) == 17
    assert finding.robustness.of == 17


@pytest.mark.parametrize(("module", "of"), [(fig22, as_told), (fig22_free, rolling)])
def test_nothing_is_judged_by_a_band_that_is_not_registered(module, of):
    folder = Path(fig22.__file__).with_name("registration")
    registered, finding = Registration.read(folder), judged(module, STANDARD, of)
    registered.check(finding)
    assert set(finding.trials[0].choices) == set(registered.claims[finding.id].factors)


@pytest.mark.parametrize("design", [_debris.DESIGN, fig22.DESIGN, fig22_free.DESIGN])
def test_no_choice_goes_along_with_another_throughout_the_settings(design):
    sets = design.settings(16)[1:]
    for (one, a), (other, b) in combinations(design.levels.items(), 2):
        cells = {(chosen[one], chosen[other]) for chosen in sets}
        assert len(cells) > max(len(a), len(b)), (one, other)


def test_rods_that_free_grains_form_too_disagree_with_the_paper():
    assert judged(fig22, STANDARD, lambda one: bed(0.6)).outcome is Outcome.FAILS


def test_rods_that_shuffled_paths_form_too_do_not_count():
    def of(one):
        return bed(0.6, null=0.58) if rotation(one) == LOCKED else bed(0.03)

    assert judged(fig22, STANDARD, of).outcome is Outcome.FAILS


def test_a_bed_that_stands_has_no_rods_says_so_and_decides_nothing():
    def of(one):
        stands = one.get("timeline.2.slope") == "1/10" and rotation(one) == LOCKED
        return bed(0.0, q=0.0, movers=0) if stands else as_told(one)

    finding = judged(fig22, STANDARD, of)
    flat = [one for one in finding.trials if one.choices[SLOPE].startswith("1/10")]
    assert {one.note for one in flat} == {fig22.STANDS}
    assert finding.robustness.undecided == len(flat) // 2 > 0
    assert (finding.robustness.holds, finding.robustness.of) == (17 - len(flat) // 2, 17)


def test_seeds_count_by_their_movers_and_an_interval_ends_at_what_a_share_can_be():
    def of(one):
        seed = int(one.get("seed"))
        if rotation(one) == FREE:
            return bed(0.0)
        return bed(1.0, movers=90) if seed == 1 else bed(0.0, movers=10, null=0.0)

    finding = judged(fig22, STANDARD, of)
    rods = next(one for one in finding.trials if one.part == fig22.PART_RODS)
    assert fig22._share([of(one) for one in fig22.tasks(STANDARD)[:4]]) == pytest.approx(90 / 120)
    assert -1.0 <= rods.found.low < rods.found.high <= 1.0


def test_free_grains_that_do_not_spin_or_change_nothing_disagree_with_the_paper():
    slow = judged(fig22_free, STANDARD, lambda one: bed(0.0, q=1e-4 if resisted(one) else 2e-4))
    same = judged(fig22_free, STANDARD, lambda one: bed(0.0, spin=300.0))
    assert slow.outcome is Outcome.FAILS
    assert same.outcome is Outcome.FAILS


def test_a_change_counts_whichever_way_it_goes_and_a_bed_that_stands_decides_nothing():
    def slower(one):
        return bed(0.0, q=2e-4, speed=0.15) if resisted(one) else bed(0.0, spin=300.0)

    assert judged(fig22_free, STANDARD, slower).outcome is Outcome.HOLDS
    stopped = judged(
        fig22_free,
        STANDARD,
        lambda one: bed(0.0, q=0.0, movers=0) if resisted(one) else bed(0.0, spin=300.0),
    )
    assert stopped.outcome is Outcome.HOLDS
    finding = judged(fig22_free, STANDARD, lambda one: bed(0.0, q=0.0, movers=0))
    assert finding.robustness.undecided == 17
    assert math.isnan(finding.trials[0].found.value)


@pytest.mark.slow
def test_the_real_scene_makes_rods_where_locked_and_none_where_free(tmp_path):
    names = ("fig22", "fig22_free")
    campaign = carry_out({name: load(name).tasks(QUICK) for name in names}, load, tmp_path)
    assert not campaign.problems
    found = campaign.found["fig22"]
    by_rotation = {rotation(one): run for one, run in found.items()}
    assert by_rotation[LOCKED].rods.share > by_rotation[LOCKED].rods.null_share + 0.1
    assert by_rotation[FREE].rods.share < 0.1
    assert set(fig22.draw(found, QUICK)) == {"fig22", "fig22-lengths", "fig22-profiles"}
    assert len(fig22.rows(found, QUICK)) == 2
    rolled = campaign.found["fig22_free"]
    assert set(fig22_free.draw(rolled, QUICK)) == {"fig22-free"}
    assert len(fig22_free.rows(rolled, QUICK)) == 2
