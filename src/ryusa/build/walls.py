"""Finite walls from triangles, discs and cylinders: their faces, smooth surfaces and motion."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ryusa.build.placement import ROOM_BELOW
from ryusa.build.servo import Servo, servo_rows
from ryusa.build.wall_checks import refuse_wide_round_faces
from ryusa.casefile.walls.mesh import mesh_of
from ryusa.casefile.walls.schema import WallSection
from ryusa.errors import CaseError
from ryusa.formats.mesh import MOST_TRIANGLES
from ryusa.model import FaceKind, Scene, Walls
from ryusa.model.groups import groups
from ryusa.model.scene import Floats
from ryusa.model.walls import (
    AXIS_POINT,
    PHASE,
    RATE,
    SPIN,
    SURFACE,
    SWING,
    VELOCITY,
    Ints,
    at_rest,
    box_of,
    face_boxes,
)
from ryusa.model.welding import sides_of, welded

FOLD = math.radians(30.0)  # angle up to which two triangles are one smooth surface
_SHARE = 4.0  # of a period: the longest side of a triangle along it


@dataclass(frozen=True)
class WallMotion:
    """How a wall moves, from t = 0 on; the sum of what is given."""

    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [m/s]
    spin: tuple[float, float, float] = (0.0, 0.0, 0.0)  # angular velocity [rad/s]
    axis_point: tuple[float, float, float] = (0.0, 0.0, 0.0)  # on the axis, at first [m]
    amplitude: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of an oscillation [m]
    frequency: float = 0.0  # [Hz]
    phase: float = 0.0  # [rad]
    surface_velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of a belt, along its faces [m/s]


@dataclass(frozen=True)
class SolidWall:
    """One wall: its faces, in their first place."""

    name: str
    face: Floats  # numbers of each face (model.walls.FaceKind), shape (n_face, 9)
    kind: Ints  # shape (n_face,)
    motion: WallMotion = WallMotion()
    servo: Servo | None = None


def triangles(name: str, corners: ArrayLike, motion: WallMotion | None = None) -> SolidWall:
    """A wall of triangles; `corners` have shape (n, 3, 3), three corners each [m].

    >>> triangles("floor", [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]).face.shape
    (1, 9)
    """
    a = np.asarray(corners, dtype=np.float64).reshape(-1, 3, 3)
    face = np.hstack([a[:, 0], a[:, 1] - a[:, 0], a[:, 2] - a[:, 0]])
    return SolidWall(name, face, np.full(len(a), FaceKind.TRIANGLE, np.int64), motion or WallMotion())


def rectangle(name: str, corner: ArrayLike, side_1: ArrayLike, side_2: ArrayLike) -> SolidWall:
    """A rectangle, or any parallelogram, from one corner and two sides [m]."""
    a, b, c = (np.asarray(one, dtype=np.float64) for one in (corner, side_1, side_2))
    return triangles(name, [[a, a + b, a + b + c], [a, a + b + c, a + c]])


def ridges(
    name: str, corner: ArrayLike, side_1: ArrayLike, side_2: ArrayLike, number: int, height: float
) -> SolidWall:
    """Triangular ridges on a rectangle, one after another along side_1, each as long as side_2 [m].

    They rise by `height` [m] along side_1 x side_2.

    >>> ridges("lid", (0, 0, 0), (4, 0, 0), (0, 1, 0), 2, 0.5).face[:, 2].tolist()
    [0.0, 0.5, 0.0, 0.5, 0.0, 0.5, 0.0, 0.5]
    """
    a, b, c = (np.asarray(one, dtype=np.float64) for one in (corner, side_1, side_2))
    up = np.cross(b, c)
    up *= height / np.linalg.norm(up)
    line = [a + b * (k / (2 * number)) + up * (k % 2) for k in range(2 * number + 1)]
    both = list(pairwise(line))
    near = [[p, q, q + c] for p, q in both]
    return triangles(name, near + [[p, q + c, p + c] for p, q in both])


def disc(name: str, centre: ArrayLike, normal: ArrayLike, radius: float) -> SolidWall:
    """A flat disc; the length of `normal` means nothing."""
    return SolidWall(name, _round(centre, normal, radius, 0.0), np.array([int(FaceKind.DISC)]))


def cylinder(
    name: str, end: ArrayLike, axis: ArrayLike, radius: float, *, closed: tuple[bool, bool] = (False, False)
) -> SolidWall:
    """The shell of a cylinder from the centre of one end along `axis` [m] to the other.

    Parameters
    ----------
    closed : whether a disc closes the first end, and the other.
    """
    a, b = np.asarray(end, dtype=np.float64), np.asarray(axis, dtype=np.float64)
    faces = [_round(a, b, radius, float(np.linalg.norm(b)))]
    faces += [_round(a + k * b, b, radius, 0.0) for k in (0, 1) if closed[k]]
    kinds = [FaceKind.CYLINDER, *(FaceKind.DISC for one in closed if one)]
    return SolidWall(name, np.vstack(faces), np.array([int(one) for one in kinds]))


def _round(centre: ArrayLike, normal: ArrayLike, radius: float, length: float) -> Floats:
    n = np.asarray(normal, dtype=np.float64)
    return np.concatenate([np.asarray(centre, float), n / np.linalg.norm(n), [radius, length, 0.0]])[None]


def with_walls(scene: Scene, walls: Sequence[SolidWall]) -> Scene:
    """The same scene with walls; their names become groups, as those of planes.

    Raises
    ------
    CaseError : a wall too large for a period of the scene.
    """
    if not walls:
        return scene
    split = [replace(wall, **_split(wall, scene.period, f"walls.{k}")) for k, wall in enumerate(walls)]
    largest = scene.d_max
    for k, wall in enumerate(split):
        refuse_wide_round_faces(wall.face, wall.kind, scene.period, largest, f"walls.{k}")
    count = [len(wall.kind) for wall in split]
    face, kind = np.vstack([wall.face for wall in split]), np.concatenate([wall.kind for wall in split])
    number = np.repeat(np.arange(len(walls)), count)
    surface, used = [], 0
    for wall in split:
        mine = surfaces(wall.face, wall.kind, scene.period)
        surface.append(mine + used)
        used += int(mine.max(initial=-1)) + 1
    motion = np.vstack([_motion(wall.motion) for wall in split])
    made = Walls(
        face, kind, number, np.concatenate(surface), np.ones(len(walls), np.bool_), motion,
        tuple(wall.name for wall in walls),
    )  # fmt: skip
    made = replace(made, servo=servo_rows(replace(scene, walls=made), [wall.servo for wall in walls]))
    for array in (one for one in vars(made).values() if isinstance(one, np.ndarray)):
        array.flags.writeable = False
    first = scene.n_grain + scene.n_fixed + scene.n_plane
    ends = first + np.concatenate([[0], np.cumsum(count)])
    groups = {wall.name: (int(ends[k]), int(ends[k + 1])) for k, wall in enumerate(walls)}
    return replace(scene, walls=made, groups=scene.groups | groups)


def _motion(motion: WallMotion) -> Floats:
    row = at_rest(1)
    row[0, AXIS_POINT : AXIS_POINT + 3], row[0, VELOCITY : VELOCITY + 3] = motion.axis_point, motion.velocity
    row[0, SPIN : SPIN + 3], row[0, SWING : SWING + 3] = motion.spin, motion.amplitude
    row[0, RATE], row[0, PHASE] = 2.0 * math.pi * motion.frequency, motion.phase
    row[0, SURFACE : SURFACE + 3] = motion.surface_velocity
    return row


def surfaces(face: Floats, kind: Ints, period: tuple[float, float] = (math.inf, math.inf)) -> Ints:
    """Number of the smooth surface of each face: triangles that share an edge and fold by at most `FOLD`.

    Where more than two triangles share an edge none of them continues another there.

    >>> flat = triangles("", [[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0], [0, 1, 0]]])
    >>> surfaces(flat.face, flat.kind).tolist()
    [0, 0]
    """
    flat = np.flatnonzero(kind == FaceKind.TRIANGLE)
    return groups(flat[_smooth_links(face[flat], period)], len(kind))


def _smooth_links(face: Floats, period: tuple[float, float]) -> Ints:
    """Pairs of triangles that continue each other, shape (n, 2)."""
    if not len(face):
        return np.zeros((0, 2), np.int64)
    a, b, c = face[:, :3], face[:, :3] + face[:, 3:6], face[:, :3] + face[:, 6:9]
    corners = np.stack([a, b, c], axis=1)
    sides = sides_of(welded(corners, period))
    owner = np.tile(np.arange(len(face)), 3)
    along = np.concatenate([corners[:, (k + 1) % 3] - corners[:, k] for k in range(3)])
    to_third = np.concatenate([corners[:, (k + 2) % 3] - corners[:, k] for k in range(3)])
    along /= np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
    across = to_third - np.sum(to_third * along, axis=1)[:, None] * along
    across /= np.maximum(np.linalg.norm(across, axis=1), 1e-300)[:, None]
    _, edge, times = np.unique(sides, return_inverse=True, return_counts=True)
    order = np.argsort(edge.ravel(), kind="stable")
    starts = np.concatenate([[0], np.cumsum(times)])[:-1][times == 2]
    one, other = order[starts], order[starts + 1]
    smooth = np.sum(across[one] * across[other], axis=1) <= -math.cos(FOLD * (1.0 + 1e-9))
    return np.column_stack([owner[one], owner[other]])[smooth]


def _split(wall: SolidWall, period: tuple[float, float], key: str) -> dict[str, np.ndarray]:
    """Faces of a wall, with triangles too long along a period cut in halves.

    The nearest image of a face is found from its middle; it has to be the nearest for all of it.
    """
    face, kind = wall.face, wall.kind
    while True:
        if (
            len(kind) > MOST_TRIANGLES
            or _least_pieces(face[kind == FaceKind.TRIANGLE], period) > MOST_TRIANGLES
        ):
            raise CaseError(
                key, wall.name,
                f"is so much longer than the period, {min(period):.4g} m, that it would be cut into over "
                f"{MOST_TRIANGLES:,} triangles: make it as long as the period, where it meets itself",
            )  # fmt: skip
        corners = np.stack([np.zeros_like(face[:, :3]), face[:, 3:6], face[:, 6:9]], axis=1)
        long = np.zeros(len(face), np.bool_)
        for k in range(2):
            long |= np.ptp(corners[:, :, k], axis=1) > period[k] / _SHARE
        long &= kind == FaceKind.TRIANGLE
        if not long.any():
            return {"face": face, "kind": kind}
        a, b, c = face[long, :3], face[long, 3:6], face[long, 6:9]
        sides = np.stack([b, c - b, c], axis=1)
        longest = np.argmax(np.linalg.norm(sides, axis=2), axis=1)
        first = np.choose(longest[:, None], [a, a + b, a + c])  # the longest side runs from here
        second = np.choose(longest[:, None], [a + b, a + c, a])
        third = np.choose(longest[:, None], [a + c, a, a + b])
        middle = 0.5 * (first + second)
        one = np.hstack([first, middle - first, third - first])
        other = np.hstack([middle, second - middle, third - middle])
        face = np.vstack([face[~long], one, other])
        kind = np.concatenate([kind[~long], np.zeros(2 * len(a), np.int64)])


def _least_pieces(face: Floats, period: tuple[float, float]) -> float:
    """Number of pieces that triangles are cut into at least, so that none is too long along a period."""
    short = [min(one / _SHARE, 1e300) for one in period]
    area = 0.5 * np.abs(np.cross(face[:, 3:6], face[:, 6:9])[:, 2]).sum()  # seen from above
    return float(area / (0.5 * short[0] * short[1]))


def walls_of(folder: Path, walls: tuple[WallSection, ...]) -> tuple[SolidWall, ...]:
    """Walls of a case, meshes read from their files."""
    return tuple(_wall_of(folder, wall, f"walls.{k}") for k, wall in enumerate(walls))


def _wall_of(folder: Path, wall: WallSection, key: str) -> SolidWall:
    at = wall.at or (0.0, 0.0, 0.0)
    if wall.shape == "mesh":
        made = triangles(wall.name, mesh_of(folder, wall, key).corners)
    elif wall.sides is not None and wall.number is not None:
        made = ridges(wall.name, at, *wall.sides, wall.number, wall.height or 0.0)
    elif wall.sides is not None:
        made = rectangle(wall.name, at, *wall.sides)
    elif wall.axis is not None:
        closed = (wall.ends in {"closed", "first"}, wall.ends in {"closed", "last"})
        made = cylinder(wall.name, at, wall.axis, wall.radius or 0.0, closed=closed)
    else:
        made = disc(wall.name, at, wall.normal or (0.0, 0.0, 1.0), wall.radius or 0.0)
    motion = WallMotion(
        velocity=wall.velocity or (0.0, 0.0, 0.0),
        spin=wall.angular_velocity or (0.0, 0.0, 0.0),
        axis_point=wall.axis_point or at,
        amplitude=wall.amplitude or (0.0, 0.0, 0.0),
        frequency=wall.frequency or 0.0,
        phase=wall.phase,
        surface_velocity=wall.surface_velocity or (0.0, 0.0, 0.0),
    )
    return replace(made, motion=motion, servo=_servo(wall, made))


def _servo(wall: WallSection, made: SolidWall) -> Servo | None:
    asked = wall.servo
    if asked is None:
        return None
    low, high = face_boxes(made.face, made.kind)
    extent = float((high.max(axis=0) - low.min(axis=0)).max())
    travel = extent if asked.max_travel is None else asked.max_travel
    force, pressure = (math.nan if one is None else one for one in (asked.force, asked.pressure))
    return Servo(asked.direction, asked.max_speed, travel, force, pressure)


def with_room(scene: Scene, low: bool, high: bool) -> Scene:
    """The same scene with a default domain that has room for its walls, on the sides that are asked for."""
    if scene.walls is None:
        return scene
    bottom, top = box_of(scene.walls, 0.0)
    size = float((top - bottom).max())
    below, above = bottom - ROOM_BELOW * float(scene.d.max(initial=0.0)) - size, top + size
    if low:
        least = tuple(min(a, float(b)) for a, b in zip(scene.world_low, below, strict=True))
        scene = replace(scene, world_low=least)
    if high:
        most = tuple(max(a, float(b)) for a, b in zip(scene.world_high, above, strict=True))
        scene = replace(scene, world_high=most)
    return scene
