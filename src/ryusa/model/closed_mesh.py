"""A body bounded by a mesh of triangles: whether it is closed, its volume and inertia, what is inside."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ryusa.model.arrays import Floats

Ints = NDArray[np.int64]
MOST_TRIANGLES = 100_000
CELLS = 61  # of a grid over the longest side; odd, so that a symmetrical body has a cell at its middle
_ALIKE = 1.0e-9  # corners nearer than this share of the size are one
# Columns of the grid stand beside the middles of its cells by this share of a cell, so as to meet no edge.
_ASIDE = (1.37e-4, 2.71e-4)


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
        number = _numbered(corners)
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
        turns = np.zeros((*shape[:2], shape[2] + 1), np.int64)  # of the surface about each middle
        for columns, above, sign in _crossings((self.corners - origin) / side, shape):
            np.add.at(turns, (columns[:, 0], columns[:, 1], above), sign)
        turns = np.cumsum(turns, axis=2)[:, :, :-1]
        if ((turns != 0) & (turns != 1)).any():
            raise MeshFault("passes through itself; unite its parts into one surface")
        return origin, side, turns == 1

    def distance(self, x: Floats) -> float:
        """Distance of a point from the surface [m]; `x` has shape (3,)."""
        a, b, c = self.corners.transpose(1, 0, 2)
        return float(np.sqrt(square_distances(x, a, b, c).min()))


def _numbered(corners: Floats) -> Ints:
    """Number of the point at each corner, shape (n, 3); corners that are alike have one number."""
    size = max(float(np.ptp(corners.reshape(-1, 3), axis=0).max()), 1.0e-300)
    rounded = np.round((corners.reshape(-1, 3) - corners.min(axis=(0, 1))) / (_ALIKE * size))
    return np.unique(rounded, axis=0, return_inverse=True)[1].reshape(-1, 3)


def _check_sides(number: Ints) -> None:
    """Refuse triangles that are not one closed surface whose triangles all turn the same way."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    sides = np.concatenate([number[:, [k, (k + 1) % 3]] for k in range(3)])
    _, key, times = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True)
    key = key.reshape(-1)
    if alone := int((times == 1).sum()):
        raise MeshFault(f"is not closed: {alone} sides of triangles have no other beside them")
    if many := int((times > 2).sum()):
        raise MeshFault(f"is not one surface: {many} sides belong to more than two triangles")
    along = np.zeros(len(times), np.int64)
    np.add.at(along, key, np.where(sides[:, 0] < sides[:, 1], 1, -1))
    if flipped := int((along != 0).sum()):
        raise MeshFault(f"has flipped triangles: at {flipped} sides two turn against each other")
    n = len(number)
    order = np.argsort(key, kind="stable").reshape(-1, 2) % n  # the two triangles at each side
    graph = coo_matrix((np.ones(len(order)), (order[:, 0], order[:, 1])), shape=(n, n))
    pieces = connected_components(graph, directed=False)[0]
    if pieces > 1:
        raise MeshFault(f"consists of {pieces} separate surfaces; a clump is one body without cavities")


def _crossings(corners: Floats, shape: Ints) -> list[tuple[Ints, Ints, int]]:
    """Where columns of cells meet triangles: columns (k, 2), first cell above (k,), and 1 where they enter.

    Parameters
    ----------
    corners : in cells from the middle of the first, shape (n, 3, 3).
    """
    found: list[tuple[Ints, Ints, int]] = []
    aside = np.array(_ASIDE)
    flat = corners[:, :, :2] - aside
    low = np.maximum(np.ceil(flat.min(axis=1)), 0).astype(np.int64)
    high = np.minimum(np.floor(flat.max(axis=1)), shape[:2] - 1).astype(np.int64)
    for k in np.flatnonzero((low <= high).all(axis=1)).tolist():
        a, b, c = flat[k]
        area = float((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
        if area == 0.0:
            continue
        columns = np.stack(
            np.meshgrid(*(np.arange(low[k, s], high[k, s] + 1) for s in (0, 1)), indexing="ij"), axis=-1
        ).reshape(-1, 2)
        p = columns - a
        v = (p[:, 0] * (c - a)[1] - p[:, 1] * (c - a)[0]) / area
        w = ((b - a)[0] * p[:, 1] - (b - a)[1] * p[:, 0]) / area
        hit = (v >= 0.0) & (w >= 0.0) & (v + w <= 1.0)
        if hit.any():
            z = corners[k, :, 2]
            height = z[0] + v[hit] * (z[1] - z[0]) + w[hit] * (z[2] - z[0])
            above = np.clip(np.floor(height).astype(np.int64) + 1, 0, shape[2])
            found.append((columns[hit], above, -1 if area > 0.0 else 1))
    return found


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
