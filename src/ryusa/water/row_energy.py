"""Compiled energy account of the water of a row: every term by its own formula.

The balance of a cell of a station, times U of the new time, gives the change of its kinetic energy. With the
continuity of the cell what is left over is a sum of squares of differences of U: what momentum loses that is
carried with the speed upstream, and what the implicit step loses. Where the bottom is inclined U stands here
for the speed along it, U sqrt(steep). Potential energy changes with the water of a segment by the integral of
the height of its surface. Derivation: design/0027.
"""

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ryusa.laws.families import Drive, SideWalls
from ryusa.model.row import OPEN, WALL
from ryusa.model.row_energy import N_ROW_TERM, RowTerm
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.momentum_balance import GRADIENT, StepWorkspace
from ryusa.water.time_step import distribute_water

if TYPE_CHECKING:
    from ryusa.water.row_step import RowShape, RowWater

KINETIC, POTENTIAL = int(RowTerm.KINETIC), int(RowTerm.POTENTIAL)
GRAVITY, DRIVER = int(RowTerm.GRAVITY), int(RowTerm.DRIVER)
UPSTREAM, DOWNSTREAM = int(RowTerm.UPSTREAM), int(RowTerm.DOWNSTREAM)
GRAINS, DISPLACED = int(RowTerm.GRAINS), int(RowTerm.DISPLACED)
BED, SIDE, SHEAR, POROUS = int(RowTerm.BED), int(RowTerm.SIDE), int(RowTerm.SHEAR), int(RowTerm.POROUS)
FALL, UPWIND, LATE, SURFACE = int(RowTerm.FALL), int(RowTerm.UPWIND), int(RowTerm.LATE), int(RowTerm.SURFACE)
NO_WALLS = int(SideWalls.NONE)
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


@kernel
def kinetic_at(p: ColumnParameters, shape: "RowShape", water: "RowWater", j: int) -> float:
    """Kinetic energy of the water at an open station, per width [J/m]; 0 at others."""
    if shape.kind[j] != OPEN:
        return 0.0
    a, b = shape.left[j], shape.right[j]
    total = 0.0
    for k in range(p.n):
        total += (water.content[a, k] + water.content[b, k]) * water.u[j, k] ** 2
    return 0.25 * p.rho_w * shape.dx * shape.steep[j] * total


@kernel
def add_held(
    p: ColumnParameters, shape: "RowShape", water: "RowWater", times: float, books: Floats
) -> None:
    """Add the kinetic and the potential energy of the row to the account, `times` 1 or -1."""
    for j in range(len(shape.kind)):
        books[KINETIC] += times * kinetic_at(p, shape, water, j)
    for i in range(shape.inner[0], shape.inner[1]):
        lift = lift_of(p, shape.bottom[i], water.content[i], water.wet[i])
        books[POTENTIAL] += times * p.rho_w * shape.g_z * shape.dx * lift


@kernel
def lift_of(p: ColumnParameters, bottom: float, content: Floats, wet: Floats) -> float:
    """Water of a segment times its height over the x axis, per area [m2]."""
    total = 0.0
    for k in range(p.n):
        total += content[k] * (bottom + k * p.dz + 0.5 * wet[k])
    return total


@kernel
def book_ends(p: ColumnParameters, shape: "RowShape", water: "RowWater", times: float, books: Floats) -> None:
    """Add the kinetic energy at the end stations, with `times` -1 and 1 before and after `fill_ends`."""
    last = len(shape.kind) - 1
    if len(shape.bottom) == last:  # two segments beyond the ends, one station more than inner segments
        return
    books[UPSTREAM] += times * kinetic_at(p, shape, water, 0)
    books[DOWNSTREAM] += times * kinetic_at(p, shape, water, last)


