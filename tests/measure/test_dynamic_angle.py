import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import ryusa
from ryusa.cases import case_path
from ryusa.errors import ResultsError
from ryusa.figures.dynamic_angle import dynamic_angle as drawn
from ryusa.measure import dynamic_angle, walls
from ryusa.model.walls import SPIN, FaceKind, Walls, at_rest

D, RADIUS, WIDTH = 0.002, 0.05, 0.01


def turning(make, degrees, *, fill=0.3, spin=2.0, axis=(0.0, 1.0, 0.0)):
    """A run of one frame: grains below a flat surface at an angle, in a drum about y."""
    at = np.arange(-RADIUS, RADIUS, 0.25 * D)
    x, y, z = (one.ravel() for one in np.meshgrid(at, np.arange(0.0, WIDTH, D), at, indexing="ij"))
    slope = math.radians(degrees)
    below = z * math.cos(slope) - x * math.sin(slope) < -fill * RADIUS
    inside = np.hypot(x, z) < RADIUS - 0.5 * D
    places = np.column_stack([x, y, z])[below & inside]
    n = len(places)
    motion = at_rest(1)
    motion[0, SPIN : SPIN + 3] = 0.0, spin, 0.0
    face = np.zeros((1, 9))
    face[0, 3:6], face[0, 6:8] = axis, (RADIUS, WIDTH)
    number = np.zeros(1, dtype=np.int64)
    drum = Walls(
        face=face, kind=np.array([FaceKind.CYLINDER]), wall=number, surface=number,
        active=np.ones(1, dtype=bool), motion=motion, names=("drum",),
    )  # fmt: skip
    scene = replace(make.scene(n), d=np.full(n, D), m=np.ones(n), walls=drum, plane_case=False)
    frames = SimpleNamespace(t=np.array([0.0]), x=places[None])
    return SimpleNamespace(case={}, frames=frames, scene=scene)


@pytest.mark.parametrize("degrees", [10.0, 28.0, 45.0])
@pytest.mark.parametrize("spin", [2.0, -2.0])
def test_a_flat_surface_is_found_by_its_grains_and_by_its_mass(make, degrees, spin):
    # a positive spin about y moves the lower wall towards -x, so that grains rise there
    found = dynamic_angle(turning(make, -math.copysign(degrees, spin), spin=spin))
    assert math.degrees(found.surface[0]) == pytest.approx(degrees, abs=0.7)
    assert math.degrees(found.mass[0]) == pytest.approx(degrees, abs=0.2)
    assert found.froude == pytest.approx(4.0 * RADIUS / 9.80665)
    assert found.offset[0] > 0.0


def test_a_cylinder_that_does_not_turn_about_its_level_axis_is_no_drum(make):
    for wrong in (turning(make, 20.0, spin=0.0), turning(make, 20.0, axis=(1.0, 0.0, 0.0))):
        with pytest.raises(ResultsError, match="no cylinder that turns about its own level axis"):
            dynamic_angle(wrong)


@pytest.mark.slow
def test_the_torque_on_the_drum_is_the_weight_times_the_offset_of_its_centre_of_mass(tmp_path: Path) -> None:
    run = ryusa.run(ryusa.load(case_path("drum.toml")), tmp_path / "run", progress=False)
    found = dynamic_angle(run)
    weight = float(run.scene.m.sum()) * 9.80665
    torque = -float(walls(run).torque[:, 0, 1].mean())
    assert torque == pytest.approx(weight * found.offset.mean(), rel=0.005)  # measured: 5e-4
    assert math.degrees(np.mean(found.surface) - np.mean(found.mass)) == pytest.approx(0.0, abs=2.0)
    assert run.tally["residual"].max() < 1e-3
    assert len(drawn(found).axes) == 1
