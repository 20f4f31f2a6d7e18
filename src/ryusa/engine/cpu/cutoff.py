"""A glance at pairs, many at once: how far they are apart, which of them are near, and which will be."""
# ruff: noqa: E741, F403, F405  (l is a lane; the columns of rows.py, all of them plain integers)

from typing import Any

from ryusa.engine.cpu.batch_layout import LANES
from ryusa.engine.cpu.simd.vec4 import apart4
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.rows import *
from ryusa.laws.geometry import wrap


@inner(fastmath=FAST, forceinline=True)
def see_apart(l: int, i: int, j: int, n_solid: int, x: Any, points: Any, normals: Any, glance: Any) -> None:
    """Lay the way from grain i to partner j and both radii together [m] on lane l.

    A plane is met as a grain of the same size that touches it from behind.
    """
    apart4(glance, 4 * l, x, 4 * j, 4 * i)
    if j >= n_solid:
        a, r = j - n_solid, x[i, 3]
        gap = 0.0
        for k in range(3):
            gap += (x[i, k] - points[a, k]) * normals[a, k]
        for k in range(3):
            glance[4 * l + k] = -(gap + r) * normals[a, k]
        glance[4 * l + 3] = 2.0 * r


@inner(fastmath=FAST, forceinline=True)
def tell_near(plane_case: int, reach_on: float, m: int, c: Any, glance: Any, hit: Any) -> None:
    """Set `hit` to 1 where one of the first m lanes is nearer than `reach_on` [m] beyond touch, else to 0."""
    l_x, l_y = c[C_PERIOD_X], c[C_PERIOD_Y]
    for l in range(min(m, LANES)):
        d_x, d_z, reach = wrap(glance[4 * l], l_x), glance[4 * l + 2], glance[4 * l + 3] + reach_on
        square = d_x * d_x + d_z * d_z
        if not plane_case:
            d_y = wrap(glance[4 * l + 1], l_y)
            square += d_y * d_y
        hit[l] = 1.0 if square < reach * reach else 0.0


@inner(fastmath=FAST, forceinline=True)
def see_drift(l: int, i: int, j: int, n_solid: int, v: Any, normals: Any, drift: Any) -> None:
    """Lay the velocity of partner j against grain i [m/s] on lane l; of a plane only along its normal."""
    apart4(drift, 4 * l, v, 8 * j, 8 * i)
    if j >= n_solid:
        a = j - n_solid
        leaving = v[i, 0] * normals[a, 0] + v[i, 1] * normals[a, 1] + v[i, 2] * normals[a, 2]
        for k in range(3):
            drift[4 * l + k] = -leaving * normals[a, k]


@inner(fastmath=FAST, forceinline=True)
def tell_coming(
    plane_case: int, reach_on: float, past: float, ahead: float, m: int, c: Any, glance: Any, drift: Any,
    hit: Any,
) -> None:  # fmt: skip
    """Set `hit` to 1 where one of the first m lanes comes nearer than `reach_on` [m] beyond touch, else to 0.

    Between `past` seconds ago and `ahead` seconds from now, each grain keeping the velocity it has.
    """
    l_x, l_y = c[C_PERIOD_X], c[C_PERIOD_Y]
    for l in range(min(m, LANES)):
        d_x, d_y, d_z = wrap(glance[4 * l], l_x), 0.0, glance[4 * l + 2]
        u_x, u_y, u_z = drift[4 * l], 0.0, drift[4 * l + 2]
        reach = glance[4 * l + 3] + drift[4 * l + 3] + reach_on  # the second is zero: a group is read whole
        if not plane_case:
            d_y, u_y = wrap(glance[4 * l + 1], l_y), drift[4 * l + 1]
        along, speed_2 = d_x * u_x + d_y * u_y + d_z * u_z, u_x * u_x + u_y * u_y + u_z * u_z
        nearest = -along / speed_2 if speed_2 > 0.0 else 0.0  # when they are
        nearest = min(max(nearest, -past), ahead)
        d_x, d_y, d_z = d_x + nearest * u_x, d_y + nearest * u_y, d_z + nearest * u_z
        hit[l] = 1.0 if d_x * d_x + d_y * d_y + d_z * d_z < reach * reach else 0.0
