"""Walls that a servo presses on the grains: with what force, and how often it is corrected."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ryusa.model import FaceKind, Scene
from ryusa.model.arrays import Floats
from ryusa.model.contact_law import contact_time_of
from ryusa.model.walls import (
    ASKED,
    BOUND,
    INTERVAL,
    MOST_SPEED,
    MOST_TRAVEL,
    N_SERVO,
    TOWARDS,
    Ints,
    face_boxes,
    speed_of,
)


@dataclass(frozen=True)
class Servo:
    """A wall that is pressed on the grains: the force on them, or the mean pressure, is kept at a number.

    Attributes
    ----------
    towards : direction in which it presses, of any length.
    max_speed : along it, either way [m/s].
    max_travel : along it from the first place, either way [m].
    force : on the grains in this direction [N]; nan where a pressure is given.
    pressure : force over the area of the wall seen along `towards` [Pa]; nan where a force is given.
    """

    towards: tuple[float, float, float]
    max_speed: float
    max_travel: float
    force: float = math.nan
    pressure: float = math.nan


def area_along(face: Floats, kind: Ints, towards: Floats) -> float:
    """Area of faces seen along a unit vector, front and back each by itself [m2]; a shell has none.

    >>> face = np.array([[0.0, 0, 0, 2, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1, 1, 0, 0]])
    >>> round(area_along(face, np.array([FaceKind.TRIANGLE, FaceKind.DISC]), np.array([0.0, 0, -1])), 6)
    4.141593
    """
    across = 0.5 * np.cross(face[:, 3:6], face[:, 6:9])
    round_ = kind == FaceKind.DISC
    across[round_] = math.pi * face[round_, 6:7] ** 2 * face[round_, 3:6]
    across[kind == FaceKind.CYLINDER] = 0.0
    return float(np.abs(across @ towards).sum())


def servo_interval(scene: Scene) -> int:
    """Steps from one correction to the next: those of a contact of a mean grain with a wall."""
    m, r = float(np.mean(scene.m + scene.m_added)), 0.5 * float(np.mean(scene.d))
    return max(round(contact_time_of(scene.contact, m, r, scene.contact.speed) / scene.dt), 1)


def servo_rows(
    scene: Scene, faces: Sequence[tuple[Floats, Ints]], servos: Sequence[Servo | None], motion: Floats
) -> Floats:
    """Numbers of the servos of all walls (model.walls), (n_wall, N_SERVO); no row where there is none.

    Parameters
    ----------
    scene : its grains, contact law and step.
    faces : numbers and kinds of the faces of each wall.
    motion : of each wall beside its servo (model.walls), (n_wall, N_MOTION).
    """
    rows = np.zeros((len(servos), N_SERVO))
    if not any(servos):
        return rows[:0]
    rows[:, INTERVAL] = servo_interval(scene)
    for row, (face, kind), servo, own in zip(rows, faces, servos, motion, strict=True):
        if servo is None:
            continue
        towards = np.array(servo.towards) / np.linalg.norm(servo.towards)
        area = area_along(face, kind, towards)
        row[TOWARDS : TOWARDS + 3] = towards
        row[ASKED] = servo.force if math.isnan(servo.pressure) else servo.pressure * area
        row[MOST_SPEED], row[MOST_TRAVEL] = servo.max_speed, servo.max_travel
        low, high = face_boxes(face, kind)
        row[BOUND] = speed_of(own, low.min(axis=0), high.max(axis=0)) + servo.max_speed
    return rows
