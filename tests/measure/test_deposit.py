"""Deposits and fronts in runs made up by hand: volumes, slopes and speeds in closed form."""

import math
from typing import Any

import numpy as np
import pytest
from tests.measure.made_rows import BALL, DX, DZ, WIDTH, D, layered, row_of, run_of

from ryusa.errors import ResultsError
from ryusa.figures.deposit import deposit as drawn_deposit
from ryusa.figures.front import front as drawn_front
from ryusa.measure.deposit import deposit
from ryusa.measure.front import front
from ryusa.model.feeds import IN, OUT, PASSAGE
from ryusa.model.row import ColumnRow, RowDam

T = np.arange(11) * 0.1


def dammed(n: int = 8) -> ColumnRow:
    row = row_of(n, ends=True)
    object.__setattr__(row, "dams", (RowDam("sabo dam", 4, 5, 0.004),))  # 0.14 to 0.15 m
    return row


def trapping() -> Any:
    """Ten grains are fed at 0.11 m, one each 0.1 s; every fifth goes on to 0.18 m and out, others stop.

    The first grain of the run stays at 0.12 m.
    """
    x, rows = np.full((11, 12, 3), np.nan), np.zeros(12, PASSAGE)
    x[:, 0] = (0.12, 0.0, 0.001)
    for k in range(10):
        for m in range(k + 1, 11):
            x[m, k + 1] = (0.135, 0.0, 0.001)
        rows[k]["grain"], rows[k]["way"], rows[k]["t"], rows[k]["step"] = (
            k + 1,
            IN,
            0.1 * k + 0.05,
            100 * k + 50,
        )
        rows[k]["x"] = (0.11, 0.0, 0.01)
    for k, gone in enumerate((5, 10)):
        x[gone:, gone] = np.nan  # in no frame at all
        rows[10 + k]["grain"], rows[10 + k]["way"], rows[10 + k]["t"] = gone, OUT, 0.1 * gone - 0.01
        rows[10 + k]["step"], rows[10 + k]["x"] = 100 * gone - 10, (0.18, 0.0, 0.001)
    return run_of(dammed(), T, x, np.zeros_like(x), rows[np.argsort(rows["step"], kind="stable")])


@pytest.fixture
def trap() -> Any:
    return trapping()


def test_what_came_less_what_went_is_stored_at_every_frame(trap: Any) -> None:
    found, unit = deposit(trap), BALL / WIDTH
    assert found.reach == pytest.approx((0.1, 0.15))
    assert np.isnan(found.fitted).all() and "in no frame 3 segments" in found.averages.notes[1]
    assert found.brought == pytest.approx(unit * np.arange(11))
    assert found.passed == pytest.approx(unit * np.array([0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 2]))
    assert np.abs(found.brought - found.passed - found.stored).max() < 1e-14 * 10 * unit
    assert np.abs(found.unaccounted).max() < 1e-14 * 10 * unit
    assert found.held[0] == pytest.approx(unit)
    assert found.trapped[-1] == pytest.approx(0.8) and math.isnan(found.trapped[0])
    assert found["trapped_share"].value == pytest.approx(0.8)
    assert found["brought_rate"].value == pytest.approx(10 * unit)
    assert found["passed_rate"].error > 0.0
    assert "stored" in found.averages.notes[0] and len(found.rows()) == 11
    assert len(drawn_deposit(found).axes) == 1  # no slope could be fitted: its panel is left out


def test_the_window_begins_at_the_end_of_settling(trap: Any) -> None:
    """What spilled over the dam before, as a loose bed does while it settles, is not in it."""
    trap.case["record"] = {"settle": 0.55}
    found, unit = deposit(trap), BALL / WIDTH
    assert found.t[0] == pytest.approx(0.6) and front(trap).t[0] == pytest.approx(0.6)
    assert found.passed[-1] == pytest.approx(unit) and found.brought[-1] == pytest.approx(4 * unit)
    assert deposit(trap, begin=0.0).passed[-1] == pytest.approx(2 * unit)


