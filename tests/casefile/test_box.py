"""What a box of grains measures and costs."""

from collections.abc import Callable

import pytest

from ryusa.casefile import Case, derive, estimate, explain
from ryusa.casefile.builders.box import box_plan, hole
from ryusa.casefile.builders.schema import BoxSection
from ryusa.casefile.contact.speed import expected_speed
from ryusa.casefile.read import read
from ryusa.cases import case_path

CaseOf = Callable[..., Case]


def keys(**others: object) -> BoxSection:
    return BoxSection.model_validate({"kind": "box", "columns": 4, "layers": 3, **others})


def test_fixed_grains_are_counted_whole() -> None:
    plan = box_plan(keys(walls="grains", run_out="0.3 cm"), d=0.002, room=0.002, plane=True)
    assert (plan.n_wide, plan.n_floor, plan.n_deep) == (5, 5 + 2, 1)  # 4 x 1.1 d and 1.5 d, rounded up
    assert plan.wide == pytest.approx(0.010)
    assert plan.n_back == 5 + 2  # floor and 3 x 1.1 d, rounded up, and two to spare
    assert plan.n_gate == plan.n_back - 1  # the floor goes on beneath it
    assert plan.n_fixed == 7 + 7 + 6


def test_between_planes_the_width_is_that_of_the_lattice() -> None:
    plan = box_plan(keys(floor="plane"), d=0.002, room=0.0024, plane=True)
    assert plan.wide == pytest.approx(4 * 1.1 * 0.0024)
    assert plan.n_fixed == 0


def test_a_sheet_of_grains_has_holes_and_a_line_has_none() -> None:
    assert hole(keys(), plane=True) == 0.0
    assert hole(keys(), plane=False) == pytest.approx(0.4142, abs=1e-4)
    assert hole(keys(floor_height=1.0), plane=True) == pytest.approx(0.4142, abs=1e-4)
    assert hole(keys(floor="plane"), plane=False) == 0.0


def test_the_impact_speed_of_a_box_is_that_of_its_top_layer(case: CaseOf) -> None:
    low = case(build="{ kind = 'box', columns = 4, layers = 3 }")
    assert expected_speed(low)[1].startswith("fall through one diameter")
    high = case(build="{ kind = 'box', columns = 4, layers = 3, height = '1 cm' }")
    speed, origin = expected_speed(high)
    assert speed**2 == pytest.approx(2 * 9.80665 * (0.01 + 3 * 0.1 * 0.002))
    assert "top layer" in origin
    assert any(row.name == "overlap/d at rest" for row in explain(high))
    assert estimate.events_expected(high, derive(high)) > 12 * 20 * 0.1


def test_without_gravity_impacts_are_as_fast_as_the_fastest_wall() -> None:
    speed, origin = expected_speed(read(case_path("shear_cell.toml")))
    assert speed == 0.3
    assert origin.startswith("speed of the fastest wall")
