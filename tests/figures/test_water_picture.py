"""Picture of the water over height."""

from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.figures.water import water
from ryusa.measure import Layers

FACES = np.linspace(0.0, 0.02, 21)
Z = 0.5 * (FACES[1:] + FACES[:-1])


def layers(name, value):
    return Layers(name, "", value, np.zeros(len(value)))


def profile(phi):
    """Water 2 cm deep in 20 cells over a bed of 1 cm, 9 cm/s in the lowest two cells and 1 cm/s above."""
    u = np.where(Z < 0.002, 0.09, 0.01)
    still = layers("v_x", np.zeros(2))
    grains = SimpleNamespace(z=np.array([0.0, 0.01]), v_x=still, phi=layers("phi", np.ones(2)))
    return SimpleNamespace(
        z=Z, faces=FACES, u=layers("u", u), phi=layers("phi", phi), tau=layers("tau", np.ones(21)),
        grains=grains, bed=0.01, surface=0.02, tau_bed=np.nan,
    )  # fmt: skip


def test_water_in_empty_pores_under_the_bed_is_not_drawn_and_the_caption_says_so():
    phi = np.where(Z < 0.002, 0.1, np.where(Z < 0.01, 0.6, 0.0))
    figure = water(profile(phi))
    drawn = np.asarray(figure.axes[0].lines[0].get_xdata())
    assert np.isnan(drawn[:3]).all()
    assert drawn[3:] == pytest.approx(1.0)
    assert "below z = 0.25 cm" in figure.get_supxlabel()


def test_water_down_to_the_bottom_of_a_packed_column_is_drawn():
    figure = water(profile(np.where(Z < 0.01, 0.6, 0.0)))
    assert np.isfinite(np.asarray(figure.axes[0].lines[0].get_xdata())).all()
    assert figure.get_supxlabel() == ""
    assert figure.axes[0].get_ylabel() == "height above datum  $z$  (cm)"
