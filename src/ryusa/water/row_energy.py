"""Compiled energy account of the water of a row: every term by its own formula.

The balance of a cell of a station, times U of the new time, gives the change of its kinetic energy. With the
continuity of the cell what is left over is a sum of squares of differences of U: what momentum loses that is
carried with the speed upstream, and what the implicit step loses. Where the bottom is inclined U stands here
for the speed along it, U sqrt(steep). Potential energy changes with the water of a segment by the integral of
the height of its surface. Derivation: design/0027.
"""

import math
from typing import NamedTuple

import numpy as np

from ryusa.laws.families import Drive
from ryusa.model.row import OPEN, WALL
from ryusa.model.row_energy import N_ROW_TERM, RowTerm
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel, sums
from ryusa.water.momentum_balance import GRADIENT, StepWorkspace
from ryusa.water.row_layout import RowShape, RowWater
from ryusa.water.time_step import distribute_water

KINETIC, POTENTIAL = int(RowTerm.KINETIC), int(RowTerm.POTENTIAL)
GRAVITY, DRIVER = int(RowTerm.GRAVITY), int(RowTerm.DRIVER)
UPSTREAM, DOWNSTREAM = int(RowTerm.UPSTREAM), int(RowTerm.DOWNSTREAM)
GRAINS, DISPLACED = int(RowTerm.GRAINS), int(RowTerm.DISPLACED)
BED, SIDE, SHEAR, POROUS = int(RowTerm.BED), int(RowTerm.SIDE), int(RowTerm.SHEAR), int(RowTerm.POROUS)
FALL, UPWIND, LATE, SURFACE = int(RowTerm.FALL), int(RowTerm.UPWIND), int(RowTerm.LATE), int(RowTerm.SURFACE)
OF_DISCHARGE = int(Drive.DISCHARGE)


class EnergyArrays(NamedTuple):
    """The account of an interval, and work arrays."""

    books: Floats  # the terms [J/m], shape (N_ROW_TERM,)
    through: Floats  # water that passes the middle of each segment [m2/s], shape (n_segment, n)
    speed: Floats  # speed along the bottom that it carries [m/s], shape (n_segment, n)
    moved: Floats  # content times new speed at each station, summed over the cells [m2/s], shape (n_station,)
    push: Floats  # pressure gradient by the slope of the surface there [Pa/m], shape (n_station,)

    @staticmethod
    def of(stations: int, segments: int, n: int) -> "EnergyArrays":
        """Arrays of a row."""
        return EnergyArrays(
            np.zeros(N_ROW_TERM), np.zeros((segments, n)), np.zeros((segments, n)), np.zeros(stations),
            np.zeros(stations),
        )  # fmt: skip


@sums
def kinetic_at(p: ColumnParameters, shape: RowShape, water: RowWater, j: int) -> float:
    """Kinetic energy of the water at an open station, per width [J/m]; 0 at others."""
    if shape.kind[j] != OPEN:
        return 0.0
    a, b, total = shape.left[j], shape.right[j], 0.0
    for k in range(p.n):
        total += (water.content[a, k] + water.content[b, k]) * water.u[j, k] ** 2
    return 0.25 * p.rho_w * shape.dx * shape.inertia[j] * total


@sums
def add_held(p: ColumnParameters, shape: RowShape, water: RowWater, times: float, books: Floats) -> None:
    """Add the kinetic and the potential energy of the row to the account, `times` 1 or -1."""
    kinetic, lift = 0.0, 0.0
    for j in range(len(shape.kind)):  # as `kinetic_at`, without a call for each
        if shape.kind[j] == OPEN:
            a, b, total = shape.left[j], shape.right[j], 0.0
            for k in range(p.n):
                total += (water.content[a, k] + water.content[b, k]) * water.u[j, k] ** 2
            kinetic += shape.inertia[j] * total
    for i in range(shape.inner[0], shape.inner[1]):
        total = 0.0
        for k in range(p.n):
            total += water.content[i, k] * (shape.bottom[i] + k * p.dz + 0.5 * water.wet[i, k])
        lift += total
    books[KINETIC] += times * 0.25 * p.rho_w * shape.dx * kinetic
    books[POTENTIAL] += times * p.rho_w * shape.g_z * shape.dx * lift


@sums
def lift_of(p: ColumnParameters, bottom: float, content: Floats, wet: Floats) -> float:
    """Water of a segment times its height over the x axis, per area [m2]."""
    total = 0.0
    for k in range(p.n):
        total += content[k] * (bottom + k * p.dz + 0.5 * wet[k])
    return total


@kernel
def book_ends(p: ColumnParameters, shape: RowShape, water: RowWater, times: float, books: Floats) -> None:
    """Add the kinetic energy at the end stations, with `times` -1 and 1 before and after `fill_ends`."""
    last = len(shape.kind) - 1
    if len(shape.bottom) == last:  # two segments beyond the ends, one station more than inner segments
        return
    books[UPSTREAM] += times * kinetic_at(p, shape, water, 0)
    books[DOWNSTREAM] += times * kinetic_at(p, shape, water, last)


