"""Compiled momentum balance of one station of a row of columns.

The control volume of a station is half of each segment beside it. Means of both segments therefore fulfil the
continuity of its cells exactly, and the balance is that of a column with one more term, what the flow along x
brings.
"""

from typing import NamedTuple

import numpy as np

from ryusa.laws.families import BedKind
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel
from ryusa.water.closures import bound_by_layers, mixing_lengths
from ryusa.water.exchange import Ints
from ryusa.water.momentum_balance import (
    B_ADVECTED,
    B_CHANGE,
    B_GRAVITY,
    DONE,
    GRADIENT,
    NO_WALLS,
    SURFACE,
    StepWorkspace,
    friction_velocity_at,
    iterate,
    sources_of,
    weigh_vertical_flow,
    write_results,
)
from ryusa.water.row_energy import EnergyArrays, book_resistance, book_side, book_station

ROUGH = int(BedKind.ROUGH)
FALLING = 1.0e-14  # smallest flux that falls through a dry cell, over that which would empty both segments


class StationArrays(NamedTuple):
    """Work arrays of a row."""

    flux: Floats  # along x through each station [m2/s], shape (n_station, n)
    total: Floats  # its sum over the cells, shape (n_station,)
    tilt: Floats  # limited slope of the surface in each segment [m], shape (n_segment,)
    old: Floats  # content before the step [m], shape (n_segment, n)
    q: Floats  # upwards through the faces of each segment [m/s], shape (n_segment, n + 1)
    carried: Floats  # momentum that passes the middle of each segment, over density [m3/s2], (n_segment, n)
    u: Floats  # new speeds [m/s], shape (n_station, n)
    middle: Floats  # shape (n,)
    given: Floats  # rows of `time_step`, shape (N_GIVEN, n)
    level: Floats  # speed, content and its profiles at a station, shape (6, n)
    edge: Floats  # stress and eddy viscosity there, shape (2, n + 1)
    step: StepWorkspace
    energy: EnergyArrays
    last: Ints  # highest cell of each station that has a balance, -1 without water, shape (n_station,)
    solved: (
        Floats  # new speeds up to that cell, in dry ones that of falling water [m/s], shape (n_station, n)
    )


@kernel
def along(p: ColumnParameters, g_x: float) -> ColumnParameters:
    """The same column with another gravity along x."""
    return ColumnParameters(
        p.n, p.z_low, p.dz, p.z_bed, p.z_surface, p.rho_w, p.nu, p.bed, p.k_rough, p.top, p.u_lid, p.surface,
        p.side, p.width, g_x, p.drive, p.gradient, p.tau, p.discharge, p.mixing, p.kappa, p.phi_max, p.k_f,
        p.d,
    )  # fmt: skip


@kernel
def mean_of(a: float, b: float, x: float, y: float) -> float:
    """Mean of x and y weighted with the wet thicknesses a and b; the plain mean where both are the same."""
    return 0.5 * (x + y) if a == b else (a * x + b * y) / (a + b)


@kernel
def gather(
    p: ColumnParameters, sill: int, gradient: float, steep: float, inertia: float, left: int, right: int,
    matrix_phi: Floats, linear: Floats, quadratic: Floats, phi: Floats, force: Floats, slope: Floats,
    carried: Floats, phi_w: Floats, u_old: Floats, content: Floats, wet: Floats, work: StationArrays,
) -> int:  # fmt: skip
    """Gather what the balance of a station needs, from its lowest open cell upwards; see `solve_station`.

    Returns
    -------
    m : highest wet cell above the sill, -1 without water.
    """
    step, given, now = work.step, work.given, work.level[2]
    m, part = -1, steep / inertia
    quadratic_factor = steep**0.5 * part
    for at in range(p.n - sill):
        k = at + sill
        a, b = wet[left, k], wet[right, k]
        h = 0.5 * (a + b)
        now[at] = 0.5 * (content[left, k] + content[right, k])
        step.h[at] = h
        step.z[at] = p.z_low + at * p.dz + 0.5 * max(a, b)
        step.q[at] = 0.5 * (work.q[left, k] + work.q[right, k])
        u = u_old[k]
        given[0, at], given[2, at] = u, u
        given[1, at] = 0.5 * (work.old[left, k] + work.old[right, k])
        given[3, at] = mean_of(a, b, phi[left, k], phi[right, k])
        given[4, at], given[5, at], given[6, at] = force[k], slope[k], carried[k]
        given[7, at] = phi_w[k]
        if h > 0.0:
            m = at
        solid = mean_of(a, b, matrix_phi[left, k], matrix_phi[right, k])
        if solid > 0.0 and h > 0.0:
            one = part * (0.5 * (a * linear[left, k] + b * linear[right, k]))
            two = quadratic_factor * 0.5 * (a * quadratic[left, k] + b * quadratic[right, k])
            per = p.rho_w / p.dz
            given[4, at] += per * (one + two * abs(u)) * u + solid * h / p.dz * gradient
            given[5, at] += per * (one + 2.0 * two * abs(u))
            given[6, at] += solid
    top = p.n - sill
    step.q[top] = 0.5 * (work.q[left, p.n] + work.q[right, p.n])
    return m


