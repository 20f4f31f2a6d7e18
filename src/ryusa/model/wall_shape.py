"""Walls as triangles and lines, for pictures, and how near a point is to them."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ryusa.laws.walls import nearest_on_cylinder, nearest_on_disc, nearest_on_triangle
from ryusa.model.arrays import Floats
from ryusa.model.walls import FaceKind, Ints, Walls, across, corners_of_box, face_boxes, pose
from ryusa.model.welding import sides_of, welded

SIDES = 48
_RULES = 8  # lines along a cylinder
_END = 1.0e-6  # of a period: what crosses its end by less lies in it


def triangles_of(walls: Walls, sides: int = SIDES) -> tuple[Floats, Ints]:
    """Triangles of all faces in the frames of their walls, (n, 3, 3) [m], and the wall of each, (n,)."""
    flat = walls.kind == FaceKind.TRIANGLE
    a, b, c = walls.face[flat, :3], walls.face[flat, 3:6], walls.face[flat, 6:9]
    corners, owner = [np.stack([a, a + b, a + c], axis=1)], [walls.wall[flat]]
    for f in np.flatnonzero(~flat):
        low, high = _rings(walls.face[f], sides)
        if walls.kind[f] == FaceKind.DISC:
            middle = np.broadcast_to(walls.face[f, :3], (sides, 3))
            some = np.stack([middle, low[:-1], low[1:]], axis=1)
        else:
            some = np.concatenate(
                [
                    np.stack([low[:-1], low[1:], high[1:]], axis=1),
                    np.stack([low[:-1], high[1:], high[:-1]], axis=1),
                ]
            )
        corners.append(some)
        owner.append(np.full(len(some), walls.wall[f]))
    return np.concatenate(corners), np.concatenate(owner)


def lines_of(walls: Walls, *, rules: bool = True) -> tuple[Floats, Ints]:
    """Edges where a smooth surface ends, in the frames of the walls, (n, 2, 3) [m], and the wall of each.

    Rims of round faces, and by `rules` some lines along a cylinder, by which its turning is seen.
    """
    flat = np.flatnonzero(walls.kind == FaceKind.TRIANGLE)
    corners = triangles_of(walls, 3)[0][: len(flat)]
    lines, owner = _edges(corners, walls.surface[flat], walls.wall[flat])
    found, owners = [lines], [owner]
    for f in np.flatnonzero(walls.kind != FaceKind.TRIANGLE):
        low, high = _rings(walls.face[f], SIDES)
        some = [np.stack([low[:-1], low[1:]], axis=1)]
        if walls.kind[f] == FaceKind.CYLINDER:
            some.append(np.stack([high[:-1], high[1:]], axis=1))
            chosen = slice(0, SIDES if rules else 0, SIDES // _RULES)
            some.append(np.stack([low[chosen], high[chosen]], axis=1))
        found += some
        owners += [np.full(len(one), walls.wall[f]) for one in some]
    return np.concatenate(found), np.concatenate(owners)


def outlines_of(walls: Walls, t: float, sight: Floats) -> tuple[Floats, Ints]:
    """Lines along cylinders where they end for an eye that looks along a unit vector.

    They are in the world at time t [s], (n, 2, 3) [m], with the wall of each.
    """
    found, owner = [np.zeros((0, 2, 3))], list[int]()
    for f in np.flatnonzero(walls.kind == FaceKind.CYLINDER):
        turn, shift = pose(walls.motion[walls.wall[f]], t)
        centre, axis = turn @ walls.face[f, :3] + shift, turn @ walls.face[f, 3:6]
        out = np.cross(axis, sight)
        if (across := float(np.linalg.norm(out))) > _END:  # else it is seen as a circle
            both = centre + float(walls.face[f, 6]) / across * np.stack([out, -out])
            found.append(np.stack([both, both + float(walls.face[f, 7]) * axis], axis=1))
            owner += [int(walls.wall[f])] * 2
    return np.concatenate(found), np.array(owner, np.int64)


def in_world(walls: Walls, points: Floats, owner: Ints, t: float) -> Floats:
    """Points of walls, (n, m, 3) in the frame of the wall of each row, where they are at time t [s]."""
    placed = np.array(points)
    for w in range(walls.n_wall):
        turn, shift = pose(walls.motion[w], t)
        mine = owner == w
        placed[mine] = points[mine] @ turn.T + shift
    return placed


def cut_off(corners: Floats, room: Floats) -> Floats:
    """Part of a polygon or a line, (n, 3) [m], where the room at its corners, (n,), is not negative.

    >>> cut_off(np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0]]), np.array([1.0, -1, 1])).tolist()
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 2.0, 0.0]]
    """
    kept = list[Floats]()
    for k in range(len(corners)):
        after = (k + 1) % len(corners)
        if room[k] >= 0.0:
            kept.append(corners[k])
        if (room[k] >= 0.0) != (room[after] >= 0.0):
            kept.append(corners[k] + (corners[after] - corners[k]) * (room[k] / (room[k] - room[after])))
    some = kept[:2] if len(corners) == 2 else kept  # a line is cut on its way there and on its way back
    return np.array(some).reshape(-1, 3)


def within_periods(shapes: Floats, low: Floats, period: Floats) -> Floats:
    """Lines (n, 2, 3) or triangles (n, 3, 3) [m], cut where a period ends and each part taken into it.

    Parameters
    ----------
    low, period : begin and length of the period along each axis [m], shape (3,); inf where there is none.

    >>> line = np.array([[[0.5, 0.0, 0.0], [1.5, 0.0, 0.0]]])
    >>> within_periods(line, np.zeros(3), np.array([1.0, np.inf, np.inf]))[:, :, 0].tolist()
    [[0.5, 1.0], [0.0, 0.5]]
    """
    for axis in np.flatnonzero(np.isfinite(period)):
        place = (shapes[:, :, axis] - low[axis]) / period[axis]
        least, most = place.min(axis=1), place.max(axis=1)
        first = np.floor(least + _END)
        last = np.maximum(np.ceil(most - _END) - 1.0, first)
        inside = (least > -_END) & (most < 1.0 + _END)  # a face in an end of the period stays there
        first[inside] = last[inside] = 0.0
        whole = shapes[first == last]
        whole[:, :, axis] -= period[axis] * first[first == last, None]
        found = [whole]
        for k in np.flatnonzero(first < last):
            for image in np.arange(first[k], last[k] + 1.0):
                part = shapes[k].copy()
                part[:, axis] -= period[axis] * image
                part = cut_off(part, part[:, axis] - low[axis])
                part = cut_off(part, low[axis] + period[axis] - part[:, axis])
                fan = [[0, 1]] if len(shapes[k]) == 2 else [[0, a, a + 1] for a in range(1, len(part) - 1)]
                found += [part[None, one] for one in fan]
        shapes = np.concatenate(found)
    return shapes


def _rings(face: Floats, sides: int) -> tuple[Floats, Floats]:
    """Points round the two ends of a round face, the last again the first, (sides + 1, 3) each."""
    centre, axis, radius, length = face[:3], face[3:6], float(face[6]), float(face[7])
    side = across(axis)
    angle = 2.0 * math.pi * np.arange(sides + 1) / sides
    low = centre + radius * (np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * np.cross(axis, side))
    return np.asarray(low, dtype=np.float64), np.asarray(low + length * axis, dtype=np.float64)


def _edges(corners: Floats, surface: Ints, wall: Ints) -> tuple[Floats, Ints]:
    """Sides of triangles that no other triangle of the same surface shares."""
    if not len(corners):
        return np.zeros((0, 2, 3)), np.zeros(0, np.int64)
    ends = np.concatenate([corners[:, [k, (k + 1) % 3]] for k in range(3)])
    side = np.unique(sides_of(welded(corners)), return_inverse=True)[1].ravel()
    key = side * (int(surface.max()) + 1) + np.tile(surface, 3)
    _, first, times = np.unique(key, return_index=True, return_counts=True)
    alone = first[times == 1]
    return ends[alone], np.tile(wall, 3)[alone]


def nearest_on_face(face: Floats, kind: int, x: Floats) -> Floats:
    """Point of a face nearest to a point, both in the frame of its wall [m], shape (3,).

    >>> shell = np.array([0.0, 0, 0, 0, 0, 1, 2, 3, 0])  # of radius 2 m and length 3 m
    >>> nearest_on_face(shell, FaceKind.CYLINDER, np.array([1.0, 0, 1])).tolist()
    [2.0, 0.0, 1.0]
    """
    a, b, c = face[:3], face[3:6], face[6:9]
    away = x - a
    if kind == FaceKind.TRIANGLE:
        v, w, _ = nearest_on_triangle(
            float(away @ b), float(away @ c), float(b @ b), float(b @ c), float(c @ c)
        )
        return np.asarray(a + v * b + w * c)
    along = float(away @ b)
    beside = away - along * b
    rho = float(np.linalg.norm(beside))
    if kind == FaceKind.DISC:
        return np.asarray(a + nearest_on_disc(rho, float(c[0])) * beside)
    if rho == 0.0:  # on the axis every direction is as good
        beside, rho = across(b), 1.0
    h, factor = nearest_on_cylinder(along, rho, float(c[0]), float(c[1]))
    return np.asarray(a + h * b + factor * beside, dtype=np.float64)


def ways_to_faces(walls: Walls, faces: Ints, x: Floats, t: float, period: tuple[float, float]) -> Floats:
    """Vectors from points to the nearest points of faces at time t [s], (n, 3) [m]; `x` has shape (n, 3)."""
    poses = [pose(row, t) for row in walls.motion]
    low, high = face_boxes(walls.face, walls.kind)
    ways = np.zeros((len(faces), 3))
    for k, f in enumerate(faces.tolist()):
        turn, shift = poses[walls.wall[f]]
        at = turn.T @ (x[k] - shift)
        for axis, length in enumerate(period):
            if math.isfinite(length):
                middle = 0.5 * (low[f, axis] + high[f, axis])
                at[axis] -= length * math.floor((at[axis] - middle) / length + 0.5)
        ways[k] = turn @ (nearest_on_face(walls.face[f], int(walls.kind[f]), at) - at)
    return ways


@dataclass(frozen=True)
class WallsAt:
    """Walls at one moment.

    Attributes
    ----------
    walls : their faces and motion.
    t : time [s].
    period : of the scene along x and y [m]; inf where it is not periodic.
    """

    walls: Walls
    t: float
    period: tuple[float, float]

    @cached_property
    def _poses(self) -> list[tuple[Floats, Floats]]:
        return [pose(row, self.t) for row in self.walls.motion]

    @cached_property
    def _boxes(self) -> tuple[Floats, Floats]:
        return face_boxes(self.walls.face, self.walls.kind)

    def around(self, low: Floats, high: Floats) -> "WallsAt":
        """Only the faces that can reach into a box [m], for many questions about places in it."""
        walls, corners = self.walls, corners_of_box(low, high)
        keep = np.zeros(walls.n_face, np.bool_)
        for w in np.flatnonzero(walls.active):
            turn, shift = self._poses[w]
            points = (corners - shift) @ turn
            bottom, top = points.min(axis=0), points.max(axis=0)
            axes = [k for k in range(3) if k == 2 or not math.isfinite(self.period[k])]
            near = (self._boxes[0] <= top)[:, axes] & (self._boxes[1] >= bottom)[:, axes]
            keep |= near.all(axis=1) & (walls.wall == w)
        arrays = {name: getattr(walls, name)[keep] for name in ("face", "kind", "wall", "surface")}
        return replace(self, walls=replace(walls, **arrays))

    def touch(self, x: Floats, r: float) -> bool:
        """Whether a sphere of radius r [m] with its centre at x [m], shape (3,), overlaps a wall."""
        walls, (low, high) = self.walls, self._boxes
        for w in np.flatnonzero(walls.active):
            turn, shift = self._poses[w]
            mine = np.flatnonzero(walls.wall == w)
            at = np.tile(turn.T @ (x - shift), (len(mine), 1))
            for axis, length in enumerate(self.period):
                if math.isfinite(length):
                    middle = 0.5 * (low[mine, axis] + high[mine, axis])
                    at[:, axis] -= length * np.floor((at[:, axis] - middle) / length + 0.5)
            for k in np.flatnonzero(np.all((at > low[mine] - r) & (at < high[mine] + r), axis=1)):
                f = mine[k]
                away = nearest_on_face(walls.face[f], int(walls.kind[f]), at[k]) - at[k]
                if float(np.linalg.norm(away)) < r:
                    return True
        return False
