"""The water of a run as a page or a film shows it: its surface and its velocity over height."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.laws.dispatch import profile_speed
from ryusa.laws.families import Profile
from ryusa.model import Scene
from ryusa.results import Results
from ryusa.view.encode import Blob
from ryusa.view.flow_arrows import add_arrows

POINTS = 60  # of a profile that is given by a formula
THIN = 1.0e-6  # depth up to which a segment of a row is dry [m]
_HALF = 0.5  # of the room between grains that must hold water for its speed to be shown


@dataclass(frozen=True)
class SurfaceLine:
    """Surface of the water along a row of columns.

    Attributes
    ----------
    x : begin of the row, middles of its segments, end [m], shape (n_point,), ascending.
    z : height of the surface at every frame [m], shape (n_frame, n_point); nan where it is dry.
    bottom : height of the bottom [m], shape (n_point,).
    period : of the row along x [m]; inf in a row with ends.
    """

    x: NDArray[np.float64]
    z: NDArray[np.float64]
    bottom: NDArray[np.float64]
    period: float

    def at(self, k: int, share: float) -> NDArray[np.float64]:
        """Heights between frame k and the next [m], linear in time; of the nearer one where one is dry."""
        if share == 0.0:
            return self.z[k]
        before, after = self.z[k], self.z[k + 1]
        return np.where(
            np.isfinite(before + after), before + share * (after - before), before if share < _HALF else after
        )

    def within(
        self, z: NDArray[np.float64], low: float, high: float
    ) -> list[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]]:
        """Wet stretches of a line of heights between two places [m]: x, z and bottom, of two points or more.

        A periodic row is continued.
        """
        x, bottom = self.x, self.bottom
        if math.isfinite(self.period):
            turns = np.arange(math.floor((low - x[0]) / self.period), math.ceil((high - x[0]) / self.period))
            x = np.append(
                (x[:-1] + self.period * turns[:, None]).ravel(), x[0] + self.period * (turns[-1] + 1)
            )
            z, bottom = (np.append(np.tile(one[:-1], len(turns)), one[0]) for one in (z, bottom))
        ends = np.clip([low, high], x[0], x[-1])
        inner = (x > ends[0]) & (x < ends[1])
        places = np.concatenate([ends[:1], x[inner], ends[1:]])
        heights = np.interp(places, x, z)  # nan beside a dry point
        heights[1:-1] = z[inner]
        lowest = np.interp(places, x, bottom)
        parts = np.split(np.arange(len(places)), np.flatnonzero(np.diff(np.isfinite(heights))) + 1)
        wet = [one for one in parts if len(one) > 1 and np.isfinite(heights[one[0]])]
        return [(places[one], heights[one], lowest[one]) for one in wet]


def surface_line(results: Results) -> SurfaceLine | None:
    """The surface along a row of columns at every frame; None without a row."""
    found = results.row
    if found is None:
        return None
    row = found.row
    wet = np.where(found.depth > THIN, found.surface, math.nan)
    first, last = wet[:, :1], wet[:, -1:]
    if row.periodic:
        first = last = 0.5 * (first + last)
    end = row.x_low + row.n_segment * row.dx
    x = np.concatenate([[row.x_low], row.x, [end]])
    period = end - row.x_low if row.periodic else math.inf
    bottom = (
        row.bottom[np.arange(-1, row.n_segment + 1) % row.n_segment]
        if row.periodic
        else row.bottom_with_ends()
    )
    bottom[[0, -1]] = 0.5 * (bottom[[0, -1]] + bottom[[1, -2]])
    return SurfaceLine(x, np.concatenate([first, wet, last], axis=1), bottom, period)


def flow_of(results: Results, frames: NDArray[np.int64], blob: Blob) -> dict[str, Any] | None:
    """What a page needs of the water, and its arrays into the blob; None for a dry run.

    Returns
    -------
    z : heights of the profile [m]. The speeds are the array "u" in m/s, one row per frame for a column of
        water, or the mean along a row of columns, one row in all for a given profile; nan where there is no
        water. The surface is the array "surface" in m, one per frame, or one, or none where the depth is
        unbounded. Of a row of columns it is the mean depth above the lowest cell, and the array "line" holds
        the surface in m at the places x, one row per frame; nan where it is dry. Its `arrows` are those of
        `add_arrows`.
    """
    found, line = results.row or results.water, surface_line(results)
    if found is not None:
        column, u = (results.scene.column or found.row.column), np.array(found.u[frames])
        thick = np.diff(column.faces) if line is None else column.dz
        wet = found.content[frames] / ((1.0 - found.phi[frames]) * thick)
        if line is not None:  # the mean along the row
            u, wet = u.mean(axis=1), wet.mean(axis=1)
        u[wet < _HALF] = math.nan
        blob.add("u", u.astype(np.float32))
        blob.add("surface", surfaces(results)[frames].astype(np.float32))
        if line is None:
            return {"z": column.z.tolist(), "solved": True}
        blob.add("line", line.z[frames].astype(np.float32))
        arrows = add_arrows(blob, found, frames)
        return {"z": column.z.tolist(), "solved": True, "x": line.x.tolist(), "arrows": arrows}
    water = results.scene.water
    if water.profile == Profile.NONE:
        return None
    z = heights(results.scene)
    blob.add("u", profile_at(results.scene, z).astype(np.float32)[None])
    if len(surface := surfaces(results)[:1]):
        blob.add("surface", surface.astype(np.float32))
    return {"z": z.tolist(), "solved": False}


def surfaces(results: Results) -> NDArray[np.float64]:
    """Height of the surface at every frame [m], shape (n_frame,); empty without one.

    Along a row it is the mean depth over the bottom, counted from the lowest cell as in a column.
    """
    water, column = results.scene.water, results.water
    if results.row is not None:
        row = results.row.row
        return np.asarray((results.row.surface - row.bottom).mean(axis=1)) + row.column.z_low
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
