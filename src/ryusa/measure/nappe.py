"""Water in the air below aerated sills of a row, as its speeds at the sills let it fly."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.model.arrays import Floats
from ryusa.model.row import Ints
from ryusa.results.water import WaterFrames

POINTS = 60  # of each face of a nappe


@dataclass(frozen=True)
class Nappe:
    """Water that falls freely behind a sill.

    Attributes
    ----------
    segment : the last one of the sill.
    outline : x and z of lower and upper face around the water [m], shape (n, 2).
    """

    segment: int
    outline: Floats


def nappes_of(found: WaterFrames, frames: Ints, surface: Floats, g_x: float, g_z: float) -> tuple[Nappe, ...]:
    """Nappes by the mean speeds of some frames, none behind a sill that is drowned or dry.

    Parameters
    ----------
    surface : mean height of the surface [m], shape (n_segment,).
    g_x, g_z : gravity along and normal to the x axis [m/s2].

    Notes
    -----
    Lower and upper face leave the crest and the surface with the mean speed of what passes, as the row has
    it for each cell.
    """
    row, made = found.row, list[Nappe]()
    for dam in row.dams:
        last = dam.end - 1
        low, high = float(found.floor[last]), float(surface[last])
        if not dam.aerated or not high > low or surface[dam.end] > low:
            continue
        content, u = found.content[frames, last].mean(axis=0), found.u[frames, dam.end].mean(axis=0)
        faces = found.w_faces[frames, last].mean(axis=0)
        flow = content * np.maximum(u, 0.0)
        if not flow.sum() > 0.0:
            continue
        speed = float((flow * u).sum() / flow.sum())
        rises = float((flow * 0.5 * (faces[1:] + faces[:-1])).sum() / flow.sum())
        begin, lines = row.x_low + dam.end * row.dx, list[Floats]()
        for z in (low, high):
            floor = float(found.floor[dam.end :].min())
            last_t = (rises + math.sqrt(rises**2 + 2.0 * g_z * max(z - floor, 0.0))) / g_z
            t = np.linspace(0.0, last_t, POINTS)
            x, path = begin + speed * t + 0.5 * g_x * t**2, z + rises * t - 0.5 * g_z * t**2
            under = np.flatnonzero(path < np.interp(x, row.x[dam.end :], surface[dam.end :]))
            lines.append(np.column_stack([x, path])[: under[0] + 1 if len(under) else POINTS])
        made.append(Nappe(last, np.concatenate([lines[0], lines[1][::-1]])))
    return tuple(made)
