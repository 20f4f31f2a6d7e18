"""Walls of a scene: faces in the frame of their wall, and how each wall moves."""

from dataclasses import dataclass, field
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ryusa.laws.walls import swing, swing_speed, turned_about
from ryusa.model.arrays import Bools, Floats
from ryusa.printed import ByShape

Ints = NDArray[np.int64]


class FaceKind(IntEnum):
    """What a face is; its nine numbers are three vectors."""

    TRIANGLE = 0  # one corner, and the edges from it to the two others [m]
    DISC = 1  # centre [m], unit normal [-], and (radius, 0, 0) [m]
    CYLINDER = 2  # centre of one end [m], unit axis [-], and (radius, length, 0) [m]: the shell, without ends


# Which contacts of a grain with faces are one, and how they share a force (design/0019); engines and measures
# go by the same numbers.
ON_FACE = 1e-3  # of the radius: within it a point of an edge lies on a face
SAME_PLACE = 1e-4  # of the radius: within it a point of one face lies on another
LIKE_MOST = 0.98  # of two contacts of one normal; below 1, so that the forces of many are determined
DOUBLINGS = 6  # of the exponent of (1 + cos a)/2, for an angle a between two normals: the 64th power
CELLS = 10.0  # of directions to a unit: contacts whose normals belong to one cell are one, the deepest
EXACT_SHARE, SWEEPS = 1e-9, 400  # of the largest overlap; in all contacts of a grain together
LEAST_SHARE = 1e-12

# columns of the motion of a wall
BEGIN = 0  # time of the pose below [s]
TURN = 1  # rotation at that time, world = turn . frame + shift, by rows, nine columns [-]
SHIFT = 10  # [m]
AXIS_POINT = 13  # on the axis of rotation at that time; it moves with the wall [m]
VELOCITY = 16  # [m/s]
SPIN = 19  # [rad/s], constant
SWING = 22  # amplitude of the oscillation [m]
RATE = 25  # its angular frequency [rad/s]
PHASE = 26  # its phase at that time [rad]
SURFACE = 27  # velocity of the surface against the wall, as of a belt, in the frame of the wall [m/s]
N_RIGID = 27  # columns where no surface runs, and of run folders before surfaces could
N_MOTION = 30
# columns of a servo; a wall without one has zeros
TOWARDS = 0  # unit vector in which the wall presses [-]
ASKED = 3  # force that it is to exert on the grains in this direction [N]
MOST_SPEED = 4  # largest speed along the direction [m/s]
MOST_TRAVEL = 5  # largest distance from the first place along the direction, either way [m]
INTERVAL = 6  # steps from one correction to the next, the same for all walls
BOUND = 7  # of the speed of any point of the wall, from all that moves it [m/s]; known before the run
N_SERVO = 8
N_IMPULSE = 8  # of a wall: force [N s], torque about its axis point [N m s], and
WORK = 6  # work that it gave [J]
TOUCHED = 7  # number of its contacts times the time that they lasted [s]


@dataclass(frozen=True, repr=False)
class Walls(ByShape):
    """Faces of all walls, each in the frame of its wall, which is that of the world while it is at rest.

    Faces take the ids after the planes. Grains touch both sides of a face.
    """

    face: Floats  # numbers of each face (FaceKind), shape (n_face, 9)
    kind: Ints  # FaceKind, shape (n_face,)
    wall: Ints  # number of its wall, shape (n_face,)
    surface: Ints  # number of its smooth surface, shape (n_face,)
    active: Bools  # False once removed, shape (n_wall,)
    motion: Floats  # shape (n_wall, N_MOTION)
    names: tuple[str, ...]  # of each wall
    # of walls that press on the grains (model.servo), shape (n_wall, N_SERVO); empty: there is none
    servo: Floats = field(default_factory=lambda: np.zeros((0, N_SERVO)))

    @property
    def n_face(self) -> int:
        """Number of faces."""
        return len(self.kind)

    @property
    def n_wall(self) -> int:
        """Number of walls."""
        return len(self.names)

    @property
    def face_active(self) -> Bools:
        """Whether the wall of each face is there, shape (n_face,)."""
        return self.active[self.wall]

    def moving(self) -> Bools:
        """Whether each wall moves, shape (n_wall,)."""
        moves = np.any(self.motion[:, VELOCITY:RATE] != 0.0, axis=1)
        return moves | (self.servo[:, ASKED] != 0.0) if len(self.servo) else moves

    def running(self) -> Bools:
        """Whether the surface of each wall runs, shape (n_wall,)."""
        return np.any(self.motion[:, SURFACE : SURFACE + 3] != 0.0, axis=1)