@kernel
def book_displaced(
    p: ColumnParameters, shape: RowShape, phi: Floats, water: RowWater, level: Floats, books: Floats
) -> None:
    """Add the potential energy that the water of each segment gains by grains that have moved.

    `level` is a work array of shape (>= 3, n), `phi` the new concentration, `water` that before the step.
    """
    for i in range(shape.inner[0], shape.inner[1]):
        same = True
        for k in range(p.n):
            if water.wet[i, k] > 0.0 and water.content[i, k] != (1.0 - phi[i, k]) * water.wet[i, k]:
                same = False
        if same:
            continue
        for k in range(shape.first[i]):
            level[0, k], level[1, k] = 0.0, 0.0
        m, _ = distribute_water(p, shape.first[i], phi[i], water.volume[i], level[0], level[1], level[2])
        if m < -1 or m >= p.n:  # a fault, unless the water that flows along x leaves room
            continue
        lift = lift_of(p, shape.bottom[i], level[0], level[1])
        lift -= lift_of(p, shape.bottom[i], water.content[i], water.wet[i])
        books[DISPLACED] += p.rho_w * shape.g_z * shape.dx * lift


@sums
def book_station(
    books: Floats, west: Floats, east: Floats, speed_west: Floats, speed_east: Floats, old: Floats,
    now: Floats, u: Floats, u_old: Floats, q: Floats, below: Floats, tau: Floats, sill: int, last: int,
    rho: float, steep: float, per_dx: float, per_dt: float,
) -> float:  # fmt: skip
    """Add what a station loses at the bed, between cells and by the scheme; its `moved` returned [m2/s].

    Parameters
    ----------
    west, east, speed_west, speed_east : `through` and `speed` of the segments beside it, shape (n,).
    old, now : content before and after the step [m]; these and the next are counted from the lowest open cell
        on, but for `u_old`, shape (n,).
    u, q, below, tau : new speeds [m/s], vertical fluxes and their weights, and stresses over `steep` [Pa].
    u_old : speeds before the step [m/s], shape (n,).
    sill, last : lowest open cell, and highest one solved, counted from it; -1 without.

    Notes
    -----
    Content that stays in a cell loses (1/2) c (dU)**2 in time, water that comes from a cell with another
    speed (1/2) |Q| (dU)**2. Cells without a balance, below the sill and above `last`, lose what they get.
    """
    # One function, for a call with arrays costs as much as the sums over a station
    turned, add = math.sqrt(steep), sill + last + 1
    late, upwind, moved, dropped, held = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(sill):
        dropped += west[k] * speed_west[k] ** 2 - east[k] * speed_east[k] ** 2
    for at in range(last + 1):
        k = np.uint64(at) + np.uint64(sill)  # cannot be negative: the loop becomes vector instructions
        come, go, s = west[k], east[k], turned * u[at]
        stays = old[at] * per_dt + 0.5 * per_dx * (come - abs(come) - go - abs(go))
        late += stays * (s - turned * u_old[k]) ** 2
        upwind += 0.5 * (come + abs(come)) * (speed_west[k] - s) ** 2
        upwind += 0.5 * (abs(go) - go) * (speed_east[k] - s) ** 2
        moved += now[at] * u[at]
    for at in range(len(west) - add):
        k = np.uint64(at) + np.uint64(add)
        dropped += west[k] * speed_west[k] ** 2 - east[k] * speed_east[k] ** 2
        held += old[np.uint64(at) + np.uint64(last + 1)] * u_old[k] ** 2
    sheared, lifted = 0.0, 0.0
    for f in range(last):
        change = u[f + 1] - u[f]
        sheared += tau[f + 1] * change
        lifted += (2.0 * below[f + 1] - 1.0) * q[f + 1] * change**2
    dropped = per_dx * dropped + per_dt * steep * held
    area = 1.0 / (per_dx * per_dt)
    half = 0.5 * rho * area
    if last >= 0:
        dropped += steep * (abs(q[0]) * u[0] ** 2 + q[last + 1] * u[last] ** 2)
        books[BED] += area * steep * tau[0] * u[0]
    books[LATE] += half * late
    books[UPWIND] += half * (per_dx * upwind + steep * lifted)
    books[FALL] += half * dropped
    books[SHEAR] += area * steep * sheared
    return moved


@sums
def book_side(
    books: Floats, u: Floats, k_side: Floats, r_side: Floats, m: int, rho: float, area: float
) -> None:
    """Add what side walls take: r_side - k_side u is their force over density [m2/s2], `area` in m s."""
    side = 0.0
    for k in range(m + 1):
        side += u[k] * (k_side[k] * u[k] - r_side[k])
    books[SIDE] += rho * area * side


