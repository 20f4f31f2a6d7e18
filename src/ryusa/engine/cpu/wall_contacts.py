"""Which of the faces near a grain it touches, and what contacts do to moving walls (design/0019).

Before the pairs of a block are filtered, the nearest points of all faces near its grains are found, and of
the faces met in one place one is kept: the others are put out of reach, and their memory goes to that one.
"""
# ruff: noqa: E741  (l is a lane)

import math
from typing import Any

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu import faces as F
from ryusa.engine.cpu.arrays import AccountArrays, CandidateArrays, GrainArrays
from ryusa.engine.cpu.contact_rows import copy_row
from ryusa.engine.cpu.faces import FaceArrays, in_frame, in_world, nearest_image, nearest_of_face
from ryusa.engine.cpu.simd.prefetch import prefetch
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.wall_pose import AFTER, AXIS, BEFORE, MOVES, NOW
from ryusa.model.tally import Term
from ryusa.model.walls import SPIN, TOUCHED

ON_FACE = 1e-3  # of the radius: within it a point lies on a face
SAME_PLACE = math.cos(math.radians(45.0))  # of normals of one smooth surface that count as one place
AHEAD = 8  # faces whose numbers are asked for before they are needed
WALL = int(Term.WALL)


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
    s: int, i: int, f: int, c: Any, x_of: Any, wall: Any, poses: Any, rows: Any, centre: Any, met: Any
) -> None:
    """Find how grain i and face f meet, and write it to row s of `met`."""
    w, r = wall[f], x_of[i, 3]
    x, y, z = in_frame(w, NOW, x_of[i, 0], x_of[i, 1], x_of[i, 2], poses)
    x, y = nearest_image(f, x, y, c[P.PERIOD_X], c[P.PERIOD_Y], centre)
    c_x, c_y, c_z, n_x, n_y, n_z, distance = nearest_of_face(f, x, y, z, rows)
    a_x = poses[w, 0] * n_x + poses[w, 1] * n_y + poses[w, 2] * n_z
    a_y = poses[w, 3] * n_x + poses[w, 4] * n_y + poses[w, 5] * n_z
    a_z = poses[w, 6] * n_x + poses[w, 7] * n_y + poses[w, 8] * n_z
    met[s, F.POINT], met[s, F.POINT + 1], met[s, F.POINT + 2] = c_x, c_y, c_z
    met[s, F.AWAY], met[s, F.AWAY + 1], met[s, F.AWAY + 2] = a_x, a_y, a_z
    met[s, F.DISTANCE], met[s, F.BY], met[s, F.SLOT] = distance, -1.0, w
    way = -(distance + r)
    met[s, F.GAP], met[s, F.GAP + 1], met[s, F.GAP + 2] = way * a_x, way * a_y, way * a_z
    met[s, F.GAP + 3] = 2.0 * r
    d_x = d_y = d_z = 0.0
    if poses[w, MOVES] != 0.0:
        d_x, d_y, d_z = drift_of_image(w, NOW, BEFORE, c_x - r * n_x, c_y - r * n_y, c_z - r * n_z, poses)
    for a in range(6):
        met[s, F.FORCE + a] = 0.0
    dt = c[P.DT]
    met[s, F.DRIFT], met[s, F.DRIFT + 1], met[s, F.DRIFT + 2] = d_x / dt, d_y / dt, d_z / dt


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
def _move(k: int, g: int, touching: Any, eta: Any, rows: Any) -> None:
    """Give the memory of candidate k to candidate g."""
    copy_row(g, eta, rows, k, eta, rows)
    touching[g], touching[k] = touching[k], 0