def at_rest(n_wall: int, t: float = 0.0) -> Floats:
    """Motion of walls that stay where they are, shape (n_wall, N_MOTION)."""
    motion = np.zeros((n_wall, N_MOTION))
    motion[:, BEGIN] = t
    motion[:, TURN : TURN + 9] = np.eye(3).ravel()
    return motion


def pose(row: Floats, t: float) -> tuple[Floats, Floats]:
    """Rotation (3, 3) and shift (3,) [m] of a wall at time t [s]: world = rotation . frame + shift.

    Parameters
    ----------
    row : motion of the wall, columns as above.

    >>> row = at_rest(1)[0]
    >>> row[SPIN + 2] = np.pi
    >>> [float(one) for one in np.round(pose(row, 0.5)[0] @ np.array([1.0, 0.0, 0.0]), 12) + 0.0]
    [0.0, 1.0, 0.0]
    """
    since = t - float(row[BEGIN])
    turn, shift = row[TURN : TURN + 9].reshape(3, 3).copy(), row[SHIFT : SHIFT + 3].copy()
    spin, axis_point = row[SPIN : SPIN + 3], row[AXIS_POINT : AXIS_POINT + 3]
    rate = float(np.linalg.norm(spin))
    if rate > 0.0:
        shift -= axis_point
        for vector in (*turn.T, shift):
            (x, y, z), (a, b, c) = vector.tolist(), (spin / rate).tolist()
            vector[:] = turned_about(x, y, z, a, b, c, rate * since)
        shift += axis_point
    return turn, shift + drift(row, since)


def surface_velocity(row: Floats, t: float) -> Floats:
    """Velocity of the surface of a wall against the wall at time t [s], in the world [m/s], shape (3,).

    It turns with the wall; at a contact its part along the face counts.
    """
    return np.asarray(pose(row, t)[0] @ row[SURFACE : SURFACE + 3])


def drift(row: Floats, since: float) -> Floats:
    """Displacement of the axis point of a wall in a time [s] after its motion began [m], (3,)."""
    swings = [swing(float(one), float(row[RATE]), since, float(row[PHASE])) for one in row[SWING : SWING + 3]]
    return np.asarray(row[VELOCITY : VELOCITY + 3] * since + np.array(swings))


class Carrier(NamedTuple):
    """Where a wall is and how it moves at one time; what is attached to it moves with it.

    Attributes
    ----------
    turn, shift : its pose, (3, 3) [-] and (3,) [m]: world = turn . frame + shift.
    axis_point : a point on its axis [m], shape (3,).
    velocity : of that point [m/s], shape (3,).
    spin : [rad/s], shape (3,).
    """

    turn: Floats
    shift: Floats
    axis_point: Floats
    velocity: Floats
    spin: Floats

    @staticmethod
    def of(row: Floats, t: float) -> "Carrier":
        """A wall with a motion (columns as above) at time t [s].

        >>> row = at_rest(1)[0]
        >>> row[SPIN + 2] = 2.0
        >>> arm = Carrier.of(row, np.pi / 4.0)
        >>> [
        ...     [float(x) for x in np.round(one, 12) + 0.0]
        ...     for one in (arm.place(np.array([1.0, 0.0, 0.0])), arm.velocity_at(np.array([0.0, 1.0, 0.0])))
        ... ]
        [[0.0, 1.0, 0.0], [-2.0, 0.0, 0.0]]
        """
        since, rate, phase = t - float(row[BEGIN]), float(row[RATE]), float(row[PHASE])
        speeds = [swing_speed(float(one), rate, since, phase) for one in row[SWING : SWING + 3]]
        turn, shift = pose(row, t)
        axis_point = row[AXIS_POINT : AXIS_POINT + 3] + drift(row, since)
        return Carrier(
            turn, shift, axis_point, row[VELOCITY : VELOCITY + 3] + np.array(speeds), row[SPIN : SPIN + 3]
        )

    def place(self, x: Floats) -> Floats:
        """Where a point of the frame of the wall is [m]; rows of shape (n, 3) too."""
        return np.asarray(x @ self.turn.T + self.shift)

    def frame(self, x: Floats) -> Floats:
        """The point of the frame of the wall at a place [m]; rows of shape (n, 3) too."""
        return np.asarray((x - self.shift) @ self.turn)

    def velocity_at(self, x: Floats) -> Floats:
        """Velocity of the wall at a place [m/s], shape (3,)."""
        return np.asarray(self.velocity + np.cross(self.spin, x - self.axis_point))


