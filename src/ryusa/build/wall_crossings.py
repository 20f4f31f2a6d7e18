"""Where points of a wall go through the faces of another wall, or through a plane."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ryusa.build.wall_tracks import SidePoints, WallTrack
from ryusa.model.arrays import Bools, Floats
from ryusa.model.walls import Ints

FACE_ON = math.cos(math.radians(45.0))  # of a motion and both normals: between the faces grains are crushed
_FEW = 400  # faces up to which each is held against all pieces of a path
_CHUNK = 256  # paths that are compared with their faces at a time


@dataclass(frozen=True)
class WallPassage:
    """Where a point of a wall goes through a face or a plane."""

    t: float  # [s]
    stage: int
    x: Floats  # in the frame of the face [m]
    speed: float  # against it [m/s]
    face_on: bool
    met: int  # the wall of the face, -1 for a plane


@dataclass(frozen=True)
class _Crossings:
    """Crossings of points that go through, one element each; as `WallPassage`."""

    point: Ints
    t: Floats
    stage: Ints
    x: Floats
    speed: Floats
    face_on: Bools


def through_plane(
    track: WallTrack | None, points: SidePoints, at: Floats, normal: Floats, deep: float
) -> WallPassage | None:
    """The first passage of a track from before a plane to behind it, one that is face-on before others."""
    if track is None:
        return None
    height = (track.x - at) @ normal
    crossed = (height[:-1] > 0.0) & (height[1:] <= 0.0) & _goes_through(height, deep)
    step, point = np.nonzero(crossed)
    share = height[step, point] / (height[step, point] - height[step + 1, point])
    x = track.x[step, point] + share[:, None] * (track.x[step + 1, point] - track.x[step, point])
    return _of_both(_crossings(track, points, step, point, share, x, normal), len(points.x) // 2, -1)


def through_wall(
    track: WallTrack | None, points: SidePoints, met: Floats, wall: int, deep: float,
    period: tuple[float, float],
) -> WallPassage | None:  # fmt: skip
    """The first passage of a track through triangles of a wall, one that is face-on before others."""
    if track is None or len(track.t) < 2:
        return None
    a, b, c = met[:, 0], met[:, 1] - met[:, 0], met[:, 2] - met[:, 0]
    normal = np.cross(b, c)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    middle, begin, end = met.mean(axis=1), track.x[:-1], track.x[1:]
    shift = np.zeros_like(begin)
    centre = 0.5 * (met.min(axis=(0, 1)) + met.max(axis=(0, 1)))
    images = [np.zeros(3)]
    for k in range(2):
        if math.isfinite(period[k]):
            shift[..., k] = -period[k] * np.floor((begin[..., k] - centre[k]) / period[k] + 0.5)
            images = [one + period[k] * n * np.eye(3)[k] for one in images for n in (-1, 0, 1)]
    found = list[_Crossings]()
    for image in images:
        p, q = begin + shift + image, end + shift + image
        low, high = met.min(axis=(0, 1)), met.max(axis=(0, 1))
        inside = np.all((np.minimum(p, q) <= high) & (np.maximum(p, q) >= low), axis=2)
        k, m = np.nonzero(inside)
        if not len(k):
            continue
        p, q = p[k, m], q[k, m]
        faces, pieces = _near(p, q, met, middle)
        before = np.sum((p[pieces] - a[faces]) * normal[faces], axis=1)
        after = np.sum((q[pieces] - a[faces]) * normal[faces], axis=1)
        crossed = (before > 0.0) != (after > 0.0)
        faces, pieces, before, after = (one[crossed] for one in (faces, pieces, before, after))
        share = before / (before - after)
        place = p[pieces] + share[:, None] * (q[pieces] - p[pieces])
        hit = _inside(place - a[faces], b[faces], c[faces])
        faces, pieces, share, place = faces[hit], pieces[hit], share[hit], place[hit]
        step, point = k[pieces], m[pieces]
        moved = shift[step, point] + image
        whole = _go_through(track, step, point, moved, a[faces], normal[faces], deep)
        step, point, share, x = step[whole], point[whole], share[whole], (place - moved)[whole]
        found.append(_crossings(track, points, step, point, share, x, normal[faces[whole]]))
    if not found:
        return None
    every = (np.concatenate([getattr(one, name) for one in found]) for name in _Crossings.__annotations__)
    return _of_both(_Crossings(*every), len(points.x) // 2, wall)


def _near(p: Floats, q: Floats, met: Floats, middle: Floats) -> tuple[Ints, Ints]:
    """Pairs of a triangle and a piece of a path, from p to q, whose boxes meet."""
    low, high, least, most = met.min(axis=1), met.max(axis=1), np.minimum(p, q), np.maximum(p, q)
    if len(met) <= _FEW:
        near = [
            np.flatnonzero(np.all((least <= high[f]) & (most >= low[f]), axis=1)) for f in range(len(met))
        ]
    else:
        from scipy.spatial import KDTree

        reach = np.linalg.norm(met - middle[:, None], axis=2).max(axis=1)
        reach += 0.5 * float(np.linalg.norm(q - p, axis=1).max())
        lists = KDTree(0.5 * (p + q)).query_ball_point(middle, reach)
        near = [np.array(each, np.int64) for each in lists]
    pieces = np.concatenate(near)
    faces = np.repeat(np.arange(len(met)), [len(each) for each in near])
    close = np.all((least[pieces] <= high[faces]) & (most[pieces] >= low[faces]), axis=1)
    return faces[close], pieces[close]


def _inside(x: Floats, b: Floats, c: Floats) -> Bools:
    """Whether points in the planes of triangles lie in them; `x`, `b` and `c` are from one corner, (n, 3)."""
    bb, bc, cc = np.sum(b * b, axis=1), np.sum(b * c, axis=1), np.sum(c * c, axis=1)
    xb, xc = np.sum(x * b, axis=1), np.sum(x * c, axis=1)
    area = np.maximum(bb * cc - bc * bc, 1e-300)
    v, w = (cc * xb - bc * xc) / area, (bb * xc - bc * xb) / area
    return np.asarray((v >= -1e-9) & (w >= -1e-9) & (v + w <= 1.0 + 1e-9))


def _go_through(
    track: WallTrack, step: Ints, point: Ints, moved: Floats, corner: Floats, normal: Floats, deep: float
) -> Bools:
    """Whether points go through the faces that they cross, (n,); each path and face is looked at once."""
    paths = np.column_stack([point, moved, corner, normal])
    _, first, of = np.unique(paths, axis=0, return_index=True, return_inverse=True)
    whole, order = np.zeros(len(step), np.bool_), np.argsort(of, kind="stable")
    ends = np.searchsorted(of[order], np.arange(0, len(first) + _CHUNK, _CHUNK))
    for begin, (low, high) in enumerate(pairwise(ends)):
        mine, some = first[begin * _CHUNK : (begin + 1) * _CHUNK], order[low:high]
        height = np.einsum("kmi,mi->km", track.x[:, point[mine]] + (moved - corner)[mine], normal[mine])
        whole[some] = _goes_through(height, deep)[step[some], of[some] - begin * _CHUNK]
    return whole


def _goes_through(height: Floats, deep: float) -> Bools:
    """Whether points that cross a face after a moment come from deep to as deep behind it.

    Parameters
    ----------
    height : over the face, (n_moment, n_point) [m].

    Returns
    -------
    For each moment but the last, (n_moment - 1, n_point).
    """
    side = np.where(np.abs(height) > deep, np.sign(height), 0.0)
    moments = np.arange(len(height))[:, None]
    last = np.maximum.accumulate(np.where(side != 0.0, moments, 0), axis=0)
    late = len(height) - 1
    following = np.minimum.accumulate(np.where(side != 0.0, moments, late)[::-1], axis=0)[::-1]
    before, after = np.take_along_axis(side, last, 0), np.take_along_axis(side, following, 0)
    return np.asarray(before[:-1] * after[1:] < 0.0)


def _crossings(
    track: WallTrack, points: SidePoints, step: Ints, point: Ints, share: Floats, x: Floats, normal: Floats
) -> _Crossings:
    """What there is to say about points that cross a face a share of the way after a moment."""
    t, around = track.t, (np.maximum(step - 1, 0), np.minimum(step + 2, len(track.t) - 1))
    way = track.x[around[1], point] - track.x[around[0], point]
    length, seconds = np.linalg.norm(way, axis=1), t[around[1]] - t[around[0]]
    own = np.einsum("nij,nj->ni", track.turn[step], points.normal[point])
    across = [np.abs(np.sum(way * one, axis=1)) >= FACE_ON * length for one in (own, normal)]
    moment = t[step] + share * (t[step + 1] - t[step])
    return _Crossings(point, moment, track.stage[step], x, length / seconds, across[0] & across[1])


def _of_both(found: _Crossings, n: int, met: int) -> WallPassage | None:
    """The first passage of a point, which is that of both its sides; the other side of point k is k + n."""
    order = np.argsort(found.point, kind="stable")
    ends = np.searchsorted(found.point[order], np.arange(2 * n + 1))
    whole = list[WallPassage]()
    for k in np.intersect1d(found.point, found.point - n):
        mine, other = (order[ends[each] : ends[each + 1]] for each in (k, k + n))
        t, x = found.t[mine], found.x[mine]
        nearest = other[np.abs(found.t[other] - t[:, None]).argmin(axis=1)]
        t, x = 0.5 * (t + found.t[nearest]), 0.5 * (x + found.x[nearest])
        least = np.lexsort((t, ~found.face_on[mine]))[0]
        one = mine[least]
        whole.append(
            WallPassage(
                float(t[least]), int(found.stage[one]), x[least], float(found.speed[one]),
                bool(found.face_on[one]), met,
            )
        )  # fmt: skip
    return first_of(whole)


def first_of(found: list[WallPassage]) -> WallPassage | None:
    """The first passage, one that is face-on before others; None of none."""
    return min(found, key=lambda one: (not one.face_on, one.t), default=None)
