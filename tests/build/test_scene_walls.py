"""Walls in a scene that is built from arrays."""

import numpy as np
import pytest

from ryusa import build
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.errors import CaseError

D, V = 2.0e-3, 0.1


def bounced(**walls):
    """Speed of a grain that fell on a floor, after it has left it."""
    scene, state = build.scene([[0.0, 0.0, 0.5001 * D]], D, v=[[0.0, 0.0, -V]], gravity=0.0, **walls)
    engine = CpuEngine()
    engine.load(scene, state)
    engine.advance(40).raise_if_any()
    return engine.state().v[0]


def test_a_grain_rebounds_from_a_rectangle_as_from_an_endless_plane():
    floor = build.rectangle("floor", (-D, -D, 0.0), (2 * D, 0.0, 0.0), (0.0, 2 * D, 0.0))
    plane = bounced(planes=[("floor", (0, 0, 0), (0, 0, 1))])
    assert plane[2] == pytest.approx(0.7 * V, rel=1e-6)
    assert bounced(walls=[floor]) == pytest.approx(plane, rel=1e-10)


def test_a_floor_that_rises_throws_the_grain_back_faster():
    up = 0.05
    corners = [[[-D, -D, 0], [D, -D, 0], [0, 2 * D, 0]]]
    floor = build.triangles("floor", corners, build.WallMotion(velocity=(0.0, 0.0, up)))
    assert bounced(walls=[floor])[2] == pytest.approx(up + 0.7 * (V + up), rel=1e-3)


def test_a_grain_far_from_the_planes_may_lie_in_a_large_box_of_walls():
    wide = build.cylinder("drum", (0.0, -1.0, 0.0), (0.0, 2.0, 0.0), 1.0)
    scene, _ = build.scene([[0.0, 0.0, 0.0]], D, walls=[wide])
    assert np.all(np.array(scene.world_high) >= 1.0)
    assert scene.groups["drum"][1] - scene.groups["drum"][0] == 1


def test_a_wall_through_a_first_grain_is_refused():
    with pytest.raises(CaseError, match=r"first grains overlap: .* and wall 'lid'"):
        build.scene([[0.0, 0.0, 0.0]], D, walls=[build.disc("lid", (0, 0, 0.2 * D), (0, 0, 1), 5 * D)])
