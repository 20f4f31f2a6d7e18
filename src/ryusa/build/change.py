"""Change of a scene by an entry of the timeline."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ryusa.build.assemble import gravity
from ryusa.casefile.case import Case
from ryusa.casefile.record.schema import ChangeSection
from ryusa.casefile.row.ends import per_width
from ryusa.casefile.walls.schema import MoveSection
from ryusa.errors import CaseError
from ryusa.model import Scene
from ryusa.model.walls import AXIS_POINT, PHASE, RATE, SPIN, SURFACE, SWING, TURN, VELOCITY, carried_on


def change(case: Case, scene: Scene, entry: ChangeSection) -> Scene:
    """Scene after one entry of the timeline: a group removed, gravity tilted, a wall moved, and so on.

    A new slope also changes the driving force of a column of water.
    """
    if entry.remove is not None:
        return _without(scene, entry.remove)
    if entry.move is not None:
        return _moved(scene, entry.move, entry.at)
    if entry.slope is not None or entry.slope_angle is not None:
        angle = entry.slope_angle if entry.slope_angle is not None else math.atan(entry.slope or 0.0)
        tilted = gravity(case.motion.gravity, angle)
        tilted.flags.writeable = False
        flow = scene.flow and scene.flow.tilted(float(tilted[0]), -float(tilted[2]))
        return replace(scene, gravity=tilted, flow=flow)
    if entry.discharge is not None:
        row = scene.row
        assert row is not None
        assert row.upstream is not None
        end = replace(row.upstream, discharge=per_width(case, entry.discharge))
        return replace(scene, flow=replace(row, upstream=end))
    if entry.level is not None:
        row = scene.row
        assert row is not None
        assert row.downstream is not None
        return replace(scene, flow=replace(row, downstream=replace(row.downstream, level=entry.level)))
    if entry.friction is not None or entry.friction_angle is not None:
        mu = entry.friction if entry.friction is not None else math.tan(entry.friction_angle or 0.0)
        return replace(scene, contact=replace(scene.contact, mu=mu))
    return replace(scene, rotation=entry.rotation == "free")


def replay(case: Case, scene: Scene) -> Iterator[tuple[str, ChangeSection, Scene]]:
    """Go through the timeline: key of each entry, the entry, and the scene after it."""
    for k, entry in enumerate(case.timeline):
        scene = change(case, scene, entry)
        yield f"timeline.{k}", entry, scene


def _moved(scene: Scene, move: MoveSection, at: float) -> Scene:
    """Scene whose wall moves as `move` says from the step nearest to a time [s] on."""
    t = round(at / scene.dt) * scene.dt
    walls = scene.walls
    assert walls is not None
    motion, w = walls.motion.copy(), walls.names.index(move.wall)
    row = carried_on(motion[w], t)
    row[VELOCITY:] = 0.0
    row[VELOCITY : VELOCITY + 3] = move.velocity or 0.0
    row[SPIN : SPIN + 3] = move.angular_velocity or 0.0
    row[SWING : SWING + 3] = move.amplitude or 0.0
    row[RATE], row[PHASE] = 2.0 * math.pi * (move.frequency or 0.0), move.phase
    if move.surface_velocity is not None:  # as it is now; it turns with the wall from here on
        row[SURFACE : SURFACE + 3] = np.array(move.surface_velocity) @ row[TURN : TURN + 9].reshape(3, 3)
    if move.axis_point is not None:
        row[AXIS_POINT : AXIS_POINT + 3] = move.axis_point
    motion[w] = row
    motion.flags.writeable = False
    return replace(scene, walls=replace(walls, motion=motion))


def _without(scene: Scene, name: str) -> Scene:
    n, n_fixed = scene.n_grain, scene.n_fixed
    first, end = scene.groups.get(name, (0, 0))
    if first < n:
        raise CaseError("timeline.remove", name, "is no group of fixed grains, no plane and no wall")
    if scene.walls is not None and name in scene.walls.names:
        active = scene.walls.active & (np.array(scene.walls.names) != name)
        active.flags.writeable = False
        return replace(scene, walls=replace(scene.walls, active=active))
    fixed, planes = scene.fixed_active.copy(), scene.plane_active.copy()
    ids = np.arange(first, end)
    fixed[ids[ids < n + n_fixed] - n] = False
    planes[ids[ids >= n + n_fixed] - n - n_fixed] = False
    fixed.flags.writeable = planes.flags.writeable = False
    return replace(scene, fixed_active=fixed, plane_active=planes)