def carried_on(row: Floats, t: float) -> Floats:
    """The same motion of a wall, described from time t [s] on."""
    turn, shift = pose(row, t)
    since, later = t - float(row[BEGIN]), row.copy()
    later[TURN : TURN + 9], later[SHIFT : SHIFT + 3], later[BEGIN] = turn.ravel(), shift, t
    later[AXIS_POINT : AXIS_POINT + 3] += drift(row, since)
    later[PHASE] += row[RATE] * since
    return later


def face_boxes(face: Floats, kind: Ints) -> tuple[Floats, Floats]:
    """Lowest and highest corner of the box round each face [m], in its frame, (n_face, 3) each."""
    a, b, c = face[:, :3], face[:, 3:6], face[:, 6:9]
    low = np.minimum(a, np.minimum(a + b, a + c))
    high = np.maximum(a, np.maximum(a + b, a + c))
    curved = kind != FaceKind.TRIANGLE
    across = np.sqrt(np.maximum(1.0 - b**2, 0.0)) * c[:, :1]  # of a disc normal to b
    end = a + np.where(kind == FaceKind.CYLINDER, c[:, 1], 0.0)[:, None] * b
    low[curved] = (np.minimum(a, end) - across)[curved]
    high[curved] = (np.maximum(a, end) + across)[curved]
    return low, high


def across(axis: Floats) -> Floats:
    """A unit vector normal to another vector, shape (3,)."""
    side = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    return np.asarray(side / np.linalg.norm(side), dtype=np.float64)


def corners_of_box(low: Floats, high: Floats) -> Floats:
    """The eight corners of a box [m], (8, 3)."""
    unit = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    return np.asarray(low + unit * (high - low))


def speed_of(row: Floats, low: Floats, high: Floats) -> float:
    """Bound of the speed of any point of a wall [m/s].

    Parameters
    ----------
    row : its motion.
    low, high : corners of the box round it, in its frame [m].
    """
    spin = row[SPIN : SPIN + 3]
    rate = float(np.linalg.norm(spin))
    speed = float(np.linalg.norm(row[VELOCITY : VELOCITY + 3]))
    speed += float(np.linalg.norm(row[SWING : SWING + 3])) * abs(float(row[RATE]))
    if rate > 0.0:
        turn, shift = row[TURN : TURN + 9].reshape(3, 3), row[SHIFT : SHIFT + 3]
        arm = corners_of_box(low, high) @ turn.T + shift - row[AXIS_POINT : AXIS_POINT + 3]
        speed += rate * float(np.linalg.norm(np.cross(arm, spin / rate), axis=1).max())
    return speed


def largest_speed(walls: Walls) -> float:
    """Bound of the speed of any point of any wall that is there [m/s]; 0 where none moves."""
    low, high = face_boxes(walls.face, walls.kind)
    fastest = 0.0
    for w in np.flatnonzero(walls.active & walls.moving()):
        mine = walls.wall == w
        if mine.any():
            # a servo changes the motion, and must not change when lists are made
            known = float(walls.servo[w, BOUND]) if len(walls.servo) else 0.0
            speed = known or speed_of(walls.motion[w], low[mine].min(axis=0), high[mine].max(axis=0))
            fastest = max(fastest, speed)
    return fastest


def box_of(walls: Walls, t: float) -> tuple[Floats, Floats]:
    """Lowest and highest corner of the boxes of all walls at time t [s], in the world [m]."""
    low, high = face_boxes(walls.face, walls.kind)
    every: list[Floats] = []
    for w in range(walls.n_wall):
        mine = walls.wall == w
        if mine.any():
            turn, shift = pose(walls.motion[w], t)
            every.append(corners_of_box(low[mine].min(axis=0), high[mine].max(axis=0)) @ turn.T + shift)
    points = np.vstack(every)
    return points.min(axis=0), points.max(axis=0)
