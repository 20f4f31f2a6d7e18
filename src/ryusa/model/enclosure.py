"""The inside of a mesh or a cylinder: its volume, and which cubes of a grid, and spheres, lie in it."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, Self

import numpy as np

from ryusa.model.arrays import Bools, Floats
from ryusa.model.closed_mesh import MeshFault, crossings, near, square_distances, turns_about
from ryusa.model.walls import Ints, corners_of_box
from ryusa.model.welding import open_sides

FLAT = 1.0e-3  # of the width of an opening, by which its rim may leave a plane
ROUND_OFF = 1.0e-6  # of the side of a cube, as meshes have corners of single precision
_LONG = 4.0  # sides of a cube: longer triangles are halved, so that few cubes are near each
_COLUMNS = 256  # along x and y, by which the volume is found
_LEAST = 1.0e-9  # of the cube of its size: less volume is none


@dataclass(frozen=True)
class Grid:
    """Cubes side by side; a cube has the number (k n_y + j) n_x + i for its place i, j, k along x, y, z."""

    corner: tuple[float, float, float]  # lowest one of the first cube [m]
    side: float  # of a cube [m]
    shape: tuple[int, int, int]  # cubes along x, y and z

    @property
    def n(self) -> int:
        """Number of cubes."""
        return math.prod(self.shape)

    def middles(self, numbers: Ints) -> Floats:
        """Middles of cubes [m], shape (n, 3)."""
        n_x, n_y, _ = self.shape
        layer, within = np.divmod(numbers, n_x * n_y)
        place = np.stack([within % n_x, within // n_x, layer], -1)
        return np.asarray(np.array(self.corner) + (place + 0.5) * self.side)


class Enclosure(Protocol):
    """A wall with an inside."""

    @property
    def low(self) -> Floats:
        """Lowest corner of the box round it [m], shape (3,)."""
        ...

    @property
    def high(self) -> Floats:
        """Highest corner of that box [m], shape (3,)."""
        ...

    @property
    def volume(self) -> float:
        """Volume of the inside [m3]."""
        ...

    def clearance(self, grid: Grid, reach: float) -> Floats:
        """Distance from the middle of each cube to the boundary [m], `reach` at most; 0 outside."""
        ...

    def holds(self, grid: Grid) -> Bools:
        """Whether each cube lies inside as a whole."""
        ...


@dataclass(frozen=True)
class CylinderInside:
    """The inside of the shell of a cylinder, between its ends."""

    at: tuple[float, float, float]  # centre of one end [m]
    axis: tuple[float, float, float]  # from there to the centre of the other [m]
    radius: float  # [m]

    @property
    def _length(self) -> float:
        return math.hypot(*self.axis)

    @property
    def _across(self) -> Floats:
        along = np.array(self.axis) / self._length
        return np.asarray(self.radius * np.sqrt(np.maximum(1.0 - along**2, 0.0)))

    @property
    def low(self) -> Floats:
        """Lowest corner of the box round it [m], shape (3,)."""
        return np.asarray(np.array(self.at) + np.minimum(self.axis, 0.0) - self._across)

    @property
    def high(self) -> Floats:
        """Highest corner of that box [m], shape (3,)."""
        return np.asarray(np.array(self.at) + np.maximum(self.axis, 0.0) + self._across)

    @property
    def volume(self) -> float:
        """Volume between the ends [m3].

        >>> round(CylinderInside((0.0, 0.0, 0.0), (0.0, 3.0, 4.0), 2.0).volume, 6)
        62.831853
        """
        return math.pi * self.radius**2 * self._length

    def clearance(self, grid: Grid, reach: float) -> Floats:
        """Distance from the middle of each cube to shell and ends [m], `reach` at most; 0 outside."""
        return np.clip(self._depth(grid.middles(np.arange(grid.n))), 0.0, reach)

    def holds(self, grid: Grid) -> Bools:
        """Whether each cube lies inside as a whole."""
        middle, half = grid.middles(np.arange(grid.n)), 0.5 * grid.side * (1.0 - ROUND_OFF)
        found = np.ones(grid.n, np.bool_)
        for corner in corners_of_box(np.full(3, -half), np.full(3, half)):
            found &= self._depth(middle + corner) >= 0.0
        return found

    def _depth(self, x: Floats) -> Floats:
        """Distance of points from shell and ends [m]; negative outside."""
        away, along = x - np.array(self.at), np.array(self.axis) / self._length
        h = away @ along
        rho = np.linalg.norm(away - h[:, None] * along, axis=1)
        return np.minimum(self.radius - rho, np.minimum(h, self._length - h))


@dataclass(frozen=True, eq=False)
class MeshInside:
    """What triangles enclose, with flat lids on their flat openings.

    Attributes
    ----------
    corners : of the triangles and of the lids [m], shape (n, 3, 3).
    lids : number of openings that a lid closes.

    Notes
    -----
    A point is inside if a ray from it crosses the surface an odd number of times: the order of the corners of
    triangles plays no part, and a hollow within a body is outside.
    """

    corners: Floats
    lids: int

    @classmethod
    def of(cls, corners: Floats) -> Self:
        """The inside of triangles [m], shape (n, 3, 3).

        Raises
        ------
        MeshFault : an opening has a bent rim, three triangles meet at a side, or nothing is enclosed.

        >>> MeshInside.of(np.array([[[0.0, 0, 0], [0, 1, 0], [1, 0, 0]]]))
        Traceback (most recent call last):
        ...
        ryusa.model.closed_mesh.MeshFault: is a flat sheet, or is one once its openings are closed
        """
        lids, n_lid = _lids(corners)
        found = cls(np.concatenate([corners, lids]), n_lid)
        if not found.volume > _LEAST * float((found.high - found.low).max()) ** 3:
            raise MeshFault("is a flat sheet, or is one once its openings are closed")
        return found

    @property
    def low(self) -> Floats:
        """Lowest corner of the box round it [m], shape (3,)."""
        return np.asarray(self.corners.min(axis=(0, 1)))

    @property
    def high(self) -> Floats:
        """Highest corner of that box [m], shape (3,)."""
        return np.asarray(self.corners.max(axis=(0, 1)))

    @property
    def volume(self) -> float:
        """Volume of the inside [m3], from lengths of rays in it."""
        return self._volume

    @cached_property
    def _volume(self) -> float:
        wide = np.maximum((self.high - self.low)[:2], 1.0e-300) / _COLUMNS
        in_columns = self.corners.copy()
        in_columns[:, :, :2] = (in_columns[:, :, :2] - self.low[:2]) / wide - 0.5
        column, z, _ = crossings(in_columns, (_COLUMNS, _COLUMNS))
        column, z = (one[np.lexsort((z, column))] for one in (column, z))
        return float((z[1::2] - z[::2]).sum() * wide.prod())  # an even number in each column

    def clearance(self, grid: Grid, reach: float) -> Floats:
        """Distance from the middle of each cube to the surface [m], `reach` at most; 0 outside."""
        pieces, away = self._pieces(grid), np.full(grid.n, reach / grid.side)
        far, (a, b, c) = reach / grid.side, pieces.transpose(1, 0, 2)
        for owner, place in near(pieces.min(axis=1) - far, pieces.max(axis=1) + far, grid.shape):
            square = square_distances(place.astype(np.float64), a[owner], b[owner], c[owner])
            np.minimum.at(away, _number(place, grid), np.sqrt(square))
        return np.where(self._inside(grid), away * grid.side, 0.0)

    def holds(self, grid: Grid) -> Bools:
        """Whether each cube lies inside as a whole."""
        pieces, found = self._pieces(grid), self._inside(grid)
        half, (a, b, c) = 0.5 * (1.0 - ROUND_OFF), pieces.transpose(1, 0, 2)
        for owner, place in near(pieces.min(axis=1) - half, pieces.max(axis=1) + half, grid.shape):
            met = _meet_cube(half, a[owner] - place, b[owner] - place, c[owner] - place)
            found[_number(place[met], grid)] = False
        return found

    def _in_cubes(self, grid: Grid) -> Floats:
        """Corners in sides of a cube from the middle of the first."""
        return (self.corners - np.array(grid.corner)) / grid.side - 0.5

    def _pieces(self, grid: Grid) -> Floats:
        """Those corners, of triangles cut in halves until they are short."""
        done, rest = list[Floats](), self._in_cubes(grid)
        while len(rest):
            sides = np.linalg.norm(np.roll(rest, -1, axis=1) - rest, axis=2)
            long = sides.max(axis=1) > _LONG
            done.append(rest[~long])
            rest, turn = rest[long], sides[long].argmax(axis=1)
            a, b, c = (rest[np.arange(len(rest)), (turn + k) % 3] for k in range(3))
            middle = 0.5 * (a + b)
            rest = np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
        return np.concatenate(done)

    def _inside(self, grid: Grid) -> Bools:
        """Whether the middle of each cube is inside; by chance where it is on the surface."""
        return (turns_about(self._in_cubes(grid), grid.shape) % 2 == 1).ravel()


def _lids(corners: Floats) -> tuple[Floats, int]:
    """Triangles that close flat openings, shape (n, 3, 3), and the number of openings.

    They go round the mean of each rim; where a rim is hollow they cover the place beside it twice, or not.
    """
    points, rim, times = open_sides(corners)
    if odd := int(((times > 1) & (times % 2 == 1)).sum()):
        raise MeshFault(
            f"does not say what is inside: at {odd} sides three or more triangles meet, as at a partition"
        )
    if not len(points):
        return np.zeros((0, 3, 3)), 0
    n_rim, found = int(rim.max()) + 1, list[Floats]()
    for one in range(n_rim):
        sides = points[rim == one]
        middle = sides.mean(axis=(0, 1))
        away = sides.reshape(-1, 3) - middle
        wide, off = float(np.ptp(away, axis=0).max()), away @ np.linalg.svd(away, full_matrices=False)[2][2]
        if np.abs(off).max() > FLAT * wide:
            raise MeshFault(
                f"is not closed, and one of its {n_rim} openings, {wide:.3g} m wide, has a rim that leaves a "
                f"plane by {np.abs(off).max():.2g} m, so that no lid says what is inside"
            )
        lid = np.broadcast_to(middle, (len(sides), 1, 3))
        found.append(np.concatenate([sides, lid], axis=1))
    return np.concatenate(found), n_rim


def _number(place: Ints, grid: Grid) -> Ints:
    n_x, n_y, _ = grid.shape
    return (place[:, 2] * n_y + place[:, 1]) * n_x + place[:, 0]


def _meet_cube(half: float, a: Floats, b: Floats, c: Floats) -> Bools:
    """Whether triangles meet the cube from -half to half; corners a, b, c have shape (n, 3).

    Notes
    -----
    Two convex bodies are apart if a plane parts them that is normal to a face of one, or to a side of each
    (Akenine-Möller 2001, J. Graphics Tools 6(1), 29).

    >>> a, b, c = np.array([[[0.9, 0.9, 0.0], [0.6, 0.6, 0]], [[2.0, 0, 0]] * 2, [[0.0, 2, 0]] * 2])
    >>> _meet_cube(0.5, a, b, c).tolist(), _meet_cube(1.1, a, b, c).tolist()
    ([False, False], [True, True])
    """
    corners = np.stack([a, b, c], axis=1)
    sides = [b - a, c - b, a - c]
    axes = [np.cross(sides[0], sides[1])]
    axes += [np.broadcast_to(one, a.shape) for one in np.eye(3)]
    axes += [np.cross(one, side) for one in np.eye(3) for side in sides]
    met = np.ones(len(a), np.bool_)
    for axis in axes:
        shadow, reach = np.einsum("nkj,nj->nk", corners, axis), half * np.abs(axis).sum(axis=1)
        met &= (shadow.min(axis=1) <= reach) & (shadow.max(axis=1) >= -reach)
    return met
