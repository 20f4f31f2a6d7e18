import math

import numpy as np
import pytest

from ryusa.study import Level, Outcome, Plan, carry_out
from ryusa_studies.osada2004 import bed18
from ryusa_studies.osada2004.bed18 import MOVING, REST, SETTLED, SLOPE, START, WITH, TiltedBedRun
from ryusa_studies.osada2004.study import load

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1, 2, 3, 4))
D, G = 0.002, 9.8


def flow(speed, seed=1):
    """A bed that moves after the tilt with a speed that depends on time [sqrt(g d)]."""
    t = 0.01 * np.arange(151)
    v = np.where(t > 0.3, [speed(one) for one in t], 0.0) * math.sqrt(G * D) * (1.0 + 0.01 * seed)
    x = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * 0.01)])
    return TiltedBedRun(t, v, x, D, G, None)


def synthetic(plan, speed):
    """What a campaign finds if speed(slope [deg], start, settled with friction, seed) gives the speed."""
    found = {}
    for one in bed18.tasks(plan):
        first, slope = (
            float(one.get(f"timeline.{k}.slope_angle", "21 deg").split(maxsplit=1)[0]) for k in (2, 3)
        )
        start, seed = MOVING if first != slope else REST, int(one.get("seed"))
        found[one] = flow(speed(slope, start, bool(one.get("contact.friction_angle")), seed), seed)
    return found


def judged(plan, speed):
    return bed18.judge(synthetic(plan, speed), plan)[0]


def steady(speed):
    return lambda t: speed


def test_a_bed_that_flows_at_every_slope_agrees_with_the_paper():
    finding = judged(STANDARD, lambda *_: steady(0.5))
    assert finding.outcome is Outcome.HOLDS
    assert (finding.robustness.holds, finding.robustness.of) == (17, 17)
    assert judged(QUICK, lambda *_: steady(0.5)).outcome is Outcome.UNDECIDED  # one run is no share


@pytest.mark.parametrize("speed", [0.0, 0.001])
def test_a_bed_that_stands_or_creeps_disagrees_with_the_paper(speed):
    assert judged(STANDARD, lambda *_: steady(speed)).outcome is Outcome.FAILS


def test_a_bed_whose_motion_decays_disagrees_with_the_paper():
    assert judged(STANDARD, lambda *_: lambda t: math.exp(-(t - 0.3) / 0.3)).outcome is Outcome.FAILS


def test_a_bed_that_flows_with_some_seeds_is_undecided():
    finding = judged(STANDARD, lambda slope, start, settled, seed: steady(0.5 if seed < 4 else 0.0))
    assert finding.base_outcome is Outcome.UNDECIDED
    assert finding.base[0].found.value == pytest.approx(0.75)
    assert finding.robustness.undecided == finding.robustness.of == 17


def test_the_start_that_decides_is_named():
    finding = judged(STANDARD, lambda slope, start, *_: steady(0.5 if start == MOVING else 0.0))
    assert finding.outcome is Outcome.ONLY_IF
    assert finding.condition.startswith("start once moving (8 of 8 settings, none of 9 others)")


def test_the_packing_that_decides_is_named_and_shown_over_the_slope():
    finding = judged(STANDARD, lambda slope, start, settled, seed: steady(0.5 if settled else 0.0))
    assert finding.outcome is Outcome.ONLY_IF
    assert finding.condition.startswith(f"{SETTLED} {WITH}")
    shown = {(one.choices[SETTLED], one.choices[SLOPE]): one.found.value for one in finding.beside}
    assert shown["with friction", "19 deg"] == 1.0
    assert shown["without friction", "25 deg"] == 0.0
    assert not any(one.judged for one in finding.beside)


def test_every_setting_has_the_same_number_of_runs():
    finding = judged(STANDARD, lambda *_: steady(0.5))
    assert len(finding.trials) == 17
    assert {one.found.n for one in (*finding.trials, *finding.beside)} == {4}


def test_speed_is_the_displacement_at_the_end_of_the_run_over_time():
    one = flow(lambda t: 1.0 if t > 1.2 else 0.5, seed=0)
    assert one.speed() == pytest.approx(1.0, rel=0.02)
    assert one.speed(bed18.LAST) == pytest.approx(0.5, rel=0.05)
    assert one.most == pytest.approx(1.0)
    assert one.flows(0.9)
    assert not one.flows(1.1)


def test_a_bed_from_rest_is_tilted_once_and_one_that_moves_is_pushed_first():
    for one in bed18.settings(STANDARD):
        case = bed18._run(one, 1).read()
        first, then = (change.slope_angle for change in case.timeline[2:])
        assert math.degrees(then) == pytest.approx(float(one[SLOPE].split(maxsplit=1)[0]))
        assert math.degrees(first) == pytest.approx(30.0) if one[START] == MOVING else first == then
        settled = case.timeline[0].friction_angle if one[SETTLED] == WITH else 0.0
        assert case.contact.friction_angle == settled


@pytest.mark.slow
def test_the_bed_is_run_measured_judged_and_drawn(tmp_path):
    found = carry_out({name: load(name).tasks(QUICK) for name in ("bed18",)}, load, tmp_path).found["bed18"]
    (finding,) = bed18.judge(found, QUICK)
    assert finding.id == "bed18"
    assert len(bed18.rows(found, QUICK)) == 1
    assert set(bed18.draw(found, QUICK)) == {"bed18", "bed18-snapshot"}
