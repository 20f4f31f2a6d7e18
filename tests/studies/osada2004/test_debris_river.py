"""Open question i: what of known runs is judged, and what of a run is measured."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.study import Level, Outcome, Plan
from ryusa_studies.osada2004 import debris_river as part
from ryusa_studies.osada2004.study import REGISTRATION

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1, 2, 3, 4))
T = np.linspace(1.0, 20.0, 20)
KNOWN = part.River(400, 300, 0.006, 0.2, 0.1, T, np.linspace(20.0, 35.0, 20), 3.0)


def outcomes(plan, long=KNOWN, short=KNOWN):
    """Outcome of each claim for runs of known numbers with the long and with the short collision time."""
    runs = {one: short if part.SHORT in str(one.overrides) else long for one in part.tasks(plan)}
    found = part.judge(runs, plan)
    assert tuple(one.id for one in found) == part.CLAIMS
    return {one.id: one.base_outcome for one in found}


@pytest.mark.parametrize("plan", [QUICK, STANDARD], ids=["quick", "standard"])
def test_a_flow_that_comes_to_rest_alike_holds(plan):
    assert outcomes(plan) == dict.fromkeys(part.CLAIMS, Outcome.HOLDS)


@pytest.mark.parametrize(
    "known", [replace(KNOWN, at_rest=150), replace(KNOWN, overlap=0.02)], ids=["moves on", "deep overlaps"]
)
def test_a_flow_that_moves_on_or_overlaps_deeply_falls_short(known):
    assert outcomes(QUICK, known, known) == {
        "debris-river": Outcome.FAILS, "debris-river-time": Outcome.HOLDS
    }  # fmt: skip


@pytest.mark.parametrize(
    "short",
    [replace(KNOWN, at_rest=200), replace(KNOWN, front=np.linspace(20.0, 40.0, 20))],
    ids=["at rest", "way"],
)
def test_a_collision_time_that_matters_fails(short):
    assert outcomes(QUICK, short=short)["debris-river-time"] is Outcome.FAILS


@pytest.mark.parametrize(
    "short",
    [replace(KNOWN, at_rest=0), replace(KNOWN, front=np.full(20, math.nan))],
    ids=["none at rest", "no front"],
)
def test_where_nothing_comes_to_rest_the_row_says_so(short):
    runs = {
        part.run(part.settings(QUICK)[0], time, 1): known
        for time, known in ((part.LONG, KNOWN), (part.SHORT, short))
    }
    judged = part.judge(runs, QUICK)[1]
    assert judged.base_outcome is not Outcome.HOLDS
    assert part.NOTHING in [one.note for one in judged.trials]


def test_factors_are_the_registered_ones():
    assert set(REGISTRATION.claims["debris-river"].factors) == set(part.DESIGN.levels)
    short = [one for one in part.tasks(STANDARD) if part.SHORT in str(one.overrides)]
    assert len(short) == 4 and len(part.tasks(STANDARD)) == 4 * 17 + 4
    full = Plan(Level.FULL, (1,))
    assert all(one in part.settings(full) for one in part.paired(full))
    assert len(part.paired(STANDARD)) == 1 and not REGISTRATION.claims["debris-river-time"].factors


def test_grains_past_the_break_are_counted(monkeypatch):
    # of six grains: two above the break, one at rest past it, one moving past it, two have left
    x = np.array([[10.0, 0, 0], [24.9, 0, 0], [25.1, 0, 0], [30.0, 0, 0], 3 * [math.nan], 3 * [math.nan]])
    v = np.array([[0.0, 0, 0], [0.0, 0, 0], [0.1, 0, 0], [0.2, 0, 0], 3 * [math.nan], 3 * [math.nan]])
    contacts = np.zeros(3, [("overlap_max", "f8"), ("t_part", "f8")])
    contacts["overlap_max"], contacts["t_part"] = (
        (0.2, 0.002, 0.004),
        (0.5, 2.0, 3.0),
    )  # the first while settling
    run = SimpleNamespace(
        scene=SimpleNamespace(d_mean=0.2), case={"record": {"settle": 1.0}}, contacts=contacts,
        frames=SimpleNamespace(x=[x], v=[v]),
    )  # fmt: skip
    moving = SimpleNamespace(t=np.array([1.0, 2.0, 3.0, 4.0]), front=np.array([math.nan, 26.0, 28.0, 42.0]))
    monkeypatch.setattr(part, "front", lambda results: moving)
    found = part.measure(run, part.tasks(QUICK)[0])
    assert (found.past, found.at_rest) == (4, 1)
    assert found.share == 0.25
    assert found.overlap == pytest.approx(0.015)
    assert (found.below, found.above) == (0.0, 0.5)
    assert found.speed == pytest.approx(14.0)
    assert found.way == pytest.approx(17.0)