@kernel
def book_resistance(
    p: ColumnParameters, books: Floats, step: StepWorkspace, given: Floats, tau: Floats, now: Floats,
    sill: int, m: int, steep: float, gradient: float, lost: float, per_dx: float, per_dt: float,
    force: Floats, slope: Floats,
) -> None:  # fmt: skip
    """Add the work of grains and of a porous solid at a station.

    Parameters
    ----------
    given : rows of `time_step`, which hold the forces of both, and the solid as what takes its share.
    gradient, lost : pressure gradient over `steep` [Pa/m], and forces in dry cells [N/m3].
    force, slope : of the grains alone, shape (n,).
    The others are those of `book_station`.

    Notes
    -----
    The pressure gradient acts on the water alone, c U G; what it does on grains is taken from their force.
    """
    u, h = step.r, step.h
    work, drag = 0.0, 0.0
    for at in range(m + 1):
        change = u[at] - given[0, at]
        own = force[at + sill] + slope[at + sill] * change
        every = given[4, at] + given[5, at] * change
        solid = given[6, at] * h[at]
        work -= u[at] * (own * p.dz - (h[at] - solid - now[at]) * gradient)
        drag += u[at] * ((every - own) * p.dz - solid * gradient + given[6, at] * (tau[at + 1] - tau[at]))
    if m >= 0:
        work -= u[m] * lost * p.dz
    area = steep / (per_dx * per_dt)
    books[GRAINS] += area * work
    books[POROUS] += area * drag


@kernel
def book_row(
    p: ColumnParameters, shape: RowShape, dt: float, driver: float, phi: Floats, water: RowWater,
    energy: EnergyArrays, total: Floats, out: Floats,
) -> None:  # fmt: skip
    """Add what gravity, pressure and both ends give in a step, and what surface and falls lose.

    Parameters
    ----------
    driver : pressure gradient of the driver [Pa/m].
    water : with the surface and the content after the step.
    total, out : water that passed each station [m2/s], and budgets of the stations.

    Notes
    -----
    Pressure works on the speeds of the new time with the height that the surfaces have at a station, water
    moved with the speeds of the old one, from the surface of the segment that it left.
    """
    books, moved, push = energy.books, energy.moved, energy.push
    weight, stations = p.rho_w * shape.g_z, len(shape.kind)
    for j in range(stations):
        if shape.kind[j] != OPEN:
            continue
        rises = height_at(p, shape, water, shape.right[j]) - height_at(p, shape, water, shape.left[j])
        works = -push[j] * shape.dx / weight
        books[GRAVITY] += p.rho_w * p.g_x * moved[j] * dt * shape.dx
        given = out[j, GRADIENT] * shape.inertia[j] - push[j] if p.drive == OF_DISCHARGE else driver
        books[DRIVER] += given * moved[j] * dt * shape.dx
        books[FALL] -= weight * dt * total[j] * (rises - works)
        books[SURFACE] += weight * dt * works * (moved[j] - total[j])
    for i in range(shape.inner[0], shape.inner[1]):
        gain = float(-dt / shape.dx * (total[shape.east[i]] - total[shape.west[i]]))
        if gain != 0.0:
            low = lag_of_surface(p, gain, phi[i], water.content[i], water.wet[i], water.surface[i])
            books[SURFACE] += weight * shape.dx * low
    if len(shape.bottom) == stations:
        return
    for j, beyond, sign, term in ((0, 0, 1.0, UPSTREAM), (stations - 1, stations, -1.0, DOWNSTREAM)):
        inside = beyond + 1 if j == 0 else beyond - 1
        segment = beyond if shape.kind[j] == OPEN else inside
        carried = 0.0
        for k in range(p.n):
            carried += energy.through[segment, k] * energy.speed[segment, k] ** 2
        carried *= 0.5 * p.rho_w * dt * sign
        if shape.kind[j] == WALL:
            books[FALL] -= carried
        else:
            height = height_at(p, shape, water, segment)
            books[term] += carried + sign * weight * dt * total[j] * height


@kernel
def height_at(p: ColumnParameters, shape: RowShape, water: RowWater, i: int) -> float:
    """Height of the surface of a segment over the x axis [m]."""
    return shape.bottom[i] + water.surface[i] - p.z_low


@kernel
def lag_of_surface(
    p: ColumnParameters, gain: float, phi: Floats, content: Floats, wet: Floats, surface: float
) -> float:
    """Integral of the surface's last height less its present one over the water gained [m2].

    Parameters
    ----------
    gain : water per area that the segment has gained [m].
    content, wet, surface : after it, `surface` as in `RowWater`.
    """
    k = min(int((surface - p.z_low) / p.dz), p.n - 1)
    left, below, total = abs(gain), 0.0, 0.0
    while left > 0.0 and 0 <= k < p.n:
        eps = 1.0 - phi[k]
        room = content[k] if gain > 0.0 else max(eps * (p.dz - wet[k]), 0.0)
        part = min(left, room)
        thick = part / eps
        total += part * (below + 0.5 * thick)
        below += thick
        left -= part
        k += -1 if gain > 0.0 else 1
    return total