@inner(fastmath=FAST)
def resolve_walls(
    b: int, reach_on: float, c: Any, grains: GrainArrays, faces: FaceArrays, candidates: CandidateArrays
) -> None:
    """Find how the grains of block b meet the faces near them, and keep one contact in one place."""
    first, end = candidates.first[b], candidates.first[b] + candidates.face_count[b]
    # arrays are passed one by one: references to a tuple of them would be counted for every face
    number, grain, face, met = candidates.face, candidates.face_grain, candidates.face_number, candidates.met
    touching, eta, memory = candidates.touching, candidates.eta, candidates.rows
    x_of, wall, surface = grains.x, faces.wall, faces.surface
    poses, rows, centre = faces.poses, faces.rows, faces.centre
    begin = first
    for s in range(first, min(first + AHEAD, end)):
        prefetch(rows, F.N_FACE * face[s])
        prefetch(rows, F.N_FACE * face[s] + 8)
        prefetch(x_of, 4 * grain[s])
    while begin < end:
        i, stop, near = grain[begin], begin, 0
        reach = x_of[i, 3] + reach_on
        while stop < end and grain[stop] == i:
            if stop + AHEAD < end:
                prefetch(rows, F.N_FACE * face[stop + AHEAD])
                prefetch(rows, F.N_FACE * face[stop + AHEAD] + 8)
                prefetch(x_of, 4 * grain[stop + AHEAD])
            _meet(stop, i, face[stop], c, x_of, wall, poses, rows, centre, met)
            near += 1 if met[stop, F.DISTANCE] < reach else int(touching[number[stop]] != 0)
            stop += 1
        if near > 1:
            _one_in_a_place(
                begin, stop, x_of[i, 3], reach_on, c, number, face, met, touching, eta, memory, surface,
                poses, rows, centre,
            )  # fmt: skip
        begin = stop


@inner(fastmath=FAST)
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
def keep_forces(face_lanes: Any, selected: Any, slot: Any, met: Any, batch: Any) -> None:
    """Keep the forces and torques of the faces in a batch."""
    for n in range(face_lanes[B.LANES]):
        l = face_lanes[n]
        s = slot[selected[l]]
        for a in range(3):
            met[s, F.FORCE + a] = batch[B.FORCE + 4 * l + a]
            met[s, F.TORQUE + a] = batch[B.TORQUE_J + 4 * l + a]


@inner(fastmath=FAST)
def book_walls(
    b: int, hdt: float, c: Any, grains: GrainArrays, faces: FaceArrays, candidates: CandidateArrays,
    accounts: AccountArrays,
) -> None:  # fmt: skip
    """Add the impulses on walls of block b, and the work of those that move.

    The mirrored grain has the velocity and the spin of the wall, which works against the force and the torque
    on it. The half interval after this step is booked with the next one, as that of drag.
    """
    met, impulse, p, motion = candidates.met, accounts.walls, faces.poses, faces.motion
    grain, x_of = candidates.face_grain, grains.x
    dt, given, pending = c[P.DT], accounts.stats[b, S.PENDING_WALL], 0.0
    for s in range(candidates.first[b], candidates.first[b] + candidates.face_count[b]):
        f_x, f_y, f_z = met[s, F.FORCE], met[s, F.FORCE + 1], met[s, F.FORCE + 2]
        if f_x == 0.0 and f_y == 0.0 and f_z == 0.0:
            continue
        t_x, t_y, t_z = met[s, F.TORQUE], met[s, F.TORQUE + 1], met[s, F.TORQUE + 2]
        i, w = grain[s], int(met[s, F.SLOT])
        x = x_of[i, 0] + met[s, F.GAP] - p[w, AXIS]
        y = x_of[i, 1] + met[s, F.GAP + 1] - p[w, AXIS + 1]
        z = x_of[i, 2] + met[s, F.GAP + 2] - p[w, AXIS + 2]
        impulse[b, w, TOUCHED] += dt
        impulse[b, w, 0] -= f_x * dt
        impulse[b, w, 1] -= f_y * dt
        impulse[b, w, 2] -= f_z * dt
        impulse[b, w, 3] += (t_x - (y * f_z - z * f_y)) * dt
        impulse[b, w, 4] += (t_y - (z * f_x - x * f_z)) * dt
        impulse[b, w, 5] += (t_z - (x * f_y - y * f_x)) * dt
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
        impulse[b, w, 6] += hdt * before + 0.5 * dt * after
    accounts.terms[b, WALL] += given
    accounts.stats[b, S.PENDING_WALL] = pending
