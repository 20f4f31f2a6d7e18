"""Grains in a row judged from results made up: what differs between row and column shows."""

import numpy as np
import pytest

from ryusa.study import CaseRun, Level, Outcome, Plan
from ryusa_studies.validation import river_grains

PLAN = Plan(Level.FULL, (1,))
Z = np.linspace(0.0, 0.02, 20)


def results(of_row=1.0, scatter=0.01, w=1.0, moved=1e-5):
    """Means that scatter between seeds, in the row multiplied by a number; and two beds."""
    rng = np.random.default_rng(5)
    found = {}
    for task in river_grains.tasks(PLAN):
        if isinstance(task, CaseRun):
            found[task] = {"z": Z, "w": w + 0.0 * Z, "inside": np.array(w), "ergun": np.array(1.0)}
            found[task] |= {"moved": np.array(moved), "moving": np.array(3), "median": np.array(1e-6)}
            continue
        factor = of_row if dict(task.arguments)["segments"] > 1 else 1.0
        means = {name: factor + scatter * rng.normal(size=1) for name in river_grains.REACH}
        found[task] = {"z": Z, "u": Z, "phi": Z, "residual": np.array(1e-12), **means}
    return found


@pytest.mark.parametrize(
    ("given", "reach", "bed"),
    [
        ({}, Outcome.HOLDS, Outcome.HOLDS),
        ({"of_row": 1.1}, Outcome.FAILS, Outcome.HOLDS),
        ({"scatter": 0.3}, Outcome.FAILS, Outcome.HOLDS),  # it would say nothing
        ({"w": 0.96}, Outcome.HOLDS, Outcome.FAILS),
        ({"moved": 0.01}, Outcome.HOLDS, Outcome.FAILS),
    ],
)
def test_a_row_is_judged_by_its_scatter_and_a_bed_by_ergun_and_rest(given, reach, bed):
    one, other = river_grains.judge(results(**given), PLAN)
    assert (one.outcome, other.outcome) == (reach, bed)


def test_grains_in_a_row_are_left_to_the_full_level():
    for level in (Level.QUICK, Level.STANDARD):
        assert river_grains.tasks(Plan(level, (1,))) == river_grains.judge({}, Plan(level, (1,))) == []
