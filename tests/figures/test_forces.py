"""The network of contact forces: lines to scale in N, between the centres of grains."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from ryusa import figures
from ryusa.figures.forces import CM, SLIDES
from ryusa.measure import ContactNetwork, Snapshot

D = 0.002


def column(**changes):
    """Three grains above a fixed one, each contact with the weight above; the uppermost slides."""
    x = np.array([(0.0, 0.0, (k + 1.5) * D) for k in range(3)])
    seen = Snapshot(
        t=0.5, grains=np.arange(3), x=x, d=np.full(3, D), speed=np.zeros(3), spin=np.zeros(3),
        bed_x=np.array([(0.0, 0.0, 0.5 * D)]), bed_d=np.array([D]), plane_point=np.zeros((0, 3)),
        plane_normal=np.zeros((0, 3)), period=changes.pop("period", float("inf")),
    )  # fmt: skip
    what = {
        "seen": seen, "i": np.array([0, 0, 1]), "j": np.array([3, 1, 2]), "begin": x[[0, 0, 1]],
        "end": x[[0, 1, 2]] - [[0, 0, D], [0, 0, 0], [0, 0, 0]], "f_n": 1e-4 * np.array([3.0, 2.0, 1.0]),
        "f_s": np.zeros(3), "sliding": np.array([False, False, True]), "recorded": True,
    }  # fmt: skip
    return ContactNetwork(**(what | changes))


def lines(figure):
    return [one for one in figure.axes[0].collections if isinstance(one, LineCollection)]


def words(figure):
    return figure.get_supxlabel(), [text.get_text() for text in figure.axes[0].get_legend().get_texts()]


def test_widths_are_proportional_to_the_force_and_the_scale_is_drawn_in_newtons():
    figure = figures.forces(column())
    widths = np.concatenate([one.get_linewidths() for one in lines(figure) if len(one.get_segments())])
    np.testing.assert_allclose(widths / widths[0], [1.0, 2 / 3, 1 / 3])
    scale = figure.axes[0].get_legend().get_lines()[0]
    assert scale.get_label() == r"$2 \times 10^{-4}$ N"
    assert scale.get_linewidth() == pytest.approx(widths[1])


def test_lines_run_from_centre_to_centre_and_sliding_contacts_have_their_colour():
    figure = figures.forces(column())
    sticking, sliding = lines(figure)[0].get_segments(), lines(figure)[1].get_segments()
    np.testing.assert_allclose(sticking, CM * D * np.array([[(0, 1.5), (0, 0.5)], [(0, 1.5), (0, 2.5)]]))
    np.testing.assert_allclose(sliding, CM * D * np.array([[(0, 2.5), (0, 3.5)]]))
    colours = {line.get_label(): line.get_color() for line in figure.axes[0].get_legend().get_lines()}
    assert colours["sliding"] == SLIDES != colours["sticking"]


def test_the_picture_says_how_the_forces_were_had():
    caption, labels = words(figures.forces(column()))
    assert "3 contacts" in caption and "recorded" in caption
    guessed = column(recorded=False, sliding=np.zeros(3, dtype=bool), f_s=np.full(3, np.nan))
    caption, labels = words(figures.forces(guessed))
    assert "$k_n$ times overlap" in caption and "record.forces is false" in caption
    assert labels == [r"$2 \times 10^{-4}$ N"]  # nothing is known of sliding


def test_the_slice_of_a_scene_in_three_dimensions_is_stated():
    caption, _ = words(figures.forces(column(slice_y=(0.004, 0.006), slice=2, slices=5)))
    assert "slice 2 of 5" in caption and "0.4 to 0.6 cm" in caption


def test_a_contact_that_pulls_is_told_from_one_that_pushes():
    _, labels = words(figures.forces(column(f_n=1e-4 * np.array([3.0, -2.0, 1.0]))))
    assert labels[-1] == "pulling"


def test_a_line_across_a_periodic_limit_is_drawn_at_both_ends():
    one = column(period=10 * D)
    one = replace(one, end=one.end - [0.5 * D, 0.0, 0.0])
    drawn = [kind.get_segments() for kind in lines(figures.forces(one))]
    segments = np.concatenate([some for some in drawn if len(some)])
    assert len(segments) == 6
    assert (segments[:, :, 0].max(), segments[:, :, 0].min()) == pytest.approx((1000 * D, -50 * D))


def test_a_moment_without_contacts_is_drawn_without_a_scale():
    none = np.zeros((0, 3))
    empty = column(
        i=none[:, 0], j=none[:, 0], begin=none, end=none, f_n=none[:, 0], f_s=none[:, 0],
        sliding=np.zeros(0, dtype=bool),
    )  # fmt: skip
    figure = figures.forces(empty)
    figure.canvas.draw()
    assert figure.get_supxlabel().startswith("0 contacts")
    assert figure.axes[0].get_legend() is None
