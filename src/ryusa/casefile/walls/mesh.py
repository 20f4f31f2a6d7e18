"""Where [[walls]] are: meshes read from their files, scaled and placed, and the box round any wall."""

from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from pathlib import Path

import numpy as np

from ryusa.casefile.files import contents, inside
from ryusa.casefile.walls.schema import WallSection
from ryusa.errors import CaseError, ParseError
from ryusa.formats.mesh import read_mesh
from ryusa.laws.walls import turned_about
from ryusa.model.arrays import Floats
from ryusa.model.walls import FaceKind, face_boxes
from ryusa.model.welding import first_of_each, flipped_sides, rims, welded
from ryusa.units import quantity

_FLAT = 1e-12  # of the square of its longest side: a triangle of less area has none
_FARTHEST = 1e12  # [m]
Turn = tuple[tuple[float, float, float], float]


@dataclass(frozen=True, eq=False)
class Mesh:
    """A mesh in its place.

    Attributes
    ----------
    corners : of its triangles [m], shape (n, 3, 3); each once, none without area.
    low, high : corners of the box round all that the file holds [m], shape (3,).
    empty : triangles of no area that were left out.
    doubled : triangles with the corners of an earlier one, in any order, that were left out.
    """

    corners: Floats
    low: Floats
    high: Floats
    empty: int
    doubled: int

    @cached_property
    def rims(self) -> tuple[int, Floats, int]:
        """Open sides, widths of their rims [m], and sides that more than two triangles share."""
        return rims(self.corners)

    @cached_property
    def flipped_sides(self) -> int:
        """Sides at which the normals of two triangles point to different sides of the mesh."""
        return flipped_sides(welded(self.corners))


def mesh_of(folder: Path, wall: WallSection, key: str) -> Mesh:
    """Read the mesh of a wall, in SI and in its place; `key` is that of the wall.

    Raises
    ------
    CaseError : no such file, not a mesh, or an unknown unit.
    """
    assert wall.file is not None
    path = inside(folder, f"{key}.file", wall.file)
    try:
        unit = quantity(f"1 {wall.unit}", "m")
    except ValueError as error:
        allowed = f"must be a unit of length such as 'mm' ({error})"
        raise CaseError(f"{key}.unit", wall.unit, allowed) from None
    turn = None
    if wall.turn_axis is not None and wall.turn_angle is not None:
        turn = (wall.turn_axis, wall.turn_angle)
    placed = partial(_placed, unit * wall.scale, turn, wall.at or (0.0, 0.0, 0.0))
    return contents(folder, f"{key}.file", wall.file, path, placed)


@lru_cache(maxsize=8)
def _placed(
    factor: float, turn: Turn | None, at: tuple[float, float, float], path: Path, name: str, _changed: int,
    _size: int,
) -> Mesh:  # fmt: skip
    corners = read_mesh(path, name) * factor
    if turn is not None:
        axis, angle = np.array(turn[0]) / np.linalg.norm(turn[0]), turn[1]
        x, y, z = axis.tolist()
        corners = corners @ np.array(
            [turned_about(a, b, c, x, y, z, angle) for a, b, c in np.eye(3).tolist()]
        )
    corners = corners + np.array(at)
    points = corners.reshape(-1, 3)
    if not np.abs(points).max() < _FARTHEST:
        raise ParseError(name, 1, 1, f"has corners beyond {_FARTHEST:g} m: check unit and scale")
    low, high = points.min(axis=0), points.max(axis=0)
    one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    longest = np.linalg.norm(np.ptp(corners, axis=1), axis=1)
    flat = np.linalg.norm(np.cross(one, other), axis=1) <= _FLAT * longest**2
    if flat.all():
        raise ParseError(name, 1, 1, f"all its {len(corners)} triangles have no area")
    corners = corners[~flat]
    kept = first_of_each(welded(corners))
    doubled = len(corners) - len(kept)
    corners = corners[kept] if doubled else corners
    for array in (corners, low, high):
        array.flags.writeable = False
    return Mesh(corners, low, high, int(flat.sum()), doubled)


def box_of(folder: Path, wall: WallSection, key: str) -> tuple[Floats, Floats]:
    """Lowest and highest corner of the box round a wall in its first place [m], shape (3,) each."""
    if wall.shape == "mesh":
        mesh = mesh_of(folder, wall, key)
        return mesh.low, mesh.high
    at = np.array(wall.at or (0.0, 0.0, 0.0))
    if wall.sides is not None:
        one, other = (np.array(side) for side in wall.sides)
        up = np.cross(one, other)
        up *= (wall.height or 0.0) / np.linalg.norm(up)
        ends = at + np.array([a * one + b * other + c * up for a, b, c in np.ndindex(2, 2, 2)])
        return ends.min(axis=0), ends.max(axis=0)
    kind = FaceKind.DISC if wall.axis is None else FaceKind.CYLINDER
    along = np.array(wall.axis or wall.normal or (0.0, 0.0, 1.0))
    length = float(np.linalg.norm(along))
    face = np.concatenate([at, along / length, [wall.radius or 0.0, length, 0.0]])
    low, high = face_boxes(face[None], np.array([kind]))
    return low[0], high[0]
