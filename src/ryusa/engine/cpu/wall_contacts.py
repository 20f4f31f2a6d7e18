"""Which of the faces near a grain it touches (design/0019).

Before the pairs of a block are filtered, the nearest points of all planes and faces near its grains are
found, and of those met in one place one is kept: the others are put out of reach, and their memory goes to
that one. Contacts whose normals are near to each other share their forces.
"""

import math
from typing import Any

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu import faces as F
from ryusa.engine.cpu.arrays import CandidateArrays, GrainArrays, WallArrays
from ryusa.engine.cpu.contact_rows import copy_row
from ryusa.engine.cpu.faces import in_frame, nearest_image, nearest_of_face
from ryusa.engine.cpu.simd.prefetch import prefetch
from ryusa.engine.cpu.wall_motion import drift_of_image, run_along
from ryusa.engine.cpu.wall_shares import before, deepest_of_directions, share_forces
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.status import FAULT_CROSSED, FAULT_NONE
from ryusa.engine.shared.wall_pose import BEFORE, MOVES, NOW, PLACED, RUNS
from ryusa.model.walls import ON_FACE, SAME_PLACE

SAME_POINT = 1e-9  # of the radius: nearest points closer than this are one, as on an edge that faces share
ALIKE = math.cos(math.radians(45.0))  # of normals of one smooth surface between which a contact may go over
APART, BEHIND, SAME = 0, 1, 2  # how a contact stands to a face that is nearer
UNDECIDED = -2.0  # in place of a row that takes the place of a contact
CROWD = 24  # planes and faces near a grain
AHEAD = 8  # faces whose numbers are asked for before they are needed


@inner(fastmath=FAST, forceinline=True)
def _side(f: int, x: float, y: float, z: float, rows: Any) -> tuple[float, float]:
    """Signed distance of a point from the plane or shell of face f; and its place along the normal [m]."""
    d_x, d_y, d_z = x - rows[f, F.A], y - rows[f, F.A + 1], z - rows[f, F.A + 2]
    n_x, n_y, n_z = rows[f, F.NORMAL], rows[f, F.NORMAL + 1], rows[f, F.NORMAL + 2]
    along = d_x * n_x + d_y * n_y + d_z * n_z
    if rows[f, F.KIND] != F.CYLINDER:
        return along, along
    d_x, d_y, d_z = d_x - along * n_x, d_y - along * n_y, d_z - along * n_z
    return math.sqrt(d_x * d_x + d_y * d_y + d_z * d_z) - rows[f, F.S_11], along


@inner(fastmath=FAST, forceinline=False)
def _passes(
    f: int, x: float, y: float, z: float, to_x: float, to_y: float, to_z: float, near: float, rows: Any
) -> bool:
    """Whether the straight way from one point to another goes through face f, or within `near` [m] of it."""
    a, h_a = _side(f, x, y, z, rows)
    b, h_b = _side(f, to_x, to_y, to_z, rows)
    if a * b > 0.0 or a == b:
        return False
    share = a / (a - b)
    if rows[f, F.KIND] == F.CYLINDER:
        return -near <= h_a + share * (h_b - h_a) <= rows[f, F.S_12] + near
    at = x + share * (to_x - x), y + share * (to_y - y), z + share * (to_z - z)
    return nearest_of_face(f, at[0], at[1], at[2], rows)[6] <= near


@inner(fastmath=FAST)
def _meet(
    s: int, i: int, f: int, reach: float, touched: bool, most: float, c: Any, x_of: Any, v_of: Any,
    poses: Any, rows: Any, centre: Any, met: Any,
) -> int:  # fmt: skip
    """Find how grain i and face f meet, and write it to row s of `met`; 1 if they do or did, else 0.

    -1 if the centre of the grain has gone through the face in this step; `most` bounds the speed of walls.
    """
    w, r, dt = int(rows[f, F.WALL]), x_of[i, 3], c[P.DT]
    x, y, z = x_of[i, 0], x_of[i, 1], x_of[i, 2]
    placed = poses[w, PLACED] != 0.0
    if placed:
        x, y, z = in_frame(w, NOW, x, y, z, poses)
    own_x, own_y = x, y
    x, y = nearest_image(f, x, y, c[P.PERIOD_X], c[P.PERIOD_Y], centre)
    c_x, c_y, c_z, n_x, n_y, n_z, distance, within = nearest_of_face(f, x, y, z, rows)
    met[s, F.DISTANCE], met[s, F.BY], met[s, F.GAP + 3] = distance, -1.0, 2.0 * r
    if distance < dt * (abs(v_of[i, 0]) + abs(v_of[i, 1]) + abs(v_of[i, 2]) + most):
        b_x, b_y, b_z = in_frame(
            w, BEFORE, x_of[i, 0] - dt * v_of[i, 0], x_of[i, 1] - dt * v_of[i, 1],
            x_of[i, 2] - dt * v_of[i, 2], poses,
        )  # fmt: skip
        if _passes(f, b_x + (x - own_x), b_y + (y - own_y), b_z, x, y, z, ON_FACE * r, rows):
            return -1
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
    met[s, F.SLOT] = w + 0.5 * within
    d_x = d_y = d_z = 0.0
    if poses[w, MOVES] != 0.0:
        d_x, d_y, d_z = drift_of_image(w, NOW, BEFORE, c_x - r * n_x, c_y - r * n_y, c_z - r * n_z, poses)
        d_x, d_y, d_z = d_x / dt, d_y / dt, d_z / dt
    if poses[w, RUNS] != 0.0:
        u_x, u_y, u_z = run_along(w, s, met, poses)
        d_x, d_y, d_z = d_x + u_x, d_y + u_y, d_z + u_z
    met[s, F.DRIFT], met[s, F.DRIFT + 1], met[s, F.DRIFT + 2] = d_x, d_y, d_z
    return 1


