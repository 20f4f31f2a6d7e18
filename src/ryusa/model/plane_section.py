"""A plane section of a scene: the area on it within walls, planes and periods."""

import math

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.model.scene import Scene
from ryusa.model.wall_shape import in_world, triangles_of
from ryusa.model.walls import across

SIDES = 720  # of the polygon that stands for a round wall: its area is 1.3e-5 too small
TURNS = 1440  # directions beside those of the ends of the lines
MANY = 300  # lines up to which their crossings are found too
FAR = 1.0e3  # half of the length of a line without end, in distances of the farthest point
FINE = 1.0e-9  # [rad] between two directions that are one
LEVEL = 1.0e-9  # component of a normal in the section, below which a plane is parallel to it


def section_area(
    scene: Scene, origin: Floats, normal: Floats, t: float, rim: Floats | None = None, without: int = -1
) -> float:
    """Area on a plane that is seen from a point of it before walls, planes and periods stand [m2].

    Parameters
    ----------
    scene : its walls, planes and periods count; grains do not.
    origin : the point [m], shape (3,); a period reaches half of itself to either side of it.
    normal : unit vector normal to the section, shape (3,).
    t : time [s], which tells where moving walls are.
    rim : points of a closed line in the section, in order [m], shape (n, 3), which bounds the area as well.
    without : number of a wall that does not count.

    Returns
    -------
    area : exact where what stands round the point is flat; inf where the view is open on any side.

    Notes
    -----
    The lines in which walls and planes cut the section are seen from the point. Between the directions of
    their ends and crossings the nearest is one straight line, and the area before it a triangle.
    """
    basis = _basis(normal)
    lines = _lines_of_walls(scene, origin, normal, basis, t, without)
    if rim is not None:
        corners = (rim - origin) @ basis
        lines = np.concatenate([lines, np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)])
    lines = np.concatenate([lines, _endless(scene, origin, basis, float(np.abs(lines).max(initial=0.0)))])
    return _seen(lines)


def rim_of(points: Floats, normal: Floats) -> tuple[Floats, float]:
    """Rim of points seen along a unit vector: the corners of their hull, (n, 3) [m], and its area [m2]."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points @ _basis(normal))
    return points[hull.vertices], float(hull.volume)  # in a plane this is the area


def _basis(normal: Floats) -> Floats:
    """Two unit vectors normal to one and to each other, in columns (3, 2)."""
    side = across(normal)
    return np.asarray(np.stack([side, np.cross(normal, side)], axis=1), dtype=np.float64)


def _lines_of_walls(
    scene: Scene, origin: Floats, normal: Floats, basis: Floats, t: float, without: int
) -> Floats:
    """Where walls cut a section, with their images beyond the periods, (n, 2, 2) [m] from the origin."""
    if scene.walls is None or not scene.n_face:
        return np.zeros((0, 2, 2))
    corners, owner = triangles_of(scene.walls, SIDES)
    there = scene.walls.active[owner] & (owner != without)
    corners = in_world(scene.walls, corners[there], owner[there], t) - origin
    high = corners @ normal
    high = np.where(high == 0.0, np.finfo(np.float64).tiny, high)
    cut = (high.min(axis=1) < 0.0) & (high.max(axis=1) > 0.0)
    corners, high = corners[cut], high[cut]
    alone = np.where(np.sign(high).sum(axis=1) > 0.0, np.argmin(high, axis=1), np.argmax(high, axis=1))
    row, ends = np.arange(len(high)), list[Floats]()
    for other in (1, 2):
        k = (alone + other) % 3
        share = high[row, alone] / (high[row, alone] - high[row, k])
        ends.append((corners[row, alone] + share[:, None] * (corners[row, k] - corners[row, alone])) @ basis)
    lines = np.stack(ends, axis=1)
    for axis, period in enumerate(scene.period):
        if math.isfinite(period):
            step = period * basis[axis]
            lines = np.concatenate([lines + k * step for k in (-1, 0, 1)])
    return lines


def _endless(scene: Scene, origin: Floats, basis: Floats, size: float) -> Floats:
    """Lines in which planes and the ends of periods cut a section, cut off far outside, (n, 2, 2) [m]."""
    normals, offs = list[Floats](), list[float]()
    for normal, point in zip(
        scene.plane_normal[scene.plane_active], scene.plane_point[scene.plane_active], strict=True
    ):
        normals.append(normal @ basis)
        offs.append(float((point - origin) @ normal))
    for axis, period in enumerate(scene.period):
        if math.isfinite(period):
            normals += [basis[axis], -basis[axis]]
            offs += [0.5 * period, 0.5 * period]
    normal, off = np.array(normals).reshape(-1, 2), np.array(offs)
    length = np.linalg.norm(normal, axis=1)
    upright = length > LEVEL
    normal, off = normal[upright] / length[upright, None], off[upright] / length[upright]
    foot = normal * off[:, None]
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1) * (
        FAR * max(size, float(np.abs(off).max(initial=0.0)))
    )
    return np.stack([foot - along, foot + along], axis=1)


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _seen(lines: Floats) -> float:
    """Area seen from (0, 0) before lines (n, 2, 2) stand [m2]; inf where the view is open on a side."""
    points = lines.reshape(-1, 2)
    begin, along = lines[:, 0], lines[:, 1] - lines[:, 0]
    if len(lines) <= MANY:
        with np.errstate(invalid="ignore", divide="ignore"):
            apart = begin[None] - begin[:, None]
            share = _cross(apart, along[None]) / _cross(along[:, None], along[None])
        within = (share > 0.0) & (share < 1.0)
        one, other = np.nonzero(within & within.T)
        points = np.concatenate([points, begin[one] + share[one, other, None] * along[one]])
    angle = np.concatenate([np.arctan2(points[:, 1], points[:, 0]), np.linspace(-math.pi, math.pi, TURNS)])
    angle = np.unique(angle)
    angle = np.concatenate([angle[:-1][np.diff(angle) > FINE], angle[-1:]])
    if not len(lines):
        return math.inf
    area = 0.0
    for chunk in np.array_split(np.arange(len(angle) - 1), max(len(angle) * len(lines) // 2_000_000, 1)):
        low, high = angle[chunk], angle[chunk + 1]
        middle = 0.5 * (low + high)
        towards = np.stack([np.cos(middle), np.sin(middle)], axis=1)[:, None]
        with np.errstate(invalid="ignore", divide="ignore"):
            far = _cross(begin, along) / _cross(towards, along[None])
            share = -_cross(towards, begin[None]) / _cross(towards, along[None])
        far[~((share >= -FINE) & (share <= 1.0 + FINE) & (far > 0.0))] = math.inf
        if np.isinf(far.min(axis=1)).any():
            return math.inf
        seen = far.argmin(axis=1)
        ends = [
            _cross(begin[seen], along[seen])
            / _cross(np.stack([np.cos(one), np.sin(one)], axis=1), along[seen])
            for one in (low, high)
        ]
        area += float((0.5 * ends[0] * ends[1] * np.sin(high - low)).sum())
    return area
