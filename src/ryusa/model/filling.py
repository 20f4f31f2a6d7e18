"""Bodies filled by spheres: that of a mesh, and an ellipsoid of given ratios of axes."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.model.arrays import Floats
from ryusa.model.closed_mesh import ClosedMesh
from ryusa.model.union_of_spheres import moments_of_union

LEAST_GAIN = 1.0e-3  # share of the volume that a further sphere has to add
LEAST_FILLED = 0.5  # share of the volume below which spheres are no likeness of a body
_STEEP = 0.85  # distances that grow faster along a neighbour than this are on no ridge
_SMALLEST = 1.5  # radius of the smallest sphere, in cells
_JOINED = 1.0e-3  # overlap of a sphere with those that are there, over its radius
_CELLS = 40  # of a half axis of an ellipsoid
_RATIO = 1.0e-3  # relative error of ratios of axes at which they are met
_TRIALS = 30
_NODES = 9  # of the sections by which a filling is judged


@dataclass(frozen=True)
class Filling:
    """Spheres in a body.

    Attributes
    ----------
    x, d : their centres and diameters [m], shapes (n, 3) and (n,).
    filled : volume of their union over that of the body [-].
    """

    x: Floats
    d: Floats
    filled: float


def fill_mesh(body: ClosedMesh, most: int, share: float) -> Filling:
    """Fill a body by spheres that touch its surface from inside, until so many or so full.

    Parameters
    ----------
    most : largest number of spheres.
    share : of the volume [-] at which the body is full.

    Notes
    -----
    Spheres stand on the ridges of the Euclidean distance from the surface, as those of Angelidakis et al.
    (2021, SoftwareX 15, 100735), but keep their whole radius: each touches the surface from inside (as
    those of Ferellec and McDowell 2010). Each is the one that adds most to the volume filled,
    overlaps those before it, and adds at least `LEAST_GAIN`.
    """
    from scipy.ndimage import distance_transform_edt

    origin, side, inside = body.grid()
    away = np.asarray(distance_transform_edt(np.pad(inside, 1)))  # from the next cell outside, in cells
    cells = np.argwhere(inside)
    r = away[tuple((cells + 1).T)]
    ridge = _on_ridge(away, cells) & (r > _SMALLEST + 0.5)
    places, radii = cells[ridge].astype(np.float64), r[ridge] - 0.5
    if not len(places):
        return Filling(np.zeros((0, 3)), np.zeros(0), 0.0)
    free, n_all = inside.copy(), int(inside.sum())
    bound = 4.0 / 3.0 * math.pi * (radii + 0.5) ** 3  # of cells that each would add
    joined = np.ones(len(places), np.bool_)
    chosen: list[int] = []
    exact: list[float] = []
    while len(chosen) < most and 1.0 - free.sum() / n_all < share:
        best = _next(free, places, radii, bound, joined)
        if best < 0 or bound[best] < LEAST_GAIN * n_all:
            break
        chosen.append(best)
        exact.append(body.distance(origin + side * places[best]) / side)
        _take(free, places[best], exact[-1])
        apart = np.linalg.norm(places - places[best], axis=1)
        near = apart < exact[-1] + radii * (1.0 - _JOINED)
        joined = near if len(chosen) == 1 else joined | near
        bound[best] = 0.0
    centres, diameters = origin + side * places[chosen], 2.0 * side * np.array(exact)
    kept = _not_inside(centres, 0.5 * diameters)
    centres, diameters = centres[kept], diameters[kept]
    filled = moments_of_union(centres, 0.5 * diameters, nodes=_NODES).volume / body.volume
    return Filling(centres, diameters, filled)


def _on_ridge(away: Floats, cells: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether the distance from the surface grows slowly towards every neighbour of a cell.

    `away` has a margin of one cell beside the `cells`.
    """
    at, ridge = cells + 1, np.ones(len(cells), np.bool_)
    r = away[tuple(at.T)]
    for step in np.ndindex(3, 3, 3):
        way = np.array(step) - 1
        if way.any():
            ridge &= away[tuple((at + way).T)] - r < _STEEP * math.sqrt(float(way @ way))
    return ridge


def _next(
    free: NDArray[np.bool_], places: Floats, radii: Floats, bound: Floats, joined: NDArray[np.bool_]
) -> int:
    """Number of the sphere that adds most cells, of those joined; `bound` is brought up to date, -1 if none.

    What a sphere adds never grows, so one whose old bound is below the best found need not be counted.
    """
    best, most = -1, 0.0
    for k in np.argsort(-np.where(joined, bound, 0.0), kind="stable").tolist():
        if not joined[k] or bound[k] <= most:
            break
        box, ball = _ball(free.shape, places[k], float(radii[k]))
        bound[k] = float(np.count_nonzero(free[box] & ball))
        if bound[k] > most:
            best, most = k, float(bound[k])
    return best


def _take(free: NDArray[np.bool_], place: Floats, r: float) -> None:
    box, ball = _ball(free.shape, place, r)
    free[box] &= ~ball


def _ball(
    shape: tuple[int, ...], place: Floats, r: float
) -> tuple[tuple[slice, slice, slice], NDArray[np.bool_]]:
    """Cells of a box about a sphere, and which of them have their middles in it; all in cells."""
    box: list[slice] = []
    squares: list[Floats] = []
    for at, n in zip(place.tolist(), shape, strict=True):
        low, high = max(math.ceil(at - r), 0), min(math.floor(at + r), n - 1) + 1
        box.append(slice(low, high))
        squares.append((np.arange(low, high) - at) ** 2)
    total = squares[0][:, None, None] + squares[1][:, None] + squares[2]
    return (box[0], box[1], box[2]), total <= r * r