def test_the_first_dam_is_the_one_farthest_upstream_in_whatever_order_they_are_given(trap: Any) -> None:
    dams = (RowDam("lower", 6, 7, 0.004), *trap.row.row.dams)
    object.__setattr__(trap.row.row, "dams", dams)
    assert deposit(trap).reach == pytest.approx((0.1, 0.15))
    assert deposit(trap, dam="lower").reach == pytest.approx((0.1, 0.17))


def test_exits_within_the_reach_and_its_own_bounds_count_as_passing(trap: Any) -> None:
    unit = BALL / WIDTH
    whole, below = deposit(trap, reach=(0.1, 0.18)), deposit(trap, reach=(0.15, 0.18))
    assert whole.passed == pytest.approx(deposit(trap).passed)
    assert whole.stored == pytest.approx(deposit(trap).stored)
    assert below.brought[-1] == pytest.approx(2 * unit) and below.stored == pytest.approx(0.0, abs=1e-20)
    assert math.isnan(below.trapped[0]) and below.trapped[-1] == pytest.approx(0.0)


def test_a_grain_that_no_feed_brought_is_unaccounted_for(trap: Any) -> None:
    trap.frames.x[6:, 11] = (0.13, 0.0, 0.0)
    assert deposit(trap).unaccounted[-1] == pytest.approx(BALL / WIDTH)


def test_the_slope_is_that_of_a_plane_bed_with_the_inclination_of_the_axis() -> None:
    """A bed that rises by 5 in 100 along an axis that falls by 1 in 100, over a tilted bottom."""
    bottom = 0.01 - 0.1 * DX * np.arange(16)
    row = row_of(16, ends=True, bottom=bottom)
    levels = 0.012 + 0.15 * DX * np.arange(16)
    run = run_of(row, T, np.full((11, 1, 3), 0.14), np.zeros((11, 1, 3)),
                 phi=np.tile(layered(row, np.round(levels / DZ) * DZ, 0.0), (11, 1, 1)))  # fmt: skip
    found = deposit(run)
    assert found.slope == pytest.approx(math.tan(math.atan(0.01) - math.atan(0.05)), abs=0.003)
    assert (found.slope_error < 0.003).all() and found["slope"].value == pytest.approx(found.slope[0])
    assert found.fitted == pytest.approx(np.tile((0.1, 0.26), (11, 1)))
    part = deposit(run, reach=(0.1, 0.12))
    assert np.isnan(part.slope).all()  # two segments give no error


def test_bottom_on_which_no_whole_grain_lies_does_not_count_in_the_slope() -> None:
    """A wedge that rises by 15 in 100 behind a dam, upstream of it half a grain over the bottom."""
    row = row_of(16, ends=True)
    object.__setattr__(row, "dams", (RowDam("dam", 14, 15, 0.004),))  # 0.24 to 0.25 m
    levels = np.where(np.arange(16) < 6, 0.5 * D, 0.004 + 0.15 * DX * (np.arange(16) - 6))
    run = run_of(row, T, np.full((11, 1, 3), 0.14), np.zeros((11, 1, 3)),
                 phi=np.tile(layered(row, np.round(levels / DZ) * DZ, 0.0), (11, 1, 1)))  # fmt: skip
    found = deposit(run)
    assert found.fitted == pytest.approx(np.tile((0.16, 0.24), (11, 1)))
    assert found.slope == pytest.approx(math.tan(math.atan(0.01) - math.atan(0.15)), abs=0.003)
    assert "in the last frame from x = 0.16 to 0.24 m" in found.averages.notes[1]
    assert found.rows()[0]["fitted_from_m"] == pytest.approx(0.16)


def test_the_error_of_a_slope_is_the_spread_of_slopes_of_beds_with_correlated_scatter() -> None:
    rng = np.random.default_rng(3)
    row = row_of(60, ends=True)
    noise = rng.normal(0.0, 1.0e-3, (60, 62))
    noise = (noise[:, 2:] + noise[:, 1:-1] + noise[:, :-2]) / 3.0
    levels = 0.02 + noise
    t = np.arange(60) * 0.1
    z = (np.arange(row.column.n) + 0.5) * DZ
    phi = 0.6 * np.clip((levels[:, :, None] - z) / DZ + 0.5, 0.0, 1.0)
    run = run_of(row, t, np.full((60, 1, 3), 0.14), np.zeros((60, 1, 3)), phi=phi)
    found = deposit(run)
    assert np.sqrt((found.slope_error**2).mean()) == pytest.approx(found.slope.std(), rel=0.4)


