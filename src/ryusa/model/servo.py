"""Walls that a servo presses on the grains: what is asked of each, and where one is."""

from dataclasses import replace

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.model.scene import Scene
from ryusa.model.walls import ASKED, AXIS_POINT, BEGIN, SHIFT, TOWARDS, VELOCITY, Ints, Walls


def driven(walls: Walls | None) -> Ints:
    """Numbers of the walls that have a servo and are there."""
    if walls is None or not len(walls.servo):
        return np.zeros(0, np.int64)
    return np.flatnonzero((walls.servo[:, ASKED] != 0.0) & walls.active)


def motion_with(walls: Walls, travel: Floats, speed: Floats, t: float) -> Floats:
    """Motion of all walls from time t [s] on, (n_wall, N_MOTION): their own, and that of their servos.

    Parameters
    ----------
    travel : displacement of each wall along the direction of its servo up to t [m], shape (n_wall,).
    speed : along it from t on [m/s].

    Notes
    -----
    It is found from the motion of the scene each time, never from that of the last interval, so that
    round-off does not add up.
    """
    motion = np.array(walls.motion)
    for w in driven(walls):
        towards = walls.servo[w, TOWARDS : TOWARDS + 3]
        to_begin = towards * (travel[w] - speed[w] * (t - motion[w, BEGIN]))
        motion[w, SHIFT : SHIFT + 3] += to_begin
        motion[w, AXIS_POINT : AXIS_POINT + 3] += to_begin
        motion[w, VELOCITY : VELOCITY + 3] += towards * speed[w]
    return motion


def on_way(scene: Scene, times: Floats, travel: Floats, t: float) -> Scene:
    """A scene with its walls where they are at a time between two frames.

    Parameters
    ----------
    times : of all frames [s], shape (n_frame,).
    travel : of each wall along the direction of its servo [m], shape (n_frame, n_wall).
    t : before the first and after the last frame the way goes on as in the interval beside it [s].
    """
    walls = scene.walls
    if walls is None or not len(times):
        return scene
    k = int(np.clip(np.searchsorted(times, t, side="right") - 1, 0, max(len(times) - 2, 0)))
    speed = np.zeros(scene.n_wall)
    if len(times) > 1:
        speed = (travel[k + 1] - travel[k]) / (times[k + 1] - times[k])
    motion = motion_with(walls, travel[k], speed, float(times[k]))
    return replace(scene, walls=replace(walls, motion=motion))
