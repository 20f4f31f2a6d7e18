"""Planes and faces of walls that grains touch at a moment, and how contacts share their forces.

Source: design/0019. The rules are those by which the CPU engine steps; here they answer for the frames of a
run.
"""

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ryusa.model.near_pairs import ROUND_OFF
from ryusa.model.scene import Bools, Floats, Scene
from ryusa.model.wall_shape import ways_to_faces
from ryusa.model.walls import (
    CELLS,
    DOUBLINGS,
    EXACT_SHARE,
    LEAST_SHARE,
    LIKE_MOST,
    ON_FACE,
    SAME_PLACE,
    SWEEPS,
    FaceKind,
    face_boxes,
    pose,
)

Ints = NDArray[np.int64]


def shares_of_forces(overlap: Floats, away: Floats, plane: Bools) -> Floats:
    """Share of its force that each contact of one grain with planes and faces has [-], shape (n,).

    Parameters
    ----------
    overlap : of each contact [m], greater than 0, shape (n,).
    away : unit normals from planes and faces to the grain [-], shape (n, 3).
    plane : whether a contact is with a plane; planes share with faces, not with each other, shape (n,).

    >>> flat, steep = [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]
    >>> shares_of_forces(np.ones(2), np.array([flat, steep]), np.zeros(2, bool)).tolist()
    [1.0, 1.0]
    """
    share = np.ones(len(overlap))
    cells = np.floor((away + 1.5) * CELLS).astype(np.int64) @ np.array([4096, 64, 1])
    left = [k for k in range(len(overlap)) if overlap[k] == overlap[cells == cells[k]].max()]
    if len(left) < 2:
        share[[k for k in range(len(overlap)) if k not in left]] = LEAST_SHARE
        return share
    share[:] = LEAST_SHARE
    one, d = away[left], overlap[left]
    like = LIKE_MOST * np.maximum(0.5 + 0.5 * one @ one.T, 0.0) ** 2**DOUBLINGS
    like[np.ix_(plane[left], plane[left])] = 0.0
    np.fill_diagonal(like, 0.0)
    force = d / (1.0 + like.sum(axis=1))
    for _ in range(max(SWEEPS // len(d), 20)):
        change = 0.0
        for k in range(len(d)):
            new = max(float(d[k] - like[k] @ force), 0.0)
            change, force[k] = max(change, abs(new - force[k])), new
        if change <= EXACT_SHARE * d.max():
            break
    share[left] = np.maximum(force / d, LEAST_SHARE)
    return share


def shares_of_contacts(scene: Scene, x: Floats, t: float, i: Ints, j: Ints) -> Floats:
    """Share of its force that each contact of a scene has [-], shape (n_contact,): 1 but in hollows of walls.

    Parameters
    ----------
    x : centres of the free grains [m], shape (n_grain, 3), at time t [s].
    i, j : ids of the grains and of their partners in touch, shape (n_contact,).
    """
    share, first = np.ones(len(i)), scene.n_grain + scene.n_fixed
    if scene.walls is None or not scene.n_face:
        return share
    solid = np.flatnonzero(j >= first)
    grains, times = np.unique(i[solid], return_counts=True)
    several = solid[np.isin(i[solid], grains[times > 1])]
    if not len(several):
        return share
    away, overlap = away_from_surfaces(scene, x, t, i[several], j[several])
    plane = j[several] < first + scene.n_plane
    for g in np.unique(i[several]):
        mine = np.flatnonzero((i[several] == g) & (overlap > 0.0))
        if len(mine) > 1:
            share[several[mine]] = shares_of_forces(overlap[mine], away[mine], plane[mine])
    return share


def away_from_surfaces(scene: Scene, x: Floats, t: float, i: Ints, j: Ints) -> tuple[Floats, Floats]:
    """Unit normals from planes and faces to grains, (n, 3), and overlaps [m], (n,), at time t [s]."""
    first = scene.n_grain + scene.n_fixed
    away, distance = np.zeros((len(i), 3)), np.zeros(len(i))
    face = j >= first + scene.n_plane
    normal, point = scene.plane_normal[j[~face] - first], scene.plane_point[j[~face] - first]
    away[~face], distance[~face] = normal, ((x[i[~face]] - point) * normal).sum(axis=1)
    if face.any():
        assert scene.walls is not None
        numbers = j[face] - first - scene.n_plane
        ways = ways_to_faces(scene.walls, numbers, x[i[face]], t, scene.period)
        distance[face] = np.linalg.norm(ways, axis=1)
        away[face] = -ways / np.maximum(distance[face], 1e-300)[:, None]
    return away, 0.5 * scene.d[i] - distance


def touched_surfaces(x: Floats, scene: Scene, t: float, gap: float = 0.0) -> tuple[Ints, Ints]:
    """Free grains, and ids of the planes and faces that they touch, one contact in one place, (n_pair,) each.

    Parameters
    ----------
    x : centres of the free grains [m], shape (n_grain, 3); nan where one is not there.
    t : time [s], which tells where moving walls are.
    gap : surfaces that are nearer than this count too, over the diameter of the grain [-].
    """
    here, first = np.flatnonzero(np.isfinite(x[:, 0])), scene.n_grain + scene.n_fixed
    firsts, numbers = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for k in np.flatnonzero(scene.plane_active):
        off = (x[here] - scene.plane_point[k]) @ scene.plane_normal[k]
        near = here[off < (0.5 + gap) * scene.d[here]]
        firsts.append(near)
        numbers.append(np.full(len(near), k))
    if scene.walls is None or not scene.n_face or not len(here):
        return np.concatenate(firsts), np.concatenate(numbers) + first
    near, face = _near_faces(x, scene, t, gap, here)
    i = np.concatenate([*firsts, near])
    number = np.concatenate([*numbers, face + scene.n_plane])
    away, overlap = away_from_surfaces(scene, x, t, i, number + first)
    keep = np.flatnonzero(overlap > -gap * scene.d[i])
    order = keep[np.lexsort((number[keep], number[keep] < scene.n_plane, -overlap[keep], i[keep]))]
    i, number, away, overlap = i[order], number[order], away[order], overlap[order]
    seen = np.ones(len(i), np.bool_)
    starts = np.flatnonzero(np.diff(i, prepend=-1)).tolist()
    for begin, stop in pairwise([*starts, len(i)]):  # of each grain, the nearest first, a face before a plane
        if stop - begin > 1:
            one = slice(begin, stop)
            seen[one] = _seen(
                scene, x[i[begin]], 0.5 * float(scene.d[i[begin]]), t, number[one], away[one], overlap[one]
            )
    return i[seen], number[seen] + first


def _near_faces(x: Floats, scene: Scene, t: float, gap: float, here: Ints) -> tuple[Ints, Ints]:
    """Grains and faces whose boxes come near to each other, more than touch."""
    from scipy.spatial import KDTree

    walls = scene.walls
    assert walls is not None
    low, high = face_boxes(walls.face, walls.kind)
    middle, reach = 0.5 * (low + high), 0.5 * np.linalg.norm(high - low, axis=1)
    places, poses = np.zeros_like(middle), [pose(row, t) for row in walls.motion]
    for w, (turn, shift) in enumerate(poses):
        places[walls.wall == w] = middle[walls.wall == w] @ turn.T + shift
    box = np.array([p if math.isfinite(p) else 0.0 for p in (*scene.period, math.inf)])
    own = x[here].copy()
    for axis in np.flatnonzero(box):
        own[:, axis] %= box[axis]
        own[own[:, axis] >= box[axis], axis] = 0.0
        places[:, axis] %= box[axis]
        places[places[:, axis] >= box[axis], axis] = 0.0
    tree, most = KDTree(own, boxsize=box if box.any() else None), (0.5 + gap) * float(scene.d.max())
    grains, faces = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)]
    for f in np.flatnonzero(walls.active[walls.wall]):
        widest = 0.5 * box[box > 0.0].min() if box.any() else math.inf
        inside = reach[f] + most < widest
        near = here[tree.query_ball_point(places[f], reach[f] + most) if inside else slice(None)]
        turn, shift = poses[walls.wall[f]]
        at = (x[near] - shift) @ turn - middle[f]  # from the middle of its box, along the axes of its wall
        for axis in np.flatnonzero(box):
            at[:, axis] -= box[axis] * np.round(at[:, axis] / box[axis])
        beyond = np.maximum(np.abs(at) - 0.5 * (high[f] - low[f]), 0.0)  # few grains are near a large box
        near = near[np.linalg.norm(beyond, axis=1) <= (0.5 + gap) * scene.d[near] * (1.0 + ROUND_OFF)]
        grains.append(np.asarray(near, np.int64))
        faces.append(np.full(len(near), f))
    return np.concatenate(grains), np.concatenate(faces)


