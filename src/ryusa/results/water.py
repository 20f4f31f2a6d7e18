"""Profiles of the water column of a run at every frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.model.column import Column
from ryusa.results.lazy import Part, read_frames

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class WaterFrames:
    """Profiles of the water at every frame; arrays of shape (n_frame, n) in cells, (n_frame, n + 1) at faces.

    Attributes
    ----------
    t : times of the frames [s], shape (n_frame,).
    z, faces : heights of the centres and the faces of the cells [m], shapes (n,) and (n + 1,).
    u, w : velocity along the bed and upwards [m/s].
    phi : concentration of grains, fixed ones included [-].
    content : water in a cell per area of bed [m].
    tau : shear stress of the water at the faces [Pa]; the bed's is the first.
    nu_t : eddy viscosity at the faces [m2/s].
    z_surface : height of the surface [m], shape (n_frame,).
    gradient : pressure gradient -dp/dx that drives the water in addition to gravity [Pa/m], shape (n_frame,).
    """

    t: Floats
    z: Floats
    faces: Floats
    u: Floats
    w: Floats
    phi: Floats
    content: Floats
    tau: Floats
    nu_t: Floats
    z_surface: Floats
    gradient: Floats


def read_water(parts: list[Part], t: Floats, column: Column) -> WaterFrames:
    """Read all profiles.

    Raises
    ------
    ResultsError : a part has no profiles, or profiles of another shape.
    """
    found = read_frames(parts, column.GROUP, column.frame_shapes())
    return WaterFrames(t=t, z=column.z, faces=column.faces, **found)
