"""Grains through feeds and exits one by one, in a run made up by hand with an answer known by counting."""

from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ryusa import build
from ryusa.errors import ResultsError
from ryusa.figures.passages import passages as drawn
from ryusa.measure import passages
from ryusa.model.feeds import IN, OUT, PASSAGE

DT, INTERVAL = 1.0e-3, 10  # a step, and steps between two instants
SIZES = np.linspace(1.0e-3, 2.0e-3, 7)  # of the first grain and of six that are fed
# grain, feed 'hose' (0) or 'again' (1) by IN, exit 'floor' (0) or 'side' (1) by OUT, time, step, due, speed
STORY = [
    (1, IN, 0, 0.000, 0, 0.0, 1.0),
    (2, IN, 0, 0.100, 100, 0.1, 1.0),
    (0, OUT, 0, 0.150, 160, np.nan, 3.0),
    (3, IN, 0, 0.250, 250, 0.2, 1.0),  # 50 ms late
    (1, OUT, 1, 0.300, 300, np.nan, 2.0),  # to 'again'
    (1, IN, 1, 0.310, 310, 0.3, 0.5),
    (4, IN, 0, 0.300, 310, 0.3, 1.0),
    (2, OUT, 0, 0.420, 430, np.nan, 5.0),
]
INSIDE = [1, 3, 4]  # 5 and 6, due at 0.4 s and 0.5 s, find no place


@pytest.fixture(scope="module")
def run() -> Any:
    hose = build.feed_disc("hose", SIZES[1:], 10.0, (0, 0, 0.1), 0.01, velocity=(0, 0, -1.0))
    again = build.feed_disc("again", (), 0.0, (0, 0.1, 0.1), 0.01, velocity=(0, 0, -0.5))
    floor = build.exit_plane("floor", (0, 0, 0), (0, 0, -1))
    side = build.exit_plane("side", (0.3, 0, 0), (1, 0, 0), to="again")
    scene, _ = build.scene(
        [[0.1, 0, 0.05]], SIZES[0], feeds=[hose, again], exits=[floor, side], dt=DT, stiffness=1.0
    )
    assert scene.traffic is not None
    object.__setattr__(scene.traffic, "interval", INTERVAL)
    rows = np.zeros(len(STORY), PASSAGE)
    for row, (grain, way, at, t, step, due, speed) in zip(rows, STORY, strict=True):
        row["grain"], row["way"], row["at"], row["t"], row["step"], row["due"] = grain, way, at, t, step, due
        row["to"] = 1 if (way, at) == (OUT, 1) else -1
        row["d"], row["m"] = scene.d[grain], scene.m[grain]
        row["x"], row["v"] = (0.01 * grain, 0.0, 0.1), (0.6 * speed, 0.0, -0.8 * speed)
    t = np.arange(6) * 0.1
    frames = SimpleNamespace(t=t, step=np.round(t / DT).astype(np.int64))
    return SimpleNamespace(case={}, scene=scene, frames=frames, passages=rows)


def test_every_passage_is_a_row_in_order_of_time(run: Any) -> None:
    rows = passages(run).rows()
    assert [row["t_s"] for row in rows] == sorted(t for *_, t, _, _, _ in STORY)
    assert [(row["way"], row["through"]) for row in rows[:3]] == [
        ("in", "hose"),
        ("in", "hose"),
        ("out", "floor"),
    ]
    left = rows[2]
    assert (left["id"], left["d_m"], left["m_kg"]) == (0, run.scene.d[0], run.scene.m[0])
    assert left["speed_m_per_s"] == pytest.approx(3.0)
    assert (left["v_x_m_per_s"], left["v_z_m_per_s"]) == (pytest.approx(1.8), pytest.approx(-2.4))
    assert (left["x_m"], left["z_m"]) == (0.0, 0.1)
    assert np.isnan(left["due_s"])
    late = next(row for row in rows if row["id"] == 3)
    assert late["t_s"] - late["due_s"] == pytest.approx(0.05)


def test_mass_given_in_is_mass_inside_and_mass_out_to_the_last_bit(run: Any) -> None:
    found, m = passages(run), [Fraction(one) for one in run.scene.m.tolist()]
    came = [m[int(row["grain"])] for row in found.records if row["way"] == IN]
    gone = [m[int(row["grain"])] for row in found.records if row["way"] == OUT]
    assert m[0] + sum(came) == sum(m[one] for one in INSIDE) + sum(gone)
    assert (found.n_begin, found.n_end) == (1, len(INSIDE))
    assert found.m_begin == run.scene.m[0]
    assert found.m_end == float(sum(m[one] for one in INSIDE))
    assert {one.label: one.mass for one in found.gates} == {
        "in by hose": float(sum(m[1:5])), "in by again": float(m[1]),
        "out by floor": float(m[0] + m[2]), "out by side": float(m[1]),
    }  # fmt: skip


def test_rates_are_what_passed_over_the_window(run: Any) -> None:
    m, whole = run.scene.m, passages(run)
    assert whole["rate_in"].value == pytest.approx((m[1:5].sum() + m[1]) / 0.5, rel=1e-12)
    assert whole["grains_out"].value == pytest.approx(3 / 0.5, rel=1e-12)
    assert whole["speed out by floor"].value == pytest.approx(4.0)
    assert whole["speed out by floor"].n == 2
    assert 0.0 < whole["rate_in"].error < whole["rate_in"].value
    part = passages(run, begin=0.12, end=0.305)
    assert [row["id"] for row in part.rows()] == [0, 3, 1, 4]
    assert part["out by floor"].value == pytest.approx(m[0] / 0.185, rel=1e-12)
    assert part["in by again"].value == 0.0
    assert (part.n_begin, part.n_end) == (3, 3)


def test_a_feed_owes_what_was_due_and_found_no_place(run: Any) -> None:
    found, m = passages(run), run.scene.m
    hose, again = found.gates[:2]
    owed = dict(zip(found.instants.round(3).tolist(), hose.owed_n.tolist(), strict=True))
    assert [owed[t] for t in (0.0, 0.1, 0.19, 0.2, 0.24, 0.25, 0.3, 0.31, 0.39, 0.4, 0.49, 0.5)] == [
        0, 0, 0, 1, 1, 0, 1, 0, 0, 1, 1, 2
    ]  # fmt: skip
    assert hose.owed[-1] == pytest.approx(m[5] + m[6], rel=1e-12)
    assert set(hose.owed[hose.owed_n == 0]) == {0.0}
    assert again.owed_n.tolist() == [int(0.3 <= t < 0.31) for t in found.instants.round(3)]
    assert "it owes 2" in found.averages.notes[0]


def test_the_picture_shows_debts_only_where_there_are_any(run: Any) -> None:
    assert [one.get_ylabel() for one in drawn(passages(run)).axes] == [
        "mass that passed  ($10^{-5}$ kg)",
        "mass owed  ($10^{-5}$ kg)",
    ]
    figure = drawn(passages(run, end=0.15))
    assert len(figure.axes) == 1
    lines = {line.get_label(): np.asarray(line.get_ydata()) for line in figure.axes[0].get_lines()}
    assert lines["in by hose"][-1] == pytest.approx(run.scene.m[1:3].sum())
    assert lines["out by floor"][-1] == pytest.approx(run.scene.m[0])


def test_a_window_without_time_is_refused(run: Any) -> None:
    with pytest.raises(ResultsError, match=r"ends at t = 0.5 s; no time is left from 0.5 s on"):
        passages(run, begin=0.5)
