"""Walls that a servo presses on the grains: with what force, and how often it is corrected."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ryusa.model import FaceKind, Scene
from ryusa.model.arrays import Floats
from ryusa.model.contact_law import contact_time_of
from ryusa.model.plane_section import SIDES, rim_of, section_area
from ryusa.model.wall_shape import triangles_of
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
from ryusa.model.welding import rims

ROUND = 1.0e-4  # share by which the area of the polygon that stands for a disc may be too small
ASIDE = 1.0e-6  # of the size of a wall, towards the grains


@dataclass(frozen=True)
class Servo:
    """A wall that is pressed on the grains: the force on them, or the mean pressure, is kept at a number.

    Attributes
    ----------
    towards : direction in which it presses, of any length.
    max_speed : along it, either way [m/s].
    max_travel : along it from the first place, either way [m].
    force : on the grains in this direction [N]; nan where a pressure is given.
    pressure : force over the area with which the wall presses on the sample [Pa]; nan where a force is given.
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


def pressed_area(scene: Scene, wall: int, towards: Floats) -> tuple[float, float]:
    """Area with which a wall presses on the sample, and the area of the sample, at t = 0 [m2].

    Parameters
    ----------
    towards : unit vector in which it presses, shape (3,).

    Returns
    -------
    area : of the wall seen along `towards`, of a closed body one side; without what lies beyond other walls
        and planes, as they stand in the plane of the wall, or beyond one period. Of a wall with a hole or a
        recess, such as a ring, all of it.
    sample : all that other walls, planes and periods bound there; inf where it is open, nan where the wall
        has a hole or a recess.
    """
    walls = scene.walls
    assert walls is not None
    mine = walls.wall == wall
    whole = area_along(walls.face[mine], walls.kind[mine], towards)
    corners, owner = triangles_of(walls, SIDES)
    own = corners[owner == wall]
    if not rims(own)[0]:  # a closed body
        whole *= 0.5
    rim, hull = rim_of(own.reshape(-1, 3), towards)
    if whole < (1.0 - ROUND) * hull:
        return whole, math.nan
    whole = whole if whole <= (1.0 + ROUND) * hull else hull  # more: folds that lie over each other
    origin = rim.mean(axis=0) + ASIDE * float(np.ptp(rim)) * towards  # another wall may end where it begins
    within = section_area(scene, origin, towards, 0.0, rim, without=wall)
    sample = section_area(scene, origin, towards, 0.0, without=wall)
    return within if within < (1.0 - ROUND) * whole else whole, sample


def servo_notes(scene: Scene, pressures: Mapping[int, float]) -> tuple[str, ...]:
    """On what area each pressure acts, [Pa] by number of the wall."""
    walls, notes = scene.walls, list[str]()
    for w, pressure in pressures.items():
        assert walls is not None
        row = walls.servo[w]
        area, sample = pressed_area(scene, w, row[TOWARDS : TOWARDS + 3])
        share = area / sample
        if math.isnan(sample):
            said = "all of it, since it has a hole or a recess; what lies beyond other walls counts too"
        elif share > 1.0 - ROUND:
            said = "the whole sample"
        elif math.isinf(sample):
            said = "its own, as the sample has open sides"
        else:
            said = f"{share:.1%} of the sample, in which the mean pressure is {share * pressure:.4g} Pa"
        notes.append(
            f"servo of '{walls.names[w]}': {pressure:.4g} Pa on {1.0e4 * area:.4g} cm2, {said}: "
            f"{float(row[ASKED]):.4g} N"
        )
    return tuple(notes)


def servo_interval(scene: Scene) -> int:
    """Steps from one correction to the next: those of a contact of a mean grain with a wall."""
    m, r = float(np.mean(scene.m + scene.m_added)), 0.5 * float(np.mean(scene.d))
    return max(round(contact_time_of(scene.contact, m, r, scene.contact.speed) / scene.dt), 1)


def servo_rows(scene: Scene, servos: Sequence[Servo | None]) -> Floats:
    """Numbers of the servos of the walls of a scene (model.walls), (n_wall, N_SERVO); no row without any."""
    rows = np.zeros((len(servos), N_SERVO))
    if not any(servos):
        return rows[:0]
    rows[:, INTERVAL] = servo_interval(scene)
    walls = scene.walls
    assert walls is not None
    for w, (row, servo) in enumerate(zip(rows, servos, strict=True)):
        if servo is None:
            continue
        towards = np.array(servo.towards) / np.linalg.norm(servo.towards)
        row[TOWARDS : TOWARDS + 3] = towards
        row[ASKED] = servo.force
        if not math.isnan(servo.pressure):
            row[ASKED] = servo.pressure * pressed_area(scene, w, towards)[0]
        row[MOST_SPEED], row[MOST_TRAVEL] = servo.max_speed, servo.max_travel
        low, high = face_boxes(walls.face[walls.wall == w], walls.kind[walls.wall == w])
        row[BOUND] = speed_of(walls.motion[w], low.min(axis=0), high.max(axis=0)) + servo.max_speed
    return rows
