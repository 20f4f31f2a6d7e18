"""Pictures are looked at by people; here: that they are drawn, show what they are given and are written."""

import numpy as np
import pytest
from matplotlib.collections import PatchCollection

from ryusa import figures
from ryusa.measure import Energy, Spin, Tracks, average
from ryusa.measure.table import Averages

D = 0.002


def path(n=200, length=0.3):
    x = np.linspace(0.05, 0.05 + length, n)
    bed = (np.arange(20) + 0.5) * D
    return Tracks(
        grains=(0,),
        t=np.linspace(1, 2, n),
        x=x[:, None],
        z=(0.003 + 0.004 * np.abs(np.sin(60 * x)))[:, None],
        d=np.array([D]),
        bed_x=bed,
        bed_z=np.full(20, D / 2),
        bed_d=np.full(20, D),
        period=20 * D,
    )


def test_a_long_track_is_cut_into_panels_with_round_grains_and_a_bed_without_gaps():
    figure = figures.tracks(path())
    figure.canvas.draw()
    assert len(figure.axes) == 4
    for axes in figure.axes:
        assert axes.get_aspect() == 1.0
        bed = next(one for one in axes.collections if isinstance(one, PatchCollection))
        low, high = axes.get_xlim()
        assert len(bed.get_paths()) >= (high - low) / (1e3 * D)


def test_exaggerated_heights_are_said_to_be_so():
    figure = figures.tracks(path(), panels=2, exaggeration=2.0)
    assert "2 times" in figure.axes[0].get_title(loc="right")


def test_tracks_side_by_side_share_their_scale():
    figure = figures.tracks_side_by_side({"a": path(), "b": path(length=0.4)}, 0.2)
    assert len({axes.get_xlim() for axes in figure.axes}) == 1
    assert len({axes.get_ylim() for axes in figure.axes}) == 1


def test_measured_points_carry_error_bars_and_the_axes_their_units():
    k = np.logspace(2, 5, 4)
    points = figures.Points("run", k, 1 / np.sqrt(k), 0.1 / np.sqrt(k))
    figure = figures.over_stiffness("time", [figures.Curve("Eq. (8)", k, 1 / np.sqrt(k))], [points])
    axes = figure.axes[0]
    assert axes.get_xlabel().endswith("(N/m)")
    assert axes.get_ylabel().endswith("(s)")
    assert len(axes.containers) == 1
    low, high = axes.get_xlim()
    assert low < k[0]
    assert high > k[-1]


def test_spin_is_shown_in_turns_per_second_too():
    t = np.linspace(0, 1, 50)
    omega = np.full((50, 1), 2 * np.pi)
    found = Spin(
        t, t[:, None], omega, 2 * np.pi, Averages("spin", (average("spin", "rad/s", [omega[:, 0]]),))
    )
    figure = figures.spin(found)
    figure.canvas.draw()
    right = figure.axes[0].child_axes[0]
    assert right.get_ylim()[0] == pytest.approx(figure.axes[0].get_ylim()[0] / (2 * np.pi))


def test_energy_terms_that_stay_zero_are_left_out():
    t = np.linspace(0, 1, 10)
    zero = np.zeros(10)
    found = Energy(t, {"kinetic": t, "spin": zero}, {"dash_n": zero}, {"drag": t}, 0.0, zero)
    figure = figures.energy(found)
    labels = [line.get_label() for axes in figure.axes for line in axes.lines]
    assert any("kinetic" in one for one in labels)
    assert any("drag" in one for one in labels)
    assert not any("spin" in one or "dashpot" in one for one in labels)


@pytest.mark.parametrize("kind", [".png", ".svg"])
def test_the_same_picture_is_written_with_the_same_bytes(tmp_path, kind):
    first, second = (
        figures.save(figures.tracks(path()), tmp_path / f"{name}{kind}").read_bytes() for name in "ab"
    )
    assert first == second
    assert len(first) > 1000
