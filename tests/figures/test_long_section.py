"""The long section says how many times its heights are exaggerated."""

import re
from dataclasses import replace

import numpy as np
import pytest

from ryusa.figures.long_section import long_section
from ryusa.measure.long_section import LongSection


def section(x, bottom, floor, bed, surface, dams=()):
    """A long section of still water."""
    names = ("speed", "froude", "discharge", "critical", "tau", "volume", "solid_discharge",
             "transport_concentration", "concentration")  # fmt: skip
    return LongSection(
        t=1.0, slope=0.0, x=x, bottom=bottom, floor=floor, bed=bed, surface=surface, depth=surface - bed,
        energy=surface, dams=dams, **dict.fromkeys(names, np.zeros(len(x))),
    )  # fmt: skip


@pytest.mark.parametrize(("length", "fall"), [(2.0, 0.1), (100.0, 20.0), (0.2, 0.3)])
def test_the_exaggeration_is_that_of_the_picture(length: float, fall: float) -> None:
    x = (np.arange(20) + 0.5) * length / 20
    bottom = fall * (1.0 - x / length)
    figure = long_section(section(x, bottom, bottom, bottom, bottom + 0.1 * fall))
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


def test_the_surface_is_drawn_over_a_bed_and_up_to_the_faces_of_a_dry_dam() -> None:
    x = np.arange(20) + 0.5
    bottom, dam = np.zeros(20), (x > 10.0) & (x < 12.0)
    floor = np.where(dam, 2.0, 0.0)
    bed, surface = np.where(x < 5.0, 0.3, floor), np.where(dam, floor, 1.0)
    figure = long_section(section(x, bottom, floor, bed, surface, dams=(("dam", 10.0, 12.0),)))
    (line,) = (one for one in figure.axes[0].lines if one.get_label() == "surface")
    factor = 1.0 if "(m)" in figure.axes[0].get_ylabel() else 100.0
    at, z = line.get_xydata().T
    assert np.nanmin(z) == np.nanmax(z) == pytest.approx(factor)
    wet = at[np.isfinite(z)]
    assert wet[wet < 11.0].max() == 10.0 and wet[wet > 11.0].min() == 12.0


def test_water_and_bottom_reach_the_ends_of_the_row_and_a_fast_flow_has_its_energy_line() -> None:
    x, one = np.arange(8) + 0.5, np.ones(8)
    fast = section(x, 0.0 * x, 0.0 * x, 0.0 * x, one)
    axes = long_section(replace(fast, energy=1.9 * one)).axes[0]
    factor = 1.0 if "(m)" in axes.get_ylabel() else 100.0
    (surface,) = (one for one in axes.lines if one.get_label() == "surface")
    at = surface.get_xdata()
    assert (np.nanmin(at), np.nanmax(at)) == (0.0, 8.0)
    assert any(np.ptp(one.get_xdata()) == 8.0 for one in axes.lines if one is not surface)  # the bottom
    assert axes.get_ylim()[1] > 1.9 * factor
    assert len(long_section(fast, alone=True).axes) == 1


def test_a_film_of_water_does_not_set_the_axes() -> None:
    x = np.arange(10) + 0.5
    bottom = np.zeros(10)
    surface = np.where(x < 2.0, 1.0, 1e-5)
    film = section(x, bottom, bottom, bottom, surface)
    film = replace(film, froude=np.where(x < 2.0, 0.5, 1e4), energy=np.where(x < 2.0, 1.1, 1e3))
    elevations, froude, *_ = long_section(film).axes
    factor = 1.0 if "(m)" in elevations.get_ylabel() else 100.0
    assert elevations.get_ylim()[1] < 1.5 * factor
    assert froude.get_ylim()[1] < 10.0