def test_what_has_no_dam_or_reach_of_that_name_is_refused(trap: Any) -> None:
    with pytest.raises(ResultsError, match=r"the row has sabo dam\. Did you mean 'sabo dam'"):
        deposit(trap, dam="sabo dan")
    with pytest.raises(ResultsError, match="must ascend within the row"):
        deposit(trap, reach=(0.12, 0.5))
    with pytest.raises(ResultsError, match="not both"):
        deposit(trap, dam="sabo dam", reach=(0.1, 0.12))
    with pytest.raises(ResultsError, match="a period stores nothing"):
        deposit(run_of(row_of(), T, np.zeros((11, 1, 3)), np.zeros((11, 1, 3))))


def test_a_front_that_moves_at_one_speed_has_that_speed_and_bed_grains_do_not_count() -> None:
    """A hundred grains move at 0.2 m/s and one at 0.3 m/s, over a grain ahead of them that rests."""
    x = np.zeros((11, 102, 3))
    x[:, :100, 0] = np.linspace(0.0, 0.099, 100) + 0.2 * T[:, None]
    x[:, 100, 0] = 0.1 + 0.3 * T
    x[:, 101, 0] = 5.0
    run = run_of(row_of(ends=True), T, x, np.zeros_like(x))
    found = front(run)
    assert math.isnan(found.first[0])  # none has moved
    assert found.first[1:] == pytest.approx(0.1 + 0.3 * T[1:])
    assert found.front[1:] == pytest.approx(0.095 + 0.2 * T[1:])  # six of 101, the fast one among them
    assert found["first_speed"].value == pytest.approx(0.3) and found["front_speed"].value == pytest.approx(
        0.2
    )
    assert found.moved[-1] == pytest.approx(101 * BALL)
    assert found.rows()[3]["front_speed_m_per_s"] == pytest.approx(0.2)
    assert len(drawn_front(found).axes) == 1


def test_the_speed_of_a_front_leaves_out_the_time_in_which_it_lies() -> None:
    """Grains move at 0.2 m/s for half of the time."""
    x = np.zeros((11, 100, 3))
    x[:, :, 0] = np.linspace(0.0, 0.099, 100) + 0.2 * np.minimum(T, 0.5)[:, None]
    found = front(run_of(row_of(ends=True), T, x, np.zeros_like(x)))
    assert found["front_speed"].value == pytest.approx(0.2)


def test_a_front_stays_where_its_grains_left(trap: Any) -> None:
    found = front(trap)
    assert found.first[1] == pytest.approx(0.135) and found.first[5:] == pytest.approx(0.18)
    assert found.moved[-1] == pytest.approx(10 * BALL)


def test_where_no_grain_has_moved_the_note_says_so() -> None:
    x = np.zeros((11, 3, 3))
    (note,) = front(run_of(row_of(ends=True), T, x, x)).averages.notes
    assert note == "at the end no grain has come in or is farther than 5 d from where it was"


def test_a_period_has_no_front(trap: Any) -> None:
    object.__setattr__(trap.scene, "period", (0.1, math.inf))
    with pytest.raises(ResultsError, match="periodic along x"):
        front(trap)


def test_grains_that_lie_in_the_reach_from_the_start_are_no_trapped_share() -> None:
    """Ten grains upstream of the dam, of which one goes over it in every frame; none comes in."""
    x = np.full((11, 12, 3), np.nan)
    x[:, :10] = (0.12, 0.0, 0.001)
    for k in range(10):
        x[k + 1 :, k, 0] = 0.17
    found = deposit(run_of(dammed(), T, x, np.zeros_like(x)))
    assert found.stored[-1] == pytest.approx(-10 * BALL / WIDTH)
    assert np.isnan(found.trapped).all() and found["trapped_share"].n == 0
    assert "trapped share: none" in found.averages.notes[-1]


def test_a_trapped_share_is_counted_and_has_no_error_of_one_run(trap: Any) -> None:
    found = deposit(trap)
    assert math.isnan(found["trapped_share"].error) and found["trapped_share"].n_series == 0
    assert "counted at the last frame" in found.averages.notes[-1]
