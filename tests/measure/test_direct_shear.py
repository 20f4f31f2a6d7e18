"""Friction and dilation of a direct shear test, from forces that are known and in the packaged case."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import ryusa
from ryusa.cases import case_path
from ryusa.errors import ResultsError
from ryusa.figures.direct_shear import direct_shear as drawn
from ryusa.measure import direct_shear
from ryusa.model.walls import (
    ASKED,
    N_IMPULSE,
    N_SERVO,
    SHIFT,
    SPIN,
    TOWARDS,
    VELOCITY,
    FaceKind,
    Walls,
    at_rest,
)  # fmt: skip

SPEED, LOAD, WEIGHT = 0.04, 6.0, 0.5  # [m/s], [N], of all grains [N]
T = np.linspace(0.0, 0.5, 101)
BASE, LID, LOWER, UPPER = range(4)


def sheared(*, mu=0.5, towards=-1.0, servos=1, along=(-1.0, 0.0, 0.0), spin=0.0, other=1.0, lid=0.0):
    """A run in which two walls are drawn out from under two others, under known forces, from 0.1 s on."""
    still, motion, servo = at_rest(4), at_rest(4, 0.1), np.zeros((4, N_SERVO))
    direction = np.array(along)
    motion[BASE, VELOCITY : VELOCITY + 3] = SPEED * direction
    motion[LOWER, VELOCITY : VELOCITY + 3] = other * SPEED * direction
    motion[LID, VELOCITY] = lid
    motion[BASE, SPIN] = spin
    motion[:, SHIFT] = 0.003  # where the frame of a wall is has no meaning of its own
    still[:, SHIFT] = 0.003
    for k in (LID, UPPER)[:servos]:
        servo[k, TOWARDS + 2], servo[k, ASKED] = towards, LOAD
    number = np.arange(4)

    def walls(rows):
        return Walls(
            face=np.ones((4, 9)), kind=np.full(4, FaceKind.TRIANGLE), wall=number, surface=number,
            active=np.ones(4, dtype=bool), motion=rows, names=("base", "lid", "lower", "upper"), servo=servo,
        )  # fmt: skip

    def scene_at(t):
        return SimpleNamespace(
            walls=walls(motion if t >= 0.1 else still), has_servo=True, n_grain=9, n_fixed=0, d_mean=0.002
        )

    after = np.maximum(T - 0.1, 0.0)
    impulse = np.zeros((len(T), 4, N_IMPULSE))
    shear = mu * (LOAD + 0.5 * WEIGHT) * direction  # across the plane, on what does not move
    impulse[:, UPPER, :3] = 0.75 * shear * after[:, None]
    impulse[:, LID, :3] = 0.25 * shear * after[:, None] + np.array([0.0, 0.0, LOAD]) * T[:, None]
    impulse[:, LOWER, :3] = -0.8 * shear * after[:, None]
    impulse[:, BASE, :3] = -0.2 * shear * after[:, None] - np.array([0, 0, LOAD + WEIGHT]) * T[:, None]
    travel = np.zeros((len(T), 4))
    travel[:, LID] = 0.01 - 0.001 * after
    return SimpleNamespace(
        case={"record": {"settle": 0.1}}, scene=scene_at(0.0), scene_at=scene_at, walls=impulse,
        row=None, wall_travel=travel, tally={"t": T},
    )  # fmt: skip


def test_friction_displacement_and_rise_are_those_of_known_forces():
    found = direct_shear(sheared(), begin=0.1)
    assert found.lid == "lid"
    assert found.moving == ("base", "lower")
    np.testing.assert_allclose(found.shear / found.normal, 0.5, rtol=1e-12)
    np.testing.assert_allclose(found.normal, LOAD + 0.5 * WEIGHT, rtol=1e-12)
    np.testing.assert_allclose(found.displacement, SPEED * (found.t - 0.1), atol=1e-12)
    np.testing.assert_allclose(found.rise, 0.001 * (found.t - 0.1), atol=1e-15)
    assert found["mu"].value == pytest.approx(0.5)
    assert found["imbalance"].value == pytest.approx(0.0, abs=1e-12)
    assert found.peak == pytest.approx(0.5)
    assert len(drawn(found).axes) == 2
    assert found.series()[-1]["mu"] == pytest.approx(0.5)


def test_it_does_not_matter_where_to_the_box_is_drawn():
    found = direct_shear(sheared(along=(0.6, 0.8, 0.0)), begin=0.1)
    assert found["mu"].value == pytest.approx(0.5)
    assert found.displacement[-1] == pytest.approx(SPEED * (found.t[-1] - 0.1))


def test_a_peak_is_found_where_it_is():
    run = sheared()
    high = (T > 0.2) & (T <= 0.25)
    rate = np.diff(run.walls, axis=0, prepend=run.walls[:1])
    rate[high, :, 0] *= 1.5
    run.walls = np.cumsum(rate, axis=0)
    found = direct_shear(run, begin=0.1)
    assert found.peak == pytest.approx(0.75)
    assert SPEED * 0.1 < found.peak_at < SPEED * 0.15
    assert found["mu"].value == pytest.approx(0.5)  # of the second half of the displacement


def test_what_is_no_direct_shear_test_is_refused_by_name():
    for wrong, says in (
        ({"servos": 0}, "one wall with a servo"), ({"servos": 2}, "the run has 2"),
        ({"towards": -0.5}, "'lid' is not pressed along z"), ({"spin": 1.0}, "'base' moves otherwise"),
        ({"other": 0.5}, "'lower' moves otherwise than 'base'"), ({"lid": 0.1}, "under a lid that does not"),
        ({"along": (0.0, 0.0, 0.0)}, "needs walls that move"),
        ({"along": (0.8, 0.0, 0.6)}, "does not move along a level direction"),
    ):  # fmt: skip
        with pytest.raises(ResultsError, match=says):
            direct_shear(sheared(**wrong), begin=0.1)
    with pytest.raises(ResultsError, match="needs walls that move"):
        direct_shear(sheared(), begin=0.0, end=0.09)
    with pytest.raises(ResultsError, match=r"a peak needs 0\.0005 m"):
        direct_shear(sheared(), begin=0.05, end=0.11)


@pytest.mark.slow
def test_both_halves_of_the_packaged_box_carry_the_same_and_grains_without_friction_carry_less(
    tmp_path: Path,
) -> None:
    found = [
        direct_shear(
            ryusa.run(
                ryusa.load(case_path("direct_shear.toml"), {"contact.friction": mu}),
                tmp_path / mu, progress=False,
            )
        )
        for mu in ("0.5", "0")
    ]  # fmt: skip
    for one in found:
        assert abs(one["imbalance"].value) < 0.03
        assert one["normal"].value == pytest.approx(5.76 + 0.28, rel=0.2)  # load and half of the weight [N]
    assert found[1]["mu"].value < 0.6 * found[0]["mu"].value
