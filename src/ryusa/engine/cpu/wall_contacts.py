"""Which of the faces near a grain it touches, and what contacts do to moving walls (design/0019).

Before the pairs of a block are filtered, the nearest points of all faces near its grains are found, and of
the faces met in one place one is kept: the others are put out of reach, and their memory goes to that one.
"""
# ruff: noqa: E741  (l is a lane)

import math
from typing import Any

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu import faces as F
from ryusa.engine.cpu.arrays import CandidateArrays, GrainArrays
from ryusa.engine.cpu.contact_rows import copy_row
from ryusa.engine.cpu.faces import FaceArrays, in_frame, in_world, nearest_image, nearest_of_face
from ryusa.engine.cpu.simd.prefetch import prefetch
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.wall_pose import AFTER, AXIS, BEFORE, MOVES, NOW, PLACED
from ryusa.model.walls import SPIN, TOUCHED

ON_FACE = 1e-3  # of the radius: within it a point lies on a face
SAME_POINT = 1e-9  # of the radius: nearest points closer than this are one, as on an edge that faces share
SAME_PLACE = math.cos(math.radians(45.0))  # of normals of one smooth surface that count as one place
AHEAD = 8  # faces whose numbers are asked for before they are needed


@inner(fastmath=FAST, forceinline=True)
def drift_of_image(
    w: int, at: int, before: int, x: float, y: float, z: float, poses: Any
) -> tuple[float, float, float]:
    """Displacement of a point of a wall between two poses [m]."""
    a = in_world(w, at, x, y, z, poses)
    b = in_world(w, before, x, y, z, poses)
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inner(fastmath=FAST)
def _meet(
    s: int, i: int, f: int, reach: float, touched: bool, c: Any, x_of: Any, poses: Any, rows: Any,
    centre: Any, met: Any,
) -> int:  # fmt: skip
    """Find how grain i and face f meet, and write it to row s of `met`; 1 if they do or did, else 0."""
    w, r = int(rows[f, F.WALL]), x_of[i, 3]
    x, y, z = x_of[i, 0], x_of[i, 1], x_of[i, 2]
    placed = poses[w, PLACED] != 0.0
    if placed:
        x, y, z = in_frame(w, NOW, x, y, z, poses)
    x, y = nearest_image(f, x, y, c[P.PERIOD_X], c[P.PERIOD_Y], centre)
    c_x, c_y, c_z, n_x, n_y, n_z, distance = nearest_of_face(f, x, y, z, rows)
    met[s, F.DISTANCE], met[s, F.BY], met[s, F.GAP + 3] = distance, -1.0, 2.0 * r
    if distance >= reach and not touched:
        met[s, F.GAP], met[s, F.GAP + 1], met[s, F.GAP + 2] = B.FAR, 0.0, 0.0
        return 0
    a_x, a_y, a_z = n_x, n_y, n_z
    if placed:
        a_x = poses[w, 0] * n_x + poses[w, 1] * n_y + poses[w, 2] * n_z
        a_y = poses[w, 3] * n_x + poses[w, 4] * n_y + poses[w, 5] * n_z
        a_z = poses[w, 6] * n_x + poses[w, 7] * n_y + poses[w, 8] * n_z
    way = -(distance + r)
    met[s, F.GAP], met[s, F.GAP + 1], met[s, F.GAP + 2] = way * a_x, way * a_y, way * a_z
    met[s, F.POINT], met[s, F.POINT + 1], met[s, F.POINT + 2] = c_x, c_y, c_z
    met[s, F.AWAY], met[s, F.AWAY + 1], met[s, F.AWAY + 2] = a_x, a_y, a_z
    met[s, F.SLOT] = w
    d_x = d_y = d_z = 0.0
    if poses[w, MOVES] != 0.0:
        dt = c[P.DT]
        d_x, d_y, d_z = drift_of_image(w, NOW, BEFORE, c_x - r * n_x, c_y - r * n_y, c_z - r * n_z, poses)
        d_x, d_y, d_z = d_x / dt, d_y / dt, d_z / dt
    met[s, F.DRIFT], met[s, F.DRIFT + 1], met[s, F.DRIFT + 2] = d_x, d_y, d_z
    return 1


@inner(fastmath=FAST)
def _lies_on(
    k: int, g: int, f: int, tolerance: float, c: Any, poses: Any, rows: Any, centre: Any, met: Any
) -> bool:
    """Whether the nearest point in row k lies on face f, which is in row g."""
    x, y, z = met[k, F.POINT], met[k, F.POINT + 1], met[k, F.POINT + 2]
    w, v = int(met[k, F.SLOT]), int(met[g, F.SLOT])
    if w != v:
        x, y, z = in_world(w, NOW, x, y, z, poses)
        x, y, z = in_frame(v, NOW, x, y, z, poses)
    x, y = nearest_image(f, x, y, c[P.PERIOD_X], c[P.PERIOD_Y], centre)
    return nearest_of_face(f, x, y, z, rows)[6] <= tolerance


