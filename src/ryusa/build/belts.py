"""What is wrong with walls whose surface runs, beside faces and time step."""

import numpy as np

from ryusa.build.change import replay
from ryusa.build.wall_checks import MOST_STEP
from ryusa.casefile.case import Case
from ryusa.errors import CaseError
from ryusa.model import FaceKind, Scene
from ryusa.model.arrays import Floats
from ryusa.model.walls import SURFACE, Ints

_ALONG = 1e-6  # of the speed: less of it along a face is none


def refuse_idle_belts(case: Case, scene: Scene) -> None:
    """Raise a `CaseError` for a surface that cannot run as it is asked.

    Normal to all faces it moves nothing; across the axis of a cylinder it would run in two senses at once;
    and a grain that it takes along must not go too far in a step.
    """
    if scene.walls is None:
        return
    for w in range(scene.n_wall):
        _refuse(scene, w, f"walls.{w}.surface_velocity")
    for key, entry, after in replay(case, scene):
        if entry.move is not None and entry.move.surface_velocity is not None and after.walls is not None:
            _refuse(after, after.walls.names.index(entry.move.wall), f"{key}.move.surface_velocity")


def _refuse(scene: Scene, w: int, key: str) -> None:
    walls = scene.walls
    assert walls is not None
    run, name = walls.motion[w, SURFACE : SURFACE + 3], walls.names[w]
    speed, value = float(np.linalg.norm(run)), [round(float(one), 6) for one in run]
    mine = np.flatnonzero(walls.wall == w)
    if speed == 0.0 or not len(mine):
        return
    face, kind = walls.face[mine], walls.kind[mine]
    across = np.linalg.norm(np.cross(_directions(face, kind), run), axis=1) > _ALONG * speed
    round_ = kind == FaceKind.CYLINDER
    if across[round_].any():
        raise CaseError(
            key, value,
            f"runs across the axis of the cylinder '{name}', down one side and up the other: it can run "
            "along the axis alone; a drum that turns about it has angular_velocity",
        )  # fmt: skip
    if not (round_.any() or across.any()):
        text = f"is normal to the wall '{name}' and moves nothing: a surface runs along it"
        raise CaseError(key, value, text)
    if not len(scene.d):
        return
    most = MOST_STEP * float(scene.d.min()) / scene.dt
    if not speed <= most:
        raise CaseError(
            key, value,
            f"runs at {speed:.3g} m/s, with which a grain goes too far in a step: at most {most:.3g} m/s, "
            f"{MOST_STEP:g} of the smallest diameter in a step; lower it, or raise time.steps_per_contact",
        )  # fmt: skip


def _directions(face: Floats, kind: Ints) -> Floats:
    """Unit vectors: normals of triangles and discs, axes of cylinders, shape (n, 3)."""
    flat = (kind == FaceKind.TRIANGLE)[:, None]
    found = np.where(flat, np.cross(face[:, 3:6], face[:, 6:9]), face[:, 3:6])
    return np.asarray(found / np.linalg.norm(found, axis=1)[:, None])
