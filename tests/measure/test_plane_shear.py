import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import ryusa
from ryusa.cases import case_path
from ryusa.errors import ResultsError
from ryusa.figures.plane_shear import GLASS_BEADS
from ryusa.figures.plane_shear import plane_shear as drawn
from ryusa.laws.dense_flow import mu_of_inertial_number
from ryusa.measure import plane_shear
from ryusa.model.walls import ASKED, N_IMPULSE, N_SERVO, TOWARDS, VELOCITY, FaceKind, Walls, at_rest

D, LENGTH, WIDTH, HEIGHT = 0.002, 0.02, 0.01, 0.03
RATE, PRESSURE, MU = 25.0, 400.0, 0.45


def sheared(make, *, along=1.0, towards=-1.0, speed=0.75, spin=0.0, servos=1):
    """A run whose grains have a linear velocity between two plates, under known forces."""
    rng, n = np.random.default_rng(1), 3000
    x = rng.uniform(0.0, 1.0, (n, 3)) * (LENGTH, WIDTH, HEIGHT)
    height = x[:, 2] if towards < 0.0 else HEIGHT - x[:, 2]
    v = np.zeros((n, 3))
    v[:, 0] = along * RATE * height
    motion, servo = at_rest(2), np.zeros((2, N_SERVO))
    motion[1, VELOCITY], motion[1, VELOCITY + 4] = along * speed, spin
    for k in range(servos):
        servo[1 - k, TOWARDS + 2], servo[1 - k, ASKED] = towards, PRESSURE * LENGTH * WIDTH
    number = np.array([0, 1])
    walls = Walls(
        face=np.ones((2, 9)), kind=np.full(2, FaceKind.TRIANGLE), wall=number, surface=number,
        active=np.ones(2, dtype=bool), motion=motion, names=("base", "lid"), servo=servo,
    )  # fmt: skip
    d = np.full(n, D)
    scene = replace(
        make.scene(n), d=d, m=2500.0 * np.pi / 6.0 * d**3, walls=walls, plane_case=False,
        period=(LENGTH, WIDTH), x_fixed=np.zeros((0, 3)), d_fixed=np.zeros(0), fixed_active=np.zeros(0, bool),
    )  # fmt: skip
    t, area = np.linspace(0.0, 1.0, 41), LENGTH * WIDTH
    impulse = np.zeros((len(t), 2, N_IMPULSE))
    impulse[:, 1, 2] = -towards * PRESSURE * area * t
    impulse[:, 1, 0] = -along * MU * PRESSURE * area * t
    impulse[:, 0] = -impulse[:, 1]
    frames = SimpleNamespace(t=t, x=np.repeat(x[None], len(t), 0), v=np.repeat(v[None], len(t), 0))
    frames.omega = np.zeros_like(frames.v)
    return SimpleNamespace(
        case={},
        frames=frames,
        scene=scene,
        walls=impulse,
        row=None,
        wall_travel=np.zeros((len(t), 2)),
        tally={"t": t},
    )


@pytest.mark.parametrize("along", [1.0, -1.0])
@pytest.mark.parametrize("towards", [-1.0, 1.0])
def test_friction_and_inertial_number_are_those_of_known_forces_and_a_known_profile(make, along, towards):
    run = sheared(make, along=along, towards=towards)
    found = plane_shear(run)
    assert found.mu == pytest.approx(MU)
    assert found["normal"].value == pytest.approx(PRESSURE)
    assert found.inertial == pytest.approx(RATE * D * math.sqrt(2500.0 / PRESSURE), rel=0.02)
    assert found["inertial_number"].value == pytest.approx(found.inertial, rel=1e-9)
    solid = run.scene.solid_volume.sum() / (LENGTH * WIDTH * HEIGHT)
    assert found["phi"].value == pytest.approx(solid, rel=0.02)
    assert found.base == pytest.approx(-1.0)
    assert found.curvature < 0.02
    assert len(drawn(found).axes) == 3


def test_a_profile_that_bends_is_no_line(make):
    run = sheared(make)
    run.frames.v[:, :, 0] = RATE * run.frames.x[:, :, 2] ** 2 / HEIGHT
    assert plane_shear(run).curvature > 0.05


def test_what_is_no_plane_shear_is_refused_by_name(make):
    for wrong, says in (
        ({"servos": 0}, "one wall with a servo"), ({"servos": 2}, "the run has 2"),
        ({"speed": 0.0}, "not drawn along x"), ({"spin": 1.0}, "not drawn along x"),
        ({"towards": -0.5}, "not pressed along z"),
    ):  # fmt: skip
        with pytest.raises(ResultsError, match=says):
            plane_shear(sheared(make, **wrong))


@pytest.mark.slow
def test_the_packaged_cell_has_the_friction_of_glass_beads(tmp_path: Path) -> None:
    case = ryusa.load(case_path("shear_cell.toml"), {"stop.time": "0.9 s"})
    found = plane_shear(ryusa.run(case, tmp_path / "run", progress=False))
    assert found["normal"].value == pytest.approx(500.0, rel=0.2)  # it fluctuates by a third
    assert 0.05 < found.inertial < 0.15
    assert found.mu == pytest.approx(mu_of_inertial_number(found.inertial, *GLASS_BEADS), rel=0.15)
    assert found.base == pytest.approx(-1.0, abs=0.03)
    assert found.curvature < 0.1
