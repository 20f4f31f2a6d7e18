"""Bodies made of spheres: meshes and ellipsoids of known inertia, and meshes that bound nothing."""

import math

import numpy as np
import pytest
import trimesh

from ryusa.model.closed_mesh import ClosedMesh, MeshFault
from ryusa.model.clump import Clump
from ryusa.model.filling import LEAST_GAIN, fill_ellipsoid, fill_mesh


def corners_of(mesh: trimesh.Trimesh) -> np.ndarray:
    return np.asarray(mesh.triangles, dtype=np.float64)


def ball(subdivisions: int = 3) -> np.ndarray:
    return corners_of(trimesh.creation.icosphere(subdivisions=subdivisions))


def test_a_box_has_its_volume_and_inertia_wherever_it_is() -> None:
    sides = np.array([3.0, 2.0, 1.0])
    body = ClosedMesh.of(corners_of(trimesh.creation.box(sides)) + np.array([5.0, -7.0, 2.0]))
    assert body.volume == pytest.approx(6.0, rel=1e-13)
    assert body.centre == pytest.approx([5.0, -7.0, 2.0], rel=1e-13)
    moments = 6.0 / 12.0 * (np.sum(sides**2) - sides**2)
    assert body.inertia == pytest.approx(np.diag(moments), abs=1e-12)
    assert np.array(body.lengths) == pytest.approx(sides * math.sqrt(20.0 / 12.0), rel=1e-12)


def test_a_fine_mesh_of_an_ellipsoid_has_the_inertia_of_the_ellipsoid() -> None:
    axes = np.array([1.0, 0.7, 0.4])
    body = ClosedMesh.of(ball(5) * axes)
    assert body.volume == pytest.approx(4.0 / 3.0 * math.pi * axes.prod(), rel=2e-3)
    assert np.array(body.lengths) == pytest.approx(2.0 * axes, rel=1e-3)


def test_the_grid_finds_what_is_inside() -> None:
    body = ClosedMesh.of(ball())
    origin, side, inside = body.grid()
    assert inside.sum() * side**3 == pytest.approx(body.volume, rel=0.01)
    x = origin + side * np.argwhere(inside)
    assert np.linalg.norm(x, axis=1).max() <= 1.0
    assert body.distance(np.array([0.25, 0.0, 0.0])) == pytest.approx(0.75, rel=0.01)
    assert body.distance(np.array([3.0, 4.0, 0.0])) == pytest.approx(4.0, rel=0.01)


def test_one_sphere_fills_the_mesh_of_a_sphere() -> None:
    found = fill_mesh(ClosedMesh.of(ball(4) * 0.3 + 1.0), 12, 1.0)
    assert found.x == pytest.approx(np.ones((1, 3)), abs=1e-12)
    assert found.d == pytest.approx([0.6], rel=2e-3)
    assert found.filled == pytest.approx(1.0, abs=LEAST_GAIN * 3.0)


def test_a_cube_is_filled_by_its_inscribed_sphere_and_one_in_each_corner() -> None:
    body = ClosedMesh.of(corners_of(trimesh.creation.box((1.0, 1.0, 1.0))))
    found = fill_mesh(body, 9, 1.0)
    assert found.d[0] == pytest.approx(1.0, rel=1e-12)
    assert found.x[0] == pytest.approx(np.zeros(3), abs=1e-12)
    away = np.abs(found.x[1:])
    assert away == pytest.approx(np.full((8, 3), away[0, 0]), abs=1e-12)  # on the diagonals
    assert found.d[1:] == pytest.approx(2.0 * (0.5 - away[:, 0]), rel=1e-12)  # and on three faces each
    assert len(np.unique(np.sign(found.x[1:]), axis=0)) == 8
    assert math.pi / 6.0 + 0.2 < found.filled < 0.75
    alone = fill_mesh(body, 1, 1.0)
    assert alone.filled == pytest.approx(math.pi / 6.0, rel=1e-6)


def test_spheres_of_a_mesh_lie_in_it_are_joined_and_make_a_clump_of_its_axes() -> None:
    body = ClosedMesh.of(ball() * np.array([1.0, 0.6, 0.6]))
    found = fill_mesh(body, 40, 0.9)
    assert 3 <= len(found.d) < 12  # as few as fill nine tenths
    assert found.filled == pytest.approx(0.9, abs=0.04)
    for x, d in zip(found.x, found.d, strict=True):
        assert body.distance(x) == pytest.approx(0.5 * d, rel=1e-12)
    clump = Clump.of(found.x, found.d)  # else spheres that are not joined would be refused
    assert clump.volume / body.volume == pytest.approx(found.filled, rel=0.01)
    assert clump.zingg == pytest.approx((0.6, 1.0), abs=0.05)
    again = fill_mesh(body, 40, 0.9)
    assert np.array_equal(again.x, found.x)


