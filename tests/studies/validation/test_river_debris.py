"""Debris flows judged from results made up, and the foot of a deposit on lines that are known."""

import math

import numpy as np
import pytest
from tests.studies.validation.test_river_impact import front

from ryusa.laws.debris import discharge_over_bed, equilibrium_concentration, run_out
from ryusa.study import Level, Outcome, Plan
from ryusa_studies.validation import river_debris as debris
from ryusa_studies.validation import river_grids as grids
from ryusa_studies.validation import river_impact as impact

PLAN = Plan(Level.FULL, (1,))
X = (np.arange(76) + 0.5) * 0.025
T = np.linspace(0.0, 3.0, 31)
FRICTION = 0.6


def results(growth=1.0, way=1.0, held=(1.0, 0.5, 0.1), rise=(-1e-3, 1e-3), force=1.0):
    """What each run gives; every number as the formulae have it, but for the factors."""
    u, h, c = 0.9, 0.03, 0.35
    x_l, _ = run_out(u, h, c, debris.STEEP, debris.GENTLE, FRICTION, debris.RHO_S, debris.RHO_W, debris.G)
    c_eq = equilibrium_concentration(math.radians(debris.SLOPE), math.atan(FRICTION), 2650.0, 1000.0)
    found = {}
    for seed in debris.SEEDS:
        found[debris._friction(seed)] = {"friction": FRICTION}
        q = growth * discharge_over_bed(0.02, 0.2, 0.55)
        found[debris._bed(seed)] = {
            "t": T, "series": q + 0.0 * T, "q": np.array(q), "q_0": np.array(0.02), "c": np.array(0.2),
            "c_star": np.array(0.55), "first": np.array(1.0),
        }  # fmt: skip
        found[debris._feed(seed)] = {
            "t": T, "foot": way * x_l * np.minimum(T, 1.0), "came": np.array(0.5), "u": np.array(u),
            "h": np.array(h), "c": np.array(c), "grains": np.array(u), "behind": np.array(c),
        }  # fmt: skip
        for opening, share in zip(grids.OPENINGS, held, strict=True):
            found[grids.grid(seed, opening)] = {"t": T, "share": np.linspace(1.0, share, 31)}
        found |= {impact._run(speed, seed): front(force) for speed in impact.SPEEDS}
    for side, factor, speed in zip(debris.RATES, (0.5, 1.5), rise, strict=True):
        found[debris._mixture(side)] = {
            "t": T, "series": speed * T, "c_star": np.array(0.55), "c": np.array(factor * c_eq),
            "rise": np.array(speed),
        }  # fmt: skip
    return found


@pytest.mark.parametrize(
    ("given", "missed"),
    [
        ({}, set()),
        ({"growth": 1.25}, {"growth"}),
        ({"way": 0.65}, {"stop"}),
        ({"held": (1.0, 0.5, 0.3)}, {"grid"}),
        ({"held": (0.9, 1.0, 0.1)}, {"grid"}),  # a wider opening must not hold more
        ({"rise": (1e-3, 1e-3)}, {"sign"}),
        ({"rise": (-1e-3, -1e-3)}, {"sign"}),
        ({"force": 1.4}, {"front"}),
    ],
)
def test_each_flow_is_judged_by_its_own_formula(given, missed):
    made = debris.judge(results(**given), PLAN)
    assert {one.id for one in made if one.outcome is Outcome.FAILS} == missed
    assert {one.outcome for one in made if one.id not in missed} == {Outcome.HOLDS}


def test_debris_flows_are_left_to_the_full_level():
    for level in (Level.QUICK, Level.STANDARD):
        assert debris.tasks(Plan(level, (1,))) == debris.judge({}, Plan(level, (1,))) == []


def test_the_foot_of_a_deposit_is_that_of_what_hangs_together():
    thick = np.where(X < 1.1, 0.05 - 0.1 * (X - 0.7), 0.0)
    thick[60] = 0.03  # grains that have rolled ahead
    assert debris._foot(X, thick, 0.03) == pytest.approx(0.2, abs=1e-9)
    assert debris._foot(X, thick, 0.06) == 0.0
    assert debris._foot(X, thick + 1.0, 0.03) == pytest.approx(X[-1] - 0.7)


def test_bars_leave_the_same_opening_all_across():
    keys = dict(grids.grid(1, 2.0).overrides)
    assert float(keys["water.row.width"].split()[0]) == pytest.approx(2.0 * (2.0 * 9.6 + 8.0))
    first, second = (float(keys[f"walls.{k}.at"].split('"')[3].split()[0]) for k in (0, 1))
    assert second - first == pytest.approx(2.0 * 9.6 + 8.0)
    assert grids.grid(1, 2.0).read().build.kind == "stream"
