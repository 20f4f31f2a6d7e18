"""Profiles and ways from a start: drawn in the paper's units, with errors, for several runs."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.collections import PolyCollection

from ryusa import figures
from ryusa.measure import Tracks, profiles
from ryusa.model import EVENT, ContactLaw, Scene

D = 0.002


@pytest.fixture(scope="module")
def found():
    rng = np.random.default_rng(0)
    n, one = 30, np.ones(30)
    scene = Scene(
        d=D * one, m=one, m_added=0 * one, m_weight=one, inertia=one,
        x_fixed=np.array([[0.0, 0.0, 0.5 * D]]), d_fixed=np.array([D]), fixed_active=np.ones(1, dtype=bool),
        plane_normal=np.zeros((0, 3)), plane_point=np.zeros((0, 3)), plane_active=np.zeros(0, dtype=bool),
        contact=ContactLaw(k_n=1.0, k_s=1.0, mu=0.5), dt=1.0, plane_case=True, period=(20 * D, np.inf),
    )  # fmt: skip
    x = rng.uniform(0, 1, (20, n, 3)) * [20 * D, 0, 8 * D] + [0, 0, 1.5 * D]
    frames = SimpleNamespace(t=np.arange(20.0), x=x, v=np.full(x.shape, 0.5), omega=0 * x)
    run = SimpleNamespace(case={}, frames=frames, scene=scene, contacts=np.zeros(0, EVENT), tally={})
    return profiles(run, bed=True)


def test_runs_share_panels_with_an_error_band_and_a_line_each(found):
    figure = figures.profiles({"soft": found, "stiff": found})
    figure.canvas.draw()
    assert len(figure.axes) == 2
    assert figure.axes[1].get_xlabel().endswith("(cm/s)")
    assert figure.axes[0].get_ylabel() == "height above datum  $z$  (cm)"
    speed = figure.axes[1].lines[0].get_xdata()
    assert np.nanmax(np.asarray(speed, dtype=float)) == pytest.approx(50.0)
    bands = [one for one in figure.axes[0].collections if isinstance(one, PolyCollection)]
    assert len(bands) == 2
    assert len({line.get_linestyle() for line in figure.axes[1].lines[:2]}) == 2


def test_the_bed_is_shaded_over_whole_layers_and_does_not_stretch_the_axis_of_few_grains(found):
    (bed,) = figures.profiles({"one": found}).axes[0].patches
    values, edges, _ = bed.get_data()
    assert values == pytest.approx(found.bed)
    assert edges[:-1] == pytest.approx(100.0 * (found.z - 0.5 * found.thickness))
    few = replace(found, phi=replace(found.phi, value=1e-3 * found.phi.value, error=1e-3 * found.phi.error))
    panel = figures.profiles({"one": few}).axes[0]
    assert panel.get_xlim()[1] < 1.3 * few.phi.value.max() < found.bed.max()


def test_the_axis_names_another_zero_than_the_datum(found):
    crest = figures.profiles({"one": replace(found, above="bed crest")})
    assert crest.axes[0].get_ylabel() == "height above bed crest  $z$  (cm)"


def test_heights_may_be_in_diameters_and_panels_as_many_as_asked(found):
    figure = figures.profiles({"one": found}, ("phi", "flux", "temperature_z"), height="d", area=True)
    figure.canvas.draw()
    assert "z/d" in figure.axes[0].get_ylabel()
    assert len(figure.axes) == 3
    assert 9 < figure.axes[0].get_ylim()[1] < 12


def test_paths_start_at_zero_to_scale_and_do_not_cross():
    t = np.linspace(0.0, 1.0, 101)
    x = 5 * D + 0.02 * np.outer(t, [1.0, 2.0, 3.0])
    z = 2 * D + D * np.sin(20 * np.outer(t, [1.0, 2.0, 3.0]))
    way = Tracks((0, 1, 2), t, x, z, np.full(3, D), *6 * [np.zeros(0)], np.inf)
    figure = figures.tracks_from_start({"soft": way, "stiff": way})
    figure.canvas.draw()
    assert len(figure.axes) == 2
    for axes in figure.axes:
        assert axes.get_aspect() == 1.0
        lines = [np.asarray(line.get_ydata(), dtype=float) for line in axes.lines[:3]]
        assert all(line.get_xdata()[0] == 0.0 for line in axes.lines[:3])
        assert lines[0].max() < lines[1].min() < lines[1].max() < lines[2].min()
