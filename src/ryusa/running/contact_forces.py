"""Contact forces at a frame, from the contact history of an engine's snapshot."""

import numpy as np
from numpy.typing import NDArray

from ryusa.model import Scene, State
from ryusa.model.wall_shape import ways_to_faces
from ryusa.results import schema


def contact_forces(state: State, scene: Scene) -> NDArray[np.void]:
    """Forces of all contacts that push, pull or shear, dtype schema.FORCE.

    Parameters
    ----------
    state : a snapshot; its contact history holds the forces of the step before, at x - v dt.
    scene : the scene; fixed grains and planes stand where they stood at the start.
    """
    held = state.contacts
    x, i, j = state.x - state.v * scene.dt, held.i, held.j
    every = np.concatenate([x, scene.x_fixed.reshape(-1, 3)])
    plane = (j >= len(every)) & (j < len(every) + scene.n_plane)
    face = j >= len(every) + scene.n_plane
    normal = np.zeros((len(held), 3))
    grain = ~(plane | face)
    gap = every[j[grain]] - x[i[grain]]
    for axis, period in enumerate(scene.period):
        if np.isfinite(period):
            gap[:, axis] -= period * np.round(gap[:, axis] / period)
    if scene.plane_case:
        gap[:, 1] = 0.0
    normal[grain] = gap / np.linalg.norm(gap, axis=1)[:, None]
    if scene.walls is not None and face.any():
        number = j[face] - len(every) - scene.n_plane
        ways = ways_to_faces(scene.walls, number, x[i[face]], state.t - scene.dt, scene.period)
        normal[face] = ways / np.linalg.norm(ways, axis=1)[:, None]
    normal[plane] = -scene.plane_normal[j[plane] - len(every)]
    shear = held.spring_s + held.dash_s
    if scene.plane_case:  # one component, along (n_z, 0, -n_x)
        along = shear[:, 0]
        shear = np.stack([along * normal[:, 2], np.zeros(len(held)), -along * normal[:, 0]], axis=1)
    rows = np.zeros(len(held), dtype=schema.FORCE)
    rows["i"], rows["j"] = i, j
    rows["force"] = shear - held.f_n[:, None] * normal
    return rows[np.abs(rows["force"]).max(axis=1, initial=0.0) > 0.0]
