"""Picture of the spin of grains."""

from dataclasses import replace

import numpy as np
import pytest

from ryusa import figures
from ryusa.measure import Averages, Spin, average


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


def spinning(n, settle=0.0):
    """Grain k turns at k rad/s, in the end at 10 k, and travels k/10 m, the last of them back."""
    t = np.linspace(0.0, 1.0, 50)
    omega = np.where(t[:, None] < 0.5, 1.0, 10.0) * np.arange(n)
    way = 0.1 * t[:, None] * np.arange(n) * np.where(np.arange(n) == n - 1, -1.0, 1.0)
    late = [omega[t >= settle, g] for g in range(n)]
    mean = average("spin", "rad/s", late, (settle, 1.0))
    return Spin(t, way, omega, 10.0 * n, Averages("spin", (mean,)))


def test_of_many_grains_the_three_that_travelled_farthest_are_drawn_beside_the_spin_of_all():
    found = spinning(8, settle=0.6)
    figure = figures.spin(found)
    figure.canvas.draw()
    ways, density = figure.axes
    lines = [line for line in ways.lines if line.get_label().startswith("grain")]
    assert [line.get_label() for line in lines] == ["grain 7", "grain 6", "grain 5"]
    assert lines[1].get_ydata() == pytest.approx(found.omega[:, 6])
    assert "3 of 8 grains that travelled farthest" in ways.get_legend().get_title().get_text()
    bars = density.patches
    assert sum(bar.get_width() * bar.get_height() for bar in bars) == pytest.approx(1.0)
    assert sum(bar.get_width() > 0.0 for bar in bars) == 8  # settled: 0, 10, .. 70 rad/s, and nothing else
    assert "mean 35 rad/s" in density.get_legend().get_texts()[0].get_text()


def test_of_few_grains_all_are_drawn_and_of_many_those_asked_for():
    assert len(figures.spin(spinning(3)).axes) == 1
    still = spinning(8)
    assert len(figures.spin(replace(still, omega=0.0 * still.omega)).axes) == 1
    chosen = figures.spin(spinning(8), [2]).axes[0]
    assert [line.get_label() for line in chosen.lines if line.get_label()[0] == "g"] == ["grain 2"]
    assert chosen.get_legend() is None
