"""The gate of a river that is fed by its reach, on beds that are known, and its case."""

import numpy as np
import pytest

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.study import Level, Outcome, Plan
from ryusa_studies.validation import river_feeder as feeder

PLAN = Plan(Level.FULL, (1,))
T = np.linspace(3.0, 10.0, 71)
Q_S, CORE = 7e-4, 0.58


def verdicts(kept=0.0, crossed=1.0, waiting=0.0, off=0.0):
    """Whether each number holds where the bed keeps a share of q_s, by its band."""
    rate = kept * Q_S / (CORE * (feeder.JUDGED[1] - feeder.JUDGED[0]))
    numbers = {
        "rate": rate, "core": CORE, "q_s": Q_S, "error": 1e-5, "crossed": crossed, "carried": 1.0,
        "due": 500.0, "waiting": waiting, "discharge": off,
    }  # fmt: skip
    got = {"t": T, "bed": 0.03 + rate * T} | {name: np.array(one) for name, one in numbers.items()}
    (finding,) = feeder.judge({feeder._task(): got}, PLAN)
    return finding.outcome, [trial.holds for trial in finding.trials if trial.judged]


@pytest.mark.parametrize(
    ("given", "missed"),
    [
        ({}, None),
        ({"kept": -0.2}, 0),
        ({"kept": 0.2}, 0),
        ({"crossed": 0.9}, 1),
        ({"waiting": 20.0}, 2),
        ({"off": 1e-6}, 3),
    ],
)
def test_each_number_can_hold_and_can_be_missed(given, missed):
    outcome, holds = verdicts(**given)
    assert [k for k, one in enumerate(holds) if not one] == ([] if missed is None else [missed])
    assert (outcome is Outcome.HOLDS) == (missed is None)


def test_reach_and_river_are_the_same_bed():
    one = read(case_path(f"{feeder.REACH}.toml"))
    other = read(case_path(f"{feeder.CASE}.toml"))
    assert (one.grains, one.contact, one.motion) == (other.grains, other.contact, other.motion)
    assert feeder.tasks(Plan(Level.STANDARD, (1,))) == []
    (task,) = feeder.tasks(PLAN)
    assert task.cost() == 460.0