def _not_inside(x: Floats, r: Floats) -> NDArray[np.bool_]:
    """Whether each sphere lies wholly inside no other."""
    apart = np.linalg.norm(x[:, None] - x[None], axis=2) + np.where(np.eye(len(r)), np.inf, 0.0)
    return ~(apart + r[:, None] <= r[None] * (1.0 + 1.0e-6)).any(axis=1)


def fill_ellipsoid(flat: float, thick: float, most: int, share: float) -> Filling:
    """Spheres with the moments of inertia of an ellipsoid of the ratios b/a and c/b, mirrored in its planes.

    Parameters
    ----------
    flat, thick : ratios b/a and c/b [-], above 0 and at most 1.
    most, share : as in `fill_mesh`.

    Notes
    -----
    A sphere in an ellipsoid of half axes a >= b >= c that touches it on both sides has its centre (x, y) in
    the plane of a and b, within the ellipse of half axes (a^2 - c^2)/a and (b^2 - c^2)/b, and the radius
    c sqrt(1 - x^2/(a^2 - c^2) - y^2/(b^2 - c^2)). Of such spheres, taken together with their mirror images,
    those that add most volume for each sphere are chosen. Those of a body of revolution stand on its axis
    (Favier et al. 1999, Engineering Computations 16, 467). Then the ellipsoid in which they lie is changed
    until their union has the ratios asked for.
    """
    places = _places_in_ellipsoid(flat, thick, most, share)
    form = (flat, thick)
    x, r, volume, along = _body_in_ellipsoid(places, form)
    for _ in range(_TRIALS):
        off = (flat * along[0] / along[1], thick * along[1] / along[2])
        if max(abs(one - 1.0) for one in off) < _RATIO:
            break
        thicker = min(1.0, form[1] * off[1])
        form = (min(form[0] * off[0], 1.0 / thicker), thicker)
        x, r, volume, along = _body_in_ellipsoid(places, form)
    return Filling(x, 2.0 * r, volume / (4.0 / 3.0 * math.pi * form[0] ** 2 * form[1]))


def _body_in_ellipsoid(
    places: Floats, form: tuple[float, float]
) -> tuple[Floats, Floats, float, list[float]]:
    """Spheres in an ellipsoid of the ratios `form`: volume of their union, its lengths along x, y, z."""
    x, r = _in_ellipsoid(places, *form)
    body = moments_of_union(x, r, nodes=_NODES)
    return x, r, body.volume, np.sqrt(np.maximum(np.diag(body.second), 0.0)).tolist()


def _in_ellipsoid(places: Floats, flat: float, thick: float) -> tuple[Floats, Floats]:
    """Centres and radii of spheres in an ellipsoid of half axes 1, b = flat and c = flat thick.

    `places` are x and y over the half axes of the ellipse of centres, shape (n, 2).
    """
    b, c = flat, flat * thick
    long, wide = 1.0 - c * c, b * b - c * c
    x = np.zeros((len(places), 3))
    x[:, 0], x[:, 1] = long * places[:, 0], wide / b * places[:, 1]
    square = 1.0 - long * places[:, 0] ** 2 - wide / (b * b) * places[:, 1] ** 2
    return x, c * np.sqrt(square)


def _places_in_ellipsoid(flat: float, thick: float, most: int, share: float) -> Floats:
    """Places of spheres as `_in_ellipsoid` takes them, chosen in sets of mirror images."""
    steps = np.linspace(0.0, 1.0, 25)
    u, v = (one.ravel() for one in np.meshgrid(steps, steps if thick < 1.0 else [0.0], indexing="ij"))
    if flat * thick == 1.0:
        return np.zeros((1, 2))
    within = u**2 + v**2 <= 1.0 + 1.0e-12
    quarter = np.stack([u[within], v[within]], axis=1)
    middle = (np.arange(_CELLS) + 0.5) / _CELLS
    cells = np.stack(np.meshgrid(middle, middle, middle, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = cells[(cells**2).sum(axis=1) < 1.0] * np.array([1.0, flat, flat * thick])
    x, r = _in_ellipsoid(quarter, flat, thick)
    # a mirror image covers nothing of this octant that the sphere itself does not
    covers = ((cells[None] - x[:, None]) ** 2).sum(axis=2) < (r * r)[:, None]
    size = np.where(quarter > 0.0, 2, 1).prod(axis=1)  # spheres of a set
    free, chosen = np.ones(len(cells), np.bool_), list[int]()
    while True:
        adds = covers[:, free].sum(axis=1)
        fits = (size <= most - size[chosen].sum()) & (adds >= LEAST_GAIN * len(cells))
        if chosen:
            apart = np.linalg.norm(x[:, None] - x[chosen], axis=2)
            fits &= (apart < r[chosen] + r[:, None] * (1.0 - _JOINED)).any(axis=1)
        else:
            fits &= size == 1
        if not fits.any() or 1.0 - free.mean() >= share:
            break
        chosen.append(int(np.argmax(np.where(fits, adds / size, -1.0))))
        free &= ~covers[chosen[-1]]
    signs = np.array([(1, 1), (-1, 1), (1, -1), (-1, -1)])
    return np.concatenate([np.unique(signs * quarter[k], axis=0) for k in chosen])
