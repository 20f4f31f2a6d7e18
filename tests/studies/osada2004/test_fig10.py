import math
from dataclasses import replace

import numpy as np
import pytest

from ryusa.casefile import derive
from ryusa.measure import Vibration
from ryusa.study import Level, Outcome, Plan, carry_out
from ryusa_studies.osada2004 import fig10
from ryusa_studies.osada2004.fig10 import EULER, ONE_STEP, OURS, SOFT, STIFF, SUMMED, Fall
from ryusa_studies.osada2004.study import load

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1, 2, 3, 4))
GRAINS, D = 42, 0.002


def motion(moving, until=0.5, size=0.1 * D):
    """A vibration in which so many grains move by `size` in every window up to a time."""
    end = 0.01 * np.arange(1, 51)
    span = np.zeros((50, GRAINS))
    span[end <= until + 1e-9, :moving] = size
    return Vibration(
        np.arange(GRAINS), np.full(GRAINS, D), D, end - 0.01, end, 0.01, np.full(50, 50), span, span, span,
        np.zeros_like(span),
    )  # fmt: skip


def synthetic(plan, soft, stiff, other=lambda overlap: motion(0)):
    """What a campaign finds if every box of a kind moves alike."""
    found = {}
    for one in fig10.tasks(plan):
        asked = one.get("contact.stiffness", SOFT)
        moved = {SOFT: soft, STIFF: stiff}.get(asked)
        overlap = float(asked.split()[3].strip(",")) if moved is None else 0.02
        moved = other(overlap) if moved is None else moved
        found[one] = Fall(moved, overlap, None, None, dict.fromkeys((SUMMED, EULER, ONE_STEP), moved))
    return found


def words(found, plan):
    return {one.id: one.outcome for one in fig10.judge(found, plan)}


def test_half_of_the_soft_grains_vibrating_and_stiff_grains_at_rest_agree_with_the_paper():
    said = words(synthetic(STANDARD, motion(20), motion(GRAINS, 0.1)), STANDARD)
    assert set(said.values()) == {Outcome.HOLDS}
    said = words(synthetic(QUICK, motion(20), motion(GRAINS, 0.1)), QUICK)  # 42 grains of one run are too few
    assert said["fig10-soft"] is said["fig10-rule"] is Outcome.UNDECIDED
    assert said["fig10-stiff"] is Outcome.HOLDS


@pytest.mark.parametrize(("moving", "until"), [(0, 0.5), (GRAINS, 0.5), (20, 0.4)])
def test_soft_grains_all_at_rest_or_all_vibrating_disagree_with_the_paper(moving, until):
    said = words(synthetic(STANDARD, motion(moving, until), motion(0)), STANDARD)
    assert said["fig10-soft"] is Outcome.FAILS


@pytest.mark.parametrize("until", [0.2, 0.5])
def test_one_stiff_grain_that_moves_too_long_contradicts_the_paper(until):
    said = words(synthetic(STANDARD, motion(20), motion(1, until)), STANDARD)
    assert said["fig10-stiff"] is Outcome.FAILS


def test_motion_between_two_thresholds_makes_the_verdict_depend_on_the_threshold():
    found = synthetic(STANDARD, motion(20, size=5e-4 * D), motion(0))
    soft = next(one for one in fig10.judge(found, STANDARD) if one.id == "fig10-soft")
    assert soft.outcome is Outcome.ONLY_IF
    assert "0.00001 d to 0.0001 d" in soft.condition
    assert soft.base_outcome is Outcome.FAILS


def test_the_rule_fails_if_a_grain_of_each_box_vibrates_below_the_limit_and_not_above():
    below = synthetic(STANDARD, motion(20), motion(0), lambda overlap: motion(5 * int(overlap < 0.006)))
    above = synthetic(STANDARD, motion(20), motion(0), lambda overlap: motion(5 * int(overlap > 0.02)))
    assert words(below, STANDARD)["fig10-rule"] is Outcome.FAILS
    assert words(above, STANDARD)["fig10-rule"] is Outcome.HOLDS
    rule = next(one for one in fig10.judge(above, STANDARD) if one.id == "fig10-rule")
    shown = [one.found.value for one in rule.beside if one.choices[fig10.THRESHOLD] != "0.01 d"]
    assert shown == pytest.approx([5 / 42] * len(shown))
    assert not any(one.judged for one in rule.beside)


def test_a_run_that_reaches_the_limit_does_not_test_the_rule():
    found = synthetic(STANDARD, motion(20), motion(0))
    for one in fig10.tasks(STANDARD):
        if "grains.diameter" in dict(one.overrides):
            found[one] = replace(found[one], overlap=0.011)
    rule = next(one for one in fig10.judge(found, STANDARD) if one.id == "fig10-rule")
    assert rule.base_outcome is Outcome.UNDECIDED
    assert "4 of 4 runs" in rule.base[0].note


def test_every_setting_has_the_same_number_of_runs_and_the_scheme_that_it_asks_for():
    found = synthetic(STANDARD, motion(20), motion(0))
    for finding in fig10.judge(found, STANDARD):
        assert len(finding.trials) == 17
        assert {one.found.n for one in finding.trials} == {4}
    schemes = fig10._schemes()
    for one in fig10.settings(STANDARD):
        for k in (SOFT, STIFF):
            assert one[fig10.SCHEME] in schemes[fig10._run(one, k, 1)] | {OURS}


def test_other_diameters_fall_as_many_diameters_and_as_long_in_their_own_time():
    small, large = (
        fig10._other(fig10.OTHERS.base | {fig10.SIZE: size}, 1).read() for size in ("0.05 cm", "1 cm")
    )
    for one in (small, large):
        d = derive(one).d
        assert one.build.height == pytest.approx(fig10.FALL * d)
        assert one.stop.time / math.sqrt(d / 0.002) == pytest.approx(0.5001)
    shipped = fig10._run(fig10.DESIGN.base, SOFT, 1).read()
    assert shipped.build.height == pytest.approx(fig10.FALL * derive(shipped).d)


@pytest.mark.slow
def test_the_box_is_run_measured_judged_and_drawn(tmp_path):
    found = carry_out({name: load(name).tasks(QUICK) for name in ("fig10",)}, load, tmp_path).found["fig10"]
    assert {one.id for one in fig10.judge(found, QUICK)} == set(fig10.CLAIMS)
    assert {row["k_n"] for row in fig10.rows(found, QUICK)} == {SOFT, STIFF, "by overlap"}
    assert {"fig10a", "fig10b", "fig09-start"} <= set(fig10.draw(found, QUICK))
    one = found[fig10._run(fig10.DESIGN.base, SOFT, 1)]
    assert one.moved.end[-1] == pytest.approx(0.5, abs=1e-4)
