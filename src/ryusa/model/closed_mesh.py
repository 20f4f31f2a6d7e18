"""A body bounded by a mesh of triangles: whether it is closed, its volume and inertia, what is inside."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ryusa.model.arrays import Floats
from ryusa.model.groups import groups
from ryusa.model.walls import Ints
from ryusa.model.welding import flipped_sides, sides_of, welded

MOST_TRIANGLES = 100_000
CELLS = 61  # of a grid over the longest side; odd, so that a symmetrical body has a cell at its middle
_AT_ONCE = 1_000_000  # pairs of a triangle and a cell
# Rays stand beside the middles of columns by these shares of a cell, so as to meet no edge.
_ASIDE = ((1.37e-4, 2.71e-4), (-2.23e-4, 1.19e-4), (3.07e-4, -1.61e-4), (-0.83e-4, -3.41e-4))


class MeshFault(ValueError):
    """Triangles that bound no body: what is wrong."""


@dataclass(frozen=True)
class ClosedMesh:
    """A closed surface of triangles whose normals point outwards, and the body that it bounds.

    Attributes
    ----------
    corners : of its triangles [m], shape (n, 3, 3).
    volume : [m3].
    centre : centre of mass [m], shape (3,).
    inertia : tensor about the centre over the density [m5], shape (3, 3).
    """

    corners: Floats
    volume: float
    centre: Floats
    inertia: Floats

    @classmethod
    def of(cls, corners: Floats) -> Self:
        """The body bounded by triangles, in any unit.

        Raises
        ------
        MeshFault : open, flipped or several surfaces, too many triangles, or no volume.

        Notes
        -----
        Volume and moments are sums over the tetrahedra of all triangles with one point (Green's theorem).

        >>> ClosedMesh.of(np.array([[[0.0, 0, 0], [0, 1, 0], [1, 0, 0]]]))
        Traceback (most recent call last):
        ...
        ryusa.model.closed_mesh.MeshFault: has 1 triangles; a body has 4 to 100,000
        """
        number = welded(corners)
        apart = (number != np.roll(number, 1, axis=1)).all(axis=1)
        corners, number = corners[apart], number[apart]
        if not 4 <= len(corners) <= MOST_TRIANGLES:
            raise MeshFault(f"has {len(corners):,} triangles; a body has 4 to {MOST_TRIANGLES:,}")
        _check_sides(number)
        middle = 0.5 * (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1)))
        a, b, c = (corners - middle).transpose(1, 0, 2)
        six = np.einsum("ij,ij->i", a, np.cross(b, c))  # 6 times the volume of each tetrahedron
        volume, total = float(six.sum()) / 6.0, a + b + c
        if volume < 0.0:
            raise MeshFault(
                "is turned inside out: all its triangles are flipped; their normals point inwards"
            )
        size = float(np.ptp(corners, axis=(0, 1)).max())
        if not volume > 1.0e-9 * size**3:
            raise MeshFault("has no volume")
        centre = six @ total / 24.0 / volume
        outer = sum(np.einsum("i,ij,ik->jk", six, one, one) for one in (a, b, c, total))
        second = np.asarray(outer) / 120.0 - volume * np.outer(centre, centre)
        inertia = np.trace(second) * np.eye(3) - second
        return cls(corners, volume, centre + middle, inertia)

    @property
    def moments(self) -> Floats:
        """Principal moments of inertia over the density [m5], ascending, shape (3,)."""
        return np.asarray(np.linalg.eigvalsh(self.inertia), dtype=np.float64)

    @property
    def lengths(self) -> tuple[float, float, float]:
        """Lengths a >= b >= c of the ellipsoid of the same inertia over volume [m]; as `Clump.lengths`."""
        moments = self.moments
        second = 0.5 * moments.sum() - moments
        a, b, c = np.sqrt(20.0 * np.maximum(second, 0.0) / self.volume).tolist()
        return a, b, c

    def grid(self, cells: int = CELLS) -> tuple[Floats, float, NDArray[np.bool_]]:
        """A grid of cubes over the body, so many along its longest side.

        Returns
        -------
        origin : middle of the first cell [m], shape (3,).
        side : of a cell [m].
        inside : whether the middle of each cell lies in the body, shape (n_x, n_y, n_z).

        Raises
        ------
        MeshFault : the surface passes through itself, as far as cells show it.
        """
        low, high = self.corners.min(axis=(0, 1)), self.corners.max(axis=(0, 1))
        side = float((high - low).max()) / cells
        shape = np.maximum(np.round((high - low) / side).astype(np.int64) // 2 * 2 + 1, 1)
        origin = 0.5 * (low + high) - 0.5 * side * (shape - 1)
        n_x, n_y, n_z = shape.tolist()
        turns = turns_about((self.corners - origin) / side, (n_x, n_y, n_z)).transpose(2, 1, 0)
        if ((turns != 0) & (turns != 1)).any():
            raise MeshFault("passes through itself; unite its parts into one surface")
        return origin, side, turns == 1

    def distance(self, x: Floats) -> float:
        """Distance of a point from the surface [m]; `x` has shape (3,)."""
        a, b, c = self.corners.transpose(1, 0, 2)
        return float(np.sqrt(square_distances(x, a, b, c).min()))


def _check_sides(number: Ints) -> None:
    """Refuse triangles that are not one closed surface whose triangles all turn the same way."""
    sides, n = sides_of(number), len(number)
    times = np.unique(sides, return_counts=True)[1]
    if alone := int((times == 1).sum()):
        raise MeshFault(f"is not closed: {alone} sides of triangles have no other beside them")
    if many := int((times > 2).sum()):
        raise MeshFault(f"is not one surface: {many} sides belong to more than two triangles")
    if flipped := flipped_sides(number):
        raise MeshFault(f"has flipped triangles: at {flipped} sides two turn against each other")
    beside = np.argsort(sides, kind="stable").reshape(-1, 2) % n  # the two triangles at each side
    pieces = int(groups(beside, n).max()) + 1
    if pieces > 1:
        raise MeshFault(f"consists of {pieces} separate surfaces; a clump is one body without cavities")


def turns_about(corners: Floats, shape: tuple[int, int, int]) -> Ints:
    """How often a surface goes round the middle of each cell of a grid, shape (n_z, n_y, n_x).

    Parameters
    ----------
    corners : in cells from the middle of the first, shape (n, 3, 3).
    shape : cells along x, y and z.

    Raises
    ------
    MeshFault : as `crossings`.

    Notes
    -----
    The number is that of crossings below, each by its direction: 0 outside and 1 inside a body whose normals
    point outwards; odd in what is enclosed, whatever the order of the corners. By chance on the surface.
    """
    n_x, n_y, n_z = shape
    column, height, turn = crossings(corners, (n_x, n_y))
    turns = np.zeros((n_z + 1, n_y * n_x), np.int64)
    np.add.at(turns, (np.clip(np.floor(height).astype(np.int64) + 1, 0, n_z), column), turn)
    return np.cumsum(turns, axis=0)[:-1].reshape(n_z, n_y, n_x)


def crossings(corners: Floats, shape: tuple[int, int]) -> tuple[Ints, Floats, Ints]:
    """Where rays along z through the middles of columns cross triangles: column, height, and 1 upon entering.

    Parameters
    ----------
    corners : shape (n, 3, 3), x and y in columns from the middle of the first.

    Returns
    -------
    Number of the column, y n_x + x, height, and 1 where the normal points down, -1 where up, shapes (k,).

    Raises
    ------
    MeshFault : a ray crosses an odd number of times, wherever it stands.
    """
    for aside in _ASIDE:
        flat, z = corners[:, :, :2] - np.array(aside), corners[:, :, 2]
        b, c = (flat[:, k] - flat[:, 0] for k in (1, 2))
        area = b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0]
        flat, z, b, c, area = (one[area != 0.0] for one in (flat, z, b, c, area))  # not seen edge on
        columns, heights, turns = list[Ints](), list[Floats](), list[Ints]()
        for owner, place in near(flat.min(axis=1), flat.max(axis=1), shape):
            p, one, other = place - flat[owner, 0], b[owner], c[owner]
            v = (p[:, 0] * other[:, 1] - p[:, 1] * other[:, 0]) / area[owner]
            w = (one[:, 0] * p[:, 1] - one[:, 1] * p[:, 0]) / area[owner]
            hit = (v >= 0.0) & (w >= 0.0) & (v + w <= 1.0)
            base, up, side = z[owner[hit]].T
            columns.append(place[hit, 1] * shape[0] + place[hit, 0])
            heights.append(base + v[hit] * (up - base) + w[hit] * (side - base))
            turns.append(np.where(area[owner[hit]] > 0.0, -1, 1))
        column, turn = (np.concatenate([np.zeros(0, np.int64), *one]) for one in (columns, turns))
        if not (np.bincount(column) % 2).any():
            return column, np.concatenate([np.zeros(0), *heights]), turn
    raise MeshFault("is not closed, as far as rays through it show")


def near(low: Floats, high: Floats, shape: tuple[int, ...]) -> Iterator[tuple[Ints, Ints]]:
    """Whole places of a grid in boxes, some boxes at a time: number of the box (n,), and place (n, axes)."""
    first = np.maximum(np.ceil(low), 0).astype(np.int64)
    last = np.minimum(np.floor(high), np.array(shape) - 1).astype(np.int64)
    many = np.maximum(last - first + 1, 0)
    total = many.prod(axis=1)
    used = np.flatnonzero(total)
    begun = np.cumsum(total[used]) // _AT_ONCE
    for some in np.split(used, np.flatnonzero(np.diff(begun)) + 1):
        owner = np.repeat(some, total[some])
        rest = np.arange(len(owner)) - np.repeat(np.cumsum(total[some]) - total[some], total[some])
        place = np.empty((len(owner), len(shape)), np.int64)
        for axis in range(len(shape)):
            rest, place[:, axis] = np.divmod(rest, many[owner, axis])
        yield owner, first[owner] + place


def square_distances(x: Floats, a: Floats, b: Floats, c: Floats) -> Floats:
    """Squares of the distances of a point, or of points, from triangles of corners a, b, c [m2], shape (n,).

    Nearest to a triangle is the foot of the perpendicular where it lies inside, else a point of a side.
    """
    normal = np.cross(b - a, c - a)
    square = np.einsum("ij,ij->i", normal, normal)
    height = np.einsum("ij,ij->i", x - a, normal)
    inside = square > 0.0
    best = np.full(len(a), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        way, at = q - p, x - p
        inside &= np.einsum("ij,ij->i", np.cross(way, at), normal) >= 0.0
        length = np.einsum("ij,ij->i", way, way)
        share = np.clip(np.einsum("ij,ij->i", at, way) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
        off = at - share[:, None] * way
        best = np.minimum(best, np.einsum("ij,ij->i", off, off))
    return np.where(inside, height**2 / np.where(inside, square, 1.0), best)
