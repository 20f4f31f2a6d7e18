"""Coordination number of arrangements whose contacts can be counted by hand."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.measure import coordination

D = 0.002


@pytest.fixture
def still(make):
    """A run of frames of grains at rest, (n_frame, n_grain, 3), without a bed, periodic along x and y."""

    def build(x, plane=False, period=(math.inf, math.inf), floor=False):
        scene = make.scene(x.shape[1])
        scene = replace(
            scene, plane_case=plane, period=period, x_fixed=np.zeros((0, 3)), d_fixed=np.zeros(0),
            fixed_active=np.zeros(0, dtype=bool), plane_normal=np.array([[0.0, 0.0, 1.0]]),
            plane_point=np.zeros((1, 3)), plane_active=np.array([floor]),
        )  # fmt: skip
        return SimpleNamespace(
            case={"record": {}}, scene=scene,
            frames=SimpleNamespace(t=0.01 * np.arange(len(x)), x=x, v=0.0 * x, omega=0.0 * x),
        )  # fmt: skip

    return build


def cubes(n, spacing):
    """A cubic array of n x n x n grains."""
    return spacing * np.stack(np.meshgrid(*3 * [np.arange(n)], indexing="ij"), axis=-1).reshape(1, -1, 3)


def test_every_grain_of_a_periodic_cubic_array_has_six_neighbours_but_top_and_bottom(still):
    n, spacing = 5, 0.99 * D
    x = cubes(n, spacing) + np.array([0.0, 0.0, 0.5 * D])  # a grain in the middle of each layer
    found = coordination(still(x, period=(n * spacing, n * spacing)), layer=0.99)
    np.testing.assert_allclose(found.over_height.value, [5, 6, 6, 6, 5], rtol=1e-14)
    assert found["coordination"].value == pytest.approx(5.6, rel=1e-14)
    assert found["rattlers"].value == 0.0
    assert found["without_rattlers"].value == pytest.approx(5.6, rel=1e-14)


def test_a_gap_of_one_per_mille_is_no_contact(still):
    found = coordination(still(cubes(3, 1.001 * D)))
    assert found["coordination"].value == 0.0
    assert found["rattlers"].value == 1.0


def test_rattlers_have_fewer_than_four_contacts_in_space_and_two_in_a_plane(still):
    n = 3
    x = cubes(
        n, 0.99 * D
    )  # open: 8 corners with 3 contacts, 12 edges with 4, 6 faces with 5, a middle with 6
    found = coordination(still(x))
    assert found["coordination"].value == pytest.approx((8 * 3 + 12 * 4 + 6 * 5 + 6) / 27, rel=1e-14)
    assert found["without_rattlers"].value == pytest.approx((12 * 4 + 6 * 5 + 6) / 19, rel=1e-14)
    assert found["rattlers"].value == pytest.approx(8 / 27, rel=1e-14)
    row = np.zeros((1, 4, 3))
    row[0, :, 0] = 0.99 * D * np.arange(4)  # two ends with one contact
    found = coordination(still(row, plane=True))
    assert found.least == 2
    assert found["coordination"].value == 1.5
    assert found["without_rattlers"].value == 2.0
    assert found["rattlers"].value == 0.5


def test_a_floor_counts_as_one_contact_of_each_grain_on_it(still):
    x = cubes(3, 0.99 * D) + np.array([0.0, 0.0, 0.499 * D])
    bare, floor = coordination(still(x)), coordination(still(x, floor=True))
    assert floor["coordination"].value - bare["coordination"].value == pytest.approx(9 / 27, rel=1e-12)


def test_the_mean_over_frames_has_an_error_and_counts_every_frame_alike(still):
    x = np.zeros((200, 2, 3))
    x[:, 1, 0] = np.where(np.arange(200) % 4 == 0, 0.99, 1.01) * D  # in touch in a quarter of the frames
    found = coordination(still(x))
    assert found["coordination"].value == 0.25
    assert 0.0 < found["coordination"].error < 0.05
    assert len(found.rows()) == 1
    assert [row["coordination"] for row in found.series()[:5]] == [1.0, 0.0, 0.0, 0.0, 1.0]


def test_a_window_without_a_frame_is_refused(still):
    with pytest.raises(ResultsError, match="no frame"):
        coordination(still(cubes(2, D)), begin=1.0)
