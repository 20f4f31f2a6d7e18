"""How the walls that grains touch move, and what contacts do to them (design/0019)."""
# ruff: noqa: E741  (l is a lane)

from typing import Any

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu import faces as F
from ryusa.engine.cpu.faces import in_world
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.wall_pose import AFTER, AXIS, MOVES, NOW, RUN, RUNS
from ryusa.model.walls import SPIN, TOUCHED


@inner(fastmath=FAST, forceinline=True)
def drift_of_image(
    w: int, at: int, before: int, x: float, y: float, z: float, poses: Any
) -> tuple[float, float, float]:
    """Displacement of a point of a wall between two poses [m]."""
    a = in_world(w, at, x, y, z, poses)
    b = in_world(w, before, x, y, z, poses)
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inner(fastmath=FAST, forceinline=True)
def run_along(w: int, s: int, met: Any, poses: Any) -> tuple[float, float, float]:
    """Velocity of a running surface along the face that row s of `met` touches [m/s]."""
    n_x, n_y, n_z = met[s, F.AWAY], met[s, F.AWAY + 1], met[s, F.AWAY + 2]
    r_x, r_y, r_z = poses[w, RUN], poses[w, RUN + 1], poses[w, RUN + 2]
    along = r_x * n_x + r_y * n_y + r_z * n_z
    return r_x - along * n_x, r_y - along * n_y, r_z - along * n_z


@inner(fastmath=FAST, forceinline=True)
def add_drift(face_lanes: Any, selected: Any, slot: Any, motion: Any, met: Any, batch: Any) -> None:
    """Take the motion of walls off relative velocities in a batch; mirrored grains spin with their wall."""
    for n in range(face_lanes[B.LANES]):
        l = face_lanes[n]
        s = slot[selected[l]]
        if met[s, F.SLOT] < 0.0:  # a plane
            continue
        w = int(met[s, F.SLOT])
        for a in range(3):
            batch[B.RELATIVE_VELOCITY + 4 * l + a] -= met[s, F.DRIFT + a]
            batch[B.SPIN_J + 4 * l + a] = motion[w, SPIN + a]


@inner(fastmath=FAST, forceinline=True)
def book_walls(
    given: float, pending: float, face_lanes: Any, selected: Any, hdt: float, touched: float, c: Any,
    i_of: Any, x_of: Any, slot: Any, p: Any, motion: Any, met: Any, impulse: Any, batch: Any,
) -> tuple[float, float]:  # fmt: skip
    """Add the impulses on walls of the faces in a batch to those of their block, (n_wall, N_IMPULSE).

    `touched` is the time of touch that each counts [s].

    Returns `given` and `pending` with the work of walls that move over the half interval before this step,
    and over that after it, which is booked with the next one, as that of drag [J]. The mirrored grain has the
    velocity and the spin of the wall, which works against the force and the torque on it; where the surface
    runs, its velocity along the face in addition.
    """
    dt = c[P.DT]
    for n in range(face_lanes[B.LANES]):
        l = face_lanes[n]
        f_x, f_y, f_z = batch[B.FORCE + 4 * l], batch[B.FORCE + 4 * l + 1], batch[B.FORCE + 4 * l + 2]
        if f_x == 0.0 and f_y == 0.0 and f_z == 0.0:
            continue
        t_x, t_y = batch[B.TORQUE_J + 4 * l], batch[B.TORQUE_J + 4 * l + 1]
        t_z = batch[B.TORQUE_J + 4 * l + 2]
        k = selected[l]
        i, s = i_of[k], slot[k]
        if met[s, F.SLOT] < 0.0:  # a plane
            continue
        w = int(met[s, F.SLOT])
        x = x_of[i, 0] + met[s, F.GAP] - p[w, AXIS]
        y = x_of[i, 1] + met[s, F.GAP + 1] - p[w, AXIS + 1]
        z = x_of[i, 2] + met[s, F.GAP + 2] - p[w, AXIS + 2]
        impulse[w, TOUCHED] += touched
        impulse[w, 0] -= f_x * dt
        impulse[w, 1] -= f_y * dt
        impulse[w, 2] -= f_z * dt
        impulse[w, 3] += (t_x - (y * f_z - z * f_y)) * dt
        impulse[w, 4] += (t_y - (z * f_x - x * f_z)) * dt
        impulse[w, 5] += (t_z - (x * f_y - y * f_x)) * dt
        moves, runs = p[w, MOVES] != 0.0, p[w, RUNS] != 0.0
        if not (moves or runs):
            continue
        turning = t_x * motion[w, SPIN] + t_y * motion[w, SPIN + 1] + t_z * motion[w, SPIN + 2]
        before = f_x * met[s, F.DRIFT] + f_y * met[s, F.DRIFT + 1] + f_z * met[s, F.DRIFT + 2] - turning
        after = 0.0
        if moves:
            n_x, n_y, n_z, r = met[s, F.AWAY], met[s, F.AWAY + 1], met[s, F.AWAY + 2], x_of[i, 3]
            on = drift_of_image(
                w, AFTER, NOW,
                met[s, F.POINT] - r * (p[w, 0] * n_x + p[w, 3] * n_y + p[w, 6] * n_z),
                met[s, F.POINT + 1] - r * (p[w, 1] * n_x + p[w, 4] * n_y + p[w, 7] * n_z),
                met[s, F.POINT + 2] - r * (p[w, 2] * n_x + p[w, 5] * n_y + p[w, 8] * n_z), p,
            )  # fmt: skip
            after = (f_x * on[0] + f_y * on[1] + f_z * on[2]) / dt - turning
        if runs:
            u_x, u_y, u_z = run_along(w, s, met, p)
            after += f_x * u_x + f_y * u_y + f_z * u_z
        given += hdt * before
        pending += 0.5 * dt * after
        impulse[w, 6] += hdt * before + 0.5 * dt * after
    return given, pending
