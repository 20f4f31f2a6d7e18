"""Walls whose prescribed motion takes them through another wall or a plane, named before the first step.

Points on the faces of one wall are followed in the frame of the other, over the whole run: a point that is
half a grain before a face, then crosses it, and is half a grain behind it later, has gone through. Walls that
touch, slide along each other, or cross without such a motion never show.
"""

import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np

from ryusa.build.change import replay
from ryusa.build.wall_crossings import WallPassage, first_of, through_plane, through_wall
from ryusa.build.wall_tracks import WallStage, points_on, shapes_of, track_in_world, track_of
from ryusa.casefile.case import Case
from ryusa.errors import CaseError
from ryusa.model import Scene
from ryusa.model.walls import ASKED, RATE, SPIN, VELOCITY, Walls, box_of, pose

DEEP = 0.5  # smallest diameters that a point must be before a face, and then behind it
_BESIDE = 0.2  # of the depth: so far both sides of a point go through, so that a touching edge does not count


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
    shapes, deep = shapes_of(walls), DEEP * scene.d_min
    points = [points_on(one, _BESIDE * deep) for one in shapes]
    notes, deep = list[str](), (1.0 - _BESIDE) * deep
    for a, b in combinations(np.flatnonzero(~pressed).tolist(), 2):
        found = [
            through_wall(
                track_of(stages, i, j, points[i], shapes[j], deep, scene.period),
                points[i], shapes[j], j, deep, scene.period,
            )
            for i, j in ((a, b), (b, a)) if moves[a] or moves[b]
        ]  # fmt: skip
        one, other = (a, b) if moves[a] else (b, a)
        notes += _said(stages, found, one, other, f"wall '{walls.names[other]}'")
    for a in np.flatnonzero(moves).tolist():
        for p in range(scene.n_plane):
            at, normal = scene.plane_point[p], scene.plane_normal[p]
            found = [through_plane(track_in_world(stages, a, p, points[a]), points[a], at, normal, deep)]
            notes += _said(stages, found, a, a, f"plane {_name_of(scene, p)}")
    return tuple(notes)


def _said(
    stages: tuple[WallStage, ...], found: list[WallPassage | None], one: int, other: int, what: str
) -> list[str]:
    """What there is to say about the first passage of wall `one` through `other`; raises what is refused."""
    first = first_of([each for each in found if each is not None])
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


def _stages(case: Case, scene: Scene) -> Iterator[WallStage]:
    assert scene.walls is not None
    keys, begin, known = [f"walls.{w}" for w in range(scene.n_wall)], 0.0, case.stop.time is not None
    walls, planes = scene.walls, scene.plane_active
    for key, entry, after in replay(case, scene):
        if entry.at > begin:
            yield WallStage(begin, entry.at, known, walls, planes, tuple(keys))
            begin = entry.at
        assert after.walls is not None
        walls, planes = after.walls, after.plane_active
        if entry.move is not None:
            keys[walls.names.index(entry.move.wall)] = f"{key}.move"
    end = begin + _lasting(walls, begin) if case.stop.time is None else case.stop.time
    if end > begin:
        yield WallStage(begin, end, known, walls, planes, tuple(keys))


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