def _seen(
    scene: Scene, centre: Floats, r: float, t: float, number: Ints, away: Floats, overlap: Floats
) -> Bools:
    """Which contacts of one grain, nearest first, neither lie on nor behind a nearer one."""
    distance, seen = r - overlap, np.ones(len(number), np.bool_)
    points = centre - distance[:, None] * away
    for s in range(1, len(number)):
        near = (ON_FACE if _on_edge(scene, t, int(number[s]), away[s]) else SAME_PLACE) * r
        for q in range(s):
            other = int(number[q])
            hidden = _near_point(scene, t, other, points[s]) <= near
            along = float(away[s] @ away[q])
            if not hidden and other >= scene.n_plane and distance[s] * along - distance[q] > SAME_PLACE * r:
                # Where the way to it meets the plane of the face
                at = centre - away[s] * (distance[q] / along)
                hidden = _near_point(scene, t, other, at) <= SAME_PLACE * r
            if hidden:
                seen[s] = False
                break
    return seen


def _near_point(scene: Scene, t: float, number: int, point: Floats) -> float:
    """Distance of a point from a plane, below 0 behind it, or from a face [m]."""
    if number < scene.n_plane:
        return float((point - scene.plane_point[number]) @ scene.plane_normal[number])
    assert scene.walls is not None
    faces = np.array([number - scene.n_plane])
    return float(np.linalg.norm(ways_to_faces(scene.walls, faces, point[None], t, scene.period)[0]))


def _on_edge(scene: Scene, t: float, number: int, away: Floats) -> bool:
    """Whether the nearest point of a flat face is on an edge: the way to it is not along the normal."""
    if number < scene.n_plane:
        return False
    walls = scene.walls
    assert walls is not None
    f = number - scene.n_plane
    turn = pose(walls.motion[walls.wall[f]], t)[0]
    if walls.kind[f] == FaceKind.CYLINDER:
        return abs(float(away @ (turn @ walls.face[f, 3:6]))) > 1e-9
    across = (
        walls.face[f, 3:6]
        if walls.kind[f] == FaceKind.DISC
        else np.cross(walls.face[f, 3:6], walls.face[f, 6:9])
    )
    normal = turn @ (across / np.linalg.norm(across))
    return 1.0 - abs(float(away @ normal)) > 1e-12
