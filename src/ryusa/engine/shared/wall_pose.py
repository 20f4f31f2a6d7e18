"""Where walls are at a step, one step before and one after: their poses, from their motion in closed form."""

import math
from typing import Any

from ryusa.engine.shared.kernel import kernel
from ryusa.laws.walls import swing, turned_about
from ryusa.model.walls import AXIS_POINT, BEGIN, PHASE, RATE, SHIFT, SPIN, SURFACE, SWING, TURN, VELOCITY

# Columns of a pose: world = turn . frame + shift, twelve numbers each.
NOW, BEFORE, AFTER = 0, 12, 24
AXIS = 36  # the axis point now [m]
MOVES = 39  # 1 where the wall moves
PLACED = 40  # 1 where the frame of the wall is not the world now
RUNS = 41  # 1 where its surface runs
RUN = 42  # velocity of the surface against the wall now, in the world [m/s]
N_POSE = 45


@kernel()
def pose_at(w: int, t: float, motion: Any, poses: Any, at: int) -> None:
    """Write the pose of wall w at time t [s] to twelve columns of `poses` from `at` on."""
    row = motion[w]
    since = t - row[BEGIN]
    s_x, s_y, s_z = row[SPIN], row[SPIN + 1], row[SPIN + 2]
    rate = math.sqrt(s_x * s_x + s_y * s_y + s_z * s_z)
    # every number is written once: another thread, that writes the same ones, may be reading already
    q_x, q_y, q_z = row[SHIFT], row[SHIFT + 1], row[SHIFT + 2]
    if rate > 0.0:
        a_x, a_y, a_z, angle = s_x / rate, s_y / rate, s_z / rate, rate * since
        for k in range(3):
            poses[w, at + k], poses[w, at + 3 + k], poses[w, at + 6 + k] = turned_about(
                row[TURN + k], row[TURN + 3 + k], row[TURN + 6 + k], a_x, a_y, a_z, angle
            )
        p_x, p_y, p_z = row[AXIS_POINT], row[AXIS_POINT + 1], row[AXIS_POINT + 2]
        q_x, q_y, q_z = turned_about(q_x - p_x, q_y - p_y, q_z - p_z, a_x, a_y, a_z, angle)
        q_x, q_y, q_z = p_x + q_x, p_y + q_y, p_z + q_z
    else:
        for k in range(9):
            poses[w, at + k] = row[TURN + k]
    rate, phase = row[RATE], row[PHASE]
    poses[w, at + 9] = q_x + row[VELOCITY] * since + swing(row[SWING], rate, since, phase)
    poses[w, at + 10] = q_y + row[VELOCITY + 1] * since + swing(row[SWING + 1], rate, since, phase)
    poses[w, at + 11] = q_z + row[VELOCITY + 2] * since + swing(row[SWING + 2], rate, since, phase)


@kernel(nogil=True)
def set_poses(t: float, dt: float, motion: Any, poses: Any) -> None:
    """Write the poses of all walls at time t [s], and a step before and after, to (n_wall, N_POSE)."""
    for w in range(len(motion)):
        row = motion[w]
        moves = 0.0
        for k in range(VELOCITY, RATE):
            moves = 1.0 if row[k] != 0.0 else moves
        poses[w, MOVES] = moves
        r_x, r_y, r_z = row[SURFACE], row[SURFACE + 1], row[SURFACE + 2]
        poses[w, RUNS] = 1.0 if r_x != 0.0 or r_y != 0.0 or r_z != 0.0 else 0.0
        pose_at(w, t, motion, poses, NOW)
        pose_at(w, t - dt, motion, poses, BEFORE)
        pose_at(w, t + dt, motion, poses, AFTER)
        for k in range(3):
            poses[w, RUN + k] = poses[w, 3 * k] * r_x + poses[w, 3 * k + 1] * r_y + poses[w, 3 * k + 2] * r_z
        placed = 0.0
        for k in range(12):
            placed = placed if poses[w, NOW + k] == (1.0 if k in (0, 4, 8) else 0.0) else 1.0
        poses[w, PLACED] = placed
        since = t - row[BEGIN]
        for k in range(3):
            poses[w, AXIS + k] = (
                row[AXIS_POINT + k]
                + row[VELOCITY + k] * since
                + swing(row[SWING + k], row[RATE], since, row[PHASE])
            )
