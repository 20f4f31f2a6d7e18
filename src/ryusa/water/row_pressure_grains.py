"""Grains under the pressure of a row: how they follow it, and what they give upwards.

Grains feel a change of P too, an interval later than the water. So the projection has their mobility beside
that of the water: without it the pressure of light grains overshoots and grows (design/0030).
"""

from typing import NamedTuple

import numpy as np

from ryusa.model.row import OPEN
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.row_layout import RowShape
from ryusa.water.slice_sums import SOLID, SOLID_W


class PressedGrains(NamedTuple):
    """The grains as the pressure meets them in an interval; all 0 without any."""

    yields: Floats  # interval over density and added mass in terms of the water's [s], shape (1,)
    passes: Floats  # whether grains pass each station, 1 or 0, shape (n_station,)
    phi: Floats  # concentration of free grains in the segments [-], shape (n_all, n)
    force: Floats  # of the water on free grains upwards [N/m3], shape (n_all, n)
    drag: Floats  # of fixed grains upwards, over the speed of the water [N s/m4], shape (n_all, n)
    along: Floats  # flux of grains through the stations [m2/s], shape (n_station, n)
    up: Floats  # and through the faces [m/s], shape (n_all, n + 1)
    part: Floats  # free grains in the control volume of a face [m], shape (n_all, n + 1)

    @staticmethod
    def none(stations: int, segments: int, n: int) -> "PressedGrains":
        """Arrays of a row without grains."""
        phi, force, drag = np.zeros((3, segments, n))
        up, part = np.zeros((2, segments, n + 1))
        return PressedGrains(
            np.zeros(1), np.zeros(stations), phi, force, drag, np.zeros((stations, n)), up, part
        )


@kernel
def set_grains(
    p: ColumnParameters, shape: RowShape, area: float, yields: float, sums: Floats, fixed: Floats,
    force: Floats, through: Floats, grains: PressedGrains,
) -> None:  # fmt: skip
    """Note how grains are and move at the end of an interval, before the water is moved on.

    Parameters
    ----------
    area : of the bottom of a segment [m2].
    yields : the interval, over the density of grains and added mass in terms of that of the water [s].
    sums, fixed : of `sum_grains_in_row` and `sum_fixed_in_row`.
    force : upwards on free grains [N/m3], shape (n_all, n).
    through : flux of grains through the stations [m4/s], shape (n_station, n).

    Notes
    -----
    Grains do not pass a wall, an inlet, or the upper end of a row, where a screen holds them (as in `tell`).
    Beyond the lower end they are as in the last segment, of which `through` has about a half.
    """
    volume = area * p.dz
    periodic = len(shape.kind) == len(shape.bottom)
    grains.yields[0] = yields
    last = len(shape.kind) - 1
    for j in range(len(shape.kind)):
        grains.passes[j] = 1.0 if shape.kind[j] == OPEN and (periodic or j > 0) else 0.0
        times = grains.passes[j] * (2.0 if j == last and not periodic else 1.0)
        for k in range(p.n):
            grains.along[j, k] = times * through[j, k] / area
    for i in range(len(shape.bottom)):
        for k in range(p.n):
            grains.phi[i, k] = sums[SOLID, i, k] / volume
            grains.force[i, k] = force[i, k]
            grains.drag[i, k] = fixed[0, i, k] / volume
            if k > 0:
                grains.up[i, k] = 0.5 * (sums[SOLID_W, i, k - 1] + sums[SOLID_W, i, k]) / volume


@kernel
def divide_grains(shape: RowShape, wet: Floats, top: int, i: int, grains: PressedGrains) -> None:
    """Free grains in the control volumes of the faces of a segment, into `part`, as its water is divided."""
    first, part = shape.first[i], grains.part[i]
    part[:] = 0.0
    for f in range(first + 1, top + 1):
        part[f] = 0.5 * (grains.phi[i, f - 1] * wet[f - 1] + grains.phi[i, f] * wet[f])
    if top > first:
        part[top] += 0.5 * grains.phi[i, top] * wet[top]


@kernel
def mobility_along(shape: RowShape, wet: Floats, j: int, k: int, grains: PressedGrains) -> float:
    """Flux of free grains through a station by a difference of P between full cells beside it [s m/m].

    Times the height of a cell over the wet thickness there, as the speed of the water.
    """
    left, right = shape.left[j], shape.right[j]
    solid = 0.5 * (grains.phi[left, k] * wet[left, k] + grains.phi[right, k] * wet[right, k])
    solid *= grains.passes[j]
    return float(grains.yields[0] * solid / (0.5 * (wet[left, k] + wet[right, k])) / shape.dx)