@inner(fastmath=FAST)
def _meet_plane(
    s: int, i: int, a: int, reach: float, touched: bool, x_of: Any, points: Any, normals: Any, met: Any
) -> int:
    """As `_meet`, for plane a, with the separation that planes have in scenes without walls."""
    r, gap = x_of[i, 3], 0.0
    for k in range(3):
        gap += (x_of[i, k] - points[a, k]) * normals[a, k]
    for k in range(3):
        met[s, F.GAP + k], met[s, F.AWAY + k] = -(gap + r) * normals[a, k], normals[a, k]
    met[s, F.GAP + 3], met[s, F.DISTANCE], met[s, F.BY], met[s, F.SLOT] = 2.0 * r, gap, -1.0, -1.0
    return 1 if gap < reach or touched else 0


@inner(fastmath=FAST)
def _stands(
    s: int, i: int, q: int, f: int, a: int, c: Any, x_of: Any, poses: Any, rows: Any, centre: Any,
    points: Any, normals: Any, met: Any,
) -> int:  # fmt: skip
    """How the contact in row s of grain i stands to face f, or to plane a where f < 0, which is in row q.

    BEHIND: the centre does not see it, or it is a point of an edge that lies on the other. SAME: its nearest
    point lies within it and on the other.
    """
    r, distance = x_of[i, 3], met[s, F.DISTANCE]
    x, y, z = x_of[i, 0], x_of[i, 1], x_of[i, 2]
    p_x, p_y = x - distance * met[s, F.AWAY], y - distance * met[s, F.AWAY + 1]
    p_z = z - distance * met[s, F.AWAY + 2]
    slot = met[s, F.SLOT]
    within = slot < 0.0 or slot - math.floor(slot) > 0.0
    near = SAME_PLACE * r if within else ON_FACE * r
    if f < 0:
        off = 0.0
        off += (p_x - points[a, 0]) * normals[a, 0]
        off += (p_y - points[a, 1]) * normals[a, 1]
        off += (p_z - points[a, 2]) * normals[a, 2]
        if off > near:
            return APART
        return SAME if within and off >= -SAME_PLACE * r else BEHIND
    slot = met[q, F.SLOT]
    w = int(slot)
    if slot > w and rows[f, F.KIND] != F.CYLINDER:  # its normal is that of its plane: the usual end
        away = F.AWAY
        along = met[s, away] * met[q, away] + met[s, away + 1] * met[q, away + 1]
        along += met[s, away + 2] * met[q, away + 2]
        if met[q, F.DISTANCE] - distance * along > near:
            return APART
    x, y, z = in_frame(w, NOW, x, y, z, poses)
    p_x, p_y, p_z = in_frame(w, NOW, p_x, p_y, p_z, poses)
    own_x, own_y = x, y
    x, y = nearest_image(f, x, y, c[P.PERIOD_X], c[P.PERIOD_Y], centre)
    p_x, p_y = p_x + (x - own_x), p_y + (y - own_y)
    here, there = _side(f, x, y, z, rows)[0], _side(f, p_x, p_y, p_z, rows)[0]
    if here < 0.0:
        there = -there
    if there > near:  # the usual one first
        return APART
    if there < -SAME_PLACE * r and _passes(f, x, y, z, p_x, p_y, p_z, SAME_PLACE * r, rows):
        return BEHIND
    if nearest_of_face(f, p_x, p_y, p_z, rows)[6] > near:
        return APART
    return SAME if within else BEHIND


