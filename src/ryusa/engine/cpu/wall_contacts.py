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
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.wall_pose import AFTER, AXIS, BEFORE, MOVES, NOW
from ryusa.model.tally import Term
from ryusa.model.walls import SPIN

ON_FACE = 1e-3  # of the radius: within it a point lies on a face
SAME_PLACE = math.cos(math.radians(45.0))  # of normals of one smooth surface that count as one place
WALL = int(Term.WALL)


@inner(fastmath=FAST)
def _meet(k: int, i: int, f: int, c: Any, grains: GrainArrays, faces: FaceArrays, met: Any) -> None:
    """Find how grain i and face f meet, and write it to row k of `met`."""
    w, p, r = faces.wall[f], faces.poses, grains.x[i, 3]
    x, y, z = in_frame(w, NOW, grains.x[i, 0], grains.x[i, 1], grains.x[i, 2], p)
    x, y = nearest_image(f, x, y, c[P.PERIOD_X], c[P.PERIOD_Y], faces.centre)
    c_x, c_y, c_z, n_x, n_y, n_z, distance = nearest_of_face(f, x, y, z, faces.rows)
    t, row = p[w], met[k]
    row[F.POINT], row[F.POINT + 1], row[F.POINT + 2] = c_x, c_y, c_z
    row[F.AWAY] = t[0] * n_x + t[1] * n_y + t[2] * n_z
    row[F.AWAY + 1] = t[3] * n_x + t[4] * n_y + t[5] * n_z
    row[F.AWAY + 2] = t[6] * n_x + t[7] * n_y + t[8] * n_z
    row[F.DISTANCE], row[F.BY], row[F.SLOT] = distance, -1.0, w
    for a in range(3):
        row[F.GAP + a] = -(distance + r) * row[F.AWAY + a]
        row[F.DRIFT + a] = 0.0
    row[F.GAP + 3] = 2.0 * r
    if t[MOVES] != 0.0:
        drift = drift_of_image(w, NOW, BEFORE, c_x - r * n_x, c_y - r * n_y, c_z - r * n_z, p)
        for a in range(3):
            row[F.DRIFT + a] = drift[a] / c[P.DT]


@inner(fastmath=FAST)
def drift_of_image(
    w: int, at: int, before: int, x: float, y: float, z: float, poses: Any
) -> tuple[float, float, float]:
    """Displacement of a point of a wall between two poses [m]."""
    a = in_world(w, at, x, y, z, poses)
    b = in_world(w, before, x, y, z, poses)
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inner(fastmath=FAST)
def _lies_on(k: int, g: int, f: int, tolerance: float, c: Any, faces: FaceArrays, met: Any) -> bool:
    """Whether the nearest point in row k lies on face f, which is in row g."""
    x, y, z = met[k, F.POINT], met[k, F.POINT + 1], met[k, F.POINT + 2]
    w, v = int(met[k, F.SLOT]), int(met[g, F.SLOT])
    if w != v:
        x, y, z = in_world(w, NOW, x, y, z, faces.poses)
        x, y, z = in_frame(v, NOW, x, y, z, faces.poses)
    x, y = nearest_image(f, x, y, c[P.PERIOD_X], c[P.PERIOD_Y], faces.centre)
    return nearest_of_face(f, x, y, z, faces.rows)[6] <= tolerance


@inner(fastmath=FAST)
def _alike(k: int, g: int, met: Any) -> bool:
    """Whether the normals in two rows count as one place of a smooth surface."""
    a = F.AWAY
    along = met[k, a] * met[g, a] + met[k, a + 1] * met[g, a + 1] + met[k, a + 2] * met[g, a + 2]
    return along > SAME_PLACE


@inner()
def _move(k: int, g: int, candidates: CandidateArrays) -> None:
    """Give the memory of candidate k to candidate g."""
    copy_row(g, candidates.eta, candidates.rows, k, candidates.eta, candidates.rows)
    candidates.touching[g], candidates.touching[k] = candidates.touching[k], 0


@inner(fastmath=FAST)
def resolve_walls(
    b: int, reach_on: float, c: Any, grains: GrainArrays, faces: FaceArrays, candidates: CandidateArrays
) -> None:
    """Find how the grains of block b meet the faces near them, and keep one contact in one place."""
    first, end = candidates.first[b], candidates.first[b] + candidates.face_count[b]
    number, i_of, met = candidates.face, candidates.i, candidates.met
    begin = first
    while begin < end:
        i, stop = i_of[number[begin]], begin
        while stop < end and i_of[number[stop]] == i:
            k = number[stop]
            _meet(k, i, candidates.j[k] - faces.first, c, grains, faces, met)
            stop += 1
        if stop - begin > 1:
            _one_in_a_place(begin, stop, grains.x[i, 3], reach_on, c, faces, candidates)
        begin = stop


