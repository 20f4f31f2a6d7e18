"""Walls whose prescribed motion takes them through another wall or a plane, named before the first step.

Points on the faces of one wall are followed in the frame of the other, over the whole run: a point that is
half a grain before a face, then crosses it, and is half a grain behind it later, has gone through. Walls that
touch, slide along each other, or cross without such a motion never show.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.spatial import KDTree

from ryusa.build.change import change
from ryusa.casefile.case import Case
from ryusa.errors import CaseError
from ryusa.model import Scene
from ryusa.model.arrays import Bools, Floats
from ryusa.model.wall_shape import triangles_of
from ryusa.model.walls import ASKED, RATE, SPIN, SWING, VELOCITY, Ints, Walls, at_rest, box_of, pose

DEEP = 0.5  # smallest diameters that a point must be before a face, and then behind it
FACE_ON = math.cos(math.radians(45.0))  # of a motion and both normals: between the faces grains are crushed
_TURN = math.radians(2.0)  # between two moments: a chord then leaves its arc by 2e-4 of the radius
_LEAST, _MOST = 32, 1024  # moments in a stage of the timeline
_ACROSS = 16  # points along the size of a wall
_POINTS = 500  # on each side of a wall
_BESIDE = 0.2  # of the depth: so far both sides of a point go through, so that a touching edge does not count
_SIDES = 96  # of round faces
_FEW = 400  # faces up to which each is held against all pieces of a path
_TRIED = 400  # crossings of two walls that are looked at closely


@dataclass(frozen=True)
class _Stage:
    """A time between two changes of the timeline, while walls keep their motion."""

    begin: float  # [s]
    end: float  # [s]
    known: bool  # whether stop.time says that the run lasts so long
    walls: Walls
    planes: Bools  # whether each is there
    keys: tuple[str, ...]  # where the motion of each wall is given


@dataclass(frozen=True)
class _Points:
    """Points before the faces of a wall, then as many behind them, in its frame; (n, 3) each."""

    x: Floats  # [m]
    normal: Floats  # unit normals of the faces


@dataclass(frozen=True)
class _Track:
    """Points of a wall in the frame of another, or in the world, at moments of the run.

    Attributes
    ----------
    t : moments [s], (n_moment,).
    stage : number of the stage of each moment, (n_moment,).
    x : points [m], (n_moment, n_point, 3).
    turn : of the wall of the points into that frame, (n_moment, 3, 3).
    """

    t: Floats
    stage: Ints
    x: Floats
    turn: Floats


@dataclass(frozen=True)
class _Passage:
    """Where a point of a wall goes through a face or a plane."""

    t: float  # [s]
    stage: int
    x: Floats  # in the frame of the face [m]
    speed: float  # against it [m/s]
    face_on: bool
    met: int  # the wall of the face, -1 for a plane


def refuse_passing_walls(case: Case, scene: Scene) -> tuple[str, ...]:
    """Notes on walls that go through another wall or a plane; a `CaseError` where they do so face-on.

    Face-on both faces are across the motion, and grains between them are crushed. A wall that goes along
    itself, as a gate into a slot, may be meant to. What a servo does is not known before the run.
    """
    walls = scene.walls
    if walls is None or not len(scene.d) + len(scene.d_fixed):
        return ()
    stages = tuple(_stages(case, scene))
    pressed = walls.servo[:, ASKED] != 0.0 if len(walls.servo) else np.zeros(walls.n_wall, np.bool_)
    moves = np.any([stage.walls.moving() for stage in stages], axis=0) & ~pressed
    if not moves.any():
        return ()
    shapes, deep = _shapes(walls), DEEP * float(np.concatenate([scene.d, scene.d_fixed]).min())
    points = [_points_on(one, _BESIDE * deep) for one in shapes]
    notes, deep = list[str](), (1.0 - _BESIDE) * deep
    for a, b in combinations(np.flatnonzero(~pressed).tolist(), 2):
        found = [
            _through(_track(stages, i, j, points[i], shapes[j], deep, scene.period), points[i], shapes[j], j,
                     deep, scene.period)
            for i, j in ((a, b), (b, a)) if moves[a] or moves[b]
        ]  # fmt: skip
        one, other = (a, b) if moves[a] else (b, a)
        notes += _said(stages, found, one, other, f"wall '{walls.names[other]}'")
    for a in np.flatnonzero(moves).tolist():
        for p in range(scene.n_plane):
            at, normal = scene.plane_point[p], scene.plane_normal[p]
            found = [_behind(_track_in_world(stages, a, p, points[a]), points[a], at, normal, deep)]
            notes += _said(stages, found, a, a, f"plane {_name_of(scene, p)}")
    return tuple(notes)


def _said(
    stages: tuple[_Stage, ...], found: list[_Passage | None], one: int, other: int, what: str
) -> list[str]:
    """What there is to say about the first passage of wall `one` through `other`; raises what is refused."""
    first = _first([each for each in found if each is not None])
    if first is None:
        return []
    stage = stages[first.stage]
    walls, x = stage.walls, first.x
    if first.met >= 0:
        turn, shift = pose(walls.motion[first.met], first.t)
        x = turn @ x + shift
    key = stage.keys[one if walls.moving()[one] else other]
    at = ", ".join(f"{each:.4g}" for each in x.round(9) + 0.0)
    where = f"through the {what} at {first.t:.4g} s near ({at}) m, at {first.speed:.3g} m/s"
    if first.face_on and stage.known:
        raise CaseError(
            key, walls.names[one],
            f"goes face-on {where}, and would crush what is between them: stop it before by move in "
            "[[timeline]], remove one of the two before, or place them apart",
        )  # fmt: skip
    how = "face-on " if first.face_on else ""
    why = "if the run lasts so long" if first.face_on else "edge first: grains in its way are hit"
    return [f"wall '{walls.names[one]}' goes {how}{where}, {why} ({key})"]


def _name_of(scene: Scene, p: int) -> str:
    k = scene.n_grain + scene.n_fixed + p
    return next((f"'{name}'" for name, (begin, end) in scene.groups.items() if begin <= k < end), f"{p}")


def _stages(case: Case, scene: Scene) -> Iterator[_Stage]:
    assert scene.walls is not None
    keys, begin = [f"walls.{w}" for w in range(scene.n_wall)], 0.0
    for k, entry in enumerate((*case.timeline, None)):
        walls, known = scene.walls, case.stop.time is not None
        assert walls is not None
        end = case.stop.time if entry is None else entry.at
        end = begin + _lasting(walls, begin) if end is None else end
        if end > begin:
            yield _Stage(begin, end, known, walls, scene.plane_active, tuple(keys))
        if entry is not None:
            scene = change(case, scene, entry)
            if entry.move is not None:
                keys[walls.names.index(entry.move.wall)] = f"timeline.{k}.move"
        begin = end


def _lasting(walls: Walls, t: float) -> float:
    """Time in which walls show all that they do, where the run has no stop.time [s]."""
    low, high = box_of(walls, t)
    most = 0.0
    for row in walls.motion:
        speed, rate = (float(np.linalg.norm(row[k : k + 3])) for k in (VELOCITY, SPIN))
        most = max(most, float(np.linalg.norm(high - low)) / speed if speed else 0.0)
        most = max(most, 2.0 * math.pi / rate if rate else 0.0)
        most = max(most, 2.0 * math.pi / float(row[RATE]) if row[RATE] else 0.0)
    return most


def _shapes(walls: Walls) -> list[Floats]:
    """Triangles of each wall in its frame [m], (n, 3, 3) each."""
    corners, owner = triangles_of(walls, _SIDES)
    return [corners[owner == w] for w in range(walls.n_wall)]


def _points_on(corners: Floats, beside: float) -> _Points:
    """Points on triangles, (n, 3, 3), a sixteenth of the size of the wall apart, on both sides of them."""
    size = float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0)))
    a, b, c = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(b, c)
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    longest = np.linalg.norm(np.stack([b, c, c - b]), axis=2).max(axis=0)
    parts = np.clip(np.ceil(longest * _ACROSS / size), 1, _ACROSS).astype(np.int64)
    x, normals = list[Floats](), list[Floats]()
    for n in np.unique(parts).tolist():
        i, j = np.divmod(np.arange(n * n), n)
        keep = i + j < n
        share = np.column_stack([i[keep], j[keep]]) + 1.0 / 3.0
        upper = i + j < n - 1
        share = np.vstack([share, np.column_stack([i[upper], j[upper]]) + 2.0 / 3.0]) / n
        mine = parts == n
        some = a[mine, None] + share[None, :, :1] * b[mine, None] + share[None, :, 1:] * c[mine, None]
        x.append(some.reshape(-1, 3))
        normals.append(np.repeat(normal[mine], len(share), axis=0))
    every = -(-sum(len(one) for one in x) // _POINTS) | 1  # odd: not the same place in each triangle
    some, normal = np.vstack(x)[::every], np.vstack(normals)[::every]
    return _Points(np.vstack([some + beside * normal, some - beside * normal]), np.vstack([normal, normal]))


def _moments(stage: _Stage, one: Floats, other: Floats) -> tuple[Floats, bool]:
    """Moments of a stage at which walls with two motions are looked at [s]; whether they reach its end."""
    begin, span = stage.begin, stage.end - stage.begin
    if np.array_equal(one, other):
        return np.array([begin, stage.end]), True
    rows = np.stack([one, other])
    spins = np.linalg.norm(rows[:, SPIN : SPIN + 3], axis=1)
    rates = np.where(rows[:, SWING : SWING + 3].any(axis=1), rows[:, RATE], 0.0)
    each = min(_TURN / max(float(spins.sum() + 0.2 * rates.sum()), 1e-300), span / _LEAST)
    if not rows[:, VELOCITY : VELOCITY + 3].any() and np.count_nonzero([*spins, *rates]) == 1:
        turn = 2.0 * math.pi / float(spins.sum() + rates.sum())
        if span > 2.0 * turn:  # it comes again and again: the first time, and the part of one at the end
            n = math.ceil(turn / each) + 1
            left = np.linspace(stage.end - span % turn, stage.end, n)
            return np.concatenate([np.linspace(begin, begin + turn, n), left]), True
    number = math.ceil(span / each)
    return np.linspace(begin, stage.end, number + 1)[: _MOST + 1], number <= _MOST


def _track(
    stages: tuple[_Stage, ...], a: int, b: int, points: _Points, met: Floats, deep: float,
    period: tuple[float, float],
) -> _Track | None:  # fmt: skip
    """Points of wall a in the frame of wall b while both are there, None where they stay away from it."""
    track = _moved(stages, points, [
        (stage.walls.motion[a], stage.walls.motion[b]) if stage.walls.active[[a, b]].all() else None
        for stage in stages
    ])  # fmt: skip
    if track is None:
        return None
    apart = np.maximum(met.min(axis=(0, 1)) - track.x, track.x - met.max(axis=(0, 1)))
    apart[..., [k for k in range(2) if math.isfinite(period[k])]] = 0.0
    step = np.linalg.norm(np.diff(track.x, axis=0), axis=2).max(initial=0.0)
    near = np.flatnonzero((apart < step + deep).all(axis=2).any(axis=1))
    if not len(near):
        return None
    some = slice(max(int(near[0]) - 1, 0), int(near[-1]) + 2)
    return _Track(track.t[some], track.stage[some], track.x[some], track.turn[some])


def _track_in_world(stages: tuple[_Stage, ...], a: int, p: int, points: _Points) -> _Track | None:
    """Points of wall a in the world while it and plane p are there."""
    still = at_rest(1)[0]
    return _moved(stages, points, [
        (stage.walls.motion[a], still) if stage.walls.active[a] and stage.planes[p] else None
        for stage in stages
    ])  # fmt: skip


def _moved(
    stages: tuple[_Stage, ...], points: _Points, motions: list[tuple[Floats, Floats] | None]
) -> _Track | None:
    """Points that move by the first of two motions, in a frame that moves by the second, till one is None."""
    times, turns, shifts, owners = list[Floats](), list[Floats](), list[Floats](), list[Ints]()
    for number, (stage, both) in enumerate(zip(stages, motions, strict=True)):
        if both is None:
            break
        t, whole = _moments(stage, *both)
        mine, frame = ([pose(row, float(one)) for one in t] for row in both)
        back = np.stack([turn.T for turn, _ in frame])
        times.append(t)
        turns.append(back @ np.stack([turn for turn, _ in mine]))
        way = np.stack([one - other for (_, one), (_, other) in zip(mine, frame, strict=True)])
        shifts.append(np.einsum("kij,kj->ki", back, way))
        owners.append(np.full(len(t), number))
        if not whole:
            break
    if not times or all(both is None or np.array_equal(*both) for both in motions):
        return None
    turn = np.concatenate(turns)
    x = np.einsum("kij,mj->kmi", turn, points.x) + np.concatenate(shifts)[:, None]
    return _Track(np.concatenate(times), np.concatenate(owners), x, turn)


def _behind(
    track: _Track | None, points: _Points, at: Floats, normal: Floats, deep: float
) -> _Passage | None:
    """The first passage of a track from before a plane to behind it, one that is face-on before others."""
    if track is None:
        return None
    height = (track.x - at) @ normal
    found = dict[int, list[_Passage]]()
    for k, m in np.argwhere((height[:-1] > 0.0) & (height[1:] <= 0.0))[:_TRIED].tolist():
        if _goes_through(height[:, m], k, deep):
            share = float(height[k, m] / (height[k, m] - height[k + 1, m]))
            x = track.x[k, m] + share * (track.x[k + 1, m] - track.x[k, m])
            found.setdefault(m, []).append(_passage(track, points, k, m, share, x, normal, -1))
    return _of_both(found, len(points.x) // 2)


def _through(
    track: _Track | None, points: _Points, met: Floats, wall: int, deep: float, period: tuple[float, float]
) -> _Passage | None:
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
    found = dict[int, list[_Passage]]()
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
        order = np.argsort(k[pieces], kind="stable")
        for s in order[hit[order]][:_TRIED].tolist():
            step, point, f = int(k[pieces[s]]), int(m[pieces[s]]), int(faces[s])
            moved = shift[step, point] + image
            height = (track.x[:, point] + moved - a[f]) @ normal[f]
            if _goes_through(height, step, deep):
                x = place[s] - moved
                one = _passage(track, points, step, point, float(share[s]), x, normal[f], wall)
                found.setdefault(point, []).append(one)
    return _of_both(found, len(points.x) // 2)


def _near(p: Floats, q: Floats, met: Floats, middle: Floats) -> tuple[Ints, Ints]:
    """Pairs of a triangle and a piece of a path, from p to q, whose boxes meet."""
    low, high, least, most = met.min(axis=1), met.max(axis=1), np.minimum(p, q), np.maximum(p, q)
    if len(met) <= _FEW:
        near = [
            np.flatnonzero(np.all((least <= high[f]) & (most >= low[f]), axis=1)) for f in range(len(met))
        ]
    else:
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


def _goes_through(height: Floats, step: int, deep: float) -> bool:
    """Whether a point at this height over a face, 0 after a moment, comes from deep to as deep behind."""
    far = np.abs(height) > deep
    before, after = np.flatnonzero(far[: step + 1]), np.flatnonzero(far[step + 1 :])
    if not len(before) or not len(after):
        return False
    return bool((height[before[-1]] > 0.0) != (height[step + 1 + after[0]] > 0.0))


def _passage(
    track: _Track, points: _Points, step: int, point: int, share: float, x: Floats, normal: Floats, met: int
) -> _Passage:
    """What there is to say about a point that crosses a face after a moment."""
    t, around = track.t, [max(step - 1, 0), min(step + 2, len(track.t) - 1)]
    way = track.x[around[1], point] - track.x[around[0], point]
    length, seconds = float(np.linalg.norm(way)), float(t[around[1]] - t[around[0]])
    own = track.turn[step] @ points.normal[point]
    across = [abs(float(way @ one)) >= FACE_ON * length for one in (own, normal)]
    moment = float(t[step] + share * (t[step + 1] - t[step]))
    return _Passage(moment, int(track.stage[step]), x, length / seconds, all(across), met)


def _of_both(found: dict[int, list[_Passage]], n: int) -> _Passage | None:
    """The first passage of a point, which is that of both its sides; the other side of point k is k + n."""
    whole = list[_Passage]()
    for k in (k for k in found if k + n in found):
        for one in found[k]:
            other = found[k + n][int(np.argmin([abs(each.t - one.t) for each in found[k + n]]))]
            whole.append(replace(one, t=0.5 * (one.t + other.t), x=0.5 * (one.x + other.x)))
    return _first(whole)


def _first(found: list[_Passage]) -> _Passage | None:
    return min(found, key=lambda one: (not one.face_on, one.t), default=None)
