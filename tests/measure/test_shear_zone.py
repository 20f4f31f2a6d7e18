import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.figures.shear_zone import shear_zone as drawn
from ryusa.measure import shear_zone
from ryusa.measure.shear_zone import zone
from ryusa.model.walls import AXIS_POINT, N_IMPULSE, SPIN, FaceKind, Walls, at_rest

D, R_S, R_0, HEIGHT, RATE = 0.005, 0.05, 0.075, 0.025, 0.8
CENTRE, WIDTH, SHARE = 0.043, 0.009, 0.95


def turned(make, *, rate=RATE, tilt=0.0, off=0.0, change=0.0):
    """A run whose grains turn by an error function of the radius, with torques in balance."""
    rng, n = np.random.default_rng(2), 6000
    r, phi = R_0 * np.sqrt(rng.uniform(0.0, 1.0, n)), rng.uniform(0.0, 2.0 * np.pi, n)
    x = np.column_stack([r * np.cos(phi), r * np.sin(phi), rng.uniform(0.5 * D, HEIGHT - 0.5 * D, n)])
    omega = rate * zone(r, CENTRE, WIDTH, SHARE)
    v = np.column_stack([-omega * x[:, 1], omega * x[:, 0], np.zeros(n)])
    motion = at_rest(2)
    motion[1, SPIN : SPIN + 3] = rate * math.sin(tilt), 0.0, rate * math.cos(tilt)
    motion[1, AXIS_POINT], motion[0, AXIS_POINT] = off, 0.01
    face = np.zeros((2, 9))
    face[:, 5], face[:, 6] = 1.0, (0.08, R_S)
    number = np.array([0, 1])
    walls = Walls(
        face=face, kind=np.full(2, FaceKind.DISC), wall=number, surface=number,
        active=np.ones(2, dtype=bool), motion=motion, names=("floor", "disc"),
    )  # fmt: skip
    scene = replace(make.scene(n), d=np.full(n, D), m=np.ones(n), walls=walls, plane_case=False)
    t = np.linspace(0.0, 1.0, 101)
    impulse = np.zeros((len(t), 2, N_IMPULSE))
    impulse[:, 1, 5] = -2.0 * (1.0 + change) * t
    # on the floor a force along y at its axis point, whose arm about the axis is 0.01 m, beside a torque
    impulse[:, 0, 1], impulse[:, 0, 5] = 50.0 * t, 1.5 * t
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


@pytest.mark.parametrize("rate", [RATE, -RATE])
def test_centre_and_width_of_a_known_zone_are_found_at_the_surface_and_at_every_height(make, rate):
    found = shear_zone(turned(make, rate=rate))
    assert found.centre == pytest.approx(CENTRE, rel=0.01)
    assert found.width == pytest.approx(WIDTH, rel=0.05)
    assert found.share == pytest.approx(SHARE, rel=0.02)
    assert found.misfit < 0.05
    assert found.height == pytest.approx(HEIGHT, rel=0.05)
    np.testing.assert_allclose(found.centres, CENTRE, rtol=0.02)
    assert found["centre"].value == pytest.approx(found.centre, rel=1e-6)
    assert len(drawn(found).axes) == 2


def test_torques_are_about_the_axis_and_balance_the_angular_momentum(make):
    found = shear_zone(turned(make))
    assert found.torque == pytest.approx((-2.0, 1.5 + 0.01 * 50.0))
    assert found.change < 1e-12
    assert shear_zone(turned(make, change=0.1)).change == pytest.approx(0.1 / 1.1)


def test_a_disc_that_does_not_turn_about_its_own_upright_axis_has_no_zone(make):
    for wrong in ({"rate": 0.0}, {"tilt": 0.3}, {"off": 0.01}):
        with pytest.raises(ResultsError, match="no level disc that turns about its own upright axis"):
            shear_zone(turned(make, **wrong))


def test_grains_that_turn_as_one_have_no_zone(make):
    run = turned(make)
    run.frames.v[:] = 0.0
    with pytest.raises(ResultsError, match="no shear zone"):
        shear_zone(run)
