"""Speeds and pressure in the cells of a row of columns, and their picture."""

import math

import numpy as np
import pytest

from ryusa.casefile import read_text
from ryusa.figures.flow_field import flow_field as drawn
from ryusa.measure import flow_field
from ryusa.results import Results
from ryusa.running.runner import run

SLOSHES = """
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
[contact]
stiffness = "700 N/cm"
restitution = 0.5
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
[water]
profile = "column"
[water.column]
bed = "smooth"
cell = "1 cm"
mixing_length = "none"
[water.row]
bottom = [["0 m", "{low}"], ["40 cm", "0 cm"]]
segment = "2 cm"
height = "20 cm"
surface = [["0 m", "11.5 cm"], ["40 cm", "9.5 cm"]]
pressure = "{pressure}"
upstream = {{ end = "wall" }}
downstream = {{ end = "wall" }}
[build]
kind = "empty"
[stop]
time = "0.2 s"
[record]
frames = "0.1 s"
"""


def sloshing(folder, pressure="full", low="0 cm") -> Results:
    return run(read_text(SLOSHES.format(pressure=pressure, low=low)), folder / "run", progress=False)


def test_water_that_sloshes_has_speeds_and_pressure_below_its_surface(tmp_path):
    """Airy: at the floor u = a g k/(omega cosh kh) sin(omega t), a = 8/pi^2 cm; p' < 0 below a crest."""
    made = sloshing(tmp_path)
    found = flow_field(made)
    assert found.t == pytest.approx(0.2)
    wet = found.z - 0.005 < found.surface[:, None]
    assert np.array_equal(np.isfinite(found.u), wet) and found.pressure is not None
    known = np.isfinite(found.pressure)
    assert (known <= wet).all() and (wet.sum(axis=1) - known.sum(axis=1) == 1).all()
    first = flow_field(made, 0.1)
    assert first.t == pytest.approx(0.1)
    k, g = math.pi / 0.4, 9.80665
    omega = math.sqrt(g * k * math.tanh(0.105 * k))
    airy = 0.08 / math.pi**2 * g * k / omega / math.cosh(0.105 * k) * math.sin(0.1 * omega)
    assert first.u[9:11, 0] == pytest.approx(airy, rel=0.1)
    assert first.w[0, 3] < -0.005 < 0.005 < first.w[-1, 3]
    assert first.pressure[0, 0] < -5.0 < 5.0 < first.pressure[-1, 0]
    rows = first.rows()
    assert len(rows) == np.isfinite(first.u).sum()
    assert set(rows[0]) == {"x_m", "z_m", "u_m_per_s", "w_m_per_s", "phi", "pressure_Pa"}


def test_a_hydrostatic_row_has_speeds_along_its_bottom_and_no_pressure(tmp_path):
    made = sloshing(tmp_path, "hydrostatic", "4 cm")
    found = flow_field(made, 0.1)
    assert found.pressure is None and "pressure_Pa" not in found.rows()[0]
    middle = 10
    assert found.w[middle, 0] / found.u[middle, 0] == pytest.approx(-0.1, abs=0.03)


@pytest.mark.parametrize("pressure", ["full", "hydrostatic"])
def test_the_picture_has_an_arrow_at_cells_with_water(tmp_path, pressure):
    figure = drawn(flow_field(sloshing(tmp_path, pressure), 0.1))
    axes = figure.axes[0]
    arrows = next(one for one in axes.collections if type(one).__name__ == "Quiver")
    assert 100 < arrows.N <= 34 * 13
    longest = float(np.hypot(arrows.U, arrows.V).max())
    assert 0.2 < longest < 0.5 and math.isfinite(longest)
    label = figure.axes[1].get_ylabel()
    assert ("hydrostatic" in label) == (pressure == "full")
