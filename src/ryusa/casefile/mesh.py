"""Meshes of [[walls]]: read from their files, scaled and placed, and what `ryusa check` says of them."""

from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ryusa.casefile.files import contents, inside
from ryusa.casefile.rows import ExplainRow, count
from ryusa.errors import CaseError, ParseError
from ryusa.formats.mesh import read_mesh
from ryusa.laws.walls import turned_about
from ryusa.model.arrays import Floats
from ryusa.model.welding import first_of_each, flipped_sides, rims, welded
from ryusa.units import quantity

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.derive import Derived
    from ryusa.casefile.walls import WallSection

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


def mesh_of(case: "Case", wall: "WallSection", key: str) -> Mesh:
    """Read the mesh of a wall, in SI and in its place; `key` is that of the wall.

    Raises
    ------
    CaseError : no such file, not a mesh, or an unknown unit.
    """
    assert wall.file is not None
    path = inside(case.folder, f"{key}.file", wall.file)
    try:
        unit = quantity(f"1 {wall.unit}", "m")
    except ValueError as error:
        allowed = f"must be a unit of length such as 'mm' ({error})"
        raise CaseError(f"{key}.unit", wall.unit, allowed) from None
    turn = None
    if wall.turn_axis is not None and wall.turn_angle is not None:
        turn = (wall.turn_axis, wall.turn_angle)
    placed = partial(_placed, unit * wall.scale, turn, wall.at or (0.0, 0.0, 0.0))
    return contents(case.folder, f"{key}.file", wall.file, path, placed)


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


def mesh_rows(case: "Case", derived: "Derived", wall: "WallSection", key: str) -> list[ExplainRow]:
    """Triangles of a mesh, what was left out, and where it is open."""
    mesh = mesh_of(case, wall, key)
    found = [count("walls", f"{wall.name}: triangles", len(mesh.corners), f"{wall.file}, in {wall.unit}")]
    if mesh.empty:
        about = "triangles of no area in the file; they are left out"
        found.append(count("walls", f"{wall.name}: left out", mesh.empty, about, "note"))
    if mesh.doubled:
        about = "triangles with the corners of another one in the file; each is taken once"
        found.append(count("walls", f"{wall.name}: doubled", mesh.doubled, about, "note"))
    single, wide, several = mesh.rims
    if single:
        where = "1 rim" if len(wide) == 1 else f"{len(wide)} rims"
        widest = f"{100.0 * float(wide.max(initial=0.0)):.3g} cm across"
        about = (
            f"sides that one triangle has alone, in {where}, the widest {widest}: the mesh is a sheet, or "
            f"has holes that grains may pass; the smallest grain is {100.0 * derived.d_min:.3g} cm"
        )
        found.append(count("walls", f"{wall.name}: open sides", single, about, "note"))
    if several:
        about = "sides that more than two triangles share: corners there are not smoothed"
        found.append(count("walls", f"{wall.name}: shared sides", several, about, "note"))
    if mesh.flipped_sides:
        about = (
            "sides at which one of two triangles is flipped: that plays no part, grains touch both sides of "
            "a triangle and no force depends on the order of its corners"
        )
        found.append(count("walls", f"{wall.name}: flipped sides", mesh.flipped_sides, about))
    return found