@inner(fastmath=FAST, forceinline=True)
def _alike(k: int, g: int, met: Any) -> bool:
    """Whether the normals in two rows count as one place of a smooth surface."""
    a = F.AWAY
    along = met[k, a] * met[g, a] + met[k, a + 1] * met[g, a + 1] + met[k, a + 2] * met[g, a + 2]
    return along > SAME_PLACE


@inner(fastmath=FAST)
def _same_point(k: int, g: int, r: float, met: Any) -> bool:
    """Whether the nearest points in two rows are one, seen from the centre of the grain."""
    apart = 0.0
    for a in range(3):
        off = met[k, F.DISTANCE] * met[k, F.AWAY + a] - met[g, F.DISTANCE] * met[g, F.AWAY + a]
        apart += off * off
    return apart <= (SAME_POINT * r) ** 2


@inner(fastmath=FAST)
def _move(k: int, g: int, touching: Any, eta: Any, rows: Any) -> None:
    """Give the memory of candidate k to candidate g."""
    copy_row(g, eta, rows, k, eta, rows)
    touching[g], touching[k] = touching[k], 0


@inner(fastmath=FAST)
def resolve_walls(
    b: int, reach_on: float, c: Any, grains: GrainArrays, faces: FaceArrays, candidates: CandidateArrays,
    met: Any,
) -> None:  # fmt: skip
    """Find how the grains of block b meet the faces near them, and keep one contact in one place.

    `met` has a row for each face of the block, columns of faces.py.
    """
    first, count = candidates.first[b], candidates.face_count[b]
    # arrays are passed one by one: references to a tuple of them would be counted for every face
    number, grain = candidates.face[first:], candidates.face_grain[first:]
    face = candidates.face_number[first:]
    touching, eta, memory = candidates.touching, candidates.eta, candidates.rows
    x_of, surface, poses, rows, centre = grains.x, faces.surface, faces.poses, faces.rows, faces.centre
    begin = 0
    for s in range(min(AHEAD, count)):
        prefetch(rows, F.N_FACE * face[s])
        prefetch(rows, F.N_FACE * face[s] + 8)
        prefetch(x_of, 4 * grain[s])
    while begin < count:
        i, stop, near = grain[begin], begin, 0
        reach = x_of[i, 3] + reach_on
        while stop < count and grain[stop] == i:
            if stop + AHEAD < count:
                prefetch(rows, F.N_FACE * face[stop + AHEAD])
                prefetch(rows, F.N_FACE * face[stop + AHEAD] + 8)
                prefetch(x_of, 4 * grain[stop + AHEAD])
            touched = touching[number[stop]] != 0
            near += _meet(stop, i, face[stop], reach, touched, c, x_of, poses, rows, centre, met)
            stop += 1
        if near > 1:
            _one_in_a_place(
                begin, stop, x_of[i, 3], reach_on, c, number, face, met, touching, eta, memory, surface,
                poses, rows, centre,
            )  # fmt: skip
        begin = stop


@inner(fastmath=FAST, forceinline=False)
def _one_in_a_place(
    begin: int, stop: int, r: float, reach_on: float, c: Any, number: Any, face: Any, met: Any, touching: Any,
    eta: Any, memory: Any, surface: Any, poses: Any, rows: Any, centre: Any,
) -> None:  # fmt: skip
    """Keep one contact in one place among the faces of one grain, rows begin..stop-1."""
    for s in range(begin, stop):
        if met[s, F.DISTANCE] >= r + reach_on:
            continue
        nearest = math.inf
        for q in range(begin, stop):
            away = met[q, F.DISTANCE]
            farther = away > met[s, F.DISTANCE] or (away == met[s, F.DISTANCE] and q > s)
            if q == s or farther or away >= nearest:
                continue
            f, h = face[q], face[s]
            same = surface[f] == surface[h] and _alike(s, q, met)
            if same or _lies_on(s, q, f, ON_FACE * r, c, poses, rows, centre, met):
                met[s, F.BY], nearest = q, away
    # Met in one point, as on an edge that two walls share, faces are as far away but for rounding: the first
    # of the scene has the contact, not the one that the last bit makes the nearer.
    for s in range(begin, stop):
        if met[s, F.BY] >= 0.0:
            to = s
            while met[to, F.BY] >= 0.0:
                to = int(met[to, F.BY])
            if face[s] < face[to] and _same_point(s, to, r, met):
                met[s, F.BY], met[to, F.BY] = -1.0, s
    for s in range(begin, stop):  # memory goes to the contact that takes the place
        k = number[s]
        if not touching[k]:
            continue
        to = s
        if met[s, F.BY] >= 0.0:
            while met[to, F.BY] >= 0.0:
                to = int(met[to, F.BY])
        elif met[s, F.DISTANCE] >= r:  # it left: to a face of its surface that has come in its place
            for q in range(begin, stop):
                f, h = face[q], face[s]
                new = met[q, F.BY] < 0.0 and met[q, F.DISTANCE] < r and not touching[number[q]]
                if new and surface[f] == surface[h] and _alike(s, q, met):
                    to = q
        if to != s and not touching[number[to]]:
            _move(k, number[to], touching, eta, memory)
    for s in range(begin, stop):
        if met[s, F.BY] < 0.0:
            continue
        if touching[number[s]]:  # two contacts have become one: this one ends
            for a in range(3):
                met[s, F.GAP + a] = -(1.0 + 1e-12) * 2.0 * r * met[s, F.AWAY + a]
        else:
            met[s, F.GAP], met[s, F.GAP + 1], met[s, F.GAP + 2] = B.FAR, 0.0, 0.0


