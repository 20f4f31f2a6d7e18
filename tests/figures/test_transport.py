"""Transport rate over shear stress."""

import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.figures import style
from ryusa.figures.transport import Formula, Rates, transport, transport_of_run
from ryusa.measure import Averages, average

TAU = np.geomspace(0.03, 1.0, 60)
POWER = Formula("8 (tau - 0.047)^1.5", TAU, 8.0 * np.maximum(TAU - 0.047, 0.0) ** 1.5)


def rates(q, error=0.1):
    q = np.array(q)
    return Rates("runs", np.array([0.05, 0.2, 0.8]), q, error * q)


def test_points_lie_over_named_lines_on_logarithmic_axes():
    figure = transport([rates([0.01, 0.4, 5.0])], [POWER, Formula("other", TAU, 4.0 * TAU)])
    figure.canvas.draw()
    (axes,) = figure.axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert words == ["8 (tau - 0.047)^1.5", "other", "runs"]
    drawn = np.asarray(axes.lines[0].get_ydata(), dtype=float)
    assert (drawn > 0.0).all()
    assert len(drawn) == np.count_nonzero(TAU > 0.047)
    assert axes.lines[0].get_zorder() < max(one.get_zorder() for one in axes.lines)
    assert r"\tau_*" in axes.get_xlabel()
    assert "q_*" in axes.get_ylabel()
    low, high = axes.get_ylim()
    assert low < 0.01
    assert high > 5.0


@pytest.mark.parametrize(
    ("low", "high"), [(0.05, 0.4), (0.03, 0.5), (0.2, 2.5), (0.2, 0.25), (0.03, 1.0), (0.01, 30.0)]
)
def test_numbers_on_the_axis_of_shear_stress_do_not_overlap(low, high):
    tau = np.geomspace(low, high, 60)
    figure = transport([], [Formula("line", tau, tau)])
    figure.canvas.draw()
    axis = figure.axes[0].xaxis
    low, high = axis.get_view_interval()
    ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
    shown = [one.label1 for one in ticks if one.label1.get_text() and low <= one.get_loc() <= high]
    boxes = sorted((one.get_window_extent() for one in shown), key=lambda one: one.x0)
    assert len(boxes) >= 3
    assert all(left.x1 < right.x0 for left, right in itertools.pairwise(boxes))
    named = [one.get_text() for one in shown]
    assert all("10^" in one for one in named) if high > 200.0 * low else all(float(one) for one in named)


def test_a_run_without_transport_is_shown_at_the_lower_edge():
    figure = transport([rates([0.0, 0.4, 5.0])], [POWER])
    figure.canvas.draw()
    arrows = [one for one in figure.axes[0].texts if one.arrow_patch is not None]
    assert [one.xy[0] for one in arrows] == [0.05]


def test_errors_larger_than_the_value_and_unknown_ones_can_be_drawn():
    one = rates([0.01, 0.4, 5.0], error=3.0)
    one.error[1] = np.nan
    across = Rates("flume", one.tau_star, one.q_star, one.error, 0.1 * one.tau_star)
    figure = transport([one, across], note="d = 6 mm")
    figure.canvas.draw()
    assert figure.axes[0].texts[0].get_text() == "d = 6 mm"


@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_it_can_be_saved_without_any_point(tmp_path, suffix):
    assert style.save(transport([], [POWER]), tmp_path / f"q{suffix}").stat().st_size > 0


@pytest.mark.parametrize(
    ("n", "fall", "said"), [(400, 0.0, "yes"), (12, 0.0, "too short"), (400, 2.0, "no, drift -")]
)
def test_the_picture_of_a_run_says_whether_its_rate_is_steady(n, fall, said):
    q = np.random.default_rng(2).normal(1.0, 0.1, n) - np.linspace(0.0, fall, n)
    mean = average("q_star", "-", [q])
    found = SimpleNamespace(
        t=np.arange(n) + 0.5, dt=np.ones(n), q_star=q, tau_star=math.nan, tau_error=math.nan,
        averages=Averages("transport", (mean,)),
    )  # fmt: skip
    figure = transport_of_run(found)
    first, second = figure.axes[0].texts[0].get_text().split("\n")
    assert first.endswith("*") == mean.short
    assert second.startswith(f"steady: {said}")
