import math

import numpy as np
import pytest

from ryusa.studies.osada2004 import bed18
from ryusa.studies.osada2004.bed18 import MOVING, REST, SLOPE, START, TiltedBedRun
from ryusa.studies.osada2004.study import load
from ryusa.study import Level, Outcome, Plan, carry_out

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1, 2, 3))
D, G = 0.002, 9.8


def flow(speed, seed=1):
    """A bed that moves after the tilt with a speed that depends on time [sqrt(g d)]."""
    t = 0.01 * np.arange(151)
    v = np.where(t > 0.3, [speed(one) for one in t], 0.0) * math.sqrt(G * D) * (1.0 + 0.01 * seed)
    x = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * 0.01)])
    return TiltedBedRun(t, v, x, D, G, None)


def synthetic(plan, speed):
    """What a campaign finds if speed(slope [deg], start) gives the speed over time."""
    found = {}
    for one in bed18.tasks(plan):
        first, slope = (
            float(one.get(f"timeline.{k}.slope_angle", "21 deg").split(maxsplit=1)[0]) for k in (2, 3)
        )
        start = MOVING if first != slope else REST
        found[one] = flow(speed(slope, start), int(one.get("seed")))
    return found


def judged(plan, speed):
    return bed18.judge(synthetic(plan, speed), plan)[0]


@pytest.mark.parametrize("plan", [QUICK, STANDARD])
def test_a_bed_that_flows_at_every_slope_agrees_with_the_paper(plan):
    assert judged(plan, lambda slope, start: lambda t: 0.5).outcome is Outcome.HOLDS


@pytest.mark.parametrize("speed", [0.0, 0.001])
def test_a_bed_that_stands_or_creeps_disagrees_with_the_paper(speed):
    assert judged(STANDARD, lambda slope, start: lambda t: speed).outcome is Outcome.FAILS


def test_a_bed_whose_motion_decays_disagrees_with_the_paper():
    assert (
        judged(STANDARD, lambda slope, start: lambda t: math.exp(-(t - 0.3) / 0.3)).outcome is Outcome.FAILS
    )


def test_a_bed_that_flows_from_some_slope_on_gives_that_slope():
    finding = judged(
        STANDARD, lambda slope, start: lambda t: 0.5 if slope > (22 if start == REST else 20) else 0
    )
    assert 0 < finding.robustness.holds < finding.robustness.of
    found = synthetic(STANDARD, lambda slope, start: lambda t: 0.5 if slope > 22 else 0)
    assert bed18.flattest(found, STANDARD, REST) == 23.0
    assert bed18.flattest(found, STANDARD, MOVING) == 23.0


def test_speed_is_the_displacement_at_the_end_of_the_run_over_time():
    one = flow(lambda t: 1.0 if t > 1.2 else 0.5, seed=0)
    assert one.speed() == pytest.approx(1.0, rel=0.02)
    assert one.keeps == pytest.approx(2.0, rel=0.05)
    assert one.most == pytest.approx(1.0)


def test_a_bed_from_rest_is_tilted_once_and_one_that_moves_is_pushed_first():
    for one in bed18.settings(STANDARD):
        first, then = (change.slope_angle for change in bed18._run(one, 1).read().timeline[2:])
        assert math.degrees(then) == pytest.approx(float(one[SLOPE].split(maxsplit=1)[0]))
        assert math.degrees(first) == pytest.approx(30.0) if one[START] == MOVING else first == then


@pytest.mark.slow
def test_the_bed_is_run_measured_judged_and_drawn(tmp_path):
    found = carry_out({name: load(name).tasks(QUICK) for name in ("bed18",)}, load, tmp_path).found["bed18"]
    (finding,) = bed18.judge(found, QUICK)
    assert finding.id == "bed18"
    assert len(bed18.rows(found, QUICK)) == 1
    assert set(bed18.draw(found, QUICK)) == {"bed18", "bed18-snapshot"}
