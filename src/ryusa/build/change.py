"""Change of a scene by an entry of the timeline."""

import math
from dataclasses import replace

import numpy as np

from ryusa.build.assemble import gravity
from ryusa.casefile.case import Case
from ryusa.casefile.record import ChangeSection
from ryusa.errors import CaseError
from ryusa.model import Scene


def change(case: Case, scene: Scene, entry: ChangeSection) -> Scene:
    """Scene after one entry of the timeline: a group removed, gravity tilted, friction or rotation changed.

    A new slope also changes the driving force of a column of water.
    """
    if entry.remove is not None:
        return _without(scene, entry.remove)
    if entry.slope is not None or entry.slope_angle is not None:
        angle = entry.slope_angle if entry.slope_angle is not None else math.atan(entry.slope or 0.0)
        tilted = gravity(case.motion.gravity, angle)
        tilted.flags.writeable = False
        column = None if scene.column is None else replace(scene.column, g_x=float(tilted[0]))
        return replace(scene, gravity=tilted, column=column)
    if entry.friction is not None or entry.friction_angle is not None:
        mu = entry.friction if entry.friction is not None else math.tan(entry.friction_angle or 0.0)
        return replace(scene, contact=replace(scene.contact, mu=mu))
    return replace(scene, rotation=entry.rotation == "free")


def _without(scene: Scene, name: str) -> Scene:
    n, n_fixed = scene.n_grain, scene.n_fixed
    first, end = scene.groups.get(name, (0, 0))
    if first < n:
        raise CaseError("timeline.remove", name, "is no group of fixed grains and no plane")
    fixed, planes = scene.fixed_active.copy(), scene.plane_active.copy()
    ids = np.arange(first, end)
    fixed[ids[ids < n + n_fixed] - n] = False
    planes[ids[ids >= n + n_fixed] - n - n_fixed] = False
    fixed.flags.writeable = planes.flags.writeable = False
    return replace(scene, fixed_active=fixed, plane_active=planes)
