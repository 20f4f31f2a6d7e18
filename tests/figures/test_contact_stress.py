"""The picture of the contact stress shows what the measure found."""

import math
from dataclasses import replace

import numpy as np

from ryusa.figures.contact_stress import contact_stress
from ryusa.measure import Averages, Layers
from ryusa.measure.contact_stress import ContactStress

Z = np.arange(-2.0, 9.0) * 1e-3


def found():
    """Weight and stress that fall linearly over height, and mu that grows with I."""

    def layers(name, value):
        return Layers(name, "Pa", value, 0.02 * np.abs(value) + 0.1)

    line = 200.0 * np.clip(1.0 - Z / 8e-3, 0.0, 1.0)
    some = {name: layers(name, line) for name in ("xx", "yy", "zz", "contact_zz", "p")}
    shear = {name: layers(name, -0.4 * line) for name in ("xz", "zx", "contact_xz")}
    return ContactStress(
        z=Z, length=1e-3, crest=2e-3, phi=layers("phi", 0.6 * (Z < 6e-3)), v_x=layers("v_x", 10.0 * Z),
        mu=layers("mu", 0.3 + 20.0 * Z), shear_rate=np.full(len(Z), 10.0), inertial_number=0.01 + 10.0 * Z,
        weight=line, weight_along=0.4 * line, deviation=0.01, deviation_along=0.01,
        **{f"fabric_{one}": layers(f"fabric_{one}", 0.0 * line) for one in ("xx", "zz", "xz")}, area=1e-4,
        averages=Averages("contact_stress", ()), **some, **shear,
    )  # fmt: skip


def test_stress_and_weight_above_lie_on_each_other_and_mu_stands_over_i():
    one = found()
    left, right = contact_stress(one).axes
    normal, weight, shear, along = (line.get_xdata() for line in left.get_lines()[:4])
    np.testing.assert_allclose(normal, weight)
    np.testing.assert_allclose(shear, 0.4 * one.weight)
    np.testing.assert_allclose(shear, along)
    inertial, mu = right.get_lines()[0].get_data()
    dense = (one.crest < Z) & (Z < 6e-3)
    np.testing.assert_allclose(inertial, one.inertial_number[dense])
    np.testing.assert_allclose(mu, one.mu.value[dense])


def test_under_water_no_weight_is_drawn():
    figure = contact_stress(replace(found(), deviation=math.nan))
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        r"$\sigma_{zz}$",
        r"$-\sigma_{xz}$",
        "crest of the bed",
    ]


def test_the_crest_of_the_bed_is_marked_on_heights_above_datum():
    left, _ = contact_stress(found()).axes
    assert left.get_ylabel() == "height above datum  $z$  (cm)"
    crest = next(line for line in left.get_lines() if line.get_label() == "crest of the bed")
    np.testing.assert_allclose(crest.get_ydata(), 0.2)
    bare, _ = contact_stress(replace(found(), crest=math.nan)).axes
    assert "crest of the bed" not in bare.get_legend_handles_labels()[1]


def test_the_legend_lies_over_no_curve():
    figure = contact_stress(found())
    figure.canvas.draw()
    legend = figure.legends[0].get_window_extent()
    assert not any(legend.overlaps(axes.get_window_extent()) for axes in figure.axes)
