"""Signs of a dam break over a loose bed on waves that are known, and the case of its gate."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.study import Level, Outcome, Plan
from ryusa_studies.validation import river_dam_break as over_bed

PLAN = Plan(Level.FULL, (1,))
X = (np.arange(140) + 0.5) * 0.0125
T = np.arange(26) * 0.0202
C = math.sqrt(over_bed.G * over_bed.DEEP)
FLAT = np.full(len(X), over_bed.BED)
NEAR = np.abs(X - over_bed.GATE) < over_bed.DEEP


def fixed():
    """Surface of Ritter's wave over a rigid bed, (n_frame, n_segment)."""
    return over_bed.BED + np.stack(
        [over_bed.ritter(X - over_bed.GATE, max(t, 1e-9), over_bed.DEEP) for t in T]
    )


def results(scoured=2.0, bump=0.02, at_front=0.3, at_gate=0.1, up_to=1.0):
    """What a run gives whose wave is that of Ritter but for the signs."""
    surface, bed = fixed(), np.tile(FLAT, (len(T), 1))
    surface[-1, np.argmin(np.abs(X - 0.7)) + np.array([-1, 0, 1])] += bump
    bed[-1, NEAR] -= scoured * over_bed.D
    held = np.where(X < 0.9, at_gate, at_front)
    return {
        "t": T, "x": X, "surface": surface, "bed": bed, "rest": FLAT, "concentration": held,
        "highest": FLAT + up_to * np.maximum(surface[-1] - FLAT, 0.0),
    }  # fmt: skip


def verdicts(**given):
    """Whether each sign shows where one seed of two has it as given, by its band."""
    one, other = over_bed.SEEDS
    found = {over_bed.dam_break(one): results(), over_bed.dam_break(other): results(**given)}
    (finding,) = over_bed.judge(found, PLAN)
    return finding.outcome, [trial.holds for trial in finding.trials if trial.judged]


@pytest.mark.parametrize(
    ("given", "missed"),
    [
        ({}, None),
        ({"scoured": 0.9}, 0),
        ({"bump": 0.0}, 1),
        ({"at_front": 0.05}, 2),
        ({"up_to": 0.8}, 3),
    ],
)
def test_each_sign_can_show_and_can_be_missed(given, missed):
    outcome, holds = verdicts(**given)
    assert holds == [k != missed for k in range(4)]
    assert outcome is (Outcome.HOLDS if missed is None else Outcome.FAILS)


def test_water_over_a_rigid_bed_shows_no_sign():
    surface = fixed()
    end, depth = over_bed.front(X, surface[-1]), surface[-1] - FLAT
    assert over_bed.scour(X, FLAT) == pytest.approx(0.0, abs=1e-12)
    assert over_bed.jump(T, X, surface) == pytest.approx(0.0, abs=1e-12)
    assert over_bed.lead(X, end, depth, 0.0 * X) == 0.0
    assert over_bed.reach(X, end, depth, 0.0 * X) == 0.0


def test_the_front_of_ritter_is_where_his_depth_is_one_diameter():
    surface = fixed()
    known = 2.0 - 3.0 * math.sqrt(over_bed.D / over_bed.DEEP)
    assert over_bed.front(X, surface[-1]) == pytest.approx(over_bed.GATE + known * C * T[-1], abs=2e-3)
    assert over_bed.speed(T, X, surface) == pytest.approx(known, rel=0.01)
    assert math.isnan(over_bed.front(X, np.where(X < 1.65, 0.1, 0.06)))


def test_a_wave_that_reaches_the_bed_of_reference_misses_what_needs_its_front():
    far = results()
    far["surface"] = far["surface"] + np.where(X < 1.65, 0.05, 0.0)
    found = {over_bed.dam_break(seed): far for seed in over_bed.SEEDS}
    (finding,) = over_bed.judge(found, PLAN)
    assert [trial.holds for trial in finding.trials if trial.judged] == [True, False, False, False]


@pytest.mark.parametrize(("place", "frame", "rise"), [(0.7, -1, 0.3), (1.0, -1, 0.0), (0.7, 5, 0.0)])
def test_a_rise_counts_near_the_gate_and_late(place, frame, rise):
    surface = fixed()
    first = int(np.argmin(np.abs(X - place)))
    surface[frame, first : first + 5] = surface[frame, first - 1] + 0.03
    assert over_bed.jump(T, X, surface) == pytest.approx(rise, abs=0.03)  # means of three segments


def test_the_highest_moving_grain_is_that_faster_than_a_grain_at_rest(monkeypatch):
    row = SimpleNamespace(x_low=0.0, dx=0.1, n_segment=3)
    found = SimpleNamespace(t=np.array([0.0]), row=SimpleNamespace(**vars(row), x=X), surface=0.0)
    run = SimpleNamespace(
        frames=SimpleNamespace(
            x=[np.array([[0.05, 0.0, 0.02], [0.06, 0.0, 0.05], [0.25, 0.0, 0.03], [0.31, 0.0, 0.01]])],
            v=[np.array([[0.3, 0.0, 0.0], [0.1, 0.0, 0.1], [0.0, 0.0, -0.3], [0.3, 0.0, 0.0]])],
        ),
        scene=SimpleNamespace(d=np.full(4, 0.004)),
    )
    monkeypatch.setattr(over_bed, "row_of", lambda run: found)
    monkeypatch.setattr(over_bed, "bed_line", lambda *given: 0.0)
    monkeypatch.setattr(
        over_bed, "long_section", lambda run, bed: SimpleNamespace(bed=0.0, concentration=0.0)
    )
    assert over_bed.profiles(run)["highest"] == pytest.approx([0.022, 0.0, 0.032])


def test_the_case_has_the_numbers_of_the_gate():
    case = read(case_path(f"validation/{over_bed.CASE}.toml"))
    row = case.water.row
    assert case.grains.diameter == over_bed.D
    assert row.surface == (
        (0.0, over_bed.BED + over_bed.DEEP), (over_bed.GATE, over_bed.BED + over_bed.DEEP),
        (over_bed.GATE, over_bed.BED), (over_bed.END, over_bed.BED),
    )  # fmt: skip
    assert (case.build.bed, row.bottom[-1]) == (over_bed.BED, (over_bed.END, 0.0))
    assert case.stop.time == pytest.approx(5.0 * over_bed.T_0, rel=1e-3)
    assert over_bed.GATE + 2.0 * C * case.stop.time < over_bed.AHEAD[0]
    assert C * case.stop.time < over_bed.GATE
    loose = read(case_path(f"validation/{over_bed.CASE}.toml"), over_bed.SETTLING)
    assert {z for _, z in loose.water.row.surface} == {0.005}


def test_it_is_left_to_the_full_level():
    assert len(over_bed.tasks(PLAN)) == len(over_bed.SEEDS)
    for level in (Level.QUICK, Level.STANDARD):
        assert over_bed.tasks(Plan(level, (1,))) == over_bed.judge({}, Plan(level, (1,))) == []
