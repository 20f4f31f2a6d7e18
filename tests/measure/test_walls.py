"""Forces on walls in a run made up by hand: which walls were touched, and where torques are taken about."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ryusa.errors import CaseError, ResultsError
from ryusa.figures import style
from ryusa.figures.walls import MOST
from ryusa.figures.walls import walls as drawn
from ryusa.measure.walls import walls
from ryusa.model.walls import AXIS_POINT, N_IMPULSE, TOUCHED, VELOCITY, Walls, at_rest

T = np.linspace(0.0, 2.0, 41)


def pushed(forces: dict[str, float]) -> Any:
    """A run whose grains push each wall along x with a constant force [N]; 0: they never touch it."""
    n = len(forces)
    motion = at_rest(n)
    motion[0, AXIS_POINT : AXIS_POINT + 3], motion[0, VELOCITY] = (0.343, 0.0, 0.01), 0.1
    impulse = np.zeros((len(T), n, N_IMPULSE))
    impulse[:, :, 0] = T[:, None] * np.array(list(forces.values()))
    impulse[:, :, TOUCHED] = T[:, None] * (np.array(list(forces.values())) != 0.0)
    faces = (np.zeros((n, 9)), np.zeros(n, int), np.arange(n), np.arange(n), np.ones(n, bool))
    scene = SimpleNamespace(walls=Walls(*faces, motion, tuple(forces)), has_servo=False)
    return SimpleNamespace(
        case={}, scene=scene, tally={"t": T}, walls=impulse, row=None, wall_travel=np.zeros((len(T), n))
    )


WEIR = {"weir": 0.026, "bottom": 1.1, "core": 0.0}


def test_a_wall_that_no_grain_touched_is_named() -> None:
    found = walls(pushed(WEIR))
    assert found.untouched == ("core",)
    assert "no grain touched: core" in found.averages.notes
    assert walls(pushed({"weir": 0.1, "bottom": 1.0})).untouched == ()


def test_the_point_of_each_torque_is_given_where_it_is_at_the_begin() -> None:
    found = walls(pushed(WEIR), begin=0.5)
    assert found.axis_point == pytest.approx(np.array([[0.393, 0.0, 0.01], [0, 0, 0], [0, 0, 0]]))
    (said,) = (one for one in found.averages.notes if "torque" in one)
    assert "weir (0.393, 0, 0.01) m at the begin, moving with it, bottom (0, 0, 0) m, core" in said


def test_every_wall_that_felt_a_force_is_drawn_however_much_another_carries() -> None:
    figure = drawn(walls(pushed(WEIR)))
    assert [one.get_title("left") for one in figure.axes] == ["weir", "bottom"]
    assert all(len(one.get_legend_handles_labels()[0]) == 1 for one in figure.axes)
    assert style.notes(figure) == ("no grain touched: core",)
    assert "no grain touched: core" in str(figure.get_supxlabel())


def test_of_many_walls_those_left_out_are_named_and_may_be_chosen() -> None:
    found = walls(pushed({f"pier {k}": 1.0 + k for k in range(MOST + 2)}))
    figure = drawn(found)
    assert len(figure.axes) == MOST
    assert style.notes(figure)[0].endswith("--wall NAME draws another: pier 0, pier 1")
    figure = drawn(found, wall=("pier 0", "pier 3"))
    assert [one.get_title("left") for one in figure.axes] == ["pier 0", "pier 3"]
    assert style.notes(figure) == ()
    with pytest.raises(CaseError, match="Did you mean 'pier 1'"):
        drawn(found, wall=("piet 1",))


def test_walls_that_felt_nothing_are_not_drawn_unless_they_are_named() -> None:
    found = walls(pushed({"weir": 0.0, "bottom": 0.0}))
    with pytest.raises(ResultsError, match="no grain touched a wall: weir, bottom"):
        drawn(found)
    assert "no grain touched it" in {one.get_text() for one in drawn(found, ("weir",)).axes[0].texts}
