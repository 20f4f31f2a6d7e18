"""The movable bed: rods of locked grains, spin of free ones."""

import numpy as np
import pytest

from ryusa.measure import Averages, Rods
from ryusa.studies.osada2004 import fig22
from ryusa.studies.osada2004.fig22 import FREE, LOCKED, SLOPE, MovableBedRun
from ryusa.studies.osada2004.study import load
from ryusa.study import Level, Outcome, Plan, carry_out

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1, 2, 3))


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


def judged(plan, of):
    found = {one: of(one) for one in fig22.tasks(plan)}
    return {one.id: one for one in fig22.judge(found, plan)}


def as_told(one):
    return bed(0.6) if rotation(one) == LOCKED else bed(0.03, q=1e-3, speed=0.5, spin=300.0)


@pytest.fixture(autouse=True)
def without_profile(monkeypatch):
    """Beds of this file have no profile, whose diameter the spin is set against."""
    monkeypatch.setattr(MovableBedRun, "rolling", 0.8)


@pytest.mark.parametrize("plan", [QUICK, STANDARD])
def test_rods_of_locked_grains_and_fast_spin_of_free_ones_agree_with_the_paper(plan):
    found = judged(plan, as_told)
    assert {claim: one.outcome for claim, one in found.items()} == dict.fromkeys(fig22.CLAIMS, Outcome.HOLDS)


def test_rods_that_free_grains_form_too_disagree_with_the_paper():
    assert judged(STANDARD, lambda one: bed(0.6))["fig22"].outcome is Outcome.FAILS


def test_rods_that_shuffled_paths_form_too_do_not_count():
    def of(one):
        return bed(0.6, null=0.58) if rotation(one) == LOCKED else bed(0.03)

    assert judged(STANDARD, of)["fig22"].outcome is Outcome.FAILS


def test_a_bed_that_stands_has_no_rods_and_says_so():
    def of(one):
        stands = one.get("timeline.2.slope") == "1/10" and rotation(one) == LOCKED
        return bed(0.0, q=0.0, movers=0) if stands else as_told(one)

    finding = judged(STANDARD, of)["fig22"]
    assert 0 < finding.robustness.holds < finding.robustness.of
    assert {one.note for one in finding.trials if one.choices[SLOPE].startswith("1/10")} == {fig22.STANDS}


def test_free_grains_that_do_not_spin_or_move_like_locked_ones_disagree_with_the_paper():
    slow = judged(STANDARD, lambda one: bed(0.6) if rotation(one) == LOCKED else bed(0.0, q=1e-3, speed=0.5))
    same = judged(STANDARD, lambda one: bed(0.6) if rotation(one) == LOCKED else bed(0.0, spin=300.0))
    assert slow["fig22-free"].outcome is Outcome.FAILS
    assert same["fig22-free"].outcome is Outcome.FAILS


@pytest.mark.slow
def test_the_real_scene_makes_rods_where_locked_and_none_where_free(tmp_path):
    campaign = carry_out({name: load(name).tasks(QUICK) for name in ("fig22",)}, load, tmp_path)
    assert not campaign.problems
    found = campaign.found["fig22"]
    by_rotation = {rotation(one): run for one, run in found.items()}
    assert by_rotation[LOCKED].rods.share > by_rotation[LOCKED].rods.null_share + 0.1
    assert by_rotation[FREE].rods.share < 0.1
    assert set(fig22.draw(found, QUICK)) == {"fig22", "fig22-lengths", "fig22-free"}
    assert len(fig22.rows(found, QUICK)) == 2
