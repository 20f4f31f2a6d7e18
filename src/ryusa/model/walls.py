"""Walls of a scene: faces in the frame of their wall, and how each wall moves."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ryusa.model.arrays import Bools, Floats

Ints = NDArray[np.int64]


class FaceKind(IntEnum):
    """What a face is; its nine numbers are three vectors."""

    TRIANGLE = 0  # one corner, and the edges from it to the two others [m]
    DISC = 1  # centre [m], unit normal [-], and (radius, 0, 0) [m]
    CYLINDER = 2  # centre of one end [m], unit axis [-], and (radius, length, 0) [m]: the shell, without ends


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
N_MOTION = 27
N_IMPULSE = 7  # of a wall: force [N s], torque about its axis point [N m s], and work that it gave [J]


@dataclass(frozen=True)
class Walls:
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
        return np.any(self.motion[:, VELOCITY:RATE] != 0.0, axis=1)


def at_rest(n_wall: int, t: float = 0.0) -> Floats:
    """Motion of walls that stay where they are, shape (n_wall, N_MOTION)."""
    motion = np.zeros((n_wall, N_MOTION))
    motion[:, BEGIN] = t
    motion[:, TURN : TURN + 9] = np.eye(3).ravel()
    return motion
