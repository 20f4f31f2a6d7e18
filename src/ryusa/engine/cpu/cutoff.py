"""Distance of many pairs at once: which are within a cutoff, and which approach it."""
# ruff: noqa: E741  (l is a lane)

from typing import Any

from ryusa.compiled.lanes import known_lanes
from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.faces import N_MET
from ryusa.engine.cpu.simd.vec4 import copy4, difference4
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.laws.geometry import wrap


@inner(fastmath=FAST, forceinline=True)
def set_separation(
    l: int, i: int, j: int, n_solid: int, x: Any, points: Any, normals: Any, separation: Any
) -> None:
    """Write the separation from grain i to partner j and the sum of the radii [m] to lane l.

    A plane is treated as a grain of the same size that touches it from behind.
    """
    difference4(separation, 4 * l, x, 4 * j, 4 * i)
    if j >= n_solid:
        a, r = j - n_solid, x[i, 3]
        gap = 0.0
        for k in range(3):
            gap += (x[i, k] - points[a, k]) * normals[a, k]
        for k in range(3):
            separation[4 * l + k] = -(gap + r) * normals[a, k]
        separation[4 * l + 3] = 2.0 * r


@inner(fastmath=FAST, forceinline=True)
def set_separation_of_any(
    l: int, k: int, i: int, j: int, n_solid: int, x: Any, met: Any, slot: Any, separation: Any
) -> None:  # fmt: skip
    """As `set_separation` in scenes with faces, where those and the planes have been found already."""
    if j < n_solid:  # the usual one first
        difference4(separation, 4 * l, x, 4 * j, 4 * i)
    else:
        copy4(separation, 4 * l, met, N_MET * slot[k])


@inner(fastmath=FAST, forceinline=True)
def mark_within_cutoff(
    plane_case: int, reach_on: float, m: int, c: Any, separation: Any, inside: Any
) -> None:
    """Set `inside` to 1 where one of the first m lanes is nearer than `reach_on` [m] beyond touch, else 0."""
    l_x, l_y = c[P.PERIOD_X], c[P.PERIOD_Y]
    for l in range(known_lanes(m, B.LANES)):
        d_x, d_z, reach = (
            wrap(separation[4 * l], l_x),
            separation[4 * l + 2],
            separation[4 * l + 3] + reach_on,
        )
        square = d_x * d_x + d_z * d_z
        if not plane_case:
            d_y = wrap(separation[4 * l + 1], l_y)
            square += d_y * d_y
        inside[l] = 1.0 if square < reach * reach else 0.0


@inner(fastmath=FAST, forceinline=True)
def set_relative_velocity(l: int, i: int, j: int, n_solid: int, v: Any, normals: Any, velocity: Any) -> None:
    """Write the velocity of partner j against grain i [m/s] to lane l; of a plane only along its normal."""
    difference4(velocity, 4 * l, v, 8 * j, 8 * i)
    if j >= n_solid:
        a = j - n_solid
        leaving = v[i, 0] * normals[a, 0] + v[i, 1] * normals[a, 1] + v[i, 2] * normals[a, 2]
        for k in range(3):
            velocity[4 * l + k] = -leaving * normals[a, k]


@inner(fastmath=FAST, forceinline=True)
def mark_approaching(
    plane_case: int, reach_on: float, past: float, ahead: float, m: int, c: Any, separation: Any,
    velocity: Any, inside: Any,
) -> None:  # fmt: skip
    """Set `inside` to 1 where one of m lanes comes nearer than `reach_on` [m] beyond touch, else to 0.

    Between `past` seconds ago and `ahead` seconds from now, each grain keeping the velocity it has.
    """
    l_x, l_y = c[P.PERIOD_X], c[P.PERIOD_Y]
    for l in range(known_lanes(m, B.LANES)):
        d_x, d_y, d_z = wrap(separation[4 * l], l_x), 0.0, separation[4 * l + 2]
        u_x, u_y, u_z = velocity[4 * l], 0.0, velocity[4 * l + 2]
        reach = separation[4 * l + 3] + velocity[4 * l + 3] + reach_on  # + 0: a group is read whole
        if not plane_case:
            d_y, u_y = wrap(separation[4 * l + 1], l_y), velocity[4 * l + 1]
        along, speed_2 = d_x * u_x + d_y * u_y + d_z * u_z, u_x * u_x + u_y * u_y + u_z * u_z
        nearest = -along / speed_2 if speed_2 > 0.0 else 0.0  # when they are nearest
        nearest = min(max(nearest, -past), ahead)
        d_x, d_y, d_z = d_x + nearest * u_x, d_y + nearest * u_y, d_z + nearest * u_z
        inside[l] = 1.0 if d_x * d_x + d_y * d_y + d_z * d_z < reach * reach else 0.0