@inner(fastmath=FAST)
def _one_in_a_place(
    begin: int, stop: int, r: float, reach_on: float, c: Any, faces: FaceArrays, candidates: CandidateArrays
) -> None:
    """Keep one contact in one place among the faces of one grain, `candidates.face` begin..stop-1."""
    number, met, touching = candidates.face, candidates.met, candidates.touching
    for s in range(begin, stop):
        k = number[s]
        if met[k, F.DISTANCE] >= r + reach_on:
            continue
        nearest = math.inf
        for q in range(begin, stop):
            g = number[q]
            away = met[g, F.DISTANCE]
            farther = away > met[k, F.DISTANCE] or (away == met[k, F.DISTANCE] and q > s)
            if q == s or farther or away >= nearest:
                continue
            f, h = candidates.j[g] - faces.first, candidates.j[k] - faces.first
            same = faces.surface[f] == faces.surface[h] and _alike(k, g, met)
            if same or _lies_on(k, g, f, ON_FACE * r, c, faces, met):
                met[k, F.BY], nearest = g, away
    for s in range(begin, stop):  # memory goes to the contact that takes the place
        k = number[s]
        if not touching[k]:
            continue
        g = k
        if met[k, F.BY] >= 0.0:
            while met[g, F.BY] >= 0.0:
                g = int(met[g, F.BY])
        elif met[k, F.DISTANCE] >= r:  # it left: to a face of its surface that has come in its place
            for q in range(begin, stop):
                o = number[q]
                f, h = candidates.j[o] - faces.first, candidates.j[k] - faces.first
                new = met[o, F.BY] < 0.0 and met[o, F.DISTANCE] < r and not touching[o]
                if new and faces.surface[f] == faces.surface[h] and _alike(k, o, met):
                    g = o
        if g != k and not touching[g]:
            _move(k, g, candidates)
    for s in range(begin, stop):
        k = number[s]
        if met[k, F.BY] < 0.0:
            continue
        if touching[k]:  # two contacts have become one: this one ends
            for a in range(3):
                met[k, F.GAP + a] = -(1.0 + 1e-12) * 2.0 * r * met[k, F.AWAY + a]
        else:
            met[k, F.GAP], met[k, F.GAP + 1], met[k, F.GAP + 2] = B.FAR, 0.0, 0.0


@inner(fastmath=FAST)
def add_drift(m: int, selected: Any, j_of: Any, faces: FaceArrays, met: Any, batch: Any) -> None:
    """Take the motion of walls off the relative velocities of m lanes; mirrored grains spin with the wall."""
    for l in range(m):
        k = selected[l]
        if j_of[k] >= faces.first:
            w = int(met[k, F.SLOT])
            for a in range(3):
                batch[B.RELATIVE_VELOCITY + 4 * l + a] -= met[k, F.DRIFT + a]
                batch[B.SPIN_J + 4 * l + a] = faces.motion[w, SPIN + a]


@inner(fastmath=FAST)
def book_walls(
    b: int, m: int, selected: Any, hdt: float, c: Any, grains: GrainArrays, faces: FaceArrays,
    candidates: CandidateArrays, batch: Any, accounts: AccountArrays,
) -> None:  # fmt: skip
    """Add the impulse on walls from the first m lanes, and the work of those that move.

    The mirrored grain has the velocity and the spin of the wall, which works against the force and the torque
    on it. The half interval after this step is booked with the next one, as that of drag.
    """
    met, impulse, p = candidates.met, accounts.walls, faces.poses
    dt = c[P.DT]
    for l in range(m):
        k = selected[l]
        if candidates.j[k] < faces.first:
            continue
        f_x, f_y, f_z = batch[B.FORCE + 4 * l], batch[B.FORCE + 4 * l + 1], batch[B.FORCE + 4 * l + 2]
        at = B.TORQUE_J + 4 * l
        t_x, t_y, t_z = batch[at], batch[at + 1], batch[at + 2]
        if f_x == 0.0 and f_y == 0.0 and f_z == 0.0:
            continue
        i, w, row = candidates.i[k], int(met[k, F.SLOT]), met[k]
        x = grains.x[i, 0] + row[F.GAP] - p[w, AXIS]
        y = grains.x[i, 1] + row[F.GAP + 1] - p[w, AXIS + 1]
        z = grains.x[i, 2] + row[F.GAP + 2] - p[w, AXIS + 2]
        impulse[b, w, 0] -= f_x * dt
        impulse[b, w, 1] -= f_y * dt
        impulse[b, w, 2] -= f_z * dt
        impulse[b, w, 3] += (t_x - (y * f_z - z * f_y)) * dt
        impulse[b, w, 4] += (t_y - (z * f_x - x * f_z)) * dt
        impulse[b, w, 5] += (t_z - (x * f_y - y * f_x)) * dt
        if p[w, MOVES] == 0.0:
            continue
        spin = faces.motion[w]
        turning = t_x * spin[SPIN] + t_y * spin[SPIN + 1] + t_z * spin[SPIN + 2]
        before = f_x * row[F.DRIFT] + f_y * row[F.DRIFT + 1] + f_z * row[F.DRIFT + 2] - turning
        n_x, n_y, n_z = row[F.AWAY], row[F.AWAY + 1], row[F.AWAY + 2]
        t, r = p[w], grains.x[i, 3]
        on = drift_of_image(
            w, AFTER, NOW,
            row[F.POINT] - r * (t[0] * n_x + t[3] * n_y + t[6] * n_z),
            row[F.POINT + 1] - r * (t[1] * n_x + t[4] * n_y + t[7] * n_z),
            row[F.POINT + 2] - r * (t[2] * n_x + t[5] * n_y + t[8] * n_z), p,
        )  # fmt: skip
        after = (f_x * on[0] + f_y * on[1] + f_z * on[2]) / dt - turning
        accounts.terms[b, WALL] += hdt * before
        accounts.stats[b, S.PENDING_WALL] += 0.5 * dt * after
        impulse[b, w, 6] += hdt * before + 0.5 * dt * after


@inner()
def close_wall_interval(b: int, accounts: AccountArrays) -> None:
    """Book the second half of the work of walls in the step before."""
    accounts.terms[b, WALL] += accounts.stats[b, S.PENDING_WALL]
    accounts.stats[b, S.PENDING_WALL] = 0.0
