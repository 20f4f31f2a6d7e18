"""Picture of dispersion."""

from dataclasses import replace

import numpy as np
import pytest

from ryusa.figures.dispersion import dispersion
from ryusa.measure import Averages, average
from ryusa.measure.dispersion import Dispersion

LAG = 0.01 * np.arange(1, 25)
D_X, D_Z = 4.0e-6, 1.5e-6  # m2/s


def spread(plane=False):
    """Grains that diffuse along x and normal to the bed, and fly across."""
    values = {"along": D_X, "across": 0.0, "normal": D_Z}
    chosen = ("along", "normal") if plane else ("along", "across", "normal")
    rng = np.random.default_rng(1)
    items = [
        average(f"diffusivity_{name}", "m2/s", [values[name] * rng.normal(1.0, 0.01, 4000)])
        for name in chosen
    ]
    return Dispersion(
        lag=LAG, along=1.0e-9 + 2.0 * D_X * LAG, across=1.0e-6 * LAG**2, normal=2.0 * D_Z * LAG,
        fit=(LAG[12], LAG[-1]), averages=Averages("dispersion", tuple(items)),
    )  # fmt: skip


def by_label(axes, start):
    return next(line for line in axes.lines if line.get_label().startswith(start))


def test_displacements_are_drawn_in_square_millimetres_over_lag_with_their_diffusivities():
    found = spread()
    (axes,) = dispersion(found).axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert axes.get_ylabel().endswith("(mm$^2$)")
    for name in ("along", "across", "normal"):
        line = by_label(axes, name)
        assert line.get_xdata() == pytest.approx(LAG)
        assert line.get_ydata() == pytest.approx(1.0e6 * getattr(found, name))
    words = by_label(axes, "along").get_label()
    assert r"$4 \pm 0.00" in words
    assert r"\times 10^{-6}$ m$^2$/s, steady: yes" in words


def test_the_fitted_line_has_twice_the_diffusivity_as_slope_and_spans_the_lags_of_the_fit():
    found = spread()
    (axes,) = dispersion(found).axes
    fitted = [line for line in axes.lines if line.get_color() == "black"]
    assert len(fitted) == 3
    for line, one in zip(fitted, found.averages.items, strict=True):
        x, y = line.get_data()
        assert (x[0], x[-1]) == pytest.approx(found.fit)
        assert np.diff(y) / np.diff(x) == pytest.approx(2.0e6 * one.value, abs=1e-6)
    x, y = fitted[0].get_data()
    assert y == pytest.approx(1.0e6 * found.along[12:], rel=0.01)
    (band,) = axes.patches
    assert (band.get_x(), band.get_x() + band.get_width()) == pytest.approx(found.fit)


def test_dotted_lines_grow_as_diffusion_and_as_flight():
    (axes,) = dispersion(spread()).axes
    dotted = [line for line in axes.lines if line.get_linestyle() == ":"]
    for line, power in zip(dotted, (1.0, 2.0), strict=True):
        y = line.get_ydata()
        assert y[-1] / y[0] == pytest.approx((LAG[-1] / LAG[0]) ** power)


def test_a_plane_scene_has_no_curve_across_and_grains_at_rest_can_be_drawn():
    (axes,) = dispersion(spread(plane=True)).axes
    assert not any(line.get_label().startswith("across") for line in axes.lines)
    still = replace(spread(), along=0.0 * LAG, across=0.0 * LAG, normal=0.0 * LAG)
    dispersion(still).canvas.draw()