@inner(fastmath=FAST, forceinline=True)
def _alike(k: int, g: int, met: Any) -> bool:
    """Whether the normals in two rows count as one place of a smooth surface."""
    a = F.AWAY
    along = met[k, a] * met[g, a] + met[k, a + 1] * met[g, a + 1] + met[k, a + 2] * met[g, a + 2]
    return along > ALIKE


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
    b: int, reach_on: float, n_solid: int, c: Any, grains: GrainArrays, walls: WallArrays,
    candidates: CandidateArrays, met: Any, stats: Any,
) -> None:  # fmt: skip
    """Find how the grains of block b meet the planes and faces near them, and keep one contact in one place.

    `met` has a row for each of them, columns of faces.py. A grain that has gone through a face is a fault.
    """
    first, count = candidates.first[b], candidates.face_count[b]
    # arrays are passed one by one: references to a tuple of them would be counted for every face
    number, grain = candidates.face[first:], candidates.face_grain[first:]
    face = candidates.face_number[first:]
    touching, eta, memory = candidates.touching, candidates.eta, candidates.rows
    faces, points, normals = walls.faces, walls.points, walls.normals
    x_of, v_of, n_plane = grains.x, grains.v, len(points)
    surface, poses, rows, centre = faces.surface, faces.poses, faces.rows, faces.centre
    begin = 0
    for s in range(min(AHEAD, count)):
        f = max(face[s] - n_plane, 0)
        prefetch(rows, F.N_FACE * f)
        prefetch(rows, F.N_FACE * f + 8)
        prefetch(x_of, 4 * grain[s])
    while begin < count:
        i, stop, near = grain[begin], begin, 0
        reach = x_of[i, 3] + reach_on
        while stop < count and grain[stop] == i:
            if stop + AHEAD < count:
                f = max(face[stop + AHEAD] - n_plane, 0)
                prefetch(rows, F.N_FACE * f)
                prefetch(rows, F.N_FACE * f + 8)
                prefetch(x_of, 4 * grain[stop + AHEAD])
            touched, f = touching[number[stop]] != 0, face[stop] - n_plane
            if f < 0:
                near += _meet_plane(stop, i, face[stop], reach, touched, x_of, points, normals, met)
            else:
                meets = _meet(
                    stop, i, f, reach, touched, faces.speed, c, x_of, v_of, poses, rows, centre, met
                )
                if meets < 0 and stats[S.FAULT] == FAULT_NONE:
                    stats[S.FAULT], stats[S.FAULT_GRAIN] = FAULT_CROSSED, grains.ids[i]
                    stats[S.FAULT_PARTNER] = n_solid + face[stop]
                near += abs(meets)
            stop += 1
        if near > 1:
            _one_in_a_place(
                begin, stop, i, reach_on, n_plane, c, x_of, number, face, met, touching, eta, memory, surface,
                poses, rows, centre, points, normals,
            )  # fmt: skip
        begin = stop


@inner(fastmath=FAST, forceinline=False)
def _one_in_a_place(
    begin: int, stop: int, i: int, reach_on: float, n_plane: int, c: Any, x_of: Any, number: Any, face: Any,
    met: Any, touching: Any, eta: Any, memory: Any, surface: Any, poses: Any, rows: Any, centre: Any,
    points: Any, normals: Any,
) -> None:  # fmt: skip
    """Keep one contact in one place among the planes and faces of grain i, rows begin..stop-1."""
    # One function: its passes over the same rows follow one another, each on what the one before left
    r = x_of[i, 3]
    if stop - begin > CROWD:  # a grain in the tip of a fine mesh: pairs of so many faces would take too long
        deepest_of_directions(begin, stop, r, n_plane, face, met)
    for s in range(begin, stop):  # what lies behind another is none, whatever becomes of that
        if met[s, F.DISTANCE] >= r + reach_on or met[s, F.BY] >= 0.0:
            continue
        met[s, F.BY], nearest = UNDECIDED, math.inf
        for q in range(begin, stop):
            if q == s or met[q, F.DISTANCE] >= nearest or not before(q, s, n_plane, face, met):
                continue
            stands = _stands(
                s, i, q, face[q] - n_plane, face[q], c, x_of, poses, rows, centre, points, normals, met
            )
            if stands == BEHIND:
                met[s, F.BY], nearest = q, met[q, F.DISTANCE]
    for _ in range(begin, stop):  # of what is left the nearest is kept first, and takes in what is near to it
        s = -1
        for q in range(begin, stop):
            if met[q, F.BY] == UNDECIDED and (s < 0 or before(q, s, n_plane, face, met)):
                s = q
        if s < 0:
            break
        met[s, F.BY], nearest = -1.0, math.inf
        for q in range(begin, stop):
            if q == s or met[q, F.BY] != -1.0 or met[q, F.DISTANCE] >= min(r + reach_on, nearest):
                continue
            stands = _stands(
                s, i, q, face[q] - n_plane, face[q], c, x_of, poses, rows, centre, points, normals, met
            )
            if stands == SAME:
                met[s, F.BY], nearest = q, met[q, F.DISTANCE]
    # Met in one point, as on an edge that two walls share, faces are as far away but for rounding: the first
    # of the scene has the contact, not the one that the last bit makes the nearer; and a face before a plane.
    for s in range(begin, stop):
        if met[s, F.BY] >= 0.0:
            to = s
            while met[to, F.BY] >= 0.0:
                to = int(met[to, F.BY])
            plane, other = face[s] < n_plane, face[to] < n_plane
            first = face[s] < face[to] if plane == other else other
            if first and _same_point(s, to, r, met):
                met[s, F.BY], met[to, F.BY] = -1.0, s
    share_forces(begin, stop, r, n_plane, face, number, touching, met)
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
                f, h = face[q] - n_plane, face[s] - n_plane
                new = met[q, F.BY] < 0.0 and met[q, F.DISTANCE] < r and not touching[number[q]]
                if new and f >= 0 and h >= 0 and surface[f] == surface[h] and _alike(s, q, met):
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
