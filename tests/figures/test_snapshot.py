"""Pictures of two moments of one run have the same axes and the same scale of colours."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa import figures
from ryusa.build import scene as scene_of
from ryusa.build.walls import WallMotion, cylinder, rectangle
from ryusa.measure.snapshot import Snapshot, _lines_of_walls, snapshot
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

D = 0.002


@pytest.fixture(scope="module")
def falling(tmp_path_factory: pytest.TempPathFactory):
    """Two grains that fall on a floor and roll apart on it."""
    scene, state = scene_of(
        x=[(0.0, 0.0, 0.52 * D), (0.2 * D, 0.0, 6 * D)], d=D, v=[(0.0, 0.0, 0.0), (0.3, 0.0, 0.0)],
        planes=[("floor", (0, 0, 0), (0, 0, 1))], plane_case=True,
    )  # fmt: skip
    folder = tmp_path_factory.mktemp("runs") / "falling"
    return run_scene(scene, state, folder, frames=5e-3, stop=Stop(time=0.1), progress=False)


@pytest.mark.parametrize("colour", ["speed", "spin"])
def test_two_moments_can_be_laid_over_each_other(falling, colour):
    first, last = (falling.draw("grains", t=t, colour=colour) for t in (0.0, 0.1))
    for figure in (first, last):
        figure.canvas.draw()
    (one, bar), (other, other_bar) = (
        (figure.axes[0], figure.axes[0].child_axes[0]) for figure in (first, last)
    )
    assert one.get_xlim() == other.get_xlim()
    assert one.get_ylim() == other.get_ylim()
    assert bar.get_xlim() == other_bar.get_xlim()
    assert tuple(first.get_size_inches()) == tuple(last.get_size_inches())
    unit = {"speed": "(m/s)", "spin": "(rad/s)"}[colour]
    assert any(unit in text.get_text() for text in bar.texts)


def test_the_axes_hold_the_grains_at_all_times(falling):
    axes = falling.draw("grains", t=0.0).axes[0]
    x = falling.frames.x[:]
    assert axes.get_xlim()[0] < 100 * (x[..., 0].min() - 0.5 * D)
    assert 100 * (x[..., 0].max() + 0.5 * D) < axes.get_xlim()[1]
    assert axes.get_ylim()[1] > 100 * 6.5 * D  # where the upper grain began


def test_forces_are_drawn_in_the_axes_of_the_grains(falling):
    grains, forces = falling.draw("grains", t=0.0).axes[0], falling.draw("forces", t=0.1).axes[0]
    assert grains.get_xlim() == forces.get_xlim()
    assert grains.get_ylim() == forces.get_ylim()


def test_a_lid_that_is_dragged_on_is_drawn_over_the_whole_period():
    lid = replace(
        rectangle("lid", (0, 0, 10 * D), (8 * D, 0, 0), (0, 4 * D, 0)), motion=WallMotion((11 * D, 0, 0))
    )
    scene, _ = scene_of(x=[(D, D, D)], d=D, period=(8 * D, 4 * D), walls=[lid])
    frames = SimpleNamespace(
        t=[0.0, 1.0], x=[np.full((1, 3), D)] * 2, v=[np.zeros((1, 3))] * 2, omega=[np.zeros((1, 3))] * 2
    )
    lines = snapshot(SimpleNamespace(scene=scene, frames=frames), t=1.0).wall_lines
    along = lines[(np.ptp(lines[:, :, 1], axis=1) == 0.0)]
    assert along[:, :, 0].min() == pytest.approx(0.0, abs=1e-12)
    assert along[:, :, 0].max() == pytest.approx(8 * D)
    assert np.ptp(along[:, :, 0], axis=1).sum() == pytest.approx(2 * 8 * D)  # each side of the lid once


def seen_in(lines, x, **more):
    x = np.array(x)
    return Snapshot(**{
        "t": 0.0, "grains": np.arange(len(x)), "x": x, "d": np.full(len(x), D), "speed": np.zeros(len(x)),
        "spin": np.zeros(len(x)), "bed_x": np.zeros((0, 3)), "bed_d": np.zeros(0),
        "plane_point": np.zeros((0, 3)), "plane_normal": np.zeros((0, 3)), "period": np.inf,
        "wall_lines": lines, **more,
    })  # fmt: skip


@pytest.mark.parametrize(("radius", "whole"), [(12 * D, True), (40 * D, False)])
def test_a_drum_that_is_not_much_larger_than_its_grains_is_shown_whole(radius, whole):
    drum = cylinder("drum", (0, -2 * D, 0), (0, 4 * D, 0), radius)
    scene, _ = scene_of(x=[(0, 0, 0)], d=D, walls=[drum])
    seen = seen_in(_lines_of_walls(scene, 0.0), [(-9 * D, 0, -9 * D), (9 * D, 0, 9 * D)])
    axes = figures.snapshot(seen).axes[0]
    assert bool(axes.get_xlim()[1] > 100 * radius) is whole
    assert bool(axes.get_ylim()[1] > 100 * radius) is whole


def test_an_upright_cylinder_is_drawn_by_its_outline_without_lines_inside():
    silo = cylinder("silo", (0, 0, 0), (0, 0, 20 * D), 6 * D)
    scene, _ = scene_of(x=[(0, 0, D)], d=D, walls=[silo])
    lines = _lines_of_walls(scene, 0.0)
    upright = lines[np.ptp(lines[:, :, 2], axis=1) > D]
    assert sorted(upright[:, :, 0].mean(axis=1)) == pytest.approx([-6 * D, 6 * D])


def test_a_picture_of_some_metres_is_labelled_in_metres():
    seen = seen_in(np.zeros((0, 2, 3)), [(0, 0, 0), (4.0, 0, 1.0)], d=np.full(2, 0.1))
    axes = figures.snapshot(seen).axes[0]
    axes.figure.canvas.draw()
    assert axes.get_xlabel() == "$x$  (m)"
    numbers = [float(one.get_text().replace("\N{MINUS SIGN}", "-")) for one in axes.get_xticklabels()]
    assert max(numbers) < 5.0


def test_water_over_a_bed_ends_at_the_period():
    seen = seen_in(np.zeros((0, 2, 3)), [(D, 0, D)], period=4 * D, surface=30 * D)
    axes = figures.snapshot(seen).axes[0]
    (surface,) = (one for one in axes.lines if len(one.get_xdata()) == 2)
    assert surface.get_xdata() == pytest.approx([0.0, 400 * D])
    assert axes.get_xlim()[1] > 400 * D  # the picture is wider
