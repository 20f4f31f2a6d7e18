"""Points on the faces of a wall, followed in the frame of another wall or in the world over a run."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.model.arrays import Bools, Floats
from ryusa.model.wall_shape import triangles_of
from ryusa.model.walls import RATE, SPIN, SWING, VELOCITY, Ints, Walls, at_rest, pose

_TURN = math.radians(2.0)  # between two moments: a chord then leaves its arc by 2e-4 of the radius
_LEAST, _MOST = 32, 1024  # moments in a stage of the timeline
_ACROSS = 16  # points along the size of a wall
_POINTS = 500  # on each side of a wall
_SIDES = 96  # of round faces


@dataclass(frozen=True)
class WallStage:
    """A time between two changes of the timeline, while walls keep their motion."""

    begin: float  # [s]
    end: float  # [s]
    known: bool  # whether stop.time says that the run lasts so long
    walls: Walls
    planes: Bools  # whether each is there
    keys: tuple[str, ...]  # where the motion of each wall is given


@dataclass(frozen=True)
class SidePoints:
    """Points before the faces of a wall, then as many behind them, in its frame; (n, 3) each."""

    x: Floats  # [m]
    normal: Floats  # unit normals of the faces


@dataclass(frozen=True)
class WallTrack:
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


def shapes_of(walls: Walls) -> list[Floats]:
    """Triangles of each wall in its frame [m], (n, 3, 3) each."""
    corners, owner = triangles_of(walls, _SIDES)
    return [corners[owner == w] for w in range(walls.n_wall)]


def points_on(corners: Floats, beside: float) -> SidePoints:
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
    return SidePoints(
        np.vstack([some + beside * normal, some - beside * normal]), np.vstack([normal, normal])
    )


def _moments(stage: WallStage, one: Floats, other: Floats) -> tuple[Floats, bool]:
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


def track_of(
    stages: tuple[WallStage, ...], a: int, b: int, points: SidePoints, met: Floats, deep: float,
    period: tuple[float, float],
) -> WallTrack | None:  # fmt: skip
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
    return WallTrack(track.t[some], track.stage[some], track.x[some], track.turn[some])


def track_in_world(stages: tuple[WallStage, ...], a: int, p: int, points: SidePoints) -> WallTrack | None:
    """Points of wall a in the world while it and plane p are there."""
    still = at_rest(1)[0]
    return _moved(stages, points, [
        (stage.walls.motion[a], still) if stage.walls.active[a] and stage.planes[p] else None
        for stage in stages
    ])  # fmt: skip


def _moved(
    stages: tuple[WallStage, ...], points: SidePoints, motions: list[tuple[Floats, Floats] | None]
) -> WallTrack | None:
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
    return WallTrack(np.concatenate(times), np.concatenate(owners), x, turn)
