"""Ours on a reference: axes that can be read."""

import numpy as np

from ryusa.figures.comparison import Axis, Curve, compared


def named(last):
    """Words beside the ticks of a logarithmic x-axis from 10 on, within its limits."""
    x = np.geomspace(10.0, last, 4)
    figure = compared(Axis("cells", log=True), Axis("speed"), [Curve("ours", x, x)], [Curve("known", x, x)])
    figure.canvas.draw()
    axis = figure.axes[0].xaxis
    low, high = figure.axes[0].get_xlim()
    ticks = [*axis.get_major_ticks(), *axis.get_minor_ticks()]
    return [one.label1.get_text() for one in ticks if low <= one.get_loc() <= high and one.label1.get_text()]


def test_a_short_logarithmic_axis_names_plain_numbers():
    assert named(80.0) == ["10", "20", "50"]


def test_a_long_one_names_decades():
    assert all("10^" in one for one in named(1.0e4))