@inner(fastmath=FAST, forceinline=True)
def add_drift(face_lanes: Any, selected: Any, slot: Any, motion: Any, met: Any, batch: Any) -> None:
    """Take the motion of walls off relative velocities in a batch; mirrored grains spin with their wall."""
    for n in range(face_lanes[B.LANES]):
        l = face_lanes[n]
        s = slot[selected[l]]
        w = int(met[s, F.SLOT])
        for a in range(3):
            batch[B.RELATIVE_VELOCITY + 4 * l + a] -= met[s, F.DRIFT + a]
            batch[B.SPIN_J + 4 * l + a] = motion[w, SPIN + a]


@inner(fastmath=FAST, forceinline=True)
def book_walls(
    given: float, pending: float, face_lanes: Any, selected: Any, hdt: float, c: Any, i_of: Any, x_of: Any,
    slot: Any, p: Any, motion: Any, met: Any, impulse: Any, batch: Any,
) -> tuple[float, float]:  # fmt: skip
    """Add the impulses on walls of the faces in a batch to those of their block, (n_wall, N_IMPULSE).

    Returns `given` and `pending` with the work of walls that move over the half interval before this step,
    and over that after it, which is booked with the next one, as that of drag [J]. The mirrored grain has the
    velocity and the spin of the wall, which works against the force and the torque on it.
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
        w = int(met[s, F.SLOT])
        x = x_of[i, 0] + met[s, F.GAP] - p[w, AXIS]
        y = x_of[i, 1] + met[s, F.GAP + 1] - p[w, AXIS + 1]
        z = x_of[i, 2] + met[s, F.GAP + 2] - p[w, AXIS + 2]
        impulse[w, TOUCHED] += dt
        impulse[w, 0] -= f_x * dt
        impulse[w, 1] -= f_y * dt
        impulse[w, 2] -= f_z * dt
        impulse[w, 3] += (t_x - (y * f_z - z * f_y)) * dt
        impulse[w, 4] += (t_y - (z * f_x - x * f_z)) * dt
        impulse[w, 5] += (t_z - (x * f_y - y * f_x)) * dt
        if p[w, MOVES] == 0.0:
            continue
        turning = t_x * motion[w, SPIN] + t_y * motion[w, SPIN + 1] + t_z * motion[w, SPIN + 2]
        before = f_x * met[s, F.DRIFT] + f_y * met[s, F.DRIFT + 1] + f_z * met[s, F.DRIFT + 2] - turning
        n_x, n_y, n_z, r = met[s, F.AWAY], met[s, F.AWAY + 1], met[s, F.AWAY + 2], x_of[i, 3]
        on = drift_of_image(
            w, AFTER, NOW,
            met[s, F.POINT] - r * (p[w, 0] * n_x + p[w, 3] * n_y + p[w, 6] * n_z),
            met[s, F.POINT + 1] - r * (p[w, 1] * n_x + p[w, 4] * n_y + p[w, 7] * n_z),
            met[s, F.POINT + 2] - r * (p[w, 2] * n_x + p[w, 5] * n_y + p[w, 8] * n_z), p,
        )  # fmt: skip
        after = (f_x * on[0] + f_y * on[1] + f_z * on[2]) / dt - turning
        given += hdt * before
        pending += 0.5 * dt * after
        impulse[w, 6] += hdt * before + 0.5 * dt * after
    return given, pending
