"""Slope of the deposit behind a dam, from a transport that is known; and the cases of its gate."""

import pytest

from ryusa.casefile import read
from ryusa.cases import case_path
from ryusa.study import Level, Plan
from ryusa_studies.validation import river_dam as dam


def test_the_slope_that_carries_a_known_transport_is_found() -> None:
    def q_s(slope: float, q: float) -> float:
        return 0.8 * slope**1.7 * q**1.2

    even = [(s, q, q_s(s, q), 0.02) for s, q in ((0.075, 0.028), (0.05, 0.031), (0.0625, 0.036))]
    for slope in (0.04, 0.06, 0.08):
        assert dam.slope_that_carries(even, 0.03, q_s(slope, 0.03)) == pytest.approx(slope)


@pytest.mark.parametrize("dams", dam.ALL, ids=lambda dams: dams.name)
def test_every_case_of_the_full_level_has_the_numbers_of_the_gate(dams: dam.Dams) -> None:
    tasks = dams.tasks()
    rates = list[float]()
    for one in tasks:
        folder = "" if one.case == dam.EVEN else "validation/"
        case = read(case_path(f"{folder}{one.case}.toml"), dict(one.overrides))
        assert case.grains.density == dam.DENSITY
        assert case.water is not None
        assert case.water.row is not None
        if one.case == dam.EVEN:
            continue
        row = case.water.row
        assert row.width == dam.WIDTH
        assert row.dams[0].height == dams.high
        assert row.dams[0].begin == dam.FACE
        assert row.upstream is not None
        assert row.upstream.discharge == (dams.discharge, "m2/s")
        assert case.motion.slope == pytest.approx(dam.BOTTOM)
        assert case.feeds[0].rate is not None
        rates.append(case.feeds[0].rate[0])
        assert case.stop.time is not None
        assert case.record.settle < case.stop.time
    assert rates == pytest.approx([share * dam.FEED for share in dams.shares], rel=1e-4)
    assert len(tasks) == len(dams.shares) + len(dams.beds)


def test_the_dams_belong_to_the_full_level_alone() -> None:
    assert len(dam.tasks(Plan(Level.FULL, (1,)))) == 11
    assert not dam.tasks(Plan(Level.STANDARD, (1,)))