@kernel
def solve_station(
    p: ColumnParameters, sill: int, steep: float, inertia: float, gradient: float, per_dx: float,
    per_dt: float, left: int, right: int, j: int, matrix_phi: Floats, linear: Floats, quadratic: Floats,
    phi: Floats, force: Floats, slope: Floats, carried: Floats, phi_w: Floats, u_old: Floats,
    content: Floats, wet: Floats, surface: Floats, volume: Floats, laden: bool, work: StationArrays,
    rows: Floats, faces: Floats, out: Floats,
) -> int:  # fmt: skip
    """New speeds of a station, written to `work.u[j]`; profiles and budget as `time_step` writes them.

    Parameters
    ----------
    p : the column.
    sill : lowest cell open on both sides.
    steep : 1 + tan**2 of the angle between bottom and x axis [-].
    inertia : the same where the pressure is hydrostatic; 1 where a pressure of its own turns the flow.
    gradient : pressure gradient [Pa/m].
    per_dx, per_dt : one over the length of a segment [1/m] and over the step [1/s].
    left, right, j : the segments beside the station, and the station.
    matrix_phi, linear, quadratic : as `RowMatrix`.
    phi, force, slope, carried, phi_w : as `RowGrains`, all but the first at this station.
    u_old : speeds before the step [m/s], shape (n,).
    content, wet, surface, volume : as `RowWater`.
    laden : whether there are grains or a porous solid in the row.
    work : with `old`, `q` and `carried` of this step; the energy account is added to.
    rows, faces, out : output of this station.

    Notes
    -----
    In a flow inclined to the x axis by alpha, u is the part along x of the speed u/cos(alpha). Its inertia is
    `steep` times that of a level flow, its stresses `steep`**2 times, its quadratic drag and that of side
    walls `steep`**1.5 times (design/0027). The balance is solved after division by `inertia`.

    Water that falls behind a sill takes its momentum along; what rises before it brings none.
    """
    # One function: the balance of one station from its arrays to its budget, in the order of `time_step`
    cells = p.n - sill
    here = p if inertia == 1.0 else along(p, p.g_x / inertia)
    gradient = gradient / inertia
    m = gather(
        p, sill, gradient, steep, inertia, left, right, matrix_phi, linear, quadratic, phi, force, slope,
        carried, phi_w, u_old, content, wet, work,
    )  # fmt: skip
    step, given, edge, level = work.step, sources_of(work.given), work.edge, work.level
    for k in range(p.n):
        work.u[j, k] = 0.0
        for r in range(6):
            rows[r, k] = 0.0
    for f in range(p.n + 1):
        faces[0, f], faces[1, f], step.k_face[f], step.r_face[f] = 0.0, 0.0, 0.0, 0.0
    for r in range(len(out)):
        out[r] = 0.0
    through, speed = work.energy.through, work.energy.speed
    work.last[j] = sill + m
    if m < 0:
        work.last[j] = -1
        work.energy.moved[j] = book_station(
            work.energy.books, through[left], through[right], speed[left], speed[right], work.given[1],
            level[2], step.r, u_old, step.q, step.below, edge[0], sill, -1, p.rho_w, inertia, per_dx,
            per_dt,
        )  # fmt: skip
        return DONE
    least = FALLING * 0.5 * (volume[left] + volume[right]) * per_dt
    last = m
    while last + 1 < cells and step.q[last + 1] < -least:
        last += 1
    work.last[j] = sill + last
    turned = np.sqrt(inertia)
    for at in range(cells):
        k = at + sill
        given.advected[at] = -(work.carried[right, k] - work.carried[left, k]) * per_dx / turned
    if m == 0 and p.bed == ROUGH:  # a film: Eq. (9) is zero at k_rough/30
        step.z[0] = max(step.z[0], p.z_low + min(p.k_rough / 15.0, 0.5 * p.dz))
    floor = p.z_low + sill * p.dz
    z_surface = 0.5 * (max(surface[left], floor) + max(surface[right], floor)) - sill * p.dz
    old, now = work.given[1], level[2]
    u_star = friction_velocity_at(here, work.given[2, 0], step.z[0] - p.z_low)
    mixing_lengths(here, m, given.phi, step.z, z_surface, u_star, step.square)
    bound_by_layers(here, m, given.phi, step.z, work.given[2], step.square)
    weigh_vertical_flow(here, m, last, work.given[0], step)
    if step.q[0] < 0.0:
        step.below[0] = 0.0
    lost = 0.0
    for at in range(m + 1, cells):
        lost += given.force[at]
    for at in range(cells):
        level[0, at] = work.given[2, at]
    status, gradient = iterate(
        here, m, last, z_surface, u_star, work.given[0], old, given, gradient, lost, per_dt,
        steep, steep / inertia, level[0],
        now, out, step,
    )  # fmt: skip
    if status != DONE:
        return status
    write_results(here, m, last, work.given[0], old, given, gradient, lost, per_dt, level, edge, out, step)
    out[SURFACE], out[GRADIENT] = z_surface, gradient
    work.energy.moved[j] = book_station(
        work.energy.books, through[left], through[right], speed[left], speed[right], old, now, step.r, u_old,
        step.q, step.below, edge[0], sill, last, p.rho_w, inertia, per_dx, per_dt,
    )  # fmt: skip
    if p.side != NO_WALLS:
        area = inertia / (per_dx * per_dt)
        book_side(work.energy.books, step.r, step.k_side, step.r_side, m, p.rho_w, area)
    if laden:
        book_resistance(
            p, work.energy.books, step, work.given, edge[0], now, sill, m, inertia, gradient, lost, per_dx,
            per_dt, force, slope,
        )  # fmt: skip
    if inertia != steep:  # the stress along the flow, as elsewhere
        for at in range(cells):
            edge[0, at] *= inertia / steep
            level[5, at] *= inertia / steep
    for at in range(last + 1):
        work.solved[j, at + sill] = step.r[at]
        out[B_ADVECTED] += p.rho_w * given.advected[at]
    out[B_ADVECTED] += p.rho_w * step.q[0] * (1.0 - step.below[0]) * level[0, 0]
    for at in range(cells):
        work.u[j, at + sill] = level[0, at]
        for r in range(6):
            rows[r, at + sill] = level[r, at]
    for at in range(cells + 1):
        faces[0, at + sill], faces[1, at + sill] = edge[0, at], edge[1, at]
    return DONE


@kernel
def relative_residual_at(out: Floats) -> float:
    """Residual of the momentum budget of a station over its largest term [-]."""
    largest, residual = 0.0, 0.0
    for k in range(B_GRAVITY, B_ADVECTED + 1):
        term = -out[k] if k == B_CHANGE else out[k]
        residual += term
        largest = max(largest, abs(term))
    return abs(residual) / largest if largest > 0.0 else 0.0


@kernel
def largest_residual(budgets: Floats) -> float:
    """Largest `relative_residual_at` of the stations [-]; budgets (n_station, N_OUT)."""
    most = 0.0
    for j in range(len(budgets)):
        most = max(most, relative_residual_at(budgets[j]))
    return most
