"""Geometry and velocities of the pairs of a batch, lane by lane: the same for every law of contact."""
# ruff: noqa: E741  (l is a lane)

import math
from typing import Any

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.laws.contact_step import contact_kinematics
from ryusa.laws.geometry import overlap as overlap_of
from ryusa.laws.geometry import wrap


@inner(fastmath=FAST)
def overlap_of_lane(l: int, c: Any, batch: Any) -> float:
    """Overlap of the pair on lane l [m]."""
    d_x, d_z = wrap(batch[B.SEPARATION + 4 * l], c[P.PERIOD_X]), batch[B.SEPARATION + 4 * l + 2]
    d_y = wrap(batch[B.SEPARATION + 4 * l + 1], c[P.PERIOD_Y])
    distance = math.sqrt(d_x * d_x + d_y * d_y + d_z * d_z)
    return overlap_of(batch[B.SPIN_I + 4 * l + 3], batch[B.SPIN_J + 4 * l + 3], distance)


@inner(fastmath=FAST, forceinline=True)
def kinematics_of_lane(
    l: int, plane: bool, most: float, dt: float, l_x: float, l_y: float, batch: Any
) -> tuple[float, float]:
    """Write normal, arms, slip and twist of lane l; returns overlap [m] and closing speed [m/s] of its pair.

    `most` is the largest overlap over diameter so far [-], `l_x` and `l_y` are the periods [m].
    """
    d_x, d_y, d_z = wrap(batch[B.SEPARATION + 4 * l], l_x), 0.0, batch[B.SEPARATION + 4 * l + 2]
    u_x, u_y, u_z = batch[B.RELATIVE_VELOCITY + 4 * l], 0.0, batch[B.RELATIVE_VELOCITY + 4 * l + 2]
    i_x, i_y, i_z = batch[B.SPIN_I + 4 * l], batch[B.SPIN_I + 4 * l + 1], batch[B.SPIN_I + 4 * l + 2]
    j_x, j_y, j_z = batch[B.SPIN_J + 4 * l], batch[B.SPIN_J + 4 * l + 1], batch[B.SPIN_J + 4 * l + 2]
    if plane:  # spin has one component; the zeros beside it are read to read all four of a group
        i_y, j_y = i_x + i_y + i_z, j_x + j_y + j_z
    else:
        d_y, u_y = wrap(batch[B.SEPARATION + 4 * l + 1], l_y), batch[B.RELATIVE_VELOCITY + 4 * l + 1]
    r_i, r_j = batch[B.SPIN_I + 4 * l + 3], batch[B.SPIN_J + 4 * l + 3]
    n_x, n_y, n_z, overlap, a_i, a_j, closing, s_x, s_y, s_z, twist = contact_kinematics(
        plane, d_x, d_y, d_z, batch[B.SEPARATION + 4 * l + 3], r_i, u_x, u_y, u_z,
        i_x, i_y, i_z, j_x, j_y, j_z, dt,
    )  # fmt: skip
    if not plane:
        batch[B.TWIST + l] = twist
        batch[B.NORMAL + B.PITCH + l] = n_y
        batch[B.SLIP + B.PITCH + l], batch[B.SLIP + 2 * B.PITCH + l] = s_y, s_z
    batch[B.NORMAL + l], batch[B.NORMAL + 2 * B.PITCH + l] = n_x, n_z
    batch[B.SLIP + l] = s_x
    batch[B.OVERLAP + l], batch[B.CLOSING + l] = overlap, closing
    batch[B.ARM_I + l], batch[B.ARM_J + l] = a_i, a_j
    batch[B.EXCESS + l] = overlap - 2.0 * most * min(r_i, r_j)
    return overlap, closing
