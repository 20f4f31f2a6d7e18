"""The bore that a wall reflects, and the force of a front over it."""

import math

import numpy as np
import pytest

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.laws.bore import reflected_bore
from ryusa.study import Level, Plan
from ryusa_studies.validation import river_debris as debris
from ryusa_studies.validation import river_impact as impact


def front(share: float, end: float = 0.8) -> dict:
    """A front whose force is a share of that of the bore from 0.3 s on, half of it of grains."""
    u, h, c = 1.5, 0.03, 0.25
    t = np.arange(0.005, end, 0.01)
    force = 0.5 * 1412.5 * impact.G * reflected_bore(u, h, impact.G)[0] ** 2
    half = 0.5 * share * force * (t > 0.3)
    return {"u": np.array(u), "h": np.array(h), "c": np.array(c), "t": t, "grains": half, "water": half}


@pytest.mark.parametrize("share", [0.8, 1.0, 1.2])
def test_the_force_over_that_of_the_bore(share):
    found = impact.of_force(front(share))
    assert found["ratio"] == pytest.approx(share)
    assert found["peak"] == pytest.approx(share)
    still = 0.5 * 1412.5 * impact.G * 0.03**2
    assert found["drag"] == pytest.approx(found["mean"] * still / (1412.5 * 1.5**2 * 0.03))
    assert found["froude"] == pytest.approx(1.5 / math.sqrt(0.03 * impact.G))


def test_without_an_impact_or_its_window_there_is_no_ratio():
    assert math.isnan(impact.of_force(front(0.4))["ratio"])
    assert math.isnan(impact.of_force(front(1.0, end=0.5))["ratio"])


def test_the_water_alone_agrees_with_the_closed_form():
    finding = impact.of_bore({impact.alone(): impact.water_alone()})
    assert finding.outcome.name == "HOLDS"


def test_the_case_is_that_of_the_middle_speed():
    case, one = read(case_path("validation/front_on_dam.toml")), impact._run(1.5, 1).read()
    assert one.feeds == case.feeds
    assert one.water.row.upstream == case.water.row.upstream
    runs = [task for task in debris.tasks(Plan(Level.FULL, (1,))) if getattr(task, "case", "") == impact.CASE]
    assert len(runs) == len(impact.SEEDS) * len(impact.SPEEDS)
    assert debris.tasks(Plan(Level.STANDARD, (1,))) == []
