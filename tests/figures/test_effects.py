"""Pictures of a sweep: what is drawn is what was found."""

import math

import pytest

from ryusa.figures.effects import EffectAxis, EffectPoint, effects

SLOPE = EffectAxis("motion.slope  (–)")
WORDS = EffectAxis("water.drag", ("constant", "24/Re+2"))


def drawn(axes, points, **how):
    figure = effects(axes, points, "q  (m²/s)", error="mean ± s.e.", **{"joined": True, **how})
    figure.canvas.draw()
    return [panel for panel in figure.axes if panel.get_visible()]


def test_every_run_every_mean_and_every_error_is_drawn():
    points = [
        EffectPoint((0.02,), ("",), (3.0, 5.0), 4.0, 0.5), EffectPoint((0.01,), ("",), (1.0, 2.0), 1.5, 0.25)
    ]  # fmt: skip
    (panel,) = drawn([SLOPE], points)
    (bars,) = panel.containers
    line, _, (sticks,) = bars.lines
    assert line.get_xydata().tolist() == [[0.01, 1.5], [0.02, 4.0]]  # in order along the axis
    assert [one[:, 1].tolist() for one in sticks.get_segments()] == [[1.25, 1.75], [3.5, 4.5]]
    runs = sorted(
        y for one in panel.lines if one.get_marker() == "o" and one is not line for y in one.get_ydata()
    )
    assert runs == [1.0, 2.0, 3.0, 5.0]
    assert panel.get_ylabel() == "q  (m²/s)"


def test_a_setting_without_a_mean_has_its_run_alone():
    (panel,) = drawn([SLOPE], [EffectPoint((0.01,), ("",), (1.0,), math.nan, math.nan)])
    assert len(panel.containers[0].lines[0].get_xdata()) == 0


def test_means_are_joined_at_levels_of_a_grid_and_not_in_a_sampled_design():
    points = [EffectPoint((x,), ("",), (x,), x, 0.1) for x in (1.0, 2.0)]
    for joined in (True, False):
        (panel,) = drawn([SLOPE], points, joined=joined)
        assert (panel.containers[0].lines[0].get_linestyle() != "None") == joined


def test_words_stand_along_the_axis_and_groups_beside_each_other():
    points = [
        EffectPoint((float(w),), (group,), (1.0,), 1.0, 0.1) for w in (0, 1) for group in ("0.01", "0.02")
    ]  # fmt: skip
    (panel,) = drawn([EffectAxis("water.drag", WORDS.words, legend="slope")], points)
    assert [one.get_text() for one in panel.get_xticklabels()] == ["constant", "24/Re+2"]
    places = [one.lines[0].get_xdata().tolist() for one in panel.containers]
    assert places[0] != places[1]
    assert places[0][0] + places[1][0] == pytest.approx(0.0)
    assert panel.get_legend().get_title().get_text() == "slope"


@pytest.mark.parametrize(("n", "shape"), [(1, (1, 1)), (2, (1, 2)), (3, (1, 3)), (4, (2, 2)), (5, (2, 3))])
def test_every_key_has_its_panel(n, shape):
    point = EffectPoint((1.0,) * n, ("",) * n, (1.0,), 1.0, 0.1)
    panels = drawn([SLOPE] * n, [point])
    assert len(panels) == n
    assert panels[0].get_subplotspec().get_gridspec().get_geometry() == shape
