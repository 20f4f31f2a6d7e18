"""The long section says how many times its heights are exaggerated."""

import re

import numpy as np
import pytest

from ryusa.figures.long_section import long_section
from ryusa.measure.long_section import LongSection


@pytest.mark.parametrize(("length", "fall"), [(2.0, 0.1), (100.0, 20.0), (0.2, 0.3)])
def test_the_exaggeration_is_that_of_the_picture(length: float, fall: float) -> None:
    n = 20
    x = (np.arange(n) + 0.5) * length / n
    bottom, level = fall * (1.0 - x / length), np.full(n, 0.0)
    names = ("speed", "froude", "discharge", "critical", "tau", "volume", "solid_discharge",
             "transport_concentration", "concentration")  # fmt: skip
    found = LongSection(
        t=1.0, slope=0.0, x=x, bottom=bottom, floor=bottom, bed=bottom, surface=bottom + 0.1 * fall,
        depth=np.full(n, 0.1 * fall), energy=bottom + 0.2 * fall, dams=(), **dict.fromkeys(names, level),
    )  # fmt: skip
    figure = long_section(found)
    figure.canvas.draw()
    axes = figure.axes[0]
    (said,) = [
        one.get_text() for one in axes.texts if "heights" in one.get_text() or one.get_text() == "to scale"
    ]
    factor = 1.0 if "(m)" in axes.get_ylabel() else 100.0
    (x_0, z_0), (x_1, z_1) = axes.transData.transform([(0.0, 0.0), (length, fall * factor)])
    times = (z_1 - z_0) / fall / ((x_1 - x_0) / length)
    number = re.search(r"[0-9.]+(e[+-][0-9]+)?", said)
    assert (float(number[0]) if number else 1.0) == pytest.approx(times, rel=0.06)
    assert axes.get_xlim() == pytest.approx((0.0, length))