@kernel
def book_displaced(
    p: ColumnParameters, shape: "RowShape", phi: Floats, water: "RowWater", level: Floats, books: Floats
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


@kernel
def book_station(
    p: ColumnParameters, energy: EnergyArrays, step: StepWorkspace, given: Floats, tau: Floats, now: Floats,
    sill: int, m: int, last: int, steep: float, per_dx: float, per_dt: float, left: int, right: int,
    u_old: Floats,
) -> float:  # fmt: skip
    """Add what a station loses at bed and walls, between cells and by the scheme; its `moved` returned.

    Parameters
    ----------
    step : after the solution: new speeds in `r`, vertical fluxes and their weights, side walls.
    given, now : rows of `time_step` with the content before the step, and the content after it.
    tau : stress at the faces, over `steep` [Pa].
    sill, m, last : lowest open cell, highest wet cell and highest solved cell, -1 without; counted from sill.
    u_old : speeds before the step [m/s], shape (n,).

    Notes
    -----
    Content that stays in a cell loses (1/2) c (dU)**2 in time, water that comes from a cell with another speed
    (1/2) |Q| (dU)**2.
    """
    books, through, speed, u = energy.books, energy.through, energy.speed, step.r
    turned = math.sqrt(steep)
    moved, late, upwind, dropped = 0.0, 0.0, 0.0, 0.0
    for at in range(last + 1):
        k = at + sill
        s = turned * u[at]
        west, east = through[left, k], through[right, k]
        stays = given[1, at] * per_dt + per_dx * (min(west, 0.0) - max(east, 0.0))
        late += stays * (s - turned * u_old[k]) ** 2
        upwind += max(west, 0.0) * (speed[left, k] - s) ** 2 - min(east, 0.0) * (speed[right, k] - s) ** 2
    upwind *= per_dx
    for at in range(m + 1):
        moved += now[at] * u[at]
    for f in range(1, last + 1):
        if step.below[f] != 0.5:
            upwind += (2.0 * step.below[f] - 1.0) * steep * step.q[f] * (u[f] - u[f - 1]) ** 2
    shear = 0.0
    for f in range(1, m + 1):
        shear += tau[f] * (u[f] - u[f - 1])
    cells = p.n - sill
    for k in range(sill):
        dropped += unsolved(energy, left, right, k, 0.0, per_dx)
    for at in range(last + 1, cells):
        k = at + sill
        held = given[1, at] * per_dt * steep * u_old[k] ** 2
        dropped += unsolved(energy, left, right, k, held, per_dx)
    if last >= 0:
        dropped += steep * (abs(step.q[0]) * u[0] ** 2 + step.q[last + 1] * u[last] ** 2)
    area = 1.0 / (per_dx * per_dt)
    half = 0.5 * p.rho_w * area
    books[LATE] += half * late
    books[UPWIND] += half * upwind
    books[FALL] += half * dropped
    books[SHEAR] += area * steep * shear
    if m >= 0:
        books[BED] += area * steep * tau[0] * u[0]
    if p.side != NO_WALLS:
        side = 0.0
        for at in range(m + 1):
            side += u[at] * (step.k_side[at] * u[at] - step.r_side[at])
        books[SIDE] += p.rho_w * area * steep * side
    return moved


@kernel
def unsolved(energy: EnergyArrays, left: int, right: int, k: int, held: float, per_dx: float) -> float:
    """Twice the power that is lost in a cell without a balance, over density and length [m3/s3]."""
    west = energy.through[left, k] * energy.speed[left, k] ** 2
    return held + per_dx * (west - energy.through[right, k] * energy.speed[right, k] ** 2)


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
    p: ColumnParameters, shape: "RowShape", dt: float, driver: float, phi: Floats, water: "RowWater",
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
        given = out[j, GRADIENT] * shape.steep[j] - push[j] if p.drive == OF_DISCHARGE else driver
        books[DRIVER] += given * moved[j] * dt * shape.dx
        books[FALL] -= weight * dt * total[j] * (rises - works)
        books[SURFACE] += weight * dt * works * (moved[j] - total[j])
    for i in range(shape.inner[0], shape.inner[1]):
        gain = -dt / shape.dx * (total[shape.east[i]] - total[shape.west[i]])
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
def height_at(p: ColumnParameters, shape: "RowShape", water: "RowWater", i: int) -> float:
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