@pytest.mark.parametrize(
    ("flat", "thick", "most"), [(0.5, 1.0, 3), (0.5, 1.0, 7), (0.8, 0.7, 9), (1.0, 0.6, 9)]
)
def test_spheres_of_an_ellipsoid_have_its_ratios_and_its_symmetry(
    flat: float, thick: float, most: int
) -> None:
    found = fill_ellipsoid(flat, thick, most, 1.0)
    assert 3 <= len(found.d) <= most
    clump = Clump.of(found.x, found.d)
    assert clump.zingg == pytest.approx((flat, thick), rel=3e-3)
    assert clump.centre == pytest.approx(np.zeros(3), abs=1e-12)
    rows = np.column_stack([found.x, found.d])
    for sign in ([-1, 1, 1, 1], [1, -1, 1, 1], [1, 1, -1, 1]):
        mirrored = rows * sign
        apart = np.abs(mirrored[:, None] - rows[None]).max(axis=2)
        assert (apart.min(axis=1) < 1e-12).all()
    assert 0.5 < found.filled < 1.0


def test_spheres_of_a_long_ellipsoid_touch_it_and_stand_on_its_axis() -> None:
    """With 15 spheres 99 % are filled, and the ellipsoid is nearly that asked for."""
    found = fill_ellipsoid(0.5, 1.0, 15, 1.0)
    assert found.filled > 0.98
    assert np.abs(found.x[:, 1:]).max() == 0.0
    b = found.d.max() / 2.0  # the sphere in the middle
    assert 0.25 * found.d**2 == pytest.approx(b * b * (1.0 - found.x[:, 0] ** 2 / (1.0 - b * b)), rel=1e-12)
    assert b == pytest.approx(0.5, rel=0.02)


def test_a_round_ellipsoid_is_one_sphere() -> None:
    found = fill_ellipsoid(1.0, 1.0, 12, 1.0)
    assert found.x.tolist() == [[0.0, 0.0, 0.0]]
    assert found.d.tolist() == [2.0]
    assert found.filled == pytest.approx(1.0, rel=1e-12)


BOX = corners_of(trimesh.creation.box((1.0, 1.0, 1.0)))
FLIPPED = BOX.copy()
FLIPPED[3] = FLIPPED[3, ::-1]
BAD = [
    (BOX[1:], "is not closed: 3 sides of triangles"),
    (BOX[:, ::-1], "is turned inside out"),
    (FLIPPED, "has flipped triangles: at 3 sides"),
    (np.concatenate([BOX, BOX + 3.0]), "consists of 2 separate surfaces"),
    (np.concatenate([BOX, 0.4 * BOX[:, ::-1]]), "consists of 2 separate surfaces"),  # a cavity
    (np.concatenate([BOX, BOX + np.array([1.0, 1.0, 0.0])]), "is not one surface: 1 sides"),
    (BOX[:3], "has 3 triangles; a body has 4 to"),
    (BOX * np.array([1.0, 1.0, 0.0]), "is not one surface|no volume"),
]


@pytest.mark.parametrize(("corners", "message"), BAD)
def test_a_mesh_that_bounds_no_body_is_refused(corners: np.ndarray, message: str) -> None:
    with pytest.raises(MeshFault, match=message):
        ClosedMesh.of(corners)


def test_a_surface_that_passes_through_itself_is_refused() -> None:
    """A tube bent so far that one arm stands in the other."""
    angle = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
    along = np.linspace(-0.2, math.pi + 0.2, 40)
    mesh = trimesh.creation.cylinder(0.2, 1.0, sections=24)
    assert ClosedMesh.of(corners_of(mesh)).volume == pytest.approx(math.pi * 0.04, rel=0.02)
    points = np.array(
        [
            [[(0.3 + 0.2 * math.cos(a)) * math.cos(1.9 * s), (0.3 + 0.2 * math.cos(a)) * math.sin(1.9 * s),
              0.2 * math.sin(a)] for a in angle]
            for s in along
        ]
    )  # fmt: skip
    n, m = points.shape[:2]
    faces = []
    for i in range(n - 1):
        for j in range(m):
            p, q, r, s = points[i, j], points[i + 1, j], points[i + 1, (j + 1) % m], points[i, (j + 1) % m]
            faces += [[p, q, r], [p, r, s]]
    for ring, order in ((points[0], 1), (points[-1], -1)):
        middle = ring.mean(axis=0)
        faces += [[middle, ring[j], ring[(j + 1) % m]][::order] for j in range(m)]
    corners = np.array(faces)
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum()
    body = ClosedMesh.of(corners if volume > 0.0 else corners[:, ::-1])
    with pytest.raises(MeshFault, match="passes through itself"):
        body.grid()
