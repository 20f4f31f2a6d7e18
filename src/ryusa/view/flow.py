"""The water of a run as a page or a film shows it: its surface and its velocity over height."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.laws.dispatch import profile_speed
from ryusa.laws.families import Profile
from ryusa.model import Scene
from ryusa.results import Results
from ryusa.results.row import RowFrames
from ryusa.view.encode import Blob

POINTS = 60  # of a profile that is given by a formula
_HALF = 0.5  # of the room between grains that must hold water for its speed to be shown


def flow_of(results: Results, frames: NDArray[np.int64], blob: Blob) -> dict[str, Any] | None:
    """What a page needs of the water, and its arrays into the blob; None for a dry run.

    Returns
    -------
    z : heights of the profile [m]. The speeds are the array "u" in m/s, one row per frame for a column of
        water, or the mean along a row of columns, one row in all for a given profile; nan where there is no
        water. The surface is the array
        "surface" in m, one per frame, or one, or none where the depth is unbounded.
    """
    column = results.water
    if results.row is not None:
        return _mean_of_row(results, results.row, frames, blob)
    if column is not None:
        u = np.array(column.u[frames])
        wet = column.content[frames] / ((1.0 - column.phi[frames]) * np.diff(column.faces))
        u[wet < _HALF] = math.nan
        blob.add("u", u.astype(np.float32))
        blob.add("surface", surfaces(results)[frames].astype(np.float32))
        return {"z": column.z.tolist(), "solved": True}
    water = results.scene.water
    if water.profile == Profile.NONE:
        return None
    z = heights(results.scene)
    blob.add("u", profile_at(results.scene, z).astype(np.float32)[None])
    if len(surface := surfaces(results)[:1]):
        blob.add("surface", surface.astype(np.float32))
    return {"z": z.tolist(), "solved": False}


def _mean_of_row(results: Results, row: RowFrames, frames: NDArray[np.int64], blob: Blob) -> dict[str, Any]:
    """The mean along a row of columns, for `flow_of`."""
    column, among = row.row.column, 1.0 - row.phi[frames]
    wet = (row.content[frames] / (among * column.dz)).mean(axis=1)
    u = row.u[frames].mean(axis=1)
    u[wet < _HALF] = math.nan
    blob.add("u", u.astype(np.float32))
    blob.add("surface", surfaces(results)[frames].astype(np.float32))
    return {"z": column.z.tolist(), "solved": True}


def surfaces(results: Results) -> NDArray[np.float64]:
    """Height of the surface at every frame [m], its mean along a row, shape (n_frame,); empty without one."""
    water, column = results.scene.water, results.water
    if results.row is not None:
        return np.asarray(results.row.surface.mean(axis=1))
    if column is not None:
        return np.asarray(column.z_surface)
    if water.profile == Profile.NONE or not math.isfinite(water.depth):
        return np.zeros(0)
    return np.full(len(results.frames), water.z_zero + water.depth)


def heights(scene: Scene) -> NDArray[np.float64]:
    """Heights at which a given profile is shown [m]: from its zero to the surface, or ten diameters up."""
    water = scene.water
    top = water.depth if math.isfinite(water.depth) else 10.0 * float(scene.d.max())
    return water.z_zero + np.linspace(0.0, top, POINTS + 1)[1:]


def profile_at(scene: Scene, z: NDArray[np.float64]) -> NDArray[np.float64]:
    """Speed of the water along x at heights z [m], for a profile given by a formula [m/s]."""
    water = scene.water
    law = int(water.profile)
    above = [float(one) - water.z_zero for one in z]
    return np.array(
        [profile_speed(law, h, water.u_star, water.k_rough, water.nu, water.u_uniform) for h in above]
    )
